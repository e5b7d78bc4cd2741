//! Building a [`GeometryTable`]: two searches per node, coarse over the whole wheel, fine where it may touch.

use super::grid::Shifts;
use super::seam::{Seams, USUAL_ROLL};
use super::{
    BLEND_FROM, BLEND_TO, Gaps, GeometryTable, LEAST_CURVATURE, LEAST_PENETRATION, MOST_PENETRATION, NO_RAIL,
    PENETRATION, Part, Placement, ROLL_RANGE, ROLL_STEP, ROLLS, Values, YAW_FULL, YAW_TRAVEL,
};
use crate::contact::profile::{Profile, ProfileKind, SPACING};
use crate::contact::search::VIRTUAL;
use crate::contact::{hertz, kalker_table};
use crate::error::{Error, Fault, KeyPath, Result};
use std::ops::Range;

/// Stations per coarse cell (0.4 mm of arc).
const STRIDE: usize = 8;
/// How much deeper than at the ends of a coarse cell the surfaces may come within it, m along the normal: curvature
/// 2 per mm over 0.4 mm, more than smoothed profiles have.
const SLACK: f64 = 0.05e-3;
/// Steepest contact angle for which vertical and normal distances are still told apart, rad.
const STEEPEST_CONTACT: f64 = 1.4;

/// A wheel station turned by the roll of the wheel.
#[derive(Clone, Copy)]
pub(super) struct Turned {
    y: f64,
    z: f64,
    /// Direction of the tangent in rail axes; the contact angle is its negative.
    direction: f64,
    pub(super) cos: f64,
}

/// What does not change with the roll.
struct WheelStation {
    y: f64,
    z: f64,
    curvature: f64,
}

/// Part of the wheel: the weight chi of every station, and the stations beyond which it is zero.
struct Support {
    chi: Vec<f64>,
    first: usize,
    end: usize,
}

impl Support {
    fn new(chi: Vec<f64>) -> Self {
        let first = chi.iter().position(|c| *c > 0.0).unwrap_or(chi.len());
        let end = chi.iter().rposition(|c| *c > 0.0).map_or(first, |last| last + 1);
        Self { chi, first, end }
    }

    fn has(&self, k: usize) -> bool {
        self.chi[k] > 0.0
    }

    /// The part outside a seam and that inside it, sharing what lies within; and the stations that each has for itself.
    fn cut(&self, seam: &Range<usize>) -> [(Self, Range<usize>); 2] {
        let width = (seam.end - seam.start) as f64;
        let outer = |k: usize| smoothstep((k as f64 - seam.start as f64) / width);
        let weighted = |weight: &dyn Fn(usize) -> f64| {
            Self::new(self.chi.iter().enumerate().map(|(k, chi)| chi * weight(k)).collect())
        };
        [(weighted(&outer), seam.end..self.chi.len()), (weighted(&|k| 1.0 - outer(k)), 0..seam.start + 1)]
    }
}

fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

impl GeometryTable {
    /// Table of `wheel` on `rail` (upright as drawn; inclined and placed here).
    ///
    /// # Errors
    /// - profiles of the wrong kind,
    /// - a rail that does not reach down to the gauge point on its gauge side,
    /// - gauge, radius, distances or elastic constants that are not positive, Poisson's ratio outside 0..0.5, an
    ///   inclination steeper than 1:5,
    /// - a gauge too narrow for the flanges, or so wide that the wheelset falls in.
    pub fn build(wheel: &Profile, rail: &Profile, placement: &Placement) -> Result<Self> {
        Self::build_at(wheel, rail, placement, PENETRATION)
    }

