//! Quality of profile points: what a person should know before trusting a contact computed from them.

use serde::Serialize;

use super::shape::{Shape, wrong_kind, wrong_unit};
use super::{HALF_WIDTH, ProfileKind, SPACING, STEEPEST, WIDEST_GAP, crossing, fit, read::LEAST_POINTS};
use crate::error::KeyPath;

/// Points closer than this are the same, m.
const DOUBLED: f64 = 1e-6;
/// A gap this many times the median distance of points, and at least [`LEAST_GAP`], is told, m.
const GAP_RATIO: f64 = 5.0;
/// No gap below this is told, m: the smoothing window is 2 mm wide.
const LEAST_GAP: f64 = 1e-3;
/// A turn at one point by this and by [`KINK_RATIO`] times what its neighbours turn is a kink, rad (5 degrees).
const KINK: f64 = 0.087;
/// See [`KINK`].
const KINK_RATIO: f64 = 4.0;
/// A turn by this is a reversal, rad (120 degrees).
const REVERSAL: f64 = 2.1;
/// Scatter about the smoothed curve from which on it is told, m.
const NOISE: f64 = 2e-6;
/// A point this many times the scatter off the curve, and at least [`LEAST_SPIKE`], is a spike.
const SPIKE_RATIO: f64 = 8.0;
/// No spike below this is told, m.
const LEAST_SPIKE: f64 = 10e-6;
/// Depths below the top at which gauges are measured, m.
const GAUGE_DEPTHS: [f64; 2] = [0.014, 0.016];
/// Shift of a rail's middle between depths from which on it is told, m.
const ASYMMETRY: f64 = 0.3e-3;
/// Findings of one code that are listed one by one.
const LISTED: usize = 20;

/// How much a finding matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Good to know.
    Note,
    /// Contact will be computed, perhaps not of what was meant.
    Warning,
    /// [`Profile::new`](super::Profile::new) refuses such points.
    Error,
}

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Code {
    /// A coordinate that is no finite number.
    NotFinite,
    /// Fewer than 8 points (error), or fewer than one per 2 mm (warning).
    TooFewPoints,
    /// A width that no profile has.
    Width,
    /// The shape of the other kind.
    WrongKind,
    /// A wheel's flange at positive y, or anything upside down.
    Orientation,
    /// Segments that cross.
    SelfCrossing,
    /// A point on the one before.
    DoubledPoint,
    /// Neighbours far apart.
    Gap,
    /// A sudden turn.
    Kink,
    /// The line turns back on itself.
    Reversal,
    /// A stretch that cannot be seen from above or is steeper than 86 degrees: left out of contact.
    Overhang,
    /// Points scatter about the smoothed curve.
    Noise,
    /// A point far off the smoothed curve.
    Spike,
    /// A wheel that does not reach its running circle.
    RunningCircle,
    /// A rail that does not reach down to where the gauge is measured.
    GaugePoint,
    /// A rail whose sides differ: its shape does not say which is the gauge side.
    Asymmetry,
}

/// One finding about a profile.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What.
    pub code: Code,
    /// How much it matters.
    pub severity: Severity,
    /// Index of the point, if it is about one (of a stretch: the first).
    pub index: Option<usize>,
    /// [y, z] there, m.
    pub place: Option<[f64; 2]>,
    /// In words, lengths in mm.
    pub text: String,
}

struct Report<'a> {
    points: &'a [[f64; 2]],
    list: Vec<Finding>,
}

impl Report<'_> {
    fn add(&mut self, code: Code, severity: Severity, index: Option<usize>, text: String) {
        match self.list.iter().filter(|f| f.code == code).count() {
            n if n < LISTED => {
                let place = index.and_then(|i| self.points.get(i)).copied();
                self.list.push(Finding { code, severity, index, place, text });
            }
            LISTED => {
                let text = format!("and more than these {LISTED}");
                self.list.push(Finding { code, severity, index: None, place: None, text });
            }
            _ => {}
        }
    }
}

