//! Templates: `[template.<name>]` holds the same lists as the vehicle itself, `[[use]]` copies it to a place.
//!
//! `with` gives words for the placeholders `{word}` in the names and references of the template; `at` shifts all its
//! positions. Templates may use templates. A copied element keeps the key under which it was written.

use std::collections::{BTreeMap, BTreeSet};

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Number;

use super::check::{self, unknown};
use super::node::{Node, Value};
use super::parameter::{self, Named};
use crate::error::Fault;

/// The lists that a vehicle and a template hold, and which of their keys are positions.
pub(super) const KINDS: [&str; 5] = ["body", "connection", "gap", "sensor", "wheelset"];
const POSITIONS: [&str; 2] = ["position", "positions"];

/// No real vehicle comes near it; templates that use templates grow as a power.
const MOST_ELEMENTS: usize = 10_000;

/// Templates within templates; each level costs stack.
const DEEPEST: usize = 32;

/// One copy of a template.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Use {
    /// Name of the template.
    pub template: String,
    /// Shift of all its positions, m (x forward, y right, z down).
    #[serde(default)]
    pub at: [f64; 3],
    /// Words for its placeholders.
    #[serde(default)]
    pub with: BTreeMap<String, String>,
}

/// Elements by kind, each ready to be read: no placeholder, no reference, positions in vehicle axes.
pub(super) type Elements = BTreeMap<&'static str, Vec<Node>>;

/// What the expansion of one document needs throughout.
struct Expansion<'a> {
    numbers: &'a BTreeMap<String, Number>,
    known: &'a Named,
    templates: BTreeMap<&'a str, &'a Node>,
    used: BTreeSet<String>,
    count: usize,
}

/// Copies all templates of `root`. The second result holds the elements of templates that nobody uses, for the
/// structural check alone.
pub(super) fn expand(
    root: &Node,
    numbers: &BTreeMap<String, Number>,
    known: &Named,
    faults: &mut Vec<Fault>,
) -> (Elements, Elements) {
    let mut templates = BTreeMap::new();
    if let Some(node) = root.get("template") {
        match node.table() {
            Some(map) => templates.extend(map.iter().map(|(name, template)| (name.as_str(), template))),
            None => faults.push(Fault::new(node.at.clone(), node.found(), "a table of templates")),
        }
    }
    for template in templates.values() {
        check_template_keys(template, faults);
    }
    let mut expansion = Expansion { numbers, known, templates, used: BTreeSet::new(), count: 0 };
    let mut out = Elements::new();
    expansion.copy(root, None, [0.0; 3], &mut Vec::new(), &mut out, faults);

    // A template that nobody uses is checked as it stands, each placeholder standing for itself.
    let mut spare = Elements::new();
    let names: Vec<&str> = expansion.templates.keys().copied().collect();
    for name in names {
        if expansion.used.contains(name) {
            continue;
        }
        let Some(template) = expansion.templates.get(name).copied() else { continue };
        let own: BTreeMap<String, String> =
            placeholders(template).into_iter().map(|word| (word.clone(), word)).collect();
        expansion.copy(template, Some(&own), [0.0; 3], &mut vec![name.to_owned()], &mut spare, faults);
    }
    (out, spare)
}

fn check_template_keys(template: &Node, faults: &mut Vec<Fault>) {
    let Some(map) = template.table() else {
        faults.push(Fault::new(template.at.clone(), template.found(), "a table"));
        return;
    };
    let known: Vec<&str> = KINDS.iter().copied().chain(["use"]).collect();
    for (key, item) in map.iter().filter(|(key, _)| !known.contains(&key.as_str())) {
        let allowed = known.join(", ");
        faults.push(unknown(item.at.clone(), "an unknown key".into(), allowed, key, known.iter().copied()));
    }
}

