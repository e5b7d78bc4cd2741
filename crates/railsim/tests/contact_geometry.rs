//! Contact geometry: closed forms on simple shapes, the shipped pairs, continuity, and the table against a direct search.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::contact::{PLACEMENT, as60, wheel};
use proptest::prelude::*;
use railsim::KeyPath;
use railsim::contact::geometry_table::{
    ContactPoint, GeometryTable, MAX_CONTACTS, OutOfTable, PENETRATION, Placement, Zone,
};
use railsim::contact::profile::{Profile, ProfileKind};
use railsim::contact::search::{Pose, RailShift, Side, VIRTUAL};
use std::sync::LazyLock;

static ANZR1: LazyLock<GeometryTable> =
    LazyLock::new(|| GeometryTable::build(&wheel("anzr1"), &as60(), &PLACEMENT).unwrap());
static WORN_2: LazyLock<GeometryTable> =
    LazyLock::new(|| GeometryTable::build(&wheel("anzr1_worn_2"), &as60(), &PLACEMENT).unwrap());
static WORN_HIGH: LazyLock<GeometryTable> =
    LazyLock::new(|| GeometryTable::build(&wheel("anzr1_worn_high"), &as60(), &PLACEMENT).unwrap());
static S1002: LazyLock<GeometryTable> =
    LazyLock::new(|| GeometryTable::build(&wheel("s1002"), &as60(), &PLACEMENT).unwrap());

fn one(table: &GeometryTable, dy: f64, roll: f64, load_depth: f64) -> Vec<ContactPoint> {
    let gap = table.gap(dy, roll).unwrap();
    let mut out = [ContactPoint::default(); MAX_CONTACTS];
    let n = table.contacts(dy, roll, gap[0].min(gap[1]) + load_depth, 0.0, &mut out).unwrap();
    out[..n].to_vec()
}

/// A cone of slope lambda on a round head of radius R: dr = 2 lambda y/(1 - lambda (R + r0)/l0): the wheelset rolls by
/// phi = -lambda dy/l0 about its centre, which shifts the wheels by r0 phi and the contacts on the heads by R phi.
#[test]
fn cone_on_round_rail_closed_form() {
    let (lambda, radius) = (0.05, 0.3);
    let cone: Vec<_> = (-600..=600).map(|i| [1e-4 * f64::from(i), -lambda * 1e-4 * f64::from(i)]).collect();
    let head: Vec<_> = (-400..=400)
        .map(|i| {
            let y = 1e-4 * f64::from(i);
            [y, radius - (radius * radius - y * y).sqrt()]
        })
        .collect();
    let wheel = Profile::new(&cone, ProfileKind::Wheel, &KeyPath::of("w")).unwrap();
    let rail = Profile::new(&head, ProfileKind::Rail, &KeyPath::of("r")).unwrap();
    let placement = Placement { rail_inclination: 0.0, gauge_point_depth: 0.002, ..PLACEMENT };
    let table = GeometryTable::build(&wheel, &rail, &placement).unwrap();
    for dy in [-6e-3, -2.03e-3, 1.57e-3, 5e-3] {
        let dr = table.rolling_radius_difference(dy).unwrap();
        let exact = 2.0 * lambda * dy / (1.0 - lambda * (radius + 0.46) / 0.75);
        println!("dr({:.2} mm) = {:.5} mm, closed form {:.5} mm", 1e3 * dy, 1e3 * dr, 1e3 * exact);
        // third order: lambda^2
        assert!((dr / exact - 1.0).abs() < 4e-3);
        let contact = one(&table, dy, 0.0, 5e-5)[0];
        let angle = lambda.atan();
        // contact where the rail's slope is -lambda
        assert!((contact.y_rail + radius * angle.sin()).abs() < 2e-5, "{}", contact.y_rail);
        assert!((contact.angle - angle).abs() < 1e-4);
        assert!((contact.share - 1.0).abs() < 1e-12 && contact.zone == Zone::Tread);
        // Hertz of R 0.46/cos and R 0.3: within what the averaging leaves
        let hertz = railsim::contact::hertz::solve(
            angle.cos() / (0.46 + contact.z_wheel),
            1.0 / radius,
            railsim::contact::hertz::effective_modulus(210e9, 0.28),
        );
        assert!((contact.hertz / hertz.stiffness - 1.0).abs() < 2e-3);
        assert!((contact.a1 / hertz.a1 - 1.0).abs() < 2e-3 && (contact.b1 / hertz.b1 - 1.0).abs() < 2e-3);
    }
}

