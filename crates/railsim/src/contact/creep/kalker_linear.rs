//! Kalker's linear theory.

use super::{CreepForce, Creepage, Patch};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Kalker's linear theory: Fx = -G a b C11 xi, Fy = -G a b (C22 eta + sqrt(a b) C23 phi).
///
/// G shear modulus (Pa), a, b semi-axes (m), xi, eta creepages, phi spin (1/m), C11, C22, C23 Kalker's coefficients
/// (J. J. Kalker, *Three-Dimensional Elastic Bodies in Rolling Contact*, 1990, eq. 2.61 and Table E.3). Right for creepages so small that
/// next to nothing of the patch slips; **not limited by friction**: outside that range it overestimates without bound.
/// For linear analysis and tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KalkerLinear {}

impl KalkerLinear {
    /// Force on the wheel.
    #[must_use]
    pub fn force(&self, p: &Patch, creepage: &Creepage) -> CreepForce {
        let area = p.a * p.b;
        let scale = -p.shear_modulus * area;
        CreepForce {
            fx: scale * p.c11 * creepage.xi,
            fy: scale * (p.c22 * creepage.eta + area.sqrt() * p.c23 * creepage.phi),
        }
    }

    /// Spin moment on the wheel, N m: Mz = -G c^3 (-C23 eta + c C33 phi), c = sqrt(a b) (the same source; C33 by Kalker 1967).
    #[must_use]
    pub fn spin_moment(&self, p: &Patch, c33: f64, creepage: &Creepage) -> f64 {
        let c = (p.a * p.b).sqrt();
        -p.shear_modulus * c * c * c * (-p.c23 * creepage.eta + c * c33 * creepage.phi)
    }

    /// Laws for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self {}]
    }
}
