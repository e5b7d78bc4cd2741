//! Longitudinal train dynamics against momentum, energy and hand formulas.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use railsim::KeyPath;
use railsim::equipment::effort::davis;
use railsim::equipment::train::{Mass, OnMass, WAGON, Wagons};
use railsim::integrator::{Integrator, Stepper, System};
use railsim::schema::drive::Train;
use railsim::track::{Layout, Segment};
use serde_json::{Value, json};

const G: f64 = 9.80665;

/// A leading mass with a train behind it; `hauls` is what pulls the leading mass forward.
struct Line {
    wagons: Wagons,
    layout: Layout,
    lead: f64,
    hauls: f64,
    drawbar: f64,
    /// Share of the wagons' brake force.
    brake: f64,
    /// Effort of each mass, N.
    efforts: Vec<f64>,
}

impl System for Line {
    fn size(&self) -> usize {
        2 + self.wagons.states()
    }

    fn rhs(&mut self, _t: f64, x: &[f64], dx: &mut [f64]) {
        let leads = [[x[0], x[1]]; 2];
        let on = |i: usize| OnMass { brake: self.brake, effort: self.efforts.get(i).copied().unwrap_or(0.0) };
        let [front, pull] = self.wagons.rates(&self.layout, leads, on, &x[2..], &mut dx[2..]);
        self.drawbar = pull;
        dx[0] = x[1];
        dx[1] = (self.hauls + front - pull) / self.lead - G * self.layout.gradient(x[0]).sin();
    }
}

impl Line {
    fn new(train: Value, segments: &Value) -> Self {
        let written: Train = serde_json::from_value(train).unwrap();
        let segments: Vec<Segment> = serde_json::from_value(segments.clone()).unwrap();
        let length = segments.iter().map(Segment::length).sum();
        let layout = Layout::new(&segments, length, &KeyPath::of("track.layout")).unwrap();
        let wagons = Wagons::new(written, G);
        Self { wagons, layout, lead: 134e3, hauls: 0.0, drawbar: 0.0, brake: 0.0, efforts: Vec::new() }
    }

    /// Everything at `speed`, drawn out behind the leading mass at `place`.
    fn start(&self, place: f64, speed: f64) -> Vec<f64> {
        let mut x = vec![0.0; self.size()];
        (x[0], x[1]) = (place, speed);
        self.wagons.place([place; 2], speed, &mut x[2..]);
        x
    }

    fn run(&mut self, x: &mut [f64], time: f64) {
        let h = 1e-3;
        let mut stepper = Stepper::new(&Integrator::Rk4 { step: h }, x.len(), &[]);
        for k in 0..(time / h).round() as usize {
            let _ = stepper.step(self, k as f64 * h, x, h);
        }
    }

    fn energy(&self, x: &[f64]) -> f64 {
        let height = -self.layout.frame(x[0]).r_IT.z;
        0.5 * self.lead * x[1] * x[1]
            + self.lead * G * height
            + self.wagons.energy(&self.layout, [[x[0], x[1]]; 2], &x[2..])
    }

    fn momentum(&self, x: &[f64]) -> f64 {
        let own = |(w, m): (&[f64], &Mass)| (m.mass + m.rotary_mass) * w[1];
        self.lead * x[1] + x[2..].chunks_exact(WAGON).zip(&self.wagons.masses).map(own).sum::<f64>()
    }
}

fn level(length: f64) -> Value {
    json!([{ "kind": "tangent", "length": length }])
}

/// Conservation of energy: nothing is lost in draft gear without friction and damping.
#[test]
fn a_train_that_coasts_over_a_hump_keeps_its_energy() {
    let hump = json!([
        { "kind": "tangent", "length": 500.0 },
        { "kind": "clothoid", "length": 200.0 }, { "kind": "tangent", "length": 100.0, "gradient": 0.02 },
        { "kind": "clothoid", "length": 400.0 }, { "kind": "tangent", "length": 100.0, "gradient": -0.02 },
        { "kind": "clothoid", "length": 200.0 }, { "kind": "tangent", "length": 1500.0 }
    ]);
    let gear = json!({ "stiffness": 1e7, "friction": 0.0, "damping": 0.0 });
    let train = json!({ "wagons": 20, "mass": 80e3, "length": 15.0, "resistance": false, "coupler": gear });
    let mut line = Line::new(train, &hump);
    let mut x = line.start(450.0, 15.0);
    let (before, speed) = (line.energy(&x), x[1]);
    line.run(&mut x, 40.0);
    let top = line.energy(&x);
    println!("at the top: v {:.3} m/s, energy {:+.2e} of {before:.4e} J", x[1], top - before);
    assert!(x[1] < 0.97 * speed, "{}", x[1]);
    assert!((top - before).abs() < 1e-6 * before);
    line.run(&mut x, 60.0);
    assert!((line.energy(&x) - before).abs() < 1e-6 * before);
}

