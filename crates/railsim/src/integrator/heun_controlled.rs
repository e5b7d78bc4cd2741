//! Heun's scheme with step-back control: a step whose local error is over tolerance is taken again in smaller ones.
//!
//! The error of a step of length h is that of its predictor, the difference between Euler's and Heun's result,
//! e = |h (k2 - k1)/2|, the largest over the elements of the state: for nothing more than the scheme's own two right-hand
//! sides (E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, section II.4, with the embedded
//! pair of orders 2 and 1). It is of order h^2, so it bounds what the step itself does wrong (order h^3) from far above.
//!
//! Within the outer step every length is a power of 1/2 of it and starts at a multiple of itself: the end of the outer step
//! is met exactly and the same state gives the same bytes. Every outer step tries its whole length first; where that fails
//! the slope at its start is kept and the length goes down by as many halvings as e asks for. After a step with e below an
//! eighth of the tolerance the length doubles again (e grows fourfold).

use super::{Statistics, StepEnd, System, first_slope};

/// After an error below this part of the tolerance the step is doubled: half of what the fourfold error would need.
const DOUBLED_BELOW: f64 = 0.125;

/// The scheme's working memory.
#[derive(Debug, Clone)]
pub struct HeunControlled {
    tolerance: f64,
    halvings: u32,
    k1: Vec<f64>,
    k2: Vec<f64>,
    argument: Vec<f64>,
}

impl HeunControlled {
    pub fn new(tolerance: f64, halvings: u32, size: usize) -> Self {
        let empty = || vec![0.0; size];
        Self { tolerance, halvings, k1: empty(), k2: empty(), argument: empty() }
    }

    pub fn step<S: System>(
        &mut self,
        system: &mut S,
        t: f64,
        x: &mut [f64],
        h: f64,
        slope: Option<&[f64]>,
        statistics: &mut Statistics,
    ) -> StepEnd {
        // Lengths and places within the step are counted in the shortest length allowed.
        let whole = 1_u32 << self.halvings;
        let unit = h / f64::from(whole);
        let (mut done, mut length) = (0, whole);
        let mut known = slope;
        while done < whole {
            let now = t + f64::from(done) * unit;
            first_slope(system, now, x, known.take(), &mut self.k1, statistics);
            let error = loop {
                let h = f64::from(length) * unit;
                let (error, element) = self.try_length(system, now, x, h);
                statistics.rhs_evaluations += 1;
                if error <= self.tolerance {
                    break error;
                }
                statistics.rejected += 1;
                system.reject();
                if length == 1 {
                    return StepEnd::OverTolerance { element };
                }
                length = self.shorter(length, error);
            };
            let half = 0.5 * f64::from(length) * unit;
            for ((x, k1), k2) in x.iter_mut().zip(&self.k1).zip(&self.k2) {
                *x += half * (k1 + k2);
            }
            done += length;
            if error < DOUBLED_BELOW * self.tolerance && done % (2 * length) == 0 && done < whole {
                length *= 2;
            }
        }
        statistics.steps += 1;
        StepEnd::Done
    }

    /// Fills k2 and gives the local error with the element of the state that has it.
    fn try_length<S: System>(&mut self, system: &mut S, t: f64, x: &[f64], h: f64) -> (f64, usize) {
        for ((a, x), k) in self.argument.iter_mut().zip(x).zip(&self.k1) {
            *a = x + h * k;
        }
        system.rhs(t + h, &self.argument, &mut self.k2);
        let mut worst = (0.0, 0);
        for (element, (k1, k2)) in self.k1.iter().zip(&self.k2).enumerate() {
            let error = (0.5 * h * (k2 - k1)).abs();
            if error.is_nan() {
                return (error, element);
            }
            if error > worst.0 {
                worst = (error, element);
            }
        }
        worst
    }

    /// Halved as often as an error that falls with the square of the length asks for, at least once.
    fn shorter(&self, length: u32, error: f64) -> u32 {
        let (mut length, mut expected) = (length / 2, 0.25 * error);
        while length > 1 && expected > self.tolerance {
            length /= 2;
            expected *= 0.25;
        }
        length
    }
}
