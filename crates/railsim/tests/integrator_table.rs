//! The numbers of `docs/concepts/integrators.md`: what each scheme costs and how far it is off on the locomotive over rough track.

mod common;

use std::time::Instant;

use railsim::integrator::{Integrator, Stepper, System};
use railsim::run::{Ended, Free, simulate};
use serde_json::{Value, json};

/// 120 m of class 6 at the speed and on the worn wheels of the hunting test.
fn rough() -> Value {
    let mut value = common::coco134();
    value["condition"] = json!("tare");
    value["run"]["wheel_profile"] = json!("anzr1_worn_1");
    value["run"]["output_step"] = json!(0.008);
    value["track"]["length"] = json!(120.0);
    value["track"]["fade_in"] = json!(30.0);
    value["track"]["irregularity"] = json!({
        "kind": "psd", "form": "fra_hamid_yang", "class": 6, "wavelengths": [1.5, 40.0], "seed": 1, "period": 1000.0
    });
    value
}

const JUDGED: [&str; 3] = ["carbody.lead_pivot.ay", "carbody.lead_pivot.az", "ws1.left.Y"];

struct Measured {
    columns: [Vec<f64>; 3],
    evaluations: f64,
    rejected: u64,
    microseconds: f64,
}

fn measure(integrator: &Value) -> Measured {
    let mut value = rough();
    value["run"]["integrator"] = integrator.clone();
    let case = common::case(&value);
    // With the contact tables, which are made before the first step: a second of it.
    let start = Instant::now();
    let outcome = simulate(&case, &Free).unwrap();
    let wall = start.elapsed().as_secs_f64();
    assert_eq!(outcome.ended, Ended::EndOfTrack, "{integrator}");
    let simulated = outcome.statistics["simulated_s"].as_f64().unwrap();
    Measured {
        columns: JUDGED.map(|name| common::column(&outcome.columns, name).to_vec()),
        evaluations: outcome.statistics["right_hand_sides"].as_f64().unwrap() / simulated,
        rejected: outcome.statistics["rejected"].as_u64().unwrap(),
        microseconds: 1e6 * wall / outcome.statistics["right_hand_sides"].as_f64().unwrap(),
    }
}

/// Root of the mean square of the difference, over that of the signal about its mean.
fn difference(ours: &[f64], reference: &[f64]) -> f64 {
    let mean = reference.iter().sum::<f64>() / reference.len() as f64;
    let off: f64 = ours.iter().zip(reference).map(|(a, b)| (a - b).powi(2)).sum();
    let size: f64 = reference.iter().map(|b| (b - mean).powi(2)).sum();
    (off / size).sqrt()
}

/// Least factor by which halving the step divides an error: the right-hand side has a continuous slope only (tables of
/// contact and connections), which leaves any of the schemes the order 2, factor 4; half an order is left for not being in
/// the limit.
const HALVED: f64 = 2.828;

/// What a tenth of the tolerance divides the error of the wheel force by, likewise: the stiffest mode, which the force shows,
/// takes what the tolerance allows, so that the two are proportional: 10, and half of that order.
const TIGHTENED: f64 = 3.162;

/// Errors are printed for the documentation. Judged is what theory says of them: how they fall with the step and the
/// tolerance.
#[test]
#[allow(clippy::print_stdout)] // the table of the documentation
fn what_each_scheme_costs_and_is_off_by() {
    let reference = measure(&json!({ "kind": "rk4", "step": 1.25e-4 }));
    let off = |integrator: Value| -> [f64; 3] {
        let found = measure(&integrator);
        let off = [0, 1, 2].map(|i| 100.0 * difference(&found.columns[i], &reference.columns[i]));
        println!(
            "{integrator}: {:.0} right-hand sides a simulated second ({:.1} us each), {} rejected; off by {off:.3?} %",
            found.evaluations, found.microseconds, found.rejected
        );
        off
    };
    for (kind, step) in [("heun", 4e-4), ("rk4", 1e-3), ("ros2", 1e-3)] {
        let coarse = off(json!({ "kind": kind, "step": step }));
        let fine = off(json!({ "kind": kind, "step": 0.5 * step }));
        for (coarse, fine) in coarse.into_iter().zip(fine) {
            assert!(coarse > HALVED * fine, "{kind}: {coarse} % at {step} s, {fine} % at half of it");
        }
    }
    let controlled = |step: f64, tolerance: f64| {
        off(json!({ "kind": "heun_controlled", "step": step, "tolerance": tolerance }))
    };
    let (loose, tight, longer) = (controlled(1e-3, 1e-2), controlled(1e-3, 1e-3), controlled(4e-3, 1e-3));
    assert!(loose[2] > TIGHTENED * tight[2], "{loose:?} {tight:?}");
    // The tolerance decides, not the step that is tried first.
    for (longer, tight) in longer.into_iter().zip(tight) {
        assert!(longer < TIGHTENED * tight, "{longer} {tight}");
    }
}

/// q'' = -w^2 q.
struct Mode(f64);

impl System for Mode {
    fn size(&self) -> usize {
        2
    }

    fn rhs(&mut self, _: f64, x: &[f64], dx: &mut [f64]) {
        dx[0] = x[1];
        dx[1] = -self.0 * self.0 * x[0];
    }
}

#[test]
#[allow(clippy::print_stdout)] // the table of the documentation
fn energy_of_a_mode_of_5_hz_after_10_seconds() {
    let w = std::f64::consts::TAU * 5.0;
    for (integrator, theirs) in [
        // Energy per step: Heun 1 + y^4/4, rk4 1 - y^6/72, ros2 outside its blocks as Heun; y = w h.
        (Integrator::Heun { step: 4e-4 }, 1.0 + (w * 4e-4).powi(4) / 4.0),
        (
            Integrator::HeunControlled { step: 1e-3, tolerance: 1e-3, halvings: 10 },
            1.0 + (w * 1e-3).powi(4) / 4.0,
        ),
        (Integrator::Rk4 { step: 1e-3 }, 1.0 - (w * 1e-3).powi(6) / 72.0),
        (Integrator::Ros2 { step: 1e-3 }, 1.0 + (w * 1e-3).powi(4) / 4.0),
    ] {
        let mut x = [1e-3, 0.0];
        let mut stepper = Stepper::new(&integrator, 2, &[]);
        let h = integrator.step();
        let steps = (10.0 / h).round() as u32;
        for i in 0..steps {
            let _ = stepper.step(&mut Mode(w), f64::from(i) * h, &mut x, h);
        }
        let ours = (x[0] * x[0] + x[1] * x[1] / (w * w)) / 1e-6 - 1.0;
        let theirs = theirs.powf(f64::from(steps)) - 1.0;
        println!("{integrator:?}: energy {:+.4} %, theory {:+.4} %", 100.0 * ours, 100.0 * theirs);
        assert!((ours - theirs).abs() < 0.02 * theirs.abs() + 1e-9);
    }
}
