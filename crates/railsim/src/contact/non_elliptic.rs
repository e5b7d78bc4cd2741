//! Contact patch without an ellipse: the virtual penetration of Kik and Piotrowski.
//!
//! W. Kik, J. Piotrowski, 2nd Mini Conf. on Contact Mechanics and Wear of Rail/Wheel Systems, Budapest 1996; J. Piotrowski, W. Kik,
//! Vehicle System Dynamics 46 (2008) 27 (equation numbers below); reviewed by J. Piotrowski, H. Chollet, Vehicle System Dynamics 43
//! (2005) 455. Both bodies of one material and half-spaces; the pressure is semi-elliptical along the rolling direction.
//!
//! With the separation f(y) of the undeformed bodies in the plane across the rail, f = 0 where they touch first, and the approach delta:
//!
//! - the patch is where the bodies, moved together by delta_0 = eps delta, would overlap: g(y) = delta_0 - f(y) > 0 (eq. 7), with
//!   eps = [`REDUCTION`] in place of the deformation that the overlap leaves out;
//! - its half-length x_l(y) = sqrt(2 R g(y)), 1/R the relative curvature along the rail;
//! - the pressure p(x, y) = (p0/x_l(y0)) sqrt(x_l(y)^2 - x^2), y0 the place of f = 0;
//! - the deformation at y0 alone is that of the approach, which gives the force (eq. 13, Boussinesq):
//!   N = pi E delta/(2 (1 - nu^2)) I1/I2, I1 = int int sqrt(x_l^2 - x^2) dx dy, I2 = int int sqrt((x_l^2 - x^2)/(x^2 + (y - y0)^2)) dx dy;
//! - p0 = N x_l(y0)/I1.
//!
//! The integrals over x are closed: pi x_l^2/2, and 2 x_l^2 D(k)/s with s^2 = x_l^2 + (y - y0)^2, k^2 = x_l^2/s^2 (D in
//! [`crate::math::elliptic`]).
//!
//! **Error of the method.** On Hertz's geometry the overlap is an ellipse with axes as the square root of the curvatures, which Hertz's
//! are not: the test `hertzian_gaps_against_hertz` prints it. At one load, on a circle, the approach is 3.1 % short, the area 6.6 % large, the
//! peak pressure 6.2 % low; at an axis ratio of 7, either way, 0.7 % short, 21 % large, 17 % low. At one approach the force is 1 to 5 % high.
//! What it is for is the shape of patches that are no ellipses. One pressure scale serves all zones of a gap that touches in several places.

use crate::contact::hertz::effective_modulus;
use crate::error::{Error, Fault, KeyPath, Result};
use crate::math::elliptic;
use crate::math::quadrature::GAUSS_4;
use std::f64::consts::PI;

/// eps, virtual penetration over approach: 0.55 (Kik and Piotrowski 1996; 0.5 would give a circle its own area).
pub const REDUCTION: f64 = 0.55;

/// Separation of two undeformed bodies across the rolling direction, piecewise linear.
#[derive(Debug, Clone, PartialEq)]
pub struct Gap {
    /// Lateral position in the contact plane, m, rising.
    y: Vec<f64>,
    /// Normal separation, m, smallest 0.
    separation: Vec<f64>,
    /// Index of the smallest.
    origin: usize,
}

/// What the bodies are made of, and how they curve along the rail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bodies {
    /// Relative curvature along the rolling direction 1/R, 1/m.
    pub curvature: f64,
    /// Young's modulus of both, Pa.
    pub youngs_modulus: f64,
    /// Poisson's ratio of both.
    pub poisson: f64,
}

