//! Each kind of connection against a formula that nobody here made: textbooks of mechanics and vibration.
//!
//! Two bodies by hand: A stands still, B is moved as a formula asks.

#![allow(clippy::print_stdout)] // both numbers are shown, from helpers too

use railsim::connection::{Along, ForceLaw, Law, Mount, Pair, Pose, RELAXATION_TIME, Relative};
use railsim::integrator::{Integrator, Stepper, System};
use railsim::math::Vec3;
use railsim::math::rotation::{rot_x, rot_y};
use serde_json::{Value, json};

fn law(written: Value) -> Law {
    let law: Law = serde_json::from_value(written).unwrap();
    assert!(law.faults(&railsim::KeyPath::default()).is_empty(), "{law:?}");
    law
}

/// Force and moment on B about B's point, with A's point at the origin.
fn on_b(law: &Law, mount: &Mount, b: &Pose, memory: &[f64]) -> (Vec3, Vec3) {
    let motion = Relative::between(&Pose::at(Vec3::zeros()), b);
    let pair = Pair::new(&law.wrench(&motion, mount, memory), &motion, &nalgebra::Matrix3::identity());
    (pair.on_B.f, pair.on_B.m - (b.R * mount.p_B).cross(&pair.on_B.f))
}

fn ends(between: [f64; 3]) -> Mount {
    Mount::new(Vec3::zeros(), Vec3::zeros(), Vec3::from(between))
}

fn close(ours: f64, theirs: f64, relative: f64, what: &str) {
    println!("{what}: {ours:.6e}, closed form {theirs:.6e} ({:+.2e})", ours / theirs - 1.0);
    assert!((ours / theirs - 1.0).abs() < relative, "{what}: {ours} {theirs}");
}

/// One mass on one element: m x'' = force(t) - T.
struct Oscillator {
    law: Law,
    mount: Mount,
    mass: f64,
    force: fn(f64) -> f64,
}

impl Oscillator {
    fn pose(&self, x: &[f64]) -> Pose {
        Pose { v: Vec3::new(x[1], 0.0, 0.0), ..Pose::at(self.mount.between + Vec3::new(x[0], 0.0, 0.0)) }
    }

    fn run(&mut self, start: [f64; 2], integrator: &Integrator, end: f64, mut see: impl FnMut(f64, &[f64])) {
        let mut x = vec![0.0; self.size()];
        x[..2].copy_from_slice(&start);
        let mut stepper = Stepper::new(integrator, x.len(), &[]);
        let h = integrator.step();
        for i in 0..(end / h).round() as u64 {
            let _ = stepper.step(self, i as f64 * h, &mut x, h);
            see((i + 1) as f64 * h, &x);
        }
    }
}

impl System for Oscillator {
    fn size(&self) -> usize {
        2 + self.law.memory()
    }

    fn rhs(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        let pose = self.pose(x);
        let motion = Relative::between(&Pose::at(Vec3::zeros()), &pose);
        dx[0] = x[1];
        dx[1] = ((self.force)(t) + on_b(&self.law, &self.mount, &pose, &x[2..]).0.x) / self.mass;
        self.law.memory_rates(&motion, &self.mount, &x[2..], &mut dx[2..]);
    }
}

/// A spring of known free length pulls by Hooke; by table by its table.
#[test]
fn point_spring_hooke() {
    let mut mount = ends([0.5, 0.0, 0.0]);
    let spring = law(json!({ "kind": "point_spring", "stiffness": 2e5, "free_length": 0.45 }));
    spring.settle(&mut mount, None).unwrap();
    let (f, _) = on_b(&spring, &mount, &Pose::at(Vec3::new(0.3, 0.4, 0.3)), &[]);
    let length = 0.34_f64.sqrt();
    close(f.norm(), 2e5 * (length - 0.45), 1e-12, "tension");
    close(f.y / f.x, 4.0 / 3.0, 1e-12, "direction");
    // Solved: it carries 10 kN in the design position, so its free length is shorter by 10e3/2e5.
    spring.settle(&mut mount, Some(&Vec3::new(-1e4, 0.0, 0.0))).unwrap();
    close(mount.stretched, 0.05, 1e-12, "elongation under 10 kN");
    let table = json!({ "x": [0.0, 0.1, 0.2], "f": [0.0, 1e4, 4e4] });
    let progressive = law(json!({ "kind": "point_spring", "table": table }));
    progressive.settle(&mut mount, Some(&Vec3::new(2.5e4, 0.0, 0.0))).unwrap();
    close(mount.stretched, -0.15, 1e-12, "pressed by 25 kN on the second branch");
}