/// Drawbar force of a train at constant speed on a gradient: weight along it and running resistance (modified Davis).
#[test]
fn steady_drawbar_force_is_weight_and_resistance() {
    let train = json!({ "wagons": 10, "mass": 90e3, "length": 15.0, "coupler": { "stiffness": 1e7, "damping": 1e6 } });
    let grade: f64 = 1.0 / 60.0;
    let mut line = Line::new(train, &json!([{ "kind": "tangent", "length": 5000.0, "gradient": grade }]));
    let mut x = line.start(1000.0, 10.0);
    // What makes the whole of it keep its speed, by hand; the leading mass has no resistance of its own here.
    let slope = grade.atan().sin();
    let by_hand = 10.0 * (90e3 * G * slope + davis(90e3, 1.0, 10.0));
    line.hauls = by_hand + line.lead * G * slope;
    line.run(&mut x, 60.0);
    println!("drawbar {:.1} N, by hand {by_hand:.1} N, v {:.5} m/s", line.drawbar, x[1]);
    assert!((line.drawbar - by_hand).abs() < 1e-3 * by_hand);
    assert!((x[1] - 10.0).abs() < 0.05);
}

/// Run-in of a train with slack: the leading mass runs into a standing train; what is left is the common speed p/m.
#[test]
fn a_run_in_keeps_momentum_and_ends_at_the_common_speed() {
    let gear = json!({ "slack": 0.05, "stiffness": 1e7, "friction": 0.5, "damping": 2e5, "travel": 0.08 });
    let train = json!({ "wagons": 8, "mass": 60e3, "rotary_mass": 2e3, "length": 12.0, "resistance": false, "coupler": gear });
    let mut line = Line::new(train, &level(5000.0));
    let mut x = line.start(2000.0, 0.0);
    x[1] = -1.0;
    let before = line.momentum(&x);
    let mut least = f64::INFINITY;
    for _ in 0..600 {
        line.run(&mut x, 0.1);
        least = least.min(line.drawbar);
    }
    let common = before / (line.lead + 8.0 * 62e3);
    println!(
        "largest push {:.0} kN, speeds {:.5} .. {:.5}, common {common:.5} m/s",
        -least / 1e3,
        x[1],
        x[x.len() - WAGON + 1]
    );
    assert!((line.momentum(&x) - before).abs() < 1e-9 * before.abs());
    let spread = x[2..].chunks_exact(WAGON).map(|w| (w[1] - common).abs()).fold(0.0, f64::max);
    assert!(spread < 0.05 * common.abs(), "{spread}");
}

/// Several locomotives: the train accelerates as one mass with all efforts, and each coupling carries what the masses beyond it need.
#[test]
fn efforts_along_the_train_add_up_and_share_the_coupling_forces() {
    let train = json!({
        "wagons": 10, "ahead": 3, "mass": 60e3, "length": 15.0, "resistance": false,
        "coupler": { "stiffness": 1e7, "damping": 1e6 },
        "locomotives": [{ "at": 1, "mass": 120e3, "rotary_mass": 20e3 }, { "at": 7, "mass": 120e3 }]
    });
    let mut line = Line::new(train, &level(5000.0));
    line.efforts = vec![0.0; 10];
    (line.efforts[0], line.efforts[6], line.hauls) = (200e3, 150e3, 100e3);
    let mut x = line.start(1000.0, 5.0);
    line.run(&mut x, 40.0);
    let mut dx = vec![0.0; x.len()];
    line.rhs(0.0, &x, &mut dx);
    let whole = line.lead + 140e3 + 120e3 + 8.0 * 60e3;
    let a = 450e3 / whole;
    // Ahead of the leading mass 260 t want `a` and get 200 kN from their own locomotive; behind it 480 t less 150 kN.
    let (front, rear) = (200e3 - 260e3 * a, (6.0 * 60e3 + 120e3) * a - 150e3);
    let leads = [[x[0], x[1]]; 2];
    let found = [2, 3].map(|i| line.wagons.force(leads, &x[2..], i));
    println!(
        "a {:.5} by hand {a:.5} m/s2; front {:.0} by hand {front:.0} N, rear {:.0} by hand {rear:.0} N",
        dx[1], found[0], found[1]
    );
    assert!((dx[1] - a).abs() < 1e-4 * a);
    assert!((found[0] - front).abs() < 1e-3 * front && (found[1] - rear).abs() < 1e-3 * rear);
}

