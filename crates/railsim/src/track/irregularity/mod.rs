//! What deviates from the design line: lateral, vertical, cross-level and gauge, as functions of arc length.
//!
//! | channel | unit | + |
//! |---|---|---|
//! | `y` lateral (alignment) | m | track centre line to the right |
//! | `z` vertical (profile) | m | track centre line down |
//! | `cross_level` | m | right rail lower: z_right - z_left over the base of 1.5 m |
//! | `gauge` | m | wider |
//!
//! A rail's own deviation follows: z of the right rail is z + cross_level/2, of the left one z - cross_level/2; y of
//! the right rail is y + gauge/2, of the left one y - gauge/2.

mod combine;
mod measured;
mod psd;
mod shape;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::require;
use crate::error::{Fault, KeyPath};

pub use combine::DeviationField;
pub use measured::Measured;
pub use psd::{Density, Form, GaugeSeries, Level, Psd, spectrum};
pub use shape::{Shape, ShapeChannel, Wave};

/// Which of the four channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Centre line to the right.
    Lateral,
    /// Centre line down (written heights are up).
    Vertical,
    /// Right rail lower than left.
    CrossLevel,
    /// Gauge wider.
    Gauge,
}

impl Channel {
    /// All four, in the order of [`DeviationField::extremes`].
    pub const ALL: [Self; 4] = [Self::Lateral, Self::Vertical, Self::CrossLevel, Self::Gauge];

    /// Its place in [`Self::ALL`].
    #[must_use]
    pub fn index(self) -> usize {
        match self {
            Self::Lateral => 0,
            Self::Vertical => 1,
            Self::CrossLevel => 2,
            Self::Gauge => 3,
        }
    }
}

/// Deviation of the track from its design line at one arc length, and its slopes along s. The fields follow the order
/// and the signs of the module's table.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deviation {
    /// Track centre line, + right, m.
    pub y: f64,
    /// Track centre line, + down, m.
    pub z: f64,
    /// z_right - z_left over 1.5 m, + right rail lower, m.
    pub cross_level: f64,
    /// Widening of the gauge, m.
    pub gauge: f64,
    /// Slope of `y`, 1.
    pub dy_ds: f64,
    /// Slope of `z`, 1.
    pub dz_ds: f64,
    /// Slope of `cross_level`, 1.
    pub dcross_level_ds: f64,
    /// Slope of `gauge`, 1.
    pub dgauge_ds: f64,
}

/// One irregularity as written. A case holds a list of them; they add up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Irregularity {
    /// A realisation of a power spectral density.
    Psd(Psd),
    /// Waves of given height and length: humps, dips, kinks, joints, cyclic irregularities.
    Shape(Shape),
    /// A record of a track, read by the caller.
    Measured(Measured),
}

impl Irregularity {
    /// Examples of every kind, for the contract suite and the documentation.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let psd = Psd::examples().into_iter().map(Self::Psd);
        let measured = Measured::examples().into_iter().map(Self::Measured);
        psd.chain(Shape::examples().into_iter().map(Self::Shape)).chain(measured).collect()
    }

    /// Everything that is wrong with it; `at` is the path of its table.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = Vec::new();
        match self {
            Self::Psd(psd) => psd.faults(at, &mut faults),
            Self::Shape(shape) => shape.faults(at, &mut faults),
            Self::Measured(measured) => measured.faults(at, &mut faults),
        }
        faults
    }
}

/// 1 for a `scale` that is not written.
fn one() -> f64 {
    1.0
}

fn scale_faults(scale: f64, at: &KeyPath, faults: &mut Vec<Fault>) {
    require(faults, at.key("scale"), scale, |_| true, "a finite number");
}
