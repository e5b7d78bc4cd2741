//! Balance in curves, on cant and along paths of loads against closed forms: unbalanced force, load transfer, Redtenbacher's offset,
//! rigid bogies, rollover, springs.

mod common;

use railsim::analysis::{Stand, run};
use railsim::dynamics::equilibrium::{self, Conditions};
use railsim::integrator::System;
use railsim::math::Vec3;
use railsim::run::{Ended, Free, Outcome};
use serde_json::{Value, json};

#[allow(clippy::print_stdout)] // ours beside theirs
fn compare(what: &str, ours: f64, theirs: f64, tolerance: f64) {
    let off = ours / theirs - 1.0;
    println!("{what}: ours {ours:.6}, theirs {theirs:.6} ({:+.3} %)", 100.0 * off);
    assert!(off.abs() < tolerance, "{what}: {ours} against {theirs}");
}

fn curve(radius: f64, cant_mm: f64) -> Value {
    json!([{ "kind": "curve", "length": 200.0, "radius": radius, "cant_mm": cant_mm }])
}

fn row(outcome: &Outcome, name: &str, i: usize) -> f64 {
    common::column(&outcome.columns, name)[i]
}

/// 115 km/h, R 1000 m, no cant: a = 1.0205 m/s2, cant deficiency 2 l0 V2/(g R) = 156.0 mm over 1.5 m.
#[test]
fn the_locomotive_in_a_curve_carries_its_unbalanced_force() {
    let speed = 115.0 / 3.6;
    for (cant, sign) in [(0.0, 1.0), (100.0, 1.0), (100.0, -1.0)] {
        let mut value = common::coco134();
        value["track"]["layout"] = curve(sign * 1000.0, sign * cant);
        value["run"] = json!({ "kind": "equilibrium", "speed": speed, "friction": 0.4 });
        let start = std::time::Instant::now();
        let outcome = run(&common::case(&value), &Free).unwrap();
        println!("cant {cant} mm, {sign}: {:?} with compilation", start.elapsed());
        assert_eq!(outcome.ended, Ended::Complete);
        let at = |name: &str| row(&outcome, name, 0);
        let unbalanced = at("unbalanced");
        if cant == 0.0 {
            compare("unbalanced acceleration, m/s2", unbalanced, 1.0205, 1e-4);
            compare("cant deficiency, mm", 1e3 * 1.5 * unbalanced / 9.80665, 156.0, 1e-3);
        }
        let sum: f64 = (1..=6).map(|w| at(&format!("ws{w}.sum_Y"))).sum();
        // To the left in a right-hand curve. The centre of mass is off the centre line by centimetres of a kilometre.
        compare("sum of track-shifting forces, N", sum, -134_000.0 * unbalanced, 2e-3);
        let outer = if sign > 0.0 { ("left", "right") } else { ("right", "left") };
        let side = |s: &str| (1..=6).map(|w| at(&format!("ws{w}.{s}.Q"))).sum::<f64>();
        // Centre of mass and its lean outward, over all bodies.
        let bodies = [("carbody", 87_180.0), ("bogie1", 14_860.0), ("bogie2", 14_860.0)];
        let axles = ["ws1", "ws2", "ws3", "ws4", "ws5", "ws6"].map(|w| (w, 2850.0));
        let all = || bodies.iter().chain(&axles);
        // Axles stand inside the tangent below the car body, by the versine of their distance; so do the bogies.
        let versine = |x: f64| sign * x * x / 2000.0;
        let (pivots, wheels) = (versine(6.6), [4.7, 6.6, 8.5].map(versine).iter().sum::<f64>() / 3.0);
        let inside = all().map(|(b, m)| m * at(&format!("{b}.y"))).sum::<f64>()
            + 2.0 * 14_860.0 * pivots
            + 6.0 * 2850.0 * wheels;
        let lean = -sign * (inside / 134_000.0 - wheels);
        let high = -all().map(|(b, m)| m * at(&format!("{b}.z"))).sum::<f64>() / 134_000.0;
        let (g, a) = (9.80665, sign * unbalanced);
        let transfer = (side(outer.0) - side(outer.1)) / (side(outer.0) + side(outer.1));
        println!("  h {high:.3} m, lean {:.1} mm, rigid {:.4}", 1e3 * lean, a * high / (g * 0.75));
        // Axles with the reflected rotors that turn with the curve: Iyy spin V/R each, 6 % of the whole.
        let gyroscopic = 6.0 * 1200.0 * (speed / 0.5335) * (speed / 1000.0) / (134_000.0 * g);
        // The arms are some per cent off 0.75 m: contacts at the flange on one side.
        compare("  load transfer with lean", transfer, (a * high / g + lean + gyroscopic) / 0.75, 0.04);
        for w in 1..=6 {
            println!(
                "  ws{w}: angle of attack {:+.2} mrad, Q {:.1} {:.1} kN, Y {:.1} {:.1} kN, y {:+.2} mm",
                1e3 * at(&format!("ws{w}.psi")),
                1e-3 * at(&format!("ws{w}.left.Q")),
                1e-3 * at(&format!("ws{w}.right.Q")),
                1e-3 * at(&format!("ws{w}.left.Y")),
                1e-3 * at(&format!("ws{w}.right.Y")),
                1e3 * at(&format!("ws{w}.y")),
            );
        }
    }
}

