//! SIMPACK profiles, which CONTACT reads too: `.prw` (wheel), `.prr` (rail).
//!
//! `key = value` lines in sections `header.begin` to `header.end` (`type`: 0 rail, 1 wheel) and `spline.begin` to `spline.end`, in it rows
//! `y z [weight]` from `point.begin` to `point.end`; `!` begins a comment. What the keys do to the points, in this order (that of the files'
//! own comments and of CONTACT): `point.dist.min` drops points closer than that to the one before; `shift.y`, `shift.z`;
//! `rotate` about x, y' = y cos - z sin, z' = y sin + z cos; points outside `bound.y.min`, `bound.y.max` are dropped and z is
//! clipped to `bound.z.min`, `bound.z.max` (each pair only if min < max); `mirror.y`, `mirror.z`; `inversion` of the order; and
//! `units.len.f`, `units.ang.f`: user units per metre and per radian (1000 for mm; 1 where not given). `approx.smooth` and the
//! weights are not used: all profiles are smoothed the same way.

use super::read::{Codec, Format, ProfileKind, Raw, Rule, WriteOptions};
use super::text::{Faults, fields, lines, millimetres, numbers, one_line, starts_with_number};
use crate::error::Result;

pub(super) const CODEC: Codec = Codec {
    format: Format::Simpack,
    extensions: &["prw", "prr"],
    sniff,
    rule: Rule { mirror_y: false, mirror_z: false, because: "y outward, z down in this format" },
    parse,
    write: Some(write),
};

fn sniff(text: &str) -> Option<&'static str> {
    lines(text)
        .any(|(_, line)| ["header.begin", "spline.begin"].contains(&code(line)))
        .then_some("it has a section header.begin or spline.begin")
}

/// A line without its comment; an exclamation mark in quotes is text.
fn code(line: &str) -> &str {
    let mut quoted = false;
    for (i, c) in line.char_indices() {
        match c {
            '\'' => quoted = !quoted,
            '!' if !quoted => return line[..i].trim(),
            _ => {}
        }
    }
    line.trim()
}

/// What the header does to the points, in user units.
struct Processing {
    least_distance: f64,
    shift: [f64; 2],
    rotate: f64,
    bounds: [[f64; 2]; 2],
    mirror: [bool; 2],
    inversion: bool,
    length: f64,
    angle: f64,
}

