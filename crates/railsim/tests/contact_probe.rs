use railsim::KeyPath;
use railsim::contact::geometry_table::*;
use railsim::contact::profile::*;
fn shipped(name: &str, kind: ProfileKind) -> Profile {
    let path = format!("{}/../../models/profiles/{name}.csv", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap();
    Profile::new(&read_csv(&text, name).unwrap(), kind, &KeyPath::of("p")).unwrap()
}
#[test]
fn probe() {
    let p = Placement {
        gauge: 1.435,
        gauge_point_depth: 0.016,
        rail_inclination: 0.05,
        tape_half_distance: 0.75,
        wheel_radius: 0.46,
        youngs_modulus: 210e9,
        poisson: 0.28,
    };
    let rail = shipped("as60", ProfileKind::Rail);
    for name in std::env::var("W").unwrap_or("anzr1 s1002".into()).split(' ') {
        let wheel = shipped(name, ProfileKind::Wheel);
        let t0 = std::time::Instant::now();
        let table = GeometryTable::build(&wheel, &rail, &p).unwrap();
        println!("{name} build {:?} origin {}", t0.elapsed(), table.rail_origin_y());
        for roll in [0.0] {
            for i in 0..50 {
                let dy = -0.004 + 0.0003 * f64::from(i);
                let off = 0.75 - table.rail_origin_y() + dy;
                let (lo, hi) = wheel.range();
                let n = ((hi - lo) / 1e-5) as usize;
                let g: Vec<(f64, f64)> = (0..n)
                    .filter_map(|k| {
                        let y = lo + 1e-5 * k as f64;
                        let z = wheel.z(y)?;
                        Some((y, table.rail().z(y + off)? - z - y * roll))
                    })
                    .collect();
                let least = g.iter().map(|q| q.1).fold(9.0, f64::min);
                let mut text = String::new();
                for k in 1..g.len() - 1 {
                    if g[k].1 <= g[k - 1].1 && g[k].1 < g[k + 1].1 && g[k].1 < least + 5e-4 {
                        text += &format!(
                            " [yw {:.2} yr {:.2} ang {:.3} dg {:.1}um]",
                            1e3 * g[k].0,
                            1e3 * (g[k].0 + off),
                            -wheel.slope(g[k].0).unwrap().atan(),
                            1e6 * (g[k].1 - least)
                        );
                    }
                }
                let tg = table.gap(dy, roll).unwrap();
                println!(
                    "dy {:.1} {text}   T {:.1} F {:.1}",
                    1e3 * dy,
                    1e6 * (tg[0] - least),
                    1e6 * (tg[1] - least)
                );
            }
        }
    }
}
