//! Reader of profile points from text.

use crate::error::{Error, Fault, KeyPath, Result};

/// Points [y, z] in metres from CSV text in millimetres.
///
/// One point a line: y (lateral, flange or gauge corner negative) and z (down), separated by comma, semicolon, tab or blanks;
/// further columns are ignored. Lines starting with `#` and empty lines are skipped, and so are header lines: any lines
/// before the first point whose first two fields are not numbers. `name` is only used in messages.
///
/// # Errors
/// - a line after the first point that is not two finite numbers,
/// - no point at all.
pub fn read_csv(text: &str, name: &str) -> Result<Vec<[f64; 2]>> {
    let at = KeyPath::of("profiles").key(name).key("points");
    let mut points: Vec<[f64; 2]> = Vec::new();
    let mut faults = Vec::new();
    for (number, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        match point(line) {
            Some([y, z]) => points.push([1e-3 * y, 1e-3 * z]),
            None if points.is_empty() => {}
            None => faults.push(Fault::new(
                at.clone(),
                format!("line {}: `{line}`", number + 1),
                "two finite numbers, y and z in mm",
            )),
        }
    }
    if points.is_empty() {
        faults.push(
            Fault::new(at, "no point", "lines of two numbers, y and z in mm")
                .hint("a decimal comma is not understood: use a point"),
        );
    }
    if faults.is_empty() { Ok(points) } else { Err(Error::Input(faults)) }
}

fn point(line: &str) -> Option<[f64; 2]> {
    let mut fields =
        line.split(|c: char| c == ',' || c == ';' || c.is_whitespace()).filter(|field| !field.is_empty());
    let y: f64 = fields.next()?.parse().ok()?;
    let z: f64 = fields.next()?.parse().ok()?;
    (y.is_finite() && z.is_finite()).then_some([y, z])
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn empty_text_is_refused() {
        assert!(read_csv("# nothing\n", "x").is_err());
    }
}
