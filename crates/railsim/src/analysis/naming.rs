//! What a mode is called: by which bodies have most of its kinetic energy, and in which direction.
//!
//! The car body is the heaviest body; bogies are the others that a connection ties to a wheelset. Sway of the car body is
//! *lower* where it turns about a point below its centre of mass and *upper* where that point is above. *Hunting* is a
//! lateral motion in which the axles run where they point (their lateral sliding speed is small beside their lateral speed)
//! and move at least half as far as the car body above them.

use nalgebra::Complex;

use crate::analysis::modal::{Mode, RIGID};
use crate::body::coordinate::{PHI, PSI, THETA, Y};
use crate::dynamics::Model;

/// Members of a group with less than this share of the most moved one's energy are not named.
const NOTED: f64 = 0.25;
/// Largest square of sliding over lateral speed of axles that run where they point.
const FOLLOWING: f64 = 0.25;

/// Words for x, y, z, phi, theta, psi.
const WORDS: [&str; 6] = ["longitudinal", "lateral", "bounce", "roll", "pitch", "yaw"];

/// Kinetic energy of one member of a group in each direction, and its phase there.
struct Member {
    name: String,
    energy: [f64; 6],
    speed: [Complex<f64>; 6],
}

struct Group {
    what: &'static str,
    members: Vec<Member>,
}

impl Group {
    fn total(&self) -> f64 {
        self.members.iter().flat_map(|m| m.energy).sum()
    }

    fn by_direction(&self) -> [f64; 6] {
        let mut sum = [0.0; 6];
        for member in &self.members {
            for (s, e) in sum.iter_mut().zip(member.energy) {
                *s += e;
            }
        }
        sum
    }

    /// Energy in the lateral plane (y, phi, psi) and in the vertical one (x, z, theta).
    fn planes(&self) -> [f64; 2] {
        let e = self.by_direction();
        [e[1] + e[3] + e[5], e[0] + e[2] + e[4]]
    }

    /// Lateral and vertical plane apart, then the strongest direction in the stronger plane.
    fn direction(&self) -> usize {
        let e = self.by_direction();
        let [lateral, vertical] = self.planes();
        let plane = if lateral > vertical { [1, 3, 5] } else { [0, 2, 4] };
        plane.into_iter().max_by(|a, b| e[*a].total_cmp(&e[*b])).unwrap_or(0)
    }
}

/// The name of a mode with the given shape.
pub(super) fn name(model: &Model, speed: f64, eigenvalue: Complex<f64>, shape: &[Complex<f64>]) -> String {
    let [car, bogies, others, axles, track] = groups(model, shape);
    if eigenvalue.norm() < RIGID && stands_displaced(model, shape) {
        return "displaced, held by friction".into();
    }
    if eigenvalue.norm() < RIGID {
        let all: Vec<f64> = (0..6)
            .map(|d| [&car, &bogies, &others, &axles].iter().map(|g| g.by_direction()[d]).sum())
            .collect();
        let d = (0..6).max_by(|a, b| all[*a].total_cmp(&all[*b])).unwrap_or(0);
        return if d == 0 { "free rolling".into() } else { format!("free {}", WORDS[d]) };
    }
    let running = bogies.total() + axles.total();
    // Sideways: in a motion along the track the lateral parts are rounding, which may follow anything.
    let planes = [&car, &bogies, &axles].map(Group::planes);
    let sideways = planes.iter().map(|p| p[0]).sum::<f64>() > planes.iter().map(|p| p[1]).sum();
    if speed > 0.0 && sideways && running > track.total() && follows(model, speed, shape) {
        let group =
            if bogies.members.is_empty() || axles.total() > 3.0 * bogies.total() { &axles } else { &bogies };
        let e = group.by_direction();
        return describe(group, if e[1] >= e[5] { Y } else { PSI }, "hunting");
    }
    let strongest =
        [&car, &bogies, &others, &axles, &track].into_iter().max_by(|a, b| a.total().total_cmp(&b.total()));
    let Some(group) = strongest else { return "mode".into() };
    let direction = group.direction();
    if std::ptr::eq(group, &car) {
        return car_body(model, &car, direction, shape);
    }
    let word = if std::ptr::eq(group, &axles) && direction == THETA { "spin" } else { WORDS[direction] };
    describe(group, direction, word)
}

/// Whether a motion that takes for ever is none: friction that sticks holds a displaced vehicle where it is, one eigenvalue 0
/// for each of its memories.
fn stands_displaced(model: &Model, shape: &[Complex<f64>]) -> bool {
    let map = model.map();
    let size = |range: std::ops::Range<usize>| shape[range].iter().map(Complex::norm_sqr).sum::<f64>();
    let (mut place, mut speed) = (0.0, 0.0);
    for i in 0..model.count() {
        place += size(map.q(i));
        speed += size(map.u(i));
    }
    map.memory > 0 && speed < 1e-6 * place
}

/// Modes of the same name are numbered by frequency.
pub(super) fn tell_apart(modes: &mut [Mode]) {
    let names: Vec<String> = modes.iter().map(|m| m.name.clone()).collect();
    for (i, mode) in modes.iter_mut().enumerate() {
        if names.iter().filter(|n| **n == names[i]).count() > 1 {
            let number = names[..=i].iter().filter(|n| **n == names[i]).count();
            mode.name = format!("{} {number}", names[i]);
        }
    }
}

