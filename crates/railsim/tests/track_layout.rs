//! The design line against closed forms and against its own derivatives.

#![allow(clippy::unwrap_used, reason = "test helpers")]

use proptest::prelude::*;
use railsim::error::{Error, KeyPath};
use railsim::math::{Mat3, Vec3};
use railsim::track::{Curve, Layout, Passage, Segment, Tangent};

fn tangent(length: f64, cant_mm: f64, gradient: f64) -> Segment {
    Segment::Tangent(Tangent { length, cant_mm, gradient, widening_mm: 0.0 })
}

fn curve(length: f64, radius: f64, cant_mm: f64, gradient: f64) -> Segment {
    Segment::Curve(Curve {
        length,
        curvature: None,
        radius: Some(radius),
        cant_mm,
        gradient,
        widening_mm: 0.0,
    })
}

fn clothoid(length: f64) -> Segment {
    Segment::Clothoid(Passage { length })
}

fn build(segments: &[Segment], length: f64) -> Layout {
    Layout::new(segments, length, &KeyPath::of("track.layout")).unwrap()
}

/// Curved, canted, graded, with vertical curves in and out of curves; curves to both sides.
fn general() -> Layout {
    build(
        &[
            tangent(40.0, 0.0, 0.0),
            clothoid(60.0),
            curve(120.0, 300.0, 100.0, 0.02),
            clothoid(50.0), // vertical curve and change of curvature
            curve(80.0, 190.0, 140.0, -0.03),
            clothoid(45.0),
            tangent(20.0, 0.0, -0.03),
            clothoid(30.0),
            curve(90.0, -250.0, -80.0, 0.01),
            clothoid(70.0),
            tangent(60.0, 20.0, 0.0),
        ],
        665.0,
    )
}

/// The same with every kind of passage.
fn shaped() -> Layout {
    let p = |length| Passage { length };
    build(
        &[
            tangent(40.0, 0.0, 0.0),
            Segment::Cosine(p(60.0)),
            curve(120.0, 300.0, 100.0, 0.02),
            Segment::Bloss(p(50.0)),
            curve(80.0, 190.0, 140.0, -0.03),
            Segment::CubicParabola(p(45.0)),
            tangent(20.0, 0.0, -0.03),
            Segment::CubicParabola(p(30.0)),
            curve(90.0, -250.0, -80.0, 0.01),
            Segment::Helmert(p(70.0)),
            tangent(60.0, 20.0, 0.0),
        ],
        665.0,
    )
}

fn skew(k: Vec3) -> Mat3 {
    Mat3::new(0.0, -k.z, k.y, k.z, 0.0, -k.x, -k.y, k.x, 0.0)
}

/// Central difference of fourth order.
fn slope<T>(f: impl Fn(f64) -> T, s: f64, h: f64) -> T
where
    T: std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
{
    ((f(s + h) - f(s - h)) * 8.0 - (f(s + 2.0 * h) - f(s - 2.0 * h))) * (1.0 / (12.0 * h))
}

#[test]
fn a_full_circle_closes_on_itself() {
    for radius in [-150.0_f64, 400.0] {
        let length = std::f64::consts::TAU * radius.abs();
        let layout = build(&[curve(length, radius, 75.0, 0.0)], length);
        let (start, end) = (layout.frame(0.0), layout.frame(length));
        println!("circle {radius} m: closes within {:.2e} m", (end.r_IT - start.r_IT).norm());
        assert!((end.r_IT - start.r_IT).norm() < 1e-11);
        assert!((end.R_IT - start.R_IT).norm() < 1e-13);
        // Constant radius: the centre is at (0, R), a quarter on at (R, R) or, to the left, (|R|, R).
        let quarter = layout.frame(0.25 * length).r_IT;
        assert!((quarter - Vec3::new(radius.abs(), radius, 0.0)).norm() < 1e-11);
        for i in 0..50 {
            let r_IT = layout.frame(length * f64::from(i) / 50.0).r_IT;
            assert!(((r_IT - Vec3::new(0.0, radius, 0.0)).norm() - radius.abs()).abs() < 1e-11);
        }
    }
}

