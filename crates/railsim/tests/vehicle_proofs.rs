//! Physics proofs of the whole: energy, Klingel, mirror symmetry, order.

mod common;

use railsim::Error;
use railsim::body::{RigidBody, Wheelset};
use railsim::contact::creep::CreepLaw;
use railsim::contact::friction::FrictionField;
use railsim::contact::geometry_table::{GeometryTable, Placement};
use railsim::contact::profile::{Profile, ProfileKind};
use railsim::dynamics::{Contact, Model, SpeedProgram, VehicleSystem, compile, energy, equilibrium};
use railsim::error::KeyPath;
use railsim::integrator::{Integrator, Stepper, System};
use railsim::math::Vec3;
use railsim::run::{Free, simulate};
use railsim::track::DeviationField;
use railsim::track::Layout;
use serde_json::{Value, json};

/// Klingel (VALIDATION: r0 0.46, l0 0.75, lambda 0.05): L = 2 pi sqrt(r0 l0 / lambda), here with the full contact:
/// a cone rolling on the round rail head through geometry table, Hertz and FASTSIM.
#[test]
fn klingel_1883_wavelength_of_a_free_wheelset_on_cones() {
    let (radius, half, conicity) = (0.46, 0.75, 0.05_f64);
    let cone: Vec<[f64; 2]> = (0..=800)
        .map(|i| {
            let y = -0.040 + 1e-4 * f64::from(i);
            // A steep flange far out of reach, so that the profile has one.
            [y, if y < -0.036 { -conicity * y + 3.0 * (-0.036 - y) } else { -conicity * y }]
        })
        .collect();
    let at = KeyPath::of("profiles.cone");
    let wheel = Profile::new(&cone, ProfileKind::Wheel, &at).unwrap();
    let text = std::fs::read_to_string(common::models().join("profiles/as60.csv")).unwrap();
    let rail =
        Profile::new(&railsim::contact::profile::read_csv(&text, "as60").unwrap(), ProfileKind::Rail, &at)
            .unwrap();
    let placement = Placement {
        gauge: 1.435,
        gauge_point_depth: 0.016,
        rail_inclination: conicity,
        tape_half_distance: half,
        wheel_radius: radius,
        youngs_modulus: 2.1e11,
        poisson: 0.28,
    };
    let table = GeometryTable::build(&wheel, &rail, &placement).unwrap();
    let set = Wheelset {
        body: RigidBody {
            name: "ws1".into(),
            mass: 10_000.0,
            inertia: Vec3::new(600.0, 100.0, 600.0),
            position: Vec3::new(0.0, 0.0, -radius),
        },
        radius,
        tape_half_distance: half,
    };
    let contact = Contact::Profiles {
        table: std::sync::Arc::new(table),
        law: CreepLaw::default(),
        shear_modulus: 8.2e10,
        dissipation: 1.0,
        friction: FrictionField::constant(0.5),
    };
    let model = Model::new(
        vec![],
        vec![set],
        vec![],
        vec![],
        None,
        Layout::tangent(1000.0),
        DeviationField::none(),
        None,
        contact,
        9.80665,
    );
    // Slow enough that inertia does not matter: the motion is kinematic.
    let speed = 5.0;
    let mut x = equilibrium::solve(&model, 0.0, speed).unwrap();
    x[1] = 0.001;
    let mut system = VehicleSystem::new(&model, SpeedProgram { s: 0.0, speed, acceleration: 0.0 });
    let h = 1e-4;
    let mut stepper = Stepper::new(&Integrator::Ros2 { step: h }, system.size(), system.stiff_blocks());
    let mut crossings = Vec::new();
    let mut step = 0_u32;
    while x[0] < 60.0 {
        let (s, y) = (x[0], x[1]);
        let _ = stepper.step(&mut system, f64::from(step) * h, &mut x, h);
        step += 1;
        if y > 0.0 && x[1] <= 0.0 {
            crossings.push(s + (x[0] - s) * y / (y - x[1]));
        }
    }
    let measured = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64;
    let klingel = 2.0 * std::f64::consts::PI * (radius * half / conicity).sqrt();
    println!(
        "kinematic wavelength: {measured:.4} m, Klingel {klingel:.4} m ({:+.2} %)",
        100.0 * (measured / klingel - 1.0)
    );
    assert!((measured / klingel - 1.0).abs() < 0.01);
    // On a round rail head (radius R) the contact wanders with the roll y lambda / l0, which also moves the wheelset's
    // centre against the contacts: lambda (1 + (R + r0) lambda / l0), and ds psi = dy (1 + lambda r0 / l0).
    let (head, l0) = (0.3, half + 0.0017);
    let along = conicity / l0;
    let refined = klingel * ((l0 / half) * (1.0 + radius * along) / (1.0 + (head + radius) * along)).sqrt();
    println!("with the rail head's radius: {refined:.4} m ({:+.3} %)", 100.0 * (measured / refined - 1.0));
    assert!((measured / refined - 1.0).abs() < 1e-3);
}

