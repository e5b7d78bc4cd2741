//! Elastic contact: patches of a wheel lowered into its rail, and the load that they carry.

use super::outline::Outline;
use super::{MAX_CONTACTS, NoContact, Pose, RailShift, STEEPEST_CONTACT, Side, Touch, part};
use crate::contact::{hertz, kalker_table};

/// Share of the approach to which the undeformed surfaces interpenetrate about as wide as the pressed patch (W. Kik, J. Piotrowski, 2nd Mini
/// Conference on Contact Mechanics, Budapest 1996: 0.55; 0.5 for a circle by Hertz).
pub const VIRTUAL: f64 = 0.55;
/// Greatest `spread` for which a patch passes as one of Hertz: up to 0.2 the load at a given approach is CONTACT's within 1.5 per cent (Manchester case ), at
/// 0.46 it is 9 per cent less, at 0.68 20 per cent.
pub const HERTZ_SPREAD: f64 = 0.25;

/// One patch of a wheel under load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Where the interpenetration is greatest; its gap is minus the approach.
    pub deepest: Touch,
    /// Centre of the patch: positions and angle averaged over the stretch with the interpenetration left of
    /// [`VIRTUAL`] times the approach as weight, as the force of its strips is distributed.
    pub centre: Touch,
    /// From the deepest point along the contact plane to where the virtual interpenetration ends, m: inward (negative), outward.
    pub reach: [f64; 2],
    /// Relative lateral curvature that the load was computed with, 1/m.
    pub curvature: f64,
    /// How far from an ellipse: (b+ - b-)/(b+ + b-) of the two reaches, and how far the mean width differs from
    /// that of the local curvature (whichever is greater, 0 for Hertz).
    pub spread: f64,
    /// Normal force, N.
    pub normal: f64,
    /// Semi-axis along rolling, m.
    pub a: f64,
    /// Semi-axis across, m.
    pub b: f64,
    /// Kalker's C11, C22, C23 for a/b.
    pub kalker: [f64; 3],
}

impl Patch {
    /// Whether Hertz's assumption holds ([`HERTZ_SPREAD`]).
    #[must_use]
    pub fn is_hertzian(&self) -> bool {
        self.spread <= HERTZ_SPREAD
    }
}

/// A wheel under load.
#[derive(Debug, Clone, PartialEq)]
pub struct Pressed {
    /// The pose with the depth at which the load is carried.
    pub pose: Pose,
    /// Patches from the field side to the flange.
    pub patches: Vec<Patch>,
}

impl Side {
    /// Patches at a pose with its depth, from the field side to the flange; none where the wheel hangs above the rail.
    ///
    /// # Errors
    /// [`NoContact`]; an end of a profile is refused where a patch would reach its greatest interpenetration there.
    pub fn patches(&self, pose: &Pose, rail: &RailShift) -> std::result::Result<Vec<Patch>, NoContact> {
        let points = self.outline(pose, rail)?;
        let depth = |p: &Outline| -p.gap * p.direction.abs().min(STEEPEST_CONTACT).cos();
        let mut out: Vec<Patch> = Vec::with_capacity(MAX_CONTACTS);
        let mut k = 0;
        while k < points.len() {
            if depth(&points[k]) <= 0.0 {
                k += 1;
                continue;
            }
            let first = k;
            while k < points.len() && depth(&points[k]) > 0.0 {
                k += 1;
            }
            out.push(self.patch(&points, first, k, pose)?);
        }
        out.sort_by(|a, b| b.normal.total_cmp(&a.normal));
        out.truncate(MAX_CONTACTS);
        out.sort_by(|a, b| b.centre.wheel[0].total_cmp(&a.centre.wheel[0]));
        Ok(out)
    }

