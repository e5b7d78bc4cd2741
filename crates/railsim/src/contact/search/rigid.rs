//! Rigid contact: the places where a wheel is closest to its rail.

use super::outline::{Outline, hermite, station_z};
use super::{MAX_CONTACTS, NoContact, Pose, RailShift, Side, Touch, part, vertical};

/// Minima of the gap closer than this along the wheel are one contact, m.
const SEPARATE: f64 = 0.5e-3;

impl Side {
    /// Refined minimum of the gap between stations `k` and `k + 1` of the outline at part `t`.
    fn touch(&self, points: &[Outline], pose: &Pose, k: usize, t: f64) -> Touch {
        let (p, q) = (&points[k], &points[(k + 1).min(points.len() - 1)]);
        let mix = |a: f64, b: f64| a + t * (b - a);
        let (y, z) = hermite(p, q, t);
        let stations = self.wheel.stations();
        let (a, b) = (&stations[p.station], &stations[q.station]);
        let direction = mix(p.direction, q.direction);
        let local = self.rail.local(y);
        let rail_z = self.rail.z(y).unwrap_or(z + p.gap);
        let wheel = [mix(a.y, b.y), station_z(a, b, t)];
        let (k_xx, k_xy, k_wheel) = self.wheel_curvature(
            pose,
            mix(a.direction, b.direction),
            mix(a.curvature, b.curvature),
            wheel[1],
        );
        let back = wheel[0] < self.tip;
        let rail_direction = local.map_or(direction, |l| l.direction);
        let angle = -0.5 * (direction + rail_direction);
        let mut touch = Touch {
            part: part(angle, back),
            gap: 0.0,
            rail: [y, rail_z],
            wheel,
            ahead: mix(p.x, q.x),
            angle,
            k_xx,
            k_xy,
            k_yy: k_wheel + local.map_or(0.0, |l| l.curvature),
        };
        // By the same angle that turns it back into a vertical gap: at a kink wheel and rail have not one tangent.
        touch.gap = (rail_z - z) * vertical(&touch);
        touch
    }

    /// Places where the wheel is closest to the rail, at most [`MAX_CONTACTS`], in the order in which a wheel that is lowered touches
    /// them (by rising vertical gap).
    ///
    /// # Errors
    /// [`NoContact`]: beside the rail, or the closest place is the end of a profile.
    pub fn closest(&self, pose: &Pose, rail: &RailShift) -> std::result::Result<Vec<Touch>, NoContact> {
        let points = self.outline(pose, rail)?;
        let mut found = self.minima(&points, pose);
        self.refuse_ends(&points, found.iter().map(|f| f.gap / vertical(f)).fold(f64::INFINITY, f64::min))?;
        found.sort_by(|a, b| (a.gap / vertical(a)).total_cmp(&(b.gap / vertical(b))));
        let mut out: Vec<Touch> = Vec::with_capacity(MAX_CONTACTS);
        for touch in found {
            let apart = |other: &Touch| {
                (other.wheel[0] - touch.wheel[0]).hypot(other.wheel[1] - touch.wheel[1]) > SEPARATE
            };
            if out.len() < MAX_CONTACTS && out.iter().all(apart) {
                out.push(touch);
            }
        }
        Ok(out)
    }

    /// Smallest vertical gap at a pose, m: how far the wheel may be lowered until it touches.
    ///
    /// # Errors
    /// As [`Side::closest`].
    pub fn gap(&self, pose: &Pose, rail: &RailShift) -> std::result::Result<f64, NoContact> {
        self.closest(pose, rail)?
            .iter()
            .map(|t| t.gap / vertical(t))
            .min_by(f64::total_cmp)
            .ok_or(NoContact::BesideTheRail)
    }

    pub(super) fn minima(&self, points: &[Outline], pose: &Pose) -> Vec<Touch> {
        // slope of the gap over y
        let slope =
            |p: &Outline| self.rail.slope(p.y).map(|slope| slope - p.direction.clamp(-1.55, 1.55).tan());
        let mut out = Vec::new();
        for k in 1..points.len().saturating_sub(1) {
            let (before, here, after) = (&points[k - 1], &points[k], &points[k + 1]);
            let together =
                after.station == before.station + 2 && before.gap.is_finite() && after.gap.is_finite();
            if !(together && before.gap >= here.gap && here.gap < after.gap) {
                continue;
            }
            let slopes = [before, here, after].map(|p| slope(p).unwrap_or(f64::NAN));
            let i = if slopes[1] > 0.0 { k - 1 } else { k };
            let (a, b) = if slopes[1] > 0.0 { (slopes[0], slopes[1]) } else { (slopes[1], slopes[2]) };
            // the slope turns between the two; where it does not (rounding), the station itself
            let t = if a <= 0.0 && b > 0.0 { a / (a - b) } else { (k - i) as f64 };
            out.push(self.touch(points, pose, i, t));
        }
        out
    }

    /// Refuses a smallest gap at an end of either profile: it is less than every true minimum.
    fn refuse_ends(&self, points: &[Outline], least: f64) -> std::result::Result<(), NoContact> {
        let Some(lowest) = points.iter().min_by(|a, b| a.gap.total_cmp(&b.gap)) else {
            return Err(NoContact::BesideTheRail);
        };
        // a true minimum lies at most a nanometre or so above the station beside it
        if lowest.gap > least - 1e-7 {
            return Ok(());
        }
        let stations = self.wheel.stations();
        let s = &stations[lowest.station];
        let of_wheel = lowest.station == 0 || lowest.station + 1 == stations.len();
        Err(if of_wheel {
            NoContact::EndOfProfile { profile: "wheel", y: s.y }
        } else {
            NoContact::EndOfProfile { profile: "rail", y: lowest.y }
        })
    }
}
