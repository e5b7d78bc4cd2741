//! Profiles and what contact geometry says of them.

use pyo3::prelude::*;
use railsim::contact::profile::read_csv;
use railsim::dynamics::compile::geometry_table;
use railsim::schema::Case;
use serde_json::json;

use crate::errors::raise;

/// A profile file's text as JSON, in millimetres.
#[pyfunction]
pub fn read_profile(py: Python<'_>, text: &str, name: &str) -> PyResult<String> {
    let points = read_csv(text, name).map_err(|e| raise(py, e))?;
    let points: Vec<[f64; 2]> = points.iter().map(|point| point.map(millimetres)).collect();
    Ok(json!({"points": points}).to_string())
}

/// Equivalent conicity of the case's wheels on its rails.
#[pyfunction]
pub fn equivalent_conicity(py: Python<'_>, case_json: &str, amplitude: f64) -> PyResult<Option<f64>> {
    let case = Case::from_json(case_json).map_err(|e| raise(py, e))?;
    py.detach(|| geometry_table(&case).map(|table| table.equivalent_conicity(amplitude)))
        .map_err(|e| raise(py, e))
}

/// Metres as millimetres, to the picometre: 1e3 times the number that 1e-3 made out of 46.1 is not 46.1.
fn millimetres(metres: f64) -> f64 {
    (metres * 1e12).round() / 1e9
}
