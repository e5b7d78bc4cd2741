//! Smoothing of a profile: local least squares along the arc.
//!
//! At every station a cubic is fitted to the points within a half-width w of arc length, in axes along and across the
//! local chord, with the biweight (1 - (u/w)^2)^2. Value, slope and curvature at the station are read off the cubic. Because
//! the axes turn with the profile, a flange at 70 degrees is treated as well as the tread; because the curvature
//! comes from some twenty points and not from three, rounding or measuring noise in the points is averaged (noise sigma in the
//! points gives about 7 sigma/(w^2 sqrt(n)) in curvature). An arc keeps its radius exactly (to w^4/R^3); a jump of curvature
//! between arcs becomes a ramp about 1.2 w long.

/// One station of a smoothed profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// Arc length from the first point, m.
    pub s: f64,
    /// Lateral, m.
    pub y: f64,
    /// Down, m.
    pub z: f64,
    /// Direction of the tangent, atan2(dz, dy), rad.
    pub direction: f64,
    /// d(direction)/ds = z''/(1 + z'^2)^1.5, 1/m.
    pub curvature: f64,
}

/// Points closer than this to the one before are dropped as duplicates, m.
const DUPLICATE: f64 = 1e-9;

/// Points with arc length, duplicates dropped, gaps wider than `widest` filled in by the local parabola-tangent cubic.
fn densify(points: &[[f64; 2]], widest: f64) -> Vec<[f64; 3]> {
    let mut unique: Vec<[f64; 3]> = Vec::with_capacity(points.len());
    for p in points {
        match unique.last() {
            Some(l) => {
                let step = (p[0] - l[1]).hypot(p[1] - l[2]);
                let s = l[0] + step;
                if step > DUPLICATE {
                    unique.push([s, p[0], p[1]]);
                }
            }
            None => unique.push([0.0, p[0], p[1]]),
        }
    }
    let n = unique.len();
    if n < 3 {
        return Vec::new();
    }
    // tangent of the parabola through three neighbours, by chord length
    let tangent = |i: usize, axis: usize| -> f64 {
        let (l, m, r) = if i == 0 {
            (0, 1, 2)
        } else if i + 1 == n {
            (n - 3, n - 2, n - 1)
        } else {
            (i - 1, i, i + 1)
        };
        let (h0, h1) = (unique[m][0] - unique[l][0], unique[r][0] - unique[m][0]);
        let (d0, d1) = ((unique[m][axis] - unique[l][axis]) / h0, (unique[r][axis] - unique[m][axis]) / h1);
        let second = (d1 - d0) / (h0 + h1);
        let at_middle = d0 + second * h0;
        if i == 0 {
            at_middle - 2.0 * second * h0
        } else if i + 1 == n {
            at_middle + 2.0 * second * h1
        } else {
            at_middle
        }
    };
    let mut dense = Vec::with_capacity(2 * n);
    for i in 0..n - 1 {
        dense.push(unique[i]);
        let h = unique[i + 1][0] - unique[i][0];
        let pieces = (h / widest).ceil().max(1.0) as usize;
        for k in 1..pieces {
            let t = k as f64 / pieces as f64;
            let (t2, t3) = (t * t, t * t * t);
            let mut point = [unique[i][0] + t * h, 0.0, 0.0];
            for axis in [1, 2] {
                point[axis] = (2.0 * t3 - 3.0 * t2 + 1.0) * unique[i][axis]
                    + (t3 - 2.0 * t2 + t) * h * tangent(i, axis)
                    + (3.0 * t2 - 2.0 * t3) * unique[i + 1][axis]
                    + (t3 - t2) * h * tangent(i + 1, axis);
            }
            dense.push(point);
        }
    }
    dense.push(unique[n - 1]);
    dense
}

/// Solves the symmetric 4 x 4 normal equations; `None` where they are singular.
fn solve4(mut m: [[f64; 5]; 4]) -> Option<[f64; 4]> {
    for i in 0..4 {
        let pivot = (i..4).max_by(|&p, &q| m[p][i].abs().total_cmp(&m[q][i].abs()))?;
        m.swap(i, pivot);
        if m[i][i].abs() < 1e-14 {
            return None;
        }
        for r in i + 1..4 {
            let factor = m[r][i] / m[i][i];
            let row = m[i];
            for (value, above) in m[r].iter_mut().zip(row).skip(i) {
                *value -= factor * above;
            }
        }
    }
    let mut x = [0.0; 4];
    for i in (0..4).rev() {
        let tail: f64 = (i + 1..4).map(|c| m[i][c] * x[c]).sum();
        x[i] = (m[i][4] - tail) / m[i][i];
    }
    Some(x)
}

/// Stations every `spacing` of arc length, smoothed over +-`half_width`; none from fewer than three distinct points.
pub(super) fn stations(points: &[[f64; 2]], spacing: f64, half_width: f64) -> Vec<Station> {
    let dense = densify(points, 0.2 * half_width);
    let Some(length) = dense.last().map(|p| p[0]) else { return Vec::new() };
    let count = (length / spacing).floor() as usize + 1;
    let mut out = Vec::with_capacity(count);
    let (mut low, mut high) = (0, 0);
    for k in 0..count {
        let s = (k as f64 * spacing).min(length);
        while dense[low][0] < s - half_width {
            low += 1;
        }
        while high < dense.len() && dense[high][0] <= s + half_width {
            high += 1;
        }
        if let Some(station) = fit(&dense[low..high], s, half_width) {
            out.push(station);
        }
    }
    out
}

fn fit(window: &[[f64; 3]], s: f64, half_width: f64) -> Option<Station> {
    let (first, last) = (window.first()?, window.last()?);
    let chord = (last[2] - first[2]).atan2(last[1] - first[1]);
    let (sin, cos) = chord.sin_cos();
    // origin: the polyline at s
    let i = window.partition_point(|p| p[0] <= s).clamp(1, window.len() - 1);
    let (p, q) = (window[i - 1], window[i]);
    let t = (s - p[0]) / (q[0] - p[0]);
    let (y0, z0) = (p[1] + t * (q[1] - p[1]), p[2] + t * (q[2] - p[2]));
    let mut normal = [[0.0; 5]; 4];
    for p in window {
        let (dy, dz) = (p[1] - y0, p[2] - z0);
        let u = (dy * cos + dz * sin) / half_width;
        let v = (-dy * sin + dz * cos) / half_width;
        let weight = (1.0 - u * u).max(0.0).powi(2) + 1e-9;
        let powers = [1.0, u, u * u, u * u * u];
        for (r, pr) in powers.iter().enumerate() {
            for (c, pc) in powers.iter().enumerate() {
                normal[r][c] += weight * pr * pc;
            }
            normal[r][4] += weight * pr * v;
        }
    }
    let c = solve4(normal)?;
    let (v, slope, second) = (c[0] * half_width, c[1], 2.0 * c[2] / half_width);
    Some(Station {
        s,
        y: y0 - v * sin,
        z: z0 + v * cos,
        direction: chord + slope.atan(),
        curvature: second / (1.0 + slope * slope).powf(1.5),
    })
}
