//! Anti-roll bar: a torsion bar whose levers and links oppose roll of one body against the other, and nothing else.
//!
//! `M = k t_x + c dt_x/dt` about x, with `t` the antisymmetric part of the relative rotation (the sine of the angle for
//! pure roll). For a bar of torsional stiffness kt (N m/rad, end against end) with levers of length a and links that stand 2 b
//! apart, a relative roll phi lifts the links by `+-b phi` and twists the bar by `2 b phi/a`: `k = kt (2 b/a)^2`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bushing_matrix::turned;
use super::{ForceLaw, Mount, Relative, Wrench, not_negative};
use crate::error::{Fault, KeyPath};
use crate::math::Vec3;

/// Stiffness and damping against relative roll.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AntiRollBar {
    /// Moment about x per relative roll, N m/rad.
    #[schemars(extend("minimum" = 0, "unit" = "N m/rad"))]
    pub stiffness: f64,
    /// Moment about x per rate of relative roll, N m s/rad.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "N m s/rad"))]
    pub damping: f64,
}

impl AntiRollBar {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self { stiffness: 9.4e5, damping: 2e3 }]
    }

    /// Roll, its rate, and how a moment about it acts.
    #[inline]
    fn roll(motion: &Relative) -> (f64, f64, Vec3) {
        let (t, jacobian) = turned(&motion.R_AB);
        let row: Vec3 = jacobian.row(0).transpose();
        (t.x, row.dot(&motion.w_AB), row)
    }
}

impl ForceLaw for AntiRollBar {
    #[inline]
    fn wrench(&self, motion: &Relative, _mount: &Mount, _memory: &[f64]) -> Wrench {
        let (roll, rate, row) = Self::roll(motion);
        Wrench { f: Vec3::zeros(), m: -(self.stiffness * roll + self.damping * rate) * row }
    }

    fn energy(&self, motion: &Relative, _mount: &Mount, _memory: &[f64]) -> f64 {
        let (roll, ..) = Self::roll(motion);
        0.5 * self.stiffness * roll * roll
    }

    fn dissipation(&self, motion: &Relative, _mount: &Mount, _memory: &[f64]) -> f64 {
        let (_, rate, _) = Self::roll(motion);
        self.damping * rate * rate
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = not_negative(&[self.stiffness], &at.key("stiffness"), "N m/rad");
        faults.extend(not_negative(&[self.damping], &at.key("damping"), "N m s/rad"));
        faults
    }
}
