//! Realisations of a power spectral density, seeded.
//!
//! The spectra are one-sided: the integral of S over the band is the variance. A realisation of period P is the sum
//! over the harmonics k whose wavelength P/k lies in the band, of amplitude sqrt(2 S(k/P)/P) and a phase drawn evenly
//! from 0..2 pi; it repeats after P without a seam.
//!
//! Phases come from ChaCha8, key: the seed (8 bytes, little endian, then zeros), one stream per channel (0 lateral,
//! 1 vertical, 2 cross-level, 3 gauge), phase of harmonic k: 2 pi times the upper 53 bits of the k-th 64-bit word. So
//! a seed is the same track for ever, and a narrower band is the same track filtered.
//!
//! Sources of the laws and constants:
//! - `fra_hamid_yang`: A. Hamid, T. L. Yang, "Analytical descriptions of track geometry variations", Transportation
//!   Research Record 838 (1981) 19-26; constants as used in the public VTCM_PYTHON code. That its A counts 1e-7
//!   m2 (1/m) is decided by the published extremes of a class 6 realisation (Spiryagin et al. 2013, table 6).
//! - `fra_cutoff`: X. Lei, N. A. Noda, "Analyses of dynamic response of vehicle and track coupling system with random
//!   irregularity of track vertical profile", Journal of Sound and Vibration 258 (2002) 147-165; constants as in the
//!   public TTB-2D and STEM codes (Av, cut-off), Aa and the second cut-off of classes 1-5 from general knowledge.
//! - `table`: points as written.
//! - `erri`: ERRI B176 low and high level, constants as in the public German spectrum of VTCM_PYTHON.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::cant::BASE;
use super::{Channel, one, require, scale_faults};
use crate::error::{Fault, KeyPath};
use crate::math::{fft, hermite::Hermite};

/// Largest number of nodes of a table (64 bytes each).
const MAX_NODES: f64 = 1_048_576.0;
/// Nodes stand no further apart than this, m, ...
const MAX_CELL: f64 = 0.1;
/// ... and at least this many on the shortest wave: the cubic between them is then exact to 3e-5 of that wave.
const NODES_PER_WAVE: f64 = 20.0;

/// Law of the spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// FRA classes 1 to 6 with one cut-off (Lei and Noda 2002).
    FraCutoff,
    /// FRA classes 1 to 6 after Hamid and Yang (1981).
    FraHamidYang,
    /// ERRI B176, low or high level.
    Erri,
    /// Points of frequency and density as written, `density` or `density_rad`.
    Table,
}

/// Level of the ERRI spectra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// Low disturbance.
    Low,
    /// High disturbance.
    High,
}

/// Where the gauge channel comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GaugeSeries {
    /// A series of its own with the gauge spectrum.
    #[default]
    Independent,
    /// The cross-level series itself (the published table of extremes has the same digits for both).
    CrossLevel,
}

/// One-sided spectra of the channels as points [frequency, density], frequencies increasing; a channel without points is smooth.
///
/// Between the points density is a power of frequency: straight lines on logarithmic axes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Density {
    /// Lateral.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lateral: Vec<[f64; 2]>,
    /// Vertical.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub vertical: Vec<[f64; 2]>,
    /// Cross-level over 1.5 m.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cross_level: Vec<[f64; 2]>,
    /// Gauge.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gauge: Vec<[f64; 2]>,
}

impl Density {
    fn points(&self, channel: Channel) -> &[[f64; 2]] {
        match channel {
            Channel::Lateral => &self.lateral,
            Channel::Vertical => &self.vertical,
            Channel::CrossLevel => &self.cross_level,
            Channel::Gauge => &self.gauge,
        }
    }

    /// Density at a frequency in the units of the points; outside them that of the nearest one, without points 0.
    fn at(&self, channel: Channel, frequency: f64) -> f64 {
        let points = self.points(channel);
        let next = points.partition_point(|p| p[0] <= frequency);
        match (next.checked_sub(1).and_then(|i| points.get(i)), points.get(next)) {
            (Some(&[f0, s0]), Some(&[f1, s1])) => s0 * (frequency / f0).powf((s1 / s0).ln() / (f1 / f0).ln()),
            (Some(&[_, s]), None) | (None, Some(&[_, s])) => s,
            (None, None) => 0.0,
        }
    }

