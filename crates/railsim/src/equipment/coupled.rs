//! What the vehicle's couplers do: forces from the train model or given over time, along the track or at the angle at which couplers
//! stand in curves.
//!
//! A coupler lies in the line between its pivot in the underframe and that of the neighbour's. The neighbour stands with its bogie centres on
//! the track's centre line, a vehicle's length away (what the draft gear gives is left out); in a curve of radius R two equal
//! vehicles have the angle L/(2R) against either body, on an S-curve it follows from where both stand. Pull turns the vehicle's end to
//! the inside of the curve, push to the outside. Both couplers are taken to be at one height: the force has no part along the normal of the track.

use super::train::{OnMass, WAGON};
use super::{Acting, Equipment};
use crate::body::{Kinematics, coordinate};
use crate::dynamics::{Model, Scratch};
use crate::math::{Vec3, interpolate};
use crate::schema::drive::Couplers;
use crate::track::Layout;

/// Front and rear.
pub const ENDS: [f64; 2] = [1.0, -1.0];

/// Couplers at an angle, compiled.
#[derive(Debug, Clone, PartialEq)]
pub struct Angled {
    /// As written.
    pub written: Couplers,
    /// Length of a neighbour over its couplers, m.
    pub length: f64,
    /// Distance of its bogie centres, m.
    pub pivots: f64,
    /// Its couplers above rail, m.
    pub height: f64,
}

impl Angled {
    /// Pivot of the neighbour's coupler at the vehicle's end `end`, inertial axes, m, where the vehicle's pulling face there is at `s` m.
    fn neighbour(&self, layout: &Layout, s: f64, end: f64) -> Vec3 {
        let centre = s + end * 0.5 * self.length;
        let bogies = [0.5, -0.5].map(|half| layout.frame(centre + half * self.pivots));
        let along = (bogies[0].r_IT - bogies[1].r_IT).normalize();
        let down = 0.5 * (bogies[0].R_IT.column(2) + bogies[1].R_IT.column(2));
        let middle = 0.5 * (bogies[0].r_IT + bogies[1].r_IT);
        middle - end * (0.5 * self.length - self.written.shank) * along - self.height * down
    }

    /// Direction in which the coupler at `end` pulls a body whose face there is at `p` from its centre of mass (body axes, m), and the
    /// lever of that force, both in inertial axes.
    fn line(&self, layout: &Layout, k: &Kinematics, s: f64, p: &Vec3, end: f64) -> (Vec3, Vec3) {
        let lever = k.pose.R * (p - Vec3::new(end * self.written.shank, 0.0, 0.0));
        let to = self.neighbour(layout, s, end) - (k.pose.r + lever);
        let normal = k.frame.R_IT.column(2);
        let flat = to - normal * normal.dot(&to);
        (flat.normalize(), lever)
    }

    /// Angle of the coupler at `end` against the body, rad: + where it leads to the vehicle's right.
    fn angle(&self, layout: &Layout, k: &Kinematics, s: f64, p: &Vec3, end: f64) -> f64 {
        let (direction, _) = self.line(layout, k, s, p, end);
        let own = k.pose.R.tr_mul(&direction);
        own.y.atan2(end * own.x)
    }
}

impl Equipment {
    /// The pulling face at an end, from the centre of mass of the coupler's body, body axes, m.
    fn face(&self, end: f64) -> &Vec3 {
        if end > 0.0 { &self.front } else { &self.coupler.1 }
    }
}

