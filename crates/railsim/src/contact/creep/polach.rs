//! Polach's formula.

use super::{CreepCase, CreepForce, Creepage, Patch};
use crate::error::{Fault, KeyPath};
use crate::math::elementary::{arctan, decay};
use crate::math::widest;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Polach's closed formula with reduction factors for adhesion (`k_a`) and slip (`k_s`).
///
/// Without spin (O. Polach, Wear 258 (2005) 992, eqs. 2-4; sx = xi, sy = eta, s = sqrt(sx^2 + sy^2), Q the normal force):
///
/// - eps = G pi a b c_jj s/(4 Q mu), c_jj = sqrt((C11 sx/s)^2 + (C22 sy/s)^2),
/// - F = (2 Q mu/pi) (k_a eps/(1 + (k_a eps)^2) + atan(k_s eps)).
///
/// With spin (O. Polach, Vehicle System Dynamics Suppl. 33 (1999) 728; omega = phi in 1/m):
///
/// - s_yC = sy + omega a if that is greater in magnitude than sy, else sy; s_C = sqrt(sx^2 + s_yC^2) stands for s in eps,
/// - K = 1 + 6.3 (1 - exp(-a/b)), eps_M = (8/3) b sqrt(a b) G C23 |s_yC|/(K Q mu), d = (eps_M^2 - 1)/(eps_M^2 + 1),
/// - F_yS = (9/16) a Q mu K (eps_M (-d^3/3 + d^2/2 - 1/6) + (1 - d^2)^1.5/3),
/// - Fx = -F sx/s_C, Fy = -(F sy + F_yS omega)/s_C.
///
/// `k_a` = `k_s` = 1 is the formula of 1999. The slope at zero is (k_a + k_s)/2 of Kalker's; the spin term alone does not reach Kalker's C23
/// (the method's own error). Its error against the exact theory is up to some 0.04 mu Q without spin. The vector is cut
/// at mu Q, which the spin term can otherwise exceed. The coefficient of friction at the slip velocity
/// mu0 ((1 - A) exp(-B w) + A) is the caller's: `mu` is what holds at this contact now.
///
/// **Speed.** Patches are worked out four at a time in vector lanes where the processor has AVX2, the rest and a single one alone; the same operations in
/// the same order, so that the bytes depend on neither. Arctangent and exponential are our own ([`crate::math::elementary`]).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Polach {
    /// Reduction factor in the area of adhesion, 0 < k_s <= k_a <= 1. Default 1: clean and dry, the formula of 1999.
    #[serde(default = "one")]
    pub k_a: f64,
    /// Reduction factor in the area of slip. Default 1.
    #[serde(default = "one")]
    pub k_s: f64,
}

fn one() -> f64 {
    1.0
}

impl Default for Polach {
    fn default() -> Self {
        Self { k_a: one(), k_s: one() }
    }
}

impl Polach {
    /// Force on the wheel of one patch.
    #[must_use]
    pub fn force(&self, p: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
        let mut one = One { law: self, patch: p, creepage, mu, force: CreepForce::default() };
        widest::run(&mut one);
        one.force
    }

    /// Forces on the wheel of several patches: cheaper than one by one, and the same to the bit.
    ///
    /// # Panics
    /// Where `cases` and `forces` differ in length.
    pub fn forces(&self, cases: &[CreepCase], forces: &mut [CreepForce]) {
        assert_eq!(cases.len(), forces.len(), "one force per case");
        widest::run(&mut Several { law: self, cases, forces });
    }

    /// The formula, in an order in which what waits for a division or a root has other work beside it.
    #[inline(always)]
    fn formula(&self, p: &Patch, c: &Creepage, mu: f64) -> CreepForce {
        let (sx, sy, limit) = (c.xi, c.eta, mu * p.n);
        let turn = c.phi * p.a;
        let (sx2, sy2, spun2) = (sx * sx, sy * sy, (sy + turn) * (sy + turn));
        let syc2 = if spun2 > sy2 { spun2 } else { sy2 };
        let (square, sc2) = (sx2 + sy2, sx2 + syc2);
        // (c_jj s_C)^2; where spin alone slides, c_jj is C22
        let (along, across) = (p.c11 * sx, p.c22 * sy);
        let stretched = if square > 0.0 {
            (along * along + across * across) * (sc2 / square)
        } else {
            p.c22 * p.c22 * sc2
        };
        let over_sc = if sc2 > 0.0 { 1.0 / sc2.sqrt() } else { 0.0 };
        let stiff = p.shear_modulus * p.b;
        let spin = turn * over_sc * spin(p, stiff, syc2, limit);
        // Q mu eps
        let linear = 0.25 * PI * p.a * stiff * stretched.sqrt();
        let adhesion = self.k_a * linear;
        let held = adhesion * limit / (limit * limit + adhesion * adhesion);
        let force = 2.0 / PI * limit * (held + arctan(self.k_s * linear, limit));
        let (fx, fy) = (-force * (sx * over_sc), -(force * (sy * over_sc) + spin));
        let size = fx * fx + fy * fy;
        let cut = if size > limit * limit { limit / size.sqrt() } else { 1.0 };
        if limit > 0.0 { CreepForce { fx: cut * fx, fy: cut * fy } } else { CreepForce::default() }
    }

