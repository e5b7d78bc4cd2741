//! Damper with one direction: tension `T = f(dx/dt)`, `f` a constant damping or a table.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::along::{Characteristic, one_of};
use super::{Along, ForceLaw, Mount, Relative, Wrench, directed, ends_along};
use crate::error::{Fault, KeyPath};
use crate::math::Vec3;
use crate::math::table::Table;

/// Viscous damper between two points, along their line or along an axis.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointDamper {
    /// Damping, N s/m; or `table`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping: Option<f64>,
    /// Tension (N) over the rate of elongation (m/s), instead of `damping`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
    /// Along the line between the ends, or an axis of the first body.
    #[serde(default)]
    pub along: Along,
}

impl PointDamper {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let blow_off = Table::linear(&[[0.0, 0.0], [0.1, 8e3], [0.5, 1.2e4]]);
        vec![
            Self { damping: Some(4.0e4), ..Self::default() },
            Self { table: Some(blow_off), along: Along::X, ..Self::default() },
        ]
    }

    fn law(&self) -> Characteristic<'_> {
        Characteristic::of(self.damping, self.table.as_ref())
    }
}

impl ForceLaw for PointDamper {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> Wrench {
        let s = self.along.stretch(motion, mount);
        s.wrench(self.law().force(s.rate))
    }

    fn energy(&self, _motion: &Relative, _mount: &Mount, _memory: &[f64]) -> f64 {
        0.0
    }

    fn dissipation(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        let s = self.along.stretch(motion, mount);
        self.law().force(s.rate) * s.rate
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        ends_along(self.along, between)?;
        if self.law().is_odd() { Ok(()) } else { directed(self.along, between) }
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        one_of(("damping", self.damping, "N s/m"), self.table.as_ref(), false, at)
    }
}
