//! Rod with elastic ends: a spring and a damper side by side along the line between its ends, tension
//! `T = f(x + x0) + c dx/dt`. As a swing link that carries weight, its tension over its length is the pendulum's stiffness,
//! which the turning line gives by itself.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::along::{Characteristic, one_of};
use super::point_spring::{along_only, free_length, stretched};
use super::{Along, ForceLaw, Mount, Relative, Wrench, ends_along, not_negative};
use crate::error::{Fault, KeyPath};
use crate::math::table::Table;
use crate::math::{Mat3, Vec3};

/// Traction rod, push-pull rod, Panhard rod, swing link.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TractionRod {
    /// Stiffness of the rod with its rubber ends, N/m; or `table`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
    /// Tension (N) over elongation from the free length (m), instead of `stiffness`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
    /// Damping of the rubber, N s/m.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "N s/m"))]
    pub damping: f64,
    /// Length without force, m. Left out: free in the design position, or solved where it carries weight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free_length: Option<f64>,
}

impl TractionRod {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![Self { stiffness: Some(5e6), damping: 2e4, free_length: Some(2.4), ..Self::default() }]
    }

    fn law(&self) -> Characteristic<'_> {
        Characteristic::of(self.stiffness, self.table.as_ref())
    }
}

impl ForceLaw for TractionRod {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> Wrench {
        let s = Along::Line.stretch(motion, mount);
        s.wrench(self.law().force(mount.stretched + s.x) + self.damping * s.rate)
    }

    fn energy(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        let s = Along::Line.stretch(motion, mount);
        self.law().work(mount.stretched + s.x) - self.law().work(mount.stretched)
    }

    fn dissipation(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        let s = Along::Line.stretch(motion, mount);
        self.damping * s.rate * s.rate
    }

    fn nominal_stiffness(&self, between: &Vec3) -> Mat3 {
        along_only(self.law().slope(0.0), Along::Line, between)
    }

    fn settle(&self, mount: &mut Mount, force: Option<&Vec3>) -> Result<(), String> {
        mount.stretched = stretched(&self.law(), Along::Line, mount, force, self.free_length)?;
        Ok(())
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        ends_along(Along::Line, between)
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = one_of(("stiffness", self.stiffness, "N/m"), self.table.as_ref(), false, at);
        faults.extend(not_negative(&[self.damping], &at.key("damping"), "N s/m"));
        faults.extend(free_length(self.free_length, Along::Line, at));
        faults
    }
}
