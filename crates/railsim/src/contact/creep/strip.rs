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
}

impl Strips {
    /// Flexibilities from Kalker's coefficients (as in [`super::Fastsim`]); parabolic bound under the normal force `n`.
    pub(super) fn new(p: &Patch, c: &Creepage, mu: f64, n: f64) -> Self {
        let g = p.shear_modulus;
        let (l1, l2) = (3.0 * g * p.c11 / (8.0 * p.a), 3.0 * g * p.c22 / (8.0 * p.a));
        let l3 = 4.0 * g * p.c23 / (PI * p.a * (p.a / p.b).sqrt());
        Self {
            a: p.a,
            b: p.b,
            rate: [c.xi * l1, c.eta * l2, c.phi * l3],
            bound: 2.0 * mu * n / (PI * p.a * p.b),
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
            let limit = self.bound * square * (1.0 - x * x);
            let size = q[0].hypot(q[1]);
            if size > limit {
                q = q.map(|q| q * (limit / size));
            }
            element(x, q);
            before = x;
        }
    }
}

/// Spin moment of FASTSIM's stresses about the normal through the centre of the patch, N m: sum of x p_y - y p_x over `ny` strips,
/// spaced in the angle, of `nx` elements.
pub(super) fn moment(nx: u16, ny: u16, p: &Patch, creepage: &Creepage, mu: f64) -> f64 {
    let strips = Strips::new(p, creepage, mu, p.n);
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
