//! Stability where a wheelset on its track mass needs it: 2500 rad/s and soft modes beside it.

#![allow(clippy::unwrap_used, reason = "test helpers")]

use nalgebra::{DMatrix, Matrix2};
use railsim::integrator::{Integrator, ROS2_GAMMA, StepEnd, Stepper, StiffBlock, System};

/// M q'' = -K q - C q' with the last `stiff` coordinates in one stiff block, of which the system reports `known` times
/// its own matrices. State: positions, then rates.
struct Chain {
    k: DMatrix<f64>,
    c: DMatrix<f64>,
    block: [StiffBlock; 1],
    known: f64,
}

impl Chain {
    /// Masses, and for each mass (first: against ground) a spring and a damper to the one before.
    fn new(masses: &[f64], springs: &[(f64, f64)], stiff: usize, known: f64) -> Self {
        let n = masses.len();
        let assemble = |pick: fn(&(f64, f64)) -> f64| {
            let mut m = DMatrix::zeros(n, n);
            for (i, spring) in springs.iter().enumerate() {
                // spring i joins mass i - 1 (or ground) and mass i (or ground)
                let value = pick(spring);
                if i > 0 {
                    m[(i - 1, i - 1)] += value;
                }
                if i < n {
                    m[(i, i)] += value;
                }
                if i > 0 && i < n {
                    m[(i - 1, i)] -= value;
                    m[(i, i - 1)] -= value;
                }
            }
            for i in 0..n {
                for j in 0..n {
                    m[(i, j)] /= masses[i];
                }
            }
            m
        };
        let block = [StiffBlock { pos: n - stiff..n, vel: 2 * n - stiff..2 * n }];
        Self { k: assemble(|s| s.0), c: assemble(|s| s.1), block, known }
    }
}

impl System for Chain {
    fn size(&self) -> usize {
        2 * self.k.nrows()
    }

    fn rhs(&mut self, _: f64, x: &[f64], dx: &mut [f64]) {
        let n = self.k.nrows();
        for i in 0..n {
            dx[i] = x[n + i];
            dx[n + i] = -(0..n).map(|j| self.k[(i, j)] * x[j] + self.c[(i, j)] * x[n + j]).sum::<f64>();
        }
    }

    fn stiff_blocks(&self) -> &[StiffBlock] {
        &self.block
    }

    fn stiff_matrices(&mut self, _: usize, k: &mut [f64], c: &mut [f64]) {
        let (n, stiff) = (self.k.nrows(), self.block[0].pos.len());
        let first = n - stiff;
        for i in 0..stiff {
            for j in 0..stiff {
                k[i * stiff + j] = self.known * self.k[(first + i, first + j)];
                c[i * stiff + j] = self.known * self.c[(first + i, first + j)];
            }
        }
    }
}

/// Largest eigenvalue in size of the matrix that one step of a linear system is.
fn spectral_radius(integrator: &Integrator, system: &mut Chain, h: f64) -> f64 {
    let size = system.size();
    let mut step = DMatrix::zeros(size, size);
    for column in 0..size {
        let mut x = vec![0.0; size];
        x[column] = 1.0;
        let mut stepper = Stepper::new(integrator, size, &system.block);
        assert_eq!(stepper.step(system, 0.0, &mut x, h), StepEnd::Done);
        step.set_column(column, &nalgebra::DVector::from_vec(x));
    }
    step.complex_eigenvalues().iter().map(|z| z.norm()).fold(0.0, f64::max)
}

const HEUN: Integrator = Integrator::Heun { step: 1e-3 };
const ROS2: Integrator = Integrator::Ros2 { step: 1e-3 };

#[test]
fn a_stiff_oscillator_is_stable_with_ros2_and_not_with_heun() {
    let w: f64 = 2500.0;
    let mut system = Chain::new(&[1.0], &[(w * w, 2.0 * 0.7 * w)], 1, 1.0);
    for h in [1e-3, 5e-3] {
        let (heun, ros2) = (spectral_radius(&HEUN, &mut system, h), spectral_radius(&ROS2, &mut system, h));
        println!("2500 rad/s, zeta 0.7, h {h}: heun {heun:.3}, ros2 {ros2:.3}");
        assert!(heun > 1.0 && ros2 < 0.6);
        // And it comes to rest: started away from it, 50 steps of ros2 leave less than a millionth.
        let mut x = [1e-3, 0.0];
        let mut stepper = Stepper::new(&ROS2, 2, &system.block);
        for i in 0..50 {
            assert_eq!(stepper.step(&mut system, f64::from(i) * h, &mut x, h), StepEnd::Done);
        }
        assert!(x[0].abs() < 1e-9, "{x:?}");
    }
    // Where Heun holds, as VALIDATION says: a limit just under 0.5 ms for this kind of mode.
    assert!(spectral_radius(&HEUN, &mut system, 0.4e-3) < 1.0);
}

