//! Stiffness and damping of one wheelset on its track mass, for implicit schemes: contact normal, creep, track
//! support, all at the last evaluated state. Approximate on purpose (a W-method keeps its order with any matrix): the
//! contact planes stand still, creep is the secant slope, the suspension above is left out.

use crate::contact::creepage::PlacedContact;
use crate::dynamics::axle::patch;
use crate::dynamics::model::{Contact, Model};
use crate::dynamics::rhs::LEAST_ROLLING_SPEED;
use crate::dynamics::scratch::{ContactForce, Scratch, Wheel};
use crate::dynamics::state::PAIR;
use crate::equipment::stick::CONTACT_DAMPING;
use crate::math::Vec3;
use crate::math::cube_root::cube_root;

/// Relative speed along `e` of wheel against rail per unit of each of the pair's nine speeds.
pub(crate) fn direction(placed: &PlacedContact, e: &Vec3) -> [f64; PAIR] {
    let turn = placed.lever.cross(e);
    let [y, z] = placed.point;
    [e.x, e.y, e.z, turn.x, turn.y, turn.z, -e.y, -e.z, -(y * e.z - z * e.y)]
}

/// Adds `factor * left * right'`.
pub(crate) fn add_outer(m: &mut [f64], factor: f64, left: &[f64; PAIR], right: &[f64; PAIR]) {
    for (row, l) in m.chunks_exact_mut(PAIR).zip(left) {
        let scaled = factor * l;
        for (value, r) in row.iter_mut().zip(right) {
            *value += scaled * r;
        }
    }
}

/// What the pair's nine speeds move: kg, kg m2; infinite for a rigid track.
pub(crate) fn inertias(model: &Model, w: usize) -> [f64; PAIR] {
    let body = &model.wheelsets[w].body;
    let mut mass = [f64::INFINITY; PAIR];
    mass[..3].fill(body.mass);
    mass[3..6].copy_from_slice(body.inertia.as_slice());
    if let Some(support) = &model.support {
        mass[6..].copy_from_slice(&[support.mass, support.mass, support.inertia]);
    }
    mass
}

/// Creep damping forward and lateral, N s/m: Kalker's slopes, reduced by what saturation leaves of the linear force.
fn creep_slope(contact: &Contact, force: &ContactForce, speed: f64) -> [f64; 2] {
    match (contact, &force.geometry) {
        (Contact::Textbook(book), _) => [book.f11 / speed, book.f22 / speed],
        (Contact::Profiles { shear_modulus, .. }, Some(point)) => {
            let p = patch(point, force.normal, *shear_modulus);
            let c = &force.placed.creepage;
            let stiffness = p.shear_modulus * p.a * p.b;
            let (f11, f22) = (stiffness * p.c11, stiffness * p.c22);
            let linear_x = f11 * c.xi;
            let linear_y = f22 * c.eta + stiffness * (p.a * p.b).sqrt() * p.c23 * c.phi;
            let linear = (linear_x * linear_x + linear_y * linear_y).sqrt();
            let [fx, fy] = force.creep;
            let left = if linear > 0.0 { ((fx * fx + fy * fy).sqrt() / linear).min(1.0) } else { 1.0 };
            [left * f11 / speed, left * f22 / speed]
        }
        (Contact::Profiles { .. }, None) => [0.0; 2],
    }
}

/// Half the length of a contact's patch, m.
fn half_length(force: &ContactForce) -> f64 {
    force.geometry.map_or(1.0, |point| (point.a1 * cube_root(force.normal)).max(1e-6))
}

/// Fills `k` and `c` (9 x 9, row-major): `d(speeds)/dt ~ -k positions - c speeds` for wheelset `w` and its track.
/// `sticking` is the share of the deflection in the creepage of contacts, 0 in a run without a driver.
pub fn matrices(model: &Model, scratch: &Scratch, w: usize, sticking: f64, k: &mut [f64], c: &mut [f64]) {
    k.fill(0.0);
    c.fill(0.0);
    let speed = scratch.kinematics[model.bodies.len() + w].v_T.x.abs().max(LEAST_ROLLING_SPEED);
    for contact in scratch.wheels[w].iter().flat_map(Wheel::contacts) {
        let n = direction(&contact.placed, &contact.placed.e_n);
        let t = direction(&contact.placed, &contact.placed.e_t);
        let x = direction(&contact.placed, &Vec3::x());
        // Penetration does not depend on the place along the track nor on the axle's turned angle.
        let mut n_q = n;
        n_q[0] = 0.0;
        n_q[4] = 0.0;
        add_outer(k, contact.normal_slope[0], &n, &n_q);
        add_outer(c, contact.normal_slope[1], &n, &n);
        let slope = creep_slope(&model.contact, contact, speed);
        for (slope, e) in slope.into_iter().zip([&x, &t]) {
            if sticking > 0.0 {
                // At rest a spring: the slope over creepage becomes one over the deflection of half a patch.
                let spring = sticking * slope * speed / half_length(contact);
                add_outer(k, spring, e, e);
                add_outer(c, (1.0 - sticking) * slope + CONTACT_DAMPING * spring, e, e);
            } else {
                add_outer(c, slope, e, e);
            }
        }
    }
    match &model.support {
        Some(support) => {
            for d in 0..3 {
                let diagonal = (6 + d) * PAIR + 6 + d;
                k[diagonal] += support.stiffness[d];
                c[diagonal] += support.damping[d];
            }
        }
        // A rigid track does not move: no column here, no row by its infinite mass.
        None => {
            for i in 0..PAIR {
                k[i * PAIR + 6..(i + 1) * PAIR].fill(0.0);
                c[i * PAIR + 6..(i + 1) * PAIR].fill(0.0);
            }
        }
    }
    for (i, mass) in inertias(model, w).into_iter().enumerate() {
        let inverse = 1.0 / mass;
        for j in 0..PAIR {
            k[i * PAIR + j] *= inverse;
            c[i * PAIR + j] *= inverse;
        }
    }
}