#[test]
fn point_damper_newton() {
    let damper =
        law(json!({ "kind": "point_damper", "table": { "x": [0.0, 0.1, 0.5], "f": [0.0, 8e3, 1.2e4] } }));
    let b = Pose { v: Vec3::new(0.3, 5.0, 0.0), ..Pose::at(Vec3::new(0.5, 0.0, 0.0)) };
    close(on_b(&damper, &ends([0.5, 0.0, 0.0]), &b, &[]).0.x, -1e4, 1e-12, "beyond blow-off");
}

/// Steady sine through a damper with end stiffness: complex stiffness k i w c/(k + i w c).
#[test]
fn maxwell_complex_stiffness() {
    let (k, c, amplitude) = (5e6_f64, 3e5_f64, 2e-3_f64);
    for frequency in [0.5_f64, 2.65, 10.0] {
        let w = 2.0 * std::f64::consts::PI * frequency;
        let element = law(json!({ "kind": "maxwell", "stiffness": k, "damping": c, "along": "x" }));
        let mount = ends([0.0; 3]);
        let (h, mut z, mut t) = (1e-5, 0.0_f64, 0.0_f64);
        let rate = |t: f64, z: f64| {
            let pose = Pose {
                v: Vec3::new(amplitude * w * (w * t).cos(), 0.0, 0.0),
                ..Pose::at(Vec3::new(amplitude * (w * t).sin(), 0.0, 0.0))
            };
            let mut rates = [0.0];
            element.memory_rates(
                &Relative::between(&Pose::at(Vec3::zeros()), &pose),
                &mount,
                &[z],
                &mut rates,
            );
            rates[0]
        };
        // Ten time constants c/k and a whole number of periods, then one period's Fourier coefficients.
        let period = (1.0 / frequency / h).round() as usize;
        let settle = period * (0.6 * frequency).ceil() as usize;
        let (mut sine, mut cosine) = (0.0, 0.0);
        for i in 0..settle + period {
            let k1 = rate(t, z);
            let k2 = rate(t + h, z + h * k1);
            if i >= settle {
                sine += 2.0 * k * z * (w * t).sin() / period as f64;
                cosine += 2.0 * k * z * (w * t).cos() / period as f64;
            }
            z += 0.5 * h * (k1 + k2);
            t += h;
        }
        let expected = c * w * amplitude / (1.0 + (w * c / k).powi(2)).sqrt();
        close(sine.hypot(cosine), expected, 1e-4, "amplitude of the tension");
        close(cosine.atan2(sine), (k / (c * w)).atan(), 1e-4, "lead of the tension");
    }
}

/// A blow-off damper in series under constant speed settles at its table's force.
#[test]
fn maxwell_settles_at_the_dampers_force() {
    let table = json!({ "x": [0.0, 0.02, 0.2], "f": [0.0, 8e3, 1.2e4] });
    let element = law(json!({ "kind": "maxwell", "stiffness": 8e6, "table": table, "along": "x" }));
    let b = Pose { v: Vec3::new(0.11, 0.0, 0.0), ..Pose::at(Vec3::zeros()) };
    let motion = Relative::between(&Pose::at(Vec3::zeros()), &b);
    let (mut z, mut rates) = ([0.0], [0.0]);
    for _ in 0..200_000 {
        element.memory_rates(&motion, &ends([0.0; 3]), &z, &mut rates);
        z[0] += 1e-6 * rates[0];
    }
    close(8e6 * z[0], 1e4, 1e-9, "force at 0.11 m/s");
}

