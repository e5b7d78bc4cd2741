//! Monotone one-dimensional tables: a force over an elongation, or over its rate.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::hermite::Hermite;
use crate::error::{Fault, KeyPath};

/// What is between the points of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Straight lines.
    #[default]
    Linear,
    /// Monotone cubics without overshoot (Fritsch and Butland 1984, with the three-point slope at the ends).
    Pchip,
}

/// A curve through the origin that never falls: `f` over `x`.
///
/// A table that begins at x = 0 holds for both directions, `f(-x) = -f(x)`; one that begins below holds as written. Beyond
/// its ends it goes on straight, with the slope that it has there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Elongation, m, or its rate, m/s; rising. The first is 0, or one of them is.
    #[schemars(length(min = 2))]
    pub x: Vec<f64>,
    /// Force, N, at each `x`; never falling, 0 at x = 0.
    #[schemars(length(min = 2))]
    pub f: Vec<f64>,
    /// Between the points: straight lines, or monotone cubics.
    #[serde(default)]
    pub interpolation: Interpolation,
}

impl Table {
    /// Straight lines through points.
    #[must_use]
    pub fn linear(points: &[[f64; 2]]) -> Self {
        Self {
            x: points.iter().map(|p| p[0]).collect(),
            f: points.iter().map(|p| p[1]).collect(),
            interpolation: Interpolation::Linear,
        }
    }

    /// Monotone cubics through points.
    #[must_use]
    pub fn pchip(points: &[[f64; 2]]) -> Self {
        Self { interpolation: Interpolation::Pchip, ..Self::linear(points) }
    }

    /// True where the table begins at 0 and so holds for both directions.
    #[must_use]
    pub fn is_odd(&self) -> bool {
        self.x.first().is_none_or(|x| *x == 0.0)
    }

