//! Named parameters: `[parameters.<group>]`, overridden from outside (`set`) and by `[condition.<name>]`, referred to
//! as `"$group.key"` or `"-$group.key"` wherever a number stands.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Number;

use super::check::unknown;
use super::node::{Node, Value};
use crate::error::{Fault, KeyPath};

/// Groups that would be mistaken for keys of a spec on the command line (`--set run.speed_kmh=80`).
pub(super) const REFUSED_GROUPS: [&str; 5] = ["condition", "run", "test", "track", "vehicle"];

/// A table of numbers by dotted name, e.g. `secondary.kz`; each a number or a reference.
pub(super) type Named = BTreeMap<String, Node>;

/// Reads nested tables of numbers into dotted names. A dot inside a key counts as nesting.
pub(super) fn flatten(node: &Node, faults: &mut Vec<Fault>) -> Named {
    let mut named = Named::new();
    flatten_into(node, "", &mut named, faults);
    named
}

fn flatten_into(node: &Node, prefix: &str, named: &mut Named, faults: &mut Vec<Fault>) {
    let Some(map) = node.table() else {
        faults.push(Fault::new(node.at.clone(), node.found(), "a table of named numbers"));
        return;
    };
    for (key, item) in map {
        let name = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
        match &item.value {
            Value::Table(_) => flatten_into(item, &name, named, faults),
            _ if is_value(item) => {
                if let Some(first) = named.insert(name, item.clone()) {
                    faults.push(Fault::new(
                        item.at.clone(),
                        format!("the name of {}", first.at),
                        "a name once",
                    ));
                }
            }
            _ => {
                faults.push(Fault::new(item.at.clone(), item.found(), A_VALUE));
                let known = Node { value: Value::Faulty, ..item.clone() };
                named.insert(name, known);
            }
        }
    }
}

const A_VALUE: &str = "a number, or a reference as \"$group.key\" or \"-$group.key\"";

/// A number or something that is meant as a reference.
fn is_value(node: &Node) -> bool {
    match &node.value {
        Value::Number(_) => true,
        Value::Text(text) => reference(text).is_some(),
        _ => false,
    }
}

/// `[parameters]` with its own rules: grouped, and no group of a refused name.
pub(super) fn read_parameters(root: &Node, faults: &mut Vec<Fault>) -> Named {
    let Some(node) = root.get("parameters") else { return Named::new() };
    for (group, item) in node.table().into_iter().flatten() {
        let head = group.split('.').next().unwrap_or_default();
        if REFUSED_GROUPS.contains(&head) {
            let refused = format!("any name but {}", REFUSED_GROUPS.join(", "));
            faults.push(
                Fault::new(item.at.clone(), format!("the group name {head}"), refused)
                    .hint("on the command line these are keys of the spec"),
            );
        } else if item.table().is_none() && !group.contains('.') {
            let allowed = "a number in a group, as [parameters.group]";
            faults.push(Fault::new(item.at.clone(), "a number without a group", allowed));
        }
    }
    flatten(node, faults)
}

/// Replaces parameters by `other`, which may only name existing ones.
pub(super) fn override_with(parameters: &mut Named, other: &Named, faults: &mut Vec<Fault>) {
    for (name, value) in other {
        if !parameters.contains_key(name) {
            faults.push(unknown_parameter(value.at.clone(), name, parameters));
        } else if matches!(value.value, Value::Faulty) {
            parameters.insert(name.clone(), value.clone());
        } else if !is_value(value) {
            faults.push(Fault::new(value.at.clone(), value.found(), A_VALUE));
        } else {
            parameters.insert(name.clone(), value.clone());
        }
    }
}

/// The fault for a name that is no parameter: shows the names of its group, or else the groups.
pub(super) fn unknown_parameter(at: KeyPath, name: &str, known: &Named) -> Fault {
    let group = |name: &str| name.rsplit_once('.').map(|(group, _)| group.to_owned());
    let own = group(name);
    let beside: Vec<&str> =
        known.keys().map(String::as_str).filter(|other| own.is_some() && group(other) == own).collect();
    let allowed = if known.is_empty() {
        "a named parameter of the vehicle, which has none".to_owned()
    } else if beside.is_empty() {
        let groups: BTreeSet<String> = known.keys().filter_map(|name| group(name)).collect();
        format!("a named parameter, in {}", groups.into_iter().collect::<Vec<_>>().join(", "))
    } else {
        format!("a named parameter: {}", beside.join(", "))
    };
    let found = format!("the unknown name {name}");
    unknown(at, found, allowed, name, known.keys().map(String::as_str))
}

/// Name and sign, if the text is a reference.
pub(super) fn reference(text: &str) -> Option<(bool, &str)> {
    let (negative, rest) = match text.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, text),
    };
    rest.strip_prefix('$').map(|name| (negative, name))
}

/// Every parameter as a number; parameters that refer to parameters are followed.
pub(super) fn evaluate(parameters: &Named, faults: &mut Vec<Fault>) -> BTreeMap<String, Number> {
    let mut numbers = BTreeMap::new();
    for (name, start) in parameters {
        let mut node = start;
        let mut negative = false;
        // A chain longer than there are parameters has come round to where it was.
        for steps in 0.. {
            match &node.value {
                Value::Number(n) => {
                    numbers.insert(name.clone(), signed(n, negative));
                    break;
                }
                Value::Text(text) => {
                    let Some((minus, target)) = reference(text) else { break };
                    if steps > parameters.len() {
                        let found = format!("{}, which comes back to itself", start.found());
                        faults.push(Fault::new(start.at.clone(), found, "references that end at a number"));
                        break;
                    }
                    let Some(next) = parameters.get(target) else {
                        if steps == 0 {
                            faults.push(unknown_parameter(node.at.clone(), target, parameters));
                        }
                        break;
                    };
                    negative ^= minus;
                    node = next;
                }
                _ => break,
            }
        }
    }
    numbers
}

fn signed(n: &Number, negative: bool) -> Number {
    if !negative {
        return n.clone();
    }
    n.as_f64().and_then(|x| Number::from_f64(-x)).unwrap_or_else(|| n.clone())
}

/// Replaces every reference below `node` by its number. `known` tells a parameter that has no value (its own
/// fault has been said) from one that does not exist.
pub(super) fn resolve(
    node: &mut Node,
    numbers: &BTreeMap<String, Number>,
    known: &Named,
    faults: &mut Vec<Fault>,
) {
    match &mut node.value {
        Value::List(items) => items.iter_mut().for_each(|item| resolve(item, numbers, known, faults)),
        Value::Table(map) => map.values_mut().for_each(|item| resolve(item, numbers, known, faults)),
        Value::Text(text) => {
            let Some((negative, name)) = reference(text) else { return };
            match numbers.get(name) {
                Some(n) => {
                    let n = signed(n, negative);
                    node.via = Some(text.clone());
                    node.value = Value::Number(n);
                }
                None => {
                    if !known.contains_key(name) {
                        faults.push(unknown_parameter(node.at.clone(), name, known));
                    }
                    node.value = Value::Faulty;
                }
            }
        }
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Faulty => {}
    }
}
