//! The compiled model: immutable, shared between threads.

use std::ops::Range;
use std::sync::Arc;

use crate::body::{RigidBody, Wheelset};
use crate::connection::{ForceLaw, Law, Mount, Relative, Wrench};
use crate::contact::creep::CreepLaw;
use crate::contact::friction::FrictionField;
use crate::contact::geometry_table::GeometryTable;
use crate::contact::textbook::Textbook;
use crate::dynamics::state::StateMap;
use crate::equipment::Equipment;
use crate::equipment::coupled::Angled;
use crate::integrator::StiffBlock;
use crate::math::{Mat3, Vec3};
use crate::track::DeviationField;
use crate::track::Layout;

/// A connection between two bodies, by index (bodies, then wheelsets).
#[derive(Debug, Clone)]
pub struct Link {
    /// Name, e.g. `ws1.primary_left`.
    pub name: String,
    /// Body A.
    pub a: usize,
    /// Body B.
    pub b: usize,
    /// Points and preload, in the connection's own axes.
    pub mount: Mount,
    /// Force law.
    pub law: Law,
    /// The connection's own axes to the bodies' in the design position, where they differ.
    pub axes: Option<Box<Mat3>>,
    /// Where in the state stands what the law remembers; set by [`Model::new`].
    pub memory: Range<usize>,
}

impl Link {
    /// Whether it is between these two, either way.
    #[must_use]
    pub fn joins(&self, one: usize, other: usize) -> bool {
        (self.a, self.b) == (one, other) || (self.b, self.a) == (one, other)
    }

    /// The motion as the connection's own axes see it.
    #[inline]
    fn seen(motion: &Relative, R: &Mat3) -> Relative {
        Relative {
            r_AB: R.tr_mul(&motion.r_AB),
            R_AB: R.tr_mul(&(motion.R_AB * R)),
            v_AB: R.tr_mul(&motion.v_AB),
            w_AB: R.tr_mul(&motion.w_AB),
        }
    }

    /// Wrench on B about A's centre of mass in A's axes, at the state `x`.
    #[inline]
    #[must_use]
    pub fn wrench(&self, motion: &Relative, x: &[f64]) -> Wrench {
        let memory = &x[self.memory.clone()];
        match &self.axes {
            None => self.law.wrench(motion, &self.mount, memory),
            Some(R) => {
                let own = self.law.wrench(&Self::seen(motion, R), &self.mount, memory);
                Wrench { f: **R * own.f, m: **R * own.m }
            }
        }
    }

    /// Rates of what the law remembers, written into `dx`.
    #[inline]
    pub fn memory_rates(&self, motion: &Relative, x: &[f64], dx: &mut [f64]) {
        let (memory, rates) = (&x[self.memory.clone()], &mut dx[self.memory.clone()]);
        match &self.axes {
            None => self.law.memory_rates(motion, &self.mount, memory, rates),
            Some(R) => self.law.memory_rates(&Self::seen(motion, R), &self.mount, memory, rates),
        }
    }

    /// Stored energy, J, and dissipated power, W, at the state `x`.
    #[must_use]
    pub fn energy(&self, motion: &Relative, x: &[f64]) -> (f64, f64) {
        let memory = &x[self.memory.clone()];
        let own = self.axes.as_ref().map_or(*motion, |R| Self::seen(motion, R));
        (self.law.energy(&own, &self.mount, memory), self.law.dissipation(&own, &self.mount, memory))
    }

    /// Translational stiffness in the design position, bodies' axes, N/m.
    #[must_use]
    pub fn nominal_stiffness(&self) -> Mat3 {
        let k = self.law.nominal_stiffness(&self.mount.between);
        self.axes.as_ref().map_or(k, |R| **R * k * R.transpose())
    }

    /// Sets what the connection carries in the design position; `force` on B in the bodies' axes.
    ///
    /// # Errors
    /// What the law cannot carry, in words.
    pub fn settle(&mut self, force: Option<&Vec3>) -> std::result::Result<(), String> {
        let own = force.map(|f| self.axes.as_ref().map_or(*f, |R| R.tr_mul(f)));
        self.law.settle(&mut self.mount, own.as_ref())
    }

    /// Levers of the two ends, bodies' axes, m.
    #[must_use]
    pub fn levers(&self) -> [Vec3; 2] {
        [self.mount.p_A, self.mount.p_B].map(|p| self.axes.as_ref().map_or(p, |R| **R * p))
    }
}

/// A named point on a body.
#[derive(Debug, Clone)]
pub struct Sensor {
    /// Name with its body's, e.g. `carbody.lead_pivot`.
    pub name: String,
    /// Body index.
    pub body: usize,
    /// Point from the centre of mass, body axes, m.
    pub p_B: Vec3,
}

/// Two points that face each other on two bodies.
#[derive(Debug, Clone)]
pub struct Gap {
    /// Name.
    pub name: String,
    /// Body indices.
    pub bodies: [usize; 2],
    /// A point on each, from the centre of mass, its own axes, m.
    pub points: [Vec3; 2],
    /// From the first point to the second in the vehicle as drawn, axes of the first body, unit vector.
    pub direction: Vec3,
}

/// Spring and damper along the track between a body and a frame that moves at the speed asked for.
#[derive(Debug, Clone, Copy)]
pub struct SpeedHold {
    /// Body index.
    pub body: usize,
    /// N/m.
    pub stiffness: f64,
    /// N s/m.
    pub damping: f64,
}

/// Track under a wheelset: one mass with three degrees of freedom on springs and dampers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// kg.
    pub mass: f64,
    /// Roll inertia, kg m2.
    pub inertia: f64,
    /// Lateral, vertical (both rails), roll stiffness: N/m, N/m, N m/rad.
    pub stiffness: [f64; 3],
    /// Damping in the same order.
    pub damping: [f64; 3],
}

