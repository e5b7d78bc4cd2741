//! The train: wagons and locomotives as masses on the design line with draft gear between them, behind the vehicle and ahead of it.
//!
//! Masses are numbered from the head of the train; the vehicle itself is between two of them or at an end. Each owns the coupling on its side
//! towards the vehicle and has four numbers of state: place of its centre (m), speed (m/s), how far the friction of that coupling's
//! draft gear is on the side of drawing (+1) or pushing (-1), and the deflection of its brake blocks (m).
//!
//! Brake blocks are sliders: a spring of [`STICK`] at full force holds what stands, friction slides beyond the limit. So a braked train stands
//! on a gradient without creeping.
//!
//! Draft gear: with u the travel outside the slack, the elastic force k u, plus solid steel beyond the gear's travel;
//! friction wedges add a share of it while the gear is loaded and take the same share off while it is unloaded. The
//! change of side needs a travel of [`TURN`]: `dh/dt = (du/dt)/TURN (1 - h sign(du/dt))`, after Dahl (1968), so that the force is
//! continuous. A gear never pulls while it is pushed.

use crate::connection::RELAXATION_TIME;
use crate::equipment::effort::{curve_resistance, davis, direction};
use crate::schema::drive::{DraftGear, Train};
use crate::track::Layout;

/// Travel in which the friction of a draft gear changes sides, m.
const TURN: f64 = 5e-4;
/// Fastest change of sides, 1/s, so that no explicit scheme here is asked for a smaller step.
const FASTEST_TURN: f64 = 500.0;
/// Deflection of brake blocks that carry their whole force without sliding, m: small beside what draft gears give, and a mass on it
/// swings no faster than on them.
const STICK: f64 = 1e-3;
/// Damping of blocks that stick, over their stiffness, s: what swings at rest dies away.
const STICK_DAMPING: f64 = 0.02;
/// Numbers of state of a mass.
pub const WAGON: usize = 4;

/// Force of draft gear (N, + pull): elongation `e` (m, 0 in the middle of the slack), its rate (m/s), side of friction `h`. NaN of any of them is
/// NaN: a train that is lost takes the vehicle with it, where the run is ended.
#[must_use]
pub fn draft_force(gear: &DraftGear, e: f64, rate: f64, h: f64) -> f64 {
    let travel = e.abs() - 0.5 * gear.slack;
    if travel <= 0.0 {
        return 0.0;
    }
    let sign = e.signum();
    let solid = gear.travel.map_or(0.0, |end| gear.solid_stiffness * (travel - end).max(0.0));
    let elastic = sign * (gear.stiffness * travel + solid);
    let whole = elastic + gear.friction * elastic.abs() * h + gear.damping * rate;
    if sign * whole < 0.0 { 0.0 } else { whole }
}

/// Energy stored in draft gear, J: the elastic part.
#[must_use]
pub fn draft_energy(gear: &DraftGear, e: f64) -> f64 {
    let travel = (e.abs() - 0.5 * gear.slack).max(0.0);
    let beyond = gear.travel.map_or(0.0, |end| (travel - end).max(0.0));
    0.5 * (gear.stiffness * travel * travel + gear.solid_stiffness * beyond * beyond)
}

/// One mass of the train.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mass {
    /// kg.
    pub mass: f64,
    /// What turning wheelsets add to its inertia, kg.
    pub rotary_mass: f64,
    /// Vehicles that it stands for in the running resistance.
    pub vehicles: f64,
    /// Brake force with its cylinder full, N.
    pub brake_force: f64,
    /// Effort over that of the vehicle's own curves: 0 for a wagon.
    pub effort: f64,
}

/// What acts on a mass beside couplings, gradient and resistance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OnMass {
    /// Share of its brake force.
    pub brake: f64,
    /// Effort of its motors, N, + forward.
    pub effort: f64,
}

/// A train, compiled.
#[derive(Debug, Clone, PartialEq)]
pub struct Wagons {
    /// As written.
    pub written: Train,
    /// m/s2.
    pub gravity: f64,
    /// From the head of the train.
    pub masses: Vec<Mass>,
}

