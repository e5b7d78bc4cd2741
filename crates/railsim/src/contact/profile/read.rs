//! Profiles from text and to text: one door for all formats.
//!
//! [`read`] finds the format, parses, turns the points into the one form that the rest of the program knows (y outward, z down, flange
//! or gauge corner at negative y, metres, from the flange or gauge side outward) and says in [`Detected`] what it found
//! and why. [`ReadOptions`] overrules each finding.
//!
//! - **Format**: by content first (a SIMPACK section, a VAMPIRE first line, MiniProf's `Key=Value` lines), then by the
//!   extension. A `.rail` file is thus MiniProf's with such lines and GENSYS's without.
//! - **Wheel or rail**: as asked for, else as the file says, else by extension, else by [shape](super::shape). A shape that plainly
//!   contradicts what was said is an error.
//! - **Unit**: as the file says, else millimetres. A width that is none of a profile is an error that names the factor, never a
//!   silent correction.
//! - **z**: down, whichever way the file has it: the flange, or the sides of a rail's head, hang.
//! - **y**: a wheel's flange shows it. A rail's shape does not, so there the format's own rule holds.

use serde::{Deserialize, Serialize};

use super::shape::{Shape, wrong_kind, wrong_unit};
use super::text::key;
use super::{csv, gensys, miniprof, simpack, vampire};
use crate::error::{Error, Fault, Result};

pub use super::ProfileKind;

/// Points from which on a shape is looked at.
pub(super) const LEAST_POINTS: usize = 8;

/// A form of profile files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// Two columns, mm: `.csv` and anything unknown.
    Csv,
    /// `.whl`, `.ban`, `.mpt`, and `.rail` with `Key=Value` lines.
    Miniprof,
    /// `.prw`, `.prr`; CONTACT reads them too.
    Simpack,
    /// `.wheel`, and `.rail` without `Key=Value` lines.
    Gensys,
    /// `.whe`, `.rai`; read only.
    Vampire,
}

/// A unit of length of a file's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LengthUnit {
    /// Millimetre.
    Mm,
    /// Centimetre.
    Cm,
    /// Metre.
    M,
    /// Inch.
    In,
}

impl LengthUnit {
    /// In metres.
    #[must_use]
    pub fn metres(self) -> f64 {
        match self {
            Self::Mm => 1e-3,
            Self::Cm => 1e-2,
            Self::M => 1.0,
            Self::In => 0.0254,
        }
    }
}

/// What overrules detection; nothing by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ReadOptions {
    /// Wheel or rail. A shape that plainly is the other is an error.
    pub kind: Option<ProfileKind>,
    /// Format of the text.
    pub format: Option<Format>,
    /// Unit of the file's numbers.
    pub unit: Option<LengthUnit>,
    /// Whether the file's y is turned round.
    pub mirror_y: Option<bool>,
    /// Whether the file's z is turned round.
    pub mirror_z: Option<bool>,
}

/// How a profile is written.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WriteOptions {
    /// Wheel or rail; by the extension if absent. Only SIMPACK's files say it.
    pub kind: Option<ProfileKind>,
    /// Format; by the extension if absent (`.rail` is written as GENSYS's).
    pub format: Option<Format>,
    /// One line for the head of the file.
    pub title: String,
}

/// A finding and what it rests on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Told<T> {
    /// What was found.
    pub value: T,
    /// Why, for a person.
    pub because: String,
}

impl<T> Told<T> {
    fn new(value: T, because: impl Into<String>) -> Self {
        Self { value, because: because.into() }
    }
}

/// What was found out about a profile file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Detected {
    /// Format.
    pub format: Told<Format>,
    /// Wheel, rail, or not known.
    pub kind: Told<Option<ProfileKind>>,
    /// One of the file's length units in metres.
    pub unit: Told<f64>,
    /// Whether y was turned round.
    pub mirrored_y: Told<bool>,
    /// Whether z was turned round.
    pub mirrored_z: Told<bool>,
    /// Whether the order of the points was turned round, so that they run from the flange or gauge side outward.
    pub reversed: bool,
    /// What else is worth knowing: keys that were applied or are not used.
    pub notes: Vec<String>,
}

/// A profile as read: points in the form that [`Profile`](super::Profile) takes, and what was found out on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct PointList {
    /// [y, z], m: y outward, z down, from the flange or gauge side outward.
    pub points: Vec<[f64; 2]>,
    /// Wheel or rail, where it is known.
    pub kind: Option<ProfileKind>,
    /// What was found out.
    pub detected: Detected,
}

