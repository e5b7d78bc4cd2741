//! Cases for tests: the shipped vehicle, track and profiles, read from the project's own files.

#![allow(dead_code)] // each test binary uses its own part

pub mod contact;

use std::path::PathBuf;

use railsim::schema::{Case, toml_to_json};
use serde_json::{Value, json};

pub fn models() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../models")
}

pub fn read_toml(path: &str) -> Value {
    let text = std::fs::read_to_string(models().join(path)).unwrap();
    toml_to_json(&text).unwrap()
}

pub fn profile(name: &str, kind: &str) -> Value {
    let text = std::fs::read_to_string(models().join(format!("profiles/{name}.csv"))).unwrap();
    let points = railsim::contact::profile::read_csv(&text, name).unwrap();
    let mm: Vec<[f64; 2]> = points.iter().map(|p| p.map(|v| v * 1e3)).collect();
    json!({ "kind": kind, "points": mm })
}

/// The reference locomotive on ideal tangent track, new profiles.
pub fn coco134() -> Value {
    let mut track = read_toml("tracks/plain_1435_as60.toml");
    track["length"] = json!(200.0);
    json!({
        "format": 1,
        "label": "test",
        "vehicle": read_toml("vehicles/coco134.toml"),
        "condition": "full",
        "track": track,
        "run": {
            "kind": "time",
            "speed": 35.0,
            "friction": 0.4,
            "wheel_profile": "anzr1",
            "integrator": { "kind": "ros2", "step": 0.001 },
            "output_step": 0.005
        },
        "profiles": {
            "anzr1": profile("anzr1", "wheel"),
            "anzr1_worn_1": profile("anzr1_worn_1", "wheel"),
            "as60": profile("as60", "rail")
        }
    })
}

pub fn case(value: &Value) -> Case {
    Case::from_value(value).unwrap_or_else(|e| panic!("{e}"))
}

pub fn column<'a>(columns: &'a [(String, Vec<f64>)], name: &str) -> &'a [f64] {
    &columns.iter().find(|(n, _)| n == name).unwrap_or_else(|| panic!("no channel {name}")).1
}
