//! Wheelset: a rigid body that is symmetric about its axle and spins about it.
//!
//! Its equations are written in axle axes A, which follow roll and yaw but not the spin. Inertia about x and z is
//! equal, so it is constant in A, and `w_axes x (I w)` holds the gyroscopic moments. Connections are fixed to axle
//! boxes: they hand forces to the axle through a bearing that passes no moment about the axle.

use super::{Kinematics, RigidBody, Wrench, rigid_body};
use crate::math::Vec3;

/// A wheelset's mass properties and nominal wheel geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct Wheelset {
    /// Mass, inertia (roll and yaw equal; pitch about the axle), design position.
    pub body: RigidBody,
    /// Nominal rolling radius at the tape circle, m.
    pub radius: f64,
    /// Lateral distance of the tape circle from the wheelset's centre, m.
    pub tape_half_distance: f64,
}

/// Rotational part. `boxes` is the moment (inertial axes) handed over by axle boxes; `wheels_A` that of the
/// wheel/rail forces and of whatever drives or brakes the axle, in axle axes.
///
/// The axle boxes' axes turn with roll and yaw only, so their moment about the axle does work on yaw alone,
/// through `d psi (0, sin phi, cos phi)`: virtual work turns `M_y` into `M_y tan(phi)` about z.
#[inline(always)]
pub(crate) fn rotate(k: &Kinematics, inertia: &Vec3, boxes: &Wrench, wheels_A: &Vec3, du: &mut [f64; 6]) {
    let m = k.pose.R.tr_mul(&boxes.m);
    let tan_phi = k.R_TB[(2, 1)] / k.R_TB[(2, 2)];
    let moment = Vec3::new(m.x, 0.0, m.z + m.y * tan_phi) + wheels_A;
    rigid_body::rotate(k, inertia, &moment, du);
}
