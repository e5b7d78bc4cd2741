//! The proof of the track-following frame: a free rigid body thrown over a curved, canted, graded track flies an inertial
//! parabola and keeps its angular momentum, whatever the track below it does.

use railsim::body::RigidBody;
use railsim::contact::textbook::Textbook;
use railsim::dynamics::{Contact, Model, SpeedProgram, VehicleSystem};
use railsim::error::KeyPath;
use railsim::integrator::{Integrator, Stepper, System};
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
    .unwrap()
}

#[test]
fn a_thrown_body_keeps_its_inertial_parabola_and_angular_momentum() {
    let model = free_body();
    let program = SpeedProgram { s: 0.0, speed: 0.0, acceleration: 0.0 };
    let mut system = VehicleSystem::new(&model, program);
    // General throw: off the centre line, tilted, tumbling.
    let mut x = vec![5.0, 0.3, -2.0, 0.1, -0.05, 0.2, 40.0, 1.5, -8.0, 0.4, -0.3, 0.25];
    let mut dx = vec![0.0; 12];
    system.rhs(0.0, &x, &mut dx);
    let start = system.scratch.kinematics[0].pose;
    let inertia = Vec3::new(300.0, 500.0, 700.0);
    let momentum = |s: &VehicleSystem<'_>| {
        let k = &s.scratch.kinematics[0];
        k.pose.R * inertia.component_mul(&k.w_B)
    };
    let h0 = momentum(&system);

    let (step, n) = (0.001, 4000);
    let integrator = Integrator::Rk4 { step };
    let mut stepper = Stepper::new(&integrator, 12, &[]);
    let mut worst = 0.0_f64;
    for i in 0..n {
        stepper.step(&mut system, f64::from(i) * step, &mut x, step);
        let t = f64::from(i + 1) * step;
        system.rhs(t, &x, &mut dx);
        let g = Vec3::new(0.0, 0.0, GRAVITY);
        let flight = start.r + start.v * t + 0.5 * g * t * t;
        worst = worst.max((system.scratch.kinematics[0].pose.r - flight).norm());
    }
    let drift = (momentum(&system) - h0).norm() / h0.norm();
    println!(
        "largest departure from the parabola over 160 m: {worst:.3e} m; angular momentum drift {drift:.3e}"
    );
    // Segment joins have a jump in the rate of curvature: a few steps of a fourth-order scheme straddle it, each with
    // an error of order h^3 times the jump; 1e-7 m is a hundred times that.
    assert!(worst < 1e-7, "{worst}");
    assert!(drift < 1e-9, "{drift}");
}

#[test]
fn a_body_at_rest_in_space_stays_when_weight_is_off_and_the_track_turns_below() {
    let mut model = free_body();
    model.gravity = 0.0;
    let mut system = VehicleSystem::new(&model, SpeedProgram { s: 0.0, speed: 0.0, acceleration: 0.0 });
    let x = vec![100.0, 1.0, -3.0, 0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut dx = vec![1.0; 12];
    system.rhs(0.0, &x, &mut dx);
    assert!(dx.iter().all(|v| v.abs() < 1e-15), "{dx:?}");
}
