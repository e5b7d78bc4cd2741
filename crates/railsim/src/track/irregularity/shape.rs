//! Waves of given height and length: bumps, dips, kinks, joints, cyclic irregularities, on the track or on one rail.

use std::f64::consts::{PI, TAU};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{one, require, scale_faults};
use crate::error::{Fault, KeyPath};

/// Form of one wave over the fraction u = 0..1 of its length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Wave {
    /// (1 - cos 2 pi u)/2: from 0 up to the height and back, level at both ends.
    Versine,
    /// (sin 2 pi u)/2: half the height to either side, with corners at the ends of the group.
    Sine,
    /// sin pi u: rails that stand high between low joints, with a corner at every joint.
    RectifiedSine,
    /// Half a versine up over `rise`, level, half a versine down over `rise`.
    FlatHump,
    /// 1 - |2u - 1|: straight up to the height in the middle and straight down.
    Kink,
    /// -(1 - |2u - 1|)^2: two parabolas, level at their outer ends, that meet in the middle under `dip_angle`.
    DippedWeld,
}

impl Wave {
    const ALL: [Self; 6] =
        [Self::Versine, Self::Sine, Self::RectifiedSine, Self::FlatHump, Self::Kink, Self::DippedWeld];

    /// The word in a file.
    fn name(self) -> &'static str {
        match self {
            Self::Versine => "versine",
            Self::Sine => "sine",
            Self::RectifiedSine => "rectified_sine",
            Self::FlatHump => "flat_hump",
            Self::Kink => "kink",
            Self::DippedWeld => "dipped_weld",
        }
    }

    /// Value and slope over u of the wave of height 1; `rise` as a fraction of the length.
    #[inline]
    fn at(self, u: f64, rise: f64) -> (f64, f64) {
        let versine = |u: f64| {
            let (sin, cos) = (TAU * u).sin_cos();
            (0.5 * (1.0 - cos), PI * sin)
        };
        let side = if u < 0.5 { 1.0 } else { -1.0 };
        let inward = 1.0 - (2.0 * u - 1.0).abs();
        match self {
            Self::Versine => versine(u),
            Self::Sine => {
                let (sin, cos) = (TAU * u).sin_cos();
                (0.5 * sin, PI * cos)
            }
            Self::RectifiedSine => {
                let (sin, cos) = (PI * u).sin_cos();
                (sin, PI * cos)
            }
            Self::FlatHump => {
                let flank = 0.5 * inward / rise;
                if flank < 1.0 {
                    let (value, slope) = versine(0.5 * flank);
                    (value, side * 0.5 * slope / rise)
                } else {
                    (1.0, 0.0)
                }
            }
            Self::Kink => (inward, 2.0 * side),
            Self::DippedWeld => (-inward * inward, -4.0 * side * inward),
        }
    }

    /// How much the slope over u of the wave of height 1 changes at corner `k`: the start of the group (0), the middle of
    /// its first wave (1), the end of that (2), ... the end of the group (`last`).
    #[inline]
    fn corner(self, k: u32, last: u32) -> f64 {
        let inner = k > 0 && k < last;
        let middle = k % 2 == 1;
        match self {
            Self::Versine | Self::FlatHump => 0.0,
            Self::Sine if inner => 0.0,
            Self::Sine => {
                if k == 0 {
                    PI
                } else {
                    -PI
                }
            }
            Self::RectifiedSine if middle => 0.0,
            Self::RectifiedSine => {
                if inner {
                    TAU
                } else {
                    PI
                }
            }
            Self::Kink if middle => -4.0,
            Self::Kink => {
                if inner {
                    4.0
                } else {
                    2.0
                }
            }
            Self::DippedWeld => {
                if middle {
                    8.0
                } else {
                    0.0
                }
            }
        }
    }

    fn has_corners(self) -> bool {
        !matches!(self, Self::Versine | Self::FlatHump)
    }

    /// Whether `key` has a meaning with this form.
    fn takes(self, key: &str) -> bool {
        match key {
            "height" => self != Self::DippedWeld,
            "dip_angle" => self == Self::DippedWeld,
            "rise" => self == Self::FlatHump,
            _ => self.has_corners(),
        }
    }
}

/// On what a shape acts: on both rails together, or on one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ShapeChannel {
    /// Both rails to the right.
    Lateral,
    /// Both rails up.
    Vertical,
    /// Right rail lower than left.
    CrossLevel,
    /// Gauge wider.
    Gauge,
    /// The left rail to the right (so the gauge narrower).
    LeftLateral,
    /// The right rail to the right (so the gauge wider).
    RightLateral,
    /// The left rail up.
    LeftVertical,
    /// The right rail up.
    RightVertical,
}

