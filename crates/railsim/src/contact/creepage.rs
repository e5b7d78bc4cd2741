//! Kinematics of one wheel on its rail: where the contacts are, how fast the surfaces slide, and what the contact
//! forces do to the wheelset and to the track under it.
//!
//! Everything is written in side coordinates (x forward, y~ outward, z down), so that left and right run the same
//! code: `sigma` is +1 on the right, -1 on the left, lateral components and turns about x and z change sign with it.
//!
//! Creepages are the sliding velocity of the wheel's surface against the rail's, over the rolling speed `V`:
//! `xi = v_x / V`, `eta = v_t / V` with t the outward tangent in the contact plane, and spin
//! `phi = Omega . (e_x x e_t) / V`; the slip field in the patch is `(xi - phi y, eta + phi x) V`
//! (Kalker 1990, eq. 1.85, written for our axes).
//!
//! The contact leads or trails the axle by the wheel's yaw against the rail and by the rail's slopes, so that a wheelset which
//! follows its rails does not creep. Normal and creep forces have no component along a sloping rail: irregularity takes nothing
//! from the speed.

use crate::body::Kinematics;
use crate::contact::creep::Creepage;
use crate::contact::geometry_table::ContactPoint;
use crate::math::Vec3;
use crate::math::angle::{self, SinCos};
use crate::track::cant::BASE as CROSS_LEVEL_BASE;
use crate::track::irregularity::Deviation;

/// Position and velocity of the track mass under a wheelset, relative to the design track.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrackMotion {
    /// Lateral, m, + right.
    pub y: f64,
    /// Vertical, m, + down.
    pub z: f64,
    /// Roll, rad.
    pub phi: f64,
    /// dy/dt, m/s.
    pub vy: f64,
    /// dz/dt, m/s.
    pub vz: f64,
    /// dphi/dt, rad/s.
    pub vphi: f64,
}

/// A rail as the wheel of side `sigma` meets it.
#[derive(Debug, Clone, Copy)]
pub struct RailPose {
    /// Origin of the rail profile in side coordinates of the track frame: y~, z, m.
    pub origin: [f64; 2],
    /// Roll of the rail in side coordinates, rad.
    pub roll: f64,
    /// Its sine and cosine.
    pub turn: SinCos,
    /// Slope of the running surface along the track, y~ and z, 1.
    pub slope: [f64; 2],
    /// Velocity of the running surface at the origin as seen from the moving frame, y~ and z, m/s: that of the
    /// track mass plus the deviation passing below.
    pub surface_velocity: [f64; 2],
}

/// Roll of the track from its design position, rad: cross level and the roll `phi` of the track mass.
#[inline(always)]
#[must_use]
pub fn track_roll(dev: &Deviation, phi: f64) -> f64 {
    dev.cross_level / CROSS_LEVEL_BASE + phi
}

/// Rail of one side: design position, irregularity and track mass. `turn` are sine and cosine of [`track_roll`].
#[inline(always)]
#[must_use]
pub fn rail_pose(
    sigma: f64,
    rail_y: f64,
    dev: &Deviation,
    track: &TrackMotion,
    turn: SinCos,
    s_dot: f64,
) -> RailPose {
    let roll = track_roll(dev, track.phi);
    let y = rail_y + 0.5 * dev.gauge;
    let slope = [
        0.5 * dev.dgauge_ds + sigma * dev.dy_ds,
        dev.dz_ds + sigma * y * dev.dcross_level_ds / CROSS_LEVEL_BASE,
    ];
    RailPose {
        origin: [y + sigma * (dev.y + track.y), dev.z + track.z + sigma * y * roll],
        roll: sigma * roll,
        turn: (sigma * turn.0, turn.1),
        slope,
        surface_velocity: [
            slope[0] * s_dot + sigma * track.vy,
            slope[1] * s_dot + track.vz + sigma * y * track.vphi,
        ],
    }
}

/// A wheel relative to its rail, in rail axes: what the geometry table is asked.
#[derive(Debug, Clone, Copy)]
pub struct WheelPose {
    /// Outward shift of the tape-circle point from its nominal place over the rail, m.
    pub shift: f64,
    /// Depth of the tape-circle point below the top of the rail, m.
    pub depth: f64,
    /// Roll of the wheel against the rail, side coordinates, rad.
    pub roll: f64,
    /// Yaw of the wheelset against the rail under it, side coordinates, rad.
    pub yaw: f64,
}

