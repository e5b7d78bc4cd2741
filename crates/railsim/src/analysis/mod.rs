//! What is done with a case, by its `run.kind`: stepped in time ([`crate::run`]), brought to balance, taken along loads,
//! linearised, or searched for the speed at which it hunts. Each gives one frame.
//!
//! All but time stepping are of the design track: irregularities are refused.

mod air_brake;
pub mod critical_speed;
pub mod modal;
mod naming;
pub mod quasi_static;
mod stand;

pub use modal::{Mode, modes};
pub use stand::Stand;

use crate::error::Result;
use crate::run::channel::{Channel, describe};
use crate::run::{Control, Ended, Outcome, simulate};
use crate::schema::{Case, RunKind};

/// Runs a case of any kind.
///
/// # Errors
/// Bad input, no balance, an interruption; see the kinds.
pub fn run(case: &Case, control: &dyn Control) -> Result<Outcome> {
    match case.run.kind {
        RunKind::Time => simulate(case, control),
        RunKind::Equilibrium | RunKind::QuasiStatic => quasi_static::run(case, control),
        RunKind::Modal => modal::run(case, control),
        RunKind::CriticalSpeed => critical_speed::run(case, control),
        RunKind::AirBrake => air_brake::run(case, control),
        RunKind::Lint => Ok(crate::lint::run(case)),
    }
}

/// The channels that a case gives, in the order of its columns; what is text (the names of modes) is not among them.
///
/// # Errors
/// Whatever compiling the case finds.
pub fn channels(case: &Case) -> Result<Vec<Channel>> {
    let names = match case.run.kind {
        RunKind::Time => return crate::run::channels(case),
        RunKind::Equilibrium | RunKind::QuasiStatic => quasi_static::columns(case)?,
        RunKind::Modal => modal::columns(case)?,
        RunKind::CriticalSpeed => critical_speed::columns(case)?,
        RunKind::AirBrake => air_brake::columns(case),
        RunKind::Lint => crate::lint::columns(),
    };
    Ok(names
        .into_iter()
        .map(|name| {
            let (unit, meaning) = describe(&name).unwrap_or(("1", ""));
            Channel { name, unit, meaning }
        })
        .collect())
}

/// Rows of numbers under names.
#[derive(Debug)]
struct Table {
    names: Vec<String>,
    columns: Vec<Vec<f64>>,
}

impl Table {
    fn new(names: Vec<String>) -> Self {
        let columns = names.iter().map(|_| Vec::new()).collect();
        Self { names, columns }
    }

    /// Takes one row, a value for each name.
    fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        let mut values = row.into_iter();
        for column in &mut self.columns {
            column.push(values.next().unwrap_or(f64::NAN));
        }
        debug_assert!(values.next().is_none(), "more values than columns");
    }

    fn done(
        self,
        labels: Vec<(String, Vec<String>)>,
        ended: Ended,
        statistics: serde_json::Value,
    ) -> Outcome {
        Outcome { columns: self.names.into_iter().zip(self.columns).collect(), labels, ended, statistics }
    }
}
