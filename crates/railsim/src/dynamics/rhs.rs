//! The right-hand side as a list of stages: angles, kinematics, contacts, connections, speed hold, accelerations.

use crate::body::{Wrench, kinematics, rigid_body, steady_speeds, wheelset};
use crate::contact::creep::CreepLaw;
use crate::contact::creepage::{TrackMotion, track_roll};
use crate::contact::geometry_table::MAX_CONTACTS;
use crate::dynamics::axle::{Axle, total_force};
use crate::dynamics::joints::Joints;
use crate::dynamics::model::{Contact, Model};
use crate::dynamics::scratch::{LeftRail, Scratch, Wheel};
use crate::dynamics::state::{PAIR, StateMap, WHEELSET, array, array_mut};
use crate::dynamics::stiff;
use crate::equipment::Acting;
use crate::integrator::{StiffBlock, System};
use crate::math::{Vec3, widest};
use crate::track::Deviation;

/// Below this rolling speed (m/s) creepages are formed with it instead, so that standstill stays finite.
pub const LEAST_ROLLING_SPEED: f64 = 0.1;

/// Where the moving frame of the speed hold is: constant acceleration from a start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedProgram {
    /// Place at t = 0, m.
    pub s: f64,
    /// Speed at t = 0, m/s.
    pub speed: f64,
    /// m/s2.
    pub acceleration: f64,
}

impl SpeedProgram {
    /// Place and speed at time `t`.
    #[must_use]
    pub fn at(&self, t: f64) -> (f64, f64) {
        (self.s + t * (self.speed + 0.5 * self.acceleration * t), self.speed + self.acceleration * t)
    }
}

/// A model with the buffers of one run: what an integrator steps.
#[derive(Debug)]
pub struct VehicleSystem<'m> {
    /// The model.
    pub model: &'m Model,
    /// Buffers of the last evaluation.
    pub scratch: Scratch,
    /// Speed asked for.
    pub program: SpeedProgram,
    /// False on the ideal design track: irregularities are left out.
    pub irregular: bool,
    /// False at standstill: contacts stick and creep forces are left out.
    pub creeping: bool,
    /// Whether the speed hold acts, where there is one.
    pub holding: bool,
    /// Traction, brakes and train at work, with their own numbers at the end of the state.
    pub acting: Option<Box<Acting<'m>>>,
    map: StateMap,
    level: bool,
    /// Weight of each body and wheelset, inertial axes.
    weights: Vec<Wrench>,
    joints: Joints,
}

fn weight(newtons: f64) -> Wrench {
    Wrench { f: Vec3::new(0.0, 0.0, newtons), m: Vec3::zeros() }
}

impl<'m> VehicleSystem<'m> {
    /// A system at rest.
    #[must_use]
    pub fn new(model: &'m Model, program: SpeedProgram) -> Self {
        Self {
            model,
            scratch: Scratch::new(model),
            program,
            irregular: true,
            creeping: true,
            holding: true,
            acting: None,
            map: model.map(),
            level: model.layout.is_tangent(),
            weights: (0..model.count()).map(|i| weight(model.rigid(i).mass * model.gravity)).collect(),
            joints: Joints::new(&model.links),
        }
    }

    /// The track under each wheelset, and sines and cosines of every angle at once.
    #[inline(always)]
    fn turn_stage(&mut self, x: &[f64]) {
        let (bodies, sets) = self.map.parts(x);
        let Scratch { turns, track_turns, deviation, .. } = &mut self.scratch;
        for (i, q) in bodies.iter().enumerate() {
            turns.set(3 * i, q[3]);
            turns.set(3 * i + 1, q[4]);
            turns.set(3 * i + 2, q[5]);
        }
        for (w, (q, deviation)) in sets.iter().zip(deviation).enumerate() {
            // Not the second: how far an axle has turned is nobody's angle.
            let i = bodies.len() + w;
            turns.set(3 * i, q[3]);
            turns.set(3 * i + 2, q[5]);
            *deviation = if self.irregular { self.model.deviation.at(q[0]) } else { Deviation::default() };
            let (widening, slope) = self.model.layout.widening(q[0]);
            deviation.gauge += widening;
            deviation.dgauge_ds += slope;
            track_turns.set(w, track_roll(deviation, q[8]));
        }
        turns.update();
        track_turns.update();
    }

