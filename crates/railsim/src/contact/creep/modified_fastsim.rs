//! FASTSIM with a slope that falls with creepage.

use super::{CreepCase, CreepForce, Creepage, Fastsim, Patch, strip};
use crate::error::{Fault, KeyPath};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Modified FASTSIM (M. Spiryagin, O. Polach and C. Cole, Vehicle System Dynamics, 2013): FASTSIM whose flexibilities grow with
/// the creepage, for rails with a third-body layer.
///
/// - L_eff = L/k, k = k0 (alpha + (1 - alpha)/(1 + beta eps)): from k0 of Kalker's slope at zero creepage to k0 alpha of it,
/// - eps = G pi a b k0 c_jj s/(4 mu N), c_jj s = sqrt((C11 xi)^2 + (C22 eta)^2): the gradient of tangential stress as in Polach's formula. Spin
///   does not enter eps; k acts on its flexibility too.
///
/// The friction that falls with the slip velocity is not here: `mu` is what holds at this contact now ([`crate::contact::friction`]), so that
/// it is applied once.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModifiedFastsim {
    /// Slope at zero creepage over Kalker's, k0: greater than 0, at most 1.
    pub k0: f64,
    /// Slope at large creepage over that at zero, alpha: 0 to 1. 1 is plain FASTSIM with its slope times k0.
    pub alpha: f64,
    /// How fast the slope falls, beta: 0 or more.
    pub beta: f64,
    /// Elements along rolling, as in FASTSIM.
    #[serde(default = "ten")]
    pub nx: u16,
    /// Strips across, as in FASTSIM.
    #[serde(default = "ten")]
    pub ny: u16,
}

/// Cases that go into one march: enough to fill its lanes, on the stack.
const TOGETHER: usize = 16;

fn ten() -> u16 {
    10
}

impl ModifiedFastsim {
    /// The patch as the plain march sees it: Kalker's coefficients times k.
    fn softened(&self, p: &Patch, creepage: &Creepage, mu: f64) -> Patch {
        if mu * p.n <= 0.0 {
            return *p;
        }
        let slip = (p.c11 * creepage.xi).hypot(p.c22 * creepage.eta);
        let eps = 0.25 * p.shear_modulus * PI * p.a * p.b * self.k0 * slip / (mu * p.n);
        let k = self.k0 * (self.alpha + (1.0 - self.alpha) / (1.0 + self.beta * eps));
        Patch { c11: k * p.c11, c22: k * p.c22, c23: k * p.c23, ..*p }
    }

    fn plain(&self) -> Fastsim {
        Fastsim { nx: self.nx, ny: self.ny }
    }

    /// Force on the wheel.
    #[must_use]
    pub fn force(&self, p: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
        let mut force = [CreepForce::default()];
        self.forces(&[CreepCase { patch: *p, creepage: *creepage, mu }], &mut force);
        force[0]
    }

    /// Forces on the wheel of several patches: cheaper than one by one, and the same to the bit.
    ///
    /// # Panics
    /// Where `cases` and `forces` differ in length.
    pub fn forces(&self, cases: &[CreepCase], forces: &mut [CreepForce]) {
        assert_eq!(cases.len(), forces.len(), "one force per case");
        for (cases, forces) in cases.chunks(TOGETHER).zip(forces.chunks_mut(TOGETHER)) {
            let mut soft = [cases[0]; TOGETHER];
            for (soft, case) in soft.iter_mut().zip(cases) {
                *soft = CreepCase { patch: self.softened(&case.patch, &case.creepage, case.mu), ..*case };
            }
            self.plain().forces(&soft[..cases.len()], forces);
        }
    }

    /// Spin moment on the wheel, N m.
    #[must_use]
    pub fn spin_moment(&self, p: &Patch, creepage: &Creepage, mu: f64) -> f64 {
        strip::moment(self.nx, self.ny, &self.softened(p, creepage, mu), creepage, mu)
    }

    /// Faults in the parameters.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = self.plain().faults(at);
        let ranges = [
            ("k0", self.k0, self.k0 > 0.0 && self.k0 <= 1.0, "greater than 0, at most 1"),
            ("alpha", self.alpha, (0.0..=1.0).contains(&self.alpha), "0 to 1"),
            ("beta", self.beta, self.beta >= 0.0 && self.beta.is_finite(), "0 or more"),
        ];
        for (key, value, good, allowed) in ranges {
            if !good {
                faults.push(Fault::new(at.key(key), value.to_string(), allowed));
            }
        }
        faults
    }

    /// Laws for the contract suite: the locomotive measured on a wet rail of the paper.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self { k0: 0.54, alpha: 0.02, beta: 0.62, nx: 10, ny: 10 }]
    }
}
