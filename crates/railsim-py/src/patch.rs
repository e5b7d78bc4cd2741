//! Contact patches: Hertz's, and those that are no ellipses. Arrays come as buffers of doubles and leave as their bytes.

use std::f64::consts::PI;

use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use railsim::contact::hertz as law;
use railsim::contact::non_elliptic::{Bodies, Gap};
use railsim::{Error, Fault, KeyPath};

use crate::errors::raise;

/// Doubles as bytes for numpy.frombuffer.
fn bytes<'py>(py: Python<'py>, values: impl IntoIterator<Item = f64>) -> Bound<'py, PyBytes> {
    let raw: Vec<u8> = values.into_iter().flat_map(f64::to_ne_bytes).collect();
    PyBytes::new(py, &raw)
}

/// Semi-axes along and across, approach and peak pressure of Hertz's patch, for arrays of equal length.
#[pyfunction]
pub fn hertz<'py>(
    py: Python<'py>,
    force: PyBuffer<f64>,
    kx: PyBuffer<f64>,
    ky: PyBuffer<f64>,
    youngs_modulus: f64,
    poisson: f64,
) -> PyResult<[Bound<'py, PyBytes>; 4]> {
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
    Ok(out.map(|column| bytes(py, column)))
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
) -> PyResult<Bound<'py, PyDict>> {
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
    out.set_item("y", bytes(py, patch.y))?;
    out.set_item("half_length", bytes(py, patch.half_length))?;
    Ok(out)
}