impl Expansion<'_> {
    /// Copies the lists of `table` and of all that it uses. Without `words` there are no placeholders.
    fn copy(
        &mut self,
        table: &Node,
        words: Option<&BTreeMap<String, String>>,
        shift: [f64; 3],
        within: &mut Vec<String>,
        out: &mut Elements,
        faults: &mut Vec<Fault>,
    ) {
        for kind in KINDS {
            for element in list(table, kind, faults) {
                if !self.room(element, faults) {
                    return;
                }
                let mut element = self.ready(element, words, faults);
                if kind == "wheelset" && shift[2] != 0.0 {
                    let found = format!("a shift of {} m in z by use", shift[2]);
                    faults.push(Fault::new(element.at.clone(), found, "0 m: a wheelset stands on the rail"));
                }
                if let Value::Table(map) = &mut element.value {
                    for (_, position) in map.iter_mut().filter(|(key, _)| POSITIONS.contains(&key.as_str())) {
                        shift_by(position, shift, faults);
                    }
                }
                out.entry(kind).or_default().push(element);
            }
        }
        for node in list(table, "use", faults) {
            if !self.room(node, faults) {
                return;
            }
            let node = self.ready(node, words, faults);
            let Some(written) = check::read::<Use>(&node, faults) else { continue };
            self.copy_use(&node, &written, shift, within, out, faults);
        }
    }

    fn copy_use(
        &mut self,
        node: &Node,
        written: &Use,
        shift: [f64; 3],
        within: &mut Vec<String>,
        out: &mut Elements,
        faults: &mut Vec<Fault>,
    ) {
        let name = written.template.as_str();
        let at = node.at.key("template");
        let Some(template) = self.templates.get(name).copied() else {
            let names: Vec<&str> = self.templates.keys().copied().collect();
            let allowed = if names.is_empty() {
                "the name of a [template], of which there is none".to_owned()
            } else {
                format!("the name of a [template]: {}", names.join(", "))
            };
            faults.push(unknown(at, format!("{name:?}"), allowed, name, names));
            return;
        };
        self.used.insert(name.to_owned());
        if within.iter().any(|outer| outer == name) {
            let chain = within.iter().map(String::as_str).chain([name]).collect::<Vec<_>>().join(" -> ");
            faults.push(Fault::new(at, format!("a template that uses itself: {chain}"), "no such ring"));
            return;
        }
        if within.len() == DEEPEST {
            let found = format!("{} templates within each other", DEEPEST + 1);
            faults.push(Fault::new(at, found, format!("{DEEPEST} at most")));
            return;
        }
        let needed = placeholders(template);
        let mut missing: BTreeSet<&String> =
            needed.iter().filter(|word| !written.with.contains_key(*word)).collect();
        let complete = missing.is_empty();
        for word in written.with.keys().filter(|word| !needed.contains(*word)) {
            let allowed = if needed.is_empty() {
                format!("nothing: template {name} has no placeholders")
            } else {
                needed.iter().cloned().collect::<Vec<_>>().join(", ")
            };
            let left = missing.iter().map(|word| word.as_str());
            let (fault, meant) = check::unknown_key(node.at.key("with").key(word), allowed, word, left);
            faults.push(fault);
            missing.retain(|word| Some(word.as_str()) != meant.as_deref());
        }
        for word in missing {
            let allowed = format!("a text for {{{word}}} in template {name}");
            faults.push(Fault::new(node.at.key("with").key(word), "nothing", allowed));
        }
        if !complete {
            return;
        }
        let shift = [0, 1, 2].map(|i| shift[i] + written.at[i]);
        within.push(name.to_owned());
        self.copy(template, Some(&written.with), shift, within, out, faults);
        within.pop();
    }

    /// A copy with placeholders filled in and references replaced.
    fn ready(
        &self,
        element: &Node,
        words: Option<&BTreeMap<String, String>>,
        faults: &mut Vec<Fault>,
    ) -> Node {
        let mut copy = element.clone();
        if let Some(words) = words {
            substitute(&mut copy, words);
        } else {
            refuse_placeholders(&mut copy, faults);
        }
        parameter::resolve(&mut copy, self.numbers, self.known, faults);
        copy
    }

    fn room(&mut self, node: &Node, faults: &mut Vec<Fault>) -> bool {
        self.count += 1;
        if self.count == MOST_ELEMENTS {
            let found = format!("{MOST_ELEMENTS} elements after expansion");
            faults.push(Fault::new(node.at.clone(), found, "fewer elements"));
        }
        self.count < MOST_ELEMENTS
    }
}

