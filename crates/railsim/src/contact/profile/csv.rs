//! Plain columns: CSV in millimetres, the form of `models/profiles`.
//!
//! One point a line: y (lateral, outward from the track centre, flange or gauge corner negative) and z (down), separated by
//! comma, semicolon, tab or blanks; further columns are ignored. Lines starting with `#` and empty lines are skipped, and so
//! are header lines: any lines before the first point that do not start with a number. CONTACT's plain two-column profiles
//! are the same, whatever their extension.

use super::read::{Codec, Format, Raw, Rule, WriteOptions};
use super::text::{Faults, lines, millimetres, one_line, pair, starts_with_number};
use crate::error::Result;

pub(super) const CODEC: Codec = Codec {
    format: Format::Csv,
    extensions: &["csv", "txt", "dat", ""],
    sniff: |_| None,
    rule: Rule { mirror_y: false, mirror_z: false, because: "y outward, z down in this format" },
    parse,
    write: Some(write),
};

/// Points [y, z] in metres from CSV text in millimetres, in the file's own order and axes. `name` is only used in messages.
///
/// # Errors
/// - a line after the first point that is not two finite numbers,
/// - no point at all.
pub fn read_csv(text: &str, name: &str) -> Result<Vec<[f64; 2]>> {
    Ok(parse(text, name)?.points.iter().map(|p| p.map(|x| 1e-3 * x)).collect())
}

fn parse(text: &str, name: &str) -> Result<Raw> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    let mut faults = Faults::of(name);
    for (number, line) in lines(text) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        match pair(line) {
            Some(point) => points.push(point),
            None if points.is_empty() && !starts_with_number(line) => {}
            None => faults.line(number, line, "two finite numbers, y and z in mm"),
        }
    }
    if points.is_empty() && !faults.any() {
        faults.whole("no point", "lines of two numbers, y and z in mm");
        faults.hint("a decimal comma is not understood: use a point");
    }
    faults.or(Raw::millimetres(points))
}

fn write(points: &[[f64; 2]], options: &WriteOptions) -> String {
    let mut out = String::new();
    if !options.title.is_empty() {
        out += &format!("# {}\n", one_line(&options.title));
    }
    out += "# mm; y outward (flange or gauge corner negative), z down\ny_mm,z_mm\n";
    for p in points {
        out += &format!("{},{}\n", millimetres(p[0]), millimetres(p[1]));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    #[test]
    fn headers_comments_and_separators() {
        let text = "# source\ny_mm,z_mm\n-1.0,0.5\n\n# more\n0;0\n 1.5\t-0.25 7\n";
        let points = read_csv(text, "x").unwrap();
        assert_eq!(points, vec![[-1e-3, 0.5e-3], [0.0, 0.0], [1.5e-3, -0.25e-3]]);
    }

    #[test]
    fn every_bad_line_is_reported_by_number() {
        let Err(Error::Input(faults)) = read_csv("0 0\nabc\n1 nan\n", "worn") else { panic!("accepted") };
        assert_eq!(faults.len(), 2);
        assert_eq!(faults[0].key.to_string(), "profiles.worn.points");
        assert_eq!(faults[0].found, "line 2: `abc`");
    }

    #[test]
    fn a_first_point_that_is_not_a_number_is_no_header() {
        let Err(Error::Input(faults)) = read_csv("nan nan\n1 2\n", "x") else { panic!("accepted") };
        assert_eq!(faults[0].found, "line 1: `nan nan`");
    }

    #[test]
    fn decimal_commas_are_not_taken_for_separators() {
        let Err(Error::Input(faults)) = read_csv("12,5;3,2\n12,6;3,3\n", "x") else { panic!("accepted") };
        assert!(faults[0].to_string().contains("decimal comma"), "{}", faults[0]);
    }

    #[test]
    fn a_text_that_is_something_else_is_not_listed_line_by_line() {
        let text = format!("0 0\n{}", "what\n".repeat(500));
        let Err(Error::Input(faults)) = read_csv(&text, "x") else { panic!("accepted") };
        assert_eq!(faults.len(), 11);
        assert_eq!(faults[10].found, "490 more lines like these");
    }

    #[test]
    fn empty_text_is_refused() {
        assert!(read_csv("# nothing\n", "x").is_err());
    }
}
