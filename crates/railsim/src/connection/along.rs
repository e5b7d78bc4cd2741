//! Elements with one degree of freedom: along the line between their ends, or along one of their axes.
//!
//! Elongation is positive when the ends part, tension positive when the element pulls them together. Along the line
//! `x = L - L0`, with `L0` the design length. Along an axis of body A it is the change of that component of the vector
//! from A's point to B's, counted in the direction in which the ends lie apart in the design position (where they
//! coincide: B towards + of the axis).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Mount, Relative, Wrench};
use crate::error::{Fault, KeyPath};
use crate::math::Vec3;
use crate::math::table::Table;

/// Where an element with one degree of freedom acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Along {
    /// Along the line between its ends, which lie apart.
    #[default]
    Line,
    /// Along the x axis of the first body.
    X,
    /// Along the y axis of the first body.
    Y,
    /// Along the z axis of the first body.
    Z,
}

/// Least distance of two ends that count as apart, m.
pub const APART: f64 = 1e-3;

/// Elongation of an element, its rate, and how its tension acts.
#[derive(Debug, Clone, Copy)]
pub struct Stretch {
    /// From the design position, m.
    pub x: f64,
    /// m/s.
    pub rate: f64,
    /// From A's end to B's, A's axes.
    e: Vec3,
    /// B's end from A's centre of mass, A's axes, m.
    lever: Vec3,
}

impl Along {
    /// The axis, unless it is the line.
    #[must_use]
    pub fn axis(self) -> Option<usize> {
        match self {
            Self::Line => None,
            Self::X => Some(0),
            Self::Y => Some(1),
            Self::Z => Some(2),
        }
    }

    /// Unit vector of a positive elongation in the design position.
    #[must_use]
    pub fn direction(self, between: &Vec3) -> Vec3 {
        match self.axis() {
            None => between.try_normalize(0.0).unwrap_or_else(Vec3::zeros),
            Some(i) => {
                let mut e = Vec3::zeros();
                e[i] = if between[i] < -APART { -1.0 } else { 1.0 };
                e
            }
        }
    }

    /// Whether the ends tell which way is apart.
    #[must_use]
    pub fn is_directed(self, between: &Vec3) -> bool {
        self.axis().is_none_or(|i| between[i].abs() >= APART)
    }

    /// Elongation and rate of an element on this mount.
    #[inline]
    #[must_use]
    pub fn stretch(self, motion: &Relative, mount: &Mount) -> Stretch {
        let q_B = motion.R_AB * mount.p_B;
        let lever = motion.r_AB + q_B;
        let d = lever - mount.p_A;
        let velocity = motion.v_AB + motion.w_AB.cross(&q_B);
        match self.axis() {
            None => {
                let length = d.norm();
                // Ends that meet have no line between them: no direction, so no force, until they part again.
                let e = if length > 0.0 { d / length } else { Vec3::zeros() };
                Stretch { x: length - mount.between.norm(), rate: velocity.dot(&e), e, lever }
            }
            Some(i) => {
                let e = self.direction(&mount.between);
                Stretch { x: e[i] * (d[i] - mount.between[i]), rate: velocity.dot(&e), e, lever }
            }
        }
    }
}

impl Stretch {
    /// A tension as a wrench on B about A's centre of mass, A's axes.
    #[inline]
    #[must_use]
    pub fn wrench(&self, tension: f64) -> Wrench {
        let f = -tension * self.e;
        Wrench { f, m: self.lever.cross(&f) }
    }
}

/// A spring's force over its elongation: constant stiffness, or a table.
#[derive(Debug, Clone, Copy)]
pub struct Characteristic<'a> {
    /// N/m, or N s/m of a damper; used where there is no table.
    pub constant: f64,
    /// Force over elongation (of a damper: over its rate).
    pub table: Option<&'a Table>,
}

impl<'a> Characteristic<'a> {
    /// Of the two keys of which a law has one.
    #[inline]
    #[must_use]
    pub fn of(constant: Option<f64>, table: Option<&'a Table>) -> Self {
        Self { constant: constant.unwrap_or(0.0), table }
    }

    /// Force, N.
    #[inline]
    #[must_use]
    pub fn force(&self, x: f64) -> f64 {
        self.table.map_or(self.constant * x, |t| t.value(x))
    }

    /// Slope of the force.
    #[must_use]
    pub fn slope(&self, x: f64) -> f64 {
        self.table.map_or(self.constant, |t| t.slope(x))
    }

    /// Integral of the force from 0, J.
    #[must_use]
    pub fn work(&self, x: f64) -> f64 {
        self.table.map_or(0.5 * self.constant * x * x, |t| t.integral(x))
    }

    /// Where the force is `force`.
    #[inline]
    #[must_use]
    pub fn inverse(&self, force: f64) -> Option<f64> {
        match self.table {
            Some(table) => table.inverse(force),
            None if self.constant > 0.0 => Some(force / self.constant),
            None => (force == 0.0).then_some(0.0),
        }
    }

    /// False where the force differs for pull and push.
    #[must_use]
    pub fn is_odd(&self) -> bool {
        self.table.is_none_or(Table::is_odd)
    }
}

/// One of `constant` and `table`, each in its range.
pub(super) fn one_of(
    (key, constant, unit): (&str, Option<f64>, &str),
    table: Option<&Table>,
    strict: bool,
    at: &KeyPath,
) -> Vec<Fault> {
    match (constant, table) {
        (Some(_), Some(_)) => {
            vec![Fault::new(at.key("table"), format!("{key} and table"), format!("one of {key} and table"))]
        }
        (None, None) => vec![Fault::new(at.key(key), "nothing", format!("a number ({unit}), or a table"))],
        (Some(c), None) => {
            let good = c.is_finite() && if strict { c > 0.0 } else { c >= 0.0 };
            let sign = if strict { ">" } else { ">=" };
            if good {
                Vec::new()
            } else {
                vec![Fault::new(at.key(key), c.to_string(), format!("a finite number {sign} 0 {unit}"))]
            }
        }
        (None, Some(table)) => table.faults(&at.key("table"), strict),
    }
}