#[test]
fn bump_stop_force_and_work() {
    let stop = law(json!({ "kind": "bump_stop", "clearance": 0.02, "stiffness": 2e5, "cubic": 1e9 }));
    let mount = ends([0.0, 0.0, -0.3]);
    let at = |z: f64| Pose::at(Vec3::new(0.0, 0.0, z));
    assert_eq!(on_b(&stop, &mount, &at(-0.281), &[]).0.norm(), 0.0, "within the clearance");
    assert_eq!(on_b(&stop, &mount, &at(-0.4), &[]).0.norm(), 0.0, "pulled apart");
    let (f, _) = on_b(&stop, &mount, &at(-0.25), &[]);
    close(f.z, -(2e5 * 0.03 + 1e9 * 0.03_f64.powi(3)), 1e-9, "force 30 mm deep");
    let energy = stop.energy(&Relative::between(&Pose::at(Vec3::zeros()), &at(-0.25)), &mount, &[]);
    close(energy, 0.5 * 2e5 * 0.03_f64.powi(2) + 0.25 * 1e9 * 0.03_f64.powi(4), 1e-9, "work 30 mm deep");
}

/// Coulomb: a mass on a spring and a slider loses 4 F/k of amplitude in each period and stops where k x < F
/// (Den Hartog, Mechanical Vibrations: under dry friction amplitudes fall on a straight line).
#[test]
fn friction_decay_of_a_coulomb_damped_oscillator() {
    let (m, k, f) = (1000.0_f64, 4e4_f64, 200.0);
    struct Pair {
        oscillator: Oscillator,
        k: f64,
    }
    impl System for Pair {
        fn size(&self) -> usize {
            self.oscillator.size()
        }
        fn rhs(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
            self.oscillator.rhs(t, x, dx);
            dx[1] -= self.k * x[0] / self.oscillator.mass;
        }
    }
    // Stick stiffness a hundred times the spring's: gives way by 0.05 mm.
    let friction = law(json!({ "kind": "friction", "force": f, "stiffness": 4e6, "along": "x" }));
    let mut system =
        Pair { oscillator: Oscillator { law: friction, mount: ends([0.0; 3]), mass: m, force: |_| 0.0 }, k };
    let mut x = [0.1, 0.0, 0.0];
    let mut stepper = Stepper::new(&Integrator::Heun { step: 4e-4 }, 3, &[]);
    let (mut peaks, mut before) = (vec![0.1], -1.0);
    for i in 0..12_500 {
        let _ = stepper.step(&mut system, f64::from(i) * 4e-4, &mut x, 4e-4);
        if before > 0.0 && x[1] <= 0.0 && x[0] > 0.02 {
            peaks.push(x[0]);
        }
        before = x[1];
    }
    println!("peaks: {peaks:?}");
    for pair in peaks.windows(2) {
        // Less by the stick travel (2 F/k_stick at each of two reversals) and the relaxation time.
        close(pair[0] - pair[1], 4.0 * f / k, 0.02, "loss of amplitude in a period");
    }
    assert!(peaks.len() >= 4);
}

/// The work of a slow cycle of amplitude X is that of the elasto-plastic slider, 4 F (X - F/k).
#[test]
fn friction_work_of_a_cycle() {
    let (f, k, amplitude) = (8e3_f64, 4e6_f64, 0.01_f64);
    let friction = law(json!({ "kind": "friction", "force": f, "stiffness": k, "along": "x" }));
    let w = 2.0 * std::f64::consts::PI;
    let h = 1e-4;
    let (mut z, mut work) = ([0.0], 0.0);
    for i in 0..30_000 {
        let t = f64::from(i) * h;
        let v = amplitude * w * (w * (t + 0.5 * h)).cos();
        let b = Pose { v: Vec3::new(v, 0.0, 0.0), ..Pose::at(Vec3::zeros()) };
        let motion = Relative::between(&Pose::at(Vec3::zeros()), &b);
        let (mut k1, mut k2) = ([0.0], [0.0]);
        friction.memory_rates(&motion, &ends([0.0; 3]), &z, &mut k1);
        friction.memory_rates(&motion, &ends([0.0; 3]), &[z[0] + h * k1[0]], &mut k2);
        z[0] += 0.5 * h * (k1[0] + k2[0]);
        if i >= 20_000 {
            work -= on_b(&friction, &ends([0.0; 3]), &b, &z).0.x * v * h;
        }
    }
    close(work, 4.0 * f * (amplitude - f / k), 2e-3, "work of a cycle of 10 mm at 1 Hz");
}