/// The outcome of a curve mirrored is the mirrored outcome; in sharp curves too there is a balance.
#[test]
fn sharp_curves_have_a_balance() {
    for radius in [600.0, 300.0, 200.0, 120.0] {
        let mut value = common::coco134();
        value["track"]["layout"] = curve(radius, 0.0);
        value["run"] = json!({ "kind": "equilibrium", "speed": 8.0, "friction": 0.4 });
        let start = std::time::Instant::now();
        let outcome = run(&common::case(&value), &Free).unwrap();
        println!(
            "R {radius} m: {:?}; ws1 angle of attack {:+.2} mrad, outer L/V {:.3}, inner {:.3}",
            start.elapsed(),
            1e3 * row(&outcome, "ws1.psi", 0),
            row(&outcome, "ws1.left.LV", 0),
            row(&outcome, "ws1.right.LV", 0)
        );
        assert_eq!(outcome.ended, Ended::Complete);
    }
}

/// Wheelsets in a frame of springs, textbook contact.
fn textbook(axles: &[f64], stiffness: f64, conicity: f64, radius: f64, f: [f64; 2]) -> Value {
    let mut value = common::coco134();
    let r0 = 0.46;
    let sets: Vec<Value> = axles
        .iter()
        .enumerate()
        .map(|(i, x)| {
            json!({
                "name": format!("ws{}", i + 1), "mass": 1500.0, "inertia": [900.0, 100.0, 900.0], "radius": r0,
                "tape_half_distance": 0.75, "position": [x, 0.0]
            })
        })
        .collect();
    let (mut bodies, mut links) = (vec![], vec![]);
    if axles.len() > 1 {
        bodies.push(json!({ "name": "frame", "mass": 3000.0, "inertia": [2e3, 3e3, 4e3], "position": [0.0, 0.0, -r0] }));
        for (i, x) in axles.iter().enumerate() {
            links.push(json!({
                "name": format!("primary{}", i + 1), "kind": "bushing", "between": [format!("ws{}", i + 1), "frame"],
                "mirror": true, "carries_weight": true, "position": [x, 1.0, -r0],
                "stiffness": [stiffness, stiffness, 1e7]
            }));
        }
    }
    value["vehicle"] = json!({
        "name": "bogie", "title": "Wheelsets and a frame", "design_speed_kmh": 100.0,
        "wheel_profile": "anzr1", "track": "plain_1435_as60", "design_condition": "only",
        "condition": { "only": {} }, "body": bodies, "wheelset": sets, "connection": links,
        "contact": { "youngs_modulus": 2.1e11, "poisson": 0.28, "damping": 0.0 }
    });
    value["condition"] = json!("only");
    value["track"]["support"] = json!("rigid");
    value["track"]["layout"] = curve(radius, 0.0);
    // Slow: next to no centrifugal force.
    value["run"] = json!({
        "kind": "equilibrium", "speed": 0.1, "friction": 0.4,
        "contact": { "kind": "textbook", "conicity": conicity, "f11": f[0], "f22": f[1], "stiffness": 1e8 }
    });
    value
}

