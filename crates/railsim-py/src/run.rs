//! Cases: checking, running, and what a run records.

use std::collections::BTreeMap;
use std::iter::once;
use std::num::NonZeroUsize;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedStr;
use pyo3::types::{PyDict, PyIterator};
use railsim::KeyPath;
use railsim::analysis;
use railsim::run::{Action, Law, Outcome, Outside, simulate_controlled};
use railsim::schema::Case;
use railsim::track::irregularity::DeviationField;

use crate::arrow::Frame;
use crate::contact::{Tables, read};
use crate::enter::{Finished, Listener, Progress, enter};
use crate::errors::raise;

/// Version of the package.
#[pyfunction]
pub fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// SHA-256 of the core's sources.
#[pyfunction]
pub fn fingerprint() -> &'static str {
    env!("RAILSIM_FINGERPRINT")
}

/// Every fault of a case, at once.
#[pyfunction]
#[pyo3(signature = (case_json, tables=None))]
pub fn check_case(py: Python<'_>, case_json: &str, tables: Option<&Tables>) -> PyResult<()> {
    read(py, case_json, tables).map(drop)
}

/// Name, unit and meaning of every channel.
#[pyfunction]
#[pyo3(signature = (case_json, tables=None))]
pub fn channels(
    py: Python<'_>,
    case_json: &str,
    tables: Option<&Tables>,
) -> PyResult<Vec<(String, &'static str, &'static str)>> {
    let case = read(py, case_json, tables)?;
    let channels = analysis::channels(&case).map_err(|e| raise(py, e))?;
    Ok(channels.into_iter().map(|c| (c.name, c.unit, c.meaning)).collect())
}

/// Smallest and largest value of each track irregularity.
#[pyfunction]
#[pyo3(signature = (case_json, tables=None))]
pub fn track_extremes(
    py: Python<'_>,
    case_json: &str,
    tables: Option<&Tables>,
) -> PyResult<BTreeMap<&'static str, (f64, f64)>> {
    let case = read(py, case_json, tables)?;
    let extremes = py.detach(|| {
        let track = &case.track;
        let at = KeyPath::of("track.irregularity");
        DeviationField::new(&track.irregularity, track.length, track.fade_start, track.fade_in, &at)
            .map(|field| field.extremes())
    });
    let extremes = extremes.map_err(|e| raise(py, e))?;
    Ok(["lateral", "vertical", "cross_level", "gauge"].into_iter().zip(extremes).collect())
}

/// Runs cases on `jobs` threads, begun in their order; results and progress go to the callbacks. `cases` may be any iterable of
/// JSON: it is asked for the next one when a thread is free, on that thread.
#[pyfunction]
#[pyo3(signature = (cases, jobs, on_progress, on_done, tables=None))]
pub fn run_cases(
    py: Python<'_>,
    cases: &Bound<'_, PyAny>,
    jobs: NonZeroUsize,
    on_progress: Py<PyAny>,
    on_done: Py<PyAny>,
    tables: Option<&Tables>,
) -> PyResult<()> {
    // A batch shares its tables whether the caller wants them afterwards or not.
    let tables = tables.map(|t| t.tables.clone()).unwrap_or_default();
    enter(
        py,
        Texts(cases.try_iter()?.unbind()),
        jobs,
        |text: PyBackedStr, control| {
            let mut case = Case::from_json(&text)?;
            case.tables = tables.clone();
            analysis::run(&case, control)
        },
        &mut Callbacks { on_progress, on_done },
    )
}

/// Runs one case with a Python function as control law: `controller(t, seen)` with `seen` a dict of the channels, gives a dict with
/// `torque` (N m, a number for each wheelset) and `independent_brake` (Pa), or nothing.
#[pyfunction]
pub fn run_controlled(
    py: Python<'_>,
    case_json: String,
    name: String,
    channels: Vec<String>,
    controller: Py<PyAny>,
    on_progress: Py<PyAny>,
    on_done: Py<PyAny>,
) -> PyResult<()> {
    let controller = &controller;
    enter(
        py,
        once(Ok(case_json)),
        NonZeroUsize::MIN,
        |case_json: String, control| {
            let mut law = PythonLaw { controller, channels: &channels };
            let mut outside = Outside { name: name.clone(), channels: channels.clone(), law: &mut law };
            simulate_controlled(&Case::from_json(&case_json)?, control, &mut outside)
        },
        &mut Callbacks { on_progress, on_done },
    )
}

/// What a Python iterator gives.
struct Texts(Py<PyIterator>);

impl Iterator for Texts {
    type Item = PyResult<PyBackedStr>;

    fn next(&mut self) -> Option<Self::Item> {
        Python::attach(|py| self.0.bind(py).clone().next().map(|text| Ok(text?.extract()?)))
    }
}

/// A Python function as control law.
struct PythonLaw<'a> {
    controller: &'a Py<PyAny>,
    channels: &'a [String],
}

impl Law for PythonLaw<'_> {
    fn sample(&mut self, t: f64, seen: &[f64]) -> Result<Action, String> {
        Python::attach(|py| {
            let dict = PyDict::new(py);
            for (name, value) in self.channels.iter().zip(seen) {
                dict.set_item(name, value)?;
            }
            let answer = self.controller.bind(py).call1((t, dict))?;
            if answer.is_none() {
                return Ok(Action::default());
            }
            let answer = answer.cast_into::<PyDict>()?;
            let mut action = Action::default();
            for (key, value) in answer.iter() {
                match key.extract::<String>()?.as_str() {
                    "torque" => action.torque = Some(value.extract()?),
                    "independent_brake" => action.independent_brake = Some(value.extract()?),
                    other => {
                        let message = format!("an answer with `{other}`; allowed: torque, independent_brake");
                        return Err(PyValueError::new_err(message));
                    }
                }
            }
            Ok(action)
        })
        .map_err(|error: PyErr| error.to_string())
    }
}

/// Hands what happens to two Python functions.
pub struct Callbacks {
    /// `on_progress(index, fraction, distance_m, real_time_factor)`
    pub on_progress: Py<PyAny>,
    /// `on_done(index, frame or exception)`
    pub on_done: Py<PyAny>,
}

impl Listener for Callbacks {
    type Output = Outcome;

    fn progress(&mut self, py: Python<'_>, index: usize, progress: Progress) -> PyResult<()> {
        let Progress { fraction, distance, real_time_factor } = progress;
        self.on_progress.call1(py, (index, fraction, distance, real_time_factor)).map(drop)
    }

    fn done(&mut self, py: Python<'_>, finished: Finished<Outcome>) -> PyResult<()> {
        let Finished { index, result, wall_s } = finished;
        match result.map_err(|e| e.into_py_err(py)).and_then(|outcome| Frame::new(outcome, wall_s)) {
            Ok(frame) => self.on_done.call1(py, (index, frame)),
            Err(error) => self.on_done.call1(py, (index, error.into_value(py))),
        }
        .map(drop)
    }
}