    /// Every fault; `band` holds the frequencies asked for, in the units of the points.
    fn faults(&self, band: [f64; 2], unit: &str, at: &KeyPath, faults: &mut Vec<Fault>) {
        const NAMES: [&str; 4] = ["lateral", "vertical", "cross_level", "gauge"];
        if Channel::ALL.iter().all(|c| self.points(*c).is_empty()) {
            let allowed = "points [frequency, density] of lateral, vertical, cross_level or gauge";
            faults.push(Fault::new(at.clone(), "no points", allowed));
        }
        for (channel, name) in Channel::ALL.into_iter().zip(NAMES) {
            let points = self.points(channel);
            let here = at.key(name);
            let before = faults.len();
            for (i, &[f, s]) in points.iter().enumerate() {
                let at = here.index(i);
                require(faults, at.index(0), f, |f| f > 0.0, &format!("above 0 {unit}"));
                require(faults, at.index(1), s, |s| s > 0.0, &format!("above 0 m2/({unit})"));
                if i > 0 && f <= points[i - 1][0] {
                    let allowed = format!("above {}, the frequency before", points[i - 1][0]);
                    faults.push(Fault::new(at.index(0), f.to_string(), allowed));
                }
            }
            // Rounding of 1/wavelength, a hundredth of a millionth.
            if let (Some(first), Some(last)) = (points.first(), points.last())
                && faults.len() == before
                && (first[0] > band[0] * (1.0 + 1e-8) || last[0] < band[1] * (1.0 - 1e-8))
            {
                let found = format!("points from {} to {} {unit}", first[0], last[0]);
                let allowed = format!(
                    "points that cover {:.6} to {:.6} {unit}, the band of wavelengths",
                    band[0], band[1]
                );
                faults.push(Fault::new(here, found, allowed));
            }
        }
    }
}

/// A realisation of a spectrum as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Psd {
    /// Law.
    pub form: Form,
    /// FRA class, 1 (worst) to 6 (best); with the two FRA forms only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub class: Option<i64>,
    /// Level; with `form = "erri"` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub level: Option<Level>,
    /// `form = "table"`: points in cycles per metre and m2/(1/m). This or `density_rad`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<Density>,
    /// `form = "table"`: points in rad/m and m2/(rad/m).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density_rad: Option<Density>,
    /// Shortest and longest wavelength, m. The longest decides the amplitude: no default.
    pub wavelengths: [f64; 2],
    /// Seed.
    pub seed: u64,
    /// The realisation repeats after this distance, m.
    pub period: f64,
    /// Where the gauge channel comes from.
    #[serde(default)]
    pub gauge: GaugeSeries,
    /// Factor on all channels.
    #[serde(default = "one")]
    pub scale: f64,
}

/// Constants of `fra_cutoff`, by class: Av, Aa (cm2 rad/m), second cut-off (rad/m).
const CUTOFF: [[f64; 3]; 6] = [
    [1.2107, 3.3634, 0.6046],
    [1.0181, 1.2107, 0.9308],
    [0.6816, 0.4128, 0.8520],
    [0.5376, 0.3027, 1.1312],
    [0.2095, 0.0762, 0.8209],
    [0.0339, 0.0339, 0.4380],
];
/// First cut-off of `fra_cutoff`, rad/m, and its factor k.
const CUTOFF_OMEGA_C: f64 = 0.8245;
const CUTOFF_K: f64 = 0.25;

/// Roughness of `fra_hamid_yang`, by channel (lateral, vertical, cross-level, gauge) and class, 1e-7 m2 (1/m).
const HAMID_YANG_A: [[f64; 6]; 4] = [
    [10.5833, 5.9267, 3.3867, 1.8838, 1.0583, 0.5927],
    [16.7217, 9.5250, 5.2917, 2.9633, 1.6722, 0.9525],
    [4.8683, 3.3867, 2.3283, 1.5663, 1.0583, 0.7197],
    [10.5833, 5.9267, 3.3867, 1.8838, 1.0583, 0.5927],
];
/// Break frequencies of `fra_hamid_yang`, by channel, 1/m.
const HAMID_YANG_PHI: [[f64; 2]; 4] =
    [[0.0328, 0.1837], [0.0233, 0.1312], [0.0233, 0.1312], [0.0292, 0.2329]];

/// ERRI B176: Aa, Av, Ag (m2 rad/m) at low and at high level; cut-offs c, r, s (rad/m).
const ERRI_A: [[f64; 3]; 2] = [[2.119e-7, 4.032e-7, 5.32e-8], [6.125e-7, 1.080e-6, 1.032e-7]];
const ERRI_OMEGA: [f64; 3] = [0.8246, 0.0206, 0.4380];

