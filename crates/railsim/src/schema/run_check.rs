//! What holds between the keys of `run`: which of them a kind of run needs, which it has no use for.

use super::check;
use super::drive::Until;
use super::node::Node;
use super::run::{Load, Run, RunKind, Search};
use crate::error::Fault;

/// Keys that only some kinds of run have a use for, with those kinds.
const OWNED: [(&str, &[RunKind]); 11] = [
    ("disturbance", &[RunKind::Time, RunKind::CriticalSpeed]),
    ("start", &[RunKind::Time]),
    ("place", &[RunKind::Equilibrium, RunKind::QuasiStatic, RunKind::Modal, RunKind::CriticalSpeed]),
    ("hold", &[RunKind::Equilibrium, RunKind::QuasiStatic, RunKind::Modal, RunKind::CriticalSpeed]),
    ("speeds", &[RunKind::Modal]),
    ("load", &[RunKind::QuasiStatic]),
    ("load_steps", &[RunKind::QuasiStatic]),
    ("search", &[RunKind::CriticalSpeed]),
    ("drive", &[RunKind::Time, RunKind::AirBrake]),
    ("train", &[RunKind::Time, RunKind::AirBrake]),
    ("couplers", &[RunKind::Time]),
];

/// Speeds that a search looks at, at most; more is a slip of the pen.
const MOST_SPEEDS: f64 = 1000.0;

/// Fastest that any run may be, m/s: 720 km/h, beyond all that has run on wheels and rails (574.8 km/h, 2007). More is km/h given as m/s.
const MOST_SPEED: f64 = 200.0;

/// What is said of a key that only a driven run has a use for.
const BESIDE_DRIVE: &str = "this key beside run.drive";

/// Every fault of relation; those of structure are said elsewhere.
pub(super) fn relations(node: &Node, faults: &mut Vec<Fault>) {
    // A key that is missing or out of range is said by the structural check, and there is no telling the rest.
    let Some(run) = check::read::<Run>(node, &mut Vec::new()) else { return };
    for (key, kinds) in OWNED {
        if let Some(found) = node.get(key)
            && !kinds.contains(&run.kind)
        {
            let names: Vec<_> = kinds.iter().map(|k| format!("\"{}\"", k.name())).collect();
            let allowed = format!("this key with run.kind = {}", names.join(", "));
            faults.push(Fault::new(found.at.clone(), format!("it with \"{}\"", run.kind.name()), allowed));
        }
    }
    too_fast(node, &run, faults);
    let stepped = match (run.kind, &run.search) {
        (RunKind::Time, _) => true,
        (RunKind::CriticalSpeed, Some(search)) => !matches!(search, Search::Linear { .. }),
        _ => false,
    };
    if stepped {
        needs(
            node,
            "integrator",
            "a table with kind = \"heun\", \"heun_controlled\", \"rk4\", \"ros2\"",
            faults,
        );
        needs(node, "output_step", "a number > 0 s", faults);
        if run.speed <= 0.0 && run.drive.is_none() {
            at(node, "speed", "a number > 0 m/s, or 0 with run.drive", faults);
        }
        if !run.hold.is_empty() {
            at(node, "hold", "nothing where time is stepped", faults);
        }
    }
    drive(node, &run, faults);
    match run.kind {
        RunKind::QuasiStatic => loads(node, &run, faults),
        RunKind::CriticalSpeed => match &run.search {
            Some(search) => searching(node, &run, search, faults),
            None => needs(
                node,
                "search",
                "a table with method = \"linear\", \"ramp_down\", \"bifurcation\"",
                faults,
            ),
        },
        _ => {}
    }
}

/// Speeds beyond [`MOST_SPEED`], wherever a run has one.
fn too_fast(node: &Node, run: &Run, faults: &mut Vec<Fault>) {
    fn items<'a>(table: &'a Node, key: &str) -> &'a [Node] {
        table.get(key).map_or(&[], Node::items)
    }
    let loads = items(node, "load").iter().zip(&run.load);
    let paths = loads.filter(|(_, load)| matches!(load, Load::Speed { .. }));
    let speeds = node
        .get("speed")
        .into_iter()
        .chain(items(node, "speeds"))
        .chain(paths.flat_map(|(table, _)| items(table, "path")))
        .chain(node.get("search").into_iter().flat_map(|search| items(search, "range")));
    for found in speeds {
        let Some(v) = found.number().filter(|v| *v > MOST_SPEED) else { continue };
        let allowed = format!("at most {MOST_SPEED} m/s, which is {} km/h", 3.6 * MOST_SPEED);
        let hint = format!("{v} km/h is {} m/s", (v / 0.036).round() / 100.0);
        faults.push(Fault::new(found.at.clone(), format!("{v} m/s"), allowed).hint(hint));
    }
}

