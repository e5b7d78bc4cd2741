//! A vehicle rolling on ideal straight track while its speed is changed.

use crate::analysis::Stand;
use crate::dynamics::{Model, SpeedProgram, VehicleSystem};
use crate::error::{Error, Fault, KeyPath, Result};
use crate::integrator::{Integrator, Stepper, System};
use crate::run::{divergence, stability};
use crate::schema::Case;

/// Refuses a layout that is not straight and a vehicle whose speed nothing holds.
///
/// # Errors
/// Either of them.
pub(super) fn on_straight_track(model: &Model) -> Result<()> {
    if !model.layout.is_tangent() {
        return Err(Error::input(Fault::new(
            KeyPath::of("track.layout"),
            "curves, cant or gradients",
            "straight level track: the speed is changed over kilometres of it",
        )));
    }
    if model.place_is_free() {
        return Err(Error::input(Fault::new(
            KeyPath::of("vehicle.speed_hold"),
            "nothing",
            "a body whose speed is held, with stiffness and damping, or a guided body",
        )));
    }
    Ok(())
}

/// The vehicle on its way.
pub(super) struct Roller<'m> {
    system: VehicleSystem<'m>,
    stepper: Stepper,
    x: Vec<f64>,
    h: f64,
    /// Since the speed program was last set.
    steps: u64,
    before: u64,
    axles: Vec<usize>,
    reference: usize,
}

impl<'m> Roller<'m> {
    /// In balance at the case's speed, disturbed.
    pub fn new(case: &Case, stand: &'m Stand, mut x: Vec<f64>, offsets: &[(usize, f64)]) -> Result<Self> {
        let model = &stand.model;
        let map = model.map();
        let mut system = stand.system(case.run.speed);
        stability::check(&mut system, &x, &case.run.integrator)?;
        system.scratch.left_rail = None;
        for (q, by) in offsets {
            x[*q] += by;
        }
        let stepper = Stepper::new(&case.run.integrator, map.size(), system.stiff_blocks());
        Ok(Self {
            system,
            stepper,
            x,
            h: case.run.integrator.step(),
            steps: 0,
            before: 0,
            axles: (0..map.wheelsets).map(|w| map.q(map.bodies + w).start + 1).collect(),
            reference: map.q(model.reference()).start,
        })
    }

    pub fn shift(&mut self, offsets: &[(usize, f64)], share: f64) {
        for (q, by) in offsets {
            self.x[*q] += share * by;
        }
    }

    /// From now on the speed asked for changes at this rate, m/s2.
    pub fn accelerate(&mut self, acceleration: f64) {
        let (s, speed) = self.system.program.at(self.steps as f64 * self.h);
        self.system.program = SpeedProgram { s, speed, acceleration };
        self.before += self.steps;
        self.steps = 0;
    }

    /// Time since the start, s.
    pub fn time(&self) -> f64 {
        (self.before + self.steps) as f64 * self.h
    }

    /// Speed asked for, m/s.
    pub fn speed(&self) -> f64 {
        self.system.program.at(self.steps as f64 * self.h).1
    }

    /// Place of the vehicle, m.
    pub fn place(&self) -> f64 {
        self.x[self.reference]
    }

    /// Lateral places of the axles, m.
    pub fn lateral(&self) -> impl Iterator<Item = f64> + '_ {
        self.axles.iter().map(|i| self.x[*i])
    }

    /// Steps taken since the start.
    pub fn steps(&self) -> u64 {
        self.before + self.steps
    }

    /// Goes on by a number of steps.
    ///
    /// # Errors
    /// [`Error::Diverged`].
    pub fn advance(&mut self, steps: usize) -> Result<()> {
        for _ in 0..steps {
            let t = self.steps as f64 * self.h;
            let end = self.stepper.step(&mut self.system, t, &mut self.x, self.h);
            self.steps += 1;
            let time = self.time();
            divergence::stepped(&self.system, end, time, &self.x)?;
            divergence::check(&mut self.system, time, &self.x)?;
        }
        Ok(())
    }
}

/// Steps from one row to the next.
pub(super) fn stride(integrator: &Integrator, output_step: f64) -> usize {
    (output_step / integrator.step()).round().max(1.0) as usize
}

/// Largest less smallest.
pub(super) fn swing(values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
    if values.is_empty() { 0.0 } else { high - low }
}
