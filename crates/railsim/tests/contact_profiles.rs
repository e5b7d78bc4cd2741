//! Profiles from text to geometry table: every format there and back, every way the axes may point, bad input, and no panic for
//! any text.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use proptest::prelude::*;
use railsim::contact::geometry_table::{GeometryTable, Placement};
use railsim::contact::profile::{
    Code, Format, LengthUnit, PointList, Profile, ProfileKind, ReadOptions, Severity, WriteOptions, quality,
    read, write,
};
use railsim::dynamics::compile::geometry_table;
use railsim::schema::Case;
use railsim::{Error, KeyPath};
use serde_json::json;
use std::sync::Arc;

const WHEELS: [&str; 5] = ["anzr1", "anzr1_worn_1", "anzr1_worn_2", "anzr1_worn_high", "s1002"];
const RAILS: [&str; 2] = ["as60", "uic60"];

fn text(name: &str) -> String {
    std::fs::read_to_string(common::models().join(format!("profiles/{name}.csv"))).unwrap()
}

fn shipped(name: &str) -> PointList {
    read(&text(name), name, &ReadOptions::default()).unwrap()
}

fn all() -> impl Iterator<Item = (&'static str, ProfileKind)> {
    WHEELS.into_iter().map(|n| (n, ProfileKind::Wheel)).chain(RAILS.map(|n| (n, ProfileKind::Rail)))
}

/// File names of a kind, one for each extension that can be written.
fn names(kind: ProfileKind) -> &'static [&'static str] {
    match kind {
        ProfileKind::Wheel => {
            &["w.csv", "w", "w.txt", "w.whl", "w.mpt", "w.prw", "w.WHEEL", "folder.d/w.prw"]
        }
        ProfileKind::Rail => &["r.csv", "r", "r.ban", "r.mpt", "r.prr", "r.rail"],
    }
}

fn faults(result: Result<impl std::fmt::Debug, Error>) -> Vec<String> {
    match result {
        Err(Error::Input(faults)) => faults.iter().map(ToString::to_string).collect(),
        other => panic!("not refused: {other:?}"),
    }
}

/// The one message of bad input.
fn message(result: Result<impl std::fmt::Debug, Error>) -> String {
    let all = faults(result);
    assert_eq!(all.len(), 1, "one clear error: {all:#?}");
    println!("{}", all[0]);
    all.into_iter().next().unwrap()
}

#[test]
fn shipped_profiles_are_read_as_they_stand() {
    for (name, kind) in all() {
        let profile = shipped(name);
        let d = &profile.detected;
        assert_eq!(profile.kind, Some(kind), "{name}: {}", d.kind.because);
        assert!(!d.mirrored_y.value && !d.mirrored_z.value && !d.reversed, "{name}");
        let plain = railsim::contact::profile::read_csv(&text(name), name).unwrap();
        assert_eq!(profile.points, plain, "{name}");
        let worst = quality(&profile.points, profile.kind);
        // the back of the S1002's flange starts with a gap of 2 mm: R20.5 sampled every 0.1 mm of y
        let allowed = if name == "s1002" { Severity::Warning } else { Severity::Note };
        assert!(worst.iter().all(|f| f.severity <= allowed), "{name}: {worst:?}");
    }
}

#[test]
fn every_format_gives_the_same_points_again() {
    for (name, kind) in all() {
        let points = shipped(name).points;
        for file in names(kind) {
            let options =
                WriteOptions { title: format!("{name}, 'as' \"shipped\"\n# or not"), ..Default::default() };
            let written = write(&points, file, &options).unwrap();
            let again = read(&written, file, &ReadOptions::default()).unwrap();
            assert_eq!(again.points, points, "{name} as {file}: {:#?}", again.detected);
            assert_eq!(again.kind, Some(kind), "{name} as {file}");
        }
        // a .rail file may be MiniProf's: its content says so
        let options = WriteOptions { format: Some(Format::Miniprof), ..Default::default() };
        if kind == ProfileKind::Rail {
            let again = read(&write(&points, "r.rail", &options).unwrap(), "r.rail", &ReadOptions::default())
                .unwrap();
            assert_eq!(again.detected.format.value, Format::Miniprof);
            assert_eq!(again.points, points);
        }
    }
}