    /// The same with another normal interpenetration for the quasi-elastic averages, m (1 to 200 um): [`VIRTUAL`](crate::contact::search::VIRTUAL)
    /// times the approach under the wheel load that matters. [`PENETRATION`] is that of some 40 kN.
    ///
    /// # Errors
    /// As [`GeometryTable::build`]; an interpenetration outside its range.
    pub fn build_at(
        wheel: &Profile,
        rail: &Profile,
        placement: &Placement,
        penetration: f64,
    ) -> Result<Self> {
        check(wheel, rail, placement)?;
        if !(LEAST_PENETRATION..=MOST_PENETRATION).contains(&penetration) {
            let found = format!("{} um", 1e6 * penetration);
            return Err(Error::input(Fault::new(KeyPath::of("penetration"), found, "1 to 200 um")));
        }
        let (rail, rail_origin_y) = place_rail(rail, placement)?;
        let shifts = Shifts::new(wheel, placement.tape_half_distance - rail_origin_y, placement);
        let count = shifts.count() * ROLLS;
        let mut table = Self {
            placement: *placement,
            rail_origin_y,
            rail,
            flange_angle: wheel.stations().iter().fold(0.0, |most, s| most.max(-s.direction)),
            shifts,
            gaps: Vec::with_capacity(count),
            values: [Vec::with_capacity(count), Vec::with_capacity(count)],
            split: [None, None],
        };
        table.fill(wheel, penetration);
        Ok(table)
    }

    fn fill(&mut self, wheel: &Profile, penetration: f64) {
        let stations = wheel_stations(wheel);
        let supports = zones(wheel);
        let mut seams = [Seams::new(stations.len()), Seams::new(stations.len())];
        let rail = self.rail.clone();
        let scene = Scene {
            rail: &rail,
            stations: &stations,
            penetration,
            placement: &self.placement.clone(),
            shifts: self.shifts,
        };
        // of the patch whose averages these are; the stations at hand reach no further
        let approach = (penetration / VIRTUAL).min(penetration + SLACK);
        let mut scratch = Scratch::default();
        let mut near: [Vec<(usize, f64)>; 2] = Default::default();
        let mut extents: [Vec<Range<usize>>; 2] = Default::default();
        scene.nodes(self.rail_origin_y, wheel, |turned, roll, offset, close| {
            scene.look(turned, offset, 0..stations.len(), &mut scratch);
            let mut gaps = Gaps { gap: [NO_RAIL; 2], yaw: [0.0; 2] };
            for zone in 0..2 {
                let mut values = [0.0; 16];
                near[zone].clear();
                if let Some(found) = scene.node(turned, offset, &supports[zone], &mut scratch) {
                    [gaps.gap[zone], gaps.yaw[zone]] = found.gap;
                    values = found.values;
                    if !values[0].is_nan() {
                        std::mem::swap(&mut near[zone], &mut scratch.fine);
                    }
                }
                self.values[zone].push(values);
                extents[zone].push(extent(turned, &near[zone], gaps.gap[zone], penetration));
            }
            let least = gaps.gap[0].min(gaps.gap[1]);
            let usual = close && roll.abs() < USUAL_ROLL;
            for zone in (0..2).filter(|&z| usual && gaps.gap[z] - least < approach) {
                seams[zone].note(turned, &supports[zone].chi, &near[zone], gaps.gap[zone], approach);
            }
            self.gaps.push(gaps);
        });
        for zone in 0..2 {
            if let Some(seam) = seams[zone].seam() {
                let whole =
                    |n: usize| ([self.gaps[n].gap[zone], self.gaps[n].yaw[zone]], self.values[zone][n]);
                let parts = supports[zone].cut(&seam).map(|(support, full)| {
                    // where the zone's own average lies within the part, it is the part's
                    let known = |n: usize| {
                        let e: &Range<usize> = &extents[zone][n];
                        (!e.is_empty() && full.start <= e.start && e.end <= full.end).then(|| whole(n))
                    };
                    scene.part(self.rail_origin_y, wheel, &support, known, &mut scratch)
                });
                self.split[zone] = Some(Box::new(parts));
            }
        }
    }
}

/// From the first to the last station that an average is over.
fn extent(turned: &[Turned], fine: &[(usize, f64)], least: f64, penetration: f64) -> Range<usize> {
    let mut within = fine.iter().filter(|(k, g)| (g - least) * turned[*k].cos < penetration).map(|(k, _)| *k);
    match within.next() {
        Some(first) => first..within.next_back().unwrap_or(first) + 1,
        None => 0..0,
    }
}

