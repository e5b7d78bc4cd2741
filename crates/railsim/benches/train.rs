//! How much faster than real time the locomotive hauls a hundred wagons, each a mass with draft gear and brake.
//!
//! `cargo bench -p railsim --bench train`

#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Instant;

use railsim::run::{Free, simulate};
use serde_json::json;

const TIME: f64 = 20.0;

fn main() {
    for wagons in [1, 100] {
        let mut value = common::coco134();
        value["track"]["length"] = json!(1000.0);
        value["track"]["layout"] = json!([{ "kind": "tangent", "length": 1000.0, "gradient": 0.005 }]);
        value["run"]["speed"] = json!(22.0 / 3.6);
        value["run"]["output_step"] = json!(0.02);
        value["run"]["drive"] = json!({ "notch": 8, "until": { "time": TIME } });
        value["run"]["train"] = json!({
            "wagons": wagons, "mass": 4000e3 / f64::from(wagons), "length": 15.0, "brake_force": 50e3,
            "coupler": { "slack": 0.02 }
        });
        let case = common::case(&value);
        let begun = Instant::now();
        let outcome = simulate(&case, &Free).unwrap_or_else(|e| panic!("{e}"));
        let wall = begun.elapsed().as_secs_f64();
        let done = common::column(&outcome.columns, "t").last().copied().unwrap_or_default();
        println!(
            "locomotive and {wagons} wagons: {done:.1} s in {wall:.2} s, {:.1} times real time",
            done / wall
        );
    }
}
