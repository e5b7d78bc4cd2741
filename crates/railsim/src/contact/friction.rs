//! Coefficient of friction: constant, per rail, along the track, falling with the slip velocity.
//!
//! As written in a case: `friction = 0.4`, or a table
//!
//! ```toml
//! [run.friction]
//! left = 0.47                                  # or value = 0.47 for both rails
//! right = 0.30
//! falling = { ratio = 0.44, decay = 0.7 }      # with the slip velocity
//! along = [{ from = 200.0, transition = 20.0, value = 0.30, falling = { ratio = 0.38, decay = 0.1 } }]
//! ```
//!
//! Here is the only place where friction depends on slip velocity: a creep law takes the coefficient that holds at its contact now
//! and applies it once.

use crate::contact::creep::Polach;
use crate::error::{Fault, KeyPath};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest coefficient that is taken for one.
const LARGEST: f64 = 1.5;

/// Friction that falls with the slip velocity w: mu(w) = mu0 ((1 - A) exp(-B w) + A) (O. Polach, Wear 258 (2005) 992).
///
/// w is the magnitude of the sliding velocity at the middle of the contact, spin left out. Typical: dry A 0.40 and B 0.60 s/m, wet A 0.40 and B 0.20 s/m
/// (the same source).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Falling {
    /// A, friction at infinite over that at zero slip velocity.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub ratio: f64,
    /// B, s/m.
    #[schemars(extend("minimum" = 0, "unit" = "s/m"))]
    pub decay: f64,
}

impl Falling {
    /// Factor on the coefficient at zero slip velocity; `w` in m/s.
    #[inline]
    #[must_use]
    pub fn factor(&self, w: f64) -> f64 {
        (1.0 - self.ratio) * (-self.decay * w).exp() + self.ratio
    }

    /// Faults in the parameters.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = Vec::new();
        if !(0.0..=1.0).contains(&self.ratio) {
            faults.push(Fault::new(at.key("ratio"), self.ratio.to_string(), "0 to 1"));
        }
        if !(self.decay >= 0.0 && self.decay.is_finite()) {
            faults.push(Fault::new(at.key("decay"), self.decay.to_string(), "a number >= 0, s/m"));
        }
        faults
    }
}

/// Reduction factors of Polach's formula ([`Polach`]) on a stretch of track, instead of those of `run.creep`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Reduction {
    /// Factor in the area of adhesion.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub k_a: f64,
    /// Factor in the area of slip, at most `k_a`.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub k_s: f64,
}

/// From somewhere along the track on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stretch {
    /// Where it begins, m along the track.
    #[schemars(extend("unit" = "m"))]
    pub from: f64,
    /// Length over which the coefficient goes over, linearly, from what was before; 0, a step, if absent.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "m"))]
    pub transition: f64,
    /// Coefficient on both rails, at zero slip velocity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1.5))]
    pub value: Option<f64>,
    /// On the left rail.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1.5))]
    pub left: Option<f64>,
    /// On the right rail.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1.5))]
    pub right: Option<f64>,
    /// How it falls with the slip velocity; not, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub falling: Option<Falling>,
    /// Reduction factors of Polach's formula from here on; those of `run.creep` if absent. They go over with the coefficient.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reduction: Option<Reduction>,
}

/// Friction that is not the same everywhere.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Varied {
    /// Coefficient on both rails, at zero slip velocity.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1.5))]
    pub value: Option<f64>,
    /// On the left rail.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1.5))]
    pub left: Option<f64>,
    /// On the right rail.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1.5))]
    pub right: Option<f64>,
    /// How it falls with the slip velocity; not, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub falling: Option<Falling>,
    /// Further stretches of the track, in order. Each says its coefficients and how they fall anew.
    #[serde(default)]
    pub along: Vec<Stretch>,
}

/// Friction between wheel and rail, as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Friction {
    /// One coefficient everywhere.
    Constant(#[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1.5))] f64),
    /// Per rail, along the track, falling with the slip velocity.
    Varied(Varied),
}

impl Varied {
    fn first(&self) -> Stretch {
        let Self { value, left, right, falling, .. } = *self;
        Stretch { from: f64::NEG_INFINITY, transition: 0.0, value, left, right, falling, reduction: None }
    }
}

