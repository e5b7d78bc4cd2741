//! Direct contact search: closed forms, properties, refusals, and the tables against it.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::contact::{self, PLACEMENT};
use proptest::prelude::*;
use railsim::KeyPath;
use railsim::contact::geometry_table::{ContactPoint, GeometryTable, MAX_CONTACTS, Placement};
use railsim::contact::pair::Pair;
use railsim::contact::profile::{Profile, ProfileKind, read_csv};
use railsim::contact::search::{NoContact, Part, Pose, RailShift, Side};
use std::sync::LazyLock;

const STILL: RailShift = RailShift { y: 0.0, z: 0.0, roll: 0.0 };

fn side(wheel: &str) -> Side {
    Side::new(&contact::wheel(wheel), &contact::as60(), &PLACEMENT).unwrap()
}

static S1002: LazyLock<Side> = LazyLock::new(|| side("s1002"));
static ANZR1: LazyLock<Side> = LazyLock::new(|| side("anzr1"));

/// Cone of half-angle atan(lambda) on a round head, yawed by psi: the normal at the contact stays without x-component where
/// sin(t) = tan(psi) lambda (for no roll), so the contact leads by r sin(t) cos(psi) less what the axle's turn takes back.
#[test]
fn yawed_cone_on_round_head() {
    let (lambda, head, psi) = (0.1_f64, 0.3_f64, 0.02_f64);
    let cone: Vec<_> = (-600..=600).map(|i| [1e-4 * f64::from(i), -lambda * 1e-4 * f64::from(i)]).collect();
    let arc: Vec<_> =
        (-500..=500).map(|i| 1e-4 * f64::from(i)).map(|y| [y, head - (head * head - y * y).sqrt()]).collect();
    let wheel = Profile::new(&cone, ProfileKind::Wheel, &KeyPath::of("w")).unwrap();
    let rail = Profile::new(&arc, ProfileKind::Rail, &KeyPath::of("r")).unwrap();
    let placement = Placement { rail_inclination: 0.0, gauge_point_depth: 0.002, ..PLACEMENT };
    let side = Side::new(&wheel, &rail, &placement).unwrap();
    let touch = side.closest(&Pose { yaw: psi, ..Pose::default() }, &STILL).unwrap()[0];
    let r = placement.wheel_radius + touch.wheel[1];
    let t = (psi.tan() * lambda).asin();
    let ahead = r * t.sin() * psi.cos() - psi.sin() * (placement.tape_half_distance + touch.wheel[0]);
    // the outline's slope: normal (sin t, lambda, cos t) turned by yaw
    let angle = (psi.sin() * t.sin() + psi.cos() * lambda).atan2(t.cos());
    println!(
        "ahead {:.6} mm ({:.6}), angle {:.7} ({:.7})",
        1e3 * touch.ahead,
        1e3 * ahead,
        touch.angle,
        angle
    );
    assert!((touch.ahead - ahead).abs() < 1e-7 && (touch.angle - angle).abs() < 1e-6);
    assert!((touch.rail[0] + head * angle.sin()).abs() < 1e-6);
    assert!((touch.k_yy - touch.k_xy.powi(2) / touch.k_xx - 1.0 / head).abs() < 1e-2);
}

