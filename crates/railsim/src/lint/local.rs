//! Stiffness and damping of connections about the design position, by differences of their forces: whatever the kind.
//!
//! Of body B as seen from body A: six motions (three of A's centre of mass carried with B, three turns about it) and the six forces
//! that go with them.

use std::collections::BTreeMap;

use nalgebra::{Matrix6, SymmetricEigen, Vector6};

use super::subject::Subject;
use crate::body::{Pose, Relative};
use crate::connection::Wrench;
use crate::dynamics::{Link, Model};
use crate::error::KeyPath;
use crate::math::{Mat3, Vec3, rotation};

/// Increments: m and rad; m/s and rad/s.
const INCREMENT: f64 = 1e-6;

fn join(w: &Wrench) -> Vector6<f64> {
    Vector6::new(w.f.x, w.f.y, w.f.z, w.m.x, w.m.y, w.m.z)
}

fn at_rest(model: &Model, link: &Link) -> Relative {
    let place = |i: usize| Pose::at(model.rigid(i).position);
    Relative::between(&place(link.a), &place(link.b))
}

/// Nothing of what laws remember is strained at rest.
fn memory(model: &Model) -> Vec<f64> {
    vec![0.0; model.map().size()]
}

/// Force on B at rest, N.
pub fn force(model: &Model, link: &Link) -> Vec3 {
    link.wrench(&at_rest(model, link), &memory(model)).f
}

fn moved(rest: &Relative, i: usize, by: f64) -> Relative {
    let mut motion = *rest;
    if i < 3 {
        motion.r_AB[i] += by;
    } else {
        let turn = [rotation::rot_x, rotation::rot_y, rotation::rot_z][i - 3](by);
        motion.r_AB = turn * rest.r_AB;
        motion.R_AB = turn * rest.R_AB;
    }
    motion
}

fn moving(rest: &Relative, i: usize, at: f64) -> Relative {
    let mut motion = *rest;
    if i < 3 {
        motion.v_AB[i] = at;
    } else {
        motion.w_AB[i - 3] = at;
        motion.v_AB = motion.w_AB.cross(&rest.r_AB);
    }
    motion
}

fn slopes(link: &Link, x: &[f64], motion: impl Fn(usize, f64) -> Relative) -> Matrix6<f64> {
    let mut slopes = Matrix6::zeros();
    for i in 0..6 {
        let at = |by: f64| join(&link.wrench(&motion(i, by), x));
        slopes.set_column(i, &((at(-INCREMENT) - at(INCREMENT)) / (2.0 * INCREMENT)));
    }
    0.5 * (slopes + slopes.transpose())
}

/// Stiffness of a link at rest.
pub fn stiffness(model: &Model, link: &Link) -> Matrix6<f64> {
    let rest = at_rest(model, link);
    slopes(link, &memory(model), |i, by| moved(&rest, i, by))
}

/// Damping of a link at rest; of one that remembers, without what goes through its memory.
pub fn damping(model: &Model, link: &Link) -> Matrix6<f64> {
    let rest = at_rest(model, link);
    slopes(link, &memory(model), |i, at| moving(&rest, i, at))
}

/// Inverse inertia of the motion of B against A, both free. Bodies that are led do not move; axle boxes do not turn with the
/// axle, so that nothing pitches them.
pub fn mobility(model: &Model, a: usize, b: usize) -> Matrix6<f64> {
    let r = model.rigid(b).position - model.rigid(a).position;
    let mut mobility = Matrix6::zeros();
    for (i, lever) in [(a, Vec3::zeros()), (b, r)] {
        if model.guided.contains(&i) {
            continue;
        }
        let body = model.rigid(i);
        let mut about = Mat3::from_diagonal(&body.inertia.map(|v| 1.0 / v));
        if i >= model.bodies.len() {
            about[(1, 1)] = 0.0;
        }
        // A wrench about A's centre of mass, seen from this body's.
        let mut shift = Matrix6::identity();
        shift.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-lever.cross_matrix()));
        let mut inverse = Matrix6::zeros();
        inverse.fixed_view_mut::<3, 3>(0, 0).copy_from(&(Mat3::identity() / body.mass));
        inverse.fixed_view_mut::<3, 3>(3, 3).copy_from(&about);
        mobility += shift.transpose() * inverse * shift;
    }
    mobility
}

