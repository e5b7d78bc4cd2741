//! The compiled model: immutable, shared between threads.

use crate::body::{RigidBody, Wheelset};
use crate::connection::{Law, Mount};
use crate::contact::creep::CreepLaw;
use crate::contact::friction::FrictionField;
use crate::contact::geometry_table::GeometryTable;
use crate::contact::textbook::Textbook;
use crate::dynamics::state::StateMap;
use crate::error::Result;
use crate::integrator::StiffBlock;
use crate::math::Vec3;
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
    /// Points and preload.
    pub mount: Mount,
    /// Force law.
    pub law: Law,
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
        table: Box<GeometryTable>,
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
    pub(crate) stiff_blocks: Vec<StiffBlock>,
}

impl Model {
    /// Puts the parts together.
    ///
    /// # Errors
    /// None yet beyond those of the parts; kept fallible for checks across parts.
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
    ) -> Result<Self> {
        links.sort_by_key(|l| (l.a, l.b));
        let map = StateMap { bodies: bodies.len(), wheelsets: wheelsets.len() };
        let stiff_blocks = (0..wheelsets.len())
            .map(|w| {
                let start = map.start(map.bodies + w);
                StiffBlock { pos: start..start + 9, vel: start + 9..start + 18 }
            })
            .collect();
        Ok(Self {
            bodies,
            wheelsets,
            links,
            sensors,
            speed_hold,
            layout,
            deviation,
            support,
            contact,
            gravity,
            stiff_blocks,
        })
    }

    /// Layout of the state.
    #[must_use]
    pub fn map(&self) -> StateMap {
        StateMap { bodies: self.bodies.len(), wheelsets: self.wheelsets.len() }
    }

    /// Body or wheelset `i` as a rigid body.
    #[must_use]
    pub fn rigid(&self, i: usize) -> &RigidBody {
        if i < self.bodies.len() { &self.bodies[i] } else { &self.wheelsets[i - self.bodies.len()].body }
    }

    /// Number of bodies and wheelsets.
    #[must_use]
    pub fn count(&self) -> usize {
        self.bodies.len() + self.wheelsets.len()
    }

    /// Mass of everything, kg.
    #[must_use]
    pub fn mass(&self) -> f64 {
        (0..self.count()).map(|i| self.rigid(i).mass).sum()
    }

    /// The body whose place is called the vehicle's: the one that the speed is held on, else the first.
    #[must_use]
    pub fn reference(&self) -> usize {
        self.speed_hold.map_or(0, |h| h.body)
    }
}
