//! Where the largest real part of the vehicle's eigenvalues passes zero, looked for from below.

use serde_json::json;

use crate::analysis::modal::{Mode, RIGID, modes};
use crate::analysis::{Stand, Table};
use crate::error::{Error, Result};
use crate::run::{Control, Ended, Outcome};
use crate::schema::Case;

/// Width to which the speed is bisected, as a share of it.
const BISECTED: f64 = 1e-8;
/// Speeds looked at before bisection, unless the file says how far apart they are.
const LOOKS: f64 = 20.0;

pub(super) fn names() -> Vec<String> {
    ["v", "real", "imag", "frequency", "damping_ratio", "critical_speed"].map(str::to_owned).to_vec()
}

/// The least stable mode at a speed.
fn least_stable(stand: &mut Stand, speed: f64) -> Result<Mode> {
    let x = stand.settle(speed)?;
    let all = modes(&stand.model, &mut stand.system(speed), &x, &stand.held)?;
    let moving = all.into_iter().filter(|m| m.eigenvalue.norm() > RIGID);
    moving.max_by(|a, b| a.eigenvalue.re.total_cmp(&b.eigenvalue.re)).ok_or_else(|| Error::NotConverged {
        what: "linear critical speed".into(),
        iterations: 0,
        residual: f64::INFINITY,
        unit: "1/s",
        worst: "a vehicle in which nothing can move".into(),
    })
}

pub(super) fn run(
    case: &Case,
    range: [f64; 2],
    spacing: Option<f64>,
    control: &dyn Control,
) -> Result<Outcome> {
    let mut stand = Stand::new(case)?;
    let spacing = spacing.unwrap_or((range[1] - range[0]) / LOOKS);
    let mut looked: Vec<(f64, Mode)> = Vec::new();
    let looks = ((range[1] - range[0]) / spacing).ceil().max(1.0) as u32;
    let mut critical = range[1];
    let mut found = "stable up to the highest speed looked at";
    for k in 0..=looks {
        if control.stop() {
            return Err(Error::Interrupted);
        }
        let v = (range[0] + spacing * f64::from(k)).min(range[1]);
        control.progress(f64::from(k), 0.0, f64::from(k) / f64::from(looks + 1));
        let mode = least_stable(&mut stand, v)?;
        let grows = mode.eigenvalue.re > 0.0;
        let below = looked.last().map(|(v, _)| *v);
        looked.push((v, mode));
        if grows {
            (critical, found) = match below {
                None => (v, "unstable at the lowest speed looked at"),
                Some(below) => {
                    let (v, mode) = bisect(&mut stand, below, v)?;
                    looked.push((v, mode));
                    (v, "where the largest real part passes zero")
                }
            };
            break;
        }
    }
    looked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut table = Table::new(names());
    let mut labels = Vec::new();
    for (v, mode) in &looked {
        let e = mode.eigenvalue;
        table.push([*v, e.re, e.im, mode.frequency(), mode.damping_ratio(), critical]);
        labels.push(mode.name.clone());
    }
    let statistics = json!({
        "analysis": "critical_speed",
        "method": "linear",
        "critical_speed": critical,
        "found": found,
        "speeds": looked.len(),
    });
    Ok(table.done(vec![("name".into(), labels)], Ended::Complete, statistics))
}

fn bisect(stand: &mut Stand, mut stable: f64, mut unstable: f64) -> Result<(f64, Mode)> {
    let mut last = None;
    while unstable - stable > BISECTED * unstable {
        let middle = 0.5 * (stable + unstable);
        let mode = least_stable(stand, middle)?;
        if mode.eigenvalue.re > 0.0 {
            unstable = middle
        } else {
            stable = middle
        }
        last = Some(mode);
    }
    let v = 0.5 * (stable + unstable);
    let mode = match last {
        Some(mode) => mode,
        None => least_stable(stand, v)?,
    };
    Ok((v, mode))
}
