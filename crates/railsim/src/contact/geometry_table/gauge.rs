//! Whether a wheelset fits between the rails: neither wedged nor falling in.

use super::Placement;
use crate::contact::profile::Profile;
use crate::error::{Fault, KeyPath};

/// Least steepness of what counts as a flange: 30 degrees. A cone that reaches the gauge's depth guides nothing.
const FLANGE_SLOPE: f64 = 0.577;

/// y of the flange face at the depth at which the gauge is measured, m from the running circle; `None` of a wheel without a flange that deep.
pub(super) fn flange(wheel: &Profile, depth: f64) -> Option<f64> {
    wheel
        .points
        .windows(2)
        .filter(|w| w[0][0] < 0.0 && (w[0][1] - depth) * (w[1][1] - depth) <= 0.0)
        .filter(|w| (w[1][1] - w[0][1]).abs() > FLANGE_SLOPE * (w[1][0] - w[0][0]).abs())
        .map(|w| w[0][0] + (w[1][0] - w[0][0]) * (depth - w[0][1]) / (w[1][1] - w[0][1]))
        .reduce(f64::max)
}

/// Adds a fault where the flanges do not fit between the rails, or where with one flange on its rail the other wheel's rim ends within
/// the gauge: that wheel has nothing under it.
///
/// The flange is taken at the depth at which the gauge is measured, the wheelset level. A wheel without a flange that deep is not
/// judged: nothing stops its shift.
pub(super) fn faults(wheel: &Profile, p: &Placement, faults: &mut Vec<Fault>) {
    let rim = wheel.points.iter().map(|point| point[0]).fold(f64::NEG_INFINITY, f64::max);
    let Some(flange) = flange(wheel, p.gauge_point_depth) else { return };
    let least = 2.0 * (p.tape_half_distance + flange);
    let most = 2.0 * p.tape_half_distance + flange + rim;
    let found = if p.gauge < least {
        format!("{} m: the flanges stand {:.1} mm too far apart for it", p.gauge, 1e3 * (least - p.gauge))
    } else if p.gauge > most {
        format!(
            "{} m: with one flange on its rail the other wheel's rim ends {:.1} mm within the gauge, the wheelset falls in",
            p.gauge,
            1e3 * (p.gauge - most)
        )
    } else {
        return;
    };
    let allowed = format!(
        "{least:.4} to {most:.4} m for these wheels, {} m between running circles",
        2.0 * p.tape_half_distance
    );
    faults.push(Fault::new(KeyPath::of("track.gauge"), found, allowed));
}