/// What the tables lose against direct search, by pair; `docs/concepts/contact.md` states it.
#[test]
fn table_against_direct_search() {
    println!(
        "| pair | yaw, mrad | contacts | gap, um: 95 %, max | position, mm: 95 %, max | angle, mrad: 95 %, max | radius, um: 95 %, max |"
    );
    for name in ["anzr1", "anzr1_worn_1", "anzr1_worn_2", "anzr1_worn_high", "s1002"] {
        let side = side(name);
        let (wheel, rail) = (contact::wheel(name), contact::as60());
        let table = GeometryTable::build(&wheel, &rail, &PLACEMENT).unwrap();
        for yaw in [0.0, 0.01] {
            let mut errors: [Vec<f64>; 4] = Default::default();
            for i in 0..120 {
                for j in 0..3 {
                    compare(
                        &side,
                        &table,
                        -0.0093 + 1.637e-4 * f64::from(i),
                        -0.0051 + 0.0047 * f64::from(j),
                        yaw,
                        &mut errors,
                    );
                }
            }
            let count = errors[0].len();
            let text = errors.each_mut().map(|e| {
                e.sort_by(f64::total_cmp);
                format!("{:.2}, {:.2}", e[e.len() * 95 / 100], e[e.len() - 1])
            });
            println!("| {name} on as60 | {:.0} | {count} | {} |", 1e3 * yaw, text.join(" | "));
            let ninety_five = |k: usize| errors[k][count * 95 / 100];
            assert!(ninety_five(0) < 2.0 && ninety_five(1) < 1.5 && ninety_five(2) < 40.0, "{name}");
        }
    }
}

/// Patches of the side pressed to the table's own interpenetration (30 um of it virtual), matched with the table's contacts.
fn compare(side: &Side, table: &GeometryTable, y: f64, roll: f64, yaw: f64, errors: &mut [Vec<f64>; 4]) {
    let approach = 30e-6 / railsim::contact::search::VIRTUAL;
    let pose = Pose { y, z: 0.0, roll, yaw };
    let Ok(gap) = side.gap(&pose, &STILL) else { return };
    let z = gap + approach;
    let Ok(patches) = side.patches(&Pose { z, ..pose }, &STILL) else { return };
    let (half, radius) = (PLACEMENT.tape_half_distance, PLACEMENT.wheel_radius);
    let ((sr, cr), cp) = (roll.sin_cos(), yaw.cos());
    let dy = y + cp * (half * cr - radius * sr) - half;
    let depth = z - radius + half * sr + radius * cr;
    let mut out = [ContactPoint::default(); MAX_CONTACTS];
    let count = table.contacts(dy, roll, depth, yaw, &mut out).unwrap();
    // the patch that touches first; one contact alone is compared, two that share it by their mean
    let Some(patch) = patches.iter().min_by(|a, b| a.deepest.gap.total_cmp(&b.deepest.gap)) else { return };
    let near: Vec<&ContactPoint> =
        out[..count].iter().filter(|c| (c.y_wheel - patch.centre.wheel[0]).abs() < 4e-3).collect();
    let weight = |c: &ContactPoint| c.share * c.penetration.powf(1.5);
    let total: f64 = near.iter().map(|c| weight(c)).sum();
    if total <= 0.0 {
        return;
    }
    let mean =
        |value: &dyn Fn(&ContactPoint) -> f64| near.iter().map(|c| weight(c) * value(c)).sum::<f64>() / total;
    let deepest = near.iter().map(|c| c.penetration * c.angle.cos()).fold(0.0, f64::max);
    errors[0].push(1e6 * (deepest + patch.deepest.gap).abs());
    errors[1].push(1e3 * (mean(&|c| c.y_rail) - patch.centre.rail[0]).abs());
    errors[2].push(1e3 * (mean(&|c| c.angle) - patch.centre.angle).abs());
    errors[3].push(1e6 * (mean(&|c| c.z_wheel) - patch.centre.wheel[1]).abs());
}

/// anzr1 on as60 at its flange play: two places at once, 40 mm apart, and under load both carry.
#[test]
fn tread_and_flange_touch_together() {
    let (mut low, mut high) = (0.0, 0.015);
    for _ in 0..60 {
        let y = 0.5 * (low + high);
        let touch = ANZR1.closest(&Pose { y, ..Pose::default() }, &STILL).unwrap()[0];
        if touch.part == Part::Tread { low = y } else { high = y }
    }
    let pose = Pose { y: low, ..Pose::default() };
    let touches = ANZR1.closest(&pose, &STILL).unwrap();
    println!("at {:.4} mm:", 1e3 * low);
    for t in &touches {
        println!(
            "    {:?}: y wheel {:.2} mm, angle {:.4}, gap {:.3} um",
            t.part,
            1e3 * t.wheel[0],
            t.angle,
            1e6 * t.gap
        );
    }
    let vertical = |i: usize| touches[i].gap / touches[i].angle.cos();
    assert!(touches.len() >= 2 && (vertical(0) - vertical(1)).abs() < 1e-9);
    assert!((touches[0].wheel[0] - touches[1].wheel[0]).abs() > 20e-3);
    let pressed = ANZR1.press(&pose, &STILL, 100e3).unwrap();
    assert_eq!(pressed.patches.len(), 2);
    assert!(pressed.patches.iter().all(|p| p.normal > 1e3));
}

