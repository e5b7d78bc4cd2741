//! Viscous damper along the line between its two ends: `F = c dL/dt`, tension positive.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::point_spring::{line, tension};
use super::{ForceLaw, Mount, Pair, Pose, not_negative};
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
    fn rate(a: &Pose, b: &Pose, q_A: &Vec3, q_B: &Vec3, e: &Vec3) -> f64 {
        (b.v + b.w.cross(q_B) - a.v - a.w.cross(q_A)).dot(e)
    }
}

impl ForceLaw for PointDamper {
    #[inline]
    fn wrench(&self, a: &Pose, b: &Pose, mount: &Mount) -> Pair {
        let (q_A, q_B, e, _) = line(a, b, mount);
        tension(self.damping * Self::rate(a, b, &q_A, &q_B, &e), &e, &q_A, &q_B)
    }

    fn energy(&self, _a: &Pose, _b: &Pose, _mount: &Mount) -> f64 {
        0.0
    }

    fn dissipation(&self, a: &Pose, b: &Pose, mount: &Mount) -> f64 {
        let (q_A, q_B, e, _) = line(a, b, mount);
        let rate = Self::rate(a, b, &q_A, &q_B, &e);
        self.damping * rate * rate
    }

    fn nominal_stiffness(&self, _between: &Vec3) -> Vec3 {
        Vec3::zeros()
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        not_negative(&[self.damping], &at.key("damping"), "N s/m")
    }
}
