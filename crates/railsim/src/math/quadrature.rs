//! Gauss-Legendre quadrature.

/// Abscissae and weights of the four-point rule on -1..1 (Abramowitz and Stegun, table 25.4): exact for
/// polynomials of degree 7.
pub const GAUSS_4: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_to_degree_seven_and_no_further() {
        for degree in 0..=8 {
            let sum: f64 = GAUSS_4.iter().map(|(x, w)| w * (1.0 + x).powi(degree)).sum();
            let exact = 2.0_f64.powi(degree + 1) / f64::from(degree + 1);
            let error = (sum - exact).abs() / exact;
            assert_eq!(error < 1e-14, degree <= 7, "degree {degree}: {error:.2e}");
        }
    }
}
