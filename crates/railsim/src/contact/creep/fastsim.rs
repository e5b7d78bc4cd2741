//! FASTSIM, Kalker's simplified theory.

use super::{CreepCase, CreepForce, Creepage, Patch};
use crate::error::{Fault, KeyPath};
use crate::math::widest;
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
/// **Speed.** Strips of one patch or of several are marched side by side in blocks of [`LANES`], so that the compiler puts them into
/// vector lanes; where the processor has AVX2 (found at run time) four to a register, else two. No path fuses a multiplication with an
/// addition and each strip has its own lane: the bytes do not depend on the path, nor on which patches share a block. Every element
/// costs a division and a square root, whose unit is the floor: some 200 ns for 10 x 10 at 2.5 GHz with AVX2. AVX-512 divides no faster,
/// and a root by Newton's iteration without a division is slower.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fastsim {
    /// Elements along rolling, 2 to 400. Default 10: within 0.006 mu N of a fine grid without spin
    /// (0.08 mu N with saturated spin, 0.02 in the mean) at a four-hundredth of the cost of 200 x 200.
    #[serde(default = "ten")]
    pub nx: u16,
    /// Strips across, 2 to 400. Default 10.
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

/// Strips that are marched together: two patches of ten, five registers of four.
const LANES: usize = 20;
/// The same for what is left over: one patch of ten in three registers.
const FEW: usize = 12;

/// What is the same for all strips of a patch.
#[derive(Clone, Copy)]
struct March {
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
    /// An empty lane's: no slip, no stress.
    const NONE: Self = Self { px: 0.0, py: 0.0, sx: 0.0, sy: 0.0, bound: 0.0 };
}

/// Strips side by side, each with its patch's numbers; an empty lane is all zero.
struct Block<const L: usize> {
    /// Relative lateral position y/b of each strip, within -1..1.
    y: [f64; L],
    px: [f64; L],
    py: [f64; L],
    sx: [f64; L],
    sy: [f64; L],
    bound: [f64; L],
    /// Sums of the stress along each strip times its half-length, x and y.
    sum: [[f64; L]; 2],
}

impl<const L: usize> Block<L> {
    const EMPTY: Self = {
        let none = [0.0; L];
        Self { y: none, px: none, py: none, sx: none, sy: none, bound: none, sum: [none; 2] }
    };

    #[inline(always)]
    fn set(&mut self, lane: usize, y: f64, march: &March) {
        self.y[lane] = y;
        self.px[lane] = march.px;
        self.py[lane] = march.py;
        self.sx[lane] = march.sx;
        self.sy[lane] = march.sy;
        self.bound[lane] = march.bound;
    }

    /// Marches every strip from its leading to its trailing edge in `nx` elements.
    #[inline(always)]
    fn march(&mut self, nx: u16) {
        let mut half = [0.0; L]; // a(y)/a
        let mut ax = [0.0; L];
        let mut ay = [0.0; L];
        let mut ey = [0.0; L];
        let mut limit = [0.0; L];
        for l in 0..L {
            let square = 1.0 - self.y[l] * self.y[l];
            half[l] = square.sqrt();
            ax[l] = half[l] * (self.px[l] - self.sx[l] * self.y[l]);
            ay[l] = half[l] * self.py[l];
            ey[l] = square * self.sy[l];
            limit[l] = self.bound[l] * square;
        }
        let step = 2.0 / f64::from(nx);
        let mut qx = [0.0; L];
        let mut qy = [0.0; L];
        let mut tx = [0.0; L];
        let mut ty = [0.0; L];
        for i in 0..nx {
            // x/a(y) at the element's middle, and halfway between it and the middle before (the leading edge for the first)
            let x = 1.0 - step * (f64::from(i) + 0.5);
            let (h, middle) = if i == 0 { (0.5 * step, 1.0 - 0.25 * step) } else { (step, x + 0.5 * step) };
            let parabola = 1.0 - x * x;
            for l in 0..L {
                let px = qx[l] - h * ax[l];
                let py = qy[l] - h * (ay[l] + ey[l] * middle);
                let g = limit[l] * parabola;
                // g/|p_H|, cut at 1; the tiny number keeps 0/0 out. No branch around it: to skip the division where every strip
                // sticks was tried, and costs more in broken-up loops than it saves.
                let ratio = g * g / (px * px + py * py + f64::MIN_POSITIVE);
                let scale = if ratio < 1.0 { ratio.sqrt() } else { 1.0 };
                qx[l] = px * scale;
                qy[l] = py * scale;
                tx[l] += qx[l];
                ty[l] += qy[l];
            }
        }
        for l in 0..L {
            self.sum[0][l] = half[l] * tx[l];
            self.sum[1][l] = half[l] * ty[l];
        }
    }