impl Stretch {
    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = Vec::new();
        let written = [("value", self.value), ("left", self.left), ("right", self.right)];
        let keys: Vec<&str> = written.iter().filter(|(_, v)| v.is_some()).map(|(k, _)| *k).collect();
        if keys != ["value"] && keys != ["left", "right"] {
            let found = if keys.is_empty() { "neither".to_owned() } else { keys.join(", ") };
            faults.push(Fault::new(at.clone(), found, "value for both rails, or left and right"));
        }
        for (key, value) in written {
            if let Some(mu) = value
                && !(mu > 0.0 && mu <= LARGEST)
            {
                faults.push(Fault::new(
                    at.key(key),
                    mu.to_string(),
                    format!("greater than 0, at most {LARGEST}"),
                ));
            }
        }
        faults.extend(self.falling.iter().flat_map(|falling| falling.faults(&at.key("falling"))));
        if let Some(r) = &self.reduction {
            faults.extend(Polach { k_a: r.k_a, k_s: r.k_s }.faults(&at.key("reduction")));
        }
        faults
    }
}

impl Friction {
    /// Faults that a single key does not show, by key below `at`.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let varied = match self {
            Self::Constant(mu) if *mu > 0.0 && *mu <= LARGEST => return Vec::new(),
            Self::Constant(mu) => {
                return vec![Fault::new(
                    at.clone(),
                    mu.to_string(),
                    format!("greater than 0, at most {LARGEST}"),
                )];
            }
            Self::Varied(varied) => varied,
        };
        let mut faults = varied.first().faults(at);
        let mut free = f64::NEG_INFINITY;
        for (i, stretch) in varied.along.iter().enumerate() {
            let here = at.key("along").index(i);
            faults.extend(stretch.faults(&here));
            if !stretch.from.is_finite() || stretch.from < free {
                let allowed = format!("{free} m or more, where the stretch before is complete");
                let allowed = if free.is_finite() { allowed } else { "a finite number, m".to_owned() };
                faults.push(Fault::new(here.key("from"), format!("{} m", stretch.from), allowed));
            }
            if !(stretch.transition >= 0.0 && stretch.transition.is_finite()) {
                faults.push(Fault::new(
                    here.key("transition"),
                    stretch.transition.to_string(),
                    "a length >= 0, m",
                ));
            }
            free = stretch.from + stretch.transition;
        }
        faults
    }
}

/// One stretch, ready for the right-hand side.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    from: f64,
    transition: f64,
    /// Left, right.
    mu: [f64; 2],
    falling: Option<Falling>,
    reduction: Option<Reduction>,
}

impl Piece {
    #[inline]
    fn mu(&self, side: usize, slip: [f64; 2]) -> f64 {
        let mu = self.mu[side];
        self.falling.map_or(mu, |falling| mu * falling.factor((slip[0] * slip[0] + slip[1] * slip[1]).sqrt()))
    }
}

/// Friction ready for the right-hand side: no allocation, one comparison where it is constant.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionField {
    /// Before the first change.
    first: Piece,
    /// Changes in the order of the track.
    along: Vec<Piece>,
}

impl FrictionField {
    /// From what is written; faults ([`Friction::faults`]) are looked for before.
    #[must_use]
    pub fn new(friction: &Friction) -> Self {
        let piece = |s: &Stretch| {
            let side = |own: Option<f64>| own.or(s.value).unwrap_or_default();
            let mu = [side(s.left), side(s.right)];
            Piece { from: s.from, transition: s.transition, mu, falling: s.falling, reduction: s.reduction }
        };
        match friction {
            Friction::Constant(mu) => Self::constant(*mu),
            Friction::Varied(varied) => {
                Self { first: piece(&varied.first()), along: varied.along.iter().map(piece).collect() }
            }
        }
    }

    /// One coefficient everywhere.
    #[must_use]
    pub fn constant(mu: f64) -> Self {
        let first =
            Piece { from: f64::NEG_INFINITY, transition: 0.0, mu: [mu; 2], falling: None, reduction: None };
        Self { first, along: Vec::new() }
    }

    /// Coefficient on the left (`side` 0) or right (1) rail at `s` m along the track where the surfaces slide with the velocity `slip`,
    /// forward and lateral in the contact plane, m/s.
    #[inline]
    #[must_use]
    pub fn at(&self, side: usize, s: f64, slip: [f64; 2]) -> f64 {
        if self.along.is_empty() { self.first.mu(side, slip) } else { self.searched(side, s, slip) }
    }

    /// Whether any stretch has reduction factors of its own.
    #[inline]
    #[must_use]
    pub fn has_reductions(&self) -> bool {
        self.along.iter().any(|piece| piece.reduction.is_some())
    }