/// data/README.md and CONTACT.md 5.4: conicity 0.0529 at 1-6 mm, flange play +-6.4 mm.
#[test]
fn anzr1_on_as60_conicity_and_flange_play() {
    // the radius of coco134 and the gauge at 14 mm are what the published figures belong to
    let placement = Placement { wheel_radius: 0.5335, gauge_point_depth: 0.014, ..PLACEMENT };
    let pair = GeometryTable::build(&wheel("anzr1"), &as60(), &placement).unwrap();
    for millimetres in 1..=6 {
        let conicity = pair.equivalent_conicity(1e-3 * f64::from(millimetres)).unwrap();
        println!("anzr1/as60 equivalent conicity at {millimetres} mm: {conicity:.4} (0.0529)");
        assert!((conicity - 0.0529).abs() < 0.0002);
    }
    // play: the shift of the wheelset at which the flange gap equals the tread gap
    let difference = |y: f64| {
        let roll = pair.touching_roll(y).unwrap();
        let gap = pair.gap(y - roll * placement.wheel_radius, roll).unwrap();
        gap[1] - gap[0]
    };
    let (mut low, mut high) = (0.0, 0.012);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if difference(middle) > 0.0 { low = middle } else { high = middle }
    }
    println!("flange play {:.3} mm (6.4)", 1e3 * low);
    assert!((low - 6.4e-3).abs() < 0.1e-3);
}

/// The table of models/profiles/README.md, to its last figure.
#[test]
fn shipped_pairs_have_the_conicity_this_readme_states() {
    let readme =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/profiles/README.md"))
            .unwrap();
    let placement = Placement { wheel_radius: 0.5335, ..PLACEMENT };
    let mut found = 0;
    for line in readme.lines() {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let stated: Vec<f64> = cells.iter().skip(1).filter_map(|c| c.parse().ok()).collect();
        if stated.len() != 3 {
            continue;
        }
        let table = GeometryTable::build(&wheel(cells[0]), &as60(), &placement).unwrap();
        for (amplitude, stated) in [1e-3, 3e-3, 5e-3].into_iter().zip(stated) {
            let ours = table.equivalent_conicity(amplitude).unwrap();
            println!("{} at {amplitude} m: {ours:.4} ({stated})", cells[0]);
            assert!((ours - stated).abs() < 6e-4);
        }
        found += 1;
    }
    assert_eq!(found, 5);
}

/// Direct search on the smoothed curves, independent of the table: every 5 micrometres of y over the whole rail.
fn direct_gap(wheel: &Profile, table: &GeometryTable, dy: f64, roll: f64) -> f64 {
    let offset = PLACEMENT.tape_half_distance - table.rail_origin_y() + dy;
    let (low, high) = wheel.range();
    let count = ((high - low) / 5e-6) as usize;
    let (sin, cos) = roll.sin_cos();
    (0..count)
        .filter_map(|i| {
            let y = low + 5e-6 * i as f64;
            let z = wheel.z(y)?;
            Some(table.rail().z(y * cos - z * sin + offset)? - (y * sin + z * cos))
        })
        .fold(f64::INFINITY, f64::min)
}

