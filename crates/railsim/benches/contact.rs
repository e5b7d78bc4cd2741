//! Cost of one contact: geometry lookup, FASTSIM, table build.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use railsim::KeyPath;
use railsim::contact::creep::{
    CreepCase, CreepForce, CreepLaw, Creepage, Fastrip, KalkerLinear, ModifiedFastsim, Patch, Polach,
    ShenHedrickElkins, VermeulenJohnson,
};
use railsim::contact::geometry_table::{ContactPoint, GeometryTable, MAX_CONTACTS, Placement};
use railsim::contact::profile::{Profile, ProfileKind, read_csv};
use std::hint::black_box;

fn shipped(name: &str, kind: ProfileKind) -> Profile {
    let path = format!("{}/../../models/profiles/{name}.csv", env!("CARGO_MANIFEST_DIR"));
    let points = std::fs::read_to_string(path).ok().and_then(|text| read_csv(&text, name).ok());
    let points = points.unwrap_or_default();
    match Profile::new(&points, kind, &KeyPath::of("points")) {
        Ok(profile) => profile,
        Err(error) => panic!("{error}"),
    }
}

fn contact(criterion: &mut Criterion) {
    let patch = Patch { a: 6.5e-3, b: 5e-3, n: 1e5, c11: 4.5, c22: 4.2, c23: 1.9, shear_modulus: 82e9 };
    let law = CreepLaw::default();
    let mut group = criterion.benchmark_group("contact");
    for (name, creepage) in [
        ("fastsim 10x10, partial slip", Creepage { xi: 4e-4, eta: 3e-4, phi: 0.1 }),
        ("fastsim 10x10, full slip", Creepage { xi: 2e-2, eta: 1e-2, phi: 0.5 }),
    ] {
        group.bench_function(name, |b| b.iter(|| law.force(black_box(&patch), black_box(&creepage), 0.4)));
    }
    let cases = [CreepCase { patch, creepage: Creepage { xi: 2e-2, eta: 1e-2, phi: 0.5 }, mu: 0.4 }; 12];
    let mut forces = [CreepForce::default(); 12];
    group.throughput(Throughput::Elements(12));
    group.bench_function("fastsim 10x10, full slip, twelve patches", |b| {
        b.iter(|| law.forces(black_box(&cases), &mut forces));
    });
    let polach = CreepLaw::Polach(Polach { k_a: 0.6, k_s: 0.15 });
    group.bench_function("polach, twelve patches", |b| {
        b.iter(|| polach.forces(black_box(&cases), &mut forces));
    });
    group.throughput(Throughput::Elements(1));
    for (name, law) in [
        ("polach", polach),
        ("kalker linear", CreepLaw::KalkerLinear(KalkerLinear {})),
        ("shen-hedrick-elkins", CreepLaw::ShenHedrickElkins(ShenHedrickElkins {})),
        ("vermeulen-johnson", CreepLaw::VermeulenJohnson(VermeulenJohnson::default())),
        (
            "modified fastsim 10x10",
            CreepLaw::ModifiedFastsim(ModifiedFastsim { k0: 0.54, alpha: 0.02, beta: 0.62, nx: 10, ny: 10 }),
        ),
        ("fastrip 20x20", CreepLaw::Fastrip(Fastrip::default())),
    ] {
        let creepage = Creepage { xi: 2e-3, eta: 1e-3, phi: 0.2 };
        group.bench_function(name, |b| b.iter(|| law.force(black_box(&patch), black_box(&creepage), 0.4)));
    }
    let (wheel, rail) = (shipped("anzr1_worn_2", ProfileKind::Wheel), shipped("as60", ProfileKind::Rail));
    let placement = Placement {
        gauge: 1.435,
        gauge_point_depth: 0.016,
        rail_inclination: 0.05,
        tape_half_distance: 0.75,
        wheel_radius: 0.5335,
        youngs_modulus: 210e9,
        poisson: 0.28,
    };
    let Ok(table) = GeometryTable::build(&wheel, &rail, &placement) else { panic!("no table") };
    // near flange contact both gaps are small
    let gap = table.gap(7.4e-3, 1e-3).unwrap_or_default();
    let mut out = [ContactPoint::default(); MAX_CONTACTS];
    for (name, dy, dz) in [
        ("lookup, no contact", 1e-3, -1e-3),
        ("lookup, one contact", 1e-3, table.gap(1e-3, 1e-3).map_or(0.0, |g| g[0] + 1e-4)),
        ("lookup, two contacts", 7.4e-3, gap[0].max(gap[1]) + 1e-4),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| table.contacts(black_box(dy), black_box(1e-3), black_box(dz), 1e-3, &mut out));
        });
    }
    group.sample_size(10);
    group.bench_function("table build", |b| b.iter(|| GeometryTable::build(&wheel, &rail, &placement)));
    group.bench_function("profile fit, wheel", |b| {
        b.iter(|| Profile::new(black_box(&wheel.points), ProfileKind::Wheel, &KeyPath::of("points")));
    });
    group.finish();
}

criterion_group!(benches, contact);
criterion_main!(benches);
