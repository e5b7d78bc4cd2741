//! Vermeulen and Johnson's theory.

use super::{CreepForce, Creepage, DEFAULT_POISSON, Patch, poisson_faults};
use crate::error::{Fault, KeyPath};
use crate::math::elliptic;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Vermeulen and Johnson's theory for elliptical patches without spin (P. J. Vermeulen and K. L. Johnson, J. Appl. Mech. 31 (1964) 338):
/// the area of adhesion is an ellipse similar to the patch that touches its leading edge.
///
/// - tau = pi a b G/(mu N) sqrt((xi/Phi)^2 + (eta/Psi)^2), F = mu N (1 - (1 - tau/3)^3) for tau <= 3, else mu N,
/// - direction: opposite to (xi/Phi, eta/Psi),
/// - a <= b, k^2 = 1 - (a/b)^2: Phi = B - nu (D - C), Psi = B - nu (a/b)^2 C,
/// - a >= b, k^2 = 1 - (b/a)^2: Phi = (b/a)(D - nu (D - C)), Psi = (b/a)(D - nu C),
///
/// with the complete elliptic integrals B, C, D of Jahnke and Emde, C = (D - B)/k^2. Phi and Psi are the mean of the tangential
/// compliance of an ellipsoidal traction over the patch, so that without tables the slopes at zero are pi/Phi and pi/Psi:
/// 16/(4 - 3 nu) and 16/(4 - nu) at a = b, some 20 % above Kalker's C11 and C22 because the leading edge is let slide wrongly.
/// **Spin is left out.**
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VermeulenJohnson {
    /// Poisson's ratio, 0 to 0.5. If absent, the vehicle's in a case and 0.28 elsewhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0, "maximum" = 0.5))]
    pub poisson: Option<f64>,
}

/// Factor on a linear force of `u` times the friction: 1 - u/3 + u^2/27, 1/u from u = 3 on.
#[inline]
pub(super) fn saturation(u: f64) -> f64 {
    if u >= 3.0 { 1.0 / u } else { 1.0 - u / 3.0 + u * u / 27.0 }
}

/// Phi and Psi for the axis ratio g = a/b.
fn compliance(g: f64, nu: f64) -> [f64; 2] {
    let minor = g.min(1.0 / g);
    let e = elliptic::complete(minor);
    let square = (1.0 - minor) * (1.0 + minor);
    // near the circle the difference D - B loses its digits: C = pi/16 (1 + 3 k^2/4 + ..)
    let c = if square > 1e-4 { (e.D - e.B) / square } else { PI / 16.0 * (1.0 + 0.75 * square) };
    if g <= 1.0 {
        [e.B - nu * (e.D - c), e.B - nu * g * g * c]
    } else {
        [minor * (e.D - nu * (e.D - c)), minor * (e.D - nu * c)]
    }
}

impl VermeulenJohnson {
    fn compliance(&self, p: &Patch) -> [f64; 2] {
        compliance(p.a / p.b, self.poisson.unwrap_or(DEFAULT_POISSON))
    }

    /// Force on the wheel.
    #[must_use]
    pub fn force(&self, p: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
        let limit = mu * p.n;
        if limit <= 0.0 {
            return CreepForce::default();
        }
        let [phi, psi] = self.compliance(p);
        let scale = -PI * p.a * p.b * p.shear_modulus;
        let (fx, fy) = (scale * creepage.xi / phi, scale * creepage.eta / psi);
        let ratio = saturation((fx * fx + fy * fy).sqrt() / limit);
        CreepForce { fx: ratio * fx, fy: ratio * fy }
    }

    /// Slopes at zero creepage, longitudinal and lateral, as fractions of Kalker's.
    #[must_use]
    pub fn slopes(&self, p: &Patch) -> [f64; 2] {
        let [phi, psi] = self.compliance(p);
        [PI / (phi * p.c11), PI / (psi * p.c22)]
    }

    /// Faults in the parameters.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        poisson_faults(self.poisson, at)
    }

    /// Laws for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self::default(), Self { poisson: Some(0.0) }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Johnson's circle (J. Appl. Mech. 25 (1958) 339): slopes 16/(4 - 3 nu) and 16/(4 - nu).
    #[test]
    fn circle_is_johnsons() {
        for nu in [0.0, 0.25, 0.3, 0.5] {
            for g in [1.0, 1.0 - 1e-9, 1.0 + 1e-9] {
                let [phi, psi] = compliance(g, nu);
                assert!((PI / phi - 16.0 / (4.0 - 3.0 * nu)).abs() < 1e-8);
                assert!((PI / psi - 16.0 / (4.0 - nu)).abs() < 1e-8);
            }
        }
    }

    /// Phi and Psi straight from the half-space: curvature along x of the displacement under an ellipsoidal traction is the integral over
    /// all chords through a point (K. L. Johnson, *Contact Mechanics* (1985), section 3.6).
    #[test]
    fn compliance_is_the_half_spaces() {
        for g in [0.05, 0.3, 0.8, 0.999, 1.0, 1.001, 1.4, 4.0, 20.0] {
            let nu = 0.28;
            let count = 200_000;
            let h = FRAC_PI_2 / f64::from(count);
            let (mut along, mut across) = (0.0, 0.0);
            for i in 0..count {
                let (sin, cos) = (h * (f64::from(i) + 0.5)).sin_cos();
                // in units of b: a = g, b = 1
                let chord = (cos * cos + g * g * sin * sin).powf(1.5);
                let weight = sin * sin / chord * g * g * h;
                along += weight * (1.0 - nu + nu * cos * cos);
                across += weight * (1.0 - nu + nu * sin * sin);
            }
            let [phi, psi] = compliance(g, nu);
            println!("a/b {g}: Phi {phi:.6} quadrature {along:.6}, Psi {psi:.6} {across:.6}");
            assert!((phi / along - 1.0).abs() < 1e-6 && (psi / across - 1.0).abs() < 1e-6);
        }
    }
}
