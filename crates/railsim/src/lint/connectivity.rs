//! LM2: what holds what.

use super::Report;
use super::subject::Subject;
use crate::connection::Law;
use crate::math::Vec3;
use crate::schema::Connection;

pub(super) fn find(subject: &Subject<'_>, report: &mut Report) {
    held(subject, report);
    no_effect(subject, report);
    duplicates(subject, report);
}

/// For each body whether connections of a kind lead from it to a wheelset or a guided body.
fn reaches(subject: &Subject<'_>, counts: impl Fn(&Connection) -> bool) -> Vec<bool> {
    let mut reached: Vec<bool> = subject.things.iter().map(|t| t.is_wheelset || t.guided).collect();
    let ends: Vec<[usize; 2]> = subject
        .connections()
        .iter()
        .filter(|c| counts(c))
        .filter_map(|c| Some([subject.thing(&c.between[0])?.0, subject.thing(&c.between[1])?.0]))
        .collect();
    for _ in 0..subject.things.len() {
        for [a, b] in &ends {
            let either = reached[*a] || reached[*b];
            (reached[*a], reached[*b]) = (either, either);
        }
    }
    reached
}

fn held(subject: &Subject<'_>, report: &mut Report) {
    let connected = reaches(subject, |_| true);
    let carried = reaches(subject, |c| c.preload);
    for (i, thing) in subject.things.iter().enumerate() {
        let names = |c: &&Connection| c.between.iter().any(|name| name == thing.name);
        let own = subject.connections().iter().filter(names).count();
        if own == 0 {
            report.add(
                "LM201",
                thing.name,
                thing.key.clone(),
                "no connection to it",
                "connections that hold a body",
            );
        } else if !connected[i] {
            let found = format!("{own} connection(s) that lead to no wheelset");
            report.add("LM202", thing.name, thing.key.clone(), found, "a way to the wheels");
        } else if !carried[i] {
            let found = format!("{own} connection(s) that carry no weight to the wheels");
            let usual = "`carries_weight = true` on the springs below it";
            report.add("LM203", thing.name, thing.key.clone(), found, usual);
        }
    }
}

/// Whether a law can push or resist at all.
fn is_idle(law: &Law) -> bool {
    let zero = |values: &[f64]| values.iter().all(|v| *v == 0.0);
    match law {
        Law::Bushing(b) => {
            zero(&b.stiffness)
                && zero(&b.damping)
                && zero(&b.rotational_stiffness.unwrap_or_default())
                && zero(&b.rotational_damping.unwrap_or_default())
        }
        Law::BushingMatrix(b) => zero(b.stiffness.as_flattened()) && zero(b.damping.as_flattened()),
        Law::AntiRollBar(bar) => bar.stiffness == 0.0 && bar.damping == 0.0,
        Law::PointDamper(damper) => damper.damping == Some(0.0),
        Law::PointSpring(spring) => spring.stiffness == Some(0.0),
        Law::Friction(friction) => friction.force == 0.0,
        _ => false,
    }
}

fn no_effect(subject: &Subject<'_>, report: &mut Report) {
    for c in subject.connections().iter().filter(|c| is_idle(&c.law)) {
        let found = format!("a `{}` of zeros", c.law.kind());
        report.add("LM204", &c.name, c.key.clone(), found, "stiffness or damping above 0");
    }
}

/// Whether two connections join the same bodies at the same points.
pub(super) fn same_place(a: &Connection, b: &Connection) -> bool {
    const SAME: f64 = 1e-3;
    let near = |i: usize, j: usize| (Vec3::from(a.points[i]) - Vec3::from(b.points[j])).norm() < SAME;
    let joins = |i: usize, j: usize| a.between[0] == b.between[i] && a.between[1] == b.between[j];
    (joins(0, 1) && near(0, 0) && near(1, 1)) || (joins(1, 0) && near(0, 1) && near(1, 0))
}

fn duplicates(subject: &Subject<'_>, report: &mut Report) {
    let all = subject.connections();
    for (i, c) in all.iter().enumerate() {
        // Springs are nested, dampers are not doubled: what is equal in everything was pasted twice.
        let twin = all[..i].iter().find(|o| same_place(o, c) && o.law == c.law && o.axes == c.axes);
        if let Some(other) = twin.filter(|o| !is_idle(&o.law)) {
            let found = format!("the same as {}", other.name);
            report.add("LM205", &c.name, c.key.clone(), found, "one connection, or different ones");
        }
    }
}
