//! The speed above which a vehicle hunts, three ways: where small disturbances begin to grow (`linear`), where hunting ends when a
//! vehicle that hunts is slowed down (`ramp_down`), and the limit cycles in between (`bifurcation`).

mod bifurcation;
mod linear;
mod ramp_down;
mod roller;

use crate::analysis::Stand;
use crate::dynamics::coordinate;
use crate::error::{Error, Fault, KeyPath, Result};
use crate::run::{Control, Outcome};
use crate::schema::Case;
use crate::schema::run::Search;

/// Runs a case of kind `critical_speed`.
///
/// # Errors
/// Faults of the case, no balance at the start, a step beyond the scheme's stability limit.
pub fn run(case: &Case, control: &dyn Control) -> Result<Outcome> {
    match search(case)? {
        Search::Linear { range, spacing } => linear::run(case, *range, *spacing, control),
        Search::RampDown { end_speed, deceleration, hunting } => {
            ramp_down::run(case, *end_speed, *deceleration, hunting, control)
        }
        Search::Bifurcation { end_speed, speed_step, acceleration, settle_s, hunting } => {
            let steps = bifurcation::Steps {
                end_speed: *end_speed,
                speed_step: *speed_step,
                acceleration: *acceleration,
                settle_s: *settle_s,
            };
            bifurcation::run(case, &steps, hunting, control)
        }
    }
}

/// Names of all columns.
///
/// # Errors
/// Faults of the case.
pub fn columns(case: &Case) -> Result<Vec<String>> {
    let stand = Stand::new(case)?;
    let search = search(case)?;
    if !matches!(search, Search::Linear { .. }) {
        coordinate::disturbance(&stand.model, &case.run.disturbance)?;
        roller::on_straight_track(&stand.model)?;
    }
    Ok(match search {
        Search::Linear { .. } => linear::names(),
        Search::RampDown { .. } => ramp_down::names(&stand.model),
        Search::Bifurcation { .. } => bifurcation::names(&stand.model),
    })
}

fn search(case: &Case) -> Result<&Search> {
    case.run.search.as_ref().ok_or_else(|| {
        Error::input(Fault::new(KeyPath::of("run.search"), "nothing", "how the critical speed is found"))
    })
}
