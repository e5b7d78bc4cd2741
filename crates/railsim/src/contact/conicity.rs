//! Rolling radius difference and equivalent conicity of a wheelset with the same pair on both sides.
//!
//! EN 15302 (UIC 519): the wavelength of the undamped kinematic motion of the wheelset,
//! expressed as the cone that would have it. With dr(y) = r_right - r_left and S(y) = int_0^y dr dy, the motion of amplitude A
//! has (dy/dx)^2 = 2 (S(A) - S(y))/(e r0); by Klingel's formula tan(gamma_e) = (pi/lambda)^2 2 e r0, where e r0
//! cancels: tan(gamma_e) = pi^2/(8 I^2), I = int_0^A dy/sqrt(2 (S(A) - S(y))). Both sides being mirror images, dr is odd and the motion
//! symmetrical, +-A.
//!
//! [`RadiusCurve`] is of rigid contact by direct search and any two wheels; the methods of [`GeometryTable`] are of elastic contact and a rolling axle:
//! on the reference pairs of UIC 519/EN 15302 (wheels A, B, H, I on rail A, gauge 1435.16 mm, r0 460 mm, 3 mm) this gives 0.177, 0.077, 0.274, 0.512, and
//! 0.171, 0.060, 0.255, 0.503 if the roll of the wheelset is left out, against 0.188, 0.058, 0.245, 0.489 in the standard; its tolerance for calculations is
//! the smaller of 0.05 and half the value.

use crate::contact::geometry_table::{GeometryTable, OutOfTable};
use std::f64::consts::{FRAC_PI_2, PI};

impl GeometryTable {
    /// Rolling radius of the right wheel less that of the left, m, for the wheelset's centre shifted to the right by `y` (m).
    ///
    /// The wheelset rolls about its centre until both wheels touch ([`GeometryTable::touching_roll`]); that
    /// adds (R + r0) tan(gamma)/l0 to the conicity of a cone on a head of radius R, some 5 %. The radii are those of the quasi-elastic contact
    /// positions, so dr is continuous where rigid contact would jump.
    ///
    /// # Errors
    /// A shift outside the table.
    pub fn rolling_radius_difference(&self, y: f64) -> Result<f64, OutOfTable> {
        let roll = self.touching_roll(y)?;
        let dy = self.tape_shift(y, roll);
        Ok(self.touching(dy, roll)?.z_wheel - self.touching(-dy, -roll)?.z_wheel)
    }

    /// Shift of the right wheel's tape-circle point, which lies a radius below the axle.
    fn tape_shift(&self, y: f64, roll: f64) -> f64 {
        y - roll * self.placement().wheel_radius
    }

    /// Roll of the wheelset (rad, right side down positive) at which both wheels touch when its centre is shifted to the
    /// right by `y` (m), by fixed-point iteration (contraction: contact angle times radius over l0, even 1.2 rad
    /// converges with the halved step).
    ///
    /// # Errors
    /// A shift outside the table.
    pub fn touching_roll(&self, y: f64) -> Result<f64, OutOfTable> {
        let least = |gap: [f64; 2]| gap[0].min(gap[1]);
        let mut roll = 0.0;
        for _ in 0..30 {
            let dy = self.tape_shift(y, roll);
            let (right, left) = (least(self.gap(dy, roll)?), least(self.gap(-dy, -roll)?));
            let next = (right - left) / (2.0 * self.placement().tape_half_distance);
            let step = 0.5 * (next - roll);
            roll += step;
            if step.abs() < 1e-9 {
                break;
            }
        }
        Ok(roll)
    }

    /// Equivalent conicity tan(gamma_e) at an amplitude (m, half the peak-to-peak lateral motion) by EN 15302's integration.
    ///
    /// `None` where there is no oscillation of this amplitude (dr does not restore, or the table ends).
    #[must_use]
    pub fn equivalent_conicity(&self, amplitude: f64) -> Option<f64> {
        equivalent_conicity(|y| self.rolling_radius_difference(y).ok(), amplitude)
    }
}

/// Equivalent conicity of any odd dr(y), as [`GeometryTable::equivalent_conicity`].
///
/// Midpoint sums over theta with y = A sin(theta), which removes the singularity at the turning point; 400 steps.
#[must_use]
pub fn equivalent_conicity(dr: impl Fn(f64) -> Option<f64>, amplitude: f64) -> Option<f64> {
    const STEPS: usize = 400;
    if amplitude.is_nan() || amplitude <= 0.0 {
        return None;
    }
    // S at the ends of the steps, by Simpson
    let y = |position: f64| amplitude * (FRAC_PI_2 * position / STEPS as f64).sin();
    let mut s = vec![0.0; STEPS + 1];
    let mut middles = vec![0.0; STEPS];
    let mut before = dr(0.0)?;
    for k in 0..STEPS {
        let (y0, y1) = (y(k as f64), y(k as f64 + 1.0));
        let (middle, after) = (dr(0.5 * (y0 + y1))?, dr(y1)?);
        let h = y1 - y0;
        s[k + 1] = s[k] + h * (before + 4.0 * middle + after) / 6.0;
        // half a step by the parabola through the three
        middles[k] = s[k] + h * (5.0 * before + 8.0 * middle - after) / 24.0;
        before = after;
    }
    let mut integral = 0.0;
    for (k, middle) in middles.iter().enumerate() {
        let (y0, y1) = (y(k as f64), y(k as f64 + 1.0));
        let left = s[STEPS] - middle;
        if left <= 0.0 {
            return None;
        }
        // dy = sqrt(A^2 - y^2) dtheta at the same y as S
        let at = 0.5 * (y0 + y1);
        let dy = (amplitude * amplitude - at * at).sqrt() * FRAC_PI_2 / STEPS as f64;
        integral += dy / (2.0 * left).sqrt();
    }
    Some(PI * PI / (8.0 * integral * integral))
}

