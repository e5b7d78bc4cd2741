//! Every vehicle that ships, and parts of one: it compiles, stands at its design height, its wheel loads are its weight.

#![allow(clippy::print_stdout)] // both numbers are shown, from helpers too

mod common;

use railsim::contact::textbook::Textbook;
use railsim::dynamics::linearise::jacobian;
use railsim::dynamics::{Contact, Model, SpeedProgram, VehicleSystem, compile, equilibrium};
use railsim::integrator::{Integrator, Stepper, System};
use railsim::schema::toml_to_json;
use serde_json::{Value, json};

const VEHICLES: [&str; 5] = ["bobo86", "coco134", "manchester1", "suspended_wheelset", "wagon2"];

fn case_of(vehicle: Value, condition: &str) -> Value {
    let mut value = common::coco134();
    value["run"]["wheel_profile"] = vehicle["wheel_profile"].clone();
    value["profiles"]["s1002"] = common::profile("s1002", "wheel");
    value["vehicle"] = vehicle;
    value["condition"] = json!(condition);
    value
}

fn shipped(name: &str) -> Value {
    let vehicle = common::read_toml(&format!("vehicles/{name}.toml"));
    let condition = vehicle["design_condition"].as_str().unwrap().to_owned();
    case_of(vehicle, &condition)
}

/// State in equilibrium, standing, and wheel loads left and right of each wheelset, N.
fn standing(model: &Model) -> (Vec<f64>, Vec<[f64; 2]>) {
    let x = equilibrium::solve(model, 10.0, 0.0).unwrap();
    let program = SpeedProgram { s: equilibrium::reference_s(model, 10.0), speed: 0.0, acceleration: 0.0 };
    let mut system = VehicleSystem::new(model, program);
    system.creeping = false;
    let mut dx = vec![0.0; system.size()];
    system.rhs(0.0, &x, &mut dx);
    let loads = system.scratch.wheels.iter().map(|w| [w[0].Q, w[1].Q]).collect();
    (x, loads)
}

fn weight(model: &Model) -> f64 {
    model.mass() * model.gravity
}

fn check_standing(name: &str, model: &Model) {
    let (x, loads) = standing(model);
    let map = model.map();
    let kilonewton: Vec<[f64; 2]> = loads.iter().map(|p| p.map(|q| (q / 10.0).round() / 100.0)).collect();
    println!("{name}: wheel loads, kN, left and right: {kilonewton:?}");
    let sum: f64 = loads.iter().flatten().sum();
    // Equilibrium is solved to 1e-7 m/s2.
    assert!((sum / weight(model) - 1.0).abs() < 1e-6, "{name}: {sum} {}", weight(model));
    let mean = sum / (2 * loads.len()) as f64;
    for pair in &loads {
        assert!((pair[0] - pair[1]).abs() < 1e-6 * mean, "{name}: left and right differ: {pair:?}");
    }
    // Design height: all bodies are as much lower as their wheelsets, which sink into track and contact.
    let sinks: Vec<f64> = (0..model.count())
        .filter(|i| !model.guided.contains(i))
        .map(|i| x[map.q(i).start + 2] - model.rigid(i).position.z)
        .collect();
    let deepest = sinks.iter().fold(0.0_f64, |m, s| m.max(*s));
    println!(
        "{name}: lowered by {:?} mm into track and contact",
        sinks.iter().map(|s| (s * 1e6).round() / 1e3).collect::<Vec<_>>()
    );
    // A general wheel load differs from the mean by pitch of a bogie at most.
    assert!(sinks.iter().all(|s| (s - deepest).abs() < 1e-4), "{name}: {sinks:?}");
    // What connections remember is nothing in equilibrium.
    assert!(x[map.memory()].iter().all(|z| *z == 0.0));
}

