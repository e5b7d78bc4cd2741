//! Properties of the schema: overrides change what refers to them and nothing else; no input makes it panic.

use std::collections::BTreeMap;

use proptest::prelude::*;
use railsim::schema::{self, Case, Vehicle, line_of, toml_to_json};
use railsim::{Error, KeyPath, error::Segment};
use serde_json::{Map, Value, json};

const COCO134: &str = include_str!("../../../models/vehicles/coco134.toml");
const BOBO86: &str = include_str!("../../../models/vehicles/bobo86.toml");
const WAGON2: &str = include_str!("../../../models/vehicles/wagon2.toml");
const TROLLEY: &str = include_str!("fixtures/trolley.toml");

fn coco134() -> Value {
    toml_to_json(COCO134).unwrap()
}

/// Dotted names and values of all named parameters.
fn parameters(node: &Value, prefix: &str, out: &mut Vec<(String, f64)>) {
    for (key, value) in node.as_object().unwrap() {
        let name = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
        match value.as_f64() {
            Some(x) => out.push((name, x)),
            None => parameters(value, &name, out),
        }
    }
}

/// Every number of a vehicle under a name of its own.
fn numbers(v: &Vehicle) -> BTreeMap<String, f64> {
    let mut out = BTreeMap::new();
    let mut put = |name: String, values: &[f64]| {
        for (i, x) in values.iter().enumerate() {
            out.insert(format!("{name} {i}"), *x);
        }
    };
    for b in &v.bodies {
        put(format!("{} mass", b.name), &[b.mass]);
        put(format!("{} inertia", b.name), &b.inertia);
        put(format!("{} position", b.name), &b.position);
    }
    for w in &v.wheelsets {
        put(format!("{} mass", w.name), &[w.mass, w.radius, w.tape_half_distance]);
        put(format!("{} inertia", w.name), &w.inertia);
        put(format!("{} position", w.name), &w.position);
    }
    for c in &v.connections {
        put(format!("{} points", c.name), &c.points.concat());
        match &c.law {
            railsim::connection::Law::Bushing(law) => {
                put(format!("{} k", c.name), &law.stiffness);
                put(format!("{} c", c.name), &law.damping);
            }
            other => panic!("{other:?}"),
        }
    }
    for s in &v.sensors {
        put(format!("{} position", s.name), &s.position);
    }
    let hold = v.speed_hold.as_ref().unwrap();
    put("speed_hold".into(), &[hold.stiffness, hold.damping]);
    if let Some(drive) = &v.traction {
        put("traction".into(), &[drive.max_effort, drive.power_at_rail]);
    }
    if let Some(brake) = &v.dynamic_brake {
        put("dynamic_brake".into(), &[brake.max_effort]);
    }
    if let Some(brake) = &v.air_brake {
        let times = [brake.apply_time, brake.release_time, brake.service_rate, brake.emergency_rate];
        put("air_brake".into(), &times);
    }
    if let Some(brake) = &v.parking_brake {
        put("parking_brake".into(), &[brake.block_force]);
    }
    put("contact".into(), &[v.contact.youngs_modulus, v.contact.poisson, v.contact.damping]);
    out
}

/// What refers to a parameter, worked out from the text of the file alone: the prefixes under which the numbers
/// above may change.
fn may_change(name: &str) -> Vec<&'static str> {
    let (group, key) = name.split_once('.').unwrap();
    match (group, key) {
        ("car", "mass") => vec!["carbody mass"],
        ("car", "z") => vec!["carbody position"],
        ("car", _) => vec!["carbody inertia"],
        ("bogie", "mass") => vec!["bogie1 mass", "bogie2 mass"],
        ("bogie", "z") => vec!["bogie1 position", "bogie2 position"],
        // The bogies with all that is on them, but not the car body.
        ("bogie", "x") => vec![
            "bogie1 position",
            "bogie2 position",
            "ws",
            "primary_",
            "secondary_",
            "pivot_",
            "lateral_damper_",
            "yaw_damper_",
            "carbody.",
            "bogie1.",
            "bogie2.",
        ],
        ("bogie", _) => vec!["bogie1 inertia", "bogie2 inertia"],
        ("wheelset", "mass" | "tape_half_distance") => vec!["ws"],
        ("wheelset", "radius" | "spacing") => vec!["ws", "primary_", "bogie1.", "bogie2."],
        ("wheelset", _) => vec!["ws"],
        ("primary", _) => vec!["primary_"],
        ("secondary", _) => vec!["secondary_"],
        ("centre_pivot", "z") => vec!["pivot_", "carbody."],
        ("centre_pivot", _) => vec!["pivot_"],
        ("lateral_damper", _) => vec!["lateral_damper_"],
        ("yaw_damper", _) => vec!["yaw_damper_"],
        ("contact", _) => vec!["contact"],
        ("traction", _) => vec!["traction"],
        ("dynamic_brake", _) => vec!["dynamic_brake"],
        ("air_brake", _) => vec!["air_brake"],
        ("parking_brake", _) => vec!["parking_brake"],
        ("speed_hold", _) => vec!["speed_hold"],
        _ => panic!("a new group: {group}"),
    }
}

