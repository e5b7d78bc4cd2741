//! Traction and brakes: what acts on axles, and the train that hangs behind.
//!
//! Controllers are sampled: every `period` they read axle speeds and the vehicle's speed and leave commands. What lies between two
//! samples is a closed form (the lag of inverter and motor) or an equation of motion (brake blocks, train), so that every integrator
//! sees a smooth right-hand side within a step and keeps its order.
//!
//! A motor's torque acts on the axle and, reversed, on the bogie frame that the axle hangs on: so do brake blocks. Axle loads
//! shift by what that couple and the forces at axle boxes, pivot and coupler make of it; nothing is added by hand.
//!
//! At rest wheels stick ([`stick`]).

pub mod air_brake;
pub mod coupled;
pub mod effort;
pub mod slip;
pub mod stick;
pub mod thermal;
pub mod train;

use crate::body::{Kinematics, coordinate};
use crate::connection::RELAXATION_TIME;
use crate::dynamics::{Model, Scratch, StateMap};
use crate::equipment::air_brake::Pneumatics;
use crate::equipment::coupled::Faces;
use crate::equipment::slip::{Gains, Lag, SlipController, SlipObserver, slip};
use crate::equipment::thermal::Motor;
use crate::equipment::train::Wagons;
use crate::math::{Vec3, interpolate};
use crate::run::law::Output;
use crate::schema::drive::{Drive, Inverter};
use crate::schema::{AirBrake, DynamicBrake, ParkingBrake, Traction};

/// Stick stiffness of the blocks of a wheelset at the rim, N/m.
const BLOCK_STIFFNESS: f64 = 5.0e7;

/// A bogie with its motors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bogie {
    /// Index of the body that motors and blocks hang on.
    pub body: usize,
    /// Its name.
    pub name: String,
    /// Its wheelsets.
    pub wheelsets: Vec<usize>,
}

/// Equipment of a run, compiled.
#[derive(Debug, Clone)]
pub struct Equipment {
    /// What the driver asks for.
    pub drive: Drive,
    /// Bogies, in the order of their first wheelset.
    pub bogies: Vec<Bogie>,
    /// Traction.
    pub traction: Option<Traction>,
    /// Dynamic brake.
    pub dynamic_brake: Option<DynamicBrake>,
    /// Air brake.
    pub air_brake: Option<AirBrake>,
    /// Parking brake with the wheelsets that it acts on.
    pub parking: Option<(ParkingBrake, Vec<bool>)>,
    /// The train.
    pub train: Option<Wagons>,
    /// Pulling faces.
    pub faces: Faces,
}

impl Equipment {
    /// Numbers of state for a vehicle of `wheelsets` wheelsets: deflections of its contacts, of its blocks, the train.
    #[must_use]
    pub fn states(&self, wheelsets: usize) -> usize {
        (stick::MEMORY + 1) * wheelsets + self.train.as_ref().map_or(0, Wagons::states)
    }

    /// What a control law of the user's can set, by name.
    #[must_use]
    pub fn outputs(&self, model: &Model) -> Vec<(String, Output)> {
        let torque = |name: &str| format!("{name}.torque");
        let sets = model.wheelsets.iter().enumerate();
        let mut outputs: Vec<_> = sets.map(|(w, set)| (torque(&set.body.name), Output::Torque(w))).collect();
        let bogies = self.bogies.iter().enumerate();
        outputs.extend(bogies.map(|(b, bogie)| (torque(&bogie.name), Output::BogieTorque(b))));
        if self.air_brake.is_some() {
            outputs.push(("independent_brake".to_owned(), Output::IndependentBrake));
        }
        outputs
    }

