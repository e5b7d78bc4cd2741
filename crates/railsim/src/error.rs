//! The one error type. Every variant carries what a message needs: key, found, allowed; or time, distance, body.

use std::fmt;

/// Result of everything in this crate that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// One step of a key path.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Segment {
    /// Key of a table.
    Key(String),
    /// Index into an array, from zero.
    Index(usize),
}

/// Where in a document a value stands, e.g. `vehicle.body[2].mass`.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct KeyPath(pub Vec<Segment>);

impl KeyPath {
    /// Path from dotted keys without indices: `KeyPath::of("run.integrator.step")`.
    #[must_use]
    pub fn of(dotted: &str) -> Self {
        Self(dotted.split('.').map(|k| Segment::Key(k.to_owned())).collect())
    }

    /// This path with a key appended.
    #[must_use]
    pub fn key(&self, key: &str) -> Self {
        let mut path = self.clone();
        path.0.push(Segment::Key(key.to_owned()));
        path
    }

    /// This path with an index appended.
    #[must_use]
    pub fn index(&self, index: usize) -> Self {
        let mut path = self.clone();
        path.0.push(Segment::Index(index));
        path
    }
}

impl fmt::Display for KeyPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, segment) in self.0.iter().enumerate() {
            match segment {
                Segment::Key(key) if i == 0 => write!(f, "{key}")?,
                Segment::Key(key) => write!(f, ".{key}")?,
                Segment::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// One fault in what the user wrote.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Where, as a path from the root of the document or case.
    pub key: KeyPath,
    /// What was found there, as the user would recognise it.
    pub found: String,
    /// What is allowed there.
    pub allowed: String,
    /// What to try, e.g. the nearest known name.
    pub hint: Option<String>,
}

impl Fault {
    /// A fault without a hint.
    pub fn new(key: KeyPath, found: impl Into<String>, allowed: impl Into<String>) -> Self {
        Self { key, found: found.into(), allowed: allowed.into(), hint: None }
    }

    /// The same with a hint.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: found {}; allowed: {}", self.key, self.found, self.allowed)?;
        if let Some(hint) = &self.hint {
            write!(f, " ({hint})")?;
        }
        Ok(())
    }
}

fn join(faults: &[Fault]) -> String {
    faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

/// Everything that can go wrong in the core.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Bad input: every fault that was found, not only the first.
    #[error("{}", join(.0))]
    Input(Vec<Fault>),
    /// An iteration that did not reach its tolerance.
    #[error(
        "{what} did not converge in {iterations} iterations: largest residual {residual:.3e} {unit} at {worst}"
    )]
    NotConverged {
        /// What was solved.
        what: String,
        /// Iterations made.
        iterations: usize,
        /// Largest residual left.
        residual: f64,
        /// Its unit.
        unit: &'static str,
        /// The equation it belongs to, e.g. `ws3 roll`.
        worst: String,
    },
    /// The run left what the model describes: NaN, a body beyond its bounds, an energy blow-up, a derailment.
    #[error("run ended at t = {t:.4} s, s = {s:.2} m: {body}: {cause}")]
    Diverged {
        /// Time, s.
        t: f64,
        /// Distance of the vehicle, m.
        s: f64,
        /// The body that left first.
        body: String,
        /// Likely cause, for a person.
        cause: String,
    },
    /// Stopped from outside (Ctrl-C).
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// One fault.
    #[must_use]
    pub fn input(fault: Fault) -> Self {
        Self::Input(vec![fault])
    }
}
