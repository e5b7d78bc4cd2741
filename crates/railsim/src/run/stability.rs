//! Will this scheme at this step stay bounded? Asked before the first step, of the linearised vehicle.
//!
//! One step of a scheme on the linear system `dx/dt = J x` is `x <- R x`. A step is refused when the spectral radius of R
//! is above both 1 and what the vehicle's own fastest growing mode does in one step: contact forces cannot grow
//! without bound (wheels lift), so a scheme past its limit would chatter for ever and look like rough track.
//!
//! The check is of the start: wheels on their treads under static load. Two or three times that load stiffens a contact by
//! 26 to 44 % (its stiffness grows with the cube root), so a step near its limit may still be lost on the way.

use nalgebra::DMatrix;

use crate::connection::ForceLaw;
use crate::dynamics::linearise::jacobian;
use crate::dynamics::state::PAIR;
use crate::dynamics::{Link, Model, VehicleSystem};
use crate::error::{Error, Fault, KeyPath, Result};
use crate::integrator::{Integrator, ROS2_GAMMA, System};

/// Growth per step (beyond the vehicle's own) that counts as unstable: it doubles an error in 700 steps.
const TOLERATED_GROWTH: f64 = 1e-3;

/// What the check found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stability {
    /// Largest magnitude of an eigenvalue, rad/s.
    pub largest_eigenvalue: f64,
    /// Largest real part, 1/s: positive where the vehicle itself is unstable.
    pub fastest_growth: f64,
    /// Spectral radius of one step.
    pub radius: f64,
}

/// Checks the step at the state `x`, on the design track.
///
/// # Errors
/// [`Error::Input`] at `run.integrator.step` with the largest step found stable.
pub fn check(system: &mut VehicleSystem<'_>, x: &[f64], integrator: &Integrator) -> Result<Stability> {
    let irregular = std::mem::replace(&mut system.irregular, false);
    let j = jacobian(system, 0.0, x);
    let mut dx = vec![0.0; x.len()];
    system.rhs(0.0, x, &mut dx);
    let a = stiff_part(system);
    system.irregular = irregular;
    // Control may go on down to its shortest step, so that is the one that has to be stable.
    let h = integrator.shortest_step();
    let per_shortest = integrator.step() / h;
    follow_memory(system.model, integrator)?;
    // What the vehicle itself does in one step is exp(h J): its spectral radius is exp(h times the largest real part).
    let (Some(largest_eigenvalue), Some(own)) = (spectral_radius(j.clone()), spectral_radius((&j * h).exp()))
    else {
        return Err(Error::NotConverged {
            what: "linearised vehicle at the start".into(),
            iterations: 1,
            residual: f64::INFINITY,
            unit: "rad/s",
            worst: "the stability check of the step, which met a number that is not finite".into(),
        });
    };
    let fastest_growth = own.ln() / h;
    let stable = |h: f64| {
        let radius = radius(&j, &a, integrator, h)?;
        Some((radius, radius <= (h * fastest_growth.max(0.0)).exp() + TOLERATED_GROWTH))
    };
    match stable(h) {
        Some((radius, true)) => Ok(Stability { largest_eigenvalue, fastest_growth, radius }),
        found => {
            let (mut low, mut high) = (0.0, h);
            for _ in 0..8 {
                let middle = 0.5 * (low + high);
                if stable(middle).is_some_and(|s| s.1) { low = middle } else { high = middle }
            }
            let growth = found.map_or("without bound".to_owned(), |f| format!("by a factor {:.3}", f.0));
            Err(Error::input(
                Fault::new(
                    KeyPath::of("run.integrator.step"),
                    format!(
                        "{} s with `{}`, in which an error grows {growth} each step (fastest eigenvalue {largest_eigenvalue:.0} rad/s)",
                        integrator.step(),
                        integrator.name()
                    ),
                    if low > 0.0 {
                        format!("at most about {:.2e} s with this scheme", low * per_shortest)
                    } else {
                        "another scheme: this one is stable with no step here".to_owned()
                    },
                )
                .hint("`ros2` treats wheel and track implicitly and takes larger steps"),
            ))
        }
    }
}