/// Every damper of the vehicle file set to nothing, no friction, no contact damping, rigid track.
fn undamped() -> Model {
    let mut value = common::coco134();
    for (group, keys) in [
        ("primary", &["cx", "cy", "cz"][..]),
        ("secondary", &["cx", "cy", "cz"]),
        ("centre_pivot", &["cx", "cy"]),
        ("lateral_damper", &["cy"]),
        ("yaw_damper", &["cx"]),
    ] {
        for key in keys {
            assert!(value["vehicle"]["parameters"][group][key].is_number(), "{group}.{key}");
            value["vehicle"]["parameters"][group][key] = json!(0.0);
        }
    }
    let mut model = compile::model(&common::case(&value)).unwrap();
    model.support = None;
    if let Some(hold) = &mut model.speed_hold {
        hold.damping = 0.0;
    }
    if let Contact::Profiles { dissipation, friction, .. } = &mut model.contact {
        *dissipation = 0.0;
        *friction = FrictionField::constant(0.0);
    }
    model
}

#[test]
fn energy_of_the_undamped_vehicle_on_rigid_frictionless_track_is_kept() {
    let model = undamped();
    let start = 20.0;
    let mut x = equilibrium::solve(&model, start, 0.0).unwrap();
    let map = model.map();
    // Lift and roll the body, push a bogie: vertical, lateral, pitch and roll motion all at once.
    x[map.q(0).start + 2] -= 0.015;
    x[map.q(0).start + 3] += 0.004;
    x[map.q(1).start + 1] += 0.002;
    x[map.q(0).start + 1] += 0.004;
    let program = SpeedProgram { s: equilibrium::reference_s(&model, start), speed: 0.0, acceleration: 0.0 };
    let mut system = VehicleSystem::new(&model, program);
    let mut dx = vec![0.0; map.size()];
    let h = 1e-4;
    let mut stepper = Stepper::new(&Integrator::Rk4 { step: h }, map.size(), &[]);
    system.rhs(0.0, &x, &mut dx);
    let first = energy::total(&system, 0.0, &x);
    let mut exchanged = (f64::MAX, f64::MIN);
    let mut drift = 0.0_f64;
    for step in 0..20_000_u32 {
        let _ = stepper.step(&mut system, f64::from(step) * h, &mut x, h);
        if step % 50 == 0 {
            let t = f64::from(step + 1) * h;
            system.rhs(t, &x, &mut dx);
            let kinetic: f64 = (0..model.count())
                .map(|i| {
                    let body = model.rigid(i);
                    railsim::body::rigid_body::kinetic_energy(
                        &system.scratch.kinematics[i],
                        body.mass,
                        &body.inertia,
                    )
                })
                .sum();
            exchanged = (exchanged.0.min(kinetic), exchanged.1.max(kinetic));
            drift = drift.max((energy::total(&system, t, &x) - first).abs());
        }
    }
    let turned_over = exchanged.1 - exchanged.0;
    println!("energy drift over 2 s: {drift:.3e} J of {turned_over:.1} J exchanged");
    assert!(turned_over > 100.0);
    // The contact table's position, angle and gap are interpolated each by itself, so the normal force is the gradient of
    // its energy only to the table's accuracy.
    assert!(drift < 2e-3 * turned_over, "{drift}");
}