/// The rail inclined, its highest point at z = 0, and the distance of its origin from the track centre.
///
/// # Errors
/// A rail that does not reach down to the gauge point on its gauge side.
pub(crate) fn place_rail(rail: &Profile, placement: &Placement) -> Result<(Profile, f64)> {
    let mut rail = rail.inclined(placement.rail_inclination, &KeyPath::of("track.rail_profile"))?;
    rail.top_to_zero();
    let gauge_point = gauge_point(&rail, placement.gauge_point_depth).ok_or_else(|| {
        Error::input(
            Fault::new(
                KeyPath::of("track.gauge_point_depth"),
                format!("{:.1} mm", 1e3 * placement.gauge_point_depth),
                "a depth that the gauge side of the rail profile reaches",
            )
            .hint("the gauge side has negative y"),
        )
    })?;
    Ok((rail, 0.5 * placement.gauge - gauge_point))
}

/// Gauge point: y at `depth` on the gauge side of the points themselves (the side may be too steep for the smoothed curve).
fn gauge_point(rail: &Profile, depth: f64) -> Option<f64> {
    let top = rail.points.iter().enumerate().min_by(|p, q| p.1[1].total_cmp(&q.1[1]))?.0;
    (1..=top).rev().find_map(|i| {
        let (p, q) = (rail.points[i], rail.points[i - 1]);
        (p[1] <= depth && q[1] > depth).then(|| p[0] + (q[0] - p[0]) * (depth - p[1]) / (q[1] - p[1]))
    })
}

fn wheel_stations(wheel: &Profile) -> Vec<WheelStation> {
    wheel.stations().iter().map(|s| WheelStation { y: s.y, z: s.z, curvature: s.curvature }).collect()
}

/// Tread and flange.
fn zones(wheel: &Profile) -> [Support; 2] {
    // from the running circle to the flange: once flange, always flange; field side: always tread
    let mut flange = 0.0_f64;
    let mut chi: Vec<f64> = wheel
        .stations()
        .iter()
        .rev()
        .map(|s| {
            let here = smoothstep((-s.direction - BLEND_FROM) / (BLEND_TO - BLEND_FROM));
            flange = if s.y > 0.0 { 0.0 } else { flange.max(here) };
            flange
        })
        .collect();
    chi.reverse();
    [Support::new(chi.iter().map(|flange| 1.0 - flange).collect()), Support::new(chi)]
}

#[derive(Default)]
struct Scratch {
    /// Gaps of every [`STRIDE`]th station, from the first cell that was looked at.
    coarse: Vec<f64>,
    fine: Vec<(usize, f64)>,
}

/// What a zone has at a node.
struct Found {
    /// Vertical gap, and its rate by yaw^2.
    gap: [f64; 2],
    values: Values,
}

/// A wheel over its rail.
struct Scene<'a> {
    rail: &'a Profile,
    stations: &'a [WheelStation],
    penetration: f64,
    placement: &'a Placement,
    shifts: Shifts,
}

