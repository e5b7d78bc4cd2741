//! The contract of every connection: balance, energy, dissipation, mirror, preload. Run over every arm of `Law`.

use nalgebra::Rotation3;
use proptest::prelude::*;
use railsim::connection::{Bushing, ForceLaw, KINDS, Law, Mount, Pair, Pose, Relative};
use railsim::math::{Mat3, Vec3};
use serde_json::{Value, json};

fn vector(size: f64) -> impl Strategy<Value = Vec3> {
    (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(move |(x, y, z): (f64, f64, f64)| size * Vec3::new(x, y, z))
}

fn pose(place: Vec3) -> impl Strategy<Value = Pose> {
    (vector(0.05), vector(0.2), vector(1.0), vector(0.5)).prop_map(move |(r, turn, v, w)| Pose {
        r: place + r,
        R: Rotation3::new(turn).into_inner(),
        v,
        w,
    })
}

fn mount() -> impl Strategy<Value = Mount> {
    (vector(0.8), vector(0.8), vector(0.9), vector(1e5), -0.05..0.05).prop_map(
        |(p_A, p_B, between, preload, stretched)| {
            // Ends apart in every direction: where they coincide, a prestretch along an axis has no side of its own.
            let between = between.map(|v: f64| v + 0.01 * v.signum());
            Mount { p_A, p_B, between, preload, stretched }
        },
    )
}

/// Two bodies some 0.5 m apart in a general direction, no zeros, no coincident ends; what a law remembers, far into sliding.
fn scene() -> impl Strategy<Value = (Pose, Pose, Mount, [f64; 2])> {
    let memory = [-0.03..0.03, -0.03..0.03];
    (pose(Vec3::new(0.1, 0.2, -0.3)), pose(Vec3::new(1.9, 1.5, -1.6)), mount(), memory)
}

fn memory_of<'a>(law: &Law, memory: &'a [f64; 2]) -> &'a [f64] {
    &memory[..law.memory()]
}

fn wrench(law: &Law, a: &Pose, b: &Pose, mount: &Mount, memory: &[f64; 2]) -> Pair {
    let motion = Relative::between(a, b);
    Pair::new(&law.wrench(&motion, mount, memory_of(law, memory)), &motion, &a.R)
}

const REST: [f64; 2] = [0.0; 2];

fn power(pair: &Pair, a: &Pose, b: &Pose) -> f64 {
    pair.on_A.f.dot(&a.v) + pair.on_A.m.dot(&a.w) + pair.on_B.f.dot(&b.v) + pair.on_B.m.dot(&b.w)
}

fn advance(p: &Pose, h: f64) -> Pose {
    Pose { r: p.r + h * p.v, R: Rotation3::new(h * p.w).into_inner() * p.R, v: p.v, w: p.w }
}

fn mirror(p: &Pose) -> Pose {
    let m = Mat3::from_diagonal(&Vec3::new(1.0, -1.0, 1.0));
    Pose { r: m * p.r, R: m * p.R * m, v: m * p.v, w: -(m * p.w) }
}

