//! Coordinates by name: `carbody.y`, `ws1.track_phi`.

use std::collections::BTreeMap;

use crate::dynamics::Model;
use crate::error::{Error, Fault, KeyPath, Result};

/// Coordinates of a body, in the order of the state.
pub const OF_BODY: [&str; 6] = ["x", "y", "z", "phi", "theta", "psi"];
/// Coordinates of the track mass under a wheelset, in the order of the state.
pub const OF_TRACK: [&str; 3] = ["track_y", "track_z", "track_phi"];

/// One coordinate of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Coordinate {
    /// As written.
    pub name: String,
    /// Index of the coordinate in the state.
    pub q: usize,
    /// Index of its speed.
    pub u: usize,
    /// Mass or moment of inertia that it moves, kg or kg m2.
    pub inertia: f64,
    /// An angle, not a length.
    pub turns: bool,
}

/// The coordinate called `name`, which is written at `at`.
///
/// # Errors
/// A name that is none.
pub fn find(model: &Model, name: &str, at: &KeyPath) -> Result<Coordinate> {
    all(model).into_iter().find(|c| c.name == name).ok_or_else(|| {
        let bodies: Vec<&str> = (0..model.count()).map(|i| model.rigid(i).name.as_str()).collect();
        let found = format!("`{name}`");
        let fault = if let Some((body, _)) = name.split_once('.').filter(|(body, _)| bodies.contains(body)) {
            let track = if model.support.is_some() && model.wheelsets.iter().any(|w| w.body.name == body) {
                ", track_y, track_z, track_phi"
            } else {
                ""
            };
            Fault::new(at.clone(), found, format!("{body}. with x, y, z, phi, theta, psi{track}"))
        } else {
            Fault::new(at.clone(), found, format!("a coordinate of {}", bodies.join(", ")))
                .hint(format!("such as {}.y", bodies.first().unwrap_or(&"carbody")))
        };
        Error::input(fault)
    })
}

/// State index and offset (m or rad) of every coordinate of `run.disturbance`.
///
/// # Errors
/// A coordinate that does not exist.
pub fn disturbance(model: &Model, written: &BTreeMap<String, f64>) -> Result<Vec<(usize, f64)>> {
    let at = KeyPath::of("run.disturbance");
    written.iter().map(|(name, by)| find(model, name, &at.key(name)).map(|c| (c.q, *by))).collect()
}

/// Every coordinate of a model: of bodies, of wheelsets, then of the track masses that it has.
#[must_use]
pub fn all(model: &Model) -> Vec<Coordinate> {
    let map = model.map();
    let mut found = Vec::new();
    for i in 0..model.count() {
        let body = model.rigid(i);
        let inertia = [body.mass, body.mass, body.mass, body.inertia.x, body.inertia.y, body.inertia.z];
        for (d, part) in OF_BODY.into_iter().enumerate() {
            found.push(Coordinate {
                name: format!("{}.{part}", body.name),
                q: map.q(i).start + d,
                u: map.u(i).start + d,
                inertia: inertia[d],
                turns: d >= 3,
            });
        }
    }
    if let Some(support) = &model.support {
        for (w, set) in model.wheelsets.iter().enumerate() {
            for (d, part) in OF_TRACK.into_iter().enumerate() {
                found.push(Coordinate {
                    name: format!("{}.{part}", set.body.name),
                    q: map.track_q(w).start + d,
                    u: map.track_u(w).start + d,
                    inertia: if d < 2 { support.mass } else { support.inertia },
                    turns: d == 2,
                });
            }
        }
    }
    found
}