#[test]
fn every_vehicle_stands_at_its_design_height_on_its_weight() {
    let mut found: Vec<String> = std::fs::read_dir(common::models().join("vehicles"))
        .unwrap()
        .map(|f| f.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned())
        // What includes another file is put together in Python, and stands in tests/validation.
        .filter(|name| common::read_toml(&format!("vehicles/{name}.toml")).get("include").is_none())
        .collect();
    found.sort();
    assert_eq!(found, VEHICLES, "a vehicle that is not tested here");
    for name in VEHICLES {
        let model = compile::model(&common::case(&shipped(name))).unwrap_or_else(|e| panic!("{name}: {e}"));
        check_standing(name, &model);
    }
}

/// Iwnicki 1998: wheel load 54.55 kN with g = 9.81 m/s2.
#[test]
fn manchester_wheel_load() {
    let mut value = shipped("manchester1");
    value["run"]["gravity"] = json!(9.81);
    let model = compile::model(&common::case(&value)).unwrap();
    let (_, loads) = standing(&model);
    for q in loads.iter().flatten() {
        println!("wheel load {:.3} kN, benchmark 54.55 kN", q / 1e3);
        assert!((q / 54.55e3 - 1.0).abs() < 5e-4);
    }
    // Static loads of the springs, worked out by hand from the masses: 45.653 kN and 78.480 kN.
    let force = |name: &str| {
        let link = model.links.iter().find(|l| l.name == name).unwrap();
        link.mount.preload.z.abs()
    };
    println!(
        "primary {:.1} N (45653), secondary {:.1} N (78480)",
        force("primary_ws1_left"),
        force("secondary_bogie2_right")
    );
    assert!((force("primary_ws1_left") / 45653.0 - 1.0).abs() < 1e-4);
    assert!((force("secondary_bogie2_right") / 78480.0 - 1.0).abs() < 1e-4);
}

/// Parts of a vehicle: a bogie alone (its springs to the car body left out with it).
#[test]
fn a_bogie_alone_stands() {
    let text = std::fs::read_to_string(common::models().join("vehicles/manchester1.toml")).unwrap();
    let mut vehicle = toml_to_json(&text).unwrap();
    vehicle["body"] = json!([]);
    let uses = vehicle["use"].as_array().unwrap()[..1].to_vec();
    vehicle["use"] = json!(uses);
    let bogie = &mut vehicle["template"]["bogie"];
    bogie["connection"] = json!([]);
    bogie["sensor"] = json!([]);
    vehicle["use"][0]["with"].as_object_mut().unwrap().remove("end");
    vehicle.as_object_mut().unwrap().remove("speed_hold");
    let model = compile::model(&common::case(&case_of(vehicle, "benchmark"))).unwrap();
    check_standing("bogie of manchester1", &model);
}

/// A wheelset alone, with nothing above it.
#[test]
fn a_wheelset_alone_stands() {
    let mut vehicle = common::read_toml("vehicles/suspended_wheelset.toml");
    vehicle["body"] = json!([]);
    vehicle["connection"] = json!([]);
    let model = compile::model(&common::case(&case_of(vehicle, "textbook"))).unwrap();
    check_standing("wheelset alone", &model);
}

