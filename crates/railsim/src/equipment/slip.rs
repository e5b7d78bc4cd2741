//! Slip control: what is measured, what is asked for, what the inverter makes of it.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use crate::schema::drive::Observer;

/// Slip is formed with at least this speed (m/s), so that it stays finite at rest.
pub const LEAST_SPEED: f64 = 1.0;

/// Axle speeds as the controller sees them.
#[derive(Debug, Clone)]
pub struct SlipObserver {
    noise: f64,
    factor: Vec<f64>,
    source: ChaCha8Rng,
}

impl SlipObserver {
    /// An observer of `axles` axles.
    #[must_use]
    pub fn new(written: &Observer, axles: usize) -> Self {
        let factor =
            (0..axles).map(|w| 1.0 + written.diameter_error.get(w).copied().unwrap_or(0.0)).collect();
        Self { noise: written.noise, factor, source: ChaCha8Rng::seed_from_u64(written.seed) }
    }

    /// Rim speed (m/s) as measured, of axle `w` with the true one `rim`.
    pub fn rim_speed(&mut self, w: usize, rim: f64) -> f64 {
        let noise = if self.noise > 0.0 { self.noise * self.normal() } else { 0.0 };
        rim * self.factor[w] + noise
    }

    /// A normal deviate (Box and Muller 1958).
    fn normal(&mut self) -> f64 {
        let mut uniform = || ((self.source.next_u64() >> 11) as f64 + 0.5) / (1u64 << 53) as f64;
        let (u, v): (f64, f64) = (uniform(), uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}

/// Slip of a rim against the vehicle, 1; positive where the wheel is faster. All speeds m/s.
#[must_use]
pub fn slip(rim: f64, speed: f64) -> f64 {
    (rim - speed) / speed.abs().max(LEAST_SPEED)
}

/// Gains of a slip controller, for one axle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    /// N m per unit slip.
    pub kp: f64,
    /// N m per unit slip and second.
    pub ki: f64,
}

/// PI controller of the slip that never asks for more than the torque reference.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SlipController {
    integral: f64,
}

impl SlipController {
    /// Torque (N m, each axle, >= 0) after one sample: `error` is the slip asked for minus the slip found, `reference` the
    /// torque that is asked for (the limiter). The integral is kept where the torque just stays between 0 and the
    /// reference, so that it does not wind up while the limiter holds.
    pub fn sample(&mut self, gains: &Gains, error: f64, reference: f64, period: f64) -> f64 {
        let proportional = gains.kp * error;
        self.integral = (self.integral + gains.ki * error * period)
            .clamp((-proportional).min(0.0), (reference - proportional).max(0.0));
        (proportional + self.integral).clamp(0.0, reference)
    }

    /// Forgets, as when nothing is asked for.
    pub fn reset(&mut self) {
        self.integral = 0.0;
    }
}

/// First-order lag of inverter and motor between two samples: `tau dT/dt = command - T`, exactly.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Lag {
    from: f64,
    command: f64,
    since: f64,
}

impl Lag {
    /// What there is at time `t` (s) with the time constant `tau` (s).
    #[inline]
    #[must_use]
    pub fn at(&self, t: f64, tau: f64) -> f64 {
        if tau <= 0.0 {
            return self.command;
        }
        self.command + (self.from - self.command) * (-(t - self.since) / tau).exp()
    }

    /// A new command from time `t` on.
    pub fn command(&mut self, t: f64, tau: f64, command: f64) {
        *self = Self { from: self.at(t, tau), command, since: t };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lag_is_the_exponential_whatever_the_samples() {
        let (tau, mut lag) = (0.05, Lag::default());
        lag.command(0.0, tau, 1000.0);
        assert!((lag.at(0.05, tau) - 1000.0 * (1.0 - (-1.0_f64).exp())).abs() < 1e-9);
        let direct = lag.at(0.1, tau);
        for k in 1..10 {
            lag.command(0.01 * f64::from(k), tau, 1000.0);
        }
        assert!((lag.at(0.1, tau) - direct).abs() < 1e-9);
    }

    #[test]
    fn torque_stays_between_nothing_and_its_reference_and_does_not_wind_up() {
        let gains = Gains { kp: 2e5, ki: 4e5 };
        let mut controller = SlipController::default();
        for _ in 0..10_000 {
            let torque = controller.sample(&gains, 0.05, 20e3, 0.01);
            assert!((0.0..=20e3).contains(&torque));
        }
        assert_eq!(controller.sample(&gains, 0.05, 20e3, 0.01), 20e3);
        // After 100 s at the limiter the first sample with too much slip takes torque off.
        assert!(controller.sample(&gains, -0.05, 20e3, 0.01) < 15e3);
        // And none of it is ever negative.
        for _ in 0..1000 {
            assert!(controller.sample(&gains, -1.0, 20e3, 0.01) >= 0.0);
        }
        assert!(controller.sample(&gains, 0.05, 20e3, 0.01) > 0.0);
    }

    #[test]
    fn noise_has_its_deviation_and_its_seed() {
        let written = Observer { noise: 0.02, seed: 3, diameter_error: vec![0.0, 0.01] };
        let mut observer = SlipObserver::new(&written, 2);
        let readings: Vec<f64> = (0..20_000).map(|_| observer.rim_speed(0, 6.0)).collect();
        let mean = readings.iter().sum::<f64>() / 2e4;
        let deviation = (readings.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / 2e4).sqrt();
        assert!((mean - 6.0).abs() < 5e-4 && (deviation - 0.02).abs() < 4e-4, "{mean} {deviation}");
        assert_eq!(SlipObserver::new(&written, 2).rim_speed(0, 6.0), readings[0]);
        let exact = Observer { noise: 0.0, ..written };
        assert!((SlipObserver::new(&exact, 2).rim_speed(1, 6.0) - 6.06).abs() < 1e-12);
    }
}
