//! The air brake by itself: pressures and block forces over time, nothing moving.

use super::Table;
use crate::equipment::air_brake::Pneumatics;
use crate::equipment::train::Wagons;
use crate::error::{Error, Fault, KeyPath, Result};
use crate::run::{Control, Ended, Outcome};
use crate::schema::Case;

const COLUMNS: [&str; 6] = ["t", "s", "brake.pipe", "brake.reservoir", "brake.cylinder", "brake.block_force"];
/// Of the last wagon, where there is a train.
const REAR: [&str; 2] = ["train.rear.pipe", "train.rear.cylinder"];

/// Names of the columns.
pub(super) fn columns(case: &Case) -> Vec<String> {
    let rear = if case.run.train.is_some() { &REAR[..] } else { &[] };
    COLUMNS.iter().chain(rear).map(|name| (*name).to_owned()).collect()
}

/// Steps the brake through `run.drive.until.time`.
pub(super) fn run(case: &Case, control: &dyn Control) -> Result<Outcome> {
    let (Some(drive), Some(data)) = (&case.run.drive, &case.vehicle.air_brake) else {
        let found = "nothing";
        return Err(Error::input(Fault::new(
            KeyPath::of("vehicle.air_brake"),
            found,
            "the data of an air brake",
        )));
    };
    let period = drive.period;
    let every = (case.run.output_step / period).round().max(1.0) as u64;
    let end = drive.until.time.unwrap_or_default();
    let mut own = Pneumatics::new(data, 0.0, drive, true);
    let mut rear = case.run.train.as_ref().map(|train| {
        let vehicle = case.vehicle.outline.as_ref().map_or(0.0, |o| o.length_over_couplers);
        let train = Wagons::new(train.clone(), case.run.gravity);
        Pneumatics::new(data, train.pipe_length(vehicle, train.masses.len() - 1), drive, false)
    });
    let mut table = Table::new(columns(case));
    let mut step: u64 = 0;
    loop {
        let t = step as f64 * period;
        if step.is_multiple_of(every) {
            let first = [t, 0.0, own.pipe, own.reservoir, own.cylinder, own.block_force(data)];
            let last = rear.iter().flat_map(|r| [r.pipe, r.cylinder]);
            table.push(first.into_iter().chain(last));
            control.progress(t, 0.0, t / end);
            if control.stop() {
                return Err(Error::Interrupted);
            }
        }
        if t >= end - 1e-9 {
            break;
        }
        step += 1;
        let t = step as f64 * period;
        own.pass(data, drive, drive.independent_brake.at(t), t, period);
        if let Some(rear) = &mut rear {
            rear.pass(data, drive, 0.0, t, period);
        }
    }
    Ok(table.done(Vec::new(), Ended::Complete, serde_json::json!({ "samples": step })))
}
