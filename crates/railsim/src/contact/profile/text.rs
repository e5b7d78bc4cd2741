//! What all readers of profile text share: fields, numbers, and faults by line.

use crate::error::{Error, Fault, KeyPath, Result};

/// Faults of one text that are listed one by one; a text that is something else altogether has thousands.
const LISTED: usize = 10;

/// Faults of a text, by line.
pub(super) struct Faults {
    at: KeyPath,
    list: Vec<Fault>,
    more: usize,
}

impl Faults {
    pub(super) fn of(name: &str) -> Self {
        Self { at: key(name), list: Vec::new(), more: 0 }
    }

    /// A fault in a line, counted from one.
    pub(super) fn line(&mut self, number: usize, line: &str, allowed: impl Into<String>) {
        if self.list.len() < LISTED {
            let found = format!("line {number}: `{}`", shown(line));
            self.list.push(Fault::new(self.at.clone(), found, allowed));
        } else {
            self.more += 1;
        }
    }

    /// A fault of the whole text.
    pub(super) fn whole(&mut self, found: impl Into<String>, allowed: impl Into<String>) {
        self.list.push(Fault::new(self.at.clone(), found, allowed));
    }

    /// Gives the last fault a hint.
    pub(super) fn hint(&mut self, hint: &str) {
        if let Some(last) = self.list.pop() {
            self.list.push(last.hint(hint));
        }
    }

    pub(super) fn any(&self) -> bool {
        !self.list.is_empty()
    }

    /// `value`, unless there are faults.
    pub(super) fn or<T>(mut self, value: T) -> Result<T> {
        if self.more > 0 {
            let found = format!("{} more lines like these", self.more);
            self.list.push(Fault::new(self.at.clone(), found, "none"));
        }
        if self.list.is_empty() { Ok(value) } else { Err(Error::Input(self.list)) }
    }
}

/// Key under which the points of a profile stand in a case.
pub(super) fn key(name: &str) -> KeyPath {
    KeyPath::of("profiles").key(name).key("points")
}

/// A line as a message shows it: its first 60 characters.
fn shown(line: &str) -> String {
    let mut characters = line.chars();
    let head: String = characters.by_ref().take(60).collect();
    if characters.next().is_some() { head + "..." } else { head }
}

/// Lines with their numbers from one, trimmed, without a byte order mark.
pub(super) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.trim_start_matches('\u{feff}').lines().enumerate().map(|(i, line)| (i + 1, line.trim()))
}

/// Fields of a row: separated by semicolons where there is one (a comma then belongs to a number, and is no point),
/// otherwise by commas; blanks separate too.
pub(super) fn fields(line: &str) -> impl Iterator<Item = &str> {
    let semicolon = line.contains(';');
    line.split(move |c: char| c == ';' || (c == ',' && !semicolon) || c.is_whitespace())
        .filter(|field| !field.is_empty())
}

/// The numbers of a row, as far as they are numbers (`nan` and `inf` are).
pub(super) fn numbers(line: &str) -> Vec<f64> {
    fields(line).map_while(|field| field.parse().ok()).collect()
}

/// Whether a line starts with a number.
pub(super) fn starts_with_number(line: &str) -> bool {
    fields(line).next().is_some_and(|field| field.parse::<f64>().is_ok())
}

/// The first two numbers of a row; `None` unless both are there and finite.
pub(super) fn pair(line: &str) -> Option<[f64; 2]> {
    match numbers(line)[..] {
        [y, z, ..] if y.is_finite() && z.is_finite() => Some([y, z]),
        _ => None,
    }
}

/// Metres as a decimal number of millimetres, to the picometre: reading it gives the same metres again wherever they came from
/// millimetres with up to nine decimals.
pub(super) fn millimetres(metres: f64) -> f64 {
    let rounded = (metres * 1e12).round() / 1e9;
    if rounded.is_finite() { rounded + 0.0 } else { metres * 1e3 }
}

/// A title as one line of a file: no line breaks, quotes or other control characters.
pub(super) fn one_line(title: &str) -> String {
    title.chars().map(|c| if c.is_control() || c == '\'' || c == '"' { ' ' } else { c }).collect()
}
