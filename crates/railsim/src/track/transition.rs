//! How a quantity passes from one value to another along a segment.
//!
//! With x the fraction of the length and f from 0 to 1, curvature, cant, gradient angle and gauge of one segment share f:
//!
//! | shape | f(x) | known as |
//! |---|---|---|
//! | linear | x | clothoid, Euler's spiral |
//! | cosine | (1 - cos pi x)/2 | half-wave cosine, Japan's high-speed lines |
//! | bloss | 3 x^2 - 2 x^3 | Bloss's cubic |
//! | helmert | 2 x^2, from the middle on 1 - 2 (1 - x)^2 | Helmert's (Schramm's) two parabolas |
//! | cubic parabola | curvature of y = a X^3 in plan | the railways' oldest, the clothoid of small angles |
//!
//! EN 13803 (annex on transition curves) lists the same shapes.

use std::f64::consts::PI;

/// The shape of a transition as a function of the fraction x = 0..1 of its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Transition {
    /// f = x: curvature grows in proportion to arc length.
    Linear,
    /// f = (1 - cos pi x)/2: level at both ends.
    Cosine,
    /// f = 3 x^2 - 2 x^3: level at both ends.
    Bloss,
    /// Two parabolas that meet in the middle: level at both ends.
    Helmert,
    /// A cubic parabola between straight track and a curve.
    CubicParabola(CubicParabola),
}

/// Values of a shape at one fraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// f, from 0 to 1.
    pub value: f64,
    /// df/dx.
    pub slope: f64,
    /// Integral of f from 0 to x.
    pub integral: f64,
}

impl Transition {
    /// Every shape, for tests.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let cubic = |turn, reversed| CubicParabola::new(turn, reversed).map(Self::CubicParabola);
        let mut examples = vec![Self::Linear, Self::Cosine, Self::Bloss, Self::Helmert];
        examples
            .extend([(0.0, false), (0.2, false), (0.6, true)].into_iter().filter_map(|(t, r)| cubic(t, r)));
        examples
    }

    /// The shape at fraction `x` in 0..=1.
    #[must_use]
    pub fn at(self, x: f64) -> Shape {
        match self {
            Self::Linear => Shape { value: x, slope: 1.0, integral: 0.5 * x * x },
            Self::Cosine => {
                let (sin, cos) = (PI * x).sin_cos();
                Shape { value: 0.5 * (1.0 - cos), slope: 0.5 * PI * sin, integral: 0.5 * (x - sin / PI) }
            }
            Self::Bloss => {
                let square = x * x;
                Shape {
                    value: square * (3.0 - 2.0 * x),
                    slope: 6.0 * x * (1.0 - x),
                    integral: square * x * (1.0 - 0.5 * x),
                }
            }
            Self::Helmert => {
                let rest = 1.0 - x;
                if x < 0.5 {
                    Shape { value: 2.0 * x * x, slope: 4.0 * x, integral: x * x * x / 1.5 }
                } else {
                    Shape {
                        value: 1.0 - 2.0 * rest * rest,
                        slope: 4.0 * rest,
                        integral: x - 0.5 + rest * rest * rest / 1.5,
                    }
                }
            }
            Self::CubicParabola(cubic) => cubic.at(x),
        }
    }
}

/// The cubic parabola y = a X^3 in plan, from its vertex to where its curvature is that of the curve.
///
/// With X = xi X_e over its chord X_e along the straight and p = 3 a X_e^2 the tangent of the whole turn, the tangent at xi
/// is p xi^2, the curvature 2 p xi/X_e (1 + p^2 xi^4)^(-3/2) and the arc length X_e times the integral of
/// sqrt(1 + p^2 xi^4). Its curvature has a maximum, so that no cubic parabola is longer than about 0.8 R.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubicParabola {
    /// p.
    tangent: f64,
    /// Arc length over X_e.
    arc: f64,
    /// Curvature at the end times arc length.
    turn: f64,
    /// From the curve to the straight.
    reversed: bool,
}

/// Largest p: the series of the arc length is then exact to rounding.
const MAX_TANGENT: f64 = 0.4;

impl CubicParabola {
    /// Largest length over the radius of the curve.
    pub const MAX_TURN: f64 = 0.65;