fn groups(model: &Model, shape: &[Complex<f64>]) -> [Group; 5] {
    let map = model.map();
    let car = model.car_body();
    let group = |what, members| Group { what, members };
    let mut all = [
        group("car body", Vec::new()),
        group("bogies", Vec::new()),
        group("bodies", Vec::new()),
        group("wheelsets", Vec::new()),
        group("track", Vec::new()),
    ];
    for i in 0..model.count() {
        let at = match i {
            _ if i >= map.bodies => 3,
            _ if Some(i) == car => 0,
            _ if model.carried_by_axles(i) => 1,
            _ => 2,
        };
        all[at].members.push(member(model, i, shape));
    }
    if let Some(support) = &model.support {
        for (w, set) in model.wheelsets.iter().enumerate() {
            let u = map.track_u(w).start;
            let mut m = Member {
                name: format!("under {}", set.body.name),
                energy: [0.0; 6],
                speed: [Complex::default(); 6],
            };
            for (d, to) in [1, 2, 3].into_iter().enumerate() {
                let mass = if d < 2 { support.mass } else { support.inertia };
                m.speed[to] = shape[u + d];
                m.energy[to] = mass * shape[u + d].norm_sqr();
            }
            all[4].members.push(m);
        }
    }
    all
}

fn member(model: &Model, i: usize, shape: &[Complex<f64>]) -> Member {
    let (body, u) = (model.rigid(i), model.map().u(i).start);
    let inertia = [body.mass, body.mass, body.mass, body.inertia.x, body.inertia.y, body.inertia.z];
    let mut m = Member { name: body.name.clone(), energy: [0.0; 6], speed: [Complex::default(); 6] };
    for d in 0..6 {
        m.speed[d] = shape[u + d];
        m.energy[d] = inertia[d] * shape[u + d].norm_sqr();
    }
    m
}

/// Largest square of the car body's lateral motion over that of the axles below it: more is the body's own sway.
const CARRIED: f64 = 4.0;

/// Whether the axles run where they point, and the car body does not move much farther than they do.
fn follows(model: &Model, speed: f64, shape: &[Complex<f64>]) -> bool {
    let map = model.map();
    let (mut sliding, mut lateral, mut axles, mut above) = (0.0, 0.0, 0.0, 0.0);
    let car = model.car_body();
    for i in map.bodies..model.count() {
        let (vy, psi) = (shape[map.u(i).start + Y], shape[map.q(i).start + PSI]);
        sliding += (vy - speed * psi).norm_sqr();
        lateral += vy.norm_sqr();
        axles += shape[map.q(i).start + Y].norm_sqr();
        if let Some(car) = car {
            let (q, apart) = (map.q(car).start, model.rigid(i).position.x - model.rigid(car).position.x);
            above += (shape[q + Y] + shape[q + PSI] * apart).norm_sqr();
        }
    }
    lateral > 0.0 && sliding < FOLLOWING * lateral && above < CARRIED * axles
}

fn car_body(model: &Model, car: &Group, direction: usize, shape: &[Complex<f64>]) -> String {
    let e = car.by_direction();
    if direction.is_multiple_of(2) || e[5] > e[1] + e[3] {
        let word = if direction.is_multiple_of(2) { WORDS[direction] } else { WORDS[PSI] };
        return format!("car body {word}");
    }
    let map = model.map();
    let Some(i) =
        (0..map.bodies).find(|i| Some(&model.rigid(*i).name) == car.members.first().map(|m| &m.name))
    else {
        return "car body sway".into();
    };
    // The body turns about the point at depth y / phi below its centre of mass.
    let q = map.q(i).start;
    let below = (shape[q + Y] * shape[q + PHI].conj()).re > 0.0;
    format!("car body {} sway", if below { "lower" } else { "upper" })
}

/// Group, who in it, the word for the motion, and for two or more their phase.
fn describe(group: &Group, direction: usize, word: &str) -> String {
    let total = |m: &Member| m.energy.iter().sum::<f64>();
    let most = group.members.iter().map(total).fold(0.0, f64::max);
    let noted: Vec<&Member> = group.members.iter().filter(|m| total(m) >= NOTED * most).collect();
    let single = match group.what {
        "bodies" => "body",
        what => what.trim_end_matches('s'),
    };
    match noted[..] {
        [only] if group.what == "track" => format!("track {word} {}", only.name),
        [only] => format!("{} {word}", only.name),
        [first, .., last] => {
            let side = (first.speed[direction] * last.speed[direction].conj()).re;
            let phase = if side >= 0.0 { "in phase" } else { "in antiphase" };
            if noted.len() == group.members.len() {
                format!("{} {word} {phase}", group.what)
            } else {
                let names: Vec<_> = noted.iter().map(|m| m.name.as_str()).collect();
                format!("{single} {word} {phase} ({})", names.join(" "))
            }
        }
        [] => format!("{single} {word}"),
    }
}
