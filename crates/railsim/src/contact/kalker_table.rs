//! Kalker's creep coefficients C11, C22, C23, C33 of the linear theory.
//!
//! Constants: J. J. Kalker, *Three-Dimensional Elastic Bodies in Rolling Contact* (1990), Table E.3, for Poisson's ratio
//! 0, 0.25, 0.5 and a/b or b/a = 0.1 .. 1; C33 as in the table of his thesis of 1967. Between the three Poisson's ratios:
//! the parabola through 1/C; for C33 with a > b, which falls nearly in proportion to nu, through C. Between rows: monotone cubics in ln C over ln(a/b) (F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5
//! (1984) 300, eq. 5), because the coefficients go as powers of a/b at both ends: a straight line in a/b would miss C23 and C33 by
//! 10 to 15 % between 0.1 and 0.2. Outside 0.1 <= a/b <= 10 Kalker's asymptotes are used (same table), scaled by a constant that
//! makes them meet the table at the edge: the bare asymptotes step there by up to some 7 %.

use std::f64::consts::PI;

/// Kalker's coefficients of one ellipse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// Longitudinal force per longitudinal creepage.
    pub c11: f64,
    /// Lateral force per lateral creepage.
    pub c22: f64,
    /// Lateral force per spin (and moment per lateral creepage).
    pub c23: f64,
    /// Spin moment per spin.
    pub c33: f64,
}

/// One row: [C11, C22, C23, C33] for nu = 0, 0.25, 0.5.
type Row = [[f64; 3]; 4];

/// Rows of the whole table, in the order of a/b.
const ROWS: usize = 19;

/// a/b = 0.1, 0.2 .. 1.0 (Kalker 1990, Table E.3).
#[allow(clippy::approx_constant)] // 3.14 is a tabulated C22
const NARROW: [Row; 10] = [
    [[2.51, 3.31, 4.85], [2.51, 2.52, 2.53], [0.334, 0.473, 0.731], [6.42, 8.28, 11.7]],
    [[2.59, 3.37, 4.81], [2.59, 2.63, 2.66], [0.483, 0.603, 0.809], [3.46, 4.27, 5.66]],
    [[2.68, 3.44, 4.80], [2.68, 2.75, 2.81], [0.607, 0.715, 0.889], [2.49, 2.96, 3.72]],
    [[2.78, 3.53, 4.82], [2.78, 2.88, 2.98], [0.720, 0.823, 0.977], [2.02, 2.32, 2.77]],
    [[2.88, 3.62, 4.83], [2.88, 3.01, 3.14], [0.827, 0.929, 1.07], [1.74, 1.93, 2.22]],
    [[2.98, 3.72, 4.91], [2.98, 3.14, 3.31], [0.930, 1.03, 1.18], [1.56, 1.68, 1.86]],
    [[3.09, 3.81, 4.97], [3.09, 3.28, 3.48], [1.03, 1.14, 1.29], [1.43, 1.5, 1.6]],
    [[3.19, 3.91, 5.05], [3.19, 3.41, 3.65], [1.13, 1.25, 1.40], [1.34, 1.37, 1.42]],
    [[3.29, 4.01, 5.12], [3.29, 3.54, 3.82], [1.23, 1.36, 1.51], [1.27, 1.27, 1.27]],
    [[3.40, 4.12, 5.20], [3.40, 3.67, 3.98], [1.33, 1.47, 1.63], [1.21, 1.19, 1.16]],
];

/// b/a = 0.1, 0.2 .. 1.0 (Kalker 1990, Table E.3).
const LONG: [Row; 10] = [
    [[10.7, 11.7, 12.9], [10.7, 12.8, 16.0], [12.2, 14.6, 18.0], [0.795, 0.526, 0.228]],
    [[6.96, 7.78, 8.82], [6.96, 8.14, 9.79], [5.72, 6.63, 7.89], [0.828, 0.601, 0.341]],
    [[5.57, 6.34, 7.34], [5.57, 6.40, 7.51], [3.79, 4.32, 5.01], [0.868, 0.674, 0.446]],
    [[4.84, 5.57, 6.57], [4.84, 5.48, 6.31], [2.88, 3.24, 3.70], [0.912, 0.747, 0.549]],
    [[4.37, 5.10, 6.11], [4.37, 4.90, 5.56], [2.35, 2.62, 2.96], [0.958, 0.819, 0.65]],
    [[4.06, 4.78, 5.80], [4.06, 4.50, 5.04], [2.01, 2.23, 2.50], [1.01, 0.892, 0.751]],
    [[3.82, 4.54, 5.58], [3.82, 4.21, 4.67], [1.76, 1.95, 2.18], [1.05, 0.965, 0.852]],
    [[3.65, 4.36, 5.42], [3.65, 3.99, 4.39], [1.58, 1.75, 1.94], [1.1, 1.04, 0.954]],
    [[3.51, 4.22, 5.30], [3.51, 3.81, 4.16], [1.44, 1.59, 1.77], [1.16, 1.11, 1.06]],
    [[3.40, 4.12, 5.20], [3.40, 3.67, 3.98], [1.33, 1.47, 1.63], [1.21, 1.19, 1.16]],
];

