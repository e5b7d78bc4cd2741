//! A control law of the user's: at every sample it sees channels and sets torques and brakes.

use crate::dynamics::VehicleSystem;
use crate::error::{Error, Fault, KeyPath, Result};
use crate::integrator::System;
use crate::run::channel::{Source, plan};
use crate::run::recorder::value;

/// What a control law sets; what it leaves out stays with the vehicle's own controllers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Action {
    /// Torque asked of the inverter of each wheelset, N m, + forward.
    pub torque: Option<Vec<f64>>,
    /// Pressure asked for in the vehicle's own brake cylinders, Pa.
    pub independent_brake: Option<f64>,
}

/// A control law.
pub trait Law {
    /// Asked at every sample with the time (s) and the channels that it declared, in their order.
    ///
    /// # Errors
    /// Why it could not answer, in words.
    fn sample(&mut self, t: f64, seen: &[f64]) -> std::result::Result<Action, String>;
}

/// A control law with the names of the channels that it sees.
pub struct Outside<'a> {
    /// What a message calls it.
    pub name: String,
    /// Channels.
    pub channels: Vec<String>,
    /// The law.
    pub law: &'a mut dyn Law,
}

impl std::fmt::Debug for Outside<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Outside")
            .field("name", &self.name)
            .field("channels", &self.channels)
            .finish_non_exhaustive()
    }
}

/// The same in a run.
pub(crate) struct Watching<'a, 'o> {
    outside: &'o mut Outside<'a>,
    sources: Vec<Source>,
    seen: Vec<f64>,
    slope: Vec<f64>,
}

impl<'a, 'o> Watching<'a, 'o> {
    /// Looks the channels up.
    pub fn new(outside: &'o mut Outside<'a>, system: &VehicleSystem<'_>) -> Result<Self> {
        let known = plan(system.model);
        let at = KeyPath::of("controller").key("channels");
        let (mut sources, mut faults) = (Vec::new(), Vec::new());
        for (i, name) in outside.channels.iter().enumerate() {
            match known.iter().find(|(n, _)| n == name) {
                Some((_, source)) => sources.push(*source),
                None => {
                    let allowed = "a channel of the run (`lmap channels VEHICLE` lists them)";
                    faults.push(Fault::new(at.index(i), format!("`{name}`"), allowed));
                }
            }
        }
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let seen = vec![0.0; sources.len()];
        Ok(Self { outside, sources, seen, slope: vec![0.0; system.size()] })
    }

    /// Asks the law at `t`, `x` and puts its answer into the equipment.
    pub fn sample(&mut self, system: &mut VehicleSystem<'_>, t: f64, x: &[f64]) -> Result<()> {
        system.rhs(t, x, &mut self.slope);
        let map = system.model.map();
        for (value_, source) in self.seen.iter_mut().zip(&self.sources) {
            *value_ = value(*source, system, map, t, x, &self.slope);
        }
        let wheelsets = system.model.wheelsets.len();
        let action = self.outside.law.sample(t, &self.seen).and_then(|action| checked(action, wheelsets));
        let action = action.map_err(|why| {
            let found = format!("{} at t = {t:.3} s: {why}", self.outside.name);
            let allowed = "a control law that answers every time with finite numbers";
            Error::input(Fault::new(KeyPath::of("controller"), found, allowed))
        })?;
        if let Some(acting) = &mut system.acting {
            acting.overrule(t, &action);
        }
        Ok(())
    }
}

fn checked(action: Action, wheelsets: usize) -> std::result::Result<Action, String> {
    if let Some(torque) = &action.torque {
        if torque.len() != wheelsets {
            return Err(format!("{} torques for {wheelsets} wheelsets", torque.len()));
        }
        if let Some(bad) = torque.iter().find(|v| !v.is_finite()) {
            return Err(format!("a torque of {bad} N m"));
        }
    }
    if let Some(pressure) = action.independent_brake
        && !(pressure.is_finite() && pressure >= 0.0)
    {
        return Err(format!("an independent_brake of {pressure} Pa"));
    }
    Ok(action)
}
