//! What the vehicle's couplers do: where they point, and forces in them from the train model or given over time, along the track or at the
//! angle at which couplers stand in curves.
//!
//! A coupler lies in the line between its pivot in the underframe and that of the neighbour's. The neighbour stands with its bogie centres on
//! the track's centre line, a vehicle's length away, its couplers as high as the vehicle's own (what the draft gear gives is left out). Two equal
//! vehicles have the angle L/(2R) against either body in a curve, in plan or over a hump; elsewhere it follows from where both stand. Pull turns
//! the vehicle's end to the inside of the curve, push to the outside. The force has no part along the normal of the track.

use super::Acting;
use super::train::{OnMass, WAGON};
use crate::body::{Kinematics, coordinate};
use crate::dynamics::{Model, Scratch};
use crate::math::{Vec3, interpolate, rotation};
use crate::schema::drive::Couplers;
use crate::track::Layout;

/// Front and rear.
pub const ENDS: [f64; 2] = [1.0, -1.0];

/// The vehicle's pulling faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Faces {
    /// Index of the body that they are on.
    pub body: usize,
    /// The front and the rear one from its centre of mass, body axes, m.
    pub places: [Vec3; 2],
}

/// Couplers at an angle, compiled.
#[derive(Debug, Clone, PartialEq)]
pub struct Angled {
    /// As written.
    pub written: Couplers,
    /// The vehicle's own.
    pub faces: Faces,
    /// Length of a neighbour over its couplers, m.
    pub length: f64,
    /// Distance of its bogie centres, m.
    pub pivots: f64,
    /// Its couplers above rail, m.
    pub height: f64,
}

impl Angled {
    /// Puts the neighbours' couplers as high as the vehicle's own are on straight track in the state `q` of their body.
    pub fn level_with(&mut self, q: &[f64]) {
        let middle = 0.5 * (self.faces.places[0] + self.faces.places[1]);
        let turned = rotation::rot_x(q[coordinate::PHI]) * rotation::rot_y(q[coordinate::THETA]) * middle;
        self.height = -(q[coordinate::Z] + turned.z);
    }

    /// Pivot of the neighbour's coupler at the vehicle's end `end` (0 front, 1 rear), inertial axes, m, where the vehicle's body is at `s` m.
    fn neighbour(&self, layout: &Layout, s: f64, end: usize) -> Vec3 {
        let way = ENDS[end];
        let centre = s + self.faces.places[end].x + way * 0.5 * self.length;
        let bogies = [0.5, -0.5].map(|half| layout.frame(centre + half * self.pivots));
        let along = (bogies[0].r_IT - bogies[1].r_IT).normalize();
        let down = (bogies[0].R_IT.column(2) + bogies[1].R_IT.column(2)).normalize();
        let middle = 0.5 * (bogies[0].r_IT + bogies[1].r_IT);
        middle - way * (0.5 * self.length - self.written.shank) * along - self.height * down
    }

    /// From the pivot of the coupler at `end` to the neighbour's, and from the body's centre of mass to that pivot, inertial axes, m.
    fn reach(&self, layout: &Layout, k: &Kinematics, s: f64, end: usize) -> [Vec3; 2] {
        let shank = Vec3::new(ENDS[end] * self.written.shank, 0.0, 0.0);
        let lever = k.pose.R * (self.faces.places[end] - shank);
        [self.neighbour(layout, s, end) - (k.pose.r + lever), lever]
    }

    /// Direction in which the coupler at `end` pulls the body that is at `s` m, and the lever of that force, both in inertial axes.
    fn line(&self, layout: &Layout, k: &Kinematics, s: f64, end: usize) -> (Vec3, Vec3) {
        let [to, lever] = self.reach(layout, k, s, end);
        let normal = k.frame.R_IT.column(2);
        let flat = to - normal * normal.dot(&to);
        (flat.normalize(), lever)
    }

    /// Angles of the coupler at `end` against the body that is at `s` m, rad: sideways, + where it leads to the vehicle's right; up and
    /// down, + where it leads up.
    #[must_use]
    pub fn angles(&self, layout: &Layout, k: &Kinematics, s: f64, end: usize) -> [f64; 2] {
        let own = k.pose.R.tr_mul(&self.reach(layout, k, s, end)[0]);
        let away = ENDS[end] * own.x;
        [own.y.atan2(away), (-own.z).atan2(away)]
    }
}

