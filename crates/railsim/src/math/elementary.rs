//! Arctangent and exponential without a library call: Polach's formula needs both for every contact, several side by side in vector lanes.
//!
//! A library's own depend on the processor (with or without fused multiply-add, found at run time) in their last bit; these do not.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_8, LOG2_E};

/// tan(pi/16), tan(3 pi/16), tan(5 pi/16) and tan(7 pi/16): where one base angle gives way to the next.
const HALFWAY: [f64; 4] =
    [0.198_912_367_379_658, 0.668_178_637_919_298_9, 1.496_605_762_665_489, 5.027_339_492_125_846];
/// tan(pi/8) and tan(3 pi/8).
const FLAT: f64 = 0.414_213_562_373_095_03;
const STEEP: f64 = 2.414_213_562_373_095;

/// Angle whose tangent is y/x, of y >= 0 and x > 0, to two units in the last place.
///
/// arctan(y/x) = base + arctan((y - x t)/(x + y t)) with t = tan(base) of the nearest multiple of pi/8, and what is left (a tangent of at most
/// tan(pi/16)) by Gregory's series to the 23rd power.
#[inline(always)]
#[must_use]
pub fn arctan(y: f64, x: f64) -> f64 {
    let (above, below, base) = if y > HALFWAY[1] * x {
        if y > HALFWAY[3] * x {
            (-x, y, FRAC_PI_2)
        } else if y > HALFWAY[2] * x {
            (y - STEEP * x, x + STEEP * y, 3.0 * FRAC_PI_8)
        } else {
            (y - x, x + y, FRAC_PI_4)
        }
    } else if y > HALFWAY[0] * x {
        (y - FLAT * x, x + FLAT * y, FRAC_PI_8)
    } else {
        (y, x, 0.0)
    };
    let t = above / below;
    let z = t * t;
    let (z2, z4) = (z * z, z * z * (z * z));
    // pairs of terms, so that the processor need not wait for one before the next
    let low = (z * (1.0 / 5.0) - 1.0 / 3.0) + z2 * (z * (1.0 / 9.0) - 1.0 / 7.0);
    let middle = (z * (1.0 / 13.0) - 1.0 / 11.0) + z2 * (z * (1.0 / 17.0) - 1.0 / 15.0);
    let high = (z * (1.0 / 21.0) - 1.0 / 19.0) - z2 * (1.0 / 23.0);
    base + (t + t * z * (low + z4 * (middle + z4 * high)))
}

/// exp(-x) of x >= 0, to two units in the last place; beyond x = 40 that of 40. NaN stays NaN.
///
/// A power of two times exp(r), |r| <= ln(2)/2, by the rational function of Cephes (S. L. Moshier, *Methods and Programs for Mathematical
/// Functions*, 1989).
#[inline(always)]
#[must_use]
pub fn decay(x: f64) -> f64 {
    /// 1.5 times 2^52: adding it rounds to a whole number, which then stands in the lowest bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    /// ln 2 in two parts.
    const LN_2: [f64; 2] = [6.931_457_519_531_25e-1, 1.428_606_820_309_417_2e-6];
    // This way round what is no number passes, and it still is one instruction.
    let x = if 40.0 < x { 40.0 } else { x };
    let shifted = ROUND - x * LOG2_E;
    let power = shifted - ROUND;
    let r = (-x - power * LN_2[0]) - power * LN_2[1];
    let z = r * r;
    let p = r * ((1.261_771_930_748_105_9e-4 * z + 3.029_944_077_074_419_6e-2) * z + 1.0);
    let q = (3.001_985_051_386_644_6e-6 * z + 2.524_483_403_496_841e-3) * (z * z)
        + (2.272_655_482_081_550_3e-1 * z + 2.0);
    let scale = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    (q + p) / (q - p) * scale
}

#[cfg(test)]
mod tests {
    use super::{arctan, decay};

    #[test]
    fn agree_with_the_library() {
        let (mut angle, mut power) = (0.0_f64, 0.0_f64);
        for i in 0..200_000 {
            let y = 10.0_f64.powf(-12.0 + 1.2e-4 * f64::from(i));
            // a power of two as x, so that y/x is not rounded
            let theirs = (y / 32_768.0).atan();
            angle = angle.max((arctan(y, 32_768.0) / theirs - 1.0).abs());
            let x = 2e-4 * f64::from(i);
            power = power.max((decay(x) / (-x).exp() - 1.0).abs());
        }
        println!("largest relative difference: arctan {angle:.2e}, decay {power:.2e}");
        assert!(angle < 6e-16 && power < 6e-16);
        assert_eq!((arctan(0.0, 1.0), decay(0.0)), (0.0, 1.0));
        assert_eq!((arctan(1e300, 1e-300), decay(1e300)), (std::f64::consts::FRAC_PI_2, decay(40.0)));
        assert!(arctan(f64::NAN, 1.0).is_nan() && arctan(1.0, f64::NAN).is_nan() && decay(f64::NAN).is_nan());
    }
}
