//! Direct contact search: where a wheelset touches its rails, without a table.
//!
//! This is what the tables of [`crate::contact::geometry_table`] are measured against, what EN 15302 asks for
//! ([`crate::contact::conicity`]) and where patches that are no ellipses start ([`Side::gap_profile`]).
//!
//! **Outline.** The rail is a cylinder along x. Seen along x, a yawed wheel is the outline of its surface of revolution: on the circle of every
//! station (radius r, slope r' = dz/dy) the point whose normal has no x-component, `cos(psi) sin(t) + sin(psi) (r' cos(phi) + sin(phi) cos(t)) = 0`
//! with t the angle from the lowest point (the trace method: K. Wang, *The track of wheel contact points and the calculation of wheel/rail
//! geometric contact parameters*, J. Southwest Jiaotong Univ. 19 (1984) 89). Contact in space so becomes contact of two plane curves, exactly, for any
//! yaw and roll; the x of the point is where the contact leads or trails the axle.
//!
//! **Rigid contact.** The vertical gap of outline and rail (rail axes) has minima where the two tangents are parallel: these are the
//! candidates, at most [`MAX_CONTACTS`] of them. The least of them touches.
//!
//! **Elastic contact.** The wheel lowered beyond touching interpenetrates the rail; each connected stretch is one patch, at most
//! [`MAX_CONTACTS`]. Its approach is the greatest normal interpenetration, its curvatures those of the gap about the
//! patch, and Hertz gives the load. [`Pressed::patches`] say by `spread` how far from Hertz's assumption (constant curvature
//! across the patch) they are.
//!
//! Side coordinates: y outward from the track centre, z down, angles as everywhere in [`crate::contact`].

use crate::contact::geometry_table::{Placement, check, place_rail};
use crate::contact::profile::{Profile, Station};
use crate::contact::{hertz, kalker_table};
use crate::error::Result;

/// Most contacts of one wheel that are told apart.
pub const MAX_CONTACTS: usize = 3;
/// Steepest contact angle for which vertical and normal distances are still told apart, rad.
const STEEPEST_CONTACT: f64 = 1.45;
/// Minima of the gap closer than this along the wheel are one contact, m.
const SEPARATE: f64 = 0.5e-3;
/// Contact angle from which a contact counts as one of the flange, rad.
pub const FLANGE_ANGLE: f64 = 0.35;
/// Share of the approach to which the undeformed surfaces interpenetrate about as wide as the pressed patch (W. Kik, J. Piotrowski, 2nd Mini
/// Conference on Contact Mechanics, Budapest 1996: 0.55; 0.5 for a circle by Hertz).
pub const VIRTUAL: f64 = 0.55;
/// Greatest `spread` for which a patch passes as one of Hertz: up to 0.2 the load at a given approach is CONTACT's within 1.5 per cent (Manchester case ), at
/// 0.46 it is 9 per cent less, at 0.68 20 per cent.
pub const HERTZ_SPREAD: f64 = 0.25;

/// Position of a wheelset as the wheel of one side sees it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Pose {
    /// Outward shift of the axle's centre, m.
    pub y: f64,
    /// Depth of the axle's centre below its nominal height, one nominal radius above the top of the rail, m.
    pub z: f64,
    /// Roll, lowering the field side, rad.
    pub roll: f64,
    /// Yaw, turning the field side backward (as in every side coordinate: right-handed on the right), rad.
    pub yaw: f64,
}

/// How far a rail has left its place, side coordinates.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RailShift {
    /// Outward, m: half of a gauge widening, and the rail's own movement.
    pub y: f64,
    /// Down, m.
    pub z: f64,
    /// Roll about the rail's origin, lowering the field side, rad.
    pub roll: f64,
}

/// Part of the wheel that touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Contact angle below [`FLANGE_ANGLE`].
    Tread,
    /// Steeper, down to the flange tip.
    Flange,
    /// Beyond the tip.
    FlangeBack,
}

/// One place where wheel and rail touch or are closest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Part of the wheel.
    pub part: Part,
    /// Gap along the common normal, m; negative: interpenetration.
    pub gap: f64,
    /// On the rail, rail axes: y outward from its origin, z down from its top, m.
    pub rail: [f64; 2],
    /// On the wheel, wheel axes: y outward from the tape circle, z below it (greater radius), m.
    pub wheel: [f64; 2],
    /// Along the rail ahead of the axle's centre, m.
    pub ahead: f64,
    /// Contact angle against the rail axes, rad, positive on the flange side.
    pub angle: f64,
    /// Relative curvature along the rail, 1/m.
    pub k_xx: f64,
    /// Relative twist of the surfaces in the contact plane, 1/m: zero without yaw.
    pub k_xy: f64,
    /// Relative curvature across, 1/m: that of the surfaces, `k_yy - k_xy^2/k_xx` that of the outlines.
    pub k_yy: f64,
}

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

