//! Equivalent conicity against the reference results of EN 15302 (UIC 519): the four curves E1-E4 and nine pairs at 3 mm.
//!
//! The profiles and curves are read in place from the shared folder (`LMAP_SHARED`, else beside the project) and are not part of it; without them
//! the tests say so and pass.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use railsim::contact::conicity::{Method, RadiusCurve};
use railsim::contact::pair::{Pair, Roll};
use railsim::contact::profile::read_csv;
use serde_json::{Value, json};

fn fetched(name: &str) -> Option<String> {
    let beside = format!("{}/../../../shared", env!("CARGO_MANIFEST_DIR"));
    let shared = std::env::var("LMAP_SHARED").unwrap_or(beside);
    let text = std::fs::read_to_string(format!("{shared}/data/fetched/{name}.csv")).ok();
    if text.is_none() {
        println!("skipped: {name}.csv is not there (set LMAP_SHARED)");
    }
    text
}

/// Right wheel, left wheel, diameters, tan(gamma_e) at 3 mm; rail A, gauge 1435.16 mm.
const CASES: [(&str, &str, &str, f64, f64, f64); 9] = [
    ("E1", "A", "A", 0.920, 0.920, 0.188),
    ("E2", "B", "B", 0.920, 0.920, 0.058),
    ("E3", "H", "H", 0.920, 0.920, 0.245),
    ("E4", "I", "I", 0.920, 0.920, 0.489),
    ("E5", "A", "A", 0.920, 0.918, 0.261),
    ("E6", "B", "B", 0.920, 0.918, 0.278),
    ("E7", "H", "H", 0.920, 0.918, 0.270),
    ("E8", "I", "I", 0.920, 0.918, 0.449),
    ("E9", "A", "B", 0.920, 0.920, 0.132),
];

fn given(case: &str) -> Option<RadiusCurve> {
    let text = fetched("en15302_delta_r")?;
    let points: Vec<[f64; 2]> = text
        .lines()
        .filter(|l| l.starts_with(case))
        .map(|l| {
            let cells: Vec<&str> = l.split(',').collect();
            [2, 3].map(|i| 1e-3 * cells[i].parse::<f64>().unwrap())
        })
        .collect();
    Some(RadiusCurve::new(&points))
}

fn points(name: &str) -> Option<Vec<[f64; 2]>> {
    let text = fetched(&format!("uic519_{name}"))?;
    Some(read_csv(&text, name).unwrap().iter().map(|p| p.map(|v| 1e3 * v)).collect())
}

fn pair(right: &str, left: &str, diameters: [f64; 2]) -> Option<Pair> {
    let rail = points("rail_A")?;
    let side = |wheel: &str, diameter: f64| -> Option<Value> {
        Some(json!({"wheel": points(&format!("wheel_{wheel}"))?, "rail": rail, "radius": 0.5 * diameter}))
    };
    let json = json!({
        "left": side(left, diameters[1])?,
        "right": side(right, diameters[0])?,
        "gauge": 1.43516,
        "flange_back_distance": 1.360,
    });
    Some(Pair::from_json(&json.to_string()).unwrap())
}

/// From the standard's own rolling radius curves to its own conicities, every tenth of a millimetre of amplitude.
#[test]
fn conicity_of_the_given_curves() {
    let Some(text) = fetched("en15302_equivalent_conicity") else { return };
    for (case, ..) in &CASES[..4] {
        let curve = given(case).unwrap();
        let (mut worst, mut at, mut count, mut missing) = (0.0_f64, 0.0, 0, 0);
        for line in text.lines().filter(|l| l.starts_with(case)) {
            let cells: Vec<&str> = line.split(',').collect();
            let [amplitude, theirs] = [2, 3].map(|i| cells[i].parse::<f64>().unwrap());
            let Some(ours) = curve.conicity(1e-3 * amplitude, Method::Integration) else {
                missing += 1;
                continue;
            };
            count += 1;
            if (ours - theirs).abs() > worst {
                (worst, at) = ((ours - theirs).abs(), amplitude);
            }
        }
        let three = |method| curve.conicity(3e-3, method).unwrap();
        println!(
            "{case}: {count} amplitudes, largest difference {worst:.4} at {at} mm ({missing} without oscillation); at 3 mm integration {:.4}, regression {:.4}, harmonic {:.4}",
            three(Method::Integration),
            three(Method::Regression),
            three(Method::Harmonic)
        );
    }
    for (case, .., theirs) in &CASES[..4] {
        let ours = given(case).unwrap().conicity(3e-3, Method::Integration).unwrap();
        assert!((ours - theirs).abs() < 0.002, "{case} {ours} {theirs}");
    }
}

