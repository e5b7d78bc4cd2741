//! `run.drive` and `run.train`: what the driver does, and what hangs behind the vehicle.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::error::{Fault, KeyPath};

/// A demand: one value for the whole run, or values from given times on.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Demand {
    /// The same all the time.
    Constant(f64),
    /// Time (s) and the value that holds from then on; before the first 0.
    Steps(#[schemars(length(min = 1))] Vec<[f64; 2]>),
}

impl Default for Demand {
    fn default() -> Self {
        Self::Constant(0.0)
    }
}

impl Demand {
    /// The value that holds at time `t`, s.
    #[must_use]
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Steps(steps) => {
                // A step holds from its own time on, roundings of a control instant aside.
                let passed = steps.partition_point(|s| s[0] <= t + 1e-9);
                passed.checked_sub(1).map_or(0.0, |i| steps[i][1])
            }
        }
    }

    /// Time and value of every change up to the end of the run.
    #[must_use]
    pub fn steps(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Constant(value) => vec![[0.0, *value]],
            Self::Steps(steps) => steps.clone(),
        }
    }

    /// Whether anything is ever asked for.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.steps().iter().all(|s| s[1] == 0.0)
    }

    /// Times that do not rise, values outside `range`.
    #[must_use]
    pub fn faults(&self, range: [f64; 2], unit: &str, at: &KeyPath) -> Vec<Fault> {
        let mut faults = Vec::new();
        let allowed = match range {
            [low, f64::INFINITY] => format!("a number >= {low}{unit}"),
            [low, high] => format!("{low} to {high}{unit}"),
        };
        let good = |v: f64| v.is_finite() && v >= range[0] && v <= range[1];
        match self {
            Self::Constant(v) if good(*v) => {}
            Self::Constant(v) => faults.push(Fault::new(at.clone(), v.to_string(), allowed)),
            Self::Steps(steps) => {
                let mut before = f64::NEG_INFINITY;
                for (i, [t, v]) in steps.iter().enumerate() {
                    if !(t.is_finite() && *t >= 0.0 && *t > before) {
                        let allowed = "times >= 0 s, each after the one before";
                        faults.push(Fault::new(at.index(i).index(0), format!("{t} s"), allowed));
                    }
                    if !good(*v) {
                        faults.push(Fault::new(at.index(i).index(1), v.to_string(), allowed.clone()));
                    }
                    before = *t;
                }
            }
        }
        faults
    }
}

/// Which axles have one torque.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Inverter {
    /// One inverter for each bogie: the same torque on all its axles, held back by the fastest of them.
    #[default]
    Bogie,
    /// One inverter for each axle.
    Axle,
}

/// What the slip observer sees.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Observer {
    /// Standard deviation of each measured axle speed at the rim, m/s; 0 measures exactly.
    #[schemars(extend("minimum" = 0, "unit" = "m/s"))]
    pub noise: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// Share by which the diameter that the controller knows is too large, one for each wheelset in the order of the file; all
    /// exact if absent.
    pub diameter_error: Vec<f64>,
}

/// Sand under the wheels: friction as it is, times a factor.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sanding {
    /// Demand: 1 sands, 0 does not.
    pub demand: Demand,
    /// Time from the demand until sand is under the wheels (and until it has gone), s.
    #[schemars(extend("minimum" = 0, "unit" = "s"))]
    pub delay: f64,
    /// Factor on the coefficient of friction.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 5))]
    pub friction_factor: f64,
}

/// When a run ends before the end of the track.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Until {
    /// After this time, s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "s"))]
    pub time: Option<f64>,
    /// When the vehicle has become as slow as this, m/s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s"))]
    pub speed_below: Option<f64>,
    /// When the vehicle has become as fast as this, m/s.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m/s"))]
    pub speed_above: Option<f64>,
}

fn yes() -> bool {
    true
}

fn period() -> f64 {
    0.01
}

