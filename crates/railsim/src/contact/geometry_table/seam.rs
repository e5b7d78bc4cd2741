//! Where a zone of the wheel touches in two places at once.
//!
//! While a table is built, every node of usual roll is noted at which the wheel, lowered by the approach under load, would press two patches of one zone into the rail: the stations
//! between the two deepest count for a seam there, those within them against it, each by how deep the lesser patch reaches.
//! Where that comes to half the approach somewhere, the zone is cut where most counts for it.

use super::build::Turned;
use std::ops::Range;

/// Roll of a wheel against its rail within which a pair is looked at, rad: more turns it into a pair of another inclination.
pub(super) const USUAL_ROLL: f64 = 5e-3;
/// Depth of the lesser patch, as a part of the approach, from which on a zone is cut: it then carries a third of the other's load.
const LEAST_DEPTH: f64 = 0.5;
/// A seam is what has this part of the greatest count.
const PLATEAU: f64 = 0.9;
/// Least width of a seam, stations (0.4 mm of arc).
const LEAST_WIDTH: usize = 8;

/// What was seen of a zone.
pub(super) struct Seams {
    score: Vec<f64>,
    strongest: f64,
}

/// Stations next to each other, and the greatest interpenetration of them (1 where the zone is closest to the rail) times their weight.
#[derive(Clone)]
struct Stretch {
    stations: Range<usize>,
    depth: f64,
}

impl Seams {
    pub(super) fn new(stations: usize) -> Self {
        Self { score: vec![0.0; stations], strongest: 0.0 }
    }

    /// A node: the zone's weight chi, vertical gaps of its stations in order, `least` the smallest; the approach along the normal, m.
    pub(super) fn note(
        &mut self,
        turned: &[Turned],
        chi: &[f64],
        fine: &[(usize, f64)],
        least: f64,
        approach: f64,
    ) {
        // the two deepest
        let mut best: [Option<Stretch>; 2] = [None, None];
        let mut current: Option<Stretch> = None;
        for &(k, g) in fine {
            let depth = 1.0 - (g - least) * turned[k].cos / approach;
            if depth <= 0.0 {
                continue;
            }
            let depth = chi[k] * depth;
            match &mut current {
                Some(stretch) if stretch.stations.end == k => {
                    stretch.stations.end = k + 1;
                    stretch.depth = stretch.depth.max(depth);
                }
                _ => keep(&mut best, current.replace(Stretch { stations: k..k + 1, depth })),
            }
        }
        keep(&mut best, current);
        let [Some(a), Some(b)] = best else { return };
        let depth = a.depth.min(b.depth);
        self.strongest = self.strongest.max(depth);
        let (a, b) = if a.stations.start < b.stations.start { (a, b) } else { (b, a) };
        self.score[a.stations.end..b.stations.start].iter_mut().for_each(|s| *s += depth);
        for within in [a.stations, b.stations] {
            self.score[within].iter_mut().for_each(|s| *s -= depth);
        }
    }

    /// The stations over which the zone is cut, if it is.
    pub(super) fn seam(&self) -> Option<Range<usize>> {
        let best = (0..self.score.len()).max_by(|&i, &j| self.score[i].total_cmp(&self.score[j]))?;
        let greatest = self.score[best];
        if self.strongest < LEAST_DEPTH || greatest <= 0.0 {
            return None;
        }
        let high = |k: &usize| self.score[*k] >= PLATEAU * greatest;
        let start = (0..=best).rev().take_while(high).last()?;
        let end = (best..self.score.len()).take_while(high).last()? + 1;
        let missing = LEAST_WIDTH.saturating_sub(end - start);
        Some(start.saturating_sub(missing / 2)..end + missing.div_ceil(2))
    }
}

fn keep(best: &mut [Option<Stretch>; 2], found: Option<Stretch>) {
    let Some(found) = found else { return };
    let depth = |s: &Option<Stretch>| s.as_ref().map_or(0.0, |s| s.depth);
    if found.depth > depth(&best[0]) {
        best[1] = best[0].replace(found);
    } else if found.depth > depth(&best[1]) {
        best[1] = Some(found);
    }
}
