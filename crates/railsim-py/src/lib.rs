//! Python bindings of railsim: the module `lmap._railsim`.
//!
//! Plain data goes in (TOML and JSON text), handles with Arrow columns and JSON come out. No physics in
//! here. What Python users read stands in `python/lmap/_railsim.pyi`, which is checked against this module.

mod arrow;
mod contact;
mod enter;
mod errors;
mod lint;
mod probe;
mod run;
mod toml;
mod vehicle;

/// The compiled module.
#[pyo3::pymodule(name = "_railsim")]
mod module {
    #[pymodule_export]
    use crate::arrow::Frame;
    #[pymodule_export]
    use crate::contact::{equivalent_conicity, read_profile};
    #[pymodule_export]
    use crate::errors::{
        ConvergenceError, DivergenceError, InputError, InternalError, Interrupted, RailsimError,
    };
    #[pymodule_export]
    use crate::lint::{lint_codes, lint_vehicle};
    #[pymodule_export]
    use crate::probe::_run_probes;
    #[pymodule_export]
    use crate::run::{channels, check_case, fingerprint, run_cases, track_extremes, version};
    #[pymodule_export]
    use crate::toml::{toml_line, toml_to_json};
    #[pymodule_export]
    use crate::vehicle::{vehicle_resolve, vehicle_schema};
}
