//! The system's matrix about a state, by central differences.

use nalgebra::DMatrix;

use crate::dynamics::rhs::VehicleSystem;
use crate::integrator::System;

/// Increment of each state (m, rad, m/s, rad/s): far above rounding of contact forces, far below their curvature.
const INCREMENT: f64 = 1e-7;

/// `d(dx/dt)/dx` at `(t, x)`.
#[must_use]
pub fn jacobian(system: &mut VehicleSystem<'_>, t: f64, x: &[f64]) -> DMatrix<f64> {
    let n = system.size();
    let mut at = x.to_vec();
    let (mut up, mut down) = (vec![0.0; n], vec![0.0; n]);
    let mut jacobian = DMatrix::zeros(n, n);
    for j in 0..n {
        at[j] = x[j] + INCREMENT;
        system.rhs(t, &at, &mut up);
        at[j] = x[j] - INCREMENT;
        system.rhs(t, &at, &mut down);
        at[j] = x[j];
        for i in 0..n {
            jacobian[(i, j)] = (up[i] - down[i]) / (2.0 * INCREMENT);
        }
    }
    jacobian
}
