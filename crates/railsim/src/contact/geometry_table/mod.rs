//! Contact geometry of one wheel on one rail, reduced to a table before the run.
//!
//! **Gap.** For a lateral shift dy and a roll of the wheel against the rail (in rail axes, about the wheel's tape-circle
//! point) the vertical gap at every lateral position y is g(y) = z_rail(y) - z_wheel(y), with the tape-circle point at
//! z = 0. Lowered by dz the wheel touches where dz > g.
//!
//! **Zones.** One contact per zone of the *wheel*, tread and flange. A smooth weight chi over the wheel's
//! own contact angle divides them, 1 on the tread below [`BLEND_FROM`], 0 on the flange above [`BLEND_TO`] and from there on
//! to the flange tip. The bounds lie about where the crown of a rail (R 300, R 80) ends and its gauge corner (R 13)
//! begins: 0.22 rad on as60, 0.24 rad on UIC 60, plus or minus the inclination. Tread contacts stay below 0.15 rad (0.144 at most on S1002, 0.09 on
//! the worn anzr1), flange and root contacts lie above 0.35 rad, and rigid contact jumps from the one to the other. Where a pair leads one contact
//! through the blend, both zones see it and share it, `share` adding up to about 1; two separate contacts have share 1 each.
//!
//! **Second parts.** Where the pair touches in two places of one zone at once (root and face of a worn flange, two places of a
//! tread), that zone is cut between them ([`seam`]) and each part has its own contact: up to three at once, in four slots. Which pairs do, building the table finds out; for all
//! others it costs nothing. The back of a flange is in no table: [`SHIFT_RANGE`] outward it still stands some 10 mm clear of a running rail.
//!
//! **Quasi-elastic averages.** Rigid contact points jump from one place of nearly conforming profiles to another; the pressed patch
//! does not. Each zone's position, angle and curvature are averages over the zone with the weight
//! w = max(0, 1 - n/delta), n the normal distance beyond the zone's smallest gap and delta the interpenetration that belongs to a
//! wheel load ([`Placement::penetration_under`]; a run takes the vehicle's static one). Every stored value is thus a continuous function of dy and roll, and bilinear
//! interpolation keeps it so.
//!
//! **Curvatures.** Longitudinal 1/r cos(gamma) with r the local rolling radius (rail straight). Lateral relative curvature: the weighted
//! mean of k_rail - k_wheel; where conforming profiles make that tiny or negative it is bounded from below by half of
//! the curvature whose patch at penetration delta is as wide as the real one (32 delta/(9 W^2), W = int w ds), and by [`LEAST_CURVATURE`]. So
//! Hertz always has an ellipse, no wider than about 1.4 times the conforming stretch; pressure in a truly conformal contact is not
//! what this table is for.
//!
//! **Yaw** enters by its square, to first order, with the rates of every node. The outline of the yawed wheel stands nearer to the
//! rail by u = r sin(gamma) tan(gamma) yaw^2/2 along the normal (vertically r tan(gamma)^2 yaw^2/2), which varies along the wheel as gamma does: the
//! contact moves by u'/k along the rail, k the relative lateral curvature, at most [`YAW_TRAVEL`], and its angle with it; on the wheel it also leads by r tan(gamma) tan(yaw), whence
//! the outline's own outward shift r tan(gamma) yaw^2. [`crate::contact::search`] has yaw exactly.
//!
//! **Ends.** Where a zone would come closest to the rail at an end of either profile, nothing is known of the contact: asking for it is an
//! error ([`OutOfTable`]).

mod build;
mod gauge;
mod grid;
mod seam;
pub mod store;

pub(crate) use build::{check, place_rail};
pub use store::{Pair, Tables};

use crate::contact::hertz;
use crate::contact::profile::Profile;
use crate::contact::search::VIRTUAL;
use grid::Shifts;