#[test]
fn a_rail_file_is_told_by_its_content() {
    let points = shipped("uic60").points;
    let of = |format| {
        let options = WriteOptions { format: Some(format), ..Default::default() };
        let written = write(&points, "r.rail", &options).unwrap();
        read(&written, "r.rail", &ReadOptions::default()).unwrap().detected.format
    };
    for (written, found) in [
        (Format::Gensys, Format::Gensys),
        (Format::Miniprof, Format::Miniprof),
        (Format::Simpack, Format::Simpack),
    ] {
        let told = of(written);
        println!("{written:?}: {told:?}");
        assert_eq!(told.value, found);
    }
}

/// Whichever way a wheel's axes point and its points run, it comes out the same; a rail but for its gauge side.
#[test]
fn axes_and_order_are_detected() {
    for (name, kind) in all() {
        let points = shipped(name).points;
        for turned in 0..8 {
            let (y_turned, z_turned, order) = (turned & 1 != 0, turned & 2 != 0, turned & 4 != 0);
            if kind == ProfileKind::Rail && y_turned {
                continue;
            }
            let sign = |is: bool| if is { -1e3 } else { 1e3 };
            let mut rows: Vec<String> = points
                .iter()
                .map(|p| format!("{} {}", sign(y_turned) * p[0], sign(z_turned) * p[1]))
                .collect();
            if order {
                rows.reverse();
            }
            let found = read(&rows.join("\n"), "x.csv", &ReadOptions::default()).unwrap();
            let d = &found.detected;
            assert_eq!(found.kind, Some(kind));
            assert_eq!((d.mirrored_y.value, d.mirrored_z.value), (y_turned, z_turned), "{name}: {d:?}");
            assert_eq!(d.reversed, order); // seen after mirroring
            for (a, b) in found.points.iter().zip(&points) {
                assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-15);
            }
        }
    }
}

#[test]
fn options_overrule_detection() {
    let points = shipped("s1002").points;
    let rows: Vec<String> = points.iter().map(|p| format!("{} {}", p[0], p[1])).collect();
    let metres = rows.join("\n");
    let options = ReadOptions { unit: Some(LengthUnit::M), ..Default::default() };
    assert_eq!(read(&metres, "x", &options).unwrap().points, points);
    let options = ReadOptions { mirror_z: Some(true), mirror_y: Some(true), ..options };
    let turned = read(&metres, "x", &options).unwrap();
    assert_eq!(turned.points[0], [-points[1300][0], -points[1300][1]]);
    assert_eq!(turned.detected.mirrored_z.because, "asked for");
    // MiniProf rails have their gauge side at positive x; mirrored otherwise
    let rail = shipped("uic60").points;
    let written = write(&rail, "r.ban", &WriteOptions::default()).unwrap();
    let options = ReadOptions { mirror_y: Some(false), ..Default::default() };
    let other = read(&written, "r.ban", &options).unwrap();
    assert_eq!(other.points[0][0], -rail[rail.len() - 1][0]);
    // as another format: SIMPACK's sections are no columns
    let written = write(&rail, "r.prr", &WriteOptions::default()).unwrap();
    let options = ReadOptions { format: Some(Format::Csv), ..Default::default() };
    assert!(faults(read(&written, "r.prr", &options)).len() > 1);
}

