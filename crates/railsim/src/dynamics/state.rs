//! Where everything stands in the state vector.
//!
//! Bodies first, 12 numbers each: `s y z phi theta psi | vx vy vz wx wy wz`. Then wheelsets with the track mass under
//! them, 18 each: `s y z phi theta psi  y_t z_t phi_t | vx vy vz wx wy wz  vy_t vz_t vphi_t`, so that a wheelset and its
//! track are one contiguous block of positions and one of speeds: the block that an implicit scheme treats. Last what
//! connections remember, in the order of the links.

use std::ops::Range;

/// Numbers of a body's state.
pub const BODY: usize = 12;
/// Numbers of the state of a wheelset and its track mass.
pub const WHEELSET: usize = 18;
/// Half of that: positions, or speeds.
pub const PAIR: usize = 9;

/// Layout of the state vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StateMap {
    /// Number of bodies that are no wheelsets.
    pub bodies: usize,
    /// Number of wheelsets.
    pub wheelsets: usize,
    /// Numbers that connections remember.
    pub memory: usize,
}

impl StateMap {
    /// Length of the state vector.
    #[must_use]
    pub fn size(&self) -> usize {
        self.bodies * BODY + self.wheelsets * WHEELSET + self.memory
    }

    /// What all connections remember.
    #[must_use]
    pub fn memory(&self) -> Range<usize> {
        self.size() - self.memory..self.size()
    }

    /// First number of body `i` (bodies, then wheelsets).
    #[must_use]
    pub fn start(&self, i: usize) -> usize {
        if i < self.bodies { i * BODY } else { self.bodies * BODY + (i - self.bodies) * WHEELSET }
    }

    /// Six coordinates of body or wheelset `i`.
    #[must_use]
    pub fn q(&self, i: usize) -> Range<usize> {
        let start = self.start(i);
        start..start + 6
    }

    /// Six speeds of body or wheelset `i`.
    #[must_use]
    pub fn u(&self, i: usize) -> Range<usize> {
        let start = self.start(i) + if i < self.bodies { 6 } else { PAIR };
        start..start + 6
    }

    /// The body or wheelset (with the track mass under it) that number `element` of the state belongs to; none for what
    /// connections remember.
    #[must_use]
    pub fn owner(&self, element: usize) -> Option<usize> {
        let bodies = self.bodies * BODY;
        let owner =
            if element < bodies { element / BODY } else { self.bodies + (element - bodies) / WHEELSET };
        (owner < self.bodies + self.wheelsets).then_some(owner)
    }

    /// Three coordinates of the track mass under wheelset `w`.
    #[must_use]
    pub fn track_q(&self, w: usize) -> Range<usize> {
        let start = self.start(self.bodies + w) + 6;
        start..start + 3
    }

    /// Three speeds of the track mass under wheelset `w`.
    #[must_use]
    pub fn track_u(&self, w: usize) -> Range<usize> {
        let start = self.start(self.bodies + w) + PAIR + 6;
        start..start + 3
    }
}

impl StateMap {
    /// The numbers of each body and of each wheelset with its track mass.
    #[inline(always)]
    #[must_use]
    pub fn parts<'x>(&self, x: &'x [f64]) -> (&'x [[f64; BODY]], &'x [[f64; WHEELSET]]) {
        let (bodies, rest) = x.split_at(self.bodies * BODY);
        (bodies.as_chunks().0, rest[..self.wheelsets * WHEELSET].as_chunks().0)
    }

    /// The same, to be written.
    #[inline(always)]
    pub fn parts_mut<'x>(&self, x: &'x mut [f64]) -> (&'x mut [[f64; BODY]], &'x mut [[f64; WHEELSET]]) {
        let (bodies, rest) = x.split_at_mut(self.bodies * BODY);
        (bodies.as_chunks_mut().0, rest[..self.wheelsets * WHEELSET].as_chunks_mut().0)
    }
}

/// `N` numbers from `at` on, as an array: where both are known when compiled, nothing is left to check in a run.
///
/// # Panics
/// Where there are not so many.
#[inline(always)]
#[must_use]
pub fn array<const N: usize>(x: &[f64], at: usize) -> &[f64; N] {
    let Some(array) = x[at..].first_chunk() else { panic!("{N} numbers from {at} on, of {}", x.len()) };
    array
}

/// The same, to be written.
///
/// # Panics
/// Where there are not so many.
#[inline(always)]
pub fn array_mut<const N: usize>(x: &mut [f64], at: usize) -> &mut [f64; N] {
    let count = x.len();
    let Some(array) = x[at..].first_chunk_mut() else { panic!("{N} numbers from {at} on, of {count}") };
    array
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_of_the_state_has_exactly_one_owner() {
        let map = StateMap { bodies: 3, wheelsets: 6, memory: 4 };
        let mut owners = vec![0; map.size()];
        let mut own = |r: Range<usize>| r.for_each(|i| owners[i] += 1);
        for i in 0..9 {
            own(map.q(i));
            own(map.u(i));
        }
        for w in 0..6 {
            own(map.track_q(w));
            own(map.track_u(w));
        }
        own(map.memory());
        assert!(owners.iter().all(|n| *n == 1));
        for i in 0..9 {
            assert!(map.q(i).chain(map.u(i)).all(|element| map.owner(element) == Some(i)));
        }
        for w in 0..6 {
            assert!(map.track_q(w).chain(map.track_u(w)).all(|element| map.owner(element) == Some(3 + w)));
        }
        assert!(map.memory().all(|element| map.owner(element).is_none()));
    }

    #[test]
    fn parts_are_what_the_ranges_say() {
        let map = StateMap { bodies: 3, wheelsets: 2, memory: 4 };
        let mut x: Vec<f64> = (0..map.size()).map(|i| i as f64).collect();
        let (bodies, sets) = map.parts(&x);
        assert_eq!((bodies.len(), sets.len()), (3, 2));
        for (i, body) in bodies.iter().enumerate() {
            assert_eq!(array::<6>(body, 0), &x[map.q(i)]);
            assert_eq!(array::<6>(body, 6), &x[map.u(i)]);
        }
        for (w, set) in sets.iter().enumerate() {
            assert_eq!(array::<6>(set, 0), &x[map.q(3 + w)]);
            assert_eq!(array::<3>(set, 6), &x[map.track_q(w)]);
            assert_eq!(array::<6>(set, PAIR), &x[map.u(3 + w)]);
            assert_eq!(array::<3>(set, PAIR + 6), &x[map.track_u(w)]);
        }
        array_mut::<3>(&mut map.parts_mut(&mut x).1[1], 6)[0] = -1.0;
        assert_eq!(x[map.track_q(1)][0], -1.0);
    }
}
