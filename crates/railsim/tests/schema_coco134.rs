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

fn bushing(c: &Connection) -> ([f64; 3], [f64; 3]) {
    match &c.law {
        Law::Bushing(b) => (b.stiffness, b.damping),
        other => panic!("{}: {other:?}", c.name),
    }
}

#[test]
fn total_mass_is_134_t_full_and_126_t_tare() {
    assert_eq!(vehicle("full").mass(), 134_000.0);
    assert_eq!(vehicle("tare").mass(), 126_000.0);
}

#[test]
fn names_are_those_that_channels_use() {
    let v = vehicle("full");
    let bodies: Vec<&str> = v.bodies.iter().map(|b| b.name.as_str()).collect();
    let wheelsets: Vec<&str> = v.wheelsets.iter().map(|w| w.name.as_str()).collect();
    let sensors: Vec<&str> = v.sensors.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(bodies, ["carbody", "bogie1", "bogie2"]);
    assert_eq!(wheelsets, ["ws1", "ws2", "ws3", "ws4", "ws5", "ws6"]);
    assert_eq!(sensors, ["carbody.lead_pivot", "carbody.trail_pivot"]);
}
