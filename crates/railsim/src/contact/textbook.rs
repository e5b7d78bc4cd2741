//! Linear textbook contact: constant conicity, given creep coefficients, a vertical spring under each wheel.
//!
//! For closed forms (Klingel, the suspended wheelset, textbook bogies) and as the cheapest contact there is; never
//! for acceptance. Per wheel: `N = k depth + c depth'`, `Fx = -f11 xi`, `Fy = -f22 eta - f23 phi`, the rolling radius
//! `r0 + conicity * shift`, the contact plane horizontal (no gravity stiffness).

/// Constants of one wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Textbook {
    /// Conicity, rad.
    pub conicity: f64,
    /// Longitudinal creep coefficient per wheel, N.
    pub f11: f64,
    /// Lateral creep coefficient per wheel, N.
    pub f22: f64,
    /// Lateral/spin creep coefficient per wheel, N m.
    pub f23: f64,
    /// Vertical stiffness per wheel, N/m.
    pub stiffness: f64,
    /// Vertical damping per wheel, N s/m.
    pub damping: f64,
}