/// No drift at rest: 0.9 of the friction force pushes for 60 s while the mass trembles. It stands where the spring of the
/// slider holds it, to rounding.
#[test]
fn friction_holds_for_60_s() {
    for kind in ["friction", "friction_plate"] {
        let written = if kind == "friction" {
            json!({ "kind": kind, "force": 1e4, "stiffness": 5e6, "along": "x" })
        } else {
            json!({ "kind": kind, "coefficient": 0.25, "load": 4e4, "stiffness": 5e6 })
        };
        let pushes = |t: f64| 8.5e3 + 2.5e2 * (2.0 * std::f64::consts::PI * 11.0 * t).sin();
        let mut system = Oscillator { law: law(written), mount: ends([0.0; 3]), mass: 500.0, force: pushes };
        let period = 1.0 / 11.0;
        let (mut first, mut last, mut counts) = (0.0, 0.0, [0.0, 0.0]);
        // Starts where 8.5 kN hold it: any slip or creep afterwards would be seen, at 1e-9 m of 1.7 mm.
        let mut x = vec![0.0; system.size()];
        x[0] = 8.5e3 / 5e6;
        x[2] = 8.5e3 / 5e6;
        let h = 4e-4;
        let mut stepper = Stepper::new(&Integrator::Heun { step: h }, x.len(), &[]);
        for i in 0..150_000_u32 {
            let t = f64::from(i) * h;
            let _ = stepper.step(&mut system, t, &mut x, h);
            if t < 5.0 * period {
                first += x[0];
                counts[0] += 1.0;
            }
            if t > 60.0 - 5.0 * period {
                last += x[0];
                counts[1] += 1.0;
            }
            // The memory is the displacement itself as long as nothing slides.
            assert!((x[0] - x[2]).abs() < 1e-12, "{kind} slid at {t} s: {x:?}");
        }
        let drift = last / counts[1] - first / counts[0];
        println!("{kind}: drift of the mean over 60 s: {drift:.2e} m of {:.2e} m", x[0]);
        // Both means hold some 7 periods of the free vibration, 0.1 mm: 2e-6 m each of an incomplete one.
        assert!(drift.abs() < 5e-6, "{drift}");
    }
}

/// Sliding in a plane: force of size mu N against the direction of sliding, whatever that is; and turning round.
#[test]
fn friction_plate_opposes_sliding() {
    let plate = law(json!({ "kind": "friction_plate", "coefficient": 0.3, "load": 5e4, "stiffness": 5e6 }));
    let mut z = [0.0, 0.0];
    for angle in [0.3_f64, 2.0, 4.4] {
        let v = 0.05 * Vec3::new(angle.cos(), angle.sin(), 0.0);
        let b = Pose { v, ..Pose::at(Vec3::zeros()) };
        let motion = Relative::between(&Pose::at(Vec3::zeros()), &b);
        for _ in 0..120_000 {
            let mut rates = [0.0; 2];
            plate.memory_rates(&motion, &ends([0.0; 3]), &z, &mut rates);
            z = [z[0] + 1e-5 * rates[0], z[1] + 1e-5 * rates[1]];
        }
        let (f, _) = on_b(&plate, &ends([0.0; 3]), &b, &z);
        close(f.norm(), 0.3 * 5e4, 1e-12, "friction force");
        close(-f.dot(&v) / (f.norm() * v.norm()), 1.0, 1e-6, "against the sliding");
        let over = z[0].hypot(z[1]) - 0.3 * 5e4 / 5e6;
        close(over, 0.05 * RELAXATION_TIME, 1e-6, "the slider runs ahead by tau v");
    }
}

