use super::*;

fn rail_of_radius(radius: f64, step: f64, noise: f64) -> Vec<[f64; 2]> {
    let mut seed = 12345_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let half = 0.9_f64.min(0.04 / radius).asin();
    let count = (2.0 * half * radius / step) as i32;
    (0..=count)
        .map(|i| {
            let angle = -half + 2.0 * half * f64::from(i) / f64::from(count);
            [radius * angle.sin(), radius * (1.0 - angle.cos()) + noise * random()]
        })
        .collect()
}

#[test]
fn arcs_keep_their_radius() {
    for radius in [0.3, 0.08, 0.02, 0.013] {
        for step in [0.05e-3, 0.1e-3, 0.5e-3] {
            // rounded to 1e-9 m, as in files in mm with six decimals
            let points: Vec<_> = rail_of_radius(radius, step, 0.0)
                .iter()
                .map(|p| [(p[0] * 1e9).round() * 1e-9, (p[1] * 1e9).round() * 1e-9])
                .collect();
            let profile = Profile::new(&points, ProfileKind::Rail, &KeyPath::of("x")).unwrap();
            let (low, high) = profile.range();
            for i in 1..20 {
                let y = low + (high - low) * f64::from(i) / 20.0;
                let curvature = profile.curvature(y).unwrap();
                assert!(
                    (curvature * radius - 1.0).abs() < 5e-3,
                    "R {radius} step {step}: {}",
                    1.0 / curvature
                );
                let z = radius - (radius * radius - y * y).sqrt();
                assert!((profile.z(y).unwrap() - z).abs() < 2e-8);
                assert!((profile.slope(y).unwrap() - y / (radius * radius - y * y).sqrt()).abs() < 2e-5);
            }
        }
    }
}

/// 2 micrometres of noise on points every 0.1 mm, wide window: the radius of 80 mm is still seen.
#[test]
fn noisy_points_need_the_wider_window() {
    let points = rail_of_radius(0.08, 0.1e-3, 4e-6);
    let profile = Profile::smoothed(&points, ProfileKind::Rail, 4e-3, &KeyPath::of("x")).unwrap();
    for i in 3..17 {
        let (low, high) = profile.range();
        let y = low + (high - low) * f64::from(i) / 20.0;
        assert!((profile.curvature(y).unwrap() * 0.08 - 1.0).abs() < 0.15);
    }
}

#[test]
fn order_of_points_and_overhang_do_not_matter() {
    let mut points = rail_of_radius(0.02, 0.1e-3, 0.0);
    let forward = Profile::new(&points, ProfileKind::Rail, &KeyPath::of("x")).unwrap();
    points.reverse();
    let backward = Profile::new(&points, ProfileKind::Rail, &KeyPath::of("x")).unwrap();
    assert_eq!(forward, backward);
    // a full circle: the upper half is kept, to 86 degrees
    let circle: Vec<_> = (0..=600)
        .map(|i| {
            let angle = std::f64::consts::PI * (-0.9 + 1.8 * f64::from(i) / 600.0);
            [0.02 * angle.sin(), 0.02 * (1.0 - angle.cos())]
        })
        .collect();
    let kept = Profile::new(&circle, ProfileKind::Rail, &KeyPath::of("x")).unwrap();
    assert!((kept.range().1 - 0.02 * STEEPEST.sin()).abs() < 1e-4);
}

#[test]
fn inclination_lowers_the_gauge_side() {
    let flat = rail_of_radius(0.3, 0.1e-3, 0.0);
    let rail = Profile::new(&flat, ProfileKind::Rail, &KeyPath::of("x")).unwrap();
    let inclined = rail.inclined(0.05, &KeyPath::of("x")).unwrap();
    assert!((inclined.slope(0.0).unwrap() + 0.05).abs() < 1e-6);
    assert!(inclined.z(-0.02).unwrap() > 0.0);
}

#[test]
fn bad_points_are_refused_by_key() {
    let good = rail_of_radius(0.08, 0.5e-3, 0.0);
    let at = KeyPath::of("profiles.r.points");
    let refused = |points: &[[f64; 2]], kind| match Profile::new(points, kind, &at) {
        Err(Error::Input(faults)) => faults[0].to_string(),
        other => panic!("accepted: {other:?}"),
    };
    assert!(refused(&good[..5], ProfileKind::Rail).contains("5 points"));
    let mut bad = good.clone();
    bad[3][1] = f64::NAN;
    assert!(refused(&bad, ProfileKind::Rail).starts_with("profiles.r.points[3]"));
    let millimetres: Vec<_> = good.iter().map(|p| [1e3 * p[0], 1e3 * p[1]]).collect();
    assert!(refused(&millimetres, ProfileKind::Rail).contains("1000 times too wide"));
    let upside_down: Vec<_> = good.iter().map(|p| [p[0], -p[1]]).collect();
    assert!(refused(&upside_down, ProfileKind::Rail).contains("highest point"));
    let flange_outside: Vec<_> = (0..100).map(|i| [1e-3 * f64::from(i - 30), 1e-4 * f64::from(i)]).collect();
    assert!(refused(&flange_outside, ProfileKind::Wheel).contains("flange"));
}
