//! Vehicles as resolved data.

use pyo3::prelude::*;

use railsim::schema::{self, resolve_summary};
use railsim::{Error, Fault, KeyPath};
use serde::de::DeserializeOwned;

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
    let resolve = || {
        let (document, overrides) = (parse("vehicle", document_json)?, parse("set", overrides_json)?);
        resolve_summary(&document, &overrides, condition).map(|summary| summary.to_string())
    };
    py.detach(resolve).map_err(|e| raise(py, e))
}

/// JSON schema of a vehicle file.
#[pyfunction]
pub fn vehicle_schema() -> String {
    schema::vehicle_schema().to_string()
}

/// JSON schemas of a case's tables, by name.
#[pyfunction]
pub fn case_schema() -> String {
    schema::case_schema().to_string()
}

/// A JSON argument.
pub fn parse<T: DeserializeOwned>(key: &str, text: &str) -> railsim::Result<T> {
    let fault = |e: serde_json::Error| Fault::new(KeyPath::of(key), e.to_string(), "a JSON object");
    serde_json::from_str(text).map_err(|e| Error::input(fault(e)))
}
