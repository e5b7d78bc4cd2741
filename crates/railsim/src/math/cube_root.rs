//! Cube root without a library call: the patch of every contact needs one in every right-hand side.

/// Cube root of a positive number, to two units in the last place. Anything else (zero, negative, tiny, NaN, infinite) goes to the
/// library.
///
/// `x^(-1/3)` from the exponent bits (to 4 per cent), then twice by the fourth-order step `y (1 + e/3 + 2 e^2/9 + 14 e^3/81)`,
/// `e = 1 - x y^3`, the binomial series of `(1 - e)^(-1/3)`.
#[inline(always)]
#[must_use]
pub fn cube_root(x: f64) -> f64 {
    if !(1e-280..=1e280).contains(&x) {
        return x.cbrt();
    }
    let mut y = f64::from_bits(0x553E_F0FF_289D_D796 - x.to_bits() / 3);
    for _ in 0..2 {
        let e = 1.0 - x * y * y * y;
        y += y * e * (1.0 / 3.0 + e * (2.0 / 9.0 + e * (14.0 / 81.0)));
    }
    x * y * y
}

#[cfg(test)]
mod tests {
    use super::cube_root;

    #[test]
    fn agrees_with_the_library() {
        let mut worst = 0.0_f64;
        for i in 0..60_000 {
            let x = 10.0_f64.powf(-12.0 + 4e-4 * f64::from(i));
            worst = worst.max((cube_root(x) / x.cbrt() - 1.0).abs());
        }
        println!("largest relative difference {worst:.2e}");
        assert!(worst < 5e-16);
        for x in [0.0, -8.0, 1e-300, f64::INFINITY] {
            assert_eq!(cube_root(x), x.cbrt());
        }
        assert!(cube_root(f64::NAN).is_nan());
    }
}
