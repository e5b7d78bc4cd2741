#![allow(clippy::unwrap_used, clippy::print_stdout)]
use railsim::contact::conicity::{Method, RadiusCurve};
use railsim::contact::pair::{Pair, Roll};
use railsim::contact::profile::read_csv;
use serde_json::json;

#[test]
fn explore() {
    let shared = std::env::var("LMAP_SHARED").map(|s| format!("{s}/data")).unwrap();
    let read = |n: &str| {
        let t = std::fs::read_to_string(format!("{shared}/fetched/uic519_{n}.csv")).unwrap();
        let p: Vec<_> = read_csv(&t, n).unwrap().iter().map(|p| p.map(|v| 1e3 * v)).collect();
        p
    };
    let smoothing: f64 = std::env::var("HW").map_or(1e-3, |v| v.parse().unwrap());
    let curves = std::fs::read_to_string(format!("{shared}/fetched/en15302_delta_r.csv")).unwrap();
    for (case, r, l, dr, dl, theirs) in [
        ("E1", "A", "A", 920., 920., 0.188),
        ("E2", "B", "B", 920., 920., 0.058),
        ("E3", "H", "H", 920., 920., 0.245),
        ("E4", "I", "I", 920., 920., 0.489),
        ("E5", "A", "A", 920., 918., 0.261),
        ("E6", "B", "B", 920., 918., 0.278),
        ("E7", "H", "H", 920., 918., 0.270),
        ("E8", "I", "I", 920., 918., 0.449),
        ("E9", "A", "B", 920., 920., 0.132),
    ] {
        let side = |w: &str, d: f64| json!({"wheel": read(&format!("wheel_{w}")), "rail": read("rail_A"), "radius": d / 2000.0});
        let pair = json!({"left": side(l, dl), "right": side(r, dr), "gauge": 1.43516, "flange_back_distance": 1.360, "smoothing": smoothing});
        let pair = Pair::from_json(&pair.to_string()).unwrap();
        let t = std::time::Instant::now();
        let curve = pair
            .radius_curve(0.010, 1e-4, if std::env::var("FREE").is_ok() { Roll::Free } else { Roll::Level })
            .unwrap();
        let m = |m| curve.conicity(3e-3, m).unwrap_or(f64::NAN);
        println!(
            "{case}: {theirs} int {:.4} reg {:.4} har {:.4} centre {:?} turn {:?} range {:?} {:?} {:?}",
            m(Method::Integration),
            m(Method::Regression),
            m(Method::Harmonic),
            curve.centre(),
            curve.turning_points(3e-3),
            curve.y().first(),
            curve.y().last(),
            t.elapsed()
        );
        let given: Vec<[f64; 2]> = curves
            .lines()
            .filter(|l| l.starts_with(case))
            .map(|l| {
                let f: Vec<&str> = l.split(',').collect();
                [f[2].parse::<f64>().unwrap() * 1e-3, f[3].parse::<f64>().unwrap() * 1e-3]
            })
            .collect();
        if !given.is_empty() {
            let g = RadiusCurve::new(&given);
            let m = |m| g.conicity(3e-3, m).unwrap_or(f64::NAN);
            println!(
                "   given curve: {:.4} {:.4} {:.4}",
                m(Method::Integration),
                m(Method::Regression),
                m(Method::Harmonic)
            );
            for y in [-6., -5., -4., -3., -2., -1.5, -1., -0.5, 0., 0.5, 1., 1.5, 2., 3., 4., 5., 6.] {
                print!(
                    " {y}: {:.3}/{:.3}",
                    1e3 * curve.at(y * 1e-3).unwrap_or(f64::NAN),
                    1e3 * g.at(y * 1e-3).unwrap_or(f64::NAN)
                );
            }
            println!();
        }
    }
}
