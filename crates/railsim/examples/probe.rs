use railsim::contact::geometry_table::*;
use railsim::contact::profile::*;
use railsim::error::KeyPath;
fn main() {
    let at = KeyPath::of("p");
    let args: Vec<String> = std::env::args().collect();
    let rd = |n: &str, k| Profile::new(&read_csv(&std::fs::read_to_string(format!("models/profiles/{n}.csv")).unwrap(), n).unwrap(), k, &at).unwrap();
    let conicity = 0.05;
    let wheel = if args[1] == "cone" {
        let cone: Vec<[f64; 2]> = (0..=800).map(|i| { let y = -0.040 + 1e-4 * f64::from(i);
            [y, if y < -0.036 { -conicity * y + 3.0 * (-0.036 - y) } else { -conicity * y }] }).collect();
        Profile::new(&cone, ProfileKind::Wheel, &at).unwrap()
    } else { rd(&args[1], ProfileKind::Wheel) };
    let rail = rd("as60", ProfileKind::Rail);
    let p = Placement { gauge: 1.435, gauge_point_depth: 0.016, rail_inclination: 0.05, tape_half_distance: 0.75, wheel_radius: 0.5335, youngs_modulus: 2.1e11, poisson: 0.28 };
    let t = GeometryTable::build(&wheel, &rail, &p).unwrap();
    println!("rail origin {}", t.rail_origin_y());
    let step: f64 = args[2].parse().unwrap();
    for i in -15..=15 {
        let dy = step * f64::from(i) * 1e-3;
        let g = t.gap(dy, 0.0).unwrap();
        let mut out = [ContactPoint::default(); 2];
        let depth = g[0].min(g[1]) + 8e-5;
        let n = t.contacts(dy, 0.0, depth, 0.0, &mut out).unwrap();
        print!("dy {:7.3} gaps {:8.4} {:8.4} ", dy*1e3, g[0]*1e3, g[1]*1e3);
        for c in &out[..n] { print!("| {:?} pen {:.4} share {:.3} yr {:7.3} yw {:7.3} zw {:7.4} ang {:.4} C {:.3e} a1 {:.2e} b1 {:.2e} ", c.zone, c.penetration*1e3, c.share, c.y_rail*1e3, c.y_wheel*1e3, c.z_wheel*1e3, c.angle, c.hertz, c.a1, c.b1); }
        println!(" dr {:?}", t.rolling_radius_difference(dy).map(|d| d*1e3));
    }
    for a in [1e-3,2e-3,3e-3,4e-3,5e-3,6e-3] { print!(" {:?}", t.equivalent_conicity(a)); }
    println!();
}