/// Largest eigenvalue (rad/s) of two free bodies on a stiffness.
pub fn fastest(mobility: &Matrix6<f64>, stiffness: &Matrix6<f64>) -> f64 {
    let own = SymmetricEigen::new(*mobility);
    let root = own.eigenvectors
        * Matrix6::from_diagonal(&own.eigenvalues.map(|v| v.max(0.0).sqrt()))
        * own.eigenvectors.transpose();
    let squared = SymmetricEigen::new(root * stiffness * root).eigenvalues;
    squared.iter().fold(0.0_f64, |a, b| a.max(*b)).sqrt()
}

/// All connections between two bodies, as one.
pub struct Stage {
    pub a: usize,
    pub b: usize,
    pub stiffness: Matrix6<f64>,
    pub damping: Matrix6<f64>,
    /// Middle of the connections' ends, from the first body's centre of mass, m.
    pub centre: Vec3,
    /// A connection that damps through what it remembers (friction, damper in series) is among them.
    pub remembers: bool,
    /// Names of the connections.
    pub links: Vec<String>,
}

/// The pairs of bodies that connections join, in order.
pub fn stages(model: &Model) -> Vec<Stage> {
    let mut stages: BTreeMap<(usize, usize), Stage> = BTreeMap::new();
    for link in &model.links {
        let (a, b) = (link.a.min(link.b), link.a.max(link.b));
        let stage = stages.entry((a, b)).or_insert_with(|| Stage {
            a,
            b,
            stiffness: Matrix6::zeros(),
            damping: Matrix6::zeros(),
            centre: Vec3::zeros(),
            remembers: false,
            links: Vec::new(),
        });
        let turn = turned(model, link);
        stage.stiffness += turn.transpose() * stiffness(model, link) * turn;
        stage.damping += turn.transpose() * damping(model, link) * turn;
        let ends = link.levers()[0] + model.rigid(link.a).position - model.rigid(a).position;
        stage.centre += (ends - stage.centre) / (stage.links.len() + 1) as f64;
        stage.remembers |= !link.memory.is_empty();
        stage.links.push(link.name.clone());
    }
    stages.into_values().collect()
}

/// From motions about the centre of mass of the pair's first body to those about that of the link's A.
pub fn turned(model: &Model, link: &Link) -> Matrix6<f64> {
    let mut turn = Matrix6::identity();
    let to = model.rigid(link.a).position - model.rigid(link.a.min(link.b)).position;
    turn.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-to.cross_matrix()));
    turn
}

/// A connection that carries weight.
pub struct Carrier<'c> {
    pub name: &'c str,
    pub key: KeyPath,
    /// On B at rest, N.
    pub force: Vec3,
    /// How far the force would press it from nothing at the stiffness that it has at rest, m.
    pub deflection: f64,
}

/// Connections that carry weight in the design condition, and how far it deflects them.
pub fn carriers<'c>(subject: &Subject<'c>) -> Vec<Carrier<'c>> {
    let Some(model) = subject.model() else { return Vec::new() };
    let by_name = subject.by_name();
    let mut carriers = Vec::new();
    for link in &model.links {
        let Some(connection) = by_name.get(link.name.as_str()).filter(|c| c.preload) else { continue };
        let force = force(model, link);
        let Some(along) = force.try_normalize(0.0) else { continue };
        let k = link.nominal_stiffness();
        let deflection = force.norm() / along.dot(&(k * along));
        // The number that a person has to change, where the law has one for the vertical.
        let own = connection.key.key("stiffness");
        let key = if link.law.kind() == "bushing" { own.index(2) } else { own };
        carriers.push(Carrier { name: &connection.name, key, force, deflection });
    }
    carriers
}
