//! FASTSIM, Kalker's simplified theory.

use super::{CreepForce, Creepage, Patch};
use crate::error::{Fault, KeyPath};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// FASTSIM (J. J. Kalker, Vehicle System Dynamics 11 (1982) 1-13): surface stress proportional to surface displacement,
/// marched from the leading to the trailing edge of each of `ny` strips in `nx` steps.
///
/// Flexibilities (three, so that each creepage has Kalker's linear slope; a, b semi-axes (m), G shear modulus (Pa)):
/// L1 = 8 a/(3 G C11), L2 = 8 a/(3 G C22), L3 = pi a sqrt(a/b)/(4 G C23).
/// March, from x = +a(y) with step dx: p_H = p - dx (xi/L1 - phi y/L3, eta/L2 + phi x/L3); where |p_H| exceeds mu p_z the
/// element slips and p = p_H mu p_z/|p_H|. Bound: Kalker's parabola p_z = 2N/(pi a b) (1 - (x/a)^2 - (y/b)^2).
///
/// **Grid.** Strips of equal width, elements of equal length on each strip, stress at the middle of the element (first step half
/// a step). What the midpoint sums of such a grid miss is known in closed form, and is taken out: L1, L2 by the
/// sum of a(y)^2, L3 and p_z by the sum of (1 - x^2 - y^2). So at every grid the slopes at zero creepage are
/// Kalker's own, and the force in full slip is mu N in pure translation and never more. The factors are 1.005 and some 1.006 on the default
/// grid of 10 x 10 and tend to 1.
///
/// The method itself differs from the exact theory by 0.01-0.02 mu N in the mean and up to some 0.1 mu N in combined
/// creepage with large spin (`CONTACT`, Hertzian, a/b = 1).
///
/// Strips are marched side by side in fixed-size arrays, so that the compiler puts them into vector lanes at opt-level 3 (square root and
/// division included); at 2 they still overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fastsim {
    /// Elements along rolling, 2 to 400. Default 10: within 0.006 mu N of a fine grid without spin
    /// (0.08 mu N with saturated spin, 0.02 in the mean) at a four-hundredth of the cost of 200 x 200.
    #[serde(default = "ten")]
    pub nx: u16,
    /// Strips across, 2 to 400. Default 10. Multiples of ten are cheapest, then even numbers.
    #[serde(default = "ten")]
    pub ny: u16,
}

fn ten() -> u16 {
    10
}

impl Default for Fastsim {
    fn default() -> Self {
        Self { nx: ten(), ny: ten() }
    }
}

/// What is the same for all strips of a patch.
struct March {
    nx: u16,
    /// Stress added per full step of relative length (times a(y)/a), Pa, x and y: creepage part.
    px: f64,
    py: f64,
    /// The same for spin: times y/b, and times x/a.
    sx: f64,
    sy: f64,
    /// Bound mu p_z at the centre, Pa.
    bound: f64,
}

impl March {
    /// Marches `LANES` strips at relative lateral positions `y` (|y| < 1) and adds their stress sums, weighted by their half-lengths.
    #[inline(always)]
    fn strips<const LANES: usize>(&self, y: &[f64; LANES], sum: &mut [f64; 2]) {
        let mut half = [0.0; LANES]; // a(y)/a
        let mut ax = [0.0; LANES];
        let mut ay = [0.0; LANES];
        let mut ey = [0.0; LANES];
        let mut limit = [0.0; LANES];
        for l in 0..LANES {
            let square = 1.0 - y[l] * y[l];
            half[l] = square.sqrt();
            ax[l] = half[l] * (self.px - self.sx * y[l]);
            ay[l] = half[l] * self.py;
            ey[l] = square * self.sy;
            limit[l] = self.bound * square;
        }
        let step = 2.0 / f64::from(self.nx);
        let mut qx = [0.0; LANES];
        let mut qy = [0.0; LANES];
        let mut tx = [0.0; LANES];
        let mut ty = [0.0; LANES];
        for i in 0..self.nx {
            // x/a(y) at the element's middle, and halfway between it and the middle before (the leading edge for the first)
            let x = 1.0 - step * (f64::from(i) + 0.5);
            let (h, middle) = if i == 0 { (0.5 * step, 1.0 - 0.25 * step) } else { (step, x + 0.5 * step) };
            let parabola = 1.0 - x * x;
            let mut square = [0.0; LANES];
            let mut limit_square = [0.0; LANES];
            let mut slides = false;
            for l in 0..LANES {
                qx[l] -= h * ax[l];
                qy[l] -= h * (ay[l] + ey[l] * middle);
                let g = limit[l] * parabola;
                limit_square[l] = g * g;
                square[l] = qx[l] * qx[l] + qy[l] * qy[l];
                slides |= square[l] > limit_square[l];
            }
            // Where every strip still sticks the factor is 1 in all of them: division and root are most of the cost.
            if slides {
                for l in 0..LANES {
                    // g/|p_H|, cut at 1; the tiny number keeps 0/0 out
                    let scale = (limit_square[l] / (square[l] + f64::MIN_POSITIVE)).min(1.0).sqrt();
                    qx[l] *= scale;
                    qy[l] *= scale;
                }
            }
            for l in 0..LANES {
                tx[l] += qx[l];
                ty[l] += qy[l];
            }
        }
        for l in 0..LANES {
            sum[0] += half[l] * tx[l];
            sum[1] += half[l] * ty[l];
        }
    }

