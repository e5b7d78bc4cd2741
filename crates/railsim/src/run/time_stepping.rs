//! A case in time: rolling equilibrium, fixed steps to the end of the track, one row per output step.

use crate::dynamics::{Model, SpeedProgram, VehicleSystem, compile, coordinate, equilibrium};
use crate::error::{Error, Fault, KeyPath, Result};
use crate::integrator::{Stepper, System};
use crate::run::recorder::Recorder;
use crate::run::{divergence, stability};
use crate::schema::Case;

/// Room that is taken for rows before the run, at most; more is taken as it is needed.
const MOST_ROWS_AT_ONCE: usize = 1 << 18;
/// A run that takes more than this many times its time will not end.
const LATEST: f64 = 3.0;

/// How the caller watches and stops a run.
pub trait Control: Sync {
    /// Called now and then with time (s), place (m) and the fraction done.
    fn progress(&self, t: f64, s: f64, fraction: f64);
    /// True when the run is to stop; asked after every output step.
    fn stop(&self) -> bool;
}

/// Nobody watches, nobody stops.
#[derive(Debug, Clone, Copy)]
pub struct Free;

impl Control for Free {
    fn progress(&self, _t: f64, _s: f64, _fraction: f64) {}
    fn stop(&self) -> bool {
        false
    }
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ended {
    /// The leading wheelset reached the end of the track.
    EndOfTrack,
    /// An analysis gave all its rows.
    Complete,
    /// The run left what the model describes; the columns go up to there.
    Diverged(Error),
}

/// What a run gives.
#[derive(Debug)]
pub struct Outcome {
    /// Names and samples, all of one length.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Names and texts of the same length, beside the columns: what modes are called.
    pub labels: Vec<(String, Vec<String>)>,
    /// How it ended.
    pub ended: Ended,
    /// Counts: steps, right-hand sides, factorisations; the step's stability margin.
    pub statistics: serde_json::Value,
}

/// Runs a case of kind `time`.
///
/// The first wheelset starts at `run.start`, by default the beginning of the track with the vehicle behind it on a straight
/// continuation, in rolling equilibrium on the design track at the speed asked for but for `run.disturbance`; the run ends when that wheelset reaches the
/// end of the track.
///
/// # Errors
/// Bad input, no equilibrium, a step beyond the scheme's stability limit, an interruption. A run that diverges on the way
/// is an [`Outcome`] that says so.
pub fn simulate(case: &Case, control: &dyn Control) -> Result<Outcome> {
    let model = compile::model(case)?;
    let integrator = &case.run.integrator;
    let h = integrator.step();
    let every = (case.run.output_step / h).round().max(1.0) as usize;
    let map = model.map();
    let speed = case.run.speed;
    let disturbance = coordinate::disturbance(&model, &case.run.disturbance)?;

    let places: Vec<f64> = (0..model.count()).map(|i| model.rigid(i).position.x).collect();
    let wheels = if model.wheelsets.is_empty() { &places[..] } else { &places[model.bodies.len()..] };
    let start = case.run.start - wheels.iter().fold(f64::MIN, |front, x| front.max(*x));
    smooth_start(&model, start)?;

    let mut x = equilibrium::solve(&model, start, speed)?;
    let program = SpeedProgram { s: equilibrium::reference_s(&model, start), speed, acceleration: 0.0 };
    let mut system = VehicleSystem::new(&model, program);
    let mut dx = vec![0.0; map.size()];
    system.rhs(0.0, &x, &mut dx);
    let limit = stability::check(&mut system, &x, integrator)?;
    control.progress(0.0, start, 0.0);
    for (q, by) in disturbance {
        x[q] += by;
    }
    system.rhs(0.0, &x, &mut dx);
    // What the perturbed states of that check set.
    system.scratch.left_rail = None;

    let distance = case.track.length - case.run.start;
    let rows = ((distance / speed / (h * every as f64)) as usize).min(MOST_ROWS_AT_ONCE) + 8;
    let mut recorder = Recorder::new(&model, rows);
    recorder.record(&system, 0.0, &x, &dx);
    let mut stepper = Stepper::new(integrator, map.size(), system.stiff_blocks());
    let leading = (0..map.wheelsets).map(|w| map.q(map.bodies + w).start).collect::<Vec<_>>();
    let reference = map.q(model.reference()).start;

    let mut step: u64 = 0;
    let mut output: u64 = 0;
    let ended = 'run: loop {
        for n in 0..every {
            // The slope that the last row was written from is the first of the step that follows.
            let known = (n == 0).then_some(&dx[..]);
            let end = stepper.step_from(&mut system, step as f64 * h, &mut x, h, known);
            step += 1;
            let t = step as f64 * h;
            let good = divergence::stepped(&system, end, t, &x);
            if let Err(error) = good.and_then(|()| divergence::check(&mut system, t, &x)) {
                break 'run Ended::Diverged(error);
            }
        }
        let t = step as f64 * h;
        system.rhs(t, &x, &mut dx);
        recorder.record(&system, t, &x, &dx);
        output += 1;
        let s = x[reference] - model.rigid(model.reference()).position.x;
        if leading.iter().any(|i| x[*i] >= case.track.length) {
            control.progress(t, s, 1.0);
            break Ended::EndOfTrack;
        }
        if t > LATEST * distance / speed {
            break Ended::Diverged(Error::Diverged {
                t,
                s,
                body: model.rigid(model.reference()).name.clone(),
                cause: format!(
                    "not at the end of the track in {LATEST} times the time that the speed asked for takes: nothing holds it"
                ),
            });
        }
        if output.is_multiple_of(20) {
            control.progress(t, s, ((s - start) / distance).clamp(0.0, 1.0));
        }
        if control.stop() {
            return Err(Error::Interrupted);
        }
    };
    let counts = stepper.statistics();
    let statistics = serde_json::json!({
        "scheme": integrator.name(),
        "step": h,
        "steps": step,
        "right_hand_sides": counts.rhs_evaluations,
        "factorisations": counts.factorisations,
        "rejected": counts.rejected,
        "largest_eigenvalue": limit.largest_eigenvalue,
        "simulated_s": step as f64 * h,
        "distance_m": x[reference] - model.rigid(model.reference()).position.x - start,
    });
    Ok(Outcome { columns: recorder.into_columns(), labels: Vec::new(), ended, statistics })
}

