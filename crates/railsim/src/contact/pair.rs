//! A wheelset on its two rails, each side with its own profiles and radius: what a contact specialist asks by itself, without a vehicle.

use crate::contact::conicity::RadiusCurve;
use crate::contact::geometry_table::Placement;
use crate::contact::profile::{self, Profile, ProfileKind};
use crate::contact::search::{NoContact, Pose, RailShift, Side, Touch};
use crate::error::{Error, Fault, KeyPath, Result};
use serde::Deserialize;

/// Profiles and radius of one side, as written.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WrittenSide {
    /// Wheel profile, mm, y outward with the flange at negative y, z down, y = 0 at the running circle.
    pub wheel: Vec<[f64; 2]>,
    /// Rail profile, upright, mm, y outward with the gauge corner at negative y, z down, top at the origin.
    pub rail: Vec<[f64; 2]>,
    /// Radius of the running circle, m.
    pub radius: f64,
}

/// A wheelset and a track, as written: SI, profiles in mm.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Written {
    /// Left side; the right one too where `right` is left out.
    pub left: WrittenSide,
    /// Right side.
    pub right: Option<WrittenSide>,
    /// Gauge, m.
    pub gauge: f64,
    /// Depth below the top of the rail where it is measured, m.
    #[serde(default = "fourteen_millimetres")]
    pub gauge_point_depth: f64,
    /// Inclination of the rails, as a slope; 0 where the profiles are drawn inclined.
    #[serde(default)]
    pub rail_inclination: f64,
    /// Distance between the flange backs, m.
    pub flange_back_distance: f64,
    /// From a flange back to the running circle, m.
    #[serde(default = "seventy_millimetres")]
    pub tape_from_flange_back: f64,
    /// Half-width of the profile smoothing, m.
    #[serde(default = "profile_half_width")]
    pub smoothing: f64,
    /// Young's modulus of wheel and rail, Pa.
    #[serde(default = "steel")]
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    #[serde(default = "poisson")]
    pub poisson: f64,
}

fn fourteen_millimetres() -> f64 {
    0.014
}
fn seventy_millimetres() -> f64 {
    0.070
}
fn profile_half_width() -> f64 {
    profile::HALF_WIDTH
}
fn steel() -> f64 {
    210e9
}
fn poisson() -> f64 {
    0.28
}

/// A wheelset over its rails.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// Left and right.
    pub sides: [Side; 2],
}

/// Whether a rigid wheelset that is moved sideways rolls until both wheels touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Roll {
    /// The axle stays level, each wheel finds its own contact: how the reference curves of EN 15302 were computed (dr of its 1:40 cones is
    /// 0.05 y exactly).
    Level,
    /// It rolls, as a real one does: some 3 to 5 per cent more conicity on round heads.
    Free,
}

/// A rigid wheelset standing on both rails.
#[derive(Debug, Clone, PartialEq)]
pub struct Standing {
    /// Roll that both wheels touch at, right side down, rad.
    pub roll: f64,
    /// Depth of the axle's centre below the mean radius over the top of the rails, m.
    pub z: f64,
    /// Closest places of the left wheel, by rising gap: the first touches.
    pub left: Vec<Touch>,
    /// Of the right wheel.
    pub right: Vec<Touch>,
}

impl Pair {
    /// Two sides; their placements must belong to one wheelset (gauge and running circles).
    #[must_use]
    pub fn new(left: Side, right: Side) -> Self {
        Self { sides: [left, right] }
    }

    /// A pair from its JSON text ([`Written`]).
    ///
    /// # Errors
    /// [`Error::Input`] with the keys of what is missing, unknown or out of range, and everything that [`Side::new`] refuses.
    pub fn from_json(text: &str) -> Result<Self> {
        let mut json = serde_json::Deserializer::from_str(text);
        let written: Written = serde_path_to_error::deserialize(&mut json).map_err(|e| {
            // the path of a fault of the text itself, or of the whole, has no key
            let path = e.path().to_string();
            let key = if path == "." || path == "?" { "pair" } else { &path };
            let allowed = "a wheelset on a track: left, right, gauge, flange_back_distance, ...";
            Error::input(Fault::new(KeyPath::of(key), e.inner().to_string(), allowed))
        })?;
        Self::from_written(&written)
    }

