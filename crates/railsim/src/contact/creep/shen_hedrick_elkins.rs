//! Shen, Hedrick and Elkins' saturation of the linear theory.

use super::vermeulen_johnson::saturation;
use super::{CreepForce, Creepage, KalkerLinear, Patch};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Kalker's linear force, spin included, cut down to the friction by the cubic of Vermeulen and Johnson
/// (Z. Y. Shen, J. K. Hedrick, J. A. Elkins, Proc. 8th IAVSD Symposium (1983) 591, *A comparison of alternative creep force models for
/// rail vehicle dynamic analysis*).
///
/// With F0 the resultant of the linear theory and u = F0/(mu N): F = mu N (u - u^2/3 + u^3/27) for u <= 3, else mu N, in the direction of
/// F0. Right for small spin; where spin saturates the patch, F keeps growing to mu N though the exact theory's falls. Slope at zero: Kalker's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShenHedrickElkins {}

impl ShenHedrickElkins {
    /// Force on the wheel.
    #[must_use]
    pub fn force(&self, p: &Patch, creepage: &Creepage, mu: f64) -> CreepForce {
        let linear = KalkerLinear {}.force(p, creepage);
        let limit = mu * p.n;
        if limit <= 0.0 {
            return CreepForce::default();
        }
        let ratio = saturation((linear.fx * linear.fx + linear.fy * linear.fy).sqrt() / limit);
        CreepForce { fx: ratio * linear.fx, fy: ratio * linear.fy }
    }

    /// Laws for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self {}]
    }
}
