//! Linear textbook contact: constant conicity, given creep coefficients, a vertical spring under each wheel.
//!
//! For closed forms (Klingel, the suspended wheelset, textbook bogies) and as the cheapest contact there is; never
//! for acceptance. Per wheel: `N = k depth + c depth'`, `Fx = -f11 xi`, `Fy = -f22 eta - f23 phi`, the rolling radius
//! `r0 + conicity * shift`, the contact plane horizontal (no gravity stiffness).

use schemars::JsonSchema;
use serde::Deserialize;

/// Constants of one wheel.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Textbook {
    /// Conicity, rad.
    #[schemars(extend("minimum" = 0, "exclusiveMaximum" = 1))]
    pub conicity: f64,
    /// Longitudinal creep coefficient per wheel, N.
    #[schemars(extend("minimum" = 0, "unit" = "N"))]
    pub f11: f64,
    /// Lateral creep coefficient per wheel, N.
    #[schemars(extend("minimum" = 0, "unit" = "N"))]
    pub f22: f64,
    /// Lateral/spin creep coefficient per wheel, N m.
    #[serde(default)]
    #[schemars(extend("unit" = "N m"))]
    pub f23: f64,
    /// Vertical stiffness per wheel, N/m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N/m"))]
    pub stiffness: f64,
    /// Vertical damping per wheel, N s/m.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "N s/m"))]
    pub damping: f64,
}