proptest! {
    #[test]
    fn forces_and_moments_of_the_two_ends_balance((a, b, mount, z) in scene()) {
        for law in Law::examples() {
            let pair = wrench(&law, &a, &b, &mount, &z);
            let force = pair.on_A.f + pair.on_B.f;
            let moment = pair.on_A.m + a.r.cross(&pair.on_A.f) + pair.on_B.m + b.r.cross(&pair.on_B.f);
            let size = pair.on_A.f.norm() + pair.on_A.m.norm() + 1.0;
            prop_assert!(force.norm() < 1e-12 * size, "{law:?}: force {force}");
            prop_assert!(moment.norm() < 1e-11 * size, "{law:?}: moment {moment}");
        }
    }

    #[test]
    fn power_put_in_is_stored_or_dissipated((a, b, mount, z) in scene()) {
        for law in Law::examples() {
            let h = 1e-7;
            let motion = Relative::between(&a, &b);
            let memory = memory_of(&law, &z);
            let mut rates = [0.0; 2];
            law.memory_rates(&motion, &mount, memory, &mut rates[..law.memory()]);
            let energy = |h: f64| {
                let moved = [z[0] + h * rates[0], z[1] + h * rates[1]];
                law.energy(&Relative::between(&advance(&a, h), &advance(&b, h)), &mount, memory_of(&law, &moved))
            };
            let stored = (energy(h) - energy(-h)) / (2.0 * h);
            let lost = law.dissipation(&motion, &mount, memory);
            let put_in = -power(&wrench(&law, &a, &b, &mount, &z), &a, &b);
            let size = put_in.abs() + stored.abs() + lost.abs() + 1.0;
            // Central difference of energies of up to 1e7 J: rounding 1e7 * 1e-16 / 1e-7, and a kink of a table or stop
            // within h of the state. Rotational terms of a bushing use the antisymmetric part of the rotation: off by the
            // relative turn, up to 0.7 rad here, times its moment K turn (3e4 N m/rad) times the turning rate (1.7 rad/s).
            // Their sign has a test of its own below.
            let angle = Rotation3::from_matrix(&motion.R_AB).angle();
            let slack = match &law {
                Law::Bushing(l) if l.rotational_stiffness.is_some() => 3e4 * angle * angle * motion.w_AB.norm(),
                _ => 1e-2,
            };
            prop_assert!((stored + lost - put_in).abs() < 1e-5 * size + slack, "{law:?}: {stored} + {lost} != {put_in}");
        }
    }

    #[test]
    fn dissipation_is_never_negative((a, b, mount, z) in scene()) {
        for law in Law::examples() {
            prop_assert!(law.dissipation(&Relative::between(&a, &b), &mount, memory_of(&law, &z)) >= 0.0, "{law:?}");
        }
    }

    #[test]
    fn mirrored_motion_gives_mirrored_force((a, b, mount, z) in scene()) {
        let m = Mat3::from_diagonal(&Vec3::new(1.0, -1.0, 1.0));
        for law in Law::examples() {
            let mirrored = Mount {
                p_A: m * mount.p_A,
                p_B: m * mount.p_B,
                between: m * mount.between,
                preload: m * mount.preload,
                stretched: mount.stretched,
            };
            // A plate remembers a vector, of which the lateral part changes its sign; an elongation has no side.
            let memory = match &law {
                Law::FrictionPlate(plate) => match serde_json::to_value(plate).unwrap()["normal"].as_str() {
                    Some("y") => z,
                    _ => [z[0], -z[1]],
                },
                _ => z,
            };
            let one = wrench(&law, &a, &b, &mount, &z);
            let other = wrench(&law.mirrored(), &mirror(&a), &mirror(&b), &mirrored, &memory);
            prop_assert!((m * one.on_B.f - other.on_B.f).norm() < 1e-9 * (1.0 + one.on_B.f.norm()), "{law:?}");
            prop_assert!((m * one.on_B.m + other.on_B.m).norm() < 1e-9 * (1.0 + one.on_B.m.norm()), "{law:?}");
        }
    }

    /// What a law remembers settles no faster than it says, so that a step can be judged by it.
    #[test]
    fn memory_settles_no_faster_than_it_says((a, b, mount, z) in scene()) {
        for law in Law::examples().into_iter().filter(|l| l.memory() > 0) {
            let motion = Relative::between(&a, &b);
            let rate = |z: [f64; 2]| {
                let mut rates = [0.0; 2];
                law.memory_rates(&motion, &mount, memory_of(&law, &z), &mut rates[..law.memory()]);
                rates
            };
            let h = 1e-9;
            for i in 0..law.memory() {
                let mut moved = z;
                moved[i] += h;
                let slope = (rate(moved)[i] - rate(z)[i]) / h;
                prop_assert!(slope < 1e-3 * law.memory_speed() && slope > -1.001 * law.memory_speed(), "{law:?} {slope}");
            }
        }
    }

    /// The tangent stiffness at the design position is the one with which preloads are shared out.
    #[test]
    fn nominal_stiffness_is_the_tangent_in_the_design_position(p_A in vector(0.8), p_B in vector(0.8), way in 0_usize..3) {
        for law in Law::examples() {
            let between = match &law {
                _ if law.check_ends(&Vec3::zeros()).is_ok() => Vec3::zeros(),
                Law::ShearSpring(_) => Vec3::new(0.0, 0.0, -0.6),
                _ => Vec3::new(0.3, 0.5, -0.6),
            };
            let mut mount = Mount::new(p_A, p_B, between);
            if matches!(law, Law::FrictionPlate(_)) {
                mount.preload = Vec3::new(0.0, 0.0, -1e5);
            }
            let (a, b) = (Pose::at(Vec3::zeros()), Pose::at(p_A + between - p_B));
            let force = |h: f64| {
                let mut moved = b;
                moved.r[way] += h;
                wrench(&law, &a, &moved, &mount, &REST).on_B.f
            };
            let h = 1e-6;
            let tangent = (force(h) - force(-h)) / (2.0 * h);
            let nominal = law.nominal_stiffness(&between);
            let carries = nominal.amax() > 0.0;
            if carries {
                prop_assert!((tangent + nominal.column(way)).norm() < 1e-4 * nominal.amax(), "{law:?} {tangent}");
            }
        }
    }
}

