//! Explicit Runge-Kutta schemes from their Butcher tableau.

use super::{Statistics, StepEnd, System, first_slope};

/// Butcher tableau: stage times c, lower triangle a (row by row, without the first, empty row), weights b.
#[derive(Debug)]
pub struct Tableau {
    /// Stage times as fractions of the step.
    pub c: &'static [f64],
    /// Row i holds the weights of stages 0..=i in the argument of stage i + 1.
    pub a: &'static [&'static [f64]],
    /// Weights of the stages in the step.
    pub b: &'static [f64],
}

/// A tableau with its working memory.
#[derive(Debug, Clone)]
pub struct Explicit {
    tableau: &'static Tableau,
    slopes: Vec<Vec<f64>>,
    argument: Vec<f64>,
}

impl Explicit {
    pub fn new(tableau: &'static Tableau, size: usize) -> Self {
        Self { tableau, slopes: vec![vec![0.0; size]; tableau.c.len()], argument: vec![0.0; size] }
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
        let Tableau { c, a, b } = self.tableau;
        first_slope(system, t, x, slope, &mut self.slopes[0], statistics);
        for (stage, row) in a.iter().enumerate() {
            let (known, rest) = self.slopes.split_at_mut(stage + 1);
            let mut terms = known.iter().zip(*row).filter(|(_, weight)| **weight != 0.0);
            match terms.next() {
                Some((k, weight)) => {
                    for ((to, from), k) in self.argument.iter_mut().zip(&*x).zip(k) {
                        *to = from + h * weight * k;
                    }
                }
                None => self.argument.copy_from_slice(x),
            }
            for (k, weight) in terms {
                add(&mut self.argument, h * weight, k);
            }
            system.rhs(t + c[stage + 1] * h, &self.argument, &mut rest[0]);
        }
        for (k, weight) in self.slopes.iter().zip(*b) {
            add(x, h * weight, k);
        }
        statistics.steps += 1;
        statistics.rhs_evaluations += c.len() as u64 - 1;
        StepEnd::Done
    }
}

/// `x += factor * slope`.
fn add(x: &mut [f64], factor: f64, slope: &[f64]) {
    for (value, k) in x.iter_mut().zip(slope) {
        *value += factor * k;
    }
}
