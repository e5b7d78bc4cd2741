//! Static and rolling equilibrium by Newton's method with a numerical Jacobian.
//!
//! Unknowns are all coordinates of all bodies and track masses; a rolling wheelset's turned angle is replaced by its
//! spin rate. Residuals are the accelerations of all speeds. Nothing is settled by time stepping.
//!
//! Where Newton's method fails (contacts that would part), the coordinates are relaxed instead: `dq/dtau` = accelerations, by
//! implicit Euler steps in a pseudo-time whose step grows as the residual falls (pseudo-transient continuation; Kelley and
//! Keyes, SIAM J. Numer. Anal. 35 (1998) 508). With an infinite step that is Newton's method again.

use nalgebra::{DMatrix, DVector};

use crate::body::{coordinate, steady_speeds};
use crate::contact::geometry_table::{ContactPoint, MAX_CONTACTS};
use crate::dynamics::model::{Contact, Model};
use crate::dynamics::rhs::{SpeedProgram, VehicleSystem};
use crate::error::{Error, Result};
use crate::integrator::System;

/// Largest acceleration left, m/s2 or rad/s2: a hundred times the rounding of the stiffest spring's force.
const TOLERANCE: f64 = 1e-7;
/// Largest acceleration left where rounding of stiffer springs lets no step get below [`TOLERANCE`].
const ROUNDING: f64 = 1e-5;
const MOST_ITERATIONS: usize = 40;
/// Iterations after which a step that is followed from a balance nearby is better taken in two.
const FEW_ITERATIONS: usize = 10;
/// Implicit steps of a relaxation, at most.
const MOST_RELAXATIONS: usize = 300;
/// First step of a relaxation in pseudo-time, s2: a few times the inverse square of the fastest mode (some 2500 rad/s).
const FIRST_RELAXATION: f64 = 1e-6;
const INCREMENT: f64 = 1e-7;
/// Of a singular value decomposition; far more than it takes.
const MOST_SWEEPS: usize = 10_000;
/// The same for what connections remember: a slider passes its limit by no more than its speed on the way times a millisecond.
const MEMORY_INCREMENT: f64 = 1e-11;
/// Share by which a full step of Newton's has to lower the residual (Armijo's rule).
const SUFFICIENT: f64 = 0.1;

/// Place of the rate of spin among a body's speeds.
const SPIN: usize = 4;

/// One unknown: an index into the state, or the spin rate of a wheelset.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Unknown {
    State(usize),
    Spin(usize),
}

/// What a balance is sought under.
#[derive(Debug, Clone, Copy, Default)]
pub struct Conditions<'a> {
    /// Speed along the track, m/s; 0 stands.
    pub speed: f64,
    /// Coordinates (indices into the state) that stay where they are; nobody asks for balance in their directions.
    pub held: &'a [usize],
    /// Accelerations (m/s2, rad/s2) that loads from outside add to speeds (indices into the state).
    pub push: &'a [(usize, f64)],
    /// The balance before this one, from which what connections remember is followed along the way here; without it they
    /// remember what they did.
    pub since: Option<&'a [f64]>,
}

/// Time that a way from one balance to the next takes, s: so slow that dampers carry nothing.
const WAY: f64 = 1e3;

struct Problem<'s, 'm, 'c> {
    system: &'s mut VehicleSystem<'m>,
    unknowns: Vec<Unknown>,
    equations: Vec<usize>,
    spin: Vec<f64>,
    conditions: Conditions<'c>,
    x: Vec<f64>,
    dx: Vec<f64>,
}

