//! Polach's formula.

use super::{CreepForce, Creepage, Patch};
use crate::error::{Fault, KeyPath};
use crate::math::arctan::arctan;
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
    /// Force on the wheel.
    #[must_use]
    pub fn force(&self, p: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
        let (sx, sy, omega) = (creepage.xi, creepage.eta, creepage.phi);
        let limit = mu * p.n;
        if limit <= 0.0 {
            return CreepForce::default();
        }
        let with_spin = sy + omega * p.a;
        let syc = if with_spin.abs() > sy.abs() { with_spin } else { sy };
        let sc2 = sx * sx + syc * syc;
        if sc2 == 0.0 {
            return CreepForce::default();
        }
        let inverse = 1.0 / limit;
        let stiff = p.shear_modulus * p.b * inverse;
        // c_jj s_C; where spin alone slides, c_jj is C22
        let (square, along, across) = (sx * sx + sy * sy, p.c11 * sx, p.c22 * sy);
        let stretched = if square > 0.0 {
            (along * along + across * across) * (sc2 / square)
        } else {
            p.c22 * p.c22 * sc2
        };
        let eps = 0.25 * PI * p.a * stiff * stretched.sqrt();
        let adhesion = self.k_a * eps;
        let force = 2.0 / PI * limit * (adhesion / (1.0 + adhesion * adhesion) + arctan(self.k_s * eps));
        let spin = if omega == 0.0 { 0.0 } else { spin(p, stiff * syc.abs(), limit) };
        let over_sc = 1.0 / sc2.sqrt();
        let (fx, fy) = (-force * sx * over_sc, -(force * sy + spin * omega) * over_sc);
        let size = fx * fx + fy * fy;
        let cut = if size > limit * limit { limit / size.sqrt() } else { 1.0 };
        CreepForce { fx: cut * fx, fy: cut * fy }
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

/// F_yS, N m: what spin adds to the lateral force, times s_C/omega. `stiff` is G b |s_yC|/(Q mu), `limit` Q mu.
fn spin(p: &Patch, stiff: f64, limit: f64) -> f64 {
    let k = 1.0 + 6.3 * (1.0 - (-p.a / p.b).exp());
    // eps_M = e/K
    let e = 8.0 / 3.0 * (p.a * p.b).sqrt() * p.c23 * stiff;
    let (e2, k2) = (e * e, k * k);
    // (1 - d^2)^1.5 = (2 eps/(eps^2 + 1))^3
    let inverse = 1.0 / (e2 + k2);
    let d = (e2 - k2) * inverse;
    let root = 2.0 * e * k * inverse;
    9.0 / 16.0 * p.a * limit * (e * (d * d * (0.5 - d / 3.0) - 1.0 / 6.0) + k * root * root * root / 3.0)
}
