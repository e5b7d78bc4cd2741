//! Eigenvalues and eigenvectors of a real matrix without symmetry.
//!
//! Balanced (Parlett and Reinsch, Numer. Math. 13 (1969) 293), brought to Hessenberg form by Householder reflections, then to
//! Schur form by the double-shift QR iteration, whose vectors come by back-substitution: EISPACK's `balanc`, `orthes` and `hqr2`
//! (Peters and Wilkinson, Numer. Math. 16 (1970) 181). Vehicles mix metres with radians and 1e-1 with 1e4 rad/s, so balancing
//! is no luxury.

use nalgebra::{Complex, DMatrix};

/// QR sweeps for one eigenvalue; three are usual.
const MOST_SWEEPS: u32 = 90;
/// Sweeps without result after which an exceptional shift is tried.
const STALLED: u32 = 10;

/// Eigenvalues with their vectors.
#[derive(Debug, Clone)]
pub struct Eigen {
    /// Eigenvalues; conjugate pairs stand together, positive imaginary part first.
    pub values: Vec<Complex<f64>>,
    /// Vectors as columns `v[j]` of length n, not normalised; of a pair the second is the conjugate of the first.
    n: usize,
    vectors: Vec<f64>,
}

impl Eigen {
    /// Of a square matrix; none where it holds a number that is not finite or the iteration stalls.
    #[must_use]
    pub fn new(matrix: &DMatrix<f64>) -> Option<Self> {
        let n = matrix.nrows();
        if matrix.ncols() != n || matrix.iter().any(|v| !v.is_finite()) {
            return None;
        }
        if n == 0 {
            return Some(Self { values: Vec::new(), n, vectors: Vec::new() });
        }
        let mut a = matrix.transpose().as_slice().to_vec(); // row-major
        let scale = balance(&mut a, n);
        let mut v = vec![0.0; n * n];
        hessenberg(&mut a, &mut v, n);
        let mut schur = Schur { n, h: a, v, re: vec![0.0; n], im: vec![0.0; n] };
        schur.iterate()?;
        schur.back_substitute();
        for (row, factor) in schur.v.chunks_exact_mut(n).zip(&scale) {
            row.iter_mut().for_each(|x| *x *= factor);
        }
        let values = schur.re.iter().zip(&schur.im).map(|(re, im)| Complex::new(*re, *im)).collect();
        Some(Self { values, n, vectors: schur.v })
    }

    /// Vector of eigenvalue `j`.
    #[must_use]
    pub fn vector(&self, j: usize) -> Vec<Complex<f64>> {
        let at = |i: usize, j: usize| self.vectors[i * self.n + j];
        (0..self.n)
            .map(|i| match self.values[j].im {
                im if im > 0.0 => Complex::new(at(i, j), at(i, j + 1)),
                im if im < 0.0 => Complex::new(at(i, j - 1), -at(i, j)),
                _ => Complex::new(at(i, j), 0.0),
            })
            .collect()
    }
}

/// Scales rows against columns by powers of two until their norms agree; gives back the scale of each.
fn balance(a: &mut [f64], n: usize) -> Vec<f64> {
    const RADIX: f64 = 2.0;
    let mut scale = vec![1.0; n];
    loop {
        let mut done = true;
        for i in 0..n {
            let (mut c, mut r) = (0.0, 0.0);
            for j in (0..n).filter(|j| *j != i) {
                c += a[j * n + i].abs();
                r += a[i * n + j].abs();
            }
            if c == 0.0 || r == 0.0 {
                continue;
            }
            let (sum, mut f) = (c + r, 1.0);
            while c < r / RADIX {
                f *= RADIX;
                c *= RADIX * RADIX;
            }
            while c >= r * RADIX {
                f /= RADIX;
                c /= RADIX * RADIX;
            }
            if (c + r) / f < 0.95 * sum {
                done = false;
                scale[i] *= f;
                for j in 0..n {
                    a[i * n + j] /= f;
                }
                for j in 0..n {
                    a[j * n + i] *= f;
                }
            }
        }
        if done {
            return scale;
        }
    }
}

