//! The vehicle: bodies, wheelsets, connections and sensors in vehicle axes, every number resolved.

use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::document::{Document, finish};
use crate::connection::Law;
use crate::error::{Fault, KeyPath, Result};

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
    /// Air brake.
    pub air_brake: Option<AirBrake>,
    /// Parking brake.
    pub parking_brake: Option<ParkingBrake>,
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
    /// Wheel load over whose patch the contact tables average position, angle and curvature, N. If absent, the static wheel load: the
    /// vehicle's weight over its wheels. The approach that belongs to it is rounded to a tenth of a micrometre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N"))]
    pub averaging_load: Option<f64>,
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
    /// Effort (N) over speed (m/s) of each notch, first to last, instead of `max_effort` and `power_at_rail`: points `[speed,
    /// effort]`, straight between them, level beyond.
    #[serde(default)]
    pub notch_curves: Vec<Vec<[f64; 2]>>,
    /// Rating of the motors; without it thermal tests cannot be assessed.
    #[serde(default)]
    pub thermal: Option<Thermal>,
}

/// Thermal rating of the traction motors, as efforts of the whole vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Thermal {
    /// Effort that may be held for ever, N.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N"))]
    pub continuous_effort: f64,
    /// Effort that may be held for the short time, from cold, N.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N"))]
    pub short_time_effort: f64,
    /// The short time, s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "s"))]
    pub short_time: f64,
}

impl Traction {
    /// What a schema cannot say.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = Vec::new();
        if !self.notch_curves.is_empty() && self.notch_curves.len() != self.notches as usize {
            let found = format!("{} curves", self.notch_curves.len());
            let allowed = format!("one for each of the {} notches, or none", self.notches);
            faults.push(Fault::new(at.key("notch_curves"), found, allowed));
        }
        for (i, curve) in self.notch_curves.iter().enumerate() {
            let key = at.key("notch_curves").index(i);
            if curve.len() < 2 {
                faults.push(Fault::new(key.clone(), format!("{} points", curve.len()), "2 points or more"));
            }
            let mut before = f64::NEG_INFINITY;
            for (k, [speed, effort]) in curve.iter().enumerate() {
                if !(speed.is_finite() && *speed >= 0.0 && *speed > before) {
                    let allowed = "speeds >= 0 m/s, each above the one before";
                    faults.push(Fault::new(key.index(k).index(0), format!("{speed} m/s"), allowed));
                }
                if !(effort.is_finite() && *effort >= 0.0) {
                    faults.push(Fault::new(key.index(k).index(1), format!("{effort} N"), "an effort >= 0 N"));
                }
                before = *speed;
            }
        }
        if let Some(thermal) = &self.thermal
            && thermal.short_time_effort <= thermal.continuous_effort
        {
            let allowed = format!("above continuous_effort = {} N", thermal.continuous_effort);
            let found = format!("{} N", thermal.short_time_effort);
            faults.push(Fault::new(at.key("thermal").key("short_time_effort"), found, allowed));
        }
        faults
    }
}

/// Air brake of the vehicle: pipe, distributor, cylinders, rigging, blocks on every wheelset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AirBrake {
    /// Pressure of the charged brake pipe and auxiliary reservoir, Pa (gauge).
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "Pa"))]
    pub pipe_pressure: f64,
    /// Rate at which the driver's valve lowers the pipe in service, Pa/s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "Pa/s"))]
    pub service_rate: f64,
    /// Rate in an emergency, Pa/s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "Pa/s"))]
    pub emergency_rate: f64,
    /// Rate at which the pipe is charged again, Pa/s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "Pa/s"))]
    pub release_rate: f64,
    /// Speed at which a change runs along the pipe, m/s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s"))]
    pub propagation: f64,
    /// Cylinder pressure over the reduction of the pipe.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub distributor_ratio: f64,
    /// Reduction below which the distributor does nothing, Pa.
    #[schemars(extend("minimum" = 0, "unit" = "Pa"))]
    pub insensitivity: f64,
    /// Largest cylinder pressure of the automatic brake, Pa.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "Pa"))]
    pub max_cylinder: f64,
    /// Largest cylinder pressure of the independent brake, Pa.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "Pa"))]
    pub max_independent: f64,
    /// Volume of the auxiliary reservoir over that of the full cylinders.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub reservoir_ratio: f64,
    /// Time from 0 to 95 % of the cylinder pressure asked for, s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "s"))]
    pub apply_time: f64,
    /// Time from there to 5 % of it, s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "s"))]
    pub release_time: f64,
    /// Piston area for each wheelset, m2.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m2"))]
    pub piston_area: f64,
    /// Ratio of the rigging, all blocks of a wheelset over the piston.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rigging_ratio: f64,
    /// Efficiency of the rigging.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub rigging_efficiency: f64,
    /// Force of the return springs at the piston, N.
    #[schemars(extend("minimum" = 0, "unit" = "N"))]
    pub return_force: f64,
    /// Coefficient of friction of the blocks over speed: points `[m/s, 1]`.
    #[schemars(length(min = 1))]
    pub block_friction: Vec<[f64; 2]>,
}

/// Parking brake: spring or screw on the blocks of some wheelsets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ParkingBrake {
    /// Force of all blocks of a wheelset, N.
    #[schemars(extend("minimum" = 0, "unit" = "N"))]
    pub block_force: f64,
    /// Static coefficient of friction of the blocks.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1.5))]
    pub block_friction: f64,
    /// The wheelsets that it acts on.
    #[schemars(length(min = 1))]
    pub wheelsets: Vec<String>,
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
