//! Eigenvalues and mode shapes about the balance: standing with wheels that stick, or rolling.
//!
//! The matrix is the right-hand side's, by central differences. What is left out of it: the turned angle of a rolling axle, on
//! which nothing depends; held coordinates with their speeds; and, where no speed hold fixes it, the place along the track,
//! counted from the reference body. Of the latter one eigenvalue 0 remains, the free rolling.
//!
//! **Standing**, a wheel sticks: the tangential stiffness of the contact is `2 (1 - nu)/(2 - nu)` of the normal one (Mindlin, J. Appl.
//! Mech. 16 (1949) 259, for equal elastic constants and a circular patch; Johnson, Contact Mechanics, 1985, section 7.3), along
//! and across the rail. A standing wheel can still roll.

use nalgebra::{Complex, DMatrix};
use serde_json::json;

use crate::analysis::naming;
use crate::analysis::{Stand, Table};
use crate::body::coordinate::{S, THETA};
use crate::dynamics::coordinate::{self, Coordinate};
use crate::dynamics::linearise::jacobian;
use crate::dynamics::scratch::Wheel;
use crate::dynamics::state::PAIR;
use crate::dynamics::stiff::{add_outer, direction, inertias};
use crate::dynamics::{Contact, Model, VehicleSystem};
use crate::error::{Error, Result};
use crate::integrator::System;
use crate::math::Vec3;
use crate::math::eigen::Eigen;
use crate::run::{Control, Ended, Outcome};
use crate::schema::Case;

/// Eigenvalues smaller than this (rad/s) are of rigid motion: a period of an hour and more.
pub const RIGID: f64 = 1e-3;

/// One mode.
#[derive(Debug, Clone)]
pub struct Mode {
    /// What moves, e.g. `car body lower sway`.
    pub name: String,
    /// Eigenvalue, 1/s and rad/s; of a conjugate pair the one with the positive imaginary part.
    pub eigenvalue: Complex<f64>,
    /// Displacements (m, rad) and speeds, laid out as the state. The most moved coordinate is 1 and real: an axle's turned angle
    /// counts by the travel of its rim.
    pub shape: Vec<Complex<f64>>,
    /// Number of the root locus that it belongs to, from 1.
    pub branch: usize,
}

impl Mode {
    /// Frequency of the damped motion, Hz; 0 where it does not oscillate.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.eigenvalue.im / std::f64::consts::TAU
    }

    /// |eigenvalue| as a frequency, Hz.
    #[must_use]
    pub fn natural_frequency(&self) -> f64 {
        self.eigenvalue.norm() / std::f64::consts::TAU
    }

    /// Share of critical damping; negative where the motion grows.
    #[must_use]
    pub fn damping_ratio(&self) -> f64 {
        let size = self.eigenvalue.norm();
        if size < RIGID { 0.0 } else { -self.eigenvalue.re / size }
    }

    /// Motion of a body as a whole that nothing drives or damps.
    #[must_use]
    pub fn is_rigid(&self) -> bool {
        self.eigenvalue.norm() < RIGID
    }
}

/// A system's matrix without what cannot vibrate.
struct Reduced {
    matrix: DMatrix<f64>,
    /// Indices into the state of its rows.
    kept: Vec<usize>,
}