/// Householder reduction; `v` becomes the product of the reflections.
fn hessenberg(a: &mut [f64], v: &mut [f64], n: usize) {
    for i in 0..n {
        v[i * n + i] = 1.0;
    }
    let (mut u, mut w) = (vec![0.0; n], vec![0.0; n]);
    for m in 1..n.saturating_sub(1) {
        let size: f64 = (m..n).map(|i| a[i * n + m - 1].abs()).sum();
        if size == 0.0 {
            continue;
        }
        let mut h = 0.0;
        for i in m..n {
            u[i] = a[i * n + m - 1] / size;
            h += u[i] * u[i];
        }
        let g = if u[m] > 0.0 { -h.sqrt() } else { h.sqrt() };
        h -= u[m] * g;
        u[m] -= g;
        // A <- (I - u u'/h) A
        w.fill(0.0);
        for i in m..n {
            let row = &a[i * n..(i + 1) * n];
            w.iter_mut().zip(row).for_each(|(w, x)| *w += u[i] * x);
        }
        for i in m..n {
            let factor = u[i] / h;
            a[i * n..(i + 1) * n].iter_mut().zip(&w).for_each(|(x, w)| *x -= factor * w);
        }
        // A <- A (I - u u'/h), and the same for the product of all.
        for matrix in [&mut *a, &mut *v] {
            for row in matrix.chunks_exact_mut(n) {
                let f: f64 = row[m..].iter().zip(&u[m..]).map(|(x, u)| x * u).sum::<f64>() / h;
                row[m..].iter_mut().zip(&u[m..]).for_each(|(x, u)| *x -= f * u);
            }
        }
        a[m * n + m - 1] = size * g;
        for i in m + 1..n {
            a[i * n + m - 1] = 0.0;
        }
    }
}

