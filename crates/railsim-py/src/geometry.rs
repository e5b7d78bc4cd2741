//! Contact geometry of a wheelset on its track by direct search: rolling radius difference, conicity, contact map.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use railsim::contact::conicity::{Method, RadiusCurve};
use railsim::contact::pair::{Pair, Roll};
use railsim::contact::search::{Part, Patch, Pose, RailShift, Side, Touch};
use railsim::dynamics::compile;
use railsim::schema::Case;

use crate::arrow::Frame;
use crate::errors::raise;

/// A pair from its own JSON, or from that of a case (which has a vehicle).
fn pair(json: &str) -> railsim::Result<Pair> {
    let is_case = serde_json::from_str::<serde_json::Value>(json).is_ok_and(|v| v.get("vehicle").is_some());
    if is_case {
        let side = compile::side(&Case::from_json(json)?)?;
        return Ok(Pair::new(side.clone(), side));
    }
    Pair::from_json(json)
}

fn roll_of(free: bool) -> Roll {
    if free { Roll::Free } else { Roll::Level }
}

fn method_named(name: &str) -> PyResult<Method> {
    Method::named(name).ok_or_else(|| {
        PyValueError::new_err(format!("method '{name}': one of integration, regression, harmonic"))
    })
}

fn frame(columns: Vec<(&str, Vec<f64>)>) -> PyResult<Frame> {
    let columns = columns.into_iter().map(|(name, values)| (name.to_owned(), values)).collect();
    Frame::table(columns)
}

/// Rolling radius of the right wheel less that of the left at every shift.
#[pyfunction]
#[pyo3(signature = (pair_json, shifts, free_roll=false))]
pub fn rolling_radius_difference(
    py: Python<'_>,
    pair_json: &str,
    shifts: Vec<f64>,
    free_roll: bool,
) -> PyResult<Vec<Option<f64>>> {
    py.detach(|| {
        let pair = pair(pair_json)?;
        Ok(shifts.iter().map(|y| pair.rolling_radius_difference(*y, roll_of(free_roll)).ok()).collect())
    })
    .map_err(|e| raise(py, e))
}

/// Equivalent conicity at every amplitude.
#[pyfunction]
#[pyo3(signature = (pair_json, amplitudes, method="integration", free_roll=false, step=1e-4))]
pub fn pair_conicity(
    py: Python<'_>,
    pair_json: &str,
    amplitudes: Vec<f64>,
    method: &str,
    free_roll: bool,
    step: f64,
) -> PyResult<Vec<Option<f64>>> {
    let method = method_named(method)?;
    if !(1e-6..=1e-3).contains(&step) {
        return Err(PyValueError::new_err(format!("step {step} m: 1e-6 to 1e-3")));
    }
    let widest = amplitudes.iter().copied().filter(|a| a.is_finite()).fold(1e-3, f64::max);
    py.detach(|| {
        let pair = pair(pair_json)?;
        let curve = pair.radius_curve((2.0 * widest + 0.004).min(0.05), step, roll_of(free_roll));
        // a wheelset that does not stand even when centred has no conicity
        Ok(amplitudes
            .iter()
            .map(|a| curve.as_ref().ok().and_then(|curve| curve.conicity(*a, method)))
            .collect())
    })
    .map_err(|e: railsim::Error| raise(py, e))
}

/// Equivalent conicity of a rolling radius difference given by points.
#[pyfunction]
#[pyo3(signature = (y, difference, amplitudes, method="integration"))]
pub fn curve_conicity(
    y: Vec<f64>,
    difference: Vec<f64>,
    amplitudes: Vec<f64>,
    method: &str,
) -> PyResult<Vec<Option<f64>>> {
    let method = method_named(method)?;
    if y.len() != difference.len() {
        return Err(PyValueError::new_err(format!(
            "{} positions, {} differences",
            y.len(),
            difference.len()
        )));
    }
    let points: Vec<[f64; 2]> = y.into_iter().zip(difference).map(|(y, d)| [y, d]).collect();
    let curve = RadiusCurve::new(&points);
    Ok(amplitudes.iter().map(|a| curve.conicity(*a, method)).collect())
}