/// Contact angle of the wheel up to which it is all tread, rad.
pub const BLEND_FROM: f64 = 0.15;
/// Contact angle from which on it is all flange, rad.
pub const BLEND_TO: f64 = 0.35;
/// Normal penetration of the quasi-elastic average where no load is said, m: that of some 40 kN.
pub const PENETRATION: f64 = 0.03e-3;
/// Least normal penetration of an average, m.
pub const LEAST_PENETRATION: f64 = 1e-6;
/// Greatest normal penetration of an average, m.
pub const MOST_PENETRATION: f64 = 200e-6;
/// Radius of a rail's crown for which a wheel load is turned into an approach, m.
pub const CROWN_RADIUS: f64 = 0.3;
/// Most that yaw may move a contact along the rail, m at [`YAW_FULL`].
pub const YAW_TRAVEL: f64 = 2e-3;
/// Yaw to which that bound belongs, rad.
pub const YAW_FULL: f64 = 0.02;
/// Bound of the relative lateral curvature, 1/m (a radius of 2 m).
pub const LEAST_CURVATURE: f64 = 0.5;

/// Most contacts of one wheel that a table gives: three places at once are the most that was met; one of them in a blend counts twice.
pub const MAX_CONTACTS: usize = 4;
/// Least reach of a table either way, and how far inward its nodes are [`SHIFT_STEP`] apart, m.
pub const SHIFT_RANGE: f64 = 0.020;
/// Step of the shift, m.
pub const SHIFT_STEP: f64 = 0.1e-3;
/// Step of the shift inward of [`SHIFT_RANGE`], where a wheel stands on the outer part of its tread, m.
pub const INWARD_STEP: f64 = 0.5e-3;
/// Furthest that a table reaches inward, m, however wide the wheel is drawn.
pub const MOST_INWARD: f64 = 0.1;
/// How far beyond flange contact a table reaches outward, m.
pub const OUTWARD_MARGIN: f64 = 0.010;
/// Greatest roll either way, rad.
pub const ROLL_RANGE: f64 = 0.020;
/// Step of the roll, rad: the bilinear error of the gap is R step^2/8, 0.15 um for R 300 mm.
pub const ROLL_STEP: f64 = 2e-3;

const ROLLS: usize = 21;

/// How wheel and rail are placed against each other, and what they are made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Track gauge, m.
    pub gauge: f64,
    /// Depth below the top of the inclined rail where the gauge is measured, m.
    pub gauge_point_depth: f64,
    /// Inclination of the rail to the track centre, as a slope (0.05 for 1:20).
    pub rail_inclination: f64,
    /// Half the distance between the running circles of a wheelset, m.
    pub tape_half_distance: f64,
    /// Radius of the running circle, m.
    pub wheel_radius: f64,
    /// Young's modulus of wheel and rail, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio of wheel and rail.
    pub poisson: f64,
}

impl Placement {
    /// Normal interpenetration (m) that belongs to a wheel load (N): [`VIRTUAL`](crate::contact::search::VIRTUAL) times the approach that Hertz
    /// gives this wheel, a cylinder along the rail, on a head of radius [`CROWN_RADIUS`]; within the bounds of [`GeometryTable::build_at`].
    #[must_use]
    pub fn penetration_under(&self, load: f64) -> f64 {
        let modulus = hertz::effective_modulus(self.youngs_modulus, self.poisson);
        let patch = hertz::solve(1.0 / self.wheel_radius, 1.0 / CROWN_RADIUS, modulus);
        (VIRTUAL * (load / patch.stiffness).powf(2.0 / 3.0)).clamp(LEAST_PENETRATION, MOST_PENETRATION)
    }
}

/// Part of the wheel profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Zone {
    /// Contact angles below the blend.
    #[default]
    Tread,
    /// The part of the tread nearer to the flange, of a pair that touches in two places of the tread at once.
    SecondTread,
    /// Contact angles above the blend, to the flange tip.
    Flange,
    /// The part of the flange nearer to its tip, of a pair that touches in two places of the flange at once.
    SecondFlange,
}

impl Zone {
    /// Whether it is on the flange, first or second part.
    #[must_use]
    pub fn is_flange(self) -> bool {
        matches!(self, Self::Flange | Self::SecondFlange)
    }
}

