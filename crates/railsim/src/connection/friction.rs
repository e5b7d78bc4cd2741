//! Coulomb friction in one direction: a slider of constant force behind a spring (the stick stiffness).
//!
//! The memory z is the elongation of the spring. The tension is that of the spring, cut at the limit `F`:
//!
//! ```text
//! T = P(k z),  P(f) = f cut to |f| <= F
//! dz/dt = dx/dt - (z - P(k z)/k) / tau,     tau = 1 ms
//! ```
//!
//! Below the limit `dz/dt = dx/dt`: the element is a spring, exactly, so that nothing creeps at rest however long and
//! however much it trembles below the limit (smooth laws after Dahl or Bouc and Wen drift there, and LuGre's too). At the limit the
//! force is the limit at every speed; z runs ahead of it by `tau dx/dt`, which only delays a reversal, by less than tau.
//! This is the elasto-plastic slider with the return to the limit in a relaxation time instead of at once (Duvaut and
//! Lions, Inequalities in Mechanics and Physics, 1976; Simo and Hughes, Computational Inelasticity, 1998, section 2.7):
//! a Lipschitz-continuous equation that every integrator here takes as it is, with a fastest rate 1/tau known beforehand.
//!
//! With `over = |z| - F/k` beyond the limit, the stored energy is `k z^2/2`, there `F |z| - F^2/(2k)`, whose gradient is T;
//! the dissipated power is `F over/tau`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Along, ForceLaw, Mount, Relative, Wrench, ends_along, not_negative, positive};
use crate::error::{Fault, KeyPath};
use crate::math::Vec3;

/// Time in which a slider returns to its limit, s.
pub const RELAXATION_TIME: f64 = 1e-3;

/// Friction of constant force along a line or an axis.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Friction force, N.
    #[schemars(extend("minimum" = 0, "unit" = "N"))]
    pub force: f64,
    /// Stick stiffness, N/m: it gives way by `force / stiffness` before it slides.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N/m"))]
    pub stiffness: f64,
    /// Along the line between the ends, or an axis of the first body.
    #[serde(default)]
    pub along: Along,
}

impl Friction {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![
            Self { force: 8e3, stiffness: 4e6, along: Along::Z },
            Self { force: 2e3, stiffness: 1e6, along: Along::Line },
        ]
    }

    /// Elongation of the spring beyond which it slides, m.
    fn limit(&self) -> f64 {
        self.force / self.stiffness
    }
}

impl ForceLaw for Friction {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> Wrench {
        let tension = (self.stiffness * memory[0]).clamp(-self.force, self.force);
        self.along.stretch(motion, mount).wrench(tension)
    }

    fn energy(&self, _motion: &Relative, _mount: &Mount, memory: &[f64]) -> f64 {
        slider_energy(self.stiffness, memory[0].abs(), self.limit())
    }

    fn dissipation(&self, _motion: &Relative, _mount: &Mount, memory: &[f64]) -> f64 {
        self.force * (memory[0].abs() - self.limit()).max(0.0) / RELAXATION_TIME
    }

    fn memory(&self) -> usize {
        1
    }

    #[inline]
    fn memory_rates(&self, motion: &Relative, mount: &Mount, memory: &[f64], rates: &mut [f64]) {
        let limit = self.limit();
        let over = memory[0] - memory[0].clamp(-limit, limit);
        rates[0] = self.along.stretch(motion, mount).rate - over / RELAXATION_TIME;
    }

    fn memory_speed(&self) -> f64 {
        1.0 / RELAXATION_TIME
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        ends_along(self.along, between)
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = not_negative(&[self.force], &at.key("force"), "N");
        faults.extend(positive(&[self.stiffness], &at.key("stiffness"), "N/m"));
        faults
    }
}

/// Energy of a slider's spring drawn to `z >= 0`, with its limit at `limit`, J.
#[inline]
pub(super) fn slider_energy(stiffness: f64, z: f64, limit: f64) -> f64 {
    let elastic = z.min(limit);
    stiffness * (0.5 * elastic * elastic + limit * (z - limit).max(0.0))
}
