//! Creep laws against other people's numbers: CONTACT's curves, Kalker's table, a locomotive's traction curve. Prints ours, theirs, difference.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use railsim::contact::creep::{
    CreepLaw, Creepage, Fastrip, Fastsim, KalkerLinear, ModifiedFastsim, Patch, Polach, ShenHedrickElkins,
    VermeulenJohnson,
};
use railsim::contact::friction::Falling;
use railsim::contact::kalker_table;
use std::path::PathBuf;

fn data(name: &str) -> String {
    std::fs::read_to_string(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)).unwrap()
}

/// The folder with files that are not ours to copy: beside the project, or where the variable says.
fn fetched(name: &str) -> Option<String> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let folder = std::env::var_os("LMAP_SHARED").map_or(beside, PathBuf::from);
    let text = std::fs::read_to_string(folder.join("data/fetched").join(name)).ok();
    if text.is_none() {
        println!("skipped: data/fetched/{name} is not there (LMAP_SHARED says where)");
    }
    text
}

/// Kalker 1990, Table E.3 (C33: 1967), at every node and Poisson's ratio of the table.
#[test]
fn kalkers_table_at_its_nodes() {
    let Some(text) = fetched("kalker_table_published.csv") else { return };
    let mut worst = 0.0_f64;
    let mut nodes = 0;
    for line in text.lines().filter(|l| !l.starts_with('#') && !l.starts_with("a_over_b")) {
        let v: Vec<f64> = line.split(',').map(|f| f.parse().unwrap()).collect();
        // the file rounds b/a = 0.9 to a/b = 1.111111
        let ratio = if v[0] > 1.0 { 1.0 / ((10.0 / v[0]).round() / 10.0) } else { v[0] };
        for (k, nu) in [0.0, 0.25, 0.5].into_iter().enumerate() {
            let c = kalker_table::coefficients(ratio, nu);
            for (i, ours) in [c.c11, c.c22, c.c23, c.c33].into_iter().enumerate() {
                worst = worst.max((ours / v[1 + 3 * i + k] - 1.0).abs());
                nodes += 1;
            }
        }
    }
    println!("{nodes} nodes of Kalker's table, largest relative difference {worst:.1e}");
    assert!(nodes == 19 * 12 && worst < 1e-12);
}

/// One row of the curves of CONTACT (Hertzian, 100 kN, a = b = 6 mm, mu 0.3, G 82 GPa, nu 0.28); moments over mu N c.
struct Row {
    method: String,
    kind: String,
    c: Creepage,
    f: [f64; 3],
}

const MU: f64 = 0.3;

fn patch() -> (Patch, f64) {
    let k = kalker_table::coefficients(1.0, 0.28);
    let p = Patch { a: 6e-3, b: 6e-3, n: 1e5, c11: k.c11, c22: k.c22, c23: k.c23, shear_modulus: 82e9 };
    (p, k.c33)
}

/// Their y is ours reversed: Fy, eta and phi change sign together, and so does the moment: the numbers stay.
fn curves() -> Vec<Row> {
    data("creep_force_curves_ab1.csv")
        .lines()
        .filter(|l| !l.starts_with('#') && !l.starts_with("a_over_b"))
        .map(|line| {
            let f: Vec<&str> = line.split(',').collect();
            let number = |i: usize| f[i].parse::<f64>().unwrap();
            Row {
                method: f[3].to_owned(),
                kind: f[5].to_owned(),
                c: Creepage { xi: number(9), eta: number(10), phi: 1e3 * number(11) },
                f: [number(16), number(17), number(18)],
            }
        })
        .collect()
}

struct Errors {
    mean: f64,
    largest: f64,
    rows: usize,
}

fn errors(rows: &[Row], method: &str, kind: &str, ours: impl Fn(&Creepage) -> [f64; 2]) -> Errors {
    let all: Vec<f64> = rows
        .iter()
        .filter(|r| r.method == method && (kind == "all" || r.kind == kind))
        .map(|r| {
            let f = ours(&r.c);
            (f[0] - r.f[0]).hypot(f[1] - r.f[1])
        })
        .collect();
    assert!(!all.is_empty());
    Errors {
        mean: all.iter().sum::<f64>() / all.len() as f64,
        largest: all.iter().copied().fold(0.0, f64::max),
        rows: all.len(),
    }
}