/// Parabola through the values at nu = 0, 0.25, 0.5.
fn parabola(c: [f64; 3], nu: f64) -> f64 {
    let l0 = (nu - 0.25) * (nu - 0.5) / 0.125;
    let l1 = -nu * (nu - 0.5) / 0.0625;
    let l2 = nu * (nu - 0.25) / 0.125;
    l0 * c[0] + l1 * c[1] + l2 * c[2]
}

/// The row at Poisson's ratio nu; `long` where a > b.
fn row(row: &Row, nu: f64, long: bool) -> [f64; 4] {
    let mut all = row.map(|c| 1.0 / parabola(c.map(|c| 1.0 / c), nu));
    if long {
        all[3] = parabola(row[3], nu);
    }
    all
}

/// Row `i` of 0 .. 18: a/b = 0.1 .. 1, then b/a = 0.9 .. 0.1.
fn node(i: usize) -> (f64, &'static Row) {
    let g = |i: usize| (i + 1) as f64 / 10.0;
    if i < 10 { (g(i).ln(), &NARROW[i]) } else { (-g(ROWS - 1 - i).ln(), &LONG[ROWS - 1 - i]) }
}

/// Slope of the monotone cubic between a step `h0` with rise `d0` (per unit) and the next, `h1` with `d1`: a harmonic mean weighted by the steps.
fn slope(h0: f64, d0: f64, h1: f64, d1: f64) -> f64 {
    if d0 * d1 <= 0.0 {
        return 0.0;
    }
    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
    (w0 + w1) / (w0 / d0 + w1 / d1)
}

/// Slope at an end of the table: the parabola's, kept from turning round.
fn end_slope(h0: f64, d0: f64, h1: f64, d1: f64) -> f64 {
    let s = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if s * d0 <= 0.0 {
        0.0
    } else if d0 * d1 < 0.0 && s.abs() > 3.0 * d0.abs() {
        3.0 * d0
    } else {
        s
    }
}

/// Monotone cubic in ln C over `u` = ln(a/b) within the table.
fn inside(u: f64, nu: f64) -> [f64; 4] {
    let k = (0..ROWS - 2).take_while(|&i| node(i + 1).0 <= u).count();
    // up to four rows around the interval k .. k + 1
    let first = k.saturating_sub(1);
    let count = (k + 3).min(ROWS) - first;
    let mut x = [0.0; 4];
    let mut y = [[0.0; 4]; 4];
    for i in 0..count {
        let (at, values) = node(first + i);
        x[i] = at;
        y[i] = row(values, nu, first + i >= NARROW.len()).map(f64::ln);
    }
    let j = k - first;
    let h = |i: usize| x[i + 1] - x[i];
    let t = (u - x[j]) / h(j);
    let mut out = [0.0; 4];
    for (c, out) in out.iter_mut().enumerate() {
        let d = |i: usize| (y[i + 1][c] - y[i][c]) / h(i);
        let left =
            if j == 0 { end_slope(h(0), d(0), h(1), d(1)) } else { slope(h(j - 1), d(j - 1), h(j), d(j)) };
        let right = if j + 2 == count {
            end_slope(h(j), d(j), h(j - 1), d(j - 1))
        } else {
            slope(h(j), d(j), h(j + 1), d(j + 1))
        };
        let (s, r) = (1.0 - t, h(j));
        let value = s * s * (1.0 + 2.0 * t) * y[j][c]
            + t * t * (3.0 - 2.0 * t) * y[j + 1][c]
            + s * t * r * (s * left - t * right);
        *out = value.exp();
    }
    out
}

