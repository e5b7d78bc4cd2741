//! Measured tracks: through their samples, in their units, repeated, and what is wrong with a record.

#![allow(clippy::unwrap_used, reason = "test helpers")]

#[path = "common/deviation.rs"]
mod deviation;

use deviation::{field, slopes, values};
use railsim::error::{Error, KeyPath};
use railsim::track::irregularity::{DeviationField, Irregularity, Measured};
fn record(text: &str) -> Measured {
    Measured {
        file: "line_12.csv".into(),
        sha256: None,
        text: Some(text.into()),
        start: 0.0,
        repeat_blend: None,
        scale: 1.0,
    }
}

#[test]
fn a_measured_track_passes_through_its_samples_in_their_units_and_signs() {
    // Every 0.1 m and unevenly; places in km, deviations in mm and inches, a column that is not ours.
    let wave = |s: f64| 4.0 * (s / 5.0).sin();
    let places: Vec<f64> = (0..1500).map(|i| 0.1 * f64::from(i) + 0.03 * f64::from(i % 3)).collect();
    let lines: String = places
        .iter()
        .map(|s| format!("{:.9},{:.9},x,{:.9},{:.9}\n", s / 1000.0, wave(*s), -0.1 * wave(*s), 0.5))
        .collect();
    let text = format!("# measured\n\ns_km,vertical_mm,remark,left_lateral_in,gauge_mm\n{lines}");
    let field = field(&[Irregularity::Measured(Measured { start: 7.0, scale: 2.0, ..record(&text) })], 140.0);
    for s in places.iter().skip(1).step_by(7) {
        let d = field.at(s + 7.0);
        let left = 2.0 * 0.0254 * -0.1 * wave(*s);
        let expected = [0.5 * left, -2e-3 * wave(*s), 0.0, 1e-3 - left];
        for (ours, theirs) in values(d).into_iter().zip(expected) {
            // Written with nine digits behind the point, of mm, inches and km.
            assert!((ours - theirs).abs() < 1e-9, "{s}: {ours} {theirs}");
        }
    }
    // Between them it errs by some third of (step)^3 times the third derivative/9 sqrt 3.
    for i in 0..500 {
        let s = 10.0 + 0.251 * f64::from(i);
        let d = field.at(s + 7.0);
        assert!((d.z + 2e-3 * wave(s)).abs() < 1e-7, "{s}: {} {}", d.z, -2e-3 * wave(s));
        assert!((d.dz_ds + 8e-3 / 5.0 * (s / 5.0).cos()).abs() < 2e-6, "{s}");
    }
    // Held outside.
    assert_eq!((field.at(-30.0).gauge, field.at(-30.0).dgauge_ds), (field.at(7.0).gauge, 0.0));
}

#[test]
fn a_repeated_record_passes_smoothly_from_its_end_into_its_start() {
    let example = Measured::examples().remove(1);
    let (blend, start) = (example.repeat_blend.unwrap(), example.start);
    let length = 0.25 * 1999.0;
    let period = length - blend;
    let field = field(&[Irregularity::Measured(example)], 2000.0);
    // Between the passages the record repeats.
    for s in [start + blend + 1.0, start + 200.0, start + period - 1.0] {
        for (a, b) in values(field.at(s)).into_iter().zip(values(field.at(s + 2.0 * period))) {
            assert!((a - b).abs() < 1e-12, "{s}");
        }
    }
    // Across both ends of the passage value and slope are continuous, though the record's ends differ by 150 mm.
    for seam in [start + period, start + period + blend, start + 2.0 * period] {
        let (a, b) = (field.at(seam - 1e-7), field.at(seam + 1e-7));
        for (a, b) in values(a).into_iter().zip(values(b)).chain(slopes(a).into_iter().zip(slopes(b))) {
            assert!((a - b).abs() < 1e-7, "{seam}: {a} {b}");
        }
    }
}

#[test]
fn what_is_wrong_with_a_record_is_told_with_its_line() {
    let told = |measured: Measured, length: f64| -> Vec<String> {
        let at = KeyPath::of("track.irregularity");
        match DeviationField::new(&[Irregularity::Measured(measured)], length, 0.0, 0.0, &at) {
            Err(Error::Input(faults)) => faults.iter().map(ToString::to_string).collect(),
            other => panic!("{other:?}"),
        }
    };
    let names = "s_m and lateral_mm, vertical_mm, cross_level_mm, gauge_mm, left_vertical_mm, ...";
    let file = "track.irregularity.file: found \"line_12.csv\", ";
    let good = "s_m,vertical_mm\n0,1\n10,2\n20,1\n";
    for (text, message) in [
        ("", "an empty file; allowed: a line of column names, then lines of numbers".to_owned()),
        (
            "place,vertical_mm\n0,1\n1,2\n",
            format!(
                "line 1: no column of places (or several): place,vertical_mm; allowed: {names} (a column's name ends in its \
                 unit: s_m, s_km)"
            ),
        ),
        (
            "# top\ns_m,profile_mm\n0,1\n",
            format!("line 2: no column of a channel: s_m,profile_mm; allowed: {names}"),
        ),
        (
            "s_m,gauge_mm,gauge_in\n0,1,1\n",
            "line 1: two columns of the same channel: s_m,gauge_mm,gauge_in; allowed: one column for each channel".into(),
        ),
        (
            "s_m,vertical_mm\n0,1\n10,2\n10,3\n",
            "line 4: place 10 m after 10 m; allowed: places that increase from line to line".into(),
        ),
        ("s_m,vertical_mm\n0,1\n10,two\n", "line 3: \"two\"; allowed: a number in every column".into()),
        ("s_m,vertical_mm\n0,1\n10,nan\n", "line 3: \"nan\"; allowed: a number in every column".into()),
        (
            "s_m,vertical_mm\n0,1\n10\n",
            "line 3: 1 columns where the first line names 2; allowed: a number in every column".into(),
        ),
        (
            "s_m,gauge_mm\n0,1435\n10,1436\n",
            "line 2: a deviation of 1.435 m; allowed: at most 0.5 m (deviations from the design, the gauge's too: not the \
             gauge itself)"
                .into(),
        ),
        ("s_m,gauge_mm\n0,1\n", "1 samples; allowed: two samples or more".into()),
    ] {
        assert_eq!(told(record(text), 10.0), [format!("{file}{message}")]);
    }
    assert_eq!(
        told(record(good), 30.0),
        [format!(
            "{file}a record to 20 m; allowed: one that goes on to 30 m, the end of the track (repeat_blend = 50.0 repeats \
             it, passing over 50 m)"
        )]
    );
    assert_eq!(
        told(Measured { text: None, ..record(good) }, 20.0),
        [format!("{}which nobody has read; allowed: a file whose text is handed over with the case", file)]
    );
    assert_eq!(
        told(Measured { repeat_blend: Some(11.0), ..record(good) }, 20.0),
        [
            "track.irregularity.repeat_blend: found 11; allowed: above 0 m, at most 10 m, half the record's length"
        ]
    );
    assert!(
        told(Measured { start: 40.0, ..record(good) }, 30.0)[0]
            .starts_with("track.irregularity.start: found 40 m")
    );
    field(&[Irregularity::Measured(record(good))], 20.0);
}
