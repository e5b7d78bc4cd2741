//! Motion of a body as force elements see it, and what they do to it.

use crate::math::{Mat3, Vec3};

/// Motion of the frame that a connection is fixed to, in inertial axes. For a wheelset this is the axle box,
/// which does not turn with the axle.
#[derive(Debug, Clone, Copy)]
pub struct Pose {
    /// Centre of mass, m.
    pub r: Vec3,
    /// Body axes to inertial axes.
    pub R: Mat3,
    /// Velocity of the centre of mass, m/s.
    pub v: Vec3,
    /// Angular velocity of the frame, rad/s.
    pub w: Vec3,
}

impl Pose {
    /// At rest, unturned, at `r`.
    #[must_use]
    pub fn at(r: Vec3) -> Self {
        Self { r, R: Mat3::identity(), v: Vec3::zeros(), w: Vec3::zeros() }
    }
}

/// Force (N) and moment about a body's centre of mass (N m), inertial axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench {
    /// Force, N.
    pub f: Vec3,
    /// Moment about the centre of mass, N m.
    pub m: Vec3,
}

impl Wrench {
    /// No force, no moment.
    #[must_use]
    pub fn zero() -> Self {
        Self { f: Vec3::zeros(), m: Vec3::zeros() }
    }

    /// Adds a force `f` acting at `lever` from the centre of mass.
    #[inline(always)]
    pub fn add_force(&mut self, f: &Vec3, lever: &Vec3) {
        self.f += f;
        self.m += lever.cross(f);
    }
}

impl std::ops::AddAssign for Wrench {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.f += other.f;
        self.m += other.m;
    }
}

/// Motion of body B as seen from body A, in A's axes: all that a force between the two can depend on.
#[derive(Debug, Clone, Copy)]
pub struct Relative {
    /// B's centre of mass from A's, m.
    pub r_AB: Vec3,
    /// B's axes to A's axes.
    pub R_AB: Mat3,
    /// Rate of `r_AB` as A sees it, m/s.
    pub v_AB: Vec3,
    /// Angular velocity of B against A, rad/s.
    pub w_AB: Vec3,
}

impl Relative {
    /// Of two bodies.
    #[inline(always)]
    #[must_use]
    pub fn between(a: &Pose, b: &Pose) -> Self {
        let apart = b.r - a.r;
        Self {
            r_AB: a.R.tr_mul(&apart),
            R_AB: a.R.tr_mul(&b.R),
            v_AB: a.R.tr_mul(&(b.v - a.v - a.w.cross(&apart))),
            w_AB: a.R.tr_mul(&(b.w - a.w)),
        }
    }
}