    /// Polach's formula as it holds at `s` m along the track, `law` where nothing else is said.
    #[must_use]
    pub fn reduction(&self, s: f64, law: &Polach) -> Polach {
        let of = |piece: &Piece| piece.reduction.map_or(*law, |r| Polach { k_a: r.k_a, k_s: r.k_s });
        let passed = self.along.partition_point(|piece| piece.from <= s);
        let Some(here) = passed.checked_sub(1).map(|i| &self.along[i]) else { return *law };
        let gone = s - here.from;
        if gone >= here.transition {
            return of(here);
        }
        let (before, here, t) =
            (if passed > 1 { of(&self.along[passed - 2]) } else { *law }, of(here), gone / here.transition);
        let mix = |a: f64, b: f64| (1.0 - t) * a + t * b;
        Polach { k_a: mix(before.k_a, here.k_a), k_s: mix(before.k_s, here.k_s) }
    }

    fn searched(&self, side: usize, s: f64, slip: [f64; 2]) -> f64 {
        let passed = self.along.partition_point(|piece| piece.from <= s);
        let Some(here) = passed.checked_sub(1).map(|i| &self.along[i]) else {
            return self.first.mu(side, slip);
        };
        let gone = s - here.from;
        if gone >= here.transition {
            return here.mu(side, slip);
        }
        let before = if passed > 1 { &self.along[passed - 2] } else { &self.first };
        let t = gone / here.transition;
        (1.0 - t) * before.mu(side, slip) + t * here.mu(side, slip)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(text: &str) -> Friction {
        serde_json::from_str(text).expect("friction")
    }

    const TRACK: &str = r#"{"left": 0.47, "right": 0.3, "falling": {"ratio": 0.44, "decay": 0.7},
        "along": [{"from": 100, "transition": 20, "value": 0.2}, {"from": 150, "left": 0.1, "right": 0.4}]}"#;

    #[test]
    fn number_is_everywhere() {
        let field = FrictionField::new(&written("0.4"));
        assert_eq!(field.at(0, -5.0, [0.0; 2]), 0.4);
        assert_eq!(field.at(1, 1e6, [12.0, -3.0]), 0.4);
    }

    #[test]
    fn rails_stretches_and_slip_velocity() {
        let field = FrictionField::new(&written(TRACK));
        let fall = 0.56 * f64::exp(-0.7 * 2.0) + 0.44;
        for (side, s, w, mu) in [
            (0, 0.0, 0.0, 0.47),
            (1, 99.999, 0.0, 0.30),
            (0, 50.0, 2.0, 0.47 * fall),
            (0, 110.0, 0.0, 0.5 * (0.47 + 0.2)),
            (1, 110.0, 2.0, 0.5 * (0.30 * fall + 0.2)),
            (1, 120.0, 2.0, 0.2),
            (0, 149.0, 9.0, 0.2),
            (0, 150.0, 9.0, 0.1),
            (1, 1e5, 9.0, 0.4),
        ] {
            assert!((field.at(side, s, [-0.6 * w, 0.8 * w]) - mu).abs() < 1e-15, "side {side} s {s} w {w}");
        }
    }

    /// Published: Spiryagin et al. (2013), mu 0.1368 + 0.2232 2^(-w/0.99 m/s), is mu0 0.36, A 0.38, B 0.7 s/m.
    #[test]
    fn two_ways_to_write_a_falling_friction() {
        let falling = Falling { ratio: 0.38, decay: 0.7 };
        for w in [0.0, 0.3, 1.0, 2.5] {
            let theirs = 0.1368 + 0.2232 * f64::powf(2.0, -w / 0.99);
            assert!((0.36 * falling.factor(w) - theirs).abs() < 1e-4);
        }
    }

    #[test]
    fn faults_name_their_key() {
        let at = KeyPath::of("run.friction");
        assert!(written(TRACK).faults(&at).is_empty());
        for (text, message) in [
            ("-0.1", "run.friction: found -0.1; allowed: greater than 0, at most 1.5"),
            ("{}", "run.friction: found neither; allowed: value for both rails, or left and right"),
            (
                r#"{"left": 0.3}"#,
                "run.friction: found left; allowed: value for both rails, or left and right",
            ),
            (
                r#"{"value": 0.3, "falling": {"ratio": 1.2, "decay": 1}}"#,
                "run.friction.falling.ratio: found 1.2; allowed: 0 to 1",
            ),
            (
                r#"{"value": 0.3, "along": [{"from": 5, "transition": 10, "value": 0.1}, {"from": 12, "value": 0.2}]}"#,
                "run.friction.along[1].from: found 12 m; allowed: 15 m or more, where the stretch before is complete",
            ),
        ] {
            let faults = written(text).faults(&at);
            assert_eq!(faults.len(), 1, "{text}");
            assert_eq!(faults[0].to_string(), message);
        }
    }
}
