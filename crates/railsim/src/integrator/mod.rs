//! Fixed-step integrators. They see a [`System`] (a size and a right-hand side), never a vehicle.
//!
//! | `kind` | order | right-hand sides per step | stable to (undamped / real) | for |
//! |---|---|---|---|---|
//! | `heun` | 2 | 2 | 0 (growth of y^4/8 per step) / h lambda = -2 | the paper's scheme |
//! | `heun_controlled` | 2 | 2, and 1 or 2 for each sub-step more | as `heun`, of its shortest sub-step | steps beyond `heun`'s limit |
//! | `rk4` | 4 | 4 | 2.83 / -2.79 | runs on lumped track at speed: the hunting spec |
//! | `ros2` | 2 | 2 and one small LU per stiff block | no limit inside the blocks, as `heun` outside | contact on track masses |
//!
//! y is the angular frequency times the step.

mod explicit;
mod heun;
mod heun_controlled;
mod rk4;
mod ros2;

use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{Fault, KeyPath};

pub use ros2::GAMMA as ROS2_GAMMA;

/// Largest step that is accepted, s. No scheme here follows a vehicle's modes with more.
pub const MAX_STEP: f64 = 0.05;
/// Most halvings of a step that is taken again: a thousandth of a thousandth of it.
pub const MAX_HALVINGS: u32 = 20;

/// A part of the state whose own stiffness and damping are large: positions and their rates.
///
/// Both ranges have the same length n (up to about 12) and d(pos)/dt is `vel`, exactly or nearly.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StiffBlock {
    /// Where the positions stand in the state.
    pub pos: Range<usize>,
    /// Where their rates stand in the state.
    pub vel: Range<usize>,
}

/// What is integrated: dx/dt = f(t, x).
pub trait System {
    /// Length of the state.
    fn size(&self) -> usize;

    /// Writes f(t, x) into `dx`, every element of it.
    fn rhs(&mut self, t: f64, x: &[f64], dx: &mut [f64]);

    /// The stiff blocks, disjoint; none by default.
    fn stiff_blocks(&self) -> &[StiffBlock] {
        &[]
    }

    /// Fills K and C (n by n, row-major) of d(vel)/dt ~ -K pos - C vel + ... of stiff block `block`, at the state
    /// of the *last* call of [`Self::rhs`]. They may be approximate: accuracy of order two does not depend on
    /// them, stability does ([`ROS2_GAMMA`]). With zeros, the default, only d(pos)/dt = vel is implicit.
    fn stiff_matrices(&mut self, block: usize, k: &mut [f64], c: &mut [f64]) {
        let _ = block;
        k.fill(0.0);
        c.fill(0.0);
    }

    /// Told after a call of [`Self::rhs`] whose state is thrown away: what was noted about it does not count.
    fn reject(&mut self) {}
}

/// Which scheme, with which step (written form: `integrator = { kind = "ros2", step = 0.001 }`).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Integrator {
    /// Heun's two-stage Runge-Kutta scheme (Euler predictor, trapezoidal corrector), order 2.
    Heun {
        /// Step, s.
        step: f64,
    },
    /// Heun's scheme with step-back control: where the local error is over tolerance the step is taken again in smaller
    /// ones, down to `step / 2^halvings`.
    HeunControlled {
        /// Longest step, s; rows are written at multiples of it.
        step: f64,
        /// Largest local error (the difference between the predictor and the corrector) of any number of the state: m, rad,
        /// m/s, rad/s alike.
        tolerance: f64,
        /// How often a step may be halved; 10 if absent. An error over tolerance in the shortest step ends the run.
        #[serde(default = "ten_halvings")]
        halvings: u32,
    },
    /// The classical four-stage Runge-Kutta scheme, order 4.
    Rk4 {
        /// Step, s.
        step: f64,
    },
    /// Linearly implicit two-stage scheme (a W-method), order 2: implicit in the stiff blocks of the system,
    /// Heun elsewhere.
    Ros2 {
        /// Step, s.
        step: f64,
    },
}

fn ten_halvings() -> u32 {
    10
}

