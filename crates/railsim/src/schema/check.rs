//! Structure of a document: every unknown key, missing key, wrong type and number out of range, all at once.
//!
//! serde stops at the first fault and loses the key inside tagged enums. So the tree is first held against the
//! JSON schema that schemars derives from the very types that serde fills: what is allowed is said in one place
//! (the struct), editors see the same ranges, and a new kind of connection or integrator is checked without a
//! line here. Two words are added to JSON schema: `unit`, shown in messages, and the same ranges on a list hold for
//! each of its numbers.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use super::node::{Node, Value, quoted};
use crate::error::{Fault, KeyPath, Segment};

/// The JSON schema of `T` as plain JSON.
pub(super) fn schema_of<T: JsonSchema>() -> Json {
    schemars::schema_for!(T).to_value()
}

/// Holds `node` against the schema of `T` and, if nothing is wrong, reads it. Every fault goes to `faults`.
pub(super) fn read<T: JsonSchema + DeserializeOwned>(node: &Node, faults: &mut Vec<Fault>) -> Option<T> {
    let before = faults.len();
    structure::<T>(node, faults);
    if faults.len() > before || node.is_faulty() {
        return None;
    }
    match serde_path_to_error::deserialize::<_, T>(&node.to_json()) {
        Ok(value) => Some(value),
        Err(error) => {
            let place = node.deepest(&segments(error.path()));
            faults.push(Fault::new(place.at.clone(), place.found(), error.inner().to_string()));
            None
        }
    }
}

/// Holds `node` against the schema of `T`.
pub(super) fn structure<T: JsonSchema>(node: &Node, faults: &mut Vec<Fault>) {
    let root = schema_of::<T>();
    Checker { root: &root }.check(node, &root, faults);
}

fn segments(path: &serde_path_to_error::Path) -> Vec<Segment> {
    path.iter()
        .filter_map(|segment| match segment {
            serde_path_to_error::Segment::Seq { index } => Some(Segment::Index(*index)),
            serde_path_to_error::Segment::Map { key } => Some(Segment::Key(key.clone())),
            serde_path_to_error::Segment::Enum { .. } | serde_path_to_error::Segment::Unknown => None,
        })
        .collect()
}

/// The known name that is nearest, if one is near.
fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const NEAR: f64 = 0.5; // share of letters that agree; below it a hint misleads more than it helps
    known
        .into_iter()
        .map(|candidate| (strsim::normalized_damerau_levenshtein(name, candidate), candidate))
        .filter(|(likeness, _)| *likeness >= NEAR)
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(a.1)))
        .map(|(_, candidate)| candidate)
}

fn did_you_mean(name: &str) -> String {
    format!("did you mean {name}?")
}

/// A fault with the nearest known name as its hint.
pub(super) fn unknown<'a>(
    at: KeyPath,
    found: String,
    allowed: String,
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Fault {
    let fault = Fault::new(at, found, allowed);
    match nearest(name, known) {
        Some(name) => fault.hint(did_you_mean(name)),
        None => fault,
    }
}

/// A fault for an unknown key, and which of the keys `left` (those that do not stand there already) seems to be meant: it need
/// not be missed a second time.
pub(super) fn unknown_key<'a>(
    at: KeyPath,
    allowed: String,
    key: &str,
    left: impl IntoIterator<Item = &'a str>,
) -> (Fault, Option<String>) {
    let fault = Fault::new(at, "an unknown key", allowed);
    match nearest(key, left) {
        Some(name) => (fault.hint(did_you_mean(name)), Some(name.to_owned())),
        None => (fault, None),
    }
}

/// Schemas are trees of finite size, but `$ref` may close a ring; deeper than this is not followed.
const DEEPEST: usize = 64;

struct Checker<'a> {
    root: &'a Json,
}