impl Acting<'_> {
    /// Place and speed of the vehicle's front and rear pulling faces along the track.
    fn leads(&self, model: &Model, x: &[f64], speed: f64) -> [[f64; 2]; 2] {
        let s = x[model.map().q(self.design.coupler.0).start];
        ENDS.map(|end| [s + self.design.face(end).x, speed])
    }

    /// Puts the train about the vehicle that stands in `x`.
    pub fn place_train(&self, model: &Model, x: &mut [f64]) {
        let Some(train) = &self.design.train else { return };
        let speed = x[model.map().u(self.design.coupler.0).start + coordinate::S];
        let places = self.leads(model, x, speed).map(|lead| lead[0]);
        let at = self.train_at();
        train.place(places, speed, &mut x[at..at + train.states()]);
    }

    /// Commands the efforts of the train's locomotives, each at its own speed.
    pub(super) fn command_locomotives(&mut self, t: f64, x: &[f64]) {
        let Some(train) = &self.design.train else { return };
        let at = self.train_at();
        for (i, mass) in train.masses.iter().enumerate().filter(|(_, mass)| mass.effort > 0.0) {
            let v = x[at + WAGON * i + 1];
            let (traction, braking) = self.references(t, v);
            let forward = if v < 0.0 { -1.0 } else { 1.0 };
            self.efforts[i].command(t, self.lag, mass.effort * (traction - forward * braking));
        }
    }

    /// Forces in both couplers at `t`, on the vehicle; rates of the train's state.
    pub(super) fn couple(&mut self, model: &Model, t: f64, x: &[f64], dx: &mut [f64], scratch: &mut Scratch) {
        let body = self.design.coupler.0;
        let speed = scratch.kinematics[body].s_dot;
        let mut pulls = [0.0; 2];
        if let Some(train) = &self.design.train {
            let at = self.train_at();
            let range = at..at + train.states();
            let on =
                |i: usize| OnMass { brake: self.wagon_brakes[i], effort: self.efforts[i].at(t, self.lag) };
            let leads = self.leads(model, x, speed);
            pulls = train.rates(&model.layout, leads, on, &x[range.clone()], &mut dx[range]);
        }
        if let Some(angled) = &self.design.angled {
            pulls[0] += interpolate(&angled.written.front, t);
            pulls[1] += interpolate(&angled.written.rear, t);
        }
        self.drawbars = pulls;
        let k = scratch.kinematics[body];
        for (pull, end) in pulls.into_iter().zip(ENDS).filter(|(pull, _)| *pull != 0.0) {
            let face = self.design.face(end);
            let (direction, lever) = match &self.design.angled {
                Some(angled) => {
                    let s = x[model.map().q(body).start] + face.x;
                    angled.line(&model.layout, &k, s, face, end)
                }
                None => (k.frame.R_IT.column(0) * end, k.pose.R * face),
            };
            let force = pull * direction;
            scratch.wrench[body].f += force;
            scratch.wrench[body].m += lever.cross(&force);
        }
    }

    /// Angle of the coupler at an end against the car body, rad.
    pub(super) fn coupler_angle(&self, end: f64, model: &Model, x: &[f64], scratch: &Scratch) -> f64 {
        let body = self.design.coupler.0;
        let face = self.design.face(end);
        let s = x[model.map().q(body).start] + face.x;
        self.design
            .angled
            .as_ref()
            .map_or(f64::NAN, |a| a.angle(&model.layout, &scratch.kinematics[body], s, face, end))
    }

    /// The one force of all couplings of the train that `choose` leaves over, N, + pull.
    pub(super) fn drawbar_of(
        &self,
        model: &Model,
        x: &[f64],
        scratch: &Scratch,
        choose: fn(f64, f64) -> f64,
    ) -> f64 {
        let leads = self.leads(model, x, scratch.kinematics[self.design.coupler.0].s_dot);
        let own = &x[self.train_at()..];
        self.design.train.as_ref().map_or(f64::NAN, |train| {
            (0..train.masses.len()).map(|i| train.force(leads, own, i)).fold(f64::NAN, choose)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Pose;
    use crate::error::KeyPath;
    use crate::math::Mat3;
    use crate::track::Segment;

    const LENGTH: f64 = 22.0;
    const PIVOTS: f64 = 13.2;
    const HEIGHT: f64 = 0.9;

    /// A body with its bogie centres on the centre line, centre of mass at the middle of its chord.
    fn standing(layout: &Layout, s: f64) -> Kinematics {
        let ends = [0.5, -0.5].map(|half| layout.frame(s + half * PIVOTS).r_IT);
        let along = (ends[0] - ends[1]).normalize();
        let down = Vec3::z();
        let R = Mat3::from_columns(&[along, down.cross(&along), down]);
        let pose = Pose { R, ..Pose::at(0.5 * (ends[0] + ends[1])) };
        Kinematics { frame: layout.frame(s), pose, ..Kinematics::zero() }
    }

    fn angles(segments: &serde_json::Value, s: f64) -> [f64; 2] {
        let segments: Vec<Segment> = serde_json::from_value(segments.clone()).expect("segments");
        let length = segments.iter().map(Segment::length).sum();
        let layout = Layout::new(&segments, length, &KeyPath::of("track.layout")).expect("layout");
        let written = Couplers {
            shank: 0.75,
            neighbour_length: None,
            neighbour_pivots: None,
            front: vec![],
            rear: vec![],
        };
        let angled = Angled { written, length: LENGTH, pivots: PIVOTS, height: HEIGHT };
        let k = standing(&layout, s);
        ENDS.map(|end| {
            let face = Vec3::new(0.5 * end * LENGTH, 0.0, -HEIGHT);
            angled.angle(&layout, &k, s + face.x, &face, end)
        })
    }

    /// Equal vehicles in a curve: two chords turn by L/R against each other, by symmetry half of it at either, to the inside.
    #[test]
    fn in_a_curve_a_coupler_has_half_the_angle_between_the_vehicles() {
        for radius in [160.0, -300.0] {
            let curve = serde_json::json!([{ "kind": "curve", "length": 200.0, "radius": radius }]);
            for found in angles(&curve, 100.0) {
                assert!((found - LENGTH / (2.0 * radius)).abs() < 1e-9, "{radius}: {found}");
            }
        }
    }

    /// Where a curve turns at once into its opposite both vehicles point the same way, and the line between them is askew: to first order
    /// the ends of two chords stand out of the centre line by (L^2 - B^2)/(8 R) on either side.
    #[test]
    fn on_an_s_curve_a_coupler_is_askew_by_both_throws_over_its_length() {
        let radius = 2000.0;
        let s_curve = serde_json::json!([
            { "kind": "curve", "length": 200.0, "radius": radius }, { "kind": "curve", "length": 200.0, "radius": -radius }
        ]);
        // The vehicle in the first curve, the neighbour ahead in the second; their pulling faces meet at 200 m.
        let [front, _] = angles(&s_curve, 200.0 - 0.5 * LENGTH);
        let pivot = 0.5 * LENGTH - 0.75;
        let out = |x: f64| (4.0 * x * x - PIVOTS * PIVOTS) / (8.0 * radius);
        // Both chords are turned by L/(2 R) against the tangent where the curves meet.
        let by_hand = LENGTH / (2.0 * radius) + 2.0 * out(pivot) / 1.5;
        assert!((front - by_hand).abs() < 0.05 * by_hand, "{front} {by_hand}");
    }
}
