//! The pair that most contact tests are about: profiles as they ship, on as60 inclined 1:20, gauge 1435 mm.

use railsim::KeyPath;
use railsim::contact::geometry_table::Placement;
use railsim::contact::profile::{Profile, ProfileKind, read_csv};

pub const PLACEMENT: Placement = Placement {
    gauge: 1.435,
    gauge_point_depth: 0.016,
    rail_inclination: 0.05,
    tape_half_distance: 0.750,
    wheel_radius: 0.460,
    youngs_modulus: 210e9,
    poisson: 0.28,
};

pub fn shipped(name: &str, kind: ProfileKind) -> Profile {
    let path = super::models().join(format!("profiles/{name}.csv"));
    let points = read_csv(&std::fs::read_to_string(path).unwrap(), name).unwrap();
    Profile::new(&points, kind, &KeyPath::of("profiles").key(name).key("points")).unwrap()
}

pub fn wheel(name: &str) -> Profile {
    shipped(name, ProfileKind::Wheel)
}

pub fn as60() -> Profile {
    shipped("as60", ProfileKind::Rail)
}
