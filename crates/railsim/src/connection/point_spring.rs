//! Spring with one direction: tension `T = f(x + x0)`, `x` the elongation from the design position, `x0` that of the design
//! position from the free length; `f` a constant stiffness or a table. Stored energy: the integral of T over x.
//!
//! `x0` follows from the free length; a spring that carries the vehicle has its free length solved instead, so that it
//! bears its share at the design height. With neither it is free in the design position.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::along::{Characteristic, one_of};
use super::{Along, ForceLaw, Mount, Relative, Wrench, directed, ends_along, positive};
use crate::error::{Fault, KeyPath};
use crate::math::table::Table;
use crate::math::{Mat3, Vec3};

/// Spring between two points, along their line or along an axis.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointSpring {
    /// Stiffness, N/m; or `table`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
    /// Tension (N) over elongation from the free length (m), instead of `stiffness`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
    /// Length without force, m; with `along = "line"` only. Left out: free in the design position, or solved where it
    /// carries weight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free_length: Option<f64>,
    /// Along the line between the ends, or an axis of the first body.
    #[serde(default)]
    pub along: Along,
}

impl PointSpring {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let table = Table::pchip(&[[-0.2, -9e4], [-0.02, -4e3], [0.0, 0.0], [0.1, 2e4], [0.15, 6e4]]);
        vec![
            Self { stiffness: Some(2.0e5), ..Self::default() },
            Self { stiffness: Some(2.0e5), along: Along::Y, ..Self::default() },
            Self { table: Some(table), ..Self::default() },
        ]
    }

    fn law(&self) -> Characteristic<'_> {
        Characteristic::of(self.stiffness, self.table.as_ref())
    }
}

/// Elongation in the design position of a spring: from the force it is to carry, or from its free length.
pub(super) fn stretched(
    law: &Characteristic<'_>,
    along: Along,
    mount: &Mount,
    force: Option<&Vec3>,
    free_length: Option<f64>,
) -> Result<f64, String> {
    match (force, free_length) {
        (Some(force), _) => {
            let tension = -force.dot(&along.direction(&mount.between));
            law.inverse(tension)
                .ok_or_else(|| format!("{tension:.0} N, which its characteristic never reaches"))
        }
        (None, Some(free)) => Ok(mount.between.norm() - free),
        (None, None) => Ok(0.0),
    }
}

/// Stiffness along one direction.
pub(super) fn along_only(k: f64, along: Along, between: &Vec3) -> Mat3 {
    let e = along.direction(between);
    k * e * e.transpose()
}

impl ForceLaw for PointSpring {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> Wrench {
        let s = self.along.stretch(motion, mount);
        s.wrench(self.law().force(mount.stretched + s.x))
    }

    fn energy(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        let s = self.along.stretch(motion, mount);
        self.law().work(mount.stretched + s.x) - self.law().work(mount.stretched)
    }

    fn dissipation(&self, _motion: &Relative, _mount: &Mount, _memory: &[f64]) -> f64 {
        0.0
    }

    fn nominal_stiffness(&self, between: &Vec3) -> Mat3 {
        along_only(self.law().slope(0.0), self.along, between)
    }

    fn settle(&self, mount: &mut Mount, force: Option<&Vec3>) -> Result<(), String> {
        mount.stretched = stretched(&self.law(), self.along, mount, force, self.free_length)?;
        Ok(())
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        ends_along(self.along, between)?;
        if self.law().is_odd() { Ok(()) } else { directed(self.along, between) }
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = one_of(("stiffness", self.stiffness, "N/m"), self.table.as_ref(), false, at);
        faults.extend(free_length(self.free_length, self.along, at));
        faults
    }
}

/// What is wrong with a free length.
pub(super) fn free_length(length: Option<f64>, along: Along, at: &KeyPath) -> Vec<Fault> {
    let Some(length) = length else { return Vec::new() };
    if along != Along::Line {
        let allowed = "a free length with `along = \"line\"` only";
        return vec![Fault::new(at.key("free_length"), format!("{length} m along an axis"), allowed)];
    }
    positive(&[length], &at.key("free_length"), "m")
}