fn force(law: &CreepLaw, p: &Patch, c: &Creepage) -> [f64; 2] {
    let f = law.force(p, c, MU);
    [f.fx / (MU * p.n), f.fy / (MU * p.n)]
}

/// Every law against the exact theory over the whole grid of creepages: the table of docs/concepts/creep.md. The bounds are the
/// methods' errors as found, rounded up; the order FaStrip, FASTSIM, Polach is the literature's.
#[test]
fn every_law_against_contact() {
    let rows = curves();
    let (p, _) = patch();
    let fine = 200;
    let laws: [(&str, CreepLaw, [f64; 2]); 7] = [
        (
            "FaStrip, 200 x 200",
            CreepLaw::Fastrip(Fastrip { nx: fine, ny: fine, poisson: Some(0.28) }),
            [0.02, 0.12],
        ),
        (
            "FaStrip, 20 x 20",
            CreepLaw::Fastrip(Fastrip { poisson: Some(0.28), ..Fastrip::default() }),
            [0.02, 0.12],
        ),
        ("FASTSIM, 200 x 200", CreepLaw::Fastsim(Fastsim { nx: fine, ny: fine }), [0.04, 0.16]),
        ("FASTSIM, 10 x 10", CreepLaw::default(), [0.05, 0.21]),
        ("Polach, k_a = k_s = 1", CreepLaw::Polach(Polach::default()), [0.1, 0.4]),
        ("Shen-Hedrick-Elkins", CreepLaw::ShenHedrickElkins(ShenHedrickElkins {}), [0.2, 1.0]),
        (
            "Vermeulen-Johnson",
            CreepLaw::VermeulenJohnson(VermeulenJohnson { poisson: Some(0.28) }),
            [0.4, 1.1],
        ),
    ];
    println!("| law | xi | eta | spin | combined | all |");
    let mut means = Vec::new();
    for (name, law, bounds) in &laws {
        print!("| {name} |");
        for kind in ["xi", "eta", "phi", "comb", "all"] {
            let e = errors(&rows, "CONTACT", kind, |c| force(law, &p, c));
            print!(" {:.3}, {:.3} |", e.mean, e.largest);
            if kind == "all" {
                means.push(e.mean);
                println!(" {} rows", e.rows);
                assert!(e.mean < bounds[0] && e.largest < bounds[1], "{name}: {} {}", e.mean, e.largest);
            }
        }
    }
    assert!(means[0] < means[2] && means[2] < means[4], "FaStrip, FASTSIM, Polach: {means:?}");
}

/// FaStrip of CONTACT (its modified form, n = 200) is another variant of the same method.
#[test]
fn fastrip_against_contacts_own() {
    let rows = curves();
    let (p, _) = patch();
    let law = CreepLaw::Fastrip(Fastrip { nx: 200, ny: 200, poisson: Some(0.28) });
    for (kind, bound) in [("xi", 0.02), ("eta", 0.02), ("phi", 0.1), ("comb", 0.1)] {
        let e = errors(&rows, "FASTRIP", kind, |c| force(&law, &p, c));
        println!(
            "FaStrip 200 x 200 against CONTACT's, {kind}: {} rows, mean {:.4}, max {:.4}",
            e.rows, e.mean, e.largest
        );
        assert!(e.largest < bound, "{kind}: {}", e.largest);
    }
}