/// What holds between `drive`, `train` and the rest.
fn drive(node: &Node, run: &Run, faults: &mut Vec<Fault>) {
    faults.extend(run.couplers.iter().flat_map(|couplers| couplers.faults(&node.at.key("couplers"))));
    let Some(drive) = &run.drive else {
        if run.train.is_some() {
            at(node, "train", BESIDE_DRIVE, faults);
        }
        if let (Some(table), Some(couplers)) = (node.get("couplers"), &run.couplers) {
            for (key, forces) in [("front", &couplers.front), ("rear", &couplers.rear)] {
                if !forces.is_empty() {
                    at(table, key, BESIDE_DRIVE, faults);
                }
            }
        }
        if run.kind == RunKind::AirBrake {
            needs(node, "drive", "a table: what the brakes are asked for", faults);
        }
        return;
    };
    let Some(table) = node.get("drive") else { return };
    faults.extend(drive.faults(&table.at));
    faults.extend(run.train.iter().flat_map(|train| train.faults(&node.at.key("train"))));
    if run.kind == RunKind::AirBrake {
        needs(node, "output_step", "a number > 0 s", faults);
        if drive.until.time.is_none() {
            faults.push(Fault::new(
                table.at.key("until").key("time"),
                "nothing",
                "the time that it takes, s",
            ));
        }
        return;
    }
    if run.speed <= 0.0 && drive.until == Until::default() {
        faults.push(Fault::new(
            table.at.key("until"),
            "nothing, from standstill",
            "time or speed_above: nobody knows when the end of the track is reached",
        ));
    }
    let ratio = drive.period / run.integrator.step();
    if ratio.round() < 1.0 || (ratio - ratio.round()).abs() > 1e-9 * ratio {
        let allowed = format!("a whole multiple of run.integrator.step = {} s", run.integrator.step());
        faults.push(Fault::new(table.at.key("period"), format!("{} s", drive.period), allowed));
    }
}

fn needs(node: &Node, key: &str, allowed: &str, faults: &mut Vec<Fault>) {
    if node.get(key).is_none() {
        faults.push(Fault::new(node.at.key(key), "nothing", allowed));
    }
}

/// A fault at a key that is there.
fn at(node: &Node, key: &str, allowed: &str, faults: &mut Vec<Fault>) {
    if let Some(found) = node.get(key) {
        faults.push(Fault::new(found.at.clone(), found.found(), allowed));
    }
}

fn loads(node: &Node, run: &Run, faults: &mut Vec<Fault>) {
    let Some(first) = run.load.first() else {
        needs(node, "load", "one load or more, each with a path of values", faults);
        at(node, "load", "one load or more, each with a path of values", faults);
        return;
    };
    let items = node.get("load").map_or(&[][..], Node::items);
    for (load, item) in run.load.iter().zip(items) {
        if load.path().len() != first.path().len() {
            let allowed = format!("{} values, as in the first load: all go in step", first.path().len());
            at(item, "path", &allowed, faults);
        }
        if let Load::Speed { path } = load
            && path.iter().any(|v| *v <= 0.0)
        {
            at(item, "path", "speeds above 0 m/s", faults);
        }
    }
}

fn searching(node: &Node, run: &Run, search: &Search, faults: &mut Vec<Fault>) {
    let Some(table) = node.get("search") else { return };
    match search {
        Search::Linear { range, spacing } => {
            at(node, "disturbance", "nothing where no time is stepped", faults);
            if range[0] >= range[1] {
                at(table, "range", "the lower speed first, m/s", faults);
            } else if spacing.is_some_and(|d| range[1] - range[0] > MOST_SPEEDS * d) {
                at(table, "spacing", &format!("at most {MOST_SPEEDS} speeds in the range"), faults);
            }
        }
        Search::RampDown { end_speed, .. } | Search::Bifurcation { end_speed, .. } => {
            if *end_speed >= run.speed {
                at(table, "end_speed", &format!("below run.speed = {} m/s", run.speed), faults);
            }
            if let Search::Bifurcation { speed_step, .. } = search
                && run.speed - end_speed > MOST_SPEEDS * speed_step
            {
                at(table, "speed_step", &format!("at most {MOST_SPEEDS} speeds"), faults);
            }
            if run.disturbance.values().all(|v| *v == 0.0) {
                let allowed =
                    "a coordinate and by how much, e.g. { \"carbody.y\" = 0.01 }: without it nothing moves";
                needs(node, "disturbance", allowed, faults);
                at(node, "disturbance", allowed, faults);
            }
        }
    }
}
