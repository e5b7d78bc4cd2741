//! `run` of a case: what is done, how fast, with which laws.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::drive::{Couplers, Drive, Train};
use crate::contact::creep::CreepLaw;
use crate::contact::friction::Friction;
use crate::contact::textbook::Textbook;
use crate::integrator::Integrator;

/// What is done with the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RunKind {
    /// Time stepping along the track.
    Time,
    /// Standing or rolling in balance at one place.
    Equilibrium,
    /// Balance after balance along a path of loads, prescribed coordinates or speeds.
    QuasiStatic,
    /// Eigenvalues and mode shapes about the balance, at one or more speeds.
    Modal,
    /// The speed above which the vehicle hunts.
    CriticalSpeed,
    /// Pressures and block forces of the air brake by itself, nothing moving.
    AirBrake,
    /// What looks wrong in the vehicle's description.
    Lint,
}

impl RunKind {
    /// The word in a file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Equilibrium => "equilibrium",
            Self::QuasiStatic => "quasi_static",
            Self::Modal => "modal",
            Self::CriticalSpeed => "critical_speed",
            Self::AirBrake => "air_brake",
            Self::Lint => "lint",
        }
    }
}

/// How a case is run.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// What is done.
    pub kind: RunKind,
    /// Speed, m/s, at most 200 (720 km/h); 0 stands. Of a ramp-down or bifurcation the speed at which it begins.
    #[schemars(extend("minimum" = 0, "unit" = "m/s"))]
    pub speed: f64,
    /// Coefficient of friction between wheel and rail: a number, or a table per rail, along the track, falling with the slip velocity.
    pub friction: Friction,
    /// Name of the wheel profile in `profiles`; the vehicle's own if absent. After reading always a name.
    #[serde(default)]
    pub wheel_profile: String,
    /// Creep force law; FASTSIM if absent.
    #[serde(default)]
    pub creep: CreepLaw,
    /// Constant coefficients instead of profiles, Hertz and a creep law: for closed forms, never for acceptance.
    #[serde(default)]
    pub contact: Option<SimpleContact>,
    /// Integrator with its step, where time is stepped.
    #[serde(default = "no_integrator")]
    pub integrator: Integrator,
    /// Time between rows of the result, s; a whole multiple of the integrator's step.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "s"))]
    pub output_step: f64,
    /// Coordinates (as in `hold`) that are not at their balance when time begins, and by how much, m or rad: `time`, `ramp_down` and
    /// `bifurcation`, the last with a hundredth of it at each step on the way up.
    #[serde(default)]
    pub disturbance: BTreeMap<String, f64>,
    /// Acceleration of gravity, m/s2; 9.80665, the standard value, if absent.
    #[serde(default = "standard_gravity")]
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s2"))]
    pub gravity: f64,
    /// `time`: where the first wheelset is at the start, m; 0, the beginning of the track, if absent.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "m"))]
    pub start: f64,
    /// Where the vehicle's centre stands on the layout, m; the middle of the track if absent. Not for `time`.
    #[serde(default)]
    #[schemars(extend("unit" = "m"))]
    pub place: Option<f64>,
    /// Coordinates that do not move, e.g. `ws1.z`: x y z phi theta psi of a body, track_y track_z track_phi of a
    /// wheelset. Not where time is stepped.
    #[serde(default)]
    pub hold: Vec<String>,
    /// `modal`: speeds of a root locus, m/s, instead of `speed` alone.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "m/s"))]
    pub speeds: Vec<f64>,
    /// `quasi_static`: what is done to the vehicle, all in step.
    #[serde(default)]
    pub load: Vec<Load>,
    /// `quasi_static`: load steps from one value of a path to the next; 10 if absent.
    #[serde(default = "load_steps")]
    #[schemars(extend("minimum" = 1, "maximum" = 10000))]
    pub load_steps: u32,
    /// `critical_speed`: how it is found.
    #[serde(default)]
    pub search: Option<Search>,
    /// `time`, `air_brake`: what the driver asks of traction and brakes. With it no speed is held.
    #[serde(default)]
    pub drive: Option<Drive>,
    /// `time`: what the vehicle is coupled to.
    #[serde(default)]
    pub train: Option<Train>,
    /// `time`: couplers at an angle: which, and with `drive` their lateral forces. Without it what the train pulls with is along the track.
    #[serde(default)]
    pub couplers: Option<Couplers>,
}