/// Spin moment against the exact theory, over mu N c.
#[test]
fn spin_moment_against_contact() {
    let rows = curves();
    let (p, c33) = patch();
    let unit = MU * p.n * (p.a * p.b).sqrt();
    let laws = [
        ("FASTSIM 50 x 50", CreepLaw::Fastsim(Fastsim { nx: 50, ny: 50 }), [0.12, 0.12, 0.12, 0.12]),
        (
            "FaStrip 50 x 50",
            CreepLaw::Fastrip(Fastrip { nx: 50, ny: 50, poisson: Some(0.28) }),
            [0.05, 0.06, 0.06, 0.12],
        ),
    ];
    for (name, law, bounds) in laws {
        for (kind, bound) in ["xi", "eta", "phi", "comb"].into_iter().zip(bounds) {
            let all: Vec<f64> = rows
                .iter()
                .filter(|r| r.method == "CONTACT" && r.kind == kind)
                .map(|r| (law.spin_moment(&p, c33, &r.c, MU).unwrap() / unit - r.f[2]).abs())
                .collect();
            let largest = all.iter().copied().fold(0.0, f64::max);
            println!(
                "Mz of {name} against CONTACT, {kind}: mean {:.4}, max {largest:.4}",
                all.iter().sum::<f64>() / all.len() as f64
            );
            assert!(largest < bound, "{name} {kind}: {largest}");
        }
    }
    // linear theory at the smallest creepages of the file, where some per cent of the patch slide
    let linear = CreepLaw::KalkerLinear(KalkerLinear {});
    for kind in ["eta", "phi"] {
        let row = rows.iter().find(|r| r.method == "CONTACT" && r.kind == kind).unwrap();
        let ours = linear.spin_moment(&p, c33, &row.c, MU).unwrap() / unit;
        println!(
            "Mz of the linear theory, {kind}: {ours:.4}, CONTACT {:.4}, difference {:+.4}",
            row.f[2],
            ours - row.f[2]
        );
        assert!(ours * row.f[2] > 0.0 && (ours / row.f[2] - 1.0).abs() < 0.25);
    }
}

/// Slopes at zero creepage on a fine grid: the bound is 0.5 %.
#[test]
fn small_creepage_slopes_on_a_fine_grid() {
    let (p, _) = patch();
    for law in [
        CreepLaw::Fastsim(Fastsim { nx: 100, ny: 100 }),
        CreepLaw::Fastrip(Fastrip { nx: 100, ny: 100, poisson: Some(0.28) }),
    ] {
        let scale = p.shear_modulus * p.a * p.b;
        let small = 1e-9;
        let long =
            law.force(&p, &Creepage { xi: small, ..Creepage::default() }, MU).fx / (-scale * p.c11 * small);
        let lateral =
            law.force(&p, &Creepage { eta: small, ..Creepage::default() }, MU).fy / (-scale * p.c22 * small);
        println!("{law:?}: slopes over Kalker's {long:.5} and {lateral:.5}");
        assert!((long - 1.0).abs() < 0.005 && (lateral - 1.0).abs() < 0.005);
    }
}

/// How forces settle with the grid: the second table of docs/concepts/creep.md (largest distance from 400 x 400 over the file's creepages).
#[test]
fn convergence_with_the_grid() {
    let rows = curves();
    let (p, _) = patch();
    let fastsim = |n| CreepLaw::Fastsim(Fastsim { nx: n, ny: n });
    let fastrip = |n| CreepLaw::Fastrip(Fastrip { nx: n, ny: n, poisson: Some(0.28) });
    let makers: [(&str, &dyn Fn(u16) -> CreepLaw); 2] = [("FASTSIM", &fastsim), ("FaStrip", &fastrip)];
    for (name, make) in makers {
        let reference: Vec<[f64; 2]> = rows.iter().map(|r| force(&make(400), &p, &r.c)).collect();
        let mut before = f64::INFINITY;
        for n in [5, 10, 20, 40, 80] {
            let law = make(n);
            let mut worst = [0.0_f64; 2];
            for (row, fine) in rows.iter().zip(&reference) {
                let f = force(&law, &p, &row.c);
                let spin = usize::from(row.c.phi != 0.0);
                worst[spin] = worst[spin].max((f[0] - fine[0]).hypot(f[1] - fine[1]));
            }
            println!("| {name} {n} x {n} | {:.4} | {:.4} |", worst[0], worst[1]);
            assert!(worst[1] < before);
            before = worst[1];
        }
        assert!(before < 0.02);
    }
}

struct Traction {
    series: u8,
    xi: f64,
    adhesion: f64,
}

fn traction() -> Vec<Traction> {
    data("tractcurv.csv")
        .lines()
        .filter(|l| !l.starts_with('#') && !l.starts_with("series"))
        .map(|line| {
            let f: Vec<&str> = line.split(',').collect();
            Traction {
                series: f[0].parse().unwrap(),
                xi: f[2].parse().unwrap(),
                adhesion: f[7].parse().unwrap(),
            }
        })
        .collect()
}

