//! A measured track: samples of the channels along the line, as a recording car gives them.
//!
//! The core opens no file: whoever does hands over its text. It is CSV: lines that start with `#` and empty ones are skipped,
//! the first other line names the columns, every further one holds numbers; separated by commas, semicolons or tabs. A
//! column's name ends in its unit, `_m`, `_mm`, `_km`, `_in` or `_ft`; without it, it is the channel that it holds:
//!
//! | name | holds | + |
//! |---|---|---|
//! | `s` | place along the track, increasing | forward |
//! | `lateral`, `vertical`, `cross_level`, `gauge` | deviation of both rails from their design | as for shapes: right, up, right rail lower, wider |
//! | `left_lateral`, `right_vertical`, ... | deviation of one rail | right, up |
//!
//! Between samples runs the cubic whose slope at each of them is that of the parabola through it and its neighbours:
//! continuous with its slope. Before the first and after the last sample the ends are held.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ShapeChannel, one, require, scale_faults};
use crate::error::{Fault, KeyPath};
use crate::math::hermite::Hermite;

/// Largest deviation that is accepted, m.
const LARGEST: f64 = 0.5;
/// Units by the last part of a column's name, m.
const UNITS: [(&str, f64); 5] = [("_mm", 1e-3), ("_km", 1e3), ("_in", 0.0254), ("_ft", 0.3048), ("_m", 1.0)];
/// Name of the column of places.
const PLACE: &str = "s";

/// A measured track as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Measured {
    /// File that it was read from: CSV, or what was made of one.
    pub file: String,
    /// SHA-256 of its bytes, hexadecimal: what makes the case the same case.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
    /// The file's text, handed over by who opened it. Not written in a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
    /// Where on the track the file's place 0 lies, m; 0 if absent.
    #[serde(default)]
    pub start: f64,
    /// The record repeats; over this length its end passes into its start, m. Without it, it stands once and reaches to the
    /// end of the track.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeat_blend: Option<f64>,
    /// Factor on all channels.
    #[serde(default = "one")]
    pub scale: f64,
}

/// One sample: values of lateral, vertical (+ down), cross-level, gauge (m), then their slopes.
type Node = [f64; 8];

/// The record, compiled.
#[derive(Debug, Clone)]
pub(super) struct Record {
    s: Vec<f64>,
    nodes: Vec<Node>,
    blend: Option<f64>,
}

impl Measured {
    /// Two short records, one of which repeats.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let line = |i: u32| {
            let x = 0.25 * f64::from(i);
            format!("{x};{:.4};{:.4}\n", 3.0 * (0.4 * x).sin() + 0.3 * x, 2.0 * (0.31 * x).cos())
        };
        let text = format!(
            "# sampled every 0.25 m\ns_m;vertical_mm;left_lateral_mm\n{}",
            (0..2000).map(line).collect::<String>()
        );
        let once = Self {
            file: "recorded.csv".into(),
            sha256: None,
            text: Some(text),
            start: 0.0,
            repeat_blend: None,
            scale: 1.0,
        };
        vec![once.clone(), Self { start: -20.0, repeat_blend: Some(31.0), scale: -0.5, ..once }]
    }

    /// Everything that is wrong with it; `at` is the path of its table.
    pub(super) fn faults(&self, at: &KeyPath, faults: &mut Vec<Fault>) {
        require(faults, at.key("start"), self.start, |_| true, "a finite number of metres");
        scale_faults(self.scale, at, faults);
        match self.record() {
            Err(found) => faults.extend(found.into_iter().map(|f| f.at(at.key("file")))),
            Ok(record) => {
                if let Some(blend) = self.repeat_blend {
                    let half = 0.5 * record.length();
                    let range = format!("above 0 m, at most {half} m, half the record's length");
                    require(faults, at.key("repeat_blend"), blend, |b| b > 0.0 && b <= half, &range);
                }
            }
        }
    }

    /// What is wrong with it on a track of this length, m: a record that stands once and ends before.
    pub(super) fn too_short(&self, length: f64, at: &KeyPath) -> Option<Fault> {
        let record = self.record().ok()?;
        let (first, last) = (record.s.first()?, record.s.last()?);
        if self.repeat_blend.is_none() && *last < length {
            let found = format!("{:?}, a record to {last} m", self.file);
            let allowed = format!("one that goes on to {length} m, the end of the track");
            let fault = Fault::new(at.key("file"), found, allowed);
            return Some(fault.hint("repeat_blend = 50.0 repeats it, passing over 50 m"));
        }
        if *first > length {
            let found = format!("{} m, so that the record begins at {first} m", self.start);
            return Some(Fault::new(at.key("start"), found, format!("a start on the track of {length} m")));
        }
        None
    }

    /// The record, or what is wrong with its text.
    pub(super) fn record(&self) -> Result<Record, Vec<Bad>> {
        let Some(text) = &self.text else {
            let found = format!("{:?}, which nobody has read", self.file);
            return Err(vec![Bad::new(found, "a file whose text is handed over with the case")]);
        };
        let (s, values) =
            read(text).map_err(|bad| bad.into_iter().map(|b| b.of(&self.file)).collect::<Vec<_>>())?;
        let s: Vec<f64> = s.into_iter().map(|s| s + self.start).collect();
        let nodes = (0..s.len()).map(|i| node(&s, &values, i, self.scale)).collect();
        Ok(Record { s, nodes, blend: self.repeat_blend })
    }
}

