//! What the shape of a profile shows: wheel or rail, which way is down, where the flange is.
//!
//! Compared are the middle (the median height of the polyline between 35 and 65 % of the width) and the heights within 15 % of the
//! width from either end that differ most from it. A rail's head hangs at both ends: the same sign, the smaller at
//! least 0.3 of the larger and 4 % of the width. A wheel hangs at one, its flange: by 12 % of the width or more, the other
//! end less than 0.2 of it in the same direction (hollow wear with a false flange stays below), and it is at least 85 mm
//! wide, so that half a rail's head is not taken for one.

use super::ProfileKind;
use super::read::LEAST_POINTS;
use crate::error::{Fault, KeyPath};

/// Narrowest profile, m.
pub(super) const NARROWEST: f64 = 0.01;
/// Widest profile, m.
pub(super) const WIDEST: f64 = 0.3;
/// A wheel is at least this wide, m.
const WHEEL_WIDTH: f64 = 0.085;
/// Samples along the polyline.
const SAMPLES: usize = 2000;

/// What the shape shows; `None` where it does not.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shape {
    /// Wheel or rail.
    pub kind: Option<ProfileKind>,
    /// z points up.
    pub z_up: Option<bool>,
    /// The flange, if this is a wheel, is at the greater y.
    pub flange_positive: Option<bool>,
    /// In words.
    pub words: String,
}

impl Shape {
    /// The shape of points in metres, finite; `said` is what they are known to be.
    pub fn of(points: &[[f64; 2]], said: Option<ProfileKind>) -> Self {
        let unknown = |words: String| Self { kind: None, z_up: None, flange_positive: None, words };
        if points.len() < LEAST_POINTS {
            return unknown(format!("{} points, too few to see a shape", points.len()));
        }
        let (least, most) = width(points);
        let wide = most - least;
        let Some([left, right]) = ends(points, least, wide) else {
            return unknown("a shape that is neither a wheel's nor a rail's".to_owned());
        };
        let (large, small) = if left.abs() >= right.abs() { (left, right) } else { (right, left) };
        let same = large * small > 0.0;
        let rail = same && small.abs() >= 0.3 * large.abs() && small.abs() >= 0.04 * wide;
        let flanged = large.abs() >= 0.12 * wide && !(same && small.abs() >= 0.2 * large.abs());
        let kind = if rail {
            Some(ProfileKind::Rail)
        } else if flanged && wide >= WHEEL_WIDTH {
            Some(ProfileKind::Wheel)
        } else {
            None
        };
        let is_wheel = said.or(kind) == Some(ProfileKind::Wheel);
        let down = said.or(kind).is_some() && large.abs() >= 0.02 * wide && (rail || flanged);
        Self {
            kind,
            z_up: down.then_some(large < 0.0),
            flange_positive: (is_wheel && flanged).then_some(right.abs() > left.abs()),
            words: format!(
                "{:.1} mm wide, the end at y = {:.1} mm is {}, that at {:.1} mm {}",
                1e3 * wide,
                1e3 * least,
                against(left),
                1e3 * most,
                against(right)
            ),
        }
    }
}

fn against(by: f64) -> String {
    format!("{:.1} mm {} z than the middle", 1e3 * by.abs(), if by < 0.0 { "less in" } else { "more in" })
}

/// Least and greatest y.
pub(super) fn width(points: &[[f64; 2]]) -> (f64, f64) {
    points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), p| (l.min(p[0]), m.max(p[0])))
}

/// How far the ends at least and at greatest y differ from the middle, m.
fn ends(points: &[[f64; 2]], least: f64, wide: f64) -> Option<[f64; 2]> {
    let length: f64 = points.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1])).sum();
    if !(length.is_finite() && length > 0.0 && wide > 0.0) {
        return None;
    }
    let step = length / SAMPLES as f64;
    let mut samples = Vec::with_capacity(2 * SAMPLES);
    for w in points.windows(2) {
        let pieces = ((w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]) / step).ceil().max(1.0);
        for i in 0..pieces as usize {
            let t = i as f64 / pieces;
            samples.push([w[0][0] + t * (w[1][0] - w[0][0]), w[0][1] + t * (w[1][1] - w[0][1])]);
        }
    }
    samples.push(points[points.len() - 1]);
    let part = |from: f64, to: f64| {
        samples.iter().filter(move |p| (from..=to).contains(&((p[0] - least) / wide))).map(|p| p[1])
    };
    let mut middle: Vec<f64> = part(0.35, 0.65).collect();
    if middle.is_empty() {
        return None;
    }
    middle.sort_by(f64::total_cmp);
    let middle = middle[middle.len() / 2];
    let farthest = |heights: &mut dyn Iterator<Item = f64>| {
        heights.map(|z| z - middle).max_by(|a, b| a.abs().total_cmp(&b.abs()))
    };
    Some([farthest(&mut part(0.0, 0.15))?, farthest(&mut part(0.85, 1.0))?])
}

