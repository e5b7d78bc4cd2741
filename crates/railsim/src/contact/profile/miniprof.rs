//! MiniProf files: `.whl` (wheel), `.ban` and `.rail` (rail), `.mpt` (either).
//!
//! `Key=Value` lines, then rows of X and Y in millimetres; y up. `ColumnDef` names the columns (X, Y, and A, C, N, K, which are
//! not used), `XOffset` and `YOffset` are added to the points. An `.mpt` file has its parts under `[...]` headings and its rows
//! under `[...Points]`; files of the oldest kind say MINIPROF at the top and have plain header lines down to the first
//! empty one. Lines starting with `"`, `!`, `%` or `#` are left out. Source: the key list and column letters that the
//! reader of the public program CONTACT knows, and its example file; there is no public specification of the maker's. X of
//! a rail is taken as positive on the gauge side, as in that example; a wheel's shape shows its flange.

use super::read::{Codec, Format, Raw, Rule, WriteOptions};
use super::text::{Faults, lines, millimetres, numbers, one_line, starts_with_number};
use crate::error::Result;

pub(super) const CODEC: Codec = Codec {
    format: Format::Miniprof,
    extensions: &["whl", "ban", "mpt"],
    sniff,
    rule: Rule { mirror_y: true, mirror_z: true, because: "x towards the track centre, y up in this format" },
    parse,
    write: Some(write),
};

fn comment(line: &str) -> bool {
    line.is_empty() || line.starts_with(['"', '!', '%', '#'])
}

fn sniff(text: &str) -> Option<&'static str> {
    let (_, first) = lines(text).find(|(_, line)| !comment(line))?;
    if first.starts_with("[FileInfo") || first.to_ascii_uppercase().starts_with("MINIPROF") {
        return Some("it starts as MiniProf files do");
    }
    let (key, _) = first.split_once('=')?;
    (!key.is_empty() && !starts_with_number(first) && !key.contains(".begin"))
        .then_some("`Key=Value` lines come first")
}

/// What the header says that matters here.
struct Header {
    column: [usize; 2],
    columns: usize,
    offset: [f64; 2],
    count: Option<usize>,
    notes: Vec<String>,
}

fn parse(text: &str, name: &str) -> Result<Raw> {
    let mut faults = Faults::of(name);
    let mut header = Header { column: [0, 1], columns: 2, offset: [0.0; 2], count: None, notes: Vec::new() };
    let mut points: Vec<[f64; 2]> = Vec::new();
    let old = lines(text).take(3).any(|(_, line)| line.to_ascii_uppercase().contains("MINIPROF"))
        && !lines(text).take(3).any(|(_, line)| line.contains('='));
    let mut in_old_header = old;
    let mut tables = 0;
    for (number, line) in lines(text) {
        if line.is_empty() {
            in_old_header = false;
        }
        if comment(line) || in_old_header {
            continue;
        }
        if line.starts_with('[') {
            let rows = line.contains("Points]");
            tables += usize::from(rows);
            if rows && tables == 2 {
                faults.line(number, line, "one profile in a file");
            }
        } else if starts_with_number(line) {
            let row = line.split(['"', '!', '%']).next().unwrap_or_default();
            let values = numbers(row);
            let of = |i: usize| values.get(header.column[i]).copied().filter(|x| x.is_finite());
            match (of(0), of(1)) {
                (Some(x), Some(y)) => points.push([x, y]),
                _ => faults.line(
                    number,
                    line,
                    format!("{} finite numbers, X and Y in mm among them", header.columns),
                ),
            }
        } else if let Some((key, value)) = line.split_once('=') {
            if points.is_empty() || tables > 0 {
                header.enter(key.trim(), value.trim(), number, line, &mut faults);
            } else {
                faults.line(number, line, "`Key=Value` lines before the first point only");
            }
        } else {
            faults.line(number, line, "`Key=Value`, or a row of numbers");
        }
    }
    if points.is_empty() && !faults.any() {
        faults.whole("no point", "rows of X and Y in mm after the header");
    }
    if let Some(count) = header.count.filter(|&count| count != points.len()) {
        header.notes.push(format!("XYPoints says {count} points, there are {}", points.len()));
    }
    for p in &mut points {
        *p = [p[0] + header.offset[0], p[1] + header.offset[1]];
    }
    faults.or(Raw { notes: header.notes, ..Raw::millimetres(points) })
}