impl Problem<'_, '_, '_> {
    /// Speeds that go with the coordinates: every body stays in its track frame, which moves on.
    fn set_speeds(&mut self) {
        let map = self.system.model.map();
        let first = self.system.model.bodies.len();
        for i in 0..self.system.model.count() {
            let frame = self.system.model.layout.frame(self.x[map.q(i).start]);
            let spins = i >= first;
            let spin = if spins { self.spin[i - first] } else { 0.0 };
            let u = steady_speeds(&self.x[map.q(i)], &frame, self.conditions.speed, spin, spins);
            self.x[map.u(i)].copy_from_slice(&u);
        }
        for w in 0..self.system.model.wheelsets.len() {
            self.x[map.track_u(w)].fill(0.0);
        }
    }

    /// Adds the slow speeds of the way from the balance before.
    fn creep_from(&mut self, before: &[f64]) {
        let map = self.system.model.map();
        let spins = self.system.model.bodies.len();
        for i in 0..self.system.model.count() {
            let (q, u) = (map.q(i).start, map.u(i).start);
            for d in (0..6).filter(|d| i < spins || *d != coordinate::THETA) {
                self.x[u + d] += (self.x[q + d] - before[q + d]) / WAY;
            }
        }
    }

    fn residual(&mut self, out: &mut DVector<f64>) {
        self.set_speeds();
        if let Some(before) = self.conditions.since {
            self.creep_from(before);
        }
        self.system.rhs(0.0, &self.x, &mut self.dx);
        for (speed, by) in self.conditions.push {
            self.dx[*speed] += by;
        }
        if let Some(before) = self.conditions.since {
            // One implicit Euler step: the equation of a memory stands at its own place, times the step.
            for i in self.system.model.map().memory() {
                self.dx[i] = WAY * self.dx[i] - (self.x[i] - before[i]);
            }
        }
        for (r, e) in out.iter_mut().zip(&self.equations) {
            *r = self.dx[*e];
        }
    }

    fn shift(&mut self, unknown: Unknown, by: f64) {
        match unknown {
            Unknown::State(i) => self.x[i] += by,
            Unknown::Spin(w) => self.spin[w] += by,
        }
    }
}

/// State in equilibrium on the design track with the vehicle's centre at `s`, standing (`speed` 0, contacts stick) or
/// rolling at `speed` (m/s) with creep forces.
///
/// # Errors
/// [`Error::NotConverged`] naming the worst equation.
pub fn solve(model: &Model, s: f64, speed: f64) -> Result<Vec<f64>> {
    let mut x = design_state(model, s);
    let mut system = standing(model, s);
    let mut conditions = Conditions::default();
    settle(&mut system, &mut x, conditions)?;
    if speed > 0.0 {
        roll(&mut system, speed);
        conditions.speed = speed;
        settle(&mut system, &mut x, conditions)?;
    }
    Ok(x)
}

/// A system that stands on the design track with its centre at `s`.
#[must_use]
pub fn standing(model: &Model, s: f64) -> VehicleSystem<'_> {
    let program = SpeedProgram { s: reference_s(model, s), speed: 0.0, acceleration: 0.0 };
    let mut system = VehicleSystem::new(model, program);
    system.irregular = false;
    system.creeping = false;
    system
}

/// Lets a standing system roll.
pub fn roll(system: &mut VehicleSystem<'_>, speed: f64) {
    system.program.speed = speed;
    system.creeping = speed > 0.0;
}

/// Takes `x` to balance under `conditions`: by Newton's method, else by relaxation. `x` is left as it was on failure.
///
/// # Errors
/// [`Error::NotConverged`] naming the worst equation.
pub fn settle(system: &mut VehicleSystem<'_>, x: &mut Vec<f64>, conditions: Conditions<'_>) -> Result<()> {
    let held = with_free_place(system.model, conditions.held);
    let conditions = Conditions { held: &held, ..conditions };
    let mut problem = Problem::new(system, x, conditions);
    let outcome = problem.newton(MOST_ITERATIONS).or_else(|first| {
        problem.restart(x);
        problem.relax().map_err(|_| first)
    });
    if outcome.is_ok() {
        x.clone_from(&problem.x);
    }
    outcome
}

/// The same by Newton's method alone: quick to tell that a balance is too far away.
///
/// # Errors
/// [`Error::NotConverged`].
pub fn newton(system: &mut VehicleSystem<'_>, x: &mut Vec<f64>, conditions: Conditions<'_>) -> Result<()> {
    let held = with_free_place(system.model, conditions.held);
    let mut problem = Problem::new(system, x, Conditions { held: &held, ..conditions });
    problem.newton(MOST_ITERATIONS)?;
    x.clone_from(&problem.x);
    Ok(())
}