    #[inline(always)]
    fn kinematics_stage(&mut self, x: &[f64], dx: &mut [f64]) {
        let ((bodies, sets), (d_bodies, d_sets)) = (self.map.parts(x), self.map.parts_mut(dx));
        let (layout, level) = (&self.model.layout, self.level);
        let Scratch { turns, kinematics: all, wrench, .. } = &mut self.scratch;
        wrench.copy_from_slice(&self.weights);
        let (k_bodies, k_sets) = all.split_at_mut(bodies.len());
        for (i, ((x, dx), k)) in bodies.iter().zip(d_bodies).zip(k_bodies).enumerate() {
            let (q, u, dq) = (array(x, 0), array(x, 6), array_mut(dx, 0));
            kinematics(q, turns.three(i), u, layout.frame(q[0]), false, level, dq, k);
        }
        for (w, ((x, dx), k)) in sets.iter().zip(d_sets).zip(k_sets).enumerate() {
            let (q, u, dq) = (array(x, 0), array(x, PAIR), array_mut(dx, 0));
            kinematics(q, turns.three(bodies.len() + w), u, layout.frame(q[0]), true, level, dq, k);
        }
    }

    /// Guided bodies keep their place in the track frame, which moves at the speed asked for.
    #[inline(always)]
    fn guide_stage(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        for &i in &self.model.guided {
            let q = array(x, self.map.start(i));
            let frame = self.model.layout.frame(q[0]);
            let u = steady_speeds(q, &frame, self.program.at(t).1, 0.0, false);
            let (turns, k) = (self.scratch.turns.three(i), &mut self.scratch.kinematics[i]);
            kinematics(q, turns, &u, frame, false, self.level, array_mut(dx, self.map.start(i)), k);
        }
    }

    /// Contacts of every wheel, then the creep forces of all of them in one go, then what they add up to.
    #[inline(always)]
    fn contact_stage(&mut self, x: &[f64]) {
        self.scratch.creep_cases.clear();
        for (w, numbers) in self.map.parts(x).1.iter().enumerate() {
            self.place_wheels(w, numbers);
        }
        self.creep_stage(x);
        for w in 0..self.model.wheelsets.len() {
            self.add_wheel_forces(w);
        }
    }

    #[inline(always)]
    fn place_wheels(&mut self, w: usize, x: &[f64; WHEELSET]) {
        let scratch = &mut self.scratch;
        let k = &scratch.kinematics[self.model.bodies.len() + w];
        let (q, tq, tu) = (array(x, 0), array::<3>(x, 6), array::<3>(x, PAIR + 6));
        let axle = Axle {
            model: self.model,
            set: &self.model.wheelsets[w],
            creeping: self.creeping,
            q,
            k,
            w_T: k.R_TB * k.w_B,
            speed: k.v_T.x.abs().max(LEAST_ROLLING_SPEED),
            track: TrackMotion { y: tq[0], z: tq[1], phi: tq[2], vy: tu[0], vz: tu[1], vphi: tu[2] },
            track_turn: scratch.track_turns.at(w),
            deviation: scratch.deviation[w],
        };
        // One after the other instead of a loop: each side is compiled with its own sign.
        let ([left, right], cases) = (&mut scratch.wheels[w], &mut scratch.creep_cases);
        let ends = [(-1.0, axle.wheel(-1.0, left, cases)), (1.0, axle.wheel(1.0, right, cases))];
        for (side, end) in ends {
            if let Err(out) = end {
                scratch.left_rail = Some(LeftRail { wheelset: w, side, shift: out.shift, roll: out.roll });
            }
        }
    }

    #[inline(always)]
    fn creep_stage(&mut self, x: &[f64]) {
        let Contact::Profiles { law, friction, .. } = &self.model.contact else { return };
        if self.acting.is_some() {
            self.stick_stage(x);
        }
        let scratch = &mut self.scratch;
        let forces = &mut scratch.creep_forces[..scratch.creep_cases.len()];
        law.forces(&scratch.creep_cases, forces);
        // A contact that was asked about is one with a normal force: the same order, the same choice.
        let mut answers = forces.iter();
        let wheels = scratch.wheels.iter_mut().flatten();
        for contact in wheels.flat_map(Wheel::contacts_mut).filter(|c| c.creeps) {
            if let Some(force) = answers.next() {
                contact.creep = [force.fx, force.fy];
            }
        }
        if friction.has_reductions() {
            self.reduced_stage(x);
        }
    }

