//! Rigid body: Newton's law in the turning track frame, Euler's equations in principal body axes.

use super::{Kinematics, Wrench};
use crate::math::Vec3;

/// Mass properties and design position.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBody {
    /// Name, e.g. `carbody`.
    pub name: String,
    /// Mass, kg.
    pub mass: f64,
    /// Principal moments of inertia about roll, pitch, yaw axes, kg m2.
    pub inertia: Vec3,
    /// Centre of mass in the design position: vehicle axes (origin at the vehicle's centre, top of rail), m.
    pub position: Vec3,
}

/// Linear part: `dv_T/dt = R_IT' F / m - w_T x v_T`. `wrench.f` holds all forces with weight, inertial axes; `level` as in
/// `kinematics`.
#[inline(always)]
pub(crate) fn translate(k: &Kinematics, mass: f64, wrench: &Wrench, level: bool, du: &mut [f64; 6]) {
    let a = if level {
        wrench.f / mass
    } else {
        k.frame.R_IT.tr_mul(&wrench.f) / mass - (k.s_dot * k.frame.k_T).cross(&k.v_T)
    };
    du[..3].copy_from_slice(a.as_slice());
}

/// Rotational part in the body's axes: `I dw/dt + w_axes x (I w) = M`.
#[inline(always)]
pub(crate) fn rotate(k: &Kinematics, inertia: &Vec3, moment_B: &Vec3, du: &mut [f64; 6]) {
    let h = inertia.component_mul(&k.w_B);
    let a = (moment_B - k.w_axes.cross(&h)).component_div(inertia);
    du[3..6].copy_from_slice(a.as_slice());
}

/// Kinetic energy, J.
#[must_use]
pub fn kinetic_energy(k: &Kinematics, mass: f64, inertia: &Vec3) -> f64 {
    0.5 * mass * k.v_T.norm_squared() + 0.5 * k.w_B.dot(&inertia.component_mul(&k.w_B))
}
