//! The march of FASTSIM along one strip, element by element, for what needs the stresses themselves: their moment, and the
//! direction of sliding in FaStrip. The force alone is [`super::Fastsim`]'s, which is laid out for speed.

use super::{Creepage, Patch};
use std::f64::consts::PI;

/// FASTSIM on one patch: creepages over flexibilities, and the bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strips {
    a: f64,
    b: f64,
    /// xi/L1, eta/L2, phi/L3: stress per metre (and per metre squared for spin), Pa/m.
    rate: [f64; 3],
    /// mu p_z at the centre of the patch, Pa.
    bound: f64,
    /// Hertz's pressure for p_z, an ellipsoid; otherwise Kalker's paraboloid.
    hertz: bool,
}

impl Strips {
    /// As [`super::Fastsim`]: three flexibilities, parabolic bound.
    pub(super) fn three_flexibilities(p: &Patch, c: &Creepage, mu: f64) -> Self {
        let [l1, l2, l3] = flexibilities(p);
        Self {
            a: p.a,
            b: p.b,
            rate: [c.xi / l1, c.eta / l2, c.phi / l3],
            bound: 2.0 * mu * p.n / (PI * p.a * p.b),
            hertz: false,
        }
    }

    /// One flexibility for all creepages, their mean weighted by them (Kalker 1990), so that where everything slides the
    /// stress opposes the slip; Hertz's pressure under the normal force `n` for a bound.
    pub(super) fn one_flexibility(p: &Patch, creepage: &Creepage, mu: f64, n: f64) -> Self {
        let [l1, l2, l3] = flexibilities(p);
        let c = (p.a * p.b).sqrt();
        let (xi, eta, phi) = (creepage.xi.abs(), creepage.eta.abs(), c * creepage.phi.abs());
        let weight = (xi * l1 + eta * l2 + phi * l3) / (xi * xi + eta * eta + phi * phi).sqrt();
        let stiffness = if weight > 0.0 { 1.0 / weight } else { 0.0 };
        Self {
            a: p.a,
            b: p.b,
            rate: [creepage.xi, creepage.eta, creepage.phi].map(|c| c * stiffness),
            bound: 1.5 * mu * n / (PI * p.a * p.b),
            hertz: true,
        }
    }

    /// Marches the strip at `y` = `relative` times b in `count` elements from the leading edge; calls `element` with the
    /// middle of each, x over the strip's half-length a(y), and the stress there, Pa.
    #[inline]
    pub(super) fn march(&self, relative: f64, count: u16, mut element: impl FnMut(f64, [f64; 2])) {
        let square = 1.0 - relative * relative;
        let half = self.a * square.max(0.0).sqrt();
        let [rx, ry, spin] = self.rate;
        let across = rx - spin * relative * self.b;
        let step = 2.0 / f64::from(count);
        let mut q = [0.0; 2];
        let mut before = 1.0; // leading edge, then the middle of the element before
        for i in 0..count {
            let x = 1.0 - step * (f64::from(i) + 0.5);
            let (h, middle) = (half * (before - x), 0.5 * half * (before + x));
            q[0] -= h * across;
            q[1] -= h * (ry + spin * middle);
            let shape = square * (1.0 - x * x);
            let limit = self.bound * if self.hertz { shape.max(0.0).sqrt() } else { shape };
            let size = q[0].hypot(q[1]);
            if size > limit {
                q = q.map(|q| q * (limit / size));
            }
            element(x, q);
            before = x;
        }
    }
}

/// L1, L2, L3 from Kalker's coefficients, m/Pa (L3 per metre of the patch).
fn flexibilities(p: &Patch) -> [f64; 3] {
    let g = p.shear_modulus;
    let translation = 8.0 * p.a / (3.0 * g);
    [translation / p.c11, translation / p.c22, PI * p.a * (p.a / p.b).sqrt() / (4.0 * g * p.c23)]
}

/// Spin moment of FASTSIM's stresses about the normal through the centre of the patch, N m: sum of x p_y - y p_x over `ny` strips,
/// spaced in the angle, of `nx` elements.
pub(super) fn moment(nx: u16, ny: u16, p: &Patch, creepage: &Creepage, mu: f64) -> f64 {
    let strips = Strips::three_flexibilities(p, creepage, mu);
    let mut sum = 0.0;
    for j in 0..ny {
        let (relative, width) = spaced(j, ny);
        let half = p.a * (1.0 - relative * relative).sqrt();
        let area = p.b * width * 2.0 * half / f64::from(nx);
        strips.march(relative, nx, |x, q| sum += area * (half * x * q[1] - p.b * relative * q[0]));
    }
    sum
}

/// Strips spaced evenly in the angle t of y = cos(t): relative y of the middle and relative width. Sums over them of powers of
/// sqrt(1 - y^2), which make up the force, are exact or nearly so at few strips.
#[inline]
pub(super) fn spaced(j: u16, count: u16) -> (f64, f64) {
    let width = PI / f64::from(count);
    let (sin, cos) = (width * (f64::from(j) + 0.5)).sin_cos();
    (cos, sin * width)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spaced_strips_sum_areas_and_loads() {
        for count in [5, 10, 50] {
            let sum = |f: fn(f64) -> f64| -> f64 {
                (0..count).map(|j| spaced(j, count)).map(|(y, w)| w * f(1.0 - y * y)).sum()
            };
            assert!((sum(f64::sqrt) / (PI / 2.0) - 1.0).abs() < 1e-13);
            assert!((sum(|s| s) / (4.0 / 3.0) - 1.0).abs() < 2e-3);
            assert!((sum(|s| s * s.sqrt()) / (3.0 * PI / 8.0) - 1.0).abs() < 1e-13);
        }
    }
}
