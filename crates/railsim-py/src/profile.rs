//! Profiles: files read and written, points examined and smoothed. Points cross as JSON, in millimetres.

use pyo3::prelude::*;
use railsim::contact::profile::{
    Finding, HALF_WIDTH, PointList, Profile, ProfileKind, ReadOptions, WriteOptions, quality, read, write,
};
use railsim::{Error, Fault, KeyPath, Result};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::errors::raise;

/// Points of a profile file's text.
#[pyfunction]
#[pyo3(signature = (text, name, options_json="{}"))]
pub fn read_profile(py: Python<'_>, text: &str, name: &str, options_json: &str) -> PyResult<String> {
    let profile = py.detach(|| from_text(text, name, options_json)).map_err(|e| raise(py, e))?;
    Ok(json!({"points": in_millimetres(&profile.points)}).to_string())
}

/// The same with all that was found out about it.
#[pyfunction]
#[pyo3(signature = (text, name, options_json="{}"))]
pub fn inspect_profile(py: Python<'_>, text: &str, name: &str, options_json: &str) -> PyResult<String> {
    let profile = from_text(text, name, options_json).map_err(|e| raise(py, e))?;
    let found = quality(&profile.points, profile.kind);
    Ok(json!({
        "points": in_millimetres(&profile.points),
        "kind": profile.kind,
        "detected": profile.detected,
        "findings": found.iter().map(finding).collect::<Vec<_>>(),
        "smoothing": {
            "half_width": millimetres(HALF_WIDTH),
            "because": "local cubics by least squares; z once continuously differentiable, curvature continuous",
        },
    })
    .to_string())
}

/// The text of a profile file.
#[pyfunction]
#[pyo3(signature = (points_json, name, options_json="{}"))]
pub fn write_profile(py: Python<'_>, points_json: &str, name: &str, options_json: &str) -> PyResult<String> {
    let written = || {
        let options: WriteOptions = parsed(options_json, "options", "kind, format and title")?;
        write(&points(points_json)?, name, &options)
    };
    written().map_err(|e| raise(py, e))
}

/// What is remarkable about points.
#[pyfunction]
#[pyo3(signature = (points_json, kind=None))]
pub fn profile_quality(py: Python<'_>, points_json: &str, kind: Option<&str>) -> PyResult<String> {
    let found = || Ok(quality(&points(points_json)?, kind.map(wheel_or_rail).transpose()?));
    let found: Vec<Value> = found().map_err(|e| raise(py, e))?.iter().map(finding).collect();
    Ok(Value::from(found).to_string())
}

/// The smoothed curve through points.
#[pyfunction]
#[pyo3(signature = (points_json, kind, half_width=1.0))]
pub fn smooth_profile(py: Python<'_>, points_json: &str, kind: &str, half_width: f64) -> PyResult<String> {
    let smoothed = || {
        let (kind, points) = (wheel_or_rail(kind)?, points(points_json)?);
        Profile::smoothed(&points, kind, 1e-3 * half_width, &KeyPath::of("points"))
    };
    let profile = smoothed().map_err(|e| raise(py, e))?;
    let column = |of: fn(&railsim::contact::profile::Station) -> f64| -> Vec<f64> {
        profile.stations().iter().map(of).collect()
    };
    Ok(json!({
        "y": column(|s| 1e3 * s.y),
        "z": column(|s| 1e3 * s.z),
        "angle": column(|s| s.direction),
        "curvature": column(|s| s.curvature),
    })
    .to_string())
}

fn from_text(text: &str, name: &str, options_json: &str) -> Result<PointList> {
    let options: ReadOptions = parsed(
        options_json,
        "options",
        "kind, format, unit, mirror_y and mirror_z, each only if it is to overrule",
    )?;
    read(text, name, &options)
}

fn parsed<T: DeserializeOwned>(text: &str, key: &str, allowed: &str) -> Result<T> {
    serde_json::from_str(text).map_err(|e| Error::input(Fault::new(KeyPath::of(key), e.to_string(), allowed)))
}

fn points(text: &str) -> Result<Vec<[f64; 2]>> {
    let points: Vec<[f64; 2]> = parsed(text, "points", "a list of [y, z], mm")?;
    Ok(points.iter().map(|point| point.map(|x| 1e-3 * x)).collect())
}

fn wheel_or_rail(kind: &str) -> Result<ProfileKind> {
    match kind {
        "wheel" => Ok(ProfileKind::Wheel),
        "rail" => Ok(ProfileKind::Rail),
        _ => Err(Error::input(Fault::new(KeyPath::of("kind"), format!("\"{kind}\""), "wheel, rail"))),
    }
}

fn finding(finding: &Finding) -> Value {
    json!({
        "code": finding.code,
        "severity": finding.severity,
        "index": finding.index,
        "place": finding.place.map(|place| place.map(millimetres)),
        "text": finding.text,
    })
}

fn in_millimetres(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    points.iter().map(|point| point.map(millimetres)).collect()
}

/// Metres as millimetres, to the picometre: 1e3 times the number that 1e-3 made out of 46.1 is not 46.1.
fn millimetres(metres: f64) -> f64 {
    (metres * 1e12).round() / 1e9
}
