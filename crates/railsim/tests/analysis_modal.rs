//! Eigenvalues against closed forms and published vehicles: pendulum, cantilever, gyroscope, the suspended wheelset's critical
//! speed, Manchester vehicle 1.

mod common;

use std::f64::consts::TAU;

use nalgebra::Complex;
use railsim::analysis::{Mode, modes, run};
use railsim::body::{RigidBody, Wheelset};
use railsim::connection::{Bushing, Law, Mount};
use railsim::contact::textbook::Textbook;
use railsim::dynamics::equilibrium::{self, Conditions};
use railsim::dynamics::{Contact, Link, Model};
use railsim::math::Vec3;
use railsim::run::{Free, Outcome};
use railsim::schema::toml_to_json;
use railsim::track::{DeviationField, Layout};
use serde_json::{Value, json};

/// Prints ours beside theirs and fails beyond `tolerance`, a share.
#[allow(clippy::print_stdout)] // ours beside theirs
fn compare(what: &str, ours: f64, theirs: f64, tolerance: f64) {
    let off = ours / theirs - 1.0;
    println!("{what}: ours {ours:.6}, theirs {theirs:.6} ({:+.4} %)", 100.0 * off);
    assert!(off.abs() < tolerance, "{what}: {ours} against {theirs}");
}

fn body(name: &str, mass: f64, inertia: [f64; 3], position: [f64; 3]) -> RigidBody {
    RigidBody { name: name.into(), mass, inertia: Vec3::from(inertia), position: Vec3::from(position) }
}

fn link(a: usize, b: usize, ends: [&RigidBody; 2], point: [f64; 3], k: [f64; 3], turning: [f64; 3]) -> Link {
    let [p_A, p_B] = ends.map(|end| Vec3::from(point) - end.position);
    let mount = Mount::new(p_A, p_B, Vec3::zeros());
    let law = Law::Bushing(Bushing {
        stiffness: k,
        damping: [0.0; 3],
        rotational_stiffness: Some(turning),
        rotational_damping: None,
    });
    Link { name: format!("{a}-{b}"), a, b, mount, law, axes: None, memory: 0..0 }
}

fn model(bodies: Vec<RigidBody>, wheelsets: Vec<Wheelset>, links: Vec<Link>, gravity: f64) -> Model {
    let book = Textbook {
        conicity: 0.0,
        f11: 0.0,
        f22: 0.0,
        f23: 0.0,
        stiffness: 1e-3,
        damping: 0.0,
        gravity_stiffness: false,
    };
    Model::new(
        bodies,
        wheelsets,
        links,
        vec![],
        None,
        Layout::tangent(100.0),
        DeviationField::none(),
        None,
        Contact::Textbook(book),
        gravity,
    )
}

/// Modes with the first body held.
fn modes_on_a_wall(model: &Model, speed: f64, more: &[usize]) -> Vec<Mode> {
    let mut held: Vec<usize> = model.map().q(0).collect();
    held.extend(more);
    let mut x = equilibrium::design_state(model, 0.0);
    let mut system = equilibrium::standing(model, 0.0);
    equilibrium::roll(&mut system, speed);
    equilibrium::settle(&mut system, &mut x, Conditions { speed, held: &held, push: &[], since: None })
        .unwrap();
    modes(model, &mut system, &x, &held).unwrap()
}

/// m g L theta + (I + m L^2) theta'' = 0, about both horizontal axes (the compound pendulum: J. P. Den Hartog, Mechanical
/// Vibrations, 1956).
#[test]
fn a_physical_pendulum_swings_with_its_closed_form() {
    let (mass, inertia, length, gravity) = (120.0, [7.0, 4.0, 3.0], 1.3, 9.80665);
    let wall = body("wall", 1e6, [1e6; 3], [0.0, 0.0, 0.0]);
    let bob = body("bob", mass, inertia, [0.0, 0.0, length]);
    let hinge = link(0, 1, [&wall, &bob], [0.0; 3], [1e10; 3], [0.0, 0.0, 1e3]);
    let all = modes_on_a_wall(&model(vec![wall, bob], vec![], vec![hinge], gravity), 0.0, &[]);
    for (i, axis) in [(0, "x"), (1, "y")] {
        let theirs = (mass * gravity * length / (inertia[i] + mass * length * length)).sqrt() / TAU;
        let ours = all
            .iter()
            .map(Mode::frequency)
            .min_by(|a, b| (a - theirs).abs().total_cmp(&(b - theirs).abs()))
            .unwrap();
        compare(&format!("pendulum about {axis}, Hz"), ours, theirs, 1e-5);
    }
}

