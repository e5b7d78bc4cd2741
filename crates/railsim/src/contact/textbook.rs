//! Linear textbook contact: constant conicity, given creep coefficients, a vertical spring under each wheel.
//!
//! For closed forms (Klingel, the suspended wheelset, textbook bogies) and as the cheapest contact there is; never
//! for acceptance. Per wheel: `N = k depth + c depth'`, `Fx = -f11 xi`, `Fy = -f22 eta - f23 phi`, the rolling radius
//! `r0 + conicity * shift`.
//!
//! Without gravity stiffness the normal force is vertical. With it, it stands on the cone: the wheel meets the rail `conicity * shift` deeper and the
//! normal leans inward by the cone's angle less the roll of the axle. Under the axle load W, l half the distance of the running circles and r0 the radius, a
//! wheelset is then pushed back by W e/l per metre of shift, e = l conicity/(l - r0 conicity), and turned on by W l conicity per radian of yaw (A. H.
//! Wickens, *Fundamentals of Rail Vehicle Dynamics* (2003), for cones on knife-edged rails). Creep forces stay in the plane of the track.

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
    /// Whether the normal force leans with the cone, so that weight centres a shifted wheelset and turns a yawed one.
    #[serde(default)]
    pub gravity_stiffness: bool,
}
