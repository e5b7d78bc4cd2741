//! LM5: masses and moments of inertia.

use super::Report;
use super::subject::Subject;

/// Rounding of three printed moments.
const ROUNDING: f64 = 1e-6;
/// Moment about the axle over that about a diameter: 0.1 (bare) to 1 with the rotor geared to it.
const SPIN: [f64; 2] = [0.02, 1.5];
/// Farthest that a centre of mass is off the centre line without being meant, m.
const BESIDE: f64 = 0.01;

pub(super) fn find(subject: &Subject<'_>, report: &mut Report) {
    for thing in &subject.things {
        let [x, y, z] = thing.inertia;
        let key = thing.key.key("inertia");
        if thing.is_wheelset {
            // What turns with the axle by gears counts in its Iyy: no triangle holds for it.
            let ratio = y / x;
            if !(SPIN[0]..=SPIN[1]).contains(&ratio) {
                let found = format!("Iyy = {y} kg m2, {ratio:.3} of Ixx");
                let usual = format!("{} to {} of Ixx, with all that is geared to the axle", SPIN[0], SPIN[1]);
                report.add("LM502", thing.name, key, found, usual);
            }
        } else {
            let triangle = [
                ("Ixx", x, "Iyy + Izz", y + z),
                ("Iyy", y, "Ixx + Izz", x + z),
                ("Izz", z, "Ixx + Iyy", x + y),
            ];
            for (one, size, others, sum) in triangle {
                if size > sum * (1.0 + ROUNDING) {
                    let found = format!("{one} = {size} kg m2, more than {others} = {sum} kg m2");
                    let usual = "each moment at most the sum of the others: so it is for any mass";
                    report.add("LM501", thing.name, key.clone(), found, usual);
                }
            }
        }
        if thing.position[1].abs() > BESIDE && !thing.is_wheelset && !has_mirror(subject, thing.name) {
            let found = format!("y = {:.3} m", thing.position[1]);
            report.add(
                "LM503",
                thing.name,
                thing.key.key("position"),
                found,
                "0 m, or a body on either side",
            );
        }
    }
}

/// Whether a body stands on the other side too.
fn has_mirror(subject: &Subject<'_>, name: &str) -> bool {
    let Some((i, thing)) = subject.thing(name) else { return false };
    let [x, y, z] = thing.position;
    let near = |p: &[f64; 3]| (p[0] - x).abs() + (p[1] + y).abs() + (p[2] - z).abs() < BESIDE;
    subject.things.iter().enumerate().any(|(j, other)| i != j && near(&other.position))
}