#[test]
fn every_kind_is_listed_sorted_and_has_an_example() {
    let mut kinds: Vec<&str> = Law::examples().iter().map(Law::kind).collect();
    kinds.dedup();
    assert_eq!(kinds, KINDS);
    assert!(KINDS.is_sorted());
    for law in Law::examples() {
        let written = serde_json::to_value(&law).unwrap();
        assert_eq!(written["kind"], law.kind());
        assert_eq!(serde_json::from_value::<Law>(written).unwrap(), law);
        assert!(law.memory() <= 2, "the suite gives two numbers");
    }
}

#[test]
fn a_bushing_in_its_design_position_gives_its_preload() {
    let preload = Vec3::new(100.0, -200.0, -5e4);
    let mount =
        Mount { preload, ..Mount::new(Vec3::new(1.0, 0.5, -0.2), Vec3::new(0.4, -0.1, 0.3), Vec3::zeros()) };
    let (a, b) = (Pose::at(Vec3::zeros()), Pose::at(mount.p_A - mount.p_B));
    for law in Law::examples().into_iter().filter(|l| matches!(l, Law::Bushing(_))) {
        assert!((wrench(&law, &a, &b, &mount, &REST).on_B.f - preload).norm() < 1e-9);
    }
}

/// Closed form: a vertical preload P whose ends are displaced sideways by y turns each body by P y / 2.
#[test]
fn a_displaced_preload_turns_both_bodies_by_half_its_couple() {
    let p = 1.0e5;
    let mount =
        Mount { preload: Vec3::new(0.0, 0.0, -p), ..Mount::new(Vec3::zeros(), Vec3::zeros(), Vec3::zeros()) };
    let law = Law::Bushing(Bushing::examples().remove(0));
    let y = 0.01;
    let (a, b) = (Pose::at(Vec3::zeros()), Pose::at(Vec3::new(0.0, y, 0.0)));
    let pair = wrench(&law, &a, &b, &mount, &REST);
    // A carries -(-P) = +P z at half the distance, so it rolls to the right: P y / 2; B the same.
    assert!((pair.on_A.m.x - 0.5 * p * y).abs() < 1e-9 * p);
    assert!((pair.on_B.m.x - 0.5 * p * y).abs() < 1e-9 * p);
}

