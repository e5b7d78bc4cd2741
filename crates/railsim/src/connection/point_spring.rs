//! Spring along the line between its two ends: `F = P + k (L - L0)`, tension positive, with `L0` the design length
//! and `P` the preload, of which the mount's x component is read as the tension along the line. Stored energy `P (L - L0) + k (L - L0)^2 / 2`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ForceLaw, Mount, Relative, Wrench, not_negative};
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

/// Line between the ends, A's axes: B's lever from B's centre, unit vector from A's point to B's, length.
#[inline]
pub(super) fn line(motion: &Relative, mount: &Mount) -> (Vec3, Vec3, f64) {
    let q_B = motion.R_AB * mount.p_B;
    let D = motion.r_AB + q_B - mount.p_A;
    let length = D.norm();
    // Ends that meet have no line between them: no direction, so no force, until they part again.
    let e = if length > 0.0 { D / length } else { Vec3::zeros() };
    (q_B, e, length)
}

/// Tension along the line as a wrench on B about A's centre.
#[inline]
pub(super) fn tension(force: f64, e: &Vec3, mount: &Mount) -> Wrench {
    let f = -force * e;
    Wrench { f, m: mount.p_A.cross(&f) }
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
    fn wrench(&self, motion: &Relative, mount: &Mount) -> Wrench {
        let (_, e, length) = line(motion, mount);
        tension(mount.preload.x + self.stiffness * (length - self.length), &e, mount)
    }

    fn energy(&self, motion: &Relative, mount: &Mount) -> f64 {
        let (_, _, length) = line(motion, mount);
        let x = length - self.length;
        mount.preload.x * x + 0.5 * self.stiffness * x * x
    }

    fn dissipation(&self, _motion: &Relative, _mount: &Mount) -> f64 {
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
