//! Wheel and rail profiles: points, checked and smoothed into a curve with slope and curvature.
//!
//! Axes: y outward from the track centre, z down, metres. A wheel's origin is its running (tape) circle, 70 mm from
//! the back of the flange, flange at negative y; a rail's origin is the top of the upright head, gauge corner at negative y.
//!
//! [`read`](read()) and [`write`](write()) know the formats, [`quality`](quality()) reports on points before they are used.
//!
//! Smoothness: z(y) is once continuously differentiable (cubic Hermite pieces through smoothed stations), the
//! curvature is continuous (see [`fit`] for what smoothing does to arcs and jumps).

mod crossing;
mod csv;
pub mod fit;
mod gensys;
mod miniprof;
mod quality;
mod read;
mod shape;
mod simpack;
mod text;
mod vampire;

pub use csv::read_csv;
pub use fit::Station;
pub use quality::{Code, Finding, Severity, quality};
pub use read::{Detected, Format, LengthUnit, PointList, ReadOptions, Told, WriteOptions, read, write};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Fault, KeyPath, Result};

/// Steepest surface that is kept, rad from the horizontal (86 degrees): beyond it z(y) is no function worth having.
pub const STEEPEST: f64 = 1.5;
/// Half-width of the smoothing window along the arc, m. One millimetre keeps the 13 mm gauge corner and averages
/// some twenty points of a profile given every 0.1 mm.
pub const HALF_WIDTH: f64 = 1.0e-3;
/// Distance of stations along the arc, m.
pub const SPACING: f64 = 0.05e-3;
/// Greatest distance of neighbouring points, m.
const WIDEST_GAP: f64 = 0.02;
/// Step of the lookup grid in y, m.
const GRID: f64 = 0.02e-3;

/// What a profile belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProfileKind {
    /// A wheel: the body lies above the curve.
    Wheel,
    /// A rail: the body lies below the curve.
    Rail,
}

impl ProfileKind {
    /// `wheel` or `rail`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Wheel => "wheel",
            Self::Rail => "rail",
        }
    }
}

/// One cell of the lookup grid: z = c0 + t (c1 + t (c2 + t c3)), t in 0..1; curvature and direction linear.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    c: [f64; 4],
    curvature: [f64; 2],
    direction: [f64; 2],
}

/// A smoothed profile at one y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Local {
    /// Direction of the tangent, rad.
    pub direction: f64,
    /// z''/(1 + z'^2)^1.5, 1/m.
    pub curvature: f64,
}

/// A profile: its points and the smoothed curve through them.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// What it belongs to.
    pub kind: ProfileKind,
    /// The points as given, m, ordered by rising arc length from the flange or gauge side.
    pub points: Vec<[f64; 2]>,
    /// The smoothed part that can be seen from above, rising y.
    stations: Vec<Station>,
    half_width: f64,
    y_first: f64,
    cells: Vec<Cell>,
}

impl Profile {
    /// A profile from points [y, z] in metres, smoothed over +-[`HALF_WIDTH`]; `at` is the key of the points in the case.
    ///
    /// The points may run either way. An overhang (the underside of a head, the back of a flange) is allowed and left
    /// out: what is kept runs both ways from the top of the rail or the running circle of the wheel to where the surface
    /// becomes steeper than [`STEEPEST`].
    ///
    /// # Errors
    /// - fewer than 8 points, a value that is not finite,
    /// - a profile narrower than 10 mm or wider than 300 mm (units), one that plainly has the shape of the other kind,
    /// - a profile that crosses itself, two neighbouring points more than 20 mm apart,
    /// - a wheel without the running circle (y = 0) or with its flange at positive y, a rail whose top is not near its origin.
    pub fn new(points: &[[f64; 2]], kind: ProfileKind, at: &KeyPath) -> Result<Self> {
        Self::smoothed(points, kind, HALF_WIDTH, at)
    }

    /// The same with another half-width of the smoothing window, m (0.3 mm to 10 mm): wider for noisy measured points.
    ///
    /// # Errors
    /// As [`Profile::new`], and a half-width outside its range.
    pub fn smoothed(points: &[[f64; 2]], kind: ProfileKind, half_width: f64, at: &KeyPath) -> Result<Self> {
        check(points, kind, half_width, at)?;
        let mut points = points.to_vec();
        if points[0][0] > points[points.len() - 1][0] {
            points.reverse();
        }
        let all = fit::stations(&points, SPACING, half_width);
        let mut profile =
            Self { kind, points, stations: visible(&all, kind), half_width, y_first: 0.0, cells: Vec::new() };
        if profile.stations.len() < 100 {
            return Err(Error::input(Fault::new(
                at.clone(),
                format!(
                    "{:.1} mm of profile less steep than 86 degrees",
                    5e-2 * profile.stations.len() as f64
                ),
                "at least 5 mm around the running circle or the top of the rail",
            )));
        }
        profile.tabulate();
        if kind == ProfileKind::Wheel {
            profile.shift_z(at)?;
        }
        Ok(profile)
    }