    /// What is recorded, by name.
    #[must_use]
    pub fn plan(&self, model: &Model) -> Vec<(String, Quantity)> {
        use Quantity as Q;
        let mut plan = Vec::new();
        let mut add = |name: &str, quantity: Q| plan.push((name.to_owned(), quantity));
        if let Some(traction) = &self.traction {
            add("traction.notch", Q::Notch);
            add("traction.effort", Q::Effort);
            add("traction.adhesion", Q::Adhesion);
            if self.drive.sanding.is_some() {
                add("traction.sanding", Q::Sanding);
            }
            for (b, bogie) in self.bogies.iter().enumerate() {
                add(&format!("traction.{}.effort", bogie.name), Q::BogieEffort(b));
                if traction.thermal.is_some() {
                    add(&format!("traction.{}.temperature", bogie.name), Q::Temperature(b));
                }
            }
        }
        if self.air_brake.is_some() {
            for (name, quantity) in [
                ("pipe", Q::Pipe),
                ("reservoir", Q::Reservoir),
                ("cylinder", Q::Cylinder),
                ("block_force", Q::Block),
            ] {
                add(&format!("brake.{name}"), quantity);
            }
        }
        if self.air_brake.is_some() || self.parking.is_some() {
            add("brake.effort", Q::BrakeEffort);
        }
        if let Some(train) = &self.train {
            add("train.drawbar", Q::Drawbar);
            if train.ahead() > 0 {
                add("train.front.drawbar", Q::FrontDrawbar);
            }
            add("train.rear.v", Q::RearSpeed);
            if train.written.wagons > 1 {
                add("train.largest.drawbar", Q::LargestDrawbar);
                add("train.least.drawbar", Q::LeastDrawbar);
            }
        }
        if model.angled.is_some() {
            add("coupler.front.drawbar", Q::FrontDrawbar);
            add("coupler.rear.drawbar", Q::Drawbar);
        }
        for (w, set) in model.wheelsets.iter().enumerate() {
            let name = &set.body.name;
            add(&format!("{name}.slip"), Q::Slip(w));
            add(&format!("{name}.torque"), Q::Torque(w));
            for (side, label) in ["left", "right"].into_iter().enumerate() {
                add(&format!("{name}.{label}.Fx"), Q::Fx(w, side));
                add(&format!("{name}.{label}.adhesion"), Q::WheelAdhesion(w, side));
            }
        }
        plan
    }
}

/// What a run with equipment records beside the vehicle's motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Notch asked for.
    Notch,
    /// Torque of all motors over the wheel radius, N, + forward.
    Effort,
    /// Longitudinal creep force of all wheels over their load.
    Adhesion,
    /// Factor of sand on friction.
    Sanding,
    /// Torque of a bogie's motors over the wheel radius, N.
    BogieEffort(usize),
    /// Temperature rise of a bogie's motors, share of the limit.
    Temperature(usize),
    /// Brake pipe, Pa.
    Pipe,
    /// Auxiliary reservoir, Pa.
    Reservoir,
    /// Cylinders, Pa.
    Cylinder,
    /// Force of all blocks of a wheelset by the air brake, N.
    Block,
    /// Friction of all blocks at the rims, N, + forward.
    BrakeEffort,
    /// Force in the vehicle's rear coupler, N, + pull.
    Drawbar,
    /// The same in its front coupler.
    FrontDrawbar,
    /// Largest force in any coupling, N.
    LargestDrawbar,
    /// Least force in any coupling, N.
    LeastDrawbar,
    /// Speed of the last wagon, m/s.
    RearSpeed,
    /// Slip of a wheelset.
    Slip(usize),
    /// Motor torque on a wheelset, N m, + forward.
    Torque(usize),
    /// Longitudinal creep force on a wheel, N, + forward.
    Fx(usize, usize),
    /// The same over the wheel's own load.
    WheelAdhesion(usize, usize),
}

