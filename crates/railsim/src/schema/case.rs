//! A case: one fully resolved simulation as plain data.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value as Json, json};

use super::check::{self, unknown};
use super::document::{Document, finish};
use super::node::{Node, Value, quoted};
use super::run::{Run, RunKind};
use super::run_check;
use super::track::Track;
use super::vehicle::Vehicle;
use crate::contact::creep::CreepLaw;
use crate::contact::friction::Friction;
use crate::contact::geometry_table::Tables;
use crate::error::{Error, Fault, KeyPath, Result};
use crate::integrator::Integrator;
use crate::track::irregularity::{DeviationField, Irregularity};
use crate::track::{Layout, Segment};

/// The version of the case format that this code reads.
pub const FORMAT: u64 = 1;

/// A profile needs this many points for a spline with a meaningful curvature.
const LEAST_POINTS: usize = 8;

/// JSON schemas of a case's tables `track` and `run`, by name: keys, units, ranges, meanings.
#[must_use]
pub fn case_schema() -> Json {
    json!({ "track": check::schema_of::<Track>(), "run": check::schema_of::<Run>() })
}

/// One simulation: vehicle, track, run and all the data that they name.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// What varies within the spec, e.g. `anzr1_worn_1`.
    pub label: String,
    /// The vehicle in the case's condition.
    pub vehicle: Vehicle,
    /// The vehicle in its design condition, in which it stands at its written heights: preloads are solved there.
    pub design: Vehicle,
    /// The track.
    pub track: Track,
    /// What is done.
    pub run: Run,
    /// Profiles by name.
    pub profiles: BTreeMap<String, ProfileData>,
    /// The vehicle as written, overrides in it: what names and references are looked for in.
    pub written: Json,
    /// Contact tables that the case shares with others; one of its own to begin with.
    pub tables: Tables,
}

/// Which of the two a profile is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ProfileKind {
    /// A wheel.
    Wheel,
    /// A rail.
    Rail,
}