/// One contact between wheel and rail.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactPoint {
    /// Part of the wheel.
    pub zone: Zone,
    /// Vertical penetration, dz less the gap (m, > 0). The normal one is this times cos(angle).
    pub penetration: f64,
    /// Part of this contact that belongs to its zone, 0 to 1: multiplies the normal force.
    pub share: f64,
    /// On the rail, from the rail's origin, rail axes, m outward.
    pub y_rail: f64,
    /// On the rail, m below the top of rail.
    pub z_rail: f64,
    /// On the wheel, from the tape-circle point, wheel axes, m outward.
    pub y_wheel: f64,
    /// On the wheel, m below the tape-circle point: the rolling radius is `wheel_radius + z_wheel`.
    pub z_wheel: f64,
    /// Contact angle gamma against the rail axes, rad, positive on the flange side.
    pub angle: f64,
    /// C in N = C delta^1.5, delta the normal penetration, N/m^1.5.
    pub hertz: f64,
    /// Semi-axis along rolling per cube root of the normal force, m/N^(1/3).
    pub a1: f64,
    /// Semi-axis across, the same way.
    pub b1: f64,
    /// Kalker's C11.
    pub c11: f64,
    /// Kalker's C22.
    pub c22: f64,
    /// Kalker's C23.
    pub c23: f64,
}

/// The wheel has left the table: shift or roll beyond its range, or not a number.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "wheel outside the contact table: shift {:.2} mm ({:.1} to {:.1}), roll {:.2} mrad (+-20), or standing on the end of a profile",
    1e3 * dy,
    1e3 * reach[0],
    1e3 * reach[1],
    1e3 * roll
)]
pub struct OutOfTable {
    /// Shift asked for, m.
    pub dy: f64,
    /// Roll asked for, rad.
    pub roll: f64,
    /// Least and greatest shift of the table, m.
    pub reach: [f64; 2],
}

/// Gaps of a node, apart from the rest so that a wheel in the air or off the flange costs four numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gaps {
    /// Vertical gap per zone, m.
    gap: [f64; 2],
    /// By yaw^2, r tan(gamma)^2/2 - y_wheel tan(gamma)/2 per zone, m/rad^2.
    yaw: [f64; 2],
}

/// The rest of a node for one zone, in the order of [`ContactPoint`] from `share` on, then the rates by yaw^2 of `y_rail`, `y_wheel` and `angle`, and dz/dy at
/// the contact. A share that is no number marks an end of a profile.
type Values = [f64; 16];

/// Table of contacts of one wheel/rail pair over shift and roll. Immutable; share it between wheels and threads.
#[derive(Debug, Clone, PartialEq)]
pub struct GeometryTable {
    placement: Placement,
    rail_origin_y: f64,
    rail: Profile,
    flange_angle: f64,
    shifts: Shifts,
    /// [roll][shift]
    gaps: Vec<Gaps>,
    values: [Vec<Values>; 2],
    /// The two parts of tread and flange, where they touch in two places at once.
    split: [Option<Box<[Part; 2]>>; 2],
}

/// One part of a zone that touches in two places.
#[derive(Debug, Clone, PartialEq)]
struct Part {
    /// Vertical gap, m, and its rate by yaw^2, m/rad^2.
    gaps: Vec<[f64; 2]>,
    values: Vec<Values>,
}

impl Part {
    #[inline(always)]
    fn gap_at(&self, place: &Place) -> [f64; 2] {
        let mut out = [0.0; 2];
        for (n, w) in place.nodes().into_iter().zip(place.weights) {
            let node = &self.gaps[n];
            out[0] += w * node[0];
            out[1] += w * node[1];
        }
        out
    }
}

/// Zones as a whole, and their second parts.
const ZONES: [[Zone; 2]; 2] = [[Zone::Tread, Zone::SecondTread], [Zone::Flange, Zone::SecondFlange]];

/// Gap of a zone that has no rail under it, m.
const NO_RAIL: f64 = 0.2;