/// Points as they stand in a file, and what the file says of them.
pub(super) struct Raw {
    pub points: Vec<[f64; 2]>,
    /// m per unit of the points.
    pub unit: f64,
    pub unit_because: &'static str,
    pub kind: Option<(ProfileKind, &'static str)>,
    pub notes: Vec<String>,
}

impl Raw {
    pub fn millimetres(points: Vec<[f64; 2]>) -> Self {
        Self { points, unit: 1e-3, unit_because: "the format is in mm", kind: None, notes: Vec::new() }
    }
}

/// Which axes a format turns round, where the shape does not tell.
#[derive(Clone, Copy)]
pub(super) struct Rule {
    pub mirror_y: bool,
    pub mirror_z: bool,
    pub because: &'static str,
}

/// Text of points in the program's form.
type Writer = fn(&[[f64; 2]], &WriteOptions) -> String;

/// One format.
pub(super) struct Codec {
    pub format: Format,
    pub extensions: &'static [&'static str],
    /// Why the text is of this format; `None` where it does not show.
    pub sniff: fn(&str) -> Option<&'static str>,
    pub rule: Rule,
    pub parse: fn(text: &str, name: &str) -> Result<Raw>,
    pub write: Option<Writer>,
}

/// All formats, in the order in which their contents are tried.
const CODECS: [&Codec; 5] = [&vampire::CODEC, &simpack::CODEC, &miniprof::CODEC, &gensys::CODEC, &csv::CODEC];

/// Extension of a file name in lower case, without the dot; empty if there is none.
fn extension(name: &str) -> String {
    let file = name.rsplit(['/', '\\']).next().unwrap_or_default();
    file.rsplit_once('.').map_or(String::new(), |(_, extension)| extension.to_ascii_lowercase())
}

fn of_extension(extension: &str) -> Option<&'static Codec> {
    CODECS.into_iter().find(|codec| codec.extensions.contains(&extension))
}

fn of_format(format: Format) -> &'static Codec {
    CODECS.into_iter().find(|codec| codec.format == format).unwrap_or(&csv::CODEC)
}

fn kind_of_extension(extension: &str) -> Option<ProfileKind> {
    match extension {
        "whl" | "prw" | "wheel" | "whe" => Some(ProfileKind::Wheel),
        "ban" | "prr" | "rail" | "rai" => Some(ProfileKind::Rail),
        _ => None,
    }
}

fn codec(text: &str, extension: &str, asked: Option<Format>) -> (&'static Codec, String) {
    if let Some(format) = asked {
        return (of_format(format), "asked for".to_owned());
    }
    if let Some((codec, why)) =
        CODECS.into_iter().find_map(|codec| (codec.sniff)(text).map(|why| (codec, why)))
    {
        return (codec, why.to_owned());
    }
    match of_extension(extension) {
        Some(codec) if !extension.is_empty() => (codec, format!("extension .{extension}")),
        _ => (&csv::CODEC, "neither content nor extension say otherwise".to_owned()),
    }
}

/// Reads a profile. `name` is the file's name or that of the profile: its extension counts, and messages call the profile so.
///
/// Fewer than eight points are handed on as they are by the format's rule: too few to see a shape in.
///
/// # Errors
/// [`Error::Input`] with
/// - every line that the format does not allow, numbers that are not finite, a text without points,
/// - wheel or rail said in two ways that contradict each other, or against the shape,
/// - a width that no profile has, with the factor that would mend it.
pub fn read(text: &str, name: &str, options: &ReadOptions) -> Result<PointList> {
    let extension = extension(name);
    let (codec, format_because) = codec(text, &extension, options.format);
    let raw = (codec.parse)(text, name)?;
    let said = said_kind(&raw, &extension, name, options)?;
    let (unit, unit_because) = match options.unit {
        Some(unit) => (unit.metres(), "asked for"),
        None => (raw.unit, raw.unit_because),
    };
    let mut points: Vec<[f64; 2]> = raw.points.iter().map(|p| p.map(|x| x * unit)).collect();
    let plenty = points.len() >= LEAST_POINTS;
    let refuse = |fault: Fault| Err(Error::input(fault));
    if let Some(p) = points.iter().find(|p| !(p[0].is_finite() && p[1].is_finite())) {
        let found = format!("[{}, {}] after shifting and scaling", p[0], p[1]);
        return refuse(Fault::new(key(name), found, "finite numbers"));
    }
    if plenty && let Some(fault) = wrong_unit(&points, &key(name)) {
        return refuse(fault.hint("the option unit says what the file's numbers are: mm, cm, m, in"));
    }
    let shape = Shape::of(&points, said.as_ref().map(|s| s.value));
    if plenty
        && let Some(said) = &said
        && let Some(fault) = wrong_kind(&shape, said.value, &key(name))
    {
        return refuse(fault.hint(format!("{} said so", said.because)));
    }
    let kind = match said {
        Some(told) => Told { value: Some(told.value), because: told.because },
        None => Told::new(shape.kind.filter(|_| plenty), shape.words.clone()),
    };
    let rule = codec.rule;
    let seen = |seen: Option<bool>| seen.filter(|_| plenty);
    let mirrored_z = turned(options.mirror_z, seen(shape.z_up), rule.mirror_z, &shape.words, rule.because);
    let flange_out = match kind.value {
        Some(ProfileKind::Rail) => None, // its shape does not show the gauge side
        _ => seen(shape.flange_positive),
    };
    let mirrored_y = turned(options.mirror_y, flange_out, rule.mirror_y, &shape.words, rule.because);
    for p in &mut points {
        // adding zero makes -0 a 0
        *p = [
            if mirrored_y.value { 0.0 - p[0] } else { p[0] },
            if mirrored_z.value { 0.0 - p[1] } else { p[1] },
        ];
    }
    let reversed = points.first().zip(points.last()).is_some_and(|(first, last)| first[0] > last[0]);
    if reversed {
        points.reverse();
    }
    Ok(PointList {
        points,
        kind: kind.value,
        detected: Detected {
            format: Told::new(codec.format, format_because),
            kind,
            unit: Told::new(unit, unit_because),
            mirrored_y,
            mirrored_z,
            reversed,
            notes: raw.notes,
        },
    })
}