/// A contact patch symmetrical along x and of any shape along y.
#[derive(Debug, Clone, PartialEq)]
pub struct NonElliptic {
    /// Approach of the bodies delta, m.
    pub approach: f64,
    /// Normal force N, N.
    pub force: f64,
    /// Largest pressure p0, at x = 0 and the y where the bodies touch first, Pa.
    pub max_pressure: f64,
    /// Area of the patch, m2.
    pub area: f64,
    /// Where the bodies touch first, m.
    pub origin: f64,
    /// Outline: lateral positions, m, rising; the ends of every zone are among them.
    pub y: Vec<f64>,
    /// Outline: half-length x_l at each, m; its square is linear between them.
    pub half_length: Vec<f64>,
}

/// A piece of the overlap between two points: y and x_l^2 at both ends, x_l^2 linear between.
#[derive(Debug, Clone, Copy)]
struct Strip {
    y: [f64; 2],
    square: [f64; 2],
}

impl Gap {
    /// A gap from lateral positions (m, rising) and normal separations (m); only differences of the separation count.
    ///
    /// # Errors
    /// Lists of different length or below three points, a value that is not finite, positions that do not rise, a smallest
    /// separation at either end.
    pub fn new(y: &[f64], separation: &[f64]) -> Result<Self> {
        let fault =
            |found: String, allowed: &str| Err(Error::input(Fault::new(KeyPath::of("gap"), found, allowed)));
        if y.len() != separation.len() || y.len() < 3 {
            return fault(
                format!("{} positions and {} separations", y.len(), separation.len()),
                "as many of the one as of the other, at least 3",
            );
        }
        if let Some(bad) = y.iter().chain(separation).find(|value| !value.is_finite()) {
            return fault(bad.to_string(), "finite numbers");
        }
        if let Some(pair) = y.windows(2).find(|pair| pair[1] <= pair[0]) {
            return fault(format!("y = {} m after {} m", pair[1], pair[0]), "positions that rise");
        }
        let origin = (0..y.len()).min_by(|&i, &j| separation[i].total_cmp(&separation[j])).unwrap_or(0);
        if origin == 0 || origin == y.len() - 1 {
            return fault(
                format!("its smallest separation at its end, y = {} m", y[origin]),
                "a gap that opens to both sides",
            );
        }
        let least = separation[origin];
        Ok(Self { y: y.to_vec(), separation: separation.iter().map(|f| f - least).collect(), origin })
    }

    /// Patch at an approach of the bodies (m, > 0).
    ///
    /// # Errors
    /// An approach that is not positive, or at which the patch would reach the end of the gap; a material or curvature that is not
    /// positive and finite (Poisson's ratio: 0 to 0.5).
    pub fn at_approach(&self, approach: f64, bodies: &Bodies) -> Result<NonElliptic> {
        check(bodies)?;
        let most = self.greatest_approach();
        if !(approach > 0.0 && approach < most) {
            return Err(Error::input(Fault::new(
                KeyPath::of("approach"),
                format!("{approach} m"),
                format!("above 0 and below {most:.3e} m, where the patch reaches the end of the gap"),
            )));
        }
        Ok(self.patch(approach, bodies))
    }

    /// Patch under a normal force (N, > 0).
    ///
    /// # Errors
    /// A force that is not positive, or under which the patch would reach the end of the gap; as [`Gap::at_approach`] for the bodies.
    pub fn at_force(&self, force: f64, bodies: &Bodies) -> Result<NonElliptic> {
        check(bodies)?;
        let most = self.force(self.greatest_approach(), bodies);
        if !(force > 0.0 && force < most) {
            return Err(Error::input(Fault::new(
                KeyPath::of("force"),
                format!("{force} N"),
                format!("above 0 and below {most:.3e} N, where the patch reaches the end of the gap"),
            )));
        }
        let mut low = self.greatest_approach();
        let mut high = low;
        while self.force(low, bodies) >= force {
            (low, high) = (0.5 * low, low);
        }
        // N grows as delta to the power of some 1.5: the false position in logarithms, the older end halved (Illinois)
        let excess = |delta: f64| (self.force(delta, bodies) / force).ln();
        let (mut f_low, mut f_high) = (excess(low), excess(high));
        let mut delta = low;
        for _ in 0..60 {
            delta = low * (high / low).powf(f_low / (f_low - f_high));
            let f = excess(delta);
            if f.abs() < 1e-13 || high / low - 1.0 < 1e-15 {
                break;
            }
            if f < 0.0 {
                (low, f_low, f_high) = (delta, f, 0.5 * f_high);
            } else {
                (high, f_high, f_low) = (delta, f, 0.5 * f_low);
            }
        }
        Ok(self.patch(delta, bodies))
    }