/// Modes of a model about the balance `x` at `speed` (m/s), lowest frequency first; `held` coordinates do not move.
///
/// # Errors
/// [`Error::NotConverged`] where the matrix holds a number that is not finite or the iteration stalls.
pub fn modes(model: &Model, system: &mut VehicleSystem<'_>, x: &[f64], held: &[usize]) -> Result<Vec<Mode>> {
    let speed = system.program.speed;
    let reduced = reduce(model, system, x, held);
    let eigen = Eigen::new(&reduced.matrix).ok_or_else(|| Error::NotConverged {
        what: "eigenvalues".into(),
        iterations: reduced.kept.len(),
        residual: f64::INFINITY,
        unit: "rad/s",
        worst: "the matrix of the linearised vehicle".into(),
    })?;
    let coordinates = coordinate::all(model);
    let mut modes: Vec<Mode> = (0..reduced.kept.len())
        .filter(|j| eigen.values[*j].im >= 0.0)
        .map(|j| {
            let eigenvalue = eigen.values[j];
            let mut shape = vec![Complex::new(0.0, 0.0); x.len()];
            for (value, i) in eigen.vector(j).into_iter().zip(&reduced.kept) {
                shape[*i] = value;
            }
            turn_axles(model, speed, eigenvalue, &mut shape);
            normalise(model, &mut shape, &coordinates);
            let name = naming::name(model, speed, eigenvalue, &shape);
            Mode { name, eigenvalue, shape, branch: 0 }
        })
        .collect();
    modes.sort_by(|a, b| {
        let key = |m: &Mode| (m.eigenvalue.im, m.eigenvalue.norm());
        let (a, b) = (key(a), key(b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    naming::tell_apart(&mut modes);
    Ok(modes)
}

fn reduce(model: &Model, system: &mut VehicleSystem<'_>, x: &[f64], held: &[usize]) -> Reduced {
    let map = model.map();
    let mut matrix = jacobian(system, 0.0, x);
    let standing = !system.creeping;
    if standing {
        stick(model, system, x, &mut matrix);
    }
    let mut gone: Vec<usize> = Vec::new();
    for c in coordinate::all(model).iter().filter(|c| held.contains(&c.q)) {
        gone.extend([c.q, c.u]);
    }
    for i in &model.guided {
        gone.extend(map.q(*i).chain(map.u(*i)));
    }
    for w in 0..model.wheelsets.len() {
        if model.support.is_none() {
            gone.extend(map.track_q(w).chain(map.track_u(w)));
        }
        if !standing {
            gone.push(map.q(map.bodies + w).start + THETA);
        }
    }
    let place = map.q(model.reference()).start + S;
    if model.place_is_free() && !held.contains(&place) {
        count_from_reference(model, standing, place, &mut matrix);
        gone.push(place);
    }
    let kept: Vec<usize> = (0..x.len()).filter(|i| !gone.contains(i)).collect();
    let matrix = DMatrix::from_fn(kept.len(), kept.len(), |i, j| matrix[(kept[i], kept[j])]);
    Reduced { matrix, kept }
}

/// Places become places relative to the reference body's (and a standing axle's turned angle one relative to rolling with
/// it): the common place then drops out.
fn count_from_reference(model: &Model, standing: bool, place: usize, matrix: &mut DMatrix<f64>) {
    let map = model.map();
    let common = matrix.row(place).into_owned();
    for i in 0..model.count() {
        let q = map.q(i).start;
        let mut subtract = |row: usize, share: f64| {
            if row != place {
                let mut row = matrix.row_mut(row);
                row -= &common * share;
            }
        };
        subtract(q + S, 1.0);
        if standing && i >= map.bodies {
            subtract(q + THETA, -1.0 / model.wheelsets[i - map.bodies].radius);
        }
    }
}

/// Adds the tangential stiffness of contacts that stick.
fn stick(model: &Model, system: &mut VehicleSystem<'_>, x: &[f64], matrix: &mut DMatrix<f64>) {
    let map = model.map();
    let mut dx = vec![0.0; x.len()];
    system.rhs(0.0, x, &mut dx);
    // Textbook contact has no Poisson's ratio of its own.
    let poisson = match &model.contact {
        Contact::Profiles { table, .. } => table.placement().poisson,
        Contact::Textbook(_) => 0.3,
    };
    let share = 2.0 * (1.0 - poisson) / (2.0 - poisson);
    for (w, wheels) in system.scratch.wheels.iter().enumerate() {
        let mut k = [0.0; PAIR * PAIR];
        for contact in wheels.iter().flat_map(Wheel::contacts) {
            for e in [Vec3::x(), contact.placed.e_t] {
                let along = direction(&contact.placed, &e);
                add_outer(&mut k, share * contact.normal_slope[0], &along, &along);
            }
        }
        let mass = inertias(model, w);
        let start = map.start(map.bodies + w);
        for i in 0..PAIR {
            for j in 0..PAIR {
                matrix[(start + PAIR + i, start + j)] -= k[i * PAIR + j] / mass[i];
            }
        }
    }
}

/// The turned angle of rolling axles, which the matrix leaves out, from their spin.
fn turn_axles(model: &Model, speed: f64, eigenvalue: Complex<f64>, shape: &mut [Complex<f64>]) {
    let map = model.map();
    if speed > 0.0 && eigenvalue.norm() > RIGID {
        for i in map.bodies..model.count() {
            shape[map.q(i).start + THETA] = shape[map.u(i).start + THETA] / eigenvalue;
        }
    }
}

/// Makes the largest coordinate 1 and real, angles over a lever of 1 m, those that axles turn by over the wheel's radius; of a
/// motion without displacement (free rolling) the largest speed.
fn normalise(model: &Model, shape: &mut [Complex<f64>], coordinates: &[Coordinate]) {
    let first = 6 * model.bodies.len();
    let lever = |k: usize| match k.checked_sub(first).map(|k| (k / 6, k % 6)) {
        Some((w, THETA)) if w < model.wheelsets.len() => model.wheelsets[w].radius,
        _ => 1.0,
    };
    let largest = |index: fn(&Coordinate) -> usize| {
        let travel = coordinates.iter().enumerate().map(|(k, c)| shape[index(c)] * lever(k));
        travel.max_by(|a, b| a.norm().total_cmp(&b.norm()))
    };
    let unit = largest(|c| c.q).filter(|v| v.norm() > 1e-12).or_else(|| largest(|c| c.u));
    if let Some(unit) = unit.filter(|v| v.norm() > 0.0) {
        shape.iter_mut().for_each(|v| *v /= unit);
    }
}

/// Numbers the modes of one speed by those of the speed before that they continue: the most alike in shape and eigenvalue.
pub(crate) fn continue_branches(
    model: &Model,
    before: Option<&[Mode]>,
    modes: &mut [Mode],
    branches: &mut usize,
) {
    let coordinates = coordinate::all(model);
    let scaled = |m: &Mode| -> Vec<Complex<f64>> {
        let v: Vec<_> = coordinates.iter().map(|c| m.shape[c.u] * c.inertia.sqrt()).collect();
        let size = v.iter().map(Complex::norm_sqr).sum::<f64>().sqrt();
        v.into_iter().map(|x| if size > 0.0 { x / size } else { x }).collect()
    };
    let old: Vec<_> = before.unwrap_or_default().iter().map(|m| (m, scaled(m))).collect();
    let mut pairs = Vec::new();
    for (i, mode) in modes.iter().enumerate() {
        let shape = scaled(mode);
        for (j, (other, before)) in old.iter().enumerate() {
            let alike = shape.iter().zip(before).map(|(a, b)| a.conj() * b).sum::<Complex<f64>>().norm_sqr();
            let apart = (mode.eigenvalue - other.eigenvalue).norm();
            pairs.push((alike * (-apart / (1.0 + 0.3 * other.eigenvalue.norm())).exp(), i, j));
        }
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut taken = vec![false; old.len()];
    for (_, i, j) in pairs {
        if modes[i].branch == 0 && !taken[j] {
            modes[i].branch = old[j].0.branch;
            taken[j] = true;
        }
    }
    for mode in modes.iter_mut().filter(|m| m.branch == 0) {
        *branches += 1;
        mode.branch = *branches;
    }
}

/// Names of all columns.
///
/// # Errors
/// Faults of the case.
pub fn columns(case: &Case) -> Result<Vec<String>> {
    Ok(names(&Stand::new(case)?.model))
}

const OWN: [&str; 8] =
    ["v", "mode", "branch", "frequency", "natural_frequency", "damping_ratio", "real", "imag"];

fn names(model: &Model) -> Vec<String> {
    let coordinates = coordinate::all(model);
    let shape =
        ["re", "im"].into_iter().flat_map(|p| coordinates.iter().map(move |c| format!("{p}.{}", c.name)));
    OWN.into_iter().map(str::to_owned).chain(shape).collect()
}

/// Runs a case of kind `modal`: a row for each mode at each speed, `name` beside the numbers.
///
/// # Errors
/// Faults of the case; no balance; [`Error::NotConverged`].
pub fn run(case: &Case, control: &dyn Control) -> Result<Outcome> {
    let mut stand = Stand::new(case)?;
    let speeds = if case.run.speeds.is_empty() { vec![case.run.speed] } else { case.run.speeds.clone() };
    let mut table = Table::new(names(&stand.model));
    let mut labels = Vec::new();
    let (mut before, mut branches) = (None::<Vec<Mode>>, 0);
    let mut largest = 0.0_f64;
    for (i, speed) in speeds.iter().enumerate() {
        if control.stop() {
            return Err(Error::Interrupted);
        }
        control.progress(i as f64, 0.0, i as f64 / speeds.len() as f64);
        let x = stand.settle(*speed)?;
        let mut modes = modes(&stand.model, &mut stand.system(*speed), &x, &stand.held)?;
        continue_branches(&stand.model, before.as_deref(), &mut modes, &mut branches);
        let coordinates = coordinate::all(&stand.model);
        for (k, mode) in modes.iter().enumerate() {
            largest = largest.max(mode.eigenvalue.norm());
            table.push(row(*speed, k + 1, mode, &coordinates));
            labels.push(mode.name.clone());
        }
        before = Some(modes);
    }
    let statistics = json!({
        "analysis": "modal",
        "speeds": speeds.len(),
        "largest_eigenvalue": largest,
        "place_m": stand.s,
    });
    Ok(table.done(vec![("name".into(), labels)], Ended::Complete, statistics))
}

fn row(speed: f64, number: usize, mode: &Mode, coordinates: &[Coordinate]) -> Vec<f64> {
    let mut row = vec![
        speed,
        number as f64,
        mode.branch as f64,
        mode.frequency(),
        mode.natural_frequency(),
        mode.damping_ratio(),
        mode.eigenvalue.re,
        mode.eigenvalue.im,
    ];
    row.extend(coordinates.iter().map(|c| mode.shape[c.q].re));
    row.extend(coordinates.iter().map(|c| mode.shape[c.q].im));
    row
}