/// Wheel or rail, as the user, the file or its extension say; they must not contradict each other.
fn said_kind(
    raw: &Raw,
    extension: &str,
    name: &str,
    options: &ReadOptions,
) -> Result<Option<Told<ProfileKind>>> {
    let all = [
        options.kind.map(|kind| Told::new(kind, "what was asked for")),
        raw.kind.map(|(kind, because)| Told::new(kind, because)),
        kind_of_extension(extension).map(|kind| Told::new(kind, format!("extension .{extension}"))),
    ];
    let mut said = all.into_iter().flatten();
    let Some(first) = said.next() else { return Ok(None) };
    match said.find(|other| other.value != first.value) {
        None => Ok(Some(first)),
        Some(other) => Err(Error::input(Fault::new(
            key(name),
            format!("a {} by {}", other.value.word(), other.because),
            format!("a {}, by {}", first.value.word(), first.because),
        ))),
    }
}

fn turned(asked: Option<bool>, seen: Option<bool>, rule: bool, shape: &str, because: &str) -> Told<bool> {
    match (asked, seen) {
        (Some(asked), _) => Told::new(asked, "asked for"),
        (None, Some(seen)) => Told::new(seen, shape),
        (None, None) => Told::new(rule, because),
    }
}

/// Writes points ([y, z], m; y outward, z down, from the flange or gauge side outward) as a file called `name`.
///
/// [`read`] gives the same points again, exactly where they came from millimetres with up to nine decimals.
///
/// # Errors
/// - a format that cannot be written (VAMPIRE: nothing says how), an extension that no format has,
/// - SIMPACK without wheel or rail said, or with an extension that says the other,
/// - a point that is not finite, no point at all.
pub fn write(points: &[[f64; 2]], name: &str, options: &WriteOptions) -> Result<String> {
    let extension = extension(name);
    let refuse = |found: String, allowed: &str| Err(Error::input(Fault::new(key(name), found, allowed)));
    let Some(codec) = options.format.map(of_format).or_else(|| of_extension(&extension)) else {
        let known: Vec<String> = CODECS
            .iter()
            .flat_map(|c| c.extensions)
            .filter(|e| !e.is_empty())
            .map(|e| format!(".{e}"))
            .collect();
        return refuse(format!("extension .{extension}"), &known.join(", "));
    };
    let Some(write) = codec.write else {
        return refuse(
            "VAMPIRE, of which no specification is public".to_owned(),
            "csv, miniprof, simpack, gensys",
        );
    };
    if points.is_empty() {
        return refuse("no point".to_owned(), "points");
    }
    if let Some((i, p)) = points.iter().enumerate().find(|(_, p)| !(p[0].is_finite() && p[1].is_finite())) {
        return Err(Error::input(Fault::new(
            key(name).index(i),
            format!("[{}, {}]", p[0], p[1]),
            "finite numbers",
        )));
    }
    let mut options = options.clone();
    let by_extension = kind_of_extension(&extension);
    match (options.kind, by_extension) {
        (Some(kind), Some(other)) if kind != other => {
            return refuse(format!("a {} for .{extension}", kind.word()), "an extension of its kind");
        }
        (kind, other) => options.kind = kind.or(other),
    }
    if codec.format == Format::Simpack && options.kind.is_none() {
        return refuse("neither wheel nor rail".to_owned(), "SIMPACK files say which: kind, .prw or .prr");
    }
    Ok(write(points, &options))
}