    /// Approach at which the overlap reaches the nearer end of the gap, m.
    fn greatest_approach(&self) -> f64 {
        self.separation[0].min(self.separation[self.separation.len() - 1]) / REDUCTION
    }

    /// The overlap at an approach, cut at its own ends.
    fn strips(&self, approach: f64, curvature: f64) -> impl Iterator<Item = Strip> {
        let square = move |i: usize| 2.0 / curvature * (REDUCTION * approach - self.separation[i]);
        (1..self.y.len()).filter_map(move |i| {
            let (s0, s1) = (square(i - 1), square(i));
            let (y0, y1) = (self.y[i - 1], self.y[i]);
            if s0 <= 0.0 && s1 <= 0.0 {
                return None;
            }
            let end = || y0 + (y1 - y0) * s0 / (s0 - s1);
            Some(match (s0 > 0.0, s1 > 0.0) {
                (true, true) => Strip { y: [y0, y1], square: [s0, s1] },
                (true, false) => Strip { y: [y0, end()], square: [s0, 0.0] },
                _ => Strip { y: [end(), y1], square: [0.0, s1] },
            })
        })
    }

    /// I1 and I2.
    fn integrals(&self, approach: f64, curvature: f64) -> (f64, f64) {
        let origin = self.y[self.origin];
        self.strips(approach, curvature).fold((0.0, 0.0), |(i1, i2), strip| {
            let width = strip.y[1] - strip.y[0];
            (i1 + 0.25 * PI * width * (strip.square[0] + strip.square[1]), i2 + strip.influence(origin))
        })
    }

    fn force(&self, approach: f64, bodies: &Bodies) -> f64 {
        let (i1, i2) = self.integrals(approach, bodies.curvature);
        PI * effective_modulus(bodies.youngs_modulus, bodies.poisson) * approach * i1 / i2
    }

    fn patch(&self, approach: f64, bodies: &Bodies) -> NonElliptic {
        let (i1, i2) = self.integrals(approach, bodies.curvature);
        let force = PI * effective_modulus(bodies.youngs_modulus, bodies.poisson) * approach * i1 / i2;
        let longest = (2.0 * REDUCTION * approach / bodies.curvature).sqrt();
        let (mut y, mut half_length, mut area) = (Vec::new(), Vec::new(), 0.0);
        for strip in self.strips(approach, bodies.curvature) {
            if y.last() != Some(&strip.y[0]) {
                y.push(strip.y[0]);
                half_length.push(strip.square[0].sqrt());
            }
            y.push(strip.y[1]);
            half_length.push(strip.square[1].sqrt());
            area += strip.area();
        }
        let origin = self.y[self.origin];
        NonElliptic { approach, force, max_pressure: force * longest / i1, area, origin, y, half_length }
    }
}

impl Strip {
    /// 2 int x_l dy.
    fn area(&self) -> f64 {
        let [a, b] = self.square.map(f64::sqrt);
        4.0 / 3.0 * (self.y[1] - self.y[0]) * (a * a + a * b + b * b) / (a + b)
    }