/// A free wheelset runs outward by y = r0 l0/(lambda R) (F. Redtenbacher, Die Gesetze des Locomotiv-Baues, 1855).
#[test]
fn redtenbacher_offset_of_a_free_wheelset() {
    for (conicity, radius) in [(0.05, 2000.0), (0.1, 1000.0), (0.15, 800.0)] {
        let value = textbook(&[0.0], 0.0, conicity, radius, [1e7, 9e6]);
        let outcome = run(&common::case(&value), &Free).unwrap();
        let theirs = 0.46 * 0.75 / (conicity * radius);
        compare("offset of a free wheelset, m", -row(&outcome, "ws1.y", 0), theirs, 2e-3);
        assert!(row(&outcome, "ws1.psi", 0).abs() < 1e-5);
    }
}

/// Rigid bogies: no yaw, y = r0/(lambda l0 R) [l0^2 + (f22/f11) b^2], for three axles (2/3) b^2.
#[test]
fn rigid_bogies_run_outward_as_in_closed_form() {
    let (conicity, radius, f, b, l0) = (0.1, 2000.0, [1e7, 8e6], 1.2, 0.75);
    for (axles, share) in [(vec![b, -b], 1.0), (vec![b, 0.0, -b], 2.0 / 3.0)] {
        let value = textbook(&axles, 1e9, conicity, radius, f);
        let outcome = run(&common::case(&value), &Free).unwrap();
        let theirs = 0.46 / (conicity * l0 * radius) * (l0 * l0 + share * f[1] / f[0] * b * b);
        // The frame's centre stands on the chord: closed form of the axles' mean offset, without the versine.
        let ours =
            -axles.iter().enumerate().map(|(i, _)| row(&outcome, &format!("ws{}.y", i + 1), 0)).sum::<f64>()
                / axles.len() as f64;
        compare(&format!("offset of a rigid bogie of {} axles, m", axles.len()), ours, theirs, 0.01);
    }
}

/// A stiff box on two axles, rigid but for what keeps the equations regular.
fn box_vehicle(radius: f64) -> Value {
    let mut value = common::coco134();
    let height = -1.9;
    let mut links = Vec::new();
    let mut sets = Vec::new();
    for (name, x) in [("ws1", 3.0), ("ws2", -3.0)] {
        sets.push(json!({
            "name": name, "mass": 1500.0, "inertia": [900.0, 100.0, 900.0], "radius": 0.5335,
            "tape_half_distance": 0.75, "position": [x, 0.0]
        }));
        links.push(json!({
            "name": format!("primary_{name}"), "kind": "bushing", "between": [name, "carbody"], "mirror": true,
            "carries_weight": true, "position": [x, 1.0, -0.5335],
            "stiffness": [1e9, 1e9, 1e10]
        }));
    }
    value["vehicle"] = json!({
        "name": "box", "title": "A stiff box", "design_speed_kmh": 100.0,
        "wheel_profile": "anzr1", "track": "plain_1435_as60", "design_condition": "only",
        "condition": { "only": {} },
        "body": [{ "name": "carbody", "mass": 30_000.0, "inertia": [4e4, 3e5, 3e5], "position": [0.0, 0.0, height] }],
        "wheelset": sets, "connection": links,
        "speed_hold": { "body": "carbody", "stiffness": 5e5, "damping": 2e5 },
        "contact": { "youngs_modulus": 2.1e11, "poisson": 0.28, "damping": 1e5 }
    });
    value["condition"] = json!("only");
    value["track"]["support"] = json!("rigid");
    value["track"]["layout"] = curve(radius, 0.0);
    value
}

