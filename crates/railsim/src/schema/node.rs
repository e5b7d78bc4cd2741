//! A document as a tree in which every value knows where it was written.
//!
//! Templates are copied, references replaced and positions shifted on this tree; what comes out still points at
//! the key that a person has to change.

use std::collections::BTreeMap;

use serde_json::{Map, Number};

use crate::error::{KeyPath, Segment};

/// A value and where it stands in the document as written.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    /// Path in the document, before any expansion.
    pub at: KeyPath,
    /// The reference that this number came from, e.g. `$car.mass`.
    pub via: Option<String>,
    /// The value.
    pub value: Value,
}

/// The kinds of value that JSON and TOML share.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Null,
    Bool(bool),
    Number(Number),
    Text(String),
    List(Vec<Node>),
    Table(BTreeMap<String, Node>),
    /// Something whose fault has been said: no further check looks at it, and nothing is made of it.
    Faulty,
}

impl Node {
    /// The tree of a JSON value that stands at `at`.
    pub fn from_json(json: &serde_json::Value, at: KeyPath) -> Self {
        let value = match json {
            serde_json::Value::Null => Value::Null,
            serde_json::Value::Bool(b) => Value::Bool(*b),
            serde_json::Value::Number(n) => Value::Number(n.clone()),
            serde_json::Value::String(s) => Value::Text(s.clone()),
            serde_json::Value::Array(items) => Value::List(
                items.iter().enumerate().map(|(i, item)| Self::from_json(item, at.index(i))).collect(),
            ),
            serde_json::Value::Object(map) => Value::Table(
                map.iter().map(|(k, item)| (k.clone(), Self::from_json(item, at.key(k)))).collect(),
            ),
        };
        Self { at, via: None, value }
    }

    /// Plain JSON again, for serde.
    pub fn to_json(&self) -> serde_json::Value {
        match &self.value {
            Value::Null | Value::Faulty => serde_json::Value::Null,
            Value::Bool(b) => serde_json::Value::Bool(*b),
            Value::Number(n) => serde_json::Value::Number(n.clone()),
            Value::Text(s) => serde_json::Value::String(s.clone()),
            Value::List(items) => serde_json::Value::Array(items.iter().map(Self::to_json).collect()),
            Value::Table(map) => serde_json::Value::Object(
                map.iter().map(|(k, item)| (k.clone(), item.to_json())).collect::<Map<_, _>>(),
            ),
        }
    }

    /// The node below `key`, if this is a table that has it.
    pub fn get(&self, key: &str) -> Option<&Self> {
        match &self.value {
            Value::Table(map) => map.get(key),
            _ => None,
        }
    }

    /// The items, if this is a list.
    pub fn items(&self) -> &[Self] {
        match &self.value {
            Value::List(items) => items,
            _ => &[],
        }
    }

    /// The keys and values, if this is a table.
    pub fn table(&self) -> Option<&BTreeMap<String, Self>> {
        match &self.value {
            Value::Table(map) => Some(map),
            _ => None,
        }
    }

    /// The number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match &self.value {
            Value::Number(n) => n.as_f64(),
            _ => None,
        }
    }

    /// The text, if it is one.
    pub fn text(&self) -> Option<&str> {
        match &self.value {
            Value::Text(s) => Some(s),
            _ => None,
        }
    }

    /// Whether it says `true`.
    pub fn is_true(&self) -> bool {
        matches!(self.value, Value::Bool(true))
    }

    /// Whether anything in here has been found faulty already.
    pub fn is_faulty(&self) -> bool {
        match &self.value {
            Value::Faulty => true,
            Value::List(items) => items.iter().any(Self::is_faulty),
            Value::Table(map) => map.values().any(Self::is_faulty),
            _ => false,
        }
    }

    /// The deepest node that exists along `path` (keys and indices of the tree, not of the document).
    pub fn deepest(&self, path: &[Segment]) -> &Self {
        let mut node = self;
        for segment in path {
            let next = match (segment, &node.value) {
                (Segment::Key(key), Value::Table(map)) => map.get(key),
                (Segment::Index(i), Value::List(items)) => items.get(*i),
                _ => None,
            };
            match next {
                Some(next) => node = next,
                None => break,
            }
        }
        node
    }

    /// What stands here, as a message shows it.
    pub fn found(&self) -> String {
        let text = match &self.value {
            Value::Null | Value::Faulty => "null".to_owned(),
            Value::Bool(b) => b.to_string(),
            Value::Number(n) => n.to_string(),
            Value::Text(s) => quoted(s),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(_) => "a table".to_owned(),
        };
        match &self.via {
            Some(reference) => format!("{text} (from {reference})"),
            None => text,
        }
    }
}

/// A text in quotes, shortened when long.
pub(super) fn quoted(text: &str) -> String {
    const LONGEST: usize = 60;
    if text.chars().count() > LONGEST {
        format!("{:?}...", text.chars().take(LONGEST).collect::<String>())
    } else {
        format!("{text:?}")
    }
}
