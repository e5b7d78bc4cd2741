//! GENSYS profiles, `.wheel` and `.rail`: two columns in free format, `#` begins a comment anywhere in a line.
//!
//! Source: the GENSYS manual as summarised for its `kpf` profile files: a wheel's y is positive *towards* the track centre, z down,
//! origin at the nominal running circle, 70 mm from the flange back. That a rail file has the same direction of y is
//! assumed; the rail's shape seldom shows it. A `.rail` file is MiniProf's where `Key=Value` lines come first, GENSYS's otherwise.

use super::read::{Codec, Format, Raw, Rule, WriteOptions};
use super::text::{Faults, lines, millimetres, one_line, pair};
use crate::error::Result;

pub(super) const CODEC: Codec = Codec {
    format: Format::Gensys,
    extensions: &["wheel", "rail"],
    sniff: |_| None,
    rule: Rule {
        mirror_y: true,
        mirror_z: false,
        because: "y towards the track centre, z down in this format",
    },
    parse,
    write: Some(write),
};

fn parse(text: &str, name: &str) -> Result<Raw> {
    let mut points = Vec::new();
    let mut faults = Faults::of(name);
    for (number, line) in lines(text) {
        let row = line.split('#').next().unwrap_or_default().trim();
        if row.is_empty() {
            continue;
        }
        match pair(row) {
            Some(point) => points.push(point),
            None => faults.line(number, line, "two finite numbers, y and z in mm, or a comment after #"),
        }
    }
    if points.is_empty() && !faults.any() {
        faults.whole("no point", "lines of two numbers, y and z in mm");
    }
    faults.or(Raw::millimetres(points))
}

fn write(points: &[[f64; 2]], options: &WriteOptions) -> String {
    let mut out = String::new();
    if !options.title.is_empty() {
        out += &format!("# {}\n", one_line(&options.title));
    }
    out += "# mm; y towards the track centre, z down\n";
    for p in points {
        out += &format!("{} {}\n", millimetres(-p[0]), millimetres(p[1]));
    }
    out
}