    /// f at `x`.
    #[inline]
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        if x < 0.0 && self.is_odd() { -self.inside(-x).0 } else { self.inside(x).0 }
    }

    /// df/dx at `x`.
    #[inline]
    #[must_use]
    pub fn slope(&self, x: f64) -> f64 {
        if x < 0.0 && self.is_odd() { self.inside(-x).1 } else { self.inside(x).1 }
    }

    /// The integral of f from 0 to `x`, never negative.
    #[must_use]
    pub fn integral(&self, x: f64) -> f64 {
        if self.is_odd() {
            return self.area_to(x.abs());
        }
        self.area_to(x) - self.area_to(0.0)
    }

    /// The x at which f is `f`; none where the table does not reach it or stays level.
    #[must_use]
    pub fn inverse(&self, f: f64) -> Option<f64> {
        if f < 0.0 && self.is_odd() {
            return self.inverse(-f).map(|x| -x);
        }
        let n = self.x.len();
        let beyond = |i: usize| {
            let slope = self.end_slope(i);
            (slope > 0.0).then(|| self.x[i] + (f - self.f[i]) / slope)
        };
        if f < self.f[0] {
            return beyond(0);
        }
        if f > self.f[n - 1] {
            return beyond(n - 1);
        }
        let cell = self.f.partition_point(|g| *g < f).clamp(1, n - 1) - 1;
        let (mut low, mut high) = (self.x[cell], self.x[cell + 1]);
        if self.interpolation == Interpolation::Linear {
            let rise = self.f[cell + 1] - self.f[cell];
            return Some(if rise > 0.0 { low + (high - low) * (f - self.f[cell]) / rise } else { low });
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.inside(middle).0 < f { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }

    /// Least slope anywhere, beyond the ends too.
    #[must_use]
    pub fn least_slope(&self) -> f64 {
        // Cubics of Fritsch and Butland lie below their secants somewhere; a lower bound is enough, and 0 is one.
        match self.interpolation {
            Interpolation::Linear => {
                (0..self.x.len() - 1).map(|i| self.secant(i)).fold(f64::INFINITY, f64::min)
            }
            Interpolation::Pchip => 0.0,
        }
    }

    /// Value and slope, without the continuation to negative x.
    #[inline]
    fn inside(&self, x: f64) -> (f64, f64) {
        let last = self.x.len() - 1;
        if x >= self.x[last] {
            let slope = self.end_slope(last);
            return (self.f[last] + slope * (x - self.x[last]), slope);
        }
        if x <= self.x[0] {
            let slope = self.end_slope(0);
            return (self.f[0] + slope * (x - self.x[0]), slope);
        }
        let i = self.x.partition_point(|p| *p <= x) - 1;
        self.in_cell(i, x)
    }

    #[inline]
    fn in_cell(&self, i: usize, x: f64) -> (f64, f64) {
        let h = self.x[i + 1] - self.x[i];
        match self.interpolation {
            Interpolation::Linear => {
                let slope = self.secant(i);
                (self.f[i] + slope * (x - self.x[i]), slope)
            }
            Interpolation::Pchip => {
                let w = Hermite::at((x - self.x[i]) / h, h);
                let ends = [self.f[i], self.f[i + 1], self.node_slope(i), self.node_slope(i + 1)];
                let sum = |w: &[f64; 4]| w.iter().zip(&ends).map(|(w, e)| w * e).sum();
                (sum(&w.value), sum(&w.slope))
            }
        }
    }

    /// Integral from the first point to `x`.
    fn area_to(&self, x: f64) -> f64 {
        let last = self.x.len() - 1;
        let straight = |i: usize, x: f64| {
            let d = x - self.x[i];
            self.f[i] * d + 0.5 * self.end_slope(i) * d * d
        };
        if x <= self.x[0] {
            return straight(0, x);
        }
        let mut sum = 0.0;
        for i in 0..last {
            let (a, b) = (self.x[i], self.x[i + 1].min(x));
            if b <= a {
                break;
            }
            // Simpson's rule is exact for a cubic.
            let h = b - a;
            sum += h / 6.0
                * (self.in_cell(i, a).0 + 4.0 * self.in_cell(i, 0.5 * (a + b)).0 + self.in_cell(i, b).0);
        }
        if x > self.x[last] { sum + straight(last, x) } else { sum }
    }

    fn secant(&self, i: usize) -> f64 {
        (self.f[i + 1] - self.f[i]) / (self.x[i + 1] - self.x[i])
    }

    /// Slope at point `i`: Fritsch and Butland (SIAM J. Sci. Stat. Comput. 5, 1984, 300-304), weighted harmonic mean.
    fn node_slope(&self, i: usize) -> f64 {
        let last = self.x.len() - 1;
        if last == 1 {
            return self.secant(0);
        }
        if i == 0 {
            // The continuation to negative x has the same first secant.
            return if self.is_odd() { self.secant(0) } else { self.one_sided(0, 1) };
        }
        if i == last {
            return self.one_sided(last - 1, last - 2);
        }
        let (left, right) = (self.secant(i - 1), self.secant(i));
        if left <= 0.0 || right <= 0.0 {
            return 0.0;
        }
        let (h0, h1) = (self.x[i] - self.x[i - 1], self.x[i + 1] - self.x[i]);
        let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
        (w0 + w1) / (w0 / left + w1 / right)
    }

    /// Three-point slope at an end, kept monotone: near cell, next cell.
    fn one_sided(&self, near: usize, next: usize) -> f64 {
        let (h0, h1) = (self.x[near + 1] - self.x[near], self.x[next + 1] - self.x[next]);
        let (d0, d1) = (self.secant(near), self.secant(next));
        let slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
        slope.clamp(0.0, 3.0 * d0)
    }

    fn end_slope(&self, i: usize) -> f64 {
        match self.interpolation {
            Interpolation::Linear => self.secant(i.min(self.x.len() - 2)),
            Interpolation::Pchip => self.node_slope(i),
        }
    }

    /// What is wrong with the points; `at` is the path of the table, `strict` asks for a force that rises everywhere.
    #[must_use]
    pub fn faults(&self, at: &KeyPath, strict: bool) -> Vec<Fault> {
        let mut faults = Vec::new();
        let mut refuse =
            |key: KeyPath, found: String, allowed: &str| faults.push(Fault::new(key, found, allowed));
        for (key, values) in [("x", &self.x), ("f", &self.f)] {
            if values.len() < 2 {
                refuse(at.key(key), format!("{} points", values.len()), "2 points or more");
                return faults;
            }
            if let Some(i) = values.iter().position(|v| !v.is_finite()) {
                refuse(at.key(key).index(i), values[i].to_string(), "a finite number");
                return faults;
            }
        }
        if self.x.len() != self.f.len() {
            let found = format!("{} values of f for {} of x", self.f.len(), self.x.len());
            refuse(at.key("f"), found, "one for each x");
            return faults;
        }
        for i in 1..self.x.len() {
            if self.x[i] <= self.x[i - 1] {
                let found = format!("{} after {}", self.x[i], self.x[i - 1]);
                refuse(at.key("x").index(i), found, "rising values");
            }
            let fell = self.f[i] < self.f[i - 1] || (strict && self.f[i] == self.f[i - 1]);
            if fell {
                let found = format!("{} after {}", self.f[i], self.f[i - 1]);
                let allowed = if strict { "rising values" } else { "values that never fall" };
                refuse(at.key("f").index(i), found, allowed);
            }
        }
        match self.x.iter().position(|x| *x == 0.0) {
            Some(i) if self.f[i] != 0.0 => {
                refuse(at.key("f").index(i), format!("{} at x = 0", self.f[i]), "0 at x = 0");
            }
            Some(_) => {}
            None => refuse(at.key("x"), "no x = 0".into(), "a point at x = 0, with f = 0"),
        }
        faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> Vec<[f64; 2]> {
        vec![[-2.0, -3.0], [-0.5, -1.0], [0.0, 0.0], [1.0, 0.5], [2.5, 4.0], [3.0, 4.0], [4.0, 9.0]]
    }

    /// scipy 1.17 `PchipInterpolator` through the same points, an implementation of the same paper by others.
    #[test]
    fn pchip_as_scipy_gives_it() {
        let table = Table::pchip(&points());
        for (x, value, slope) in SCIPY {
            assert!((table.value(x) - value).abs() < 1e-13, "{x}: {} {value}", table.value(x));
            assert!((table.slope(x) - slope).abs() < 1e-12, "{x}: {} {slope}", table.slope(x));
        }
    }

    const SCIPY: [(f64, f64, f64); 5] = [
        (-1.3, -2.2222937420178805, 1.3498850574712642),
        (-0.2, -0.33426600985221677, 2.247487684729064),
        (0.7, 0.3299473684210526, 0.4024060150375939),
        (1.9, 2.8816842105263154, 3.107368421052633),
        (3.6, 6.04, 6.2),
    ];

    #[test]
    fn slope_and_integral_fit_the_value_and_the_inverse_finds_back() {
        let odd = &points()[2..];
        for table in
            [Table::linear(&points()), Table::pchip(&points()), Table::linear(odd), Table::pchip(odd)]
        {
            assert!(table.faults(&KeyPath::default(), false).is_empty());
            assert_eq!(table.integral(0.0), 0.0);
            for i in -97..=113 {
                let (x, h) = (0.0501 * f64::from(i) + 0.0007, 1e-6); // off the kinks
                let slope = (table.value(x + h) - table.value(x - h)) / (2.0 * h);
                assert!((slope - table.slope(x)).abs() < 1e-5, "{table:?} {x}");
                let f = (table.integral(x + h) - table.integral(x - h)) / (2.0 * h);
                assert!((f - table.value(x)).abs() < 1e-8, "{table:?} {x}: {f} {}", table.value(x));
                assert!(table.integral(x) >= 0.0);
                if slope > 1e-3 {
                    assert!((table.inverse(table.value(x)).unwrap() - x).abs() < 1e-9, "{table:?} {x}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_curve_is_refused_by_key() {
        let at = KeyPath::of("table");
        let keys = |points: &[[f64; 2]], strict| -> Vec<String> {
            Table::linear(points).faults(&at, strict).iter().map(|f| f.key.to_string()).collect()
        };
        assert_eq!(keys(&[[0.0, 0.0]], false), ["table.x"]);
        assert_eq!(keys(&[[0.0, 0.0], [0.0, 1.0]], false), ["table.x[1]"]);
        assert_eq!(keys(&[[0.0, 0.0], [1.0, -1.0]], false), ["table.f[1]"]);
        assert_eq!(keys(&[[0.0, 0.0], [1.0, 0.0]], true), ["table.f[1]"]);
        assert_eq!(keys(&[[0.0, 1.0], [1.0, 2.0]], false), ["table.f[0]"]);
        assert_eq!(keys(&[[1.0, 1.0], [2.0, 2.0]], false), ["table.x"]);
        assert_eq!(keys(&[[0.0, 0.0], [1.0, f64::NAN]], false), ["table.f[1]"]);
    }
}