/// The smallest gap is a minimum over places of contact, so it has creases where the contact jumps from one place to another;
/// bilinear interpolation rounds a crease off over one cell, by up to (distance of the places) * 2 mrad/4. S1002 on 1:20, with three
/// places 33 mm apart within the tread, is the worst; the pairs of the locomotive have no such jump within a zone.
#[test]
fn table_against_direct_search() {
    for (name, table, bound) in [
        ("anzr1", &*ANZR1, 1e-6),
        ("anzr1_worn_2", &*WORN_2, 1e-6),
        ("anzr1_worn_high", &*WORN_HIGH, 1e-5),
        ("s1002", &*S1002, 3e-5),
    ] {
        let wheel = common::contact::wheel(name);
        let mut worst = (0.0_f64, 0.0, 0.0);
        let mut all = Vec::new();
        for i in 0..30 {
            for j in 0..5 {
                let dy = -0.0093 + 0.000_637 * f64::from(i);
                let roll = -0.0071 + 0.0037 * f64::from(j);
                let gap = table.gap(dy, roll).unwrap();
                let error = gap[0].min(gap[1]) - direct_gap(&wheel, table, dy, roll);
                all.push(error.abs());
                if error.abs() > worst.0.abs() {
                    worst = (error, dy, roll);
                }
            }
        }
        println!(
            "{name}/as60: largest error of the gap {:.3} um at dy {:.2} mm, roll {:.1} mrad",
            1e6 * worst.0,
            1e3 * worst.1,
            1e3 * worst.2
        );
        assert!(worst.0.abs() < bound, "{name}");
        all.sort_by(f64::total_cmp);
        println!("    median {:.3} um, 95 % {:.3} um", 1e6 * all[75], 1e6 * all[142]);
    }
}

/// Where the wheel's root crosses the blend, one contact is shared by both zones: the shares add up to about one.
#[test]
fn shares_of_one_contact_add_up_to_one() {
    let mut worst = 0.0_f64;
    for (name, table) in
        [("anzr1", &*ANZR1), ("worn 2", &*WORN_2), ("worn high", &*WORN_HIGH), ("s1002", &*S1002)]
    {
        for i in 0..=200 {
            let dy = -0.01 + 0.0001 * f64::from(i);
            let found = one(table, dy, 0.0, 1e-5);
            // contacts closer than 1.5 mm on the wheel are one contact
            let total: f64 = found.iter().map(|c| c.share).sum();
            let separate = found.windows(2).any(|c| (c[0].y_wheel - c[1].y_wheel).abs() > 1.5e-3);
            if !separate {
                if (total - 1.0).abs() > worst {
                    println!(
                        "{name} at {:.1} mm: {total:.3} {:?}",
                        1e3 * dy,
                        found.iter().map(|c| (c.zone, c.share, 1e3 * c.y_wheel)).collect::<Vec<_>>()
                    );
                }
                worst = worst.max((total - 1.0).abs());
            }
        }
    }
    println!("largest |sum of shares - 1|: {worst:.3}");
    assert!(worst < 0.05);
}

/// Which pairs touch in two places of a zone at once is found from the pair alone.
#[test]
fn zones_are_cut_where_a_pair_touches_twice_in_them() {
    for (name, table, seconds) in [
        ("anzr1", &*ANZR1, [false, false]),
        ("anzr1_worn_2", &*WORN_2, [false, true]),
        ("anzr1_worn_high", &*WORN_HIGH, [true, true]),
        ("s1002", &*S1002, [true, false]),
    ] {
        println!("{name}: {:?}", table.seconds());
        assert_eq!(table.seconds(), seconds, "{name}");
    }
}