/// Rigid load transfer dQ/Q0 = a h/(g l0), and rollover where the low rail carries nothing: a = g l/h with l the arm from the
/// centre of mass to the high-rail contact.
#[test]
fn a_rigid_vehicle_unloads_and_rolls_over_as_in_closed_form() {
    let (radius, g) = (200.0, 9.80665);
    let mut value = box_vehicle(radius);
    value["run"] = json!({ "kind": "equilibrium", "speed": 15.0, "friction": 0.4 });
    let case = common::case(&value);
    let mut stand = Stand::new(&case).unwrap();
    let mut x = stand.settle(15.0).unwrap();
    let masses = [30_000.0, 1500.0, 1500.0];
    let total: f64 = masses.iter().sum();
    // (V2, load of the low rail), speed by speed until no balance is left.
    let mut low: Vec<[f64; 2]> = Vec::new();
    let (mut arm, mut height) = (0.0, 0.0);
    let mut v = 15.0_f64;
    let mut step = 2.0;
    while step > 0.02 {
        let mut system = stand.system(v);
        let mut trial = x.clone();
        let conditions = Conditions { speed: v, held: &[], push: &[], since: None };
        if equilibrium::newton(&mut system, &mut trial, conditions).is_err() {
            v -= step;
            step *= 0.5;
            v += step;
            continue;
        }
        let mut dx = vec![0.0; trial.len()];
        system.rhs(0.0, &trial, &mut dx);
        let load = |side: usize| system.scratch.wheels.iter().map(|w| w[side].Q).sum::<f64>();
        let map = stand.model.map();
        let mean = |d: usize| (0..3).map(|i| masses[i] * trial[map.q(i).start + d]).sum::<f64>() / total;
        height = -mean(2);
        // Where the resultant on the outer, left wheels passes through the plane of the rails below the car body: the axles stand
        // inside the tangent there, by the versine of their distance.
        let frame = |i: usize| system.scratch.kinematics[i].frame;
        let (mut moment, mut force) = (0.0, 0.0);
        for (w, wheels) in system.scratch.wheels.iter().enumerate() {
            for contact in wheels[0].contacts() {
                let turn = frame(0).R_IT.transpose() * frame(1 + w).R_IT;
                let [y, z] = contact.placed.point;
                let point = turn * Vec3::new(0.0, y, z)
                    + frame(0).R_IT.transpose() * (frame(1 + w).r_IT - frame(0).r_IT);
                let f = turn
                    * (contact.normal * contact.placed.e_n
                        + contact.creep[1] * contact.placed.e_t
                        + Vec3::new(contact.creep[0], 0.0, 0.0));
                moment += f.z * point.y - f.y * point.z;
                force += f.z;
            }
        }
        // Axles with their masses, in the same axes.
        let versine = 3.0 * 3.0 / (2.0 * radius) * (masses[1] + masses[2]) / total;
        arm = mean(1) + versine - moment / force;
        if load(1) < 0.0 {
            v -= step;
            step *= 0.5;
            v += step;
            continue;
        }
        low.push([v * v, load(1)]);
        x = trial;
        if v < 15.5 {
            // Rigid transfer with the arms that there are.
            let a = v * v / radius;
            let transfer = (load(0) - load(1)) / (total * g);
            println!(
                "load transfer at 15 m/s: {transfer:.4}, rigid with arms of 0.75 m {:.4}",
                a * height / (g * 0.75)
            );
        }
        v += step;
    }
    let [a, b] = [low[low.len() - 2], low[low.len() - 1]];
    let zero = b[0] - b[1] * (b[0] - a[0]) / (b[1] - a[1]);
    println!(
        "last balance at {:.2} m/s with {:.0} N on the low rail; arm {arm:.4} m, height {height:.4} m",
        b[0].sqrt(),
        b[1]
    );
    compare("rollover speed, m/s", zero.sqrt(), (g * arm / height * radius).sqrt(), 0.01);
}

/// A lateral force on the car body there and back: elastic, so the way does not matter, and the spring's own stiffness.
#[test]
fn a_lateral_force_there_and_back_leaves_nothing() {
    let mut value = common::coco134();
    value["run"] = json!({
        "kind": "quasi_static", "speed": 0.0, "friction": 0.4, "load_steps": 4,
        "load": [{ "kind": "force", "body": "carbody", "axis": "y", "path": [0.0, 40e3, -40e3, 0.0] }]
    });
    let outcome = run(&common::case(&value), &Free).unwrap();
    let y = common::column(&outcome.columns, "carbody.y");
    let force = common::column(&outcome.columns, "carbody.force_y");
    println!("{:?}\n{:?}", force, y.iter().map(|y| 1e3 * y).collect::<Vec<_>>());
    assert_eq!(force.len(), 13);
    assert!((y[12] - y[0]).abs() < 1e-8);
    assert!((y[4] + y[8]).abs() < 1e-7 && y[4] > 0.0);
    // The same displacement prescribed is held by the same force.
    value["run"]["load"] =
        json!([{ "kind": "displacement", "coordinate": "carbody.y", "path": [0.0, y[4]] }]);
    let held = run(&common::case(&value), &Free).unwrap();
    compare("force that holds the body, N", row(&held, "carbody.y.reaction", 4), 40e3, 1e-6);
}

