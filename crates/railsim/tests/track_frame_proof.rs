//! The proof of the track-following frame: a free rigid body thrown over a curved, canted, graded track flies an inertial
//! parabola and keeps its angular momentum, whatever the track below it does.

use railsim::body::RigidBody;
use railsim::contact::textbook::Textbook;
use railsim::dynamics::{Contact, Model, SpeedProgram, VehicleSystem};
use railsim::error::KeyPath;
use railsim::integrator::{Integrator, StepEnd, Stepper, System};
use railsim::math::Vec3;
use railsim::track::DeviationField;
use railsim::track::{Layout, Segment};

const GRAVITY: f64 = 9.80665;

fn track() -> Layout {
    let text = r#"[
        { "kind": "tangent", "length": 20.0, "gradient": 0.01 },
        { "kind": "clothoid", "length": 60.0 },
        { "kind": "curve", "length": 100.0, "radius": 300.0, "cant_mm": 120.0, "gradient": 0.02 },
        { "kind": "clothoid", "length": 60.0 },
        { "kind": "curve", "length": 200.0, "radius": -250.0, "cant_mm": -100.0, "gradient": -0.02 }
    ]"#;
    let segments: Vec<Segment> = serde_json::from_str(text).unwrap();
    Layout::new(&segments, 440.0, &KeyPath::of("track.layout")).unwrap()
}

fn free_body() -> Model {
    let body = RigidBody {
        name: "stone".into(),
        mass: 1000.0,
        inertia: Vec3::new(300.0, 500.0, 700.0),
        position: Vec3::new(0.0, 0.0, -2.0),
    };
    let contact = Contact::Textbook(Textbook {
        conicity: 0.0,
        f11: 0.0,
        f22: 0.0,
        f23: 0.0,
        stiffness: 0.0,
        damping: 0.0,
        gravity_stiffness: false,
    });
    Model::new(
        vec![body],
        vec![],
        vec![],
        vec![],
        None,
        track(),
        DeviationField::none(),
        None,
        contact,
        GRAVITY,
    )
}

/// Throws the body at `s` and gives its largest departure from the parabola (m) and the drift of its angular momentum (1).
fn throw(s: f64, step: f64, duration: f64) -> (f64, f64) {
    let model = free_body();
    let program = SpeedProgram { s: 0.0, speed: 0.0, acceleration: 0.0 };
    let mut system = VehicleSystem::new(&model, program);
    // General throw: off the centre line, tilted, tumbling.
    let mut x = vec![s, 0.3, -2.0, 0.1, -0.05, 0.2, 40.0, 1.5, -8.0, 0.4, -0.3, 0.25];
    let mut dx = vec![0.0; 12];
    system.rhs(0.0, &x, &mut dx);
    let start = system.scratch.kinematics[0].pose;
    let inertia = Vec3::new(300.0, 500.0, 700.0);
    let momentum = |s: &VehicleSystem<'_>| {
        let k = &s.scratch.kinematics[0];
        k.pose.R * inertia.component_mul(&k.w_B)
    };
    let h0 = momentum(&system);
    let mut stepper = Stepper::new(&Integrator::Rk4 { step }, 12, &[]);
    let (mut worst, mut drift) = (0.0_f64, 0.0_f64);
    for i in 0..(duration / step).round() as u32 {
        assert_eq!(stepper.step(&mut system, f64::from(i) * step, &mut x, step), StepEnd::Done);
        let t = f64::from(i + 1) * step;
        system.rhs(t, &x, &mut dx);
        let g = Vec3::new(0.0, 0.0, GRAVITY);
        let flight = start.r + start.v * t + 0.5 * g * t * t;
        worst = worst.max((system.scratch.kinematics[0].pose.r - flight).norm());
        drift = drift.max((momentum(&system) - h0).norm() / h0.norm());
    }
    (worst, drift)
}

#[test]
fn a_thrown_body_keeps_its_inertial_parabola_and_angular_momentum() {
    // Within one segment each: a clothoid on which curvature, cant and gradient all change, then a canted, graded curve.
    for (s, duration) in [(22.0, 1.3), (85.0, 2.0), (183.0, 1.3), (245.0, 3.0)] {
        let (worst, drift) = throw(s, 0.001, duration);
        println!(
            "thrown at {s} m for {duration} s: {worst:.2e} m off the parabola, angular momentum drift {drift:.2e}"
        );
        // Rounding of 1e2 m over a few thousand fourth-order steps.
        assert!(worst < 1e-9, "{worst}");
        assert!(drift < 1e-11, "{drift}");
    }
}

#[test]
fn across_segment_joins_the_error_is_that_of_the_straddling_step_alone() {
    // At a join the rate of cant jumps, so the one step across it is of first order in the step.
    let (coarse, _) = throw(5.0, 1e-3, 4.0);
    let (fine, _) = throw(5.0, 1e-4, 4.0);
    println!("160 m over four joins: {coarse:.2e} m at 1 ms, {fine:.2e} m at 0.1 ms");
    assert!(coarse < 2e-4);
    assert!(fine < 0.3 * coarse);
}