/// The matrix on its way to Schur form.
struct Schur {
    n: usize,
    h: Vec<f64>,
    v: Vec<f64>,
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Schur {
    fn h(&self, i: usize, j: usize) -> f64 {
        self.h[i * self.n + j]
    }

    /// First row of the unreduced block that ends in row `last`.
    fn split(&self, last: usize, norm: f64) -> usize {
        let mut l = last;
        while l > 0 {
            let s = self.h(l - 1, l - 1).abs() + self.h(l, l).abs();
            let s = if s == 0.0 { norm } else { s };
            if self.h(l, l - 1).abs() <= f64::EPSILON * s {
                break;
            }
            l -= 1;
        }
        l
    }

    fn iterate(&mut self) -> Option<()> {
        let n = self.n;
        let norm: f64 =
            (0..n).map(|i| (i.saturating_sub(1)..n).map(|j| self.h(i, j).abs()).sum::<f64>()).sum();
        let mut left = n;
        let (mut shifted, mut sweeps) = (0.0, 0);
        while left > 0 {
            let last = left - 1;
            let l = self.split(last, norm);
            if l == last {
                let value = self.h(last, last) + shifted;
                self.h[last * n + last] = value;
                (self.re[last], self.im[last]) = (value, 0.0);
                (left, sweeps) = (left - 1, 0);
            } else if l + 1 == last {
                self.pair(last, shifted);
                (left, sweeps) = (left - 2, 0);
            } else {
                if sweeps == MOST_SWEEPS {
                    return None;
                }
                sweeps += 1;
                self.sweep(l, last, sweeps, &mut shifted);
            }
        }
        Some(())
    }

    /// The last two by two block has come off: two real eigenvalues (then made triangular) or a conjugate pair.
    fn pair(&mut self, last: usize, shifted: f64) {
        let n = self.n;
        let k = last - 1;
        let w = self.h(last, k) * self.h(k, last);
        let p = 0.5 * (self.h(k, k) - self.h(last, last));
        let q = p * p + w;
        self.h[last * n + last] += shifted;
        self.h[k * n + k] += shifted;
        let x = self.h(last, last);
        let z = q.abs().sqrt();
        if q < 0.0 {
            (self.re[k], self.re[last]) = (x + p, x + p);
            (self.im[k], self.im[last]) = (z, -z);
            return;
        }
        let z = if p >= 0.0 { p + z } else { p - z };
        self.re[k] = x + z;
        self.re[last] = if z == 0.0 { x + z } else { x - w / z };
        (self.im[k], self.im[last]) = (0.0, 0.0);
        let x = self.h(last, k);
        let r = x.hypot(z);
        let (p, q) = (x / r, z / r);
        for j in k..n {
            let (a, b) = (self.h(k, j), self.h(last, j));
            self.h[k * n + j] = q * a + p * b;
            self.h[last * n + j] = q * b - p * a;
        }
        for matrix in [&mut self.h, &mut self.v] {
            for row in matrix.chunks_exact_mut(n) {
                let (a, b) = (row[k], row[last]);
                row[k] = q * a + p * b;
                row[last] = q * b - p * a;
            }
        }
    }

    /// One double-shift sweep over rows `l..=last`.
    fn sweep(&mut self, l: usize, last: usize, sweeps: u32, shifted: &mut f64) {
        let n = self.n;
        let mut x = self.h(last, last);
        let mut y = self.h(last - 1, last - 1);
        let mut w = self.h(last, last - 1) * self.h(last - 1, last);
        if sweeps.is_multiple_of(STALLED) {
            *shifted += x;
            for i in 0..=last {
                self.h[i * n + i] -= x;
            }
            let s = self.h(last, last - 1).abs() + self.h(last - 1, last - 2).abs();
            x = 0.75 * s;
            y = x;
            w = -0.4375 * s * s;
        }
        // Where two consecutive small subdiagonal elements let the sweep start.
        let (mut p, mut q, mut r);
        let mut m = last - 2;
        loop {
            let z = self.h(m, m);
            let (a, b) = (x - z, y - z);
            p = (a * b - w) / self.h(m + 1, m) + self.h(m, m + 1);
            q = self.h(m + 1, m + 1) - z - a - b;
            r = self.h(m + 2, m + 1);
            let s = p.abs() + q.abs() + r.abs();
            (p, q, r) = (p / s, q / s, r / s);
            if m == l {
                break;
            }
            let small = self.h(m, m - 1).abs() * (q.abs() + r.abs());
            let beside = self.h(m - 1, m - 1).abs() + z.abs() + self.h(m + 1, m + 1).abs();
            if small < f64::EPSILON * p.abs() * beside {
                break;
            }
            m -= 1;
        }
        for i in m + 2..=last {
            self.h[i * n + i - 2] = 0.0;
            if i > m + 2 {
                self.h[i * n + i - 3] = 0.0;
            }
        }
        for k in m..last {
            let three = k + 1 < last;
            if k != m {
                p = self.h(k, k - 1);
                q = self.h(k + 1, k - 1);
                r = if three { self.h(k + 2, k - 1) } else { 0.0 };
                x = p.abs() + q.abs() + r.abs();
                if x == 0.0 {
                    continue;
                }
                (p, q, r) = (p / x, q / x, r / x);
            }
            let s = (p * p + q * q + r * r).sqrt();
            let s = if p < 0.0 { -s } else { s };
            if s == 0.0 {
                continue;
            }
            if k != m {
                self.h[k * n + k - 1] = -s * x;
            } else if l != m {
                self.h[k * n + k - 1] = -self.h(k, k - 1);
            }
            p += s;
            let reflection = Reflection { k, three, x: p / s, y: q / s, z: r / s, q: q / p, r: r / p };
            reflection.on_rows(&mut self.h, n);
            reflection.on_columns(&mut self.h[..(last.min(k + 3) + 1) * n], n);
            reflection.on_columns(&mut self.v, n);
        }
    }

    /// Vectors of the quasi-triangular form, then of the matrix itself, into `v`.
    fn back_substitute(&mut self) {
        let n = self.n;
        let norm: f64 =
            (0..n).map(|i| (i.saturating_sub(1)..n).map(|j| self.h(i, j).abs()).sum::<f64>()).sum();
        let tiny = f64::EPSILON * norm;
        // Columns of the triangular form's vectors, as rows: the sums below run along memory.
        let mut t = vec![0.0; n * n];
        for j in (0..n).rev() {
            if self.im[j] == 0.0 {
                self.real_vector(j, tiny, &mut t);
            } else if self.im[j] < 0.0 {
                self.complex_vector(j, tiny, &mut t);
            }
        }
        let mut product = vec![0.0; n * n];
        for (row, out) in self.v.chunks_exact(n).zip(product.chunks_exact_mut(n)) {
            for (x, t) in out.iter_mut().zip(t.chunks_exact(n)) {
                *x = row.iter().zip(t).map(|(v, t)| v * t).sum();
            }
        }
        self.v = product;
    }

    fn real_vector(&self, j: usize, tiny: f64, t: &mut [f64]) {
        let n = self.n;
        let p = self.re[j];
        let x = &mut t[j * n..(j + 1) * n];
        x[j] = 1.0;
        let (mut below_w, mut below_r) = (0.0, 0.0);
        for i in (0..j).rev() {
            let row = &self.h[i * n..(i + 1) * n];
            let w = row[i] - p;
            let r: f64 = row[i + 1..=j].iter().zip(&x[i + 1..=j]).map(|(h, x)| h * x).sum();
            if self.im[i] < 0.0 {
                (below_w, below_r) = (w, r);
                continue;
            }
            if self.im[i] == 0.0 {
                x[i] = -r / if w == 0.0 { tiny } else { w };
            } else {
                // Two rows of a block at once: i and i + 1.
                let (upper, lower) = (row[i + 1], self.h(i + 1, i));
                let q = (self.re[i] - p).powi(2) + self.im[i].powi(2);
                let z = (upper * below_r - below_w * r) / q;
                x[i] = z;
                x[i + 1] = if upper.abs() > below_w.abs() {
                    (-r - w * z) / upper
                } else {
                    (-below_r - lower * z) / below_w
                };
            }
            restrain(&mut x[i..=j]);
        }
    }

    /// For the pair `j - 1`, `j`: real parts into row `j - 1` of `t`, imaginary ones into row `j`.
    fn complex_vector(&self, j: usize, tiny: f64, t: &mut [f64]) {
        let n = self.n;
        let k = j - 1;
        let (p, q) = (self.re[j], self.im[j]);
        let (head, tail) = t.split_at_mut(j * n);
        let (re, im) = (&mut head[k * n..], &mut tail[..n]);
        if self.h(j, k).abs() > self.h(k, j).abs() {
            re[k] = q / self.h(j, k);
            im[k] = -(self.h(j, j) - p) / self.h(j, k);
        } else {
            let c = Complex::new(0.0, -self.h(k, j)) / Complex::new(self.h(k, k) - p, q);
            (re[k], im[k]) = (c.re, c.im);
        }
        (re[j], im[j]) = (0.0, 1.0);
        let mut below = (0.0, Complex::new(0.0, 0.0));
        for i in (0..k).rev() {
            let row = &self.h[i * n..(i + 1) * n];
            let sum = |x: &[f64]| row[i + 1..=j].iter().zip(&x[i + 1..=j]).map(|(h, x)| h * x).sum::<f64>();
            let r = Complex::new(sum(re), sum(im));
            let w = row[i] - p;
            if self.im[i] < 0.0 {
                below = (w, r);
                continue;
            }
            if self.im[i] == 0.0 {
                let d = Complex::new(w, q);
                let c = -r / if w == 0.0 && q == 0.0 { Complex::new(tiny, 0.0) } else { d };
                (re[i], im[i]) = (c.re, c.im);
            } else {
                let (upper, lower) = (row[i + 1], self.h(i + 1, i));
                let (z, s) = below;
                let mut d = Complex::new(
                    (self.re[i] - p).powi(2) + self.im[i].powi(2) - q * q,
                    2.0 * q * (self.re[i] - p),
                );
                if d.re == 0.0 && d.im == 0.0 {
                    d.re = tiny * (w.abs() + q.abs() + upper.abs() + lower.abs() + z.abs());
                }
                let c = (upper * s - Complex::new(z, q) * r) / d;
                (re[i], im[i]) = (c.re, c.im);
                let next = if upper.abs() > z.abs() + q.abs() {
                    (-r - Complex::new(w, q) * c) / upper
                } else {
                    (-s - lower * c) / Complex::new(z, q)
                };
                (re[i + 1], im[i + 1]) = (next.re, next.im);
            }
            let largest = re[i].abs().max(im[i].abs());
            if f64::EPSILON * largest * largest > 1.0 {
                re[i..=j].iter_mut().chain(&mut im[i..=j]).for_each(|x| *x /= largest);
            }
        }
    }
}

/// Scales a vector down before its square overflows; its first element is its newest.
fn restrain(x: &mut [f64]) {
    let largest = x[0].abs();
    if f64::EPSILON * largest * largest > 1.0 {
        x.iter_mut().for_each(|x| *x /= largest);
    }
}

/// Reflection of rows (or columns) k, k + 1 and, if `three`, k + 2.
struct Reflection {
    k: usize,
    three: bool,
    x: f64,
    y: f64,
    z: f64,
    q: f64,
    r: f64,
}

impl Reflection {
    fn on_rows(&self, h: &mut [f64], n: usize) {
        let (k, q, r) = (self.k, self.q, self.r);
        let (first, rest) = h[k * n..].split_at_mut(n);
        let (second, third) = rest.split_at_mut(n);
        if self.three {
            for ((a, b), c) in first[k..].iter_mut().zip(&mut second[k..]).zip(&mut third[k..n]) {
                let p = *a + q * *b + r * *c;
                *a -= p * self.x;
                *b -= p * self.y;
                *c -= p * self.z;
            }
        } else {
            for (a, b) in first[k..].iter_mut().zip(&mut second[k..]) {
                let p = *a + q * *b;
                *a -= p * self.x;
                *b -= p * self.y;
            }
        }
    }

