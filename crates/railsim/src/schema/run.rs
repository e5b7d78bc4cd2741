//! `run` of a case: what is done, how fast, with which laws.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::contact::creep::CreepLaw;
use crate::contact::friction::Friction;
use crate::integrator::Integrator;

/// What is done with the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RunKind {
    /// Time stepping along the track.
    Time,
}

/// How a case is run.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// What is done.
    pub kind: RunKind,
    /// Speed, m/s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s"))]
    pub speed: f64,
    /// Coefficient of friction between wheel and rail: a number, or a table per rail, along the track, falling with the slip velocity.
    pub friction: Friction,
    /// Name of the wheel profile in `profiles`; the vehicle's own if absent. After reading always a name.
    #[serde(default)]
    pub wheel_profile: String,
    /// Creep force law; FASTSIM if absent.
    #[serde(default)]
    pub creep: CreepLaw,
    /// Integrator with its step.
    pub integrator: Integrator,
    /// Time between rows of the result, s; a whole multiple of the integrator's step.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "s"))]
    pub output_step: f64,
    /// Acceleration of gravity, m/s2; 9.80665, the standard value, if absent.
    #[serde(default = "standard_gravity")]
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s2"))]
    pub gravity: f64,
}

fn standard_gravity() -> f64 {
    9.80665
}