/// The same rail in metres, turned by 20 degrees, shifted, mirrored, inverted and with points beyond its bounds, undone by the header.
#[test]
fn simpack_headers_are_undone() {
    let points = shipped("as60").points;
    let (sin, cos) = 0.3_f64.sin_cos();
    let mut rows = vec!["-0.9 0.2 ! beyond the bounds".to_owned()];
    rows.extend(points.iter().map(|p| {
        let [y, z] = [-p[0], -p[1]];
        format!("{:e} {:e} 1.0", y * cos + z * sin - 0.01, z * cos - y * sin + 0.002)
    }));
    let degrees = 0.3_f64.to_degrees();
    let file = format!(
        "! rail\nheader.begin\n version = 1\n type = 0\nheader.end\nspline.begin\n approx.smooth = 0.5\n shift.y = 0.01\n \
         shift.z = -0.002\n rotate = {degrees:e} ! degrees\n bound.y.min = -0.5\n bound.y.max = 0.5\n mirror.y = 1\n \
         mirror.z = 1\n inversion = 1\n units.len.f = 1.0\n units.ang.f = {:e}\n point.begin\n{}\n point.end\nspline.end\n",
        1.0_f64.to_degrees(),
        rows.join("\n")
    );
    let found = read(&file, "x.prr", &ReadOptions::default()).unwrap();
    assert_eq!(found.points.len(), points.len());
    for (a, b) in found.points.iter().zip(&points) {
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-15, "{a:?} {b:?}");
    }
    assert_eq!(found.detected.notes.len(), 2, "{:?}", found.detected.notes);
}

/// A VAMPIRE file as the reader of CONTACT expects it, left and right from the track centre.
#[test]
fn vampire_files_are_read_with_their_header_or_as_two_columns() {
    let wheel = shipped("s1002").points;
    let row = |p: &[f64; 2], centre: f64, sign: f64| {
        let (y, z) = (1e3 * p[0] + centre, sign * 1e3 * p[1]);
        format!("{} {z} {y} {z}", -y)
    };
    let rows = |points: &[[f64; 2]], centre: f64, sign: f64| {
        points.iter().map(|p| row(p, centre, sign)).collect::<Vec<_>>().join("\n")
    };
    let file =
        format!("WHEELPROFILE\nS1002\nTREADDATUM EUROPEAN\nFLANGEBACK 1360\n{}\n", rows(&wheel, 750.0, 1.0));
    let found = read(&file, "w.whe", &ReadOptions::default()).unwrap();
    let far = |a: &[[f64; 2]], b: &[[f64; 2]]| {
        a.iter().zip(b).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
    };
    assert_eq!(found.kind, Some(ProfileKind::Wheel));
    assert!(far(&found.points, &wheel) < 1e-12);
    let rail = shipped("uic60").points;
    let file = format!("RAILPROFILE\nUIC60\nGAUGEPOINT EUROPEAN\nGAUGE 1435\n{}\n", rows(&rail, 753.5, -1.0));
    let found = read(&file, "r.rai", &ReadOptions::default()).unwrap();
    assert_eq!((found.kind, found.detected.mirrored_z.value), (Some(ProfileKind::Rail), true));
    assert!(far(&found.points, &rail) < 1e-12);
    // two plain columns
    let plain = text("s1002").lines().filter(|l| !l.starts_with('y')).collect::<Vec<_>>().join("\n");
    assert_eq!(read(&plain, "w.whe", &ReadOptions::default()).unwrap().points, wheel);
    // neither
    let nothing = message(read("1 2 3\n4 5 6\n", "w.whe", &ReadOptions::default()));
    assert!(nothing.contains("no specification of VAMPIRE files is public"), "{nothing}");
    let bad = message(read(
        "WHEELPROFILE\nx\nTREADDATUM NONE\nFLANGEBACK 1360\n0 0 0 0\n",
        "w.whe",
        &ReadOptions::default(),
    ));
    assert!(bad.contains("TREADDATUM and EUROPEAN"), "{bad}");
    let no = message(write(&wheel, "w.whe", &WriteOptions::default()));
    assert!(no.contains("VAMPIRE"), "{no}");
}