/// One side of the track under the first axle raised: twist by prescribed track coordinates.
#[test]
fn a_raised_wheel_unloads_its_diagonal() {
    let mut value = common::coco134();
    value["run"] = json!({
        "kind": "quasi_static", "speed": 0.0, "friction": 0.4, "load_steps": 3,
        "load": [{ "kind": "displacement", "coordinate": "ws1.track_phi", "path": [0.0, 0.004, 0.0] }]
    });
    let outcome = run(&common::case(&value), &Free).unwrap();
    let q = common::column(&outcome.columns, "ws1.left.Q");
    println!("{q:?}");
    // Rolled to the right the left rail rises.
    assert!(q[3] > 1.1 * q[0] && (q[6] / q[0] - 1.0).abs() < 1e-6);
    let moment = common::column(&outcome.columns, "ws1.track_phi.reaction_moment");
    let right = common::column(&outcome.columns, "ws1.right.Q");
    // What raises the track works against its roll springs, kz half_base2, and the difference of the wheels on it.
    let springs = 1.5e8 * 0.75 * 0.75 * 0.004;
    compare("moment on the raised track, N m", moment[3], springs + 0.7522 * (q[3] - right[3]), 1e-3);
}

/// On the textbook contact the arms are exactly 0.75 m: dQ/Q0 = a h/(g l0).
#[test]
fn a_rigid_vehicle_on_textbook_contact_transfers_its_load_exactly() {
    let radius = 5000.0;
    let mut value = box_vehicle(radius);
    value["run"] = json!({
        "kind": "equilibrium", "speed": 60.0, "friction": 0.4,
        "contact": { "kind": "textbook", "conicity": 0.05, "f11": 1e7, "f22": 1e7, "stiffness": 1e10 }
    });
    let outcome = run(&common::case(&value), &Free).unwrap();
    let at = |name: &str| row(&outcome, name, 0);
    let side = |s: &str| (1..=2).map(|w| at(&format!("ws{w}.{s}.Q"))).sum::<f64>();
    let transfer = (side("left") - side("right")) / (side("left") + side("right"));
    let height = (30_000.0 * 1.9 + 3000.0 * 0.5335) / 33_000.0;
    // The textbook's contacts stay at +-0.75 m of the axle's centre: only the box leans against it, less the axles' versine.
    let versine = 9.0 / (2.0 * radius);
    let axles = 0.5 * (at("ws1.y") + at("ws2.y"));
    let lean = -(30_000.0 * (at("carbody.y") - versine - axles)) / 33_000.0;
    // An axle that turns with the curve takes Iyy spin V/R about its length, which the rails give it.
    let gyroscopic = 2.0 * 100.0 * (60.0 / 0.5335) * (60.0 / radius) / (33_000.0 * 9.80665 * 0.75);
    let theirs = (at("unbalanced") * height / 9.80665 + lean) / 0.75 + gyroscopic;
    println!("lean {:.2} mm, gyroscopic {gyroscopic:.5}", 1e3 * lean);
    compare("load transfer", transfer, theirs, 2e-3);
}

