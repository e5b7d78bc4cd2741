//! Fields of irregularities and their numbers.

#![allow(dead_code, clippy::unwrap_used, reason = "test helpers, not all used by every test")]

use railsim::error::KeyPath;
use railsim::track::irregularity::{Deviation, DeviationField, Irregularity};

/// Without fading.
pub fn field(written: &[Irregularity], length: f64) -> DeviationField {
    DeviationField::new(written, length, 0.0, 0.0, &KeyPath::of("track.irregularity")).unwrap()
}

pub fn values(d: Deviation) -> [f64; 4] {
    [d.y, d.z, d.cross_level, d.gauge]
}

pub fn slopes(d: Deviation) -> [f64; 4] {
    [d.dy_ds, d.dz_ds, d.dcross_level_ds, d.dgauge_ds]
}