/// S1002 on 1:20, where two places of the tread and the flange root carry at once: three contacts where direct search has three patches. This is the
/// pair that a table serves worst. Nothing here was asked for: what is held is the error that docs/concepts/contact.md states, so that neither it nor the
/// table changes in silence; and that all three are there.
#[test]
fn three_contacts_at_once() {
    let side = Side::new(&wheel("s1002"), &as60(), &PLACEMENT).unwrap();
    let approach = PENETRATION / VIRTUAL;
    let load = |c: &ContactPoint| c.share * c.hertz * (c.penetration * c.angle.cos()).powf(1.5);
    // whole load, stiffness of the heaviest contact and its place, against direct search
    let (mut loads, mut stiffness, mut farthest) =
        ([f64::INFINITY, 0.0_f64], [f64::INFINITY, 0.0_f64], 0.0_f64);
    let note = |range: &mut [f64; 2], x: f64| *range = [range[0].min(x), range[1].max(x)];
    for i in 0..=60 {
        let y = 0.005 + 5e-5 * f64::from(i);
        let pose = Pose { y, ..Pose::default() };
        let gap = side.gap(&pose, &RailShift::default()).unwrap();
        let patches = side.patches(&Pose { z: gap + approach, ..pose }, &RailShift::default()).unwrap();
        if patches.len() < 3 {
            continue;
        }
        let mut out = [ContactPoint::default(); MAX_CONTACTS];
        let n = S1002.contacts(y, 0.0, gap + approach, 0.0, &mut out).unwrap();
        assert!(n >= 3);
        println!("y = {:.2} mm: search, table", 1e3 * y);
        for p in &patches {
            println!(
                "    {:6.2} mm {:5.1} kN, spread {:.2}",
                1e3 * p.centre.wheel[0],
                1e-3 * p.normal,
                p.spread
            );
        }
        for c in &out[..n] {
            let (place, kn) = (1e3 * c.y_wheel, 1e-3 * load(c));
            println!("        {place:6.2} mm {kn:5.1} kN {:?} share {:.2}", c.zone, c.share);
        }
        let heaviest = patches.iter().max_by(|p, q| p.normal.total_cmp(&q.normal)).unwrap();
        let main = out[..n].iter().max_by(|p, q| load(p).total_cmp(&load(q))).unwrap();
        farthest = farthest.max((main.y_wheel - heaviest.centre.wheel[0]).abs());
        note(&mut stiffness, main.hertz / (heaviest.normal * (-heaviest.deepest.gap).powf(-1.5)));
        let theirs: f64 = patches.iter().map(|p| p.normal).sum();
        note(&mut loads, out[..n].iter().map(load).sum::<f64>() / theirs);
    }
    println!(
        "load {:.2} to {:.2} of direct search's, stiffness of the heaviest contact {:.2} to {:.2}, its place within {:.1} mm",
        loads[0],
        loads[1],
        stiffness[0],
        stiffness[1],
        1e3 * farthest
    );
    for (ours, stated) in loads.into_iter().chain([1e3 * farthest]).zip([0.78, 0.98, 3.3]) {
        assert!((ours - stated).abs() < if stated > 1.0 { 0.1 } else { 0.01 }, "{ours}, {stated} is stated");
    }
}

#[test]
fn yaw_closes_the_flange_gap_to_second_order() {
    let (dy, roll) = (0.007, 0.0);
    let gap = ANZR1.gap(dy, roll).unwrap();
    let mut out = [ContactPoint::default(); MAX_CONTACTS];
    assert_eq!(ANZR1.contacts(dy, roll, gap[1] - 1e-4, 0.0, &mut out).unwrap(), 0);
    assert_eq!(ANZR1.contacts(dy, roll, gap[1] - 1e-4, 0.02, &mut out).unwrap(), 1);
    let flange = out[0];
    assert!(flange.zone.is_flange());
    let closed = 0.5 * (0.46 + flange.z_wheel) * flange.angle.tan().powi(2) * 0.02 * 0.02;
    assert!((flange.penetration - (closed - 1e-4)).abs() < 0.05 * closed);
}

/// Inward to where the rim ends over the top of the rail, outward 10 mm past flange contact, 20 mm at least.
#[test]
fn the_reach_follows_the_pair() {
    for gauge in [1.435, 1.465] {
        let wheel = wheel("anzr1");
        let table = GeometryTable::build(&wheel, &as60(), &Placement { gauge, ..PLACEMENT }).unwrap();
        let [inward, outward] = table.reach();
        // the flange face at the depth of the gauge, from the points: where the profile falls through 16 mm
        let face =
            wheel.points.iter().filter(|p| p[0] < 0.0 && p[1] <= 0.016).map(|p| p[0]).fold(0.0, f64::min);
        let clearance = 0.5 * gauge - PLACEMENT.tape_half_distance - face;
        let nominal = PLACEMENT.tape_half_distance - table.rail_origin_y();
        let rim = wheel.range().1 + nominal;
        println!(
            "{gauge} m: {:.1} to {:.1} mm, clearance {:.1} mm",
            1e3 * inward,
            1e3 * outward,
            1e3 * clearance
        );
        assert!(rim + inward >= 0.0 && rim + inward < 0.6e-3);
        assert!(outward >= (clearance + 0.0095).max(0.02) && outward < (clearance + 0.0115).max(0.0201));
        // room for 30 mm of widening, the other wheel's flange on its rail
        assert!(-inward > clearance + if gauge > 1.45 { 0.0 } else { 0.030 });
    }
}

