//! From what was written to a [`Vehicle`]: mirrored connections, names, and the checks that a schema cannot say.

use std::collections::BTreeMap;

use super::check::unknown;
use super::node::{Node, quoted};
use super::vehicle::{Body, Connection, Gap, Sensor, Shape, Vehicle, Wheelset};
use super::written::{WrittenConnection, WrittenGap, WrittenVehicle};
use crate::connection::ForceLaw;
use crate::error::{Fault, KeyPath, Segment};

/// Turns what was written into a [`Vehicle`].
pub(super) struct Builder<'a> {
    root: &'a Node,
    faults: &'a mut Vec<Fault>,
}

impl<'a> Builder<'a> {
    /// `root` is the tree that `written` was read from.
    pub fn new(root: &'a Node, faults: &'a mut Vec<Fault>) -> Self {
        Self { root, faults }
    }

    /// All of it, unless something is wrong.
    pub fn vehicle(mut self, written: WrittenVehicle, condition: &str) -> Option<Vehicle> {
        let before = self.faults.len();
        let bodies: Vec<Body> = written
            .body
            .into_iter()
            .zip(self.nodes("body"))
            .map(|(b, node)| Body {
                name: b.name,
                mass: b.mass,
                inertia: b.inertia,
                position: b.position,
                guided: b.guided,
                key: node.at.clone(),
            })
            .collect();
        let wheelsets: Vec<Wheelset> = written
            .wheelset
            .into_iter()
            .zip(self.nodes("wheelset"))
            .map(|(w, node)| Wheelset {
                name: w.name,
                mass: w.mass,
                inertia: w.inertia,
                position: [w.position[0], w.position[1], -w.radius],
                radius: w.radius,
                tape_half_distance: w.tape_half_distance,
                key: node.at.clone(),
            })
            .collect();
        if wheelsets.is_empty() {
            self.fault(Fault::new(self.root.at.key("wheelset"), "no wheelset", "one or more"));
        }
        let connections: Vec<Connection> = written
            .connection
            .into_iter()
            .zip(self.nodes("connection"))
            .flat_map(|(c, node)| self.connection(c, node))
            .collect();
        let sensors: Vec<Sensor> = written
            .sensor
            .into_iter()
            .zip(self.nodes("sensor"))
            .map(|(s, node)| {
                self.name(&s.name, &node.at);
                Sensor {
                    name: format!("{}.{}", s.body, s.name),
                    body: s.body,
                    position: s.position,
                    key: node.at.clone(),
                }
            })
            .collect();

        let gaps: Vec<Gap> =
            written.gap.into_iter().zip(self.nodes("gap")).flat_map(|(g, node)| self.gap(g, node)).collect();

        let named: Vec<(&str, &KeyPath)> = bodies
            .iter()
            .map(|b| (b.name.as_str(), &b.key))
            .chain(wheelsets.iter().map(|w| (w.name.as_str(), &w.key)))
            .collect();
        for (name, key) in &named {
            self.name(name, key);
        }
        let names: Vec<&str> = named.iter().map(|(name, _)| *name).collect();
        let others = connections.iter().map(|c| (c.name.as_str(), &c.key));
        let others = others.chain(gaps.iter().map(|g| (g.name.as_str(), &g.key)));
        self.unique(named.iter().copied().chain(others));
        self.unique(sensors.iter().map(|s| (s.name.as_str(), &s.key)));
        let pairs = connections.iter().map(|c| (&c.between, &c.key));
        for (between, key) in pairs.chain(gaps.iter().map(|g| (&g.between, &g.key))) {
            for (i, body) in between.iter().enumerate() {
                self.body(body, key.key("between").index(i), &names);
            }
            if between[0] == between[1] {
                let found = format!("{0} and {0}", between[0]);
                self.fault(Fault::new(key.key("between"), found, "two different bodies"));
            }
        }
        for s in &sensors {
            self.body(&s.body, s.key.key("body"), &names);
        }
        for (kind, placed) in [
            ("equipment", written.equipment.iter().map(|e| e.body.as_str()).collect::<Vec<_>>()),
            ("shape", written.shape.iter().map(Shape::body).collect()),
        ] {
            for (body, node) in placed.into_iter().zip(self.nodes(kind)) {
                self.body(body, node.at.key("body"), &names);
            }
        }
        for (i, piece) in written.equipment.iter().enumerate() {
            self.name(&piece.name, &self.root.at.key("equipment").index(i));
        }
        for (case, loads) in &written.load_case {
            for (i, load) in loads.iter().enumerate() {
                self.body(&load.body, self.root.at.key("load_case").key(case).index(i).key("body"), &names);
            }
        }
        if !written._include.is_empty() {
            let allowed = "a document with its included files already in it, as `lmap` makes it";
            self.fault(Fault::new(self.root.at.key("include"), "files to include", allowed));
        }
        if let Some(hold) = &written.speed_hold {
            self.body(&hold.body, self.root.at.key("speed_hold").key("body"), &names);
        }
        if let Some(traction) = &written.traction {
            let found = traction.faults(&self.root.at.key("traction"));
            self.faults.extend(found);
        }
        if let Some(air) = &written.air_brake {
            let key = self.root.at.key("air_brake").key("block_friction");
            self.rising(&air.block_friction, "m/s", &key);
        }
        if let Some(parking) = &written.parking_brake {
            let sets: Vec<&str> = wheelsets.iter().map(|w| w.name.as_str()).collect();
            for (i, set) in parking.wheelsets.iter().enumerate() {
                if !sets.contains(&set.as_str()) {
                    let at = self.root.at.key("parking_brake").key("wheelsets").index(i);
                    let allowed = format!("a wheelset: {}", sets.join(", "));
                    self.fault(unknown(at, quoted(set), allowed, set, sets.iter().copied()));
                }
            }
        }
        (self.faults.len() == before).then_some(Vehicle {
            name: written.name,
            title: written.title,
            design_speed: written.design_speed_kmh / 3.6,
            wheel_profile: written.wheel_profile,
            track: written.track,
            condition: condition.to_owned(),
            design_condition: written.design_condition,
            bodies,
            wheelsets,
            connections,
            sensors,
            gaps,
            speed_hold: written.speed_hold,
            contact: written.contact,
            outline: written.outline,
            traction: written.traction,
            dynamic_brake: written.dynamic_brake,
            air_brake: written.air_brake,
            parking_brake: written.parking_brake,
            equipment: written.equipment,
            shapes: written.shape,
            load_cases: written.load_case,
        })
    }

