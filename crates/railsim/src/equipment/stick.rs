//! At rest wheels stick. Below [`STEADY`] the creepage that the creep law is asked for is the tangential deflection of the contact
//! over its half-length a (each zone of a wheel's contacts has its own, so that one keeps it when another comes or goes), which follows the sliding velocity w by `dz/dt = w - max(V, |w|) z/a`: rolling, that is the steady creepage w/V
//! after rolling some a; at rest it is a spring with the slope of the creep law, so that a wheel stands on a gradient
//! without creeping, and slides beyond the friction limit. In the state stands z less the way that the coordinates of axle and track
//! say, so that the spring is one between positions, which the implicit scheme knows (transient rolling contact to first order: Knothe and Gross-Thebing, Vehicle
//! System Dynamics 15 (1986) 173; the relaxation length of tyre models).

use super::Acting;
use crate::body::coordinate;
use crate::contact::geometry_table::MAX_CONTACTS;
use crate::dynamics::{Model, Scratch, StateMap};

/// From this rolling speed on (m/s) creepage is the steady one; below half of it the contact's deflection.
pub const STEADY: f64 = 4.0;
/// Fastest return of a contact's deflection, 1/s: explicit schemes follow it at any step here.
const FASTEST_RETURN: f64 = 400.0;
/// Numbers of state of a wheelset: two for every contact that either wheel can have.
pub(super) const MEMORY: usize = 2 * WHEEL;
/// The same of a wheel.
const WHEEL: usize = 2 * MAX_CONTACTS;
/// Damping of a contact's deflection over its stiffness, s: what rings at rest dies away. Rolling, it has no effect.
pub const CONTACT_DAMPING: f64 = 5e-4;

impl Acting<'_> {
    /// Rolling speed of every wheelset, for [`Self::creepage`].
    pub(crate) fn rolls(&mut self, scratch: &Scratch, bodies: usize) {
        for (w, rolling) in self.rolling.iter_mut().enumerate() {
            *rolling = scratch.kinematics[bodies + w].v_T.x.abs();
        }
    }

    /// Share of the contact's deflection in what the creep law is asked, by the rolling speed of wheelset `w`.
    #[must_use]
    pub fn sticking(&self, w: usize) -> f64 {
        1.0 - ((2.0 * self.rolling[w] - STEADY) / STEADY).clamp(0.0, 1.0)
    }

    /// Way (m) that a wheel's tread has gone over its rail, forward and outward, as the coordinates of axle and track (or their
    /// rates) say it: what is left out, and turns on the rail, makes the rate of the contact's memory.
    fn way(&self, model: &Model, map: StateMap, w: usize, side: usize, x: &[f64], rates: bool) -> [f64; 2] {
        let set = &model.wheelsets[w];
        let sigma = if side == 0 { -1.0 } else { 1.0 };
        let at = map.bodies + w;
        let (q, track) =
            if rates { (&x[map.u(at)], &x[map.track_u(w)]) } else { (&x[map.q(at)], &x[map.track_q(w)]) };
        [
            q[coordinate::S] + set.radius * q[coordinate::THETA]
                - sigma * set.tape_half_distance * q[coordinate::PSI],
            sigma * (q[coordinate::Y] - set.radius * q[coordinate::PHI] - track[0]),
        ]
    }

    /// Creepage (longitudinal, lateral) of the contact in zone `n` of a wheel that slides with `slip` (m/s) on a patch of half-length `a`,
    /// given the steady one; without a contact (`None`) the deflection is let go. Keeps the rate of the contact's memory.
    pub(crate) fn creepage(
        &mut self,
        model: &Model,
        map: StateMap,
        (w, side, n): (usize, usize, usize),
        contact: Option<([f64; 2], [f64; 2], f64)>,
        x: &[f64],
    ) -> [f64; 2] {
        let memory = MEMORY * w + WHEEL * side + 2 * n;
        let at = self.first + memory;
        let (way, rate) = (self.way(model, map, w, side, x, false), self.way(model, map, w, side, x, true));
        let share = self.sticking(w);
        let mut given = [0.0; 2];
        for d in 0..2 {
            let z = x[at + d] + way[d];
            let turning = match contact {
                Some((slip, steady, a)) => {
                    let back = (self.rolling[w].max(slip[0].hypot(slip[1])) / a).min(FASTEST_RETURN);
                    let turning = slip[d] - back * z;
                    given[d] = (1.0 - share) * steady[d] + share * (z + CONTACT_DAMPING * turning) / a;
                    turning
                }
                None => -FASTEST_RETURN * z,
            };
            self.returns[memory + d] = turning - rate[d];
        }
        given
    }

    /// Lets every contact begin without deflection in the state `x`.
    pub fn release(&self, model: &Model, x: &mut [f64]) {
        let map = model.map();
        for (w, side) in (0..self.wheelsets).flat_map(|w| [(w, 0), (w, 1)]) {
            let way = self.way(model, map, w, side, x, false);
            let at = self.first + MEMORY * w + WHEEL * side;
            for contact in x[at..at + WHEEL].chunks_exact_mut(2) {
                contact.copy_from_slice(&way.map(|d| -d));
            }
        }
    }
}
