//! Mathematics without a rail word in it.

pub mod angle;
pub mod cube_root;
pub mod eigen;
pub mod elementary;
pub mod elliptic;
pub mod fft;
pub mod hermite;
pub mod quadrature;
pub mod rotation;
pub mod small_lu;
pub mod table;
pub mod widest;

/// Column of three.
pub type Vec3 = nalgebra::Vector3<f64>;
/// Three by three.
pub type Mat3 = nalgebra::Matrix3<f64>;

/// Straight lines between points `[x, y]` (x rising), level beyond both ends (NaN lies before the first); 0 without points.
#[must_use]
pub fn interpolate(points: &[[f64; 2]], x: f64) -> f64 {
    let after = points.partition_point(|p| p[0] <= x);
    match (after.checked_sub(1).map(|i| points[i]), points.get(after)) {
        (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some([_, y]), None) => y,
        (None, Some([_, y])) => *y,
        (None, None) => 0.0,
    }
}
