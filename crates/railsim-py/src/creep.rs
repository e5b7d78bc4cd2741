//! Creep forces of many contacts at once, and Kalker's coefficients.

use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use railsim::contact::creep::{self, CreepLaw, Creepage, Patch};
use railsim::contact::friction::Falling;
use railsim::contact::kalker_table;
use railsim::{Error, Fault, KeyPath};
use serde::de::DeserializeOwned;

use crate::arrow::Frame;
use crate::errors::raise;

const NEEDED: [&str; 11] = ["a", "b", "n", "c11", "c22", "c23", "shear_modulus", "xi", "eta", "phi", "mu"];
const OPTIONAL: [&str; 2] = ["c33", "speed"];

/// More faults than this are not listed.
const LISTED: usize = 10;

/// Values of one name: one for all contacts, or one each.
struct Column {
    name: &'static str,
    values: Vec<f64>,
}

impl Column {
    fn at(&self, i: usize) -> f64 {
        if self.values.len() == 1 { self.values[0] } else { self.values[i] }
    }

    fn key(&self, i: usize) -> KeyPath {
        let key = KeyPath::of(self.name);
        if self.values.len() == 1 { key } else { key.index(i) }
    }
}

fn input(key: KeyPath, found: impl Into<String>, allowed: impl Into<String>) -> Error {
    Error::Input(vec![Fault::new(key, found, allowed)])
}

/// JSON text under the name `at`.
fn parse<T: DeserializeOwned>(text: &str, at: &str, allowed: &str) -> Result<T, Error> {
    serde_json::from_str(text).map_err(|e| input(KeyPath::of(at), e.to_string(), allowed))
}

fn column(contacts: &Bound<'_, PyDict>, name: &'static str) -> PyResult<Option<Column>> {
    let Some(value) = contacts.get_item(name)? else { return Ok(None) };
    let values = if let Ok(one) = value.extract::<f64>() {
        vec![one]
    } else if let Ok(buffer) = PyBuffer::<f64>::get(&value) {
        buffer.to_vec(value.py())?
    } else {
        value.extract::<Vec<f64>>().map_err(|_| {
            let found =
                value.get_type().name().map_or_else(|_| "something else".to_owned(), |n| n.to_string());
            raise(value.py(), input(KeyPath::of(name), found, "a number, or numbers in an array or a list"))
        })?
    };
    Ok(Some(Column { name, values }))
}

/// The columns by name, all of one length or of length one; and that length.
fn columns(contacts: &Bound<'_, PyDict>) -> PyResult<(Vec<Column>, usize)> {
    let py = contacts.py();
    let mut faults = Vec::new();
    for key in contacts.keys() {
        let name: String = key.extract()?;
        if !NEEDED.contains(&name.as_str()) && !OPTIONAL.contains(&name.as_str()) {
            let allowed = format!("{}; {}", NEEDED.join(", "), OPTIONAL.join(", "));
            faults.push(Fault::new(KeyPath::of(&name), "an unknown name", allowed));
        }
    }
    let mut columns = Vec::new();
    for name in NEEDED.into_iter().chain(OPTIONAL) {
        match column(contacts, name)? {
            Some(column) => columns.push(column),
            None if NEEDED.contains(&name) => {
                faults.push(Fault::new(
                    KeyPath::of(name),
                    "nothing",
                    "a number, or numbers in an array or a list",
                ));
            }
            None => {}
        }
    }
    let count = columns.iter().map(|c| c.values.len()).find(|n| *n != 1).unwrap_or(1);
    for column in columns.iter().filter(|c| c.values.len() != 1 && c.values.len() != count) {
        faults.push(Fault::new(
            KeyPath::of(column.name),
            format!("{} values", column.values.len()),
            format!("1, or {count} as the others have"),
        ));
    }
    if faults.is_empty() { Ok((columns, count)) } else { Err(raise(py, Error::Input(faults))) }
}

/// Contact `i`: patch, creepage, friction at zero slip velocity.
fn contact(columns: &[Column], i: usize) -> (Patch, Creepage, f64) {
    let v: [f64; 11] = std::array::from_fn(|k| columns[k].at(i));
    let [a, b, n, c11, c22, c23, shear_modulus, xi, eta, phi, mu] = v;
    (Patch { a, b, n, c11, c22, c23, shear_modulus }, Creepage { xi, eta, phi }, mu)
}

struct Work {
    law: CreepLaw,
    falling: Option<Falling>,
    columns: Vec<Column>,
    count: usize,
}

