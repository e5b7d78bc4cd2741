//! TOML text as JSON, and the line of a key.

use pyo3::prelude::*;
use railsim::error::Segment;
use railsim::schema::{SyntaxError, line_of, syntax_error};
use railsim::{Error, Fault, KeyPath, schema};

use crate::errors::{input_error, raise};

/// A TOML document as JSON text.
#[pyfunction]
pub fn toml_to_json(py: Python<'_>, text: &str) -> PyResult<String> {
    refuse_syntax_error(py, text)?;
    match schema::toml_to_json(text) {
        Ok(json) => Ok(json.to_string()),
        Err(Error::Input(faults)) => {
            let message = Error::Input(faults.clone()).to_string();
            let faults: Vec<_> = faults.into_iter().map(|f| (line_of(text, &f.key), f)).collect();
            Err(input_error(py, &message, faults))
        }
        Err(other) => Err(raise(py, other)),
    }
}

/// Line, from 1, of the deepest part of `key` that exists; nothing where not even its first part does.
#[pyfunction]
pub fn toml_line(py: Python<'_>, text: &str, key: Vec<KeyPart>) -> PyResult<Option<usize>> {
    refuse_syntax_error(py, text)?;
    Ok(line_of(text, &KeyPath(key.into_iter().map(Segment::from).collect())))
}

/// One part of a key path as Python gives it.
#[derive(FromPyObject)]
pub enum KeyPart {
    /// Index into an array.
    Index(usize),
    /// Key of a table.
    Key(String),
}

impl From<KeyPart> for Segment {
    fn from(part: KeyPart) -> Self {
        match part {
            KeyPart::Index(index) => Self::Index(index),
            KeyPart::Key(key) => Self::Key(key),
        }
    }
}

fn refuse_syntax_error(py: Python<'_>, text: &str) -> PyResult<()> {
    let Some(SyntaxError { line, column, message }) = syntax_error(text) else { return Ok(()) };
    let written = text.lines().nth(line - 1).unwrap_or("").trim();
    let found = format!("`{written}`: {message}");
    let told = format!("line {line}, column {column}: not TOML: {found}");
    Err(input_error(py, &told, [(Some(line), Fault::new(KeyPath::default(), found, "TOML"))]))
}
