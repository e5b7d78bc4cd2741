//! How a quantity passes from one value to another along a segment.

/// The shape of a transition as a function of the fraction x = 0..1 of its length. Curvature, cant and gradient of
/// one segment share it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transition {
    /// f = x: curvature grows in proportion to arc length, the clothoid (Euler's spiral).
    Linear,
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
        vec![Self::Linear]
    }

    /// The shape at fraction `x` in 0..=1.
    #[must_use]
    pub fn at(self, x: f64) -> Shape {
        match self {
            Self::Linear => Shape { value: x, slope: 1.0, integral: 0.5 * x * x },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_goes_from_zero_to_one_with_its_own_derivatives() {
        let h = 1e-5;
        for shape in Transition::examples() {
            assert_eq!((shape.at(0.0).value, shape.at(0.0).integral), (0.0, 0.0));
            assert!((shape.at(1.0).value - 1.0).abs() < 1e-15);
            for k in 1..20 {
                let x = f64::from(k) / 20.0;
                let (a, b, c) = (shape.at(x - h), shape.at(x), shape.at(x + h));
                assert!(((c.value - a.value) / (2.0 * h) - b.slope).abs() < 1e-8);
                assert!(((c.integral - a.integral) / (2.0 * h) - b.value).abs() < 1e-8);
            }
        }
    }
}