#[test]
fn gauge_rail_roll_and_rail_shift_enter() {
    let at = |side: &Side, rail: &RailShift| side.closest(&Pose::default(), rail).unwrap()[0];
    let base = at(&ANZR1, &STILL);
    // a rail moved outward is a wheel moved inward; half a gauge widening is the same
    let moved = at(&ANZR1, &RailShift { y: 2e-3, ..STILL });
    let shifted = ANZR1.closest(&Pose { y: -2e-3, ..Pose::default() }, &STILL).unwrap()[0];
    assert!((moved.rail[0] - shifted.rail[0]).abs() < 1e-9);
    let wide = Placement { gauge: PLACEMENT.gauge + 4e-3, ..PLACEMENT };
    let (wheel, rail) = (contact::wheel("anzr1"), contact::as60());
    let widened = at(&Side::new(&wheel, &rail, &wide).unwrap(), &STILL);
    assert!((moved.rail[0] - widened.rail[0]).abs() < 1e-9);
    // a rail rolled outward meets the wheel further in on its head: R300 on a cone, by the angle times the radius
    let rolled = at(&ANZR1, &RailShift { roll: 1e-3, ..STILL });
    println!("rail roll of 1 mrad moves the contact by {:.3} mm", 1e3 * (rolled.rail[0] - base.rail[0]));
    assert!((rolled.rail[0] - base.rail[0] + 0.3e-3).abs() < 0.02e-3);
}

/// The gap across a contact of two arcs is the difference of two parabolas, to fourth order.
#[test]
fn gap_across_a_contact() {
    let pose = Pose { y: 1e-3, ..Pose::default() };
    let touch = ANZR1.closest(&pose, &STILL).unwrap()[0];
    let gap = ANZR1.gap_profile(&pose, &STILL, &touch, 5e-3, 0.25e-3).unwrap();
    assert_eq!(gap.len(), 41);
    for p in &gap {
        let parabola = 0.5 * touch.k_yy * p.s * p.s;
        assert!((p.gap - parabola).abs() < 0.03e-6, "s {} gap {} parabola {}", p.s, p.gap, parabola);
        assert!((p.k_xx - touch.k_xx).abs() < 0.01);
    }
}

#[test]
fn impossible_input_is_refused() {
    let nowhere = ANZR1.closest(&Pose { y: f64::NAN, ..Pose::default() }, &STILL);
    assert!(matches!(nowhere, Err(NoContact::Nowhere(_))));
    for load in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(ANZR1.press(&Pose::default(), &STILL, load), Err(NoContact::Load(_))));
    }
    // far inward the wheel stands on the end of its field side, and beyond that beside the rail
    let end = ANZR1.closest(&Pose { y: -0.08, ..Pose::default() }, &STILL).unwrap_err();
    println!("{end}");
    assert!(matches!(end, NoContact::EndOfProfile { .. }));
    assert!(matches!(
        ANZR1.closest(&Pose { y: -0.2, ..Pose::default() }, &STILL),
        Err(NoContact::BesideTheRail)
    ));
    let (wheel, rail) = (contact::wheel("anzr1"), contact::as60());
    for gauge in [1.40, 1.52] {
        let placement = Placement { gauge, ..PLACEMENT };
        let refused = GeometryTable::build(&wheel, &rail, &placement).unwrap_err().to_string();
        println!("{refused}");
        assert!(refused.contains("track.gauge") && refused.lines().count() == 1);
        assert!(Side::new(&wheel, &rail, &placement).is_err());
    }
}