impl ShapeChannel {
    /// The channel of this name.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "lateral" => Self::Lateral,
            "vertical" => Self::Vertical,
            "cross_level" => Self::CrossLevel,
            "gauge" => Self::Gauge,
            "left_lateral" => Self::LeftLateral,
            "right_lateral" => Self::RightLateral,
            "left_vertical" => Self::LeftVertical,
            "right_vertical" => Self::RightVertical,
            _ => return None,
        })
    }

    /// What a written height of 1 is on the four channels, in the order of [`Channel::ALL`] (vertical: + down).
    ///
    /// With z of the rails z -+ cross_level/2 and y of the rails y -+ gauge/2, one rail moves the centre line by half.
    pub(super) fn weights(self) -> [f64; 4] {
        match self {
            Self::Lateral => [1.0, 0.0, 0.0, 0.0],
            Self::Vertical => [0.0, -1.0, 0.0, 0.0],
            Self::CrossLevel => [0.0, 0.0, 1.0, 0.0],
            Self::Gauge => [0.0, 0.0, 0.0, 1.0],
            Self::LeftLateral => [0.5, 0.0, 0.0, -1.0],
            Self::RightLateral => [0.5, 0.0, 0.0, 1.0],
            Self::LeftVertical => [0.0, -0.5, 1.0, 0.0],
            Self::RightVertical => [0.0, -0.5, -1.0, 0.0],
        }
    }
}

/// A group of equal waves, as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shape {
    /// Form of one wave.
    pub shape: Wave,
    /// On what it acts: `vertical`, `lateral`, `cross_level`, `gauge`, or one rail, `left_vertical`, `right_lateral`, ...
    /// Staggered rails: the same wave twice, on `left_vertical` and half a wave on on `right_vertical`.
    pub channel: ShapeChannel,
    /// Where the first wave begins, m.
    pub start: f64,
    /// Length of one wave from end to end, m.
    pub length: f64,
    /// Peak to peak, m: + up (vertical), to the right (lateral), right rail lower (cross-level), wider (gauge). Not with
    /// `dipped_weld`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<f64>,
    /// `dipped_weld`: the whole angle between the two sides at the weld, rad, + downwards (a negative height); the depth
    /// is `dip_angle length / 8`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dip_angle: Option<f64>,
    /// `flat_hump`: length over which it rises and over which it falls, m; what is left of `length` is level.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rise: Option<f64>,
    /// Length over which each corner is rounded, m: by the parabola that continues both sides, half of it on either. 0
    /// leaves the corner sharp. `kink` needs it; 0 where a `sine`, `rectified_sine`, `dipped_weld` has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rounding: Option<f64>,
    /// Number of waves in a row.
    #[serde(default = "one_wave")]
    pub waves: u32,
    /// The group begins again after this distance, m; without it, it stands once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub period: Option<f64>,
    /// Factor on the height.
    #[serde(default = "one")]
    pub scale: f64,
}

fn one_wave() -> u32 {
    1
}

