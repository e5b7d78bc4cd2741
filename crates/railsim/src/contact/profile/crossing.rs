//! Where a polyline crosses itself.

use crate::error::{Fault, KeyPath};

/// Twice the area of the triangle a, b, c; positive if it turns left.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether two segments cross within both; touching does not count.
fn crosses(p: &[[f64; 2]], q: &[[f64; 2]]) -> bool {
    let opposite = |a: f64, b: f64| (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0);
    opposite(turn(p[0], p[1], q[0]), turn(p[0], p[1], q[1]))
        && opposite(turn(q[0], q[1], p[0]), turn(q[0], q[1], p[1]))
}

/// The first pair of segments (by the later one's index) that cross, by the indices of their first points.
///
/// Segments are swept along the longer side of the profile, so that each is only compared with those beside it.
pub(super) fn first(points: &[[f64; 2]]) -> Option<[usize; 2]> {
    let extent = |axis: usize| {
        let (l, m) = points
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), p| (l.min(p[axis]), m.max(p[axis])));
        m - l
    };
    let axis = usize::from(extent(1) > extent(0));
    let range = |i: usize, axis: usize| {
        let (a, b) = (points[i][axis], points[i + 1][axis]);
        (a.min(b), a.max(b))
    };
    let mut order: Vec<usize> = (0..points.len().saturating_sub(1)).collect();
    order.sort_by(|&i, &j| range(i, axis).0.total_cmp(&range(j, axis).0));
    let mut active: Vec<usize> = Vec::new();
    let mut found: Option<[usize; 2]> = None;
    for i in order {
        let (low, _) = range(i, axis);
        active.retain(|&j| range(j, axis).1 >= low);
        let across = range(i, 1 - axis);
        for &j in &active {
            let other = range(j, 1 - axis);
            if other.0 <= across.1 && across.0 <= other.1 && crosses(&points[i..=i + 1], &points[j..=j + 1]) {
                let pair = [i.min(j), i.max(j)];
                if found.is_none_or(|f| (pair[1], pair[0]) < (f[1], f[0])) {
                    found = Some(pair);
                }
            }
        }
        active.push(i);
    }
    found
}

/// A fault if the polyline crosses itself.
pub(super) fn fault(points: &[[f64; 2]], at: &KeyPath) -> Option<Fault> {
    first(points).map(|[i, j]| {
        let near = points[j];
        Fault::new(
            at.clone(),
            format!(
                "a profile that crosses itself near y = {:.2}, z = {:.2} mm: point {i} to {} and point {j} to {}",
                1e3 * near[0],
                1e3 * near[1],
                i + 1,
                j + 1
            ),
            "a line that does not cross itself",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_crosses_and_a_spiral_does_not() {
        let line = [[0.0, 0.0], [2.0, 2.0], [3.0, 0.0], [1.0, 3.0], [0.0, 3.0]];
        assert_eq!(first(&line), Some([0, 2]));
        let spiral: Vec<_> =
            (0..400).map(|i| f64::from(i) * 0.05).map(|a: f64| [a * a.cos(), a * a.sin()]).collect();
        assert_eq!(first(&spiral), None);
        assert_eq!(first(&line[..1]), None);
    }

    #[test]
    fn touching_and_doubled_points_do_not_cross() {
        assert_eq!(first(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [2.0, 1.0], [1.0, 0.0]]), None);
        assert_eq!(first(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), None);
    }
}
