//! Irregularities added up and faded in.

use std::f64::consts::PI;

use super::measured::Record;
use super::psd::Realisation;
use super::{Deviation, Irregularity, Shape};
use crate::error::{Error, Fault, KeyPath, Result};
use crate::track::{beside, require};

/// Extremes are looked for at points this far apart, m.
const SCAN: f64 = 0.025;

/// Every irregularity of a track, compiled: immutable, no allocation in [`Self::at`].
#[derive(Debug, Clone)]
pub struct DeviationField {
    parts: Vec<Part>,
    length: f64,
    fade_start: f64,
    fade_in: f64,
}

#[derive(Debug, Clone)]
enum Part {
    Realisation(Realisation),
    /// The wave of height 1, and what that is on the four channels.
    Shape(Shape, [f64; 4]),
    Record(Record),
}

impl DeviationField {
    /// Compiles the list `written` for a track of `length` metres.
    ///
    /// The sum is multiplied by a factor that is 0 up to `fade_start`, 1 from `fade_start + fade_in` on, and between
    /// them the rising half of a cosine wave, level at both ends (m; `fade_in = 0`: no fading). `at` is the path of
    /// the list, `fade_in` and `fade_start` stand beside it. A list of one may have been written as a table: its
    /// faults have no index.
    ///
    /// # Errors
    /// Every fault at once, of every irregularity (a record that ends before the track), of `fade_in` and `fade_start` (finite, not below 0, no start
    /// without a length).
    pub fn new(
        written: &[Irregularity],
        length: f64,
        fade_start: f64,
        fade_in: f64,
        at: &KeyPath,
    ) -> Result<Self> {
        let mut faults = Vec::new();
        for (i, irregularity) in written.iter().enumerate() {
            let here = if written.len() == 1 { at.clone() } else { at.index(i) };
            let own = irregularity.faults(&here);
            if let Irregularity::Measured(measured) = irregularity
                && own.is_empty()
            {
                faults.extend(measured.too_short(length, &here));
            }
            faults.extend(own);
        }
        let mut good = require(&mut faults, beside(at, "fade_in"), fade_in, |x| x >= 0.0, "0 m or more");
        good &= require(&mut faults, beside(at, "fade_start"), fade_start, |x| x >= 0.0, "0 m or more");
        if good && fade_start > 0.0 && fade_in == 0.0 {
            let fault = Fault::new(beside(at, "fade_in"), "0 m", "above 0 m where fade_start is above 0");
            faults.push(fault.hint("the track would begin with a step"));
        }
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let parts = written
            .iter()
            .filter_map(|irregularity| match irregularity {
                Irregularity::Psd(psd) => Some(Part::Realisation(Realisation::new(psd))),
                Irregularity::Shape(shape) => Some(Part::Shape(shape.clone(), shape.weights())),
                // What is no record has been refused above.
                Irregularity::Measured(measured) => measured.record().ok().map(Part::Record),
            })
            .collect();
        Ok(Self { parts, length, fade_start, fade_in })
    }

    /// Perfect track.
    #[must_use]
    pub fn none() -> Self {
        Self { parts: Vec::new(), length: 0.0, fade_start: 0.0, fade_in: 0.0 }
    }

    /// Nothing in it.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.parts.is_empty()
    }

    /// The deviation at arc length `s` (m), any s.
    #[inline(always)]
    #[must_use]
    pub fn at(&self, s: f64) -> Deviation {
        if self.parts.is_empty() {
            return Deviation::default();
        }
        let (fade, fade_slope) = self.fade(s);
        if fade == 0.0 {
            return Deviation::default();
        }
        let mut sum = [0.0; 8];
        for part in &self.parts {
            match part {
                Part::Realisation(realisation) => {
                    for (sum, value) in sum.iter_mut().zip(realisation.at(s)) {
                        *sum += value;
                    }
                }
                Part::Record(record) => {
                    for (sum, value) in sum.iter_mut().zip(record.at(s)) {
                        *sum += value;
                    }
                }
                Part::Shape(shape, weights) => {
                    let (value, slope) = shape.at(s);
                    for (i, weight) in weights.iter().enumerate() {
                        sum[i] += weight * value;
                        sum[i + 4] += weight * slope;
                    }
                }
            }
        }
        for i in 0..4 {
            sum[i + 4] = fade * sum[i + 4] + fade_slope * sum[i];
            sum[i] *= fade;
        }
        let [y, z, cross_level, gauge, dy_ds, dz_ds, dcross_level_ds, dgauge_ds] = sum;
        Deviation { y, z, cross_level, gauge, dy_ds, dz_ds, dcross_level_ds, dgauge_ds }
    }

    /// Factor and its slope.
    fn fade(&self, s: f64) -> (f64, f64) {
        if self.fade_in == 0.0 {
            return (1.0, 0.0);
        }
        let x = (s - self.fade_start) / self.fade_in;
        if x <= 0.0 {
            (0.0, 0.0)
        } else if x >= 1.0 {
            (1.0, 0.0)
        } else {
            let (sin, cos) = (PI * x).sin_cos();
            (0.5 - 0.5 * cos, 0.5 * PI / self.fade_in * sin)
        }
    }

    /// Least and greatest value over the length of the track of `y`, `z`, `cross_level`, `gauge`, m, as sampled every
    /// 25 mm.
    #[must_use]
    pub fn extremes(&self) -> [(f64, f64); 4] {
        let count = (self.length / SCAN).ceil() as usize;
        let mut extremes = [(f64::INFINITY, f64::NEG_INFINITY); 4];
        for i in 0..=count {
            let d = self.at((i as f64 * SCAN).min(self.length));
            for ((least, greatest), value) in extremes.iter_mut().zip([d.y, d.z, d.cross_level, d.gauge]) {
                *least = least.min(value);
                *greatest = greatest.max(value);
            }
        }
        extremes
    }
}
