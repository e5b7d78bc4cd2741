//! Columns of samples, never filtered.

use crate::connection::{Pair, Relative};
use crate::contact::creep::Creepage;
use crate::contact::geometry_table::Zone;
use crate::dynamics::scratch::Wheel;
use crate::dynamics::{Model, StateMap, VehicleSystem};
use crate::math::Vec3;
use crate::run::channel::{Source, WheelQuantity, plan};

/// Gathers one row at each output time.
#[derive(Debug)]
pub struct Recorder {
    names: Vec<String>,
    sources: Vec<Source>,
    columns: Vec<Vec<f64>>,
    map: StateMap,
}

impl Recorder {
    /// Columns for all channels of a model, with room for `rows`.
    #[must_use]
    pub fn new(model: &Model, rows: usize) -> Self {
        let (names, sources): (Vec<_>, Vec<_>) = plan(model).into_iter().unzip();
        let columns = names.iter().map(|_| Vec::with_capacity(rows)).collect();
        Self { names, sources, columns, map: model.map() }
    }

    /// Takes a row from a system that has just evaluated `dx` at `t`, `x`.
    pub fn record(&mut self, system: &VehicleSystem<'_>, t: f64, x: &[f64], dx: &[f64]) {
        for (source, column) in self.sources.iter().zip(&mut self.columns) {
            column.push(value(*source, system, self.map, t, x, dx));
        }
    }

    /// Names and columns, in order.
    #[must_use]
    pub fn into_columns(self) -> Vec<(String, Vec<f64>)> {
        self.names.into_iter().zip(self.columns).collect()
    }
}

pub(crate) fn value(
    source: Source,
    system: &VehicleSystem<'_>,
    map: StateMap,
    t: f64,
    x: &[f64],
    dx: &[f64],
) -> f64 {
    let (model, scratch) = (system.model, &system.scratch);
    let reference = model.reference();
    match source {
        Source::Time => t,
        Source::Place => model.place(x),
        Source::Speed => dx[map.q(reference).start],
        Source::HoldForce => model.speed_hold.map_or(0.0, |hold| {
            let (s, v) = system.program.at(t);
            let q = map.q(hold.body).start;
            hold.stiffness * (s - x[q]) + hold.damping * (v - dx[q])
        }),
        Source::Coordinate(body, index) => x[map.q(body).start + index],
        Source::TrackMass(w, d) => x[map.track_q(w).start + d],
        Source::Irregularity(i) => {
            let d = &scratch.deviation[0];
            [d.y, d.z, d.cross_level, d.gauge][i]
        }
        Source::SensorPlace(i, axis) => {
            let sensor = &model.sensors[i];
            let k = &scratch.kinematics[sensor.body];
            let p = k.R_TB * sensor.p_B;
            x[map.q(sensor.body).start + axis] + p[axis]
        }
        Source::SensorAcceleration(i, axis) => {
            let sensor = &model.sensors[i];
            let k = &scratch.kinematics[sensor.body];
            let du = &dx[map.u(sensor.body)];
            let a_T = Vec3::new(du[0], du[1], du[2]) + (k.s_dot * k.frame.k_T).cross(&k.v_T);
            let mut turn = Vec3::new(du[3], du[4], du[5]);
            if sensor.body >= map.bodies {
                turn.y = 0.0; // a point on an axle box does not turn with the axle
            }
            let w = k.w_axes;
            let a = k.R_TB.tr_mul(&a_T) + turn.cross(&sensor.p_B) + w.cross(&w.cross(&sensor.p_B));
            a[axis]
        }
        Source::Gap(i) => {
            let gap = &model.gaps[i];
            let [a, b] = gap.bodies.map(|body| &scratch.kinematics[body].pose);
            let between = a.R.tr_mul(&(b.r + b.R * gap.points[1] - a.r)) - gap.points[0];
            between.dot(&gap.direction)
        }
        Source::YawMoment(bogie, car) => yaw_moment(system, x, bogie, car),
        Source::Wheel(w, side, quantity) => wheel_value(&scratch.wheels[w][side], quantity),
        Source::SumLV(w) => {
            let [left, right] = &scratch.wheels[w];
            ratio(left).abs() + ratio(right).abs()
        }
        Source::SumY(w) => {
            let [left, right] = &scratch.wheels[w];
            right.Y - left.Y
        }
        Source::CouplerAngle(end, plane) => model.angled.as_ref().map_or(f64::NAN, |angled| {
            let body = angled.faces.body;
            angled.angles(&model.layout, &scratch.kinematics[body], x[map.q(body).start], end)[plane]
        }),
        Source::Equipment(quantity) => {
            system.acting.as_ref().map_or(f64::NAN, |acting| acting.value(quantity, model, t, x, scratch))
        }
    }
}

/// Moment (N m) that all connections between two bodies put on the first, about its own z axis through its centre of mass.
fn yaw_moment(system: &VehicleSystem<'_>, x: &[f64], on: usize, by: usize) -> f64 {
    let pose = |body: usize| &system.scratch.kinematics[body].pose;
    let between = system.model.links.iter().filter(|link| link.joins(on, by));
    let moments = between.map(|link| {
        let motion = Relative::between(pose(link.a), pose(link.b));
        let pair = Pair::new(&link.wrench(&motion, x), &motion, &pose(link.a).R);
        if link.a == on { pair.on_A.m } else { pair.on_B.m }
    });
    pose(on).R.column(2).dot(&moments.sum::<Vec3>())
}

/// Y/Q; 0 for a wheel without force. A flange that carries without vertical load gives a negative or infinite ratio: that
/// is for a criterion to judge or refuse, not to be hidden here.
fn ratio(wheel: &Wheel) -> f64 {
    if wheel.Q == 0.0 && wheel.Y == 0.0 { 0.0 } else { wheel.Y / wheel.Q }
}

fn wheel_value(wheel: &Wheel, quantity: WheelQuantity) -> f64 {
    use WheelQuantity as W;
    let normal = |part: &dyn Fn(Zone) -> bool| {
        wheel.contacts().iter().filter(|c| c.geometry.is_some_and(|g| part(g.zone))).map(|c| c.normal).sum()
    };
    let main = wheel.contacts().iter().max_by(|a, b| a.normal.total_cmp(&b.normal));
    let creepage = main.map_or(Creepage { xi: 0.0, eta: 0.0, phi: 0.0 }, |c| c.placed.creepage);
    match quantity {
        W::Q => wheel.Q,
        W::Y => wheel.Y,
        W::LV => ratio(wheel),
        W::Shift => wheel.shift,
        W::NTread => normal(&|zone| !zone.is_flange()),
        W::NFlange => normal(&Zone::is_flange),
        W::NSecondTread => normal(&|zone| zone == Zone::SecondTread),
        W::NSecondFlange => normal(&|zone| zone == Zone::SecondFlange),
        W::CreepX => creepage.xi,
        W::CreepY => creepage.eta,
        W::Spin => creepage.phi,
        W::ContactY => main.and_then(|c| c.geometry).map_or(f64::NAN, |g| g.y_wheel),
    }
}