/// From a balance `x` to one nearby, where held coordinates (indices into the state) have moved by `moves` and loads have
/// changed: along the tangent, then by a few of Newton's steps. Wheels of an axle that is raised are raised with it, so that no
/// contact parts on the way. `x` is left as it was on failure.
///
/// # Errors
/// [`Error::NotConverged`]: the two balances are too far apart.
pub fn follow(
    system: &mut VehicleSystem<'_>,
    x: &mut Vec<f64>,
    conditions: Conditions<'_>,
    moves: &[(usize, f64)],
) -> Result<()> {
    let held = with_free_place(system.model, conditions.held);
    let mut problem = Problem::new(system, x, Conditions { held: &held, ..conditions });
    problem.predict(moves);
    problem.newton(FEW_ITERATIONS)?;
    x.clone_from(&problem.x);
    Ok(())
}

/// The held coordinates with, where no speed hold fixes the vehicle's place, that of its reference body: it stands where it
/// was put, and what would move it along the track is not asked for.
fn with_free_place(model: &Model, held: &[usize]) -> Vec<usize> {
    let mut held = held.to_vec();
    let place = model.map().q(model.reference()).start;
    if model.place_is_free() && !held.contains(&place) {
        held.push(place);
    }
    held
}

/// Arc length of the reference body when the vehicle's centre is at `s`.
#[must_use]
pub fn reference_s(model: &Model, s: f64) -> f64 {
    s + model.rigid(model.reference()).position.x
}

/// All bodies where the drawing has them, lowered until the wheels touch and the track carries them.
#[must_use]
pub fn design_state(model: &Model, s: f64) -> Vec<f64> {
    let map = model.map();
    let mut x = vec![0.0; map.size()];
    let load = model.mass() * model.gravity / model.wheelsets.len().max(1) as f64;
    let sink = model.support.map_or(0.0, |t| load / t.stiffness[1]);
    let touch = match &model.contact {
        Contact::Profiles { table, .. } => touching_depth(table, 0.5 * load),
        Contact::Textbook(book) => 0.5 * load / book.stiffness,
    };
    for i in 0..model.count() {
        let p = model.rigid(i).position;
        let q = map.q(i).start;
        x[q] = s + p.x;
        x[q + coordinate::Y] = p.y;
        x[q + coordinate::Z] = p.z + if model.wheelsets.is_empty() { 0.0 } else { sink + touch };
    }
    for w in 0..model.wheelsets.len() {
        x[map.track_q(w).start + 1] = sink;
    }
    x
}

/// Depth at which a centred wheel carries about `load`, by bisection.
fn touching_depth(table: &crate::contact::geometry_table::GeometryTable, load: f64) -> f64 {
    let carried = |depth: f64| {
        let mut out = [ContactPoint::default(); MAX_CONTACTS];
        let n = table.contacts(0.0, 0.0, depth, 0.0, &mut out).unwrap_or(0);
        out[..n].iter().map(|c| c.share * c.hertz * (c.penetration * c.angle.cos()).powf(1.5)).sum::<f64>()
    };
    let (mut low, mut high) = (-0.05, 0.05);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if carried(middle) < load { low = middle } else { high = middle }
    }
    high
}

impl<'s, 'm, 'c> Problem<'s, 'm, 'c> {
    fn new(system: &'s mut VehicleSystem<'m>, x: &[f64], conditions: Conditions<'c>) -> Self {
        let model = system.model;
        let map = model.map();
        let rolling = conditions.speed > 0.0;
        let mut pairs = Vec::new();
        for i in (0..model.count()).filter(|i| !model.guided.contains(i)) {
            for d in 0..6 {
                let (q, u) = (map.q(i).start + d, map.u(i).start + d);
                match i.checked_sub(model.bodies.len()) {
                    Some(w) if d == coordinate::THETA => {
                        if rolling {
                            pairs.push((q, Unknown::Spin(w), u));
                        }
                    }
                    _ => pairs.push((q, Unknown::State(q), u)),
                }
            }
        }
        if model.support.is_some() {
            for w in 0..model.wheelsets.len() {
                pairs.extend(map.track_q(w).zip(map.track_u(w)).map(|(q, u)| (q, Unknown::State(q), u)));
            }
        }
        if conditions.since.is_some() {
            pairs.extend(map.memory().map(|i| (i, Unknown::State(i), i)));
        }
        pairs.retain(|(q, ..)| !conditions.held.contains(q));
        let (unknowns, equations) = pairs.into_iter().map(|(_, unknown, u)| (unknown, u)).unzip();
        let dx = vec![0.0; map.size()];
        let mut problem =
            Self { system, unknowns, equations, spin: Vec::new(), conditions, x: Vec::new(), dx };
        problem.restart(x);
        problem
    }

