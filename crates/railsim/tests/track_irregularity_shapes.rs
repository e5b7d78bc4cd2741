//! Shapes of irregularity: their heights and places, corners and rails, and what is refused.

#![allow(clippy::unwrap_used, reason = "test helpers")]

#[path = "common/deviation.rs"]
mod deviation;

use deviation::field;
use railsim::error::KeyPath;
use railsim::track::irregularity::{Deviation, DeviationField, Irregularity, Shape, ShapeChannel, Wave};
#[test]
fn the_papers_bumps_have_their_height_and_place() {
    // Three waves of 13.7 m, 20 mm peak to peak, from 275 m to 316.1 m; up, so z is negative.
    let bounce = Irregularity::Shape(Shape::examples().remove(0));
    let field = field(&[bounce], 400.0);
    for (s, z) in [
        (274.9, 0.0),
        (275.0, 0.0),
        (281.85, -0.020),
        (288.7, 0.0),
        (309.25, -0.020),
        (316.1, 0.0),
        (330.0, 0.0),
    ] {
        assert!((field.at(s).z - z).abs() < 1e-12, "{s}");
        assert!(field.at(s).dz_ds.abs() < 1e-11, "{s}");
    }
    let [_, (least, greatest), ..] = field.extremes();
    assert!((least + 0.020).abs() < 1e-8 && greatest == 0.0);
    // Half up the first rise it climbs: z falls.
    assert!(field.at(278.4).dz_ds < 0.0);
    // A repeated group comes again after its period and not before its start.
    let roll = DeviationField::new(
        &[Irregularity::Shape(Shape::examples().remove(2))],
        400.0,
        0.0,
        0.0,
        &KeyPath::of("track.irregularity"),
    )
    .unwrap();
    assert!((roll.at(24.0).cross_level - 0.005).abs() < 1e-15);
    assert!((roll.at(24.0 + 5.0 * 40.0).cross_level - 0.005).abs() < 1e-15);
    assert_eq!(roll.at(24.0 - 40.0).cross_level, 0.0);
}

fn shape(shape: Wave, channel: ShapeChannel, start: f64, length: f64) -> Shape {
    Shape {
        shape,
        channel,
        start,
        length,
        height: None,
        dip_angle: None,
        rise: None,
        rounding: None,
        waves: 1,
        period: None,
        scale: 1.0,
    }
}

/// The field of shapes alone, without fading.
fn shapes<const N: usize>(written: [Shape; N]) -> DeviationField {
    field(&written.map(Irregularity::Shape), 400.0)
}

#[test]
fn a_flat_hump_rises_stays_and_falls() {
    // Rise 1 - cos over 2 m to 25 mm, level over 10 m, fall over 2 m; both rails, up.
    let hump = Shape {
        height: Some(0.025),
        rise: Some(2.0),
        ..shape(Wave::FlatHump, ShapeChannel::Vertical, 100.0, 14.0)
    };
    let hump = shapes([hump]);
    for (s, up) in [
        (100.0, 0.0),
        (101.0, 12.5),
        (102.0, 25.0),
        (107.0, 25.0),
        (112.0, 25.0),
        (113.0, 12.5),
        (114.0, 0.0),
    ] {
        let d = hump.at(s);
        assert!((d.z + 1e-3 * up).abs() < 1e-15, "{s}: {}", d.z);
        // Half up its slope is (pi/2) height/rise.
        let slope = match s {
            101.0 => -0.5 * std::f64::consts::PI * 0.025 / 2.0,
            113.0 => 0.5 * std::f64::consts::PI * 0.025 / 2.0,
            _ => 0.0,
        };
        assert!((d.dz_ds - slope).abs() < 1e-15, "{s}: {}", d.dz_ds);
    }
    // The same as a constant gauge of 1460.5 mm on a track of 1435 mm.
    let wide = Shape {
        height: Some(0.0255),
        rise: Some(5.0),
        ..shape(Wave::FlatHump, ShapeChannel::Gauge, 10.0, 200.0)
    };
    let wide = shapes([wide]);
    for s in [15.0, 100.0, 205.0] {
        assert_eq!((wide.at(s).gauge, wide.at(s).dgauge_ds), (0.0255, 0.0));
    }
    assert_eq!((wide.at(10.0).gauge, wide.at(210.0).gauge), (0.0, 0.0));
}