/// A tread that ends 5 mm outside its running circle: the rail's crown lies beyond.
#[test]
fn a_short_profile_is_not_silently_accepted() {
    let text =
        std::fs::read_to_string(format!("{}/../../models/profiles/anzr1.csv", env!("CARGO_MANIFEST_DIR")))
            .unwrap();
    let points: Vec<_> = read_csv(&text, "anzr1").unwrap().into_iter().filter(|p| p[0] < 5e-3).collect();
    let wheel = Profile::new(&points, ProfileKind::Wheel, &KeyPath::of("w")).unwrap();
    let rail = contact::as60();
    let placement = PLACEMENT;
    let table = GeometryTable::build(&wheel, &rail, &placement).unwrap();
    let side = Side::new(&wheel, &rail, &placement).unwrap();
    let y = -0.012;
    let refused = side.closest(&Pose { y, ..Pose::default() }, &STILL).unwrap_err();
    println!("{refused}");
    let gap = table.gap(y, 0.0).unwrap();
    let mut out = [ContactPoint::default(); MAX_CONTACTS];
    let refused = table.contacts(y, 0.0, gap[0].min(gap[1]) + 1e-4, 0.0, &mut out).unwrap_err();
    println!("{refused}");
    assert!(table.touching(y, 0.0).is_err());
}