    /// The same from parsed data.
    ///
    /// # Errors
    /// As [`Pair::from_json`].
    pub fn from_written(written: &Written) -> Result<Self> {
        let half = 0.5 * written.flange_back_distance + written.tape_from_flange_back;
        let right = written.right.as_ref().unwrap_or(&written.left);
        let mut faults = Vec::new();
        for (side, at) in [(&written.left, "left.radius"), (right, "right.radius")] {
            if !(0.05..=2.0).contains(&side.radius) {
                faults.push(Fault::new(KeyPath::of(at), format!("{} m", side.radius), "0.05 to 2 m"));
            }
        }
        for (value, key, low, high) in [
            (written.gauge, "gauge", 0.2, 3.0),
            (written.gauge_point_depth, "gauge_point_depth", 1e-3, 0.05),
            (written.flange_back_distance, "flange_back_distance", 0.1, 3.0),
            (written.tape_from_flange_back, "tape_from_flange_back", 0.02, 0.15),
        ] {
            if !(low..=high).contains(&value) {
                faults.push(Fault::new(KeyPath::of(key), format!("{value} m"), format!("{low} to {high} m")));
            }
        }
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let side = |side: &WrittenSide, name: &str| {
            let metres = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
                points.iter().map(|p| p.map(|x| 1e-3 * x)).collect()
            };
            let at = KeyPath::of(name);
            let read = |points: &[[f64; 2]], kind, key: &str| {
                Profile::smoothed(&metres(points), kind, written.smoothing, &at.key(key))
            };
            let wheel = read(&side.wheel, ProfileKind::Wheel, "wheel")?;
            let rail = read(&side.rail, ProfileKind::Rail, "rail")?;
            let placement = Placement {
                gauge: written.gauge,
                gauge_point_depth: written.gauge_point_depth,
                rail_inclination: written.rail_inclination,
                tape_half_distance: half,
                wheel_radius: side.radius,
                youngs_modulus: written.youngs_modulus,
                poisson: written.poisson,
            };
            Side::new(&wheel, &rail, &placement)
        };
        let left = side(&written.left, "left")?;
        let right = match &written.right {
            Some(written) => side(written, "right")?,
            None => left.clone(),
        };
        Ok(Self::new(left, right))
    }

    /// Mean radius of the running circles, m.
    #[must_use]
    pub fn radius(&self) -> f64 {
        0.5 * (self.sides[0].placement().wheel_radius + self.sides[1].placement().wheel_radius)
    }

    /// Poses of the left and right wheel, each in its own side coordinates, of a wheelset at `y` (m, right), depth `z` of its
    /// centre below the mean radius over the top of the rails (m), `roll` (right side down) and `yaw` (rad).
    #[must_use]
    pub fn poses(&self, y: f64, z: f64, roll: f64, yaw: f64) -> [Pose; 2] {
        [-1.0, 1.0].map(|sigma| {
            let side = &self.sides[usize::from(sigma > 0.0)];
            let z = z + side.placement().wheel_radius - self.radius();
            Pose { y: sigma * y, z, roll: sigma * roll, yaw: sigma * yaw }
        })
    }

    /// The rigid wheelset at lateral position `y` and `yaw`, at rest on both rails: roll and height are found.
    ///
    /// # Errors
    /// [`NoContact`] of either side.
    pub fn stand(
        &self,
        y: f64,
        yaw: f64,
        rails: &[RailShift; 2],
    ) -> std::result::Result<Standing, NoContact> {
        self.stand_near(y, yaw, rails, 0.0)
    }

    /// The same from a first guess of the roll.
    ///
    /// # Errors
    /// As [`Pair::stand`].
    pub fn stand_near(
        &self,
        y: f64,
        yaw: f64,
        rails: &[RailShift; 2],
        guess: f64,
    ) -> std::result::Result<Standing, NoContact> {
        let gaps = |roll: f64| -> std::result::Result<[f64; 2], NoContact> {
            let [left, right] = self.poses(y, 0.0, roll, yaw);
            Ok([self.sides[0].gap(&left, &rails[0])?, self.sides[1].gap(&right, &rails[1])?])
        };
        let span =
            self.sides[0].placement().tape_half_distance + self.sides[1].placement().tape_half_distance;
        // More roll lowers the right wheel: the difference falls, by about the span. Newton, with a bracket once there is one.
        let (mut roll, mut low, mut high) = (guess, f64::NEG_INFINITY, f64::INFINITY);
        for _ in 0..60 {
            let [left, right] = gaps(roll)?;
            let difference = right - left;
            if difference > 0.0 {
                low = low.max(roll)
            } else {
                high = high.min(roll)
            }
            if difference.abs() < 1e-12 {
                break;
            }
            let mut next = roll + difference / span;
            if !(next > low && next < high) && low.is_finite() && high.is_finite() {
                next = 0.5 * (low + high);
            }
            if (next - roll).abs() < 1e-13 {
                break;
            }
            roll = next;
        }
        let [l, r] = self.poses(y, 0.0, roll, yaw);
        let z = self.sides[0].gap(&l, &rails[0])?.min(self.sides[1].gap(&r, &rails[1])?);
        let [l, r] = self.poses(y, z, roll, yaw);
        Ok(Standing {
            roll,
            z,
            left: self.sides[0].closest(&l, &rails[0])?,
            right: self.sides[1].closest(&r, &rails[1])?,
        })
    }

    /// Rolling radius of the right wheel less that of the left, m, for the rigid wheelset at `y` (m, right).
    ///
    /// # Errors
    /// [`NoContact`] of either side.
    pub fn rolling_radius_difference(&self, y: f64, roll: Roll) -> std::result::Result<f64, NoContact> {
        let mut guess = 0.0;
        self.difference(y, roll, &mut guess)
    }

    fn difference(&self, y: f64, roll: Roll, guess: &mut f64) -> std::result::Result<f64, NoContact> {
        let rails = [RailShift::default(); 2];
        let [left, right] = match roll {
            Roll::Free => {
                let standing = self.stand_near(y, 0.0, &rails, *guess)?;
                *guess = standing.roll;
                [standing.left, standing.right]
            }
            Roll::Level => {
                let [l, r] = self.poses(y, 0.0, 0.0, 0.0);
                [self.sides[0].closest(&l, &rails[0])?, self.sides[1].closest(&r, &rails[1])?]
            }
        };
        let radius = |side: usize, touches: &[Touch]| {
            let lowest = touches.iter().min_by(|a, b| vertical_gap(a).total_cmp(&vertical_gap(b)));
            lowest
                .map(|t| self.sides[side].placement().wheel_radius + t.wheel[1])
                .ok_or(NoContact::BesideTheRail)
        };
        Ok(radius(1, &right)? - radius(0, &left)?)
    }

    /// The rolling radius difference every `step` (m) from -`range` to `range` (m), as far as both wheels stand on their profiles.
    ///
    /// # Errors
    /// [`NoContact`] where not even the centred wheelset stands.
    pub fn radius_curve(
        &self,
        range: f64,
        step: f64,
        roll: Roll,
    ) -> std::result::Result<RadiusCurve, NoContact> {
        let count = (range / step).round().clamp(1.0, 1e5) as i64;
        let mut centre = 0.0;
        let mut points = vec![[0.0, self.difference(0.0, roll, &mut centre)?]];
        for direction in [-1.0, 1.0] {
            let mut guess = centre;
            for i in 1..=count {
                let y = direction * step * i as f64;
                let Ok(difference) = self.difference(y, roll, &mut guess) else { break };
                points.push([y, difference]);
            }
        }
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Ok(RadiusCurve::new(&points))
    }
}

fn vertical_gap(touch: &Touch) -> f64 {
    touch.gap / touch.angle.cos().max(0.05)
}