/// How an equivalent conicity is taken from a rolling radius difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Wavelength of the kinematic motion by integrating twice (EN 15302, annex B): the reference.
    Integration,
    /// Half the slope of the least-squares line through dr over the amplitude either side of where that line is zero (annex C), in two
    /// steps: a first line finds the centre, a second, about it, the slope.
    Regression,
    /// Half the first harmonic of dr(y0 + A sin) over A (quasi-linearisation).
    Harmonic,
}

impl Method {
    /// By name: `integration`, `regression`, `harmonic`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "integration" => Some(Self::Integration),
            "regression" => Some(Self::Regression),
            "harmonic" => Some(Self::Harmonic),
            _ => None,
        }
    }
}

/// A rolling radius difference dr(y) = r_right - r_left by points, straight between them. Need not be odd: the wheels may differ in
/// profile and diameter.
#[derive(Debug, Clone, PartialEq)]
pub struct RadiusCurve {
    y: Vec<f64>,
    dr: Vec<f64>,
    /// int dr dy from the first point
    s: Vec<f64>,
}

impl RadiusCurve {
    /// From points [y, dr] (m), by rising y; points that are not finite or do not rise are left out.
    #[must_use]
    pub fn new(points: &[[f64; 2]]) -> Self {
        let mut out = Self { y: Vec::new(), dr: Vec::new(), s: Vec::new() };
        for &[y, dr] in points {
            if !(y.is_finite() && dr.is_finite()) || out.y.last().is_some_and(|&last| y <= last) {
                continue;
            }
            let s = match (out.y.last(), out.dr.last(), out.s.last()) {
                (Some(y0), Some(d0), Some(s0)) => s0 + 0.5 * (dr + d0) * (y - y0),
                _ => 0.0,
            };
            out.y.push(y);
            out.dr.push(dr);
            out.s.push(s);
        }
        out
    }

    /// Lateral positions, m.
    #[must_use]
    pub fn y(&self) -> &[f64] {
        &self.y
    }

    /// Rolling radius differences there, m.
    #[must_use]
    pub fn dr(&self) -> &[f64] {
        &self.dr
    }

    fn piece(&self, y: f64) -> Option<(usize, f64)> {
        let (first, last) = (*self.y.first()?, *self.y.last()?);
        if !(y >= first && y <= last) || self.y.len() < 2 {
            return None;
        }
        let i = self.y.partition_point(|&v| v <= y).clamp(1, self.y.len() - 1) - 1;
        Some((i, y - self.y[i]))
    }

    /// dr at y, m; `None` outside.
    #[must_use]
    pub fn at(&self, y: f64) -> Option<f64> {
        let (i, h) = self.piece(y)?;
        Some(self.dr[i] + h * (self.dr[i + 1] - self.dr[i]) / (self.y[i + 1] - self.y[i]))
    }

    /// int dr dy from the first point to y, m2.
    fn integral(&self, y: f64) -> Option<f64> {
        let (i, h) = self.piece(y)?;
        Some(self.s[i] + 0.5 * h * (self.dr[i] + self.at(y)?))
    }

    /// Where the wheelset runs centred: the zero of dr with a rising slope that is nearest to y = 0.
    #[must_use]
    pub fn centre(&self) -> Option<f64> {
        let mut best: Option<f64> = None;
        for i in 0..self.y.len().saturating_sub(1) {
            let (a, b) = (self.dr[i], self.dr[i + 1]);
            if a <= 0.0 && b > 0.0 {
                let y = self.y[i] - a * (self.y[i + 1] - self.y[i]) / (b - a);
                if best.is_none_or(|other| y.abs() < other.abs()) {
                    best = Some(y);
                }
            }
        }
        best
    }

    /// Equivalent conicity tan(gamma_e) at an amplitude (m, half the peak-to-peak lateral motion).
    ///
    /// `None` where there is no oscillation of this amplitude: dr does not restore, or the curve ends.
    #[must_use]
    pub fn conicity(&self, amplitude: f64, method: Method) -> Option<f64> {
        if amplitude.is_nan() || amplitude <= 0.0 {
            return None;
        }
        let conicity = match method {
            Method::Integration => self.by_integration(amplitude),
            Method::Regression => self.by_regression(amplitude),
            Method::Harmonic => self.by_harmonic(amplitude),
        };
        conicity.filter(|c| c.is_finite() && *c > 0.0)
    }

