//! Spring along the line between its two ends: `F = P + k (L - L0)`, tension positive, with `L0` the design length
//! and `P` the preload, of which the mount's x component is read as the tension along the line. Stored energy `P (L - L0) + k (L - L0)^2 / 2`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ForceLaw, Mount, Pair, Pose, Wrench, not_negative};
use crate::error::{Fault, KeyPath};
use crate::math::Vec3;

/// Linear spring between two points that do not coincide.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointSpring {
    /// Stiffness, N/m.
    pub stiffness: f64,
    /// Length in the design position, m.
    pub length: f64,
}

/// Line between the ends: levers, unit vector from A's point to B's, length.
#[inline]
pub(super) fn line(a: &Pose, b: &Pose, mount: &Mount) -> (Vec3, Vec3, Vec3, f64) {
    let q_A = a.R * mount.p_A;
    let q_B = b.R * mount.p_B;
    let D = b.r + q_B - a.r - q_A;
    let length = D.norm();
    // Ends that meet have no line between them: no direction, so no force, until they part again.
    let e = if length > 0.0 { D / length } else { Vec3::zeros() };
    (q_A, q_B, e, length)
}

/// Tension along the line as a pair of wrenches.
#[inline]
pub(super) fn tension(force: f64, e: &Vec3, q_A: &Vec3, q_B: &Vec3) -> Pair {
    let f = force * e;
    Pair { on_A: Wrench { f, m: q_A.cross(&f) }, on_B: Wrench { f: -f, m: -q_B.cross(&f) } }
}

impl PointSpring {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self { stiffness: 2.0e5, length: 0.4 }]
    }
}

impl ForceLaw for PointSpring {
    #[inline]
    fn wrench(&self, a: &Pose, b: &Pose, mount: &Mount) -> Pair {
        let (q_A, q_B, e, length) = line(a, b, mount);
        tension(mount.preload.x + self.stiffness * (length - self.length), &e, &q_A, &q_B)
    }

    fn energy(&self, a: &Pose, b: &Pose, mount: &Mount) -> f64 {
        let (_, _, _, length) = line(a, b, mount);
        let x = length - self.length;
        mount.preload.x * x + 0.5 * self.stiffness * x * x
    }

    fn dissipation(&self, _a: &Pose, _b: &Pose, _mount: &Mount) -> f64 {
        0.0
    }

    fn nominal_stiffness(&self, between: &Vec3) -> Vec3 {
        let e = between.normalize();
        self.stiffness * e.component_mul(&e)
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = not_negative(&[self.stiffness], &at.key("stiffness"), "N/m");
        if !(self.length.is_finite() && self.length > 0.0) {
            faults.push(Fault::new(at.key("length"), format!("{}", self.length), "a finite number > 0 m"));
        }
        faults
    }
}
