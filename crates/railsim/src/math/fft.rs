//! Fast Fourier transform of a length that is a power of two.

/// In place: `x_j <- sum over k of x_k exp(+2 pi i j k / n)`, without a factor. Elements are (real, imaginary).
///
/// Radix 2, decimation in time (Cooley and Tukey 1965). The twiddle factors are computed one by one, not by
/// recurrence, so that the error stays near rounding times log2 n. A length that is not a power of two is a
/// mistake of the caller (checked in debug builds).
pub fn inverse(x: &mut [[f64; 2]]) {
    let n = x.len();
    debug_assert!(n.is_power_of_two());
    if n < 2 {
        return;
    }
    let shift = usize::BITS - n.trailing_zeros();
    for i in 0..n {
        let j = i.reverse_bits() >> shift;
        if j > i {
            x.swap(i, j);
        }
    }
    let twiddle: Vec<[f64; 2]> = (0..n / 2)
        .map(|k| {
            let (s, c) = (std::f64::consts::TAU * k as f64 / n as f64).sin_cos();
            [c, s]
        })
        .collect();
    let mut half = 1;
    while half < n {
        let stride = n / (2 * half);
        for start in (0..n).step_by(2 * half) {
            for k in 0..half {
                let [wr, wi] = twiddle[k * stride];
                let [ar, ai] = x[start + k];
                let [br, bi] = x[start + k + half];
                let (pr, pi) = (br * wr - bi * wi, br * wi + bi * wr);
                x[start + k] = [ar + pr, ai + pi];
                x[start + k + half] = [ar - pr, ai - pi];
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_sum_it_stands_for() {
        let n = 32_usize;
        let x: Vec<[f64; 2]> = (0..n).map(|k| [(k as f64 * 0.7).sin(), (k as f64).cos() * 0.3]).collect();
        let mut fast = x.clone();
        inverse(&mut fast);
        for (j, y) in fast.iter().enumerate() {
            let mut sum = [0.0, 0.0];
            for (k, [re, im]) in x.iter().enumerate() {
                let (s, c) = (std::f64::consts::TAU * (j * k) as f64 / n as f64).sin_cos();
                sum[0] += re * c - im * s;
                sum[1] += re * s + im * c;
            }
            assert!((y[0] - sum[0]).abs() < 1e-13 && (y[1] - sum[1]).abs() < 1e-13);
        }
    }
}
