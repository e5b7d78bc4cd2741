//! Preloads: the forces with which the chosen connections carry the vehicle in its design position.
//!
//! Wheelsets stand still; the carrying connections share the weight of everything above them by their stiffness: the
//! linear static problem `K u = W` at the design geometry, each preload then being the force of its connection at `u`.
//! With these preloads the design position is in equilibrium exactly, since they balance at that geometry.

use nalgebra::{DMatrix, DVector};

use crate::body::{RigidBody, Wheelset};
use crate::connection::{Pair, Pose, Relative};
use crate::dynamics::model::Link;
use crate::error::{Error, Fault, KeyPath, Result};
use crate::math::{Mat3, Vec3};

/// Displacement of the point at `p` from a centre of mass, for its six unit motions: 3 x 6.
fn motion(p: &Vec3) -> nalgebra::SMatrix<f64, 3, 6> {
    let mut m = nalgebra::SMatrix::<f64, 3, 6>::zeros();
    m.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
    m.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-p.cross_matrix()));
    m
}

/// Motion of the two ends' bodies in the design position.
fn at_rest(bodies: &[RigidBody], wheelsets: &[Wheelset], link: &Link) -> Relative {
    let place = |i: usize| {
        if i < bodies.len() { bodies[i].position } else { wheelsets[i - bodies.len()].body.position }
    };
    Relative::between(&Pose::at(place(link.a)), &Pose::at(place(link.b)))
}

/// Solves the preloads of the links marked in `carries` (same length as `links`) for the given masses; the others push as
/// their own preload or free length says, and are carried too. `fixed` bodies (guided ones) stand like wheelsets.
///
/// # Errors
/// A body that the carrying connections do not hold; a load that a law does not carry (at the key of its link).
pub fn solve(
    bodies: &[RigidBody],
    wheelsets: &[Wheelset],
    links: &mut [Link],
    carries: &[bool],
    fixed: &[usize],
    gravity: f64,
    key: impl Fn(usize) -> KeyPath,
) -> Result<()> {
    let free = |i: usize| i < bodies.len() && !fixed.contains(&i);
    let n = 6 * bodies.len();
    let mut stiffness = DMatrix::<f64>::zeros(n, n);
    let mut load = DVector::<f64>::zeros(n);
    for (i, body) in bodies.iter().enumerate().filter(|(i, _)| free(*i)) {
        load[6 * i + 2] = body.mass * gravity;
    }
    for (link, _) in links.iter().zip(carries).filter(|(_, c)| !**c) {
        let motion = at_rest(bodies, wheelsets, link);
        let on_B = link.wrench(&motion, &vec![0.0; link.memory.len()]);
        let pair = Pair::new(&on_B, &motion, &Mat3::identity());
        for (i, own) in [(link.a, pair.on_A), (link.b, pair.on_B)].into_iter().filter(|(i, _)| free(*i)) {
            for d in 0..3 {
                load[6 * i + d] += own.f[d];
                load[6 * i + 3 + d] += own.m[d];
            }
        }
    }
    for (link, _) in links.iter().zip(carries).filter(|(_, c)| **c) {
        let k = link.nominal_stiffness();
        let [p_A, p_B] = link.levers();
        let ends = [(link.a, -motion(&p_A)), (link.b, motion(&p_B))];
        for (i, m_i) in &ends {
            for (j, m_j) in &ends {
                if free(*i) && free(*j) {
                    let block = m_i.transpose() * k * m_j;
                    let mut view = stiffness.fixed_view_mut::<6, 6>(6 * i, 6 * j);
                    view += block;
                }
            }
        }
    }
    if load.amax() == 0.0 {
        return settle(links, carries, key, |_| Vec3::zeros()); // wheelsets alone: nothing stands on anything
    }
    // A direction that nothing carries (yaw over ideal rollers, say) is left alone if nothing loads it: the
    // pseudo-inverse gives it no displacement, and the residual tells if it was needed.
    let svd = stiffness.clone().svd(true, true);
    let tolerance = svd.singular_values.max() * 1e-12;
    let u = svd.solve(&load, tolerance).map_err(|e| {
        Error::input(Fault::new(
            KeyPath::of("vehicle.connection"),
            e.to_string(),
            "connections that carry the vehicle",
        ))
    })?;
    let residual = &stiffness * &u - &load;
    if let Some((i, body)) = bodies.iter().enumerate().find(|(i, b)| {
        // In proportion to the largest load too: a light body may carry a heavy one.
        let size = (b.mass * gravity.max(1.0)).max(1e-3 * load.amax());
        residual.rows(6 * i, 6).amax() > 1e-6 * size
    }) {
        return Err(Error::input(
            Fault::new(
                KeyPath::of("vehicle.connection"),
                format!(
                    "body `{}` with {:.0} N that nothing carries",
                    body.name,
                    residual.rows(6 * i, 6).amax()
                ),
                "connections with `carries_weight = true` that hold every body's weight",
            )
            .hint("mark the springs that stand under this body with `carries_weight = true`"),
        ));
    }
    let share = |link: &Link| {
        let [p_A, p_B] = link.levers();
        let moved =
            |i: usize, p: &Vec3| if free(i) { motion(p) * u.fixed_rows::<6>(6 * i) } else { Vec3::zeros() };
        -(link.nominal_stiffness() * (moved(link.b, &p_B) - moved(link.a, &p_A)))
    };
    settle(links, carries, key, share)
}

fn settle(
    links: &mut [Link],
    carries: &[bool],
    key: impl Fn(usize) -> KeyPath,
    share: impl Fn(&Link) -> Vec3,
) -> Result<()> {
    for (i, (link, _)) in links.iter_mut().zip(carries).enumerate().filter(|(_, (_, c))| **c) {
        let force = share(link);
        link.settle(Some(&force)).map_err(|found| {
            Error::input(Fault::new(
                key(i).key("carries_weight"),
                found,
                "a load that this connection reaches",
            ))
        })?;
    }
    Ok(())
}