fn list<'a>(table: &'a Node, kind: &str, faults: &mut Vec<Fault>) -> &'a [Node] {
    let Some(node) = table.get(kind) else { return &[] };
    if !matches!(node.value, Value::List(_)) {
        faults.push(Fault::new(node.at.clone(), node.found(), format!("a list of tables, as [[{kind}]]")));
    }
    node.items()
}

/// Adds `shift` to a position, or to each of a list of positions. What is no position is left to the check.
fn shift_by(node: &mut Node, shift: [f64; 3], faults: &mut Vec<Fault>) {
    let Value::List(items) = &mut node.value else { return };
    if items.iter().any(|item| matches!(item.value, Value::List(_))) {
        items.iter_mut().for_each(|item| shift_by(item, shift, faults));
        return;
    }
    for (item, by) in items.iter_mut().zip(shift) {
        let Value::Number(n) = &item.value else { continue };
        if by == 0.0 {
            continue;
        }
        match n.as_f64().and_then(|x| Number::from_f64(x + by)) {
            Some(sum) => item.value = Value::Number(sum),
            None => faults.push(Fault::new(item.at.clone(), format!("{n} + {by}"), "a finite position")),
        }
    }
}

/// The placeholders in all texts below `node`.
fn placeholders(node: &Node) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    visit(node, &mut |word| {
        found.insert(word.to_owned());
    });
    found
}

/// Outside templates a placeholder stands for nothing.
fn refuse_placeholders(node: &mut Node, faults: &mut Vec<Fault>) {
    match &mut node.value {
        Value::Text(text) => {
            let word = words_in(text).next().map(str::to_owned);
            if let Some(word) = word {
                let found = format!("the placeholder {{{word}}}");
                faults.push(Fault::new(node.at.clone(), found, "placeholders in templates only"));
                node.value = Value::Faulty;
            }
        }
        Value::List(items) => items.iter_mut().for_each(|item| refuse_placeholders(item, faults)),
        Value::Table(map) => map.values_mut().for_each(|item| refuse_placeholders(item, faults)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Faulty => {}
    }
}

fn visit(node: &Node, act: &mut impl FnMut(&str)) {
    match &node.value {
        Value::Text(text) => words_in(text).for_each(act),
        Value::List(items) => items.iter().for_each(|item| visit(item, act)),
        Value::Table(map) => map.values().for_each(|item| visit(item, act)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Faulty => {}
    }
}

/// The words between braces in a text, from left to right.
fn words_in(text: &str) -> impl Iterator<Item = &str> {
    text.split('{').skip(1).filter_map(|piece| piece.split_once('}').map(|(word, _)| word))
}

fn substitute(node: &mut Node, words: &BTreeMap<String, String>) {
    match &mut node.value {
        Value::Text(text) => {
            if text.contains('{') {
                *text = filled(text, words);
            }
        }
        Value::List(items) => items.iter_mut().for_each(|item| substitute(item, words)),
        Value::Table(map) => map.values_mut().for_each(|item| substitute(item, words)),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::Faulty => {}
    }
}

/// One pass, so that a word that itself holds braces is not read again.
fn filled(text: &str, words: &BTreeMap<String, String>) -> String {
    let mut pieces = text.split('{');
    let mut out = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        match piece.split_once('}') {
            Some((word, rest)) if words.contains_key(word) => {
                out.push_str(&words[word]);
                out.push_str(rest);
            }
            _ => {
                out.push('{');
                out.push_str(piece);
            }
        }
    }
    out
}
