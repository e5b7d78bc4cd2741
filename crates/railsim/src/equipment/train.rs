//! The train: wagons as masses on the design line with draft gear between them.
//!
//! Every wagon has three numbers of state: place of its centre (m), speed (m/s), and how far the friction of the draft gear in front
//! of it is on the side of drawing (+1) or pushing (-1).
//!
//! Draft gear: with u the travel outside the slack, the elastic force k u, plus solid steel beyond the gear's travel;
//! friction wedges add a share of it while the gear is loaded and take the same share off while it is unloaded. The
//! change of side needs a travel of [`TURN`]: `dh/dt = (du/dt)/TURN (1 - h sign(du/dt))`, after Dahl (1968), so that the force is
//! continuous. A gear never pulls while it is pushed.

use crate::equipment::effort::{curve_resistance, davis, direction};
use crate::schema::drive::{DraftGear, Train};
use crate::track::Layout;

/// Travel in which the friction of a draft gear changes sides, m.
const TURN: f64 = 5e-4;
/// Fastest change of sides, 1/s, so that no explicit scheme here is asked for a smaller step.
const FASTEST_TURN: f64 = 500.0;
/// Numbers of state of a wagon.
pub const WAGON: usize = 3;

/// Force of draft gear (N, + pull): elongation `e` (m, 0 in the middle of the slack), its rate (m/s), side of friction `h`.
#[must_use]
pub fn draft_force(gear: &DraftGear, e: f64, rate: f64, h: f64) -> f64 {
    let travel = (e.abs() - 0.5 * gear.slack).max(0.0);
    if travel == 0.0 {
        return 0.0;
    }
    let sign = e.signum();
    let solid = gear.travel.map_or(0.0, |end| gear.solid_stiffness * (travel - end).max(0.0));
    let elastic = sign * (gear.stiffness * travel + solid);
    let whole = elastic + gear.friction * elastic.abs() * h + gear.damping * rate;
    if sign > 0.0 { whole.max(0.0) } else { whole.min(0.0) }
}

/// Energy stored in draft gear, J: the elastic part.
#[must_use]
pub fn draft_energy(gear: &DraftGear, e: f64) -> f64 {
    let travel = (e.abs() - 0.5 * gear.slack).max(0.0);
    let beyond = gear.travel.map_or(0.0, |end| (travel - end).max(0.0));
    0.5 * (gear.stiffness * travel * travel + gear.solid_stiffness * beyond * beyond)
}

/// A train, compiled.
#[derive(Debug, Clone, PartialEq)]
pub struct Wagons {
    /// As written.
    pub written: Train,
    /// m/s2.
    pub gravity: f64,
}

impl Wagons {
    /// Numbers of state.
    #[must_use]
    pub fn states(&self) -> usize {
        WAGON * self.written.wagons as usize
    }

    /// Mass of all wagons, kg.
    #[must_use]
    pub fn mass(&self) -> f64 {
        f64::from(self.written.wagons) * self.written.mass
    }

    /// Distance of the middle of wagon `i` from the coupler in front of the train, m.
    #[must_use]
    pub fn distance(&self, i: usize) -> f64 {
        (i as f64 + 0.5) * self.written.length + (i as f64 + 1.0) * 0.5 * self.written.coupler.slack
    }

    /// Places the train behind a coupler at `place` (m) at `speed` (m/s), drawn out so that every gear just touches.
    pub fn place(&self, place: f64, speed: f64, x: &mut [f64]) {
        for (i, wagon) in x.chunks_exact_mut(WAGON).enumerate() {
            wagon.copy_from_slice(&[place - self.distance(i), speed, 0.0]);
        }
    }

    /// Elongation of the coupling in front of wagon `i` and its rate, with the leading vehicle's coupler at `lead` (m, m/s).
    fn coupling(&self, lead: [f64; 2], x: &[f64], i: usize) -> [f64; 2] {
        let half = 0.5 * self.written.length;
        let front = match i.checked_sub(1) {
            Some(j) => [x[WAGON * j] - half, x[WAGON * j + 1]],
            None => lead,
        };
        [front[0] - x[WAGON * i] - half, front[1] - x[WAGON * i + 1]]
    }

    /// Force in the coupling in front of wagon `i`, N, + pull.
    #[must_use]
    pub fn force(&self, lead: [f64; 2], x: &[f64], i: usize) -> f64 {
        let [e, rate] = self.coupling(lead, x, i);
        draft_force(&self.written.coupler, e, rate, x[WAGON * i + 2])
    }

    /// Rates of the train's state; gives the force on the leading vehicle's coupler, N, + where the train holds it back. `brake` is
    /// the share of the brake force in each wagon.
    pub fn rates(
        &self,
        layout: &Layout,
        lead: [f64; 2],
        brake: impl Fn(usize) -> f64,
        x: &[f64],
        dx: &mut [f64],
    ) -> f64 {
        let Train { mass, rotary_mass, resistance, brake_force, wagons, .. } = self.written;
        let mut pull = self.force(lead, x, 0);
        let first = pull;
        for i in 0..wagons as usize {
            let [s, v] = [x[WAGON * i], x[WAGON * i + 1]];
            let behind = if i + 1 < wagons as usize { self.force(lead, x, i + 1) } else { 0.0 };
            let mut against = brake_force * brake(i);
            if resistance {
                against += davis(mass, v) + curve_resistance(mass, layout.curvature(s));
            }
            let slope = -mass * self.gravity * layout.gradient(s).sin();
            dx[WAGON * i] = v;
            dx[WAGON * i + 1] = (pull - behind + slope - against * direction(v)) / (mass + rotary_mass);
            let [_, rate] = self.coupling(lead, x, i);
            let turn = (rate.abs() / TURN).min(FASTEST_TURN);
            dx[WAGON * i + 2] = turn * (rate.signum() - x[WAGON * i + 2]);
            pull = behind;
        }
        first
    }

    /// Kinetic energy, energy of place and that of the draft gears, J, against an arbitrary zero.
    #[must_use]
    pub fn energy(&self, layout: &Layout, lead: [f64; 2], x: &[f64]) -> f64 {
        let (m, inertia) = (self.written.mass, self.written.mass + self.written.rotary_mass);
        x.chunks_exact(WAGON)
            .enumerate()
            .map(|(i, w)| {
                let height = -layout.frame(w[0]).r_IT.z;
                0.5 * inertia * w[1] * w[1]
                    + m * self.gravity * height
                    + draft_energy(&self.written.coupler, self.coupling(lead, x, i)[0])
            })
            .sum()
    }

    /// Fastest rate of the couplings (rad/s): what limits an explicit scheme's step.
    #[must_use]
    pub fn fastest(&self) -> f64 {
        let gear = &self.written.coupler;
        let solid = if gear.travel.is_some() { gear.solid_stiffness } else { 0.0 };
        let k = (1.0 + gear.friction) * gear.stiffness + solid;
        2.0 * (k / (self.written.mass + self.written.rotary_mass)).sqrt()
    }
}
