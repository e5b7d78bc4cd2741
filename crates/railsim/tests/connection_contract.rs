//! The contract of every connection: balance, energy, dissipation, mirror, preload. Run over every arm of `Law`.

use nalgebra::Rotation3;
use proptest::prelude::*;
use railsim::connection::{ForceLaw, Law, Mount, Pair, Pose, Relative};
use railsim::math::{Mat3, Vec3};

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
    (vector(0.8), vector(0.8), vector(1e5)).prop_map(|(p_A, p_B, preload)| Mount { p_A, p_B, preload })
}

/// Two bodies some 0.5 m apart in a general direction: no zeros, no coincident ends.
fn scene() -> impl Strategy<Value = (Pose, Pose, Mount)> {
    (pose(Vec3::new(0.1, 0.2, -0.3)), pose(Vec3::new(1.9, 1.5, -1.6)), mount())
}

fn wrench(law: &Law, a: &Pose, b: &Pose, mount: &Mount) -> Pair {
    let motion = Relative::between(a, b);
    Pair::new(&law.wrench(&motion, mount), &motion, &a.R)
}

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
    fn forces_and_moments_of_the_two_ends_balance((a, b, mount) in scene()) {
        for law in Law::examples() {
            let pair = wrench(&law, &a, &b, &mount);
            let force = pair.on_A.f + pair.on_B.f;
            let moment = pair.on_A.m + a.r.cross(&pair.on_A.f) + pair.on_B.m + b.r.cross(&pair.on_B.f);
            let size = pair.on_A.f.norm() + 1.0;
            prop_assert!(force.norm() < 1e-12 * size, "{law:?}: force {force}");
            prop_assert!(moment.norm() < 1e-11 * size, "{law:?}: moment {moment}");
        }
    }

    #[test]
    fn power_put_in_is_stored_or_dissipated((a, b, mount) in scene()) {
        for law in Law::examples() {
            let h = 1e-6;
            let before = law.energy(&Relative::between(&advance(&a, -h), &advance(&b, -h)), &mount);
            let after = law.energy(&Relative::between(&advance(&a, h), &advance(&b, h)), &mount);
            let stored = (after - before) / (2.0 * h);
            let lost = law.dissipation(&Relative::between(&a, &b), &mount);
            let put_in = -power(&wrench(&law, &a, &b, &mount), &a, &b);
            let size = put_in.abs() + stored.abs() + lost.abs() + 1.0;
            // Central difference of energies of up to 1e7 J: rounding 1e7 * 1e-16 / 1e-6. Rotational terms of a bushing
            // use the antisymmetric part of the rotation: off by the relative turn, up to 0.7 rad here, times its moment
            // K turn (3e4 N m/rad) times the turning rate (1.7 rad/s). Their sign has a test of its own below.
            let turn = Relative::between(&a, &b);
            let angle = Rotation3::from_matrix(&turn.R_AB).angle();
            let slack = match &law {
                Law::Bushing(l) if l.rotational_stiffness.is_some() => 3e4 * angle * angle * turn.w_AB.norm(),
                _ => 0.0,
            };
            prop_assert!((stored + lost - put_in).abs() < 1e-5 * size + slack, "{law:?}: {stored} + {lost} != {put_in}");
        }
    }

    #[test]
    fn dissipation_is_never_negative((a, b, mount) in scene()) {
        for law in Law::examples() {
            prop_assert!(law.dissipation(&Relative::between(&a, &b), &mount) >= 0.0);
        }
    }

    #[test]
    fn mirrored_motion_gives_mirrored_force((a, b, mount) in scene()) {
        let m = Mat3::from_diagonal(&Vec3::new(1.0, -1.0, 1.0));
        for law in Law::examples() {
            // A line spring reads its preload as a tension, which has no side.
            let preload = if matches!(law, Law::Bushing(_)) { m * mount.preload } else { mount.preload };
            let mirrored = Mount { p_A: m * mount.p_A, p_B: m * mount.p_B, preload };
            let one = wrench(&law, &a, &b, &mount);
            let other = wrench(&law, &mirror(&a), &mirror(&b), &mirrored);
            prop_assert!((m * one.on_B.f - other.on_B.f).norm() < 1e-9 * (1.0 + one.on_B.f.norm()));
            prop_assert!((m * one.on_B.m + other.on_B.m).norm() < 1e-9 * (1.0 + one.on_B.m.norm()));
        }
    }
}

