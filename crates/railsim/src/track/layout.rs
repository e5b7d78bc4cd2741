//! The design line: segments as written, compiled to frames in closed form.
//!
//! Along each segment curvature (the turning of the heading per metre of arc length), cant (mm), gradient angle and the
//! widening of the gauge are constant or pass from one value to the next by one [`Transition`]; a vertical curve is a passage
//! of the gradient angle, if linear a circular arc in elevation. Heading, gradient and cant are closed forms of s; the
//! position is the integral of the direction, a closed form on straight and uniformly curved track, elsewhere summed
//! once at nodes and continued from the nearest one by a four-point Gauss rule over less than a tenth of a radian
//! (error below 1e-17 of the length).

use super::cant;
use super::frame::{Attitude, Frame};
use super::gauge::Gauge;
use super::segment::{Ends, Segment, ends, faults};
use super::transition::Transition;
use crate::error::{Error, KeyPath, Result};
use crate::math::Vec3;
use crate::math::angle::{self, SinCos};
use crate::math::quadrature::GAUSS_4;

/// Nodes stand so close that the line turns by no more than this between two of them, rad.
const TURN_PER_CELL: f64 = 0.1;

/// Least number of cells of a shape that is no straight line, so that the rule follows the shape; made even, so that one ends
/// where Helmert's parabolas meet.
const CELLS_PER_SHAPE: f64 = 16.0;

/// The line at one point: origin, heading and gradient.
#[derive(Debug, Clone, Copy)]
struct Line {
    r_IT: Vec3,
    heading: SinCos,
    gradient: SinCos,
}

/// The line at the start of a cell, with its angles (rad) as numbers.
#[derive(Debug, Clone, Copy)]
struct Node {
    line: Line,
    heading: f64,
    gradient: f64,
}

/// A segment compiled.
#[derive(Debug, Clone)]
struct Piece {
    start: f64,
    length: f64,
    per_length: f64,
    transition: Transition,
    /// At the start and what is added along the piece: heading per metre, sine of cant, gradient angle.
    curvature: [f64; 2],
    cant: [f64; 2],
    gradient: [f64; 2],
    /// Heading at the start, rad.
    heading: f64,
    /// Curvature and gradient constant: the line is a closed form, one node is enough.
    uniform: bool,
    /// The line at the starts of equal cells; the first is the start of the piece.
    nodes: Vec<Node>,
    cell: f64,
    /// Frame at the start: all that is needed on uniform straight track.
    first: Frame,
}

impl Piece {
    fn new(
        start: f64,
        length: f64,
        ends: [Ends; 2],
        transition: Transition,
        heading: f64,
        r_IT: Vec3,
    ) -> Self {
        let rise = |f: fn(&Ends) -> f64| [f(&ends[0]), f(&ends[1]) - f(&ends[0])];
        let curvature = rise(|e| e.curvature);
        let gradient = rise(|e| e.gradient.atan());
        let turn = curvature[0].abs().max((curvature[0] + curvature[1]).abs()) * length + gradient[1].abs();
        let mut cells = (turn / TURN_PER_CELL).ceil().max(1.0);
        if transition != Transition::Linear {
            cells = 2.0 * (0.5 * cells.max(CELLS_PER_SHAPE)).ceil();
        }
        let mut piece = Self {
            start,
            length,
            per_length: 1.0 / length,
            transition,
            curvature,
            cant: rise(|e| cant::sine(e.cant_mm)),
            gradient,
            heading,
            uniform: curvature[1] == 0.0 && gradient[1] == 0.0,
            nodes: Vec::new(),
            cell: length / cells,
            first: Frame::level(0.0),
        };
        piece.nodes.push(piece.node(0.0, r_IT));
        if !piece.uniform {
            for k in 1..cells as usize {
                let u = k as f64 * piece.cell;
                piece.nodes.push(piece.node(u, piece.line(u).r_IT));
            }
        }
        piece.first = piece.frame(0.0);
        piece
    }

    /// On straight track without passages the frame only moves.
    fn is_straight(&self) -> bool {
        self.uniform && self.curvature[0] == 0.0 && self.cant[1] == 0.0
    }

    fn is_level_tangent(&self) -> bool {
        self.is_straight() && self.cant[0] == 0.0 && self.gradient[0] == 0.0
    }

