//! LM4: numbers that look wrong by a factor of 1000.
//!
//! A body's mass, moments and the span of what is fixed to it hang together: the radius of gyration is of the span's order, the mass is
//! some hundred kilograms per cubed metre of span. A factor of 1000 in mass or moments shifts these by 1000 or by its root.

use super::Report;
use super::local;
use super::subject::{Subject, Thing};
use crate::math::Vec3;

/// Mass over the cube of the span, kg/m3: 170 (light frame) to 2500 (wheelset) in the models that ship.
const DENSITY: [f64; 2] = [4.0, 2e5];
/// Radius of gyration over the span: 0.1 to 1 in the models that ship.
const GYRATION: [f64; 2] = [0.04, 6.0];
/// Smallest span that counts, m.
const LEAST_SPAN: f64 = 0.5;
/// No coordinate of a vehicle is larger, m.
const FARTHEST: f64 = 100.0;
/// No wheel, tape distance or height is larger, m.
const LARGEST: f64 = 10.0;
/// Steel with a generous margin, Pa.
const MODULUS: [f64; 2] = [1e10, 1e12];
/// Wheel radius, m: low-floor wagons to steam locomotives.
const RADIUS: [f64; 2] = [0.15, 1.2];
/// Design speed, km/h.
const SPEED: [f64; 2] = [5.0, 450.0];
/// Static deflections that only a slip of unit explains, m.
const DEFLECTION: [f64; 2] = [5e-5, 5.0];

pub(super) fn find(subject: &Subject<'_>, report: &mut Report) {
    lengths(subject, report);
    if !report.any("LM404") {
        masses(subject, report);
    }
    stiffness(subject, report);
    material(subject, report);
    radius(subject, report);
    speed(subject, report);
}

fn lengths(subject: &Subject<'_>, report: &mut Report) {
    let v = &subject.case.vehicle;
    let usual = "metres";
    let far = |p: &[f64; 3]| p.iter().copied().find(|x| x.abs() > FARTHEST);
    for t in &subject.things {
        if let Some(x) = far(&t.position) {
            report.add("LM404", t.name, t.key.key("position"), format!("{x} m"), usual);
        }
    }
    for w in &v.wheelsets {
        for (key, value) in [("radius", w.radius), ("tape_half_distance", w.tape_half_distance)] {
            if value > LARGEST {
                report.add("LM404", &w.name, w.key.key(key), format!("{value} m"), usual);
            }
        }
    }
    for c in &v.connections {
        if let Some(x) = c.points.iter().find_map(far) {
            report.add("LM404", &c.name, c.key.clone(), format!("a coordinate of {x} m"), usual);
        }
    }
    for s in &v.sensors {
        if let Some(x) = far(&s.position) {
            report.add("LM404", &s.name, s.key.key("position"), format!("{x} m"), usual);
        }
    }
}

/// Farthest point that is fixed to a body from its centre of mass, m; of a wheelset at least its wheels.
fn span(subject: &Subject<'_>, thing: &Thing<'_>) -> f64 {
    let ends = subject.connections().iter().flat_map(|c| c.between.iter().zip(&c.points));
    let own = ends.filter(|(name, _)| *name == thing.name);
    let far = |p: &[f64; 3]| (Vec3::from(*p) - Vec3::from(thing.position)).norm();
    let farthest = own.map(|(_, p)| far(p)).fold(LEAST_SPAN, f64::max);
    let wheel = subject.case.vehicle.wheelsets.iter().find(|w| w.name == thing.name);
    wheel.map_or(farthest, |w| farthest.max(w.tape_half_distance))
}

fn masses(subject: &Subject<'_>, report: &mut Report) {
    for thing in subject.things.iter().filter(|t| !t.guided) {
        let span = span(subject, thing);
        let density = thing.mass / span.powi(3);
        let largest = thing.inertia.iter().fold(0.0, |a: f64, b| a.max(*b));
        let gyration = (largest / thing.mass).sqrt();
        if !(DENSITY[0]..=DENSITY[1]).contains(&density) {
            let found = format!("{} kg on a body that reaches {span:.2} m", thing.mass);
            let usual = "kilograms: some hundred for each cubed metre of reach";
            report.add("LM401", thing.name, thing.key.key("mass"), found, usual);
        } else if gyration < GYRATION[0] * span || gyration > GYRATION[1] * span {
            let found = format!("a radius of gyration of {gyration:.3} m on a body that reaches {span:.2} m");
            let usual = "kg m2: a radius of gyration of a third to all of the reach";
            report.add("LM402", thing.name, thing.key.key("inertia"), found, usual);
        }
    }
}

fn stiffness(subject: &Subject<'_>, report: &mut Report) {
    for spring in local::carriers(subject) {
        if spring.deflection > DEFLECTION[1] || spring.deflection < DEFLECTION[0] {
            let found = format!(
                "{:.4} m of static deflection under {:.1} kN",
                spring.deflection,
                1e-3 * spring.force.norm()
            );
            let usual = "N/m: some ten to two hundred millimetres";
            report.add("LM403", spring.name, spring.key, found, usual);
        }
    }
}

fn material(subject: &Subject<'_>, report: &mut Report) {
    let modulus = subject.case.vehicle.contact.youngs_modulus;
    if !(MODULUS[0]..=MODULUS[1]).contains(&modulus) {
        let key = crate::error::KeyPath::of("vehicle.contact.youngs_modulus");
        report.add("LM405", "contact", key, format!("{modulus:e} Pa"), "2.1e11 Pa for steel");
    }
}

fn radius(subject: &Subject<'_>, report: &mut Report) {
    for w in &subject.case.vehicle.wheelsets {
        if w.radius < RADIUS[0] || w.radius > RADIUS[1] {
            let usual = format!("{} to {} m", RADIUS[0], RADIUS[1]);
            report.add("LM406", &w.name, w.key.key("radius"), format!("{} m", w.radius), usual);
        }
    }
}

fn speed(subject: &Subject<'_>, report: &mut Report) {
    let kmh = 3.6 * subject.case.vehicle.design_speed;
    if !(SPEED[0]..=SPEED[1]).contains(&kmh) {
        let key = crate::error::KeyPath::of("vehicle.design_speed_kmh");
        let usual = format!("{} to {} km/h", SPEED[0], SPEED[1]);
        report.add("LM407", &subject.case.vehicle.name, key, format!("{kmh:.4} km/h"), usual);
    }
}