/// Most irregularity (m) under a wheel at the start: a tenth of what the contact is pressed in by the wheel's load.
const SMOOTH: f64 = 1e-5;

/// The start is in equilibrium on the design track, so the irregularity must not have begun there: a step of a millimetre
/// under a wheel is a hammer blow.
fn smooth_start(model: &Model, start: f64) -> Result<()> {
    for set in &model.wheelsets {
        // Just ahead of the wheelset: a clothoid begins straight, a curve does not.
        let s = start + set.body.position.x + 1e-6;
        let (curvature, cant) = (model.layout.curvature(s), model.layout.cant(s));
        if curvature.abs() > 1e-6 || cant.abs() > 1e-6 {
            return Err(Error::input(Fault::new(
                KeyPath::of("track.layout"),
                format!(
                    "curvature {curvature:.2e} 1/m, cant {cant:.2e} rad under {} at the start",
                    set.body.name
                ),
                "straight track without cant under the whole vehicle, then a clothoid: a run starts on straight track",
            )));
        }
    }
    for set in &model.wheelsets {
        let d = model.deviation.at(start + set.body.position.x);
        let largest = [d.y, d.z, d.cross_level, d.gauge].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if largest > SMOOTH {
            return Err(Error::input(
                Fault::new(
                    KeyPath::of("track.fade_in"),
                    format!(
                        "an irregularity of {:.2} mm under {} at the start",
                        1e3 * largest,
                        set.body.name
                    ),
                    "a length > 0 m over which the irregularity grows from nothing",
                )
                .hint(
                    "`fade_in = 50.0` fades it in over the 50 m from `fade_start` on, which is 0 by default",
                ),
            ));
        }
    }
    Ok(())
}
