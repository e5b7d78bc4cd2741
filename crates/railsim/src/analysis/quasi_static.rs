//! Balance after balance: at rest or at constant speed, on straight track or in a curve, along a path of loads.
//!
//! The equilibrium of `run.kind = "equilibrium"` is one such balance. Elements whose force depends on the way there (friction)
//! are followed step by step, so that a path that comes back shows their hysteresis.

use serde_json::json;

use crate::analysis::{Stand, Table};
use crate::dynamics::coordinate::{self, Coordinate};
use crate::dynamics::equilibrium::{self, Conditions};
use crate::dynamics::{Contact, Model};
use crate::error::{Error, Fault, KeyPath, Result};
use crate::integrator::System;
use crate::math::Vec3;
use crate::run::recorder::Recorder;
use crate::run::{Control, Ended, Outcome};
use crate::schema::Case;
use crate::schema::run::{Axis, Load};

/// Columns before the channels of the vehicle.
const OWN: [&str; 6] = ["step", "curvature", "cant", "gradient", "unbalanced", "flange_angle"];

/// A load with its names resolved.
#[derive(Debug)]
enum Action {
    /// Accelerations (state index, per newton) and the column's name.
    Force {
        push: Vec<(usize, f64)>,
        name: String,
    },
    Displacement(Coordinate),
    Speed,
}

impl Action {
    fn new(model: &Model, load: &Load, at: &KeyPath) -> Result<Self> {
        Ok(match load {
            Load::Force { body, axis, position, .. } => force(model, body, *axis, *position, at)?,
            Load::Displacement { coordinate, .. } => {
                Self::Displacement(coordinate::find(model, coordinate, &at.key("coordinate"))?)
            }
            Load::Speed { .. } => Self::Speed,
        })
    }

    fn column(&self) -> Option<String> {
        match self {
            Self::Force { name, .. } => Some(name.clone()),
            Self::Displacement(c) if c.turns => Some(format!("{}.reaction_moment", c.name)),
            Self::Displacement(c) => Some(format!("{}.reaction", c.name)),
            Self::Speed => None,
        }
    }
}

fn force(model: &Model, body: &str, axis: Axis, position: Option<[f64; 3]>, at: &KeyPath) -> Result<Action> {
    let names: Vec<&str> = (0..model.count()).map(|i| model.rigid(i).name.as_str()).collect();
    let Some(index) = names.iter().position(|n| *n == body) else {
        let fault = Fault::new(at.key("body"), format!("`{body}`"), names.join(", "));
        return Err(Error::input(fault));
    };
    let (rigid, first) = (model.rigid(index), model.map().u(index).start);
    let (direction, part) = match axis {
        Axis::X => (Vec3::x(), "force_x"),
        Axis::Y => (Vec3::y(), "force_y"),
        Axis::Z => (Vec3::z(), "force_z"),
    };
    let lever = position.map_or(Vec3::zeros(), |p| Vec3::from(p) - rigid.position);
    let moment = lever.cross(&direction);
    let mut push = Vec::new();
    for d in 0..3 {
        push.push((first + d, direction[d] / rigid.mass));
        // An axle box's moment about the axle is no moment of the wheelset.
        if index < model.bodies.len() || d != 1 {
            push.push((first + 3 + d, moment[d] / rigid.inertia[d]));
        }
    }
    push.retain(|(_, by)| *by != 0.0);
    Ok(Action::Force { push, name: format!("{body}.{part}") })
}

fn actions(model: &Model, case: &Case) -> Result<Vec<Action>> {
    let at = KeyPath::of("run.load");
    let mut actions: Vec<Action> = Vec::new();
    for (i, load) in case.run.load.iter().enumerate() {
        let mut action = Action::new(model, load, &at.index(i))?;
        if let Action::Force { name, .. } = &mut action {
            // Several forces along one axis of a body: `carbody.force_z`, `carbody.2.force_z`, ...
            let column = |n: usize| match name.rsplit_once('.') {
                Some((body, part)) if n > 1 => format!("{body}.{n}.{part}"),
                _ => name.clone(),
            };
            let taken: Vec<_> = actions.iter().filter_map(Action::column).collect();
            let own = (1..).map(column).find(|c| !taken.contains(c));
            *name = own.unwrap_or_default();
        }
        actions.push(action);
    }
    Ok(actions)
}