impl Acting<'_> {
    /// Place and speed of the vehicle's front and rear pulling faces along the track.
    fn leads(&self, model: &Model, x: &[f64], speed: f64) -> [[f64; 2]; 2] {
        let Faces { body, places } = self.design.faces;
        let s = x[model.map().q(body).start];
        places.map(|face| [s + face.x, speed])
    }

    /// Puts the train about the vehicle that stands in `x`.
    pub fn place_train(&self, model: &Model, x: &mut [f64]) {
        let Some(train) = &self.design.train else { return };
        let speed = x[model.map().u(self.design.faces.body).start + coordinate::S];
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
        let body = self.design.faces.body;
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
        if let Some(angled) = &model.angled {
            pulls[0] += interpolate(&angled.written.front, t);
            pulls[1] += interpolate(&angled.written.rear, t);
        }
        self.drawbars = pulls;
        let k = scratch.kinematics[body];
        for (end, pull) in pulls.into_iter().enumerate().filter(|(_, pull)| *pull != 0.0) {
            let (direction, lever) = match &model.angled {
                Some(angled) => angled.line(&model.layout, &k, x[model.map().q(body).start], end),
                None => (k.frame.R_IT.column(0) * ENDS[end], k.pose.R * self.design.faces.places[end]),
            };
            let force = pull * direction;
            scratch.wrench[body].f += force;
            scratch.wrench[body].m += lever.cross(&force);
        }
    }

    /// The one force of all couplings of the train that `choose` leaves over, N, + pull.
    pub(super) fn drawbar_of(
        &self,
        model: &Model,
        x: &[f64],
        scratch: &Scratch,
        choose: fn(f64, f64) -> f64,
    ) -> f64 {
        let leads = self.leads(model, x, scratch.kinematics[self.design.faces.body].s_dot);
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
    const SHANK: f64 = 0.75;

    /// A body with its bogie centres on the centre line, centre of mass at the middle of its chord.
    fn standing(layout: &Layout, s: f64) -> Kinematics {
        let ends = [0.5, -0.5].map(|half| layout.frame(s + half * PIVOTS).r_IT);
        let along = (ends[0] - ends[1]).normalize();
        let right = Vec3::z().cross(&along).normalize();
        let R = Mat3::from_columns(&[along, right, along.cross(&right)]);
        let pose = Pose { R, ..Pose::at(0.5 * (ends[0] + ends[1])) };
        Kinematics { frame: layout.frame(s), pose, ..Kinematics::zero() }
    }

    /// Yaw and pitch of both couplers of a vehicle whose middle is at `s`, its neighbours like it.
    fn angles(segments: &serde_json::Value, s: f64) -> [[f64; 2]; 2] {
        let segments: Vec<Segment> = serde_json::from_value(segments.clone()).expect("segments");
        let length = segments.iter().map(Segment::length).sum();
        let layout = Layout::new(&segments, length, &KeyPath::of("track.layout")).expect("layout");
        let written = Couplers {
            shank: SHANK,
            neighbour_length: None,
            neighbour_pivots: None,
            front: vec![],
            rear: vec![],
        };
        let faces = Faces { body: 0, places: ENDS.map(|end| Vec3::new(0.5 * end * LENGTH, 0.0, -HEIGHT)) };
        let angled = Angled { written, faces, length: LENGTH, pivots: PIVOTS, height: HEIGHT };
        let k = standing(&layout, s);
        [0, 1].map(|end| angled.angles(&layout, &k, s, end))
    }

    /// A vertical curve of 200 m between level track and a gradient, from 100 m on, and its radius: + a dip.
    fn vertical(gradient: f64) -> (serde_json::Value, f64) {
        let layout = serde_json::json!([
            { "kind": "tangent", "length": 100.0 }, { "kind": "clothoid", "length": 200.0 },
            { "kind": "tangent", "length": 100.0, "gradient": gradient }
        ]);
        (layout, 200.0 / gradient.atan())
    }

    /// Equal vehicles in a curve: two chords turn by L/R against each other, by symmetry half of it at either, to the inside.
    #[test]
    fn in_a_curve_a_coupler_has_half_the_angle_between_the_vehicles() {
        for radius in [160.0, -300.0] {
            let curve = serde_json::json!([{ "kind": "curve", "length": 200.0, "radius": radius }]);
            for [yaw, pitch] in angles(&curve, 100.0) {
                assert!((yaw - LENGTH / (2.0 * radius)).abs() < 1e-9, "{radius}: {yaw}");
                assert!(pitch.abs() < 1e-9, "{radius}: {pitch}");
            }
        }
    }

    /// The same in elevation: over a hump both couplers lead down, through a dip up.
    #[test]
    fn in_a_vertical_curve_too() {
        for gradient in [0.1, -0.1] {
            let (layout, radius) = vertical(gradient);
            for [yaw, pitch] in angles(&layout, 200.0) {
                assert!((pitch - LENGTH / (2.0 * radius)).abs() < 1e-9, "{radius}: {pitch}");
                assert!(yaw.abs() < 1e-9, "{radius}: {yaw}");
            }
        }
    }

    /// On level track up to where a vertical curve begins, the neighbour ahead wholly on it: to first order the curve has left the level by
    /// x^2/(2 R), the chord between the neighbour's bogie centres at (L -+ B)/2 by (L x - (L^2 - B^2)/4)/(2 R). At its pivot that is on the other
    /// side than the curve, and the level vehicle's coupler, of twice the shank, leads there: up where a hump begins.
    #[test]
    fn where_a_vertical_curve_begins_a_coupler_leads_the_other_way() {
        for gradient in [0.1, -0.1] {
            let (layout, radius) = vertical(gradient);
            let [front, rear] = angles(&layout, 100.0 - 0.5 * LENGTH);
            let at_pivot = (LENGTH * SHANK - 0.25 * (LENGTH * LENGTH - PIVOTS * PIVOTS)) / (2.0 * radius);
            let by_hand = at_pivot / (2.0 * SHANK);
            assert!(by_hand * gradient < 0.0, "{by_hand}");
            assert!((front[1] - by_hand).abs() < 0.02 * by_hand.abs(), "{} {by_hand}", front[1]);
            assert!(
                front[0].abs() < 1e-9 && rear.iter().all(|angle| angle.abs() < 1e-9),
                "{front:?} {rear:?}"
            );
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
        let [[front, _], _] = angles(&s_curve, 200.0 - 0.5 * LENGTH);
        let pivot = 0.5 * LENGTH - SHANK;
        let out = |x: f64| (4.0 * x * x - PIVOTS * PIVOTS) / (8.0 * radius);
        // Both chords are turned by L/(2 R) against the tangent where the curves meet.
        let by_hand = LENGTH / (2.0 * radius) + out(pivot) / SHANK;
        assert!((front - by_hand).abs() < 0.05 * by_hand, "{front} {by_hand}");
    }
}
