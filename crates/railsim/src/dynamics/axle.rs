//! The two wheels of a wheelset on their rails: where they touch, how they slide, how hard they are pressed.

use crate::body::{Kinematics, Wheelset};
use crate::contact::creep::{CreepCase, Creepage, Patch};
use crate::contact::creepage::{RailPose, TrackMotion, WheelPose, place, rail_pose, wheel_pose};
use crate::contact::geometry_table::{ContactPoint, MAX_CONTACTS};
use crate::contact::normal::hunt_crossley;
use crate::contact::textbook::Textbook;
use crate::dynamics::model::{Contact, Model};
use crate::dynamics::scratch::{ContactForce, Wheel};
use crate::math::Vec3;
use crate::math::angle::SinCos;
use crate::math::cube_root::cube_root;
use crate::track::Deviation;

/// A wheelset as its two wheels see it.
pub(super) struct Axle<'a> {
    pub model: &'a Model,
    pub set: &'a Wheelset,
    pub creeping: bool,
    pub q: &'a [f64; 6],
    pub k: &'a Kinematics,
    pub w_T: Vec3,
    pub speed: f64,
    pub track: TrackMotion,
    pub track_turn: SinCos,
    pub deviation: Deviation,
}

/// Angle of a contact's normal to the vertical, by its functions: most contacts of this kind have none to work out.
#[derive(Debug, Clone, Copy)]
struct Lean {
    sin: f64,
    cos: f64,
    tan: f64,
}

impl Lean {
    const NONE: Self = Self { sin: 0.0, cos: 1.0, tan: 0.0 };

    fn of(angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { sin, cos, tan: sin / cos }
    }
}

impl Axle<'_> {
    #[inline(always)]
    fn rail(&self, sigma: f64, rail_y: f64) -> RailPose {
        rail_pose(sigma, rail_y, &self.deviation, &self.track, self.track_turn, self.k.s_dot)
    }

    /// One wheel: place it on its rail, look its contacts up, give each its normal force and ask for its creep force. Gives
    /// back the pose with which the wheel left the table.
    #[inline(always)]
    pub fn wheel(&self, sigma: f64, wheel: &mut Wheel, cases: &mut Vec<CreepCase>) -> Result<(), WheelPose> {
        let (half, radius) = (self.set.tape_half_distance, self.set.radius);
        match &self.model.contact {
            Contact::Profiles { table, shear_modulus, dissipation, friction, .. } => {
                let rail_y = table.rail_origin_y();
                let rail = self.rail(sigma, rail_y);
                let pose = wheel_pose(sigma, self.q, self.k, half, radius, half - rail_y, &rail);
                wheel.lift(pose.shift);
                let mut found = [ContactPoint::default(); MAX_CONTACTS];
                let count = table
                    .contacts(pose.shift, pose.roll, pose.depth, pose.yaw, &mut found)
                    .map_err(|_| pose)?;
                for point in &found[..count] {
                    let contact = wheel.add();
                    let (q, k) = (self.q, self.k);
                    let placed = place(sigma, point, &rail, radius, q, k, &self.w_T, &self.track, self.speed);
                    let n =
                        hunt_crossley(point.hertz, placed.penetration, placed.approach_rate, *dissipation);
                    contact.geometry = Some(*point);
                    contact.normal = point.share * n.force;
                    contact.normal_slope = [point.share * n.stiffness, point.share * n.damping];
                    contact.creep = [0.0; 2];
                    let mu = friction.at(usize::from(sigma > 0.0), q[0], placed.slip);
                    contact.creeps = self.creeping && contact.normal > 0.0 && mu > 0.0;
                    if contact.creeps {
                        cases.push(CreepCase {
                            patch: patch(point, contact.normal, *shear_modulus),
                            creepage: placed.creepage,
                            mu,
                        });
                    }
                    contact.placed = placed;
                }
            }
            Contact::Textbook(book) => {
                let rail = self.rail(sigma, half);
                let pose = wheel_pose(sigma, self.q, self.k, half, radius, 0.0, &rail);
                wheel.lift(pose.shift);
                let lean = if book.gravity_stiffness {
                    Lean::of(book.conicity.atan() - sigma * self.q[3])
                } else {
                    Lean::NONE
                };
                let depth = pose.depth + lean.tan * pose.shift;
                if depth > 0.0 {
                    self.textbook(book, sigma, pose.shift, depth, lean, rail.surface_velocity, wheel.add());
                }
            }
        }
        Ok(())
    }

    /// `lean` is the normal's inward, `surface` the velocity of the running surface, side coordinates.
    #[allow(clippy::too_many_arguments)] // plain data, on the way into its place
    #[inline(always)]
    fn textbook(
        &self,
        book: &Textbook,
        sigma: f64,
        shift: f64,
        depth: f64,
        lean: Lean,
        surface: [f64; 2],
        contact: &mut ContactForce,
    ) {
        let half = sigma * self.set.tape_half_distance;
        // In axle axes the contact is below the tape circle, at the rolling radius there.
        let lever = self.k.R_TB * Vec3::new(0.0, half, self.set.radius + book.conicity * shift);
        let rail = Vec3::new(0.0, self.track.vy, self.track.vz + half * self.track.vphi);
        let v_wheel = self.k.v_T + self.w_T.cross(&lever);
        let slip = v_wheel - rail;
        let rate = v_wheel.z - surface[1] + lean.tan * (sigma * v_wheel.y - surface[0]);
        let creepage = Creepage {
            xi: slip.x / self.speed,
            eta: sigma * slip.y / self.speed,
            phi: sigma * self.w_T.z / self.speed,
        };
        // One by one into their places: a whole contact with its geometry is forty numbers.
        let placed = &mut contact.placed;
        placed.lever = lever;
        placed.point = [half + self.track.y, self.track.z];
        placed.e_t = Vec3::new(0.0, sigma, 0.0);
        placed.e_n = Vec3::new(0.0, -sigma * lean.sin, -lean.cos);
        placed.penetration = depth;
        placed.approach_rate = rate;
        placed.slip = [slip.x, sigma * slip.y];
        placed.creepage = creepage;
        contact.geometry = None;
        contact.normal = (book.stiffness * depth + book.damping * rate).max(0.0);
        contact.normal_slope = [book.stiffness, book.damping];
        contact.creep = [-book.f11 * creepage.xi, -book.f22 * creepage.eta - book.f23 * creepage.phi];
        contact.creeps = false;
    }
}

/// The patch of a contact of the geometry table under load.
#[inline(always)]
pub(super) fn patch(point: &ContactPoint, normal: f64, shear_modulus: f64) -> Patch {
    let root = cube_root(normal);
    Patch {
        a: point.a1 * root,
        b: point.b1 * root,
        n: normal,
        c11: point.c11,
        c22: point.c22,
        c23: point.c23,
        shear_modulus,
    }
}

/// Force of one contact on the wheel, track axes, N.
#[inline(always)]
pub(super) fn total_force(c: &ContactForce) -> Vec3 {
    c.normal * c.placed.e_n + c.creep[1] * c.placed.e_t + Vec3::new(c.creep[0], 0.0, 0.0)
}