    /// Slope at zero creepage as a fraction of Kalker's.
    #[must_use]
    pub fn reduction(&self) -> f64 {
        0.5 * (self.k_a + self.k_s)
    }

    /// Faults in the parameters.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (key, value) in [("k_a", self.k_a), ("k_s", self.k_s)] {
            if !(value > 0.0 && value <= 1.0) {
                faults.push(Fault::new(at.key(key), value.to_string(), "greater than 0, at most 1"));
            }
        }
        if faults.is_empty() && self.k_s > self.k_a {
            faults.push(Fault::new(
                at.key("k_s"),
                self.k_s.to_string(),
                format!("at most k_a = {}", self.k_a),
            ));
        }
        faults
    }

    /// Laws for the contract suite: the formula of 1999 and a wet rail.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self::default(), Self { k_a: 0.29, k_s: 0.09 }]
    }
}

/// F_yS/a, N: what spin adds to the lateral force, times s_C/(omega a). `stiff` is G b, `syc2` s_yC^2, `limit` Q mu.
///
/// With e = K Q mu eps_M and k = K Q mu, so that nothing is divided by a small Q mu; 1 - d is 2 u, and the polynomial of d, whose terms cancel
/// where d is near 1, is -(2/3) u^2 (3 - 4 u). (1 - d^2)^1.5 is the cube of 2 e k/(e^2 + k^2).
#[inline(always)]
fn spin(p: &Patch, stiff: f64, syc2: f64, limit: f64) -> f64 {
    let k = limit * (7.3 - 6.3 * decay(p.a / p.b));
    let e = 8.0 / 3.0 * p.c23 * stiff * (p.a * p.b * syc2).sqrt();
    let k2 = k * k;
    let inverse = 1.0 / (e * e + k2);
    let (u, root) = (k2 * inverse, e * k * inverse);
    1.5 * (k * root) * (root * root) - (e * u) * (u * (9.0 / 8.0 - 1.5 * u))
}

/// One patch.
struct One<'a> {
    law: &'a Polach,
    patch: &'a Patch,
    creepage: &'a Creepage,
    mu: f64,
    force: CreepForce,
}

impl widest::Work for One<'_> {
    #[inline(always)]
    fn run(&mut self) {
        self.force = self.law.formula(self.patch, self.creepage, self.mu);
    }
}

/// Patches that are worked out side by side: one register of AVX2.
const LANES: usize = 4;

/// Several patches.
struct Several<'a> {
    law: &'a Polach,
    cases: &'a [CreepCase],
    forces: &'a mut [CreepForce],
}

impl widest::Work for Several<'_> {
    #[inline(always)]
    fn run(&mut self) {
        let (fours, rest) = self.cases.as_chunks::<LANES>();
        let (of_fours, of_rest) = self.forces.as_chunks_mut::<LANES>();
        for (cases, forces) in fours.iter().zip(of_fours) {
            lanes(self.law, cases, forces);
        }
        for (case, force) in rest.iter().zip(of_rest) {
            *force = self.law.formula(&case.patch, &case.creepage, case.mu);
        }
    }
}