impl Wagons {
    /// A train from what is written, with the acceleration of gravity in m/s2.
    #[must_use]
    pub fn new(written: Train, gravity: f64) -> Self {
        let wagon = Mass {
            mass: written.mass,
            rotary_mass: written.rotary_mass,
            vehicles: f64::from(written.vehicles),
            brake_force: written.brake_force,
            effort: 0.0,
        };
        let mut masses = vec![wagon; written.wagons as usize];
        for own in &written.locomotives {
            if let Some(mass) = masses.get_mut((own.at as usize).saturating_sub(1)) {
                let (own_mass, rotary_mass, effort) = (own.mass, own.rotary_mass, own.effort);
                *mass = Mass { mass: own_mass, rotary_mass, vehicles: 1.0, effort, ..wagon };
            }
        }
        Self { written, gravity, masses }
    }

    /// Numbers of state.
    #[must_use]
    pub fn states(&self) -> usize {
        WAGON * self.masses.len()
    }

    /// Mass of all of it, kg.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.masses.iter().map(|m| m.mass).sum()
    }

    /// How many masses are ahead of the vehicle.
    #[must_use]
    pub fn ahead(&self) -> usize {
        (self.written.ahead as usize).min(self.masses.len())
    }

    /// -1 for a mass ahead of the vehicle, +1 for one behind it.
    fn side(&self, i: usize) -> f64 {
        if i < self.ahead() { -1.0 } else { 1.0 }
    }

    /// The next mass towards the vehicle; `None` where that is the vehicle.
    fn inner(&self, i: usize) -> Option<usize> {
        let ahead = self.ahead();
        if i < ahead { (i + 1 < ahead).then_some(i + 1) } else { (i > ahead).then(|| i - 1) }
    }

    /// The next mass away from the vehicle; `None` at an end of the train.
    fn outer(&self, i: usize) -> Option<usize> {
        if i < self.ahead() { i.checked_sub(1) } else { (i + 1 < self.masses.len()).then_some(i + 1) }
    }

    /// Distance of the middle of mass `i` from the vehicle's coupler on its side, m.
    #[must_use]
    pub fn distance(&self, i: usize) -> f64 {
        let ahead = self.ahead();
        let between = if i < ahead { ahead - 1 - i } else { i - ahead } as f64;
        (between + 0.5) * self.written.length + (between + 1.0) * 0.5 * self.written.coupler.slack
    }

    /// Brake pipe (m) between the driver's valve, in the middle of the vehicle of length `vehicle` (m, over its couplers), and the middle of
    /// mass `i`, ahead of it or behind.
    #[must_use]
    pub fn pipe_length(&self, vehicle: f64, i: usize) -> f64 {
        0.5 * vehicle + self.distance(i)
    }

    /// Places the train at `speed` (m/s) about a vehicle whose front and rear couplers are at `places` (m), drawn out so that every gear
    /// just touches.
    pub fn place(&self, places: [f64; 2], speed: f64, x: &mut [f64]) {
        for (i, mass) in x.chunks_exact_mut(WAGON).enumerate() {
            let from = places[usize::from(i >= self.ahead())];
            mass.copy_from_slice(&[from - self.side(i) * self.distance(i), speed, 0.0, 0.0]);
        }
    }

    /// Elongation of the coupling that mass `i` owns and its rate, with place and speed of the vehicle's front and rear couplers (m, m/s).
    fn coupling(&self, leads: [[f64; 2]; 2], x: &[f64], i: usize) -> [f64; 2] {
        let (side, half) = (self.side(i), 0.5 * self.written.length);
        let inner = match self.inner(i) {
            Some(j) => [x[WAGON * j] - side * half, x[WAGON * j + 1]],
            None => leads[usize::from(i >= self.ahead())],
        };
        [side * (inner[0] - x[WAGON * i]) - half, side * (inner[1] - x[WAGON * i + 1])]
    }

    /// Force in the coupling that mass `i` owns, N, + pull.
    #[must_use]
    pub fn force(&self, leads: [[f64; 2]; 2], x: &[f64], i: usize) -> f64 {
        let [e, rate] = self.coupling(leads, x, i);
        draft_force(&self.written.coupler, e, rate, x[WAGON * i + 2])
    }

    /// Rates of the train's state; gives the forces in the vehicle's front and rear couplings, N, + pull. `acting` says what acts on each
    /// mass.
    pub fn rates(
        &self,
        layout: &Layout,
        leads: [[f64; 2]; 2],
        acting: impl Fn(usize) -> OnMass,
        x: &[f64],
        dx: &mut [f64],
    ) -> [f64; 2] {
        let ahead = self.ahead();
        let mut vehicle = [0.0; 2];
        for (end, nearest) in [(0, ahead.checked_sub(1)), (1, (ahead < self.masses.len()).then_some(ahead))] {
            let mut next = nearest;
            let mut near = nearest.map_or(0.0, |i| self.force(leads, x, i));
            vehicle[end] = near;
            while let Some(i) = next {
                next = self.outer(i);
                let far = next.map_or(0.0, |j| self.force(leads, x, j));
                let pull = self.side(i) * (near - far);
                let [_, rate] = self.coupling(leads, x, i);
                let own = WAGON * i..WAGON * (i + 1);
                self.mass_rates(layout, i, pull, acting(i), rate, &x[own.clone()], &mut dx[own]);
                near = far;
            }
        }
        vehicle
    }

    /// Rates of one mass that its couplings pull forward with `pull`, N; `rate` is that of its own coupling's elongation.
    #[allow(clippy::too_many_arguments)] // one mass of the loop above, which has them all
    fn mass_rates(
        &self,
        layout: &Layout,
        i: usize,
        pull: f64,
        on: OnMass,
        rate: f64,
        x: &[f64],
        dx: &mut [f64],
    ) {
        let Mass { mass, rotary_mass, vehicles, brake_force, .. } = self.masses[i];
        let ([s, v], deflection) = ([x[0], x[1]], x[3]);
        let mut force = pull + on.effort - mass * self.gravity * layout.gradient(s).sin();
        if self.written.resistance {
            let against = davis(mass, vehicles, v) + curve_resistance(mass, layout.curvature(s));
            force -= against * direction(v);
        }
        let (limit, stiffness) = (brake_force * on.brake, brake_force / STICK);
        if stiffness > 0.0 {
            force -= (stiffness * (deflection + STICK_DAMPING * v)).clamp(-limit, limit);
            let held = (stiffness * deflection).clamp(-limit, limit) / stiffness;
            dx[3] = v - (deflection - held) / RELAXATION_TIME;
        } else {
            dx[3] = 0.0;
        }
        dx[0] = v;
        dx[1] = force / (mass + rotary_mass);
        let turn = (rate.abs() / TURN).min(FASTEST_TURN);
        dx[2] = turn * (rate.signum() - x[2]);
    }

    /// Kinetic energy, energy of place and that of the draft gears, J, against an arbitrary zero.
    #[must_use]
    pub fn energy(&self, layout: &Layout, leads: [[f64; 2]; 2], x: &[f64]) -> f64 {
        x.chunks_exact(WAGON)
            .zip(&self.masses)
            .enumerate()
            .map(|(i, (w, m))| {
                let height = -layout.frame(w[0]).r_IT.z;
                0.5 * (m.mass + m.rotary_mass) * w[1] * w[1]
                    + m.mass * self.gravity * height
                    + draft_energy(&self.written.coupler, self.coupling(leads, x, i)[0])
            })
            .sum()
    }

    /// Fastest rate of couplings and brake blocks (rad/s): what limits an explicit scheme's step.
    #[must_use]
    pub fn fastest(&self) -> f64 {
        let gear = &self.written.coupler;
        let solid = if gear.travel.is_some() { gear.solid_stiffness } else { 0.0 };
        let k = (1.0 + gear.friction) * gear.stiffness + solid;
        // The larger root of rate^2 = c/m rate + k/m: sqrt(k/m) without damping, c/m where that rules.
        let rate = |m: &Mass| {
            let mass = m.mass + m.rotary_mass;
            let (block, half) = (m.brake_force / STICK, 0.5 / mass);
            let damped = half * (4.0 * gear.damping + STICK_DAMPING * block);
            damped + (damped * damped + (4.0 * k + block) / mass).sqrt()
        };
        self.masses.iter().map(rate).fold(0.0, f64::max)
    }
}
