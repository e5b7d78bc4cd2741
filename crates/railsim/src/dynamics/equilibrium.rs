//! Static and rolling equilibrium by Newton's method with a numerical Jacobian.
//!
//! Unknowns are all coordinates of all bodies and track masses; a rolling wheelset's turned angle is replaced by its
//! spin rate. Residuals are the accelerations of all speeds. Nothing is settled by time stepping.

use nalgebra::{DMatrix, DVector};

use crate::body::{coordinate, steady_speeds};
use crate::contact::geometry_table::{ContactPoint, MAX_CONTACTS};
use crate::dynamics::model::{Contact, Model};
use crate::dynamics::rhs::{SpeedProgram, VehicleSystem};
use crate::error::{Error, Result};
use crate::integrator::System;

/// Largest acceleration left, m/s2 or rad/s2: a hundred times the rounding of the stiffest spring's force.
const TOLERANCE: f64 = 1e-7;
const MOST_ITERATIONS: usize = 60;
const INCREMENT: f64 = 1e-7;

/// One unknown: an index into the state, or the spin rate of a wheelset.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Unknown {
    State(usize),
    Spin(usize),
}

struct Problem<'s, 'm> {
    system: &'s mut VehicleSystem<'m>,
    unknowns: Vec<Unknown>,
    equations: Vec<usize>,
    spin: Vec<f64>,
    speed: f64,
    x: Vec<f64>,
    dx: Vec<f64>,
}

impl Problem<'_, '_> {
    /// Speeds that go with the coordinates: every body stays in its track frame, which moves on.
    fn set_speeds(&mut self) {
        let map = self.system.model.map();
        let first = self.system.model.bodies.len();
        for i in 0..self.system.model.count() {
            let frame = self.system.model.layout.frame(self.x[map.q(i).start]);
            let spins = i >= first;
            let spin = if spins { self.spin[i - first] } else { 0.0 };
            let u = steady_speeds(&self.x[map.q(i)], &frame, self.speed, spin, spins);
            self.x[map.u(i)].copy_from_slice(&u);
        }
        for w in 0..self.system.model.wheelsets.len() {
            self.x[map.track_u(w)].fill(0.0);
        }
    }

    fn residual(&mut self, out: &mut DVector<f64>) {
        self.set_speeds();
        self.system.rhs(0.0, &self.x, &mut self.dx);
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
    let standing = SpeedProgram { s: reference_s(model, s), speed: 0.0, acceleration: 0.0 };
    let mut system = VehicleSystem::new(model, standing);
    system.irregular = false;
    system.creeping = false;
    newton(&mut system, &mut x, 0.0)?;
    if speed > 0.0 {
        system.program.speed = speed;
        system.creeping = true;
        newton(&mut system, &mut x, speed)?;
    }
    Ok(x)
}

/// Arc length of the reference body when the vehicle's centre is at `s`.
#[must_use]
pub fn reference_s(model: &Model, s: f64) -> f64 {
    s + model.rigid(model.reference()).position.x
}

/// All bodies where the drawing has them, lowered until the wheels touch and the track carries them.
fn design_state(model: &Model, s: f64) -> Vec<f64> {
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

fn newton(system: &mut VehicleSystem<'_>, x: &mut Vec<f64>, speed: f64) -> Result<()> {
    let model = system.model;
    let map = model.map();
    let rolling = speed > 0.0;
    let mut unknowns = Vec::new();
    let mut equations = Vec::new();
    for i in 0..model.count() {
        let wheelset = i.checked_sub(model.bodies.len());
        for d in 0..6 {
            match wheelset {
                Some(_) if d == coordinate::THETA && !rolling => {}
                Some(w) if d == coordinate::THETA => {
                    unknowns.push(Unknown::Spin(w));
                    equations.push(map.u(i).start + d);
                }
                _ => {
                    unknowns.push(Unknown::State(map.q(i).start + d));
                    equations.push(map.u(i).start + d);
                }
            }
        }
    }
    if model.support.is_some() {
        for w in 0..model.wheelsets.len() {
            unknowns.extend(map.track_q(w).map(Unknown::State));
            equations.extend(map.track_u(w));
        }
    }
    let n = unknowns.len();
    let spin = model.wheelsets.iter().map(|w| -speed / w.radius).collect();
    let dx = vec![0.0; map.size()];
    let mut p = Problem { system, unknowns, equations, spin, speed, x: std::mem::take(x), dx };
    let mut r = DVector::zeros(n);
    let mut trial = DVector::zeros(n);
    p.residual(&mut r);
    let mut iterations = 0;
    while size(&r) > TOLERANCE {
        if iterations == MOST_ITERATIONS || !size(&r).is_finite() {
            let (worst, _) = r.argmax_abs();
            return Err(Error::NotConverged {
                what: if rolling { "rolling equilibrium".into() } else { "static equilibrium".into() },
                iterations,
                residual: size(&r),
                unit: "m/s2 or rad/s2",
                worst: describe(model, p.equations[worst]),
            });
        }
        let mut jacobian = DMatrix::zeros(n, n);
        for j in 0..n {
            let u = p.unknowns[j];
            p.shift(u, INCREMENT);
            p.residual(&mut trial);
            p.shift(u, -2.0 * INCREMENT);
            let mut back = DVector::zeros(n);
            p.residual(&mut back);
            p.shift(u, INCREMENT);
            jacobian.set_column(j, &((&trial - back) / (2.0 * INCREMENT)));
        }
        let step = descend(jacobian, &r);
        // Halve the step until the residual falls; contacts that would part make full steps overshoot.
        let mut factor = 1.0;
        let old = r.norm();
        loop {
            for j in 0..n {
                let u = p.unknowns[j];
                p.shift(u, -factor * step[j]);
            }
            p.residual(&mut trial);
            if trial.norm() < old || factor < 1e-3 {
                break;
            }
            for j in 0..n {
                let u = p.unknowns[j];
                p.shift(u, factor * step[j]);
            }
            factor *= 0.5;
        }
        r.copy_from(&trial);
        iterations += 1;
    }
    p.set_speeds();
    *x = p.x;
    Ok(())
}

/// Newton step; where the Jacobian is singular (a coordinate nothing holds) the smallest step that does it.
fn descend(jacobian: DMatrix<f64>, r: &DVector<f64>) -> DVector<f64> {
    let lu = jacobian.clone().full_piv_lu();
    if let Some(step) = lu.solve(r).filter(|s| s.amax() < 1.0) {
        return step;
    }
    let svd = jacobian.svd(true, true);
    let tolerance = svd.singular_values.max() * 1e-13;
    svd.solve(r, tolerance).unwrap_or_else(|_| DVector::zeros(r.len()))
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