impl Integrator {
    /// One of each kind, for the contract suite and the documentation.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![
            Self::Heun { step: 2.5e-4 },
            Self::HeunControlled { step: 1e-3, tolerance: 1e-3, halvings: 10 },
            Self::Rk4 { step: 1e-3 },
            Self::Ros2 { step: 1e-3 },
        ]
    }

    /// The step, s.
    #[must_use]
    pub fn step(&self) -> f64 {
        match *self {
            Self::Heun { step }
            | Self::HeunControlled { step, .. }
            | Self::Rk4 { step }
            | Self::Ros2 { step } => step,
        }
    }

    /// The shortest step that the scheme may take, s: [`Self::step`] but where it is controlled.
    #[must_use]
    pub fn shortest_step(&self) -> f64 {
        match *self {
            Self::HeunControlled { step, halvings, .. } => {
                step * 0.5_f64.powi(halvings.min(MAX_HALVINGS) as i32)
            }
            _ => self.step(),
        }
    }

    /// The same scheme with another step.
    #[must_use]
    pub fn with_step(&self, step: f64) -> Self {
        match *self {
            Self::Heun { .. } => Self::Heun { step },
            Self::HeunControlled { tolerance, halvings, .. } => {
                Self::HeunControlled { step, tolerance, halvings }
            }
            Self::Rk4 { .. } => Self::Rk4 { step },
            Self::Ros2 { .. } => Self::Ros2 { step },
        }
    }

    /// The `kind` as written.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Heun { .. } => "heun",
            Self::HeunControlled { .. } => "heun_controlled",
            Self::Rk4 { .. } => "rk4",
            Self::Ros2 { .. } => "ros2",
        }
    }

    /// Order of accuracy.
    #[must_use]
    pub fn order(&self) -> u32 {
        match self {
            Self::Heun { .. } | Self::HeunControlled { .. } | Self::Ros2 { .. } => 2,
            Self::Rk4 { .. } => 4,
        }
    }

    /// Right-hand sides in one step; of a controlled one that is taken at once.
    #[must_use]
    pub fn stages(&self) -> u64 {
        match self {
            Self::Heun { .. } | Self::HeunControlled { .. } | Self::Ros2 { .. } => 2,
            Self::Rk4 { .. } => 4,
        }
    }

    /// What is wrong with the written values; `at` is the path of the integrator's table.
    #[must_use]
    pub fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = Vec::new();
        let step = self.step();
        if !(step.is_finite() && step > 0.0 && step <= MAX_STEP) {
            let fault =
                Fault::new(at.key("step"), format!("{step} s"), format!("above 0, at most {MAX_STEP} s"));
            faults.push(if (0.1..=50.0).contains(&step) {
                fault.hint(format!("the step is in seconds: {step} ms is {}", step / 1000.0))
            } else {
                fault
            });
        }
        if let Self::HeunControlled { tolerance, halvings, .. } = *self {
            if !(tolerance.is_finite() && tolerance > 0.0) {
                faults.push(Fault::new(at.key("tolerance"), tolerance.to_string(), "a number above 0"));
            }
            if !(1..=MAX_HALVINGS).contains(&halvings) {
                let allowed = format!("1 to {MAX_HALVINGS}");
                faults.push(Fault::new(at.key("halvings"), halvings.to_string(), allowed));
            }
        }
        faults
    }
}

/// How a call of [`Stepper::step`] ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[must_use]
pub enum StepEnd {
    /// The state is one step further.
    Done,
    /// The matrix of a stiff block has no inverse (most likely a NaN in it): the state is where it was.
    Singular {
        /// Which block.
        block: usize,
    },
    /// The shortest step that control may take is over tolerance: the state is where the last good one led.
    OverTolerance {
        /// The element of the state with the largest error.
        element: usize,
    },
}

/// Work done so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statistics {
    /// Steps taken.
    pub steps: u64,
    /// Evaluations of the right-hand side.
    pub rhs_evaluations: u64,
    /// LU decompositions of stiff blocks.
    pub factorisations: u64,
    /// Steps thrown away by control and taken again.
    pub rejected: u64,
}

/// Writes the slope at (t, x) into `k`: the known one, else by a call of the right-hand side.
fn first_slope<S: System>(
    system: &mut S,
    t: f64,
    x: &[f64],
    known: Option<&[f64]>,
    k: &mut [f64],
    statistics: &mut Statistics,
) {
    match known {
        Some(slope) => k.copy_from_slice(slope),
        None => {
            system.rhs(t, x, k);
            statistics.rhs_evaluations += 1;
        }
    }
}

/// A scheme with its working memory: the state is the caller's, nothing here outlives a step but the counts.
#[derive(Debug, Clone)]
pub struct Stepper {
    scheme: Scheme,
    statistics: Statistics,
}

