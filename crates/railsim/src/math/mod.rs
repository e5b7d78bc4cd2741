//! Mathematics without a rail word in it.

pub mod angle;
pub mod arctan;
pub mod cube_root;
pub mod eigen;
pub mod elliptic;
pub mod fft;
pub mod hermite;
pub mod quadrature;
pub mod rotation;
pub mod small_lu;
pub mod table;

/// Column of three.
pub type Vec3 = nalgebra::Vector3<f64>;
/// Three by three.
pub type Mat3 = nalgebra::Matrix3<f64>;
