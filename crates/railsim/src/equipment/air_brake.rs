//! Air brake of one vehicle: brake pipe, distributor, auxiliary reservoir, cylinder, rigging, blocks.
//!
//! Pressures are gauge pressures, Pa. The pipe follows the driver's valve at a given rate, later by the way of the change along
//! the train; the distributor asks the cylinder for a multiple of the pipe's reduction; cylinders fill and empty like a
//! vessel through an orifice, linearised: first order, exactly between two samples. What fills them is
//! taken from the auxiliary reservoir, which the pipe charges while the brake is released.

use crate::math::interpolate;
use crate::schema::AirBrake;
use crate::schema::drive::Drive;

/// ln 20: first order reaches 95 % after this many time constants.
const TO_95: f64 = 2.995_732_273_553_991;
/// ln 19: from 95 to 5 %.
const TO_5: f64 = 2.944_438_979_166_440_5;

/// Pressures in one vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pneumatics {
    /// Time that a change needs from the driver's valve to here, s.
    delay: f64,
    /// Brake pipe, Pa.
    pub pipe: f64,
    /// Auxiliary reservoir, Pa.
    pub reservoir: f64,
    /// Cylinders, Pa.
    pub cylinder: f64,
}

impl Pneumatics {
    /// Charged, `distance` m of pipe from the driver's valve; what is asked for at the start has been there for long.
    #[must_use]
    pub fn new(data: &AirBrake, distance: f64, drive: &Drive, own: bool) -> Self {
        let full = data.pipe_pressure;
        let mut new = Self { delay: distance / data.propagation, pipe: full, reservoir: full, cylinder: 0.0 };
        let reduction = drive.brake_pipe_reduction.at(0.0);
        new.pipe = (full - reduction).max(0.0);
        let automatic = new.automatic(data);
        // From the reservoir as it was charged: what is in the cylinder has left it.
        let equal = full * data.reservoir_ratio / (1.0 + data.reservoir_ratio);
        let automatic = automatic.min(equal);
        new.reservoir = full - automatic / data.reservoir_ratio;
        let independent = if own { drive.independent_brake.at(0.0).min(data.max_independent) } else { 0.0 };
        new.cylinder = automatic.max(independent);
        new
    }

    /// What the distributor asks for, Pa.
    fn automatic(&self, data: &AirBrake) -> f64 {
        let reduction = data.pipe_pressure - self.pipe;
        if reduction <= data.insensitivity {
            return 0.0;
        }
        (data.distributor_ratio * reduction).min(data.max_cylinder).min(self.reservoir.max(self.cylinder))
    }

    /// Passes from `t - period` to `t`. `independent` (Pa) is what the independent brake or blending asks for.
    pub fn pass(&mut self, data: &AirBrake, drive: &Drive, independent: f64, t: f64, period: f64) {
        let there = t - self.delay;
        let emergency = drive.emergency.is_some_and(|from| there >= from);
        let reduction = if there < 0.0 {
            drive.brake_pipe_reduction.at(0.0)
        } else {
            drive.brake_pipe_reduction.at(there)
        };
        let (target, down) = if emergency {
            (0.0, data.emergency_rate)
        } else {
            ((data.pipe_pressure - reduction).max(0.0), data.service_rate)
        };
        self.pipe += (target - self.pipe).clamp(-down * period, data.release_rate * period);

        let automatic = self.automatic(data);
        let independent = independent.min(data.max_independent);
        let wanted = automatic.max(independent);
        let filling = wanted > self.cylinder;
        let tau = if filling { data.apply_time / TO_95 } else { data.release_time / TO_5 };
        let before = self.cylinder;
        self.cylinder += (wanted - self.cylinder) * (1.0 - (-period / tau).exp());
        if filling && automatic >= independent {
            self.reservoir -= (self.cylinder - before) / data.reservoir_ratio;
        } else if automatic == 0.0 && self.reservoir < self.pipe {
            self.reservoir += (self.pipe - self.reservoir).min(data.release_rate * period);
        }
    }

    /// Force of all blocks of a wheelset, N.
    #[must_use]
    pub fn block_force(&self, data: &AirBrake) -> f64 {
        let piston = (self.cylinder * data.piston_area - data.return_force).max(0.0);
        piston * data.rigging_ratio * data.rigging_efficiency
    }