    /// The rail turned about its origin so that its head leans to the track centre by `slope` (0.05 for 1:20): a flat
    /// head becomes z = -slope * y. The origin is not moved.
    ///
    /// # Errors
    /// As [`Profile::new`].
    pub fn inclined(&self, slope: f64, at: &KeyPath) -> Result<Self> {
        let (sin, cos) = slope.atan().sin_cos();
        let points: Vec<[f64; 2]> =
            self.points.iter().map(|p| [p[0] * cos + p[1] * sin, p[1] * cos - p[0] * sin]).collect();
        Self::smoothed(&points, self.kind, self.half_width, at)
    }

    /// Moves the curve so that its highest point is at z = 0; returns by how much it was below.
    pub(crate) fn top_to_zero(&mut self) -> f64 {
        let top = self.stations.iter().map(|s| s.z).fold(f64::INFINITY, f64::min);
        self.lift(top);
        top
    }

    fn lift(&mut self, by: f64) {
        self.points.iter_mut().for_each(|p| p[1] -= by);
        self.stations.iter_mut().for_each(|s| s.z -= by);
        self.cells.iter_mut().for_each(|cell| cell.c[0] -= by);
    }

    /// Smoothed stations of the part that can be seen from above, rising y, every [`SPACING`] of arc.
    #[must_use]
    pub fn stations(&self) -> &[Station] {
        &self.stations
    }

    /// Least and greatest y of the smoothed curve, m.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        (self.y_first, self.y_first + GRID * self.cells.len() as f64)
    }

    #[inline]
    fn cell(&self, y: f64) -> Option<(&Cell, f64)> {
        let x = (y - self.y_first) * (1.0 / GRID);
        if x.is_nan() || x < 0.0 {
            return None;
        }
        let index = x as usize;
        self.cells.get(index).map(|cell| (cell, x - index as f64))
    }

    /// z (m, down) at y; `None` outside [`Profile::range`].
    #[inline]
    #[must_use]
    pub fn z(&self, y: f64) -> Option<f64> {
        self.cell(y).map(|(cell, t)| cell.c[0] + t * (cell.c[1] + t * (cell.c[2] + t * cell.c[3])))
    }

    /// Slope dz/dy at y; `None` outside [`Profile::range`].
    #[must_use]
    pub fn slope(&self, y: f64) -> Option<f64> {
        self.cell(y).map(|(cell, t)| (cell.c[1] + t * (2.0 * cell.c[2] + t * 3.0 * cell.c[3])) / GRID)
    }

    /// Curvature z''/(1 + z'^2)^1.5 at y, 1/m: positive where a rail is convex, negative where a wheel is convex;
    /// `None` outside [`Profile::range`].
    #[must_use]
    pub fn curvature(&self, y: f64) -> Option<f64> {
        self.cell(y).map(|(cell, t)| cell.curvature[0] + t * (cell.curvature[1] - cell.curvature[0]))
    }

    /// Direction and curvature at y, in one lookup.
    #[inline]
    pub(crate) fn local(&self, y: f64) -> Option<Local> {
        self.cell(y).map(|(cell, t)| Local {
            direction: cell.direction[0] + t * (cell.direction[1] - cell.direction[0]),
            curvature: cell.curvature[0] + t * (cell.curvature[1] - cell.curvature[0]),
        })
    }

    /// Lookup grid from the stations.
    fn tabulate(&mut self) {
        let s = &self.stations;
        self.y_first = s[0].y;
        let count = ((s[s.len() - 1].y - self.y_first) / GRID).floor() as usize;
        let mut nodes = Vec::with_capacity(count + 1); // z, dz/dy, curvature, direction
        let mut i = 0;
        for k in 0..=count {
            let y = self.y_first + GRID * k as f64;
            while i + 2 < s.len() && s[i + 1].y < y {
                i += 1;
            }
            let (p, q) = (&s[i], &s[i + 1]);
            let h = q.y - p.y;
            let t = (y - p.y) / h;
            let (m0, m1) = (p.direction.tan() * h, q.direction.tan() * h);
            let (t2, t3) = (t * t, t * t * t);
            let z = (2.0 * t3 - 3.0 * t2 + 1.0) * p.z
                + (t3 - 2.0 * t2 + t) * m0
                + (3.0 * t2 - 2.0 * t3) * q.z
                + (t3 - t2) * m1;
            let dz =
                (6.0 * (t2 - t) * (p.z - q.z) + (3.0 * t2 - 4.0 * t + 1.0) * m0 + (3.0 * t2 - 2.0 * t) * m1)
                    / h;
            nodes.push([
                z,
                dz,
                p.curvature + t * (q.curvature - p.curvature),
                p.direction + t * (q.direction - p.direction),
            ]);
        }
        self.cells = nodes
            .windows(2)
            .map(|w| {
                let ([z0, d0, k0, a0], [z1, d1, k1, a1]) = (w[0], w[1]);
                let (m0, m1) = (d0 * GRID, d1 * GRID);
                Cell {
                    c: [z0, m0, 3.0 * (z1 - z0) - 2.0 * m0 - m1, 2.0 * (z0 - z1) + m0 + m1],
                    curvature: [k0, k1],
                    direction: [a0, a1],
                }
            })
            .collect();
    }

    /// Moves a wheel so that its running circle is the origin.
    fn shift_z(&mut self, at: &KeyPath) -> Result<()> {
        let Some(z0) = self.z(0.0) else {
            return Err(Error::input(Fault::new(
                at.clone(),
                format!("y from {:.1} to {:.1} mm", 1e3 * self.range().0, 1e3 * self.range().1),
                "a wheel profile that covers its running circle, y = 0",
            )));
        };
        self.lift(z0);
        Ok(())
    }
}