impl<'a> Checker<'a> {
    fn check(&self, node: &Node, schema: &'a Json, faults: &mut Vec<Fault>) {
        if matches!(node.value, Value::Faulty) {
            return;
        }
        let mut parts = Vec::new();
        if !self.parts(node, schema, &mut parts, faults, 0) {
            return;
        }
        if parts.iter().any(|p| p.get("type").is_some_and(|t| !admits(t, node))) {
            faults.push(Fault::new(node.at.clone(), node.found(), self.allowed(schema)));
            return;
        }
        if let Some(choices) = parts.iter().find_map(|p| words(p)) {
            if !node.text().is_some_and(|text| choices.contains(&text)) {
                let allowed = choices.iter().map(|c| quoted(c)).collect::<Vec<_>>().join(", ");
                let name = node.text().unwrap_or_default();
                faults.push(unknown(node.at.clone(), node.found(), allowed, name, choices));
            }
            return;
        }
        match &node.value {
            Value::Number(_) => {
                if !parts.iter().all(|p| in_range(node, p)) {
                    faults.push(Fault::new(node.at.clone(), node.found(), self.allowed(schema)));
                }
            }
            Value::List(items) => self.list(node, items, &parts, schema, faults),
            Value::Table(map) => self.table(node, map, &parts, faults),
            Value::Null | Value::Bool(_) | Value::Text(_) | Value::Faulty => {}
        }
    }

    /// All schemas that hold for this node together: itself, what it refers to, the chosen alternative.
    /// False when no alternative fits (said in `faults`) or when a fitting one has been checked already.
    fn parts(
        &self,
        node: &Node,
        schema: &'a Json,
        parts: &mut Vec<&'a Json>,
        faults: &mut Vec<Fault>,
        depth: usize,
    ) -> bool {
        if depth > DEEPEST {
            return true;
        }
        parts.push(schema);
        if let Some(target) = self.target(schema)
            && !self.parts(node, target, parts, faults, depth + 1)
        {
            return false;
        }
        for part in schema.get("allOf").and_then(Json::as_array).into_iter().flatten() {
            if !self.parts(node, part, parts, faults, depth + 1) {
                return false;
            }
        }
        let Some(alternatives) = alternatives(schema) else { return true };
        if alternatives.iter().all(|a| words(a).is_some()) {
            return true; // a list of words, looked at as a whole
        }
        match self.choose(node, schema, alternatives, faults) {
            Choice::One(alternative) => self.parts(node, alternative, parts, faults, depth + 1),
            Choice::Done => false,
        }
    }