/// Something wrong in the text: found, allowed.
#[derive(Debug)]
pub(super) struct Bad {
    found: String,
    allowed: String,
    hint: Option<&'static str>,
}

impl Bad {
    fn new(found: impl Into<String>, allowed: impl Into<String>) -> Self {
        Self { found: found.into(), allowed: allowed.into(), hint: None }
    }

    fn of(self, file: &str) -> Self {
        Self { found: format!("{file:?}, {}", self.found), ..self }
    }

    fn at(self, key: KeyPath) -> Fault {
        let fault = Fault::new(key, self.found, self.allowed);
        match self.hint {
            Some(hint) => fault.hint(hint),
            None => fault,
        }
    }
}

/// What a column holds, and its unit in m.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Column {
    /// None for the place.
    channel: Option<ShapeChannel>,
    unit: f64,
}

fn column(name: &str) -> Option<Column> {
    let name = name.trim().trim_matches('"');
    let (stem, unit) = UNITS.iter().find_map(|(suffix, unit)| Some((name.strip_suffix(suffix)?, *unit)))?;
    let channel = if stem == PLACE { None } else { Some(ShapeChannel::named(stem)?) };
    Some(Column { channel, unit })
}

/// Places (m) and the four channels (m) of every sample.
type Samples = (Vec<f64>, Vec<[f64; 4]>);

