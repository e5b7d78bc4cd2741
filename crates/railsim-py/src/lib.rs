//! Python bindings of railsim: the module `lmap._railsim`.
//!
//! Plain data goes in (TOML and JSON text), handles with Arrow columns and JSON come out. No physics in
//! here. What Python users read stands in `python/lmap/_railsim.pyi`, which is checked against this module.

mod arrow;
mod contact;
mod creep;
mod enter;
mod errors;
mod geometry;
mod lint;
mod patch;
mod probe;
mod profile;
mod run;
mod toml;
mod vehicle;

/// The compiled module.
#[pyo3::pymodule(name = "_railsim")]
mod module {
    #[pymodule_export]
    use crate::arrow::Frame;
    #[pymodule_export]
    use crate::contact::{Tables, equivalent_conicity};
    #[pymodule_export]
    use crate::creep::{creep_forces, kalker_coefficients};
    #[pymodule_export]
    use crate::errors::{
        ConvergenceError, DivergenceError, InputError, InternalError, Interrupted, RailsimError,
    };
    #[pymodule_export]
    use crate::geometry::{contact_map, curve_conicity, pair_conicity, rolling_radius_difference};
    #[pymodule_export]
    use crate::lint::{lint_codes, lint_vehicle};
    #[pymodule_export]
    use crate::patch::{contact_gap, hertz, non_elliptic};
    #[pymodule_export]
    use crate::probe::_run_probes;
    #[pymodule_export]
    use crate::profile::{inspect_profile, profile_quality, read_profile, smooth_profile, write_profile};
    #[pymodule_export]
    use crate::run::{channel_parts, channels, check_case, fingerprint, run_cases, track_extremes, version};
    #[pymodule_export]
    use crate::toml::{toml_line, toml_to_json};
    #[pymodule_export]
    use crate::vehicle::{case_schema, vehicle_resolve, vehicle_schema};
}
