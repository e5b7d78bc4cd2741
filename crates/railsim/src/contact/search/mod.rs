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

mod elastic;
mod gap;
mod outline;
mod rigid;

pub use elastic::{HERTZ_SPREAD, Patch, Pressed, VIRTUAL};
pub use gap::GapPoint;

use crate::contact::geometry_table::{Placement, check, place_rail};
use crate::contact::profile::Profile;
use crate::error::Result;

/// Most contacts of one wheel that are told apart.
pub const MAX_CONTACTS: usize = 3;
/// Steepest contact angle for which vertical and normal distances are still told apart, rad.
const STEEPEST_CONTACT: f64 = 1.45;
/// Contact angle from which a contact counts as one of the flange, rad.
pub const FLANGE_ANGLE: f64 = 0.35;

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
