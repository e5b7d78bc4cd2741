//! Profiles and what contact geometry says of them.

use pyo3::prelude::*;
use serde_json::json;

use crate::core;
use crate::core::schema::Case;
use crate::errors::raise;

/// A profile file's text as JSON, in millimetres.
#[pyfunction]
pub fn read_profile(py: Python<'_>, text: &str, name: &str) -> PyResult<String> {
    let points = core::contact::profile::read_csv(text, name).map_err(|e| raise(py, e))?;
    let points: Vec<[f64; 2]> = points.iter().map(|[y, z]| [y * 1e3, z * 1e3]).collect();
    Ok(json!({"points": points}).to_string())
}

/// Equivalent conicity of the case's wheels on its rails.
#[pyfunction]
pub fn equivalent_conicity(py: Python<'_>, case_json: &str, amplitude: f64) -> PyResult<f64> {
    let case = Case::from_json(case_json).map_err(|e| raise(py, e))?;
    py.detach(|| core::contact::equivalent_conicity(&case, amplitude)).map_err(|e| raise(py, e))
}