/// What the driver asks of traction and brakes, and how their controllers are set in this run.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Notch of the traction controller; 0 coasts.
    #[serde(default)]
    pub notch: Demand,
    /// Dynamic brake, share of its full effort.
    #[serde(default)]
    pub dynamic_brake: Demand,
    /// Automatic air brake: reduction of the brake pipe's pressure at the driver's valve, Pa.
    #[serde(default)]
    pub brake_pipe_reduction: Demand,
    /// Time at which the brake pipe is vented (emergency), s.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "s"))]
    pub emergency: Option<f64>,
    /// Independent air brake: pressure asked for in the vehicle's own cylinders, Pa.
    #[serde(default)]
    pub independent_brake: Demand,
    /// Parking brake applied, from the start.
    #[serde(default)]
    pub parking_brake: bool,
    /// Air brake of the vehicle makes up what the dynamic brake's curve, its build-up and `effort_limit` leave of the demand (which is a share of its full
    /// effort at every speed); never what slip control takes off, which the same wheels would have to carry.
    #[serde(default)]
    pub blending: bool,
    /// Largest effort of the whole vehicle that the torque reference asks of the motors, N; the notch curve alone if absent. It limits the
    /// machines, not the demand: with `blending` air brakes add the rest of that.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N"))]
    pub effort_limit: Option<f64>,
    /// One torque for the axles of a bogie, or for each axle.
    #[serde(default)]
    pub inverter: Inverter,
    /// Whether slip is controlled at all.
    #[serde(default = "yes")]
    pub slip_control: bool,
    /// Slip that the controller asks for instead of the vehicle's.
    #[serde(default)]
    pub slip_reference: Option<Demand>,
    /// Slip limiter instead of the vehicle's: no reference passes it.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub slip_limit: Option<f64>,
    /// What the slip observer sees.
    #[serde(default)]
    pub observer: Observer,
    /// Time between two samples of the controllers, s; a whole multiple of the integrator's step.
    #[serde(default = "period")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1, "unit" = "s"))]
    pub period: f64,
    /// Sand.
    #[serde(default)]
    pub sanding: Option<Sanding>,
    /// Running resistance of the vehicle itself, by the same formula as the train's but for curve resistance, which its wheels make.
    #[serde(default = "yes")]
    pub resistance: bool,
    /// The speed hold stays on: the vehicle pulls against it at constant speed, as against a brake van. For adhesion curves.
    #[serde(default)]
    pub hold_speed: bool,
    /// When the run ends before the end of the track.
    #[serde(default)]
    pub until: Until,
}

impl Drive {
    /// What a schema cannot say.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        const ANY: f64 = f64::INFINITY;
        let mut faults = self.notch.faults([0.0, ANY], "", &at.key("notch"));
        faults.extend(self.dynamic_brake.faults([0.0, 1.0], "", &at.key("dynamic_brake")));
        faults.extend(self.brake_pipe_reduction.faults([0.0, ANY], " Pa", &at.key("brake_pipe_reduction")));
        faults.extend(self.independent_brake.faults([0.0, ANY], " Pa", &at.key("independent_brake")));
        if let Some(reference) = &self.slip_reference {
            faults.extend(reference.faults([0.0, 1.0], "", &at.key("slip_reference")));
        }
        if let Some(sanding) = &self.sanding {
            faults.extend(sanding.demand.faults([0.0, 1.0], "", &at.key("sanding").key("demand")));
        }
        for (i, error) in self.observer.diameter_error.iter().enumerate() {
            if !(error.is_finite() && error.abs() < 0.5) {
                let key = at.key("observer").key("diameter_error").index(i);
                faults.push(Fault::new(key, error.to_string(), "a share between -0.5 and 0.5"));
            }
        }
        faults
    }
}

/// Draft gear between two vehicles.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DraftGear {
    /// Free play from fully pushed to fully pulled, m.
    #[schemars(extend("minimum" = 0, "unit" = "m"))]
    pub slack: f64,
    /// Stiffness in the middle between loading and unloading, N/m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N/m"))]
    pub stiffness: f64,
    /// Friction: share of that force which loading lies above it and unloading below.
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 1))]
    pub friction: f64,
    /// Damping while the gear is drawn or pushed, N s/m.
    #[schemars(extend("minimum" = 0, "unit" = "N s/m"))]
    pub damping: f64,
    /// Travel after which the gear is solid, m; never if absent.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub travel: Option<f64>,
    /// Stiffness of the solid gear, N/m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N/m"))]
    pub solid_stiffness: f64,
}

impl Default for DraftGear {
    fn default() -> Self {
        Self {
            slack: 0.0,
            stiffness: 1.0e7,
            friction: 0.4,
            damping: 1.0e5,
            travel: None,
            solid_stiffness: 1.0e8,
        }
    }
}

fn one() -> u32 {
    1
}

fn whole() -> f64 {
    1.0
}