impl Scene<'_> {
    /// Goes through all nodes in the order of the table: the turned wheel, its roll, where it stands, whether nodes are close together there.
    fn nodes(&self, rail_origin_y: f64, wheel: &Profile, mut node: impl FnMut(&[Turned], f64, f64, bool)) {
        let nominal = self.placement.tape_half_distance - rail_origin_y;
        let mut turned = Vec::with_capacity(self.stations.len());
        for j in 0..ROLLS {
            let roll = -ROLL_RANGE + ROLL_STEP * j as f64;
            let (sin, cos) = roll.sin_cos();
            turned.clear();
            turned.extend(self.stations.iter().zip(wheel.stations()).map(|(s, raw)| {
                let direction = raw.direction + roll;
                Turned {
                    y: s.y * cos - s.z * sin,
                    z: s.y * sin + s.z * cos,
                    direction,
                    cos: direction.abs().min(STEEPEST_CONTACT).cos(),
                }
            }));
            for i in 0..self.shifts.count() {
                node(&turned, roll, self.shifts.from(nominal, i), self.shifts.is_close(i));
            }
        }
    }

    /// One part of a zone that touches in two places, over all nodes; `known` has those that need no search.
    fn part(
        &self,
        rail_origin_y: f64,
        wheel: &Profile,
        support: &Support,
        known: impl Fn(usize) -> Option<([f64; 2], Values)>,
        scratch: &mut Scratch,
    ) -> Part {
        let count = self.shifts.count() * ROLLS;
        let mut out = Part { gaps: Vec::with_capacity(count), values: Vec::with_capacity(count) };
        self.nodes(rail_origin_y, wheel, |turned, _, offset, _| {
            let (gap, values) = known(out.gaps.len()).unwrap_or_else(|| {
                self.look(turned, offset, support.first..support.end, scratch);
                self.node(turned, offset, support, scratch)
                    .map_or(([NO_RAIL, 0.0], [0.0; 16]), |f| (f.gap, f.values))
            });
            out.gaps.push(gap);
            out.values.push(values);
        });
        out
    }

    fn gap(&self, t: &Turned, offset: f64) -> f64 {
        self.rail.z(t.y + offset).map_or(f64::INFINITY, |z| z - t.z)
    }

    /// Gaps at the ends of the coarse cells that hold some stations; infinite elsewhere.
    fn look(&self, turned: &[Turned], offset: f64, over: Range<usize>, scratch: &mut Scratch) {
        let cells = over.start / STRIDE..over.end.div_ceil(STRIDE) + 1;
        scratch.coarse.clear();
        scratch.coarse.extend(
            turned
                .iter()
                .step_by(STRIDE)
                .enumerate()
                .map(|(c, t)| if cells.contains(&c) { self.gap(t, offset) } else { f64::INFINITY }),
        );
    }

    fn node(
        &self,
        turned: &[Turned],
        offset: f64,
        support: &Support,
        scratch: &mut Scratch,
    ) -> Option<Found> {
        let coarse_least = scratch
            .coarse
            .iter()
            .enumerate()
            .filter(|(c, _)| support.has(c * STRIDE))
            .map(|(_, g)| *g)
            .fold(f64::INFINITY, f64::min);
        if !coarse_least.is_finite() {
            return None;
        }
        scratch.fine.clear();
        for c in support.first / STRIDE..support.end.div_ceil(STRIDE) {
            let first = c * STRIDE;
            let end = (first + STRIDE).min(turned.len());
            let next = scratch.coarse.get(c + 1).copied().unwrap_or(f64::INFINITY);
            let near = (self.penetration + SLACK) / turned[first].cos.min(turned[end - 1].cos);
            if scratch.coarse[c].min(next) - coarse_least > near
                || !(support.has(first) || support.has(end - 1))
            {
                continue;
            }
            for k in (first..end).filter(|&k| support.has(k)) {
                let g = self.gap(&turned[k], offset);
                if g.is_finite() {
                    scratch.fine.push((k, g));
                }
            }
        }
        let &(lowest, least) = scratch.fine.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let average = self.average(turned, offset, support, least, &scratch.fine);
        let tan = average.angle.clamp(-STEEPEST_CONTACT, STEEPEST_CONTACT).tan();
        // the second part: the profile's own distance from the running circle, foreshortened
        let yaw = 0.5 * tan * ((self.placement.wheel_radius + average.z_wheel) * tan - average.y_wheel);
        let mut values = average.values(self.placement);
        if at_end(self.rail, turned, offset, lowest) {
            values[0] = f64::NAN;
        }
        Some(Found { gap: [least, yaw], values })
    }
}

/// Whether a closest station is the last of the wheel, or over the last of the rail, so that the surfaces might come closer beyond.
fn at_end(rail: &Profile, turned: &[Turned], offset: f64, k: usize) -> bool {
    let beyond = |k: usize| rail.z(turned[k].y + offset).is_none();
    k == 0 || k + 1 == turned.len() || beyond(k - 1) || beyond(k + 1)
}

/// Quasi-elastic averages of one zone.
#[derive(Default)]
struct Average {
    share: f64,
    y_rail: f64,
    z_rail: f64,
    y_wheel: f64,
    z_wheel: f64,
    angle: f64,
    curvature: f64,
    rail_curvature: f64,
}