    /// The patch over the interpenetrating stations `first..end` of the outline.
    fn patch(
        &self,
        points: &[Outline],
        first: usize,
        end: usize,
        pose: &Pose,
    ) -> std::result::Result<Patch, NoContact> {
        // The deepest true minimum of the stretch (of up to a few in a conforming one).
        let from = first.saturating_sub(1);
        let to = (end + 1).min(points.len());
        let deepest = self.minima(&points[from..to], pose).into_iter().min_by(|a, b| a.gap.total_cmp(&b.gap));
        let Some(deepest) = deepest else {
            let p = points[first];
            let s = self.wheel.stations()[p.station];
            let of_wheel = p.station == 0 || points[end - 1].station + 1 == self.wheel.stations().len();
            return Err(if of_wheel {
                NoContact::EndOfProfile { profile: "wheel", y: s.y }
            } else {
                NoContact::EndOfProfile { profile: "rail", y: p.y }
            });
        };
        let approach = -deepest.gap;
        let mean = self.averaged(&points[from..to], &deepest, VIRTUAL * approach);
        let k_yy = mean.curvature + deepest.k_xy * deepest.k_xy / deepest.k_xx;
        let (modulus, poisson) = (
            hertz::effective_modulus(self.placement.youngs_modulus, self.placement.poisson),
            self.placement.poisson,
        );
        let [along, across] = principal(deepest.k_xx, deepest.k_xy, k_yy);
        let h = hertz::solve(along, across, modulus);
        let normal = h.stiffness * approach.powf(1.5);
        let (a, b) = (h.a1 * normal.cbrt(), h.b1 * normal.cbrt());
        let kalker = kalker_table::coefficients(a / b, poisson);
        let local = (deepest.k_yy - deepest.k_xy * deepest.k_xy / deepest.k_xx).max(0.0);
        let [inward, outward] = mean.reach;
        Ok(Patch {
            deepest,
            centre: mean.centre,
            reach: mean.reach,
            curvature: mean.curvature,
            spread: ((outward + inward) / (outward - inward))
                .abs()
                .max(((local / mean.curvature).sqrt() - 1.0).abs()),
            normal,
            a,
            b,
            kalker: [kalker.c11, kalker.c22, kalker.c23],
        })
    }

    /// Means over a stretch with the virtual interpenetration as weight, and the curvature of the parabola that has the same area of it.
    fn averaged(&self, points: &[Outline], deepest: &Touch, depth: f64) -> Mean {
        let lost = -deepest.gap - depth;
        let (sin, cos) = deepest.angle.sin_cos();
        let along = |p: &Outline| (p.y - deepest.rail[0]) * cos - (p.z - deepest.rail[1]) * sin;
        let stations = self.wheel.stations();
        let (mut area, mut sum) = (0.0, [0.0; 6]);
        let mut reach = [0.0_f64; 2];
        let left = |p: &Outline| -p.gap * p.direction.abs().min(STEEPEST_CONTACT).cos() - lost;
        for pair in points.windows(2) {
            let (p, q) = (&pair[0], &pair[1]);
            let (wp, wq) = (left(p), left(q));
            if wp.max(wq) <= 0.0 || !(p.gap.is_finite() && q.gap.is_finite()) {
                continue;
            }
            // the part of the step that is inside, and the values in its middle
            let (t0, t1) =
                (if wp < 0.0 { wp / (wp - wq) } else { 0.0 }, if wq < 0.0 { wp / (wp - wq) } else { 1.0 });
            let t = 0.5 * (t0 + t1);
            let mix = |a: f64, b: f64| a + t * (b - a);
            let ends = [along(p) + t0 * (along(q) - along(p)), along(p) + t1 * (along(q) - along(p))];
            reach = [reach[0].min(ends[0]), reach[1].max(ends[1])];
            let w = mix(wp, wq).max(0.0) * (ends[1] - ends[0]).abs();
            area += w;
            let y = mix(p.y, q.y);
            let (a, b) = (&stations[p.station], &stations[q.station]);
            let direction = self.rail.local(y).map_or(mix(p.direction, q.direction), |l| l.direction);
            let values = [
                y,
                self.rail.z(y).unwrap_or(mix(p.z, q.z)),
                mix(a.y, b.y),
                mix(a.z, b.z),
                mix(p.x, q.x),
                -0.5 * (mix(p.direction, q.direction) + direction),
            ];
            for (s, v) in sum.iter_mut().zip(values) {
                *s += w * v;
            }
        }
        if area <= 0.0 {
            // narrower than a station
            let curvature = (deepest.k_yy - deepest.k_xy * deepest.k_xy / deepest.k_xx).max(1e-3);
            let b = (2.0 * depth / curvature).sqrt();
            return Mean { centre: *deepest, reach: [-b, b], curvature };
        }
        let [y_rail, z_rail, y_wheel, z_wheel, ahead, angle] = sum.map(|s| s / area);
        let curvature = 2.0 * depth * (4.0 / 3.0 * depth / area).powi(2);
        let centre = Touch {
            part: part(angle, y_wheel < self.tip),
            rail: [y_rail, z_rail],
            wheel: [y_wheel, z_wheel],
            ahead,
            angle,
            ..*deepest
        };
        Mean { centre, reach, curvature }
    }