/// Half a bogie above one wheelset on its track mass, vertical: secondary and primary outside the block, wheelset and
/// track mass with contact and ballast inside (the reference locomotive's values; contact 2 x 1.3e9 N/m, undamped).
fn vertical(known: f64) -> Chain {
    let masses = [14860.0 / 3.0, 2850.0, 600.0];
    let springs = [(1.0e6, 4.0e4), (8.0e6, 8.0e4), (2.6e9, 0.0), (1.5e8, 2.0e5)];
    Chain::new(&masses, &springs, 2, known)
}

#[test]
fn a_wheelset_under_a_bogie_is_stable_with_ros2_to_2_ms() {
    let mut system = vertical(1.0);
    assert!(spectral_radius(&HEUN, &mut system, 1.0e-3) > 1.0);
    for h in [0.25e-3, 0.5e-3, 1e-3, 2e-3] {
        let radius = spectral_radius(&ROS2, &mut system, h);
        println!("wheelset, track and bogie, h {h}: ros2 {radius:.6}");
        assert!(radius < 1.0);
    }
}

#[test]
fn an_overestimated_jacobian_is_stable_and_one_far_too_soft_is_not() {
    for known in [0.9, 1.0, 1.2, 1.5, 2.0, 5.0, 10.0] {
        for h in [0.5e-3, 1e-3, 2e-3] {
            assert!(spectral_radius(&ROS2, &mut vertical(known), h) < 1.0, "{known} {h}");
        }
        for y in [0.01, 0.1, 1.0, 3.0, 10.0, 100.0] {
            for zeta in [0.0, 0.02, 0.7] {
                let mut single = Chain::new(&[1.0], &[(y * y, 2.0 * zeta * y)], 1, known);
                let radius = spectral_radius(&ROS2, &mut single, 1.0);
                assert!(radius < 1.0 + 1e-12, "{known} {y} {zeta}: {radius}");
            }
        }
    }
    let mut soft = Chain::new(&[1.0], &[(1e4, 1.0)], 1, 0.8);
    assert!(spectral_radius(&ROS2, &mut soft, 1.0) > 1.0);
}

/// Damping ratio that a scheme gives an undamped mode of `hz` at step h.
fn damping_ratio(integrator: &Integrator, hz: f64, h: f64) -> f64 {
    let w = std::f64::consts::TAU * hz;
    let mut system = Chain::new(&[1.0], &[(w * w, 0.0)], 1, 1.0);
    -spectral_radius(integrator, &mut system, h).ln() / (w * h)
}

#[test]
fn damping_added_to_a_vehicles_modes_is_the_documented_one() {
    for (hz, in_block, outside) in [(5.0, 1.1e-7, -3.9e-6), (10.0, 9.1e-7, -3.1e-5), (30.0, 2.5e-5, -8.4e-4)]
    {
        let (ros2, heun) = (damping_ratio(&ROS2, hz, 1e-3), damping_ratio(&HEUN, hz, 1e-3));
        println!("{hz} Hz at 1 ms: damping ratio added in a block {ros2:.2e}, outside {heun:.2e}");
        assert!((ros2 / in_block - 1.0).abs() < 0.05 && (heun / outside - 1.0).abs() < 0.05);
    }
}

#[test]
fn stability_function_of_the_exact_jacobian_is_verwers() {
    // R(z) = (1 + (1 - 2 g) z)/(1 - g z)^2 as a function of the matrix of an oscillator.
    let (y, zeta) = (4.0_f64, 0.3);
    let mut system = Chain::new(&[1.0], &[(y * y, 2.0 * zeta * y)], 1, 1.0);
    let z = Matrix2::new(0.0, 1.0, -y * y, -2.0 * zeta * y);
    let one = Matrix2::identity();
    let inverse = (one - ROS2_GAMMA * z).try_inverse().unwrap();
    let expected = (one + (1.0 - 2.0 * ROS2_GAMMA) * z) * inverse * inverse;
    for column in 0..2 {
        let mut x = [0.0, 0.0];
        x[column] = 1.0;
        let mut stepper = Stepper::new(&ROS2, 2, &system.block);
        assert_eq!(stepper.step(&mut system, 0.0, &mut x, 1.0), StepEnd::Done);
        for row in 0..2 {
            assert!((x[row] - expected[(row, column)]).abs() < 1e-13);
        }
    }
}
