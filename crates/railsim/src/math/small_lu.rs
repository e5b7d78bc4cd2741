//! LU decomposition of a small dense matrix in place, with partial pivoting, without allocation after `new`.

/// The matrix has no pivot left in a column: it is singular, or holds a NaN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Singular {
    /// Column in which no pivot was found.
    pub column: usize,
}

/// Storage for one matrix and its factors.
///
/// Doolittle's form with row interchanges (Golub and Van Loan, Matrix Computations, algorithm 3.4.1).
/// Meant for n up to about 12, where the loops beat any blocked routine.
#[derive(Debug, Clone)]
pub struct SmallLu {
    n: usize,
    a: Vec<f64>,
    pivot: Vec<usize>,
}

impl SmallLu {
    /// Room for an `n` by `n` matrix (all zero: fill it through [`Self::matrix_mut`]).
    #[must_use]
    pub fn new(n: usize) -> Self {
        Self { n, a: vec![0.0; n * n], pivot: vec![0; n] }
    }

    /// The matrix, row-major; [`Self::factorise`] overwrites it with its factors.
    pub fn matrix_mut(&mut self) -> &mut [f64] {
        &mut self.a
    }

    /// Replaces the matrix by its factors.
    ///
    /// # Errors
    /// [`Singular`] where a column holds no pivot that is finite and not zero.
    pub fn factorise(&mut self) -> Result<(), Singular> {
        let n = self.n;
        let a = &mut self.a;
        for column in 0..n {
            let mut best = column;
            for row in column + 1..n {
                if a[row * n + column].abs() > a[best * n + column].abs() {
                    best = row;
                }
            }
            let largest = a[best * n + column].abs();
            if !(largest > 0.0 && largest.is_finite()) {
                return Err(Singular { column });
            }
            self.pivot[column] = best;
            if best != column {
                for k in 0..n {
                    a.swap(column * n + k, best * n + k);
                }
            }
            let inverse = 1.0 / a[column * n + column];
            for row in column + 1..n {
                let factor = a[row * n + column] * inverse;
                a[row * n + column] = factor;
                for k in column + 1..n {
                    a[row * n + k] -= factor * a[column * n + k];
                }
            }
        }
        Ok(())
    }

    /// Solves with the factors of the last [`Self::factorise`]; `b` becomes the solution.
    pub fn solve(&self, b: &mut [f64]) {
        let n = self.n;
        debug_assert_eq!(b.len(), n);
        for row in 0..n {
            b.swap(row, self.pivot[row]);
        }
        for row in 1..n {
            let lower = &self.a[row * n..row * n + row];
            let sum: f64 = lower.iter().zip(&*b).map(|(a, x)| a * x).sum();
            b[row] -= sum;
        }
        for row in (0..n).rev() {
            let upper = &self.a[row * n + row + 1..(row + 1) * n];
            let sum: f64 = upper.iter().zip(&b[row + 1..]).map(|(a, x)| a * x).sum();
            b[row] = (b[row] - sum) / self.a[row * n + row];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn residual(n: usize, a: &[f64], x: &[f64], b: &[f64]) -> f64 {
        (0..n).map(|i| ((0..n).map(|k| a[i * n + k] * x[k]).sum::<f64>() - b[i]).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_permutation_needs_pivots() {
        let mut lu = SmallLu::new(3);
        lu.matrix_mut().copy_from_slice(&[0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 4.0, 0.0, 0.0]);
        lu.factorise().unwrap();
        let mut b = [3.0, 8.0, 20.0];
        lu.solve(&mut b);
        assert_eq!(b, [5.0, 3.0, 4.0]);
    }

    #[test]
    fn singular_and_nan_are_told() {
        let mut lu = SmallLu::new(2);
        lu.matrix_mut().copy_from_slice(&[1.0, 2.0, 2.0, 4.0]);
        assert_eq!(lu.factorise(), Err(Singular { column: 1 }));
        lu.matrix_mut().copy_from_slice(&[f64::NAN, 2.0, f64::NAN, 4.0]);
        assert_eq!(lu.factorise(), Err(Singular { column: 0 }));
    }

    proptest! {
        // Partial pivoting is backward stable: the residual is rounding times growth times n (here far below 1e-10).
        #[test]
        fn residual_is_rounding(n in 1_usize..=12, values in prop::collection::vec(-1.0_f64..1.0, 144 + 12)) {
            let mut a = values[..n * n].to_vec();
            for i in 0..n {
                a[i * n + i] += 0.01;
            }
            let b = &values[144..144 + n];
            let mut lu = SmallLu::new(n);
            lu.matrix_mut().copy_from_slice(&a);
            prop_assume!(lu.factorise().is_ok());
            let mut x = b.to_vec();
            lu.solve(&mut x);
            let size = x.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
            prop_assert!(residual(n, &a, &x, b) < 1e-12 * size);
        }
    }
}
