//! TOML text: to JSON, and back from a key path to the line where it stands.

use serde_json::{Map, Value as Json};
use toml_edit::{Document, Item, Table, TableLike, Value};

use crate::error::{Error, Fault, KeyPath, Result, Segment};

/// Where and why a text is not TOML.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SyntaxError {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What is wrong, in one line.
    pub message: String,
}

/// The syntax error of a text, if it has one.
#[must_use]
pub fn syntax_error(text: &str) -> Option<SyntaxError> {
    parse(text).err()
}

fn parse(text: &str) -> std::result::Result<Document<&str>, SyntaxError> {
    Document::parse(text).map_err(|error| {
        let (line, column) = place(text, error.span().map_or(0, |span| span.start));
        let message = error.message().split_whitespace().collect::<Vec<_>>().join(" ");
        SyntaxError { line, column, message }
    })
}

fn place(text: &str, byte: usize) -> (usize, usize) {
    let mut byte = byte.min(text.len());
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    let before = &text[..byte];
    let start = before.rfind('\n').map_or(0, |i| i + 1);
    (before.matches('\n').count() + 1, before[start..].chars().count() + 1)
}

/// A TOML text as JSON.
///
/// # Errors
/// [`Error::Input`]: a syntax error, whose key reads `line 3, column 7` (see [`syntax_error`] for the numbers); a date,
/// an infinite number or NaN, which JSON does not have.
pub fn toml_to_json(text: &str) -> Result<Json> {
    let document = parse(text).map_err(|e| {
        let key = KeyPath(vec![Segment::Key(format!("line {}, column {}", e.line, e.column))]);
        Error::input(Fault::new(key, e.message, "TOML"))
    })?;
    let mut faults = Vec::new();
    let json = table(document.as_table(), &KeyPath::default(), &mut faults);
    if faults.is_empty() { Ok(json) } else { Err(Error::Input(faults)) }
}

fn table(map: &dyn TableLike, at: &KeyPath, faults: &mut Vec<Fault>) -> Json {
    let mut out = Map::new();
    for (key, item) in map.iter() {
        out.insert(key.to_owned(), of_item(item, &at.key(key), faults));
    }
    Json::Object(out)
}

fn of_item(item: &Item, at: &KeyPath, faults: &mut Vec<Fault>) -> Json {
    match item {
        Item::None => Json::Null,
        Item::Value(value) => of_value(value, at, faults),
        Item::Table(inner) => table(inner, at, faults),
        Item::ArrayOfTables(tables) => {
            Json::Array(tables.iter().enumerate().map(|(i, t)| table(t, &at.index(i), faults)).collect())
        }
    }
}

fn of_value(value: &Value, at: &KeyPath, faults: &mut Vec<Fault>) -> Json {
    match value {
        Value::String(s) => Json::String(s.value().clone()),
        Value::Integer(i) => Json::from(*i.value()),
        Value::Boolean(b) => Json::Bool(*b.value()),
        Value::Float(x) => match serde_json::Number::from_f64(*x.value()) {
            Some(n) => Json::Number(n),
            None => {
                faults.push(Fault::new(at.clone(), x.value().to_string(), "a finite number"));
                Json::Null
            }
        },
        Value::Datetime(date) => {
            faults.push(Fault::new(at.clone(), format!("the date {}", date.value()), "a text, in quotes"));
            Json::Null
        }
        Value::Array(items) => Json::Array(
            items.iter().enumerate().map(|(i, item)| of_value(item, &at.index(i), faults)).collect(),
        ),
        Value::InlineTable(inner) => table(inner, at, faults),
    }
}

/// Line (from 1) of the deepest part of `key` that stands in the text: the line of its key, or of the item in a list.
/// `None` when not even its first part does, or the text is not TOML.
#[must_use]
pub fn line_of(text: &str, key: &KeyPath) -> Option<usize> {
    let document = parse(text).ok()?;
    let byte = deepest(Place::Table(document.as_table()), &key.0)?;
    Some(place(text, byte).0)
}

/// What a key path can go down into.
enum Place<'a> {
    Table(&'a Table),
    Inline(&'a toml_edit::InlineTable),
    Array(&'a toml_edit::Array),
    Tables(&'a toml_edit::ArrayOfTables),
    Leaf,
}

impl<'a> Place<'a> {
    fn of_item(item: &'a Item) -> Self {
        match item {
            Item::Table(t) => Self::Table(t),
            Item::ArrayOfTables(t) => Self::Tables(t),
            Item::Value(v) => Self::of_value(v),
            Item::None => Self::Leaf,
        }
    }

    fn of_value(value: &'a Value) -> Self {
        match value {
            Value::InlineTable(t) => Self::Inline(t),
            Value::Array(a) => Self::Array(a),
            _ => Self::Leaf,
        }
    }

    /// One step down, and the byte where that part is written, if it is written at all (a table that only its
    /// subtables imply is not).
    fn step(&self, segment: &Segment) -> Option<(Self, Option<usize>)> {
        match (self, segment) {
            (Self::Table(t), Segment::Key(key)) => {
                let (written, item) = t.get_key_value(key)?;
                // The header of a table: its own span; the key's is that of its first mention.
                let own = match item {
                    Item::Table(t) if !t.is_dotted() => t.span().map(|s| s.start),
                    _ => None,
                };
                Some((Self::of_item(item), own.or(written.span().map(|s| s.start))))
            }
            (Self::Inline(t), Segment::Key(key)) => {
                let (written, item) = t.get_key_value(key)?;
                Some((Self::of_item(item), written.span().map(|s| s.start)))
            }
            (Self::Array(a), Segment::Index(i)) => {
                let value = a.get(*i)?;
                Some((Self::of_value(value), value.span().map(|s| s.start)))
            }
            (Self::Tables(a), Segment::Index(i)) => {
                let table = a.get(*i)?;
                Some((Self::Table(table), table.span().map(|s| s.start)))
            }
            _ => None,
        }
    }
}

fn deepest(start: Place<'_>, path: &[Segment]) -> Option<usize> {
    let mut place = start;
    let mut byte = None;
    for segment in path {
        let Some((next, at)) = place.step(segment) else { break };
        byte = at.or(byte);
        place = next;
    }
    byte
}