    /// The same with the widest instructions there are.
    fn march_best(&mut self, nx: u16) {
        widest::run(&mut Marching { block: self, nx });
    }
}

/// A block to be marched.
struct Marching<'a, const L: usize> {
    block: &'a mut Block<L>,
    nx: u16,
}

impl<const L: usize> widest::Work for Marching<'_, L> {
    #[inline(always)]
    fn run(&mut self) {
        self.block.march(self.nx);
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

/// What is the same for all patches on one grid.
struct Grid {
    /// Width of a strip over b.
    width: f64,
    /// Element area over a a(y)/a b: (2/nx) (2/ny).
    area: f64,
    /// L1, L2: 3/8 over the excess of the midpoint sums across.
    creepage: f64,
    /// L3: 4/pi over the excess of both sums.
    spin: f64,
    /// Bound: 2/pi over the excess of both sums.
    bound: f64,
}

impl Grid {
    fn new(law: &Fastsim) -> Self {
        let (nx, ny) = (f64::from(law.nx), f64::from(law.ny));
        // excess of midpoint sums over integrals, in closed form where there is one
        let along = 1.0 + 0.5 / (nx * nx);
        let across = 1.0 + 0.5 / (ny * ny);
        let both = along * ellipsoid_excess(law.ny);
        Self {
            width: 2.0 / ny,
            area: 4.0 / (nx * ny),
            creepage: 3.0 / (8.0 * across),
            spin: 4.0 / (PI * both),
            bound: 2.0 / (PI * both),
        }
    }

    /// Stress increments a/L1 xi, a/L2 eta, a b/L3 phi (of y/b) and a a/L3 phi (of x/a), and the bound.
    #[inline]
    fn march(&self, case: &CreepCase) -> March {
        let (p, creepage) = (&case.patch, &case.creepage);
        let flexible = self.creepage * p.shear_modulus;
        let c = (p.a * p.b).sqrt();
        let spin = self.spin * p.shear_modulus * p.c23 * creepage.phi;
        March {
            px: flexible * p.c11 * creepage.xi,
            py: flexible * p.c22 * creepage.eta,
            sx: spin * p.b * p.b / c,
            sy: spin * c,
            bound: self.bound * case.mu * p.n / (c * c),
        }
    }
}

/// The strips of several patches, one after the other.
struct Strips<'a> {
    grid: &'a Grid,
    cases: &'a [CreepCase],
    /// Strips of a patch.
    each: usize,
    /// Strips that are not marched yet.
    left: usize,
    /// The next one: of which case, which of its strips.
    case: usize,
    strip: usize,
    march: March,
}

impl<'a> Strips<'a> {
    fn new(grid: &'a Grid, cases: &'a [CreepCase], each: usize) -> Self {
        let march = cases.first().map_or(March::NONE, |c| grid.march(c));
        Self { grid, cases, each, left: each * cases.len(), case: 0, strip: 0, march }
    }

