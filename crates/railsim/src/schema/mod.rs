//! What the user writes: vehicle, track and run, read from TOML or JSON, expanded, checked, typed.
//!
//! A document goes one way: named parameters are overridden (`set`, then the operating condition), templates are
//! copied, references become numbers, the structure is held against the JSON schema of the types that serde
//! fills, and relations between keys are checked. Faults are collected; each names the key as written.

mod build;
mod case;
mod check;
mod document;
pub mod drive;
mod node;
mod parameter;
pub mod run;
mod run_check;
mod summary;
mod template;
mod toml_source;
pub mod track;
mod vehicle;
mod written;

pub use case::{Case, FORMAT, ProfileData, ProfileKind, case_schema};
pub use document::vehicle_schema;
pub use run::{Run, RunKind};
pub use summary::resolve_summary;
pub use toml_source::{SyntaxError, line_of, syntax_error, toml_to_json};
pub use track::{Support, Track};
pub use vehicle::{
    AirBrake, Axis, Body, Connection, ContactSettings, DynamicBrake, Equipment, Gap, Load, Outline,
    ParkingBrake, Sensor, Shape, SpeedHold, Thermal, Traction, Vehicle, Wheelset,
};