/// One-sided spectral density of a channel in m2/(1/m) at `frequency` in cycles per metre. `grade` is the FRA class
/// 1..=6, or 1 (low), 2 (high) for ERRI; outside that range, and of a table ([`Psd::spectrum`]), the density is NaN.
///
/// `fra_hamid_yang` (phi in 1/m): lateral and vertical A phi2^2 (phi^2 + phi1^2)/(phi^4 (phi^2 + phi2^2)), cross-level
/// and gauge A phi2^2/((phi^2 + phi1^2)(phi^2 + phi2^2)).
/// `fra_cutoff` (W in rad/m): k A Wc^2/(W^2 (W^2 + Wc^2)), cross-level and gauge 4 k Av Wc^2/((W^2 + Wc^2)(W^2 + Ws^2)).
/// `erri`: A Wc^2/((W^2 + Wr^2)(W^2 + Wc^2)); gauge Ag Wc^2 W^2/((W^2 + Wr^2)(W^2 + Wc^2)(W^2 + Ws^2)); cross-level the
/// same with Av/(0.75 m)^2, an angle, here times the base of 1.5 m.
/// The last two count per rad/m: times 2 pi.
#[must_use]
pub fn spectrum(form: Form, grade: usize, channel: Channel, frequency: f64) -> f64 {
    let i = channel.index();
    let row = grade.wrapping_sub(1);
    let omega2 = (TAU * frequency).powi(2);
    match form {
        Form::FraHamidYang => {
            let Some(a) = HAMID_YANG_A[i].get(row).map(|a| a * 1e-7) else { return f64::NAN };
            let [p1, p2] = HAMID_YANG_PHI[i].map(|p| p * p);
            let p = frequency * frequency;
            match channel {
                Channel::Lateral | Channel::Vertical => a * p2 * (p + p1) / (p * p * (p + p2)),
                Channel::CrossLevel | Channel::Gauge => a * p2 / ((p + p1) * (p + p2)),
            }
        }
        Form::FraCutoff => {
            let Some([av, aa, ws]) = CUTOFF.get(row) else { return f64::NAN };
            let c2 = CUTOFF_OMEGA_C * CUTOFF_OMEGA_C;
            let per_radian = 1e-4
                * match channel {
                    Channel::Lateral => CUTOFF_K * aa * c2 / (omega2 * (omega2 + c2)),
                    Channel::Vertical => CUTOFF_K * av * c2 / (omega2 * (omega2 + c2)),
                    Channel::CrossLevel | Channel::Gauge => {
                        4.0 * CUTOFF_K * av * c2 / ((omega2 + c2) * (omega2 + ws * ws))
                    }
                };
            TAU * per_radian
        }
        Form::Erri => {
            let Some([aa, av, ag]) = ERRI_A.get(row) else { return f64::NAN };
            let [c2, r2, s2] = ERRI_OMEGA.map(|w| w * w);
            let plain = c2 / ((omega2 + r2) * (omega2 + c2));
            let relative = plain * omega2 / (omega2 + s2);
            let half_base = 0.5 * BASE;
            TAU * match channel {
                Channel::Lateral => aa * plain,
                Channel::Vertical => av * plain,
                Channel::CrossLevel => av / (half_base * half_base) * relative * BASE * BASE,
                Channel::Gauge => ag * relative,
            }
        }
        Form::Table => f64::NAN,
    }
}