    /// Marches the next `L` strips, or what is left, and adds their sums to the forces of their patches, in the order of the strips.
    fn block<const L: usize>(&mut self, nx: u16, forces: &mut [CreepForce]) {
        let mut block = Block::<L>::EMPTY;
        let (mut case, mut strip) = (self.case, self.strip);
        let filled = L.min(self.left);
        for l in 0..filled {
            block.set(l, -1.0 + self.grid.width * (self.strip as f64 + 0.5), &self.march);
            self.strip += 1;
            if self.strip == self.each {
                (self.case, self.strip) = (self.case + 1, 0);
                self.march = self.cases.get(self.case).map_or(March::NONE, |c| self.grid.march(c));
            }
        }
        self.left -= filled;
        block.march_best(nx);
        for l in 0..filled {
            forces[case].fx += block.sum[0][l];
            forces[case].fy += block.sum[1][l];
            strip += 1;
            if strip == self.each {
                (case, strip) = (case + 1, 0);
            }
        }
    }
}

impl Fastsim {
    /// Force on the wheel of one patch.
    #[must_use]
    pub fn force(&self, p: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
        let mut force = [CreepForce::default()];
        self.forces(&[CreepCase { patch: *p, creepage: *creepage, mu }], &mut force);
        force[0]
    }

    /// Forces on the wheel of several patches: cheaper than one by one, and the same to the bit.
    ///
    /// # Panics
    /// Where `cases` and `forces` differ in length.
    pub fn forces(&self, cases: &[CreepCase], forces: &mut [CreepForce]) {
        assert_eq!(cases.len(), forces.len(), "one force per case");
        let grid = Grid::new(self);
        forces.fill(CreepForce::default());
        let mut strips = Strips::new(&grid, cases, usize::from(self.ny));
        while strips.left > FEW {
            strips.block::<LANES>(self.nx, forces);
        }
        if strips.left > 0 {
            strips.block::<FEW>(self.nx, forces);
        }
        for (force, case) in forces.iter_mut().zip(cases) {
            let area = grid.area * case.patch.a * case.patch.b;
            force.fx *= area;
            force.fy *= area;
        }
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

    fn cases() -> Vec<CreepCase> {
        (0..7)
            .map(|k| {
                let f = f64::from(k);
                CreepCase {
                    patch: Patch {
                        a: 6e-3 + 4e-4 * f,
                        b: 5e-3,
                        n: 2e4 * (f + 1.0),
                        c11: 4.5,
                        c22: 4.2,
                        c23: 1.9,
                        shear_modulus: 82e9,
                    },
                    creepage: Creepage { xi: 1e-3 * (f - 3.0), eta: 4e-4 * f, phi: 0.2 * f },
                    mu: 0.3,
                }
            })
            .collect()
    }

    /// Lanes are only a way of computing: which patches share a block changes no bit, whatever the grid.
    #[test]
    fn patches_together_are_patches_one_by_one() {
        let cases = cases();
        for law in [Fastsim::default(), Fastsim { nx: 7, ny: 5 }, Fastsim { nx: 9, ny: 33 }] {
            for count in 0..=cases.len() {
                let mut forces = vec![CreepForce::default(); count];
                law.forces(&cases[..count], &mut forces);
                for (force, c) in forces.iter().zip(&cases) {
                    assert_eq!(*force, law.force(&c.patch, &c.creepage, c.mu));
                }
            }
        }
    }

    /// The path for this processor's best instructions and the one for any: the same bits.
    #[test]
    fn the_path_changes_no_bit() {
        let grid = Grid::new(&Fastsim::default());
        for (k, case) in cases().iter().enumerate() {
            let (mut best, mut any) = (Block::<LANES>::EMPTY, Block::<LANES>::EMPTY);
            for l in 0..LANES {
                let y = -0.95 + 0.097 * l as f64;
                best.set(l, y, &grid.march(case));
                any.set(l, y, &grid.march(case));
            }
            best.march_best(10);
            any.march(10);
            assert_eq!(best.sum, any.sum, "case {k}");
        }
    }
}