    fn restart(&mut self, x: &[f64]) {
        let (model, map) = (self.system.model, self.system.model.map());
        let speed = self.conditions.speed;
        let spin = |(w, set): (usize, &crate::body::Wheelset)| {
            // That of the balance before, where it is one of this speed.
            let (before, pure) = (x[map.u(model.bodies.len() + w).start + SPIN], -speed / set.radius);
            if speed > 0.0 && (before / pure - 1.0).abs() < 0.1 { before } else { pure }
        };
        self.spin = model.wheelsets.iter().enumerate().map(spin).collect();
        self.x = x.to_vec();
    }

    /// Moves held coordinates and, by the tangent, all others with them.
    fn predict(&mut self, moves: &[(usize, f64)]) {
        let most = moves.iter().fold(0.0_f64, |most, (_, by)| most.max(by.abs()));
        if most == 0.0 {
            return;
        }
        let n = self.unknowns.len();
        let (mut r, mut up, mut down) = (DVector::zeros(n), DVector::zeros(n), DVector::zeros(n));
        let jacobian = self.jacobian();
        self.residual(&mut r);
        let share = INCREMENT / most;
        self.move_by(moves, share);
        self.residual(&mut up);
        self.move_by(moves, -2.0 * share);
        self.residual(&mut down);
        self.move_by(moves, share + 1.0);
        r += (up - down) / (2.0 * share);
        self.shift_all(&descend(jacobian, &r), -1.0);
    }

    fn move_by(&mut self, moves: &[(usize, f64)], share: f64) {
        for (q, by) in moves {
            self.x[*q] += share * by;
        }
    }

    fn jacobian(&mut self) -> DMatrix<f64> {
        let n = self.unknowns.len();
        let mut jacobian = DMatrix::zeros(n, n);
        let (mut up, mut down) = (DVector::zeros(n), DVector::zeros(n));
        let memory = self.system.model.map().memory();
        for j in 0..n {
            let u = self.unknowns[j];
            let remembered = matches!(u, Unknown::State(i) if memory.contains(&i));
            let by = if remembered { MEMORY_INCREMENT } else { INCREMENT };
            self.shift(u, by);
            self.residual(&mut up);
            self.shift(u, -2.0 * by);
            self.residual(&mut down);
            self.shift(u, by);
            jacobian.set_column(j, &((&up - &down) / (2.0 * by)));
        }
        jacobian
    }

    fn shift_all(&mut self, step: &DVector<f64>, factor: f64) {
        for j in 0..self.unknowns.len() {
            let u = self.unknowns[j];
            self.shift(u, factor * step[j]);
        }
    }

    fn newton(&mut self, most: usize) -> Result<()> {
        let n = self.unknowns.len();
        let (mut r, mut trial) = (DVector::zeros(n), DVector::zeros(n));
        self.residual(&mut r);
        let mut iterations = 0;
        while size(&r) > TOLERANCE {
            if iterations == most || !size(&r).is_finite() {
                return Err(self.not_converged(iterations, &r));
            }
            let step = descend(self.jacobian(), &r);
            // Halve the step until the residual falls by a share of it: contacts that would part make full steps overshoot, and
            // a slider's limit is a kink at which full steps jump from side to side.
            let mut factor = 1.0;
            let old = r.norm();
            loop {
                self.shift_all(&step, -factor);
                self.residual(&mut trial);
                if trial.norm() < (1.0 - SUFFICIENT * factor) * old {
                    break;
                }
                if factor < 1e-3 {
                    if size(&r) < ROUNDING {
                        self.shift_all(&step, factor);
                        self.set_speeds();
                        return Ok(());
                    }
                    // At the kink of a contact about to part no fraction lowers the residual. A thousandth of the step goes
                    // past it; the count of iterations ends what does not come back, and relaxation takes over.
                    break;
                }
                self.shift_all(&step, factor);
                factor *= 0.5;
            }
            r.copy_from(&trial);
            iterations += 1;
        }
        self.set_speeds();
        Ok(())
    }

