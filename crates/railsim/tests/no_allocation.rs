//! The right-hand side of the whole locomotive allocates nothing, nor does a step.

mod common;

use std::alloc::{GlobalAlloc, Layout, System as Heap};
use std::sync::atomic::{AtomicUsize, Ordering};

use railsim::contact::creep::CreepLaw;
use railsim::dynamics::{SpeedProgram, VehicleSystem, compile, equilibrium};
use railsim::equipment::Acting;
use railsim::integrator::{Integrator, Stepper, System};
use serde_json::{Value, json};

struct Counting;

static COUNT: AtomicUsize = AtomicUsize::new(0);

// SAFETY: hands every call on to the system's allocator unchanged; counting touches no memory of it.
#[allow(unsafe_code)] // a counting allocator cannot be written without
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise about `layout` is passed on.
        unsafe { Heap.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: `pointer` came from `Heap.alloc` with this layout.
        unsafe { Heap.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn right_hand_side_and_step_allocate_nothing() {
    // The locomotive, and two vehicles with connections that remember: yaw dampers with end stiffness, dry friction.
    for vehicle in ["coco134", "bobo86", "wagon2"] {
        allocates_nothing(vehicle, &rough(vehicle), 35.0);
    }
    // Driven, coupled at both ends at an angle, in a sharp curve.
    let mut value = rough("coco134");
    value["track"]["layout"] = json!([
        { "kind": "tangent", "length": 120.0 }, { "kind": "clothoid", "length": 30.0 },
        { "kind": "curve", "radius": 250.0, "length": 90.0 }
    ]);
    value["run"]["speed"] = json!(3.0);
    value["run"]["drive"] = json!({ "notch": 8, "until": { "time": 1.0 } });
    value["run"]["couplers"] = json!({ "shank": 0.75, "front": [[0.0, 1e5], [1.0, 2e5]] });
    value["run"]["train"] = json!({
        "wagons": 5, "ahead": 2, "mass": 8e4, "length": 15.0, "brake_force": 5e4, "locomotives": [{ "at": 1, "mass": 1.3e5 }]
    });
    allocates_nothing("driven", &value, 3.0);
    // Every creep law, friction that changes along the track and with the slip, flanges that touch in a sharp curve.
    for law in CreepLaw::examples() {
        let mut value = rough("coco134");
        value["run"]["creep"] = serde_json::to_value(law).unwrap();
        value["run"]["friction"] = json!({ "left": 0.4, "right": 0.3 });
        value["track"]["layout"] = json!([
            { "kind": "tangent", "length": 120.0 },
            { "kind": "clothoid", "length": 30.0 },
            { "kind": "curve", "radius": 250.0, "length": 50.0, "cant_mm": 60.0 }
        ]);
        allocates_nothing(&format!("{law:?}"), &value, 14.0);
    }
}

fn rough(vehicle: &str) -> Value {
    let mut value = common::coco134();
    value["vehicle"] = common::read_toml(&format!("vehicles/{vehicle}.toml"));
    value["run"]["wheel_profile"] = value["vehicle"]["wheel_profile"].clone();
    value["profiles"]["s1002"] = common::profile("s1002", "wheel");
    value["track"]["irregularity"] = json!({
        "kind": "psd", "form": "fra_hamid_yang", "class": 6, "wavelengths": [1.5, 40.0], "seed": 1, "period": 1000.0
    });
    value
}

fn allocates_nothing(what: &str, value: &Value, speed: f64) {
    let model = compile::model(&common::case(value)).unwrap();
    let mut x = equilibrium::solve(&model, 100.0, speed).unwrap();
    let mut dx = vec![0.0; x.len()];
    // On, into the curve where there is one: there the wheels are on their flanges.
    for body in 0..model.count() {
        x[model.map().q(body).start] += 75.0;
    }
    let program = SpeedProgram { s: equilibrium::reference_s(&model, 100.0), speed, acceleration: 0.0 };
    let mut system = VehicleSystem::new(&model, program);
    if let Some(equipment) = &model.equipment {
        let mut acting = Box::new(Acting::new(&model, equipment));
        x.resize(model.map().size() + acting.states(), 0.0);
        dx.resize(x.len(), 0.0);
        acting.release(&model, &mut x);
        acting.place_train(&model, &mut x);
        acting.sample(&model, 0.0, &x);
        system.acting = Some(acting);
    }
    for integrator in Integrator::examples() {
        let mut stepper = Stepper::new(&integrator, x.len(), system.stiff_blocks());
        let before = COUNT.load(Ordering::Relaxed);
        for i in 0..50 {
            system.rhs(0.0, &x, &mut dx);
            let _ = stepper.step(&mut system, 1e-4 * f64::from(i), &mut x, 1e-4);
        }
        assert_eq!(COUNT.load(Ordering::Relaxed) - before, 0, "{what}, {}", integrator.name());
    }
}
