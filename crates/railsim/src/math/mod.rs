//! Mathematics without a rail word in it.

pub mod elliptic;
pub mod rotation;

/// Column of three.
pub type Vec3 = nalgebra::Vector3<f64>;
/// Three by three.
pub type Mat3 = nalgebra::Matrix3<f64>;