impl Psd {
    /// One of each form.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let fra = |form, class, gauge| Self {
            form,
            class: Some(class),
            level: None,
            density: None,
            density_rad: None,
            wavelengths: [1.5, 40.0],
            seed: 1,
            period: 1000.0,
            gauge,
            scale: 1.0,
        };
        vec![
            fra(Form::FraHamidYang, 6, GaugeSeries::CrossLevel),
            fra(Form::FraCutoff, 4, GaugeSeries::Independent),
            Self {
                class: None,
                level: Some(Level::Low),
                wavelengths: [3.0, 150.0],
                seed: 7,
                period: 777.7,
                scale: 0.8,
                ..fra(Form::Erri, 1, GaugeSeries::Independent)
            },
            Self {
                class: None,
                density: Some(Density {
                    vertical: vec![[0.02, 4e-4], [0.1, 6e-6], [0.7, 3e-9]],
                    lateral: vec![[0.01, 1e-3], [0.7, 2e-9]],
                    ..Density::default()
                }),
                ..fra(Form::Table, 1, GaugeSeries::Independent)
            },
        ]
    }

    /// One-sided spectral density of a channel in m2/(1/m) at `frequency` in cycles per metre, without the scale; NaN where
    /// what is written does not fit the form.
    #[must_use]
    pub fn spectrum(&self, channel: Channel, frequency: f64) -> f64 {
        match (self.form, &self.density, &self.density_rad) {
            (Form::Table, Some(density), None) => density.at(channel, frequency),
            // Per rad/m: times 2 pi.
            (Form::Table, None, Some(density)) => TAU * density.at(channel, TAU * frequency),
            (form, ..) => self.grade().map_or(f64::NAN, |grade| spectrum(form, grade, channel, frequency)),
        }
    }

    /// FRA class, or 1 low, 2 high; none where the written one does not fit the form.
    fn grade(&self) -> Option<usize> {
        match (self.form, self.class, self.level) {
            (Form::FraCutoff | Form::FraHamidYang, Some(class), None) if (1..=6).contains(&class) => {
                usize::try_from(class).ok()
            }
            (Form::Erri, None, Some(Level::Low)) => Some(1),
            (Form::Erri, None, Some(Level::High)) => Some(2),
            _ => None,
        }
    }

    /// Everything that is wrong with it; `at` is the path of its table.
    pub(super) fn faults(&self, at: &KeyPath, faults: &mut Vec<Fault>) {
        self.grade_faults(at, faults);
        let [short, long] = self.wavelengths;
        let key = at.key("wavelengths");
        let mut good = require(faults, key.index(0), short, |w| w > 0.0, "above 0 m");
        good &= require(faults, key.index(1), long, |w| w > 0.0, "above 0 m");
        if good && short >= long {
            let fault = Fault::new(key, format!("[{short}, {long}]"), "the shortest, then the longest, m");
            faults.push(fault.hint("turn them round"));
            good = false;
        }
        self.table_faults(good, at, faults);
        let at_period = at.key("period");
        if require(faults, at_period.clone(), self.period, |p| p > 0.0, "above 0 m") && good {
            let nodes = self.period / self.cell();
            if nodes > MAX_NODES {
                let most = MAX_NODES * self.cell();
                let allowed = format!("at most {most:.0} m with a shortest wavelength of {short} m");
                faults.push(Fault::new(at_period, format!("{} m", self.period), allowed));
            } else if self.harmonics().is_empty() {
                let allowed = format!("at least {short} m, so that a wave of {short} to {long} m fits in it");
                faults.push(Fault::new(at_period, format!("{} m", self.period), allowed));
            }
        }
        scale_faults(self.scale, at, faults);
    }

    fn grade_faults(&self, at: &KeyPath, faults: &mut Vec<Fault>) {
        let (erri, fra) =
            (self.form == Form::Erri, matches!(self.form, Form::FraCutoff | Form::FraHamidYang));
        match self.class {
            None if fra => {
                faults.push(Fault::new(at.key("class"), "nothing", "1 to 6 with an FRA form"));
            }
            Some(class) if fra && !(1..=6).contains(&class) => {
                faults.push(Fault::new(at.key("class"), class.to_string(), "1 (worst) to 6 (best)"));
            }
            Some(class) if erri => {
                let fault = Fault::new(at.key("class"), class.to_string(), "not with form = \"erri\"");
                faults.push(fault.hint("level = \"low\" or \"high\""));
            }
            Some(class) if !fra => {
                faults.push(Fault::new(at.key("class"), class.to_string(), "only with an FRA form"));
            }
            _ => {}
        }
        match self.level {
            None if erri => {
                let allowed = "\"low\" or \"high\" with form = \"erri\"";
                faults.push(Fault::new(at.key("level"), "nothing", allowed));
            }
            Some(_) if !erri => {
                let fault = Fault::new(at.key("level"), "a level", "only with form = \"erri\"");
                faults.push(if fra { fault.hint("class = 1 to 6") } else { fault });
            }
            _ => {}
        }
    }

    /// `density` and `density_rad`: one of them with a table, none without.
    fn table_faults(&self, wavelengths_good: bool, at: &KeyPath, faults: &mut Vec<Fault>) {
        let [short, long] = self.wavelengths;
        let band = if wavelengths_good { [1.0 / long, 1.0 / short] } else { [f64::INFINITY, 0.0] };
        let table = self.form == Form::Table;
        if table && self.density.is_some() == self.density_rad.is_some() {
            let found = if self.density.is_some() { "density and density_rad" } else { "nothing" };
            let allowed = "points with form = \"table\": density (1/m) or density_rad (rad/m)";
            faults.push(Fault::new(at.key("density"), found, allowed));
            return;
        }
        for (key, density, factor, unit) in
            [("density", &self.density, 1.0, "1/m"), ("density_rad", &self.density_rad, TAU, "rad/m")]
        {
            let Some(density) = density else { continue };
            if table {
                density.faults(band.map(|f| factor * f), unit, &at.key(key), faults);
            } else {
                faults.push(Fault::new(at.key(key), "points", "only with form = \"table\""));
            }
        }
    }

    fn cell(&self) -> f64 {
        MAX_CELL.min(self.wavelengths[0] / NODES_PER_WAVE)
    }

    /// Harmonics of the period in the band. A wavelength of 40 m in a period of 1000 m counts despite rounding.
    fn harmonics(&self) -> std::ops::RangeInclusive<usize> {
        let [short, long] = self.wavelengths;
        let first = (self.period / long * (1.0 - 1e-12)).ceil().max(1.0);
        let last = (self.period / short * (1.0 + 1e-12)).floor();
        first as usize..=last as usize
    }
}

