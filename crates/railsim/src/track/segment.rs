//! Segments of the layout as written, and what is wrong with a list of them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::transition::{CubicParabola, Transition};
use super::{beside, cant, gauge, require};
use crate::error::{Fault, KeyPath};

/// Largest curvature that is accepted, 1/m.
const MAX_CURVATURE: f64 = 0.1;
/// Largest gradient that is accepted, rise per metre.
const MAX_GRADIENT: f64 = 0.2;
/// Longest passage that is accepted, m: its line is summed up in cells before the run.
const MAX_PASSAGE: f64 = 10_000.0;
/// Two segments that meet without a transition may differ by this much in cant (mm) and gradient: rounding.
const SAME: f64 = 1e-9;

/// Straight track.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tangent {
    /// Length, m.
    pub length: f64,
    /// Cant, mm over 1.5 m, + right rail lower.
    #[serde(default)]
    pub cant_mm: f64,
    /// Gradient, rise per metre of horizontal distance, + uphill.
    #[serde(default)]
    pub gradient: f64,
    /// Gauge wider than the track's by this, mm.
    #[serde(default)]
    pub widening_mm: f64,
}

/// Track of constant curvature.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Length, m.
    pub length: f64,
    /// Turning of the heading per metre, 1/m, + to the right. This or `radius`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curvature: Option<f64>,
    /// Radius, m, + to the right. This or `curvature`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Cant, mm over 1.5 m, + right rail lower (so + in a right-hand curve).
    #[serde(default)]
    pub cant_mm: f64,
    /// Gradient, rise per metre of horizontal distance, + uphill.
    #[serde(default)]
    pub gradient: f64,
    /// Gauge wider than the track's by this, mm.
    #[serde(default)]
    pub widening_mm: f64,
}

/// Passage of curvature, cant, gradient angle and gauge from the end of the segment before to the start of the segment
/// after (level straight track of the track's gauge where there is none): a transition curve, a cant ramp on straight track,
/// a gauge ramp, or, between two segments that differ in gradient alone, a vertical curve; a linear one is circular, of
/// radius length / (difference of gradient angles).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Passage {
    /// Length, m.
    pub length: f64,
}

/// One segment of the layout as written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Segment {
    /// Straight track.
    Tangent(Tangent),
    /// Constant curvature.
    Curve(Curve),
    /// Linear passage between its neighbours.
    Clothoid(Passage),
    /// Passage along half a cosine wave.
    Cosine(Passage),
    /// Passage along Bloss's cubic, 3 x^2 - 2 x^3.
    Bloss(Passage),
    /// Passage along two parabolas.
    Helmert(Passage),
    /// Passage between straight track and a curve along a cubic parabola in plan; cant and the rest follow its curvature.
    CubicParabola(Passage),
}

/// What a segment holds at one of its ends: curvature (1/m), cant (mm), gradient (rise per metre), widening (mm).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Ends {
    pub curvature: f64,
    pub cant_mm: f64,
    pub gradient: f64,
    pub widening_mm: f64,
}