fn rough(seed: u64) -> Value {
    let mut value = common::coco134();
    value["run"]["wheel_profile"] = json!("anzr1_worn_1");
    value["track"]["length"] = json!(150.0);
    value["track"]["irregularity"] = json!({
        "kind": "psd", "form": "fra_hamid_yang", "class": 6, "wavelengths": [1.5, 40.0], "seed": seed, "period": 1000.0
    });
    value["track"]["fade_in"] = json!(30.0);
    value
}

/// The same track seen in a mirror: lateral, cross level, curvature and cant change sign; gauge and height do not.
#[test]
fn mirrored_track_gives_the_mirrored_run() {
    let run = |sign: f64| {
        let mut value = common::coco134();
        value["run"]["speed"] = json!(20.0);
        value["run"]["integrator"] = json!({ "kind": "heun", "step": 0.00025 });
        value["track"]["length"] = json!(160.0);
        value["track"]["layout"] = json!([
            { "kind": "tangent", "length": 20.0 },
            { "kind": "clothoid", "length": 50.0 },
            { "kind": "curve", "length": 40.0, "radius": sign * 600.0, "cant_mm": sign * 60.0 },
            { "kind": "clothoid", "length": 50.0 },
            { "kind": "tangent", "length": 10.0 }
        ]);
        let shape = |channel: &str, height: f64, start: f64| json!({ "kind": "shape", "shape": "versine", "channel": channel, "start": start, "length": 9.0, "height": height });
        value["track"]["irregularity"] = json!([
            shape("lateral", sign * 0.004, 15.0),
            shape("cross_level", sign * 0.006, 22.0),
            shape("gauge", 0.003, 30.0),
            shape("vertical", 0.005, 27.0)
        ]);
        simulate(&common::case(&value), &Free).unwrap().columns
    };
    let (one, other) = (run(1.0), run(-1.0));
    for (name, mirrored, sign) in [
        ("carbody.y", "carbody.y", -1.0),
        ("carbody.z", "carbody.z", 1.0),
        ("carbody.phi", "carbody.phi", -1.0),
        ("bogie1.psi", "bogie1.psi", -1.0),
        ("ws1.left.Q", "ws1.right.Q", 1.0),
        ("ws1.left.Y", "ws1.right.Y", 1.0),
        ("ws4.right.creep_x", "ws4.left.creep_x", 1.0),
        ("ws6.left.creep_y", "ws6.right.creep_y", 1.0),
    ] {
        let (a, b) = (common::column(&one, name), common::column(&other, mirrored));
        let size = a.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let worst = a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - sign * b).abs()));
        // The same operations in another order for two sides: rounding, grown by 8 s of motion.
        assert!(worst < 1e-6 * size, "{name}: {worst:.3e} of {size:.3e}");
    }
}