    fn on_columns(&self, matrix: &mut [f64], n: usize) {
        let k = self.k;
        for row in matrix.chunks_exact_mut(n) {
            if self.three {
                let p = self.x * row[k] + self.y * row[k + 1] + self.z * row[k + 2];
                row[k] -= p;
                row[k + 1] -= p * self.q;
                row[k + 2] -= p * self.r;
            } else {
                let p = self.x * row[k] + self.y * row[k + 1];
                row[k] -= p;
                row[k + 1] -= p * self.q;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pseudo_random(n: usize, seed: u64) -> DMatrix<f64> {
        let mut state = seed;
        DMatrix::from_fn(n, n, |_, _| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        })
    }

    /// Largest |A v - lambda v| over |A| |v|.
    fn residual(a: &DMatrix<f64>, eigen: &Eigen) -> f64 {
        let complex = a.map(|x| Complex::new(x, 0.0));
        (0..a.nrows())
            .map(|j| {
                let v = nalgebra::DVector::from_vec(eigen.vector(j));
                (&complex * &v - &v * eigen.values[j]).norm() / (v.norm() * a.norm())
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn vectors_satisfy_their_equation_for_sizes_and_scales() {
        for n in [1, 2, 3, 4, 7, 20, 75, 144] {
            let mut a = pseudo_random(n, 7 + n as u64);
            let eigen = Eigen::new(&a).unwrap();
            assert!(residual(&a, &eigen) < 1e-13, "{n}: {}", residual(&a, &eigen));
            let trace: f64 = eigen.values.iter().map(|v| v.re).sum();
            assert!((trace - a.trace()).abs() < 1e-12 * n as f64);
            // Units of very different size: a diagonal similarity does not change the values.
            for i in 0..n {
                let s = 10.0_f64.powi((i % 9) as i32 - 4);
                a.row_mut(i).scale_mut(s);
                a.column_mut(i).scale_mut(1.0 / s);
            }
            let scaled = Eigen::new(&a).unwrap();
            let radius = |e: &Eigen| e.values.iter().map(|v| v.norm()).fold(0.0, f64::max);
            assert!((radius(&scaled) / radius(&eigen) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn companion_matrix_has_the_roots_of_its_polynomial() {
        // (x - 1)(x - 2)(x + 3)(x^2 + 2 x + 17): 1, 2, -3, -1 +- 4i
        let expanded = {
            // From the factors, so that nothing is copied by hand.
            let mut p = vec![1.0];
            for factor in [&[-1.0, 1.0][..], &[-2.0, 1.0], &[3.0, 1.0], &[17.0, 2.0, 1.0]] {
                let mut next = vec![0.0; p.len() + factor.len() - 1];
                for (i, a) in p.iter().enumerate() {
                    for (j, b) in factor.iter().enumerate() {
                        next[i + j] += a * b;
                    }
                }
                p = next;
            }
            p
        };
        let n = 5;
        let a =
            DMatrix::from_fn(
                n,
                n,
                |i, j| {
                    if j == n - 1 { -expanded[i] } else { f64::from(u8::from(i == j + 1)) }
                },
            );
        let mut found = Eigen::new(&a).unwrap().values;
        found.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        let expected = [(-3.0, 0.0), (-1.0, -4.0), (-1.0, 4.0), (1.0, 0.0), (2.0, 0.0)];
        for (f, e) in found.iter().zip(expected) {
            assert!((f.re - e.0).abs() < 1e-11 && (f.im - e.1).abs() < 1e-11, "{f} {e:?}");
        }
    }

    #[test]
    fn defective_and_zero_matrices_end() {
        let jordan = DMatrix::from_fn(6, 6, |i, j| f64::from(u8::from(j == i + 1)));
        assert!(Eigen::new(&jordan).unwrap().values.iter().all(|v| v.norm() < 1e-2));
        assert!(Eigen::new(&DMatrix::zeros(4, 4)).unwrap().values.iter().all(|v| v.norm() == 0.0));
        assert_eq!(Eigen::new(&DMatrix::zeros(0, 0)).unwrap().values.len(), 0);
        assert!(Eigen::new(&DMatrix::from_element(3, 3, f64::NAN)).is_none());
    }
}
