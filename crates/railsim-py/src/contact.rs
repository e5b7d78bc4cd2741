//! What contact geometry says of a pair of profiles, and the tables that cases share.

use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use railsim::contact::geometry_table;
use railsim::dynamics::compile::geometry_table;
use railsim::schema::Case;

use crate::errors::raise;

/// What calls share: contact tables, and the case that was read last, of which several things are asked in a row.
#[pyclass(frozen, module = "lmap._railsim")]
#[derive(Default)]
pub struct Tables {
    pub tables: geometry_table::Tables,
    last: Mutex<Option<(String, Case)>>,
}

#[pymethods]
impl Tables {
    #[new]
    fn new() -> Self {
        Self::default()
    }
}

/// A case from its JSON, with the tables of others where there are any. Other threads have the GIL meanwhile: a suite's cases are read
/// while others are judged.
pub fn read(py: Python<'_>, case_json: &str, tables: Option<&Tables>) -> PyResult<Case> {
    let parsed = || py.detach(|| Case::from_json(case_json)).map_err(|e| raise(py, e));
    let Some(shared) = tables else { return parsed() };
    // Held for no longer than a comparison or a clone, and whole even where a holder has panicked.
    let last = || shared.last.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((text, case)) = &*last()
        && text == case_json
    {
        return Ok(case.clone());
    }
    let mut case = parsed()?;
    case.tables = shared.tables.clone();
    *last() = Some((case_json.to_owned(), case.clone()));
    Ok(case)
}

/// Equivalent conicity of the case's wheels on its rails.
#[pyfunction]
#[pyo3(signature = (case_json, amplitude, tables=None))]
pub fn equivalent_conicity(
    py: Python<'_>,
    case_json: &str,
    amplitude: f64,
    tables: Option<&Tables>,
) -> PyResult<Option<f64>> {
    let case = read(py, case_json, tables)?;
    py.detach(|| geometry_table(&case).map(|table| table.equivalent_conicity(amplitude)))
        .map_err(|e| raise(py, e))
}
