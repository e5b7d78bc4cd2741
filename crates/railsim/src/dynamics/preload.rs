//! Preloads: the forces with which the chosen connections carry the vehicle in its design position.
//!
//! Wheelsets stand still; the carrying connections share the weight of everything above them by their stiffness: the
//! linear static problem `K u = W` at the design geometry, each preload then being the force of its connection at `u`.
//! With these preloads the design position is in equilibrium exactly, since they balance at that geometry.

use nalgebra::{DMatrix, DVector};

use crate::body::{RigidBody, Wheelset};
use crate::connection::ForceLaw;
use crate::dynamics::model::Link;
use crate::error::{Error, Fault, KeyPath, Result};
use crate::math::Vec3;

/// Displacement of the point at `p` from a centre of mass, for its six unit motions: 3 x 6.
fn motion(p: &Vec3) -> nalgebra::SMatrix<f64, 3, 6> {
    let mut m = nalgebra::SMatrix::<f64, 3, 6>::zeros();
    m.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
    m.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-p.cross_matrix()));
    m
}

/// Solves the preloads of the links marked in `carries` (same length as `links`) for the given masses.
///
/// # Errors
/// A body that the carrying connections do not hold.
pub fn solve(
    bodies: &[RigidBody],
    wheelsets: &[Wheelset],
    links: &mut [Link],
    carries: &[bool],
    gravity: f64,
) -> Result<()> {
    if bodies.is_empty() {
        return Ok(()); // wheelsets alone: nothing stands on anything
    }
    let n = 6 * bodies.len();
    let mut stiffness = DMatrix::<f64>::zeros(n, n);
    let mut load = DVector::<f64>::zeros(n);
    for (i, body) in bodies.iter().enumerate() {
        load[6 * i + 2] = body.mass * gravity;
    }
    for (link, _) in links.iter().zip(carries).filter(|(_, c)| **c) {
        let k =
            nalgebra::Matrix3::from_diagonal(&link.law.nominal_stiffness(&between(bodies, wheelsets, link)));
        let ends = [(link.a, -motion(&link.mount.p_A)), (link.b, motion(&link.mount.p_B))];
        for (i, m_i) in &ends {
            for (j, m_j) in &ends {
                if *i < bodies.len() && *j < bodies.len() {
                    let block = m_i.transpose() * k * m_j;
                    let mut view = stiffness.fixed_view_mut::<6, 6>(6 * i, 6 * j);
                    view += block;
                }
            }
        }
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
    if let Some((i, body)) = bodies
        .iter()
        .enumerate()
        .find(|(i, b)| residual.rows(6 * i, 6).amax() > 1e-6 * b.mass * gravity.max(1.0))
    {
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
    for (link, _) in links.iter_mut().zip(carries).filter(|(_, c)| **c) {
        let k = link.law.nominal_stiffness(&between(bodies, wheelsets, link));
        let moved = |i: usize, p: &Vec3| {
            if i < bodies.len() { motion(p) * u.fixed_rows::<6>(6 * i) } else { Vec3::zeros() }
        };
        let d = moved(link.b, &link.mount.p_B) - moved(link.a, &link.mount.p_A);
        link.mount.preload = -k.component_mul(&d);
    }
    Ok(())
}

fn between(bodies: &[RigidBody], wheelsets: &[Wheelset], link: &Link) -> Vec3 {
    let place = |i: usize| {
        if i < bodies.len() { bodies[i].position } else { wheelsets[i - bodies.len()].body.position }
    };
    place(link.b) + link.mount.p_B - place(link.a) - link.mount.p_A
}