/// The search cannot answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoContact {
    /// No station of the wheel is above the rail: it stands beside it.
    #[error("no part of the wheel stands over the rail")]
    BesideTheRail,
    /// The closest place is an end of a profile: what lies beyond is not known.
    #[error(
        "the wheel would stand on the end of its {profile} profile (y = {:.1} mm): the profile is too short, or the wheel has left the rail",
        1e3 * y
    )]
    EndOfProfile {
        /// "wheel" or "rail".
        profile: &'static str,
        /// Place on that profile, m.
        y: f64,
    },
    /// A pose that is not a number, or beyond 0.5 m or 0.5 rad.
    #[error("a wheelset at {0:?} is nowhere near the track")]
    Nowhere(Pose),
    /// The load cannot be carried.
    #[error("a load of {0} N: not a positive number that these profiles can carry")]
    Load(f64),
}

/// One wheel on one rail.
#[derive(Debug, Clone, PartialEq)]
pub struct Side {
    wheel: Profile,
    /// dz/dy of the wheel's stations
    slopes: Vec<f64>,
    tip: f64,
    rail: Profile,
    rail_origin_y: f64,
    placement: Placement,
}

/// Point of the outline, rail axes.
#[derive(Clone, Copy)]
struct Outline {
    station: usize,
    x: f64,
    y: f64,
    z: f64,
    direction: f64,
    /// rail less outline, vertically; infinite where there is no rail
    gap: f64,
}

impl Side {
    /// A wheel over a rail (upright as drawn; inclined and placed here).
    ///
    /// # Errors
    /// As [`crate::contact::geometry_table::GeometryTable::build`].
    pub fn new(wheel: &Profile, rail: &Profile, placement: &Placement) -> Result<Self> {
        check(wheel, rail, placement)?;
        let (rail, rail_origin_y) = place_rail(rail, placement)?;
        Ok(Self {
            slopes: wheel.stations().iter().map(|s| s.direction.tan()).collect(),
            tip: tip(wheel),
            wheel: wheel.clone(),
            rail,
            rail_origin_y,
            placement: *placement,
        })
    }

    /// How the pair was placed.
    #[must_use]
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// Distance of the rail's origin from the track centre at nominal gauge, m.
    #[must_use]
    pub fn rail_origin_y(&self) -> f64 {
        self.rail_origin_y
    }

    /// The rail as it stands: inclined, its highest point at z = 0.
    #[must_use]
    pub fn rail(&self) -> &Profile {
        &self.rail
    }

    /// The wheel, its running circle at the origin.
    #[must_use]
    pub fn wheel(&self) -> &Profile {
        &self.wheel
    }

    fn outline(&self, pose: &Pose, rail: &RailShift) -> std::result::Result<Vec<Outline>, NoContact> {
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

    /// Curvatures of the wheel in the contact plane (convex positive), along x, mixed, across.
    fn wheel_curvature(&self, pose: &Pose, direction: f64, curvature: f64, z: f64) -> (f64, f64, f64) {
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

    fn minima(&self, points: &[Outline], pose: &Pose) -> Vec<Touch> {
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

/// y of the flange tip: the lowest station at negative y.
fn tip(wheel: &Profile) -> f64 {
    let lowest = wheel.stations().iter().filter(|s| s.y < 0.0).max_by(|a, b| a.z.total_cmp(&b.z));
    lowest.map_or(f64::NEG_INFINITY, |s| if s.direction.abs() < 0.2 { s.y } else { f64::NEG_INFINITY })
}

/// cos of the angle by which normal and vertical differ.
fn vertical(touch: &Touch) -> f64 {
    touch.angle.abs().min(STEEPEST_CONTACT).cos()
}

fn part(angle: f64, back: bool) -> Part {
    if back {
        Part::FlangeBack
    } else if angle > FLANGE_ANGLE {
        Part::Flange
    } else {
        Part::Tread
    }
}

/// Cubic through two points of the outline with their tangents.
fn hermite(p: &Outline, q: &Outline, t: f64) -> (f64, f64) {
    let y = p.y + t * (q.y - p.y);
    let h = q.y - p.y;
    let tangent = |direction: f64| direction.clamp(-1.55, 1.55).tan() * h;
    (y, cubic(p.z, tangent(p.direction), q.z, tangent(q.direction), t))
}

fn station_z(a: &Station, b: &Station, t: f64) -> f64 {
    let h = b.y - a.y;
    cubic(a.z, a.direction.tan() * h, b.z, b.direction.tan() * h, t)
}

fn cubic(z0: f64, m0: f64, z1: f64, m1: f64, t: f64) -> f64 {
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

/// Means over a patch.
struct Mean {
    centre: Touch,
    reach: [f64; 2],
    curvature: f64,
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

/// Principal curvatures, that nearer to the first axis first; the smaller one bounded from below where surfaces conform.
fn principal(k_xx: f64, k_xy: f64, k_yy: f64) -> [f64; 2] {
    let (mean, half) = (0.5 * (k_xx + k_yy), (0.5 * (k_xx - k_yy)).hypot(k_xy));
    let floor = 1e-3 * (mean + half).abs().max(1e-3);
    let (large, small) = ((mean + half).max(floor), (mean - half).max(floor));
    if k_xx >= k_yy { [large, small] } else { [small, large] }
}
