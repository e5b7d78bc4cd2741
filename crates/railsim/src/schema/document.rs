//! A vehicle document on its way to a [`Vehicle`]: overrides, condition, templates, references, structure, in this order.

use std::collections::BTreeMap;

use serde_json::{Map, Value as Json, json};

use super::build::Builder;
use super::check::{self, unknown};
use super::node::{Node, Value, quoted};
use super::parameter::{self, Named};
use super::template::{self, Elements, KINDS};
use super::vehicle::Vehicle;
use super::written::{
    WrittenBody, WrittenConnection, WrittenGap, WrittenSensor, WrittenVehicle, WrittenWheelset,
};
use crate::error::{Error, Fault, KeyPath, Result, Segment};

/// The value, or all faults, each once.
pub(super) fn finish<T>(value: Option<T>, faults: Vec<Fault>) -> Result<T> {
    match value {
        Some(value) if faults.is_empty() => Ok(value),
        _ => {
            let mut once: Vec<Fault> = Vec::with_capacity(faults.len());
            for fault in faults {
                if !once.contains(&fault) {
                    once.push(fault);
                }
            }
            Err(Error::Input(once))
        }
    }
}

/// A vehicle document with its named parameters and conditions read out.
pub(super) struct Document {
    root: Node,
    parameters: Named,
    conditions: BTreeMap<String, Named>,
}

impl Document {
    /// Reads parameters and conditions.
    pub fn read(document: &Json, faults: &mut Vec<Fault>) -> Self {
        let root = Node::from_json(document, KeyPath::of("vehicle"));
        let parameters = parameter::read_parameters(&root, faults);
        let mut conditions = BTreeMap::new();
        if let Some(node) = root.get("condition") {
            match node.table() {
                Some(map) => {
                    for (name, table) in map {
                        conditions.insert(name.clone(), parameter::flatten(table, faults));
                    }
                }
                None => faults.push(Fault::new(node.at.clone(), node.found(), "a table of conditions")),
            }
        }
        for named in conditions.values() {
            parameter::override_with(&mut parameters.clone(), named, faults);
        }
        Self { root, parameters, conditions }
    }

    /// Name of the design condition, as far as it can be read.
    pub fn design_condition(&self) -> &str {
        self.root.get("design_condition").and_then(Node::text).unwrap_or("full")
    }

    /// Names of all conditions.
    pub fn condition_names(&self) -> impl Iterator<Item = &str> {
        self.conditions.keys().map(String::as_str)
    }

    /// The vehicle in one condition.
    pub fn resolve(&self, condition: Option<&str>, faults: &mut Vec<Fault>) -> Option<Vehicle> {
        let whole = self.expand(condition, faults);
        self.build(&whole, condition, faults)
    }

    /// The same document with its lists expanded, every reference a number, and what made them so taken out.
    pub fn expand(&self, condition: Option<&str>, faults: &mut Vec<Fault>) -> Node {
        let (name, at) = match condition {
            Some(name) => (name, KeyPath::of("condition")),
            None => (self.design_condition(), self.root.at.key("design_condition")),
        };
        let mut parameters = self.parameters.clone();
        match self.conditions.get(name) {
            // Its unknown names have been said by `read`.
            Some(named) => parameter::override_with(&mut parameters, named, &mut Vec::new()),
            None => {
                let names: Vec<&str> = self.condition_names().collect();
                let allowed = if names.is_empty() {
                    "a [condition] of the vehicle, which has none".to_owned()
                } else {
                    format!("a [condition] of the vehicle: {}", names.join(", "))
                };
                faults.push(unknown(at, quoted(name), allowed, name, names));
            }
        }
        let numbers = parameter::evaluate(&parameters, faults);
        let (mut elements, spare) = template::expand(&self.root, &numbers, &parameters, faults);
        let mut whole = self.root.clone();
        if let Value::Table(map) = &mut whole.value {
            for key in ["parameters", "condition", "template", "use"].iter().chain(&KINDS) {
                map.remove(*key);
            }
            map.values_mut().for_each(|item| parameter::resolve(item, &numbers, &parameters, faults));
            for kind in KINDS {
                let items = elements.remove(kind).unwrap_or_default();
                let list = Node { at: self.root.at.key(kind), via: None, value: Value::List(items) };
                map.insert(kind.to_owned(), list);
            }
        }
        check_spare(&spare, faults);
        whole
    }

