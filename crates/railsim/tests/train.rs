//! Longitudinal train dynamics against momentum, energy and hand formulas.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use railsim::KeyPath;
use railsim::equipment::effort::davis;
use railsim::equipment::train::{WAGON, Wagons};
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
}

impl System for Line {
    fn size(&self) -> usize {
        2 + self.wagons.states()
    }

    fn rhs(&mut self, _t: f64, x: &[f64], dx: &mut [f64]) {
        let pull = self.wagons.rates(&self.layout, [x[0], x[1]], |_| 0.0, &x[2..], &mut dx[2..]);
        self.drawbar = pull;
        dx[0] = x[1];
        dx[1] = (self.hauls - pull) / self.lead - G * self.layout.gradient(x[0]).sin();
    }
}

impl Line {
    fn new(train: Value, segments: &Value) -> Self {
        let written: Train = serde_json::from_value(train).unwrap();
        let segments: Vec<Segment> = serde_json::from_value(segments.clone()).unwrap();
        let length = segments.iter().map(Segment::length).sum();
        let layout = Layout::new(&segments, length, &KeyPath::of("track.layout")).unwrap();
        Self { wagons: Wagons { written, gravity: G }, layout, lead: 134e3, hauls: 0.0, drawbar: 0.0 }
    }

    /// Everything at `speed`, drawn out behind the leading mass at `place`.
    fn start(&self, place: f64, speed: f64) -> Vec<f64> {
        let mut x = vec![0.0; self.size()];
        (x[0], x[1]) = (place, speed);
        self.wagons.place(place, speed, &mut x[2..]);
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
            + self.wagons.energy(&self.layout, [x[0], x[1]], &x[2..])
    }

    fn momentum(&self, x: &[f64]) -> f64 {
        let inertia = self.wagons.written.mass + self.wagons.written.rotary_mass;
        self.lead * x[1] + x[2..].chunks_exact(WAGON).map(|w| inertia * w[1]).sum::<f64>()
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
    let by_hand = 10.0 * (90e3 * G * slope + davis(90e3, 10.0));
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
        x[x.len() - 2]
    );
    assert!((line.momentum(&x) - before).abs() < 1e-9 * before.abs());
    let spread = x[2..].chunks_exact(WAGON).map(|w| (w[1] - common).abs()).fold(0.0, f64::max);
    assert!(spread < 0.05 * common.abs(), "{spread}");
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
}
