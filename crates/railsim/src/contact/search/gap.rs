//! The gap across a contact: what patches that are no ellipses are made of.

use super::outline::cubic;
use super::{NoContact, Pose, RailShift, Side, Touch};

/// The gap about a contact, at one place across it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GapPoint {
    /// Along the contact plane from the contact point, m, + outward (and up on the flange).
    pub s: f64,
    /// Distance of the undeformed surfaces along the normal of the contact plane, zero at first touch there, m;
    /// less than zero where they interpenetrate.
    pub gap: f64,
    /// Angle of the surfaces here against the rail axes (mean of both), rad.
    pub angle: f64,
    /// Relative curvature along the rail, 1/m.
    pub k_xx: f64,
    /// Where the strip's middle lies along the rail, ahead of the axle, m.
    pub ahead: f64,
}

impl Side {
    /// The gap of the undeformed surfaces across a contact, normal to its contact plane, every `step` (m) up to `half_width` (m) either way, as
    /// far as both profiles go: what a patch that is no ellipse is made of. The gap is counted from that at the contact
    /// itself, so it is zero there.
    ///
    /// # Errors
    /// [`NoContact`] as [`Side::closest`].
    pub fn gap_profile(
        &self,
        pose: &Pose,
        rail: &RailShift,
        touch: &Touch,
        half_width: f64,
        step: f64,
    ) -> std::result::Result<Vec<GapPoint>, NoContact> {
        let points = self.outline(pose, rail)?;
        let stations = self.wheel.stations();
        let frame = |y: f64, z: f64| {
            let (sin, cos) = touch.angle.sin_cos();
            let (dy, dz) = (y - touch.rail[0], z - touch.rail[1]);
            [dy * cos - dz * sin, dy * sin + dz * cos]
        };
        let outline: Vec<Planar> = points
            .iter()
            .map(|p| {
                let [s, n] = frame(p.y, p.z);
                let w = &stations[p.station];
                let (k_xx, _, _) = self.wheel_curvature(pose, w.direction, w.curvature, w.z);
                Planar { s, n, turn: p.direction + touch.angle, k_xx, ahead: p.x }
            })
            .collect();
        let head: Vec<Planar> = self
            .rail
            .stations()
            .iter()
            .map(|p| {
                let [s, n] = frame(p.y, p.z);
                Planar { s, n, turn: p.direction + touch.angle, k_xx: 0.0, ahead: 0.0 }
            })
            .collect();
        let (outline, head) = (single_valued(&outline), single_valued(&head));
        let count = (half_width / step).floor() as i64;
        let mut out = Vec::with_capacity(2 * count.max(0) as usize + 1);
        let zero = match (at(outline, 0.0), at(head, 0.0)) {
            (Some(w), Some(r)) => r.n - w.n,
            _ => touch.gap,
        };
        for i in -count..=count {
            let s = step * i as f64;
            if let (Some(w), Some(r)) = (at(outline, s), at(head, s)) {
                out.push(GapPoint {
                    s,
                    gap: r.n - w.n - zero,
                    angle: touch.angle - 0.5 * (w.turn + r.turn),
                    k_xx: w.k_xx,
                    ahead: w.ahead,
                });
            }
        }
        Ok(out)
    }
}

/// A curve in axes along and across a contact plane.
#[derive(Clone, Copy)]
struct Planar {
    s: f64,
    n: f64,
    turn: f64,
    k_xx: f64,
    ahead: f64,
}

/// The stretch about s = 0 along which s rises.
fn single_valued(curve: &[Planar]) -> &[Planar] {
    let nearest = (0..curve.len()).min_by(|&i, &j| {
        let far = |p: &Planar| p.s.hypot(p.n);
        far(&curve[i]).total_cmp(&far(&curve[j]))
    });
    let Some(start) = nearest else { return curve };
    let steep = |p: &Planar| p.turn.abs() > 1.45;
    let mut first = start;
    while first > 0 && curve[first - 1].s < curve[first].s && !steep(&curve[first - 1]) {
        first -= 1;
    }
    let mut last = start;
    while last + 1 < curve.len() && curve[last + 1].s > curve[last].s && !steep(&curve[last + 1]) {
        last += 1;
    }
    &curve[first..=last]
}

/// The curve at s.
fn at(curve: &[Planar], s: f64) -> Option<Planar> {
    let i = curve.partition_point(|p| p.s <= s);
    if i == 0 || i == curve.len() {
        return None;
    }
    let (p, q) = (&curve[i - 1], &curve[i]);
    let h = q.s - p.s;
    let t = (s - p.s) / h;
    let mix = |a: f64, b: f64| a + t * (b - a);
    Some(Planar {
        s,
        n: cubic(p.n, p.turn.tan() * h, q.n, q.turn.tan() * h, t),
        turn: mix(p.turn, q.turn),
        k_xx: mix(p.k_xx, q.k_xx),
        ahead: mix(p.ahead, q.ahead),
    })
}