#[derive(Debug, Clone)]
enum Scheme {
    Explicit(explicit::Explicit),
    HeunControlled(heun_controlled::HeunControlled),
    Ros2(ros2::Ros2),
}

impl Stepper {
    /// Working memory for a state of length `size`; `blocks` are [`System::stiff_blocks`], which only `ros2` uses.
    #[must_use]
    pub fn new(integrator: &Integrator, size: usize, blocks: &[StiffBlock]) -> Self {
        let scheme = match *integrator {
            Integrator::Heun { .. } => Scheme::Explicit(explicit::Explicit::new(&heun::TABLEAU, size)),
            Integrator::HeunControlled { tolerance, halvings, .. } => {
                let halvings = halvings.min(MAX_HALVINGS);
                Scheme::HeunControlled(heun_controlled::HeunControlled::new(tolerance, halvings, size))
            }
            Integrator::Rk4 { .. } => Scheme::Explicit(explicit::Explicit::new(&rk4::TABLEAU, size)),
            Integrator::Ros2 { .. } => Scheme::Ros2(ros2::Ros2::new(size, blocks)),
        };
        Self { scheme, statistics: Statistics::default() }
    }

    /// Takes `x` from t to t + h. Allocates nothing.
    pub fn step<S: System>(&mut self, system: &mut S, t: f64, x: &mut [f64], h: f64) -> StepEnd {
        self.step_from(system, t, x, h, None)
    }

    /// The same where the slope at (t, x) is known already, from the *last* call of [`System::rhs`]: an output step
    /// evaluates it for its row.
    pub fn step_from<S: System>(
        &mut self,
        system: &mut S,
        t: f64,
        x: &mut [f64],
        h: f64,
        slope: Option<&[f64]>,
    ) -> StepEnd {
        match &mut self.scheme {
            Scheme::Explicit(scheme) => scheme.step(system, t, x, h, slope, &mut self.statistics),
            Scheme::HeunControlled(scheme) => scheme.step(system, t, x, h, slope, &mut self.statistics),
            Scheme::Ros2(scheme) => scheme.step(system, t, x, h, slope, &mut self.statistics),
        }
    }

    /// Work done so far.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_form_is_read_and_unknown_keys_are_refused() {
        let read = |text: &str| serde_json::from_str::<Integrator>(text);
        assert_eq!(read(r#"{"kind":"ros2","step":0.001}"#).unwrap(), Integrator::Ros2 { step: 1e-3 });
        for example in Integrator::examples() {
            let text = serde_json::to_string(&example).unwrap();
            assert!(text.contains(example.name()));
            assert_eq!(read(&text).unwrap(), example);
        }
        assert!(
            read(r#"{"kind":"ros2","step":0.001,"gamma":1.0}"#).unwrap_err().to_string().contains("gamma")
        );
        assert!(read(r#"{"kind":"euler","step":0.001}"#).unwrap_err().to_string().contains("heun"));
    }

    #[test]
    fn a_tolerance_and_halvings_outside_their_range_are_refused_by_key() {
        let at = KeyPath::of("run.integrator");
        let faults = |tolerance, halvings| -> Vec<String> {
            let scheme = Integrator::HeunControlled { step: 1e-3, tolerance, halvings };
            scheme.faults(&at).iter().map(ToString::to_string).collect()
        };
        assert_eq!(faults(0.0, 4), ["run.integrator.tolerance: found 0; allowed: a number above 0"]);
        assert_eq!(faults(f64::NAN, 4).len(), 1);
        assert_eq!(faults(1e-3, 21), ["run.integrator.halvings: found 21; allowed: 1 to 20"]);
        assert_eq!(faults(-1.0, 0).len(), 2);
    }

    #[test]
    fn a_step_outside_its_range_is_refused_by_key() {
        let at = KeyPath::of("run.integrator");
        for good in Integrator::examples() {
            assert_eq!(good.faults(&at), []);
            for bad in [0.0, -1e-3, f64::NAN, f64::INFINITY, 0.0501, 1.0] {
                let faults = good.with_step(bad).faults(&at);
                assert_eq!(faults.len(), 1, "{bad}");
                assert_eq!(faults[0].key.to_string(), "run.integrator.step");
            }
        }
        let message = Integrator::Heun { step: 1.0 }.faults(&at)[0].to_string();
        assert_eq!(
            message,
            "run.integrator.step: found 1 s; allowed: above 0, at most 0.05 s (the step is in seconds: 1 ms is 0.001)"
        );
    }
}
