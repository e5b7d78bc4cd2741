//! The shifts of a table's nodes: close together where flange and tread change places, wider apart where a wheel of a widened track stands
//! on the outer part of its tread.

use super::gauge::flange;
use super::{INWARD_STEP, MOST_INWARD, OUTWARD_MARGIN, Placement, SHIFT_RANGE, SHIFT_STEP};
use crate::contact::profile::Profile;

/// Columns of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shifts {
    /// Cells of [`INWARD_STEP`], inward of -[`SHIFT_RANGE`].
    wide: usize,
    /// Cells of [`SHIFT_STEP`] outward from there.
    close: usize,
}

impl Shifts {
    /// Of a pair: inward to where the end of the wheel's rim stands over the top of the rail, outward to some way beyond flange contact;
    /// [`SHIFT_RANGE`] at least, each way.
    ///
    /// `nominal` is the rail coordinate of the running circle when the shift is zero, m.
    pub(super) fn new(wheel: &Profile, nominal: f64, placement: &Placement) -> Self {
        let (_, rim) = wheel.range();
        let inward = (rim + nominal).min(MOST_INWARD) - SHIFT_RANGE;
        let clearance = flange(wheel, placement.gauge_point_depth)
            .map_or(0.0, |y| 0.5 * placement.gauge - placement.tape_half_distance - y);
        // a tenth of a millimetre of rounding is no reason for a larger table
        let outward = (1e3 * (clearance + OUTWARD_MARGIN) - 0.1).ceil() * 1e-3;
        Self {
            wide: (inward.max(0.0) / INWARD_STEP) as usize,
            close: ((SHIFT_RANGE + outward.max(SHIFT_RANGE)) / SHIFT_STEP).round() as usize,
        }
    }

    /// Nodes.
    #[inline(always)]
    pub(super) fn count(self) -> usize {
        self.wide + self.close + 1
    }

    /// Whether a node lies where they are close together.
    pub(super) fn is_close(self, i: usize) -> bool {
        i >= self.wide
    }

    /// Least and greatest shift, m.
    pub(super) fn reach(self) -> [f64; 2] {
        [-SHIFT_RANGE - INWARD_STEP * self.wide as f64, -SHIFT_RANGE + SHIFT_STEP * self.close as f64]
    }

    /// Shift of node `i` from `origin`, m.
    pub(super) fn from(self, origin: f64, i: usize) -> f64 {
        match i.checked_sub(self.wide) {
            Some(close) => origin - SHIFT_RANGE + SHIFT_STEP * close as f64,
            None => origin - SHIFT_RANGE - INWARD_STEP * (self.wide - i) as f64,
        }
    }

    /// Node at or inward of a shift, and the part of the step beyond it; `None` outside.
    #[inline(always)]
    pub(super) fn place(self, dy: f64) -> Option<(usize, f64)> {
        let x = (dy + SHIFT_RANGE) * (1.0 / SHIFT_STEP);
        if x >= 0.0 && x <= self.close as f64 {
            let i = (x as usize).min(self.close - 1);
            return Some((self.wide + i, x - i as f64));
        }
        let x = (dy + SHIFT_RANGE) * (1.0 / INWARD_STEP) + self.wide as f64;
        // A shift just inward of the close nodes may round to the first of them: it is the end of the last wide cell.
        (x >= 0.0 && dy < 0.0 && self.wide > 0).then(|| {
            let i = (x as usize).min(self.wide - 1);
            (i, x - i as f64)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every shift within reach has its cell, also those that differ from a seam by a rounding; none outside has.
    #[test]
    fn no_gap_between_wide_and_close_cells() {
        let grid = Shifts { wide: 66, close: 400 };
        for (from, to) in [(-SHIFT_RANGE, 0.0), (-0.053, 1e-12), (0.02, -1e-12)] {
            let mut dy = from + to;
            (0..40).for_each(|_| dy = dy.next_down());
            for _ in 0..80 {
                let (i, part) = grid.place(dy).unwrap_or_else(|| panic!("{dy:e}"));
                let next = grid.from(0.0, i + 1);
                let at = grid.from(0.0, i) + part * (next - grid.from(0.0, i));
                assert!((at - dy).abs() < 1e-15 && (-1e-9..=1.0 + 1e-9).contains(&part), "{dy:e} {i} {part}");
                dy = dy.next_up();
            }
        }
        let none = Shifts { wide: 0, close: 400 };
        for outside in [-0.0531, 0.0201, f64::NAN] {
            assert!(grid.place(outside).is_none() && none.place(outside).is_none());
        }
        assert!(none.place(-0.0201).is_none() && none.place(-0.02).is_some());
    }
}