/// What is remarkable about points [y, z] (m; y outward, z down) of a wheel or rail: the most serious first, then in the
/// order of the points. Empty for a clean profile. Never fails: what cannot be examined is a finding itself.
#[must_use]
pub fn quality(points: &[[f64; 2]], kind: Option<ProfileKind>) -> Vec<Finding> {
    let mut report = Report { points, list: Vec::new() };
    for (i, p) in points.iter().enumerate().filter(|(_, p)| !(p[0].is_finite() && p[1].is_finite())) {
        report.add(Code::NotFinite, Severity::Error, Some(i), format!("point {i} is [{}, {}]", p[0], p[1]));
    }
    if points.len() < LEAST_POINTS {
        let text = format!("{} points; {LEAST_POINTS} are needed at least", points.len());
        report.add(Code::TooFewPoints, Severity::Error, None, text);
    }
    if report.list.is_empty() {
        let at = KeyPath::default();
        if let Some(fault) = wrong_unit(points, &at) {
            report.add(Code::Width, Severity::Error, None, fault.found);
        } else {
            whole(&mut report, kind, &at);
            steps(&mut report);
            turns(&mut report);
            overhangs(&mut report, kind);
            if report.list.iter().all(|f| f.severity < Severity::Error) {
                scatter(&mut report);
            }
        }
    }
    report.list.sort_by_key(|f| std::cmp::Reverse(f.severity));
    report.list
}

/// Kind, orientation, crossing, and what a wheel or a rail must have.
fn whole(report: &mut Report<'_>, kind: Option<ProfileKind>, at: &KeyPath) {
    let points = report.points;
    let shape = Shape::of(points, kind);
    if let Some(fault) = kind.and_then(|kind| wrong_kind(&shape, kind, at)) {
        report.add(Code::WrongKind, Severity::Error, None, fault.found);
        return;
    }
    if shape.z_up == Some(true) {
        report.add(Code::Orientation, Severity::Error, None, format!("z points up: {}", shape.words));
    }
    if shape.flange_positive == Some(true) {
        let text = format!("the flange at positive y: {}", shape.words);
        report.add(Code::Orientation, Severity::Error, None, text);
    }
    if let Some([i, j]) = crossing::first(points) {
        let text = format!("points {i} to {} and {j} to {} cross", i + 1, j + 1);
        report.add(Code::SelfCrossing, Severity::Error, Some(j), text);
    }
    let (least, most) = super::shape::width(points);
    match kind.or(shape.kind) {
        Some(ProfileKind::Wheel) if !(least < 0.0 && most > 0.0) => {
            let text = format!(
                "y from {:.1} to {:.1} mm: without the running circle, y = 0",
                1e3 * least,
                1e3 * most
            );
            report.add(Code::RunningCircle, Severity::Error, None, text);
        }
        Some(ProfileKind::Rail) if shape.z_up != Some(true) => rail(report),
        _ => {}
    }
}

