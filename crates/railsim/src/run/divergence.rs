//! Seeing that a run has left what the model describes: after every step, before anything is recorded.

use crate::body::coordinate;
use crate::dynamics::VehicleSystem;
use crate::error::Error;
use crate::integrator::StepEnd;

/// Farther than this from the design position (m) a body is not on this track any more.
pub const FARTHEST: f64 = 1.0;
/// Farther than this (m) no track gives way.
pub const FARTHEST_TRACK: f64 = 0.1;
/// Larger angles (rad) than this: rolled over or turned across.
pub const STEEPEST: f64 = 0.6;
/// A wheel force beyond this many static ones is a blow-up of the integration, not physics.
pub const LARGEST_LOAD: f64 = 100.0;

/// Whether a step came to its end, at time `t` and state `x`.
///
/// # Errors
/// [`Error::Diverged`] with the wheelset whose implicit step has no solution, or the body whose motion control could not
/// follow.
pub fn stepped(system: &VehicleSystem<'_>, end: StepEnd, t: f64, x: &[f64]) -> Result<(), Error> {
    let model = system.model;
    let map = model.map();
    let (body, cause) = match end {
        StepEnd::Done => return Ok(()),
        StepEnd::Singular { block } => (
            model.wheelsets[block].body.name.clone(),
            "the implicit step has no solution: a number that is not finite in wheel and track".to_owned(),
        ),
        StepEnd::OverTolerance { element } => (
            map.owner(element).map_or_else(|| "a connection".to_owned(), |i| model.rigid(i).name.clone()),
            "the local error of the shortest step that step control may take is over tolerance: \
             allow more (run.integrator.tolerance) or more halvings (run.integrator.halvings)"
                .to_owned(),
        ),
    };
    Err(Error::Diverged { t, s: model.place(x), body, cause })
}

/// Checks the state after a step.
///
/// # Errors
/// [`Error::Diverged`] with time, place, body and likely cause.
pub fn check(system: &mut VehicleSystem<'_>, t: f64, x: &[f64]) -> Result<(), Error> {
    let model = system.model;
    let map = model.map();
    let s = model.place(x);
    let diverged = |body: String, cause: String| Err(Error::Diverged { t, s, body, cause });
    for i in 0..model.count() {
        let body = model.rigid(i);
        let (q, u) = (&x[map.q(i)], &x[map.u(i)]);
        if q.iter().chain(u).any(|v| !v.is_finite()) {
            return diverged(
                body.name.clone(),
                "a number that is not finite: the integration left its stability limit; take a smaller step"
                    .into(),
            );
        }
        let away = (q[coordinate::Y] - body.position.y).abs().max((q[coordinate::Z] - body.position.z).abs());
        if away > FARTHEST {
            return diverged(
                body.name.clone(),
                format!("{away:.2} m away from its design position (limit {FARTHEST} m)"),
            );
        }
        // A wheelset's pitch is its turned angle.
        let pitch = if i < model.bodies.len() { q[coordinate::THETA].abs() } else { 0.0 };
        let turned = q[coordinate::PHI].abs().max(q[coordinate::PSI].abs()).max(pitch);
        if turned > STEEPEST {
            return diverged(body.name.clone(), format!("turned by {turned:.2} rad (limit {STEEPEST} rad)"));
        }
    }
    for (w, set) in model.wheelsets.iter().enumerate() {
        let (q, u) = (&x[map.track_q(w)], &x[map.track_u(w)]);
        let body = || format!("track under {}", set.body.name);
        if q.iter().chain(u).any(|v| !v.is_finite()) {
            return diverged(
                body(),
                "a number that is not finite: the integration left its stability limit; take a smaller step"
                    .into(),
            );
        }
        let away = q[0].abs().max(q[1].abs());
        if away > FARTHEST_TRACK {
            return diverged(
                body(),
                format!("{away:.2} m away from where it lies (limit {FARTHEST_TRACK} m)"),
            );
        }
    }
    if let Some(left) = system.scratch.left_rail.take() {
        let side = if left.side > 0.0 { "right" } else { "left" };
        return diverged(
            model.wheelsets[left.wheelset].body.name.clone(),
            format!(
                "derailment: the {side} wheel left the contact table, shifted outward by {:.1} mm and rolled by {:.1} mrad on its rail",
                1e3 * left.shift,
                1e3 * left.roll
            ),
        );
    }
    let limit = LARGEST_LOAD * model.mass() * model.gravity;
    for (set, wheels) in model.wheelsets.iter().zip(&system.scratch.wheels) {
        if let Some(wheel) = wheels.iter().find(|w| w.Q.abs() > limit / (2.0 * model.wheelsets.len() as f64))
        {
            return diverged(
                set.body.name.clone(),
                format!(
                    "wheel force {:.0} kN, over {LARGEST_LOAD} static wheel loads: the integration blew up",
                    wheel.Q / 1e3
                ),
            );
        }
    }
    Ok(())
}