/// Relative position of wheel and rail. `q` are the wheelset's coordinates, `nominal_shift` the tape circle's
/// distance from the rail origin at nominal gauge.
#[inline(always)]
#[must_use]
pub fn wheel_pose(
    sigma: f64,
    q: &[f64],
    k: &Kinematics,
    tape_half_distance: f64,
    radius: f64,
    nominal_shift: f64,
    rail: &RailPose,
) -> WheelPose {
    let half = sigma * tape_half_distance;
    let y = sigma * (q[1] + k.R_TB[(1, 1)] * half + k.R_TB[(1, 2)] * radius) - rail.origin[0];
    let z = q[2] + k.R_TB[(2, 1)] * half + k.R_TB[(2, 2)] * radius - rail.origin[1];
    let (sin, cos) = rail.turn;
    WheelPose {
        shift: y * cos + z * sin - nominal_shift,
        depth: z * cos - y * sin,
        roll: sigma * q[3] - rail.roll,
        yaw: sigma * q[5] - rail.slope[0],
    }
}

/// One contact, placed in the track frame.
#[derive(Debug, Clone, Copy, Default)]
pub struct PlacedContact {
    /// Contact point from the wheelset's centre of mass, track axes, m.
    pub lever: Vec3,
    /// Contact point in the cross-section of the track frame: y, z, m.
    pub point: [f64; 2],
    /// Outward tangent in the contact plane, track axes.
    pub e_t: Vec3,
    /// Normal, from the rail into the wheel, track axes.
    pub e_n: Vec3,
    /// Normal penetration, m.
    pub penetration: f64,
    /// Rate of approach along the normal, m/s.
    pub approach_rate: f64,
    /// Sliding velocity of the wheel against the rail, forward and along `e_t`, m/s.
    pub slip: [f64; 2],
    /// Creepages.
    pub creepage: Creepage,
}

/// Places a contact of the geometry table in the track frame and computes its creepages at rolling speed `speed`;
/// `w_T` is the wheelset's angular velocity in track axes.
#[inline(always)]
#[must_use]
#[allow(clippy::too_many_arguments)] // one stage of the right-hand side, all of it plain data
pub fn place(
    sigma: f64,
    contact: &ContactPoint,
    rail: &RailPose,
    radius: f64,
    q: &[f64],
    k: &Kinematics,
    w_T: &Vec3,
    track: &TrackMotion,
    speed: f64,
) -> PlacedContact {
    let (sin_r, cos_r) = rail.turn;
    // The contact plane's tilt in the track frame; the angle is positive where the flange is.
    let tilt = angle::small(contact.angle);
    let (sin_g, cos_g) = angle::add(tilt, (-sin_r, cos_r));
    let e_t = Vec3::new(0.0, sigma * cos_g, -sin_g);
    let e_n = Vec3::new(0.0, -sigma * sin_g, -cos_g);
    let side_y = rail.origin[0] + contact.y_rail * cos_r - contact.z_rail * sin_r;
    let z = rail.origin[1] + contact.y_rail * sin_r + contact.z_rail * cos_r;
    let y = sigma * side_y;
    // On an inclined surface a yawed wheel touches ahead of the axle (flange side outwards-yawed): the normal of
    // its surface of revolution has no forward component where sin(eps) = tan(yaw) tan(gamma).
    let (rolling, tan_g, tan_psi) =
        (radius + contact.z_wheel, sin_g / cos_g, k.R_TB[(1, 0)] / k.R_TB[(0, 0)]);
    let across = y - q[1];
    // The wheel itself stands behind or ahead of the axle's centre, turned there by yaw with the axle.
    let ahead = Vec3::new(rolling * sigma * tan_psi * tan_g - across * tan_psi, across, z - q[2]);
    let v_wheel = k.v_T + w_T.cross(&ahead);
    // Where the rail turns, falls or rises, the normals meet elsewhere again. The surface's own rate of approach does
    // not depend on it: it is taken against a surface that moves with those slopes.
    let back = Vec3::new(-rolling * (rail.slope[0] * tan_g + rail.slope[1]), 0.0, 0.0);

    let v_rail = Vec3::new(0.0, track.vy - track.vphi * z, track.vz + track.vphi * y);
    let slip = v_wheel + w_T.cross(&back) - v_rail;
    let slip_t = slip.dot(&e_t);
    let surface = Vec3::new(0.0, sigma * rail.surface_velocity[0], rail.surface_velocity[1]);
    let spin_axis = Vec3::new(0.0, sin_g, sigma * cos_g); // e_x x e_t
    let spin = (w_T - Vec3::new(track.vphi, 0.0, 0.0)).dot(&spin_axis);
    PlacedContact {
        lever: ahead + back,
        point: [y, z],
        e_t,
        e_n,
        penetration: contact.penetration * tilt.1,
        approach_rate: -(v_wheel - surface).dot(&e_n),
        slip: [slip.x, slip_t],
        creepage: Creepage { xi: slip.x / speed, eta: slip_t / speed, phi: spin / speed },
    }
}