fn set(name: &str, value: f64) -> Vehicle {
    let overrides = Map::from_iter([(name.to_owned(), json!(value))]);
    let changed = schema::resolve_summary(&coco134(), &overrides, None).unwrap_or_else(|e| panic!("{e}"));
    Vehicle::resolve(&changed["document"], None).unwrap()
}

#[test]
fn every_named_parameter_moves_what_refers_to_it_and_nothing_else() {
    let document = coco134();
    let before = numbers(&Vehicle::resolve(&document, None).unwrap());
    let mut all = Vec::new();
    parameters(&document["parameters"], "", &mut all);
    assert!(all.len() > 40, "{}", all.len());
    for (name, value) in all {
        let after = numbers(&set(&name, value * 1.0625 + if value == 0.0 { 0.5 } else { 0.0 }));
        let changed: Vec<&String> = before.keys().filter(|key| before[*key] != after[*key]).collect();
        assert!(!changed.is_empty(), "nothing refers to {name}");
        let expected = may_change(&name);
        for key in changed {
            assert!(expected.iter().any(|prefix| key.starts_with(prefix)), "{name} moved {key}");
        }
        assert!(
            expected.iter().all(|p| before.keys().any(|k| k.starts_with(p) && before[k] != after[k])),
            "{name}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// The value arrives unrounded, with its sign where the file negates it.
    #[test]
    fn an_overridden_number_arrives_bit_for_bit(x in 1e-6_f64..1e9) {
        let v = set("secondary.kz", x);
        for c in v.connections.iter().filter(|c| c.name.starts_with("secondary_")) {
            let railsim::connection::Law::Bushing(law) = &c.law else { panic!() };
            prop_assert_eq!(law.stiffness[2], x);
        }
        let v = set("wheelset.radius", x);
        prop_assert_eq!(v.wheelsets[0].position[2], -x);
        prop_assert_eq!(v.connections.iter().find(|c| c.name == "primary_ws1_left").unwrap().points[0][2], -x);
    }

    /// Setting twice is setting the second; setting what is there changes nothing.
    #[test]
    fn overrides_are_idempotent(x in 1.0_f64..1e7, y in 1.0_f64..1e7) {
        let one = |document: &Value, x: f64| {
            let overrides = Map::from_iter([("primary.kz".to_owned(), json!(x))]);
            schema::resolve_summary(document, &overrides, None).unwrap()["document"].clone()
        };
        let document = coco134();
        prop_assert_eq!(one(&one(&document, x), y), one(&document, y));
        prop_assert_eq!(one(&document, 4.0e6), document);
    }
}

/// Any JSON, with the words of the format among its keys and texts so that it gets past the first checks.
fn any_json() -> impl Strategy<Value = Value> {
    let word = prop_oneof![
        Just("$a.b"),
        Just("-$a.b"),
        Just("{x}"),
        Just("body"),
        Just("t"),
        Just("bushing"),
        Just("kind"),
        Just("$"),
        Just("time"),
        Just("heun"),
        Just(""),
        Just("{"),
        Just("}{"),
        Just("\u{1f682}"),
    ];
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        word.prop_map(Value::from),
        ".{0,8}".prop_map(Value::from),
    ];
    let key = prop_oneof![
        prop::sample::select(vec![
            "parameters",
            "condition",
            "template",
            "use",
            "body",
            "wheelset",
            "connection",
            "gap",
            "sensor",
            "name",
            "mass",
            "inertia",
            "position",
            "positions",
            "between",
            "kind",
            "stiffness",
            "mirror",
            "with",
            "at",
            "a",
            "b",
            "t",
            "full",
            "design_condition",
            "vehicle",
            "track",
            "run",
            "profiles",
            "points",
            "format",
            "label",
            "integrator",
            "step",
            "output_step",
            "irregularity",
            "layout",
            "creep",
            "length",
            "contact",
        ])
        .prop_map(str::to_owned),
        ".{0,6}",
    ];
    leaf.prop_recursive(5, 64, 6, move |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(Value::from),
            prop::collection::btree_map(key.clone(), inner, 0..6)
                .prop_map(|map| Value::Object(map.into_iter().collect())),
        ]
    })
}

