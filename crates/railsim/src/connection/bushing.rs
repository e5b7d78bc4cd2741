//! Three-direction spring-damper between two body-fixed points, with optional rotational stiffness.
//!
//! With `D = r_B + R_B p_B - r_A - R_A p_A` the vector from A's point to B's, and `d_A = R_A^T D`,
//! `d_B = R_B^T D` its components in either body's axes, the stored energy is the mean of the energies in the
//! two sets of axes,
//!
//! ```text
//! U = 1/2 [ 1/2 (d_A - d0)' K (d_A - d0) + 1/2 (d_B - d0)' K (d_B - d0) ] - 1/2 P' (d_A + d_B - 2 d0),
//! ```
//!
//! so that neither body is preferred: a preload `P` whose ends have moved apart by `D` across it turns each body
//! by half of `D x P`, as a coil spring between parallel end plates does. Virtual work then puts the half that is
//! written in A's axes at B's point and the half in B's axes at A's point; forces and moments balance exactly.
//! The damper acts on the rates of `d_A` and `d_B` in the same way. Rotational terms act on the small relative
//! rotation vector `R_A' R_B` (its antisymmetric part, exact to second order in the angle).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ForceLaw, Mount, Pair, Pose, Wrench, not_negative};
use crate::error::{Fault, KeyPath};
use crate::math::Vec3;

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

#[inline]
fn scale(k: &[f64; 3], d: &Vec3) -> Vec3 {
    Vec3::new(k[0] * d.x, k[1] * d.y, k[2] * d.z)
}

/// Relative rotation of B from A as a vector in A's axes (antisymmetric part of `R_A' R_B`).
fn relative_rotation(a: &Pose, b: &Pose) -> Vec3 {
    let R = a.R.transpose() * b.R;
    0.5 * Vec3::new(R[(2, 1)] - R[(1, 2)], R[(0, 2)] - R[(2, 0)], R[(1, 0)] - R[(0, 1)])
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

    /// Vector between the points and the levers of both points from both centres of mass.
    #[inline]
    fn arms(a: &Pose, b: &Pose, mount: &Mount) -> (Vec3, Vec3, Vec3) {
        let q_A = a.R * mount.p_A;
        let q_B = b.R * mount.p_B;
        (b.r + q_B - a.r - q_A, q_A, q_B)
    }

    /// Rates of `D` at B's point seen from A and at A's point seen from B, inertial axes.
    #[inline]
    fn rates(a: &Pose, b: &Pose, D: &Vec3, q_A: &Vec3, q_B: &Vec3) -> (Vec3, Vec3) {
        let v = b.v + b.w.cross(q_B) - a.v - a.w.cross(q_A);
        (v - a.w.cross(D), v - b.w.cross(D))
    }
}

impl ForceLaw for Bushing {
    #[inline]
    fn wrench(&self, a: &Pose, b: &Pose, mount: &Mount) -> Pair {
        let (D, q_A, q_B) = Self::arms(a, b, mount);
        let (v_A, v_B) = Self::rates(a, b, &D, &q_A, &q_B);
        let half = |pose: &Pose, v: &Vec3| {
            let d = pose.R.tr_mul(&D);
            let rate = pose.R.tr_mul(v);
            0.5 * (pose.R * (mount.preload - scale(&self.stiffness, &d) - scale(&self.damping, &rate)))
        };
        let f_A = half(a, &v_A); // written in A's axes, acts at B's point
        let f_B = half(b, &v_B); // written in B's axes, acts at A's point
        let f = f_A + f_B;
        // (q_A + D) x f_A + q_A x f_B, and what balances it about any point.
        let m = q_A.cross(&f) + D.cross(&f_A);
        let mut on_A = Wrench { f: -f, m: -m };
        let mut on_B = Wrench { f, m: m - (b.r - a.r).cross(&f) };
        if self.rotational_stiffness.is_some() || self.rotational_damping.is_some() {
            let k = self.rotational_stiffness.unwrap_or_default();
            let c = self.rotational_damping.unwrap_or_default();
            let rate = a.R.tr_mul(&(b.w - a.w));
            let m = a.R * (scale(&k, &relative_rotation(a, b)) + scale(&c, &rate));
            on_A.m += m;
            on_B.m -= m;
        }
        Pair { on_A, on_B }
    }

    fn energy(&self, a: &Pose, b: &Pose, mount: &Mount) -> f64 {
        let (D, _, _) = Self::arms(a, b, mount);
        let half = |pose: &Pose| {
            let d = pose.R.tr_mul(&D);
            0.5 * (0.5 * d.dot(&scale(&self.stiffness, &d)) - mount.preload.dot(&d))
        };
        let turn = relative_rotation(a, b);
        let k = self.rotational_stiffness.unwrap_or_default();
        half(a) + half(b) + 0.5 * turn.dot(&scale(&k, &turn))
    }

    fn dissipation(&self, a: &Pose, b: &Pose, mount: &Mount) -> f64 {
        let (D, q_A, q_B) = Self::arms(a, b, mount);
        let (v_A, v_B) = Self::rates(a, b, &D, &q_A, &q_B);
        let (d_A, d_B) = (a.R.tr_mul(&v_A), b.R.tr_mul(&v_B));
        let turn = a.R.tr_mul(&(b.w - a.w));
        let c = self.rotational_damping.unwrap_or_default();
        0.5 * (d_A.dot(&scale(&self.damping, &d_A)) + d_B.dot(&scale(&self.damping, &d_B)))
            + turn.dot(&scale(&c, &turn))
    }

    fn nominal_stiffness(&self, _between: &Vec3) -> Vec3 {
        Vec3::from(self.stiffness)
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
