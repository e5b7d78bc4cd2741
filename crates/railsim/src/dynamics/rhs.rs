//! The right-hand side as a list of stages: kinematics, contacts, connections, speed hold, accelerations.

use crate::body::{Kinematics, Wheelset, Wrench, kinematics, rigid_body, steady_speeds, wheelset};
use crate::connection::lanes::BushingBlock;
use crate::connection::{Law, Pair, Pose, Relative};
use crate::contact::creep::{CreepCase, CreepLaw, Creepage, Patch};
use crate::contact::creepage::{PlacedContact, TrackMotion, WheelPose, place, rail_pose, wheel_pose};
use crate::contact::geometry_table::{ContactPoint, MAX_CONTACTS};
use crate::contact::normal::hunt_crossley;
use crate::contact::textbook::Textbook;
use crate::dynamics::model::{Contact, Link, Model};
use crate::dynamics::scratch::{ContactForce, LeftRail, Scratch, Wheel};
use crate::dynamics::state::StateMap;
use crate::dynamics::stiff;
use crate::equipment::Acting;
use crate::integrator::{StiffBlock, System};
use crate::math::Vec3;
use crate::math::cube_root::cube_root;
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
    joints: Joints,
}

/// Connections as a run evaluates them: everything between the same two bodies sees one relative motion, bushings go side by
/// side.
#[derive(Debug)]
struct Joints {
    /// Bodies A and B of each joint.
    pairs: Vec<(usize, usize)>,
    motions: Vec<Relative>,
    /// What its connections add up to, on B about A's centre of mass, in A's axes.
    sums: Vec<Wrench>,
    blocks: Vec<BushingBlock>,
    /// Joint and link of every connection that is in no block.
    single: Vec<(usize, usize)>,
}