/// From the profiles. Tolerance of the standard for calculations: the smaller of 0.05 and half the value.
///
/// dr at every 0.1 mm, as the reference curves are given, straight between: where contact jumps near the amplitude asked for, the result hangs on that
/// (E2 is 0.045 with 0.05 mm). E3's 0.277 against 0.245: wheel H jumps from tread to flange root between 2.1 and 2.5 mm, and at 3 mm the conicity hangs on where exactly. With
/// different diameters (E7) the motion crosses the jump fast and agrees in the third figure.
#[test]
fn conicity_of_the_reference_pairs() {
    for (case, right, left, d_right, d_left, theirs) in CASES {
        let Some(pair) = pair(right, left, [d_right, d_left]) else { return };
        let curve = pair.radius_curve(0.010, 1e-4, Roll::Level).unwrap();
        let of = |method| curve.conicity(3e-3, method).unwrap();
        let ours = of(Method::Integration);
        println!(
            "{case}: {ours:.4} ({theirs}) {:+.4}; regression {:.4}, harmonic {:.4}",
            ours - theirs,
            of(Method::Regression),
            of(Method::Harmonic)
        );
        assert!((ours - theirs).abs() < 0.05_f64.min(0.5 * theirs), "{case}");
    }
    // the axle that rolls
    for (case, right, left, d_right, d_left, theirs) in &CASES[..4] {
        let Some(pair) = pair(right, left, [*d_right, *d_left]) else { return };
        let curve = pair.radius_curve(0.006, 1e-4, Roll::Free).unwrap();
        println!("{case} free to roll: {:.4} ({theirs})", curve.conicity(3e-3, Method::Integration).unwrap());
    }
}

/// Our rolling radius curves against the standard's.
#[test]
fn rolling_radius_difference_of_the_reference_pairs() {
    for (case, right, left, d_right, d_left, _) in &CASES[..4] {
        let (Some(pair), Some(given)) = (pair(right, left, [*d_right, *d_left]), given(case)) else { return };
        let mut errors: Vec<(f64, f64)> = given
            .y()
            .iter()
            .zip(given.dr())
            .filter(|(y, _)| y.abs() < 6e-3)
            .map(|(y, dr)| ((pair.rolling_radius_difference(*y, Roll::Level).unwrap() - dr).abs(), *y))
            .collect();
        errors.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n = errors.len();
        println!(
            "{case}: dr median {:.4} mm, 90 % {:.4}, largest {:.3} at {:.1} mm",
            1e3 * errors[n / 2].0,
            1e3 * errors[n * 9 / 10].0,
            1e3 * errors[n - 1].0,
            1e3 * errors[n - 1].1
        );
        assert!(errors[n / 2].0 < 0.05e-3, "{case}");
    }
}

/// Cone: dr = 2 gamma y, any method gives gamma, also about a centre that is not zero and for unequal wheels.
#[test]
fn a_cone_by_every_method() {
    for centre in [0.0, 1.3e-3] {
        let points: Vec<[f64; 2]> =
            (-100..=100).map(|i| 1e-4 * f64::from(i)).map(|y| [y, 0.1 * (y - centre)]).collect();
        let curve = RadiusCurve::new(&points);
        for method in [Method::Integration, Method::Regression, Method::Harmonic] {
            let ours = curve.conicity(3e-3, method).unwrap();
            println!("{method:?} about {centre}: {ours:.7}");
            assert!((ours - 0.05).abs() < 1e-6);
        }
        assert!((curve.centre().unwrap() - centre).abs() < 1e-12);
        assert_eq!(curve.conicity(9.9e-3 + centre, Method::Integration).is_some(), centre == 0.0);
    }
}

/// dr = c y^3, closed forms: integration by the lemniscate integral, regression 3 c A^2/10, harmonic 3 c A^2/8.
#[test]
fn a_cubic_by_every_method() {
    let (c, a) = (1000.0_f64, 3e-3_f64);
    let points: Vec<[f64; 2]> =
        (-4000..=4000).map(|i| 1e-6 * f64::from(i)).map(|y| [y, c * y.powi(3)]).collect();
    let curve = RadiusCurve::new(&points);
    let pi = std::f64::consts::PI;
    for (method, exact) in [
        (Method::Integration, pi * pi * c * a * a / (16.0 * 1.311_028_777_146_06_f64.powi(2))),
        (Method::Regression, 0.3 * c * a * a),
        (Method::Harmonic, 0.375 * c * a * a),
    ] {
        let ours = curve.conicity(a, method).unwrap();
        println!("{method:?}: {ours:.6e} ({exact:.6e})");
        assert!((ours / exact - 1.0).abs() < 1e-4);
    }
}