/// A locomotive of the train, as a mass with effort. It pulls and brakes with the vehicle's own curves and demands at its own speed, after
/// the same lag, never limited by adhesion; its air brake is that of the wagons.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrainLocomotive {
    /// Which of the masses it is, the first of the train being 1; the vehicle itself is not counted.
    #[schemars(extend("minimum" = 1))]
    pub at: u32,
    /// Mass, kg.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "kg"))]
    pub mass: f64,
    /// What its wheelsets' turning adds to its inertia, kg.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "kg"))]
    pub rotary_mass: f64,
    /// Its effort over that of the vehicle.
    #[serde(default = "whole")]
    #[schemars(extend("minimum" = 0))]
    pub effort: f64,
}

/// Couplers that stand at an angle to the car body. Each lies in the line between its pivot and that of a neighbour, whose bogie centres
/// stand on the track's centre line and whose couplers are as high as the vehicle's own. Recorded in every run in time; forces need `run.drive`.
/// What the neighbours are is said here alone, the same at both ends: `run.train` hangs its masses where their lengths put them.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Couplers {
    /// From the pivot in the underframe to the pulling face, m; the neighbours' too.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub shank: f64,
    /// Length of the neighbours over their couplers, m; the vehicle's own if absent.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub neighbour_length: Option<f64>,
    /// Distance of the neighbours' bogie centres, m; the vehicle's own (its wheelbase, without bogies) if absent.
    #[serde(default)]
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "m"))]
    pub neighbour_pivots: Option<f64>,
    /// Force in the front coupler beside what `run.train` gives: times (s) and forces (N, + pull), straight between them.
    #[serde(default)]
    pub front: Vec<[f64; 2]>,
    /// The same in the rear coupler.
    #[serde(default)]
    pub rear: Vec<[f64; 2]>,
}

impl Couplers {
    /// What a schema cannot say.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (key, course) in [("front", &self.front), ("rear", &self.rear)] {
            let mut before = f64::NEG_INFINITY;
            for (i, [t, force]) in course.iter().enumerate() {
                let key = at.key(key).index(i);
                if !(t.is_finite() && *t > before) {
                    let allowed = "finite times (s), each after the one before";
                    faults.push(Fault::new(key.index(0), format!("{t} s"), allowed));
                }
                if !force.is_finite() {
                    faults.push(Fault::new(key.index(1), force.to_string(), "a finite force, N"));
                }
                before = *t;
            }
        }
        faults
    }
}

/// What the vehicle is coupled to: masses on the design line. One of them with the train's mass is a lumped train.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Train {
    /// Number of masses: wagons, and the locomotives among them.
    #[serde(default = "one")]
    #[schemars(extend("minimum" = 1, "maximum" = 1000))]
    pub wagons: u32,
    /// How many of them run ahead of the vehicle.
    #[serde(default)]
    pub ahead: u32,
    /// Locomotives among them.
    #[serde(default)]
    pub locomotives: Vec<TrainLocomotive>,
    /// Vehicles that each mass stands for in the running resistance, whose constant and v^2 parts go by vehicles.
    #[serde(default = "one")]
    #[schemars(extend("minimum" = 1, "maximum" = 1000))]
    pub vehicles: u32,
    /// Mass of each, kg.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "kg"))]
    pub mass: f64,
    /// What its wheelsets' turning adds to each one's inertia, kg.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "kg"))]
    pub rotary_mass: f64,
    /// Length of each, m; 0 puts it where the coupler is.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "m"))]
    pub length: f64,
    /// Running resistance (modified Davis) and curve resistance.
    #[serde(default = "yes")]
    pub resistance: bool,
    /// The draft gear of every coupling.
    #[serde(default)]
    pub coupler: DraftGear,
    /// Brake force of each wagon with its cylinder full, N; its air brake follows the brake pipe. 0 has none.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "N"))]
    pub brake_force: f64,
}

impl Train {
    /// What a schema cannot say.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = Vec::new();
        if self.ahead > self.wagons {
            let allowed = format!("0 to run.train.wagons = {}", self.wagons);
            faults.push(Fault::new(at.key("ahead"), self.ahead.to_string(), allowed));
        }
        for (i, locomotive) in self.locomotives.iter().enumerate() {
            let key = at.key("locomotives").index(i).key("at");
            let taken = self.locomotives[..i].iter().any(|other| other.at == locomotive.at);
            if taken || !(1..=self.wagons).contains(&locomotive.at) {
                let allowed = format!("a place of its own, 1 to run.train.wagons = {}", self.wagons);
                faults.push(Fault::new(key, locomotive.at.to_string(), allowed));
            }
        }
        faults
    }
}