/// The stretch around the top of a rail or the running circle of a wheel that is less steep than [`STEEPEST`].
fn visible(all: &[Station], kind: ProfileKind) -> Vec<Station> {
    let distance = |s: &Station| match kind {
        ProfileKind::Rail => s.z,
        ProfileKind::Wheel => s.y.abs(),
    };
    let Some(start) = (0..all.len()).min_by(|&i, &j| distance(&all[i]).total_cmp(&distance(&all[j]))) else {
        return Vec::new();
    };
    let good = |s: &Station| s.direction.abs() <= STEEPEST;
    let mut first = start;
    while first > 0 && good(&all[first - 1]) && all[first - 1].y < all[first].y {
        first -= 1;
    }
    let mut last = start;
    while last + 1 < all.len() && good(&all[last + 1]) && all[last + 1].y > all[last].y {
        last += 1;
    }
    all[first..=last].to_vec()
}

fn check(points: &[[f64; 2]], kind: ProfileKind, half_width: f64, at: &KeyPath) -> Result<()> {
    let mut faults = Vec::new();
    if points.len() < read::LEAST_POINTS {
        faults.push(Fault::new(at.clone(), format!("{} points", points.len()), "at least 8 points"));
    }
    for (i, p) in points.iter().enumerate() {
        if !(p[0].is_finite() && p[1].is_finite()) {
            faults.push(Fault::new(at.index(i), format!("[{}, {}]", p[0], p[1]), "finite numbers"));
        }
    }
    if !(0.3e-3..=10e-3).contains(&half_width) {
        faults.push(Fault::new(
            at.clone(),
            format!("smoothing over +-{} mm", 1e3 * half_width),
            "a half-width from 0.3 to 10 mm",
        ));
    }
    if !faults.is_empty() {
        return Err(Error::Input(faults));
    }
    // what is wrong as a whole says more than what follows from it
    let whole = shape::wrong_unit(points, at)
        .or_else(|| shape::wrong_kind(&shape::Shape::of(points, Some(kind)), kind, at))
        .or_else(|| crossing::fault(points, at));
    if let Some(fault) = whole {
        return Err(Error::input(fault));
    }
    for (i, w) in points.windows(2).enumerate() {
        let gap = (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]);
        if gap > WIDEST_GAP {
            faults.push(Fault::new(
                at.index(i + 1),
                format!("{:.1} mm from the point before", 1e3 * gap),
                "at most 20 mm between neighbours",
            ));
            break;
        }
    }
    let (least, most) = shape::width(points);
    // lowest point on either side of the origin
    let lowest = |side: f64| {
        points.iter().filter(|p| p[0] * side > 0.0).map(|p| p[1]).fold(f64::NEG_INFINITY, f64::max)
    };
    match kind {
        ProfileKind::Wheel if lowest(-1.0) < lowest(1.0) => faults.push(
            Fault::new(
                at.clone(),
                "the flange at positive y",
                "a wheel with its flange at negative y, z down",
            )
            .hint("mirror y, or z if it points up"),
        ),
        ProfileKind::Rail => {
            let top = points.iter().min_by(|p, q| p[1].total_cmp(&q[1])).map_or(0.0, |p| p[0]);
            if top.abs() > 0.8 * 0.5 * (most - least) || least > 0.0 || most < 0.0 {
                faults.push(
                    Fault::new(
                        at.clone(),
                        format!("the highest point at y = {:.1} mm", 1e3 * top),
                        "a rail whose top lies at its origin, z down",
                    )
                    .hint("mirror z if it points up"),
                );
            }
        }
        ProfileKind::Wheel => {}
    }
    if faults.is_empty() { Ok(()) } else { Err(Error::Input(faults)) }
}

#[cfg(test)]
mod tests;
