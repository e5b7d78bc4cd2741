//! LM6: left and right, front and rear. Vehicles are built symmetric; what differs is meant, or a slip.

use super::Report;
use super::subject::{Subject, Thing};
use crate::connection::Law;
use crate::math::Vec3;
use crate::schema::Connection;

/// Points that are nearer than this are the same, m.
const SAME: f64 = 1e-3;
/// Masses and moments that differ by a smaller share are the same.
const EQUAL: f64 = 1e-3;

/// The plane of a mirror: `coordinate = middle`.
#[derive(Clone, Copy)]
struct Mirror {
    axis: usize,
    middle: f64,
}

impl Mirror {
    fn image(self, p: &[f64; 3]) -> Vec3 {
        let mut image = Vec3::from(*p);
        image[self.axis] = 2.0 * self.middle - p[self.axis];
        image
    }

    fn is_in(self, p: &[f64; 3]) -> bool {
        (p[self.axis] - self.middle).abs() < SAME
    }

    /// The body where the image of one is.
    fn body<'s, 'c>(self, subject: &'s Subject<'c>, thing: &Thing<'_>) -> Option<&'s Thing<'c>> {
        let image = self.image(&thing.position);
        let near = |t: &&Thing<'_>| {
            t.is_wheelset == thing.is_wheelset && (Vec3::from(t.position) - image).norm() < SAME
        };
        subject.things.iter().find(near)
    }

    /// The name of the body where the image of a named one is; its own where there is none.
    fn name<'c>(self, subject: &Subject<'c>, name: &'c str) -> &'c str {
        let own = subject.thing(name).map(|(_, t)| *t);
        own.and_then(|t| self.body(subject, &t)).map_or(name, |t| t.name)
    }
}

pub(super) fn find(subject: &Subject<'_>, report: &mut Report) {
    let sides = Mirror { axis: 1, middle: 0.0 };
    for c in subject.connections() {
        match partner(subject, c, sides) {
            Partner::Own | Partner::Equal => {}
            Partner::Other(other) => {
                let found = format!("a `{}` that differs from {other}", c.law.kind());
                report.add("LM602", &c.name, c.key.clone(), found, "the same numbers left and right");
            }
            Partner::None => {
                let found = format!("a `{}` at y = {:.3} m alone", c.law.kind(), c.points[0][1]);
                report.add("LM601", &c.name, c.key.clone(), found, "one at -y too: `mirror = true`");
            }
        }
    }
    ends(subject, report);
}

fn ends(subject: &Subject<'_>, report: &mut Report) {
    let sets = &subject.case.vehicle.wheelsets;
    if sets.is_empty() {
        return;
    }
    let middle = sets.iter().map(|w| w.position[0]).sum::<f64>() / sets.len() as f64;
    let along = Mirror { axis: 0, middle };
    for thing in subject.things.iter().filter(|t| !t.guided) {
        match along.body(subject, thing) {
            None => {
                let found = format!("x = {:.3} m, and none at {:.3} m", thing.position[0], {
                    along.image(&thing.position).x
                });
                let usual = "bodies at equal distances before and behind the wheelsets' middle";
                report.add("LM603", thing.name, thing.key.key("position"), found, usual);
            }
            Some(other) => {
                let differs = |a: f64, b: f64| (a - b).abs() > EQUAL * a.max(b);
                if differs(thing.mass, other.mass) {
                    let found = format!("{} kg, and {} kg of {}", thing.mass, other.mass, other.name);
                    report.add("LM603", thing.name, thing.key.key("mass"), found, "the same at both ends");
                }
                if (0..3).any(|i| differs(thing.inertia[i], other.inertia[i])) {
                    let found = format!("moments other than those of {}", other.name);
                    report.add("LM603", thing.name, thing.key.key("inertia"), found, "the same at both ends");
                }
            }
        }
    }
    for c in subject.connections() {
        let found = match partner(subject, c, along) {
            Partner::Own | Partner::Equal => continue,
            Partner::Other(other) => format!("a `{}` that differs from {other}", c.law.kind()),
            Partner::None => format!("a `{}` at x = {:.3} m alone", c.law.kind(), c.points[0][0]),
        };
        report.add("LM604", &c.name, c.key.clone(), found, "its like at the other end of the vehicle");
    }
}

/// What stands where a connection's image is.
enum Partner<'c> {
    /// Itself.
    Own,
    Equal,
    /// One with other numbers.
    Other(&'c str),
    None,
}

fn partner<'c>(subject: &Subject<'c>, c: &'c Connection, mirror: Mirror) -> Partner<'c> {
    if c.points.iter().all(|p| mirror.is_in(p)) {
        return Partner::Own;
    }
    let images = [0, 1].map(|i| mirror.image(&c.points[i]));
    let names = [0, 1].map(|i| mirror.name(subject, &c.between[i]));
    let near = |p: &Vec3, q: &[f64; 3]| (p - Vec3::from(*q)).norm() < SAME;
    let place = |o: &Connection, i: usize, j: usize| {
        near(&images[0], &o.points[i])
            && near(&images[1], &o.points[j])
            && names[0] == o.between[i]
            && names[1] == o.between[j]
    };
    let mut other = None;
    for o in subject.connections() {
        if o.law.kind() == c.law.kind() && (place(o, 0, 1) || place(o, 1, 0)) {
            // Coupled matrices change signs from one side to the other: their places are compared, not their numbers.
            if o.law == c.law || matches!(c.law, Law::BushingMatrix(_)) {
                return Partner::Equal;
            }
            other = Some(o.name.as_str());
        }
    }
    other.map_or(Partner::None, Partner::Other)
}