/// A case with one profile replaced, points in mm; what becomes of it on its way to the geometry table.
fn table_of(kind: &str, points: &[[f64; 2]]) -> Result<Arc<GeometryTable>, Error> {
    let mut case = common::coco134();
    let name = if kind == "wheel" { "anzr1" } else { "as60" };
    case["profiles"][name]["points"] = json!(points);
    geometry_table(&Case::from_value(&case)?)
}

fn in_mm(name: &str) -> Vec<[f64; 2]> {
    shipped(name).points.iter().map(|p| p.map(|x| 1e3 * x)).collect()
}

#[test]
fn a_profile_of_the_wrong_kind() {
    let wheel_as_rail = message(table_of("rail", &in_mm("s1002")));
    assert!(wheel_as_rail.contains("profiles.as60.points: found the shape of a wheel"), "{wheel_as_rail}");
    let rail_as_wheel = message(table_of("wheel", &in_mm("as60")));
    assert!(rail_as_wheel.contains("profiles.anzr1.points: found the shape of a rail"), "{rail_as_wheel}");
    let rail = ReadOptions { kind: Some(ProfileKind::Rail), ..Default::default() };
    assert!(message(read(&text("s1002"), "s1002", &rail)).contains("the shape of a wheel"));
    let columns = text("s1002").replace("y_mm,z_mm\n", "");
    assert!(message(read(&columns, "s1002.rail", &ReadOptions::default())).contains("extension .rail"));
    assert!(
        message(read(&text("s1002"), "s1002.prw", &ReadOptions::default())).contains("neither header.begin")
    );
    let wheel = write(&shipped("s1002").points, "w.prw", &WriteOptions::default()).unwrap();
    assert!(message(read(&wheel, "w.prr", &ReadOptions::default())).contains("type = 1"));
}

#[test]
fn a_profile_turned_round() {
    let mirrored: Vec<_> = in_mm("s1002").iter().map(|p| [-p[0], p[1]]).collect();
    assert!(message(table_of("wheel", &mirrored)).contains("the flange at positive y"));
    let upside_down: Vec<_> = in_mm("as60").iter().map(|p| [p[0], -p[1]]).collect();
    assert!(message(table_of("rail", &upside_down)).contains("z down"));
}

#[test]
fn metres_for_millimetres() {
    let metres: Vec<_> = in_mm("s1002").iter().map(|p| p.map(|x| 1e-3 * x)).collect();
    let found = message(table_of("wheel", &metres));
    assert!(found.contains("1000 times too narrow"), "{found}");
    let rows: Vec<String> = metres.iter().map(|p| format!("{} {}", p[0], p[1])).collect();
    for name in ["x.csv", "x.whl", "x.wheel"] {
        let found = message(read(&rows.join("\n"), name, &ReadOptions::default()));
        assert!(found.contains("1000 times too narrow") && found.contains("option unit"), "{found}");
    }
    let points = &shipped("as60").points;
    let wrong = write(points, "x.prr", &WriteOptions::default())
        .unwrap()
        .replace("units.len.f = 1000", "units.len.f = 1");
    assert!(message(read(&wrong, "x.prr", &ReadOptions::default())).contains("1000 times too wide"));
    let micrometres: Vec<_> = in_mm("s1002").iter().map(|p| p.map(|x| 1e3 * x)).collect();
    assert!(message(table_of("wheel", &micrometres)).contains("1000 times too wide"));
}

#[test]
fn a_profile_that_crosses_itself() {
    let mut points = in_mm("s1002");
    points.swap(600, 620);
    let swapped = message(table_of("wheel", &points));
    assert!(swapped.contains("crosses itself near y = "), "{swapped}");
    let found =
        quality(&points.iter().map(|p| p.map(|x| 1e-3 * x)).collect::<Vec<_>>(), Some(ProfileKind::Wheel));
    assert_eq!((found[0].code, found[0].severity), (Code::SelfCrossing, Severity::Error), "{found:?}");
}

