//! Wheel/rail contact: profiles, geometry tables, Hertz patches, creep forces.
//!
//! Everything here works in *side coordinates*: x forward, y outward from the track centre, z down, so that left and right
//! are the same code. The gauge corner of the rail and the flange of the wheel lie at negative y. Contact angle gamma is
//! positive where the wheel surface falls towards the flange: dz/dy = -tan(gamma).
//!
//! The way of a contact: [`profile`] (points, smoothed) -> [`geometry_table`] (built once per pair, looked up per step) ->
//! [`hertz`] and [`kalker_table`] (stored in the table) -> [`creep`] (forces from patch and creepage).

pub mod conicity;
pub mod creep;
pub mod creepage;
pub mod friction;
pub mod geometry_table;
pub mod hertz;
pub mod kalker_table;
pub mod non_elliptic;
pub mod normal;
pub mod pair;
pub mod profile;
pub mod search;
pub mod textbook;
