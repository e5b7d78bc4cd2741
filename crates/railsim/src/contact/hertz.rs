//! Hertz's elliptical contact of two bodies of the same material.
//!
//! K. L. Johnson, *Contact Mechanics* (1985), section 4.2. With the relative principal curvatures kx, ky (1/m, sum over
//! both bodies, convex positive), the semi-axes a (along x) and b (along y), p0 = 3N/(2 pi a b) and 1/E* = 2(1 - nu^2)/E,
//! for the longer semi-axis L and the shorter S, k'= S/L, k^2 = 1 - k'^2 and the integrals K, B, D of
//! [`crate::math::elliptic`]:
//!
//! - half the smaller curvature  A = (p0/E*) (S/L^2) D,
//! - half the larger curvature   B' = (p0/E*) (S/L^2) B/k'^2   (eqs. 4.26a and b),
//! - approach                    delta = (p0/E*) S K            (eq. 4.26c).
//!
//! Hence L^3 = 3 N D/(2 pi E* A) and N = C delta^1.5 with C = (2 pi E* L1/(3 K))^1.5, L1 = L/N^(1/3).

use crate::math::elliptic;
use std::f64::consts::PI;

/// What Hertz says about one pair of curvatures, with the load taken out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hertz {
    /// C in N = C delta^1.5, delta the approach of the bodies along the normal, N/m^1.5.
    pub stiffness: f64,
    /// Semi-axis along x (rolling) per cube root of the load, m/N^(1/3).
    pub a1: f64,
    /// Semi-axis along y (lateral) per cube root of the load, m/N^(1/3).
    pub b1: f64,
}

/// Plane-strain modulus E* of two bodies of one material, Pa: E/(2 (1 - nu^2)).
#[must_use]
pub fn effective_modulus(youngs_modulus: f64, poisson: f64) -> f64 {
    youngs_modulus / (2.0 * (1.0 - poisson * poisson))
}

/// ln of the ratio larger/smaller relative curvature B/(k'^2 D) of an ellipse with axis ratio k' = shorter/longer, and its slope over ln k'.
///
/// With X = k^2 B and Y = k^2 D, dX/dk = k K and dY/dk = k E/k'^2.
fn curvature_ratio(k_complementary: f64) -> (f64, f64) {
    let kc2 = k_complementary * k_complementary;
    let k2 = (1.0 - k_complementary) * (1.0 + k_complementary);
    let c = elliptic::complete(k_complementary);
    // a circle's is -3/2: nothing is left of the difference there
    let slope = if k2 < 1e-9 { -1.5 } else { (c.E / c.D - kc2 * c.K / c.B) / k2 - 2.0 };
    ((c.B / (kc2 * c.D)).ln(), slope)
}

/// Axis ratio k' (shorter/longer, 0 < k' <= 1) of the ellipse for a curvature ratio rho >= 1 (larger/smaller).
///
/// Newton in logarithms, from a rational function of ln rho that is right to 5e-4 up to rho = 1e6. A step below 1e-7 leaves an error of its square.
#[must_use]
pub fn axis_ratio(rho: f64) -> f64 {
    if rho <= 1.0 {
        return 1.0;
    }
    let t = rho.ln();
    let start =
        -t * (0.663_443 + t * (0.197_767 + t * 0.024_139_5)) / (1.0 + t * (0.287_207 + t * 0.046_658_4));
    let mut u = start; // ln k'
    for _ in 0..40 {
        let (ratio, slope) = curvature_ratio(u.exp().min(1.0));
        let step = (t - ratio) / slope;
        u = (u + step).min(0.0);
        if step.abs() < 1e-7 {
            break;
        }
    }
    u.exp()
}