    fn heading_at(&self, u: f64) -> f64 {
        let [k0, rise] = self.curvature;
        let mut heading = self.heading + k0 * u;
        if rise != 0.0 {
            heading += rise * self.length * self.transition.at(u * self.per_length).integral;
        }
        heading
    }

    fn gradient_at(&self, u: f64) -> f64 {
        let [start, rise] = self.gradient;
        if rise == 0.0 { start } else { start + rise * self.transition.at(u * self.per_length).value }
    }

    fn node(&self, u: f64, r_IT: Vec3) -> Node {
        let (heading, gradient) = (self.heading_at(u), self.gradient_at(u));
        Node {
            line: Line { r_IT, heading: heading.sin_cos(), gradient: gradient.sin_cos() },
            heading,
            gradient,
        }
    }

    /// The line at distance `u` from the start of the piece.
    fn line(&self, u: f64) -> Line {
        if self.uniform { self.arc(u) } else { self.passage(u) }
    }

    /// Constant curvature and gradient: the chord u sinc(k u/2) in the direction of its middle.
    fn arc(&self, u: f64) -> Line {
        let Line { r_IT, heading, gradient } = self.nodes[0].line;
        let half = 0.5 * self.curvature[0] * u;
        let (sin, cos) = half.sin_cos();
        let sinc = if half.abs() < 1e-4 { 1.0 - half * half / 6.0 } else { sin / half };
        let middle = angle::add(heading, (sin, cos));
        let mut chord = Attitude::direction(middle, gradient);
        chord.x *= sinc;
        chord.y *= sinc;
        Line { r_IT: r_IT + u * chord, heading: angle::add(middle, (sin, cos)), gradient }
    }

    /// From the start of the cell on, by quadrature; the angles differ little from those of the node.
    fn passage(&self, u: f64) -> Line {
        let index = ((u / self.cell) as usize).min(self.nodes.len() - 1);
        let node = &self.nodes[index];
        let from = index as f64 * self.cell;
        let angles = |u: f64| {
            let heading = angle::add(node.line.heading, angle::small(self.heading_at(u) - node.heading));
            if self.gradient[1] == 0.0 {
                return (heading, node.line.gradient);
            }
            (heading, angle::add(node.line.gradient, angle::small(self.gradient_at(u) - node.gradient)))
        };
        let half = 0.5 * (u - from);
        let mut sum = Vec3::zeros();
        for (x, weight) in GAUSS_4 {
            let (heading, gradient) = angles(from + half * (1.0 + x));
            sum += weight * Attitude::direction(heading, gradient);
        }
        let (heading, gradient) = angles(u);
        Line { r_IT: node.line.r_IT + half * sum, heading, gradient }
    }

    fn frame(&self, u: f64) -> Frame {
        let shape = self.transition.at(u * self.per_length);
        let slope = shape.slope * self.per_length;
        let along = |[start, rise]: [f64; 2]| (start + rise * shape.value, rise * slope);
        let (curvature, _) = along(self.curvature);
        let (sine, sine_slope) = along(self.cant);
        let (_, gradient_slope) = along(self.gradient);
        // sin(c) is what the transition shapes: c' = sin' / cos.
        let cosine = (1.0 - sine * sine).sqrt();
        let cant_slope = sine_slope / cosine;
        let Line { r_IT, heading, gradient } = self.line(u);
        let attitude = Attitude {
            heading,
            gradient,
            cant: (sine, cosine),
            first: [curvature, gradient_slope, cant_slope],
        };
        attitude.frame(r_IT)
    }
}

/// The design line, compiled: immutable, no allocation after `new`.
#[derive(Debug, Clone)]
pub struct Layout {
    pieces: Vec<Piece>,
    length: f64,
    end: f64,
    last: Frame,
    tangent: bool,
    gauge: Gauge,
}

impl Layout {
    /// Straight level track.
    #[must_use]
    pub fn tangent(length: f64) -> Self {
        Self {
            pieces: Vec::new(),
            length,
            end: length,
            last: Frame::level(length),
            tangent: true,
            gauge: Gauge::default(),
        }
    }

