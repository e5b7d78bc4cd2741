//! What looks wrong in a vehicle that cannot even be read, and the codes of all findings.

use pyo3::prelude::*;
use railsim::lint::{CODES, to_json, unreadable};
use serde_json::{Value, json};

use crate::errors::raise;
use crate::vehicle::parse;

/// What the schema refuses of a vehicle document, as findings.
#[pyfunction]
#[pyo3(signature = (document_json, overrides_json, condition=None))]
pub fn lint_vehicle(
    py: Python<'_>,
    document_json: &str,
    overrides_json: &str,
    condition: Option<&str>,
) -> PyResult<String> {
    let find = || {
        let (document, overrides) = (parse("vehicle", document_json)?, parse("set", overrides_json)?);
        Ok(unreadable(&document, &overrides, condition).iter().map(to_json).collect::<Value>().to_string())
    };
    find().map_err(|e| raise(py, e))
}

/// Every code.
#[pyfunction]
pub fn lint_codes() -> String {
    let row = |c: &railsim::lint::Code| {
        json!({
            "code": c.code,
            "rule": c.name,
            "severity": c.severity.name(),
            "summary": c.summary,
        })
    };
    CODES.iter().map(row).collect::<Value>().to_string()
}