/// Euler-Bernoulli: beta L = 1.8751 and 4.6941 (R. D. Blevins, Formulas for Natural Frequency and Mode Shape, 1979, table 8-1); twenty rigid pieces joined by EI/h.
#[test]
fn a_cantilever_of_rigid_pieces_bends_like_a_beam() {
    let (pieces, length, per_metre, bending) = (20, 4.0, 30.0, 2.0e6);
    let h = length / f64::from(pieces);
    let mut bodies = vec![body("wall", 1e6, [1e6; 3], [0.0; 3])];
    let mut links = Vec::new();
    for i in 0..pieces {
        let mass = per_metre * h;
        let slim = mass * h * h / 12.0;
        bodies.push(body(
            &format!("piece{i}"),
            mass,
            [0.5 * slim, slim, slim],
            [(f64::from(i) + 0.5) * h, 0.0, 0.0],
        ));
        // Half a piece lies before the first joint.
        let k = bending / h * if i == 0 { 2.0 } else { 1.0 };
        let ends = [&bodies[i as usize], &bodies[i as usize + 1]];
        let at = [f64::from(i) * h, 0.0, 0.0];
        links.push(link(i as usize, i as usize + 1, ends, at, [1e11; 3], [1e7, 50.0 * k, k]));
    }
    let all = modes_on_a_wall(&model(bodies, vec![], links, 0.0), 0.0, &[]);
    for (beta, tolerance) in [(1.875_104_07_f64, 0.003), (4.694_091_13, 0.01)] {
        let theirs = beta * beta * (bending / per_metre).sqrt() / (length * length) / TAU;
        let ours = all
            .iter()
            .map(Mode::frequency)
            .min_by(|a, b| (a - theirs).abs().total_cmp(&(b - theirs).abs()))
            .unwrap();
        compare("cantilever, Hz", ours, theirs, tolerance);
    }
}

/// A spinning axle on springs of equal stiffness k about x and z: I w^2 -+ Iy spin w - k = 0 (Euler's equations for a small turn of a
/// symmetric rotor; J. P. Den Hartog, Mechanical Vibrations, 1956).
#[test]
fn a_gyroscope_precesses_with_its_closed_form() {
    let (inertia, about, k, radius, speed) = (900.0, 400.0, 2.0e6, 0.5, 40.0);
    let wall = body("wall", 1e6, [1e6; 3], [0.0, 0.0, -radius]);
    let axle = Wheelset {
        body: body("ws1", 1500.0, [inertia, about, inertia], [0.0, 0.0, -radius]),
        radius,
        tape_half_distance: 0.75,
    };
    let support = link(0, 1, [&wall, &axle.body], [0.0, 0.0, -radius], [1e8; 3], [k, 0.0, k]);
    let model = model(vec![wall], vec![axle], vec![support], 0.0);
    let turned = model.map().q(1).start + 4;
    let all = modes_on_a_wall(&model, speed, &[turned]);
    let half = 0.5 * about * speed / radius / inertia;
    for sign in [-1.0, 1.0] {
        let theirs = (sign * half + (half * half + k / inertia).sqrt()) / TAU;
        let ours = all
            .iter()
            .map(Mode::frequency)
            .min_by(|a, b| (a - theirs).abs().total_cmp(&(b - theirs).abs()))
            .unwrap();
        compare("gyroscope, Hz", ours, theirs, 1e-6);
    }
}

/// A wheelset on springs to a frame that rolls along. Everything but the wheelset's lateral motion and yaw is held, the contact
/// is the textbook's without spin creep: exactly the two equations of the closed form.
fn suspended(row: &[f64]) -> Value {
    let [m, iz, ky, kpsi, f11, f22, lambda, r0, l0] = row[..9] else { panic!("{row:?}") };
    let mut value = common::coco134();
    value["vehicle"] = json!({
        "name": "suspended", "title": "A wheelset on springs", "design_speed_kmh": 100.0,
        "wheel_profile": "anzr1", "track": "plain_1435_as60", "design_condition": "only",
        "condition": { "only": {} },
        "body": [{ "name": "frame", "mass": 1e4, "inertia": [1e4, 1e4, 1e4], "position": [0.0, 0.0, -r0] }],
        "wheelset": [{
            "name": "ws1", "mass": m, "inertia": [iz, 100.0, iz], "radius": r0,
            "tape_half_distance": l0, "position": [0.0, 0.0]
        }],
        "connection": [{
            "name": "primary", "kind": "bushing", "between": ["frame", "ws1"], "carries_weight": true,
            "position": [0.0, 0.0, -r0], "stiffness": [1e6, ky, 1e6], "rotational_stiffness": [0.0, 0.0, kpsi]
        }],
        "contact": { "youngs_modulus": 2.1e11, "poisson": 0.28, "damping": 0.0 }
    });
    value["condition"] = json!("only");
    value["track"]["support"] = json!("rigid");
    value["run"] = json!({
        "kind": "critical_speed", "speed": 10.0, "friction": 0.4,
        "contact": {
            "kind": "textbook", "conicity": lambda, "f11": f11, "f22": f22, "stiffness": 1e9
        },
        "hold": [
            "frame.x", "frame.y", "frame.z", "frame.phi", "frame.theta", "frame.psi",
            "ws1.x", "ws1.z", "ws1.phi", "ws1.theta"
        ],
        "search": { "method": "linear", "range": [1.0, 100.0] }
    });
    value
}

