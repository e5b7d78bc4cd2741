//! Cubic Hermite interpolation on one cell.

/// Weights of (value left, value right, slope left, slope right) for the value and for the slope of the cubic
/// that takes these values and slopes at the ends of a cell.
#[derive(Debug, Clone, Copy)]
pub struct Hermite {
    /// Weights for the value.
    pub value: [f64; 4],
    /// Weights for the slope with respect to the coordinate (not the fraction).
    pub slope: [f64; 4],
}

impl Hermite {
    /// Weights at `fraction` (0..1) of a cell of length `h`.
    #[must_use]
    pub fn at(fraction: f64, h: f64) -> Self {
        let u = fraction;
        let v = 1.0 - u;
        let bell = 6.0 * u * v / h;
        Self {
            value: [v * v * (1.0 + 2.0 * u), u * u * (1.0 + 2.0 * v), h * u * v * v, -h * u * u * v],
            slope: [-bell, bell, v * (1.0 - 3.0 * u), u * (3.0 * u - 2.0)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reproduces_a_cubic_with_its_slope() {
        let f = |x: f64| 1.3 - 0.7 * x + 0.4 * x * x - 2.1 * x * x * x;
        let d = |x: f64| -0.7 + 0.8 * x - 6.3 * x * x;
        let (a, h) = (0.4, 0.25);
        let ends = [f(a), f(a + h), d(a), d(a + h)];
        for k in 0..=10 {
            let u = f64::from(k) / 10.0;
            let w = Hermite::at(u, h);
            let value: f64 = w.value.iter().zip(ends).map(|(w, e)| w * e).sum();
            let slope: f64 = w.slope.iter().zip(ends).map(|(w, e)| w * e).sum();
            assert!((value - f(a + u * h)).abs() < 1e-14);
            assert!((slope - d(a + u * h)).abs() < 1e-13);
        }
    }
}