impl Segment {
    /// Its length, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        match self {
            Self::Tangent(Tangent { length, .. })
            | Self::Curve(Curve { length, .. })
            | Self::Clothoid(Passage { length })
            | Self::Cosine(Passage { length })
            | Self::Bloss(Passage { length })
            | Self::Helmert(Passage { length })
            | Self::CubicParabola(Passage { length }) => *length,
        }
    }

    /// Its constant values; none for a passage.
    pub(super) fn values(&self) -> Option<Ends> {
        match *self {
            Self::Tangent(Tangent { cant_mm, gradient, widening_mm, .. }) => {
                Some(Ends { curvature: 0.0, cant_mm, gradient, widening_mm })
            }
            Self::Curve(Curve { curvature, radius, cant_mm, gradient, widening_mm, .. }) => {
                let curvature = curvature.or(radius.map(|r| 1.0 / r)).unwrap_or(0.0);
                Some(Ends { curvature, cant_mm, gradient, widening_mm })
            }
            _ => None,
        }
    }

    /// The word in a file.
    fn name(&self) -> &'static str {
        match self {
            Self::Tangent(_) => "tangent",
            Self::Curve(_) => "curve",
            Self::Clothoid(_) => "clothoid",
            Self::Cosine(_) => "cosine",
            Self::Bloss(_) => "bloss",
            Self::Helmert(_) => "helmert",
            Self::CubicParabola(_) => "cubic_parabola",
        }
    }

    /// How a passage between these ends goes. A cubic parabola that there is none of (its faults say so) goes linearly.
    pub(super) fn transition(&self, [from, to]: [Ends; 2]) -> Transition {
        match self {
            Self::Cosine(_) => Transition::Cosine,
            Self::Bloss(_) => Transition::Bloss,
            Self::Helmert(_) => Transition::Helmert,
            Self::CubicParabola(Passage { length }) => {
                let turn = length * from.curvature.abs().max(to.curvature.abs());
                CubicParabola::new(turn, from.curvature != 0.0)
                    .map_or(Transition::Linear, Transition::CubicParabola)
            }
            Self::Tangent(_) | Self::Curve(_) | Self::Clothoid(_) => Transition::Linear,
        }
    }

    /// The same segment with a share of its curvature, cant, gradient and widening.
    pub(crate) fn scaled(&self, share: f64) -> Self {
        match (self, self.values()) {
            (Self::Tangent(t), Some(v)) => Self::Tangent(Tangent {
                length: t.length,
                cant_mm: share * v.cant_mm,
                gradient: share * v.gradient,
                widening_mm: share * v.widening_mm,
            }),
            (Self::Curve(c), Some(v)) => Self::Curve(Curve {
                length: c.length,
                curvature: Some(share * v.curvature),
                radius: None,
                cant_mm: share * v.cant_mm,
                gradient: share * v.gradient,
                widening_mm: share * v.widening_mm,
            }),
            _ => *self,
        }
    }

    fn faults(&self, at: &KeyPath, faults: &mut Vec<Fault>) {
        let passes = self.values().is_none();
        let range = if passes { format!("above 0 m, at most {MAX_PASSAGE} m") } else { "above 0 m".into() };
        let allowed = |l: f64| l > 0.0 && !(passes && l > MAX_PASSAGE);
        require(faults, at.key("length"), self.length(), allowed, &range);
        if let Self::Curve(curve) = self {
            let range = format!("from -{MAX_CURVATURE} to {MAX_CURVATURE} 1/m");
            match (curve.curvature, curve.radius) {
                (Some(k), None) => {
                    require(faults, at.key("curvature"), k, |k| k.abs() <= MAX_CURVATURE, &range);
                }
                (None, Some(r)) => {
                    let range = format!("{} m or more, or as much below zero", 1.0 / MAX_CURVATURE);
                    require(faults, at.key("radius"), r, |r| r.abs() >= 1.0 / MAX_CURVATURE, &range);
                }
                (Some(_), Some(_)) => {
                    let fault = Fault::new(at.key("radius"), "radius and curvature", "one of the two");
                    faults.push(fault);
                }
                (None, None) => {
                    let fault = Fault::new(at.clone(), "neither radius nor curvature", "one of the two");
                    faults.push(fault.hint("radius in m, + to the right"));
                }
            }
        }
        if let Some(values) = self.values() {
            let range = format!("from -{0} to {0} mm", cant::MAX_MM);
            require(faults, at.key("cant_mm"), values.cant_mm, |c| c.abs() <= cant::MAX_MM, &range);
            let range = format!("from -{MAX_GRADIENT} to {MAX_GRADIENT} (rise per metre)");
            require(faults, at.key("gradient"), values.gradient, |g| g.abs() <= MAX_GRADIENT, &range);
            let range = format!("from -{0} to {0} mm", gauge::MAX_MM);
            let key = at.key("widening_mm");
            if !require(&mut Vec::new(), key.clone(), values.widening_mm, |w| w.abs() <= gauge::MAX_MM, "") {
                let fault = Fault::new(key, format!("{} mm", values.widening_mm), range);
                faults.push(fault.hint("what is added to track.gauge"));
            }
        }
    }
}

