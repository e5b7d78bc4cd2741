//! LM1: names that nothing needs.

use std::collections::BTreeMap;

use serde_json::Value as Json;

use super::Report;
use super::subject::Subject;
use crate::error::KeyPath;

pub(super) fn find(subject: &Subject<'_>, report: &mut Report) {
    let written = &subject.case.written;
    parameters(written, report);
    templates(written, report);
    conditions(written, report);
}

/// Calls `act` with every text below a value.
fn texts<'a>(value: &'a Json, act: &mut impl FnMut(&'a str)) {
    match value {
        Json::String(text) => act(text),
        Json::Array(items) => items.iter().for_each(|item| texts(item, act)),
        Json::Object(map) => map.values().for_each(|item| texts(item, act)),
        _ => {}
    }
}

/// Dotted names of numbers and references below a table, with their keys.
fn flatten<'a>(value: &'a Json, name: &str, key: &KeyPath, out: &mut BTreeMap<String, (KeyPath, &'a Json)>) {
    for (part, item) in value.as_object().into_iter().flatten() {
        let name = if name.is_empty() { part.clone() } else { format!("{name}.{part}") };
        if item.is_object() {
            flatten(item, &name, &key.key(part), out);
        } else {
            out.insert(name, (key.key(part), item));
        }
    }
}

/// The name that a text refers to: `$name` or `-$name`, before which a placeholder (`{sign}$name`) may stand for the sign.
fn reference(text: &str) -> Option<&str> {
    let signed = match text.split_once('}') {
        Some((word, rest)) if word.starts_with('{') => rest,
        _ => text,
    };
    signed.strip_prefix('-').unwrap_or(signed).strip_prefix('$')
}

/// Whether a reference, in which `{word}` may stand for anything, means a name.
fn means(reference: &str, name: &str) -> bool {
    match (reference.find('{'), reference.rfind('}')) {
        (Some(a), Some(b)) if a < b => {
            let (front, back) = (&reference[..a], &reference[b + 1..]);
            name.len() >= front.len() + back.len() && name.starts_with(front) && name.ends_with(back)
        }
        _ => reference == name,
    }
}

fn parameters(written: &Json, report: &mut Report) {
    let Some(table) = written.get("parameters") else { return };
    let mut references = Vec::new();
    texts(written, &mut |text| references.extend(reference(text)));
    let mut named = BTreeMap::new();
    flatten(table, "", &KeyPath::of("vehicle.parameters"), &mut named);
    for (name, (key, value)) in named {
        if !references.iter().any(|reference| means(reference, &name)) {
            let usual = format!("a reference \"${name}\" somewhere, or no such parameter");
            report.add("LM101", &name, key, value.to_string(), usual);
        }
    }
}

fn templates(written: &Json, report: &mut Report) {
    let Some(table) = written.get("template").and_then(Json::as_object) else { return };
    let uses = |value: &Json| -> Vec<String> {
        let list = value.get("use").and_then(Json::as_array).into_iter().flatten();
        list.filter_map(|u| u.get("template")?.as_str().map(str::to_owned)).collect()
    };
    let mut used = uses(written);
    let mut next = 0;
    while let Some(name) = used.get(next).cloned() {
        for other in table.get(&name).map(&uses).unwrap_or_default() {
            if !used.contains(&other) {
                used.push(other);
            }
        }
        next += 1;
    }
    for name in table.keys().filter(|name| !used.contains(name)) {
        let key = KeyPath::of("vehicle.template").key(name);
        report.add("LM102", name, key, "a template", "a [[use]] of it, or no such template");
    }
}

fn conditions(written: &Json, report: &mut Report) {
    let mut named = BTreeMap::new();
    flatten(written.get("parameters").unwrap_or(&Json::Null), "", &KeyPath::default(), &mut named);
    for (condition, table) in written.get("condition").and_then(Json::as_object).into_iter().flatten() {
        let mut own = BTreeMap::new();
        flatten(table, "", &KeyPath::of("vehicle.condition").key(condition), &mut own);
        for (name, (key, value)) in own {
            let same = named.get(&name).is_some_and(|(_, other)| match (other.as_f64(), value.as_f64()) {
                (Some(a), Some(b)) => a == b,
                _ => *other == value,
            });
            if same {
                let subject = format!("{name} in {condition}");
                report.add("LM103", subject, key, value.to_string(), "another value than [parameters] has");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::reference;

    #[test]
    fn a_sign_may_be_a_word_of_the_template() {
        for (text, name) in [
            ("$rod.x", Some("rod.x")),
            ("-$rod.x", Some("rod.x")),
            ("{sign}$rod.x", Some("rod.x")),
            ("{sign}-$rod.x", Some("rod.x")),
            ("{axle}", None),
            ("primary_{axle}", None),
        ] {
            assert_eq!(reference(text), name, "{text}");
        }
    }
}