/// Each number of all patches side by side, so that the compiler puts patches into vector lanes.
#[inline(always)]
fn lanes(law: &Polach, cases: &[CreepCase; LANES], forces: &mut [CreepForce; LANES]) {
    let of = |number: fn(&CreepCase) -> f64| -> [f64; LANES] { std::array::from_fn(|l| number(&cases[l])) };
    let (a, b, n) = (of(|c| c.patch.a), of(|c| c.patch.b), of(|c| c.patch.n));
    let (c11, c22, c23) = (of(|c| c.patch.c11), of(|c| c.patch.c22), of(|c| c.patch.c23));
    let modulus = of(|c| c.patch.shear_modulus);
    let (xi, eta, phi) = (of(|c| c.creepage.xi), of(|c| c.creepage.eta), of(|c| c.creepage.phi));
    let mu = of(|c| c.mu);
    let (mut fx, mut fy) = ([0.0; LANES], [0.0; LANES]);
    for l in 0..LANES {
        let patch = Patch {
            a: a[l],
            b: b[l],
            n: n[l],
            c11: c11[l],
            c22: c22[l],
            c23: c23[l],
            shear_modulus: modulus[l],
        };
        let force = law.formula(&patch, &Creepage { xi: xi[l], eta: eta[l], phi: phi[l] }, mu[l]);
        (fx[l], fy[l]) = (force.fx, force.fy);
    }
    for l in 0..LANES {
        forces[l] = CreepForce { fx: fx[l], fy: fy[l] };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eqs. as printed, with the library's functions; and the size of what cancels in the bracket of F_yS, N.
    fn as_printed(law: &Polach, p: &Patch, c: &Creepage, mu: f64) -> ([f64; 2], f64) {
        let q = p.n * mu;
        let with_spin = c.eta + c.phi * p.a;
        let syc = if with_spin.abs() > c.eta.abs() { with_spin } else { c.eta };
        let (s, sc) = (c.xi.hypot(c.eta), c.xi.hypot(syc));
        if sc == 0.0 {
            return ([0.0; 2], 0.0);
        }
        let cjj = if s > 0.0 { (p.c11 * c.xi / s).hypot(p.c22 * c.eta / s) } else { p.c22 };
        let eps = p.shear_modulus * PI * p.a * p.b * cjj * sc / (4.0 * q);
        let f = 2.0 * q / PI * (law.k_a * eps / (1.0 + (law.k_a * eps).powi(2)) + (law.k_s * eps).atan());
        let k = 1.0 + 6.3 * (1.0 - (-p.a / p.b).exp());
        let m = 8.0 / 3.0 * p.b * (p.a * p.b).sqrt() * p.shear_modulus * p.c23 * syc.abs() / (k * q);
        let d = (m * m - 1.0) / (m * m + 1.0);
        let bracket = m * (-d.powi(3) / 3.0 + d * d / 2.0 - 1.0 / 6.0) + (1.0 - d * d).powf(1.5) / 3.0;
        let fys = 9.0 / 16.0 * p.a * q * k * bracket;
        let (fx, fy) = (-f * c.xi / sc, -(f * c.eta + fys * c.phi) / sc);
        let cut = (q / fx.hypot(fy)).min(1.0);
        ([cut * fx, cut * fy], 9.0 / 16.0 * p.a * q * k * m * (c.phi / sc).abs())
    }

    /// Patches and creepages from adhesion to full slip, with and without spin, thin and wide patches.
    fn cases() -> Vec<CreepCase> {
        let mut cases = Vec::new();
        for (a, b) in [(6.5e-3, 5e-3), (2e-3, 9e-3), (9e-3, 8e-4)] {
            for n in [1e3, 1e5] {
                for size in [0.0, 1e-6, 1e-4, 1e-3, 1e-2, 0.3] {
                    for (x, y) in [(1.0, 0.0), (0.6, -0.8), (0.0, 1.0), (-0.8, 0.6)] {
                        for phi in [0.0, 0.2, -3.0] {
                            cases.push(CreepCase {
                                patch: Patch { a, b, n, c11: 4.5, c22: 4.2, c23: 1.9, shear_modulus: 82e9 },
                                creepage: Creepage { xi: size * x, eta: size * y, phi },
                                mu: 0.4,
                            });
                        }
                    }
                }
            }
        }
        cases
    }

    /// What is brought together for speed is the printed formula to ten roundings of mu Q and of the terms that cancel in the printed one.
    #[test]
    fn the_formula_as_printed() {
        let mut worst = 0.0_f64;
        for law in Polach::examples() {
            for c in cases() {
                let ours = law.force(&c.patch, &c.creepage, c.mu);
                let ([fx, fy], cancelling) = as_printed(&law, &c.patch, &c.creepage, c.mu);
                let rounding = f64::EPSILON * (c.mu * c.patch.n + cancelling);
                worst = worst.max((ours.fx - fx).hypot(ours.fy - fy) / rounding);
            }
        }
        println!("largest difference to the printed formula: {worst:.1} roundings");
        assert!(worst < 10.0);
    }

    /// Lanes and instructions are only a way of computing: neither changes a bit.
    #[test]
    fn neither_lanes_nor_the_path_change_a_bit() {
        let cases = cases();
        for law in Polach::examples() {
            for count in [0, 1, 3, 4, 7, cases.len()] {
                let mut forces = vec![CreepForce::default(); count];
                law.forces(&cases[..count], &mut forces);
                let mut plain = vec![CreepForce::default(); count];
                widest::Work::run(&mut Several { law: &law, cases: &cases[..count], forces: &mut plain });
                assert_eq!(forces, plain);
                for (force, c) in forces.iter().zip(&cases) {
                    assert_eq!(*force, law.force(&c.patch, &c.creepage, c.mu));
                    assert_eq!(*force, law.formula(&c.patch, &c.creepage, c.mu));
                }
            }
        }
    }
}