fn statistic(outcome: &Outcome, name: &str) -> f64 {
    outcome.statistics[name].as_f64().unwrap_or_else(|| panic!("{name}: {}", outcome.statistics))
}

#[test]
fn suspended_wheelset_has_the_exact_critical_speeds_of_routh_and_hurwitz() {
    let text = include_str!("fixtures/suspended_wheelset_critical_speed.csv");
    let mut rows = 0;
    for line in text.lines().filter(|l| !l.starts_with('#')).skip(1) {
        let row: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
        let outcome = run(&common::case(&suspended(&row)), &Free).unwrap();
        compare("critical speed, m/s", statistic(&outcome, "critical_speed"), row[9], 1e-5);
        let v = common::column(&outcome.columns, "v");
        let critical = v.iter().position(|v| (v / row[9] - 1.0).abs() < 1e-5).unwrap();
        compare("onset, Hz", common::column(&outcome.columns, "frequency")[critical], row[11], 1e-5);
        rows += 1;
    }
    assert_eq!(rows, 5);
}

/// Manchester vehicle 1 in its vertical plane: wheelsets held, without what the published numbers leave out where `plain`.
fn manchester(plain: bool) -> Value {
    let data = toml_to_json(include_str!("fixtures/manchester_vehicle1.toml")).unwrap();
    let n = |group: &str, key: &str| data[group][key].as_f64().unwrap();
    let rigid = |key: &str| {
        let m = &data["mass"][key];
        (m["m"].clone(), json!([m["Ixx"], m["Iyy"], m["Izz"]]))
    };
    let along = |x: f64| if plain { 0.0 } else { x };
    let mut value = common::coco134();
    let (mass, inertia) = rigid("car");
    let mut bodies = vec![
        json!({ "name": "carbody", "mass": mass, "inertia": inertia, "position": [0.0, 0.0, -n("geometry", "z_car")] }),
    ];
    let (mut wheelsets, mut links, mut hold) = (Vec::new(), Vec::new(), Vec::new());
    for (b, end) in [1.0, -1.0].into_iter().enumerate() {
        let x = end * n("geometry", "half_bogie_centres");
        let name = format!("bogie{}", b + 1);
        let (mass, inertia) = rigid("bogie");
        bodies.push(json!({ "name": name, "mass": mass, "inertia": inertia, "position": [x, 0.0, -n("geometry", "z_bogie")] }));
        links.push(json!({
            "name": format!("secondary{}", b + 1), "kind": "bushing", "between": [name, "carbody"], "mirror": true,
            "carries_weight": true, "position": [x, n("geometry", "secondary_y"), -n("geometry", "z_secondary_mid")],
            "stiffness": [along(n("secondary", "kx")), n("secondary", "ky"), n("secondary", "kz")],
            "damping": [0.0, n("secondary", "cy"), n("secondary", "cz")]
        }));
        for (w, way) in [1.0, -1.0].into_iter().enumerate() {
            let set = format!("ws{}", 2 * b + w + 1);
            let at = x + way * n("geometry", "half_wheelbase");
            let (mass, inertia) = rigid("wheelset");
            wheelsets.push(json!({
                "name": set, "mass": mass, "inertia": inertia, "radius": n("geometry", "wheel_radius"),
                "tape_half_distance": 0.75, "position": [at, 0.0]
            }));
            links.push(json!({
                "name": format!("primary_{set}"), "kind": "bushing", "between": [set, name], "mirror": true,
                "carries_weight": true, "position": [at, n("geometry", "primary_y"), -n("geometry", "z_primary")],
                "stiffness": [along(n("primary", "kx")), n("primary", "ky"), n("primary", "kz")],
                "damping": [along(n("primary", "cx")), n("primary", "cy"), n("primary", "cz")]
            }));
            if plain {
                hold.extend(["x", "y", "z", "phi", "theta", "psi"].map(|c| format!("{set}.{c}")));
            }
        }
    }
    value["vehicle"] = json!({
        "name": "manchester1", "title": "Manchester vehicle 1", "design_speed_kmh": 160.0,
        "wheel_profile": "anzr1", "track": "plain_1435_as60", "design_condition": "only", "condition": { "only": {} },
        "body": bodies, "wheelset": wheelsets, "connection": links,
        "contact": { "youngs_modulus": 2.1e11, "poisson": 0.28, "damping": 1e5 }
    });
    value["condition"] = json!("only");
    value["run"] = json!({ "kind": "modal", "speed": 0.0, "friction": 0.4, "gravity": 9.81, "hold": hold });
    if plain {
        value["track"]["support"] = json!("rigid");
        value["run"]["contact"] =
            json!({ "kind": "textbook", "conicity": 0.0, "f11": 0.0, "f22": 0.0, "stiffness": 1e12 });
    }
    value
}