/// Names of all columns.
///
/// # Errors
/// Faults of the case.
pub fn columns(case: &Case) -> Result<Vec<String>> {
    let stand = Stand::new(case)?;
    Ok(names(&stand.model, &actions(&stand.model, case)?))
}

fn names(model: &Model, actions: &[Action]) -> Vec<String> {
    let recorded = Recorder::new(model, 0).into_columns().into_iter().map(|(name, _)| name);
    let own = OWN.into_iter().map(str::to_owned).chain(actions.iter().filter_map(Action::column));
    own.chain(recorded.filter(|name| name != "t")).collect()
}

/// Values of all loads at each load step.
fn path(loads: &[Load], steps: u32) -> Vec<Vec<f64>> {
    let Some(first) = loads.first() else { return vec![Vec::new()] };
    let at = |leg: usize, share: f64| -> Vec<f64> {
        loads
            .iter()
            .map(|l| {
                let (from, to) = (l.path()[leg], l.path()[(leg + 1).min(l.path().len() - 1)]);
                from + share * (to - from)
            })
            .collect()
    };
    let mut values = vec![at(0, 0.0)];
    for leg in 0..first.path().len() - 1 {
        values.extend((1..=steps).map(|k| at(leg, f64::from(k) / f64::from(steps))));
    }
    values
}

/// Runs a case of kind `equilibrium` or `quasi_static`.
///
/// Columns: load `step`, `curvature`, `cant` and `gradient` at the vehicle's centre, `unbalanced` lateral acceleration in the
/// plane of the rails (V2/R cos cant - g sin cant, + to the left of a right-hand curve, that is outward), the wheel profile's
/// `flange_angle` (NaN for the textbook's contact), each force as `<body>.force_y`, what holds a displaced coordinate as `<coordinate>.reaction`, then the channels of a run in time.
///
/// # Errors
/// Faults of the case; [`Error::NotConverged`] where there is no balance at the first load step. One that is lost on the way is
/// an [`Outcome`] that says so.
pub fn run(case: &Case, control: &dyn Control) -> Result<Outcome> {
    let mut stand = Stand::new(case)?;
    let actions = actions(&stand.model, case)?;
    let path = path(&case.run.load, case.run.load_steps);
    let start = speed(case, &actions, &path[0]);
    let mut x = stand.settle(start)?;
    let base = x.clone();
    let mut held = stand.held.clone();
    held.extend(actions.iter().filter_map(|a| match a {
        Action::Displacement(c) => Some(c.q),
        _ => None,
    }));
    let mut table = Table::new(names(&stand.model, &actions));
    let way = Way { stand: &stand, actions: &actions, case, held: &held, base: &base };
    let mut ended = Ended::Complete;
    let mut last: Vec<f64> = way.nothing(&path[0]);
    for (step, values) in path.iter().enumerate() {
        if control.stop() {
            return Err(Error::Interrupted);
        }
        control.progress(step as f64, 0.0, step as f64 / path.len() as f64);
        match way.go(&mut x, &last, values, 0) {
            Ok(()) => table.push(std::iter::once(step as f64).chain(way.row(&x, values))),
            Err(error) if step == 0 => return Err(error),
            Err(error) => {
                ended = Ended::Diverged(error);
                break;
            }
        }
        last.clone_from(values);
    }
    let rows = table.columns.first().map_or(0, Vec::len);
    let statistics = json!({ "analysis": case.run.kind.name(), "load_steps": rows, "place_m": stand.s });
    Ok(table.done(Vec::new(), ended, statistics))
}

