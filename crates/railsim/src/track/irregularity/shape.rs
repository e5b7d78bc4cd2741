//! Waves of given height and length: bumps, dips, cyclic irregularities.

use std::f64::consts::TAU;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Channel, one, require, scale_faults};
use crate::error::{Fault, KeyPath};

/// Form of one wave over the fraction u = 0..1 of its length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Wave {
    /// (1 - cos 2 pi u)/2: from 0 up to the height and back, level at both ends.
    Versine,
    /// (sin 2 pi u)/2: half the height to either side, with kinks at the ends of the group.
    Sine,
}

/// A group of equal waves on one channel, as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shape {
    /// Form of one wave.
    pub shape: Wave,
    /// Channel on which it acts, both rails together: `vertical`, `lateral`, `cross_level`, `gauge`.
    pub channel: Channel,
    /// Where the first wave begins, m.
    pub start: f64,
    /// Length of one wave, m.
    pub length: f64,
    /// Peak to peak, m: + up (vertical), to the right (lateral), right rail lower (cross-level), wider (gauge).
    pub height: f64,
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
    /// The pitch-and-bounce track of the paper (three waves of 13.7 m, 20 mm), a kinked lateral group, a repeated
    /// cross-level group.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let bounce = Self {
            shape: Wave::Versine,
            channel: Channel::Vertical,
            start: 275.0,
            length: 13.7,
            height: 0.020,
            waves: 3,
            period: None,
            scale: 1.0,
        };
        vec![
            bounce.clone(),
            Self {
                shape: Wave::Sine,
                channel: Channel::Lateral,
                start: 50.0,
                length: 11.887,
                height: -0.03175,
                waves: 5,
                ..bounce.clone()
            },
            Self {
                channel: Channel::CrossLevel,
                start: 20.0,
                length: 8.0,
                height: 0.01,
                waves: 2,
                period: Some(40.0),
                scale: 0.5,
                ..bounce
            },
        ]
    }

    fn group(&self) -> f64 {
        self.length * f64::from(self.waves)
    }

    /// Everything that is wrong with it; `at` is the path of its table.
    pub(super) fn faults(&self, at: &KeyPath, faults: &mut Vec<Fault>) {
        require(faults, at.key("start"), self.start, |_| true, "a finite number of metres");
        let mut good = require(faults, at.key("length"), self.length, |l| l > 0.0, "above 0 m");
        require(faults, at.key("height"), self.height, |h| h.abs() <= 1.0, "from -1 to 1 m");
        if self.waves == 0 {
            faults.push(Fault::new(at.key("waves"), "0", "1 or more"));
            good = false;
        }
        if let Some(period) = self.period
            && good
        {
            let group = self.group();
            let range = format!("{group} m or more, the length of the group");
            require(faults, at.key("period"), period, |p| p >= group, &range);
        }
        scale_faults(self.scale, at, faults);
    }

    /// The channel, its deviation (m, + down for the vertical one) and its slope at `s`.
    #[inline]
    pub(super) fn at(&self, s: f64) -> (usize, f64, f64) {
        let mut x = s - self.start;
        if let Some(period) = self.period
            && x > 0.0
        {
            x %= period;
        }
        let i = self.channel.index();
        if !(x > 0.0 && x < self.group()) {
            return (i, 0.0, 0.0);
        }
        let sign = if self.channel == Channel::Vertical { -1.0 } else { 1.0 };
        let half = 0.5 * sign * self.scale * self.height;
        let rate = TAU / self.length;
        let (sin, cos) = (rate * x).sin_cos();
        match self.shape {
            Wave::Versine => (i, half * (1.0 - cos), half * rate * sin),
            Wave::Sine => (i, half * sin, half * rate * cos),
        }
    }
}
