//! Contact patches: Hertz's, and those that are no ellipses. Arrays come as buffers of doubles and leave as columns.

use std::f64::consts::PI;

use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use railsim::contact::hertz as law;
use railsim::contact::non_elliptic::{Bodies, Gap};
use railsim::contact::pair::Pair;
use railsim::contact::search::{GapPoint, NoContact, RailShift};
use railsim::{Error, Fault, KeyPath};

use crate::arrow::Frame;
use crate::errors::raise;

/// Columns that are no run's.
fn table(columns: Vec<(&str, Vec<f64>)>) -> PyResult<Frame> {
    let columns = columns.into_iter().map(|(name, values)| (name.to_owned(), values)).collect();
    Frame::table(columns)
}

/// Semi-axes along and across, approach and peak pressure of Hertz's patch, for arrays of equal length.
#[pyfunction]
pub fn hertz(
    py: Python<'_>,
    force: PyBuffer<f64>,
    kx: PyBuffer<f64>,
    ky: PyBuffer<f64>,
    youngs_modulus: f64,
    poisson: f64,
) -> PyResult<Frame> {
    let modulus = law::effective_modulus(youngs_modulus, poisson);
    let (force, kx, ky) = (force.to_vec(py)?, kx.to_vec(py)?, ky.to_vec(py)?);
    let mut out = [const { Vec::new() }; 4];
    for ((n, kx), ky) in force.iter().zip(&kx).zip(&ky) {
        let h = law::solve(*kx, *ky, modulus);
        let (a, b) = (h.a1 * n.cbrt(), h.b1 * n.cbrt());
        // no load, no patch: 0/0 otherwise
        let peak = if *n == 0.0 { 0.0 } else { 1.5 * n / (PI * a * b) };
        for (column, value) in out.iter_mut().zip([a, b, (n / h.stiffness).powf(2.0 / 3.0), peak]) {
            column.push(value);
        }
    }
    table(["a", "b", "approach", "max_pressure"].into_iter().zip(out).collect())
}

/// Patch of two bodies with a separation given across the rolling direction, at a force or at an approach.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn non_elliptic<'py>(
    py: Python<'py>,
    y: PyBuffer<f64>,
    separation: PyBuffer<f64>,
    curvature: f64,
    youngs_modulus: f64,
    poisson: f64,
    force: Option<f64>,
    approach: Option<f64>,
) -> PyResult<(Bound<'py, PyDict>, Frame)> {
    let bodies = Bodies { curvature, youngs_modulus, poisson };
    let gap = Gap::new(&y.to_vec(py)?, &separation.to_vec(py)?).map_err(|e| raise(py, e))?;
    let patch = match (force, approach) {
        (Some(force), None) => gap.at_force(force, &bodies),
        (None, Some(approach)) => gap.at_approach(approach, &bodies),
        _ => Err(Error::input(Fault::new(
            KeyPath::of("force"),
            if force.is_some() { "a force and an approach" } else { "neither force nor approach" },
            "one of the two",
        ))),
    }
    .map_err(|e| raise(py, e))?;
    let out = PyDict::new(py);
    let [a, b] = patch.ellipse();
    let figures = [
        ("approach", patch.approach),
        ("force", patch.force),
        ("max_pressure", patch.max_pressure),
        ("area", patch.area),
        ("origin", patch.origin),
        ("a", a),
        ("b", b),
    ];
    for (name, value) in figures {
        out.set_item(name, value)?;
    }
    Ok((out, table(vec![("y", patch.y), ("half_length", patch.half_length)])?))
}

/// Gap of the undeformed surfaces across the place where one wheel of a standing wheelset touches first.
#[pyfunction]
pub fn contact_gap(
    py: Python<'_>,
    pair_json: &str,
    y: f64,
    right: bool,
    half_width: f64,
    step: f64,
) -> PyResult<Frame> {
    let found = py.detach(|| -> railsim::Result<Vec<GapPoint>> {
        let pair = Pair::from_json(pair_json)?;
        let rails = [RailShift::default(); 2];
        let side = usize::from(right);
        let gap = || {
            let standing = pair.stand(y, 0.0, &rails)?;
            let pose = pair.poses(y, standing.z, standing.roll, 0.0)[side];
            let touch = if right { &standing.right } else { &standing.left };
            let touch = touch.first().ok_or(NoContact::BesideTheRail)?;
            pair.sides[side].gap_profile(&pose, &rails[side], touch, half_width, step)
        };
        gap().map_err(|e| {
            Error::input(Fault::new(
                KeyPath::of("y"),
                format!("{y} m: {e}"),
                "a shift at which both wheels stand",
            ))
        })
    });
    let found = found.map_err(|e| raise(py, e))?;
    let column = |of: fn(&GapPoint) -> f64| found.iter().map(of).collect();
    table(vec![("s", column(|p| p.s)), ("gap", column(|p| p.gap)), ("k_xx", column(|p| p.k_xx))])
}