impl Joints {
    fn new(links: &[Link]) -> Self {
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        let (mut blocks, mut single) = (Vec::new(), Vec::new());
        for (i, link) in links.iter().enumerate() {
            let pair = (link.a, link.b);
            let joint = pairs.iter().position(|p| *p == pair).unwrap_or_else(|| {
                pairs.push(pair);
                pairs.len() - 1
            });
            let beside = match &link.law {
                Law::Bushing(bushing) if link.axes.is_none() => {
                    if blocks.last().is_none_or(BushingBlock::is_full) {
                        blocks.push(BushingBlock::empty());
                    }
                    blocks.last_mut().is_some_and(|block| block.add(joint, bushing, &link.mount))
                }
                _ => false,
            };
            if !beside {
                single.push((joint, i));
            }
        }
        let still = Relative::between(&Pose::at(Vec3::zeros()), &Pose::at(Vec3::zeros()));
        let (motions, sums) = (vec![still; pairs.len()], vec![Wrench::zero(); pairs.len()]);
        Self { pairs, motions, sums, blocks, single }
    }
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
            joints: Joints::new(&model.links),
        }
    }

    #[inline(always)]
    fn kinematics_stage(&mut self, x: &[f64], dx: &mut [f64]) {
        for i in 0..self.model.count() {
            let q = &x[self.map.q(i)];
            let frame = self.model.layout.frame(q[0]);
            let spins = i >= self.model.bodies.len();
            let (u, k) = (&x[self.map.u(i)], &mut self.scratch.kinematics[i]);
            kinematics(q, u, frame, spins, self.level, &mut dx[self.map.q(i)], k);
            self.scratch.wrench[i] = Wrench {
                f: Vec3::new(0.0, 0.0, self.model.rigid(i).mass * self.model.gravity),
                m: Vec3::zeros(),
            };
        }
    }

    /// Guided bodies keep their place in the track frame, which moves at the speed asked for.
    #[inline(always)]
    fn guide_stage(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        for &i in &self.model.guided {
            let q = &x[self.map.q(i)];
            let frame = self.model.layout.frame(q[0]);
            let u = steady_speeds(q, &frame, self.program.at(t).1, 0.0, false);
            let k = &mut self.scratch.kinematics[i];
            kinematics(q, &u, frame, false, self.level, &mut dx[self.map.q(i)], k);
        }
    }

    /// Contacts of every wheel, then the creep forces of all of them in one go, then what they add up to.
    #[inline(always)]
    fn contact_stage(&mut self, x: &[f64]) {
        self.scratch.creep_cases.clear();
        for w in 0..self.model.wheelsets.len() {
            self.place_wheels(w, x);
        }
        self.creep_stage(x);
        for w in 0..self.model.wheelsets.len() {
            self.add_wheel_forces(w);
        }
    }

    #[inline(always)]
    fn place_wheels(&mut self, w: usize, x: &[f64]) {
        let at = self.model.bodies.len() + w;
        let scratch = &mut self.scratch;
        let q = &x[self.map.q(at)];
        let k = &scratch.kinematics[at];
        let mut deviation = if self.irregular { self.model.deviation.at(q[0]) } else { Deviation::default() };
        let (widening, slope) = self.model.layout.widening(q[0]);
        deviation.gauge += widening;
        deviation.dgauge_ds += slope;
        scratch.deviation[w] = deviation;
        let (tq, tu) = (&x[self.map.track_q(w)], &x[self.map.track_u(w)]);
        let axle = Axle {
            model: self.model,
            set: &self.model.wheelsets[w],
            creeping: self.creeping,
            q,
            k,
            w_T: k.R_TB * k.w_B,
            speed: k.v_T.x.abs().max(LEAST_ROLLING_SPEED),
            track: TrackMotion { y: tq[0], z: tq[1], phi: tq[2], vy: tu[0], vz: tu[1], vphi: tu[2] },
            deviation,
        };
        for (side, sigma) in [-1.0, 1.0].into_iter().enumerate() {
            let wheel = &mut scratch.wheels[w][side];
            if let Err(out) = axle.wheel(sigma, wheel, &mut scratch.creep_cases) {
                scratch.left_rail =
                    Some(LeftRail { wheelset: w, side: sigma, shift: out.shift, roll: out.roll });
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
                let mut count = 0;
                for contact in wheel.contacts_mut().iter_mut().filter(|c| c.creeps) {
                    let Some(case) = cases.next() else { return };
                    case.mu *= acting.sand();
                    let steady = [case.creepage.xi, case.creepage.eta];
                    let known = Some((contact.placed.slip, steady, case.patch.a));
                    let given = acting.creepage(self.model, self.map, (w, side, count), known, x);
                    [case.creepage.xi, case.creepage.eta] = given;
                    contact.placed.creepage = case.creepage;
                    count += 1;
                }
                for none in count..MAX_CONTACTS {
                    acting.creepage(self.model, self.map, (w, side, none), None, x);
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
        let Joints { pairs, motions, sums, blocks, single } = &mut self.joints;
        let (kinematics, wrench) = (&self.scratch.kinematics, &mut self.scratch.wrench);
        for ((motion, sum), (a, b)) in motions.iter_mut().zip(sums.iter_mut()).zip(&*pairs) {
            *motion = Relative::between(&kinematics[*a].pose, &kinematics[*b].pose);
            *sum = Wrench::zero();
        }
        for block in &*blocks {
            block.apply(motions, sums);
        }
        for (joint, link) in &*single {
            let link = &self.model.links[*link];
            let one = link.wrench(&motions[*joint], x);
            sums[*joint].f += one.f;
            sums[*joint].m += one.m;
            if !link.memory.is_empty() {
                link.memory_rates(&motions[*joint], x, dx);
            }
        }
        for ((motion, sum), (a, b)) in motions.iter().zip(&*sums).zip(&*pairs) {
            let pair = Pair::new(sum, motion, &kinematics[*a].pose.R);
            wrench[*a].f += pair.on_A.f;
            wrench[*a].m += pair.on_A.m;
            wrench[*b].f += pair.on_B.f;
            wrench[*b].m += pair.on_B.m;
        }
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
        let first = self.model.bodies.len();
        for i in 0..self.model.count() {
            let body = self.model.rigid(i);
            let (k, wrench) = (&self.scratch.kinematics[i], &self.scratch.wrench[i]);
            let du = &mut dx[self.map.u(i)];
            rigid_body::translate(k, body.mass, wrench, self.level, du);
            if i < first {
                rigid_body::rotate(k, &body.inertia, &k.pose.R.tr_mul(&wrench.m), du);
            } else {
                wheelset::rotate(k, &body.inertia, wrench, &self.scratch.wheel_moment[i - first], du);
            }
        }
        for &i in &self.model.guided {
            let du = &mut dx[self.map.u(i)];
            du.fill(0.0);
            du[0] = self.program.acceleration;
        }
        for w in 0..self.model.wheelsets.len() {
            let (tq, tu) = (self.map.track_q(w), self.map.track_u(w));
            match &self.model.support {
                Some(support) => {
                    let m = [support.mass, support.mass, support.inertia];
                    for d in 0..3 {
                        let (q, v) = (x[tq.start + d], x[tu.start + d]);
                        dx[tq.start + d] = v;
                        dx[tu.start + d] = (self.scratch.track_load[w][d]
                            - support.stiffness[d] * q
                            - support.damping[d] * v)
                            / m[d];
                    }
                }
                None => {
                    dx[tq].fill(0.0);
                    dx[tu].fill(0.0);
                }
            }
        }
    }
}

/// A wheelset as its two wheels see it.
struct Axle<'a> {
    model: &'a Model,
    set: &'a Wheelset,
    creeping: bool,
    q: &'a [f64],
    k: &'a Kinematics,
    w_T: Vec3,
    speed: f64,
    track: TrackMotion,
    deviation: Deviation,
}

/// Angle of a contact's normal to the vertical, by its functions: most contacts of this kind have none to work out.
#[derive(Debug, Clone, Copy)]
struct Lean {
    sin: f64,
    cos: f64,
    tan: f64,
}

impl Lean {
    const NONE: Self = Self { sin: 0.0, cos: 1.0, tan: 0.0 };

    fn of(angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { sin, cos, tan: sin / cos }
    }
}

impl Axle<'_> {
    /// One wheel: place it on its rail, look its contacts up, give each its normal force and ask for its creep force. Gives
    /// back the pose with which the wheel left the table.
    #[inline(always)]
    fn wheel(&self, sigma: f64, wheel: &mut Wheel, cases: &mut Vec<CreepCase>) -> Result<(), WheelPose> {
        let (half, radius) = (self.set.tape_half_distance, self.set.radius);
        match &self.model.contact {
            Contact::Profiles { table, shear_modulus, dissipation, friction, .. } => {
                let rail_y = table.rail_origin_y();
                let rail = rail_pose(sigma, rail_y, &self.deviation, &self.track, self.k.s_dot);
                let pose = wheel_pose(sigma, self.q, self.k, half, radius, half - rail_y, &rail);
                wheel.lift(pose.shift);
                let mut found = [ContactPoint::default(); MAX_CONTACTS];
                let count = table
                    .contacts(pose.shift, pose.roll, pose.depth, pose.yaw, &mut found)
                    .map_err(|_| pose)?;
                for point in &found[..count] {
                    let contact = wheel.add();
                    let (q, k) = (self.q, self.k);
                    let placed = place(sigma, point, &rail, radius, q, k, &self.w_T, &self.track, self.speed);
                    let n =
                        hunt_crossley(point.hertz, placed.penetration, placed.approach_rate, *dissipation);
                    contact.geometry = Some(*point);
                    contact.normal = point.share * n.force;
                    contact.normal_slope = [point.share * n.stiffness, point.share * n.damping];
                    contact.creep = [0.0; 2];
                    let mu = friction.at(usize::from(sigma > 0.0), q[0], placed.slip);
                    contact.creeps = self.creeping && contact.normal > 0.0 && mu > 0.0;
                    if contact.creeps {
                        cases.push(CreepCase {
                            patch: patch(point, contact.normal, *shear_modulus),
                            creepage: placed.creepage,
                            mu,
                        });
                    }
                    contact.placed = placed;
                }
            }
            Contact::Textbook(book) => {
                let rail = rail_pose(sigma, half, &self.deviation, &self.track, self.k.s_dot);
                let pose = wheel_pose(sigma, self.q, self.k, half, radius, 0.0, &rail);
                wheel.lift(pose.shift);
                let lean = if book.gravity_stiffness {
                    Lean::of(book.conicity.atan() - sigma * self.q[3])
                } else {
                    Lean::NONE
                };
                let depth = pose.depth + lean.tan * pose.shift;
                if depth > 0.0 {
                    *wheel.add() = self.textbook(book, sigma, pose.shift, depth, lean, rail.surface_velocity);
                }
            }
        }
        Ok(())
    }

    /// `lean` is the normal's inward, `surface` the velocity of the running surface, side coordinates.
    #[inline(always)]
    fn textbook(
        &self,
        book: &Textbook,
        sigma: f64,
        shift: f64,
        depth: f64,
        lean: Lean,
        surface: [f64; 2],
    ) -> ContactForce {
        let half = sigma * self.set.tape_half_distance;
        // In axle axes the contact is below the tape circle, at the rolling radius there.
        let lever = self.k.R_TB * Vec3::new(0.0, half, self.set.radius + book.conicity * shift);
        let rail = Vec3::new(0.0, self.track.vy, self.track.vz + half * self.track.vphi);
        let v_wheel = self.k.v_T + self.w_T.cross(&lever);
        let slip = v_wheel - rail;
        let rate = v_wheel.z - surface[1] + lean.tan * (sigma * v_wheel.y - surface[0]);
        let creepage = Creepage {
            xi: slip.x / self.speed,
            eta: sigma * slip.y / self.speed,
            phi: sigma * self.w_T.z / self.speed,
        };
        let normal = (book.stiffness * depth + book.damping * rate).max(0.0);
        ContactForce {
            geometry: None,
            placed: PlacedContact {
                lever,
                point: [half + self.track.y, self.track.z],
                e_t: Vec3::new(0.0, sigma, 0.0),
                e_n: Vec3::new(0.0, -sigma * lean.sin, -lean.cos),
                penetration: depth,
                approach_rate: rate,
                slip: [slip.x, sigma * slip.y],
                creepage,
            },
            normal,
            normal_slope: [book.stiffness, book.damping],
            creep: [-book.f11 * creepage.xi, -book.f22 * creepage.eta - book.f23 * creepage.phi],
            creeps: false,
        }
    }
}

