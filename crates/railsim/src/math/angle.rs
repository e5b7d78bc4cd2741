//! Angles as pairs (sine, cosine), so that adding two of them needs no library function.

/// Sine and cosine.
pub type SinCos = (f64, f64);

/// Sine and cosine of a + b.
#[inline(always)]
#[must_use]
pub fn add((sa, ca): SinCos, (sb, cb): SinCos) -> SinCos {
    (sa * cb + ca * sb, ca * cb - sa * sb)
}

/// Up to here (rad) the series is exact to rounding.
const SMALL: f64 = 0.12;

/// Sine and cosine of a small angle (rad), by their series to the 9th and 10th power: exact to rounding for
/// |x| <= 0.12; larger angles go to the library.
#[inline(always)]
#[must_use]
pub fn small(x: f64) -> SinCos {
    if x.abs() > SMALL { x.sin_cos() } else { series(x) }
}

#[inline(always)]
fn series(x: f64) -> SinCos {
    let q = x * x;
    let sin = q * (1.0 / 120.0 - q * (1.0 / 5040.0 - q * (1.0 / 362_880.0)));
    let sin = x - x * q * (1.0 / 6.0 - sin);
    let cos = q * q * (1.0 / 24.0 - q * (1.0 / 720.0 - q * (1.0 / 40_320.0 - q * (1.0 / 3_628_800.0))));
    let cos = 1.0 - (0.5 * q - cos);
    (sin, cos)
}

/// Angles that are worked out side by side.
const LANES: usize = 4;

/// Many small angles, their sines and cosines worked out together: to the bit what [`small`] gives one by one.
#[derive(Debug, Clone)]
pub struct Turns {
    angle: Vec<[f64; LANES]>,
    sin: Vec<[f64; LANES]>,
    cos: Vec<[f64; LANES]>,
}

impl Turns {
    /// `count` angles of zero.
    #[must_use]
    pub fn new(count: usize) -> Self {
        let lanes = |value: f64| vec![[value; LANES]; count.div_ceil(LANES)];
        Self { angle: lanes(0.0), sin: lanes(0.0), cos: lanes(1.0) }
    }

    /// Sets angle `i`, rad.
    #[inline(always)]
    pub fn set(&mut self, i: usize, angle: f64) {
        self.angle.as_flattened_mut()[i] = angle;
    }

    /// Works all of them out.
    #[inline(always)]
    pub fn update(&mut self) {
        for ((x, sin), cos) in self.angle.iter().zip(&mut self.sin).zip(&mut self.cos) {
            let mut out = [[0.0; LANES]; 2];
            let mut large = false;
            for l in 0..LANES {
                let (s, c) = series(x[l]);
                out[0][l] = s;
                out[1][l] = c;
                large |= x[l].abs() > SMALL;
            }
            [*sin, *cos] = out;
            if large {
                for l in 0..LANES {
                    (sin[l], cos[l]) = small(x[l]);
                }
            }
        }
    }

    /// Sine and cosine of angle `i` as of the last [`Self::update`].
    #[inline(always)]
    #[must_use]
    pub fn at(&self, i: usize) -> SinCos {
        (self.sin.as_flattened()[i], self.cos.as_flattened()[i])
    }

    /// Sines and cosines of angles 3 `i` to 3 `i` + 2.
    #[inline(always)]
    #[must_use]
    pub fn three(&self, i: usize) -> [SinCos; 3] {
        let (sin, cos) =
            (&self.sin.as_flattened()[3 * i..3 * i + 3], &self.cos.as_flattened()[3 * i..3 * i + 3]);
        [(sin[0], cos[0]), (sin[1], cos[1]), (sin[2], cos[2])]
    }
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

    #[test]
    fn many_at_once_are_each_by_itself() {
        for count in [1, 4, 9] {
            let mut turns = Turns::new(count);
            let angle = |i: usize| 0.05 * i as f64 - 0.15;
            (0..count).for_each(|i| turns.set(i, angle(i)));
            turns.update();
            (0..count).for_each(|i| assert_eq!(turns.at(i), small(angle(i)), "{i} of {count}"));
        }
    }
}