/// What connections remember may settle faster in use (friction that slides, a damper that blows off) than about the
/// state at the start.
fn follow_memory(model: &Model, integrator: &Integrator) -> Result<()> {
    // Where the scheme's stability function leaves the unit circle on the negative real axis.
    let reach = match integrator {
        Integrator::Heun { .. } | Integrator::HeunControlled { .. } | Integrator::Ros2 { .. } => 2.0,
        Integrator::Rk4 { .. } => 2.785,
    };
    let speed = |link: &Link| link.law.memory_speed();
    let Some(link) = model.links.iter().max_by(|a, b| speed(a).total_cmp(&speed(b))) else { return Ok(()) };
    let h = integrator.shortest_step();
    if h * speed(link) <= reach {
        return Ok(());
    }
    Err(Error::input(Fault::new(
        KeyPath::of("run.integrator.step"),
        format!(
            "{} s, with `{}` (a `{}`) that settles at {:.0} 1/s",
            integrator.step(),
            link.name,
            link.law.kind(),
            speed(link)
        ),
        format!("at most {:.2e} s with this scheme", reach / speed(link) * integrator.step() / h),
    )))
}

/// The part of the system's matrix that the stiff blocks know.
fn stiff_part(system: &mut VehicleSystem<'_>) -> DMatrix<f64> {
    let n = system.size();
    let mut a = DMatrix::zeros(n, n);
    let (mut k, mut c) = ([0.0; PAIR * PAIR], [0.0; PAIR * PAIR]);
    for block in 0..system.stiff_blocks().len() {
        let range = system.stiff_blocks()[block].clone();
        system.stiff_matrices(block, &mut k, &mut c);
        for i in 0..PAIR {
            a[(range.pos.start + i, range.vel.start + i)] = 1.0;
            for j in 0..PAIR {
                a[(range.vel.start + i, range.pos.start + j)] = -k[i * PAIR + j];
                a[(range.vel.start + i, range.vel.start + j)] = -c[i * PAIR + j];
            }
        }
    }
    a
}

/// Spectral radius of one step of length `h`.
fn radius(j: &DMatrix<f64>, a: &DMatrix<f64>, integrator: &Integrator, h: f64) -> Option<f64> {
    let n = j.nrows();
    let one = DMatrix::<f64>::identity(n, n);
    let hj = j * h;
    let step = match integrator {
        Integrator::Heun { .. } | Integrator::HeunControlled { .. } => &one + &hj + &hj * &hj * 0.5,
        Integrator::Rk4 { .. } => &one + &hj * (&one + &hj * (&one * 0.5 + &hj * (&one / 6.0 + &hj / 24.0))),
        Integrator::Ros2 { .. } => {
            let w = (&one - a * (ROS2_GAMMA * h)).lu().try_inverse()?;
            let k1 = &w * &hj;
            let k2 = &w * (&hj * (&one + &k1) - &k1 * 2.0);
            &one + k1 * 1.5 + k2 * 0.5
        }
    };
    spectral_radius(step)
}

/// Gelfand's formula, `lim |R^n|^(1/n)`, with n = 2^17 by repeated squaring: a QR iteration stalls on the many defective
/// eigenvalues at 1 (places along the track, turned angles), a power of the matrix does not care. With norms of 1e6 at most
/// in between the estimate is high by 1e-4.
fn spectral_radius(mut power: DMatrix<f64>) -> Option<f64> {
    const SQUARINGS: i32 = 17;
    let mut log = 0.0;
    for k in 0..=SQUARINGS {
        let norm = power.norm();
        if !norm.is_finite() {
            return None;
        }
        if norm == 0.0 {
            return Some(0.0);
        }
        // |R^(2^k)| = norm * exp(2^k * log): fold the norm into the logarithm per single power.
        log += norm.ln() / 2.0_f64.powi(k);
        power /= norm;
        if k < SQUARINGS {
            power = &power * &power;
        }
    }
    Some(log.exp())
}
