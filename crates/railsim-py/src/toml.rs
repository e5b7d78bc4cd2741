//! TOML text as JSON, and the line of a key: tagged enums lose lines, so they are looked up afterwards.

use pyo3::prelude::*;
use railsim::error::Segment;
use railsim::{Fault, KeyPath};
use serde_json::{Map, Number, Value as Json};
use toml_edit::{Document, Item, TableLike, TomlError, Value};

use crate::errors::input_error;

/// A TOML document as JSON text.
#[pyfunction]
pub fn toml_to_json(py: Python<'_>, text: &str) -> PyResult<String> {
    let document = Document::parse(text).map_err(|e| syntax_error(py, text, &e))?;
    let mut faults = Vec::new();
    let json = table(document.as_table(), &KeyPath::default(), &mut faults);
    if faults.is_empty() {
        return Ok(json.to_string());
    }
    let message = faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    let faults: Vec<_> = faults
        .into_iter()
        .map(|fault| {
            let line = deepest(document.as_table(), &fault.key.0).map(|at| line_at(text, at));
            (fault, line)
        })
        .collect();
    Err(input_error(py, &message, &faults))
}

/// Line, from 1, of the deepest part of `key` that exists; nothing where not even its first part does.
#[pyfunction]
pub fn toml_line(py: Python<'_>, text: &str, key: Vec<KeyPart>) -> PyResult<Option<usize>> {
    let document = Document::parse(text).map_err(|e| syntax_error(py, text, &e))?;
    let key: Vec<Segment> = key.into_iter().map(Segment::from).collect();
    Ok(deepest(document.as_table(), &key).map(|at| line_at(text, at)))
}

/// One part of a key path as Python gives it.
#[derive(FromPyObject)]
pub enum KeyPart {
    Index(usize),
    Key(String),
}

impl From<KeyPart> for Segment {
    fn from(part: KeyPart) -> Self {
        match part {
            KeyPart::Index(index) => Self::Index(index),
            KeyPart::Key(key) => Self::Key(key),
        }
    }
}

fn line_at(text: &str, offset: usize) -> usize {
    text.as_bytes().iter().take(offset).filter(|byte| **byte == b'\n').count() + 1
}

fn syntax_error(py: Python<'_>, text: &str, error: &TomlError) -> PyErr {
    let line = error.span().map(|span| line_at(text, span.start));
    let what = error.message().lines().collect::<Vec<_>>().join("; ");
    let shown = line.and_then(|line| text.lines().nth(line - 1)).unwrap_or("").trim();
    let fault = Fault::new(KeyPath::default(), format!("`{shown}`: {what}"), "TOML");
    let at = line.map_or_else(String::new, |line| format!("line {line}: "));
    input_error(py, &format!("{at}not TOML: {what}: `{shown}`"), &[(fault, line)])
}

fn table(table: &dyn TableLike, at: &KeyPath, faults: &mut Vec<Fault>) -> Json {
    let mut map = Map::new();
    for (key, value) in table.iter() {
        map.insert(key.to_owned(), item(value, &at.key(key), faults));
    }
    Json::Object(map)
}

fn item(item: &Item, at: &KeyPath, faults: &mut Vec<Fault>) -> Json {
    match item {
        Item::None => Json::Null,
        Item::Value(v) => value(v, at, faults),
        Item::Table(t) => table(t, at, faults),
        Item::ArrayOfTables(list) => {
            Json::Array(list.iter().enumerate().map(|(i, t)| table(t, &at.index(i), faults)).collect())
        }
    }
}

fn value(value: &Value, at: &KeyPath, faults: &mut Vec<Fault>) -> Json {
    match value {
        Value::String(v) => Json::String(v.value().clone()),
        Value::Integer(v) => Json::Number((*v.value()).into()),
        Value::Boolean(v) => Json::Bool(*v.value()),
        Value::Float(v) => Number::from_f64(*v.value()).map_or_else(
            || {
                faults.push(Fault::new(at.clone(), v.value().to_string(), "a finite number"));
                Json::Null
            },
            Json::Number,
        ),
        Value::Datetime(v) => {
            let fault = Fault::new(at.clone(), v.value().to_string(), "text, a number, true or false");
            faults.push(fault.hint("write a date in quotes"));
            Json::Null
        }
        Value::Array(list) => {
            Json::Array(list.iter().enumerate().map(|(i, v)| self::value(v, &at.index(i), faults)).collect())
        }
        Value::InlineTable(t) => table(t, at, faults),
    }
}

/// Offset of the deepest part of `key` that exists below `table`.
fn deepest(root: &dyn TableLike, key: &[Segment]) -> Option<usize> {
    let mut found = None;
    let mut node = Node::Table(root);
    for segment in key {
        let Some((offset, next)) = node.step(segment) else { break };
        found = offset.or(found);
        let Some(next) = next else { break };
        node = next;
    }
    found
}

enum Node<'a> {
    Table(&'a dyn TableLike),
    Tables(&'a toml_edit::ArrayOfTables),
    Array(&'a toml_edit::Array),
}

impl<'a> Node<'a> {
    /// Where the named part starts, and what can be looked into from there.
    fn step(&self, segment: &Segment) -> Option<(Option<usize>, Option<Node<'a>>)> {
        match (self, segment) {
            (Node::Table(table), Segment::Key(key)) => {
                let (written, item) = table.get_key_value(key)?;
                let start = written.span().or_else(|| item.span()).map(|span| span.start);
                Some((start, Node::of_item(item)))
            }
            (Node::Tables(list), Segment::Index(index)) => {
                let table = list.get(*index)?;
                Some((table.span().map(|span| span.start), Some(Node::Table(table))))
            }
            (Node::Array(list), Segment::Index(index)) => {
                let value = list.get(*index)?;
                Some((value.span().map(|span| span.start), Node::of_value(value)))
            }
            _ => None,
        }
    }

    fn of_item(item: &'a Item) -> Option<Self> {
        match item {
            Item::Table(table) => Some(Node::Table(table)),
            Item::ArrayOfTables(list) => Some(Node::Tables(list)),
            Item::Value(value) => Self::of_value(value),
            Item::None => None,
        }
    }

    fn of_value(value: &'a Value) -> Option<Self> {
        match value {
            Value::InlineTable(table) => Some(Node::Table(table)),
            Value::Array(list) => Some(Node::Array(list)),
            _ => None,
        }
    }
}
