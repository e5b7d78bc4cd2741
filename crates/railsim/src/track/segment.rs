//! Segments of the layout as written, and what is wrong with a list of them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{beside, cant, require};
use crate::error::{Fault, KeyPath};

/// Largest curvature that is accepted, 1/m.
const MAX_CURVATURE: f64 = 0.1;
/// Largest gradient that is accepted, rise per metre.
const MAX_GRADIENT: f64 = 0.2;
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
}

/// Linear passage of curvature, cant and gradient from the end of the segment before to the start of the segment
/// after (level straight track where there is none): a transition curve, a cant ramp on straight track, or, between
/// two segments that differ in gradient alone, a vertical curve of radius length / (difference of gradient angles).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Clothoid {
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
    Clothoid(Clothoid),
}

/// What a segment holds at one of its ends: curvature (1/m), cant (mm), gradient (rise per metre).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Ends {
    pub curvature: f64,
    pub cant_mm: f64,
    pub gradient: f64,
}

impl Segment {
    /// Its length, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        match self {
            Self::Tangent(Tangent { length, .. })
            | Self::Curve(Curve { length, .. })
            | Self::Clothoid(Clothoid { length }) => *length,
        }
    }

    /// Its constant values; none for a passage.
    pub(super) fn values(&self) -> Option<Ends> {
        match *self {
            Self::Tangent(Tangent { cant_mm, gradient, .. }) => {
                Some(Ends { curvature: 0.0, cant_mm, gradient })
            }
            Self::Curve(Curve { curvature, radius, cant_mm, gradient, .. }) => {
                let curvature = curvature.or(radius.map(|r| 1.0 / r)).unwrap_or(0.0);
                Some(Ends { curvature, cant_mm, gradient })
            }
            Self::Clothoid(_) => None,
        }
    }

    /// The same segment with a share of its curvature, cant and gradient.
    pub(crate) fn scaled(&self, share: f64) -> Self {
        match (self, self.values()) {
            (Self::Tangent(t), Some(v)) => Self::Tangent(Tangent {
                length: t.length,
                cant_mm: share * v.cant_mm,
                gradient: share * v.gradient,
            }),
            (Self::Curve(c), Some(v)) => Self::Curve(Curve {
                length: c.length,
                curvature: Some(share * v.curvature),
                radius: None,
                cant_mm: share * v.cant_mm,
                gradient: share * v.gradient,
            }),
            _ => *self,
        }
    }

    fn faults(&self, at: &KeyPath, faults: &mut Vec<Fault>) {
        require(faults, at.key("length"), self.length(), |l| l > 0.0, "above 0 m");
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
                let fault = Fault::new(
                    here,
                    "a clothoid after a clothoid",
                    "a tangent or a curve between two clothoids",
                );
                faults.push(fault);
            }
            (Some(a), Some(b)) => {
                let hint = "put a clothoid between: it ramps cant and gradient";
                for (key, a, b, what) in [
                    ("cant_mm", a.cant_mm, b.cant_mm, "mm, as at the end of the segment before"),
                    ("gradient", a.gradient, b.gradient, "as at the end of the segment before"),
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