    /// The turning points of the motion of an amplitude: equal integrals of dr, 2 A apart.
    #[must_use]
    pub fn turning_points(&self, amplitude: f64) -> Option<[f64; 2]> {
        let centre = self.centre()?;
        // S(left) - S(left + 2 A) falls from positive (left end far out) to negative as the interval moves to the right
        let excess = |left: f64| Some(self.integral(left)? - self.integral(left + 2.0 * amplitude)?);
        let (mut low, mut high) = (centre - 2.0 * amplitude, centre);
        low = low.max(*self.y.first()?);
        high = high.min(self.y.last()? - 2.0 * amplitude);
        if low >= high || excess(low)? < 0.0 || excess(high)? > 0.0 {
            return None;
        }
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if excess(middle)? > 0.0 { low = middle } else { high = middle }
        }
        Some([low, low + 2.0 * amplitude])
    }

    fn by_integration(&self, amplitude: f64) -> Option<f64> {
        const STEPS: usize = 800;
        let [left, right] = self.turning_points(amplitude)?;
        let (middle, top) = (0.5 * (left + right), self.integral(right)?);
        let mut integral = 0.0;
        for k in 0..STEPS {
            // y = middle + A sin(theta) takes the singularities at the turning points away
            let theta = std::f64::consts::PI * ((k as f64 + 0.5) / STEPS as f64 - 0.5);
            let rest = top - self.integral(middle + amplitude * theta.sin())?;
            if rest <= 0.0 {
                return None;
            }
            integral += amplitude * theta.cos() * PI / STEPS as f64 / (2.0 * rest).sqrt();
        }
        Some(PI * PI / (2.0 * integral * integral))
    }

    /// Slope of the least-squares line over `centre` +- `amplitude`, and where that line is zero; every piece's integrals exact.
    fn line(&self, centre: f64, amplitude: f64) -> Option<[f64; 2]> {
        let (left, right) = (centre - amplitude, centre + amplitude);
        let mut knots = vec![left];
        knots.extend(self.y.iter().copied().filter(|y| *y > left && *y < right));
        knots.push(right);
        let (mut mean, mut moment) = (0.0, 0.0);
        for pair in knots.windows(2) {
            let (h, m) = (pair[1] - pair[0], 0.5 * (pair[0] + pair[1]));
            let (a, b, c) = (self.at(pair[0])?, self.at(m)?, self.at(pair[1])?);
            mean += h * (a + 4.0 * b + c) / 6.0;
            let u = [pair[0] - centre, m - centre, pair[1] - centre];
            moment += h * (a * u[0] + 4.0 * b * u[1] + c * u[2]) / 6.0;
        }
        mean /= 2.0 * amplitude;
        let slope = moment / (2.0 / 3.0 * amplitude.powi(3));
        Some([slope, centre - mean / slope])
    }

    fn by_regression(&self, amplitude: f64) -> Option<f64> {
        let [_, centre] = self.line(self.centre()?, amplitude)?;
        Some(0.5 * self.line(centre, amplitude)?[0])
    }

    fn by_harmonic(&self, amplitude: f64) -> Option<f64> {
        const STEPS: usize = 800;
        let centre = self.centre()?;
        let mut sum = 0.0;
        for k in 0..STEPS {
            let sin = (2.0 * PI * (k as f64 + 0.5) / STEPS as f64).sin();
            sum += self.at(centre + amplitude * sin)? * sin;
        }
        Some(sum / (STEPS as f64 * amplitude))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_is_its_own_equivalent() {
        let conicity = equivalent_conicity(|y| Some(2.0 * 0.05 * y), 3e-3).unwrap();
        println!("cone 0.05: {conicity:.6}");
        assert!((conicity / 0.05 - 1.0).abs() < 1e-4);
    }

    /// dr = c y^3: tan(gamma_e) = pi^2 c A^2/(8 (int_0^1 dt/sqrt((1 - t^4)/2))^2), the lemniscate integral 1.31102878.
    #[test]
    fn cubic_difference_closed_form() {
        let (c, a) = (1000.0_f64, 3e-3_f64);
        let exact = PI * PI * c * a * a / (16.0 * 1.311_028_777_146_06_f64.powi(2));
        let ours = equivalent_conicity(|y| Some(c * y * y * y), a).unwrap();
        println!("cubic: {ours:.6e} exact {exact:.6e}");
        assert!((ours / exact - 1.0).abs() < 1e-4);
    }

    #[test]
    fn a_difference_that_does_not_restore_has_no_conicity() {
        assert_eq!(equivalent_conicity(|y| Some(-0.1 * y), 3e-3), None);
    }
}
