//! The table of codes. A new finding is a row here, a rule in its family's file and a section in `docs/reference/lint.md`.

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Unusual; may be meant.
    Warning = 1,
    /// Cannot be right.
    Error = 2,
}

impl Severity {
    /// The word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// A kind of finding.
#[derive(Debug, PartialEq, Eq)]
pub struct Code {
    /// `LM`, the family's digit, two more.
    pub code: &'static str,
    /// The same in words.
    pub name: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong, in one line.
    pub summary: &'static str,
    /// Codes, or beginnings of codes, beside which it is not said: it would be their consequence.
    pub after: &'static [&'static str],
}

const fn error(code: &'static str, name: &'static str, summary: &'static str) -> Code {
    Code { code, name, severity: Severity::Error, summary, after: &[] }
}

const fn warning(code: &'static str, name: &'static str, summary: &'static str) -> Code {
    Code { code, name, severity: Severity::Warning, summary, after: &[] }
}

impl Code {
    const fn after(self, after: &'static [&'static str]) -> Self {
        Self { after, ..self }
    }
}

/// Faults that leave no vehicle to be weighed: nothing said of stiffness or balance would be worth reading beside them.
const BROKEN: &[&str] = &["LM00", "LM201", "LM202", "LM203", "LM301", "LM306", "LM4", "LM501"];
/// The same, and what makes suspensions senseless.
const UNSOUND: &[&str] = &[
    "LM00", "LM201", "LM202", "LM203", "LM301", "LM305", "LM306", "LM307", "LM4", "LM501", "LM701", "LM702",
];
/// The same, and axles in the air.
const LIFTED: &[&str] = &[
    "LM00", "LM201", "LM202", "LM203", "LM301", "LM305", "LM306", "LM307", "LM4", "LM501", "LM701", "LM702",
    "LM804",
];
/// The same as unsound, and what no step follows.
const FAST: &[&str] = &[
    "LM00", "LM201", "LM202", "LM203", "LM301", "LM305", "LM306", "LM307", "LM4", "LM501", "LM701", "LM702",
    "LM902",
];

/// Every code. Keep this list sorted.
pub const CODES: [Code; 47] = [
    error("LM001", "refused", "the file is no vehicle: a key that is unknown, missing or out of range"),
    error("LM002", "unknown-name", "a parameter, template, body or condition that does not exist"),
    error("LM003", "not-compiled", "the parts do not make a model")
        .after(&["LM201", "LM202", "LM203", "LM301", "LM305", "LM4"]),
    warning("LM101", "unused-parameter", "a named parameter that nothing refers to"),
    warning("LM102", "unused-template", "a template that nothing uses"),
    warning("LM103", "idle-condition", "a condition that sets a parameter to what it is anyway"),
    error("LM201", "unconnected-body", "a body that no connection holds"),
    error("LM202", "island", "bodies connected among themselves, but to no wheelset"),
    error("LM203", "weight-not-carried", "a body whose weight no connection carries to the wheels")
        .after(&["LM201", "LM202"]),
    warning("LM204", "no-effect", "a connection with neither stiffness nor damping"),
    warning("LM205", "duplicate-connection", "two equal connections between the same points"),
    error("LM301", "zero-length", "an element along its line whose ends meet"),
    warning("LM302", "too-long", "an element much longer than others of its kind").after(&["LM404"]),
    warning("LM303", "far-end", "a connection that ends far from its body")
        .after(&["LM307", "LM4", "LM501", "LM502"]),
    warning("LM304", "far-sensor", "a sensor far from its body").after(&["LM307", "LM4", "LM501", "LM502"]),
    error("LM305", "wheels-off-rail", "wheels that are not above the rails").after(&["LM404"]),
    error("LM306", "wheelsets-overlap", "two wheelsets nearer to each other than their wheels let them")
        .after(&["LM404"]),
    error("LM307", "below-rail", "a centre of mass at or below the top of rail").after(&["LM404"]),
    error("LM401", "mass-unit", "a mass that looks as if given in tonnes or grams"),
    error("LM402", "inertia-unit", "moments of inertia that do not fit mass and size"),
    error("LM403", "stiffness-unit", "a stiffness that looks as if given in N/mm").after(&["LM404"]),
    error("LM404", "length-unit", "a length that looks as if given in millimetres"),
    error("LM405", "modulus-unit", "a Young's modulus that is none of steel"),
    warning("LM406", "wheel-radius", "a wheel of unusual size").after(&["LM404"]),
    warning("LM407", "design-speed", "an unusual design speed"),
    error("LM501", "impossible-inertia", "moments of inertia that no rigid body has"),
    warning("LM502", "spin-inertia", "a wheelset whose moment about its axle is unusual").after(&["LM4"]),
    warning("LM503", "off-centre", "a centre of mass beside the vehicle's centre line").after(&["LM404"]),
    warning("LM601", "left-right-place", "a connection without its like on the other side").after(&["LM404"]),
    warning("LM602", "left-right-value", "a connection that differs from the one on the other side")
        .after(&["LM403"]),
    warning("LM603", "front-rear-body", "a body without its like at the other end")
        .after(&["LM401", "LM404"]),
    warning("LM604", "front-rear-connection", "a connection without its like at the other end")
        .after(&["LM404", "LM603"]),
    error("LM701", "too-stiff", "a connection whose local eigenvalue is above 5000 rad/s").after(BROKEN),
    error("LM702", "too-soft", "a suspension that its load deflects by more than 0.5 m").after(BROKEN),
    warning("LM703", "deflection", "an unusual static deflection").after(BROKEN),
    warning("LM704", "undamped", "a suspension without damping").after(BROKEN),
    warning("LM705", "over-critical", "a suspension damped beyond twice the critical value").after(UNSOUND),
    warning("LM706", "no-travel", "a damper held still by a stiff connection beside it").after(UNSOUND),
    error("LM801", "no-balance", "the vehicle does not stand").after(UNSOUND),
    warning("LM802", "wheel-loads", "wheels of an axle that carry unequal loads").after(LIFTED),
    warning("LM803", "axle-loads", "axles that carry unequal loads").after(LIFTED),
    error("LM804", "wheel-lifted", "a wheel that carries nothing at rest").after(UNSOUND),
    warning("LM806", "stop-in-contact", "a bump stop that is met at rest").after(UNSOUND),
    warning("LM807", "axle-load", "an unusual axle load").after(UNSOUND),
    error("LM808", "falls-over", "a vehicle whose balance at rest is unstable").after(UNSOUND),
    error("LM901", "step-too-large", "a time step with which the integrator is unstable").after(FAST),
    warning("LM902", "fast-eigenvalue", "a linearised vehicle with an eigenvalue above 5000 rad/s")
        .after(UNSOUND),
];

/// The row of a code.
#[must_use]
pub fn of(code: &str) -> Option<&'static Code> {
    CODES.binary_search_by(|c| c.code.cmp(code)).ok().map(|i| &CODES[i])
}
