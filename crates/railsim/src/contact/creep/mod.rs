//! Creep forces: from patch, creepage and friction to tangential force.
//!
//! Contact axes: x in the rolling direction, y lateral in the contact plane, right-handed with the normal. Creepage is the
//! velocity of the wheel's surface relative to the rail's over the rolling speed; forces act on the wheel and oppose the slip
//! field (xi - phi y, eta + phi x). At small creepage every law is Kalker's linear one times its own reduction factor:
//!
//! Fx = -G c^2 C11 xi, Fy = -G c^2 (C22 eta + c C23 phi), c = sqrt(a b).
//!
//! No law has friction that depends on the slip velocity in it: `mu` is the coefficient that holds at this contact now, from
//! [`crate::contact::friction`], so that falling friction goes with every law and is never applied twice.
//!
//! The spin moment about the normal, Mz = -G c^3 (-C23 eta + c C33 phi) at small creepage, is a question of its own
//! ([`CreepLaw::spin_moment`]) and not a part of the right-hand side: on a wheel it is some mu N c, 100 N m against the 100 kN m of the creep
//! forces on their lever of half a gauge, and no law gives it at the price of the force.

mod fastrip;
mod fastsim;
mod kalker_linear;
mod modified_fastsim;
mod polach;
mod shen_hedrick_elkins;
mod strip;
mod vermeulen_johnson;

pub use fastrip::Fastrip;
pub use fastsim::Fastsim;
pub use kalker_linear::KalkerLinear;
pub use modified_fastsim::ModifiedFastsim;
pub use polach::Polach;
pub use shen_hedrick_elkins::ShenHedrickElkins;
pub use vermeulen_johnson::VermeulenJohnson;

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

/// Poisson's ratio of steel where nothing else is said.
pub const DEFAULT_POISSON: f64 = 0.28;

fn poisson_faults(poisson: Option<f64>, at: &KeyPath) -> Vec<Fault> {
    poisson
        .filter(|nu| !(0.0..=0.5).contains(nu))
        .map(|nu| Fault::new(at.key("poisson"), nu.to_string(), "0 to 0.5"))
        .into_iter()
        .collect()
}

/// What is wrong with the numbers of one contact, by name below `at`: for the edge of the program, where they come from outside.
#[must_use]
pub fn faults(p: &Patch, c: &Creepage, mu: f64, at: &KeyPath) -> Vec<Fault> {
    let positive: fn(f64) -> bool = |x| x > 0.0;
    let not_negative: fn(f64) -> bool = |x| x >= 0.0;
    let any: fn(f64) -> bool = |_| true;
    [
        ("a", p.a, positive, "a length > 0, m"),
        ("b", p.b, positive, "a length > 0, m"),
        ("n", p.n, not_negative, "a normal force >= 0, N"),
        ("c11", p.c11, positive, "a number > 0"),
        ("c22", p.c22, positive, "a number > 0"),
        ("c23", p.c23, not_negative, "a number >= 0"),
        ("shear_modulus", p.shear_modulus, positive, "a modulus > 0, Pa"),
        ("xi", c.xi, any, "a finite number"),
        ("eta", c.eta, any, "a finite number"),
        ("phi", c.phi, any, "a finite number, 1/m"),
        ("mu", mu, not_negative, "a coefficient of friction >= 0"),
    ]
    .into_iter()
    .filter(|(_, value, good, _)| !(value.is_finite() && good(*value)))
    .map(|(key, value, _, allowed)| Fault::new(at.key(key), value.to_string(), allowed))
    .collect()
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

/// A creep-force law, as written in a case: `creep = { kind = "fastsim", nx = 10, ny = 10 }`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum CreepLaw {
    /// FaStrip: strip theory and FASTSIM.
    Fastrip(Fastrip),
    /// Kalker's simplified theory.
    Fastsim(Fastsim),
    /// Kalker's linear theory, unlimited.
    KalkerLinear(KalkerLinear),
    /// FASTSIM with a slope that falls with creepage.
    ModifiedFastsim(ModifiedFastsim),
    /// Polach's formula with reduction factors.
    Polach(Polach),
    /// Shen, Hedrick and Elkins: the linear theory saturated.
    ShenHedrickElkins(ShenHedrickElkins),
    /// Vermeulen and Johnson's theory, without spin.
    VermeulenJohnson(VermeulenJohnson),
}

impl Default for CreepLaw {
    fn default() -> Self {
        Self::Fastsim(Fastsim::default())
    }
}

impl CreepLaw {
    /// Force on the wheel for one patch, creepage and coefficient of friction.
    ///
    /// No load, no extent or no friction (n, a, b or mu not positive) gives no force. Any finite input gives a finite force: where the arithmetic of a law
    /// overflows (creepages beyond some 1e100), the patch slides as a whole. Does not allocate.
    #[must_use]
    pub fn force(&self, patch: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
        let force = match self {
            Self::Fastrip(law) => law.force(patch, creepage, mu),
            Self::Fastsim(law) => law.force(patch, creepage, mu),
            Self::KalkerLinear(law) => law.force(patch, creepage),
            Self::ModifiedFastsim(law) => law.force(patch, creepage, mu),
            Self::Polach(law) => law.force(patch, creepage, mu),
            Self::ShenHedrickElkins(law) => law.force(patch, creepage, mu),
            Self::VermeulenJohnson(law) => law.force(patch, creepage, mu),
        };
        finite(force, patch, creepage, mu)
    }