/// Asymptotes for a/b = g << 1.
fn asymptote_narrow(g: f64, nu: f64) -> [f64; 4] {
    [
        PI * PI / (4.0 * (1.0 - nu)),
        PI * PI / 4.0,
        PI * g.sqrt() / (3.0 * (1.0 - nu)) * (1.0 + nu * ((16.0 / g).ln() - 5.0)),
        PI * PI / (16.0 * (1.0 - nu) * g),
    ]
}

/// Asymptotes for b/a = g << 1, L = ln(16/g^2).
fn asymptote_long(g: f64, nu: f64) -> [f64; 4] {
    let l = (16.0 / (g * g)).ln();
    let three = 3.0 - 4.0_f64.ln();
    let d22 = (1.0 - nu) * l + 2.0 * nu;
    let d23 = (1.0 - nu) * l - 2.0 + 4.0 * nu;
    [
        2.0 * PI / ((l - 2.0 * nu) * g) * (1.0 + three / (l - 2.0 * nu)),
        2.0 * PI / (g * d22) * (1.0 + (1.0 - nu) * three / d22),
        2.0 * PI / (3.0 * g * g.sqrt() * d23),
        PI / 4.0 * (1.0 - nu * (l - 2.0) / d23),
    ]
}

/// Coefficients for the axis ratio a/b (a along rolling) and Poisson's ratio nu, 0 <= nu <= 0.5.
///
/// Exact at the table's nodes, continuous everywhere. NaN for a ratio that is not positive.
#[must_use]
pub fn coefficients(a_over_b: f64, nu: f64) -> Coefficients {
    if a_over_b.is_nan() || a_over_b <= 0.0 {
        return Coefficients { c11: f64::NAN, c22: f64::NAN, c23: f64::NAN, c33: f64::NAN };
    }
    let c = if (0.1..=10.0).contains(&a_over_b) {
        inside(a_over_b.ln(), nu)
    } else {
        let narrow = a_over_b < 1.0;
        let (g, edge) = if narrow { (a_over_b, &NARROW[0]) } else { (1.0 / a_over_b, &LONG[0]) };
        let asymptote = if narrow { asymptote_narrow } else { asymptote_long };
        let (at_g, at_edge, edge) = (asymptote(g, nu), asymptote(0.1, nu), row(edge, nu, !narrow));
        [0, 1, 2, 3].map(|i| edge[i] * at_g[i] / at_edge[i])
    };
    Coefficients { c11: c[0], c22: c[1], c23: c[2], c33: c[3] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn kalker_1990_nodes_are_exact() {
        for (k, nu) in [0.0, 0.25, 0.5].into_iter().enumerate() {
            for i in 0..10 {
                let g = f64::from(i as u32 + 1) / 10.0;
                for (ratio, table) in [(g, &NARROW), (1.0 / g, &LONG)] {
                    let c = coefficients(ratio, nu);
                    for (ours, theirs) in [c.c11, c.c22, c.c23, c.c33].into_iter().zip(table[i]) {
                        assert!((ours / theirs[k] - 1.0).abs() < 1e-12, "a/b {ratio} nu {nu}");
                    }
                }
            }
        }
    }

    /// How far the bare asymptotes are from the table at g = 0.1 bounds the scale that joins them.
    #[test]
    fn asymptotes_meet_the_table_within_some_per_cent() {
        for (asymptote, table, name) in
            [(asymptote_narrow as fn(f64, f64) -> [f64; 4], &NARROW, "a<b"), (asymptote_long, &LONG, "a>b")]
        {
            for nu in [0.25, 0.28, 0.3] {
                let (bare, tabled) = (asymptote(0.1, nu), row(&table[0], nu, name == "a>b"));
                let step: Vec<f64> = bare.iter().zip(tabled).map(|(b, t)| b / t - 1.0).collect();
                println!("{name} nu {nu}: asymptote/table - 1 at 0.1: {step:.3?}");
                assert!(step.iter().all(|s| s.abs() < 0.08));
            }
        }
    }

    proptest! {
        #[test]
        fn continuous_over_every_ratio(log_ratio in -5.0f64..5.0, nu in 0.2f64..0.35) {
            let (p, q) = (coefficients(log_ratio.exp(), nu), coefficients((log_ratio + 1e-9).exp(), nu));
            prop_assert!((p.c11 / q.c11 - 1.0).abs() < 1e-7);
            prop_assert!((p.c22 / q.c22 - 1.0).abs() < 1e-7);
            prop_assert!((p.c23 / q.c23 - 1.0).abs() < 1e-7);
            prop_assert!((p.c33 / q.c33 - 1.0).abs() < 1e-7);
        }
    }
}
