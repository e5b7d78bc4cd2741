//! Every code has a section in `docs/reference/lint.md`, and the example there triggers it and nothing else.
//!
//! An example is a difference to a vehicle that ships, `diff VEHICLE [CONDITION]`, or keys of `run` in `toml`. Comments count for nothing.

#![allow(clippy::print_stdout)] // findings are shown, from helpers too

mod common;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use proptest::prelude::*;
use railsim::lint::{CODES, Finding, Severity, lint, unreadable};
use railsim::schema::{Case, toml_to_json};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

fn page() -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/lint.md");
    std::fs::read_to_string(path).unwrap()
}

fn source(vehicle: &str) -> String {
    std::fs::read_to_string(common::models().join(format!("vehicles/{vehicle}.toml"))).unwrap()
}

/// A case of kind `lint` of a vehicle's document on its own track.
fn case_of(document: &Value, condition: &str) -> Value {
    let mut case = common::coco134();
    let track = document.get("track").and_then(Value::as_str).unwrap_or("plain_1435_as60");
    let mut track = common::read_toml(&format!("tracks/{track}.toml"));
    track["length"] = json!(200.0);
    let rail = track["rail_profile"].as_str().unwrap().to_owned();
    let wheel = document["wheel_profile"].as_str().unwrap_or("anzr1").to_owned();
    case["profiles"] =
        json!({ &wheel: common::profile(&wheel, "wheel"), &rail: common::profile(&rail, "rail") });
    case["track"] = track;
    case["vehicle"] = document.clone();
    case["condition"] = json!(condition);
    case["run"] = json!({ "kind": "lint", "speed": 32.0, "friction": 0.4 });
    case
}

fn findings(text: &str, condition: &str, run: &Value) -> Vec<Finding> {
    let document = toml_to_json(text).unwrap();
    let refused = unreadable(&document, &Map::new(), Some(condition));
    if !refused.is_empty() {
        return refused;
    }
    let mut case = case_of(&document, condition);
    for (key, value) in run.as_object().into_iter().flatten() {
        case["run"][key] = value.clone();
    }
    lint(&common::case(&case))
}

fn written(line: &str) -> &str {
    line.split('#').next().unwrap_or_default().trim_end()
}

/// Applies the hunks of a difference, each of which must fit in exactly one place.
fn patched(text: &str, difference: &[&str]) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for hunk in difference.split(|line| line.starts_with("@@")) {
        let side = |gone: char| -> Vec<&str> {
            hunk.iter().filter(|l| !l.starts_with(gone)).map(|l| l.get(1..).unwrap_or("")).collect()
        };
        let (old, new) = (side('+'), side('-'));
        let fits = |at: &usize| {
            old.iter().zip(&lines[*at..]).filter(|(a, b)| written(a) == written(b)).count() == old.len()
        };
        let places: Vec<usize> = (0..=lines.len().saturating_sub(old.len())).filter(fits).collect();
        assert_eq!(places.len(), 1, "this hunk fits in {} places:\n{}", places.len(), hunk.join("\n"));
        lines.splice(places[0]..places[0] + old.len(), new.iter().map(|l| (*l).to_owned()));
    }
    lines.join("\n")
}

struct Section {
    code: String,
    name: String,
    severity: String,
    info: String,
    example: Vec<String>,
}

fn sections() -> Vec<Section> {
    let page = page();
    let mut sections: Vec<Section> = Vec::new();
    let mut within = false;
    for line in page.lines() {
        if let Some(heading) = line.strip_prefix("## LM") {
            let (code, name) = heading.split_once(' ').unwrap();
            sections.push(Section {
                code: format!("LM{code}"),
                name: name.to_owned(),
                severity: String::new(),
                info: String::new(),
                example: Vec::new(),
            });
            continue;
        }
        let Some(section) = sections.last_mut() else { continue };
        if let Some(info) = line.strip_prefix("```") {
            within = !within;
            if within {
                section.info = info.to_owned();
            }
        } else if within {
            section.example.push(line.to_owned());
        } else if section.severity.is_empty() && !line.is_empty() {
            section.severity = line.split('.').next().unwrap_or_default().to_lowercase();
        }
    }
    sections
}

#[test]
fn the_table_is_sorted_and_has_at_least_25_codes() {
    assert!(CODES.is_sorted_by_key(|c| c.code));
    assert!(CODES.len() >= 25);
    for code in &CODES {
        let known = |other: &&str| CODES.iter().any(|c| c.code.starts_with(*other));
        assert!(code.after.iter().all(known), "{} comes after a code that does not exist", code.code);
    }
}

#[test]
fn every_code_is_documented_under_its_name_and_severity() {
    let sections = sections();
    let documented: Vec<_> = sections.iter().map(|s| (&s.code[..], &s.name[..], &s.severity[..])).collect();
    let table: Vec<_> = CODES.iter().map(|c| (c.code, c.name, c.severity.name())).collect();
    assert_eq!(documented, table);
}

/// What a finding is told apart by.
type Told = BTreeSet<(String, String)>;

fn told(f: &Finding) -> (String, String) {
    (f.code.code.to_owned(), f.subject.clone())
}

/// The vehicle and the condition of an example.
fn subject(section: &Section) -> (&str, &str) {
    let mut words = section.info.split(' ').skip(1);
    let vehicle = words.next().unwrap_or("coco134");
    (vehicle, words.next().unwrap_or(if vehicle == "coco134" { "full" } else { "textbook" }))
}