/// Every place of a document, as JSON pointers.
fn pointers(node: &Value, at: String, out: &mut Vec<String>) {
    match node {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| pointers(item, format!("{at}/{i}"), out));
        }
        Value::Object(map) => map.iter().for_each(|(key, item)| pointers(item, format!("{at}/{key}"), out)),
        _ => {}
    }
    out.push(at);
}

/// Accepted, or refused with at least one fault; anything else is a panic on the way.
fn judged<T>(result: Result<T, Error>) -> bool {
    match result {
        Ok(_) => true,
        Err(Error::Input(faults)) => !faults.is_empty(),
        Err(_) => false,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_document_makes_it_panic(json in any_json()) {
        prop_assert!(judged(Vehicle::resolve(&json, None)));
        prop_assert!(judged(Vehicle::resolve(&json, Some("full"))));
        prop_assert!(judged(Case::from_value(&json)));
        let overrides = json.as_object().cloned().unwrap_or_default();
        prop_assert!(judged(schema::resolve_summary(&json, &overrides, None)));
    }

    #[test]
    fn no_damage_to_a_good_document_makes_it_panic(
        pick in any::<prop::sample::Index>(),
        (text, condition) in prop::sample::select(vec![(TROLLEY, "empty"), (BOBO86, "tare"), (WAGON2, "tare")]),
        json in any_json(),
    ) {
        let mut document = toml_to_json(text).unwrap();
        let mut all = Vec::new();
        pointers(&document, String::new(), &mut all);
        let pointer: &String = pick.get(&all);
        *document.pointer_mut(pointer).unwrap() = json;
        prop_assert!(judged(Vehicle::resolve(&document, Some(condition))));
    }

    #[test]
    fn no_text_makes_it_panic(text in ".{0,40}", key in ".{0,5}", index in 0_usize..3) {
        let _ = toml_to_json(&text);
        let _ = schema::syntax_error(&text);
        let path = KeyPath(vec![Segment::Key(key), Segment::Index(index)]);
        let _ = line_of(&text, &path);
        prop_assert!(judged(Case::from_json(&text)));
    }

    /// Cutting a file short is what an editor saves half-way.
    #[test]
    fn no_part_of_a_file_makes_it_panic(length in 0_usize..1800) {
        let text: String = TROLLEY.chars().take(length).collect();
        if let Ok(json) = toml_to_json(&text) {
            prop_assert!(judged(Vehicle::resolve(&json, None)));
        }
    }
}

#[test]
fn templates_that_grow_as_a_power_are_refused_not_expanded() {
    let mut text = TROLLEY.to_owned();
    for level in 0..20 {
        for _ in 0..2 {
            text += &format!("\n[[template.t{level}.use]]\ntemplate = \"t{}\"\n", level + 1);
        }
    }
    text += "\n[[template.t20.sensor]]\nname = \"s\"\nbody = \"frame\"\nposition = [0.0, 0.0, 0.0]\n\n[[use]]\ntemplate = \"t0\"\n";
    match Vehicle::resolve(&toml_to_json(&text).unwrap(), None) {
        Err(Error::Input(faults)) => assert!(faults[0].found.contains("10000 elements"), "{}", faults[0]),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_long_chain_of_templates_is_refused() {
    let mut text = TROLLEY.to_owned();
    for level in 0..5000 {
        text += &format!("\n[[template.t{level}.use]]\ntemplate = \"t{}\"\n", level + 1);
    }
    text += "\n[template.t5000]\n\n[[use]]\ntemplate = \"t0\"\n";
    match Vehicle::resolve(&toml_to_json(&text).unwrap(), None) {
        Err(Error::Input(faults)) => assert_eq!(
            faults[0].to_string(),
            "vehicle.template.t31.use[0].template: found 33 templates within each other; allowed: 32 at most"
        ),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_json_schema_lets_a_reference_stand_for_a_number() {
    let schema = schema::vehicle_schema();
    let speed = &schema["properties"]["design_speed_kmh"]["anyOf"];
    assert_eq!(speed[0]["type"], "number");
    assert_eq!(speed[1]["type"], "string");
    assert!(schema["properties"]["connection"].is_object());
}
