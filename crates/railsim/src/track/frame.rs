//! The track-following frame T.

use crate::math::angle::SinCos;
use crate::math::{Mat3, Vec3};

/// Track-following frame T at one arc length s of the design line: origin on the centre line at top of rail, x along
/// the line, y to the right in the plane of the rails, z down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Origin, inertial axes, m. d(r_IT)/ds = R_IT e_x.
    pub r_IT: Vec3,
    /// Axes of T in the inertial frame: `R_IT = Rz(heading) Ry(gradient) Rx(cant)`. d(R_IT)/ds = R_IT skew(k_T).
    pub R_IT: Mat3,
    /// Rotation of T per metre of s, in T, rad/m: (twist, vertical curvature, curvature) to first order.
    pub k_T: Vec3,
}

/// Angles of the frame as sine and cosine with their changes along s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Attitude {
    /// Sine and cosine of heading (+ right), gradient (+ uphill) and cant (+ right rail lower).
    pub heading: SinCos,
    pub gradient: SinCos,
    pub cant: SinCos,
    /// First derivatives of the three angles with respect to s, rad/m.
    pub first: [f64; 3],
}

impl Frame {
    /// Straight level track along inertial x from the inertial origin.
    #[inline]
    pub(super) fn level(s: f64) -> Self {
        Self { r_IT: Vec3::new(s, 0.0, 0.0), R_IT: Mat3::identity(), k_T: Vec3::zeros() }
    }

    /// The straight line that leaves this frame along its own x.
    pub(super) fn straight_on(&self, distance: f64) -> Self {
        let r_IT = self.r_IT + self.R_IT.column(0) * distance;
        Self { r_IT, R_IT: self.R_IT, k_T: Vec3::zeros() }
    }
}

impl Attitude {
    /// Unit vector along the line, inertial axes.
    pub fn direction(heading: SinCos, gradient: SinCos) -> Vec3 {
        Vec3::new(heading.1 * gradient.1, heading.0 * gradient.1, -gradient.0)
    }

    /// The frame with origin `r_IT`.
    pub fn frame(&self, r_IT: Vec3) -> Frame {
        let (sh, ch) = self.heading;
        let (sg, cg) = self.gradient;
        let (sc, cc) = self.cant;
        let R_IT = Mat3::new(
            ch * cg,
            ch * sg * sc - sh * cc,
            ch * sg * cc + sh * sc,
            sh * cg,
            sh * sg * sc + ch * cc,
            sh * sg * cc - ch * sc,
            -sg,
            cg * sc,
            cg * cc,
        );
        // k_T = e_x c' + Rx(-c) [e_y g' + Ry(-g) e_z h'].
        let [h1, g1, c1] = self.first;
        let k_T = Vec3::new(c1 - h1 * sg, g1 * cc + h1 * sc * cg, -g1 * sc + h1 * cc * cg);
        Frame { r_IT, R_IT, k_T }
    }
}