    /// Its part of I2. Where the strip begins or ends at the origin the integrand is logarithmic: y - y0 = h s^2 there.
    fn influence(&self, origin: f64) -> f64 {
        let [y0, y1] = self.y;
        let width = y1 - y0;
        let at = |t: f64| {
            let square = self.square[0] + t * (self.square[1] - self.square[0]);
            let distance = (y0 + t * width - origin).abs();
            let s = (square + distance * distance).sqrt();
            2.0 * square * elliptic::complete(distance / s).D / s
        };
        let gauss = |f: &dyn Fn(f64) -> f64, from: f64, to: f64| -> f64 {
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            GAUSS_4.iter().map(|(x, w)| half * w * f(middle + half * x)).sum()
        };
        if y0 == origin || y1 == origin {
            let bent = |s: f64| 2.0 * s * at(if y0 == origin { s * s } else { 1.0 - s * s });
            return width * (gauss(&bent, 0.0, 0.25) + gauss(&bent, 0.25, 1.0));
        }
        width * gauss(&at, 0.0, 1.0)
    }
}

impl NonElliptic {
    /// Semi-axes along and across the rolling direction, m, of an ellipse for the creep laws: of the patch's area, and as long to its width
    /// as the patch at its longest to all of its width.
    #[must_use]
    pub fn ellipse(&self) -> [f64; 2] {
        let longest = self.half_length.iter().copied().fold(0.0, f64::max);
        let half_width = match (self.y.first(), self.y.last()) {
            (Some(first), Some(last)) => 0.5 * (last - first),
            _ => 0.0,
        };
        let scale = (self.area / (PI * longest * half_width)).sqrt();
        [longest * scale, half_width * scale]
    }

    /// Pressure at a point of the contact plane (m), Pa; zero outside the patch.
    #[must_use]
    pub fn pressure(&self, x: f64, y: f64) -> f64 {
        let next = self.y.partition_point(|at| *at <= y);
        if next == 0 || next == self.y.len() {
            return 0.0;
        }
        let t = (y - self.y[next - 1]) / (self.y[next] - self.y[next - 1]);
        let [before, after] = [self.half_length[next - 1], self.half_length[next]];
        let square = before * before * (1.0 - t) + after * after * t;
        // p0/x_l(y0), x_l being longest at y0
        let longest = self.half_length.iter().copied().fold(0.0, f64::max);
        self.max_pressure / longest * (square - x * x).max(0.0).sqrt()
    }
}

