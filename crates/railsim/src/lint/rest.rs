//! LM8: the vehicle on its wheels, at rest on straight track.

use super::Report;
use super::subject::{Rest, Subject};
use crate::body::{Pose, Relative};
use crate::connection::Law;
use crate::dynamics::Model;
use crate::error::KeyPath;
use crate::math::rotation;

/// Wheels of one axle may differ by this share of their mean (LMAP 2B.1: 4 to 5 %)...
const WHEELS: f64 = 0.04;
/// ...and axles by this (LMAP 2B.1: 2 %).
const AXLES: f64 = 0.02;
/// Axle loads, t: light railcars to heavy haul with an excess.
const AXLE_LOAD: [f64; 2] = [1.5, 45.0];
/// Growth at rest beyond rounding, 1/s.
const GROWS: f64 = 0.05;

pub(super) fn find(subject: &Subject<'_>, report: &mut Report) {
    match (&subject.rest, subject.model()) {
        (Some(Ok(rest)), Some(model)) => {
            loads(subject, model, rest, report);
            stops(subject, model, rest, report);
            falling(model, rest, report);
        }
        (Some(Err(error)), _) => {
            let usual = "a vehicle that finds its balance on straight track";
            report.add("LM801", "", KeyPath::of("vehicle"), error.to_string(), usual);
        }
        _ => {}
    }
}

fn loads(subject: &Subject<'_>, model: &Model, rest: &Rest, report: &mut Report) {
    let sets = &subject.case.vehicle.wheelsets;
    let mean = rest.loads.iter().flatten().sum::<f64>() / (2 * sets.len().max(1)) as f64;
    for (w, [left, right]) in sets.iter().zip(&rest.loads) {
        let axle = left + right;
        let kn = |n: f64| format!("{:.1} kN", 1e-3 * n);
        if left.min(*right) <= 0.0 {
            let side = if left < right { "left" } else { "right" };
            let found = format!("0 kN on the {side}, {} on the other side", kn(left.max(*right)));
            report.add("LM804", &w.name, w.key.clone(), found, format!("about {}", kn(mean)));
        } else if (left - right).abs() > WHEELS * axle {
            let found = format!(
                "{} left, {} right ({:.1} % of their mean off it)",
                kn(*left),
                kn(*right),
                100.0 * (left - right).abs() / axle
            );
            report.add("LM802", &w.name, w.key.clone(), found, format!("within {} %", 100.0 * WHEELS));
        }
        if (axle - 2.0 * mean).abs() > AXLES * 2.0 * mean {
            let found = format!(
                "{} of {} in the mean ({:+.1} %)",
                kn(axle),
                kn(2.0 * mean),
                100.0 * (axle / (2.0 * mean) - 1.0)
            );
            report.add("LM803", &w.name, w.key.clone(), found, format!("within {} %", 100.0 * AXLES));
        }
    }
    let tonnes = 2e-3 * mean / model.gravity;
    if !sets.is_empty() && !(AXLE_LOAD[0]..=AXLE_LOAD[1]).contains(&tonnes) {
        let usual = format!("{} to {} t", AXLE_LOAD[0], AXLE_LOAD[1]);
        let found = format!("{tonnes:.2} t on each axle");
        report.add("LM807", &subject.case.vehicle.name, KeyPath::of("vehicle"), found, usual);
    }
}

/// Bodies where they stand, as connections see them; an axle box does not turn with the axle.
fn pose(model: &Model, x: &[f64], i: usize) -> Pose {
    let q = &x[model.map().q(i)];
    let place = crate::math::Vec3::new(q[0], q[1], q[2]);
    let turned = rotation::rot_z(q[5]) * rotation::rot_x(q[3]);
    let pitch = if i < model.bodies.len() { rotation::rot_y(q[4]) } else { crate::math::Mat3::identity() };
    Pose { R: turned * pitch, ..Pose::at(place) }
}

fn stops(subject: &Subject<'_>, model: &Model, rest: &Rest, report: &mut Report) {
    let by_name = subject.by_name();
    for link in model.links.iter().filter(|l| matches!(l.law, Law::BumpStop(_))) {
        let Some(c) = by_name.get(link.name.as_str()) else { continue };
        let motion = Relative::between(&pose(model, &rest.x, link.a), &pose(model, &rest.x, link.b));
        let force = link.wrench(&motion, &rest.x).f.norm();
        if force > 0.0 {
            let found = format!("{:.2} kN at rest", 1e-3 * force);
            let usual = "a clearance that is open at rest";
            report.add("LM806", &c.name, c.key.key("clearance"), found, usual);
        }
    }
}

fn falling(model: &Model, rest: &Rest, report: &mut Report) {
    let worst = rest.modes.iter().max_by(|a, b| a.eigenvalue.re.total_cmp(&b.eigenvalue.re));
    if let Some(mode) = worst.filter(|m| m.eigenvalue.re > GROWS) {
        let found = format!("{} that grows at {:.2} 1/s", mode.name, mode.eigenvalue.re);
        let usual = "a balance that comes back: springs wide enough for the height above them";
        let name = model.rigid(model.reference()).name.clone();
        report.add("LM808", name, KeyPath::of("vehicle"), found, usual);
    }
}