/// Every fault of the list; `at` is its path, `length` that of the track.
pub(super) fn faults(segments: &[Segment], length: f64, at: &KeyPath) -> Vec<Fault> {
    let mut faults = Vec::new();
    let length_good = require(&mut faults, beside(at, "length"), length, |l| l > 0.0, "above 0 m");
    for (i, segment) in segments.iter().enumerate() {
        segment.faults(&at.index(i), &mut faults);
    }
    for (i, pair) in segments.windows(2).enumerate() {
        let here = at.index(i + 1);
        match (pair[0].values(), pair[1].values()) {
            (None, None) => {
                let found = format!("a {} after a {}", pair[1].name(), pair[0].name());
                faults.push(Fault::new(here, found, "a tangent or a curve between two passages"));
            }
            (Some(a), Some(b)) => {
                let hint = "put a clothoid between: it ramps cant, gradient and gauge";
                for (key, a, b, what) in [
                    ("cant_mm", a.cant_mm, b.cant_mm, "mm, as at the end of the segment before"),
                    ("gradient", a.gradient, b.gradient, "as at the end of the segment before"),
                    ("widening_mm", a.widening_mm, b.widening_mm, "mm, as at the end of the segment before"),
                ] {
                    if (a - b).abs() > SAME {
                        faults
                            .push(Fault::new(here.key(key), b.to_string(), format!("{a} {what}")).hint(hint));
                    }
                }
            }
            _ => {}
        }
    }
    for (i, segment) in segments.iter().enumerate() {
        if let Segment::CubicParabola(Passage { length }) = segment {
            cubic_parabola(*length, ends(segments, i), &at.index(i), &mut faults);
        }
    }
    let sum: f64 = segments.iter().map(Segment::length).sum();
    if let Some(last @ Segment::Curve(_)) = segments.last()
        && length_good
        && sum < length - SAME
    {
        let key = at.index(segments.len() - 1).key("length");
        let allowed = format!("{} m or more: the track is {length} m long", last.length() + length - sum);
        let fault =
            Fault::new(key, format!("{} m, the layout ends in a curve at {sum} m", last.length()), allowed);
        faults.push(fault.hint("or add what follows the curve"));
    }
    faults
}

/// What the segment holds at its start and end: its own values, or those of its neighbours.
pub(super) fn ends(segments: &[Segment], i: usize) -> [Ends; 2] {
    let neighbour = |j: Option<usize>| j.and_then(|j| segments.get(j)).and_then(Segment::values);
    match segments[i].values() {
        Some(values) => [values, values],
        None => [neighbour(i.checked_sub(1)).unwrap_or_default(), neighbour(Some(i + 1)).unwrap_or_default()],
    }
}

/// A cubic parabola has a straight end, and an end to its curvature.
fn cubic_parabola(length: f64, [from, to]: [Ends; 2], at: &KeyPath, faults: &mut Vec<Fault>) {
    if from.curvature != 0.0 && to.curvature != 0.0 {
        let fault =
            Fault::new(at.clone(), "a cubic_parabola between two curves", "straight track at one end of it");
        faults.push(fault.hint("a clothoid passes from curve to curve"));
        return;
    }
    let curvature = from.curvature.abs().max(to.curvature.abs());
    let longest = CubicParabola::MAX_TURN / curvature;
    if curvature <= MAX_CURVATURE && length > longest {
        let allowed = format!("at most {longest} m, {} of the radius", CubicParabola::MAX_TURN);
        faults.push(Fault::new(at.key("length"), format!("{length} m"), allowed));
    }
}