#[test]
fn a_rounded_kink_is_the_moving_average_of_the_sharp_one() {
    let kink = |rounding| {
        let kink = Shape {
            height: Some(0.015),
            rounding: Some(rounding),
            waves: 3,
            ..shape(Wave::Kink, ShapeChannel::Lateral, 50.0, 10.0)
        };
        shapes([kink])
    };
    let (sharp, width) = (kink(0.0), 1.6);
    let rounded = kink(width);
    // A (1 - |x|/c)+ with A 15 mm, c 5 m.
    for (s, mm) in
        [(50.0, 0.0), (52.5, 7.5), (55.0, 15.0), (57.5, 7.5), (60.0, 0.0), (65.0, 15.0), (80.0, 0.0)]
    {
        assert!((sharp.at(s).y - 1e-3 * mm).abs() < 1e-15, "{s}");
    }
    // The peak is cut by (change of slope) width/8.
    assert!((rounded.at(55.0).y - (0.015 - 0.006 * width / 8.0)).abs() < 1e-15);
    let n = 4000;
    for i in 0..700 {
        let s = 48.0 + 0.0487 * f64::from(i);
        let mean: f64 =
            (0..n).map(|k| sharp.at(s + width * ((f64::from(k) + 0.5) / f64::from(n) - 0.5)).y).sum::<f64>()
                / f64::from(n);
        // The midpoint rule at a corner: (change of slope) (width/n)^2/8/width.
        assert!((rounded.at(s).y - mean).abs() < 1e-9, "{s}: {} {mean}", rounded.at(s).y);
    }
    assert_eq!((rounded.at(49.19).y, rounded.at(80.81).y), (0.0, 0.0));
}

