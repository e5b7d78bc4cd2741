//! LM0: what keeps a file from being a vehicle, and a vehicle from being a model.

use serde_json::{Map, Value as Json};

use super::subject::Subject;
use super::{Finding, Report};
use crate::error::{Error, Fault};
use crate::schema::resolve_summary;

/// Whether a fault is about a name, by the words of `schema` (held by the fixtures of LM002).
fn is_name(fault: &Fault) -> bool {
    const ALLOWED: [&str; 5] = [
        "a body or wheelset",
        "a named parameter",
        "the name of a [template]",
        "a [condition]",
        "the name of a body or wheelset",
    ];
    fault.found.starts_with("the unknown name") || ALLOWED.iter().any(|a| fault.allowed.starts_with(a))
}

fn say(fault: Fault, code: &str, report: &mut Report) {
    let usual = match &fault.hint {
        Some(hint) => format!("{} ({hint})", fault.allowed),
        None => fault.allowed,
    };
    report.add(code, "", fault.key, fault.found, usual);
}

/// What the schema refuses of a vehicle's document with its parameters overridden, in a condition; nothing of a vehicle that can
/// become a case.
#[must_use]
pub fn unreadable(document: &Json, overrides: &Map<String, Json>, condition: Option<&str>) -> Vec<Finding> {
    let mut report = Report::default();
    if let Err(Error::Input(faults)) = resolve_summary(document, overrides, condition) {
        for fault in faults {
            let code = if is_name(&fault) { "LM002" } else { "LM001" };
            say(fault, code, &mut report);
        }
    }
    report.findings
}

pub(super) fn find(subject: &Subject<'_>, report: &mut Report) {
    match &subject.stand {
        Ok(_) => {}
        Err(Error::Input(faults)) => faults.iter().for_each(|f| say(f.clone(), "LM003", report)),
        Err(error) => {
            let key = crate::error::KeyPath::of("vehicle");
            report.add("LM003", "", key, error.to_string(), "a vehicle that can be put together");
        }
    }
}
