//! Explicit Runge-Kutta schemes from their Butcher tableau.

use super::{Statistics, StepEnd, System};

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
        statistics: &mut Statistics,
    ) -> StepEnd {
        let Tableau { c, a, b } = self.tableau;
        system.rhs(t, x, &mut self.slopes[0]);
        for (stage, row) in a.iter().enumerate() {
            let (known, rest) = self.slopes.split_at_mut(stage + 1);
            add(&mut self.argument, x, h, row, known);
            system.rhs(t + c[stage + 1] * h, &self.argument, &mut rest[0]);
        }
        for (i, value) in x.iter_mut().enumerate() {
            let increment: f64 = self.slopes.iter().zip(*b).map(|(k, weight)| weight * k[i]).sum();
            *value += h * increment;
        }
        statistics.steps += 1;
        statistics.rhs_evaluations += c.len() as u64;
        StepEnd::Done
    }
}

/// `out = x + h sum weights * slopes`.
fn add(out: &mut [f64], x: &[f64], h: f64, weights: &[f64], slopes: &[Vec<f64>]) {
    for (i, value) in out.iter_mut().enumerate() {
        let increment: f64 = slopes.iter().zip(weights).map(|(k, weight)| weight * k[i]).sum();
        *value = x[i] + h * increment;
    }
}