    /// The cylinder pressure (Pa) that gives a brake force (N) at the rims of `wheelsets` wheelsets at `speed`, m/s.
    #[must_use]
    pub fn pressure_for(data: &AirBrake, force: f64, wheelsets: usize, speed: f64) -> f64 {
        let friction = interpolate(&data.block_friction, speed.abs());
        let block = force / (friction.max(1e-6) * wheelsets as f64);
        if block <= 0.0 {
            return 0.0;
        }
        (block / (data.rigging_ratio * data.rigging_efficiency) + data.return_force) / data.piston_area
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn brake() -> AirBrake {
        serde_json::from_value(json!({
            "pipe_pressure": 5e5, "service_rate": 5e4, "emergency_rate": 5e5, "release_rate": 3e4, "propagation": 250.0,
            "distributor_ratio": 2.5, "insensitivity": 1e4, "max_cylinder": 3.8e5, "max_independent": 3.5e5,
            "reservoir_ratio": 4.0, "apply_time": 4.0, "release_time": 15.0, "piston_area": 0.05, "rigging_ratio": 5.0,
            "rigging_efficiency": 0.9, "return_force": 500.0, "block_friction": [[0.0, 0.3], [30.0, 0.2]]
        }))
        .expect("brake")
    }

    fn drive(value: serde_json::Value) -> Drive {
        serde_json::from_value(value).expect("drive")
    }

    fn run(p: &mut Pneumatics, drive: &Drive, independent: f64, from: f64, to: f64) {
        let n = ((to - from) / 0.01).round() as usize;
        for k in 1..=n {
            p.pass(&brake(), drive, independent, from + 0.01 * k as f64, 0.01);
        }
    }

    #[test]
    fn independent_brake_meets_its_times() {
        let idle = drive(json!({}));
        let mut p = Pneumatics::new(&brake(), 0.0, &idle, true);
        run(&mut p, &idle, 3e5, 0.0, 4.0);
        assert!((p.cylinder / 3e5 - 0.95).abs() < 1e-6);
        run(&mut p, &idle, 0.0, 4.0, 19.0);
        assert!((p.cylinder / 3e5 - 0.05).abs() < 1e-6);
        // 3.0e5 0.05 = 15 kN at the piston, less 0.5: 14.5 kN x 5 x 0.9
        let full = Pneumatics { cylinder: 3e5, ..p };
        assert!((full.block_force(&brake()) - 65_250.0).abs() < 1e-6);
        assert!((Pneumatics::pressure_for(&brake(), 6.0 * 0.3 * 65_250.0, 6, 0.0) - 3e5).abs() < 1e-6);
    }

    #[test]
    fn a_reduction_arrives_later_along_the_pipe_and_is_multiplied() {
        let service = drive(json!({ "brake_pipe_reduction": [[1.0, 1e5]] }));
        let mut front = Pneumatics::new(&brake(), 0.0, &service, true);
        let mut rear = Pneumatics::new(&brake(), 1000.0, &service, false);
        run(&mut front, &service, 0.0, 0.0, 4.0);
        run(&mut rear, &service, 0.0, 0.0, 4.0);
        assert!((front.pipe - 4e5).abs() < 1.0 && rear.pipe == 5e5); // 1000 m at 250 m/s: 4 s later
        run(&mut rear, &service, 0.0, 4.0, 8.0);
        assert!((rear.pipe - 4e5).abs() < 1.0);
        run(&mut front, &service, 0.0, 4.0, 60.0);
        assert!((front.cylinder - 2.5e5).abs() < 10.0);
        // What is in the cylinder has left the reservoir: V_r (p0 - p_r) = V_c p_c.
        assert!((front.reservoir - (5e5 - front.cylinder / 4.0)).abs() < 10.0);
    }

    /// More is asked of the independent brake than it can give: the automatic one fills the cylinder, out of the reservoir.
    #[test]
    fn the_reservoir_gives_what_the_independent_brake_cannot() {
        let both = drive(json!({ "brake_pipe_reduction": [[0.01, 3e5]] }));
        let mut p = Pneumatics::new(&brake(), 0.0, &both, true);
        run(&mut p, &both, 4.5e5, 0.0, 60.0);
        // 3.5e5 Pa of the independent brake, which is the quicker; the last 0.3e5 Pa, as far as max_cylinder, from the reservoir.
        println!("cylinder {:.0} Pa, reservoir {:.0} Pa", p.cylinder, p.reservoir);
        assert!((p.cylinder - 3.8e5).abs() < 10.0 && p.reservoir < 5e5 - 0.3e5 / 4.0 + 10.0);
    }

    #[test]
    fn an_emergency_equalises_reservoir_and_cylinder_and_no_more() {
        let mut small = brake();
        small.max_cylinder = 9e5;
        let vent = drive(json!({ "emergency": 0.0 }));
        let mut p = Pneumatics::new(&small, 0.0, &vent, true);
        for k in 1..=10_000 {
            p.pass(&small, &vent, 0.0, 0.01 * f64::from(k), 0.01);
        }
        assert!(p.pipe == 0.0 && (p.cylinder - 4e5).abs() < 100.0 && (p.reservoir - 4e5).abs() < 100.0);
    }
}
