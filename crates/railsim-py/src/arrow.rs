//! The core's columns as an Arrow stream: moved, never copied.

use std::sync::Arc;

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, RecordBatchIterator, StringArray};
use arrow_schema::{DataType, Field, Schema};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict};
use serde_json::json;

use crate::errors::InternalError;
use railsim::run::{Ended, Outcome};

/// One finished case: columns of floats of equal length, and how the run ended.
#[pyclass(frozen, module = "lmap._railsim")]
pub struct Frame {
    batch: RecordBatch,
    ended: serde_json::Value,
    statistics: serde_json::Value,
    wall_s: f64,
}

impl Frame {
    /// Takes over the columns of an outcome that took `wall_s` seconds to compute.
    ///
    /// # Errors
    /// `InternalError` when the columns differ in length.
    pub fn new(outcome: Outcome, wall_s: f64) -> PyResult<Self> {
        let last = |name: &str| {
            let column = outcome.columns.iter().find(|(n, _)| n == name);
            column.and_then(|(_, values)| values.last().copied())
        };
        let ended = match &outcome.ended {
            Ended::EndOfTrack => {
                json!({"kind": "end_of_track", "t": last("t"), "s": last("s"), "message": null})
            }
            Ended::Complete => {
                json!({"kind": "complete", "t": last("t"), "s": last("s"), "message": null})
            }
            Ended::Diverged(error) => {
                let (t, s) = match error {
                    railsim::Error::Diverged { t, s, .. } => (Some(*t), Some(*s)),
                    _ => (last("t"), last("s")),
                };
                json!({"kind": "diverged", "t": t, "s": s, "message": error.to_string()})
            }
        };
        let batch = batch(outcome.columns, outcome.labels)?;
        Ok(Self { batch, ended, statistics: outcome.statistics, wall_s })
    }

    /// Columns that are no run's.
    ///
    /// # Errors
    /// `InternalError` when the columns differ in length.
    pub fn table(columns: Vec<(String, Vec<f64>)>) -> PyResult<Self> {
        let ended = json!({"kind": "computed", "t": null, "s": null, "message": null});
        Ok(Self { batch: batch(columns, Vec::new())?, ended, statistics: json!({}), wall_s: 0.0 })
    }
}

fn batch(columns: Vec<(String, Vec<f64>)>, labels: Vec<(String, Vec<String>)>) -> PyResult<RecordBatch> {
    let mut fields = Vec::with_capacity(columns.len());
    let mut arrays: Vec<ArrayRef> = Vec::with_capacity(columns.len());
    for (name, values) in columns {
        fields.push(Field::new(name, DataType::Float64, false));
        arrays.push(Arc::new(Float64Array::new(values.into(), None)));
    }
    for (name, texts) in labels {
        fields.push(Field::new(name, DataType::Utf8, false));
        arrays.push(Arc::new(StringArray::from(texts)));
    }
    RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays)
        .map_err(|e| InternalError::new_err(format!("columns of a frame: {e}")))
}

#[pymethods]
impl Frame {
    #[getter]
    fn names(&self) -> Vec<String> {
        self.batch.schema_ref().fields().iter().map(|field| field.name().clone()).collect()
    }

    #[getter]
    fn rows(&self) -> usize {
        self.batch.num_rows()
    }

    #[getter]
    fn ended<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        to_dict(py, &self.ended)
    }

    #[getter]
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        to_dict(py, &self.statistics)
    }

    #[getter]
    fn wall_s(&self) -> f64 {
        self.wall_s
    }

    /// Hands out the columns, not copies. Every column is float64 whatever was asked for: the protocol makes
    /// `requested_schema` a wish.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyCapsule>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        drop(requested_schema);
        let batches = RecordBatchIterator::new([Ok(self.batch.clone())], self.batch.schema());
        PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(batches)), c"arrow_array_stream")
    }

    fn __repr__(&self) -> String {
        format!(
            "Frame({} rows x {} columns, {})",
            self.batch.num_rows(),
            self.batch.num_columns(),
            self.ended["kind"].as_str().unwrap_or("")
        )
    }
}

/// A JSON object as a Python dict.
fn to_dict<'py>(py: Python<'py>, value: &serde_json::Value) -> PyResult<Bound<'py, PyDict>> {
    let parsed = py.import("json")?.call_method1("loads", (value.to_string(),))?;
    Ok(parsed.cast_into::<PyDict>()?)
}