/// The friction of a carrying plate follows its load.
#[test]
fn friction_plate_under_its_spring() {
    let written =
        json!({ "kind": "friction_plate", "coefficient": 0.2, "stiffness": 5e6, "normal_stiffness": 2e6 });
    let plate = law(written);
    let mut mount = ends([0.0; 3]);
    plate.settle(&mut mount, Some(&Vec3::new(0.0, 0.0, -3e4))).unwrap();
    // B (above) 10 mm lower: 20 kN more; far slid along x.
    let (f, _) = on_b(&plate, &mount, &Pose::at(Vec3::new(0.0, 0.0, 0.01)), &[0.01, 0.0]);
    close(f.x, -0.2 * 5e4, 1e-12, "friction under 50 kN");
    let (f, _) = on_b(&plate, &mount, &Pose::at(Vec3::new(0.0, 0.0, -0.02)), &[0.01, 0.0]);
    assert_eq!(f, Vec3::zeros(), "lifted off");
}

/// A uniform cantilever (Euler and Bernoulli): tip force F bends it by F h^3/(3 E I) and turns its tip by F h^2/(2 E I);
/// a tip moment M by M h^2/(2 E I) and M h/(E I).
#[test]
fn shear_spring_cantilever() {
    let (ei, h) = (2.0e4_f64, 0.5_f64);
    let beam = law(json!({
        "kind": "shear_spring", "axial": 1e6, "shear": 12.0 * ei / h.powi(3), "bending": ei / h
    }));
    let mount = ends([0.0, 0.0, -h]);
    // Compliance by solving for tip displacement and tip rotation about y under given loads.
    let load = |x: f64, theta: f64| {
        let b = Pose { R: rot_y(theta), ..Pose::at(Vec3::new(x, 0.0, -h)) };
        let (f, m) = on_b(&beam, &mount, &b, &[]);
        (-f.x, -m.y)
    };
    let e = 1e-7;
    let (fx, mx) = load(e, 0.0);
    let (ft, mt) = load(0.0, e);
    let k = nalgebra::Matrix2::new(fx / e, ft / e, mx / e, mt / e);
    close(k[(0, 1)], k[(1, 0)], 1e-6, "symmetry");
    let c = k.try_inverse().unwrap();
    close(c[(0, 0)], h.powi(3) / (3.0 * ei), 1e-6, "deflection by a tip force");
    close(c[(1, 1)], h / ei, 1e-6, "rotation by a tip moment");
    // Positive pitch lifts the nose: with the tip above, +x and -pitch go together.
    close(c[(1, 0)].abs(), h.powi(2) / (2.0 * ei), 1e-6, "rotation by a tip force");
}

/// The same cantilever as a full matrix about its middle, given row by row.
#[test]
fn bushing_matrix_gives_its_rows() {
    let mut rows = [[0.0; 6]; 6];
    rows[0][0] = 2e5;
    rows[0][4] = 3e4;
    rows[4][0] = 3e4;
    rows[4][4] = 9e3;
    rows[3][3] = 4e3;
    let bushing = law(json!({ "kind": "bushing_matrix", "stiffness": rows }));
    let (x, theta) = (1e-6, 2e-6);
    let b = Pose { R: rot_y(theta), ..Pose::at(Vec3::new(x, 0.0, 0.0)) };
    let (f, m) = on_b(&bushing, &ends([0.0; 3]), &b, &[]);
    close(f.x, -(2e5 * x + 3e4 * theta), 1e-5, "force");
    close(m.y, -(3e4 * x + 9e3 * theta), 1e-5, "moment");
}

#[test]
fn anti_roll_bar_moment() {
    let bar = law(json!({ "kind": "anti_roll_bar", "stiffness": 9.4e5, "damping": 2e3 }));
    let b = Pose { R: rot_x(0.01), w: Vec3::new(0.2, 0.0, 0.0), ..Pose::at(Vec3::zeros()) };
    let (f, m) = on_b(&bar, &ends([0.0; 3]), &b, &[]);
    assert_eq!(f, Vec3::zeros());
    close(m.x, -(9.4e5 * 0.01 + 2e3 * 0.2), 1e-4, "moment (sine for angle)");
    let pitched = Pose { R: rot_y(0.02), ..Pose::at(Vec3::zeros()) };
    assert!(on_b(&bar, &ends([0.0; 3]), &pitched, &[]).1.norm() < 1e-9, "pitch is free");
}

