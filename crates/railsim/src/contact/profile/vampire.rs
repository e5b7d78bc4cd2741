//! VAMPIRE profiles, `.whe` and `.rai`: read only.
//!
//! The maker publishes no specification; what is read here is the layout that the reader of the public program CONTACT expects:
//! `WHEELPROFILE` or `RAILPROFILE`; a title; `TREADDATUM` (EUROPEAN: 70 mm from the flange back, US1: 2 27/32 in, US2: 3 1/16 in, CUSTOM and
//! mm) or `GAUGEPOINT` (not needed here); `FLANGEBACK` or `GAUGE` and mm; then rows of y and z of the left and of the
//! right profile from the track centre. The right one is taken. A wheel's y is counted from its tread datum, a rail's from its
//! highest point. A file of two columns is taken as plain CSV; anything else is refused.

use super::read::{Codec, Format, ProfileKind, Raw, Rule};
use super::text::{Faults, lines, numbers};
use crate::error::Result;

const INCH: f64 = 25.4;

pub(super) const CODEC: Codec = Codec {
    format: Format::Vampire,
    extensions: &["whe", "rai"],
    sniff,
    rule: Rule {
        mirror_y: false,
        mirror_z: false,
        because: "the right side, y outward and z as the shape has it",
    },
    parse,
    write: None,
};

fn sniff(text: &str) -> Option<&'static str> {
    let (_, first) = lines(text).next()?;
    ["WHEELPROFILE", "RAILPROFILE"].contains(&first).then_some("it starts with WHEELPROFILE or RAILPROFILE")
}

fn parse(text: &str, name: &str) -> Result<Raw> {
    let mut faults = Faults::of(name);
    let head: Vec<(usize, &str)> = lines(text).take(4).collect();
    let kind = match head.first() {
        Some((_, "WHEELPROFILE")) => ProfileKind::Wheel,
        Some((_, "RAILPROFILE")) => ProfileKind::Rail,
        _ => return columns(text, name),
    };
    let [_, _, datum, distance] = head[..] else {
        faults.whole("the end of the file in its header", "a title, a datum and a distance");
        return faults.or(Raw::millimetres(Vec::new()));
    };
    let from_centre = match kind {
        ProfileKind::Wheel => {
            let back = after(distance, "FLANGEBACK", &mut faults);
            0.5 * back + tread_datum(datum, &mut faults)
        }
        ProfileKind::Rail => 0.5 * after(distance, "GAUGE", &mut faults),
    };
    let mut points = Vec::new();
    for (number, line) in lines(text).skip(4) {
        let row = line.split(['"', '!', '%']).next().unwrap_or_default();
        if row.trim().is_empty() {
            continue;
        }
        match numbers(row)[..] {
            [_, _, y, z, ..] if y.is_finite() && z.is_finite() => points.push([y - from_centre, z]),
            _ => faults.line(number, line, "four finite numbers: y and z left, y and z right, mm"),
        }
    }
    if points.is_empty() && !faults.any() {
        faults.whole("no point", "rows of four numbers after the header");
    }
    let mut notes = vec!["the right profile; no specification of this format is public".to_owned()];
    if kind == ProfileKind::Rail {
        // z up in this format
        let top = points.iter().copied().max_by(|p, q| p[1].total_cmp(&q[1])).unwrap_or_default();
        points.iter_mut().for_each(|p| *p = [p[0] - top[0], p[1] - top[1]]);
        notes.push(format!("moved by y = {:.3} mm, its highest point at the origin", -top[0]));
    }
    faults.or(Raw { kind: Some((kind, "its first line")), notes, ..Raw::millimetres(points) })
}

/// Number of mm behind a keyword.
fn after((number, line): (usize, &str), keyword: &str, faults: &mut Faults) -> f64 {
    let value = line.strip_prefix(keyword).and_then(|rest| rest.trim().parse::<f64>().ok());
    value.filter(|x| x.is_finite()).unwrap_or_else(|| {
        faults.line(number, line, format!("{keyword} and a number of mm"));
        0.0
    })
}

fn tread_datum((number, line): (usize, &str), faults: &mut Faults) -> f64 {
    let datum = line.strip_prefix("TREADDATUM").map(str::trim);
    match datum {
        Some("EUROPEAN") => 70.0,
        Some("US1") => (2.0 + 27.0 / 32.0) * INCH,
        Some("US2") => (3.0 + 1.0 / 16.0) * INCH,
        Some(custom) if custom.starts_with("CUSTOM") => after((number, custom), "CUSTOM", faults),
        _ => {
            faults.line(number, line, "TREADDATUM and EUROPEAN, US1, US2 or CUSTOM with mm");
            0.0
        }
    }
}

/// A file without that header: two columns, or nothing that can be read.
fn columns(text: &str, name: &str) -> Result<Raw> {
    let row = |line: &str| !line.is_empty() && !line.starts_with(['#', '!', '%', '"']);
    let two = lines(text).filter(|(_, line)| row(line)).all(|(_, line)| {
        let values = numbers(line);
        values.len() == 2 && super::text::fields(line).count() == 2 && values.iter().all(|x| x.is_finite())
    });
    let points: Vec<[f64; 2]> =
        lines(text).filter(|(_, line)| row(line)).filter_map(|(_, line)| super::text::pair(line)).collect();
    if two && !points.is_empty() {
        return Ok(Raw {
            notes: vec!["read as two plain columns: no specification of this format is public".to_owned()],
            ..Raw::millimetres(points)
        });
    }
    let mut faults = Faults::of(name);
    faults.whole(
        "neither WHEELPROFILE or RAILPROFILE in the first line nor two columns of finite numbers",
        "a VAMPIRE profile with that header, or two columns y and z in mm",
    );
    faults.hint("no specification of VAMPIRE files is public; export as CSV, MiniProf or SIMPACK");
    faults.or(Raw::millimetres(Vec::new()))
}