/// Sides of a rail: depth reached, and whether they are alike.
fn rail(report: &mut Report<'_>) {
    let points = report.points;
    let top = points.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
    let summit = points.iter().position(|p| p[1] == top).unwrap_or(0);
    let gauge_first = points.first().zip(points.last()).is_some_and(|(a, b)| a[0] <= b[0]);
    let (before, after) = (&points[..=summit], &points[summit..]);
    let (gauge, field) = if gauge_first { (before, after) } else { (after, before) };
    let reaches = gauge.iter().map(|p| p[1] - top).fold(0.0, f64::max);
    for depth in GAUGE_DEPTHS.into_iter().filter(|depth| reaches < *depth) {
        let text = format!(
            "the gauge side reaches {:.1} mm below the top; a gauge measured {:.0} mm below it has no point there",
            1e3 * reaches,
            1e3 * depth
        );
        report.add(Code::GaugePoint, Severity::Warning, None, text);
    }
    let at = |side: &[[f64; 2]], depth: f64| {
        side.windows(2).find_map(|w| {
            let (a, b) = (w[0][1] - top - depth, w[1][1] - top - depth);
            (a * b <= 0.0 && a != b).then(|| w[0][0] + (w[1][0] - w[0][0]) * a / (a - b))
        })
    };
    // the middle between both sides, at several depths
    let middles: Vec<(f64, f64)> = [2e-3, 5e-3, 10e-3, 14e-3]
        .into_iter()
        .filter_map(|depth| Some((0.5 * (at(gauge, depth)? + at(field, depth)?), depth)))
        .collect();
    let least = middles.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0));
    let most = middles.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((least, most)) = least.zip(most)
        && most.0 - least.0 > ASYMMETRY
    {
        let text = format!(
            "not symmetric (inclined or worn): the middle of the head is at y = {:.2} mm {:.0} mm below the top and at \
             {:.2} mm {:.0} mm below it; the shape does not say which is the gauge side",
            1e3 * least.0,
            1e3 * least.1,
            1e3 * most.0,
            1e3 * most.1
        );
        report.add(Code::Asymmetry, Severity::Note, None, text);
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Doubled points and gaps.
fn steps(report: &mut Report<'_>) {
    let points = report.points;
    let all: Vec<f64> = points.windows(2).map(|w| distance(w[0], w[1])).collect();
    let mut sorted = all.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let length: f64 = all.iter().sum();
    if length / all.len() as f64 > 2e-3 {
        let text = format!("{} points on {:.1} mm", points.len(), 1e3 * length);
        report.add(Code::TooFewPoints, Severity::Warning, None, text);
    }
    for (i, step) in all.iter().enumerate() {
        if *step < DOUBLED {
            let text = format!("point {} lies on point {i}", i + 1);
            report.add(Code::DoubledPoint, Severity::Warning, Some(i + 1), text);
        } else if *step > LEAST_GAP.max(GAP_RATIO * median) {
            let severity = if *step > WIDEST_GAP { Severity::Error } else { Severity::Warning };
            let text = format!(
                "{:.2} mm between points {i} and {}, {:.2} mm is usual",
                1e3 * step,
                i + 1,
                1e3 * median
            );
            report.add(Code::Gap, severity, Some(i), text);
        }
    }
}

/// Kinks and reversals, on the points without doubled ones.
fn turns(report: &mut Report<'_>) {
    let points = report.points;
    let mut unique: Vec<usize> = Vec::with_capacity(points.len());
    for i in 0..points.len() {
        if unique.last().is_none_or(|&l| distance(points[l], points[i]) >= DOUBLED) {
            unique.push(i);
        }
    }
    let direction = |k: usize| {
        let (a, b) = (points[unique[k]], points[unique[k + 1]]);
        (b[1] - a[1]).atan2(b[0] - a[0])
    };
    let turn: Vec<f64> = (0..unique.len().saturating_sub(2))
        .map(|k| {
            let by = direction(k + 1) - direction(k);
            by.sin().atan2(by.cos())
        })
        .collect();
    for (k, by) in turn.iter().enumerate() {
        let i = unique[k + 1];
        let degrees = by.abs().to_degrees();
        if by.abs() > REVERSAL {
            let text = format!("the line turns back by {degrees:.0} degrees at point {i}");
            report.add(Code::Reversal, Severity::Warning, Some(i), text);
            continue;
        }
        // one point out of line: turns there and back, which is a spike
        let net: f64 = [k.wrapping_sub(1), k, k + 1].into_iter().filter_map(|j| turn.get(j)).sum();
        if net.abs() < 0.3 * by.abs() {
            continue;
        }
        let beside = [k.wrapping_sub(2), k.wrapping_sub(1), k + 1, k + 2]
            .into_iter()
            .filter_map(|j| turn.get(j))
            .map(|t| t.abs())
            .fold((0.0, 0.0), |(sum, n), t| (sum + t, n + 1.0));
        let usual = if beside.1 > 0.0 { beside.0 / beside.1 } else { 0.0 };
        if by.abs() > KINK && by.abs() > KINK_RATIO * usual {
            let text = format!(
                "a kink of {degrees:.1} degrees at point {i}; smoothing rounds it over {:.1} mm",
                2e3 * HALF_WIDTH
            );
            report.add(Code::Kink, Severity::Warning, Some(i), text);
        }
    }
}

/// Stretches that contact never sees.
fn overhangs(report: &mut Report<'_>, kind: Option<ProfileKind>) {
    let points = report.points;
    let outward = points.first().zip(points.last()).is_some_and(|(a, b)| a[0] <= b[0]);
    let hidden: Vec<bool> = points
        .windows(2)
        .map(|w| {
            let dy = if outward { w[1][0] - w[0][0] } else { w[0][0] - w[1][0] };
            let dz = (w[1][1] - w[0][1]).abs();
            dy.hypot(dz) >= DOUBLED && dz.atan2(dy) > STEEPEST
        })
        .collect();
    let mut i = 0;
    while i < hidden.len() {
        let mut end = i;
        while end < hidden.len() && hidden[end] {
            end += 1;
        }
        if end > i {
            let run = (points[end][1] - points[i][1]).abs();
            let text = format!(
                "points {i} to {end} are steeper than 86 degrees or overhang, over {:.2} mm of height: left out of contact",
                1e3 * run
            );
            // the sides of a rail's head and the back of a flange are meant to be so
            let at_end = i == 0 || end == hidden.len() || kind == Some(ProfileKind::Rail);
            let severity = if at_end { Severity::Note } else { Severity::Warning };
            report.add(Code::Overhang, severity, Some(i), text);
        }
        i = end.max(i) + 1;
    }
}

/// Noise and spikes, against the smoothed curve.
fn scatter(report: &mut Report<'_>) {
    let points = report.points;
    let stations = fit::stations(points, SPACING, HALF_WIDTH);
    let mut s = 0.0;
    let mut off: Vec<f64> = Vec::with_capacity(points.len());
    let mut last = points[0];
    for p in points {
        s += distance(last, *p);
        last = *p;
        let k = stations.partition_point(|station| station.s <= s);
        let nearest = [k.wrapping_sub(1), k]
            .into_iter()
            .filter_map(|k| stations.get(k))
            .min_by(|a, b| (a.s - s).abs().total_cmp(&(b.s - s).abs()));
        off.push(nearest.map_or(0.0, |n| {
            let (sin, cos) = n.direction.sin_cos();
            let (along, across) =
                ((p[0] - n.y) * cos + (p[1] - n.z) * sin, -(p[0] - n.y) * sin + (p[1] - n.z) * cos);
            (across - 0.5 * n.curvature * along * along).abs()
        }));
    }
    let mut sorted = off.clone();
    sorted.sort_by(f64::total_cmp);
    // median absolute deviation of a normal distribution is 0.6745 of its standard deviation
    let sigma = sorted[sorted.len() / 2] / 0.6745;
    let length = s.max(f64::MIN_POSITIVE);
    if sigma > NOISE {
        let in_window = (2.0 * HALF_WIDTH * points.len() as f64 / length).max(1.0);
        let text = format!(
            "points scatter by {:.1} um about the curve smoothed over +-{:.1} mm: some {:.0} 1/m of curvature, the more \
             smoothing the less (with its square)",
            1e6 * sigma,
            1e3 * HALF_WIDTH,
            7.0 * sigma / (HALF_WIDTH * HALF_WIDTH * in_window.sqrt())
        );
        report.add(Code::Noise, Severity::Warning, None, text);
    }
    for (i, by) in off.iter().enumerate().filter(|(_, by)| **by > LEAST_SPIKE.max(SPIKE_RATIO * sigma)) {
        // a kink is off the smoothed curve as well, and said already
        let kinked = report.list.iter().any(|f| {
            matches!(f.code, Code::Kink | Code::Reversal)
                && f.place.is_some_and(|q| distance(points[i], q) < HALF_WIDTH)
        });
        if !kinked {
            let text = format!("point {i} is {:.1} um off the smoothed curve", 1e6 * by);
            report.add(Code::Spike, Severity::Warning, Some(i), text);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A head of R80 with sides, every 0.1 mm of angle's arc.
    fn head() -> Vec<[f64; 2]> {
        (-400..=400)
            .map(|i| 1.1e-3 * f64::from(i))
            .map(|a: f64| [0.08 * a.sin(), 0.08 * (1.0 - a.cos())])
            .collect()
    }

    fn codes(points: &[[f64; 2]], kind: ProfileKind) -> Vec<(Code, Severity, Option<usize>)> {
        quality(points, Some(kind)).iter().map(|f| (f.code, f.severity, f.index)).collect()
    }

    fn rail_with(change: impl Fn(&mut Vec<[f64; 2]>)) -> Vec<(Code, Severity, Option<usize>)> {
        let mut points = head();
        change(&mut points);
        codes(&points, ProfileKind::Rail)
    }

    /// 7 mm of side is too little for a gauge: the finding that the plain head has.
    fn only_gauge(found: &[(Code, Severity, Option<usize>)]) -> bool {
        found.iter().all(|f| f.0 == Code::GaugePoint)
    }

    #[test]
    fn a_clean_head_lacks_but_its_sides() {
        let found = codes(&head(), ProfileKind::Rail);
        assert_eq!(found.len(), 2);
        assert!(only_gauge(&found), "{found:?}");
    }

    #[test]
    fn every_flaw_is_found_at_its_place() {
        let first = |found: Vec<(Code, Severity, Option<usize>)>, code: Code| {
            found.iter().find(|f| f.0 == code).copied().unwrap_or_else(|| panic!("{code:?} not in {found:?}"))
        };
        let doubled = rail_with(|p| p.insert(200, p[200]));
        assert_eq!(first(doubled, Code::DoubledPoint), (Code::DoubledPoint, Severity::Warning, Some(201)));
        let gap = rail_with(|p| drop(p.drain(200..215)));
        assert_eq!(first(gap, Code::Gap), (Code::Gap, Severity::Warning, Some(199)));
        let wide = rail_with(|p| drop(p.drain(200..450)));
        assert_eq!(first(wide, Code::Gap), (Code::Gap, Severity::Error, Some(199)));
        let kink = rail_with(|p| {
            p.iter_mut().skip(501).for_each(|q| q[1] += 0.3 * (q[0] - 0.08 * (0.11_f64).sin()))
        });
        assert_eq!(first(kink, Code::Kink), (Code::Kink, Severity::Warning, Some(500)));
        let back = rail_with(|p| {
            let again: Vec<_> = p[480..500].iter().rev().map(|q| [q[0], q[1] + 1e-5]).collect();
            p.splice(500..500, again);
        });
        assert_eq!(first(back, Code::Reversal).1, Severity::Warning);
        let spike = rail_with(|p| p[350][1] -= 5e-5);
        assert_eq!(first(spike, Code::Spike), (Code::Spike, Severity::Warning, Some(350)));
        let crossed = rail_with(|p| p.swap(300, 320));
        assert_eq!(first(crossed, Code::SelfCrossing).1, Severity::Error);
        let up = rail_with(|p| p.iter_mut().for_each(|q| q[1] = -q[1]));
        assert_eq!(first(up, Code::Orientation).1, Severity::Error);
        let worn = rail_with(|p| p.iter_mut().filter(|q| q[0] < 0.0).for_each(|q| q[1] *= 1.2));
        assert_eq!(first(worn, Code::Asymmetry).1, Severity::Note);
        let few = rail_with(|p| p.truncate(5));
        assert_eq!(first(few, Code::TooFewPoints).1, Severity::Error);
        let sparse = rail_with(|p| *p = p.iter().step_by(40).copied().collect());
        assert_eq!(first(sparse, Code::TooFewPoints).1, Severity::Warning);
        let nan = rail_with(|p| p[3][0] = f64::NAN);
        assert_eq!(nan, vec![(Code::NotFinite, Severity::Error, Some(3))]);
        let metres = rail_with(|p| p.iter_mut().for_each(|q| *q = q.map(|x| 1e-3 * x)));
        assert_eq!(metres, vec![(Code::Width, Severity::Error, None)]);
        assert_eq!(first(codes(&head(), ProfileKind::Wheel), Code::WrongKind).1, Severity::Error);
        let beside: Vec<_> = (1..120).map(|i| 1e-3 * f64::from(i)).map(|y| [y, -0.05 * y]).collect();
        assert_eq!(first(codes(&beside, ProfileKind::Wheel), Code::RunningCircle).1, Severity::Error);
        // a shelf within a wheel's tread: steeper than 86 degrees, not at an end
        let shelf: Vec<_> = (-40..60)
            .map(|i| 1e-3 * f64::from(i))
            .map(|y| [y, if y < 0.0 { 0.01 } else { -0.02 * y }])
            .flat_map(|p| if p[0] == 0.0 { vec![[0.0, 0.01], p] } else { vec![p] })
            .collect();
        assert_eq!(first(codes(&shelf, ProfileKind::Wheel), Code::Overhang).1, Severity::Warning);
    }

    #[test]
    fn noise_is_measured() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut normal = || (-2.0 * (1.0 - random()).ln()).sqrt() * (std::f64::consts::TAU * random()).cos();
        let noisy: Vec<_> = head().iter().map(|p| [p[0], p[1] + 5e-6 * normal()]).collect();
        let found = quality(&noisy, Some(ProfileKind::Rail));
        let noise = found.iter().find(|f| f.code == Code::Noise).unwrap();
        // sigma as put in, less what the fit of a cubic to some 20 points takes up
        let stated: f64 = noise.text.split_whitespace().nth(3).unwrap().parse().unwrap();
        assert!((4.0..5.5).contains(&stated), "{}", noise.text);
        assert!(!found.iter().any(|f| f.code == Code::Spike), "{found:?}");
    }

    #[test]
    fn many_findings_of_one_kind_are_cut_short() {
        let doubled: Vec<_> = head().iter().flat_map(|p| [*p, *p]).collect();
        let found = quality(&doubled, Some(ProfileKind::Rail));
        let all: Vec<_> = found.iter().filter(|f| f.code == Code::DoubledPoint).collect();
        assert_eq!(all.len(), 21);
        assert!(all[20].text.contains("more than these"));
    }
}
