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
/// Strips are marched side by side, so that the compiler puts them into vector lanes (square root and division included).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fastsim {
    /// Elements along rolling, 2 to 400. Default 10: within some 0.01 mu N of a fine grid at a hundredth of the cost.
    #[serde(default = "ten")]
    pub nx: u16,
    /// Strips across, 2 to 400. Default 10. Multiples of four are cheapest.
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

/// Strips marched side by side.
const LANES: usize = 16;

/// One value per strip.
type Lane = [f64; LANES];

/// Strips side by side. Values lie in memory and the number of strips is not known to the compiler: that is what its loop vectoriser
/// wants (two strips per instruction with SSE2, square root and division included). Strips are padded to a multiple of
/// four with ones of no width.
struct Lanes {
    count: usize,
    /// Half-length a(y)/a.
    half: Lane,
    /// Stress per full step by creepage and longitudinal spin, x and y.
    ax: Lane,
    ay: Lane,
    /// Lateral stress per full step by spin, times x/a(y).
    ey: Lane,
    /// Bound at the middle of the strip.
    limit: Lane,
    /// Stress.
    qx: Lane,
    qy: Lane,
    /// Its sum over the elements so far.
    tx: Lane,
    ty: Lane,
}

/// One step of length `h`, spin taken at `middle`, bound scaled by `parabola`, for `count` strips.
#[inline(never)]
#[allow(clippy::too_many_arguments)] // separate references tell the compiler that nothing overlaps
fn advance(
    count: usize,
    [h, middle, parabola]: [f64; 3],
    ax: &Lane,
    ay: &Lane,
    ey: &Lane,
    limit: &Lane,
    qx: &mut Lane,
    qy: &mut Lane,
    tx: &mut Lane,
    ty: &mut Lane,
) {
    for l in 0..count.min(LANES) {
        let hx = qx[l] - h * ax[l];
        let hy = qy[l] - h * (ay[l] + ey[l] * middle);
        let g = limit[l] * parabola;
        // (g/|p_H|)^2 cut at 1; the tiny number keeps 0/0 out
        let ratio = g * g / (hx * hx + hy * hy + f64::MIN_POSITIVE);
        let scale = (if ratio < 1.0 { ratio } else { 1.0 }).sqrt();
        qx[l] = hx * scale;
        qy[l] = hy * scale;
        tx[l] += hx * scale;
        ty[l] += hy * scale;
    }
}

impl March {
    /// Marches `count` strips from number `first` on, each `width` wide (in half-widths b), and adds their stress sums, weighted by their half-lengths.
    fn strips(&self, first: usize, count: usize, width: f64, sum: &mut [f64; 2]) {
        let zero = [0.0; LANES];
        let mut s = Lanes {
            count: count.next_multiple_of(4),
            half: zero,
            ax: zero,
            ay: zero,
            ey: zero,
            limit: zero,
            qx: zero,
            qy: zero,
            tx: zero,
            ty: zero,
        };
        for l in 0..count.min(LANES) {
            let y = -1.0 + width * ((first + l) as f64 + 0.5);
            let square = 1.0 - y * y;
            s.half[l] = square.sqrt();
            s.ax[l] = s.half[l] * (self.px - self.sx * y);
            s.ay[l] = s.half[l] * self.py;
            s.ey[l] = square * self.sy;
            s.limit[l] = self.bound * square;
        }
        let step = 2.0 / f64::from(self.nx);
        for i in 0..self.nx {
            // x/a(y) at the element's middle, and halfway between it and the middle before (the leading edge for the first)
            let x = 1.0 - step * (f64::from(i) + 0.5);
            let (h, middle) = if i == 0 { (0.5 * step, 1.0 - 0.25 * step) } else { (step, x + 0.5 * step) };
            let here = [h, middle, 1.0 - x * x];
            advance(s.count, here, &s.ax, &s.ay, &s.ey, &s.limit, &mut s.qx, &mut s.qy, &mut s.tx, &mut s.ty);
        }
        for l in 0..count.min(LANES) {
            sum[0] += s.half[l] * s.tx[l];
            sum[1] += s.half[l] * s.ty[l];
        }
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
        let strips = usize::from(self.ny);
        for first in (0..strips).step_by(LANES) {
            march.strips(first, (strips - first).min(LANES), width, &mut sum);
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
        march.strips(0, 10, 0.2, &mut wide);
        for j in 0..10 {
            march.strips(j, 1, 0.2, &mut narrow);
        }
        assert!((wide[0] - narrow[0]).abs() < 1e-13 && (wide[1] - narrow[1]).abs() < 1e-13);
    }
}
