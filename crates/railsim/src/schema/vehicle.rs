//! The vehicle: bodies, wheelsets, connections and sensors in vehicle axes, every number resolved.

use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
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
    /// Distances between bodies that are recorded.
    pub gaps: Vec<Gap>,
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
    /// What stands on or hangs under the bodies, for drawings.
    pub equipment: Vec<Equipment>,
    /// Shapes of the bodies, for drawings and outlines.
    pub shapes: Vec<Shape>,
    /// Extra masses of named load cases.
    pub load_cases: BTreeMap<String, Vec<Load>>,
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
    /// Moves along the design track at the speed asked for, whatever acts on it.
    pub guided: bool,
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
    /// Force on B in the design position, in the connection's own axes, N (`preload` in the file).
    pub force: Option<[f64; 3]>,
    /// Roll, pitch and yaw of the connection's own axes, rad.
    pub axes: Option<[f64; 3]>,
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

/// Two points that face each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Gap {
    /// Name.
    pub name: String,
    /// The two bodies.
    pub between: [String; 2],
    /// A nominal point on each, m.
    pub points: [[f64; 3]; 2],
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
    /// Cross-section of the car body as points y, z (right, down), m; the left half follows by mirroring.
    #[serde(default)]
    pub section: Vec<[f64; 2]>,
}

fn size(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "array", "minItems": 3, "maxItems": 3,
        "items": { "type": "number", "exclusiveMinimum": 0, "unit": "m" },
    })
}

fn size_or_none(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "array", "minItems": 3, "maxItems": 3,
        "items": { "type": "number", "minimum": 0, "unit": "m" },
    })
}

/// A piece of equipment: its mass is part of its body's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Equipment {
    /// Name, one for each piece.
    pub name: String,
    /// The body or wheelset that it is fixed to.
    pub body: String,
    /// Mass, kg, of which its body's mass already consists.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "kg"))]
    pub mass: f64,
    /// Centre in vehicle axes, m.
    pub position: [f64; 3],
    /// Length, width, height, m.
    #[serde(default)]
    #[schemars(schema_with = "size_or_none")]
    pub size: [f64; 3],
}

/// What a body looks like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// A box.
    Box {
        /// The body or wheelset.
        body: String,
        /// Centre in vehicle axes, m.
        position: [f64; 3],
        /// Length, width, height, m.
        #[schemars(schema_with = "size")]
        size: [f64; 3],
    },
    /// A round bar or tank.
    Cylinder {
        /// The body or wheelset.
        body: String,
        /// Middle of its axis in vehicle axes, m.
        position: [f64; 3],
        /// Direction of its axis: along x, y or z.
        axis: Axis,
        /// Radius, m.
        #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
        radius: f64,
        /// Length, m.
        #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
        length: f64,
    },
    /// A line through points.
    Line {
        /// The body or wheelset.
        body: String,
        /// Points in vehicle axes, m.
        #[schemars(length(min = 2))]
        points: Vec<[f64; 3]>,
    },
}

/// An axis of the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Forward.
    X,
    /// To the right.
    Y,
    /// Down.
    Z,
}

impl Shape {
    /// The body that it belongs to.
    #[must_use]
    pub fn body(&self) -> &str {
        match self {
            Self::Box { body, .. } | Self::Cylinder { body, .. } | Self::Line { body, .. } => body,
        }
    }
}

/// A mass that a load case puts on a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// The body.
    pub body: String,
    /// Mass, kg.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "kg"))]
    pub mass: f64,
    /// Its centre in vehicle axes, m.
    pub position: [f64; 3],
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
    /// Mass of all bodies but guided ones, kg.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.bodies
            .iter()
            .filter(|b| !b.guided)
            .map(|b| b.mass)
            .chain(self.wheelsets.iter().map(|w| w.mass))
            .sum()
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
