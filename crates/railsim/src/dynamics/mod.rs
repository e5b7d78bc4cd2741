//! From a compiled [`Model`] to accelerations.
//!
//! [`Model`] is immutable and shared between threads; the state is a plain slice laid out by [`StateMap`];
//! [`Scratch`] may be thrown away at any step without changing a result. [`VehicleSystem`] is what an integrator sees.

mod axle;
pub mod compile;
pub mod coordinate;
pub mod energy;
pub mod equilibrium;
mod joints;
pub mod linearise;
pub mod model;
pub mod preload;
pub mod rhs;
pub mod scratch;
pub mod state;
pub mod stiff;

pub use model::{Contact, Gap, Link, Model, Sensor, SpeedHold, Support};
pub use rhs::{SpeedProgram, VehicleSystem};
pub use scratch::Scratch;
pub use state::StateMap;