/// 106.7 kN, a/b = 0.5, CONTACT's material (G 82 GPa, nu 0.28), rolling at 10 m/s.
fn locomotive() -> Patch {
    let k = kalker_table::coefficients(0.5, 0.28);
    Patch { a: 6.307e-3, b: 12.615e-3, n: 106.7e3, c11: k.c11, c22: k.c22, c23: k.c23, shear_modulus: 82e9 }
}

fn adhesion(law: &CreepLaw, xi: f64, mu: f64) -> f64 {
    let p = locomotive();
    -law.force(&p, &Creepage { xi, eta: 0.0, phi: 0.0 }, mu).fx / p.n
}

fn against_series(name: &str, series: u8, mu: f64, bound: f64, ours: impl Fn(f64) -> f64) {
    let mut worst = (0.0_f64, 0.0, 0.0, 0.0);
    for row in traction().iter().filter(|r| r.series == series) {
        let (f, theirs) = (ours(row.xi), row.adhesion);
        let error = (f - theirs).abs() / mu;
        if error > worst.0 {
            worst = (error, row.xi, f, theirs);
        }
    }
    let (error, xi, f, theirs) = worst;
    println!(
        "{name} against series {series}: largest {error:.4} mu N at xi {xi:.4}: ours {f:.4}, theirs {theirs:.4}"
    );
    assert!(error < bound, "{name}: {error}");
}

#[test]
fn locomotive_traction_curve_fastsim() {
    for n in [10, 42, 200] {
        let law = CreepLaw::Fastsim(Fastsim { nx: n, ny: n });
        against_series(&format!("FASTSIM {n} x {n}"), 3, 0.33, 0.015, |xi| adhesion(&law, xi, 0.33));
        against_series(&format!("FASTSIM {n} x {n}"), 1, 0.33, 0.055, |xi| adhesion(&law, xi, 0.33));
    }
    let law = CreepLaw::Fastrip(Fastrip { nx: 100, ny: 100, poisson: Some(0.28) });
    against_series("FaStrip 100 x 100", 1, 0.33, 0.055, |xi| adhesion(&law, xi, 0.33));
}

/// Series 4: mu 0.1368 + 0.2232 2^(-w/0.99 m/s) at w = 10 m/s times creepage.
#[test]
fn locomotive_traction_curve_modified_fastsim() {
    let falling = Falling { ratio: 0.38, decay: std::f64::consts::LN_2 / 0.99 };
    let mu = |xi: f64| 0.36 * falling.factor(10.0 * xi);
    for n in [10, 42, 200] {
        let law =
            CreepLaw::ModifiedFastsim(ModifiedFastsim { k0: 0.54, alpha: 0.02, beta: 0.62, nx: n, ny: n });
        against_series(&format!("modified FASTSIM {n} x {n}"), 4, 0.36, 0.05, |xi| {
            adhesion(&law, xi, mu(xi))
        });
    }
}

/// Polach's two factors fitted to CONTACT's third-body curve (series 2) and to the modified FASTSIM (series 4) with their falling friction:
/// how near two constants come.
#[test]
fn locomotive_traction_curve_polach_fitted() {
    let falling = Falling { ratio: 0.38, decay: std::f64::consts::LN_2 / 0.99 };
    for (series, stated) in [(2, 0.1), (4, 0.1)] {
        let rows: Vec<Traction> = traction().into_iter().filter(|r| r.series == series).collect();
        let error = |k_a: f64, k_s: f64| {
            let law = CreepLaw::Polach(Polach { k_a, k_s });
            rows.iter()
                .map(|r| (adhesion(&law, r.xi, 0.36 * falling.factor(10.0 * r.xi)) - r.adhesion).abs() / 0.36)
                .fold(0.0, f64::max)
        };
        let mut best = (f64::INFINITY, 0.0, 0.0);
        for i in 1..=100 {
            for j in 1..=i {
                let (k_a, k_s) = (0.01 * f64::from(i), 0.01 * f64::from(j));
                let e = error(k_a, k_s);
                if e < best.0 {
                    best = (e, k_a, k_s);
                }
            }
        }
        println!(
            "Polach fitted to series {series}: k_a {:.2}, k_s {:.2}, largest difference {:.4} mu N",
            best.1, best.2, best.0
        );
        assert!(best.0 < stated);
    }
}