impl Default for Processing {
    fn default() -> Self {
        Self {
            least_distance: 0.0,
            shift: [0.0; 2],
            rotate: 0.0,
            bounds: [[1.0, 0.0]; 2],
            mirror: [false; 2],
            inversion: false,
            length: 1.0,
            angle: 1.0,
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Section {
    Outside,
    Header,
    Spline,
    Point,
}

fn section(from: Section, keyword: &str) -> Option<Section> {
    match (from, keyword) {
        (Section::Outside, "header.begin") => Some(Section::Header),
        (Section::Outside, "spline.begin") => Some(Section::Spline),
        (Section::Header, "header.end") | (Section::Spline, "spline.end") => Some(Section::Outside),
        (Section::Spline, "point.begin") => Some(Section::Point),
        (Section::Point, "point.end") => Some(Section::Spline),
        _ => None,
    }
}

fn parse(text: &str, name: &str) -> Result<Raw> {
    let mut faults = Faults::of(name);
    if sniff(text).is_none() {
        faults.whole("neither header.begin nor spline.begin", "a SIMPACK profile, which has these sections");
        return faults.or(Raw::millimetres(Vec::new()));
    }
    let mut processing = Processing::default();
    let mut notes = Vec::new();
    let mut kind = None;
    let mut points: Vec<[f64; 2]> = Vec::new();
    let (mut at, mut weighted, mut closed) = (Section::Outside, false, false);
    for (number, line) in lines(text) {
        let code = code(line);
        if code.is_empty() {
            continue;
        }
        if code.ends_with(".begin") || code.ends_with(".end") {
            match section(at, code) {
                Some(next) => at = next,
                None => faults.line(number, line, "sections header, spline and, within spline, point"),
            }
            closed |= code == "point.end";
        } else if at == Section::Point {
            match numbers(code)[..] {
                [y, z, ..] if y.is_finite() && z.is_finite() && fields(code).count() <= 3 => {
                    points.push([y, z]);
                    weighted |= fields(code).count() == 3;
                }
                _ => faults.line(number, line, "y, z and perhaps a weight, finite numbers"),
            }
        } else if let Some((key, value)) = code.split_once('=') {
            let (key, value) = (key.trim(), value.trim());
            match (at, key) {
                (Section::Header, "type") => match value {
                    "0" => kind = Some((ProfileKind::Rail, "its header's type = 0")),
                    "1" => kind = Some((ProfileKind::Wheel, "its header's type = 1")),
                    _ => faults.line(number, line, "0 for a rail, 1 for a wheel"),
                },
                (Section::Header, _) => {}
                (Section::Spline, _) => processing.enter(key, value, number, line, &mut notes, &mut faults),
                _ => faults.line(number, line, "keys within a section only"),
            }
        } else {
            faults.line(number, line, "`key = value` or the beginning or end of a section");
            if starts_with_number(code) {
                faults.hint("points stand between point.begin and point.end");
            }
        }
    }
    if !faults.any() {
        if at != Section::Outside || !closed {
            faults.whole("the end of the file", "point.end and spline.end before it");
        } else if points.is_empty() {
            faults.whole("no point", "rows of y and z between point.begin and point.end");
        }
    }
    if weighted {
        notes.push("weights of the points not used".to_owned());
    }
    let points = processing.apply(points);
    if points.is_empty() && !faults.any() {
        faults.whole(
            "no point left within bound.y.min and bound.y.max",
            "bounds in the file's own units that leave points",
        );
    }
    faults.or(Raw { points, unit: 1.0 / processing.length, unit_because: "units.len.f", kind, notes })
}

impl Processing {
    fn enter(
        &mut self,
        key: &str,
        value: &str,
        number: usize,
        line: &str,
        notes: &mut Vec<String>,
        faults: &mut Faults,
    ) {
        if ["file", "file.mtime", "comment", "type", "units.len", "units.ang"].contains(&key) {
            return;
        }
        let value = value.parse().ok().filter(|x: &f64| x.is_finite());
        let known = [
            "approx.smooth",
            "point.dist.min",
            "shift.y",
            "shift.z",
            "rotate",
            "bound.y.min",
            "bound.y.max",
            "bound.z.min",
            "bound.z.max",
            "mirror.y",
            "mirror.z",
            "inversion",
            "units.len.f",
            "units.ang.f",
        ];
        let Some(value) = value else {
            if known.contains(&key) {
                faults.line(number, line, "a finite number");
            }
            return;
        };
        let mut flag = |to: &mut bool| match value {
            0.0 => *to = false,
            1.0 => *to = true,
            _ => faults.line(number, line, "0 or 1"),
        };
        match key {
            "mirror.y" => flag(&mut self.mirror[0]),
            "mirror.z" => flag(&mut self.mirror[1]),
            "inversion" => flag(&mut self.inversion),
            "point.dist.min" => self.least_distance = value,
            "shift.y" => self.shift[0] = value,
            "shift.z" => self.shift[1] = value,
            "rotate" => self.rotate = value,
            "bound.y.min" => self.bounds[0][0] = value,
            "bound.y.max" => self.bounds[0][1] = value,
            "bound.z.min" => self.bounds[1][0] = value,
            "bound.z.max" => self.bounds[1][1] = value,
            "units.len.f" | "units.ang.f" if !(1e-6..=1e9).contains(&value) => {
                faults.line(number, line, "a number of units per metre or radian, 1e-6 to 1e9");
            }
            "units.len.f" => self.length = value,
            "units.ang.f" => self.angle = value,
            "approx.smooth" if value != 0.0 => notes.push(format!("approx.smooth of {value} not used")),
            "approx.smooth" => {}
            _ => notes.push(format!("{} not known", one_line(key))),
        }
    }

    /// The points as the header wants them, in user units.
    fn apply(&self, mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        if self.least_distance > 0.0 {
            let mut kept: Vec<[f64; 2]> = Vec::with_capacity(points.len());
            for p in points {
                if kept.last().is_none_or(|l| (p[0] - l[0]).hypot(p[1] - l[1]) >= self.least_distance) {
                    kept.push(p);
                }
            }
            points = kept;
        }
        let (sin, cos) = (self.rotate / self.angle).sin_cos();
        for p in &mut points {
            let [y, z] = [p[0] + self.shift[0], p[1] + self.shift[1]];
            *p = if self.rotate == 0.0 { [y, z] } else { [y * cos - z * sin, y * sin + z * cos] };
        }
        let [[y_min, y_max], [z_min, z_max]] = self.bounds;
        if y_min < y_max {
            points.retain(|p| (y_min..=y_max).contains(&p[0]));
        }
        for p in &mut points {
            if z_min < z_max {
                p[1] = p[1].clamp(z_min, z_max);
            }
            for (x, mirrored) in p.iter_mut().zip(self.mirror) {
                *x = if mirrored { -*x } else { *x };
            }
        }
        if self.inversion {
            points.reverse();
        }
        points
    }
}

fn write(points: &[[f64; 2]], options: &WriteOptions) -> String {
    let wheel = options.kind == Some(ProfileKind::Wheel);
    let mut out =
        format!("header.begin\n  version = 1\n  type = {}\nheader.end\nspline.begin\n", u8::from(wheel));
    out += &format!("  approx.smooth = 0\n  comment = '{}'\n", one_line(&options.title));
    out += "  units.len.f = 1000\n  units.ang.f = 1\n  point.begin\n";
    let mut row = |p: &[f64; 2]| out += &format!("    {} {}\n", millimetres(p[0]), millimetres(p[1]));
    // wheels run from the field side to the flange, rails the other way
    if wheel {
        points.iter().rev().for_each(&mut row)
    } else {
        points.iter().for_each(&mut row)
    }
    out + "  point.end\nspline.end\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    fn file(keys: &str, rows: &str) -> String {
        format!(
            "header.begin\n type = 0 ! rail\nheader.end\nspline.begin\n{keys}\npoint.begin\n{rows}\npoint.end\nspline.end\n"
        )
    }

    fn points(keys: &str, rows: &str) -> Vec<[f64; 2]> {
        parse(&file(keys, rows), "x").unwrap().points
    }

    #[test]
    fn every_key_of_the_header_is_honoured_in_order() {
        let rows = "0 0\n1 2 1.0\n1.01 2\n3 4";
        assert_eq!(points("", rows), vec![[0.0, 0.0], [1.0, 2.0], [1.01, 2.0], [3.0, 4.0]]);
        assert_eq!(points("point.dist.min = 0.1", rows).len(), 3);
        assert_eq!(points("shift.y = 1\nshift.z = -2", rows)[3], [4.0, 2.0]);
        // a quarter turn in degrees, after the shift: (3 + 1, 4) -> (-4, 4)
        let turned = points("shift.y = 1\nrotate = 90\nunits.ang.f = 57.29577951308232", rows)[3];
        assert!((turned[0] + 4.0).abs() < 1e-12 && (turned[1] - 4.0).abs() < 1e-12, "{turned:?}");
        // bounds hold for the shifted points
        assert_eq!(points("bound.y.min = 0.5\nbound.y.max = 2.5\nshift.y = 1", rows).len(), 3);
        assert_eq!(points("bound.y.min = 1\nbound.y.max = 0", rows).len(), 4);
        assert_eq!(points("bound.z.min = 1\nbound.z.max = 3", rows)[3], [3.0, 3.0]);
        // mirrored after the bounds
        assert_eq!(points("mirror.y = 1\nbound.y.min = 2\nbound.y.max = 9", rows), vec![[-3.0, 4.0]]);
        assert_eq!(points("mirror.z = 1", rows)[3], [3.0, -4.0]);
        assert_eq!(points("inversion = 1", rows)[0], [3.0, 4.0]);
        let raw = parse(&file("units.len.f = 1000", rows), "x").unwrap();
        assert_eq!(raw.unit, 1e-3);
        assert_eq!(raw.kind.map(|k| k.0), Some(ProfileKind::Rail));
    }

    #[test]
    fn comments_may_stand_in_quotes_and_are_not_code() {
        let keys = "comment = 'watch out! = here' ! said = 1\nfile = '-'";
        assert_eq!(points(keys, "1 2 ! 3\n! 4 5\n3 4").len(), 2);
    }

    #[test]
    fn malformed_files_are_refused_by_line() {
        let refused = |text: &str| match parse(text, "x") {
            Err(Error::Input(faults)) => faults.iter().map(|f| format!("{f}\n")).collect::<String>(),
            other => panic!("accepted: {:?}", other.map(|raw| raw.points)),
        };
        assert!(refused(&file("shift.y = left", "1 2")).contains("a finite number"));
        assert!(refused(&file("mirror.y = 2", "1 2")).contains("0 or 1"));
        assert!(refused(&file("units.len.f = 0", "1 2")).contains("units per metre"));
        assert!(refused(&file("", "1 nan")).contains("finite numbers"));
        assert!(refused(&file("", "1 2 3 4")).contains("a weight"));
        assert!(refused(&file("", "")).contains("no point"));
        assert!(refused(&file("bound.y.min = 5\nbound.y.max = 6", "1 2")).contains("no point left"));
        assert!(refused("header.begin\nspline.begin\n").contains("sections header, spline"));
        assert!(refused("spline.begin\npoint.begin\n1 2\n").contains("the end of the file"));
        assert!(refused("header.begin\ntype = 2\nheader.end\n").contains("0 for a rail"));
        assert!(refused("spline.begin\n1 2\nspline.end\n").contains("between point.begin and point.end"));
    }
}