/// Inward of 20 mm, on the outer part of the tread, where nodes are half a millimetre apart.
#[test]
fn table_of_a_widened_track_against_direct_search() {
    for (name, table) in [("anzr1", &*ANZR1), ("anzr1_worn_2", &*WORN_2), ("s1002", &*S1002)] {
        let (wheel, mut worst) = (common::contact::wheel(name), 0.0_f64);
        for i in 0..40 {
            let (dy, roll) = (-0.0203 - 0.000_657 * f64::from(i), -0.0031 + 0.0021 * f64::from(i % 4));
            let gap = table.gap(dy, roll).unwrap();
            worst = worst.max((gap[0].min(gap[1]) - direct_gap(&wheel, table, dy, roll)).abs());
        }
        println!("{name}/as60, 20 to 46 mm inward: largest error of the gap {:.2} um", 1e6 * worst);
        assert!(worst < 5e-6, "{name}");
    }
}

#[test]
fn leaving_the_table_is_an_error() {
    let mut out = [ContactPoint::default(); MAX_CONTACTS];
    for (dy, roll) in [(0.0201, 0.0), (-0.06, 0.0), (0.0, -0.03), (f64::NAN, 0.0)] {
        let refused = ANZR1.contacts(dy, roll, 0.0, 0.0, &mut out);
        assert!(matches!(refused, Err(OutOfTable { .. })));
    }
}

#[test]
fn profile_that_misses_the_gauge_point_is_refused() {
    let head: Vec<_> = (-200..=200).map(|i| [1e-4 * f64::from(i), 1e-8 / 0.6 * f64::from(i * i)]).collect();
    let rail = Profile::new(&head, ProfileKind::Rail, &KeyPath::of("r")).unwrap();
    let refused = GeometryTable::build(&wheel("anzr1"), &rail, &PLACEMENT);
    assert!(refused.unwrap_err().to_string().contains("gauge_point_depth"));
}

proptest! {
    /// Small shifts and rolls change every value a little: no jumps, anywhere in the table.
    #[test]
    fn table_is_continuous(dy in -0.045f64..0.0199, roll in -0.0199f64..0.0199, which in 0..2) {
        let table: &GeometryTable = if which == 0 { &ANZR1 } else { &S1002 };
        let h = 1e-9;
        let mut p = [ContactPoint::default(); MAX_CONTACTS];
        let mut q = p;
        let gap = table.gap(dy, roll).unwrap();
        let dz = gap[0].min(gap[1]) + 1e-3;
        let n = table.contacts(dy, roll, dz, 0.0, &mut p);
        let m = table.contacts(dy + h, roll + h, dz, 0.0, &mut q);
        // refused where the wheel would stand on the end of its profile
        if let (Ok(n), Ok(m)) = (n, m) && n == m {
            for (p, q) in p.iter().zip(&q).take(n) {
                prop_assert!((p.penetration - q.penetration).abs() < 50.0 * h);
                // positions may move fast, never jump: 0.1 mm of shift to 30 mm of travel at most
                prop_assert!((p.y_rail - q.y_rail).abs() < 1e3 * h);
                prop_assert!((p.y_wheel - q.y_wheel).abs() < 1e3 * h);
                prop_assert!((p.angle - q.angle).abs() < 1e5 * h);
                prop_assert!((p.share - q.share).abs() < 1e5 * h);
            }
        }
    }

    /// Every contact that is handed out is fit for use.
    #[test]
    fn contacts_are_sane(dy in -0.045f64..0.0199, roll in -0.0199f64..0.0199, which in 0..2) {
        let table: &GeometryTable = if which == 0 { &ANZR1 } else { &S1002 };
        let gap = table.gap(dy, roll).unwrap();
        let mut out = [ContactPoint::default(); MAX_CONTACTS];
        // refused where the wheel would stand on the end of its profile
        let n = table.contacts(dy, roll, gap[0].min(gap[1]) + 2e-4, 0.0, &mut out).unwrap_or(0);
        for c in &out[..n] {
            prop_assert!(c.share > 0.0 && c.share <= 1.0 + 1e-9);
            prop_assert!(c.hertz > 1e9 && c.hertz < 1e12, "{:?}", c);
            prop_assert!(c.a1 > 0.0 && c.b1 > 0.0 && c.c11 > 0.0 && c.c22 > 0.0 && c.c23 > 0.0);
            prop_assert!(c.angle.abs() < 1.5);
        }
    }
}
