//! Traction, brakes and the train of the reference locomotive against hand formulas and the paper's curves.
//!
//! The paper: Spiryagin et al., Proc. IMechE Part F 227 (2013) 453. Its Table 4 gives the friction.

mod common;

use common::{case, coco134, column};
use railsim::run::{Free, Outcome, simulate};
use serde_json::{Value, json};

type Columns = Vec<(String, Vec<f64>)>;

/// The locomotive on Table 4's dry rail (or wet, from `wet` m on), Polach's formula, at `kmh`.
fn locomotive(kmh: f64, drive: Value) -> Value {
    let mut case = coco134();
    case["run"]["speed"] = json!(kmh / 3.6);
    case["run"]["creep"] = json!({ "kind": "polach", "k_a": 0.6, "k_s": 0.15 });
    case["run"]["friction"] = json!({ "value": 0.47, "falling": { "ratio": 0.44, "decay": 0.7 } });
    case["run"]["output_step"] = json!(0.01);
    case["run"]["drive"] = drive;
    case["track"]["length"] = json!(5000.0);
    case
}

fn wet(case: &mut Value) {
    case["run"]["creep"] = json!({ "kind": "polach", "k_a": 0.29, "k_s": 0.09 });
    case["run"]["friction"] = json!({ "value": 0.30, "falling": { "ratio": 0.38, "decay": 0.1 } });
}

fn run(value: &Value) -> Outcome {
    simulate(&case(value), &Free).unwrap_or_else(|e| panic!("{e}"))
}

fn columns(value: &Value) -> Columns {
    run(value).columns
}

fn last(columns: &Columns, name: &str) -> f64 {
    *column(columns, name).last().unwrap()
}

fn show(what: &str, ours: f64, theirs: f64) {
    println!("{what:<60} {ours:>12.5} {theirs:>12.5} {:>10.5}", ours - theirs);
}

/// VALIDATION: 300 kN, per-bogie torque, pivot 0.80 m, coupler 0.90 m above rail.
#[test]
fn axle_loads_shift_as_the_hand_formula_says() {
    let mut value = locomotive(
        22.0,
        json!({ "notch": 8, "effort_limit": 300e3, "hold_speed": true, "resistance": false, "until": { "time": 6.0 } }),
    );
    value["run"]["integrator"] = json!({ "kind": "ros2", "step": 0.001 });
    let start = std::time::Instant::now();
    let c = columns(&value);
    println!("{:?}", start.elapsed());
    show("effort, kN", last(&c, "traction.effort") / 1e3, 300.0);
    for w in 1..=6 {
        let q = |i: usize| {
            let get = |side: &str| column(&c, &format!("ws{w}.{side}.Q"))[i];
            get("left") + get("right")
        };
        let n = column(&c, "t").len();
        println!(
            "ws{w} dQ {:.3} kN  fx {:.3} slip {:.5}",
            (q(n - 1) - q(0)) / 1e3,
            (last(&c, &format!("ws{w}.left.Fx")) + last(&c, &format!("ws{w}.right.Fx"))) / 1e3,
            last(&c, &format!("ws{w}.slip"))
        );
    }
    println!("v {} hold {}", last(&c, "v"), last(&c, "speed_hold"));
}
