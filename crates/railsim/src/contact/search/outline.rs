//! The outline of a yawed wheel: the curve along which its surface of revolution is seen from along the rail.

use super::{NoContact, Pose, RailShift, Side};
use crate::contact::profile::Station;

/// Point of the outline, rail axes.
#[derive(Clone, Copy)]
pub(super) struct Outline {
    pub(super) station: usize,
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
    pub(super) direction: f64,
    /// rail less outline, vertically; infinite where there is no rail
    pub(super) gap: f64,
}

impl Side {
    pub(super) fn outline(
        &self,
        pose: &Pose,
        rail: &RailShift,
    ) -> std::result::Result<Vec<Outline>, NoContact> {
        let near = |x: f64| x.abs() <= 0.5;
        let all = [pose.y, pose.z, pose.roll, pose.yaw, rail.y, rail.z, rail.roll];
        if !all.into_iter().all(near) {
            return Err(NoContact::Nowhere(*pose));
        }
        let half = self.placement.tape_half_distance;
        let radius = self.placement.wheel_radius;
        let ((sp, cp), (sr, cr)) = (pose.yaw.sin_cos(), pose.roll.sin_cos());
        let (s0, c0) = rail.roll.sin_cos();
        let trace = Trace::new(sp, cp, sr, cr);
        let mut points = Vec::with_capacity(self.wheel.stations().len());
        for (station, (s, &slope)) in self.wheel.stations().iter().zip(&self.slopes).enumerate() {
            let Some((sin, cos)) = trace.angle(slope) else { continue };
            let r = radius + s.z;
            let (x1, y1, z1) = (r * sin, half + s.y, r * cos);
            let across = y1 * cr - z1 * sr;
            let y = pose.y + sp * x1 + cp * across - self.rail_origin_y - rail.y;
            let z = pose.z - radius + y1 * sr + z1 * cr - rail.z;
            let [ny, nz] = trace.normal(slope, sin, cos);
            let (ny, nz) = (ny * c0 + nz * s0, nz * c0 - ny * s0);
            if nz <= 0.0 {
                continue;
            }
            let (y, z) = (y * c0 + z * s0, z * c0 - y * s0);
            let gap = self.rail.z(y).map_or(f64::INFINITY, |rail| rail - z);
            points.push(Outline { station, x: cp * x1 - sp * across, y, z, direction: (-ny).atan2(nz), gap });
        }
        if points.iter().any(|p| p.gap.is_finite()) { Ok(points) } else { Err(NoContact::BesideTheRail) }
    }

    /// Curvatures of the wheel in the contact plane (convex positive), along x, mixed, across.
    pub(super) fn wheel_curvature(
        &self,
        pose: &Pose,
        direction: f64,
        curvature: f64,
        z: f64,
    ) -> (f64, f64, f64) {
        let meridian = -curvature;
        let around = direction.cos() / (self.placement.wheel_radius + z);
        // x-component of the meridian's tangent
        let (sp, cp) = pose.yaw.sin_cos();
        let (sr, cr) = pose.roll.sin_cos();
        let slope = direction.tan();
        let trace = Trace::new(sp, cp, sr, cr);
        let (sin, cos) = trace.angle(slope).unwrap_or((0.0, 1.0));
        let t = [slope * sin, 1.0, slope * cos];
        let turn = (cp * t[0] - sp * (t[1] * cr - t[2] * sr)) / (1.0 + slope * slope).sqrt();
        let turn = turn.clamp(-1.0, 1.0);
        let (s2, c2) = (turn * turn, 1.0 - turn * turn);
        (around * c2 + meridian * s2, (meridian - around) * turn * c2.sqrt(), around * s2 + meridian * c2)
    }
}

/// Cubic through two points of the outline with their tangents.
pub(super) fn hermite(p: &Outline, q: &Outline, t: f64) -> (f64, f64) {
    let y = p.y + t * (q.y - p.y);
    let h = q.y - p.y;
    let tangent = |direction: f64| direction.clamp(-1.55, 1.55).tan() * h;
    (y, cubic(p.z, tangent(p.direction), q.z, tangent(q.direction), t))
}

pub(super) fn station_z(a: &Station, b: &Station, t: f64) -> f64 {
    let h = b.y - a.y;
    cubic(a.z, a.direction.tan() * h, b.z, b.direction.tan() * h, t)
}

pub(super) fn cubic(z0: f64, m0: f64, z1: f64, m1: f64, t: f64) -> f64 {
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * z0 + (t3 - 2.0 * t2 + t) * m0 + (3.0 * t2 - 2.0 * t3) * z1 + (t3 - t2) * m1
}

/// Where the outline of a yawed and rolled wheel lies on the circle of a station.
struct Trace {
    sp: f64,
    cp: f64,
    sr: f64,
    cr: f64,
    norm: f64,
    base: f64,
}

impl Trace {
    fn new(sp: f64, cp: f64, sr: f64, cr: f64) -> Self {
        let b = sp * sr;
        Self { sp, cp, sr, cr, norm: cp.hypot(b), base: b.atan2(cp) }
    }

    /// Sine and cosine of the angle from the lowest point of the circle, forward positive; `None` where the normal cannot
    /// be without an x-component.
    fn angle(&self, slope: f64) -> Option<(f64, f64)> {
        let target = -self.sp * self.cr * slope / self.norm;
        (target.abs() < 1.0).then(|| (target.asin() - self.base).sin_cos())
    }

    /// The normal there, y and z in track axes, not of unit length.
    fn normal(&self, slope: f64, sin: f64, cos: f64) -> [f64; 2] {
        let (x, y, z) = (sin, -slope, cos);
        [self.sp * x + self.cp * (y * self.cr - z * self.sr), y * self.sr + z * self.cr]
    }
}