#[test]
fn a_bushing_in_its_design_position_gives_its_preload() {
    let preload = Vec3::new(100.0, -200.0, -5e4);
    let mount = Mount { p_A: Vec3::new(1.0, 0.5, -0.2), p_B: Vec3::new(0.4, -0.1, 0.3), preload };
    let (a, b) = (Pose::at(Vec3::zeros()), Pose::at(mount.p_A - mount.p_B));
    for law in Law::examples().into_iter().filter(|l| matches!(l, Law::Bushing(_))) {
        assert!((wrench(&law, &a, &b, &mount).on_B.f - preload).norm() < 1e-9);
    }
}

/// Closed form: a vertical preload P whose ends are displaced sideways by y turns each body by P y / 2.
#[test]
fn a_displaced_preload_turns_both_bodies_by_half_its_couple() {
    let p = 1.0e5;
    let mount = Mount { p_A: Vec3::zeros(), p_B: Vec3::zeros(), preload: Vec3::new(0.0, 0.0, -p) };
    let law = Law::examples().remove(0);
    let y = 0.01;
    let (a, b) = (Pose::at(Vec3::zeros()), Pose::at(Vec3::new(0.0, y, 0.0)));
    let pair = wrench(&law, &a, &b, &mount);
    // A carries -(-P) = +P z at half the distance, so it rolls to the right: P y / 2; B the same.
    assert!((pair.on_A.m.x - 0.5 * p * y).abs() < 1e-9 * p);
    assert!((pair.on_B.m.x - 0.5 * p * y).abs() < 1e-9 * p);
}

#[test]
fn parameters_outside_their_range_are_refused_by_key() {
    use railsim::KeyPath;
    use railsim::connection::{Bushing, PointDamper, PointSpring};
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
    let damper = Law::PointDamper(PointDamper { damping: -1.0 });
    assert_eq!(damper.faults(&at)[0].key.to_string(), "vehicle.connection[3].damping");
    let spring = Law::PointSpring(PointSpring { stiffness: 1.0, length: 0.0 });
    assert_eq!(spring.faults(&at)[0].key.to_string(), "vehicle.connection[3].length");
    assert!(Law::examples().iter().all(|l| l.faults(&at).is_empty()));
}

/// Closed form: B turned by a small angle about x against A is turned back with k times the angle, and its turning is
/// damped with c times the rate.
#[test]
fn a_turned_bushing_turns_back() {
    let Some(Law::Bushing(law)) = Law::examples().into_iter().nth(1) else {
        panic!("the example with rotation")
    };
    let mount = Mount { p_A: Vec3::zeros(), p_B: Vec3::zeros(), preload: Vec3::zeros() };
    let a = Pose::at(Vec3::zeros());
    let (angle, rate) = (1e-3, 0.2);
    let b = Pose {
        R: Rotation3::new(Vec3::new(angle, 0.0, 0.0)).into_inner(),
        w: Vec3::new(rate, 0.0, 0.0),
        ..a
    };
    let pair = wrench(&Law::Bushing(law), &a, &b, &mount);
    let expected = -(1.0e4 * angle + 1.0e2 * rate);
    assert!((pair.on_B.m.x - expected).abs() < 1e-5 * expected.abs(), "{} {expected}", pair.on_B.m.x);
    assert!((pair.on_A.m.x + expected).abs() < 1e-5 * expected.abs());
}