#[test]
fn three_points_and_points_that_are_no_numbers() {
    assert!(message(table_of("wheel", &in_mm("s1002")[..3])).contains("3 points"));
    let three = read("-10,0\n0,0\n10,0\n", "x.csv", &ReadOptions::default()).unwrap();
    assert!(message(Profile::new(&three.points, ProfileKind::Wheel, &KeyPath::of("p"))).contains("3 points"));
    for (name, row) in [("x.csv", "nan 1"), ("x.whl", "1 NaN"), ("x.wheel", "inf 0"), ("x.whe", "1 nan")] {
        let text = format!("0 0\n{row}\n2 0\n");
        let found = message(read(&text, name, &ReadOptions::default()));
        assert!(found.contains("finite"), "{name}: {found}");
    }
    let mut points = shipped("as60").points;
    points[10][1] = f64::NAN;
    let found = message(Profile::new(&points, ProfileKind::Rail, &KeyPath::of("p")));
    assert!(found.starts_with("p[10]: found [") && found.contains("NaN"), "{found}");
    assert!(message(write(&points, "x.csv", &WriteOptions::default())).contains("NaN"));
    assert!(message(read("", "x.csv", &ReadOptions::default())).contains("no point"));
}

#[test]
fn names_that_cannot_be_written() {
    let points = shipped("as60").points;
    let refused = |name: &str, options: &WriteOptions| message(write(&points, name, options));
    assert!(refused("x.xyz", &WriteOptions::default()).contains(".csv, .txt"));
    let simpack = WriteOptions { format: Some(Format::Simpack), ..Default::default() };
    assert!(refused("x", &simpack).contains("neither wheel nor rail"));
    let wheel = WriteOptions { kind: Some(ProfileKind::Wheel), ..Default::default() };
    assert!(refused("x.prr", &wheel).contains("a wheel for .prr"));
    assert!(message(write(&[], "x.csv", &WriteOptions::default())).contains("no point"));
}

const PLACEMENT: Placement = Placement {
    gauge: 1.435,
    gauge_point_depth: 0.014,
    rail_inclination: 0.05,
    tape_half_distance: 0.750,
    wheel_radius: 0.460,
    youngs_modulus: 210e9,
    poisson: 0.28,
};

/// Every rail at 1:20, 1:40 and upright, its gauge measured 14 and 16 mm below the top: the gauge point lies that deep on the
/// inclined rail, half a gauge from the track centre, and the top at z = 0.
#[test]
fn rails_stand_at_every_inclination_and_gauge_depth() {
    let wheel = shipped("s1002").points;
    let wheel = Profile::new(&wheel, ProfileKind::Wheel, &KeyPath::of("w")).unwrap();
    for name in RAILS {
        let rail = Profile::new(&shipped(name).points, ProfileKind::Rail, &KeyPath::of("r")).unwrap();
        for slope in [0.0, 0.025, 0.05] {
            for depth in [0.014, 0.016] {
                let placement = Placement { gauge_point_depth: depth, rail_inclination: slope, ..PLACEMENT };
                let table = GeometryTable::build(&wheel, &rail, &placement).unwrap();
                let top = table.rail().points.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
                assert!(top.abs() < 1e-6, "{name} 1:{:.0}: top at {top}", 1.0 / slope);
                let gauge_point = 0.5 * placement.gauge - table.rail_origin_y();
                // on the polyline of the gauge side
                let at = table
                    .rail()
                    .points
                    .windows(2)
                    .filter(|w| w[0][0] < 0.0 && (w[0][1] - depth) * (w[1][1] - depth) <= 0.0)
                    .map(|w| w[0][0] + (w[1][0] - w[0][0]) * (w[0][1] - depth) / (w[0][1] - w[1][1]))
                    .fold(f64::INFINITY, |a: f64, y| {
                        if (y - gauge_point).abs() < (a - gauge_point).abs() { y } else { a }
                    });
                println!(
                    "{name} slope {slope:.3}, gauge {:.0} mm below: origin at {:.3} mm, conicity at 3 mm {:?}",
                    1e3 * depth,
                    1e3 * table.rail_origin_y(),
                    table.equivalent_conicity(3e-3)
                );
                assert!((at - gauge_point).abs() < 1e-9, "{at} {gauge_point}");
                assert!(table.gap(0.0, 0.0).unwrap()[0].is_finite());
            }
        }
    }
}

