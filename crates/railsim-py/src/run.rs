//! Cases: checking, running, and what a run records.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;

use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;
use pyo3::types::PyIterator;
use railsim::KeyPath;
use railsim::analysis;
use railsim::run::{Law, Outcome, Outside, simulate_controlled};
use railsim::schema::Case;
use railsim::track::irregularity::DeviationField;

use crate::arrow::Frame;
use crate::contact::{Tables, read};
use crate::enter::{Finished, Listener, Progress, enter};
use crate::errors::raise;

/// Version of the package.
#[pyfunction]
pub fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// SHA-256 of the core's sources.
#[pyfunction]
pub fn fingerprint() -> &'static str {
    env!("RAILSIM_FINGERPRINT")
}

/// Every fault of a case, at once.
#[pyfunction]
#[pyo3(signature = (case_json, tables=None))]
pub fn check_case(py: Python<'_>, case_json: &str, tables: Option<&Tables>) -> PyResult<()> {
    read(py, case_json, tables).map(drop)
}

/// Name, unit and meaning of every channel.
#[pyfunction]
#[pyo3(signature = (case_json, tables=None))]
pub fn channels(
    py: Python<'_>,
    case_json: &str,
    tables: Option<&Tables>,
) -> PyResult<Vec<(String, &'static str, &'static str)>> {
    let case = read(py, case_json, tables)?;
    let channels = analysis::channels(&case).map_err(|e| raise(py, e))?;
    Ok(channels.into_iter().map(|c| (c.name, c.unit, c.meaning)).collect())
}

/// Last part of the name, unit and meaning of every channel that any case may have.
#[pyfunction]
pub fn channel_parts() -> Vec<(&'static str, &'static str, &'static str)> {
    railsim::run::channel::parts().to_vec()
}

/// Smallest and largest value of each track irregularity.
#[pyfunction]
#[pyo3(signature = (case_json, tables=None))]
pub fn track_extremes(
    py: Python<'_>,
    case_json: &str,
    tables: Option<&Tables>,
) -> PyResult<BTreeMap<&'static str, (f64, f64)>> {
    let case = read(py, case_json, tables)?;
    let extremes = py.detach(|| {
        let track = &case.track;
        let at = KeyPath::of("track.irregularity");
        DeviationField::new(&track.irregularity, track.length, track.fade_start, track.fade_in, &at)
            .map(|field| field.extremes())
    });
    let extremes = extremes.map_err(|e| raise(py, e))?;
    Ok(["lateral", "vertical", "cross_level", "gauge"].into_iter().zip(extremes).collect())
}

/// Runs cases on `jobs` threads, begun in their order; results and progress go to the callbacks. `cases` may be any iterable of
/// JSON, or of pairs of JSON and a control law of the user's: it is asked for the next one when a thread is free, on that thread.
#[pyfunction]
#[pyo3(signature = (cases, jobs, on_progress, on_done, tables=None))]
pub fn run_cases(
    py: Python<'_>,
    cases: &Bound<'_, PyAny>,
    jobs: NonZeroUsize,
    on_progress: Py<PyAny>,
    on_done: Py<PyAny>,
    tables: Option<&Tables>,
) -> PyResult<()> {
    // A batch shares its tables whether the caller wants them afterwards or not.
    let tables = tables.map(|t| t.tables.clone()).unwrap_or_default();
    enter(
        py,
        Texts(cases.try_iter()?.unbind()),
        jobs,
        |(text, law): (PyBackedStr, Option<PythonLaw>), control| {
            let mut case = Case::from_json(&text)?;
            case.tables = tables.clone();
            let Some(law) = law else { return analysis::run(&case, control) };
            let mut asked =
                Asked { sample: &law.sample, period: case.run.drive.as_ref().map_or(0.0, |d| d.period) };
            let (channels, outputs) = (law.channels.clone(), law.outputs.clone());
            let mut outside = Outside { name: law.name.clone(), channels, outputs, law: &mut asked };
            simulate_controlled(&case, control, &mut outside)
        },
        &mut Callbacks { on_progress, on_done },
    )
}

/// A Python function as control law, with its name and the names of what it sees and sets.
#[derive(FromPyObject)]
pub struct PythonLaw {
    #[pyo3(item)]
    name: String,
    #[pyo3(item)]
    channels: Vec<String>,
    #[pyo3(item)]
    outputs: Vec<String>,
    #[pyo3(item)]
    sample: Py<PyAny>,
}

/// What a Python iterator gives: a case, or a case with its control law.
struct Texts(Py<PyIterator>);

impl Iterator for Texts {
    type Item = PyResult<(PyBackedStr, Option<PythonLaw>)>;

    fn next(&mut self) -> Option<Self::Item> {
        Python::attach(|py| {
            self.0.bind(py).clone().next().map(|item| {
                let item = item?;
                match item.extract() {
                    Ok((text, law)) => Ok((text, Some(law))),
                    Err(_) => Ok((item.extract()?, None)),
                }
            })
        })
    }
}

/// Takes the GIL for as long as the function answers.
struct Asked<'a> {
    sample: &'a Py<PyAny>,
    /// s
    period: f64,
}

impl Law for Asked<'_> {
    fn sample(&mut self, t: f64, seen: &[f64], set: &mut [Option<f64>]) -> Result<(), String> {
        let answer: PyResult<Vec<Option<f64>>> =
            Python::attach(|py| self.sample.bind(py).call1((t, self.period, seen.to_vec()))?.extract());
        let answer = answer.map_err(|error| Python::attach(|py| error.value(py).to_string()))?;
        if answer.len() != set.len() {
            return Err(format!("{} numbers for {} outputs", answer.len(), set.len()));
        }
        set.copy_from_slice(&answer);
        Ok(())
    }
}

/// Hands what happens to two Python functions.
pub struct Callbacks {
    /// `on_progress(index, fraction, distance_m, real_time_factor)`
    pub on_progress: Py<PyAny>,
    /// `on_done(index, frame or exception)`
    pub on_done: Py<PyAny>,
}

impl Listener for Callbacks {
    type Output = Outcome;

    fn progress(&mut self, py: Python<'_>, index: usize, progress: Progress) -> PyResult<()> {
        let Progress { fraction, distance, real_time_factor } = progress;
        self.on_progress.call1(py, (index, fraction, distance, real_time_factor)).map(drop)
    }

    fn done(&mut self, py: Python<'_>, finished: Finished<Outcome>) -> PyResult<()> {
        let Finished { index, result, wall_s } = finished;
        match result.map_err(|e| e.into_py_err(py)).and_then(|outcome| Frame::new(outcome, wall_s)) {
            Ok(frame) => self.on_done.call1(py, (index, frame)),
            Err(error) => self.on_done.call1(py, (index, error.into_value(py))),
        }
        .map(drop)
    }
}
