//! Creep forces: from patch, creepage and friction to tangential force.
//!
//! Contact axes: x in the rolling direction, y lateral in the contact plane, right-handed with the normal. Creepage is the
//! velocity of the wheel's surface relative to the rail's over the rolling speed; forces act on the wheel and oppose the slip
//! field (xi - phi y, eta + phi x). At small creepage every law is Kalker's linear one times its own reduction factor:
//!
//! Fx = -G c^2 C11 xi, Fy = -G c^2 (C22 eta + c C23 phi), c = sqrt(a b).

mod fastsim;
mod kalker_linear;
mod polach;

pub use fastsim::Fastsim;
pub use kalker_linear::KalkerLinear;
pub use polach::Polach;

use crate::error::{Fault, KeyPath};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An elliptical contact patch under load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Semi-axis along rolling, m.
    pub a: f64,
    /// Semi-axis across, m.
    pub b: f64,
    /// Normal force, N.
    pub n: f64,
    /// Kalker's C11.
    pub c11: f64,
    /// Kalker's C22.
    pub c22: f64,
    /// Kalker's C23.
    pub c23: f64,
    /// Shear modulus G, Pa.
    pub shear_modulus: f64,
}

/// Creepage in contact axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Creepage {
    /// Longitudinal, 1.
    pub xi: f64,
    /// Lateral, 1.
    pub eta: f64,
    /// Spin, 1/m.
    pub phi: f64,
}

/// Tangential force on the wheel in contact axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CreepForce {
    /// Longitudinal, N.
    pub fx: f64,
    /// Lateral, N.
    pub fy: f64,
}

/// What a law is asked: one patch, its creepage and its coefficient of friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CreepCase {
    /// The patch under load.
    pub patch: Patch,
    /// Its creepage.
    pub creepage: Creepage,
    /// Coefficient of friction.
    pub mu: f64,
}

impl CreepCase {
    /// Load and extent, without which there is no force.
    fn carries(&self) -> bool {
        self.patch.n > 0.0 && self.patch.a > 0.0 && self.patch.b > 0.0
    }
}

/// A creep-force law, as written in a case: `creep = { kind = "fastsim", nx = 10, ny = 10 }`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum CreepLaw {
    /// Kalker's simplified theory.
    Fastsim(Fastsim),
    /// Kalker's linear theory, unlimited.
    KalkerLinear(KalkerLinear),
    /// Polach's formula with reduction factors.
    Polach(Polach),
}

impl Default for CreepLaw {
    fn default() -> Self {
        Self::Fastsim(Fastsim::default())
    }
}

impl CreepLaw {
    /// Force on the wheel for one patch, creepage and coefficient of friction.
    ///
    /// No load or no extent (n, a or b not positive) gives no force. Does not allocate.
    #[must_use]
    pub fn force(&self, patch: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
        let mut force = [CreepForce::default()];
        self.forces(&[CreepCase { patch: *patch, creepage: *creepage, mu }], &mut force);
        force[0]
    }

    /// Forces of several patches, the same to the bit as one by one: `forces[i]` for `cases[i]`. Does not allocate.
    ///
    /// # Panics
    /// Where the two differ in length.
    pub fn forces(&self, cases: &[CreepCase], forces: &mut [CreepForce]) {
        assert_eq!(cases.len(), forces.len(), "one force per case");
        match self {
            Self::Fastsim(law) => law.forces(cases, forces),
            Self::KalkerLinear(law) => each(cases, forces, |c| law.force(&c.patch, &c.creepage)),
            Self::Polach(law) => each(cases, forces, |c| law.force(&c.patch, &c.creepage, c.mu)),
        }
        for (force, _) in forces.iter_mut().zip(cases).filter(|(_, case)| !case.carries()) {
            *force = CreepForce::default();
        }
    }

    /// Slope at zero creepage as a fraction of Kalker's.
    #[must_use]
    pub fn reduction(&self) -> f64 {
        match self {
            Self::Fastsim(_) | Self::KalkerLinear(_) => 1.0,
            Self::Polach(law) => law.reduction(),
        }
    }

    /// Whether the force is limited by friction.
    #[must_use]
    pub fn saturates(&self) -> bool {
        !matches!(self, Self::KalkerLinear(_))
    }

    /// Faults in the parameters, by key below `at`.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        match self {
            Self::Fastsim(law) => law.faults(at),
            Self::KalkerLinear(_) => Vec::new(),
            Self::Polach(law) => law.faults(at),
        }
    }

    /// Laws for the contract suite: some of every arm.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let fastsim = Fastsim::examples().into_iter().map(Self::Fastsim);
        let linear = KalkerLinear::examples().into_iter().map(Self::KalkerLinear);
        let polach = Polach::examples().into_iter().map(Self::Polach);
        fastsim.chain(linear).chain(polach).collect()
    }
}

#[inline]
fn each(cases: &[CreepCase], forces: &mut [CreepForce], law: impl Fn(&CreepCase) -> CreepForce) {
    for (force, case) in forces.iter_mut().zip(cases) {
        *force = law(case);
    }
}
