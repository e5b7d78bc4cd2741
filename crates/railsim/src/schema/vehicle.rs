//! The vehicle: bodies, wheelsets, connections and sensors in vehicle axes, every number resolved.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::document::{Document, finish};
use crate::connection::Law;
use crate::error::{KeyPath, Result};

/// A vehicle in one operating condition. Positions are in vehicle axes: origin at the vehicle's centre at top of rail,
/// x forward, y right, z down (heights are negative), m.
#[derive(Debug, Clone, PartialEq)]
pub struct Vehicle {
    /// Name, as files and reports use it.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Design speed, m/s.
    pub design_speed: f64,
    /// Name of the wheel profile, unless the run says otherwise.
    pub wheel_profile: String,
    /// Name of the track it is tested on, unless the spec says otherwise.
    pub track: String,
    /// The condition whose numbers these are.
    pub condition: String,
    /// The condition in which the vehicle stands at the written heights.
    pub design_condition: String,
    /// Car body, bogies: all bodies but the wheelsets, in the order of the file.
    pub bodies: Vec<Body>,
    /// Wheelsets, in the order of the file.
    pub wheelsets: Vec<Wheelset>,
    /// Connections, mirrored ones as two (right, then left).
    pub connections: Vec<Connection>,
    /// Named points.
    pub sensors: Vec<Sensor>,
    /// What holds the speed, if anything.
    pub speed_hold: Option<SpeedHold>,
    /// Wheel and rail material.
    pub contact: ContactSettings,
    /// Outer dimensions.
    pub outline: Option<Outline>,
    /// Traction equipment.
    pub traction: Option<Traction>,
    /// Dynamic brake.
    pub dynamic_brake: Option<DynamicBrake>,
}

/// A body other than a wheelset.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name, as in channels.
    pub name: String,
    /// Mass, kg.
    pub mass: f64,
    /// Principal moments of inertia Ixx, Iyy, Izz about the centre of mass, kg m2.
    pub inertia: [f64; 3],
    /// Centre of mass, m.
    pub position: [f64; 3],
    /// Where it was written.
    pub key: KeyPath,
}

/// A wheelset.
#[derive(Debug, Clone, PartialEq)]
pub struct Wheelset {
    /// Name, as in channels.
    pub name: String,
    /// Mass, kg.
    pub mass: f64,
    /// Principal moments of inertia Ixx, Iyy (about the axle), Izz, kg m2.
    pub inertia: [f64; 3],
    /// Centre, m; z = -radius.
    pub position: [f64; 3],
    /// Wheel radius at the tape circle, m.
    pub radius: f64,
    /// Lateral distance of the tape circle from the centre, m.
    pub tape_half_distance: f64,
    /// Where it was written.
    pub key: KeyPath,
}

/// A force element between two bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct Connection {
    /// Name; of a mirrored one with `_right` or `_left`.
    pub name: String,
    /// Names of bodies A and B.
    pub between: [String; 2],
    /// Nominal points on A and on B, m.
    pub points: [[f64; 3]; 2],
    /// The law.
    pub law: Law,
    /// Takes part in carrying the vehicle (`carries_weight` in the file).
    pub preload: bool,
    /// Where it was written.
    pub key: KeyPath,
}

/// A named point on a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Full name, `<body>.<name>`.
    pub name: String,
    /// The body.
    pub body: String,
    /// Nominal point, m.
    pub position: [f64; 3],
    /// Where it was written.
    pub key: KeyPath,
}

/// Spring and damper between a body and a frame that moves at the nominal speed; x only.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpeedHold {
    /// The body.
    pub body: String,
    /// Stiffness, N/m.
    #[schemars(extend("minimum" = 0, "unit" = "N/m"))]
    pub stiffness: f64,
    /// Damping, N s/m.
    #[schemars(extend("minimum" = 0, "unit" = "N s/m"))]
    pub damping: f64,
}

/// Wheel and rail material, the same for both.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ContactSettings {
    /// Young's modulus, Pa.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "Pa"))]
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 0.5))]
    pub poisson: f64,
    /// Damping of the normal contact at the static wheel load, N s/m.
    #[schemars(extend("minimum" = 0, "unit" = "N s/m"))]
    pub damping: f64,
}

/// Outer dimensions, m.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Outline {
    /// Between the pulling faces of the couplers, m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub length_over_couplers: f64,
    /// Coupler above rail, m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub coupler_height: f64,
    /// Width, m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub width: f64,
    /// Height above rail, m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub height: f64,
}

/// Traction equipment, one inverter for each bogie.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Traction {
    /// Starting effort of the vehicle, N.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N"))]
    pub max_effort: f64,
    /// Power at the rail, W.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "W"))]
    pub power_at_rail: f64,
    /// Notches of the controller.
    #[schemars(extend("minimum" = 1))]
    pub notches: u32,
    /// Slip that the controller asks for, as a share of the speed.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub slip_reference: f64,
    /// Slip that it does not pass.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub slip_limit: f64,
    /// Proportional gain, N m per unit slip, each axle.
    #[schemars(extend("minimum" = 0, "unit" = "N m"))]
    pub kp: f64,
    /// Integral gain, N m per unit slip and second, each axle.
    #[schemars(extend("minimum" = 0, "unit" = "N m/s"))]
    pub ki: f64,
    /// First-order lag of inverter and motor, s.
    #[schemars(extend("minimum" = 0, "unit" = "s"))]
    pub lag: f64,
}

/// Dynamic brake.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DynamicBrake {
    /// Largest effort, N.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N"))]
    pub max_effort: f64,
    /// Effort fades to nothing below this speed, km/h.
    #[schemars(extend("minimum" = 0, "unit" = "km/h"))]
    pub fade_below_kmh: f64,
    /// Effort falls with constant power above this speed, km/h.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "km/h"))]
    pub constant_power_above_kmh: f64,
    /// Rotary masses of the locomotive and its train as a mass at the rail, kg.
    #[schemars(extend("minimum" = 0, "unit" = "kg"))]
    pub rotary_mass_equivalent: f64,
}

impl Vehicle {
    /// Mass of all bodies, kg.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.bodies.iter().map(|b| b.mass).chain(self.wheelsets.iter().map(|w| w.mass)).sum()
    }

    /// The vehicle of a document (JSON as [`super::toml_to_json`] gives it) in one condition; without one, in its design
    /// condition. Key paths start with `vehicle`.
    ///
    /// # Errors
    /// [`crate::Error::Input`] with every fault: unknown and missing keys, wrong types, numbers out of range, unknown
    /// parameters, bodies, templates and conditions, names given twice.
    pub fn resolve(document: &Json, condition: Option<&str>) -> Result<Self> {
        let mut faults = Vec::new();
        let vehicle = Document::read(document, &mut faults).resolve(condition, &mut faults);
        finish(vehicle, faults)
    }
}
