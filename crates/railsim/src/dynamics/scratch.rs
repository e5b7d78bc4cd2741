//! Buffers of the right-hand side, each with its one writer.

use crate::body::{Kinematics, Wrench};
use crate::contact::creep::{CreepCase, CreepForce};
use crate::contact::creepage::PlacedContact;
use crate::contact::geometry_table::{ContactPoint, MAX_CONTACTS};
use crate::dynamics::model::Model;
use crate::math::Vec3;
use crate::math::angle::Turns;
use crate::track::Deviation;

/// One contact with its forces. Written by the contact stage.
#[derive(Debug, Clone, Copy, Default)]
pub struct ContactForce {
    /// Geometry from the table; `None` for textbook contact.
    pub geometry: Option<ContactPoint>,
    /// Where it is and how it slides.
    pub placed: PlacedContact,
    /// Normal force, N.
    pub normal: f64,
    /// dN/d(penetration), N/m, and dN/d(rate), N s/m.
    pub normal_slope: [f64; 2],
    /// Creep force on the wheel, forward and along the outward tangent, N.
    pub creep: [f64; 2],
    /// Whether the creep-force law is asked: a contact under load on a rail with friction, of a vehicle that rolls.
    pub creeps: bool,
}

/// One wheel on its rail. Written by the contact stage.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wheel {
    slots: [ContactForce; MAX_CONTACTS],
    count: usize,
    /// Outward lateral shift of the wheel on its rail, m.
    pub shift: f64,
    /// Vertical wheel force on the rail, N.
    pub Q: f64,
    /// Lateral wheel force on the rail, outward, N.
    pub Y: f64,
}

impl Wheel {
    /// The contacts, from the tread to the flange tip.
    #[must_use]
    pub fn contacts(&self) -> &[ContactForce] {
        &self.slots[..self.count]
    }

    pub(crate) fn contacts_mut(&mut self) -> &mut [ContactForce] {
        &mut self.slots[..self.count]
    }

    /// Off the rail, until contacts are added.
    pub(crate) fn lift(&mut self, shift: f64) {
        self.count = 0;
        self.shift = shift;
        self.Q = 0.0;
        self.Y = 0.0;
    }

    /// The next contact, to be filled in place.
    #[inline]
    pub(crate) fn add(&mut self) -> &mut ContactForce {
        self.count += 1;
        &mut self.slots[self.count - 1]
    }
}

/// A wheel that left its rail's geometry table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeftRail {
    /// Wheelset index.
    pub wheelset: usize,
    /// -1 left, +1 right.
    pub side: f64,
    /// Outward shift on the rail, m.
    pub shift: f64,
    /// Roll against the rail, rad.
    pub roll: f64,
}

/// Buffers. May be thrown away at any step.
#[derive(Debug, Clone)]
pub struct Scratch {
    /// Written by the kinematics stage.
    pub kinematics: Vec<Kinematics>,
    /// Forces and moments by connections and weight on each body, and wheel forces (not their moments); inertial axes.
    pub wrench: Vec<Wrench>,
    /// Moment of wheel forces about each wheelset's centre, axle axes. Written by the contact stage.
    pub wheel_moment: Vec<Vec3>,
    /// Wheel forces on each track mass: y, z, moment about x. Written by the contact stage.
    pub track_load: Vec<[f64; 3]>,
    /// Wheels of each wheelset: left, right. Written by the contact stage.
    pub wheels: Vec<[Wheel; 2]>,
    /// Irregularity under each wheelset. Written by the turn stage.
    pub deviation: Vec<Deviation>,
    /// Roll, pitch and yaw of every body and wheelset. Written by the turn stage.
    pub(crate) turns: Turns,
    /// Roll of the track under every wheelset. Written by the turn stage.
    pub(crate) track_turns: Turns,
    /// Set by the contact stage, cleared by whoever reads it.
    pub left_rail: Option<LeftRail>,
    /// What the creep-force law is asked in one go, and its answers: every contact under load, in the order of the wheels.
    pub(crate) creep_cases: Vec<CreepCase>,
    pub(crate) creep_forces: Vec<CreepForce>,
}

impl Scratch {
    /// Buffers for a model.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let (all, ws) = (model.count(), model.wheelsets.len());
        Self {
            kinematics: vec![Kinematics::zero(); all],
            wrench: vec![Wrench::zero(); all],
            wheel_moment: vec![Vec3::zeros(); ws],
            track_load: vec![[0.0; 3]; ws],
            wheels: vec![[Wheel::default(); 2]; ws],
            deviation: vec![Deviation::default(); ws],
            turns: Turns::new(3 * all),
            track_turns: Turns::new(ws),
            left_rail: None,
            creep_cases: Vec::with_capacity(2 * MAX_CONTACTS * ws),
            creep_forces: vec![CreepForce::default(); 2 * MAX_CONTACTS * ws],
        }
    }
}