#[test]
fn parameters_outside_their_range_are_refused_by_key() {
    use railsim::KeyPath;
    let at = KeyPath::of("vehicle.connection").index(3);
    let bushing = Bushing {
        stiffness: [1.0, -2.0, f64::NAN],
        damping: [0.0; 3],
        rotational_stiffness: None,
        rotational_damping: Some([0.0, 0.0, -1.0]),
    };
    let keys: Vec<String> = Law::Bushing(bushing).faults(&at).iter().map(|f| f.key.to_string()).collect();
    assert_eq!(
        keys,
        [
            "vehicle.connection[3].stiffness[1]",
            "vehicle.connection[3].stiffness[2]",
            "vehicle.connection[3].rotational_damping[2]"
        ]
    );
    let refused = |law: Value| -> Vec<String> {
        let law: Law = serde_json::from_value(law).unwrap();
        law.faults(&KeyPath::default()).iter().map(|f| f.key.to_string()).collect()
    };
    let falling = json!({ "x": [0.0, 1.0], "f": [0.0, -1.0] });
    let level = json!({ "x": [0.0, 1.0, 2.0], "f": [0.0, 1.0, 1.0] });
    let identity = |i: usize, j: usize, v: f64| {
        let mut rows = [[0.0; 6]; 6];
        rows[i][j] = v;
        json!(rows)
    };
    for (law, keys) in [
        (json!({ "kind": "point_spring" }), vec!["stiffness"]),
        (json!({ "kind": "point_spring", "stiffness": -1.0 }), vec!["stiffness"]),
        (json!({ "kind": "point_spring", "stiffness": 1.0, "table": level }), vec!["table"]),
        (json!({ "kind": "point_spring", "table": falling }), vec!["table.f[1]"]),
        (json!({ "kind": "point_spring", "stiffness": 1.0, "free_length": 0.0 }), vec!["free_length"]),
        (
            json!({ "kind": "point_spring", "stiffness": 1.0, "free_length": 0.5, "along": "z" }),
            vec!["free_length"],
        ),
        (json!({ "kind": "point_damper", "damping": -1.0 }), vec!["damping"]),
        (json!({ "kind": "maxwell", "stiffness": 0.0, "damping": 0.0 }), vec!["stiffness", "damping"]),
        (json!({ "kind": "maxwell", "stiffness": 1.0, "table": level }), vec!["table.f[2]"]),
        (
            json!({ "kind": "maxwell", "stiffness": 1.0, "table": { "x": [0.0, 1.0], "f": [0.0, 1.0], "interpolation": "pchip" } }),
            vec!["table.interpolation"],
        ),
        (
            json!({ "kind": "bump_stop", "clearance": -1.0, "cubic": -1.0, "stiffness": 1.0 }),
            vec!["clearance", "cubic"],
        ),
        (
            json!({ "kind": "bump_stop", "clearance": 0.0, "table": { "x": [-1.0, 0.0], "f": [-1.0, 0.0] } }),
            vec!["table.x[0]"],
        ),
        (json!({ "kind": "friction", "force": -1.0, "stiffness": 0.0 }), vec!["force", "stiffness"]),
        (
            json!({ "kind": "friction_plate", "coefficient": -0.1, "stiffness": 0.0, "normal_stiffness": -1.0, "load": -1.0 }),
            vec!["coefficient", "stiffness", "normal_stiffness", "load"],
        ),
        (json!({ "kind": "traction_rod", "stiffness": 1.0, "damping": -1.0 }), vec!["damping"]),
        (
            json!({ "kind": "coupler", "stiffness": 1.0, "slack": -1.0, "damping": -1.0 }),
            vec!["slack", "damping"],
        ),
        (
            json!({ "kind": "anti_roll_bar", "stiffness": -1.0, "damping": -1.0 }),
            vec!["stiffness", "damping"],
        ),
        (
            json!({ "kind": "shear_spring", "axial": -1.0, "shear": -1.0, "bending": -1.0, "torsion": -1.0, "damping": [0.0, -1.0, 0.0], "shear_centre": 2.0 }),
            vec!["axial", "shear", "bending", "torsion", "damping[1]", "shear_centre"],
        ),
        (json!({ "kind": "bushing_matrix", "stiffness": identity(0, 1, 1.0) }), vec!["stiffness[0][1]"]),
        (json!({ "kind": "bushing_matrix", "stiffness": identity(2, 2, -1.0) }), vec!["stiffness"]),
    ] {
        assert_eq!(refused(law.clone()), keys, "{law}");
    }
    assert!(Law::examples().iter().all(|l| l.faults(&at).is_empty()));
}

/// Closed form: B turned by a small angle about x against A is turned back with k times the angle, and its turning is
/// damped with c times the rate.
#[test]
fn a_turned_bushing_turns_back() {
    let law = Bushing::examples().remove(1);
    let mount = Mount::new(Vec3::zeros(), Vec3::zeros(), Vec3::zeros());
    let a = Pose::at(Vec3::zeros());
    let (angle, rate) = (1e-3, 0.2);
    let b = Pose {
        R: Rotation3::new(Vec3::new(angle, 0.0, 0.0)).into_inner(),
        w: Vec3::new(rate, 0.0, 0.0),
        ..a
    };
    let pair = wrench(&Law::Bushing(law), &a, &b, &mount, &REST);
    let expected = -(1.0e4 * angle + 1.0e2 * rate);
    assert!((pair.on_B.m.x - expected).abs() < 1e-5 * expected.abs(), "{} {expected}", pair.on_B.m.x);
    assert!((pair.on_A.m.x + expected).abs() < 1e-5 * expected.abs());
}
