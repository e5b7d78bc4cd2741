//! Normal force: Hertz with a dissipation factor that vanishes with the load.
//!
//! `N = C delta^(3/2) (1 + d delta')`, never negative (Hunt and Crossley, J. Appl. Mech. 42 (1975) 440, eq. 8): a dashpot in
//! parallel to the Hertz spring would pull at lift-off and push before touching. `d = c / Q0` gives the dashpot constant
//! `c` at the static wheel load `Q0`.

/// Normal force and its derivatives by penetration and by rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normal {
    /// N, >= 0.
    pub force: f64,
    /// dN/d(delta), N/m.
    pub stiffness: f64,
    /// dN/d(delta'), N s/m.
    pub damping: f64,
}

/// Force at normal penetration `delta` (m, > 0) and approach rate `rate` (m/s) with Hertz constant `hertz` (N/m^1.5)
/// and dissipation factor `d` (s/m).
#[inline(always)]
#[must_use]
pub fn hunt_crossley(hertz: f64, delta: f64, rate: f64, d: f64) -> Normal {
    let root = delta.sqrt();
    let elastic = hertz * delta * root;
    let factor = 1.0 + d * rate;
    if factor <= 0.0 {
        return Normal { force: 0.0, stiffness: 0.0, damping: 0.0 };
    }
    Normal { force: elastic * factor, stiffness: 1.5 * hertz * root * factor, damping: elastic * d }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_match_finite_differences() {
        let (c, delta, rate, d) = (1.1e11, 7.3e-5, -0.02, 0.9);
        let n = hunt_crossley(c, delta, rate, d);
        let h = 1e-9;
        let by_delta = (hunt_crossley(c, delta + h, rate, d).force
            - hunt_crossley(c, delta - h, rate, d).force)
            / (2.0 * h);
        let h = 1e-6;
        let by_rate = (hunt_crossley(c, delta, rate + h, d).force
            - hunt_crossley(c, delta, rate - h, d).force)
            / (2.0 * h);
        assert!((n.stiffness - by_delta).abs() < 1e-6 * by_delta);
        assert!((n.damping - by_rate).abs() < 1e-6 * by_rate);
    }

    #[test]
    fn fast_separation_does_not_pull() {
        assert_eq!(hunt_crossley(1e11, 1e-5, -10.0, 0.9).force, 0.0);
    }
}