fn speed(case: &Case, actions: &[Action], values: &[f64]) -> f64 {
    let own = actions.iter().zip(values).find(|(a, _)| matches!(a, Action::Speed));
    own.map_or(case.run.speed, |(_, v)| *v)
}

/// Halvings of a load step whose end is out of reach from its beginning.
const DEEPEST: u32 = 4;

/// What does not change along a path of loads.
struct Way<'a> {
    stand: &'a Stand,
    actions: &'a [Action],
    case: &'a Case,
    held: &'a [usize],
    base: &'a [f64],
}

impl Way<'_> {
    /// The values of loads that do nothing, at the speed of the first step.
    fn nothing(&self, first: &[f64]) -> Vec<f64> {
        let none =
            |(action, value): (&Action, &f64)| if matches!(action, Action::Speed) { *value } else { 0.0 };
        self.actions.iter().zip(first).map(none).collect()
    }

    /// Accelerations by the loads.
    fn push(&self, values: &[f64]) -> Vec<(usize, f64)> {
        let mut push = Vec::new();
        for (action, value) in self.actions.iter().zip(values) {
            if let Action::Force { push: unit, .. } = action {
                push.extend(unit.iter().map(|(i, by)| (*i, by * value)));
            }
        }
        push
    }

    /// From the balance at `from` to that at `to`, with stops on the way where it is too far.
    fn go(&self, x: &mut Vec<f64>, from: &[f64], to: &[f64], depth: u32) -> Result<()> {
        let before = x.clone();
        let speed = speed(self.case, self.actions, to);
        let mut system = self.stand.system(speed);
        let push = self.push(to);
        let since = (self.stand.model.map().memory > 0).then_some(&before[..]);
        let conditions = Conditions { speed, held: self.held, push: &push, since };
        let moved = |(action, value): (&Action, &f64)| match action {
            Action::Displacement(c) => Some((c.q, self.base[c.q] + value - before[c.q])),
            _ => None,
        };
        let moves: Vec<(usize, f64)> = self.actions.iter().zip(to).filter_map(moved).collect();
        if equilibrium::follow(&mut system, x, conditions, &moves).is_ok() {
            return Ok(());
        }
        if depth < DEEPEST && from != to {
            let middle: Vec<f64> = from.iter().zip(to).map(|(a, b)| 0.5 * (a + b)).collect();
            self.go(x, from, &middle, depth + 1)?;
            return self.go(x, &middle, to, depth + 1);
        }
        for (q, by) in moves {
            x[q] += by;
        }
        equilibrium::settle(&mut system, x, conditions)
    }

    /// The row of a balance without its step.
    fn row(&self, x: &[f64], values: &[f64]) -> Vec<f64> {
        let stand = self.stand;
        let speed = speed(self.case, self.actions, values);
        let mut system = stand.system(speed);
        let mut dx = vec![0.0; x.len()];
        system.rhs(0.0, x, &mut dx);
        let mut recorder = Recorder::new(&stand.model, 1);
        recorder.record(&system, 0.0, x, &dx);
        for (i, by) in self.push(values) {
            dx[i] += by;
        }
        let [curvature, cant, gradient] = stand.curve();
        let unbalanced = speed * speed * curvature * cant.cos() - stand.model.gravity * cant.sin();
        let flange_angle = match &stand.model.contact {
            Contact::Profiles { table, .. } => table.flange_angle(),
            Contact::Textbook(_) => f64::NAN,
        };
        let mut row = vec![curvature, cant, gradient, unbalanced, flange_angle];
        for (action, value) in self.actions.iter().zip(values) {
            match action {
                Action::Force { .. } => row.push(*value),
                Action::Displacement(c) => row.push(-c.inertia * dx[c.u]),
                Action::Speed => {}
            }
        }
        let recorded = recorder.into_columns().into_iter().filter(|(name, _)| name != "t");
        row.extend(recorded.map(|(_, values)| values[0]));
        row
    }
}