/// Springs of every kind that carries, under one body between two wheelsets, asymmetric: it stands where it was drawn.
#[test]
fn every_kind_that_carries_is_solved_to_the_design_height() {
    let text = include_str!("fixtures/trolley.toml");
    let at = |name: &str, rest: Value| {
        let mut c = json!({ "name": format!("{name}_{{axle}}"), "mirror": true, "carries_weight": true, "between": ["{axle}", "frame"] });
        c.as_object_mut().unwrap().extend(rest.as_object().unwrap().clone());
        c
    };
    let up = json!([[0.0, 0.9, "-$axle.radius"], [0.1, 0.8, -1.1]]);
    let above = json!([[0.0, 0.9, "-$axle.radius"], [0.0, 0.9, -0.9]]);
    let here = json!([0.0, 0.9, "-$axle.radius"]);
    let table = json!({ "x": [-0.2, -0.1, 0.0, 0.1], "f": [-9e3, -2e3, 0.0, 1e4], "interpolation": "pchip" });
    let mut rows = [[0.0; 6]; 6];
    for (i, k) in [1e5, 1e5, 2e5, 1e3, 1e3, 1e3].into_iter().enumerate() {
        rows[i][i] = k;
    }
    for connection in [
        at("s", json!({ "kind": "point_spring", "stiffness": 1e5, "positions": up })),
        at("s", json!({ "kind": "point_spring", "table": table, "positions": above })),
        at("s", json!({ "kind": "point_spring", "stiffness": 1e5, "along": "z", "position": here })),
        at("s", json!({ "kind": "traction_rod", "stiffness": 1e6, "positions": up })),
        at(
            "s",
            json!({ "kind": "shear_spring", "axial": 2e5, "shear": 1e5, "bending": 1e3, "positions": above }),
        ),
        at("s", json!({ "kind": "bushing_matrix", "stiffness": rows, "position": here })),
        at(
            "s",
            json!({ "kind": "friction_plate", "coefficient": 0.3, "stiffness": 1e6, "normal_stiffness": 3e5, "position": here }),
        ),
        at(
            "s",
            json!({ "kind": "bushing", "stiffness": [1e5, 1e5, 3e5], "axes": [0.3, 0.2, 0.1], "position": here }),
        ),
    ] {
        let mut vehicle = toml_to_json(text).unwrap();
        let list = vehicle["template"]["axle"]["connection"].as_array_mut().unwrap();
        list.push(connection.clone());
        // A spring that pushes by itself, and is carried like a load.
        let mut pushing = at(
            "p",
            json!({ "kind": "point_spring", "stiffness": 2e4, "free_length": 0.9, "positions": above }),
        );
        pushing["carries_weight"] = json!(false);
        list.push(pushing);
        let mut given = at(
            "g",
            json!({ "kind": "bushing", "stiffness": [1e4, 1e4, 0.0], "preload": [0.0, 500.0, -300.0], "position": here }),
        );
        given["carries_weight"] = json!(false);
        list.push(given);
        vehicle["wheel_profile"] = json!("anzr1");
        let model = compile::model(&common::case(&case_of(vehicle, "laden")))
            .unwrap_or_else(|e| panic!("{connection}: {e}"));
        let (x, loads) = standing(&model);
        let map = model.map();
        let sum: f64 = loads.iter().flatten().sum();
        assert!((sum / weight(&model) - 1.0).abs() < 1e-6, "{connection}: {sum}");
        let sink = |i: usize| x[map.q(i).start + 2] - model.rigid(i).position.z;
        // The wheelsets sink some tenths of a millimetre into the track; against them the frame stands where it was drawn.
        println!(
            "{}: frame against wheelsets {:.2e} m, pitch {:.1e} rad",
            connection["kind"],
            sink(0) - sink(1),
            x[map.q(0).start + 4]
        );
        assert!((sink(0) - 0.5 * (sink(1) + sink(2))).abs() < 1e-5, "{connection}: {} {}", sink(0), sink(1));
        assert!(x[map.q(0).start + 1].abs() < 1e-9 && x[map.q(0).start + 3].abs() < 1e-9);
    }
}

/// Exact critical speed of the suspended wheelset: Routh and Hurwitz on its two coupled equations of motion.
#[allow(clippy::too_many_arguments)]
fn critical_speed(m: f64, i: f64, ky: f64, kpsi: f64, f11: f64, f22: f64, l0: f64, slope: f64) -> f64 {
    let (c1, c2) = (2.0 * f22, 2.0 * f11 * l0 * l0);
    let (a3, a1) = (m * c2 + i * c1, c1 * kpsi + c2 * ky);
    let a0 = ky * kpsi + 4.0 * f11 * f22 * slope * l0;
    (a1 * a3 * c1 * c2 / (a3 * a3 * a0 + m * i * a1 * a1 - a1 * a3 * (m * kpsi + i * ky))).sqrt()
}