/// Equipment as it acts in one run.
#[derive(Debug, Clone)]
pub struct Acting<'m> {
    design: &'m Equipment,
    /// Where its numbers begin in the state.
    first: usize,
    wheelsets: usize,
    lag: f64,
    observer: SlipObserver,
    controllers: Vec<SlipController>,
    torques: Vec<Lag>,
    /// The same without slip control or a control law.
    uncut: Vec<Lag>,
    motors: Vec<Motor>,
    own_brake: Option<Pneumatics>,
    wagon_brakes: Vec<f64>,
    pipes: Vec<Pneumatics>,
    /// Effort of each mass of the train.
    efforts: Vec<Lag>,
    /// Force of all blocks of each wheelset: air, parking, N.
    blocks: Vec<[f64; 2]>,
    /// Rates of contact deflections, written where creepages are.
    returns: Vec<f64>,
    rolling: Vec<f64>,
    sanded: f64,
    /// Independent brake that a control law asks for, Pa.
    asked: Option<f64>,
    /// Forces in the front and rear couplers, N, + pull.
    drawbars: [f64; 2],
    brake_effort: f64,
}

impl<'m> Acting<'m> {
    /// Equipment at the start of a run.
    #[must_use]
    pub fn new(model: &'m Model, design: &'m Equipment) -> Self {
        let wheelsets = model.wheelsets.len();
        let drive = &design.drive;
        let rating = design.traction.as_ref().and_then(|t| t.thermal);
        // Every axle has the same effort.
        let share = |bogie: &Bogie| bogie.wheelsets.len() as f64 / wheelsets as f64;
        let pneumatics = |distance: f64, own: bool| {
            design.air_brake.as_ref().map(|data| Pneumatics::new(data, distance, drive, own))
        };
        let pipes =
            design.train.as_ref().filter(|t| t.written.brake_force > 0.0).map_or(Vec::new(), |train| {
                let [front, rear] = &design.faces.places;
                let length = front.x - rear.x;
                (0..train.masses.len())
                    .filter_map(|i| pneumatics(train.pipe_length(length, i), false))
                    .collect()
            });
        let masses = design.train.as_ref().map_or(0, |t| t.masses.len());
        let mut acting = Self {
            design,
            first: model.map().size(),
            wheelsets,
            lag: design.traction.as_ref().map_or(0.0, |t| t.lag),
            observer: SlipObserver::new(&drive.observer, wheelsets),
            controllers: vec![SlipController::default(); wheelsets],
            torques: vec![Lag::default(); wheelsets],
            uncut: vec![Lag::default(); wheelsets],
            motors: rating
                .iter()
                .flat_map(|r| design.bogies.iter().map(|b| Motor::new(r, share(b))))
                .collect(),
            own_brake: pneumatics(0.0, true),
            wagon_brakes: vec![0.0; masses],
            pipes,
            efforts: vec![Lag::default(); masses],
            blocks: vec![[0.0; 2]; wheelsets],
            returns: vec![0.0; stick::MEMORY * wheelsets],
            rolling: vec![0.0; wheelsets],
            sanded: 1.0,
            asked: None,
            drawbars: [0.0; 2],
            brake_effort: 0.0,
        };
        acting.press();
        acting
    }

    /// Length of its own state.
    #[must_use]
    pub fn states(&self) -> usize {
        self.design.states(self.wheelsets)
    }