    /// Compiles segments (none: straight level track) for a track of `length` metres; `at` is the path of the list.
    ///
    /// Where the segments end before the track does, it goes straight on.
    ///
    /// # Errors
    /// Every fault at once: `length` not above 0; curvature above 0.1 1/m; both or none of `radius` and `curvature`;
    /// cant above 320 mm; gradient above 0.2; widening above 50 mm; a step of cant, gradient or widening between two segments;
    /// two passages in a row; a cubic parabola between two curves or longer than it can be; segments that end in a curve before the track ends.
    pub fn new(segments: &[Segment], length: f64, at: &KeyPath) -> Result<Self> {
        let faults = faults(segments, length, at);
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let mut pieces: Vec<Piece> = Vec::with_capacity(segments.len());
        let (mut s, mut heading, mut r_IT) = (0.0, 0.0, Vec3::zeros());
        let mut end = Frame::level(0.0);
        let mut gauge = Gauge::default();
        for (i, segment) in segments.iter().enumerate() {
            let ends = ends(segments, i);
            let transition = segment.transition(ends);
            let piece = Piece::new(s, segment.length(), ends, transition, heading, r_IT);
            gauge.push(segment.length(), ends.map(|e| e.widening_mm), transition);
            s += piece.length;
            heading = piece.heading_at(piece.length);
            end = piece.frame(piece.length);
            r_IT = end.r_IT;
            pieces.push(piece);
        }
        if pieces.iter().all(Piece::is_level_tangent) {
            return Ok(Self { gauge: gauge.or_nothing(), ..Self::tangent(length) });
        }
        Ok(Self { pieces, length, end: s, last: end, tangent: false, gauge: gauge.or_nothing() })
    }

    /// Length of the track as given, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Straight, level and without cant throughout.
    #[must_use]
    pub fn is_tangent(&self) -> bool {
        self.tangent
    }

    /// The frame at arc length `s` (m); before the first and after the last segment the track goes straight on.
    #[inline(always)]
    #[must_use]
    pub fn frame(&self, s: f64) -> Frame {
        if self.tangent { Frame::level(s) } else { self.general_frame(s) }
    }

    fn general_frame(&self, s: f64) -> Frame {
        match self.piece(s) {
            Some((piece, u)) if piece.is_straight() => piece.first.straight_on(u),
            Some((piece, u)) => piece.frame(u),
            None if s < 0.0 => self.pieces[0].first.straight_on(s),
            None => self.last.straight_on(s - self.end),
        }
    }

    /// Turning of the heading per metre at `s`, 1/m, + to the right.
    #[must_use]
    pub fn curvature(&self, s: f64) -> f64 {
        self.value(s, |piece| piece.curvature).unwrap_or(0.0)
    }

    /// How much wider than the track's own the gauge is at `s`, m, and its slope.
    #[inline]
    #[must_use]
    pub fn widening(&self, s: f64) -> (f64, f64) {
        self.gauge.at(s)
    }

    /// Cant angle at `s`, rad, + right rail lower.
    #[must_use]
    pub fn cant(&self, s: f64) -> f64 {
        match self.value(s, |piece| piece.cant) {
            Some(sine) => sine.asin(),
            None if self.tangent => 0.0,
            None => {
                let R_IT = self.general_frame(s).R_IT;
                R_IT[(2, 1)].atan2(R_IT[(2, 2)])
            }
        }
    }

    /// Gradient angle at `s`, rad, + uphill.
    #[must_use]
    pub fn gradient(&self, s: f64) -> f64 {
        match self.value(s, |piece| piece.gradient) {
            Some(angle) => angle,
            None if self.tangent => 0.0,
            None => -self.general_frame(s).R_IT[(2, 0)].asin(),
        }
    }

    /// A quantity (start, rise) of the piece at `s`; none outside the pieces.
    fn value(&self, s: f64, of: impl Fn(&Piece) -> [f64; 2]) -> Option<f64> {
        self.piece(s).map(|(piece, u)| {
            let [start, rise] = of(piece);
            start + rise * piece.transition.at(u * piece.per_length).value
        })
    }

    /// The piece at `s` and the distance from its start.
    fn piece(&self, s: f64) -> Option<(&Piece, f64)> {
        if !(s >= 0.0 && s < self.end) {
            return None;
        }
        let next = self.pieces.partition_point(|piece| piece.start <= s);
        let piece = self.pieces.get(next.checked_sub(1)?)?;
        Some((piece, s - piece.start))
    }
}
