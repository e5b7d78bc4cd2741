//! Cost of the right-hand side and of a step, of the whole locomotive and of the vehicle alone.
//!
//! `cargo bench -p railsim --bench vehicle`

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use railsim::contact::textbook::Textbook;
use railsim::dynamics::{Contact, Model, SpeedProgram, VehicleSystem, compile, equilibrium};
use railsim::integrator::{Integrator, Stepper, System};
use serde_json::json;

fn locomotive() -> Model {
    let mut value = common::coco134();
    value["run"]["wheel_profile"] = json!("anzr1_worn_1");
    value["track"]["length"] = json!(3000.0);
    // Without it the equilibrium of ideal track meets the rough one at once, and the locomotive leaves the rails.
    value["track"]["fade_in"] = json!(50.0);
    value["track"]["irregularity"] = json!({
        "kind": "psd", "form": "fra_hamid_yang", "class": 6, "wavelengths": [1.5, 40.0], "seed": 1, "period": 1000.0
    });
    compile::model(&common::case(&value)).unwrap()
}

/// 9 bodies, 30 suspension elements, a linear contact spring and creep under each of 12 wheels, no track masses.
fn vehicle_alone() -> Model {
    let mut model = compile::model(&common::case(&common::coco134())).unwrap();
    model.support = None;
    model.contact = Contact::Textbook(Textbook {
        gravity_stiffness: false,
        conicity: 0.05,
        f11: 1.5e7,
        f22: 1.5e7,
        f23: 0.0,
        stiffness: 1e8,
        damping: 1e5,
    });
    model
}

/// A state on rough track, some way down it, so that wheels creep and contacts wander. Panics where a wheel has left
/// its rail: such a state costs a quarter of a real one.
fn rolled(model: &Model, speed: f64) -> (Vec<f64>, SpeedProgram) {
    let start = 20.0;
    let mut x = equilibrium::solve(model, start, speed).unwrap();
    let program = SpeedProgram { s: equilibrium::reference_s(model, start), speed, acceleration: 0.0 };
    let mut system = VehicleSystem::new(model, program);
    let mut stepper = Stepper::new(&Integrator::Ros2 { step: 1e-3 }, x.len(), system.stiff_blocks());
    for i in 0..2000_u32 {
        let _ = stepper.step(&mut system, f64::from(i) * 1e-3, &mut x, 1e-3);
        assert!(system.scratch.left_rail.is_none(), "off the rails after {i} ms");
    }
    assert!(
        system.scratch.wheels.iter().flatten().all(|wheel| !wheel.contacts().is_empty()),
        "a wheel in the air"
    );
    (x, SpeedProgram { s: program.s + 2.0 * speed, ..program })
}

fn bench(c: &mut Criterion) {
    let speed = 126.5 / 3.6;
    let model = locomotive();
    let (x, program) = rolled(&model, speed);
    let mut dx = vec![0.0; x.len()];
    let mut system = VehicleSystem::new(&model, program);
    c.bench_function("right-hand side, locomotive on FRA 6", |b| {
        b.iter(|| system.rhs(0.0, black_box(&x), &mut dx));
    });
    // The hunting spec's scheme first: a thousand of its steps are a simulated second.
    let schemes =
        [Integrator::Rk4 { step: 1e-3 }, Integrator::Ros2 { step: 1e-3 }, Integrator::Heun { step: 2.5e-4 }];
    for integrator in schemes {
        let mut stepper = Stepper::new(&integrator, x.len(), system.stiff_blocks());
        let h = integrator.step();
        c.bench_function(&format!("step, locomotive on FRA 6, {}", integrator.name()), |b| {
            let mut y = x.clone();
            let mut n = 0_u32;
            b.iter(|| {
                let _ = stepper.step(&mut system, f64::from(n) * h, &mut y, h);
                n += 1;
                if n == 1000 {
                    y.copy_from_slice(&x);
                    n = 0;
                }
            });
        });
    }
    let alone = vehicle_alone();
    let (x, program) = rolled(&alone, speed);
    let mut system = VehicleSystem::new(&alone, program);
    let integrator = Integrator::Heun { step: 1e-4 };
    let mut stepper = Stepper::new(&integrator, x.len(), &[]);
    let mut group = c.benchmark_group("vehicle alone");
    group.throughput(Throughput::Elements(1));
    group.bench_function("two-stage Runge-Kutta step", |b| {
        let mut y = x.clone();
        let mut n = 0_u32;
        b.iter(|| {
            let _ = stepper.step(&mut system, f64::from(n) * 1e-4, &mut y, 1e-4);
            n += 1;
            if n == 1000 {
                y.copy_from_slice(&x);
                n = 0;
            }
        });
    });
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
