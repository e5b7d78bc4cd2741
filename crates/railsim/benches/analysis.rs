//! Cost of a balance, of the modes with their shapes, and of a second of the ramp-down, of the whole locomotive.
//!
//! `cargo bench -p railsim --bench analysis`

#[path = "../tests/common/mod.rs"]
mod common;

use criterion::{Criterion, criterion_group, criterion_main};
use railsim::analysis::{Stand, modes, run};
use railsim::run::Free;
use serde_json::json;

fn bench(c: &mut Criterion) {
    let mut value = common::coco134();
    value["run"] = json!({ "kind": "modal", "speed": 0.0, "friction": 0.4 });
    let case = common::case(&value);
    let mut stand = Stand::new(&case).unwrap();
    for speed in [0.0, 35.0] {
        c.bench_function(&format!("balance, locomotive at {speed} m/s"), |b| {
            b.iter(|| stand.settle(speed).unwrap())
        });
        let x = stand.settle(speed).unwrap();
        c.bench_function(&format!("modes with shapes, locomotive at {speed} m/s"), |b| {
            b.iter(|| modes(&stand.model, &mut stand.system(speed), &x, &[]).unwrap());
        });
    }
    value["run"] = json!({
        "kind": "critical_speed", "speed": 400.0 / 3.6, "friction": 0.4,
        "integrator": { "kind": "ros2", "step": 0.001 }, "output_step": 0.01, "disturbance": { "carbody.y": 0.02 },
        "search": {
            "method": "ramp_down", "end_speed": 80.0 / 3.6, "deceleration": 5.0 / 3.6
        }
    });
    let case = common::case(&value);
    let mut group = c.benchmark_group("critical speed");
    group.sample_size(10);
    group.bench_function("ramp-down, 400 to 80 km/h at 5 km/h/s", |b| b.iter(|| run(&case, &Free).unwrap()));
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
