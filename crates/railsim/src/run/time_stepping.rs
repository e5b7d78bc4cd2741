//! A case in time: rolling equilibrium, fixed steps to the end of the track, one row per output step.

use crate::dynamics::{Model, SpeedProgram, VehicleSystem, compile, coordinate, equilibrium};
use crate::equipment::{Acting, Equipment};
use crate::error::{Error, Fault, KeyPath, Result};
use crate::integrator::{Integrator, Stepper, System};
use crate::run::law::{Outside, Watching};
use crate::run::recorder::Recorder;
use crate::run::{divergence, stability};
use crate::schema::Case;
use crate::schema::drive::Until;

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
    run(case, control, None)
}

/// The same with a control law of the user's at every sample of `run.drive.period`, after the vehicle's own controllers.
///
/// # Errors
/// As [`simulate`]; a case without `run.drive`, a channel that there is not, a law that fails or answers with no number.
pub fn simulate_controlled(case: &Case, control: &dyn Control, outside: &mut Outside<'_>) -> Result<Outcome> {
    if case.run.drive.is_none() {
        let allowed = "a table, an empty one at least: a control law drives";
        return Err(Error::input(Fault::new(KeyPath::of("run.drive"), "nothing", allowed)));
    }
    run(case, control, Some(outside))
}

fn run(case: &Case, control: &dyn Control, outside: Option<&mut Outside<'_>>) -> Result<Outcome> {
    let mut model = compile::model(case)?;
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
    if let Some(angled) = &mut model.angled {
        angled.level_with(&x[map.q(angled.faces.body)]);
    }
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
    let latest = latest(case, distance);
    let mut samples = u64::MAX;
    if let Some(equipment) = &model.equipment {
        samples = (equipment.drive.period / h).round().max(1.0) as u64;
        attach(&mut system, equipment, integrator, &mut x)?;
        dx.resize(x.len(), 0.0);
    }
    let mut watching = match outside {
        Some(outside) => Some(Watching::new(outside, &system)?),
        None => None,
    };
    if let Some(watching) = &mut watching {
        watching.sample(&mut system, 0.0, &x)?;
    }
    if model.equipment.is_some() {
        system.rhs(0.0, &x, &mut dx);
    }
    let expected = latest.min(distance / speed.max(0.1));
    let rows = ((expected / (h * every as f64)) as usize).min(MOST_ROWS_AT_ONCE) + 8;
    let mut recorder = Recorder::new(&model, rows);
    recorder.record(&system, 0.0, &x, &dx);
    let mut stepper = Stepper::new(integrator, x.len(), system.stiff_blocks());
    let leading = (0..map.wheelsets).map(|w| map.q(map.bodies + w).start).collect::<Vec<_>>();
    let reference = map.q(model.reference()).start;

    let mut step: u64 = 0;
    let mut output: u64 = 0;
    let ended = 'run: loop {
        for n in 0..every {
            if n > 0 {
                sample(&mut system, &mut watching, step, samples, h, &x)?;
            }
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
        sample(&mut system, &mut watching, step, samples, h, &x)?;
        system.rhs(t, &x, &mut dx);
        recorder.record(&system, t, &x, &dx);
        output += 1;
        let s = model.place(&x);
        if leading.iter().any(|i| x[*i] >= case.track.length) {
            control.progress(t, s, 1.0);
            break Ended::EndOfTrack;
        }
        if model.equipment.as_ref().is_some_and(|e| reached(&e.drive.until, t, dx[reference])) {
            control.progress(t, s, 1.0);
            break Ended::Complete;
        }
        if t > latest {
            break Ended::Diverged(Error::Diverged {
                t,
                s,
                body: model.rigid(model.reference()).name.clone(),
                cause: format!(
                    "not at the end of the track in {latest:.1} s, {LATEST} times what the speed asked for takes: nothing holds it"
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
    if let (Some(watching), Ended::EndOfTrack | Ended::Complete) = (&watching, &ended) {
        watching.finish()?;
    }
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
        "distance_m": model.place(&x) - start,
    });
    Ok(Outcome { columns: recorder.into_columns(), labels: Vec::new(), ended, statistics })
}

/// Time after which a run has failed, s.
fn latest(case: &Case, distance: f64) -> f64 {
    let take = distance / case.run.speed.max(0.1);
    match case.run.drive.as_ref().map(|drive| drive.until.time) {
        None => LATEST * take,
        // The end that was asked for comes first.
        Some(Some(time)) => time + case.run.output_step,
        Some(None) => SLOWEST * take,
    }
}

/// A driven run may be slower than the speed that it began with, but not by more than this.
const SLOWEST: f64 = 20.0;

/// Lets the equipment act, with its numbers at the end of the state.
fn attach<'m>(
    system: &mut VehicleSystem<'m>,
    equipment: &'m Equipment,
    integrator: &Integrator,
    x: &mut Vec<f64>,
) -> Result<()> {
    let model = system.model;
    if let Some(train) = &equipment.train
        && integrator.step() * train.fastest() > 1.0
    {
        return Err(Error::input(Fault::new(
            KeyPath::of("run.integrator.step"),
            format!(
                "{} s, with a train whose couplings swing at {:.0} rad/s",
                integrator.step(),
                train.fastest()
            ),
            format!("at most {:.2e} s", 1.0 / train.fastest()),
        )));
    }
    system.holding = equipment.drive.hold_speed;
    system.creeping = true;
    let mut acting = Box::new(Acting::new(model, equipment));
    x.resize(model.map().size() + acting.states(), 0.0);
    acting.release(model, x);
    acting.place_train(model, x);
    acting.sample(model, 0.0, x);
    system.acting = Some(acting);
    Ok(())
}

/// Lets the controllers look, every `samples` steps.
#[inline]
fn sample(
    system: &mut VehicleSystem<'_>,
    watching: &mut Option<Watching<'_, '_>>,
    step: u64,
    samples: u64,
    h: f64,
    x: &[f64],
) -> Result<()> {
    if !step.is_multiple_of(samples) {
        return Ok(());
    }
    let t = step as f64 * h;
    if let Some(acting) = &mut system.acting {
        acting.sample(system.model, t, x);
    }
    match watching {
        Some(watching) => watching.sample(system, t, x),
        None => Ok(()),
    }
}

/// Whether the end that was asked for has come, at the vehicle's speed `v`.
fn reached(until: &Until, t: f64, v: f64) -> bool {
    until.time.is_some_and(|end| t >= end - 1e-9)
        || until.speed_below.is_some_and(|end| v <= end)
        || until.speed_above.is_some_and(|end| v >= end)
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
