//! Cant: how much lower the right rail lies than the left one, and the roll angle it stands for.

/// Distance of the two contact lines over which cant and cross-level are measured on 1435 mm gauge, m.
pub const BASE: f64 = 1.5;

/// Largest cant that is accepted, mm: twice what railways build.
pub const MAX_MM: f64 = 320.0;

/// Sine of the roll angle of the track plane for a cant in mm (+ right rail lower): the base turns about the centre
/// line and keeps its length.
#[must_use]
pub fn sine(cant_mm: f64) -> f64 {
    cant_mm / (1000.0 * BASE)
}
