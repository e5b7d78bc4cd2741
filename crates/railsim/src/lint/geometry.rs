//! LM3: where things are.

use super::Report;
use super::subject::Subject;
use crate::connection::along::APART;
use crate::connection::{Along, Law};
use crate::math::Vec3;
use crate::schema::Connection;

/// An element longer than this many times the median of its kind is called long (LMAP 1.1 gives no number)...
const LONG: f64 = 3.0;
/// ...or than this, m: nothing within a vehicle is.
const LONGEST: f64 = 6.0;
/// Tape circle distance less gauge, m: 0.06 to 0.07 on every gauge, since it measures rail heads.
const TAPE_OVER_GAUGE: [f64; 2] = [0.02, 0.12];
/// Largest offset of a wheelset from the track's centre line, m: less than the flangeway.
const OFF_TRACK: f64 = 0.005;

pub(super) fn find(subject: &Subject<'_>, report: &mut Report) {
    lengths(subject, report);
    ends(subject, report);
    sensors(subject, report);
    wheels(subject, report);
    heights(subject, report);
}

fn length(c: &Connection) -> f64 {
    (Vec3::from(c.points[1]) - Vec3::from(c.points[0])).norm()
}

fn acts_along_its_line(law: &Law) -> bool {
    let line = |along: Along| along == Along::Line;
    match law {
        Law::PointSpring(law) => line(law.along),
        Law::PointDamper(law) => line(law.along),
        Law::Maxwell(law) => line(law.along),
        Law::Friction(law) => line(law.along),
        Law::BumpStop(law) => line(law.along),
        Law::TractionRod(_) | Law::Coupler(_) => true,
        _ => false,
    }
}

fn lengths(subject: &Subject<'_>, report: &mut Report) {
    for c in subject.connections() {
        let own = length(c);
        if acts_along_its_line(&c.law) && own < APART {
            let found = format!("a `{}` of {:.1} mm", c.law.kind(), 1e3 * own);
            let usual = "`positions` apart, or `along` an axis";
            report.add("LM301", &c.name, c.key.clone(), found, usual);
        }
        let mut same: Vec<f64> = subject
            .connections()
            .iter()
            .filter(|o| o.law.kind() == c.law.kind())
            .map(length)
            .filter(|l| *l > APART)
            .collect();
        same.sort_by(f64::total_cmp);
        let median = same.get(same.len() / 2).copied().unwrap_or(0.0);
        if own > LONGEST || (same.len() > 2 && own > LONG * median && own > 0.5) {
            let found = format!("{own:.2} m");
            let usual = format!("below {LONG} times the median of its kind, {median:.2} m, and {LONGEST} m");
            report.add("LM302", &c.name, c.key.clone(), found, usual);
        }
    }
}

/// Bodies whose moments can be read as a size: not those that are led, whose mass means nothing.
fn ends(subject: &Subject<'_>, report: &mut Report) {
    for c in subject.connections() {
        for (name, point) in c.between.iter().zip(&c.points) {
            let Some((_, thing)) = subject.thing(name).filter(|(_, t)| !t.guided) else { continue };
            let beyond = thing.beyond(point);
            if beyond > 0.0 {
                let [x, y, z] = thing.half_box().map(|half| 2.0 * half);
                let [px, py, pz] = [0, 1, 2].map(|i| point[i] - thing.position[i]);
                let found = format!("an end at ({px:.2}, {py:.2}, {pz:.2}) m from the centre of {name}");
                let usual = format!(
                    "within the body, which by its moments is {x:.1} x {y:.1} x {z:.1} m, or near it"
                );
                report.add("LM303", &c.name, c.key.clone(), found, usual);
            }
        }
    }
}

fn sensors(subject: &Subject<'_>, report: &mut Report) {
    for sensor in &subject.case.vehicle.sensors {
        let Some((_, thing)) = subject.thing(&sensor.body).filter(|(_, t)| !t.guided) else { continue };
        let beyond = thing.beyond(&sensor.position);
        if beyond > 0.0 {
            let [x, y, z] = thing.half_box().map(|half| 2.0 * half);
            let [px, py, pz] = [0, 1, 2].map(|i| sensor.position[i] - thing.position[i]);
            let found = format!("({px:.2}, {py:.2}, {pz:.2}) m from the centre of {}", sensor.body);
            let usual =
                format!("within the body, which by its moments is {x:.1} x {y:.1} x {z:.1} m, or near it");
            report.add("LM304", &sensor.name, sensor.key.clone(), found, usual);
        }
    }
}

fn wheels(subject: &Subject<'_>, report: &mut Report) {
    let gauge = subject.case.track.gauge;
    let sets = &subject.case.vehicle.wheelsets;
    for (i, w) in sets.iter().enumerate() {
        let over = 2.0 * w.tape_half_distance - gauge;
        if !(TAPE_OVER_GAUGE[0]..=TAPE_OVER_GAUGE[1]).contains(&over) {
            let found = format!(
                "tape circles {:.3} m apart on a gauge of {gauge} m ({over:+.3} m)",
                2.0 * w.tape_half_distance
            );
            let usual = "the gauge and 0.06 to 0.07 m: the distance of the rail heads' centres";
            report.add("LM305", &w.name, w.key.key("tape_half_distance"), found, usual);
        }
        if w.position[1].abs() > OFF_TRACK {
            let found = format!("y = {:.3} m", w.position[1]);
            report.add("LM305", &w.name, w.key.key("position"), found, "0 m: centred on the track");
        }
        for other in &sets[..i] {
            let apart = (w.position[0] - other.position[0]).abs();
            if apart < w.radius + other.radius {
                let found = format!("{apart:.3} m from {}", other.name);
                let usual = format!("more than the wheels' radii together, {:.3} m", w.radius + other.radius);
                report.add("LM306", &w.name, w.key.key("position"), found, usual);
            }
        }
    }
}

fn heights(subject: &Subject<'_>, report: &mut Report) {
    for body in &subject.case.vehicle.bodies {
        if body.position[2] >= 0.0 {
            let found = format!("z = {} m", body.position[2]);
            let key = body.key.key("position").index(2);
            report.add("LM307", &body.name, key, found, "below 0: z points down from the top of rail");
        }
    }
}
