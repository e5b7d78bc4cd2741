//! Energy of the whole vehicle, for audits: kinetic, weight, connections, contacts, track.

use crate::body::rigid_body::kinetic_energy;
use crate::connection::Relative;
use crate::dynamics::model::{Contact, Model};
use crate::dynamics::rhs::VehicleSystem;
use crate::dynamics::scratch::Wheel;

/// Total energy (J) at the last evaluated state `x`: kinetic and of position, against an arbitrary zero.
#[must_use]
pub fn total(system: &VehicleSystem<'_>, t: f64, x: &[f64]) -> f64 {
    let model: &Model = system.model;
    let (scratch, map) = (&system.scratch, model.map());
    let mut energy = 0.0;
    for i in 0..model.count() {
        let (body, k) = (model.rigid(i), &scratch.kinematics[i]);
        energy += kinetic_energy(k, body.mass, &body.inertia) - body.mass * model.gravity * k.pose.r.z;
    }
    for link in &model.links {
        let motion = Relative::between(&scratch.kinematics[link.a].pose, &scratch.kinematics[link.b].pose);
        energy += link.energy(&motion, x).0;
    }
    for contact in scratch.wheels.iter().flatten().flat_map(Wheel::contacts) {
        let delta = contact.placed.penetration;
        energy += match (&model.contact, &contact.geometry) {
            // Hertz: the integral of share C delta^1.5.
            (Contact::Profiles { .. }, Some(point)) => 0.4 * point.share * point.hertz * delta.powf(2.5),
            (Contact::Textbook(book), _) => 0.5 * book.stiffness * delta * delta,
            (Contact::Profiles { .. }, None) => 0.0,
        };
    }
    if let Some(support) = &model.support {
        let m = [support.mass, support.mass, support.inertia];
        for w in 0..model.wheelsets.len() {
            for d in 0..3 {
                let (q, v) = (x[map.track_q(w).start + d], x[map.track_u(w).start + d]);
                energy += 0.5 * (m[d] * v * v + support.stiffness[d] * q * q);
            }
        }
    }
    if let Some(hold) = &model.speed_hold {
        let away = system.program.at(t).0 - x[map.q(hold.body)][0];
        energy += 0.5 * hold.stiffness * away * away;
    }
    energy
}
