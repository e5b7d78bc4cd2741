//! Verwer's two-stage W-method `ros2`.
//!
//! J. G. Verwer, E. J. Spee, J. G. Blom, W. Hundsdorfer, "A second-order Rosenbrock method applied to photochemical
//! dispersion problems", SIAM Journal on Scientific Computing 20 (1999) 1456-1480, equation (1.4):
//!
//! ```text
//! (I - g h A) k1 = f(t, x)
//! (I - g h A) k2 = f(t + h, x + h k1) - 2 k1
//! x <- x + 3/2 h k1 + 1/2 h k2
//! ```
//!
//! Of order two for *any* matrix A; with A = 0 it is Heun's scheme. Here A is zero but for the stiff blocks, where
//! it is [[0, I], [-K, -C]] over (pos, vel). Eliminating the positions leaves one n by n system per block:
//!
//! ```text
//! (I + g h C + g^2 h^2 K) k_v = r_v - g h K r_p,      k_p = r_p + g h k_v
//! ```

use super::{Statistics, StepEnd, StiffBlock, System, first_slope};
use crate::math::small_lu::SmallLu;

/// g = 1 - 1/sqrt(2) = 0.2929.
///
/// With A the exact Jacobian the stability function is R(z) = (1 + (1 - 2g) z)/(1 - g z)^2 for both roots
/// g = 1 -+ 1/sqrt(2) of g^2 - 2g + 1/2 = 0: A-stable and zero at infinity. On the imaginary axis
/// |R(iy)|^2 = 1 - g^4 y^4/(1 + g^2 y^2)^2 (y = angular frequency times step), so that a mode inside the blocks gains
/// the damping ratio g^4 y^3/2. At a step of 1 ms:
///
/// | mode | g = 0.2929 | g = 1.7071 | outside the blocks (Heun) |
/// |---|---|---|---|
/// | 5 Hz | +1.1e-7 | +1.3e-4 | -3.9e-6 |
/// | 10 Hz | +9.1e-7 | +1.1e-3 | -3.1e-5 |
/// | 30 Hz | +2.5e-5 | +2.8e-2 | -8.4e-4 |
///
/// The leading error of one step is +0.040 z^3 for the small root, -1.37 z^3 for the large one (Heun: -1/6). Verwer
/// recommends the large root for its positivity in chemistry; a vehicle's modes of 5 to 30 Hz, which decide the
/// judged accelerations, want the small one.
///
/// What the large root would buy is tolerance of a wrong A. For an infinitely stiff mode of which A holds the
/// fraction a, R = 1 - 2/(g a) + 1/(2 g^2 a^2), at most one in size for g a >= 1/4: a >= 0.854 here, 0.146 there.
/// An A that is too stiff is always stable (a = 1 to 10 checked in `tests/integrator_stability.rs`): in doubt
/// overestimate, e.g. take creep coefficients without saturation.
pub const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// The scheme's working memory.
#[derive(Debug, Clone)]
pub struct Ros2 {
    blocks: Vec<Block>,
    k1: Vec<f64>,
    k2: Vec<f64>,
    argument: Vec<f64>,
}

/// One stiff block with its factorised matrix.
#[derive(Debug, Clone)]
struct Block {
    at: StiffBlock,
    stiffness: Vec<f64>,
    damping: Vec<f64>,
    lu: SmallLu,
    rate: Vec<f64>,
}

impl Ros2 {
    pub fn new(size: usize, blocks: &[StiffBlock]) -> Self {
        let blocks = blocks.iter().map(Block::new).collect();
        Self { blocks, k1: vec![0.0; size], k2: vec![0.0; size], argument: vec![0.0; size] }
    }

    pub fn step<S: System>(
        &mut self,
        system: &mut S,
        t: f64,
        x: &mut [f64],
        h: f64,
        slope: Option<&[f64]>,
        statistics: &mut Statistics,
    ) -> StepEnd {
        let Self { blocks, k1, k2, argument } = self;
        let gh = GAMMA * h;
        first_slope(system, t, x, slope, k1, statistics);
        for (index, block) in blocks.iter_mut().enumerate() {
            system.stiff_matrices(index, &mut block.stiffness, &mut block.damping);
            statistics.factorisations += 1;
            if !block.factorise(gh) {
                return StepEnd::Singular { block: index };
            }
            block.solve(gh, k1);
        }
        for ((a, x), k) in argument.iter_mut().zip(&*x).zip(&*k1) {
            *a = x + h * k;
        }
        system.rhs(t + h, argument, k2);
        statistics.rhs_evaluations += 1;
        for (k2, k1) in k2.iter_mut().zip(&*k1) {
            *k2 -= 2.0 * k1;
        }
        for block in blocks {
            block.solve(gh, k2);
        }
        for ((x, k1), k2) in x.iter_mut().zip(&*k1).zip(&*k2) {
            *x += h * (1.5 * k1 + 0.5 * k2);
        }
        statistics.steps += 1;
        StepEnd::Done
    }
}

impl Block {
    fn new(at: &StiffBlock) -> Self {
        let n = at.pos.len();
        debug_assert_eq!(n, at.vel.len());
        Self {
            at: at.clone(),
            stiffness: vec![0.0; n * n],
            damping: vec![0.0; n * n],
            lu: SmallLu::new(n),
            rate: vec![0.0; n],
        }
    }

    /// Factorises I + gh C + gh^2 K; false where that is singular.
    fn factorise(&mut self, gh: f64) -> bool {
        let n = self.rate.len();
        let matrix = self.lu.matrix_mut();
        for ((m, k), c) in matrix.iter_mut().zip(&self.stiffness).zip(&self.damping) {
            *m = gh * (c + gh * k);
        }
        for i in 0..n {
            matrix[i * n + i] += 1.0;
        }
        self.lu.factorise().is_ok()
    }

    /// Solves (I - gh A) k = r in this block; `k` holds r on entry.
    fn solve(&mut self, gh: f64, k: &mut [f64]) {
        let n = self.rate.len();
        for i in 0..n {
            let row = &self.stiffness[i * n..(i + 1) * n];
            let force: f64 = row.iter().zip(&k[self.at.pos.clone()]).map(|(k, r)| k * r).sum();
            self.rate[i] = k[self.at.vel.start + i] - gh * force;
        }
        self.lu.solve(&mut self.rate);
        for i in 0..n {
            k[self.at.pos.start + i] += gh * self.rate[i];
            k[self.at.vel.start + i] = self.rate[i];
        }
    }
}