fn no_integrator() -> Integrator {
    Integrator::Heun { step: 2.5e-4 }
}

fn standard_gravity() -> f64 {
    9.80665
}

fn load_steps() -> u32 {
    10
}

/// A wheel/rail contact with given coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum SimpleContact {
    /// The linear contact of the textbooks.
    Textbook(Textbook),
}

/// One thing that a quasi-static run does, along a path of values.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Load {
    /// A force on a body, in the axes of the track.
    Force {
        /// The body or wheelset.
        body: String,
        /// Direction: `x`, `y` or `z` (down).
        axis: Axis,
        /// Point that it acts at, vehicle axes, m; the centre of mass if absent.
        #[serde(default)]
        position: Option<[f64; 3]>,
        /// Values, N.
        #[schemars(length(min = 1))]
        path: Vec<f64>,
    },
    /// A coordinate taken out of the balance and moved; what holds it there is recorded.
    Displacement {
        /// As in `hold`.
        coordinate: String,
        /// Values from where the balance without loads has it, m or rad.
        #[schemars(length(min = 1))]
        path: Vec<f64>,
    },
    /// Speed, in a curve.
    Speed {
        /// Values, m/s, above 0.
        #[schemars(length(min = 1))]
        path: Vec<f64>,
    },
}

impl Load {
    /// The values that it passes.
    #[must_use]
    pub fn path(&self) -> &[f64] {
        match self {
            Self::Force { path, .. } | Self::Displacement { path, .. } | Self::Speed { path } => path,
        }
    }
}

/// Direction along the track's axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Forward.
    X,
    /// Right.
    Y,
    /// Down.
    Z,
}

/// How the critical speed is found.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(tag = "method", rename_all = "snake_case", deny_unknown_fields)]
pub enum Search {
    /// The largest real part over speed, at standstill of the motion: where small disturbances begin to grow.
    Linear {
        /// Lowest and highest speed looked at, m/s.
        #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s"))]
        range: [f64; 2],
        /// Distance of the speeds looked at before bisection, m/s; a twentieth of the range if absent.
        #[serde(default)]
        #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s"))]
        spacing: Option<f64>,
    },
    /// Fast and disturbed, then ever slower: where hunting ends.
    RampDown {
        /// Speed at which the ramp ends, m/s.
        #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s"))]
        end_speed: f64,
        /// Deceleration, m/s2.
        #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s2"))]
        deceleration: f64,
        /// When hunting counts as going on.
        #[serde(default)]
        hunting: Hunting,
    },
    /// Limit cycle after limit cycle, the speed stepped down and up again.
    Bifurcation {
        /// Speed at which the steps turn round, m/s.
        #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s"))]
        end_speed: f64,
        /// Step of the speed, m/s.
        #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s"))]
        speed_step: f64,
        /// Rate at which the speed changes between the steps, m/s2.
        #[serde(default = "change_of_speed")]
        #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s2"))]
        acceleration: f64,
        /// Time for the motion to settle at each speed, s.
        #[serde(default = "settling_time")]
        #[schemars(extend("minimum" = 0, "unit" = "s"))]
        settle_s: f64,
        /// When hunting counts as going on; the window follows the settling.
        #[serde(default)]
        hunting: Hunting,
    },
}

fn change_of_speed() -> f64 {
    1.0
}

fn settling_time() -> f64 {
    6.0
}

/// What counts as hunting.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Hunting {
    /// Least lateral motion of an axle that is hunting, peak to peak, m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub threshold: f64,
    /// Within this time, s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "s"))]
    pub window_s: f64,
}

impl Default for Hunting {
    fn default() -> Self {
        Self { threshold: 0.002, window_s: 1.0 }
    }
}
