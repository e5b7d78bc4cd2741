//! The reference locomotive: every number of its data sheet, typed in again here, against the resolved file.

use railsim::connection::Law;
use railsim::schema::{self, Connection, Vehicle};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/vehicles/coco134.toml");

fn document() -> serde_json::Value {
    schema::toml_to_json(&std::fs::read_to_string(FILE).unwrap()).unwrap()
}

fn vehicle(condition: &str) -> Vehicle {
    Vehicle::resolve(&document(), Some(condition)).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn total_mass_is_134_t_full_and_126_t_tare() {
    assert_eq!(vehicle("full").mass(), 134_000.0);
    assert_eq!(vehicle("tare").mass(), 126_000.0);
    assert_eq!(vehicle("tare").bodies[0].mass, 79_180.0);
}

#[test]
fn names_are_those_that_channels_use() {
    let v = vehicle("full");
    let bodies: Vec<&str> = v.bodies.iter().map(|b| b.name.as_str()).collect();
    let wheelsets: Vec<&str> = v.wheelsets.iter().map(|w| w.name.as_str()).collect();
    let sensors: Vec<&str> = v.sensors.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(bodies, ["carbody", "bogie1", "bogie2"]);
    assert_eq!(wheelsets, ["ws1", "ws2", "ws3", "ws4", "ws5", "ws6"]);
    let seats = ["carbody.cab_seat_front", "carbody.cab_seat_rear"];
    let bogies = ["carbody.lead_pivot", "bogie1.front", "carbody.trail_pivot", "bogie2.front"];
    assert_eq!(sensors, [&seats[..], &bogies[..]].concat());
}

#[test]
fn bodies_and_wheelsets_are_those_of_the_data_sheet() {
    let v = vehicle("full");
    let bodies: Vec<_> = v.bodies.iter().map(|b| (b.mass, b.inertia, b.position)).collect();
    let bogie = [6520.0, 45370.0, 50300.0];
    assert_eq!(
        bodies,
        [
            (87180.0, [168_550.0, 3_610_410.0, 3_590_650.0], [0.0, 0.0, -1.95]),
            (14860.0, bogie, [6.60, 0.0, -0.75]),
            (14860.0, bogie, [-6.60, 0.0, -0.75]),
        ]
    );
    let x = [8.50, 6.60, 4.70, -4.70, -6.60, -8.50];
    for (w, x) in v.wheelsets.iter().zip(x) {
        assert_eq!((w.mass, w.inertia), (2850.0, [1789.0, 1200.0, 1789.0]), "{}", w.name);
        assert_eq!((w.radius, w.tape_half_distance), (0.5335, 0.750), "{}", w.name);
        // 6.60 - 1.90 is one rounding away from 4.70
        assert!((w.position[0] - x).abs() < 1e-14, "{}", w.name);
        assert_eq!(w.position[1..], [0.0, -0.5335], "{}", w.name);
    }
    let pivots = v.sensors.iter().filter(|s| s.name.ends_with("pivot"));
    let sensors: Vec<_> = pivots.map(|s| (s.body.as_str(), s.position)).collect();
    assert_eq!(sensors, [("carbody", [6.60, 0.0, -0.80]), ("carbody", [-6.60, 0.0, -0.80])]);
}

/// One connection as the data sheet has it.
struct Row {
    name: &'static str,
    between: [&'static str; 2],
    at: [f64; 3],
    k: [f64; 3],
    c: [f64; 3],
    carries: bool,
}

/// The 30 rows, from the numbers of the data sheet.
fn sheet() -> Vec<Row> {
    let mut rows = Vec::new();
    let mut sides = |name: [&'static str; 2], between, x, y: f64, z, k, c, carries| {
        rows.push(Row { name: name[0], between, at: [x, y, z], k, c, carries });
        rows.push(Row { name: name[1], between, at: [x, -y, z], k, c, carries });
    };
    let primary = ([3.5e7, 1.0e7, 4.0e6], [2.0e4, 2.0e4, 4.0e4]);
    let secondary = ([1.5e5, 1.5e5, 5.8e5], [2.0e3, 2.0e3, 4.5e4]);
    for (names, between, x) in [
        (["primary_ws1_right", "primary_ws1_left"], ["ws1", "bogie1"], 8.50),
        (["primary_ws2_right", "primary_ws2_left"], ["ws2", "bogie1"], 6.60),
        (["primary_ws3_right", "primary_ws3_left"], ["ws3", "bogie1"], 4.70),
        (["primary_ws4_right", "primary_ws4_left"], ["ws4", "bogie2"], -4.70),
        (["primary_ws5_right", "primary_ws5_left"], ["ws5", "bogie2"], -6.60),
        (["primary_ws6_right", "primary_ws6_left"], ["ws6", "bogie2"], -8.50),
    ] {
        sides(names, between, x, 1.05, -0.5335, primary.0, primary.1, true);
    }
    for (names, bogie, x) in [
        (["secondary_bogie1_front_right", "secondary_bogie1_front_left"], "bogie1", 7.50),
        (["secondary_bogie1_rear_right", "secondary_bogie1_rear_left"], "bogie1", 5.70),
        (["secondary_bogie2_front_right", "secondary_bogie2_front_left"], "bogie2", -5.70),
        (["secondary_bogie2_rear_right", "secondary_bogie2_rear_left"], "bogie2", -7.50),
    ] {
        sides(names, [bogie, "carbody"], x, 1.05, -1.05, secondary.0, secondary.1, true);
    }
    let lateral = [0.0, 4.0e4, 0.0];
    let yaw = [1.0e5, 0.0, 0.0];
    for (names, bogie, x) in [
        (["lateral_damper_bogie1_right", "lateral_damper_bogie1_left"], "bogie1", 6.60),
        (["lateral_damper_bogie2_right", "lateral_damper_bogie2_left"], "bogie2", -6.60),
    ] {
        sides(names, [bogie, "carbody"], x, 1.10, -0.90, [0.0; 3], lateral, false);
    }
    for (names, bogie, x) in [
        (["yaw_damper_bogie1_right", "yaw_damper_bogie1_left"], "bogie1", 6.60),
        (["yaw_damper_bogie2_right", "yaw_damper_bogie2_left"], "bogie2", -6.60),
    ] {
        sides(names, [bogie, "carbody"], x, 1.40, -0.90, [0.0; 3], yaw, false);
    }
    for (name, bogie, x) in [("pivot_bogie1", "bogie1", 6.60), ("pivot_bogie2", "bogie2", -6.60)] {
        rows.push(Row {
            name,
            between: [bogie, "carbody"],
            at: [x, 0.0, -0.80],
            k: [2.0e7, 4.0e6, 0.0],
            c: [1.0e5, 0.0, 0.0],
            carries: false,
        });
    }
    rows
}

#[test]
fn connections_are_the_thirty_of_the_data_sheet() {
    let v = vehicle("full");
    let sheet = sheet();
    assert_eq!((v.connections.len(), sheet.len()), (30, 30));
    for row in &sheet {
        let c: &Connection =
            v.connections.iter().find(|c| c.name == row.name).unwrap_or_else(|| panic!("no {}", row.name));
        let Law::Bushing(law) = &c.law else { panic!("{}: {:?}", c.name, c.law) };
        assert_eq!(c.between, row.between, "{}", c.name);
        assert_eq!((law.stiffness, law.damping), (row.k, row.c), "{}", c.name);
        assert_eq!((&law.rotational_stiffness, &law.rotational_damping), (&None, &None), "{}", c.name);
        assert_eq!(c.preload, row.carries, "{}", c.name);
        assert_eq!(c.points[0], c.points[1], "{}", c.name);
        for (ours, theirs) in c.points[0].iter().zip(row.at) {
            assert!((ours - theirs).abs() < 1e-14, "{}: {:?} {:?}", c.name, c.points[0], row.at);
        }
    }
}

#[test]
fn the_rest_is_that_of_the_data_sheet() {
    let v = vehicle("full");
    assert_eq!(v.design_speed, 115.0 / 3.6);
    assert_eq!((v.wheel_profile.as_str(), v.track.as_str()), ("anzr1", "plain_1435_as60"));
    let hold = v.speed_hold.unwrap();
    assert_eq!((hold.body.as_str(), hold.stiffness, hold.damping), ("carbody", 5.0e5, 2.0e5));
    assert_eq!((v.contact.youngs_modulus, v.contact.poisson, v.contact.damping), (2.1e11, 0.28, 1.0e5));
    let o = v.outline.unwrap();
    assert_eq!((o.length_over_couplers, o.coupler_height, o.width, o.height), (22.0, 0.90, 2.95, 4.25));
    let t = v.traction.unwrap();
    assert_eq!((t.max_effort, t.power_at_rail, t.notches), (450.0e3, 2.6e6, 8));
    assert_eq!((t.slip_reference, t.slip_limit), (0.05, 0.20));
    assert_eq!((t.kp, t.ki, t.lag), (2.0e5, 4.0e5, 0.05));
    let b = v.dynamic_brake.unwrap();
    assert_eq!((b.max_effort, b.fade_below_kmh, b.constant_power_above_kmh), (325.0e3, 5.0, 43.0));
    assert_eq!(b.rotary_mass_equivalent, 60.0e3);
}

/// Exactly, bit for bit: no front/rear or left/right difference may come from rounding.
#[test]
fn the_vehicle_is_symmetrical_front_to_rear_and_left_to_right() {
    let v = vehicle("full");
    let points: Vec<[f64; 3]> = v
        .bodies
        .iter()
        .map(|b| b.position)
        .chain(v.wheelsets.iter().map(|w| w.position))
        .chain(v.connections.iter().map(|c| c.points[0]))
        .chain(v.sensors.iter().filter(|s| s.name.ends_with("pivot")).map(|s| s.position))
        .chain(v.gaps.iter().filter(|g| g.between[1] == "carbody").map(|g| g.points[0]))
        .collect();
    for flip in [[-1.0, 1.0, 1.0], [1.0, -1.0, 1.0]] {
        for p in &points {
            let image = [0, 1, 2].map(|i| p[i] * flip[i]);
            let count = |q: &[f64; 3]| points.iter().filter(|p| *p == q).count();
            assert_eq!(count(p), count(&image), "{p:?}");
        }
    }
}

#[test]
fn the_summary_says_what_procedures_need() {
    let overrides = serde_json::from_str(r#"{ "secondary.kz": 5e5 }"#).unwrap();
    let tare = schema::resolve_summary(&document(), &overrides, Some("tare")).unwrap();
    assert_eq!(tare["document"]["parameters"]["secondary"]["kz"], 5e5);
    assert_eq!(tare["name"], "coco134");
    assert_eq!(tare["design_speed"], 115.0 / 3.6);
    assert_eq!(tare["wheel_radius"], 0.5335);
    assert_eq!(tare["wheel_profile"], "anzr1");
    assert_eq!(tare["track"], "plain_1435_as60");
    assert_eq!(tare["conditions"], serde_json::json!(["full", "tare"]));
    assert_eq!(tare["design_condition"], "full");
    assert_eq!(tare["mass"], 126_000.0);
    assert_eq!(tare["bodies"].as_array().unwrap().len(), 9);
    let design = schema::resolve_summary(&document(), &serde_json::Map::new(), None).unwrap();
    assert_eq!(design["mass"], 134_000.0);
    assert_eq!(design["document"], document());
}
