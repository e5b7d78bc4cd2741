//! What the rules look at: the case, and what it becomes as far as it can be made.

use std::collections::BTreeMap;

use crate::analysis::{Mode, Stand, modes};
use crate::dynamics::Model;
use crate::error::{Error, KeyPath};
use crate::integrator::System;
use crate::schema::{Case, Connection};
use crate::track::Layout;

/// A body or a wheelset.
#[derive(Debug, Clone, Copy)]
pub struct Thing<'c> {
    pub name: &'c str,
    pub mass: f64,
    pub inertia: [f64; 3],
    pub position: [f64; 3],
    pub key: &'c KeyPath,
    pub is_wheelset: bool,
    pub guided: bool,
}

impl Thing<'_> {
    /// Half the edges of the homogeneous box with this mass and these moments, m.
    pub fn half_box(&self) -> [f64; 3] {
        let [x, y, z] = self.inertia;
        [y + z - x, x + z - y, x + y - z].map(|sum| 0.5 * (6.0 * sum / self.mass).max(0.0).sqrt())
    }

    /// How far (m) a point lies outside of a box a good deal larger than the body.
    pub fn beyond(&self, point: &[f64; 3]) -> f64 {
        let half = self.half_box();
        let outside = |i: usize| (point[i] - self.position[i]).abs() - (ROOM * half[i] + MARGIN);
        (0..3).map(outside).fold(0.0, f64::max)
    }
}

/// A body is not a homogeneous box: what belongs to it lies within this many times its half edges...
const ROOM: f64 = 1.5;
/// ...and this, m.
const MARGIN: f64 = 0.5;

/// The vehicle at rest on straight track.
pub struct Rest {
    pub x: Vec<f64>,
    /// Vertical wheel forces, left and right, N.
    pub loads: Vec<[f64; 2]>,
    /// Modes with sticking wheels; none where the iteration stalled.
    pub modes: Vec<Mode>,
}

/// A case on its way through the rules.
pub struct Subject<'c> {
    pub case: &'c Case,
    /// Bodies, then wheelsets, as the model counts them.
    pub things: Vec<Thing<'c>>,
    /// The compiled vehicle with its place, or what stands in the way.
    pub stand: Result<Stand, Error>,
    /// The standing vehicle, or what stands in the way; nothing where it was not compiled.
    pub rest: Option<Result<Rest, Error>>,
}

impl<'c> Subject<'c> {
    pub fn new(case: &'c Case) -> Self {
        let v = &case.vehicle;
        let bodies = v.bodies.iter().map(|b| Thing {
            name: &b.name,
            mass: b.mass,
            inertia: b.inertia,
            position: b.position,
            key: &b.key,
            is_wheelset: false,
            guided: b.guided,
        });
        let wheelsets = v.wheelsets.iter().map(|w| Thing {
            name: &w.name,
            mass: w.mass,
            inertia: w.inertia,
            position: w.position,
            key: &w.key,
            is_wheelset: true,
            guided: false,
        });
        let things = bodies.chain(wheelsets).collect();
        let mut stand = Stand::new(case);
        if let Ok(stand) = &mut stand {
            stand.model.layout = Layout::tangent(case.track.length);
        }
        let rest = stand.as_mut().ok().map(settle);
        Self { case, things, stand, rest }
    }

    pub fn model(&self) -> Option<&Model> {
        self.stand.as_ref().ok().map(|s| &s.model)
    }

    pub fn standing(&self) -> Option<&Rest> {
        self.rest.as_ref().and_then(|r| r.as_ref().ok())
    }

    pub fn thing(&self, name: &str) -> Option<(usize, &Thing<'c>)> {
        self.things.iter().enumerate().find(|(_, t)| t.name == name)
    }

    pub fn connections(&self) -> &'c [Connection] {
        &self.case.vehicle.connections
    }

    /// Connections by name: the model has them in its own order.
    pub fn by_name(&self) -> BTreeMap<&'c str, &'c Connection> {
        self.connections().iter().map(|c| (c.name.as_str(), c)).collect()
    }
}

fn settle(stand: &mut Stand) -> Result<Rest, Error> {
    let x = stand.settle(0.0)?;
    let mut system = stand.system(0.0);
    let mut dx = vec![0.0; x.len()];
    system.rhs(0.0, &x, &mut dx);
    let loads = system.scratch.wheels.iter().map(|w| [w[0].Q, w[1].Q]).collect();
    let modes = modes(&stand.model, &mut system, &x, &stand.held).unwrap_or_default();
    Ok(Rest { x, loads, modes })
}
