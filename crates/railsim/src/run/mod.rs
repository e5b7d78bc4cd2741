//! A case run in time: stepping, recording, and seeing when a run has left what the model describes.

pub mod channel;
pub mod divergence;
pub mod law;
pub mod recorder;
pub mod stability;
pub mod time_stepping;

pub use channel::{Channel, channels};
pub use law::{Law, Output, Outside};
pub use time_stepping::{Control, Ended, Free, Outcome, simulate, simulate_controlled};
