//! A control law of the user's: at every sample it sees channels and sets torques and brakes.

use crate::dynamics::{Model, VehicleSystem};
use crate::error::{Error, Fault, KeyPath, Result};
use crate::integrator::System;
use crate::run::channel::{Source, plan};
use crate::run::recorder::value;

/// What a control law can set: one torque at a time for each wheelset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// `<wheelset>.torque`: torque asked of the inverter of a wheelset, N m, + forward.
    Torque(usize),
    /// `<bogie>.torque`: the same on each wheelset of a bogie.
    BogieTorque(usize),
    /// `independent_brake`: pressure asked for in the vehicle's own brake cylinders, Pa.
    IndependentBrake,
}

/// A control law.
pub trait Law {
    /// Asked at every sample with the time (s) and the channels that it declared, in their order; writes what it sets, in the
    /// order of its outputs. What it leaves `None` stays with the vehicle's own controllers.
    ///
    /// # Errors
    /// Why it could not answer, in words.
    fn sample(&mut self, t: f64, seen: &[f64], set: &mut [Option<f64>]) -> std::result::Result<(), String>;
}

/// A control law with the names of what it sees and sets.
pub struct Outside<'a> {
    /// What a message calls it.
    pub name: String,
    /// Channels that it sees.
    pub channels: Vec<String>,
    /// What it sets, by the names of [`Output`].
    pub outputs: Vec<String>,
    /// The law.
    pub law: &'a mut dyn Law,
}

impl std::fmt::Debug for Outside<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Outside")
            .field("name", &self.name)
            .field("channels", &self.channels)
            .field("outputs", &self.outputs)
            .finish_non_exhaustive()
    }
}

/// The same in a run.
pub(crate) struct Watching<'a, 'o> {
    outside: &'o mut Outside<'a>,
    sources: Vec<Source>,
    outputs: Vec<Output>,
    /// Outputs, two and two, that act on the same wheelset.
    overlaps: Vec<[usize; 2]>,
    seen: Vec<f64>,
    set: Vec<Option<f64>>,
    /// Whether it has ever set anything.
    acted: bool,
    slope: Vec<f64>,
}

impl<'a, 'o> Watching<'a, 'o> {
    /// Looks channels and outputs up.
    pub fn new(outside: &'o mut Outside<'a>, system: &VehicleSystem<'_>) -> Result<Self> {
        let at = KeyPath::of("controller");
        let allowed = "a channel of the run (`lmap channels VEHICLE` lists them)";
        let channels = find(&outside.channels, &plan(system.model), &at.key("channels"), allowed);
        let known = system.model.equipment.as_ref().map_or(Vec::new(), |e| e.outputs(system.model));
        let allowed: Vec<&str> = known.iter().map(|(name, _)| name.as_str()).collect();
        let outputs = find(&outside.outputs, &known, &at.key("outputs"), &allowed.join(", "));
        let (sources, outputs) = match (channels, outputs) {
            (Ok(sources), Ok(outputs)) => (sources, outputs),
            (channels, outputs) => {
                let faults = [channels.err(), outputs.err()].into_iter().flatten().flatten().collect();
                return Err(Error::Input(faults));
            }
        };
        let overlaps = overlaps(&outputs, system.model);
        let (seen, set) = (vec![0.0; sources.len()], vec![None; outputs.len()]);
        let slope = vec![0.0; system.size()];
        Ok(Self { outside, sources, outputs, overlaps, seen, set, acted: false, slope })
    }

    /// Asks the law at `t`, `x` and puts its answer into the equipment.
    pub fn sample(&mut self, system: &mut VehicleSystem<'_>, t: f64, x: &[f64]) -> Result<()> {
        system.rhs(t, x, &mut self.slope);
        let map = system.model.map();
        for (value_, source) in self.seen.iter_mut().zip(&self.sources) {
            *value_ = value(*source, system, map, t, x, &self.slope);
        }
        self.set.fill(None);
        let answer = self.outside.law.sample(t, &self.seen, &mut self.set);
        answer.and_then(|()| self.check()).map_err(|why| {
            let found = format!("{} at t = {t:.3} s: {why}", self.outside.name);
            let allowed = "a control law that answers every time with finite numbers, no wheelset's twice";
            Error::input(Fault::new(KeyPath::of("controller"), found, allowed))
        })?;
        self.acted |= self.set.iter().any(Option::is_some);
        if let Some(acting) = &mut system.acting {
            for (output, value) in self.outputs.iter().zip(&self.set) {
                if let Some(value) = value {
                    acting.overrule(t, *output, *value);
                }
            }
        }
        Ok(())
    }

    /// After a run that reached its end: a law that never set anything was not what drove, the vehicle's own controllers were.
    pub fn finish(&self) -> Result<()> {
        if self.acted {
            return Ok(());
        }
        let found = format!("{}, which set nothing in the whole run", self.outside.name);
        let allowed =
            "a control law that sets a torque or a brake at least once: does it return what it works out?";
        Err(Error::input(Fault::new(KeyPath::of("controller"), found, allowed)))
    }

    fn check(&self) -> std::result::Result<(), String> {
        for ((name, output), value) in self.outside.outputs.iter().zip(&self.outputs).zip(&self.set) {
            let Some(value) = value else { continue };
            let brake = *output == Output::IndependentBrake;
            if !value.is_finite() || (brake && *value < 0.0) {
                let unit = if brake { "Pa" } else { "N m" };
                return Err(format!("{name} = {value} {unit}"));
            }
        }
        for pair in &self.overlaps {
            if pair.iter().all(|i| self.set[*i].is_some()) {
                let [a, b] = pair.map(|i| &self.outside.outputs[i]);
                return Err(format!("{a} and {b} at once, both of which act on the same wheelset"));
            }
        }
        Ok(())
    }
}

/// Outputs, two and two, of which a law may set one at a time: which torque a wheelset gets must not hang on their order.
fn overlaps(outputs: &[Output], model: &Model) -> Vec<[usize; 2]> {
    let bogies = model.equipment.as_ref().map_or(&[][..], |e| &e.bogies);
    let turns = |output: Output, w: usize| match output {
        Output::Torque(own) => own == w,
        Output::BogieTorque(b) => bogies[b].wheelsets.contains(&w),
        Output::IndependentBrake => false,
    };
    let both = |a: Output, b: Output| (0..model.wheelsets.len()).any(|w| turns(a, w) && turns(b, w));
    let pairs = (0..outputs.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
    pairs.filter(|[a, b]| outputs[*a] == outputs[*b] || both(outputs[*a], outputs[*b])).collect()
}

/// What stands behind each of `names`; a fault for each that `known` has not.
fn find<T: Copy>(
    names: &[String],
    known: &[(String, T)],
    at: &KeyPath,
    allowed: &str,
) -> std::result::Result<Vec<T>, Vec<Fault>> {
    let (mut found, mut faults) = (Vec::new(), Vec::new());
    for (i, name) in names.iter().enumerate() {
        match known.iter().find(|(n, _)| n == name) {
            Some((_, one)) => found.push(*one),
            None => faults.push(Fault::new(at.index(i), format!("`{name}`"), allowed)),
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}