/// The same for one right-hand side at a general state, to rounding.
#[test]
fn mirrored_state_gives_mirrored_accelerations() {
    let model = compile::model(&common::case(&common::coco134())).unwrap();
    let map = model.map();
    let mirror = |x: &[f64]| {
        let mut m = x.to_vec();
        for i in 0..model.count() {
            for d in [1, 3, 5] {
                m[map.q(i).start + d] *= -1.0;
                m[map.u(i).start + d] *= -1.0;
            }
        }
        for w in 0..model.wheelsets.len() {
            for d in [0, 2] {
                m[map.track_q(w).start + d] *= -1.0;
                m[map.track_u(w).start + d] *= -1.0;
            }
        }
        m
    };
    let mut x = equilibrium::solve(&model, 20.0, 35.0).unwrap();
    for i in 0..model.count() {
        let k = i as f64;
        x[map.q(i).start + 1] += 1e-3 * (1.0 + k).sin();
        x[map.q(i).start + 3] += 1e-3 * (2.0 + k).sin();
        x[map.q(i).start + 5] += 1e-3 * (3.0 + k).sin();
        x[map.u(i).start + 1] += 1e-2 * (4.0 + k).sin();
    }
    let program = SpeedProgram { s: 20.0, speed: 35.0, acceleration: 0.0 };
    let mut system = VehicleSystem::new(&model, program);
    let (mut one, mut other) = (vec![0.0; map.size()], vec![0.0; map.size()]);
    system.rhs(0.0, &x, &mut one);
    let left_first: Vec<[f64; 2]> = system.scratch.wheels.iter().map(|w| [w[0].Q, w[1].Q]).collect();
    system.rhs(0.0, &mirror(&x), &mut other);
    let largest = one.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    for (a, b) in mirror(&one).iter().zip(&other) {
        assert!((a - b).abs() < 1e-9 * largest, "{a} {b}");
    }
    for (w, loads) in system.scratch.wheels.iter().zip(left_first) {
        assert!((w[1].Q - loads[0]).abs() < 1e-6 * loads[0].abs().max(1.0));
        assert!((w[0].Q - loads[1]).abs() < 1e-6 * loads[1].abs().max(1.0));
    }
}

#[test]
fn the_same_case_gives_the_same_bytes() {
    let case = common::case(&rough(3));
    let bits = |c: &[(String, Vec<f64>)]| -> Vec<u64> {
        c.iter().flat_map(|(_, v)| v.iter().map(|x| x.to_bits())).collect()
    };
    let (one, two) = (simulate(&case, &Free).unwrap(), simulate(&case, &Free).unwrap());
    assert_eq!(bits(&one.columns), bits(&two.columns));
}

/// Observed order of Heun and ros2 on the whole locomotive over rough track: halving the step quarters the error.
#[test]
fn heun_and_ros2_agree_and_converge_with_order_two_on_the_vehicle() {
    let run = |kind: &str, step: f64| {
        let mut value = rough(1);
        value["run"]["integrator"] = json!({ "kind": kind, "step": step });
        value["run"]["output_step"] = json!(0.004);
        let outcome = simulate(&common::case(&value), &Free).unwrap();
        common::column(&outcome.columns, "carbody.y").to_vec()
    };
    let reference = run("heun", 6.25e-5);
    let error = |kind: &str, step: f64| {
        let y = run(kind, step);
        y.iter().zip(&reference).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()))
    };
    let size = reference.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    // Order one would give 3.0 (heun, against this reference) and 2.2 (ros2), order two 5.0 and 4: half-way between.
    for (kind, steps, least) in [("heun", [2.5e-4, 1.25e-4], 4.0), ("ros2", [5e-4, 2.5e-4], 3.1)] {
        let (coarse, fine) = (error(kind, steps[0]), error(kind, steps[1]));
        println!(
            "{kind}: error of carbody.y {coarse:.2e} m at {} s, {fine:.2e} m at {} s, of {size:.2e} m",
            steps[0], steps[1]
        );
        assert!(coarse < 0.01 * size);
        assert!(coarse / fine > least, "{kind}: {coarse} / {fine}");
    }
}

#[test]
fn a_step_beyond_the_stability_limit_is_refused_by_name() {
    let mut value = common::coco134();
    value["run"]["integrator"] = json!({ "kind": "heun", "step": 0.001 });
    match simulate(&common::case(&value), &Free) {
        Err(Error::Input(faults)) => {
            assert_eq!(faults[0].key.to_string(), "run.integrator.step");
            assert!(faults[0].allowed.contains("at most about"), "{}", faults[0]);
            println!("{}", faults[0]);
        }
        other => panic!("{other:?}"),
    }
}