impl Work {
    fn optional(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|c| c.name == name)
    }

    fn faults(&self) -> Vec<Fault> {
        let root = KeyPath::default();
        let mut faults = Vec::new();
        for i in 0..self.count {
            let (patch, creepage, mu) = contact(&self.columns, i);
            for mut fault in creep::faults(&patch, &creepage, mu, &root) {
                if let Some(column) = self.columns.iter().find(|c| KeyPath::of(c.name) == fault.key) {
                    fault.key = column.key(i);
                }
                faults.push(fault);
            }
            for name in OPTIONAL {
                if let Some(column) = self.optional(name)
                    && !(column.at(i).is_finite() && column.at(i) >= 0.0)
                {
                    faults.push(Fault::new(column.key(i), column.at(i).to_string(), "a number >= 0"));
                }
            }
            // a fault in a number that holds for all is one fault
            faults.dedup_by(|a, b| a.key == b.key);
            if faults.len() >= LISTED {
                break;
            }
        }
        faults.sort_by_key(|fault| fault.key.to_string());
        faults.dedup_by(|a, b| a.key == b.key);
        faults
    }

    fn forces(&self) -> Vec<(String, Vec<f64>)> {
        let (speed, c33) = (self.optional("speed"), self.optional("c33"));
        let (mut fx, mut fy, mut mz) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..self.count {
            let (patch, creepage, friction) = contact(&self.columns, i);
            let slip = speed.map_or(0.0, |v| v.at(i) * creepage.xi.hypot(creepage.eta));
            let mu = self.falling.map_or(friction, |falling| friction * falling.factor(slip));
            let force = self.law.force(&patch, &creepage, mu);
            fx.push(force.fx);
            fy.push(force.fy);
            if let Some(c33) = c33 {
                mz.push(self.law.spin_moment(&patch, c33.at(i), &creepage, mu).unwrap_or(f64::NAN));
            }
        }
        let mut out = vec![("fx".to_owned(), fx), ("fy".to_owned(), fy)];
        if c33.is_some() {
            out.push(("mz".to_owned(), mz));
        }
        out
    }
}

/// Creep forces on the wheel for many patches, creepages and coefficients of friction.
#[pyfunction]
#[pyo3(signature = (law_json, contacts, falling_json=None))]
pub fn creep_forces(
    py: Python<'_>,
    law_json: &str,
    contacts: &Bound<'_, PyDict>,
    falling_json: Option<&str>,
) -> PyResult<Frame> {
    let law: CreepLaw =
        parse(law_json, "creep", "a creep law, as {\"kind\": \"fastsim\"}").map_err(|e| raise(py, e))?;
    let falling: Option<Falling> = falling_json
        .map(|text| parse(text, "falling", "{\"ratio\": .., \"decay\": ..}"))
        .transpose()
        .map_err(|e| raise(py, e))?;
    let mut faults = law.faults(&KeyPath::of("creep"));
    faults.extend(falling.iter().flat_map(|f| f.faults(&KeyPath::of("falling"))));
    let (columns, count) = columns(contacts)?;
    let work = Work { law, falling, columns, count };
    if work.falling.is_some() && work.optional("speed").is_none() {
        faults.push(Fault::new(
            KeyPath::of("speed"),
            "nothing",
            "the rolling speed, m/s, with falling friction",
        ));
    }
    faults.extend(work.faults());
    if !faults.is_empty() {
        return Err(raise(py, Error::Input(faults)));
    }
    Frame::table(py.detach(|| work.forces()))
}

/// Kalker's coefficients for many axis ratios.
#[pyfunction]
pub fn kalker_coefficients(py: Python<'_>, a_over_b: Vec<f64>, poisson: f64) -> PyResult<Frame> {
    let mut faults: Vec<Fault> = a_over_b
        .iter()
        .enumerate()
        .filter(|(_, ratio)| !(ratio.is_finite() && **ratio > 0.0))
        .map(|(i, ratio)| Fault::new(KeyPath::of("a_over_b").index(i), ratio.to_string(), "a number > 0"))
        .take(LISTED)
        .collect();
    if !(0.0..=0.5).contains(&poisson) {
        faults.push(Fault::new(KeyPath::of("poisson"), poisson.to_string(), "0 to 0.5"));
    }
    if !faults.is_empty() {
        return Err(raise(py, Error::Input(faults)));
    }
    let all: Vec<_> = a_over_b.iter().map(|ratio| kalker_table::coefficients(*ratio, poisson)).collect();
    let column = |name: &str, of: fn(&kalker_table::Coefficients) -> f64| {
        (name.to_owned(), all.iter().map(of).collect())
    };
    Frame::table(vec![
        column("c11", |c| c.c11),
        column("c22", |c| c.c22),
        column("c23", |c| c.c23),
        column("c33", |c| c.c33),
    ])
}