    /// Creepages at and near standstill, and sand, put into what the creep-force law is asked.
    #[inline(never)]
    fn stick_stage(&mut self, x: &[f64]) {
        let (Some(acting), scratch) = (&mut self.acting, &mut self.scratch) else { return };
        acting.rolls(scratch, self.model.bodies.len());
        let mut cases = scratch.creep_cases.iter_mut();
        for (w, wheels) in scratch.wheels.iter_mut().enumerate() {
            for (side, wheel) in wheels.iter_mut().enumerate() {
                // By its zone: a contact keeps its own memory when another one comes or goes.
                let mut touches = [false; MAX_CONTACTS];
                for contact in wheel.contacts_mut().iter_mut().filter(|c| c.creeps) {
                    let Some(case) = cases.next() else { return };
                    case.mu *= acting.sand();
                    let steady = [case.creepage.xi, case.creepage.eta];
                    let known = Some((contact.placed.slip, steady, case.patch.a));
                    let zone = contact.geometry.map_or(0, |point| point.zone as usize);
                    let given = acting.creepage(self.model, self.map, (w, side, zone), known, x);
                    [case.creepage.xi, case.creepage.eta] = given;
                    contact.placed.creepage = case.creepage;
                    touches[zone] = true;
                }
                for (zone, _) in touches.iter().enumerate().filter(|(_, touches)| !**touches) {
                    acting.creepage(self.model, self.map, (w, side, zone), None, x);
                }
            }
        }
    }

    /// Creep forces again where a stretch of track has reduction factors of its own.
    #[inline(never)]
    fn reduced_stage(&mut self, x: &[f64]) {
        let Contact::Profiles { law: CreepLaw::Polach(law), friction, .. } = &self.model.contact else {
            return;
        };
        let mut cases = self.scratch.creep_cases.iter();
        for (w, wheels) in self.scratch.wheels.iter_mut().enumerate() {
            let s = x[self.map.q(self.map.bodies + w).start];
            let own = friction.reduction(s, law);
            for contact in wheels.iter_mut().flat_map(Wheel::contacts_mut).filter(|c| c.creeps) {
                let Some(case) = cases.next() else { return };
                let force = own.force(&case.patch, &case.creepage, case.mu);
                contact.creep = [force.fx, force.fy];
            }
        }
    }

    #[inline(never)]
    fn acting_stage(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        if let Some(acting) = &mut self.acting {
            acting.act(self.model, self.map, t, x, dx, &mut self.scratch);
        }
    }

    #[inline(always)]
    fn add_wheel_forces(&mut self, w: usize) {
        let at = self.model.bodies.len() + w;
        let scratch = &mut self.scratch;
        let k = &scratch.kinematics[at];
        let mut force = Vec3::zeros();
        let mut moment = Vec3::zeros();
        let mut load = [0.0; 3];
        for (wheel, sigma) in scratch.wheels[w].iter_mut().zip([-1.0, 1.0]) {
            let mut on_wheel = Vec3::zeros();
            for contact in wheel.contacts() {
                let f = total_force(contact);
                on_wheel += f;
                moment += contact.placed.lever.cross(&f);
                let [y, z] = contact.placed.point;
                load[2] -= y * f.z - z * f.y;
            }
            wheel.Q = -on_wheel.z;
            wheel.Y = -sigma * on_wheel.y;
            force += on_wheel;
        }
        load[0] = -force.y;
        load[1] = -force.z;
        scratch.wrench[at].f += k.frame.R_IT * force;
        scratch.wheel_moment[w] = k.R_TB.tr_mul(&moment);
        scratch.track_load[w] = load;
    }

    #[inline(always)]
    fn connection_stage(&mut self, x: &[f64], dx: &mut [f64]) {
        let (kinematics, wrench) = (&self.scratch.kinematics, &mut self.scratch.wrench);
        self.joints.act(&self.model.links, kinematics, x, dx, wrench);
    }

    #[inline(always)]
    fn speed_hold_stage(&mut self, t: f64, x: &[f64]) {
        if let Some(hold) = &self.model.speed_hold
            && self.holding
        {
            let (s, v) = self.program.at(t);
            let k = &self.scratch.kinematics[hold.body];
            let force = hold.stiffness * (s - x[self.map.q(hold.body)][0]) + hold.damping * (v - k.s_dot);
            let pull = k.frame.R_IT.column(0) * force;
            // What a driven vehicle pulls against hangs on its coupler.
            if let Some(acting) = &self.acting {
                self.scratch.wrench[hold.body].m += (k.pose.R * acting.coupler()).cross(&pull);
            }
            self.scratch.wrench[hold.body].f += pull;
        }
    }

