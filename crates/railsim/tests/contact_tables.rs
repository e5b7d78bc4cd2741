//! Contact tables that cases share: built once, the same results.
#![allow(clippy::unwrap_used)]

mod common;

use std::cell::Cell;
use std::sync::Arc;

use common::contact::PLACEMENT;
use railsim::contact::geometry_table::store::MOST;
use railsim::contact::geometry_table::{GeometryTable, Pair, Placement, Tables};
use railsim::dynamics::compile::geometry_table;
use railsim::error::{Error, Fault};
use railsim::run::{Free, simulate};
use railsim::{KeyPath, Result};
use serde_json::json;

fn pair(gauge: f64) -> Pair {
    Pair {
        wheel: vec![[0.0, 0.0]],
        rail: vec![[0.0, 0.0]],
        placement: Placement { gauge, ..PLACEMENT },
        penetration: 30e-6,
    }
}

fn table() -> GeometryTable {
    let case = common::case(&common::coco134());
    Arc::try_unwrap(geometry_table(&case).unwrap()).unwrap_or_else(|shared| (*shared).clone())
}

#[test]
fn a_table_is_built_once_and_clones_share_it() {
    let (tables, table, built) = (Tables::default(), table(), Cell::new(0));
    let build = || {
        built.set(built.get() + 1);
        Ok(table.clone())
    };
    let first = tables.get(pair(1.435), build).unwrap();
    let again = tables.clone().get(pair(1.435), build).unwrap();
    assert!(Arc::ptr_eq(&first, &again));
    tables.get(pair(1.436), build).unwrap();
    assert_eq!(built.get(), 2);
}

#[test]
fn the_table_asked_for_least_recently_goes_first_and_faults_are_not_kept() {
    let (tables, table) = (Tables::default(), table());
    let kept = |_: &str| -> Result<GeometryTable> { panic!("it is there") };
    for i in 0..MOST {
        tables.get(pair(1.0 + i as f64), || Ok(table.clone())).unwrap();
    }
    tables.get(pair(1.0), || kept("asked for again")).unwrap();
    tables.get(pair(100.0), || Ok(table.clone())).unwrap();
    tables.get(pair(1.0), || kept("not the oldest")).unwrap();
    let fault = || Err(Error::input(Fault::new(KeyPath::of("track.gauge"), "none", "one")));
    assert!(tables.get(pair(2.0), fault).is_err());
    tables.get(pair(2.0), || Ok(table.clone())).unwrap();
}

#[test]
fn cases_with_the_same_pair_share_a_table_and_give_what_they_give_alone() {
    let mut value = common::coco134();
    value["track"]["length"] = json!(30.0);
    let alone = simulate(&common::case(&value), &Free).unwrap();
    let tables = Tables::default();
    let mut first = common::case(&value);
    first.tables = tables.clone();
    value["run"]["speed"] = json!(20.0);
    let mut second = common::case(&value);
    second.tables = tables.clone();
    assert!(Arc::ptr_eq(&geometry_table(&second).unwrap(), &geometry_table(&first).unwrap()));
    let shared = simulate(&first, &Free).unwrap();
    for ((name, ours), (_, theirs)) in shared.columns.iter().zip(&alone.columns) {
        assert!(ours.iter().zip(theirs).all(|(a, b)| a.to_bits() == b.to_bits()), "{name}");
    }
    // another gauge, another table
    value["track"]["gauge"] = json!(1.437);
    let mut wide = common::case(&value);
    wide.tables = tables;
    assert!(!Arc::ptr_eq(&geometry_table(&wide).unwrap(), &geometry_table(&first).unwrap()));
}