    /// Presses the wheel down until its patches carry a vertical load (N, without friction).
    ///
    /// # Errors
    /// [`NoContact`]; a load that is not positive.
    pub fn press(&self, pose: &Pose, rail: &RailShift, load: f64) -> std::result::Result<Pressed, NoContact> {
        self.press_by(pose, rail, load, |patch| patch.normal * (patch.centre.angle - rail.roll).cos())
    }

    /// The same with the vertical force of a patch given by `carried` (friction in it): it has to grow with the patch's normal force.
    ///
    /// # Errors
    /// As [`Side::press`].
    pub fn press_by(
        &self,
        pose: &Pose,
        rail: &RailShift,
        load: f64,
        carried: impl Fn(&Patch) -> f64,
    ) -> std::result::Result<Pressed, NoContact> {
        if !(load.is_finite() && load > 0.0) {
            return Err(NoContact::Load(load));
        }
        let least = self.gap(pose, rail)?;
        let at = |depth: f64| -> std::result::Result<(Pressed, f64), NoContact> {
            let pose = Pose { z: pose.z + least + depth, ..*pose };
            let patches = self.patches(&pose, rail)?;
            let carried = patches.iter().map(&carried).sum::<f64>() - load;
            Ok((Pressed { pose, patches }, carried))
        };
        let (mut low, mut high) = ((0.0, -load), 20e-6);
        let mut found = at(high)?;
        while found.1 < 0.0 {
            low = (high, found.1);
            high *= 2.0;
            if high > 0.01 {
                return Err(NoContact::Load(load));
            }
            found = at(high)?;
        }
        // regula falsi with Illinois' weights, safeguarded
        let mut above = (high, found.1);
        let mut side = 0;
        for _ in 0..60 {
            if found.1.abs() < 1e-9 * load || above.0 - low.0 < 1e-15 {
                break;
            }
            let x = (low.0 * above.1 - above.0 * low.1) / (above.1 - low.1);
            found = at(x)?;
            if found.1 < 0.0 {
                low = (x, found.1);
                if side == -1 {
                    above.1 *= 0.5;
                }
                side = -1;
            } else {
                above = (x, found.1);
                if side == 1 {
                    low.1 *= 0.5;
                }
                side = 1;
            }
        }
        Ok(found.0)
    }
}

/// Means over a patch.
struct Mean {
    centre: Touch,
    reach: [f64; 2],
    curvature: f64,
}

/// Principal curvatures, that nearer to the first axis first; the smaller one bounded from below where surfaces conform.
fn principal(k_xx: f64, k_xy: f64, k_yy: f64) -> [f64; 2] {
    let (mean, half) = (0.5 * (k_xx + k_yy), (0.5 * (k_xx - k_yy)).hypot(k_xy));
    let floor = 1e-3 * (mean + half).abs().max(1e-3);
    let (large, small) = ((mean + half).max(floor), (mean - half).max(floor));
    if k_xx >= k_yy { [large, small] } else { [small, large] }
}