    /// The vehicle of an expanded document.
    pub fn build(&self, whole: &Node, condition: Option<&str>, faults: &mut Vec<Fault>) -> Option<Vehicle> {
        let written = check::read::<WrittenVehicle>(whole, faults)?;
        Builder::new(whole, faults).vehicle(written, condition.unwrap_or(self.design_condition()))
    }

    /// Sets named parameters as `--set` and `[set]` do, in the document too.
    pub fn set(&mut self, document: &mut Json, overrides: &Map<String, Json>, faults: &mut Vec<Fault>) {
        let at = KeyPath::of("set");
        let other: Named =
            overrides.iter().map(|(k, v)| (k.clone(), Node::from_json(v, at.key(k)))).collect();
        let places: BTreeMap<&String, KeyPath> =
            self.parameters.iter().map(|(name, node)| (name, node.at.clone())).collect();
        for (name, value) in overrides {
            if let Some(path) = places.get(name)
                && let Some(place) = place_of(document, &path.0[1..])
            {
                *place = value.clone();
            }
        }
        parameter::override_with(&mut self.parameters, &other, faults);
    }

    /// A fault for each overridden parameter that the chosen condition would override again, in silence.
    pub fn refuse_hidden(&self, overrides: &Map<String, Json>, condition: &str, faults: &mut Vec<Fault>) {
        let Some(named) = self.conditions.get(condition) else { return };
        for name in overrides.keys().filter(|name| named.contains_key(*name)) {
            let found = format!("a parameter that condition {condition} gives its own value");
            let allowed = "a parameter that the condition leaves alone";
            faults.push(
                Fault::new(KeyPath::of("set").key(name), found, allowed)
                    .hint("let the condition refer to a parameter of its own and set that one"),
            );
        }
    }
}

fn place_of<'a>(document: &'a mut Json, path: &[Segment]) -> Option<&'a mut Json> {
    path.iter().try_fold(document, |value, segment| match segment {
        Segment::Key(key) => value.get_mut(key),
        Segment::Index(i) => value.get_mut(i),
    })
}

fn check_spare(spare: &Elements, faults: &mut Vec<Fault>) {
    for (kind, items) in spare {
        for item in items {
            match *kind {
                "body" => check::structure::<WrittenBody>(item, faults),
                "connection" => check::structure::<WrittenConnection>(item, faults),
                "gap" => check::structure::<WrittenGap>(item, faults),
                "sensor" => check::structure::<WrittenSensor>(item, faults),
                _ => check::structure::<WrittenWheelset>(item, faults),
            }
        }
    }
}

/// JSON schema of a vehicle file, for editors. A number may also be a reference to a named parameter.
#[must_use]
pub fn vehicle_schema() -> Json {
    let mut schema = check::schema_of::<WrittenVehicle>();
    allow_references(&mut schema);
    schema
}

fn allow_references(schema: &mut Json) {
    match schema {
        Json::Object(map) => {
            map.values_mut().for_each(allow_references);
            let kind = map.get("type").and_then(Json::as_str);
            if matches!(kind, Some("number" | "integer")) {
                let mut number = std::mem::take(map);
                // What a person reads stays outside, where editors look for it.
                *map = ["description", "default"]
                    .into_iter()
                    .filter_map(|key| Some((key.to_owned(), number.remove(key)?)))
                    .collect();
                let reference = json!({ "type": "string", "pattern": r"^-?\$" });
                map.insert("anyOf".to_owned(), json!([Json::Object(number), reference]));
            }
        }
        Json::Array(items) => items.iter_mut().for_each(allow_references),
        _ => {}
    }
}
