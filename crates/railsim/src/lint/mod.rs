//! LMAP 1.1: what looks wrong in a vehicle's description, each finding with a code.
//!
//! Rules read the vehicle as written, then as compiled, then as it stands on its wheels, as far as that goes: what cannot
//! be compiled is not weighed. One file for each family of rules; [`codes::CODES`] lists what they may say. Every code has a section
//! in `docs/reference/lint.md` whose example is run by `tests/lint_codes.rs`.

pub mod codes;

mod connectivity;
mod geometry;
mod inertia;
mod local;
mod names;
mod reading;
mod rest;
mod step;
mod subject;
mod suspension;
mod symmetry;
mod units;

use serde_json::{Value as Json, json};

pub use codes::{CODES, Code, Severity};
pub use reading::unreadable;

use crate::error::{KeyPath, Segment};
use crate::run::{Ended, Outcome};
use crate::schema::Case;
use subject::Subject;

/// One thing that looks wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What it is an example of.
    pub code: &'static Code,
    /// The element, by name.
    pub subject: String,
    /// Where it was written; starts with `vehicle` or `run`.
    pub key: KeyPath,
    /// What was found there.
    pub found: String,
    /// What is usual.
    pub usual: String,
}

/// Findings, as families make them.
#[derive(Debug, Default)]
struct Report {
    findings: Vec<Finding>,
}

impl Report {
    fn add(
        &mut self,
        code: &str,
        subject: impl Into<String>,
        key: KeyPath,
        found: impl Into<String>,
        usual: impl Into<String>,
    ) {
        let Some(code) = codes::of(code) else {
            debug_assert!(false, "{code} is not in the table");
            return;
        };
        let (subject, found, usual) = (subject.into(), found.into(), usual.into());
        self.findings.push(Finding { code, subject, key, found, usual });
    }

    fn any(&self, code: &str) -> bool {
        self.findings.iter().any(|f| f.code.code.starts_with(code))
    }

    /// Without consequences of others, elements of one template told once, worst first.
    fn done(self, written: &Json) -> Vec<Finding> {
        let shown = |f: &Finding| !f.code.after.iter().any(|code| self.any(code));
        let mut merged: Vec<(Finding, usize)> = Vec::new();
        for finding in self.findings.iter().filter(|f| shown(f)) {
            match merged.iter_mut().find(|(f, _)| f.code == finding.code && f.key == finding.key) {
                Some((first, more)) if first.subject != finding.subject => *more += 1,
                Some(_) => {}
                None => merged.push((finding.clone(), 0)),
            }
        }
        let mut findings: Vec<Finding> = merged
            .into_iter()
            .map(|(mut f, more)| {
                if more > 0 {
                    f.subject = format!("{} and {more} more", f.subject);
                }
                if let Some(reference) = reference_at(written, &f.key) {
                    f.found = format!("{} (from ${reference})", f.found);
                }
                f
            })
            .collect();
        findings.sort_by(|a, b| (b.code.severity, a.code.code).cmp(&(a.code.severity, b.code.code)));
        findings
    }
}

/// The named parameter that stands at a key of the vehicle as written.
fn reference_at<'a>(written: &'a Json, key: &KeyPath) -> Option<&'a str> {
    let path = key.0.split_first().filter(|(first, _)| **first == Segment::Key("vehicle".into()))?.1;
    let place = path.iter().try_fold(written, |value, segment| match segment {
        Segment::Key(key) => value.get(key),
        Segment::Index(i) => value.get(i),
    })?;
    let text = place.as_str()?;
    text.strip_prefix('-').unwrap_or(text).strip_prefix('$')
}

/// Everything that looks wrong with a case's vehicle, errors first. Never fails: what stops a vehicle from being compiled or
/// from standing is a finding too.
#[must_use]
pub fn lint(case: &Case) -> Vec<Finding> {
    let subject = Subject::new(case);
    let mut report = Report::default();
    for family in FAMILIES {
        family(&subject, &mut report);
    }
    report.done(&case.written)
}

/// Keep this list in the order of the codes.
const FAMILIES: [fn(&Subject<'_>, &mut Report); 9] = [
    reading::find,
    names::find,
    connectivity::find,
    geometry::find,
    units::find,
    inertia::find,
    symmetry::find,
    suspension::find,
    rest_and_step,
];

fn rest_and_step(subject: &Subject<'_>, report: &mut Report) {
    rest::find(subject, report);
    step::find(subject, report);
}

/// Runs a case of kind `lint`: a row for each finding. Numbers are its severity alone (2 error, 1 warning); the rest are texts.
#[must_use]
pub fn run(case: &Case) -> Outcome {
    let findings = lint(case);
    let errors = findings.iter().filter(|f| f.code.severity == Severity::Error).count();
    let text = |name: &str, of: fn(&Finding) -> String| (name.to_owned(), findings.iter().map(of).collect());
    Outcome {
        columns: vec![(
            columns().remove(0),
            findings.iter().map(|f| f64::from(f.code.severity as u8)).collect(),
        )],
        labels: vec![
            text("code", |f| f.code.code.to_owned()),
            text("rule", |f| f.code.name.to_owned()),
            text("subject", |f| f.subject.clone()),
            text("key", |f| f.key.to_string()),
            text("path", |f| path(&f.key).to_string()),
            text("found", |f| f.found.clone()),
            text("usual", |f| f.usual.clone()),
        ],
        ended: Ended::Complete,
        statistics: json!({
            "analysis": "lint",
            "errors": errors,
            "warnings": findings.len() - errors,
            "rules": CODES.len(),
        }),
    }
}

/// Columns of numbers.
#[must_use]
pub fn columns() -> Vec<String> {
    vec!["severity".to_owned()]
}

/// A finding as plain data.
#[must_use]
pub fn to_json(finding: &Finding) -> Json {
    json!({
        "code": finding.code.code,
        "rule": finding.code.name,
        "severity": finding.code.severity.name(),
        "subject": finding.subject,
        "key": finding.key.to_string(),
        "path": path(&finding.key),
        "found": finding.found,
        "usual": finding.usual,
    })
}

/// A key path as a JSON list, as other programs take it.
fn path(key: &KeyPath) -> Json {
    let part = |s: &Segment| match s {
        Segment::Key(key) => json!(key),
        Segment::Index(i) => json!(i),
    };
    key.0.iter().map(part).collect()
}
