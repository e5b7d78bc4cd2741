//! Geometry tables that cases have in common.
//!
//! A table takes longer to build than a short run. Whoever runs many cases gives them one [`Tables`]; a table is a function of
//! its key alone, so that results do not depend on who built it. Nothing is shared between cases that are not given one.

use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{GeometryTable, Placement};
use crate::error::Result;

/// Tables kept at a time, some 3 MB each; the one that was asked for least recently goes first.
pub const MOST: usize = 16;

/// What a table is built from.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// Points of the wheel profile as written, m.
    pub wheel: Vec<[f64; 2]>,
    /// Points of the rail profile as written, m.
    pub rail: Vec<[f64; 2]>,
    /// How they are placed.
    pub placement: Placement,
    /// Normal interpenetration of its averages, m.
    pub penetration: f64,
}

/// The place of one table; whoever is first builds it while others wait for it.
type Slot = Arc<Mutex<Option<Arc<GeometryTable>>>>;

/// Tables by pair; clones share them.
#[derive(Clone, Default)]
pub struct Tables(Arc<Mutex<Vec<(Pair, Slot)>>>);

impl Tables {
    /// The table of a pair, built by `build` where nobody has asked for it yet.
    ///
    /// # Errors
    /// Those of `build`, for everybody who asks.
    pub fn get(
        &self,
        pair: Pair,
        build: impl FnOnce() -> Result<GeometryTable>,
    ) -> Result<Arc<GeometryTable>> {
        let slot = self.slot(pair);
        let mut found = lock(&slot);
        if let Some(table) = &*found {
            return Ok(table.clone());
        }
        let table = Arc::new(build()?);
        *found = Some(table.clone());
        Ok(table)
    }

    fn slot(&self, pair: Pair) -> Slot {
        let mut slots = lock(&self.0);
        let (pair, slot) = match slots.iter().position(|(known, _)| *known == pair) {
            Some(i) => slots.remove(i),
            None => (pair, Slot::default()),
        };
        if slots.len() >= MOST {
            slots.remove(0);
        }
        slots.push((pair, slot.clone()));
        slot
    }
}

/// A holder that panicked has left either nothing or a whole table.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl fmt::Debug for Tables {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Tables({})", lock(&self.0).len())
    }
}

/// What is kept says nothing about a case.
impl PartialEq for Tables {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
