//! Bifurcation diagram: amplitude of the limit cycle against speed, the speed stepped down from hunting and up again from
//! rest. Between the two jumps both motions are possible: what a disturbance decides.

use serde_json::json;

use crate::analysis::critical_speed::roller::{Roller, on_straight_track, stride, swing};
use crate::analysis::{Stand, Table};
use crate::dynamics::{Model, coordinate};
use crate::error::{Error, Result};
use crate::run::{Control, Ended, Outcome};
use crate::schema::Case;
use crate::schema::run::Hunting;

/// How the speed is stepped.
pub(super) struct Steps {
    pub end_speed: f64,
    pub speed_step: f64,
    pub acceleration: f64,
    pub settle_s: f64,
}

/// Share of the disturbance given at each step on the way up: a straight vehicle would run straight for ever.
const NUDGE: f64 = 0.01;

pub(super) fn names(model: &Model) -> Vec<String> {
    let mut names: Vec<String> = ["v", "direction"].map(str::to_owned).to_vec();
    names.extend(model.wheelsets.iter().map(|w| format!("{}.swing", w.body.name)));
    names.extend(["swing", "critical_speed", "critical_speed_up"].map(str::to_owned));
    names
}

/// One measured speed.
struct Reading {
    speed: f64,
    direction: f64,
    swings: Vec<f64>,
}

impl Reading {
    fn most(&self) -> f64 {
        self.swings.iter().copied().fold(0.0, f64::max)
    }
}

/// A row for each speed, first down (`direction` -1), then up (+1): `swing` of each axle, peak to peak in the window after
/// settling. `critical_speed` is the lowest speed on the way down that still hunts, `critical_speed_up` the first on the way up
/// that hunts again; NaN where there is none.
pub(super) fn run(case: &Case, steps: &Steps, hunting: &Hunting, control: &dyn Control) -> Result<Outcome> {
    let mut stand = Stand::new(case)?;
    on_straight_track(&stand.model)?;
    let offsets = coordinate::disturbance(&stand.model, &case.run.disturbance)?;
    let x = stand.settle(case.run.speed)?;
    let mut roller = Roller::new(case, &stand, x, &offsets)?;
    let count = ((case.run.speed - steps.end_speed) / steps.speed_step).round().max(1.0) as usize;
    let down = (0..=count).map(|k| (-1.0, case.run.speed - steps.speed_step * k as f64));
    let up = (0..count).map(|k| (1.0, case.run.speed - steps.speed_step * k as f64)).rev();
    let mut readings: Vec<Reading> = Vec::new();
    let mut ended = Ended::Complete;
    for (k, (direction, speed)) in down.chain(up).enumerate() {
        if direction > 0.0 {
            roller.shift(&offsets, NUDGE);
        }
        match measure(case, &mut roller, speed, steps, hunting, control) {
            Ok(swings) => readings.push(Reading { speed, direction, swings }),
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            Err(error) => {
                ended = Ended::Diverged(error);
                break;
            }
        }
        control.progress(roller.time(), roller.place(), (k + 1) as f64 / (2 * count + 1) as f64);
    }
    let hunts = |r: &&Reading| r.most() > hunting.threshold;
    let fold = readings.iter().filter(|r| r.direction < 0.0).take_while(hunts).last().map(|r| r.speed);
    let up = readings.iter().filter(|r| r.direction > 0.0).find(hunts).map(|r| r.speed);
    let mut table = Table::new(names(&stand.model));
    for r in &readings {
        let own = [r.speed, r.direction].into_iter().chain(r.swings.iter().copied());
        table.push(own.chain([r.most(), fold.unwrap_or(f64::NAN), up.unwrap_or(f64::NAN)]));
    }
    let statistics = json!({
        "analysis": "critical_speed",
        "method": "bifurcation",
        "critical_speed": fold,
        "critical_speed_up": up,
        "scheme": case.run.integrator.name(),
        "step": case.run.integrator.step(),
        "steps": roller.steps(),
        "simulated_s": roller.time(),
    });
    Ok(table.done(Vec::new(), ended, statistics))
}

/// Changes the speed, lets the motion settle, and measures each axle's swing.
fn measure(
    case: &Case,
    roller: &mut Roller<'_>,
    speed: f64,
    steps: &Steps,
    hunting: &Hunting,
    control: &dyn Control,
) -> Result<Vec<f64>> {
    let every = stride(&case.run.integrator, case.run.output_step);
    let change = speed - roller.speed();
    let row = every as f64 * case.run.integrator.step();
    let go = |roller: &mut Roller<'_>, time: f64, track: &mut Vec<Vec<f64>>| -> Result<()> {
        for _ in 0..(time / row).round() as usize {
            if control.stop() {
                return Err(Error::Interrupted);
            }
            roller.advance(every)?;
            track.push(roller.lateral().collect());
        }
        Ok(())
    };
    let mut unread = Vec::new();
    // A whole number of rows, at a rate that arrives exactly.
    let rows = (change.abs() / steps.acceleration / row).ceil();
    if rows > 0.0 {
        roller.accelerate(change / (rows * row));
        go(roller, rows * row, &mut unread)?;
    }
    roller.accelerate(0.0);
    go(roller, steps.settle_s, &mut unread)?;
    let mut rows = Vec::new();
    go(roller, hunting.window_s, &mut rows)?;
    let axles = rows.first().map_or(0, Vec::len);
    Ok((0..axles).map(|a| swing(&rows.iter().map(|r| r[a]).collect::<Vec<_>>())).collect())
}
