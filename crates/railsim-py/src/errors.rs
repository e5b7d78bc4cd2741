//! The core's errors as Python exceptions: one base, one class for each variant.

use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use railsim::error::Segment;
use railsim::{Error, Fault, KeyPath};

create_exception!(lmap._railsim, RailsimError, PyException, "Base of everything the core raises.");
create_exception!(lmap._railsim, InputError, RailsimError, "Bad input; `faults` lists every fault found.");
create_exception!(lmap._railsim, ConvergenceError, RailsimError, "An iteration did not reach its tolerance.");
create_exception!(lmap._railsim, DivergenceError, RailsimError, "A run left what the model describes.");
create_exception!(lmap._railsim, Interrupted, RailsimError, "Stopped from outside.");
create_exception!(lmap._railsim, InternalError, RailsimError, "A fault of the program itself: a panic.");

/// Why a piece of work has no result.
#[derive(Debug)]
pub enum Failure {
    /// The core said so.
    Core(Error),
    /// It panicked; the message of the panic.
    Panic(String),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Core(error)
    }
}

impl Failure {
    /// The exception that Python sees.
    pub fn into_py_err(self, py: Python<'_>) -> PyErr {
        let error = match self {
            Self::Core(error) => error,
            Self::Panic(message) => {
                return InternalError::new_err(format!(
                    "internal error: {message}; this is a fault of the program, please report it"
                ));
            }
        };
        let message = error.to_string();
        let made = match error {
            Error::Input(faults) => {
                return input_error(py, &message, faults.into_iter().map(|fault| (None, fault)));
            }
            Error::NotConverged { what, iterations, residual, unit, worst } => {
                let made = ConvergenceError::new_err(message);
                attributes(py, &made, |value| {
                    value.setattr("what", what)?;
                    value.setattr("iterations", iterations)?;
                    value.setattr("residual", residual)?;
                    value.setattr("unit", unit)?;
                    value.setattr("worst", worst)
                })
                .map(|()| made)
            }
            Error::Diverged { t, s, body, cause } => {
                let made = DivergenceError::new_err(message);
                attributes(py, &made, |value| {
                    value.setattr("t", t)?;
                    value.setattr("s", s)?;
                    value.setattr("body", body)?;
                    value.setattr("cause", cause)
                })
                .map(|()| made)
            }
            Error::Interrupted => Ok(Interrupted::new_err(message)),
        };
        made.unwrap_or_else(|failed| failed)
    }
}

/// A core error as a Python exception.
pub fn raise(py: Python<'_>, error: Error) -> PyErr {
    Failure::from(error).into_py_err(py)
}

fn attributes(
    py: Python<'_>,
    error: &PyErr,
    set: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<()>,
) -> PyResult<()> {
    set(error.value(py).as_any())
}

/// An `InputError` with its faults, each with its line where that is known.
pub fn input_error(
    py: Python<'_>,
    message: &str,
    faults: impl IntoIterator<Item = (Option<usize>, Fault)>,
) -> PyErr {
    let error = InputError::new_err(message.to_owned());
    let set = || -> PyResult<()> {
        let list = PyList::empty(py);
        for (line, fault) in faults {
            list.append(fault_dict(py, &fault, line)?)?;
        }
        error.value(py).setattr("faults", list)
    };
    match set() {
        Ok(()) => error,
        Err(failed) => failed,
    }
}

fn fault_dict<'py>(py: Python<'py>, fault: &Fault, line: Option<usize>) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("key", key_list(py, &fault.key)?)?;
    dict.set_item("path", fault.key.to_string())?;
    dict.set_item("found", &fault.found)?;
    dict.set_item("allowed", &fault.allowed)?;
    dict.set_item("hint", &fault.hint)?;
    dict.set_item("line", line)?;
    Ok(dict)
}

fn key_list<'py>(py: Python<'py>, key: &KeyPath) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for segment in &key.0 {
        match segment {
            Segment::Key(key) => list.append(key)?,
            Segment::Index(index) => list.append(index)?,
        }
    }
    Ok(list)
}
