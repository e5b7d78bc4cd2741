//! Contract of every integrator: order, exactness, energy, restart, work, and no allocation in a step.

#![allow(clippy::unwrap_used, reason = "test helpers")]

use std::alloc::{GlobalAlloc, Layout, System as SystemAllocator};
use std::cell::Cell;

use railsim::integrator::{Integrator, StepEnd, Stepper, StiffBlock, System};

/// Counts the allocations of the current thread.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

#[allow(unsafe_code, reason = "an allocator that counts; it forwards everything to the system's")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: forwarded unchanged.
        unsafe { SystemAllocator.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: forwarded unchanged.
        unsafe { SystemAllocator.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// How well the system knows its own Jacobian.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Jacobian {
    Exact,
    /// Stiffness and damping 30 % too large, and a coupling that does not exist.
    Wrong,
    Zero,
    /// No stiff block named at all.
    None,
}

/// Two coupled oscillators with a hardening spring, driven: q'' = -K q - C q' - b q^3 + forcing, built so that
/// q(t) = (sin(w t) + 0.2, cos(0.7 w t)) is a solution.
struct Driven {
    jacobian: Jacobian,
    blocks: Vec<StiffBlock>,
    q: [f64; 2],
}

const W: f64 = 3.0;
const K: [f64; 4] = [14.0, -3.0, -3.0, 9.0];
const C: [f64; 4] = [1.1, -0.4, -0.4, 0.8];
const B: f64 = 0.7;

impl Driven {
    fn new(jacobian: Jacobian) -> Self {
        // Rates before positions, and apart, so that the ranges matter.
        let block = StiffBlock { pos: 3..5, vel: 0..2 };
        let blocks = if jacobian == Jacobian::None { vec![] } else { vec![block] };
        Self { jacobian, blocks, q: [0.0; 2] }
    }

    fn solution(t: f64) -> [f64; 5] {
        let v = 0.7 * W;
        [
            W * (W * t).cos(),
            -v * (v * t).sin(),
            (0.3 * t).exp(), // a soft state beside the block: z' = 0.3 z
            (W * t).sin() + 0.2,
            (v * t).cos(),
        ]
    }
}

impl System for Driven {
    fn size(&self) -> usize {
        5
    }

    fn rhs(&mut self, t: f64, x: &[f64], dx: &mut [f64]) {
        let exact = Self::solution(t);
        let v = 0.7 * W;
        let acceleration = [-W * W * (W * t).sin(), -v * v * (v * t).cos()];
        for i in 0..2 {
            let law = |x: &[f64]| {
                let spring: f64 = (0..2).map(|j| K[2 * i + j] * x[3 + j]).sum();
                let damper: f64 = (0..2).map(|j| C[2 * i + j] * x[j]).sum();
                spring + damper + B * x[3 + i].powi(3) - 0.1 * x[2]
            };
            dx[i] = acceleration[i] + law(&exact) - law(x);
            dx[3 + i] = x[i];
        }
        dx[2] = 0.3 * x[2];
        self.q = [x[3], x[4]];
    }

    fn stiff_blocks(&self) -> &[StiffBlock] {
        &self.blocks
    }

    fn stiff_matrices(&mut self, block: usize, k: &mut [f64], c: &mut [f64]) {
        assert_eq!(block, 0);
        let factor = match self.jacobian {
            Jacobian::Zero | Jacobian::None => 0.0,
            Jacobian::Exact => 1.0,
            Jacobian::Wrong => 1.3,
        };
        for i in 0..4 {
            k[i] = factor * K[i];
            c[i] = factor * C[i];
        }
        for i in 0..2 {
            k[3 * i] += factor * 3.0 * B * self.q[i] * self.q[i];
        }
        if self.jacobian == Jacobian::Wrong {
            k[1] += 5.0;
        }
    }
}

/// The examples with control that never steps back: then the controlled scheme is Heun's.
fn uncontrolled() -> Vec<Integrator> {
    let loose = |integrator| match integrator {
        Integrator::HeunControlled { step, halvings, .. } => {
            Integrator::HeunControlled { step, tolerance: 1e3, halvings }
        }
        other => other,
    };
    Integrator::examples().into_iter().map(loose).collect()
}

fn run<S: System>(
    integrator: &Integrator,
    system: &mut S,
    x: &mut [f64],
    t0: f64,
    h: f64,
    steps: usize,
) -> Stepper {
    let blocks = system.stiff_blocks().to_vec();
    let mut stepper = Stepper::new(integrator, system.size(), &blocks);
    for i in 0..steps {
        assert_eq!(stepper.step(system, t0 + i as f64 * h, x, h), StepEnd::Done);
    }
    stepper
}

fn error_at_end(integrator: &Integrator, jacobian: Jacobian, steps: usize) -> f64 {
    let end = 2.0;
    let mut x = Driven::solution(0.0);
    run(integrator, &mut Driven::new(jacobian), &mut x, 0.0, end / steps as f64, steps);
    x.iter().zip(Driven::solution(end)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn observed_order_is_the_stated_one_whatever_the_jacobian() {
    for integrator in uncontrolled() {
        for jacobian in [Jacobian::Exact, Jacobian::Wrong, Jacobian::Zero, Jacobian::None] {
            let errors = [100, 200, 400].map(|n| error_at_end(&integrator, jacobian, n));
            let orders = [(errors[0] / errors[1]).log2(), (errors[1] / errors[2]).log2()];
            println!("{:5} {jacobian:?}: errors {errors:?}, orders {orders:.3?}", integrator.name());
            let expected = f64::from(integrator.order());
            assert!((orders[1] - expected).abs() < 0.15, "{} {jacobian:?}: {orders:?}", integrator.name());
        }
    }
}

#[test]
fn ros2_without_stiff_blocks_is_heun_to_rounding() {
    let [heun, ros2] = [Integrator::Heun { step: 0.01 }, Integrator::Ros2 { step: 0.01 }];
    let (mut a, mut b) = (Driven::solution(0.0), Driven::solution(0.0));
    run(&heun, &mut Driven::new(Jacobian::None), &mut a, 0.0, 0.01, 300);
    run(&ros2, &mut Driven::new(Jacobian::None), &mut b, 0.0, 0.01, 300);
    // 300 steps of a few roundings of values up to 10 each.
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() < 1e-13, "{a} {b}");
    }
}

/// x' = derivative of a polynomial in t alone.
struct Polynomial(i32);

impl System for Polynomial {
    fn size(&self) -> usize {
        1
    }

    fn rhs(&mut self, t: f64, _: &[f64], dx: &mut [f64]) {
        dx[0] = f64::from(self.0) * (t - 0.3).powi(self.0 - 1);
    }
}

#[test]
fn exact_for_polynomials_of_its_order_and_not_beyond() {
    for integrator in uncontrolled() {
        for degree in 1..=5 {
            let p = |t: f64| (t - 0.3).powi(degree);
            let mut x = [p(0.1)];
            run(&integrator, &mut Polynomial(degree), &mut x, 0.1, 0.8, 1);
            let error = (x[0] - p(0.9)).abs();
            let exact = degree <= integrator.order() as i32;
            assert_eq!(error < 1e-15, exact, "{} degree {degree}: {error:e}", integrator.name());
        }
    }
}

/// Undamped oscillator of unit mass, q' = v, v' = -w^2 q, as one stiff block.
struct Oscillator {
    stiffness: f64,
    damping: f64,
    blocks: [StiffBlock; 1],
}

impl Oscillator {
    fn new(w: f64, zeta: f64) -> Self {
        Self { stiffness: w * w, damping: 2.0 * zeta * w, blocks: [StiffBlock { pos: 0..1, vel: 1..2 }] }
    }

    fn energy(&self, x: &[f64]) -> f64 {
        0.5 * (self.stiffness * x[0] * x[0] + x[1] * x[1])
    }
}

impl System for Oscillator {
    fn size(&self) -> usize {
        2
    }

    fn rhs(&mut self, _: f64, x: &[f64], dx: &mut [f64]) {
        dx[0] = x[1];
        dx[1] = -self.stiffness * x[0] - self.damping * x[1];
    }

    fn stiff_blocks(&self) -> &[StiffBlock] {
        &self.blocks
    }

    fn stiff_matrices(&mut self, _: usize, k: &mut [f64], c: &mut [f64]) {
        k[0] = self.stiffness;
        c[0] = self.damping;
    }
}

#[test]
fn energy_of_an_undamped_oscillator_drifts_as_the_theory_says() {
    // Amplification |R(iy)|^2 per step: heun 1 + y^4/4; rk4 1 - y^6/72 + y^8/576; ros2 1 - (g y)^4/(1 + (g y)^2)^2.
    let w = std::f64::consts::TAU;
    let mut system = Oscillator::new(w, 0.0);
    for integrator in uncontrolled() {
        let h = 0.01;
        let y = w * h;
        let gy2 = (railsim::integrator::ROS2_GAMMA * y).powi(2);
        let gain: f64 = match integrator {
            Integrator::Heun { .. } | Integrator::HeunControlled { .. } => 1.0 + y.powi(4) / 4.0,
            Integrator::Rk4 { .. } => 1.0 - y.powi(6) / 72.0 + y.powi(8) / 576.0,
            Integrator::Ros2 { .. } => 1.0 - gy2 * gy2 / ((1.0 + gy2) * (1.0 + gy2)),
        };
        let mut x = [1.0, 0.5];
        let before = system.energy(&x);
        run(&integrator, &mut system, &mut x, 0.0, h, 1000);
        let ours = system.energy(&x) / before;
        let theory = gain.powi(1000);
        println!(
            "{:5}: energy after 10 periods, 100 steps each: {ours:.9}, theory {theory:.9}",
            integrator.name()
        );
        // The discrete energy beats within a period by the eccentricity of the discrete orbit, some y^2.
        assert!((ours / theory - 1.0).abs() < y * y, "{}", integrator.name());
        assert!((ours - 1.0).abs() < 5e-3);
    }
}

#[test]
fn a_run_split_in_two_is_the_whole_run_bit_for_bit() {
    for integrator in Integrator::examples() {
        let h = 0.01;
        let mut whole = Driven::solution(0.0);
        run(&integrator, &mut Driven::new(Jacobian::Exact), &mut whole, 0.0, h, 200);
        let mut split = Driven::solution(0.0);
        let mut system = Driven::new(Jacobian::Exact);
        for (from, to) in [(0, 77), (77, 200)] {
            let mut stepper = Stepper::new(&integrator, 5, system.stiff_blocks());
            for i in from..to {
                assert_eq!(stepper.step(&mut system, f64::from(i) * h, &mut split, h), StepEnd::Done);
            }
        }
        assert_eq!(whole.map(f64::to_bits), split.map(f64::to_bits), "{}", integrator.name());
    }
}

#[test]
fn work_is_as_documented() {
    for integrator in uncontrolled() {
        let mut x = Driven::solution(0.0);
        let stepper = run(&integrator, &mut Driven::new(Jacobian::Exact), &mut x, 0.0, 0.01, 50);
        let work = stepper.statistics();
        let stages = match integrator {
            Integrator::Heun { .. } | Integrator::HeunControlled { .. } | Integrator::Ros2 { .. } => 2,
            Integrator::Rk4 { .. } => 4,
        };
        assert_eq!(integrator.stages(), stages);
        assert_eq!((work.steps, work.rhs_evaluations), (50, 50 * stages));
        let factorisations = if matches!(integrator, Integrator::Ros2 { .. }) { 50 } else { 0 };
        assert_eq!(work.factorisations, factorisations);
    }
}

#[test]
fn control_holds_the_error_to_its_tolerance_at_the_order_of_the_scheme() {
    // e = c h^2 <= tolerance, so that h and the work go with the root of the tolerance and the error with the tolerance: the
    // observed order is that of the error against the work.
    let steps = 20;
    let mut found = Vec::new();
    for tolerance in [1e-3, 1e-4, 1e-5, 1e-6] {
        let scheme = Integrator::HeunControlled { step: 0.1, tolerance, halvings: 12 };
        let mut x = Driven::solution(0.0);
        let stepper = run(&scheme, &mut Driven::new(Jacobian::None), &mut x, 0.0, 0.1, steps);
        let error = x.iter().zip(Driven::solution(2.0)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let work = stepper.statistics();
        println!("tolerance {tolerance:e}: error {error:.2e}, {work:?}");
        assert_eq!(work.steps, steps as u64);
        assert!(work.rejected > 0 && error < 20.0 * tolerance);
        found.push((error, work.rhs_evaluations as f64));
    }
    let (first, last) = (found[0], found[found.len() - 1]);
    let order = (first.0 / last.0).ln() / (last.1 / first.1).ln();
    println!("observed order: {order:.2}");
    // The lengths go in powers of two, so that the error moves by up to a factor four within a tolerance.
    assert!((order - 2.0).abs() < 0.3, "{order}");
}

#[test]
fn control_keeps_a_stiff_mode_bounded_far_beyond_the_limit_of_heun() {
    // A track mass: 2500 rad/s, damping ratio 0.7, which Heun takes to 0.5 ms.
    for h in [1e-3, 5e-3] {
        let tolerance = 1e-4;
        let mut x = [1e-3, 0.0];
        let scheme = Integrator::HeunControlled { step: h, tolerance, halvings: 12 };
        let stepper = run(&scheme, &mut Oscillator::new(2500.0, 0.7), &mut x, 0.0, h, 40);
        let mut plain = [1e-3, 0.0];
        run(&Integrator::Heun { step: h }, &mut Oscillator::new(2500.0, 0.7), &mut plain, 0.0, h, 40);
        println!("h {h}: controlled {x:?} {:?}, heun {plain:?}", stepper.statistics());
        // What is left is what the control does not see: local errors of the tolerance at most.
        assert!(x[1].abs() <= 10.0 * tolerance, "{x:?}");
        assert!(plain[1].is_nan() || plain[1].abs() > 1e3, "{plain:?}");
    }
}

/// x' = 1 up to t = 1/3, then -1000; counts what it is told.
#[derive(Default)]
struct Jump {
    rejected: u64,
}

impl System for Jump {
    fn size(&self) -> usize {
        2
    }

    fn rhs(&mut self, t: f64, _: &[f64], dx: &mut [f64]) {
        dx[0] = if t < 1.0 / 3.0 { 1.0 } else { -1000.0 };
        dx[1] = 0.0;
    }

    fn reject(&mut self) {
        self.rejected += 1;
    }
}

#[test]
fn control_steps_back_at_a_jump_alone_and_says_where_it_cannot_follow() {
    let scheme = |halvings| Integrator::HeunControlled { step: 0.1, tolerance: 1e-2, halvings };
    let mut system = Jump::default();
    let mut x = [0.0, 7.0];
    let stepper = run(&scheme(14), &mut system, &mut x, 0.0, 0.1, 10);
    let work = stepper.statistics();
    let exact = 1.0 / 3.0 - 1000.0 * (1.0 - 1.0 / 3.0);
    println!("{} against {exact}, {work:?}", x[0]);
    // The one step that meets the jump is right to the tolerance; a scheme without control errs by up to 1001 h/2 = 50.
    assert!((x[0] - exact).abs() < 1e-2 && x[1] == 7.0);
    assert_eq!(system.rejected, work.rejected);
    // Nine steps at once, one in parts: down to the jump and up again in doublings, at most two parts for each of 14 lengths
    // either way.
    assert!(work.rejected > 0 && work.rhs_evaluations < 2 * 9 + 14 * 2 * 2 * 2 + 14, "{work:?}");

    let mut x = [0.0, 7.0];
    let mut stepper = Stepper::new(&scheme(5), 2, &[]);
    for i in 0..3 {
        assert_eq!(stepper.step(&mut Jump::default(), 0.1 * f64::from(i), &mut x, 0.1), StepEnd::Done);
    }
    let end = stepper.step(&mut Jump::default(), 0.1 * 3.0, &mut x, 0.1);
    assert_eq!(end, StepEnd::OverTolerance { element: 0 });
    // Up to the last good part, 10/32 of the step in: 1/3 is between 10/32 and 11/32 of it.
    assert!((x[0] - (0.3 + 0.1 * 10.0 / 32.0)).abs() < 1e-12, "{x:?}");
    assert_eq!(stepper.statistics().steps, 3);
    // And a number that is no number is never within tolerance.
    let mut stepper = Stepper::new(&scheme(5), 2, &[]);
    let end = stepper.step(&mut Oscillator::new(f64::NAN, 0.1), 0.0, &mut [1.0, 2.0], 0.1);
    assert!(matches!(end, StepEnd::OverTolerance { .. }), "{end:?}");
}

#[test]
fn a_step_allocates_nothing() {
    for integrator in Integrator::examples() {
        let mut system = Driven::new(Jacobian::Exact);
        let mut stepper = Stepper::new(&integrator, 5, system.stiff_blocks());
        let mut x = Driven::solution(0.0);
        let before = ALLOCATIONS.with(Cell::get);
        let end = stepper.step(&mut system, 0.0, &mut x, 0.01);
        let after = ALLOCATIONS.with(Cell::get);
        assert_eq!(end, StepEnd::Done);
        assert_eq!(after - before, 0, "{}", integrator.name());
        assert!(ALLOCATIONS.with(Cell::get) > 0, "the counter counts");
    }
}

#[test]
fn a_matrix_of_nan_is_told_and_leaves_the_state() {
    let mut system = Oscillator::new(f64::NAN, 0.1);
    let mut stepper = Stepper::new(&Integrator::Ros2 { step: 1e-3 }, 2, system.stiff_blocks());
    let mut x = [1.0, 2.0];
    assert_eq!(stepper.step(&mut system, 0.0, &mut x, 1e-3), StepEnd::Singular { block: 0 });
    assert_eq!(x, [1.0, 2.0]);
    assert_eq!(stepper.statistics().steps, 0);
}
