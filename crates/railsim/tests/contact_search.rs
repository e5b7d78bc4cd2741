#![allow(clippy::unwrap_used, clippy::print_stdout)]
use railsim::KeyPath;
use railsim::contact::geometry_table::Placement;
use railsim::contact::profile::{Profile, ProfileKind, read_csv};
use railsim::contact::search::{Pose, RailShift, Side};

#[test]
fn explore() {
    let w: f64 = std::env::var("HW").map_or(1e-3, |v| v.parse().unwrap());
    let shared = format!("{}/../../../../../work/shared/data", env!("CARGO_MANIFEST_DIR"));
    let shared = std::env::var("LMAP_SHARED").map_or(shared, |s| format!("{s}/data"));
    let read = |n: &str, k| {
        let t = std::fs::read_to_string(format!("{shared}/fetched/{n}")).unwrap();
        Profile::smoothed(&read_csv(&t, n).unwrap(), k, w, &KeyPath::of("x")).unwrap()
    };
    let wheel = read("mbench_s1002_v3.csv", ProfileKind::Wheel);
    let rail = read("mbench_uic60_v3_canted40.csv", ProfileKind::Rail);
    let placement = Placement {
        gauge: 1.435,
        gauge_point_depth: 0.014,
        rail_inclination: 0.0,
        tape_half_distance: 0.750,
        wheel_radius: 0.460,
        youngs_modulus: 2.0 * 82e9 * 1.28,
        poisson: 0.28,
    };
    let side = Side::new(&wheel, &rail, &placement).unwrap();
    println!("origin {}", side.rail_origin_y());
    let text = std::fs::read_to_string(format!("{shared}/contact/mbench_a22.csv")).unwrap();
    for line in text.lines().skip(1) {
        let f: Vec<&str> = line.split(',').collect();
        let n: Vec<f64> = f.iter().skip(2).map(|v| v.parse().unwrap()).collect();
        let s = if f[0] == "R" { 1.0 } else { -1.0 };
        let pose = Pose { y: s * n[0] * 1e-3, z: n[5] * 1e-3, roll: s * n[2], yaw: s * n[1] };
        let patches = side.patches(&pose, &RailShift::default()).unwrap();
        println!(
            "{} {:4.1} theirs: x {:6.3} yr {:7.3} yw {:7.3} ang {:.4} app {:.2} N {:.0} ext {} {}",
            f[0],
            n[0],
            n[6],
            s * n[10],
            s * n[13],
            -s * n[9],
            1e3 * n[19],
            n[15],
            n[28],
            n[29]
        );
        for p in patches {
            for t in [p.deepest, p.centre] {
                print!(
                    "   x {:6.3} yr {:7.3} yw {:7.3} ang {:.4}",
                    1e3 * t.ahead,
                    1e3 * t.rail[0],
                    1e3 * t.wheel[0],
                    t.angle
                );
            }
            println!(
                " app {:.2} N {:.0} a {:.2} b {:.2} reach {:.2} {:.2} k {:.2} loc {:.2} spread {:.2}",
                -1e6 * p.deepest.gap,
                p.normal,
                2e3 * p.a,
                2e3 * p.b,
                1e3 * p.reach[0],
                1e3 * p.reach[1],
                p.curvature,
                p.deepest.k_yy - p.deepest.k_xy.powi(2) / p.deepest.k_xx,
                p.spread
            );
        }
    }
}
