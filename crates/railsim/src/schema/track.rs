//! `track` of a case: rails, their support, layout and irregularity.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::track::Segment;
use crate::track::irregularity::Irregularity;

/// The track under the vehicle.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Track {
    /// Name of the track file, for reports.
    pub name: Option<String>,
    /// One line for people.
    pub title: Option<String>,
    /// Length, m: a run goes from the first wheelset at 0 to the first wheelset here. More than 1000 km is a slip of the
    /// pen, and irregularities are looked at metre by metre before a run.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6, "unit" = "m"))]
    pub length: f64,
    /// Gauge, m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub gauge: f64,
    /// Depth below top of rail at which the gauge is measured, m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub gauge_point_depth: f64,
    /// Inclination of the rails towards the track's centre, e.g. 0.05 for 1 in 20.
    pub rail_inclination: f64,
    /// Name of the rail profile in `profiles`.
    pub rail_profile: String,
    /// What carries the rails under each wheelset; `"rigid"`: they do not move.
    pub support: TrackSupport,
    /// Segments from the start; tangent track where none is given.
    #[serde(default)]
    pub layout: Vec<Segment>,
    /// Irregularities, added up. In the file one table or a list.
    #[serde(default)]
    pub irregularity: Vec<Irregularity>,
    /// Distance over which the irregularity grows from nothing, m; 0 if absent.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "m"))]
    pub fade_in: f64,
    /// Where this growth starts, m; 0 if absent.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "m"))]
    pub fade_start: f64,
}

/// What carries the rails.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum TrackSupport {
    /// A mass on springs and dampers.
    Lumped(Support),
    /// Nothing gives way.
    Rigid(RigidTrack),
}

/// The word for a track that does not move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RigidTrack {
    /// `"rigid"`
    Rigid,
}

/// One lumped track mass under each wheelset, moving laterally, vertically and in roll on springs and dampers.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Mass, kg.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "kg"))]
    pub mass: f64,
    /// Moment of inertia about the track's direction, kg m2.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "kg m2"))]
    pub Ixx: f64,
    /// Lateral stiffness, N/m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N/m"))]
    pub ky: f64,
    /// Vertical stiffness, both rails together, N/m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N/m"))]
    pub kz: f64,
    /// Lateral damping, N s/m.
    #[schemars(extend("minimum" = 0, "unit" = "N s/m"))]
    pub cy: f64,
    /// Vertical damping, both rails together, N s/m.
    #[schemars(extend("minimum" = 0, "unit" = "N s/m"))]
    pub cz: f64,
    /// Half the lateral distance of the two vertical springs, m: roll stiffness is `kz half_base^2`, roll damping
    /// `cz half_base^2`.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub half_base: f64,
}
