//! Connections: force elements between two body-fixed points.
//!
//! A law gives equal and opposite wrenches on its two ends, the energy that it stores and the power that it
//! dissipates; an energy audit of a whole run then finds most sign errors. The family is closed: one arm of
//! [`Law`] and one file for each kind.

mod bushing;
pub mod lanes;
mod point_damper;
mod point_spring;

pub use bushing::Bushing;
pub use point_damper::PointDamper;
pub use point_spring::PointSpring;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use crate::body::{Pose, Relative, Wrench};
use crate::error::{Fault, KeyPath};
use crate::math::{Mat3, Vec3};

/// Where a connection is fixed, and what it carries in the design position.
#[derive(Debug, Clone, Copy)]
pub struct Mount {
    /// Point on body A from its centre of mass, in A's axes, m.
    pub p_A: Vec3,
    /// Point on body B from its centre of mass, in B's axes, m.
    pub p_B: Vec3,
    /// Force on B in the design position, N (on A the opposite), in the bodies' axes.
    pub preload: Vec3,
}

/// What a law does to its two ends, inertial axes.
#[derive(Debug, Clone, Copy)]
pub struct Pair {
    /// On body A.
    pub on_A: Wrench,
    /// On body B.
    pub on_B: Wrench,
}

impl Pair {
    /// From the wrench on B about A's centre of mass in A's axes, as [`ForceLaw::wrench`] gives it.
    #[inline(always)]
    #[must_use]
    pub fn new(on_B_about_A: &Wrench, motion: &Relative, R_IA: &Mat3) -> Self {
        let f = R_IA * on_B_about_A.f;
        let m = on_B_about_A.m;
        Self {
            on_A: Wrench { f: -f, m: -(R_IA * m) },
            on_B: Wrench { f, m: R_IA * (m - motion.r_AB.cross(&on_B_about_A.f)) },
        }
    }
}

/// The contract of a force law. It knows the motion of body B as seen from body A, in A's axes, and nothing else: so it
/// cannot depend on where the two are, and gives equal and opposite forces with balanced moments by construction.
pub trait ForceLaw {
    /// Force on B (N) and its moment about A's centre of mass (N m), in A's axes; on A the opposite.
    fn wrench(&self, motion: &Relative, mount: &Mount) -> Wrench;
    /// Stored energy, J, zero in the design position; the preload's work is part of it.
    fn energy(&self, motion: &Relative, mount: &Mount) -> f64;
    /// Dissipated power, W, never negative.
    fn dissipation(&self, motion: &Relative, mount: &Mount) -> f64;
    /// Translational stiffness in the design position along the bodies' axes, N/m, with which preloads are shared out.
    fn nominal_stiffness(&self, between: &Vec3) -> Vec3;
    /// Parameters outside their range, by key below `at`.
    fn faults(&self, at: &KeyPath) -> Vec<Fault>;
}

/// Every kind of connection, as written: the table's `kind` names the arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Law {
    /// Three translational (and three rotational) spring-dampers.
    Bushing(Bushing),
    /// Viscous damper along the line between its ends.
    PointDamper(PointDamper),
    /// Spring along the line between its ends.
    PointSpring(PointSpring),
}

/// The kinds that [`Law`] knows, sorted.
pub const KINDS: [&str; 3] = ["bushing", "point_damper", "point_spring"];

macro_rules! each {
    ($self:ident, $law:ident => $call:expr) => {
        match $self {
            Law::Bushing($law) => $call,
            Law::PointDamper($law) => $call,
            Law::PointSpring($law) => $call,
        }
    };
}

impl ForceLaw for Law {
    #[inline(always)]
    fn wrench(&self, motion: &Relative, mount: &Mount) -> Wrench {
        each!(self, law => law.wrench(motion, mount))
    }

    fn energy(&self, motion: &Relative, mount: &Mount) -> f64 {
        each!(self, law => law.energy(motion, mount))
    }

    fn dissipation(&self, motion: &Relative, mount: &Mount) -> f64 {
        each!(self, law => law.dissipation(motion, mount))
    }

    fn nominal_stiffness(&self, between: &Vec3) -> Vec3 {
        each!(self, law => law.nominal_stiffness(between))
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        each!(self, law => law.faults(at))
    }
}

impl Law {
    /// One or more examples of every arm, for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let mut all: Vec<Self> = Bushing::examples().into_iter().map(Self::Bushing).collect();
        all.extend(PointDamper::examples().into_iter().map(Self::PointDamper));
        all.extend(PointSpring::examples().into_iter().map(Self::PointSpring));
        all
    }
}

/// A fault for each value that is negative or not finite.
fn not_negative(values: &[f64], at: &KeyPath, unit: &str) -> Vec<Fault> {
    values
        .iter()
        .enumerate()
        .filter(|(_, v)| !(v.is_finite() && **v >= 0.0))
        .map(|(i, v)| {
            let key = if values.len() == 1 { at.clone() } else { at.index(i) };
            Fault::new(key, format!("{v}"), format!("a finite number >= 0 {unit}"))
        })
        .collect()
}
