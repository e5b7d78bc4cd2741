//! The design gauge: how much wider than the track's own it is, constant or passing along the segments.

use super::transition::Transition;

/// Largest widening that is accepted, mm.
pub const MAX_MM: f64 = 50.0;

/// One segment: where it begins (m), 1/length, the widening at its start and what is added along it (m).
#[derive(Debug, Clone, Copy)]
struct Stretch {
    start: f64,
    per_length: f64,
    from: f64,
    rise: f64,
    transition: Transition,
}

/// Widening along the track; nothing in it where the gauge is the same throughout.
#[derive(Debug, Clone, Default)]
pub(super) struct Gauge {
    stretches: Vec<Stretch>,
    end: f64,
    last: f64,
}

impl Gauge {
    /// Adds the next segment: its length (m), the widening at its ends (mm) and how it passes between them.
    pub fn push(&mut self, length: f64, ends_mm: [f64; 2], transition: Transition) {
        let [from, to] = ends_mm.map(|mm| 1e-3 * mm);
        let per_length = 1.0 / length;
        self.stretches.push(Stretch { start: self.end, per_length, from, rise: to - from, transition });
        self.end += length;
        self.last = to;
    }

    /// The same, with nothing in it if nothing is widened.
    pub fn or_nothing(self) -> Self {
        if self.stretches.iter().all(|s| s.from == 0.0 && s.rise == 0.0) { Self::default() } else { self }
    }

    /// Widening (m) and its slope at `s`; outside the segments that of the nearest end.
    #[inline]
    pub fn at(&self, s: f64) -> (f64, f64) {
        let Some(first) = self.stretches.first() else { return (0.0, 0.0) };
        if s >= self.end {
            return (self.last, 0.0);
        }
        let next = self.stretches.partition_point(|stretch| stretch.start <= s);
        let Some(stretch) = next.checked_sub(1).and_then(|i| self.stretches.get(i)) else {
            return (first.from, 0.0);
        };
        if stretch.rise == 0.0 {
            return (stretch.from, 0.0);
        }
        let shape = stretch.transition.at((s - stretch.start) * stretch.per_length);
        (stretch.from + stretch.rise * shape.value, stretch.rise * shape.slope * stretch.per_length)
    }
}
