//! The vehicle standing and rolling in equilibrium: solved, not settled.

mod common;

use railsim::dynamics::{SpeedProgram, VehicleSystem, compile, equilibrium};
use railsim::integrator::System;
use railsim::run::{Ended, Free, simulate};
use serde_json::json;

/// Wheel loads of coco134: 134 t x 9.80665 / 12 = 109.508 kN (the paper prints 109.515).
#[test]
fn wheel_loads_sum_to_the_weight_and_are_equal_within_the_vehicle() {
    let case = common::case(&common::coco134());
    let model = compile::model(&case).unwrap();
    let x = equilibrium::solve(&model, 10.0, 0.0).unwrap();
    let program = SpeedProgram { s: equilibrium::reference_s(&model, 10.0), speed: 0.0, acceleration: 0.0 };
    let mut system = VehicleSystem::new(&model, program);
    system.creeping = false;
    let mut dx = vec![0.0; system.size()];
    system.rhs(0.0, &x, &mut dx);
    let loads: Vec<f64> = system.scratch.wheels.iter().flatten().map(|w| w.Q).collect();
    let sum: f64 = loads.iter().sum();
    println!("wheel loads, kN: {:?}", loads.iter().map(|q| (q / 10.0).round() / 100.0).collect::<Vec<_>>());
    // Equilibrium is solved to 1e-7 m/s2: 0.013 N on 134 t.
    assert!((sum - 134_000.0 * 9.80665).abs() < 0.1, "{sum}");
    for pair in system.scratch.wheels.iter() {
        assert!((pair[0].Q - pair[1].Q).abs() < 1e-3, "left and right differ: {pair:?}");
    }
    let mean = sum / 12.0;
    assert!((mean / 109.515e3 - 1.0).abs() < 1e-3);
}

#[test]
fn the_design_position_is_the_equilibrium_in_the_design_condition() {
    let case = common::case(&common::coco134());
    let model = compile::model(&case).unwrap();
    let x = equilibrium::solve(&model, 10.0, 0.0).unwrap();
    let map = model.map();
    let sink = x[map.q(3).start + 2] - model.rigid(3).position.z;
    for i in 0..3 {
        let lowered = x[map.q(i).start + 2] - model.rigid(i).position.z;
        // All bodies sink together with the wheelsets into track and contact (wheel loads differ by bogie pitch at most).
        assert!((lowered - sink).abs() < 5e-5, "{}: {lowered} {sink}", model.rigid(i).name);
    }
}

#[test]
fn in_tare_the_body_rises_by_what_its_springs_unload() {
    let mut value = common::coco134();
    value["condition"] = json!("tare");
    let model = compile::model(&common::case(&value)).unwrap();
    let x = equilibrium::solve(&model, 10.0, 0.0).unwrap();
    let full = compile::model(&common::case(&common::coco134())).unwrap();
    let y = equilibrium::solve(&full, 10.0, 0.0).unwrap();
    let map = model.map();
    let rise = y[map.q(0).start + 2] - x[map.q(0).start + 2];
    // Closed form: 8 t on 8 secondary springs, 12 axle boxes, 6 track masses (and a Hertz contact, some 0.004 mm).
    let w = 8000.0 * 9.80665;
    let expected = w / (8.0 * 5.8e5) + w / (12.0 * 4.0e6) + w / (6.0 * 1.5e8);
    println!("rise in tare: {:.3} mm, closed form {:.3} mm", 1e3 * rise, 1e3 * expected);
    assert!((rise - expected).abs() < 2e-5);
}

#[test]
fn a_rolling_start_stays_in_equilibrium_on_ideal_track() {
    let case = common::case(&common::coco134());
    let outcome = simulate(&case, &Free).unwrap();
    assert_eq!(outcome.ended, Ended::EndOfTrack);
    let q = common::column(&outcome.columns, "ws1.left.Q");
    let spread = q.iter().fold(0.0_f64, |m, v| m.max((v - q[0]).abs()));
    println!("largest change of wheel load over 180 m: {spread:.3e} N");
    assert!(spread < 1.0, "{spread}");
    let y = common::column(&outcome.columns, "ws1.y");
    assert!(y.iter().all(|v| v.abs() < 1e-9));
}
