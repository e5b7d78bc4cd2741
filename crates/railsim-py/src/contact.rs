//! What contact geometry says of a pair of profiles, and the tables that cases share.

use pyo3::prelude::*;
use railsim::contact::geometry_table;
use railsim::dynamics::compile::geometry_table;
use railsim::schema::Case;

use crate::errors::raise;

/// Contact tables that calls share.
#[pyclass(frozen, module = "lmap._railsim")]
#[derive(Default)]
pub struct Tables(pub geometry_table::Tables);

#[pymethods]
impl Tables {
    #[new]
    fn new() -> Self {
        Self::default()
    }
}

/// A case from its JSON, with the tables of others where there are any.
pub fn read(py: Python<'_>, case_json: &str, tables: Option<&Tables>) -> PyResult<Case> {
    let mut case = Case::from_json(case_json).map_err(|e| raise(py, e))?;
    if let Some(tables) = tables {
        case.tables = tables.0.clone();
    }
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
