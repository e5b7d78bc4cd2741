//! Stands in for types that arrive from `track`, `contact` and `integrator`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One segment of the layout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Segment {
    /// Straight.
    Tangent {
        /// Length, m.
        length: f64,
    },
}

/// One irregularity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Irregularity {
    /// Stochastic.
    Psd {
        /// Spectrum.
        form: String,
        /// Class.
        class: u8,
        /// Band, m.
        wavelengths: [f64; 2],
        /// Seed.
        seed: u64,
        /// Length after which it repeats, m.
        period: f64,
    },
}