/// The patch of a contact of the geometry table under load.
#[inline(always)]
pub(crate) fn patch(point: &ContactPoint, normal: f64, shear_modulus: f64) -> Patch {
    let root = cube_root(normal);
    Patch {
        a: point.a1 * root,
        b: point.b1 * root,
        n: normal,
        c11: point.c11,
        c22: point.c22,
        c23: point.c23,
        shear_modulus,
    }
}

/// Force of one contact on the wheel, track axes, N.
#[inline(always)]
pub(crate) fn total_force(c: &ContactForce) -> Vec3 {
    c.normal * c.placed.e_n + c.creep[1] * c.placed.e_t + Vec3::new(c.creep[0], 0.0, 0.0)
}

impl System for VehicleSystem<'_> {
    fn size(&self) -> usize {
        self.map.size() + self.acting.as_ref().map_or(0, |acting| acting.states())
    }

    fn rhs(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        self.stages_best(t, x, dx);
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

impl VehicleSystem<'_> {
    #[cfg(target_arch = "x86_64")]
    #[allow(unsafe_code)] // the one way to call code for instructions that not every processor has
    fn stages_best(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has just said that it has AVX2.
            unsafe { self.stages_avx2(t, x, dx) }
        } else {
            self.stages(t, x, dx);
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn stages_best(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        self.stages(t, x, dx);
    }

    /// The same stages in wider registers. Nothing fuses a multiplication with an addition: the same bytes.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn stages_avx2(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        self.stages(t, x, dx);
    }

    /// The right-hand side ([`System::rhs`]) with the instructions that every processor has.
    // Stages and what they call are `inline(always)`, so that they are compiled again for wider ones.
    #[inline(always)]
    pub fn stages(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
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