/// The points of a profile.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileData {
    /// Wheel or rail.
    pub kind: ProfileKind,
    /// Lateral coordinate (flange or gauge corner negative) and depth, m. In a case they stand in mm.
    pub points: Vec<[f64; 2]>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct WrittenCase {
    #[serde(rename = "format")]
    _format: u64,
    label: String,
    #[serde(rename = "vehicle")]
    _vehicle: serde_json::Map<String, Json>,
    #[serde(rename = "condition")]
    _condition: String,
    track: Track,
    run: Run,
    #[serde(default)]
    profiles: BTreeMap<String, WrittenProfile>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct WrittenProfile {
    /// Wheel or rail.
    kind: ProfileKind,
    /// Lateral coordinate and depth, mm.
    points: Vec<[f64; 2]>,
}

impl Case {
    /// Reads a case from JSON and checks it. Key paths start at the root of the case.
    ///
    /// # Errors
    /// [`Error::Input`] with every fault of structure, range and reference, of the vehicle too.
    pub fn from_json(text: &str) -> Result<Self> {
        let json: Json = serde_json::from_str(text).map_err(|e| {
            let key = KeyPath::of(&format!("line {}, column {}", e.line(), e.column()));
            Error::input(Fault::new(key, e.to_string(), "JSON"))
        })?;
        Self::from_value(&json)
    }

    /// The same from parsed JSON.
    ///
    /// # Errors
    /// As [`Case::from_json`].
    pub fn from_value(json: &Json) -> Result<Self> {
        let mut faults = Vec::new();
        let case = read(json, &mut faults);
        finish(case, faults)
    }
}

fn read(json: &Json, faults: &mut Vec<Fault>) -> Option<Case> {
    let mut root = Node::from_json(json, KeyPath::default());
    if !matches!(root.value, Value::Table(_)) {
        faults.push(Fault::new(KeyPath::of("case"), root.found(), "a table"));
        return None;
    }
    check_format(&root, faults)?;
    one_irregularity_is_a_list(&mut root);

    let condition = root.get("condition").and_then(Node::text);
    let document = json.get("vehicle").filter(|v| v.is_object());
    let (vehicle, design) = match document {
        Some(document) => {
            let document = Document::read(document, faults);
            // Without a condition its own fault is enough; the rest is checked in the design condition.
            let vehicle = condition.and_then(|c| document.resolve(Some(c), faults));
            (vehicle, document.resolve(None, faults))
        }
        None => (None, None),
    };
    let own_profile = document.and_then(|d| d.get("wheel_profile")).and_then(Json::as_str);
    relations(&root, own_profile, faults);
    let written = check::read::<WrittenCase>(&root, faults)?;

    let vehicle = vehicle?;
    let mut run = written.run;
    if run.wheel_profile.is_empty() {
        run.wheel_profile.clone_from(&vehicle.wheel_profile);
    }
    let millimetres = |points: Vec<[f64; 2]>| points.iter().map(|p| p.map(|x| x * 1e-3)).collect();
    Some(Case {
        label: written.label,
        vehicle,
        design: design?,
        track: written.track,
        run,
        profiles: written
            .profiles
            .into_iter()
            .map(|(name, p)| (name, ProfileData { kind: p.kind, points: millimetres(p.points) }))
            .collect(),
        written: document.cloned().unwrap_or_default(),
        tables: Tables::default(),
    })
}

fn check_format(root: &Node, faults: &mut Vec<Fault>) -> Option<()> {
    let Some(format) = root.get("format") else { return Some(()) };
    if let Some(found) = format.number()
        && found != FORMAT as f64
    {
        faults.push(Fault::new(format.at.clone(), format.found(), FORMAT.to_string()));
        return None;
    }
    Some(())
}

fn one_irregularity_is_a_list(root: &mut Node) {
    let Value::Table(map) = &mut root.value else { return };
    let Some(Value::Table(track)) = map.get_mut("track").map(|t| &mut t.value) else { return };
    if let Some(node) = track.get_mut("irregularity")
        && matches!(node.value, Value::Table(_))
    {
        let one = node.clone();
        node.value = Value::List(vec![one]);
    }
}

/// What holds between several keys. Each is looked at in the tree, so that it is said beside the faults of structure.
fn relations(root: &Node, own_profile: Option<&str>, faults: &mut Vec<Fault>) {
    let at = |table: &str, key: &str| root.get(table).and_then(|t| t.get(key));
    if let Some(output) = at("run", "output_step")
        && let Some(step) = at("run", "integrator").and_then(|i| i.get("step"))
    {
        steps(step, output, faults);
    }
    if let Some(run) = root.get("run") {
        run_check::relations(run, faults);
    }
    if let Some(start) = at("run", "start")
        && let (Some(from), Some(to)) = (start.number(), at("track", "length").and_then(Node::number))
        && from >= to
    {
        let allowed = format!("from 0 to less than track.length = {to} m");
        faults.push(Fault::new(start.at.clone(), start.found(), allowed));
    }
    if let Some(node) = at("track", "irregularity")
        && let Some(kind) = at("run", "kind").and_then(Node::text)
        && kind != RunKind::Time.name()
        && !node.items().is_empty()
    {
        let found = format!("an irregularity with run.kind = {}", quoted(kind));
        faults.push(Fault::new(node.at.clone(), found, "none: this is done on the design track"));
    }
    leaf(at("run", "integrator"), Integrator::faults, faults);
    leaf(at("run", "creep"), CreepLaw::faults, faults);
    leaf(at("run", "friction"), Friction::faults, faults);
    for node in at("track", "irregularity").into_iter().flat_map(Node::items) {
        leaf(Some(node), Irregularity::faults, faults);
    }
    if let Some(node) = root.get("track") {
        fade(node, faults);
    }
    if let Some(node) = at("track", "layout")
        && let Some(length) = at("track", "length").and_then(Node::number).filter(|length| *length > 0.0)
        && let Some(segments) = check::read::<Vec<Segment>>(node, &mut Vec::new())
        && let Err(Error::Input(own)) = Layout::new(&segments, length, &node.at)
    {
        faults.extend(own);
    }
    let wheel = match at("run", "wheel_profile") {
        Some(node) => node.text().map(|name| (name, node.at.clone())),
        None => own_profile.map(|name| (name, KeyPath::of("vehicle.wheel_profile"))),
    };
    if let Some((name, key)) = wheel {
        profile(root, name, key, "wheel", faults);
    }
    if let Some(node) = at("track", "rail_profile")
        && let Some(name) = node.text()
    {
        profile(root, name, node.at.clone(), "rail", faults);
    }
    for profile in root.get("profiles").and_then(Node::table).into_iter().flat_map(|p| p.values()) {
        if let Some(points) = profile.get("points")
            && matches!(points.value, Value::List(_))
            && points.items().len() < LEAST_POINTS
        {
            let found = format!("{} points", points.items().len());
            faults.push(Fault::new(points.at.clone(), found, format!("{LEAST_POINTS} points or more")));
        }
    }
}

fn steps(step: &Node, output: &Node, faults: &mut Vec<Fault>) {
    let (Some(h), Some(dt)) = (step.number(), output.number()) else { return };
    if h <= 0.0 || dt <= 0.0 {
        return; // said by the integrator and by the schema
    }
    let ratio = dt / h;
    let whole = ratio.round();
    // Both are decimal fractions, so a true multiple is off by a few roundings.
    if whole < 1.0 || (ratio - whole).abs() > 1e-9 * whole {
        let allowed = format!("a whole multiple of run.integrator.step = {h} s");
        faults.push(Fault::new(output.at.clone(), output.found(), allowed));
    }
}

/// How the irregularity fades in; the field itself is made when the case is compiled.
fn fade(track: &Node, faults: &mut Vec<Fault>) {
    let length = |key: &str| track.get(key).map_or(Some(0.0), Node::number).filter(|x| *x >= 0.0);
    if let (Some(start), Some(over)) = (length("fade_start"), length("fade_in"))
        && let Err(Error::Input(own)) =
            DeviationField::new(&[], 0.0, start, over, &track.at.key("irregularity"))
    {
        faults.extend(own);
    }
}

/// The faults that a leaf finds in its own table. What it cannot even read is said by the structural check.
fn leaf<T: JsonSchema + DeserializeOwned>(
    node: Option<&Node>,
    own: impl Fn(&T, &KeyPath) -> Vec<Fault>,
    faults: &mut Vec<Fault>,
) {
    if let Some(node) = node
        && let Some(value) = check::read::<T>(node, &mut Vec::new())
    {
        faults.extend(own(&value, &node.at));
    }
}

fn profile(root: &Node, name: &str, key: KeyPath, kind: &str, faults: &mut Vec<Fault>) {
    let profiles = root.get("profiles").and_then(Node::table);
    let names: Vec<&str> = profiles.into_iter().flat_map(|p| p.keys()).map(String::as_str).collect();
    match profiles.and_then(|p| p.get(name)) {
        None => {
            let allowed = if names.is_empty() {
                "a profile in profiles, which is empty".to_owned()
            } else {
                format!("a profile in profiles: {}", names.join(", "))
            };
            faults.push(unknown(key, quoted(name), allowed, name, names));
        }
        Some(found) => {
            if let Some(other) = found.get("kind").and_then(Node::text)
                && ["rail", "wheel"].contains(&other)
                && other != kind
            {
                faults.push(Fault::new(
                    key,
                    format!("{}, a {other} profile", quoted(name)),
                    format!("a {kind} profile"),
                ));
            }
        }
    }
}