fn find<'a>(outcome: &'a Outcome, name: &str) -> impl Fn(&str) -> f64 + use<'a> {
    let names = &outcome.labels[0].1;
    let row = names.iter().position(|n| n == name).unwrap_or_else(|| panic!("no {name} among {names:?}"));
    move |column| common::column(&outcome.columns, column)[row]
}

/// The data file's numbers come from hand-assembled matrices of the vertical plane with the wheels rigid on the rail.
#[test]
fn manchester_vehicle_1_bounces_and_pitches_as_published() {
    let outcome = run(&common::case(&manchester(true)), &Free).unwrap();
    for (i, name) in outcome.labels[0].1.iter().enumerate() {
        let f = common::column(&outcome.columns, "frequency")[i];
        let d = common::column(&outcome.columns, "damping_ratio")[i];
        println!("{f:8.4} Hz {d:7.4}  {name}");
    }
    for (name, hz, zeta) in [
        ("car body bounce", 1.0802, 0.1345),
        ("car body pitch", 1.3106, 0.1625),
        ("bogies bounce in phase", 7.4271, 0.2367),
        ("bogies bounce in antiphase", 7.4114, 0.2406),
        ("bogies pitch in phase", 11.7138, 0.1207),
    ] {
        let mode = find(&outcome, name);
        compare(&format!("{name}, Hz"), mode("natural_frequency"), hz, 0.001);
        compare(&format!("{name}, damping"), mode("damping_ratio"), zeta, 0.01);
    }
}

/// With all its springs, on its wheels and a track that gives: printed, and near the numbers above where those hold.
#[test]
fn manchester_vehicle_1_complete_keeps_its_bounce() {
    let outcome = run(&common::case(&manchester(false)), &Free).unwrap();
    let mode = find(&outcome, "car body bounce");
    compare("bounce on lumped track, Hz", mode("natural_frequency"), 1.0802, 0.01);
    println!(
        "pitch with longitudinal springs: {:.4} Hz",
        find(&outcome, "car body pitch")("natural_frequency")
    );
}

#[test]
fn the_locomotives_modes_are_named_and_shaped() {
    let mut value = common::coco134();
    value["run"] = json!({ "kind": "modal", "speed": 0.0, "speeds": [0.0, 20.0, 35.0], "friction": 0.4 });
    let start = std::time::Instant::now();
    let outcome = run(&common::case(&value), &Free).unwrap();
    println!("three speeds with compilation in {:?}", start.elapsed());
    let column = |name: &str| common::column(&outcome.columns, name);
    for (i, name) in outcome.labels[0].1.iter().enumerate() {
        println!(
            "{:5.1} m/s {:3} {:8.3} Hz {:8.4}  {name}",
            column("v")[i],
            column("branch")[i],
            column("frequency")[i],
            column("damping_ratio")[i]
        );
    }
    for name in
        ["car body lower sway", "car body bounce", "car body pitch", "car body yaw", "car body upper sway"]
    {
        assert!(outcome.labels[0].1.iter().any(|n| n.starts_with(name)), "{name}");
    }
    // Kinematic wavelength of a rigid three-axle bogie on these profiles: about 40 m.
    let names = &outcome.labels[0].1;
    let hunting: Vec<usize> =
        (0..names.len()).filter(|i| names[*i].contains("hunting") && column("frequency")[*i] > 0.1).collect();
    assert!(hunting.len() >= 4, "{hunting:?}");
    for i in hunting {
        let length = column("v")[i] / column("frequency")[i];
        println!("{}: wavelength {length:.1} m", names[i]);
        assert!((30.0..50.0).contains(&length));
    }
    // The most moved coordinate is 1, an axle's turn taken at its rim.
    for i in 0..outcome.labels[0].1.len() {
        let largest = outcome
            .columns
            .iter()
            .filter(|(n, _)| n.starts_with("re."))
            .map(|(n, re)| {
                let im = column(&n.replacen("re.", "im.", 1))[i];
                let lever = if n.contains("ws") && n.ends_with("theta") { 0.5335 } else { 1.0 };
                lever * Complex::new(re[i], im).norm()
            })
            .fold(0.0, f64::max);
        assert!(largest < 1.0 + 1e-9, "{largest}");
    }
}
