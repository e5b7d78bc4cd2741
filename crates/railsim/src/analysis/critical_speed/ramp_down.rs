//! The paper's way: start very fast and disturbed, brake slowly, and read the speed at which hunting ends (Spiryagin et al.,
//! Proc. IMechE F 227 (2013), test 1.6).

use serde_json::json;

use crate::analysis::critical_speed::roller::{Roller, on_straight_track, stride, swing};
use crate::analysis::{Stand, Table};
use crate::dynamics::{Model, coordinate};
use crate::error::{Error, Result};
use crate::run::{Control, Ended, Outcome};
use crate::schema::Case;
use crate::schema::run::Hunting;

pub(super) fn names(model: &Model) -> Vec<String> {
    let mut names: Vec<String> = ["t", "s", "v"].map(str::to_owned).to_vec();
    for part in ["y", "swing"] {
        names.extend(model.wheelsets.iter().map(|w| format!("{}.{part}", w.body.name)));
    }
    names.extend(["swing".to_owned(), "critical_speed".to_owned()]);
    names
}

/// A row at each output step: lateral place of each axle and its `swing`, peak to peak within the window that ends there. The
/// reading is the speed at the end of the last window in which any axle moves by more than the threshold: NaN where none ever
/// does (nothing was excited), the last speed where it still does.
pub(super) fn run(
    case: &Case,
    end_speed: f64,
    deceleration: f64,
    hunting: &Hunting,
    control: &dyn Control,
) -> Result<Outcome> {
    let mut stand = Stand::new(case)?;
    on_straight_track(&stand.model)?;
    let offsets = coordinate::disturbance(&stand.model, &case.run.disturbance)?;
    let x = stand.settle(case.run.speed)?;
    let mut roller = Roller::new(case, &stand, x, &offsets)?;
    roller.accelerate(-deceleration);
    let every = stride(&case.run.integrator, case.run.output_step);
    let axles = stand.model.wheelsets.len();
    let start = roller.place();
    let (mut times, mut places, mut speeds) = (Vec::new(), Vec::new(), Vec::new());
    let mut lateral: Vec<Vec<f64>> = vec![Vec::new(); axles];
    let mut ended = Ended::Complete;
    while roller.speed() > end_speed {
        times.push(roller.time());
        places.push(roller.place() - start);
        speeds.push(roller.speed());
        for (column, y) in lateral.iter_mut().zip(roller.lateral()) {
            column.push(y);
        }
        if control.stop() {
            return Err(Error::Interrupted);
        }
        let done = (case.run.speed - roller.speed()) / (case.run.speed - end_speed);
        control.progress(roller.time(), roller.place() - start, done);
        if let Err(error) = roller.advance(every) {
            ended = Ended::Diverged(error);
            break;
        }
    }
    let window = (hunting.window_s / case.run.output_step).round().max(1.0) as usize;
    let swings: Vec<Vec<f64>> = lateral
        .iter()
        .map(|y| (0..y.len()).map(|i| swing(&y[i.saturating_sub(window)..=i])).collect())
        .collect();
    let most: Vec<f64> = (0..times.len()).map(|i| swings.iter().map(|s| s[i]).fold(0.0, f64::max)).collect();
    // A run that ended early has no reading: it may have hunted on.
    let last = most.iter().rposition(|s| *s > hunting.threshold).filter(|_| ended == Ended::Complete);
    let critical = last.map_or(f64::NAN, |i| speeds[i]);
    let mut table = Table::new(names(&stand.model));
    for i in 0..times.len() {
        let axle_rows = lateral.iter().chain(&swings).map(|column| column[i]);
        let own = [times[i], places[i], speeds[i]].into_iter().chain(axle_rows);
        table.push(own.chain([most[i], critical]));
    }
    let statistics = json!({
        "analysis": "critical_speed",
        "method": "ramp_down",
        "critical_speed": last.map(|i| speeds[i]),
        "time_of_reading_s": last.map(|i| times[i]),
        "found": match last {
            None => "no hunting",
            Some(i) if i + 1 == times.len() => "hunts to the end of the ramp",
            Some(_) => "where hunting ends",
        },
        "scheme": case.run.integrator.name(),
        "step": case.run.integrator.step(),
        "steps": roller.steps(),
        "simulated_s": roller.time(),
        "distance_m": roller.place() - start,
    });
    Ok(table.done(Vec::new(), ended, statistics))
}