impl Shape {
    /// Every form and channel: the pitch-and-bounce track of the paper (three waves of 13.7 m, 20 mm), a sinusoidal
    /// lateral group, a repeated cross-level group, then a staggered low joint, a widened gauge, a kink, a weld.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let bounce = Self {
            shape: Wave::Versine,
            channel: ShapeChannel::Vertical,
            start: 275.0,
            length: 13.7,
            height: Some(0.020),
            dip_angle: None,
            rise: None,
            rounding: None,
            waves: 3,
            period: None,
            scale: 1.0,
        };
        let sway = Self {
            shape: Wave::Sine,
            channel: ShapeChannel::Lateral,
            start: 50.0,
            length: 11.887,
            height: Some(-0.03175),
            waves: 5,
            ..bounce.clone()
        };
        let roll = Self {
            channel: ShapeChannel::CrossLevel,
            start: 20.0,
            length: 8.0,
            height: Some(0.01),
            waves: 2,
            period: Some(40.0),
            scale: 0.5,
            ..bounce.clone()
        };
        let joints = |channel, start, rounding| Self {
            shape: Wave::RectifiedSine,
            channel,
            start,
            length: 11.887,
            height: Some(0.01905),
            waves: 10,
            rounding,
            ..bounce.clone()
        };
        let hump = Self { shape: Wave::FlatHump, length: 60.0, rise: Some(5.0), waves: 1, ..bounce.clone() };
        let kink = |channel, rounding| Self {
            shape: Wave::Kink,
            channel,
            length: 10.0,
            height: Some(0.015),
            rounding: Some(rounding),
            waves: 2,
            ..bounce.clone()
        };
        let weld = Self {
            shape: Wave::DippedWeld,
            length: 2.0,
            height: None,
            dip_angle: Some(0.02),
            waves: 1,
            ..bounce.clone()
        };
        vec![
            bounce.clone(),
            sway.clone(),
            roll,
            joints(ShapeChannel::LeftVertical, 100.0, None),
            joints(ShapeChannel::RightVertical, 105.9435, Some(0.5)),
            Self { channel: ShapeChannel::Gauge, start: 10.0, height: Some(0.0255), ..hump },
            kink(ShapeChannel::LeftLateral, 0.0),
            Self { period: Some(21.0), ..kink(ShapeChannel::RightLateral, 1.0) },
            Self { rounding: Some(0.31), ..sway },
            Self { rounding: Some(0.1), ..weld.clone() },
            Self { channel: ShapeChannel::RightVertical, start: 250.0, ..weld },
        ]
    }

    fn group(&self) -> f64 {
        self.length * f64::from(self.waves)
    }

    fn rounding(&self) -> f64 {
        self.rounding.unwrap_or(0.0)
    }

    /// Peak to peak without the scale, m. A parabola of half the length that falls by D has the slope 4 D/length at its end.
    fn peak(&self) -> f64 {
        match self.dip_angle {
            Some(angle) => 0.125 * angle * self.length,
            None => self.height.unwrap_or(0.0),
        }
    }

    /// What the wave of height 1 is on the four channels, m.
    pub(super) fn weights(&self) -> [f64; 4] {
        let height = self.scale * self.peak();
        self.channel.weights().map(|weight| weight * height)
    }

    /// Everything that is wrong with it; `at` is the path of its table.
    pub(super) fn faults(&self, at: &KeyPath, faults: &mut Vec<Fault>) {
        require(faults, at.key("start"), self.start, |_| true, "a finite number of metres");
        let long = require(faults, at.key("length"), self.length, |l| l > 0.0, "above 0 m");
        let weld = self.shape == Wave::DippedWeld;
        self.key_faults("height", self.height, !weld, at, faults);
        if let Some(height) = self.height {
            require(faults, at.key("height"), height, |h| h.abs() <= 1.0, "from -1 to 1 m");
        }
        self.key_faults("dip_angle", self.dip_angle, weld, at, faults);
        if let Some(angle) = self.dip_angle {
            let key = at.key("dip_angle");
            if !require(&mut Vec::new(), key.clone(), angle, |a| a.abs() <= 0.2, "") {
                let fault = Fault::new(key, angle.to_string(), "from -0.2 to 0.2 rad");
                faults.push(fault.hint("a weld of 20 mrad is 0.02"));
            }
        }
        self.key_faults("rise", self.rise, self.shape == Wave::FlatHump, at, faults);
        let half = 0.5 * self.length;
        if let Some(rise) = self.rise
            && long
        {
            let range = format!("above 0 m, at most {half} m, half the length");
            require(faults, at.key("rise"), rise, |r| r > 0.0 && r <= half, &range);
        }
        self.key_faults("rounding", self.rounding, self.shape == Wave::Kink, at, faults);
        let mut good = long;
        if let Some(rounding) = self.rounding
            && long
        {
            let range = format!("from 0 to {half} m, half the length of a wave");
            good = require(faults, at.key("rounding"), rounding, |r| (0.0..=half).contains(&r), &range);
        }
        if self.waves == 0 {
            faults.push(Fault::new(at.key("waves"), "0", "1 or more"));
            good = false;
        }
        if let Some(period) = self.period
            && good
        {
            let group = self.group() + self.rounding();
            let range = format!("{group} m or more, the length of the group");
            require(faults, at.key("period"), period, |p| p >= group, &range);
        }
        scale_faults(self.scale, at, faults);
    }

    /// A key that this form needs and does not have, or has and has no use for.
    fn key_faults(&self, key: &str, value: Option<f64>, needed: bool, at: &KeyPath, faults: &mut Vec<Fault>) {
        let name = self.shape.name();
        if needed && value.is_none() {
            faults.push(Fault::new(at.key(key), "nothing", format!("a number with shape = \"{name}\"")));
        } else if !self.shape.takes(key) && value.is_some() {
            let takers: Vec<_> = Wave::ALL.iter().filter(|w| w.takes(key)).map(|w| w.name()).collect();
            let allowed = format!("this key with shape = \"{}\"", takers.join("\", \""));
            faults.push(Fault::new(at.key(key), format!("it with \"{name}\""), allowed));
        }
    }

    /// Value and slope along s of the wave of height 1 at `s`.
    #[inline]
    pub(super) fn at(&self, s: f64) -> (f64, f64) {
        let half_rounding = 0.5 * self.rounding();
        let mut x = s - self.start;
        if let Some(period) = self.period
            && x > 0.0
        {
            x %= period;
            // The rounding of the first corner begins before the group does.
            if x >= period - half_rounding {
                x -= period;
            }
        }
        let group = self.group();
        let (mut value, mut slope) = (0.0, 0.0);
        if x > 0.0 && x < group {
            let u = x / self.length;
            (value, slope) = self.shape.at(u - u.floor(), self.rise.unwrap_or(0.0) / self.length);
            slope /= self.length;
        }
        if half_rounding > 0.0 && x > -half_rounding && x < group + half_rounding {
            let spacing = 0.5 * self.length;
            let last = 2 * self.waves;
            let k = (x / spacing).round().clamp(0.0, f64::from(last));
            let d = x - k * spacing;
            let reach = half_rounding - d.abs();
            if reach > 0.0 {
                // A slope that changes by j at d = 0 changes evenly over the width w = 2 half_rounding instead: what is added
                // is j (w/2 - |d|)^2/(2 w), nothing and level at the ends.
                let jump = self.shape.corner(k as u32, last) / self.length;
                value += 0.25 * jump * reach * reach / half_rounding;
                let side = if d < 0.0 { 1.0 } else { -1.0 };
                slope += 0.5 * jump * side * reach / half_rounding;
            }
        }
        (value, slope)
    }
}