impl Header {
    fn enter(&mut self, key: &str, value: &str, number: usize, line: &str, faults: &mut Faults) {
        match key {
            "ColumnDef" => {
                let letters: Vec<&str> = value.split(',').map(str::trim).collect();
                let of = |letter: &str| letters.iter().position(|l| l.eq_ignore_ascii_case(letter));
                match (of("X"), of("Y")) {
                    (Some(x), Some(y)) => {
                        self.column = [x, y];
                        self.columns = letters.len();
                    }
                    _ => faults.line(number, line, "columns with X and Y among them, e.g. X,Y"),
                }
            }
            "XOffset" | "Xoffset" | "YOffset" | "Yoffset" if !value.is_empty() => {
                match value.parse::<f64>().ok().filter(|x| x.is_finite()) {
                    Some(offset) => {
                        self.offset[usize::from(key.starts_with('Y'))] = offset;
                        if offset != 0.0 {
                            self.notes.push(format!("{key} of {offset} mm added"));
                        }
                    }
                    None => faults.line(number, line, "a number of mm"),
                }
            }
            "XYPoints" if !value.is_empty() => match value.parse() {
                Ok(count) => self.count = Some(count),
                Err(_) => faults.line(number, line, "a number of points"),
            },
            "Tilt" if value.parse::<f64>().is_ok_and(|tilt| tilt != 0.0) => {
                self.notes.push(format!("Tilt of {value} not applied"));
            }
            _ => {}
        }
    }
}

fn write(points: &[[f64; 2]], options: &WriteOptions) -> String {
    let mut out = String::from("ProgramName=railsim\n");
    out += &format!("XYPoints={}\nXOffset=0\nYOffset=0\n", points.len());
    if !options.title.is_empty() {
        out += &format!("Comment={}\n", one_line(&options.title));
    }
    out += "ColumnDef=X,Y\n\n";
    for p in points {
        out += &format!("{}\t{}\n", millimetres(-p[0]), millimetres(-p[1]));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    fn refused(text: &str) -> String {
        match parse(text, "x") {
            Err(Error::Input(faults)) => faults.iter().map(|f| format!("{f}\n")).collect(),
            other => panic!("accepted: {:?}", other.map(|raw| raw.points)),
        }
    }

    #[test]
    fn columns_offsets_and_comments() {
        let text = "Filename=a.ban\nXOffset=1.5\nYOffset=-2\nXYPoints=3\nColumnDef=A,X,Y\n\n9 1 2\n\" 9 5 5\n9 3 4 \"end\n";
        let raw = parse(text, "x").unwrap();
        assert_eq!(raw.points, vec![[2.5, 0.0], [4.5, 2.0]]);
        assert!(raw.notes.iter().any(|n| n.contains("XYPoints says 3 points, there are 2")));
    }

    #[test]
    fn parts_and_the_oldest_kind() {
        let parts =
            "[FileInfo]\nFilename=a.mpt\n[Profile1]\nColumnDef=X,Y,A\n[Profile1Points]\n1,2,0\n3,4,0\n";
        assert_eq!(parse(parts, "x").unwrap().points, vec![[1.0, 2.0], [3.0, 4.0]]);
        let two = format!("{parts}[Profile2Points]\n5,6,0\n");
        assert!(refused(&two).contains("one profile in a file"));
        let old = "MINIPROF 1.0\nSomewhere 12\n3 tracks\n\n1 2\n3 4\n";
        assert_eq!(parse(old, "x").unwrap().points, vec![[1.0, 2.0], [3.0, 4.0]]);
    }

    #[test]
    fn malformed_headers_are_refused_by_line() {
        assert!(refused("A=b\nColumnDef=X,A\n\n1 2\n").contains("line 2: `ColumnDef=X,A`"));
        assert!(refused("A=b\nXOffset=left\n\n1 2\n").contains("a number of mm"));
        assert!(refused("A=b\nXYPoints=many\n\n1 2\n").contains("a number of points"));
        assert!(refused("A=b\n\n1 2\nXOffset=1\n").contains("before the first point"));
        assert!(refused("A=b\nno equals sign\n\n1 2\n").contains("`Key=Value`, or a row of numbers"));
        assert!(refused("A=b\n\n1\n").contains("2 finite numbers"));
        assert!(refused("A=b\n\n1 nan\n").contains("2 finite numbers"));
        assert!(refused("A=b\n").contains("no point"));
    }
}
