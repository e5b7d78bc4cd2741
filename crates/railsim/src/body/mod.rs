//! Bodies in trajectory coordinates.
//!
//! Each body has its own track frame T at arc length `s` of the design centre line and six coordinates relative to
//! it: `s, y, z` of the centre of mass, and `roll phi, pitch theta, yaw psi` with
//! `R_TB = Rz(psi) Rx(phi) Ry(theta)`, all exact. The speeds of a body are its *inertial* velocity in T's axes and
//! its *inertial* angular velocity in its own axes (quasi-velocities), so that Newton's and Euler's equations need
//! no derivative of the curvature:
//!
//! ```text
//! m (dv/dt + w_T x v) = F,      w_T = (ds/dt) k_T
//! ```
//!
//! where `k_T` is the rotation of T per metre. A body with no force on it then flies straight, whatever the track
//! below it does; `tests/track_frame_proof.rs` throws one.

pub mod pose;
pub mod rigid_body;
pub mod wheelset;

pub use pose::{Pose, Relative, Wrench};
pub use rigid_body::RigidBody;
pub use wheelset::Wheelset;

use crate::math::angle::SinCos;
use crate::math::{Mat3, Vec3, rotation};
use crate::track::Frame;

/// Coordinates of one body, in the order of the state.
pub mod coordinate {
    /// Arc length of the track frame, m.
    pub const S: usize = 0;
    /// Lateral, m, + right.
    pub const Y: usize = 1;
    /// Vertical, m, + down.
    pub const Z: usize = 2;
    /// Roll, rad.
    pub const PHI: usize = 3;
    /// Pitch (of a wheelset: its turned angle), rad.
    pub const THETA: usize = 4;
    /// Yaw, rad.
    pub const PSI: usize = 5;
}

/// What the kinematics of one body give: computed once per right-hand side, read by every later stage.
#[derive(Debug, Clone, Copy)]
pub struct Kinematics {
    /// The track frame under the body.
    pub frame: Frame,
    /// ds/dt, m/s.
    pub s_dot: f64,
    /// The frame that connections see (a wheelset's does not turn with the axle), inertial axes.
    pub pose: Pose,
    /// Body axes (wheelset: axle axes) to track axes.
    pub R_TB: Mat3,
    /// Inertial velocity of the centre of mass, track axes, m/s.
    pub v_T: Vec3,
    /// Inertial angular velocity of the body with its spin, body (axle) axes, rad/s.
    pub w_B: Vec3,
    /// Inertial angular velocity of the body's (axle's) axes in these axes; differs from `w_B` for a wheelset, rad/s.
    pub w_axes: Vec3,
}

impl Kinematics {
    /// At rest at the origin.
    #[must_use]
    pub fn zero() -> Self {
        Self {
            frame: Frame { r_IT: Vec3::zeros(), R_IT: Mat3::identity(), k_T: Vec3::zeros() },
            s_dot: 0.0,
            pose: Pose::at(Vec3::zeros()),
            R_TB: Mat3::identity(),
            v_T: Vec3::zeros(),
            w_B: Vec3::zeros(),
            w_axes: Vec3::zeros(),
        }
    }

    /// Position of the centre of mass from the track frame's origin, track axes, m.
    #[must_use]
    pub fn p_T(q: &[f64]) -> Vec3 {
        Vec3::new(0.0, q[coordinate::Y], q[coordinate::Z])
    }
}

/// `dq/dt` from the quasi-velocities, and the kinematics on the way, written into `k`.
///
/// `turns` are sine and cosine of roll, pitch and yaw; `spins` is true for a wheelset, whose axes carry yaw and roll but not
/// its spin; `level` where the track frame is known to be inertial axes moved along x, which saves the turning.
#[allow(clippy::too_many_arguments)] // one stage of the right-hand side, all of it plain data
#[inline(always)]
pub(crate) fn kinematics(
    q: &[f64; 6],
    turns: [SinCos; 3],
    u: &[f64; 6],
    frame: Frame,
    spins: bool,
    level: bool,
    dq: &mut [f64; 6],
    k: &mut Kinematics,
) {
    let (y, z) = (q[1], q[2]);
    let v_T = Vec3::new(u[0], u[1], u[2]);
    let w_B = Vec3::new(u[3], u[4], u[5]);
    // v_T = ds/dt (e_x + k x p) + (0, dy/dt, dz/dt), p = (0, y, z)
    let turn = frame.k_T;
    let s_dot = if level { v_T.x } else { v_T.x / (1.0 + turn.y * z - turn.z * y) };
    dq[0] = s_dot;
    dq[1] = v_T.y + s_dot * turn.x * z;
    dq[2] = v_T.z - s_dot * turn.x * y;

    let [(sin_phi, cos_phi), (s, c), (sin_psi, cos_psi)] = turns;
    // Axle axes: Rz(psi) Rx(phi), written out.
    let R_TA = Mat3::new(
        cos_psi,
        -sin_psi * cos_phi,
        sin_psi * sin_phi,
        sin_psi,
        cos_psi * cos_phi,
        -cos_psi * sin_phi,
        0.0,
        sin_phi,
        cos_phi,
    );
    let (R_TB, w_A) = if spins {
        (R_TA, w_B)
    } else {
        // R_TA Ry(theta): x and z columns turned into each other.
        let (x, z) = (R_TA.column(0), R_TA.column(2));
        let R_TB = Mat3::from_columns(&[c * x - s * z, R_TA.column(1).into(), s * x + c * z]);
        (R_TB, Vec3::new(c * w_B.x + s * w_B.z, w_B.y, c * w_B.z - s * w_B.x))
    };
    let relative = if level { w_A } else { w_A - R_TA.tr_mul(&(s_dot * turn)) };
    let psi_dot = relative.z / cos_phi;
    dq[3] = relative.x;
    dq[4] = relative.y - psi_dot * sin_phi;
    dq[5] = psi_dot;
    let w_axes = if spins { w_A - Vec3::new(0.0, dq[4], 0.0) } else { w_B };

    k.pose = if level {
        let r = Vec3::new(frame.r_IT.x, y, z);
        Pose { r, R: R_TB, v: v_T, w: R_TB * w_axes }
    } else {
        let R = frame.R_IT * R_TB;
        let r = frame.r_IT + frame.R_IT * Vec3::new(0.0, y, z);
        Pose { r, R, v: frame.R_IT * v_T, w: R * w_axes }
    };
    k.frame = frame;
    k.s_dot = s_dot;
    k.R_TB = R_TB;
    k.v_T = v_T;
    k.w_B = w_B;
    k.w_axes = w_axes;
}

/// Quasi-velocities of a body that stays where it is in its track frame while that moves at `s_dot`; `spin` is the
/// rate of the turned angle (wheelset) or of pitch.
#[must_use]
pub fn steady_speeds(q: &[f64], frame: &Frame, s_dot: f64, spin: f64, spins: bool) -> [f64; 6] {
    let (y, z) = (q[1], q[2]);
    let k = frame.k_T;
    let R_TA = rotation::rot_z(q[5]) * rotation::rot_x(q[3]);
    let w_A = R_TA.tr_mul(&(s_dot * k)) + Vec3::new(0.0, spin, 0.0);
    let w = if spins { w_A } else { rotation::rot_y(q[4]).tr_mul(&w_A) };
    [s_dot * (1.0 + k.y * z - k.z * y), -s_dot * k.x * z, s_dot * k.x * y, w.x, w.y, w.z]
}