#[test]
fn a_helix_rises_with_its_gradient() {
    let layout = build(&[curve(500.0, 200.0, 60.0, 0.04)], 500.0);
    let (sg, cg) = 0.04_f64.atan().sin_cos();
    for s in [0.0, 123.4, 377.0, 500.0] {
        // Heading turns by s/R, so the radius in plan is R cos(gradient).
        let angle: f64 = s / 200.0;
        let expected = Vec3::new(200.0 * cg * angle.sin(), 200.0 * cg * (1.0 - angle.cos()), -sg * s);
        assert!((layout.frame(s).r_IT - expected).norm() < 1e-11);
    }
}

#[test]
fn clothoid_agrees_with_fresnel_integrals() {
    // Abramowitz and Stegun, table 7.7: C(1) = 0.7798934, S(1) = 0.4382591; to 16 digits 0.7798934003768228,
    // 0.4382591473903548; C(1/2) = 0.4923442258714464, S(1/2) = 0.0647324328599993. With theta = (pi/2) u^2 and
    // s = a u, curvature = pi s/a^2.
    let a = 100.0;
    let curvature = std::f64::consts::PI / a;
    let end = Curve {
        length: 1.0,
        curvature: Some(curvature),
        radius: None,
        cant_mm: 0.0,
        gradient: 0.0,
        widening_mm: 0.0,
    };
    let layout = build(&[clothoid(a), Segment::Curve(end)], a);
    for (u, c, s) in [
        (1.0, 0.779_893_400_376_822_8, 0.438_259_147_390_354_8),
        (0.5, 0.492_344_225_871_446_4, 0.064_732_432_859_999_3),
    ] {
        let r_IT = layout.frame(a * u).r_IT;
        println!("clothoid u {u}: ours {:.13} {:.13}, Fresnel {c:.13} {s:.13}", r_IT.x / a, r_IT.y / a);
        assert!((r_IT - a * Vec3::new(c, s, 0.0)).norm() < 1e-12 * a);
    }
}

#[test]
fn a_vertical_curve_is_a_circular_arc() {
    let (g0, g1) = (0.02_f64, -0.03_f64);
    let layout = build(&[tangent(10.0, 0.0, g0), clothoid(100.0), tangent(10.0, 0.0, g1)], 120.0);
    let radius = 100.0 / (g0.atan() - g1.atan());
    let (s0, c0) = g0.atan().sin_cos();
    let start = layout.frame(10.0).r_IT;
    let centre = start + radius * Vec3::new(s0, 0.0, c0);
    for i in 0..=20 {
        let distance = (layout.frame(10.0 + 5.0 * f64::from(i)).r_IT - centre).norm();
        assert!((distance - radius).abs() < 1e-10, "{i}: {distance} {radius}");
    }
}