/// Inclinations and gauge depths of a case reach the table.
#[test]
fn track_files_say_inclination_and_gauge_depth() {
    for (slope, depth) in [(0.0, 0.014), (0.025, 0.016), (0.05, 0.014)] {
        let mut case = common::coco134();
        case["track"]["rail_inclination"] = json!(slope);
        case["track"]["gauge_point_depth"] = json!(depth);
        let table = geometry_table(&common::case(&case)).unwrap();
        assert!((table.rail().slope(0.0).unwrap() + slope).abs() < 1e-4);
    }
    let mut case = common::coco134();
    case["track"]["gauge_point_depth"] = json!(0.04);
    assert!(
        message(geometry_table(&common::case(&case)))
            .contains("a depth that the gauge side of the rail profile reaches")
    );
}

/// The anzr1 flange stands 38 mm inward 10 mm below the running circle, at 70 degrees: 39.46 mm at the 14 mm of this gauge; its rim
/// ends at 54.92 mm. So gauges from 2 (750 - 39.46) to 1500 - 39.46 + 54.92 mm hold it.
#[test]
fn a_gauge_that_lets_the_wheelset_fall_in_or_wedges_it() {
    let table = |gauge: f64| {
        let mut case = common::coco134();
        case["track"]["gauge"] = json!(gauge);
        case["track"]["gauge_point_depth"] = json!(0.014);
        geometry_table(&common::case(&case))
    };
    let wide = message(table(1.6));
    assert!(wide.starts_with("track.gauge: found 1.6 m") && wide.contains("falls in"), "{wide}");
    assert!(wide.contains("allowed: 1.4211 to 1.5155 m"), "{wide}");
    assert!(message(table(1.4)).contains("too far apart"));
    for gauge in [1.422, 1.435, 1.514] {
        assert!(table(gauge).is_ok());
    }
}

/// Points of a shipped profile, thinned, and moved by decimals of mm: what rounding and measuring leave.
fn points() -> impl Strategy<Value = (Vec<[f64; 2]>, ProfileKind)> {
    let name = prop::sample::select(all().collect::<Vec<_>>());
    (name, 1..12_usize, prop::collection::vec((-2_000_000..2_000_000_i64, -2_000_000..2_000_000_i64), 2000))
        .prop_map(|((name, kind), every, moves)| {
            let decimals = |x: f64, by: i64| (((x * 1e12).round() as i64 + by) as f64 / 1e9) * 1e-3;
            let points = shipped(name).points;
            let last = points.len() - 1;
            let kept = (0..points.len()).filter(|i| i % every == 0 || *i == last);
            let moved =
                kept.zip(moves).map(|(i, (y, z))| [decimals(points[i][0], y), decimals(points[i][1], z)]);
            (moved.collect(), kind)
        })
}

/// Everything that a text can go through.
fn through(text: &str, name: &str, options: &ReadOptions) {
    let Ok(profile) = read(text, name, options) else { return };
    let _ = quality(&profile.points, profile.kind);
    for kind in [ProfileKind::Wheel, ProfileKind::Rail] {
        let _ = Profile::new(&profile.points, kind, &KeyPath::of("p"));
    }
    for format in [Format::Csv, Format::Miniprof, Format::Simpack, Format::Gensys] {
        let options = WriteOptions { format: Some(format), kind: profile.kind, title: name.to_owned() };
        let _ = write(&profile.points, "x", &options);
    }
}

const NAMES: [&str; 14] = [
    "x", "x.csv", "x.whl", "x.ban", "x.mpt", "x.rail", "x.wheel", "x.prw", "x.prr", "x.whe", "x.rai",
    "a/b.c/", "\u{e9}.", "",
];