/// One node of the table: values of the four channels (m), then their slopes. A cache line.
type Node = [f64; 8];

/// A realisation, tabulated over one period with exact values and slopes.
#[derive(Debug, Clone)]
pub(super) struct Realisation {
    nodes: Vec<Node>,
    period: f64,
    cell: f64,
}

impl Realisation {
    /// `psd` has no faults.
    pub fn new(psd: &Psd) -> Self {
        let count = ((psd.period / psd.cell()).ceil().clamp(4.0, MAX_NODES) as usize).next_power_of_two();
        let mut nodes = vec![[0.0; 8]; count];
        for channel in Channel::ALL {
            if channel == Channel::Gauge && psd.gauge == GaugeSeries::CrossLevel {
                for node in &mut nodes {
                    (node[3], node[7]) = (node[2], node[6]);
                }
            } else {
                fill(&mut nodes, psd, channel);
            }
        }
        Self { period: psd.period, cell: psd.period / count as f64, nodes }
    }

    /// Values and slopes at `s`.
    #[inline]
    pub fn at(&self, s: f64) -> Node {
        // The distance into the period; rounding may give the period itself: node 0 of the next turn.
        let x = (s - (s / self.period).floor() * self.period) / self.cell;
        let index = x as usize;
        let count = self.nodes.len();
        // `new` makes the number of nodes a power of two.
        let left = &self.nodes[index & (count - 1)];
        let right = &self.nodes[(index + 1) & (count - 1)];
        let Hermite { value: v, slope: d } = Hermite::at(x - index as f64, self.cell);
        let mut out = [0.0; 8];
        for i in 0..4 {
            let ends = [left[i], right[i], left[i + 4], right[i + 4]];
            out[i] = v[0] * ends[0] + v[1] * ends[1] + v[2] * ends[2] + v[3] * ends[3];
            out[i + 4] = d[0] * ends[0] + d[1] * ends[1] + d[2] * ends[2] + d[3] * ends[3];
        }
        out
    }
}

/// Writes one channel of the realisation and its slope into the table.
fn fill(nodes: &mut [Node], psd: &Psd, channel: Channel) {
    let mut seed = [0; 32];
    seed[..8].copy_from_slice(&psd.seed.to_le_bytes());
    let mut random = ChaCha8Rng::from_seed(seed);
    random.set_stream(channel.index() as u64);
    let harmonics = psd.harmonics();
    let mut values = vec![[0.0; 2]; nodes.len()];
    let mut slopes = values.clone();
    for k in 1..=*harmonics.end() {
        let phase = TAU * (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        if k < *harmonics.start() {
            continue;
        }
        let frequency = k as f64 / psd.period;
        let amplitude = psd.scale * (2.0 * psd.spectrum(channel, frequency) / psd.period).sqrt();
        let (sin, cos) = phase.sin_cos();
        let rate = TAU * frequency;
        values[k] = [amplitude * cos, amplitude * sin];
        slopes[k] = [-rate * amplitude * sin, rate * amplitude * cos];
    }
    fft::inverse(&mut values);
    fft::inverse(&mut slopes);
    let i = channel.index();
    for ((node, value), slope) in nodes.iter_mut().zip(values).zip(slopes) {
        (node[i], node[i + 4]) = (value[0], slope[0]);
    }
}
