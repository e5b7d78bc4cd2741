//! Three-direction spring-damper between two body-fixed points, with optional rotational stiffness.
//!
//! With `D = r_B + R_B p_B - r_A - R_A p_A` the vector from A's point to B's, and `d_A = R_A^T D`,
//! `d_B = R_B^T D` its components in either body's axes, the stored energy is the mean of the energies in the
//! two sets of axes,
//!
//! ```text
//! U = 1/2 [ 1/2 d_A' K d_A + 1/2 d_B' K d_B ] - 1/2 P' (d_A + d_B),
//! ```
//!
//! so that neither body is preferred: a preload `P` whose ends have moved apart by `D` across it turns each body
//! by half of `D x P`, as a coil spring between parallel end plates does. Virtual work then puts the half that is
//! written in A's axes at B's point and the half in B's axes at A's point; forces and moments balance exactly.
//! The damper acts on the rates of `d_A` and `d_B` in the same way. Rotational terms act on the small relative
//! rotation vector `R_A' R_B` (its antisymmetric part, exact to second order in the angle).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ForceLaw, Mount, Relative, Wrench, carry, coincident, not_negative};
use crate::error::{Fault, KeyPath};
use crate::math::{Mat3, Vec3};

/// Stiffness and damping along the bodies' x, y, z; rotational about them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bushing {
    /// Stiffness along x, y, z, N/m.
    #[serde(default)]
    pub stiffness: [f64; 3],
    /// Damping along x, y, z, N s/m.
    #[serde(default)]
    pub damping: [f64; 3],
    /// Stiffness about x, y, z, N m/rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotational_stiffness: Option<[f64; 3]>,
    /// Damping about x, y, z, N m s/rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotational_damping: Option<[f64; 3]>,
}

/// Wrench of the translational terms: on B about A's centre of mass, in A's axes. Without a branch, so that several go side by side
/// ([`super::lanes`]).
#[inline(always)]
pub(super) fn translational(stiffness: &Vec3, damping: &Vec3, motion: &Relative, mount: &Mount) -> Wrench {
    let s = Bushing::stretch(motion, mount);
    let half = |d: &Vec3, rate: &Vec3| {
        0.5 * (mount.preload - stiffness.component_mul(d) - damping.component_mul(rate))
    };
    let f_A = half(&s.d_A, &s.rate_A); // written in A's axes, acts at B's point
    let f_B = motion.R_AB * half(&s.d_B, &s.rate_B); // written in B's axes, acts at A's point
    let f = f_A + f_B;
    Wrench { f, m: mount.p_A.cross(&f) + s.d_A.cross(&f_A) }
}

#[inline]
fn scale(k: &[f64; 3], d: &Vec3) -> Vec3 {
    Vec3::new(k[0] * d.x, k[1] * d.y, k[2] * d.z)
}

/// Relative rotation of B from A as a vector in A's axes (antisymmetric part of `R_AB`).
fn turned(motion: &Relative) -> Vec3 {
    let R = &motion.R_AB;
    0.5 * Vec3::new(R[(2, 1)] - R[(1, 2)], R[(0, 2)] - R[(2, 0)], R[(1, 0)] - R[(0, 1)])
}

/// `d` and its rate in A's axes and in B's.
struct Stretch {
    d_A: Vec3,
    rate_A: Vec3,
    d_B: Vec3,
    rate_B: Vec3,
}

impl Bushing {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![
            Self {
                stiffness: [3.5e7, 1.0e7, 4.0e6],
                damping: [2.0e4, 2.0e4, 4.0e4],
                rotational_stiffness: None,
                rotational_damping: None,
            },
            Self {
                stiffness: [1.0e5, 2.0e5, 5.0e5],
                damping: [0.0, 0.0, 1.0e3],
                rotational_stiffness: Some([1.0e4, 2.0e4, 3.0e4]),
                rotational_damping: Some([1.0e2, 0.0, 3.0e2]),
            },
        ]
    }

    #[inline(always)]
    fn stretch(motion: &Relative, mount: &Mount) -> Stretch {
        let q_B = motion.R_AB * mount.p_B;
        let d_A = motion.r_AB + q_B - mount.p_A;
        let rate_A = motion.v_AB + motion.w_AB.cross(&q_B);
        let d_B = motion.R_AB.tr_mul(&d_A);
        let rate_B = motion.R_AB.tr_mul(&(rate_A - motion.w_AB.cross(&d_A)));
        Stretch { d_A, rate_A, d_B, rate_B }
    }
}

impl ForceLaw for Bushing {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> Wrench {
        let mut wrench = translational(&Vec3::from(self.stiffness), &Vec3::from(self.damping), motion, mount);
        if let Some(k) = &self.rotational_stiffness {
            wrench.m -= scale(k, &turned(motion));
        }
        if let Some(c) = &self.rotational_damping {
            wrench.m -= scale(c, &motion.w_AB);
        }
        wrench
    }

    fn energy(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        let s = Self::stretch(motion, mount);
        let half = |d: &Vec3| 0.5 * (0.5 * d.dot(&scale(&self.stiffness, d)) - mount.preload.dot(d));
        let turn = turned(motion);
        let k = self.rotational_stiffness.unwrap_or_default();
        half(&s.d_A) + half(&s.d_B) + 0.5 * turn.dot(&scale(&k, &turn))
    }

    fn dissipation(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        let s = Self::stretch(motion, mount);
        let lost = |rate: &Vec3| 0.5 * rate.dot(&scale(&self.damping, rate));
        let c = self.rotational_damping.unwrap_or_default();
        lost(&s.rate_A) + lost(&s.rate_B) + motion.w_AB.dot(&scale(&c, &motion.w_AB))
    }

    fn nominal_stiffness(&self, _between: &Vec3) -> Mat3 {
        Mat3::from_diagonal(&Vec3::from(self.stiffness))
    }

    fn settle(&self, mount: &mut Mount, force: Option<&Vec3>) -> Result<(), String> {
        carry(mount, force);
        Ok(())
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        coincident(between, "bushing")
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = not_negative(&self.stiffness, &at.key("stiffness"), "N/m");
        faults.extend(not_negative(&self.damping, &at.key("damping"), "N s/m"));
        if let Some(k) = &self.rotational_stiffness {
            faults.extend(not_negative(k, &at.key("rotational_stiffness"), "N m/rad"));
        }
        if let Some(c) = &self.rotational_damping {
            faults.extend(not_negative(c, &at.key("rotational_damping"), "N m s/rad"));
        }
        faults
    }
}