    /// Time between samples, s.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.design.drive.period
    }

    fn block(&self, w: usize) -> usize {
        self.first + stick::MEMORY * self.wheelsets + w
    }

    fn train_at(&self) -> usize {
        self.first + (stick::MEMORY + 1) * self.wheelsets
    }

    /// Block forces from pressures.
    fn press(&mut self) {
        let air = match (&self.own_brake, &self.design.air_brake) {
            (Some(p), Some(data)) => p.block_force(data),
            _ => 0.0,
        };
        for (w, block) in self.blocks.iter_mut().enumerate() {
            let parked =
                self.design.parking.as_ref().filter(|(_, on)| self.design.drive.parking_brake && on[w]);
            *block = [air, parked.map_or(0.0, |(brake, _)| brake.block_force)];
        }
        if let Some(data) = &self.design.air_brake {
            for (share, pipe) in self.wagon_brakes.iter_mut().zip(&self.pipes) {
                *share = pipe.cylinder / data.max_cylinder;
            }
        }
    }

    /// One sample of all controllers at time `t` in the state `x`.
    pub fn sample(&mut self, model: &Model, t: f64, x: &[f64]) {
        let drive = &self.design.drive;
        let period = drive.period;
        let map = model.map();
        let v = x[map.u(self.design.faces.body).start];
        self.heat(model, t);
        let (traction, braking) = self.references(t, v);
        self.slip_control(model, map, t, x, v, traction - braking);
        self.command_locomotives(t, x);
        self.sanded = match &drive.sanding {
            Some(sand) if t >= sand.delay && sand.demand.at(t - sand.delay) > 0.0 => sand.friction_factor,
            _ => 1.0,
        };
        let asked = self.asked.unwrap_or_else(|| drive.independent_brake.at(t));
        let independent = asked.max(self.blended(model, t, v));
        if let (Some(own), Some(data)) = (&mut self.own_brake, &self.design.air_brake) {
            if t > 0.0 {
                own.pass(data, drive, independent, t, period);
            }
            for pipe in &mut self.pipes {
                if t > 0.0 {
                    pipe.pass(data, drive, 0.0, t, period);
                }
            }
        }
        self.press();
    }

    /// Cylinder pressure (Pa) that makes up what the dynamic brake lacks of its demand: where its curve or `effort_limit` is below it, and
    /// while it builds up. What slip control takes is not made up: the same wheels, which all have the one cylinder pressure, would
    /// have to carry it. A control law's torque counts as slip control's.
    fn blended(&self, model: &Model, t: f64, v: f64) -> f64 {
        let drive = &self.design.drive;
        let (true, Some(data), Some(brake)) =
            (drive.blending, &self.design.air_brake, &self.design.dynamic_brake)
        else {
            return 0.0;
        };
        let wanted = drive.dynamic_brake.at(t) * brake.max_effort;
        // What the motors hold back with, either way that the vehicle rolls.
        let back = if v < 0.0 { 1.0 } else { -1.0 };
        let given = self.uncut.iter().zip(&model.wheelsets);
        let given: f64 = given.map(|(lag, set)| (back * lag.at(t, self.lag)).max(0.0) / set.radius).sum();
        let missing = if wanted > 0.0 { (wanted - given).max(0.0) } else { 0.0 };
        Pneumatics::pressure_for(data, missing, self.wheelsets, v)
    }

    /// Puts what a control law sets at time `t` over what the vehicle's own controllers have just commanded; brakes follow from
    /// the next sample on.
    pub fn overrule(&mut self, t: f64, output: Output, value: f64) {
        match output {
            Output::Torque(w) => self.torques[w].command(t, self.lag, value),
            Output::BogieTorque(b) => {
                for w in &self.design.bogies[b].wheelsets {
                    self.torques[*w].command(t, self.lag, value);
                }
            }
            Output::IndependentBrake => self.asked = Some(value),
        }
    }

    fn heat(&mut self, model: &Model, t: f64) {
        let period = self.design.drive.period;
        if t <= 0.0 {
            return;
        }
        for (motor, bogie) in self.motors.iter_mut().zip(&self.design.bogies) {
            let effort =
                bogie.wheelsets.iter().map(|w| self.torques[*w].at(t, self.lag) / model.wheelsets[*w].radius);
            motor.pass(effort.sum(), period);
        }
    }

    /// Efforts asked for, N: traction and dynamic brake, both positive.
    fn references(&self, t: f64, v: f64) -> (f64, f64) {
        let drive = &self.design.drive;
        let limit = drive.effort_limit.unwrap_or(f64::INFINITY);
        let traction =
            self.design.traction.as_ref().map_or(0.0, |data| effort::traction(data, drive.notch.at(t), v));
        let braking = self
            .design
            .dynamic_brake
            .as_ref()
            .map_or(0.0, |data| effort::dynamic_brake(data, drive.dynamic_brake.at(t), v));
        (traction.min(limit), braking.min(limit) * effort::direction(v).abs())
    }

    fn slip_control(&mut self, model: &Model, map: StateMap, t: f64, x: &[f64], v: f64, effort: f64) {
        let Some(data) = &self.design.traction else { return };
        let drive = &self.design.drive;
        let sign = if effort < 0.0 { -1.0 } else { 1.0 };
        // A brake works against the motion, whichever way that goes.
        let forward = if effort < 0.0 && v < 0.0 { -1.0 } else { 1.0 };
        let limit = drive.slip_limit.unwrap_or(data.slip_limit);
        let wanted =
            drive.slip_reference.as_ref().map_or(data.slip_reference, |demand| demand.at(t)).min(limit);
        let gains = Gains { kp: data.kp, ki: data.ki };
        let radius = |w: usize| model.wheelsets[w].radius;
        let Self { observer, controllers, torques, uncut, lag, .. } = self;
        let mut found = |w: usize| {
            let spin = x[map.u(map.bodies + w).start + coordinate::THETA];
            sign * forward * slip(observer.rim_speed(w, -spin * radius(w)), v)
        };
        let share = effort.abs() / self.wheelsets as f64;
        let mut drive_unit = |unit: &[usize]| {
            let worst = unit.iter().map(|w| found(*w)).fold(f64::NEG_INFINITY, f64::max);
            let reference = share * radius(unit[0]);
            let controller = &mut controllers[unit[0]];
            let torque = if reference <= 0.0 {
                controller.reset();
                0.0
            } else if drive.slip_control {
                controller.sample(&gains, wanted - worst, reference, drive.period)
            } else {
                reference
            };
            for w in unit {
                torques[*w].command(t, *lag, sign * forward * torque);
                uncut[*w].command(t, *lag, sign * forward * reference);
            }
        };
        for bogie in &self.design.bogies {
            match drive.inverter {
                Inverter::Bogie => drive_unit(&bogie.wheelsets),
                Inverter::Axle => bogie.wheelsets.chunks(1).for_each(&mut drive_unit),
            }
        }
    }

    /// What acts at `t`, added to forces and moments; rates of the equipment's own state. After every other force.
    pub fn act(
        &mut self,
        model: &Model,
        map: StateMap,
        t: f64,
        x: &[f64],
        dx: &mut [f64],
        scratch: &mut Scratch,
    ) {
        self.brake_effort = 0.0;
        for bogie in &self.design.bogies {
            let mut reaction = 0.0;
            for w in &bogie.wheelsets {
                let motor = self.torques[*w].at(t, self.lag);
                let block = self.block_torque(model, map, *w, x, dx);
                scratch.wheel_moment[*w].y -= motor + block;
                reaction += motor + block;
            }
            let axis = scratch.kinematics[bogie.body].pose.R.column(1).into_owned();
            scratch.wrench[bogie.body].m += reaction * axis;
        }
        dx[self.first..self.first + self.returns.len()].copy_from_slice(&self.returns);
        self.resist(model, scratch);
        self.couple(model, t, x, dx, scratch);
    }

    /// Torque (N m, + forward) of the blocks on wheelset `w`: sticking, a spring; sliding, friction.
    fn block_torque(&mut self, model: &Model, map: StateMap, w: usize, x: &[f64], dx: &mut [f64]) -> f64 {
        let radius = model.wheelsets[w].radius;
        let spin = x[map.u(map.bodies + w).start + coordinate::THETA];
        let rim = -spin * radius;
        let friction =
            self.design.air_brake.as_ref().map_or(0.0, |data| interpolate(&data.block_friction, rim.abs()));
        let parked = self.design.parking.as_ref().map_or(0.0, |(brake, _)| brake.block_friction);
        let [air, parking] = self.blocks[w];
        let limit = friction * air + parked * parking;
        let at = self.block(w);
        let force = (BLOCK_STIFFNESS * x[at]).clamp(-limit, limit);
        dx[at] = rim - (x[at] - force / BLOCK_STIFFNESS) / RELAXATION_TIME;
        self.brake_effort -= force;
        -force * radius
    }

    /// Running resistance of the vehicle, at the body that the coupler is on. Curve resistance is none of it: that is what creep at its
    /// wheels makes in a curve, and they are here.
    fn resist(&self, model: &Model, scratch: &mut Scratch) {
        if !self.design.drive.resistance {
            return;
        }
        let body = self.design.faces.body;
        let k: &Kinematics = &scratch.kinematics[body];
        let (mass, v) = (model.mass(), k.v_T.x);
        let force = k.frame.R_IT.column(0) * (-effort::davis(mass, 1.0, v) * effort::direction(v));
        scratch.wrench[body].f += force;
    }

    /// Factor of sand on friction.
    #[must_use]
    pub fn sand(&self) -> f64 {
        self.sanded
    }

    /// Body whose speed is the vehicle's.
    #[must_use]
    pub fn body(&self) -> usize {
        self.design.faces.body
    }

    /// The rear coupler from that body's centre of mass, body axes, m.
    #[must_use]
    pub fn coupler(&self) -> &Vec3 {
        &self.design.faces.places[1]
    }

    /// A recorded number, at the last evaluation.
    #[must_use]
    pub fn value(&self, quantity: Quantity, model: &Model, t: f64, x: &[f64], scratch: &Scratch) -> f64 {
        use Quantity as Q;
        let map = model.map();
        let torque = |w: usize| self.torques[w].at(t, self.lag);
        let effort = |w: usize| torque(w) / model.wheelsets[w].radius;
        let fx = |w: usize, side: usize| {
            scratch.wheels[w][side].contacts().iter().map(|c| c.creep[0]).sum::<f64>()
        };
        let load = |w: usize, side: usize| scratch.wheels[w][side].Q;
        let ratio = |force: f64, load: f64| if load > 0.0 { force / load } else { 0.0 };
        let wheels = || (0..self.wheelsets).flat_map(|w| [(w, 0), (w, 1)]);
        let own = self.own_brake;
        match quantity {
            Q::Notch => self.design.drive.notch.at(t),
            Q::Effort => (0..self.wheelsets).map(effort).sum(),
            Q::Adhesion => {
                ratio(wheels().map(|(w, s)| fx(w, s)).sum(), wheels().map(|(w, s)| load(w, s)).sum())
            }
            Q::Sanding => self.sanded,
            Q::BogieEffort(b) => self.design.bogies[b].wheelsets.iter().map(|w| effort(*w)).sum(),
            Q::Temperature(b) => self.motors.get(b).map_or(f64::NAN, Motor::temperature),
            Q::Pipe => own.map_or(f64::NAN, |p| p.pipe),
            Q::Reservoir => own.map_or(f64::NAN, |p| p.reservoir),
            Q::Cylinder => own.map_or(f64::NAN, |p| p.cylinder),
            Q::Block => self.blocks.first().map_or(f64::NAN, |b| b[0]),
            Q::BrakeEffort => self.brake_effort,
            Q::Drawbar => self.drawbars[1],
            Q::FrontDrawbar => self.drawbars[0],
            Q::LargestDrawbar => self.drawbar_of(model, x, scratch, f64::max),
            Q::LeastDrawbar => self.drawbar_of(model, x, scratch, f64::min),
            Q::RearSpeed => x[x.len() - train::WAGON + 1],
            Q::Slip(w) => {
                let spin = x[map.u(map.bodies + w).start + coordinate::THETA];
                slip(-spin * model.wheelsets[w].radius, x[map.u(self.body()).start])
            }
            Q::Torque(w) => torque(w),
            Q::Fx(w, side) => fx(w, side),
            Q::WheelAdhesion(w, side) => ratio(fx(w, side), load(w, side)),
        }
    }
}
