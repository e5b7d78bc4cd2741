//! Six directions with full stiffness and damping matrices: coupled rubber springs, air springs about a point, measured
//! suspensions.
//!
//! With `q_A = (d_A, t)` and `q_B = (d_B, t)`, where `d` is the vector between the ends in either body's axes (as for the
//! bushing) and `t` the antisymmetric part of the relative rotation, whose components are the same in both,
//!
//! ```text
//! U = 1/2 [ 1/2 q_A' K q_A + 1/2 q_B' K q_B ] - 1/2 P' (d_A + d_B),
//! ```
//!
//! and damping acts on the rates of `q_A` and `q_B` in the same way. Forces follow by virtual work, exactly, also for large
//! angles: `dt/dt = J w` with `J = (tr(R) 1 - R)/2`.

use nalgebra::{Matrix6, SymmetricEigen, Vector6};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{ForceLaw, Mount, Relative, Wrench, carry, coincident};
use crate::error::{Fault, KeyPath};
use crate::math::{Mat3, Vec3};

/// Full matrices about one point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BushingMatrix {
    /// Rows of the symmetric stiffness: forces x, y, z (N) and moments x, y, z (N m) per displacement x, y, z (m) and
    /// rotation x, y, z (rad).
    pub stiffness: Box<[[f64; 6]; 6]>,
    /// Rows of the symmetric damping, in the same order, per m/s and rad/s; none if left out.
    #[serde(default)]
    pub damping: Box<[[f64; 6]; 6]>,
}

/// Stretch of a coupled element in either body's axes, and rates.
pub(super) struct Coupled {
    d_A: Vec3,
    q: [Vector6<f64>; 2],
    rate: [Vector6<f64>; 2],
    jacobian: Mat3,
}

fn join(d: &Vec3, t: &Vec3) -> Vector6<f64> {
    Vector6::new(d.x, d.y, d.z, t.x, t.y, t.z)
}

/// Antisymmetric part of a rotation as a vector, and the matrix that turns angular velocity into its rate.
#[inline]
pub(super) fn turned(R: &Mat3) -> (Vec3, Mat3) {
    let t = 0.5 * Vec3::new(R[(2, 1)] - R[(1, 2)], R[(0, 2)] - R[(2, 0)], R[(1, 0)] - R[(0, 1)]);
    (t, 0.5 * (R.trace() * Mat3::identity() - R))
}

impl Coupled {
    #[inline]
    pub fn of(motion: &Relative, p_A: &Vec3, p_B: &Vec3) -> Self {
        let q_B = motion.R_AB * p_B;
        let d_A = motion.r_AB + q_B - p_A;
        let rate_A = motion.v_AB + motion.w_AB.cross(&q_B);
        let d_B = motion.R_AB.tr_mul(&d_A);
        let rate_B = motion.R_AB.tr_mul(&(rate_A - motion.w_AB.cross(&d_A)));
        let (t, jacobian) = turned(&motion.R_AB);
        let t_dot = jacobian * motion.w_AB;
        Self {
            d_A,
            q: [join(&d_A, &t), join(&d_B, &t)],
            rate: [join(&rate_A, &t_dot), join(&rate_B, &t_dot)],
            jacobian,
        }
    }

    /// Wrench of generalised forces `resist(q, dq/dt)` and a preload.
    #[inline]
    pub fn wrench(
        &self,
        R_AB: &Mat3,
        p_A: &Vec3,
        preload: &Vec3,
        resist: impl Fn(&Vector6<f64>, &Vector6<f64>) -> Vector6<f64>,
    ) -> Wrench {
        let [in_A, in_B] = [0, 1].map(|i| resist(&self.q[i], &self.rate[i]));
        let half = |g: &Vector6<f64>| 0.5 * (preload - g.fixed_rows::<3>(0));
        let f_A = half(&in_A); // written in A's axes, acts at B's point
        let f = f_A + R_AB * half(&in_B); // the other half acts at A's point
        let t: Vec3 = 0.5 * (in_A.fixed_rows::<3>(3) + in_B.fixed_rows::<3>(3));
        Wrench { f, m: p_A.cross(&f) + self.d_A.cross(&f_A) - self.jacobian.tr_mul(&t) }
    }