const COLUMNS: [&str; 21] = [
    "y",
    "side",
    "rank",
    "part",
    "roll",
    "z",
    "gap",
    "y_rail",
    "z_rail",
    "y_wheel",
    "z_wheel",
    "x",
    "angle",
    "radius",
    "k_xx",
    "k_yy",
    "normal",
    "a",
    "b",
    "curvature",
    "spread",
];

/// Every contact at every shift.
#[pyfunction]
#[pyo3(signature = (pair_json, shifts, yaw=0.0, free_roll=true, load=None, rail_shift=None, rail_roll=None))]
#[allow(clippy::too_many_arguments)] // keywords in Python
pub fn contact_map(
    py: Python<'_>,
    pair_json: &str,
    shifts: Vec<f64>,
    yaw: f64,
    free_roll: bool,
    load: Option<f64>,
    rail_shift: Option<[f64; 2]>,
    rail_roll: Option<[f64; 2]>,
) -> PyResult<Frame> {
    let (rail_shift, rail_roll) = (rail_shift.unwrap_or_default(), rail_roll.unwrap_or_default());
    let rails = [0, 1].map(|i| RailShift { y: rail_shift[i], z: 0.0, roll: rail_roll[i] });
    let columns = py
        .detach(|| {
            let pair = pair(pair_json)?;
            let mut columns: [Vec<f64>; 21] = Default::default();
            for &y in &shifts {
                let Ok(rows) = rows(&pair, y, yaw, free_roll, load, &rails) else { continue };
                for row in rows {
                    columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
                }
            }
            Ok(columns)
        })
        .map_err(|e: railsim::Error| raise(py, e))?;
    frame(COLUMNS.into_iter().zip(columns).collect())
}

type Row = [f64; 21];

fn rows(
    pair: &Pair,
    y: f64,
    yaw: f64,
    free_roll: bool,
    load: Option<f64>,
    rails: &[RailShift; 2],
) -> Result<Vec<Row>, railsim::contact::search::NoContact> {
    let roll = if free_roll { pair.stand(y, yaw, rails)?.roll } else { 0.0 };
    let poses = pair.poses(y, 0.0, roll, yaw);
    let mut out = Vec::new();
    for (i, (side, pose)) in pair.sides.iter().zip(poses).enumerate() {
        let sigma = if i == 0 { -1.0 } else { 1.0 };
        match load {
            None => {
                let pose = Pose { z: pose.z + side.gap(&pose, &rails[i])?, ..pose };
                for (rank, touch) in side.closest(&pose, &rails[i])?.iter().enumerate() {
                    out.push(row(side, y, sigma, rank, roll, pose.z, touch, None));
                }
            }
            Some(load) => {
                let pressed = side.press(&pose, &rails[i], load)?;
                for (rank, patch) in pressed.patches.iter().enumerate() {
                    out.push(row(side, y, sigma, rank, roll, pressed.pose.z, &patch.centre, Some(patch)));
                }
            }
        }
    }
    Ok(out)
}

#[allow(clippy::too_many_arguments)] // one row
fn row(
    side: &Side,
    y: f64,
    sigma: f64,
    rank: usize,
    roll: f64,
    z: f64,
    touch: &Touch,
    patch: Option<&Patch>,
) -> Row {
    let part = match touch.part {
        Part::Tread => 0.0,
        Part::Flange => 1.0,
        Part::FlangeBack => 2.0,
    };
    let [normal, a, b, curvature, spread] =
        patch.map_or([f64::NAN; 5], |p| [p.normal, p.a, p.b, p.curvature, p.spread]);
    [
        y,
        sigma,
        rank as f64,
        part,
        roll,
        z,
        touch.gap,
        touch.rail[0],
        touch.rail[1],
        touch.wheel[0],
        touch.wheel[1],
        touch.ahead,
        touch.angle,
        side.placement().wheel_radius + touch.wheel[1],
        touch.k_xx,
        touch.k_yy,
        normal,
        a,
        b,
        curvature,
        spread,
    ]
}