/// What is wrong with the example of a section; `before` holds what the good vehicles are told.
fn fault(section: &Section, before: &BTreeMap<(&str, &str), Told>) -> Option<String> {
    let (vehicle, condition) = subject(section);
    let good = source(vehicle);
    let lines: Vec<&str> = section.example.iter().map(String::as_str).collect();
    let (bad, run) = match section.info.split(' ').next() {
        Some("diff") => (patched(&good, &lines), Value::Null),
        Some("toml") => (good, toml_to_json(&lines.join("\n")).unwrap()["run"].clone()),
        other => panic!("{}: an example in {other:?}", section.code),
    };
    let after = findings(&bad, condition, &run);
    let new: Vec<_> = after.iter().filter(|f| !before[&(vehicle, condition)].contains(&told(f))).collect();
    for f in &new {
        println!("{} [{}] {}: {} | {}", f.code.code, f.subject, f.key, f.found, f.usual);
    }
    let codes: BTreeSet<&str> = new.iter().map(|f| f.code.code).collect();
    (codes != BTreeSet::from([&section.code[..]]))
        .then(|| format!("{}: {codes:?} of {after:?}", section.code))
}

#[test]
fn the_example_of_every_code_triggers_it_and_nothing_else() {
    let sections = sections();
    let subjects: BTreeSet<_> = sections.iter().map(subject).collect();
    let before = subjects
        .into_iter()
        .map(|(vehicle, condition)| {
            let found = findings(&source(vehicle), condition, &Value::Null);
            ((vehicle, condition), found.iter().map(told).collect())
        })
        .collect();
    // Each example builds its contact tables: on all cores, or it is the longest test of all.
    let wrong: Vec<String> = sections.par_iter().filter_map(|section| fault(section, &before)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_reference_locomotive_has_no_finding_in_either_condition() {
    for condition in ["full", "tare"] {
        assert_eq!(findings(&source("coco134"), condition, &Value::Null), [], "{condition}");
    }
}

#[test]
fn no_vehicle_that_ships_has_an_error() {
    for (vehicle, condition) in [
        ("bobo86", "full"),
        ("manchester1", "benchmark"),
        ("wagon2", "full"),
        ("suspended_wheelset", "textbook"),
    ] {
        let found = findings(&source(vehicle), condition, &Value::Null);
        let errors: Vec<_> = found.iter().filter(|f| f.code.severity == Severity::Error).collect();
        for f in &found {
            println!("{vehicle} {} [{}] {}: {} | {}", f.code.code, f.subject, f.key, f.found, f.usual);
        }
        assert!(errors.is_empty(), "{vehicle}: {errors:?}");
        // Its templates write references as `{sign}$name`.
        assert!(vehicle != "bobo86" || found.is_empty(), "{found:?}");
    }
}

#[test]
fn a_reference_is_named_beside_the_number_that_it_gave() {
    let soft = source("coco134").replace("kz = 5.8e5", "kz = 1.5e5");
    let found = findings(&soft, "full", &Value::Null);
    assert!(found[0].found.ends_with("(from $secondary.kz)"), "{found:?}");
    // Eight springs from one place in the file are one finding.
    assert_eq!(found[0].subject, "secondary_bogie1_front_right and 7 more");
}

/// The closed form of a body on a spring: sqrt(k/m), with the reduced mass of two.
#[test]
fn the_local_eigenvalue_is_that_of_two_masses_on_a_spring() {
    let (k, m, other) = (4.0e12, 14860.0, 87180.0_f64);
    let stiff = source("coco134").replace("ky = 4.0e6 ", "ky = 4.0e12 ").replace("z = -0.80 ", "z = -0.75 ");
    let found = findings(&stiff, "full", &Value::Null);
    assert_eq!(found.len(), 1, "{found:?}");
    let text = &found[0].found;
    let ours: f64 = text.split(' ').next().unwrap().parse().unwrap();
    // At the bogie's centre of mass it does not turn the bogie; the car body, whose centre is 1.2 m above and 6.6 m away, turns too.
    let turn = 1.2_f64.powi(2) / 168_550.0 + 6.6_f64.powi(2) / 3_590_650.0;
    let theirs = (k * (1.0 / m + 1.0 / other + turn)).sqrt();
    println!("local eigenvalue: ours {ours}, closed form {theirs:.0} rad/s");
    assert!((ours - theirs).abs() < 1e-3 * theirs, "{text}, closed form {theirs}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever becomes of the numbers of a file, the rules tell something and never panic.
    #[test]
    fn mutated_vehicles_never_panic(
        places in prop::collection::vec((any::<prop::sample::Index>(), -1e9..1e9_f64, 0..4_u8), 1..4),
    ) {
        let mut document = common::read_toml("vehicles/coco134.toml");
        for (place, number, way) in places {
            let mut numbers = Vec::new();
            pointers(&document["parameters"], "/parameters", &mut numbers);
            let pointer = place.get(&numbers);
            let slot = document.pointer_mut(pointer).unwrap();
            let old = slot.as_f64().unwrap();
            *slot = json!(match way {
                0 => old * 1e3,
                1 => old * 1e-3,
                2 => -old,
                _ => number,
            });
        }
        if let Ok(case) = Case::from_value(&case_of(&document, "full")) {
            for finding in lint(&case) {
                prop_assert!(!finding.found.contains("NaN"), "{finding:?}");
            }
        } else {
            prop_assert!(!unreadable(&document, &Map::new(), Some("full")).is_empty());
        }
    }
}

fn pointers(value: &Value, at: &str, out: &mut Vec<String>) {
    match value {
        Value::Object(map) => map.iter().for_each(|(k, v)| pointers(v, &format!("{at}/{k}"), out)),
        Value::Number(_) => out.push(at.to_owned()),
        _ => {}
    }
}