    /// Energy of `1/2 q' K q` in both axes, and of the preload.
    pub fn energy(&self, preload: &Vec3, stiff: impl Fn(&Vector6<f64>) -> Vector6<f64>) -> f64 {
        let half = |q: &Vector6<f64>| 0.5 * (0.5 * q.dot(&stiff(q)) - preload.dot(&q.fixed_rows::<3>(0)));
        half(&self.q[0]) + half(&self.q[1])
    }

    /// Power of damping forces.
    pub fn dissipation(&self, damp: impl Fn(&Vector6<f64>) -> Vector6<f64>) -> f64 {
        0.5 * self.rate.iter().map(|r| r.dot(&damp(r))).sum::<f64>()
    }
}

impl BushingMatrix {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let mut stiffness = [[0.0; 6]; 6];
        for (i, k) in [2e5, 3e5, 5e5, 1e4, 2e4, 3e4].into_iter().enumerate() {
            stiffness[i][i] = k;
        }
        for (i, j, k) in [(0, 4, 3e4), (1, 3, -2e4), (0, 1, 5e4), (2, 5, 1e4)] {
            stiffness[i][j] = k;
            stiffness[j][i] = k;
        }
        let mut damping = [[0.0; 6]; 6];
        damping[1][1] = 4e3;
        damping[3][3] = 1e3;
        damping[1][3] = 5e2;
        damping[3][1] = 5e2;
        vec![Self { stiffness: Box::new(stiffness), damping: Box::new(damping) }]
    }

    /// The one on the other side: what couples a lateral with a vertical direction changes its sign.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        const SIDE: [f64; 6] = [1.0, -1.0, 1.0, -1.0, 1.0, -1.0];
        let mirror = |m: &[[f64; 6]; 6]| {
            Box::new(std::array::from_fn(|i| std::array::from_fn(|j| SIDE[i] * m[i][j] * SIDE[j])))
        };
        Self { stiffness: mirror(&self.stiffness), damping: mirror(&self.damping) }
    }
}

#[inline]
fn times(m: &[[f64; 6]; 6], q: &Vector6<f64>) -> Vector6<f64> {
    Vector6::from_fn(|i, _| m[i].iter().zip(q.iter()).map(|(m, q)| m * q).sum())
}

impl ForceLaw for BushingMatrix {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> Wrench {
        Coupled::of(motion, &mount.p_A, &mount.p_B).wrench(
            &motion.R_AB,
            &mount.p_A,
            &mount.preload,
            |q, rate| times(&self.stiffness, q) + times(&self.damping, rate),
        )
    }

    fn energy(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        Coupled::of(motion, &mount.p_A, &mount.p_B).energy(&mount.preload, |q| times(&self.stiffness, q))
    }

    fn dissipation(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        Coupled::of(motion, &mount.p_A, &mount.p_B).dissipation(|rate| times(&self.damping, rate))
    }

    fn nominal_stiffness(&self, _between: &Vec3) -> Mat3 {
        Mat3::from_fn(|i, j| self.stiffness[i][j])
    }

    fn settle(&self, mount: &mut Mount, force: Option<&Vec3>) -> Result<(), String> {
        carry(mount, force);
        Ok(())
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        coincident(between, "bushing_matrix")
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (key, rows) in [("stiffness", &self.stiffness), ("damping", &self.damping)] {
            let at = at.key(key);
            let matrix = Matrix6::from_fn(|i, j| rows[i][j]);
            let size = matrix.amax();
            if let Some(i) = rows.iter().position(|row| row.iter().any(|v| !v.is_finite())) {
                faults.push(Fault::new(at.index(i), "a number that is not finite", "six finite numbers"));
            } else if let Some((i, j)) = (0..36)
                .map(|n| (n / 6, n % 6))
                .find(|(i, j)| (rows[*i][*j] - rows[*j][*i]).abs() > 1e-9 * size)
            {
                let found = format!("{} across from {}", rows[i][j], rows[j][i]);
                faults.push(Fault::new(at.index(i).index(j), found, "a symmetric matrix: it has an energy"));
            } else if size > 0.0 && SymmetricEigen::new(matrix).eigenvalues.min() < -1e-9 * size {
                let least = SymmetricEigen::new(matrix).eigenvalues.min();
                let found = format!("a matrix with the eigenvalue {least:.3e}");
                faults.push(Fault::new(at, found, "none below 0: it would give energy away"));
            }
        }
        faults
    }
}
