//! Stop with a clearance: no force until the ends have come `clearance` closer (or apart, or both ways), then
//! `F = k x + k3 x^3` or a table over the depth x beyond it. Continuous; stored energy is the integral of F.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::along::{Characteristic, one_of};
use super::{Along, ForceLaw, Mount, Relative, Wrench, directed, ends_along, not_negative};
use crate::error::{Fault, KeyPath};
use crate::math::Vec3;
use crate::math::table::Table;

/// Which way a stop is met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Either way, as a lateral stop in the middle.
    Both,
    /// When the ends come together, as a buffer.
    #[default]
    Pressed,
    /// When the ends part, as a check chain.
    Pulled,
}

/// Bump stop.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BumpStop {
    /// Travel from the design position until it is met, m.
    #[schemars(extend("minimum" = 0, "unit" = "m"))]
    pub clearance: f64,
    /// Stiffness where it is met, N/m; or `table`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
    /// Progression, N/m3: the force is `stiffness x + cubic x^3`.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "N/m3"))]
    pub cubic: f64,
    /// Force (N) over the depth beyond the clearance (m), from 0, instead of `stiffness`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
    /// Which way it is met.
    #[serde(default)]
    pub side: Side,
    /// Along the line between the ends, or an axis of the first body.
    #[serde(default)]
    pub along: Along,
}

impl BumpStop {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let table = Table::linear(&[[0.0, 0.0], [0.01, 2e3], [0.02, 1e4], [0.03, 6e4]]);
        vec![
            Self { clearance: 0.02, stiffness: Some(2e5), cubic: 1e9, ..Self::default() },
            Self {
                clearance: 0.03,
                table: Some(table),
                side: Side::Both,
                along: Along::Y,
                ..Self::default()
            },
            Self { clearance: 0.01, stiffness: Some(1e6), side: Side::Pulled, ..Self::default() },
        ]
    }

    /// Depth beyond the clearance, and whether the ends are pulled (+1) or pressed (-1) there.
    #[inline]
    fn depth(&self, x: f64) -> Option<(f64, f64)> {
        let (depth, sign) = (x.abs() - self.clearance, x.signum());
        let met = match self.side {
            Side::Both => true,
            Side::Pressed => sign < 0.0,
            Side::Pulled => sign > 0.0,
        };
        (met && depth > 0.0).then_some((depth, sign))
    }

    fn law(&self) -> Characteristic<'_> {
        Characteristic::of(self.stiffness, self.table.as_ref())
    }
}

impl ForceLaw for BumpStop {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> Wrench {
        let s = self.along.stretch(motion, mount);
        match self.depth(s.x) {
            Some((d, sign)) => s.wrench(sign * (self.law().force(d) + self.cubic * d * d * d)),
            None => Wrench::zero(),
        }
    }

    fn energy(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        let s = self.along.stretch(motion, mount);
        self.depth(s.x).map_or(0.0, |(d, _)| self.law().work(d) + 0.25 * self.cubic * d.powi(4))
    }

    fn dissipation(&self, _motion: &Relative, _mount: &Mount, _memory: &[f64]) -> f64 {
        0.0
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        ends_along(self.along, between)?;
        if self.side == Side::Both { Ok(()) } else { directed(self.along, between) }
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = not_negative(&[self.clearance], &at.key("clearance"), "m");
        faults.extend(not_negative(&[self.cubic], &at.key("cubic"), "N/m3"));
        faults.extend(one_of(("stiffness", self.stiffness, "N/m"), self.table.as_ref(), false, at));
        if let Some(table) = &self.table
            && !table.is_odd()
        {
            faults.push(Fault::new(
                at.key("table").key("x").index(0),
                table.x[0].to_string(),
                "0 m: where it is met",
            ));
        }
        faults
    }
}