#[test]
fn a_pair_says_what_is_wrong_with_it() {
    for (json, word) in
        [("{", "EOF"), ("{\"gauge\": 1.4}", "left"), ("{\"left\": 3}", "left"), ("{\"lft\": 3}", "lft")]
    {
        let message = Pair::from_json(json).unwrap_err().to_string();
        println!("{message}");
        assert!(message.contains(word));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Left and right are mirror images: the pair stands the same way when everything is mirrored.
    #[test]
    fn mirror_symmetry(y in -0.006f64..0.006, yaw in -0.02f64..0.02) {
        let pair = Pair::new(ANZR1.clone(), ANZR1.clone());
        let (a, b) = (pair.stand(y, yaw, &[STILL; 2]).unwrap(), pair.stand(-y, -yaw, &[STILL; 2]).unwrap());
        prop_assert!((a.roll + b.roll).abs() < 1e-9 && (a.z - b.z).abs() < 1e-10);
        prop_assert!((a.right[0].rail[0] - b.left[0].rail[0]).abs() < 1e-6);
    }

    /// Every pose on the tread has a contact, also where the smoothed profiles' curvatures jump.
    #[test]
    fn a_pose_on_the_tread_is_never_the_end_of_a_profile(y in -0.005f64..0.005, roll in -0.01f64..0.01) {
        let found = S1002.closest(&Pose { y, z: 0.0, roll, yaw: 0.0 }, &STILL);
        prop_assert!(found.is_ok(), "{:?}", found);
    }

    /// Yaw either way is the same but for the side on which the contact leads.
    #[test]
    fn yaw_is_even(y in -0.008f64..0.008, yaw in 0.0f64..0.03, roll in -0.01f64..0.01) {
        let at = |yaw| S1002.closest(&Pose { y, z: 0.0, roll, yaw }, &STILL).unwrap()[0];
        let (a, b) = (at(yaw), at(-yaw));
        prop_assert!((a.gap - b.gap).abs() < 1e-12 && (a.ahead + b.ahead).abs() < 1e-9);
        prop_assert!((a.rail[0] - b.rail[0]).abs() < 1e-9);
    }

    /// The gap is a continuous function of the pose, whatever jumps.
    #[test]
    fn the_gap_is_continuous(y in -0.01f64..0.01, roll in -0.01f64..0.01, yaw in -0.02f64..0.02) {
        let h = 1e-8;
        let at = |y, roll, yaw| S1002.gap(&Pose { y, z: 0.0, roll, yaw }, &STILL).unwrap();
        let moved = at(y + h, roll + h, yaw + h) - at(y, roll, yaw);
        prop_assert!(moved.abs() < 20.0 * h + 1e-9, "{}", moved);
    }

    /// A patch grows with its load in every direction, and so does the approach.
    #[test]
    fn patches_grow_with_the_load(y in -0.004f64..0.004, load in 5e3f64..150e3) {
        let press = |load| ANZR1.press(&Pose { y, ..Pose::default() }, &STILL, load).unwrap();
        let (small, large) = (press(load), press(1.2 * load));
        prop_assert!(large.pose.z > small.pose.z);
        prop_assert!(large.patches[0].a > small.patches[0].a && large.patches[0].b > small.patches[0].b);
        let carried: f64 = small.patches.iter().map(|p| p.normal * p.centre.angle.cos()).sum();
        prop_assert!((carried / load - 1.0).abs() < 1e-6);
    }

    /// Nothing panics, at any pose.
    #[test]
    fn any_pose_is_answered(y in -0.6f64..0.6, z in -0.1f64..0.1, roll in -0.6f64..0.6, yaw in -0.6f64..0.6) {
        let pose = Pose { y, z, roll, yaw };
        let _ = S1002.closest(&pose, &STILL);
        let _ = S1002.patches(&pose, &STILL);
        let _ = S1002.press(&pose, &STILL, 1e5);
    }

    /// Nor for any profile that is let in: a random walk of points for the wheel, another for the rail.
    #[test]
    fn any_profile_is_answered(
        steps in proptest::collection::vec(-1.0f64..1.0, 40),
        heads in proptest::collection::vec(-1.0f64..1.0, 40),
        y in -0.03f64..0.03,
        roll in -0.02f64..0.02,
    ) {
        if let Some((wheel, rail, placement)) = walks(&steps, &heads)
            && let Ok(side) = Side::new(&wheel, &rail, &placement)
        {
            let pose = Pose { y, roll, ..Pose::default() };
            let _ = side.closest(&pose, &STILL);
            let _ = side.press(&pose, &STILL, 5e4);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// And every such pair has a table, whose contacts are sane or refused, however often it touches at once.
    #[test]
    fn any_profile_has_a_table(
        steps in proptest::collection::vec(-1.0f64..1.0, 40),
        heads in proptest::collection::vec(-1.0f64..1.0, 40),
        places in proptest::collection::vec((-0.021f64..0.021, -0.021f64..0.021, 0.0f64..1e-3), 50),
    ) {
        if let Some((wheel, rail, placement)) = walks(&steps, &heads)
            && let Ok(table) = GeometryTable::build(&wheel, &rail, &placement)
        {
            for (dy, roll, depth) in places {
                let mut out = [ContactPoint::default(); MAX_CONTACTS];
                let Ok(gap) = table.gap(dy, roll) else { continue };
                let n = table.contacts(dy, roll, gap[0].min(gap[1]) + depth, 0.01, &mut out).unwrap_or(0);
                for c in &out[..n] {
                    prop_assert!(c.share > 0.0 && c.share < 1.0 + 1e-9 && c.hertz > 0.0 && c.angle.is_finite());
                }
            }
        }
    }
}

/// A wheel and a rail of random walks, where they make profiles.
fn walks(steps: &[f64], heads: &[f64]) -> Option<(Profile, Profile, Placement)> {
    let walk = |steps: &[f64], from: f64, bowl: f64| -> Vec<[f64; 2]> {
        let mut z = 0.0;
        steps
            .iter()
            .enumerate()
            .map(|(i, step)| {
                let y = from + 2e-3 * i as f64;
                z += 1e-3 * step;
                [y, z + bowl * y * y]
            })
            .collect()
    };
    let wheel = Profile::new(&walk(steps, -0.05, 5.0), ProfileKind::Wheel, &KeyPath::of("w")).ok()?;
    let rail = Profile::new(&walk(heads, -0.04, 10.0), ProfileKind::Rail, &KeyPath::of("r")).ok()?;
    Some((wheel, rail, Placement { gauge_point_depth: 0.01, ..PLACEMENT }))
}
