//! Railway vehicle dynamics.
//!
//! Axes are right-handed: x forward, y right, z down. Roll phi about x, pitch theta about y, yaw psi
//! about z. SI units everywhere. Curvature is positive to the right.
//!
//! Frame letters (monogram notation): `I` inertial, `T` track-following frame, `B` body, `A` axle (the
//! wheelset without its spin), `C` contact, `R` rail. `R_TB` turns components in B into components in T,
//! `p_TB` is the position of B's origin from T's, `v_TB` its velocity. Neighbouring letters cancel:
//! `p_TC = p_TB + R_TB * p_BC`.
//!
//! The way of a run: [`schema`] (what was written) is compiled into a [`dynamics::Model`] (immutable,
//! shared between threads), whose state is stepped by an [`integrator`] and recorded by [`run`].

#![warn(clippy::unwrap_used)] // never on what a user wrote; tests may

pub mod analysis;
pub mod body;
pub mod connection;
pub mod contact;
pub mod dynamics;
pub mod equipment;
pub mod error;
pub mod integrator;
pub mod lint;
pub mod math;
pub mod run;
pub mod schema;
pub mod track;

pub use error::{Error, Fault, KeyPath, Result};
