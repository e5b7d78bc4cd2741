//! The track: its design line ([`Layout`], giving a [`Frame`] at every arc length) and what deviates from it
//! ([`irregularity`]).

pub mod cant;
mod frame;
pub mod gauge;
pub mod irregularity;
mod layout;
mod segment;
pub mod transition;

use crate::error::{Fault, KeyPath};

pub use frame::Frame;
pub use irregularity::{Deviation, DeviationField, Irregularity};
pub use layout::Layout;
pub use segment::{Curve, Passage, Segment, Tangent};

/// The path of a key that stands beside `at` in the same table.
fn beside(at: &KeyPath, key: &str) -> KeyPath {
    let mut path = at.clone();
    path.0.pop();
    path.key(key)
}

/// Collects a fault unless `value` is finite and `allowed` (described by `range`) holds.
fn require(
    faults: &mut Vec<Fault>,
    at: KeyPath,
    value: f64,
    allowed: impl FnOnce(f64) -> bool,
    range: &str,
) -> bool {
    let good = value.is_finite() && allowed(value);
    if !good {
        faults.push(Fault::new(at, value.to_string(), range));
    }
    good
}