    /// The one that reaches the curvature k after the arc length l, `turn` = |k| l; none beyond [`Self::MAX_TURN`].
    #[must_use]
    pub fn new(turn: f64, reversed: bool) -> Option<Self> {
        if !(0.0..=Self::MAX_TURN).contains(&turn) {
            return None;
        }
        let turn_of = |p: f64| 2.0 * p * arc(p, 1.0) * (1.0 + p * p).powf(-1.5);
        // Monotone up to the bound: bisected to the last bit.
        let (mut low, mut high) = (0.0, MAX_TANGENT);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if turn_of(middle) < turn { low = middle } else { high = middle }
        }
        let tangent = if turn == 0.0 { 0.0 } else { 0.5 * (low + high) };
        Some(Self { tangent, arc: arc(tangent, 1.0), turn: turn_of(tangent), reversed })
    }

    fn at(&self, x: f64) -> Shape {
        if !self.reversed {
            return self.forward(x);
        }
        let mirrored = self.forward(1.0 - x);
        Shape {
            value: 1.0 - mirrored.value,
            slope: mirrored.slope,
            integral: x - (self.forward(1.0).integral - mirrored.integral),
        }
    }

    fn forward(&self, x: f64) -> Shape {
        let p = self.tangent;
        if p == 0.0 {
            return Transition::Linear.at(x);
        }
        // Newton from x on: the arc length grows by 1 to 1.08 times xi, so that five steps leave rounding.
        let mut xi = x;
        for _ in 0..5 {
            xi -= (arc(p, xi) - x * self.arc) / (1.0 + (p * xi * xi).powi(2)).sqrt();
        }
        let tangent = p * xi * xi;
        let stretch = 1.0 + tangent * tangent;
        let end = (1.0 + p * p).powf(1.5);
        Shape {
            value: end * xi * stretch.powf(-1.5),
            slope: end * (1.0 - 5.0 * tangent * tangent) * stretch.powi(-3) * self.arc,
            integral: tangent.atan() / self.turn,
        }
    }
}

/// Integral of sqrt(1 + p^2 eta^4) from 0 to xi, by the binomial series: with p = 0.4 the first term left out is 1e-14.
fn arc(p: f64, xi: f64) -> f64 {
    let u = (p * xi * xi).powi(2);
    let (mut sum, mut term) = (0.0, 1.0);
    for n in 0..14 {
        let n = f64::from(n);
        sum += term / (4.0 * n + 1.0);
        term *= u * (0.5 - n) / (n + 1.0);
    }
    xi * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_goes_from_zero_to_one_with_its_own_derivatives() {
        let h = 1e-5;
        for shape in Transition::examples() {
            let (start, end) = (shape.at(0.0), shape.at(1.0));
            assert!(start.value.abs() < 1e-15 && start.integral.abs() < 1e-15, "{shape:?}");
            assert!((end.value - 1.0).abs() < 1e-14, "{shape:?}");
            for k in 1..20 {
                let x = f64::from(k) / 20.0;
                let (a, b, c) = (shape.at(x - h), shape.at(x), shape.at(x + h));
                // Helmert's slope has a corner in the middle.
                assert!(((c.value - a.value) / (2.0 * h) - b.slope).abs() < 1e-8 || k == 10, "{shape:?} {x}");
                assert!(((c.integral - a.integral) / (2.0 * h) - b.value).abs() < 1e-8, "{shape:?} {x}");
            }
        }
        // Symmetric shapes turn by half of what the full curvature would.
        for shape in [Transition::Linear, Transition::Cosine, Transition::Bloss, Transition::Helmert] {
            assert!((shape.at(1.0).integral - 0.5).abs() < 1e-15);
        }
    }

    #[test]
    fn a_cubic_parabola_has_the_curvature_asked_for_and_its_limit() {
        for turn in [1e-6, 0.05, 0.3, CubicParabola::MAX_TURN] {
            let cubic = CubicParabola::new(turn, false).unwrap();
            assert!((cubic.turn / turn - 1.0).abs() < 1e-12, "{turn}");
        }
        assert_eq!(CubicParabola::new(0.66, false), None);
        assert_eq!(CubicParabola::new(f64::NAN, false), None);
    }
}