/// Cones on knife-edged rails (Wickens 2003): weight W pushes a shifted wheelset back by W e/l0 per metre, e = l0 lambda/(l0 - r0 lambda), and turns a yawed one
/// on by W l0 lambda per radian; without gravity stiffness neither.
#[test]
fn gravity_stiffness_of_a_coned_wheelset() {
    let (l0, r0, weight) = (0.75, 0.46, 1500.0 * 9.80665);
    for conicity in [0.02, 0.05, 0.1] {
        let held = |on: bool, coordinate: &str, reaction: &str| -> f64 {
            let mut value = textbook(&[0.0], 0.0, conicity, 1e4, [1e7, 9e6]);
            value["track"]["layout"] = json!([]);
            let hold = if coordinate == "ws1.y" { "ws1.psi" } else { "ws1.y" };
            value["run"] = json!({
                "kind": "quasi_static", "speed": 0.0, "friction": 0.4, "load_steps": 1, "hold": [hold],
                "load": [{ "kind": "displacement", "coordinate": coordinate, "path": [0.0, 0.001] }],
                "contact": {
                    "kind": "textbook", "conicity": conicity, "f11": 1e7, "f22": 9e6, "stiffness": 1e10,
                    "gravity_stiffness": on
                }
            });
            let outcome = run(&common::case(&value), &Free).unwrap();
            *common::column(&outcome.columns, &format!("{coordinate}.{reaction}")).last().unwrap()
        };
        let lateral = weight * conicity / (l0 - r0 * conicity);
        // the slope of the normal is a tangent: 1 + lambda^2
        let allowed = 2.0 * conicity * conicity + 1e-4;
        compare("gravity stiffness, N/m", held(true, "ws1.y", "reaction") / 1e-3, lateral, allowed);
        let yaw = held(true, "ws1.psi", "reaction_moment") / 1e-3;
        compare("gravity stiffness in yaw, N m/rad", yaw, -weight * l0 * conicity, allowed);
        assert!(held(false, "ws1.y", "reaction").abs() < 1e-6 * weight);
        assert!(held(false, "ws1.psi", "reaction_moment").abs() < 1e-6 * weight);
    }
}

/// A slider of 8 kN beside the secondary springs, bogies held: there and back again differ by twice the friction, and the way
/// comes back to itself.
#[test]
fn friction_shows_its_hysteresis_along_the_path() {
    let mut value = common::coco134();
    let connections = value["vehicle"]["connection"].as_array_mut();
    let slider = json!({
        "name": "slider", "kind": "friction", "between": ["bogie1", "carbody"], "position": [6.6, 0.0, -1.05],
        "along": "y", "force": 8e3, "stiffness": 2e7
    });
    match connections {
        Some(list) => list.push(slider),
        None => value["vehicle"]["connection"] = json!([slider]),
    }
    let hold: Vec<String> = ["bogie1", "bogie2"]
        .iter()
        .flat_map(|b| ["x", "y", "z", "phi", "theta", "psi"].map(|c| format!("{b}.{c}")))
        .chain(["carbody.phi", "carbody.psi", "carbody.theta"].map(str::to_owned))
        .collect();
    value["run"] = json!({
        "kind": "quasi_static", "speed": 0.0, "friction": 0.4, "load_steps": 10, "hold": hold,
        "load": [{ "kind": "displacement", "coordinate": "carbody.y", "path": [0.0, 0.02, -0.02, 0.02] }]
    });
    let outcome = run(&common::case(&value), &Free).unwrap();
    assert_eq!(outcome.ended, Ended::Complete);
    let (y, force) = (
        common::column(&outcome.columns, "carbody.y"),
        common::column(&outcome.columns, "carbody.y.reaction"),
    );
    for (y, f) in y.iter().zip(force) {
        println!("{:7.2} mm {:9.1} N", 1e3 * y, f);
    }
    // Rows: 0..10 out, 10..20 back, 20..30 out again; 15 and 25 pass the middle.
    compare("width of the loop, N", force[25] - force[15], 16e3, 1e-3);
    compare("the loop closes, N", force[30], force[10], 1e-6);
    // Beside it the springs: 8 x 1.5e5, pivots 2 x 4e6 N/m.
    compare("springs, N", force[10] - 8e3, 0.02 * (8.0 * 1.5e5 + 2.0 * 4e6), 0.01);
}