    fn choose(
        &self,
        node: &Node,
        schema: &'a Json,
        alternatives: &'a [Json],
        faults: &mut Vec<Fault>,
    ) -> Choice<'a> {
        let not_null: Vec<&Json> =
            alternatives.iter().filter(|a| a.get("type").and_then(Json::as_str) != Some("null")).collect();
        if not_null.len() < alternatives.len() && matches!(node.value, Value::Null) {
            return Choice::Done;
        }
        if let [only] = not_null[..] {
            return Choice::One(only);
        }
        let tagged: Vec<(&str, &str, &Json)> =
            not_null.iter().filter_map(|a| tag(a).map(|(key, word)| (key, word, *a))).collect();
        if tagged.len() == not_null.len()
            && let Some(&(key, ..)) = tagged.first()
        {
            let Value::Table(map) = &node.value else {
                faults.push(Fault::new(node.at.clone(), node.found(), self.allowed(schema)));
                return Choice::Done;
            };
            let allowed = tagged.iter().map(|(_, word, _)| quoted(word)).collect::<Vec<_>>().join(", ");
            let Some(found) = map.get(key) else {
                faults.push(Fault::new(node.at.key(key), "nothing", allowed));
                return Choice::Done;
            };
            if found.is_faulty() {
                return Choice::Done;
            }
            let word = found.text().unwrap_or_default();
            return match tagged.iter().find(|(_, w, _)| *w == word) {
                Some((_, _, alternative)) => Choice::One(alternative),
                None => {
                    let known = tagged.iter().map(|(_, w, _)| *w);
                    faults.push(unknown(found.at.clone(), found.found(), allowed, word, known));
                    Choice::Done
                }
            };
        }
        // Untagged: the first that fits; else the faults of the first whose type fits.
        let mut said = None;
        for alternative in not_null {
            let mut own = Vec::new();
            self.check(node, alternative, &mut own);
            if own.is_empty() {
                return Choice::Done;
            }
            if said.is_none() && own.iter().all(|f| f.key != node.at) {
                said = Some(own);
            }
        }
        match said {
            Some(own) => faults.extend(own),
            None => faults.push(Fault::new(node.at.clone(), node.found(), self.allowed(schema))),
        }
        Choice::Done
    }

    fn list(
        &self,
        node: &Node,
        items: &[Node],
        parts: &[&'a Json],
        schema: &'a Json,
        faults: &mut Vec<Fault>,
    ) {
        let bound = |key: &str| parts.iter().find_map(|p| p.get(key)).and_then(Json::as_u64);
        let least = bound("minItems").unwrap_or(0);
        let most = bound("maxItems").unwrap_or(u64::MAX);
        let length = items.len() as u64;
        if length < least || length > most {
            faults.push(Fault::new(node.at.clone(), node.found(), self.allowed(schema)));
        }
        for part in parts {
            let prefix = part.get("prefixItems").and_then(Json::as_array).map_or(&[][..], |p| &p[..]);
            for (item, schema) in items.iter().zip(prefix) {
                self.check(item, schema, faults);
            }
            if let Some(schema) = part.get("items") {
                for item in items.iter().skip(prefix.len()) {
                    self.check(item, schema, faults);
                }
            }
        }
    }

    fn table(&self, node: &Node, map: &BTreeMap<String, Node>, parts: &[&'a Json], faults: &mut Vec<Fault>) {
        let mut known: BTreeMap<&str, &Json> = BTreeMap::new();
        for part in parts {
            for (key, schema) in part.get("properties").and_then(Json::as_object).into_iter().flatten() {
                known.insert(key, schema);
            }
        }
        let no = |part: &Json, key: &str| part.get(key).and_then(Json::as_bool) == Some(false);
        let closed = parts.iter().any(|p| no(p, "additionalProperties") || no(p, "unevaluatedProperties"));
        let further = parts.iter().find_map(|p| p.get("additionalProperties").filter(|s| s.is_object()));
        let mut missing: BTreeSet<&str> = parts
            .iter()
            .filter_map(|p| p.get("required").and_then(Json::as_array))
            .flatten()
            .filter_map(Json::as_str)
            .filter(|key| !map.contains_key(*key))
            .collect();
        for (key, item) in map {
            if let Some(schema) = known.get(key.as_str()) {
                self.check(item, schema, faults);
            } else if closed {
                let allowed = known.keys().copied().collect::<Vec<_>>().join(", ");
                let left = known.keys().copied().filter(|k| !map.contains_key(*k));
                let (fault, meant) = unknown_key(item.at.clone(), allowed, key, left);
                faults.push(fault);
                missing.retain(|name| Some(*name) != meant.as_deref());
            } else if let Some(schema) = further {
                self.check(item, schema, faults);
            }
        }
        for key in missing {
            let allowed = known.get(key).map_or_else(|| "a value".to_owned(), |s| self.allowed(s));
            faults.push(Fault::new(node.at.key(key), "nothing", allowed));
        }
    }

    fn target(&self, schema: &Json) -> Option<&'a Json> {
        let reference = schema.get("$ref")?.as_str()?;
        self.root.pointer(reference.strip_prefix('#')?)
    }

    /// What a schema allows, in words.
    fn allowed(&self, schema: &Json) -> String {
        self.describe(schema, 0)
    }

    fn describe(&self, schema: &Json, depth: usize) -> String {
        if depth > DEEPEST {
            return "a value".to_owned();
        }
        if let Some(words) = words(schema) {
            return words.iter().map(|w| quoted(w)).collect::<Vec<_>>().join(", ");
        }
        if let Some(alternatives) = alternatives(schema) {
            let tags: Vec<(&str, &str)> = alternatives.iter().filter_map(tag).collect();
            if tags.len() == alternatives.len()
                && let Some((key, _)) = tags.first()
            {
                let kinds = tags.iter().map(|(_, w)| quoted(w)).collect::<Vec<_>>().join(", ");
                return format!("a table with {key} = {kinds}");
            }
            let texts: Vec<String> = alternatives
                .iter()
                .filter(|a| a.get("type").and_then(Json::as_str) != Some("null"))
                .map(|a| self.describe(a, depth + 1))
                .collect();
            return texts.join(", or ");
        }
        if let Some(target) = self.target(schema) {
            return self.describe(target, depth + 1);
        }
        match first_type(schema) {
            Some("number") => number_text("a number", schema),
            Some("integer") => number_text("a whole number", schema),
            Some("string") => "a text".to_owned(),
            Some("boolean") => "true or false".to_owned(),
            Some("array") => self.describe_list(schema, depth),
            Some("object") => "a table".to_owned(),
            _ => "a value".to_owned(),
        }
    }

    fn describe_list(&self, schema: &Json, depth: usize) -> String {
        let bound = |key: &str| schema.get(key).and_then(Json::as_u64);
        let count = match (bound("minItems"), bound("maxItems")) {
            (Some(least), Some(most)) if least == most => format!("a list of {least}"),
            (Some(least), _) if least > 0 => format!("a list of {least} or more"),
            _ => "a list".to_owned(),
        };
        match schema.get("items") {
            Some(items) if items.is_object() => format!("{count}, each {}", self.describe(items, depth + 1)),
            _ => count,
        }
    }
}