/// Corner of a table cell and the four bilinear weights.
#[derive(Clone, Copy)]
struct Place {
    node: usize,
    /// Nodes from one roll to the next.
    row: usize,
    weights: [f64; 4],
}

impl Place {
    #[inline(always)]
    fn nodes(&self) -> [usize; 4] {
        [self.node, self.node + 1, self.node + self.row, self.node + self.row + 1]
    }
}

impl GeometryTable {
    /// How the pair was placed.
    #[must_use]
    pub fn placement(&self) -> &Placement {
        &self.placement
    }

    /// Side coordinate (m from the track centre) of the rail profile's origin at nominal gauge; z = 0 is the highest
    /// point of the inclined head.
    #[must_use]
    pub fn rail_origin_y(&self) -> f64 {
        self.rail_origin_y
    }

    /// Steepest angle of the wheel profile's flange face against the axle, rad: Nadal's.
    #[must_use]
    pub fn flange_angle(&self) -> f64 {
        self.flange_angle
    }

    /// The rail as it stands: inclined, its highest point at z = 0.
    #[must_use]
    pub fn rail(&self) -> &Profile {
        &self.rail
    }

    /// Least and greatest shift that the table knows, m: inward (negative) to where the end of the wheel's rim stands over the top of the
    /// rail, so that any widening at which the wheelset does not fall in is in it; outward past flange contact.
    #[must_use]
    pub fn reach(&self) -> [f64; 2] {
        self.shifts.reach()
    }

    fn out(&self, dy: f64, roll: f64) -> OutOfTable {
        OutOfTable { dy, roll, reach: self.reach() }
    }

    #[inline(always)]
    fn place(&self, dy: f64, roll: f64) -> Result<Place, OutOfTable> {
        let r = (roll + ROLL_RANGE) * (1.0 / ROLL_STEP);
        if !(r >= 0.0 && r <= (ROLLS - 1) as f64) {
            return Err(self.out(dy, roll));
        }
        let (i, u) = self.shifts.place(dy).ok_or_else(|| self.out(dy, roll))?;
        let j = (r as usize).min(ROLLS - 2);
        let v = r - j as f64;
        let row = self.shifts.count();
        Ok(Place {
            node: j * row + i,
            row,
            weights: [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v],
        })
    }

    #[inline(always)]
    fn gaps_at(&self, place: &Place) -> Gaps {
        let mut out = Gaps { gap: [0.0; 2], yaw: [0.0; 2] };
        for (n, w) in place.nodes().into_iter().zip(place.weights) {
            let node = &self.gaps[n];
            for zone in 0..2 {
                out.gap[zone] += w * node.gap[zone];
                out.yaw[zone] += w * node.yaw[zone];
            }
        }
        out
    }

    /// Contacts of the wheel at shift `dy`, `roll` and depth `dz`; returns how many of `out` were written (0 to [`MAX_CONTACTS`]).
    ///
    /// - `dy` (m): side coordinate of the wheel's tape-circle point relative to the rail less its nominal value, in rail
    ///   axes, + outward, towards flange contact;
    /// - `roll` (rad): wheel less rail, in side coordinates (+ lowers the field side);
    /// - `dz` (m): depth of the tape-circle point below the top of rail;
    /// - `yaw` (rad): wheel less rail; only its square is used.
    ///
    /// Does not allocate.
    ///
    /// # Errors
    /// Shift or roll outside the table, or not a number; contact at an end of a profile.
    #[inline(always)]
    pub fn contacts(
        &self,
        dy: f64,
        roll: f64,
        dz: f64,
        yaw: f64,
        out: &mut [ContactPoint; MAX_CONTACTS],
    ) -> Result<usize, OutOfTable> {
        let place = self.place(dy, roll)?;
        let gaps = self.gaps_at(&place);
        let mut count = 0;
        for (zone, names) in ZONES.into_iter().enumerate() {
            if let Some(parts) = &self.split[zone] {
                count = split(parts, names, &place, dz, yaw, out, count).ok_or_else(|| self.out(dy, roll))?;
                continue;
            }
            let penetration = dz - gaps.gap[zone] + gaps.yaw[zone] * yaw * yaw;
            if penetration > 0.0 {
                let v = values_at(&self.values[zone], &place);
                count = add(names[0], penetration, v, yaw, out, count).ok_or_else(|| self.out(dy, roll))?;
            }
        }
        Ok(count)
    }

