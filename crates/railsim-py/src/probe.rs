//! Stand-in work for tests of the door: what a case can do to it, without any physics.

use std::num::NonZeroUsize;
use std::thread::sleep;
use std::time::Duration;

use pyo3::prelude::*;
use railsim::run::{Control, Ended, Outcome};
use railsim::{Error, Fault, KeyPath, Result};
use serde_json::json;

use crate::enter::enter;
use crate::run::Callbacks;

/// Like `run_cases`, but each "case" is the name of a deed: `rows`, `diverge`, `input`, `panic`, `endless`.
#[pyfunction]
pub fn _run_probes(
    py: Python<'_>,
    deeds: Vec<String>,
    jobs: NonZeroUsize,
    on_progress: Py<PyAny>,
    on_done: Py<PyAny>,
) -> PyResult<()> {
    let work = |deed: String, control: &dyn Control| perform(&deed, control);
    enter(py, deeds.into_iter().map(Ok), jobs, work, &mut Callbacks { on_progress, on_done })
}

fn perform(deed: &str, control: &dyn Control) -> Result<Outcome> {
    let diverged = Error::Diverged { t: 0.5, s: 2.0, body: "ws1".into(), cause: "wheel climb".into() };
    match deed {
        "rows" => Ok(rows(Ended::EndOfTrack)),
        "diverge" => Ok(rows(Ended::Diverged(diverged))),
        "refuse" => Err(diverged),
        #[expect(clippy::panic, reason = "the deed")]
        "panic" => panic!("a probe panicked"),
        "endless" => {
            for step in 0_u32.. {
                if control.stop() {
                    break;
                }
                let t = f64::from(step) * 0.001;
                control.progress(t, 4.0 * t, 0.5);
                sleep(Duration::from_millis(1));
            }
            Err(Error::Interrupted)
        }
        _ => Err(Error::input(Fault::new(KeyPath::of("probe.deed"), deed, "rows, diverge, panic, endless"))),
    }
}

fn rows(ended: Ended) -> Outcome {
    let t = vec![0.0, 0.25, 0.5];
    let s = t.iter().map(|t| 4.0 * t).collect();
    Outcome {
        columns: vec![("t".into(), t), ("s".into(), s), ("carbody.y".into(), vec![-0.0, 1e-300, 0.1])],
        labels: Vec::new(),
        ended,
        statistics: json!({"steps": 3}),
    }
}