/// A braked train stands on a gradient: what holds it is friction, not a slow slide. One wagon's blocks carry its weight along it.
#[test]
fn a_hundred_braked_wagons_hold_on_a_gradient_up_to_their_friction() {
    let slope = 1.0 / 40.0;
    let need = 80e3 * G * f64::atan(slope).sin();
    for (force, wagons, holds) in [(1.2 * need, 100, true), (0.97 * need, 10, false)] {
        let train = json!({
            "wagons": wagons, "mass": 80e3, "length": 15.0, "resistance": false, "brake_force": force
        });
        let mut line = Line::new(train, &json!([{ "kind": "tangent", "length": 9000.0, "gradient": slope }]));
        line.brake = 1.0;
        line.hauls = 134e3 * need / 80e3;
        let mut x = line.start(5000.0, 0.0);
        line.run(&mut x, 8.0);
        let before: Vec<f64> = x[2..].iter().step_by(WAGON).copied().collect();
        line.run(&mut x, 8.0);
        let after = x[2..].iter().step_by(WAGON);
        let crept = after.zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!("blocks {force:.0} of {need:.0} N: {crept:.2e} m in 8 s");
        assert!(if holds { crept < 1e-5 } else { crept > 0.3 }, "{force}: {crept}");
    }
}

/// From the driver's valve, in the middle of the vehicle, to the middle of each mass: half the vehicle, whole masses and half of one, and the
/// slack of the couplings between, drawn to the middle of it. Ahead and behind alike.
#[test]
fn the_brake_pipe_is_as_long_ahead_of_the_vehicle_as_behind() {
    let gear = json!({ "slack": 0.1 });
    let train = json!({ "wagons": 5, "ahead": 3, "mass": 60e3, "length": 15.0, "coupler": gear });
    let line = Line::new(train, &level(5000.0));
    let by_hand = [11.0 + 2.5 * 15.0 + 0.15, 11.0 + 1.5 * 15.0 + 0.1, 11.0 + 7.5 + 0.05, 18.55, 33.6];
    for (i, length) in by_hand.into_iter().enumerate() {
        let found = line.wagons.pipe_length(22.0, i);
        assert!((found - length).abs() < 1e-12, "{i}: {found} {length}");
    }
}

/// A closed cycle of draft gear loses what its friction takes: `4 friction x mean force x travel` of a slow triangle.
#[test]
fn draft_gear_has_the_hysteresis_that_is_written() {
    use railsim::equipment::train::draft_force;
    use railsim::schema::drive::DraftGear;
    let gear = DraftGear { stiffness: 1e7, friction: 0.4, damping: 0.0, slack: 0.02, ..DraftGear::default() };
    assert_eq!(draft_force(&gear, 0.009, 1.0, 1.0), 0.0);
    for (h, factor) in [(1.0, 1.4), (-1.0, 0.6)] {
        assert!((draft_force(&gear, 0.03, 0.0, h) - factor * 2e5).abs() < 1e-6);
        assert!((draft_force(&gear, -0.03, 0.0, -h) + factor * 2e5).abs() < 1e-6);
    }
    // Drawn and pushed, a gear that gives way faster than its force falls is let go, not turned round.
    let damped = DraftGear { damping: 1e6, ..gear };
    assert_eq!((draft_force(&damped, 0.011, -1.0, -1.0), draft_force(&damped, -0.011, 1.0, 1.0)), (0.0, 0.0));
    for (e, rate, h) in [(f64::NAN, 0.0, 1.0), (0.03, f64::NAN, 1.0), (-0.03, 0.0, f64::NAN)] {
        assert!(draft_force(&damped, e, rate, h).is_nan(), "{e} {rate} {h}");
    }
}
