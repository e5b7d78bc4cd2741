//! Thermal state of traction motors: one body, heated by the square of the effort.

use crate::schema::Thermal;

/// Temperature rise as a share of what the continuous rating gives: 1 is the limit.
///
/// `tau d(theta)/dt = (F/F_continuous)^2 - theta`. The short-time rating fixes tau: from cold, the short-time effort reaches 1 after the
/// short time, so `tau = -t / ln(1 - (F_continuous/F_short)^2)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motor {
    continuous: f64,
    tau: f64,
    theta: f64,
}

impl Motor {
    /// A cold motor that carries `share` of the vehicle's rated effort.
    #[must_use]
    pub fn new(rating: &Thermal, share: f64) -> Self {
        let ratio = rating.continuous_effort / rating.short_time_effort;
        let tau = -rating.short_time / (1.0 - ratio * ratio).ln();
        Self { continuous: share * rating.continuous_effort, tau, theta: 0.0 }
    }

    /// Temperature rise, share of the limit.
    #[must_use]
    pub fn temperature(&self) -> f64 {
        self.theta
    }

    /// Passes `period` seconds at `effort`, N.
    pub fn pass(&mut self, effort: f64, period: f64) {
        let load = effort / self.continuous;
        self.theta += (load * load - self.theta) * (1.0 - (-period / self.tau).exp());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ratings_are_met() {
        let rating = Thermal { continuous_effort: 300e3, short_time_effort: 400e3, short_time: 600.0 };
        let mut motor = Motor::new(&rating, 0.5);
        for _ in 0..6000 {
            motor.pass(200e3, 0.1);
        }
        assert!((motor.temperature() - 1.0).abs() < 1e-9);
        let mut motor = Motor::new(&rating, 0.5);
        for _ in 0..100_000 {
            motor.pass(150e3, 0.1);
        }
        assert!((motor.temperature() - 1.0).abs() < 1e-3 && motor.temperature() <= 1.0);
    }
}
