//! What contact geometry says of a pair of profiles.

use pyo3::prelude::*;
use railsim::dynamics::compile::geometry_table;
use railsim::schema::Case;

use crate::errors::raise;

/// Equivalent conicity of the case's wheels on its rails.
#[pyfunction]
pub fn equivalent_conicity(py: Python<'_>, case_json: &str, amplitude: f64) -> PyResult<Option<f64>> {
    let case = Case::from_json(case_json).map_err(|e| raise(py, e))?;
    py.detach(|| geometry_table(&case).map(|table| table.equivalent_conicity(amplitude)))
        .map_err(|e| raise(py, e))
}