    fn nodes(&self, kind: &str) -> &'a [Node] {
        let root: &'a Node = self.root;
        root.get(kind).map_or(&[], Node::items)
    }

    /// One connection, or the two of a mirrored one.
    fn connection(&mut self, c: WrittenConnection, node: &Node) -> Vec<Connection> {
        self.name(&c.name, &node.at);
        for fault in c.law.faults(&KeyPath::default()) {
            // The law knows its own keys only; the tree knows where their numbers were written, and how.
            let place = node.deepest(&fault.key.0);
            let is_number = place.number().is_some() && fault.found.parse::<f64>().is_ok();
            let found = if is_number { place.found() } else { fault.found.clone() };
            let missing = matches!(&fault.key.0[..], [Segment::Key(key)] if node.get(key).is_none());
            let key =
                if missing { KeyPath([&node.at.0[..], &fault.key.0].concat()) } else { place.at.clone() };
            self.faults.push(Fault { key, found, ..fault });
        }
        let points = match (c.position, c.positions) {
            (Some(point), None) => [point, point],
            (None, Some(points)) => points,
            (Some(_), Some(_)) => {
                let allowed = "position (ends coincide) or positions (two ends), not both";
                self.fault(Fault::new(node.at.key("positions"), "position and positions", allowed));
                return Vec::new();
            }
            (None, None) => {
                let allowed = "position = [x, y, z], or positions = [[x, y, z], [x, y, z]], m";
                self.fault(Fault::new(node.at.key("position"), "nothing", allowed));
                return Vec::new();
            }
        };
        if c.preload.is_some() && c.carries_weight {
            let allowed = "a given preload, or carries_weight = true, for which it is solved";
            self.fault(Fault::new(node.at.key("preload"), "preload and carries_weight", allowed));
        }
        let one = |name: String, points| Connection {
            name,
            between: c.between.clone(),
            points,
            law: c.law.clone(),
            preload: c.carries_weight,
            force: c.preload,
            axes: c.axes,
            key: node.at.clone(),
        };
        if !c.mirror {
            return vec![one(c.name.clone(), points)];
        }
        if points[0][1] <= 0.0 {
            let allowed = "y > 0 m: the right one, from which the left one is made";
            let key = node.get("position").or(node.get("positions")).map_or(&node.at, |n| &n.at);
            self.fault(Fault::new(key.clone(), format!("mirror = true with y = {}", points[0][1]), allowed));
            return Vec::new();
        }
        let right = one(format!("{}_right", c.name), points);
        let left = Connection {
            name: format!("{}_left", c.name),
            points: points.map(|[x, y, z]| [x, -y, z]),
            law: c.law.mirrored(),
            force: c.preload.map(|[x, y, z]| [x, -y, z]),
            axes: c.axes.map(|[roll, pitch, yaw]| [-roll, pitch, -yaw]),
            ..right.clone()
        };
        vec![right, left]
    }

    /// Points of a curve: places that rise, values that are not negative.
    fn rising(&mut self, points: &[[f64; 2]], unit: &str, at: &KeyPath) {
        let mut before = f64::NEG_INFINITY;
        for (i, [x, y]) in points.iter().enumerate() {
            if !(x.is_finite() && *x >= 0.0 && *x > before) {
                let allowed = format!("numbers >= 0 {unit}, each above the one before");
                self.fault(Fault::new(at.index(i).index(0), format!("{x} {unit}"), allowed));
            }
            if !(y.is_finite() && *y >= 0.0) {
                self.fault(Fault::new(at.index(i).index(1), y.to_string(), "a number >= 0"));
            }
            before = *x;
        }
    }

    /// One gap, or the two of a mirrored one.
    fn gap(&mut self, g: WrittenGap, node: &Node) -> Vec<Gap> {
        self.name(&g.name, &node.at);
        let [from, to] = g.positions;
        if from == to {
            let allowed = "two points apart: their distance is the clearance";
            self.fault(Fault::new(node.at.key("positions"), "the same point twice", allowed));
            return Vec::new();
        }
        let one = |suffix: &str, points| Gap {
            name: format!("{}{suffix}", g.name),
            between: g.between.clone(),
            points,
            key: node.at.clone(),
        };
        if !g.mirror {
            return vec![one("", g.positions)];
        }
        if from[1] <= 0.0 {
            let allowed = "y > 0 m: the right one, from which the left one is made";
            let found = format!("mirror = true with y = {}", from[1]);
            self.fault(Fault::new(node.at.key("positions"), found, allowed));
            return Vec::new();
        }
        vec![one("_right", g.positions), one("_left", g.positions.map(|[x, y, z]| [x, -y, z]))]
    }

    /// Names become parts of channel names, so they are words without dots.
    fn name(&mut self, name: &str, at: &KeyPath) {
        let mut letters = name.chars();
        let starts = letters.next().is_some_and(|c| c.is_ascii_alphabetic());
        if !starts || !letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
            let allowed = "a letter, then letters, digits and _";
            self.fault(Fault::new(at.key("name"), quoted(name), allowed));
        }
    }

    fn unique<'n>(&mut self, named: impl Iterator<Item = (&'n str, &'n KeyPath)>) {
        let mut first: BTreeMap<&str, &KeyPath> = BTreeMap::new();
        for (name, key) in named {
            if let Some(other) = first.get(name) {
                let found = format!("{}, the name of {other} too", quoted(name));
                self.faults.push(Fault::new(key.key("name"), found, "each name once"));
            } else {
                first.insert(name, key);
            }
        }
    }

    fn body(&mut self, name: &str, at: KeyPath, names: &[&str]) {
        if !names.contains(&name) {
            let allowed = format!("a body or wheelset: {}", names.join(", "));
            self.faults.push(unknown(at, quoted(name), allowed, name, names.iter().copied()));
        }
    }

    fn fault(&mut self, fault: Fault) {
        self.faults.push(fault);
    }
}