/// A wheelset that follows its rails exactly, up a slope and round a kink, slides nowhere: creepage is second order in the
/// slopes, also on an inclined contact plane.
#[test]
fn a_wheelset_that_follows_its_rails_does_not_creep() {
    use railsim::body::{Kinematics, steady_speeds};
    use railsim::contact::creepage::{TrackMotion, place, rail_pose, track_roll};
    use railsim::contact::geometry_table::ContactPoint;
    use railsim::track::Deviation;
    let (radius, half, speed) = (0.5335, 0.75, 30.0);
    let (climb, turn) = (1e-3, 2e-3);
    let dev = Deviation { dy_ds: turn, dz_ds: climb, ..Deviation::default() };
    for angle in [0.05_f64, 0.6, 1.2] {
        let contact = ContactPoint { penetration: 1e-4, share: 1.0, angle, ..ContactPoint::default() };
        let q = [0.0, 0.0, -radius, 0.0, 0.0, turn];
        let frame = Layout::tangent(100.0).frame(0.0);
        let mut u = steady_speeds(&q, &frame, speed, -speed / radius, true);
        u[1] = speed * turn;
        u[2] = speed * climb;
        let mut k = Kinematics::zero();
        let (sin, cos) = turn.sin_cos();
        k.R_TB = railsim::math::Mat3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
        k.v_T = Vec3::new(u[0], u[1], u[2]);
        k.w_B = Vec3::new(u[3], u[4], u[5]);
        k.s_dot = speed;
        let w_T = k.R_TB * k.w_B;
        for sigma in [-1.0, 1.0] {
            let still = TrackMotion::default();
            let rail = rail_pose(sigma, half, &dev, &still, track_roll(&dev, 0.0).sin_cos(), speed);
            let placed = place(sigma, &contact, &rail, radius, &q, &k, &w_T, &still, speed);
            let c = placed.creepage;
            // Second order in slopes of 2e-3, grown by tan(1.2 rad) = 2.6: a hundred times smaller than the slopes.
            assert!(c.xi.abs() < 3e-5, "xi {} at {angle} rad", c.xi);
            assert!(c.eta.abs() < 3e-5, "eta {} at {angle} rad", c.eta);
            assert!(placed.approach_rate.abs() < 3e-5 * speed, "approach {}", placed.approach_rate);
        }
    }
}

/// The right-hand side for this processor's best instructions and the one for any: the same bits, on rough track with wheels
/// that creep.
#[test]
fn wider_instructions_change_no_bit() {
    let mut value = common::coco134();
    value["track"]["irregularity"] = json!({
        "kind": "psd", "form": "fra_hamid_yang", "class": 6, "wavelengths": [1.5, 40.0], "seed": 1, "period": 1000.0
    });
    let model = compile::model(&common::case(&value)).unwrap();
    let mut x = equilibrium::solve(&model, 20.0, 35.0).unwrap();
    let program = SpeedProgram { s: equilibrium::reference_s(&model, 20.0), speed: 35.0, acceleration: 0.0 };
    let mut system = VehicleSystem::new(&model, program);
    let mut stepper = Stepper::new(&Integrator::Rk4 { step: 1e-3 }, x.len(), &[]);
    let (mut best, mut any) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    for i in 0..200_u32 {
        let t = f64::from(i) * 1e-3;
        let _ = stepper.step(&mut system, t, &mut x, 1e-3);
        system.rhs(t, &x, &mut best);
        system.stages(t, &x, &mut any);
        assert!(best.iter().zip(&any).all(|(a, b)| a.to_bits() == b.to_bits()), "step {i}");
    }
}