#[test]
fn a_cubic_parabola_is_one_in_plan() {
    for (radius, length) in [(300.0, 60.0), (-200.0, 120.0)] {
        for reversed in [false, true] {
            let cubic = Segment::CubicParabola(Passage { length });
            let layout = if reversed {
                build(&[curve(50.0, radius, 0.0, 0.0), cubic, tangent(10.0, 0.0, 0.0)], 110.0)
            } else {
                build(&[tangent(50.0, 0.0, 0.0), cubic, curve(10.0, radius, 0.0, 0.0)], 110.0)
            };
            // From its vertex, where the straight track meets it, along the straight.
            let (vertex, sign) = if reversed { (50.0 + length, -1.0) } else { (50.0, 1.0) };
            let origin = layout.frame(vertex);
            let plan = |u: f64| origin.R_IT.tr_mul(&(layout.frame(vertex + sign * u).r_IT - origin.r_IT));
            let end = plan(length);
            let a = end.y / end.x.abs().powi(3);
            for i in 1..=12 {
                let p = plan(length * f64::from(i) / 12.0);
                assert!((p.y - a * p.x.abs().powi(3)).abs() < 1e-11, "{radius} {reversed}: {p:?}");
            }
            // Its curvature at the end, y''/(1 + y'^2)^(3/2), is the curve's.
            let curvature = 6.0 * a * end.x.abs() / (1.0 + (3.0 * a * end.x * end.x).powi(2)).powf(1.5);
            println!("cubic parabola to R {radius} m over {length} m: ends at R {:.9} m", 1.0 / curvature);
            assert!((curvature * radius - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn transitions_turn_and_shift_as_in_closed_form() {
    // Small angles: heading (L/R) F(x), offset (L^2/R) times the integral of F, F the integral of f.
    let pi = std::f64::consts::PI;
    let (length, radius) = (80.0, 1e6);
    let p = Passage { length };
    for (segment, middle, offset) in [
        (Segment::Clothoid(p), 1.0 / 8.0, 1.0 / 6.0),
        (Segment::Cosine(p), 0.25 - 0.5 / pi, 0.25 - 1.0 / (pi * pi)),
        (Segment::Bloss(p), 3.0 / 32.0, 3.0 / 20.0),
        (Segment::Helmert(p), 1.0 / 12.0, 7.0 / 48.0),
        (Segment::CubicParabola(p), 1.0 / 8.0, 1.0 / 6.0),
    ] {
        let layout = build(&[tangent(10.0, 0.0, 0.0), segment, curve(50.0, radius, 0.0, 0.0)], 140.0);
        let heading = |s: f64| layout.frame(s).R_IT[(1, 0)] * radius / length;
        let y = layout.frame(10.0 + length).r_IT.y * radius / (length * length);
        println!(
            "{segment:?}: half-way heading {:.6}, end {:.6}, offset {y:.6}",
            heading(50.0),
            heading(90.0)
        );
        for (ours, theirs) in [(heading(50.0), middle), (heading(90.0), 0.5), (y, offset)] {
            assert!((ours - theirs).abs() < 1e-8, "{segment:?}: {ours} {theirs}");
        }
        // The same between two gradients: elevation, and the vertical curvature that k_T tells.
        let layout = build(&[tangent(10.0, 0.0, 0.0), segment, tangent(50.0, 0.0, 1e-4)], 140.0);
        if !matches!(segment, Segment::CubicParabola(_)) {
            let rise = -layout.frame(90.0).r_IT.z / (1e-4 * length);
            assert!((rise - 0.5).abs() < 1e-7, "{segment:?}: {rise}");
            let integral: f64 =
                (0..8000).map(|i| layout.frame(10.005 + 0.01 * f64::from(i)).k_T.y * 0.01).sum();
            assert!((integral / 1e-4 - 1.0).abs() < 1e-6, "{segment:?}: {integral}");
        }
    }
}

#[test]
fn a_hump_of_three_vertical_curves_rises_and_comes_back() {
    // Sag, crest, sag of 300 m radius, straight between: two arcs of angle d rise 2 R (1 - cos d), the straight sin d.
    let (radius, gradient) = (300.0, 0.05_f64);
    let d = gradient.atan();
    let arc = |angle: f64| clothoid(radius * angle);
    let layout = build(
        &[
            tangent(20.0, 0.0, 0.0),
            arc(d),
            tangent(12.0, 0.0, gradient),
            arc(2.0 * d),
            tangent(12.0, 0.0, -gradient),
            arc(d),
            tangent(20.0, 0.0, 0.0),
        ],
        64.0 + 4.0 * radius * d,
    );
    let foot = 20.0 + radius * d;
    let top = foot + 12.0 + radius * d;
    let rise = 2.0 * radius * (1.0 - d.cos()) + 12.0 * d.sin();
    println!("top: ours {:.6} m, closed form {rise:.6} m", -layout.frame(top).r_IT.z);
    assert!((-layout.frame(top).r_IT.z - rise).abs() < 1e-12);
    assert!(layout.frame(2.0 * top).r_IT.z.abs() < 1e-12 && layout.gradient(2.0 * top).abs() < 1e-15);
    // Vertical curvature: + where the line turns up.
    assert!((layout.frame(20.0 + 0.5 * radius * d).k_T.y * radius - 1.0).abs() < 1e-12);
    assert!((layout.frame(top).k_T.y * radius + 1.0).abs() < 1e-12);
}

#[test]
fn the_gauge_widens_along_its_ramps_and_keeps_its_ends() {
    let with = |mm: f64, segment: Segment| match segment {
        Segment::Tangent(t) => Segment::Tangent(Tangent { widening_mm: mm, ..t }),
        Segment::Curve(c) => Segment::Curve(Curve { widening_mm: mm, ..c }),
        other => other,
    };
    let layout = build(
        &[
            tangent(20.0, 0.0, 0.0),
            clothoid(10.0),
            with(15.0, curve(50.0, 150.0, 0.0, 0.0)),
            Segment::Cosine(Passage { length: 20.0 }),
            with(-3.0, tangent(30.0, 0.0, 0.0)),
        ],
        200.0,
    );
    for (s, mm, slope) in [
        (-5.0, 0.0, 0.0),
        (10.0, 0.0, 0.0),
        (25.0, 7.5, 1.5e-3),
        (40.0, 15.0, 0.0),
        (90.0, 6.0, -0.5 * std::f64::consts::PI * 18e-3 / 20.0),
        (110.0, -3.0, 0.0),
        (190.0, -3.0, 0.0),
    ] {
        let (value, found) = layout.widening(s);
        assert!((value - 1e-3 * mm).abs() < 1e-15 && (found - slope).abs() < 1e-15, "{s}: {value} {found}");
    }
    // On straight track too, which stays the straight track that it is.
    let straight =
        build(&[with(10.0, tangent(50.0, 0.0, 0.0)), clothoid(5.0), tangent(45.0, 0.0, 0.0)], 100.0);
    assert!(straight.is_tangent());
    assert_eq!((straight.widening(20.0), straight.widening(80.0)), ((0.010, 0.0), (0.0, 0.0)));
    assert_eq!(general().widening(120.0), (0.0, 0.0));
}

#[test]
fn what_passages_and_gauges_cannot_be_is_told_by_key() {
    let told = |segments: &[Segment]| -> Vec<String> {
        let sum = segments.iter().map(Segment::length).sum();
        match Layout::new(segments, sum, &KeyPath::of("track.layout")) {
            Err(Error::Input(faults)) => faults.iter().map(ToString::to_string).collect(),
            other => panic!("{other:?}"),
        }
    };
    let p = |length| Passage { length };
    let (r200, r300) = (curve(50.0, 200.0, 0.0, 0.0), curve(50.0, 300.0, 0.0, 0.0));
    assert_eq!(
        told(&[r200, Segment::CubicParabola(p(30.0)), r300]),
        [
            "track.layout[1]: found a cubic_parabola between two curves; allowed: straight track at one end of it (a \
             clothoid passes from curve to curve)"
        ]
    );
    assert_eq!(
        told(&[tangent(10.0, 0.0, 0.0), Segment::CubicParabola(p(131.0)), r200]),
        ["track.layout[1].length: found 131 m; allowed: at most 130 m, 0.65 of the radius"]
    );
    assert_eq!(
        told(&[tangent(10.0, 0.0, 0.0), Segment::Bloss(p(20.0)), Segment::Cosine(p(20.0)), r200]),
        ["track.layout[2]: found a cosine after a bloss; allowed: a tangent or a curve between two passages"]
    );
    let wide =
        |widening_mm| Segment::Tangent(Tangent { length: 20.0, cant_mm: 0.0, gradient: 0.0, widening_mm });
    assert_eq!(
        told(&[wide(0.0), wide(6.0)]),
        [
            "track.layout[1].widening_mm: found 6; allowed: 0 mm, as at the end of the segment before (put a clothoid \
             between: it ramps cant, gradient and gauge)"
        ]
    );
    assert_eq!(
        told(&[wide(1435.0)]),
        [
            "track.layout[0].widening_mm: found 1435 mm; allowed: from -50 to 50 mm (what is added to track.gauge)"
        ]
    );
}

#[test]
fn frame_is_consistent_with_its_derivatives_on_a_general_track() {
    for layout in [general(), shaped()] {
        let (h, mut worst) = (0.02, [0.0_f64; 3]);
        let seams = [40.0, 100.0, 220.0, 270.0, 350.0, 395.0, 415.0, 445.0, 535.0, 570.0, 605.0];
        for i in 0..2000 {
            let s = 0.1 + 664.8 * f64::from(i) / 2000.0;
            if seams.iter().any(|seam: &f64| (seam - s).abs() < 3.0 * h) {
                continue;
            }
            let frame = layout.frame(s);
            let R = frame.R_IT;
            // Differences of fourth order: truncation h^4 k^5/30 far below rounding, 1e-16 * 600 m/h.
            worst[0] = worst[0].max((slope(|s| layout.frame(s).r_IT, s, h) - R.column(0)).norm());
            worst[1] = worst[1].max((slope(|s| layout.frame(s).R_IT, s, h) - R * skew(frame.k_T)).norm());
            worst[2] = worst[2].max((R.transpose() * R - Mat3::identity()).norm());
            assert!((R.determinant() - 1.0).abs() < 1e-14);
        }
        println!("differences: r' {:.1e}, R' {:.1e}; R'R - 1 {:.1e}", worst[0], worst[1], worst[2]);
        assert!(worst[0] < 2e-11 && worst[1] < 1e-12 && worst[2] < 1e-14, "{worst:?}");
    }
}

#[test]
fn position_is_the_integral_of_the_direction_to_1e_11() {
    // Against composite Gauss quadrature on cells of 0.5 m, independent of the layout's own nodes.
    use railsim::math::quadrature::GAUSS_4;
    for layout in [general(), shaped()] {
        let mut r = Vec3::zeros();
        let mut worst = 0.0_f64;
        for cell in 0..1330 {
            let start = 0.5 * f64::from(cell);
            for (x, weight) in GAUSS_4 {
                r += 0.25 * weight * layout.frame(start + 0.25 * (1.0 + x)).R_IT.column(0);
            }
            worst = worst.max((layout.frame(start + 0.5).r_IT - r).norm() / (start + 0.5));
        }
        println!("position against independent quadrature: {worst:.1e} of the distance");
        assert!(worst < 1e-11);
    }
}

#[test]
fn origin_and_axes_are_continuous_at_every_seam_and_go_straight_on_outside() {
    for layout in [general(), shaped()] {
        let mut s = 0.0;
        for length in [40.0, 60.0, 120.0, 50.0, 80.0, 45.0, 20.0, 30.0, 90.0, 70.0, 60.0] {
            for seam in [s, s + length] {
                let (a, b) = (layout.frame(seam - 1e-9), layout.frame(seam + 1e-9));
                assert!((b.r_IT - a.r_IT - 2e-9 * a.R_IT.column(0)).norm() < 1e-12, "at {seam}");
                assert!((b.R_IT - a.R_IT).norm() < 1e-10, "at {seam}");
            }
            s += length;
        }
    }
    let curve_from_start = build(&[curve(100.0, 250.0, 50.0, 0.01)], 100.0);
    let (first, before) = (curve_from_start.frame(0.0), curve_from_start.frame(-30.0));
    assert_eq!(before.k_T, Vec3::zeros());
    assert!((first.r_IT - before.r_IT - 30.0 * before.R_IT.column(0)).norm() < 1e-13);
    let (last, after) = (curve_from_start.frame(100.0), curve_from_start.frame(140.0));
    assert!((after.r_IT - last.r_IT - 40.0 * last.R_IT.column(0)).norm() < 1e-12);
    assert!((after.R_IT - last.R_IT).norm() < 1e-15);
    let sine = 50.0 / 1500.0_f64;
    for s in [-30.0, 50.0, 140.0] {
        assert!((curve_from_start.cant(s) - sine.asin()).abs() < 1e-14);
        assert!((curve_from_start.gradient(s) - 0.01_f64.atan()).abs() < 1e-14);
    }
    assert_eq!(curve_from_start.curvature(50.0), 1.0 / 250.0);
    assert_eq!(curve_from_start.curvature(-1.0), 0.0);
}

#[test]
fn signs_are_right_for_a_right_hand_climbing_curve() {
    let frame = build(&[curve(100.0, 300.0, 90.0, 0.02)], 100.0).frame(50.0);
    let [x, y] = [frame.R_IT.column(0), frame.R_IT.column(1)];
    assert!(frame.r_IT.y > 0.0, "turns right");
    assert!(frame.r_IT.z < 0.0 && x.z < 0.0, "climbs: z is down");
    assert!(y.z > 0.0, "right rail lower");
    assert!(frame.k_T.z > 0.0, "curvature + to the right");
    // Across the base of 1.5 m the right rail is 90 mm lower, but for the gradient's cosine.
    assert!((1.5 * y.z - 0.09 * 0.02_f64.atan().cos()).abs() < 1e-15);
}

#[test]
fn tangent_is_the_identity_and_level_segments_are_a_tangent() {
    let layout = build(&[tangent(100.0, 0.0, 0.0), clothoid(20.0), tangent(200.0, 0.0, 0.0)], 320.0);
    assert!(layout.is_tangent() && !general().is_tangent());
    assert!(build(&[], 100.0).is_tangent());
    for s in [-20.0, 0.0, 1.5, 400.0] {
        let frame = Layout::tangent(300.0).frame(s);
        assert_eq!(frame, layout.frame(s));
        assert_eq!(
            (frame.r_IT, frame.R_IT, frame.k_T),
            (Vec3::new(s, 0.0, 0.0), Mat3::identity(), Vec3::zeros())
        );
    }
}

#[test]
fn written_form_is_read_and_unknown_keys_are_refused() {
    let text = r#"[{"kind":"tangent","length":50},{"kind":"clothoid","length":40},
                   {"kind":"curve","length":80,"radius":-300,"cant_mm":-60,"gradient":0.01}]"#;
    let segments: Vec<Segment> = serde_json::from_str(text).unwrap();
    assert_eq!(segments, [tangent(50.0, 0.0, 0.0), clothoid(40.0), curve(80.0, -300.0, -60.0, 0.01)]);
    let back: Vec<Segment> = serde_json::from_str(&serde_json::to_string(&segments).unwrap()).unwrap();
    assert_eq!(back, segments);
    for (bad, word) in [
        (r#"{"kind":"tangent","length":50,"cant":3}"#, "cant"),
        (r#"{"kind":"bend","length":50}"#, "clothoid"),
        (r#"{"kind":"curve","radius":50}"#, "length"),
    ] {
        let message = serde_json::from_str::<Segment>(bad).unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    }
}

#[test]
fn all_faults_are_collected_with_their_keys() {
    let both = Curve {
        length: 5.0,
        curvature: Some(0.01),
        radius: Some(100.0),
        cant_mm: 500.0,
        gradient: 0.0,
        widening_mm: 0.0,
    };
    let neither =
        Curve { length: 5.0, curvature: None, radius: None, cant_mm: 500.0, gradient: 0.9, widening_mm: 0.0 };
    let segments = [
        tangent(-1.0, 0.0, 0.0),
        Segment::Curve(both),
        clothoid(f64::NAN),
        clothoid(10.0),
        Segment::Curve(neither),
        curve(10.0, 3.0, 500.0, 0.9),
    ];
    let Err(Error::Input(faults)) = Layout::new(&segments, 1000.0, &KeyPath::of("track.layout")) else {
        panic!("accepted");
    };
    let keys: Vec<String> = faults.iter().map(|f| f.key.to_string()).collect();
    for key in [
        "track.layout[0].length",
        "track.layout[1].radius",
        "track.layout[1].cant_mm",
        "track.layout[2].length",
        "track.layout[3]",
        "track.layout[4]",
        "track.layout[4].gradient",
        "track.layout[5].radius",
    ] {
        assert!(keys.iter().any(|k| k == key), "{key} not in {keys:?}");
    }
    let Err(error) = Layout::new(&[curve(100.0, 300.0, 0.0, 0.0)], 250.0, &KeyPath::of("track.layout"))
    else {
        panic!("accepted");
    };
    assert_eq!(
        error.to_string(),
        "track.layout[0].length: found 100 m, the layout ends in a curve at 100 m; allowed: 250 m or more: the track \
         is 250 m long (or add what follows the curve)"
    );
    let Err(error) = Layout::new(&[], -1.0, &KeyPath::of("track.layout")) else { panic!("accepted") };
    assert!(error.to_string().starts_with("track.length: found -1"));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    // Any two constant segments joined by a clothoid: unit direction, orthonormal axes, derivative = direction.
    #[test]
    fn derivative_is_the_direction(
        radius in prop_oneof![-2000.0_f64..-90.0, 90.0_f64..2000.0],
        cant in -150.0_f64..150.0,
        gradient in -0.05_f64..0.05,
        length in 20.0_f64..120.0,
        at in 0.01_f64..0.99,
    ) {
        let layout = build(&[tangent(30.0, 0.0, 0.0), clothoid(length), curve(50.0, radius, cant, gradient)], 1.0);
        let s = 30.0 + at * length;
        let h = 1e-2_f64.min(0.4 * (s - 30.0)).min(0.4 * (30.0 + length - s));
        let frame = layout.frame(s);
        let difference = slope(|s| layout.frame(s).r_IT, s, h) - frame.R_IT.column(0);
        prop_assert!(difference.norm() < 1e-14 * 100.0 / h);
        prop_assert!((slope(|s| layout.frame(s).R_IT, s, h) - frame.R_IT * skew(frame.k_T)).norm() < 1e-13 / h);
    }
}
