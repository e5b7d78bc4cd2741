//! Coupler between two vehicles: along the line between its ends, free within its slack, then the draft gear's force.
//!
//! With x the elongation from the middle of the slack s (free play from fully pushed to fully pulled):
//! `T = sign(x) [f(|x| - s/2) + c dx/dt sign(x)]` outside the slack, nothing inside; the damper works outside only, and a
//! coupler that is let go does not pull back: T has the sign of x or is zero. Dissipated power is the tension beyond `f`
//! times the rate, never negative.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::along::{Characteristic, one_of};
use super::{Along, ForceLaw, Mount, Relative, Wrench, ends_along, not_negative};
use crate::error::{Fault, KeyPath};
use crate::math::Vec3;
use crate::math::table::Table;

/// Coupler with draft gear.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Coupler {
    /// Free play from fully pushed to fully pulled, m; in the design position it stands in the middle.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "m"))]
    pub slack: f64,
    /// Stiffness of the draft gear, N/m; or `table`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
    /// Force (N) over the travel of the draft gear (m): from 0 for pull and push alike, or from below 0 (push) to above
    /// (pull). Instead of `stiffness`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
    /// Damping of the draft gear, N s/m.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "N s/m"))]
    pub damping: f64,
}

impl Coupler {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let gear = Table::linear(&[[-0.08, -1.2e6], [-0.05, -3e5], [0.0, 0.0], [0.06, 4e5], [0.07, 1e6]]);
        vec![
            Self { slack: 0.02, stiffness: Some(1e7), damping: 1e5, ..Self::default() },
            Self { slack: 0.03, table: Some(gear), ..Self::default() },
        ]
    }

    /// Travel of the draft gear, signed; 0 within the slack.
    #[inline]
    fn travel(&self, x: f64) -> f64 {
        x.signum() * (x.abs() - 0.5 * self.slack).max(0.0)
    }

    /// Elastic and whole tension.
    #[inline]
    fn tension(&self, x: f64, rate: f64) -> (f64, f64) {
        let travel = self.travel(x);
        if travel == 0.0 {
            return (0.0, 0.0);
        }
        let elastic = self.law().force(travel);
        let whole = elastic + self.damping * rate;
        (elastic, if travel > 0.0 { whole.max(0.0) } else { whole.min(0.0) })
    }

    fn law(&self) -> Characteristic<'_> {
        Characteristic::of(self.stiffness, self.table.as_ref())
    }
}

impl ForceLaw for Coupler {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> Wrench {
        let s = Along::Line.stretch(motion, mount);
        s.wrench(self.tension(s.x, s.rate).1)
    }

    fn energy(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        self.law().work(self.travel(Along::Line.stretch(motion, mount).x))
    }

    fn dissipation(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        let s = Along::Line.stretch(motion, mount);
        let (elastic, whole) = self.tension(s.x, s.rate);
        (whole - elastic) * s.rate
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        ends_along(Along::Line, between)
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = not_negative(&[self.slack], &at.key("slack"), "m");
        faults.extend(one_of(("stiffness", self.stiffness, "N/m"), self.table.as_ref(), false, at));
        faults.extend(not_negative(&[self.damping], &at.key("damping"), "N s/m"));
        faults
    }
}