/// The locomotive over a vertical curve of 500 m: every mass m at height h is held on a circle of radius R + h (crest) or R - h
/// (sag), so the rails carry m (g cos(gradient) -+ (V/R)^2 (R +- h)) once the bounce that it is met with has died away.
#[test]
fn a_vehicle_on_a_vertical_curve_feels_v2_over_r() {
    let (g, speed) = (9.80665, 15.0);
    for radius in [500.0_f64, -500.0] {
        let angle = 0.2_f64.atan();
        let (foot, length) = (30.0, radius.abs() * angle);
        let mut value = common::coco134();
        value["track"]["length"] = json!(foot + length);
        value["track"]["layout"] = json!([
            { "kind": "tangent", "length": foot },
            { "kind": "clothoid", "length": length },
            { "kind": "tangent", "length": 30.0, "gradient": -0.2 * radius.signum() }
        ]);
        value["run"]["speed"] = json!(speed);
        let outcome = run(&common::case(&value), &Free).unwrap();
        assert_eq!(outcome.ended, Ended::EndOfTrack);
        let s = common::column(&outcome.columns, "s");
        let wheels: Vec<&[f64]> = (1..=6)
            .flat_map(|w| ["left", "right"].map(|side| format!("ws{w}.{side}.Q")))
            .map(|name| common::column(&outcome.columns, &name))
            .collect();
        // The reference is the vehicle's centre; the last two periods of the bounce of 1.12 Hz.
        let last: Vec<usize> = (s.len() - (2.0 / 1.12 / 0.005) as usize..s.len()).collect();
        let mean = |f: &dyn Fn(usize) -> f64| last.iter().map(|i| f(*i)).sum::<f64>() / last.len() as f64;
        let weight = mean(&|i| 134_000.0 * g * ((s[i] - foot) / radius).cos());
        let load = mean(&|i| wheels.iter().map(|q| q[i]).sum::<f64>());
        // What holds the speed gives way by half a per cent to the weight on the changing slope.
        let own = (s[last[last.len() - 1]] - s[last[0]]) / (0.005 * (last.len() - 1) as f64);
        // Heights of the masses, of 134 t: body 1.9 m, bogies 0.7 m, wheelsets 0.53 m, some 1.5 m in all.
        let theirs = -134_000.0 * (own / radius).powi(2) * (radius + 1.5);
        println!("R {radius} m, {own:.4} m/s: {load:.0} N where {weight:.0} N weigh");
        compare("change of load by the vertical curve, N", load - weight, theirs, 5e-3);
    }
}

/// Widened by the layout or by the track's own gauge: the same track.
#[test]
fn a_gauge_widened_by_the_layout_is_the_wider_gauge() {
    let balance = |gauge: f64, widening: f64| {
        let mut value = common::coco134();
        value["track"]["gauge"] = json!(gauge);
        value["track"]["layout"] =
            json!([{ "kind": "curve", "length": 200.0, "radius": 400.0, "widening_mm": widening }]);
        value["run"] = json!({ "kind": "equilibrium", "speed": 15.0, "friction": 0.4 });
        let outcome = run(&common::case(&value), &Free).unwrap();
        ["ws1.y", "ws1.left.Y", "ws1.right.Y", "ws3.y"].map(|name| row(&outcome, name, 0))
    };
    let plain = balance(1.435, 0.0);
    for widening in [8.0, 30.0] {
        let (wide, own) = (balance(1.435, widening), balance(1.435 + 1e-3 * widening, 0.0));
        println!("1435 mm {plain:?}, widened by {widening} mm {wide:?}, as wide by itself {own:?}");
        // The leading axle runs half the widening further out to its rail.
        assert!((wide[0] - plain[0]).abs() > 0.375e-3 * widening);
        for (a, b) in wide.iter().zip(own) {
            // Two tables, built about different places; with 30 mm the inner wheel stands where one has its nodes 0.5 mm apart.
            assert!((a / b - 1.0).abs() < 0.01, "{a} {b}");
        }
    }
}

/// A wheelset with a flange on its rail leaves the other wheel 37 mm inward of its place: no derailment.
#[test]
fn a_curve_widened_by_thirty_millimetres_is_run_through() {
    let mut value = common::coco134();
    let curve = json!({ "kind": "curve", "length": 30.0, "radius": 300.0, "widening_mm": 30.0 });
    value["track"]["layout"] =
        json!([{ "kind": "tangent", "length": 30.0 }, { "kind": "clothoid", "length": 30.0 }, curve]);
    value["track"]["length"] = json!(90.0);
    value["run"]["speed"] = json!(10.0);
    let outcome = run(&common::case(&value), &Free).unwrap();
    assert_eq!(outcome.ended, Ended::EndOfTrack);
    let (y, outer) =
        (common::column(&outcome.columns, "ws1.y"), common::column(&outcome.columns, "ws1.left.Y"));
    let (last, force) = (y[y.len() - 1], outer[outer.len() - 1]);
    println!("leading wheelset {:.1} mm outward, {:.1} kN on its outer rail", -1e3 * last, 1e-3 * force);
    assert!(-last > 0.020);
}