/// A fault if the shape plainly is not what it should be.
pub(super) fn wrong_kind(shape: &Shape, should: ProfileKind, at: &KeyPath) -> Option<Fault> {
    shape.kind.filter(|kind| *kind != should).map(|kind| {
        Fault::new(
            at.clone(),
            format!("the shape of a {}: {}", kind.word(), shape.words),
            format!("a {} profile", should.word()),
        )
    })
}

/// A fault if no profile is as wide as this; it says the factor that would mend it.
pub(super) fn wrong_unit(points: &[[f64; 2]], at: &KeyPath) -> Option<Fault> {
    let (least, most) = width(points);
    let wide = most - least;
    if (NARROWEST..=WIDEST).contains(&wide) {
        return None;
    }
    let fits = |factor: f64| (2.0 * NARROWEST..=WIDEST).contains(&(wide * factor));
    let found = if fits(1e3) {
        format!("{:.4} mm wide: 1000 times too narrow, as metres are that should be millimetres", 1e3 * wide)
    } else if fits(1e-3) {
        format!("{wide:.4} m wide: 1000 times too wide, as millimetres are that should be metres")
    } else {
        format!("{:.4} mm wide", 1e3 * wide)
    };
    Some(Fault::new(at.clone(), found, "10 to 300 mm"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wheel() -> Vec<[f64; 2]> {
        (0..=120)
            .map(|i| {
                let y = -0.065 + 1e-3 * f64::from(i);
                [y, if y < -0.035 { (0.95 * (-0.035 - y) + 0.002).min(0.028) } else { -0.05 * y }]
            })
            .collect()
    }

    fn rail() -> Vec<[f64; 2]> {
        (0..=72)
            .map(|i| {
                let y = -0.036 + 1e-3 * f64::from(i);
                [y, 40.0 * y.powi(2) * (1.0 + 5.0 * y)]
            })
            .collect()
    }

    #[test]
    fn wheels_and_rails_whichever_way_they_point() {
        for (points, kind) in [(wheel(), ProfileKind::Wheel), (rail(), ProfileKind::Rail)] {
            for (sy, sz) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                let turned: Vec<_> = points.iter().map(|p| [sy * p[0], sz * p[1]]).collect();
                let shape = Shape::of(&turned, None);
                assert_eq!(shape.kind, Some(kind), "{}", shape.words);
                assert_eq!(shape.z_up, Some(sz < 0.0), "{}", shape.words);
                let flange = (kind == ProfileKind::Wheel).then_some(sy < 0.0);
                assert_eq!(shape.flange_positive, flange, "{}", shape.words);
            }
        }
    }

    #[test]
    fn half_a_head_and_a_cone_show_nothing() {
        let half: Vec<_> = rail().into_iter().filter(|p| p[0] < 0.005).collect();
        assert_eq!(Shape::of(&half, None).kind, None);
        assert_eq!(Shape::of(&half, Some(ProfileKind::Rail)).z_up, Some(false));
        let cone: Vec<_> = (-50..50).map(|i| [1e-3 * f64::from(i), -5e-5 * f64::from(i)]).collect();
        let shape = Shape::of(&cone, Some(ProfileKind::Wheel));
        assert_eq!((shape.kind, shape.z_up, shape.flange_positive), (None, None, None));
    }

    #[test]
    fn a_false_flange_leaves_a_wheel_a_wheel() {
        let mut worn = wheel();
        for p in worn.iter_mut().filter(|p| p[0] > 0.04) {
            p[1] += 0.2 * (p[0] - 0.04);
        }
        assert_eq!(Shape::of(&worn, None).kind, Some(ProfileKind::Wheel));
    }

    #[test]
    fn the_factor_is_said() {
        let at = KeyPath::of("p");
        let times = |f: f64| wheel().iter().map(|p| p.map(|x| f * x)).collect::<Vec<_>>();
        assert!(wrong_unit(&wheel(), &at).is_none());
        assert!(wrong_unit(&times(1e-3), &at).unwrap().found.contains("1000 times too narrow"));
        assert!(wrong_unit(&times(1e3), &at).unwrap().found.contains("1000 times too wide"));
        assert!(wrong_unit(&times(30.0), &at).unwrap().found.contains("mm wide"));
    }
}