impl Scene<'_> {
    fn average(
        &self,
        turned: &[Turned],
        offset: f64,
        support: &Support,
        least: f64,
        fine: &[(usize, f64)],
    ) -> Average {
        let mut sum = Average::default();
        let mut total = 0.0;
        for &(k, g) in fine {
            let (station, t) = (&self.stations[k], &turned[k]);
            let w = 1.0 - (g - least) * t.cos / self.penetration;
            if w <= 0.0 {
                continue;
            }
            let y = t.y + offset;
            let Some(local) = self.rail.local(y) else { continue };
            total += w;
            sum.share += w * support.chi[k];
            sum.y_rail += w * y;
            sum.z_rail += w * (g + t.z);
            sum.y_wheel += w * station.y;
            sum.z_wheel += w * station.z;
            sum.angle -= w * 0.5 * (t.direction + local.direction);
            sum.curvature += w * (local.curvature - station.curvature);
            sum.rail_curvature += w * local.curvature;
        }
        let scale = 1.0 / total;
        let width = total * SPACING;
        let conforming = 0.5 * 32.0 * self.penetration / (9.0 * width * width);
        Average {
            share: sum.share * scale,
            y_rail: sum.y_rail * scale,
            z_rail: sum.z_rail * scale,
            y_wheel: sum.y_wheel * scale,
            z_wheel: sum.z_wheel * scale,
            angle: sum.angle * scale,
            curvature: (sum.curvature * scale).max(conforming).max(LEAST_CURVATURE),
            rail_curvature: sum.rail_curvature * scale,
        }
    }
}

impl Average {
    fn values(&self, placement: &Placement) -> Values {
        let rates = self.yaw_rates(placement);
        let along = self.angle.cos() / (placement.wheel_radius + self.z_wheel);
        let modulus = hertz::effective_modulus(placement.youngs_modulus, placement.poisson);
        let patch = hertz::solve(along, self.curvature, modulus);
        let kalker = kalker_table::coefficients(patch.a1 / patch.b1, placement.poisson);
        [
            self.share,
            self.y_rail,
            self.z_rail,
            self.y_wheel,
            self.z_wheel,
            self.angle,
            patch.stiffness,
            patch.a1,
            patch.b1,
            kalker.c11,
            kalker.c22,
            kalker.c23,
            rates[0],
            rates[1],
            rates[2],
            rates[3],
        ]
    }

    /// Rates by yaw^2 of y on the rail, y on the wheel and the angle, and dz/dy.
    fn yaw_rates(&self, placement: &Placement) -> [f64; 4] {
        let angle = self.angle.clamp(-STEEPEST_CONTACT, STEEPEST_CONTACT);
        let (sin, cos) = angle.sin_cos();
        let radius = placement.wheel_radius + self.z_wheel;
        // gamma along the wheel, outward
        let turning = self.curvature - self.rail_curvature;
        let slope = 0.5 * radius * (sin + sin / (cos * cos)) * turning;
        let bound = YAW_TRAVEL / (YAW_FULL * YAW_FULL);
        let travel = (slope / self.curvature).clamp(-bound, bound);
        let tan = sin / cos;
        // wheel and rail meet at the same lateral place: the outline's own shift is what the station loses
        let on_wheel = cos * travel - radius * tan;
        [cos * travel, on_wheel, -self.rail_curvature * travel, -tan]
    }
}

pub(crate) fn check(wheel: &Profile, rail: &Profile, p: &Placement) -> Result<()> {
    let mut faults = Vec::new();
    if wheel.kind != ProfileKind::Wheel {
        faults.push(Fault::new(KeyPath::of("run.wheel_profile"), "a rail profile", "a wheel profile"));
    }
    if rail.kind != ProfileKind::Rail {
        faults.push(Fault::new(KeyPath::of("track.rail_profile"), "a wheel profile", "a rail profile"));
    }
    let mut range = |key: &str, value: f64, low: f64, high: f64, unit: &str| {
        if !(low..=high).contains(&value) {
            faults.push(Fault::new(
                KeyPath::of(key),
                format!("{value} {unit}"),
                format!("{low} to {high} {unit}"),
            ));
        }
    };
    range("track.gauge", p.gauge, 0.2, 3.0, "m");
    range("track.gauge_point_depth", p.gauge_point_depth, 1e-3, 0.05, "m");
    range("track.rail_inclination", p.rail_inclination, -0.2, 0.2, "");
    range("vehicle.wheelset.tape_half_distance", p.tape_half_distance, 0.1, 1.5, "m");
    range("vehicle.wheelset.radius", p.wheel_radius, 0.05, 2.0, "m");
    range("vehicle.contact.youngs_modulus", p.youngs_modulus, 1e8, 1e13, "Pa");
    range("vehicle.contact.poisson", p.poisson, 0.0, 0.5, "");
    if faults.is_empty() {
        super::gauge::faults(wheel, p, &mut faults);
    }
    if faults.is_empty() { Ok(()) } else { Err(Error::Input(faults)) }
}