    /// Implicit Euler steps in pseudo-time.
    fn relax(&mut self) -> Result<()> {
        let n = self.unknowns.len();
        let (mut r, mut trial) = (DVector::zeros(n), DVector::zeros(n));
        self.residual(&mut r);
        let mut tau = FIRST_RELAXATION;
        for _ in 0..MOST_RELAXATIONS {
            if size(&r) <= TOLERANCE {
                self.set_speeds();
                return Ok(());
            }
            let mut jacobian = self.jacobian();
            for j in 0..n {
                jacobian[(j, j)] -= 1.0 / tau;
            }
            let step = descend(jacobian, &r);
            self.shift_all(&step, -1.0);
            self.residual(&mut trial);
            if size(&trial).is_finite() && trial.norm() < 2.0 * r.norm() {
                tau *= (r.norm() / trial.norm()).clamp(0.5, 10.0) * 1.3;
                r.copy_from(&trial);
            } else {
                self.shift_all(&step, 1.0);
                tau *= 0.2;
            }
        }
        Err(self.not_converged(MOST_RELAXATIONS, &r))
    }

    fn not_converged(&self, iterations: usize, r: &DVector<f64>) -> Error {
        let (worst, _) = r.argmax_abs();
        let what = if self.conditions.speed > 0.0 { "rolling equilibrium" } else { "static equilibrium" };
        Error::NotConverged {
            what: what.into(),
            iterations,
            residual: size(r),
            unit: "m/s2 or rad/s2",
            worst: self.equations.get(worst).map_or_else(String::new, |e| describe(self.system.model, *e)),
        }
    }
}

/// Newton step; where the Jacobian is singular (a coordinate nothing holds) the smallest step that does it.
fn descend(jacobian: DMatrix<f64>, r: &DVector<f64>) -> DVector<f64> {
    let lu = jacobian.clone().full_piv_lu();
    if let Some(step) = lu.solve(r).filter(|s| s.amax() < 1.0) {
        return step;
    }
    // Of a matrix that is not finite the decomposition would never end. No step then: the caller shortens, relaxes or gives up.
    let finite = jacobian.iter().all(|v| v.is_finite());
    let svd = finite.then(|| jacobian.try_svd(true, true, f64::EPSILON, MOST_SWEEPS)).flatten();
    svd.and_then(|svd| svd.solve(r, svd.singular_values.max() * 1e-13).ok())
        .unwrap_or_else(|| DVector::zeros(r.len()))
}

fn describe(model: &Model, equation: usize) -> String {
    let map = model.map();
    const MOTIONS: [&str; 6] = ["longitudinal", "lateral", "vertical", "roll", "pitch", "yaw"];
    for i in 0..model.count() {
        if map.u(i).contains(&equation) {
            return format!("{} {}", model.rigid(i).name, MOTIONS[equation - map.u(i).start]);
        }
    }
    for w in 0..model.wheelsets.len() {
        if map.track_u(w).contains(&equation) {
            let motion = ["lateral", "vertical", "roll"][equation - map.track_u(w).start];
            return format!("track under {} {motion}", model.wheelsets[w].body.name);
        }
    }
    "an equation".into()
}

/// Largest residual; a number that is not finite is larger than all others (`amax` would pass over a NaN).
fn size(r: &DVector<f64>) -> f64 {
    if r.iter().all(|v| v.is_finite()) { r.amax() } else { f64::INFINITY }
}

trait ArgMax {
    fn argmax_abs(&self) -> (usize, f64);
}

impl ArgMax for DVector<f64> {
    fn argmax_abs(&self) -> (usize, f64) {
        self.iter().enumerate().fold((0, 0.0), |best, (i, v)| {
            let v = if v.is_finite() { v.abs() } else { f64::INFINITY };
            if v > best.1 { (i, v) } else { best }
        })
    }
}
