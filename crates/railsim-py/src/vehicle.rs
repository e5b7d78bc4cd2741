//! Vehicles as resolved data.

use pyo3::prelude::*;

use crate::core::schema;
use crate::errors::raise;

/// A vehicle document with its overrides applied, and what a procedure asks of it, as JSON.
#[pyfunction]
#[pyo3(signature = (document_json, overrides_json, condition=None))]
pub fn vehicle_resolve(
    py: Python<'_>,
    document_json: &str,
    overrides_json: &str,
    condition: Option<&str>,
) -> PyResult<String> {
    schema::resolve_vehicle(document_json, overrides_json, condition).map_err(|e| raise(py, e))
}