/// A swing link under the weight W of length L pushes back sideways with W/L: the pendulum.
#[test]
fn traction_rod_pendulum() {
    let (weight, length) = (5e4, 0.6);
    let rod = law(json!({ "kind": "traction_rod", "stiffness": 1e9 }));
    // A above, B hangs below it.
    let mut mount = ends([0.0, 0.0, length]);
    rod.settle(&mut mount, Some(&Vec3::new(0.0, 0.0, -weight))).unwrap();
    let y = 1e-4;
    let (f, _) = on_b(&rod, &mount, &Pose::at(Vec3::new(0.0, y, length)), &[]);
    close(f.z, -weight, 2e-4, "carried"); // and its elongation by y^2/(2 L), 8 N
    close(-f.y / y, weight / length, 2e-4, "pendulum stiffness W/L");
}

#[test]
fn coupler_slack_and_draft_gear() {
    let gear = json!({ "x": [-0.05, 0.0, 0.06], "f": [-3e5, 0.0, 4e5] });
    let coupler = law(json!({ "kind": "coupler", "slack": 0.03, "table": gear }));
    let mount = ends([1.0, 0.0, 0.0]);
    let pull = |x: f64| -on_b(&coupler, &mount, &Pose::at(Vec3::new(1.0 + x, 0.0, 0.0)), &[]).0.x;
    assert_eq!((pull(0.0149), pull(-0.0149)), (0.0, 0.0));
    close(pull(0.045), 4e5 * 0.03 / 0.06, 1e-9, "pulled 30 mm beyond the slack");
    close(pull(-0.040), -3e5 * 0.025 / 0.05, 1e-9, "pushed 25 mm beyond the slack");
}

/// Heun at 0.4 ms, RK4 and ros2 at 1 ms through stick, slip and reversal of a light mass: bounded, and the limit is kept.
#[test]
fn friction_is_stable_with_every_scheme() {
    for integrator in
        [Integrator::Heun { step: 4e-4 }, Integrator::Rk4 { step: 1e-3 }, Integrator::Ros2 { step: 1e-3 }]
    {
        let pushes = |t: f64| 1.5e4 * (2.0 * std::f64::consts::PI * 2.0 * t).sin();
        let friction = law(json!({ "kind": "friction", "force": 1e4, "stiffness": 5e6, "along": "x" }));
        let mut system = Oscillator { law: friction, mount: ends([0.0; 3]), mass: 500.0, force: pushes };
        let (mut fastest, mut furthest) = (0.0_f64, 0.0_f64);
        system.run([0.0, 0.0], &integrator, 5.0, |_, x| {
            fastest = fastest.max(x[1].abs());
            furthest = furthest.max(x[2].abs());
        });
        println!("{}: fastest {fastest:.3} m/s, slider {furthest:.5} m", integrator.name());
        // Coulomb slip from rest under 15 kN sin - 10 kN within a half period: at most 5 kN/500 kg for the 0.134 s of slip.
        assert!(fastest < 1.4 && furthest < 0.002 + 1.1 * RELAXATION_TIME * fastest);
    }
}

#[test]
fn elements_along_an_axis_count_apart_as_longer() {
    let spring = law(json!({ "kind": "point_spring", "stiffness": 1e5, "along": "z" }));
    // B above A (z down): B moving up lengthens the spring, which pulls it down.
    let (f, _) = on_b(&spring, &ends([0.2, 0.0, -0.5]), &Pose::at(Vec3::new(0.3, 0.1, -0.51)), &[]);
    assert!((f - Vec3::new(0.0, 0.0, 1e3)).norm() < 1e-9, "{f}");
    assert_eq!(Along::Z.direction(&Vec3::new(0.2, 0.0, -0.5)), Vec3::new(0.0, 0.0, -1.0));
}
