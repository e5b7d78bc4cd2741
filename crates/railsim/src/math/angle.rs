//! Angles as pairs (sine, cosine), so that adding two of them needs no library function.

/// Sine and cosine.
pub type SinCos = (f64, f64);

/// Sine and cosine of a + b.
#[inline(always)]
#[must_use]
pub fn add((sa, ca): SinCos, (sb, cb): SinCos) -> SinCos {
    (sa * cb + ca * sb, ca * cb - sa * sb)
}

/// Sine and cosine of a small angle (rad), by their series to the 9th and 10th power: exact to rounding for
/// |x| <= 0.12; larger angles go to the library.
#[inline(always)]
#[must_use]
pub fn small(x: f64) -> SinCos {
    if x.abs() > 0.12 {
        return x.sin_cos();
    }
    let q = x * x;
    let sin = q * (1.0 / 120.0 - q * (1.0 / 5040.0 - q * (1.0 / 362_880.0)));
    let sin = x - x * q * (1.0 / 6.0 - sin);
    let cos = q * q * (1.0 / 24.0 - q * (1.0 / 720.0 - q * (1.0 / 40_320.0 - q * (1.0 / 3_628_800.0))));
    let cos = 1.0 - (0.5 * q - cos);
    (sin, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_sum_agree_with_the_library_to_rounding() {
        for i in -30..=30 {
            let x = 0.01 * f64::from(i);
            let (s, c) = small(x);
            assert!((s - x.sin()).abs() < 1.2e-16 && (c - x.cos()).abs() < 2.3e-16, "{x}");
            let (s, c) = add(1.1_f64.sin_cos(), small(x));
            assert!((s - (1.1 + x).sin()).abs() < 4e-16 && (c - (1.1 + x).cos()).abs() < 4e-16);
        }
    }
}