    /// Whether tread and flange have a second part: a pair that touches there in two places at once.
    #[must_use]
    pub fn seconds(&self) -> [bool; 2] {
        [self.split[0].is_some(), self.split[1].is_some()]
    }

    /// Vertical gap (m) of each zone, tread and flange, with the tape-circle point at the top of rail; without yaw.
    ///
    /// # Errors
    /// Shift or roll outside the table, or not a number.
    pub fn gap(&self, dy: f64, roll: f64) -> Result<[f64; 2], OutOfTable> {
        Ok(self.gaps_at(&self.place(dy, roll)?).gap)
    }

    /// The contact that a wheel just touching makes first: that of the zone with the smaller gap, penetration zero.
    ///
    /// # Errors
    /// Shift or roll outside the table, or not a number; contact at an end of a profile.
    pub fn touching(&self, dy: f64, roll: f64) -> Result<ContactPoint, OutOfTable> {
        let place = self.place(dy, roll)?;
        let gap = self.gaps_at(&place).gap;
        let (zone, name) = if gap[0] <= gap[1] { (0, Zone::Tread) } else { (1, Zone::Flange) };
        let values = values_at(&self.values[zone], &place);
        if values[0].is_nan() {
            return Err(self.out(dy, roll));
        }
        Ok(point(name, 0.0, &values))
    }
}

#[inline(always)]
fn values_at(nodes: &[Values], place: &Place) -> Values {
    let mut out = [0.0; 16];
    for (n, w) in place.nodes().into_iter().zip(place.weights) {
        for (o, v) in out.iter_mut().zip(&nodes[n]) {
            *o += w * v;
        }
    }
    out
}

/// Adds a contact that penetrates; gives the count back, `None` where it is at an end of a profile.
#[inline(always)]
fn add(
    zone: Zone,
    penetration: f64,
    mut v: Values,
    yaw: f64,
    out: &mut [ContactPoint; MAX_CONTACTS],
    count: usize,
) -> Option<usize> {
    if v[0] > 0.0 {
        let [on_rail, on_wheel, angle] = [v[12], v[13], v[14]].map(|rate| rate * yaw * yaw);
        v[1] += on_rail;
        v[2] += v[15] * on_rail;
        v[3] += on_wheel;
        v[4] += v[15] * on_wheel;
        v[5] += angle;
        out[count] = point(zone, penetration, &v);
        return Some(count + 1);
    }
    (!v[0].is_nan()).then_some(count)
}

/// Contacts of both parts of a zone. Apart from the rest, so that pairs without second parts do not pay for it.
#[inline(never)]
fn split(
    parts: &[Part; 2],
    names: [Zone; 2],
    place: &Place,
    dz: f64,
    yaw: f64,
    out: &mut [ContactPoint; MAX_CONTACTS],
    mut count: usize,
) -> Option<usize> {
    for (part, name) in parts.iter().zip(names) {
        let [gap, rate] = part.gap_at(place);
        let penetration = dz - gap + rate * yaw * yaw;
        if penetration > 0.0 {
            count = add(name, penetration, values_at(&part.values, place), yaw, out, count)?;
        }
    }
    Some(count)
}

#[inline(always)]
fn point(zone: Zone, penetration: f64, v: &Values) -> ContactPoint {
    ContactPoint {
        zone,
        penetration,
        share: v[0],
        y_rail: v[1],
        z_rail: v[2],
        y_wheel: v[3],
        z_wheel: v[4],
        angle: v[5],
        hertz: v[6],
        a1: v[7],
        b1: v[8],
        c11: v[9],
        c22: v[10],
        c23: v[11],
    }
}