    #[inline(always)]
    fn acceleration_stage(&mut self, x: &[f64], dx: &mut [f64]) {
        let ((bodies, sets), (d_bodies, d_sets)) = (self.map.parts(x), self.map.parts_mut(dx));
        let Scratch { kinematics, wrench, wheel_moment, track_load, .. } = &self.scratch;
        let (k_bodies, k_sets) = kinematics.split_at(bodies.len());
        let (w_bodies, w_sets) = wrench.split_at(bodies.len());
        for ((body, dx), (k, wrench)) in
            self.model.bodies.iter().zip(d_bodies).zip(k_bodies.iter().zip(w_bodies))
        {
            let du = array_mut(dx, 6);
            rigid_body::translate(k, body.mass, wrench, self.level, du);
            rigid_body::rotate(k, &body.inertia, &k.pose.R.tr_mul(&wrench.m), du);
        }
        let forces = k_sets.iter().zip(w_sets).zip(wheel_moment.iter().zip(track_load));
        for ((set, (x, dx)), ((k, wrench), (moment, load))) in
            self.model.wheelsets.iter().zip(sets.iter().zip(d_sets)).zip(forces)
        {
            let du = array_mut(dx, PAIR);
            rigid_body::translate(k, set.body.mass, wrench, self.level, du);
            wheelset::rotate(k, &set.body.inertia, wrench, moment, du);
            self.accelerate_track(x, load, dx);
        }
        for &i in &self.model.guided {
            let du = &mut dx[self.map.u(i)];
            du.fill(0.0);
            du[0] = self.program.acceleration;
        }
    }

    /// The track mass under a wheelset, where there is one; `load` is on it.
    #[inline(always)]
    fn accelerate_track(&self, x: &[f64; WHEELSET], load: &[f64; 3], dx: &mut [f64; WHEELSET]) {
        let Some(support) = &self.model.support else {
            *array_mut::<3>(dx, 6) = [0.0; 3];
            *array_mut::<3>(dx, PAIR + 6) = [0.0; 3];
            return;
        };
        let m = [support.mass, support.mass, support.inertia];
        for d in 0..3 {
            let (q, v) = (x[6 + d], x[PAIR + 6 + d]);
            dx[6 + d] = v;
            dx[PAIR + 6 + d] = (load[d] - support.stiffness[d] * q - support.damping[d] * v) / m[d];
        }
    }
}

impl System for VehicleSystem<'_> {
    fn size(&self) -> usize {
        self.map.size() + self.acting.as_ref().map_or(0, |acting| acting.states())
    }

    fn rhs(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        widest::run(&mut Stages { system: self, t, x, dx });
    }

    fn stiff_blocks(&self) -> &[StiffBlock] {
        &self.model.stiff_blocks
    }

    fn stiff_matrices(&mut self, block: usize, k: &mut [f64], c: &mut [f64]) {
        let sticking = self.acting.as_ref().map_or(0.0, |acting| acting.sticking(block));
        stiff::matrices(self.model, &self.scratch, block, sticking, k, c);
    }

    fn reject(&mut self) {
        self.scratch.left_rail = None;
    }
}

/// An evaluation, in the widest registers that there are.
struct Stages<'a, 'm> {
    system: &'a mut VehicleSystem<'m>,
    t: f64,
    x: &'a [f64],
    dx: &'a mut [f64],
}

impl widest::Work for Stages<'_, '_> {
    #[inline(always)]
    fn run(&mut self) {
        self.system.stages(self.t, self.x, self.dx);
    }
}

impl VehicleSystem<'_> {
    /// The right-hand side ([`System::rhs`]) with the instructions that every processor has.
    // Stages and what they call are `inline(always)`, so that they are compiled again for wider ones.
    #[inline(always)]
    pub fn stages(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        self.turn_stage(x);
        self.kinematics_stage(x, dx);
        self.guide_stage(t, x, dx);
        self.contact_stage(x);
        self.connection_stage(x, dx);
        self.speed_hold_stage(t, x);
        if self.acting.is_some() {
            self.acting_stage(t, x, dx);
        }
        self.acceleration_stage(x, dx);
    }
}
