//! What others than the simulator need to know of a vehicle: procedures before any case exists, drawings and checks of it.

use serde_json::{Map, Value as Json, json};

use super::document::{Document, finish};
use super::node::Node;
use super::vehicle::{Connection, Vehicle};
use crate::error::Result;

/// What procedures need to know of a vehicle before any case exists, as JSON: `document` (with the overrides in its
/// `parameters`), `name`, `title`, `design_speed` (m/s), `wheel_radius` (m, of the first wheelset), `wheel_profile`, `track`,
/// `conditions`, `design_condition`, and in `condition` or else the design condition `mass` (kg, all bodies), `bodies` (names)
/// and `model`: the vehicle with its templates copied, its references replaced and its mirrored elements made.
///
/// `model` has `written` (the document after expansion, its keys as in the file), `bodies` and `wheelsets` (`name`, `mass`,
/// `inertia`, `position`; `radius`, `tape_half_distance`), `connections` (`name`, two `points`, `element`: its place in
/// `written.connection`, `mirrored`: made from that of the other side) and `sensors` (`name`, `body`, `position`); kg, m, in
/// vehicle axes.
///
/// `overrides` are named parameters as `--set` gives them: dotted name to number or reference.
///
/// # Errors
/// [`crate::Error::Input`] with every fault; those of an override have the key `set.<name>`, all others start with `vehicle`.
pub fn resolve_summary(
    document: &Json,
    overrides: &Map<String, Json>,
    condition: Option<&str>,
) -> Result<Json> {
    let mut faults = Vec::new();
    let mut changed = document.clone();
    let mut read = Document::read(document, &mut faults);
    read.set(&mut changed, overrides, &mut faults);
    read.refuse_hidden(overrides, condition.unwrap_or(read.design_condition()), &mut faults);
    let whole = read.expand(condition, &mut faults);
    let vehicle = read.build(&whole, condition, &mut faults);
    let vehicle = finish(vehicle, faults)?;
    let bodies: Vec<&str> = vehicle
        .bodies
        .iter()
        .map(|b| b.name.as_str())
        .chain(vehicle.wheelsets.iter().map(|w| w.name.as_str()))
        .collect();
    Ok(json!({
        "document": changed,
        "name": vehicle.name,
        "title": vehicle.title,
        "design_speed": vehicle.design_speed,
        "wheel_radius": vehicle.wheelsets.first().map(|w| w.radius),
        "wheel_profile": vehicle.wheel_profile,
        "track": vehicle.track,
        "conditions": read.condition_names().collect::<Vec<_>>(),
        "design_condition": vehicle.design_condition,
        "mass": vehicle.mass(),
        "bodies": bodies,
        "model": model(&whole, &vehicle),
    }))
}

fn model(whole: &Node, vehicle: &Vehicle) -> Json {
    let bodies = vehicle
        .bodies
        .iter()
        .map(|b| json!({ "name": b.name, "mass": b.mass, "inertia": b.inertia, "position": b.position }));
    let wheelsets = vehicle.wheelsets.iter().map(|w| {
        json!({
            "name": w.name, "mass": w.mass, "inertia": w.inertia, "position": w.position,
            "radius": w.radius, "tape_half_distance": w.tape_half_distance,
        })
    });
    let sensors =
        vehicle.sensors.iter().map(|s| json!({ "name": s.name, "body": s.body, "position": s.position }));
    json!({
        "written": whole.to_json(),
        "bodies": bodies.collect::<Vec<_>>(),
        "wheelsets": wheelsets.collect::<Vec<_>>(),
        "connections": connections(whole, &vehicle.connections),
        "sensors": sensors.collect::<Vec<_>>(),
    })
}

/// Each written connection has made one, a mirrored one two: right, then left.
fn connections(whole: &Node, made: &[Connection]) -> Vec<Json> {
    let mut made = made.iter();
    let mut out = Vec::new();
    for (element, node) in whole.get("connection").map_or(&[][..], Node::items).iter().enumerate() {
        let copies = if node.get("mirror").is_some_and(Node::is_true) { 2 } else { 1 };
        out.extend(made.by_ref().take(copies).enumerate().map(|(copy, c)| {
            json!({ "name": c.name, "points": c.points, "element": element, "mirrored": copy > 0 })
        }));
    }
    out
}
