//! LM9: the vehicle and the step that it is to be run with.

use super::Report;
use super::subject::Subject;
use super::suspension::FASTEST;
use crate::error::{Error, KeyPath};
use crate::run::stability;

pub(super) fn find(subject: &Subject<'_>, report: &mut Report) {
    fast(subject, report);
    step(subject, report);
}

fn fast(subject: &Subject<'_>, report: &mut Report) {
    let Some(rest) = subject.standing() else { return };
    let worst = rest.modes.iter().max_by(|a, b| a.eigenvalue.norm().total_cmp(&b.eigenvalue.norm()));
    if let Some(mode) = worst.filter(|m| m.eigenvalue.norm() > FASTEST) {
        let found = format!("{:.0} rad/s: {}", mode.eigenvalue.norm(), mode.name);
        let usual = format!("below {FASTEST} rad/s, wheels on rails included");
        report.add("LM902", &subject.case.vehicle.name, KeyPath::of("vehicle"), found, usual);
    }
}

/// The check that every run makes before its first step, at the speed of the run.
fn step(subject: &Subject<'_>, report: &mut Report) {
    let (Ok(stand), Some(rest)) = (&subject.stand, subject.standing()) else { return };
    let run = &subject.case.run;
    let speed = if run.speed > 0.0 { run.speed } else { subject.case.vehicle.design_speed };
    let mut x = rest.x.clone();
    let mut system = stand.system(speed);
    let rolling =
        crate::dynamics::equilibrium::Conditions { speed, held: &stand.held, push: &[], since: None };
    if crate::dynamics::equilibrium::settle(&mut system, &mut x, rolling).is_err() {
        return; // hunting is not a fault of the description
    }
    if let Err(Error::Input(faults)) = stability::check(&mut system, &x, &run.integrator) {
        for fault in faults {
            report.add("LM901", run.integrator.name(), fault.key, fault.found, fault.allowed);
        }
    }
}
