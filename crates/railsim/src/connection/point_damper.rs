//! Viscous damper along the line between its two ends: `F = c dL/dt`, tension positive.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::point_spring::{line, tension};
use super::{ForceLaw, Mount, Relative, Wrench, not_negative};
use crate::error::{Fault, KeyPath};
use crate::math::Vec3;

/// Linear damper between two points that do not coincide.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointDamper {
    /// Damping, N s/m.
    pub damping: f64,
}

impl PointDamper {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self { damping: 4.0e4 }]
    }

    #[inline]
    fn rate(motion: &Relative, q_B: &Vec3, e: &Vec3) -> f64 {
        (motion.v_AB + motion.w_AB.cross(q_B)).dot(e)
    }
}

impl ForceLaw for PointDamper {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount) -> Wrench {
        let (q_B, e, _) = line(motion, mount);
        tension(self.damping * Self::rate(motion, &q_B, &e), &e, mount)
    }

    fn energy(&self, _motion: &Relative, _mount: &Mount) -> f64 {
        0.0
    }

    fn dissipation(&self, motion: &Relative, mount: &Mount) -> f64 {
        let (q_B, e, _) = line(motion, mount);
        let rate = Self::rate(motion, &q_B, &e);
        self.damping * rate * rate
    }

    fn nominal_stiffness(&self, _between: &Vec3) -> Vec3 {
        Vec3::zeros()
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        not_negative(&[self.damping], &at.key("damping"), "N s/m")
    }
}