    fn lanes<const LANES: usize>(&self, first: usize, width: f64, sum: &mut [f64; 2]) {
        let mut y = [0.0; LANES];
        for (l, y) in y.iter_mut().enumerate() {
            *y = -1.0 + width * ((first + l) as f64 + 0.5);
        }
        self.strips(&y, sum);
    }
}

/// Midpoint sum of (1 - y^2)^1.5 over -1..1 in n cells, over its integral 3 pi/8.
fn ellipsoid_excess(n: u16) -> f64 {
    let width = 2.0 / f64::from(n);
    let mut sum = 0.0;
    // both halves are equal
    for j in 0..n / 2 {
        let y = 1.0 - width * (f64::from(j) + 0.5);
        let square = 1.0 - y * y;
        sum += 2.0 * square * square.sqrt();
    }
    if n % 2 == 1 {
        sum += 1.0;
    }
    sum * width * 8.0 / (3.0 * PI)
}

impl Fastsim {
    /// Force on the wheel.
    #[must_use]
    pub fn force(&self, p: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
        let (nx, ny) = (f64::from(self.nx), f64::from(self.ny));
        // excess of midpoint sums over integrals, in closed form where there is one
        let along = 1.0 + 0.5 / (nx * nx);
        let across = 1.0 + 0.5 / (ny * ny);
        let both = along * ellipsoid_excess(self.ny);
        // 1/L1, 1/L2, 1/L3 with the excess taken out
        let flexible = 3.0 * p.shear_modulus / (8.0 * p.a * across);
        let (l1, l2) = (flexible * p.c11, flexible * p.c22);
        let l3 = 4.0 * p.shear_modulus * p.c23 / (PI * p.a * (p.a / p.b).sqrt() * both);
        let march = March {
            nx: self.nx,
            px: p.a * creepage.xi * l1,
            py: p.a * creepage.eta * l2,
            sx: p.a * p.b * creepage.phi * l3,
            sy: p.a * p.a * creepage.phi * l3,
            bound: mu * 2.0 * p.n / (PI * p.a * p.b * both),
        };
        let width = 2.0 / ny;
        let mut sum = [0.0; 2];
        let (mut j, strips) = (0, usize::from(self.ny));
        while strips - j >= 10 {
            march.lanes::<10>(j, width, &mut sum);
            j += 10;
        }
        while strips - j >= 4 {
            march.lanes::<4>(j, width, &mut sum);
            j += 4;
        }
        while strips - j >= 2 {
            march.lanes::<2>(j, width, &mut sum);
            j += 2;
        }
        if strips > j {
            march.lanes::<1>(j, width, &mut sum);
        }
        // element area: (2 a(y)/nx) (2 b/ny)
        let area = 4.0 * p.a * p.b / (nx * ny);
        CreepForce { fx: area * sum[0], fy: area * sum[1] }
    }

    /// Faults in the parameters.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        [("nx", self.nx), ("ny", self.ny)]
            .into_iter()
            .filter(|(_, value)| !(2..=400).contains(value))
            .map(|(key, value)| Fault::new(at.key(key), value.to_string(), "2 to 400"))
            .collect()
    }

    /// Laws for the contract suite: the default, a fine grid, an odd and coarse one.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self::default(), Self { nx: 50, ny: 50 }, Self { nx: 7, ny: 5 }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excess_of_the_midpoint_sums_tends_to_one() {
        assert!((ellipsoid_excess(400) - 1.0).abs() < 1e-5);
        assert!((ellipsoid_excess(10) - 1.0).abs() < 0.01);
        assert!((ellipsoid_excess(5) - 1.0).abs() < 0.03);
    }

    /// Lanes are only a way of computing: any grouping of the strips gives the same sums to rounding.
    #[test]
    fn grouping_of_strips_changes_nothing() {
        let march = March { nx: 10, px: 1.0, py: 0.7, sx: 0.4, sy: 0.5, bound: 0.8 };
        let (mut wide, mut narrow) = ([0.0; 2], [0.0; 2]);
        march.lanes::<10>(0, 0.2, &mut wide);
        for j in 0..10 {
            march.lanes::<1>(j, 0.2, &mut narrow);
        }
        assert!((wide[0] - narrow[0]).abs() < 1e-13 && (wide[1] - narrow[1]).abs() < 1e-13);
    }
}
