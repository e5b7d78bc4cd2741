//! LM7: stiffness and damping, of each connection and of all between two bodies together.

use std::f64::consts::TAU;

use nalgebra::{Matrix6, Vector6};

use super::Report;
use super::local::{self, Stage};
use super::subject::Subject;
use crate::dynamics::Model;
use crate::error::KeyPath;

/// LMAP 1.4: about the largest eigenvalue that an explicit step of a millisecond or less can follow, rad/s.
pub const FASTEST: f64 = 5000.0;
/// Static deflection, m: more is "extremely soft" (LMAP 1.1 gives no number).
const SOFTEST: f64 = 0.5;
/// Usual static deflection of one stage, m: rubber springs to soft coils.
const DEFLECTION: [f64; 2] = [1e-3, 0.3];
/// A stage slower than this carries nothing that would swing, rad/s.
const SLOWEST: f64 = 1.0;
/// Up to here vehicles are damped by their dampers, Hz: above it a stiff spring beside a damper does not matter.
const DAMPED_BELOW: f64 = 100.0;
/// Share of critical damping above which it is a slip or a lock: good bogies reach 1 and a little more against their own mass.
const OVERDAMPED: f64 = 2.0;
const AXES: [&str; 3] = ["longitudinal", "lateral", "vertical"];

pub(super) fn find(subject: &Subject<'_>, report: &mut Report) {
    let Some(model) = subject.model() else { return };
    stiff(subject, model, report);
    deflections(subject, report);
    let stages = local::stages(model);
    for stage in &stages {
        damped(subject, model, stage, report);
    }
    travel(subject, model, &stages, report);
}

fn stiff(subject: &Subject<'_>, model: &Model, report: &mut Report) {
    let by_name = subject.by_name();
    for link in &model.links {
        let Some(c) = by_name.get(link.name.as_str()) else { continue };
        let fastest = local::fastest(&local::mobility(model, link.a, link.b), &local::stiffness(model, link));
        if fastest > FASTEST {
            let found = format!(
                "{fastest:.0} rad/s of {} against {}",
                model.rigid(link.a).name,
                model.rigid(link.b).name
            );
            let usual = format!("below {FASTEST} rad/s: stiffer than that nothing can be stepped");
            report.add("LM701", &c.name, c.key.clone(), found, usual);
        }
    }
}

fn deflections(subject: &Subject<'_>, report: &mut Report) {
    for spring in local::carriers(subject) {
        let mm = 1e3 * spring.deflection;
        let found = format!("{mm:.1} mm under {:.1} kN", 1e-3 * spring.force.norm());
        if spring.deflection > SOFTEST {
            let usual = format!("below {} mm of static deflection", 1e3 * SOFTEST);
            report.add("LM702", spring.name, spring.key, found, usual);
        } else if spring.deflection < DEFLECTION[0] || spring.deflection > DEFLECTION[1] {
            let usual = format!("{} to {} mm", 1e3 * DEFLECTION[0], 1e3 * DEFLECTION[1]);
            report.add("LM703", spring.name, spring.key, found, usual);
        }
    }
}

/// The place of a stage's first connection.
fn place(subject: &Subject<'_>, stage: &Stage) -> KeyPath {
    let first = stage.links.first().and_then(|name| subject.by_name().get(name.as_str()).copied());
    first.map_or_else(|| KeyPath::of("vehicle.connection"), |c| c.key.clone())
}

fn damped(subject: &Subject<'_>, model: &Model, stage: &Stage, report: &mut Report) {
    let mobility = local::mobility(model, stage.a, stage.b);
    // Forces act where the connections are, not at the first body's centre of mass.
    let turn = stage.centre.cross_matrix();
    let names = format!("{} on {}", model.rigid(stage.a).name, model.rigid(stage.b).name);
    for (i, axis) in AXES.iter().enumerate() {
        let mut along = Vector6::zeros();
        along[i] = 1.0;
        along.fixed_rows_mut::<3>(3).copy_from(&turn.column(i));
        let (k, c, w) = (stage.stiffness[(i, i)], stage.damping[(i, i)], along.dot(&(mobility * along)));
        let omega = (k * w).max(0.0).sqrt();
        if omega < SLOWEST {
            continue;
        }
        let ratio = c * w / (2.0 * omega);
        let hz = omega / TAU;
        if c <= 0.0 && !stage.remembers {
            let found = format!("{axis} stiffness of {hz:.1} Hz and no damping");
            report.add("LM704", format!("{names}, {axis}"), place(subject, stage), found, "some damping");
        } else if ratio > OVERDAMPED {
            let found = format!("{:.0} % of the critical damping, {axis} at {hz:.1} Hz", 100.0 * ratio);
            report.add("LM705", format!("{names}, {axis}"), place(subject, stage), found, "5 to 60 %");
        }
    }
}

fn travel(subject: &Subject<'_>, model: &Model, stages: &[Stage], report: &mut Report) {
    let by_name = subject.by_name();
    for link in &model.links {
        let Some(c) = by_name.get(link.name.as_str()) else { continue };
        let Some(stage) = stages.iter().find(|s| s.links.contains(&link.name)) else { continue };
        // Rubber damps beside its own stiffness, as it does: only what damps alone is a damper.
        if local::stiffness(model, link).amax() > 0.0 {
            continue;
        }
        let turn = local::turned(model, link);
        let own = turn.transpose() * local::damping(model, link) * turn;
        for i in (0..3).filter(|i| own[(*i, *i)] > 0.0) {
            let along: Vector6<f64> = own.column(i) / own[(i, i)];
            let along = along / along.fixed_rows::<3>(0).norm();
            let damping = own.fixed_view::<3, 3>(0, 0).trace().max(own[(i, i)]);
            let corner = held_by(&stage.stiffness, &along) / damping / TAU;
            if corner > DAMPED_BELOW {
                let found = format!("what stands beside it is stiffer up to {corner:.0} Hz");
                let usual = format!("below {DAMPED_BELOW} Hz: at lower ones the damper does nothing");
                report.add("LM706", &c.name, c.key.clone(), found, usual);
                break;
            }
        }
    }
}

/// Stiffness that holds a direction still when all others are free to give, N/m.
fn held_by(stiffness: &Matrix6<f64>, along: &Vector6<f64>) -> f64 {
    let free = stiffness + Matrix6::identity(); // 1 N/m: a direction that nothing holds
    free.lu().solve(along).map_or(0.0, |give| 1.0 / along.dot(&give).abs().max(1e-15))
}