/// The samples, the file's own axes turned to ours.
fn read(text: &str) -> Result<Samples, Vec<Bad>> {
    let mut lines = text
        .trim_start_matches('\u{feff}')
        .lines()
        .enumerate()
        .map(|(i, line)| (i + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let Some((number, header)) = lines.next() else {
        return Err(vec![Bad::new("an empty file", "a line of column names, then lines of numbers")]);
    };
    let separator = [';', '\t', ','].into_iter().find(|c| header.contains(*c)).unwrap_or(',');
    let columns: Vec<Option<Column>> = header.split(separator).map(column).collect();
    let known = || columns.iter().flatten();
    let names = "s_m and lateral_mm, vertical_mm, cross_level_mm, gauge_mm, left_vertical_mm, ...";
    if known().filter(|c| c.channel.is_none()).count() != 1 {
        let mut bad = Bad::new(format!("line {number}: no column of places (or several): {header}"), names);
        bad.hint = Some("a column's name ends in its unit: s_m, s_km");
        return Err(vec![bad]);
    }
    if known().all(|c| c.channel.is_none()) {
        return Err(vec![Bad::new(format!("line {number}: no column of a channel: {header}"), names)]);
    }
    for (i, column) in known().enumerate() {
        if known().skip(i + 1).any(|other| other.channel == column.channel) {
            let found = format!("line {number}: two columns of the same channel: {header}");
            return Err(vec![Bad::new(found, "one column for each channel")]);
        }
    }
    let (mut s, mut values) = (Vec::new(), Vec::new());
    for (number, line) in lines {
        let (place, sample) = sample(line, separator, &columns)
            .map_err(|what| vec![Bad::new(format!("line {number}: {what}"), "a number in every column")])?;
        if s.last().is_some_and(|last| place <= *last) {
            let found =
                format!("line {number}: place {place} m after {} m", s.last().copied().unwrap_or(place));
            return Err(vec![Bad::new(found, "places that increase from line to line")]);
        }
        if let Some(large) = sample.iter().find(|v| v.abs() > LARGEST) {
            let mut bad =
                Bad::new(format!("line {number}: a deviation of {large} m"), format!("at most {LARGEST} m"));
            bad.hint = Some("deviations from the design, the gauge's too: not the gauge itself");
            return Err(vec![bad]);
        }
        s.push(place);
        values.push(sample);
    }
    if s.len() < 2 {
        return Err(vec![Bad::new(format!("{} samples", s.len()), "two samples or more")]);
    }
    Ok((s, values))
}

/// Place and channels of one line.
fn sample(line: &str, separator: char, columns: &[Option<Column>]) -> Result<(f64, [f64; 4]), String> {
    let cells: Vec<&str> = line.split(separator).map(str::trim).collect();
    if cells.len() != columns.len() {
        return Err(format!("{} columns where the first line names {}", cells.len(), columns.len()));
    }
    let (mut place, mut sum) = (0.0, [0.0; 4]);
    for (cell, column) in cells.iter().zip(columns) {
        let Some(Column { channel, unit }) = column else { continue };
        let value = cell.parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(|| format!("{cell:?}"))?;
        match channel {
            None => place = unit * value,
            Some(channel) => {
                for (sum, weight) in sum.iter_mut().zip(channel.weights()) {
                    *sum += weight * unit * value;
                }
            }
        }
    }
    Ok((place, sum))
}

/// Sample `i` with the slopes of the parabola through it and its neighbours, at the ends of the line to the next one.
fn node(s: &[f64], values: &[[f64; 4]], i: usize, scale: f64) -> Node {
    let chord = |j: usize, c: usize| (values[j + 1][c] - values[j][c]) / (s[j + 1] - s[j]);
    let last = s.len() - 1;
    let mut node = [0.0; 8];
    for c in 0..4 {
        node[c] = scale * values[i][c];
        node[c + 4] = scale
            * if i == 0 {
                chord(0, c)
            } else if i == last {
                chord(last - 1, c)
            } else {
                let (before, after) = (s[i] - s[i - 1], s[i + 1] - s[i]);
                (after * chord(i - 1, c) + before * chord(i, c)) / (before + after)
            };
    }
    node
}

impl Record {
    fn length(&self) -> f64 {
        self.s[self.s.len() - 1] - self.s[0]
    }

    /// Values and slopes at `s` of the track.
    #[inline]
    pub fn at(&self, s: f64) -> Node {
        let Some(blend) = self.blend else { return self.once(s) };
        let first = self.s[0];
        let period = self.length() - blend;
        let turn = ((s - first) / period).floor();
        if turn < 1.0 {
            return self.once(s);
        }
        // The distance into this turn, and the same place at the end of the turn before.
        let x = s - first - turn * period;
        let mut now = self.once(first + x);
        if x < blend {
            let before = self.once(first + period + x);
            let (sin, cos) = (std::f64::consts::PI * x / blend).sin_cos();
            let (share, rate) = (0.5 - 0.5 * cos, 0.5 * std::f64::consts::PI / blend * sin);
            for c in 0..4 {
                let difference = now[c] - before[c];
                now[c] = before[c] + share * difference;
                now[c + 4] = before[c + 4] + share * (now[c + 4] - before[c + 4]) + rate * difference;
            }
        }
        now
    }

    /// The record as it stands, its ends held.
    fn once(&self, s: f64) -> Node {
        let last = self.s.len() - 1;
        let held = |i: usize| {
            let [a, b, c, d, ..] = self.nodes[i];
            [a, b, c, d, 0.0, 0.0, 0.0, 0.0]
        };
        if s <= self.s[0] {
            return held(0);
        }
        if s >= self.s[last] {
            return held(last);
        }
        let i = self.s.partition_point(|place| *place <= s) - 1;
        let cell = self.s[i + 1] - self.s[i];
        let (left, right) = (&self.nodes[i], &self.nodes[i + 1]);
        let Hermite { value: v, slope: d } = Hermite::at((s - self.s[i]) / cell, cell);
        let mut out = [0.0; 8];
        for c in 0..4 {
            let ends = [left[c], right[c], left[c + 4], right[c + 4]];
            out[c] = v[0] * ends[0] + v[1] * ends[1] + v[2] * ends[2] + v[3] * ends[3];
            out[c + 4] = d[0] * ends[0] + d[1] * ends[1] + d[2] * ends[2] + d[3] * ends[3];
        }
        out
    }
}