/// Hertz constants for relative curvatures kx (rolling direction) and ky (lateral), 1/m, both positive.
///
/// A curvature that is not positive gives NaN: conformal geometry is bounded where curvatures are made
/// ([`crate::contact::geometry_table`]).
#[must_use]
pub fn solve(kx: f64, ky: f64, effective_modulus: f64) -> Hertz {
    if !(kx > 0.0 && ky > 0.0) {
        return Hertz { stiffness: f64::NAN, a1: f64::NAN, b1: f64::NAN };
    }
    let (smaller, larger) = if kx <= ky { (kx, ky) } else { (ky, kx) };
    let kc = axis_ratio(larger / smaller);
    let c = elliptic::complete(kc);
    let longer = (3.0 * c.D / (2.0 * PI * effective_modulus * (0.5 * smaller))).cbrt();
    let shorter = kc * longer;
    let stiffness = (2.0 * PI * effective_modulus * longer / (3.0 * c.K)).powf(1.5);
    let (a1, b1) = if kx <= ky { (longer, shorter) } else { (shorter, longer) };
    Hertz { stiffness, a1, b1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Sphere of radius R on a plane: a^3 = 3 N R/(4 E*), delta = a^2/R, N = (4/3) E* sqrt(R) delta^1.5 (Johnson 4.22-4.24).
    #[test]
    fn sphere_on_plane_closed_form() {
        let (radius, modulus) = (0.46, effective_modulus(210e9, 0.28));
        let h = solve(1.0 / radius, 1.0 / radius, modulus);
        let a1 = (0.75 * radius / modulus).cbrt();
        assert!((h.a1 / a1 - 1.0).abs() < 1e-12 && (h.b1 / a1 - 1.0).abs() < 1e-12);
        assert!((h.stiffness / (4.0 / 3.0 * modulus * radius.sqrt()) - 1.0).abs() < 1e-12);
    }

    /// Hertz's classical table (theta = acos((B-A)/(B+A)), a = m (3N/(4E*(A+B)))^(1/3) and b with n), as printed in
    /// Timoshenko & Goodier, Theory of Elasticity, art. 125: theta 30, 45, 60, 75 degrees. Printed to 4 digits at most.
    #[test]
    fn timoshenko_table_of_ellipses() {
        let modulus = effective_modulus(206e9, 0.3);
        for (theta, m, n) in
            [(30.0_f64, 2.731, 0.493), (45.0, 1.926, 0.604), (60.0, 1.486, 0.717), (75.0, 1.202, 0.846)]
        {
            let cos = theta.to_radians().cos();
            // A + B = 1, B - A = cos(theta); curvatures are 2A and 2B
            let h = solve(1.0 - cos, 1.0 + cos, modulus);
            let scale = (3.0 / (4.0 * modulus)).cbrt();
            println!("theta {theta}: m {:.4} ({m}), n {:.4} ({n})", h.a1 / scale, h.b1 / scale);
            assert!((h.a1 / scale - m).abs() < 0.002 && (h.b1 / scale - n).abs() < 0.002);
        }
    }

    proptest! {
        #[test]
        fn axis_ratio_inverts_the_curvature_ratio(log_rho in 1e-6f64..14.0) {
            let rho = log_rho.exp();
            let back = curvature_ratio(axis_ratio(rho)).0.exp();
            prop_assert!((back / rho - 1.0).abs() < 1e-10, "rho {} back {}", rho, back);
        }

        #[test]
        fn swapping_the_curvatures_swaps_the_axes(kx in 0.1f64..50.0, ky in 0.1f64..50.0) {
            let (h, s) = (solve(kx, ky, 1.1e11), solve(ky, kx, 1.1e11));
            prop_assert!((h.a1 - s.b1).abs() < 1e-15 && (h.stiffness / s.stiffness - 1.0).abs() < 1e-12);
        }

        /// N = C delta^1.5 follows from the energy: pressure integrates to N, so p0 = 3N/(2 pi a b) must give the
        /// curvature sum back: kx/2 + ky/2 = (p0/E*) b E(e)/... (Johnson 4.28 for both axes at once).
        #[test]
        fn semi_axes_reproduce_both_curvatures(kx in 0.5f64..20.0, ky in 0.5f64..20.0) {
            let modulus = 1.14e11;
            let h = solve(kx, ky, modulus);
            let n: f64 = 1e5;
            let (a, b) = (h.a1 * n.cbrt(), h.b1 * n.cbrt());
            let p0 = 1.5 * n / (PI * a * b);
            let (long, short) = if a >= b { (a, b) } else { (b, a) };
            let c = elliptic::complete(short / long);
            let big = p0 / modulus / short * c.B;
            let small = p0 / modulus * short / (long * long) * c.D;
            let (ks, kl) = if kx <= ky { (kx, ky) } else { (ky, kx) };
            prop_assert!((2.0 * big / kl - 1.0).abs() < 1e-9 && (2.0 * small / ks - 1.0).abs() < 1e-9);
        }
    }
}
