//! Spring and damper in series, as a yaw damper with its end stiffness.
//!
//! The memory is the elongation z of the spring: `T = k z`, and what is left of the elongation is the damper's:
//! `dz/dt = dx/dt - v(T)`, with `v` the damper's speed under the tension T. Stored energy `k z^2/2`, dissipated power
//! `T v(T)`. For a constant damping c, a sine of angular frequency w and amplitude X gives a tension of amplitude
//! `c w X / sqrt(1 + (w c/k)^2)`, which leads the elongation by `atan(k/(c w))`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::along::{Characteristic, one_of};
use super::{Along, ForceLaw, Mount, Relative, Wrench, directed, ends_along, positive};
use crate::error::{Fault, KeyPath};
use crate::math::Vec3;
use crate::math::table::{Interpolation, Table};

/// Damper in series with a spring, along the line between two points or along an axis.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Maxwell {
    /// Stiffness of the ends together, N/m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N/m"))]
    pub stiffness: f64,
    /// Damping, N s/m; or `table`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping: Option<f64>,
    /// Force of the damper (N) over its rate (m/s), straight lines that rise everywhere, instead of `damping`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
    /// Along the line between the ends, or an axis of the first body.
    #[serde(default)]
    pub along: Along,
}

impl Maxwell {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let blow_off = Table::linear(&[[0.0, 0.0], [0.02, 8e3], [0.2, 1.2e4]]);
        vec![
            Self { stiffness: 5.0e6, damping: Some(3.0e5), ..Self::default() },
            Self { stiffness: 8.0e6, table: Some(blow_off), along: Along::X, ..Self::default() },
        ]
    }

    /// Speed of the damper under a tension, m/s.
    #[inline]
    fn creep(&self, tension: f64) -> f64 {
        // A damping or table that the checks let through reaches every force.
        Characteristic::of(self.damping, self.table.as_ref()).inverse(tension).unwrap_or(0.0)
    }
}

impl ForceLaw for Maxwell {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> Wrench {
        self.along.stretch(motion, mount).wrench(self.stiffness * memory[0])
    }

    fn energy(&self, _motion: &Relative, _mount: &Mount, memory: &[f64]) -> f64 {
        0.5 * self.stiffness * memory[0] * memory[0]
    }

    fn dissipation(&self, _motion: &Relative, _mount: &Mount, memory: &[f64]) -> f64 {
        let tension = self.stiffness * memory[0];
        tension * self.creep(tension)
    }

    fn memory(&self) -> usize {
        1
    }

    #[inline]
    fn memory_rates(&self, motion: &Relative, mount: &Mount, memory: &[f64], rates: &mut [f64]) {
        rates[0] = self.along.stretch(motion, mount).rate - self.creep(self.stiffness * memory[0]);
    }

    fn memory_speed(&self) -> f64 {
        let least = self.table.as_ref().map_or(self.damping.unwrap_or(0.0), Table::least_slope);
        self.stiffness / least
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        ends_along(self.along, between)?;
        if self.table.as_ref().is_none_or(Table::is_odd) { Ok(()) } else { directed(self.along, between) }
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = positive(&[self.stiffness], &at.key("stiffness"), "N/m");
        faults.extend(one_of(("damping", self.damping, "N s/m"), self.table.as_ref(), true, at));
        if self.table.as_ref().is_some_and(|t| t.interpolation == Interpolation::Pchip) {
            let allowed = "\"linear\": the damper's speed is read off backwards";
            faults.push(Fault::new(at.key("table").key("interpolation"), "\"pchip\"", allowed));
        }
        faults
    }
}