/// The suspended wheelset with textbook contact against its closed form (0.1 % asked for).
#[test]
fn suspended_wheelset_critical_speed() {
    for (ky, kpsi) in [(5e5, 5e5), (1.0, 2e6), (5e5, 1.0)] {
        let mut value = shipped("suspended_wheelset");
        value["vehicle"]["parameters"]["suspension"]["ky"] = json!(0.5 * ky);
        value["vehicle"]["parameters"]["suspension"]["kx"] = json!(0.5 * kpsi);
        let mut model = compile::model(&common::case(&value)).unwrap();
        model.support = None;
        let (f11, f22, conicity) = (1e7, 9e6, 0.1);
        model.contact = Contact::Textbook(Textbook {
            conicity,
            f11,
            f22,
            f23: 0.0,
            stiffness: 1e9,
            damping: 0.0,
            gravity_stiffness: false,
        });
        let map = model.map();
        let (q, u) = (map.q(1).start, map.u(1).start);
        let states = [q + 1, q + 5, u + 1, u + 5]; // lateral and yaw: vertical, roll and pitch are held
        let growth = |speed: f64| {
            let x = equilibrium::solve(&model, 0.0, speed).unwrap();
            let mut system = VehicleSystem::new(&model, SpeedProgram { s: 0.0, speed, acceleration: 0.0 });
            let j = jacobian(&mut system, 0.0, &x);
            let small = nalgebra::Matrix4::from_fn(|a, b| j[(states[a], states[b])]);
            small.complex_eigenvalues().iter().fold(f64::MIN, |m, e| m.max(e.re))
        };
        let (mut low, mut high) = (5.0, 100.0);
        assert!(growth(low) < 0.0 && growth(high) > 0.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if growth(middle) < 0.0 { low = middle } else { high = middle }
        }
        let exact = critical_speed(1813.0, 1120.0, ky, kpsi, f11, f22, 0.75, conicity / 0.46);
        println!(
            "ky {ky:.0}, kpsi {kpsi:.0}: critical speed {low:.4} m/s, closed form {exact:.4} ({:+.4} %)",
            100.0 * (low / exact - 1.0)
        );
        assert!((low / exact - 1.0).abs() < 1e-3);
    }
}

/// Vector of `suspended_wheelset_critical_speed.csv`, worked out independently: 35.276321 m/s.
#[test]
fn the_closed_form_as_worked_out_elsewhere() {
    let ours = critical_speed(1813.0, 1120.0, 5e5, 5e5, 1e7, 9e6, 0.75, 0.1 / 0.46);
    assert!((ours - 35.276321).abs() < 1e-6, "{ours}");
}

/// Friction alone damps the wagon: lifted and let go, it slides, then sticks, and from then on no slider gives way for 60 s
/// while it trembles on its stick stiffness.
#[test]
fn the_wagon_does_not_drift_on_its_friction() {
    let model = compile::model(&common::case(&shipped("wagon2"))).unwrap();
    let (mut x, _) = standing(&model);
    let map = model.map();
    let (body, wheelset) = (map.q(0).start + 2, map.q(1).start + 2);
    let leaf = model.links.iter().find(|l| l.name == "leaf_friction_ws1_left").unwrap().memory.start;
    let program = SpeedProgram { s: equilibrium::reference_s(&model, 10.0), speed: 0.0, acceleration: 0.0 };
    let mut system = VehicleSystem::new(&model, program);
    system.creeping = false; // wheels stick
    system.irregular = false;
    x[body] -= 0.03;
    let mut stepper = Stepper::new(&Integrator::Heun { step: 4e-4 }, x.len(), &[]);
    // How far the slider has slipped: elongation of the element less that of its spring.
    let mut slipped = Vec::new();
    for i in 0..162_500_u32 {
        let _ = stepper.step(&mut system, f64::from(i) * 4e-4, &mut x, 4e-4);
        if i % 12_500 == 0 {
            slipped.push(x[body] - x[wheelset] - x[leaf]);
        }
    }
    let first = slipped[1]; // after 5 s
    println!(
        "slider has slipped, mm, every 5 s: {:?}",
        slipped.iter().map(|s| 1e3 * (s - slipped[0])).collect::<Vec<_>>()
    );
    assert!((first - slipped[0]).abs() > 5e-3, "it should have slid first");
    assert!(slipped[1..].iter().all(|s| (s - first).abs() < 1e-8), "drifts: {slipped:?}");
}