fn options() -> impl Strategy<Value = ReadOptions> {
    let kind = prop::option::of(prop::sample::select(vec![ProfileKind::Wheel, ProfileKind::Rail]));
    let format = prop::option::weighted(
        0.3,
        prop::sample::select(vec![
            Format::Csv,
            Format::Miniprof,
            Format::Simpack,
            Format::Gensys,
            Format::Vampire,
        ]),
    );
    let unit = prop::option::weighted(
        0.2,
        prop::sample::select(vec![LengthUnit::Mm, LengthUnit::Cm, LengthUnit::M, LengthUnit::In]),
    );
    let turned = || prop::option::weighted(0.2, any::<bool>());
    (kind, format, unit, turned(), turned()).prop_map(|(kind, format, unit, mirror_y, mirror_z)| {
        ReadOptions { kind, format, unit, mirror_y, mirror_z }
    })
}

/// A valid file with parts of it replaced, dropped, doubled or cut off.
fn mutated() -> impl Strategy<Value = (String, &'static str)> {
    let file = (
        points(),
        prop::sample::select(vec![Format::Csv, Format::Miniprof, Format::Simpack, Format::Gensys]),
    );
    let token = prop::sample::select(vec![
        "nan",
        "inf",
        "-1e308",
        "1e-320",
        "=",
        "\n",
        "\n\n",
        "[",
        "]",
        "'",
        "!",
        "\"",
        ";",
        ",",
        "0",
        "-",
        "header.begin",
        "point.end",
        "ColumnDef=Y,X\n",
        "XOffset=1e308\n",
        "units.len.f = 1e-6\n",
        "rotate = 1\n",
        "WHEELPROFILE\n",
        "[P1Points]\n",
        "\u{feff}",
        "\u{1F682}",
        "1 2 3 4\n",
    ]);
    let edit = (any::<prop::sample::Index>(), 0..80_usize, token);
    (file, prop::collection::vec(edit, 0..6), prop::sample::select(NAMES.to_vec())).prop_map(
        |(((points, kind), format), edits, name)| {
            let options = WriteOptions { format: Some(format), kind: Some(kind), title: String::new() };
            let mut text: Vec<char> = write(&points, "x", &options).unwrap().chars().collect();
            for (place, dropped, token) in edits {
                let from = place.index(text.len() + 1);
                let to = (from + dropped).min(text.len());
                text.splice(from..to, token.chars());
            }
            (text.into_iter().collect(), name)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_is_written_is_read_again((points, kind) in points()) {
        for name in names(kind) {
            let written = write(&points, name, &WriteOptions::default()).unwrap();
            let options = ReadOptions { kind: Some(kind), ..Default::default() };
            let again = read(&written, name, &options).unwrap();
            prop_assert_eq!(&again.points, &points, "{}", name);
        }
    }

    #[test]
    fn no_bytes_make_it_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..400),
        name in prop::sample::select(NAMES.to_vec()),
        options in options(),
    ) {
        through(&String::from_utf8_lossy(&bytes), name, &options);
    }

    #[test]
    fn no_numbers_make_it_panic(
        rows in prop::collection::vec((any::<f64>(), any::<f64>(), -0.2..0.2, -0.2..0.2, 0..4), 0..60),
        name in prop::sample::select(NAMES.to_vec()),
        options in options(),
    ) {
        let rows: Vec<String> = rows.iter().map(|(a, b, y, z, k)| match k {
            0 => format!("{a} {b}"),
            1 => format!("{:.3} {:.3}", 1e3 * y, 1e3 * z),
            _ => format!("{:.3} {:.1}", 2e2 * y, 1e2 * z),
        }).collect();
        through(&rows.join("\n"), name, &options);
    }

    #[test]
    fn no_damaged_file_makes_it_panic((text, name) in mutated(), options in options()) {
        through(&text, name, &options);
    }
}