#[test]
fn a_dipped_weld_has_its_angle_and_a_rounded_joint_no_corner() {
    let weld = |rounding| Shape {
        dip_angle: Some(0.02),
        rounding,
        ..shape(Wave::DippedWeld, ShapeChannel::Vertical, 99.0, 2.0)
    };
    let sharp = shapes([weld(None)]);
    // The angle between both sides is the whole dip angle; down in the middle by 0.02 x 2 m/8.
    let (before, after) = (sharp.at(100.0 - 1e-9).dz_ds, sharp.at(100.0 + 1e-9).dz_ds);
    assert!((before - 0.01).abs() < 1e-10 && (after + 0.01).abs() < 1e-10, "{before} {after}");
    assert!((sharp.at(100.0).z - 0.005).abs() < 1e-15);
    for end in [99.0, 101.0] {
        assert!(sharp.at(end).z.abs() < 1e-15 && sharp.at(end).dz_ds.abs() < 1e-15);
    }
    let joints = |rounding| Shape {
        height: Some(0.01905),
        rounding,
        waves: 10,
        ..shape(Wave::RectifiedSine, ShapeChannel::Vertical, 50.0, 11.887)
    };
    let rail = shapes([joints(None)]);
    assert!((rail.at(50.0 + 2.5 * 11.887).z + 0.01905).abs() < 1e-15);
    assert!(rail.at(50.0 + 3.0 * 11.887).z.abs() < 1e-15);
    let quarter = -0.01905 * (0.25 * std::f64::consts::PI).sin();
    assert!((rail.at(50.0 + 4.25 * 11.887).z - quarter).abs() < 1e-15);
    // Rounded, both are continuous in slope across every corner and the same away from it.
    for (rounded, sharp, corners) in [
        (shapes([weld(Some(0.2))]), sharp, vec![100.0]),
        (shapes([joints(Some(0.4))]), rail, (0..=10).map(|k| 50.0 + f64::from(k) * 11.887).collect()),
    ] {
        for corner in corners {
            let jump = rounded.at(corner + 1e-9).dz_ds - rounded.at(corner - 1e-9).dz_ds;
            assert!(jump.abs() < 1e-9, "{corner}: {jump}");
            for d in [-0.21, 0.21] {
                assert!((rounded.at(corner + d).z - sharp.at(corner + d).z).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn one_rail_moves_alone_and_staggered_rails_twist_the_track() {
    let rails = |d: Deviation| {
        [d.z - 0.5 * d.cross_level, d.z + 0.5 * d.cross_level, d.y - 0.5 * d.gauge, d.y + 0.5 * d.gauge]
    };
    let [left_z, right_z, left_y, right_y] = [0, 1, 2, 3];
    for (channel, moved, sign) in [
        (ShapeChannel::LeftVertical, left_z, -1.0),
        (ShapeChannel::RightVertical, right_z, -1.0),
        (ShapeChannel::LeftLateral, left_y, 1.0),
        (ShapeChannel::RightLateral, right_y, 1.0),
    ] {
        let bump = Shape { height: Some(0.02), ..shape(Wave::Versine, channel, 40.0, 12.0) };
        let found = rails(shapes([bump]).at(46.0));
        for (rail, value) in found.into_iter().enumerate() {
            let expected = if rail == moved { sign * 0.02 } else { 0.0 };
            assert!((value - expected).abs() < 1e-16, "{channel:?}: {found:?}");
        }
    }
    // Left z(x), right z(x - L/2): in the middle the rails stand in opposite phase.
    let (length, height) = (13.7, Some(0.02));
    let wave = |channel, start| Shape { height, waves: 5, ..shape(Wave::Versine, channel, start, length) };
    let field = shapes([
        wave(ShapeChannel::LeftVertical, 100.0),
        wave(ShapeChannel::RightVertical, 100.0 + 0.5 * length),
    ]);
    for i in 0..100 {
        let s = 100.0 + 0.61 * f64::from(i);
        let z = |x: f64| {
            if (0.0..5.0 * length).contains(&x) {
                -0.01 * (1.0 - (std::f64::consts::TAU * x / length).cos())
            } else {
                0.0
            }
        };
        let [left, right, ..] = rails(field.at(s));
        assert!((left - z(s - 100.0)).abs() < 1e-15 && (right - z(s - 100.0 - 0.5 * length)).abs() < 1e-15);
    }
    // Half a wave in, the left rail is 20 mm high, the right one low: cross-level 20 mm, centre 10 mm.
    let d = field.at(100.0 + 1.5 * length);
    assert!((d.cross_level - 0.02).abs() < 1e-15 && (d.z + 0.01).abs() < 1e-15);
}

#[test]
fn a_key_that_the_form_needs_or_has_no_use_for_is_named() {
    let at = KeyPath::of("track.irregularity");
    let told = |shape: Shape| -> Vec<String> {
        Irregularity::Shape(shape).faults(&at).iter().map(|f| f.to_string()).collect()
    };
    let plain = |wave| shape(wave, ShapeChannel::Vertical, 10.0, 10.0);
    let with = |wave| Shape { height: Some(0.02), ..plain(wave) };
    assert_eq!(
        told(plain(Wave::Versine)),
        ["track.irregularity.height: found nothing; allowed: a number with shape = \"versine\""]
    );
    assert_eq!(
        told(Shape { rise: Some(2.0), ..with(Wave::Versine) }),
        ["track.irregularity.rise: found it with \"versine\"; allowed: this key with shape = \"flat_hump\""]
    );
    assert_eq!(
        told(with(Wave::FlatHump)),
        ["track.irregularity.rise: found nothing; allowed: a number with shape = \"flat_hump\""]
    );
    assert_eq!(
        told(Shape { rise: Some(6.0), ..with(Wave::FlatHump) }),
        ["track.irregularity.rise: found 6; allowed: above 0 m, at most 5 m, half the length"]
    );
    assert_eq!(
        told(with(Wave::Kink)),
        ["track.irregularity.rounding: found nothing; allowed: a number with shape = \"kink\""]
    );
    assert_eq!(
        told(Shape { rounding: Some(0.1), rise: Some(1.0), ..with(Wave::FlatHump) }),
        [
            "track.irregularity.rounding: found it with \"flat_hump\"; allowed: this key with shape = \"sine\", \
             \"rectified_sine\", \"kink\", \"dipped_weld\""
        ]
    );
    assert_eq!(
        told(Shape { rounding: Some(7.0), ..with(Wave::Kink) }),
        ["track.irregularity.rounding: found 7; allowed: from 0 to 5 m, half the length of a wave"]
    );
    assert_eq!(
        told(Shape { dip_angle: Some(20.0), ..plain(Wave::DippedWeld) }),
        ["track.irregularity.dip_angle: found 20; allowed: from -0.2 to 0.2 rad (a weld of 20 mrad is 0.02)"]
    );
    assert_eq!(
        told(Shape { dip_angle: Some(0.02), ..with(Wave::DippedWeld) }),
        [
            "track.irregularity.height: found it with \"dipped_weld\"; allowed: this key with shape = \"versine\", \
             \"sine\", \"rectified_sine\", \"flat_hump\", \"kink\""
        ]
    );
    assert_eq!(
        told(Shape { rounding: Some(1.0), period: Some(10.5), ..with(Wave::Kink) }),
        ["track.irregularity.period: found 10.5; allowed: 11 m or more, the length of the group"]
    );
}