/// Wheel/rail contact of all wheels.
#[derive(Debug)]
pub enum Contact {
    /// Profiles, Hertz, creep-force law.
    Profiles {
        /// Geometry of wheel on rail, side coordinates.
        table: Arc<GeometryTable>,
        /// Creep-force law.
        law: CreepLaw,
        /// Combined shear modulus, Pa.
        shear_modulus: f64,
        /// Hunt-Crossley dissipation factor, s/m.
        dissipation: f64,
        /// Coefficient of friction.
        friction: FrictionField,
    },
    /// Constant coefficients, for closed forms.
    Textbook(Textbook),
}

/// Everything that a run needs and does not change.
#[derive(Debug)]
pub struct Model {
    /// Car bodies, bogie frames.
    pub bodies: Vec<RigidBody>,
    /// Wheelsets.
    pub wheelsets: Vec<Wheelset>,
    /// Connections, those between the same two bodies together.
    pub links: Vec<Link>,
    /// Named points.
    pub sensors: Vec<Sensor>,
    /// Distances that are recorded.
    pub gaps: Vec<Gap>,
    /// Speed hold, if any.
    pub speed_hold: Option<SpeedHold>,
    /// Design track.
    pub layout: Layout,
    /// Irregularities.
    pub deviation: DeviationField,
    /// Lumped track under each wheelset; `None` is a rigid track.
    pub support: Option<Support>,
    /// Contact.
    pub contact: Contact,
    /// m/s2.
    pub gravity: f64,
    /// Bodies that move along the design track at the speed asked for, whatever acts on them.
    pub guided: Vec<usize>,
    /// Traction, brakes and train of a run that has any.
    pub equipment: Option<Box<Equipment>>,
    /// Couplers at an angle, where the run has any.
    pub angled: Option<Angled>,
    pub(crate) stiff_blocks: Vec<StiffBlock>,
    memory: usize,
}

impl Model {
    /// Puts the parts together.
    #[must_use]
    #[allow(clippy::too_many_arguments)] // the one place where all parts meet
    pub fn new(
        bodies: Vec<RigidBody>,
        wheelsets: Vec<Wheelset>,
        mut links: Vec<Link>,
        sensors: Vec<Sensor>,
        speed_hold: Option<SpeedHold>,
        layout: Layout,
        deviation: DeviationField,
        support: Option<Support>,
        contact: Contact,
        gravity: f64,
    ) -> Self {
        links.sort_by_key(|l| (l.a, l.b));
        let mut map = StateMap { bodies: bodies.len(), wheelsets: wheelsets.len(), memory: 0 };
        let first = map.size();
        for link in &mut links {
            let start = first + map.memory;
            map.memory += link.law.memory();
            link.memory = start..first + map.memory;
        }
        let stiff_blocks = (0..wheelsets.len())
            .map(|w| {
                let start = map.start(map.bodies + w);
                StiffBlock { pos: start..start + 9, vel: start + 9..start + 18 }
            })
            .collect();
        Self {
            bodies,
            wheelsets,
            links,
            sensors,
            gaps: Vec::new(),
            speed_hold,
            layout,
            deviation,
            support,
            contact,
            gravity,
            guided: Vec::new(),
            equipment: None,
            angled: None,
            stiff_blocks,
            memory: map.memory,
        }
    }

    /// Layout of the state.
    #[must_use]
    pub fn map(&self) -> StateMap {
        StateMap { bodies: self.bodies.len(), wheelsets: self.wheelsets.len(), memory: self.memory }
    }

    /// Body or wheelset `i` as a rigid body.
    #[must_use]
    pub fn rigid(&self, i: usize) -> &RigidBody {
        if i < self.bodies.len() { &self.bodies[i] } else { &self.wheelsets[i - self.bodies.len()].body }
    }

    /// The heaviest of the bodies that are no wheelsets.
    #[must_use]
    pub fn car_body(&self) -> Option<usize> {
        (0..self.bodies.len()).max_by(|a, b| self.bodies[*a].mass.total_cmp(&self.bodies[*b].mass))
    }

    /// Whether a connection ties body `i` to a wheelset.
    #[must_use]
    pub fn carried_by_axles(&self, i: usize) -> bool {
        let is_axle = |at: usize| at >= self.bodies.len();
        self.links.iter().any(|l| (l.a == i && is_axle(l.b)) || (l.b == i && is_axle(l.a)))
    }

    /// Number of bodies and wheelsets.
    #[must_use]
    pub fn count(&self) -> usize {
        self.bodies.len() + self.wheelsets.len()
    }

    /// Mass of everything but guided bodies, kg: what the wheels carry.
    #[must_use]
    pub fn mass(&self) -> f64 {
        (0..self.count()).filter(|i| !self.guided.contains(i)).map(|i| self.rigid(i).mass).sum()
    }

    /// Whether nothing fixes the vehicle's place along the track: neither a speed hold nor a guided body.
    #[must_use]
    pub fn place_is_free(&self) -> bool {
        self.speed_hold.is_none() && self.guided.is_empty() && self.count() > 0
    }

    /// The body whose place is called the vehicle's: the one that the speed is held on, else the first.
    #[must_use]
    pub fn reference(&self) -> usize {
        self.speed_hold.map_or(0, |h| h.body)
    }

    /// Place of the vehicle's centre along the track in state `x`, m: where the reference body would be if it stood there.
    #[must_use]
    pub fn place(&self, x: &[f64]) -> f64 {
        x[self.map().q(self.reference()).start] - self.rigid(self.reference()).position.x
    }
}