fn check(bodies: &Bodies) -> Result<()> {
    let mut faults = Vec::new();
    for (key, value) in [("curvature", bodies.curvature), ("youngs_modulus", bodies.youngs_modulus)] {
        if !(value > 0.0 && value.is_finite()) {
            faults.push(Fault::new(KeyPath::of(key), value.to_string(), "a finite number > 0"));
        }
    }
    if !(0.0..=0.5).contains(&bodies.poisson) {
        faults.push(Fault::new(KeyPath::of("poisson"), bodies.poisson.to_string(), "0 to 0.5"));
    }
    if faults.is_empty() { Ok(()) } else { Err(Error::Input(faults)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::hertz;
    use proptest::prelude::*;

    const STEEL: Bodies = Bodies { curvature: 1.0 / 0.46, youngs_modulus: 210e9, poisson: 0.28 };

    /// f = k y^2/2 to either side, every `step`.
    fn gap(k_left: f64, k_right: f64, half_width: f64, step: f64) -> Gap {
        let count = (half_width / step).round() as i32;
        let y: Vec<f64> = (-count..=count).map(|i| f64::from(i) * step).collect();
        let f: Vec<f64> = y.iter().map(|y| 0.5 * if *y < 0.0 { k_left } else { k_right } * y * y).collect();
        Gap::new(&y, &f).unwrap()
    }

    /// An elliptical overlap with semi-axes A, B has I1 = 2 pi A^2 B/3 and I2 = pi A S K(k), S the shorter of both: the method's force in
    /// closed form is (2 pi/3) E* delta L/K, L the longer. The gap is given every 0.02 mm: its chords are off by step^2/(8 B^2).
    #[test]
    fn elliptical_overlap_closed_form() {
        let modulus = effective_modulus(STEEL.youngs_modulus, STEEL.poisson);
        for ky in [0.1, 0.5, 1.0 / 0.46, 10.0, 40.0] {
            let delta = 60e-6;
            let ours = gap(ky, ky, 30e-3, 2e-5).at_approach(delta, &STEEL).unwrap();
            let axis = |k: f64| (2.0 * REDUCTION * delta / k).sqrt();
            let (a, b) = (axis(STEEL.curvature), axis(ky));
            let (long, short) = (a.max(b), a.min(b));
            let exact = 2.0 * PI / 3.0 * modulus * delta * long / elliptic::complete(short / long).K;
            println!(
                "ky {ky:.2}: {:.6e} N, closed form {exact:.6e}, {:+.1e}",
                ours.force,
                ours.force / exact - 1.0
            );
            assert!((ours.force / exact - 1.0).abs() < 5e-5);
            assert!((ours.area / (PI * a * b) - 1.0).abs() < 5e-5);
            let [ours_a, ours_b] = ours.ellipse();
            assert!((ours_a / a - 1.0).abs() < 5e-5 && (ours_b / b - 1.0).abs() < 5e-5);
            assert!((ours.max_pressure / (1.5 * exact / (PI * a * b)) - 1.0).abs() < 5e-5);
        }
    }

    /// The method's own error: on a circle N/N_Hertz = sqrt(2 eps) at one approach, hence at one load delta (2 eps)^(-1/3), area (2 eps)^(2/3).
    #[test]
    fn hertzian_gaps_against_hertz() {
        let modulus = effective_modulus(STEEL.youngs_modulus, STEEL.poisson);
        let n = 1e5_f64;
        println!(
            "Hertz at 100 kN: b/a, then Kik-Piotrowski over Hertz: approach, area, peak pressure; force at one approach"
        );
        for ky in [0.1, 0.3, 1.0, 1.0 / 0.46, 5.0, 15.0, 50.0] {
            let h = hertz::solve(STEEL.curvature, ky, modulus);
            let gap = gap(ky, ky, 35e-3, 2e-5);
            let ours = gap.at_force(n, &STEEL).unwrap();
            let (a, b) = (h.a1 * n.cbrt(), h.b1 * n.cbrt());
            let delta = (n / h.stiffness).powf(2.0 / 3.0);
            let force = gap.at_approach(delta, &STEEL).unwrap().force / n;
            let ratio = [
                ours.approach / delta,
                ours.area / (PI * a * b),
                ours.max_pressure / (1.5 * n / (PI * a * b)),
            ];
            println!("{:.3}: {:.4} {:.4} {:.4}; {force:.4}", b / a, ratio[0], ratio[1], ratio[2]);
            assert!((ours.force / n - 1.0).abs() < 1e-12);
            if ky == STEEL.curvature {
                assert!((ratio[0] - 1.1_f64.powf(-1.0 / 3.0)).abs() < 1e-4);
                assert!((ratio[1] - 1.1_f64.powf(2.0 / 3.0)).abs() < 1e-4);
                assert!((ratio[2] - 1.1_f64.powf(-2.0 / 3.0)).abs() < 1e-4);
                assert!((force - 1.1_f64.sqrt()).abs() < 1e-4);
            }
            assert!((0.965..1.0).contains(&ratio[0]) && (0.99..1.055).contains(&force), "{ratio:?} {force}");
            assert!((1.06..1.22).contains(&ratio[1]) && (0.82..0.945).contains(&ratio[2]), "{ratio:?}");
        }
    }

    /// Two radii, 500 mm on one side and 50 mm on the other: the patch leans to the flatter side and ends where each half would.
    #[test]
    fn two_radii_make_an_asymmetric_patch() {
        let patch = gap(2.0, 20.0, 20e-3, 2e-5).at_force(1e5, &STEEL).unwrap();
        let (first, last) = (patch.y[0], patch.y[patch.y.len() - 1]);
        let end = |k: f64| (2.0 * REDUCTION * patch.approach / k).sqrt();
        println!(
            "two radii: {:.2} to {:.2} mm, {:.1} mm2, {:.0} MPa",
            1e3 * first,
            1e3 * last,
            1e6 * patch.area,
            1e-6 * patch.max_pressure
        );
        assert!((first / -end(2.0) - 1.0).abs() < 1e-3 && (last / end(20.0) - 1.0).abs() < 1e-3);
        assert!((first / last).abs() > 3.0);
        assert!(patch.pressure(0.0, -3e-3) > 0.0 && patch.pressure(0.0, 3e-3) == 0.0);
    }

    /// The pressure adds up to the force, and vanishes outside.
    #[test]
    fn pressure_integrates_to_the_force() {
        let patch = gap(2.0, 20.0, 20e-3, 2e-5).at_force(8e4, &STEEL).unwrap();
        let (step, mut sum) = (2e-5, 0.0);
        for i in -600..600 {
            for j in -600..600 {
                sum += patch.pressure((f64::from(i) + 0.5) * step, (f64::from(j) + 0.5) * step) * step * step;
            }
        }
        println!("pressure summed {sum:.1} N of 80000");
        assert!((sum / 8e4 - 1.0).abs() < 1e-3);
        assert_eq!(patch.pressure(0.0, 0.1), 0.0);
        assert_eq!(patch.pressure(0.0, f64::NAN), 0.0);
    }

    #[test]
    fn faults_are_named() {
        let message = |result: Result<NonElliptic>| result.unwrap_err().to_string();
        let gap = gap(2.0, 2.0, 5e-3, 1e-4);
        assert!(message(gap.at_force(-1.0, &STEEL)).starts_with("force: found -1 N"));
        assert!(message(gap.at_force(f64::NAN, &STEEL)).starts_with("force: found NaN N"));
        assert!(message(gap.at_force(1e9, &STEEL)).contains("the end of the gap"));
        assert!(message(gap.at_approach(0.0, &STEEL)).starts_with("approach: found 0 m"));
        assert!(
            message(gap.at_force(1.0, &Bodies { curvature: -1.0, ..STEEL }))
                .starts_with("curvature: found -1")
        );
        assert!(Gap::new(&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0]).unwrap_err().to_string().contains("at its end"));
        assert!(Gap::new(&[0.0, 2.0, 1.0], &[1.0, 0.0, 1.0]).unwrap_err().to_string().contains("that rise"));
        assert!(Gap::new(&[0.0, 1.0], &[1.0, 0.0]).unwrap_err().to_string().contains("at least 3"));
        assert!(
            Gap::new(&[0.0, f64::NAN, 1.0], &[1.0, 0.0, 1.0]).unwrap_err().to_string().contains("finite")
        );
    }

    proptest! {
        /// More load: more approach, more area, an outline that contains the old one; on any gap, with several dents too.
        #[test]
        fn patch_grows_with_the_load(
            dents in prop::collection::vec(0.0..30e-6_f64, 41), k in 0.5..30.0_f64, n in 1e3..1e5_f64, more in 1.01..2.0_f64,
        ) {
            let y: Vec<f64> = (0..41).map(|i| (f64::from(i) - 20.0) * 1e-3).collect();
            let f: Vec<f64> = y.iter().zip(&dents).map(|(y, d)| 0.5 * k * y * y + d + if y.abs() > 0.0195 { 0.01 } else { 0.0 }).collect();
            let gap = Gap::new(&y, &f).unwrap();
            let (small, large) = (gap.at_force(n, &STEEL).unwrap(), gap.at_force(n * more, &STEEL).unwrap());
            prop_assert!((small.force / n - 1.0).abs() < 1e-9);
            prop_assert!(large.approach > small.approach && large.area > small.area);
            prop_assert!(large.y[0] <= small.y[0] && large.y[large.y.len() - 1] >= small.y[small.y.len() - 1]);
            prop_assert!(small.half_length.iter().all(|l| l.is_finite() && *l >= 0.0));
        }
    }
}
