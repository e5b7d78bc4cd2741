//! Effort that a notch of the traction controller or the dynamic brake asks for, over speed.

use crate::math::interpolate;
use crate::schema::{DynamicBrake, Traction};

/// Tractive effort (N, at the rail, of the whole vehicle) of notch `notch` of N at `speed`, m/s.
///
/// Without curves of its own: `(n/N) max_effort`, limited by the power `(n/N)^2 power_at_rail`: a diesel engine gives
/// about the square of the notch's share (Spiryagin, Cole, Sun, McClanachan, Spiryagin, McSweeney, Design and Simulation of Rail
/// Vehicles, CRC Press 2014, chapter on traction; without the linear fall at low speed that some machines have).
#[must_use]
pub fn traction(data: &Traction, notch: f64, speed: f64) -> f64 {
    let last = f64::from(data.notches);
    let (notch, v) = (notch.clamp(0.0, last), speed.abs());
    if notch == 0.0 {
        return 0.0;
    }
    if let Some(curve) = data.notch_curves.get((notch.round().max(1.0) - 1.0) as usize) {
        return interpolate(curve, v);
    }
    let share = notch / last;
    let force = share * data.max_effort;
    let power = share * share * data.power_at_rail;
    if force * v > power { power / v } else { force }
}

/// Braking effort (N, at the rail, of the whole vehicle) of the dynamic brake at `speed` (m/s), `share` of its full effort: level,
/// above one speed at constant power, below another in proportion to speed.
#[must_use]
pub fn dynamic_brake(data: &DynamicBrake, share: f64, speed: f64) -> f64 {
    let kmh = 3.6 * speed.abs();
    let power = if kmh > data.constant_power_above_kmh { data.constant_power_above_kmh / kmh } else { 1.0 };
    let fade = if kmh < data.fade_below_kmh { kmh / data.fade_below_kmh } else { 1.0 };
    share * data.max_effort * power * fade
}

/// Running resistance (N) of `vehicles` vehicles of `mass` in all (kg) at `speed` (m/s): modified Davis (AAR RP-548), per tonne
/// `6.5 + 320/(w n) + 0.046 v + 0.096 v^2/(w n)` N with w tonnes on each of n axles and v in km/h; w n is a vehicle's mass, so
/// that two of the terms go by vehicles.
#[must_use]
pub fn davis(mass: f64, vehicles: f64, speed: f64) -> f64 {
    let (tonnes, kmh) = (1e-3 * mass, 3.6 * speed.abs());
    tonnes * (6.5 + 0.046 * kmh) + vehicles * (320.0 + 0.096 * kmh * kmh)
}

/// Curve resistance (N) of a vehicle of `mass` (kg) in a curve of `curvature` (1/m): 0.8 lb per short ton and degree of curve
/// (AREMA Manual for Railway Engineering, chapter 16), a degree being 1/1746.4 m, so 6850 N/t over the radius in m.
#[must_use]
pub fn curve_resistance(mass: f64, curvature: f64) -> f64 {
    1e-3 * mass * 6850.0 * curvature.abs()
}

/// Below this speed (m/s) resistance falls with the speed, so that it does not push what stands.
const STANDING: f64 = 0.01;

/// Direction of a resistance at `speed`: -1 to 1, level beyond 1 cm/s.
#[inline]
#[must_use]
pub fn direction(speed: f64) -> f64 {
    (speed / STANDING).clamp(-1.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn locomotive() -> Traction {
        serde_json::from_value(serde_json::json!({
            "max_effort": 450e3, "power_at_rail": 2.6e6, "notches": 8, "slip_reference": 0.05, "slip_limit": 0.2,
            "kp": 2e5, "ki": 4e5, "lag": 0.05
        }))
        .expect("traction")
    }

    #[test]
    fn notch_curves_are_level_then_of_constant_power() {
        let data = locomotive();
        assert_eq!(traction(&data, 8.0, 1.0), 450e3);
        assert!((traction(&data, 8.0, 22.0 / 3.6) - 2.6e6 * 3.6 / 22.0).abs() < 1e-6); // 425 kN
        assert!((traction(&data, 4.0, 20.0) - 0.25 * 2.6e6 / 20.0).abs() < 1e-9);
        assert_eq!(traction(&data, 0.0, 20.0), 0.0);
        let own = Traction { notches: 1, notch_curves: vec![vec![[0.0, 1e5], [10.0, 5e4]]], ..data };
        assert_eq!(traction(&own, 1.0, 5.0), 7.5e4);
        assert_eq!(traction(&own, 1.0, 50.0), 5e4);
    }

    #[test]
    fn dynamic_brake_has_a_plateau_a_power_limit_and_a_fade() {
        let data = DynamicBrake {
            max_effort: 325e3,
            fade_below_kmh: 5.0,
            constant_power_above_kmh: 43.0,
            rotary_mass_equivalent: 0.0,
        };
        for (kmh, effort) in [(2.5, 162.5e3), (5.0, 325e3), (43.0, 325e3), (86.0, 162.5e3), (0.0, 0.0)] {
            assert!((dynamic_brake(&data, 1.0, kmh / 3.6) - effort).abs() < 1e-6, "{kmh}");
        }
    }

    /// 1634 t at 43 km/h by hand: 1634 (6.5 + 0.046 43) = 13.853 kN, and 320 + 0.096 43^2 = 497.5 N for each vehicle.
    #[test]
    fn resistance_of_a_train() {
        assert!((davis(1634e3, 1.0, 43.0 / 3.6) - 14_350.6).abs() < 1.0);
        assert!((davis(1634e3, 21.0, 43.0 / 3.6) - (13_853.05 + 21.0 * 497.504)).abs() < 1.0);
        assert!((curve_resistance(100e3, 1.0 / 685.0) - 1000.0).abs() < 1e-9);
    }
}