    /// Forces of several patches, the same to the bit as one by one: `forces[i]` for `cases[i]`. Does not allocate.
    ///
    /// # Panics
    /// Where the two differ in length.
    pub fn forces(&self, cases: &[CreepCase], forces: &mut [CreepForce]) {
        assert_eq!(cases.len(), forces.len(), "one force per case");
        match self {
            Self::Fastrip(law) => each(cases, forces, |c| law.force(&c.patch, &c.creepage, c.mu)),
            Self::Fastsim(law) => law.forces(cases, forces),
            Self::KalkerLinear(law) => each(cases, forces, |c| law.force(&c.patch, &c.creepage)),
            Self::ModifiedFastsim(law) => law.forces(cases, forces),
            Self::Polach(law) => law.forces(cases, forces),
            Self::ShenHedrickElkins(law) => each(cases, forces, |c| law.force(&c.patch, &c.creepage, c.mu)),
            Self::VermeulenJohnson(law) => each(cases, forces, |c| law.force(&c.patch, &c.creepage, c.mu)),
        }
        for (force, c) in forces.iter_mut().zip(cases) {
            *force = finite(*force, &c.patch, &c.creepage, c.mu);
        }
    }

    /// Spin moment about the normal on the wheel, N m, of the laws that give one; `c33` is Kalker's.
    ///
    /// Same sign and lever as the forces: positive spin alone gives a negative moment. FASTSIM's is the moment of its stresses, which has
    /// no slope in common with C33 (the method's error, stated in the documentation). Dear: not for the right-hand side.
    #[must_use]
    pub fn spin_moment(&self, patch: &Patch, c33: f64, creepage: &Creepage, mu: f64) -> Option<f64> {
        let moment = match self {
            Self::Polach(_) | Self::ShenHedrickElkins(_) | Self::VermeulenJohnson(_) => return None,
            _ if !carries(patch, mu) => 0.0,
            Self::Fastrip(law) => law.spin_moment(patch, creepage, mu),
            Self::Fastsim(law) => strip::moment(law.nx, law.ny, patch, creepage, mu),
            Self::KalkerLinear(law) => law.spin_moment(patch, c33, creepage),
            Self::ModifiedFastsim(law) => law.spin_moment(patch, creepage, mu),
        };
        Some(if moment.is_finite() { moment } else { 0.0 })
    }

    /// The law with Poisson's ratio filled in where it needs one and none is written.
    #[must_use]
    pub fn with_poisson(self, nu: f64) -> Self {
        match self {
            Self::Fastrip(law) => Self::Fastrip(Fastrip { poisson: law.poisson.or(Some(nu)), ..law }),
            Self::VermeulenJohnson(law) => {
                Self::VermeulenJohnson(VermeulenJohnson { poisson: law.poisson.or(Some(nu)) })
            }
            other => other,
        }
    }

    /// Slopes at zero creepage, longitudinal and lateral, as fractions of Kalker's.
    #[must_use]
    pub fn slopes(&self, patch: &Patch) -> [f64; 2] {
        match self {
            Self::Fastrip(_) | Self::Fastsim(_) | Self::KalkerLinear(_) | Self::ShenHedrickElkins(_) => {
                [1.0; 2]
            }
            Self::ModifiedFastsim(law) => [law.k0; 2],
            Self::Polach(law) => [law.reduction(); 2],
            Self::VermeulenJohnson(law) => law.slopes(patch),
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
            Self::Fastrip(law) => law.faults(at),
            Self::Fastsim(law) => law.faults(at),
            Self::KalkerLinear(_) | Self::ShenHedrickElkins(_) => Vec::new(),
            Self::ModifiedFastsim(law) => law.faults(at),
            Self::Polach(law) => law.faults(at),
            Self::VermeulenJohnson(law) => law.faults(at),
        }
    }

    /// Laws for the contract suite: some of every arm.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let mut all = Vec::new();
        all.extend(Fastsim::examples().into_iter().map(Self::Fastsim));
        all.extend(KalkerLinear::examples().into_iter().map(Self::KalkerLinear));
        all.extend(Polach::examples().into_iter().map(Self::Polach));
        all.extend(Fastrip::examples().into_iter().map(Self::Fastrip));
        all.extend(ModifiedFastsim::examples().into_iter().map(Self::ModifiedFastsim));
        all.extend(ShenHedrickElkins::examples().into_iter().map(Self::ShenHedrickElkins));
        all.extend(VermeulenJohnson::examples().into_iter().map(Self::VermeulenJohnson));
        all
    }
}

/// Load, extent and friction, without which there is no force.
#[inline(always)]
fn carries(patch: &Patch, mu: f64) -> bool {
    patch.n > 0.0 && patch.a > 0.0 && patch.b > 0.0 && mu > 0.0
}

/// What a law gave, where it may give a force and that is a number.
#[inline(always)]
fn finite(force: CreepForce, patch: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
    if !carries(patch, mu) {
        CreepForce::default()
    } else if force.fx.is_finite() && force.fy.is_finite() {
        force
    } else {
        sliding(patch, creepage, mu)
    }
}

/// Full sliding against the creepage at the centre of the patch; no force where there is none, or where mu N is not finite.
#[cold]
fn sliding(patch: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
    let limit = mu * patch.n;
    let largest = creepage.xi.abs().max(creepage.eta.abs());
    let (x, y) = (creepage.xi / largest, creepage.eta / largest);
    let scale = -limit / x.hypot(y);
    if scale.is_finite() { CreepForce { fx: scale * x, fy: scale * y } } else { CreepForce::default() }
}

#[inline]
fn each(cases: &[CreepCase], forces: &mut [CreepForce], law: impl Fn(&CreepCase) -> CreepForce) {
    for (force, case) in forces.iter_mut().zip(cases) {
        *force = law(case);
    }
}
