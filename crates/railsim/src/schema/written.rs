//! The vehicle file as written, after expansion: what serde reads and what the JSON schema says of it.

use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde_json::Value as Json;

use super::vehicle::{
    AirBrake, ContactSettings, DynamicBrake, Equipment, Load, Outline, ParkingBrake, Shape, SpeedHold,
    Traction,
};
use crate::connection::Law;

fn inertia_schema(_: &mut SchemaGenerator) -> Schema {
    json_schema!({
        "type": "array", "minItems": 3, "maxItems": 3,
        "items": { "type": "number", "exclusiveMinimum": 0, "unit": "kg m2" },
    })
}

/// A vehicle file. Fields with an underscore are read before serde is asked; they stand here for the JSON schema.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenVehicle {
    /// Name, as files and reports use it.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Design speed, km/h.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "km/h"))]
    pub design_speed_kmh: f64,
    /// Profile of all wheels, unless the run says otherwise.
    pub wheel_profile: String,
    /// Track that the vehicle is tested on, unless the spec says otherwise.
    #[serde(default = "default_track")]
    pub track: String,
    /// Condition in which the vehicle stands at the heights of this file: preloads are solved there.
    #[serde(default = "default_condition")]
    pub design_condition: String,
    /// Named numbers in groups; `"$group.key"` stands for one of them wherever a number stands.
    #[serde(rename = "parameters")]
    pub _parameters: Option<BTreeMap<String, Json>>,
    /// Operating conditions: named parameters that differ in each.
    #[serde(rename = "condition")]
    pub _condition: Option<BTreeMap<String, BTreeMap<String, Json>>>,
    /// Lists to be used several times.
    #[serde(rename = "template")]
    pub _template: Option<BTreeMap<String, WrittenTemplate>>,
    /// Copies of templates.
    #[serde(rename = "use")]
    pub _uses: Option<Vec<super::template::Use>>,
    /// Bodies other than wheelsets.
    #[serde(default)]
    pub body: Vec<WrittenBody>,
    /// Wheelsets.
    #[serde(default)]
    pub wheelset: Vec<WrittenWheelset>,
    /// Force elements between bodies.
    #[serde(default)]
    pub connection: Vec<WrittenConnection>,
    /// Named points whose motion is recorded.
    #[serde(default)]
    pub sensor: Vec<WrittenSensor>,
    /// Distances between bodies that must not close.
    #[serde(default)]
    pub gap: Vec<WrittenGap>,
    /// Wheel and rail material.
    pub contact: ContactSettings,
    /// Spring-damper that holds the speed.
    pub speed_hold: Option<SpeedHold>,
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
    #[serde(default)]
    pub equipment: Vec<Equipment>,
    /// Shapes of the bodies, for drawings and outlines.
    #[serde(default)]
    pub shape: Vec<Shape>,
    /// Load cases: extra masses by name of the case.
    #[serde(default)]
    pub load_case: BTreeMap<String, Vec<Load>>,
    /// Vehicle files whose tables and lists are taken in before those of this file, seen from this file.
    #[serde(default, rename = "include")]
    pub _include: Vec<String>,
}

fn default_track() -> String {
    "plain_1435_as60".to_owned()
}

fn default_condition() -> String {
    "full".to_owned()
}

/// The lists of a template.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenTemplate {
    /// Bodies other than wheelsets.
    #[serde(default, rename = "body")]
    pub _body: Vec<WrittenBody>,
    /// Wheelsets.
    #[serde(default, rename = "wheelset")]
    pub _wheelset: Vec<WrittenWheelset>,
    /// Force elements between bodies.
    #[serde(default, rename = "connection")]
    pub _connection: Vec<WrittenConnection>,
    /// Named points.
    #[serde(default, rename = "sensor")]
    pub _sensor: Vec<WrittenSensor>,
    /// Distances between bodies.
    #[serde(default, rename = "gap")]
    pub _gap: Vec<WrittenGap>,
    /// Copies of other templates.
    #[serde(default, rename = "use")]
    pub _uses: Vec<super::template::Use>,
}

/// A body other than a wheelset.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenBody {
    /// Name, as in channels.
    pub name: String,
    /// Mass, kg.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "kg"))]
    pub mass: f64,
    /// Principal moments of inertia Ixx, Iyy, Izz about the centre of mass, kg m2.
    #[schemars(schema_with = "inertia_schema")]
    pub inertia: [f64; 3],
    /// Centre of mass in vehicle axes, m: origin at the vehicle's centre at top of rail, z down.
    pub position: [f64; 3],
    /// Moves along the design track at the speed asked for, whatever acts on it: the frame of a test rig.
    #[serde(default)]
    pub guided: bool,
}

/// A wheelset with two rigid wheels.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenWheelset {
    /// Name, as in channels.
    pub name: String,
    /// Mass, kg.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "kg"))]
    pub mass: f64,
    /// Principal moments of inertia Ixx, Iyy, Izz, kg m2; Iyy with all that turns with the axle.
    #[schemars(schema_with = "inertia_schema")]
    pub inertia: [f64; 3],
    /// Wheel radius at the tape circle, m. The axle is that high above the rail.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub radius: f64,
    /// Lateral distance of the tape circle from the wheelset's centre, m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub tape_half_distance: f64,
    /// Centre in vehicle axes, x and y, m.
    pub position: [f64; 2],
}

/// What all connections have; the keys of the law stand beside it.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[schemars(extend("unevaluatedProperties" = false))] // serde cannot deny unknown keys beside a flattened law
pub(super) struct WrittenConnection {
    /// Name.
    pub name: String,
    /// The two bodies.
    pub between: [String; 2],
    /// Both ends, when their nominal points coincide, m.
    pub position: Option<[f64; 3]>,
    /// The two ends, m.
    pub positions: Option<[[f64; 3]; 2]>,
    /// Makes two of it: `<name>_right` as written (y > 0) and `<name>_left` at -y.
    #[serde(default)]
    pub mirror: bool,
    /// Takes part in carrying the vehicle: its preload is solved so that the vehicle stands at its design height.
    #[serde(default)]
    pub carries_weight: bool,
    /// Force on the second body in the design position, in the connection's own axes, N, instead of a solved one.
    pub preload: Option<[f64; 3]>,
    /// Roll, pitch and yaw by which the connection's own axes are turned out of the vehicle's, rad; applied as
    /// yaw, then roll, then pitch.
    pub axes: Option<[f64; 3]>,
    /// The law.
    #[serde(flatten)]
    pub law: Law,
}

/// Two points that face each other on two bodies; what is left between them is recorded. No force acts: a stop that
/// is to carry is a connection.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenGap {
    /// Name; the channel is `<name>.clearance`.
    pub name: String,
    /// The two bodies.
    pub between: [String; 2],
    /// A point on each, in vehicle axes, m. Their distance is the clearance of the vehicle as drawn, the line that joins
    /// them the direction, which moves with the first body, in which it is measured.
    pub positions: [[f64; 3]; 2],
    /// Makes two of it: `<name>_right` as written (y > 0) and `<name>_left` at -y.
    #[serde(default)]
    pub mirror: bool,
}

/// A named point on a body.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenSensor {
    /// Name; channels call it `<body>.<name>`.
    pub name: String,
    /// The body.
    pub body: String,
    /// Where, in vehicle axes, m.
    pub position: [f64; 3],
}