enum Choice<'a> {
    One(&'a Json),
    Done,
}

fn alternatives(schema: &Json) -> Option<&[Json]> {
    ["oneOf", "anyOf"].iter().find_map(|key| schema.get(key)).and_then(Json::as_array).map(Vec::as_slice)
}

/// The words a schema is limited to: `enum`, `const`, or alternatives that are all words.
fn words(schema: &Json) -> Option<Vec<&str>> {
    if let Some(word) = schema.get("const") {
        return word.as_str().map(|w| vec![w]);
    }
    if let Some(list) = schema.get("enum").and_then(Json::as_array) {
        return list.iter().map(Json::as_str).collect();
    }
    let lists: Option<Vec<Vec<&str>>> = alternatives(schema)?.iter().map(words).collect();
    lists.map(|l| l.concat())
}

/// Key and word by which an alternative of a tagged enum is known.
fn tag(schema: &Json) -> Option<(&str, &str)> {
    schema.get("properties")?.as_object()?.iter().find_map(|(key, property)| {
        property.get("const").and_then(Json::as_str).map(|word| (key.as_str(), word))
    })
}

fn first_type(schema: &Json) -> Option<&str> {
    match schema.get("type")? {
        Json::String(name) => Some(name),
        Json::Array(names) => names.iter().filter_map(Json::as_str).find(|n| *n != "null"),
        _ => None,
    }
}

fn admits(types: &Json, node: &Node) -> bool {
    let one = |name: &str| match (name, &node.value) {
        ("integer", Value::Number(n)) => n.is_i64() || n.is_u64(),
        ("null", Value::Null)
        | ("boolean", Value::Bool(_))
        | ("number", Value::Number(_))
        | ("string", Value::Text(_))
        | ("array", Value::List(_))
        | ("object", Value::Table(_)) => true,
        _ => false,
    };
    match types {
        Json::String(name) => one(name),
        Json::Array(names) => names.iter().filter_map(Json::as_str).any(one),
        _ => true,
    }
}

type Holds = fn(f64, f64) -> bool;

const BOUNDS: [(&str, &str, Holds); 4] = [
    ("exclusiveMinimum", ">", |x, limit| x > limit),
    ("minimum", ">=", |x, limit| x >= limit),
    ("exclusiveMaximum", "<", |x, limit| x < limit),
    ("maximum", "<=", |x, limit| x <= limit),
];

fn in_range(node: &Node, schema: &Json) -> bool {
    let Some(x) = node.number() else { return true };
    BOUNDS.iter().all(|(key, _, holds)| match schema.get(key).and_then(Json::as_f64) {
        Some(limit) => holds(x, limit),
        None => true,
    })
}

fn number_text(what: &str, schema: &Json) -> String {
    let bounds: Vec<String> = BOUNDS
        .iter()
        .filter_map(|(key, sign, _)| schema.get(key).map(|limit| format!("{sign} {limit}")))
        .collect();
    let unit = schema.get("unit").and_then(Json::as_str);
    match (bounds.is_empty(), unit) {
        (true, None) => what.to_owned(),
        (true, Some(unit)) => format!("{what} ({unit})"),
        (false, None) => format!("{what} {}", bounds.join(" and ")),
        (false, Some(unit)) => format!("{what} {} {unit}", bounds.join(" and ")),
    }
}
