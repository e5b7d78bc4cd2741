//! Coulomb friction in a plane under a load: side bearers, centre plates, wear plates.
//!
//! The plate is on body A, its normal one of A's axes; a point of body B slides on it. The load is the elastic normal force
//! `N = max(0, N0 + kn u)`, with `N0` what is carried in the design position (solved where the plate carries weight, else
//! `load`) and `u` how much closer the two have come. Friction is the slider of `friction.rs` in two directions: memory z
//! (a vector in the plane), limit `mu N` of its length, stick stiffness k:
//!
//! ```text
//! F = k P(z),  P(z) = z, at most mu N/k long;    dz/dt = v - (z - P(z))/tau
//! ```
//!
//! Force and normal force come of one potential, `U = Un(u) + Uf(|z|, mu N(u))`, so that no energy is made or lost when the load
//! changes while it slides. For that the normal force carries `mu kn over` beyond N, with `over = |z| - |P(z)| = tau v`: as
//! though the plate stood `mu tau v` higher (0.03 mm at 0.1 m/s).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::friction::{RELAXATION_TIME, slider_energy};
use super::{ForceLaw, Mount, Relative, Wrench, coincident, not_negative, positive};
use crate::error::{Fault, KeyPath};
use crate::math::{Mat3, Vec3};

/// Normal of a plate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Normal {
    /// Along x of the first body.
    X,
    /// Along y of the first body.
    Y,
    /// Along z of the first body: a level plate.
    #[default]
    Z,
}

/// Friction in a plane.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FrictionPlate {
    /// Coefficient of friction.
    #[schemars(extend("minimum" = 0))]
    pub coefficient: f64,
    /// Stick stiffness in the plane, N/m.
    #[schemars(extend("exclusiveMinimum" = 0, "unit" = "N/m"))]
    pub stiffness: f64,
    /// Stiffness along the normal, N/m; 0 keeps the load constant.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "N/m"))]
    pub normal_stiffness: f64,
    /// Clamping load that acts within the element alone, as of a wedge spring, N; beside what it carries.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "N"))]
    pub load: f64,
    /// Axis of the first body that is the plate's normal.
    #[serde(default)]
    pub normal: Normal,
}

/// The plate's state at one instant.
struct Contact {
    /// Closing of the two in the normal direction, m, and the sign of the force on B along the axis.
    closing: f64,
    sign: f64,
    /// Elastic load and its slope.
    n: f64,
    slope: f64,
    /// Slider: vector in the plane, its length, its limit.
    z: Vec3,
    length: f64,
    limit: f64,
    lever: Vec3,
    rate: Vec3,
}

impl FrictionPlate {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        vec![
            Self { coefficient: 0.3, stiffness: 5e6, normal_stiffness: 2e6, load: 0.0, normal: Normal::Z },
            Self { coefficient: 0.2, stiffness: 2e6, normal_stiffness: 0.0, load: 3e4, normal: Normal::Y },
        ]
    }

    fn axes(&self) -> [usize; 3] {
        match self.normal {
            Normal::X => [0, 1, 2],
            Normal::Y => [1, 0, 2],
            Normal::Z => [2, 0, 1],
        }
    }

    #[inline]
    fn contact(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> Contact {
        let [i, j, k] = self.axes();
        let q_B = motion.R_AB * mount.p_B;
        let lever = motion.r_AB + q_B;
        let d = lever - mount.p_A;
        let sign = if mount.preload[i] < 0.0 { -1.0 } else { 1.0 };
        // B is pushed along sign; it comes closer against it.
        let closing = -sign * d[i];
        let carried = mount.preload[i].abs() + self.normal_stiffness * closing;
        let (carried, slope) = if carried > 0.0 { (carried, self.normal_stiffness) } else { (0.0, 0.0) };
        let n = self.load + carried;
        let mut z = Vec3::zeros();
        z[j] = memory[0];
        z[k] = memory[1];
        Contact {
            closing,
            sign,
            n,
            slope,
            z,
            length: z.norm(),
            limit: self.coefficient * n / self.stiffness,
            lever,
            rate: motion.v_AB + motion.w_AB.cross(&q_B),
        }
    }

    /// Energy of the normal spring against the design position, J.
    fn normal_energy(&self, c: &Contact, mount: &Mount) -> f64 {
        let [i, ..] = self.axes();
        let (n0, k) = (mount.preload[i].abs(), self.normal_stiffness);
        if k == 0.0 {
            return n0 * c.closing;
        }
        let lifted = -n0 / k;
        let u = c.closing.max(lifted);
        n0 * u + 0.5 * k * u * u
    }
}

impl ForceLaw for FrictionPlate {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> Wrench {
        let [i, ..] = self.axes();
        let c = self.contact(motion, mount, memory);
        let over = (c.length - c.limit).max(0.0);
        let kept = if over > 0.0 { c.limit / c.length } else { 1.0 };
        let mut f = -self.stiffness * kept * c.z;
        f[i] = c.sign * (c.n - self.load + self.coefficient * c.slope * over);
        Wrench { f, m: c.lever.cross(&f) }
    }

    fn energy(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> f64 {
        let c = self.contact(motion, mount, memory);
        self.normal_energy(&c, mount) + slider_energy(self.stiffness, c.length, c.limit)
    }

    fn dissipation(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> f64 {
        let c = self.contact(motion, mount, memory);
        self.coefficient * c.n * (c.length - c.limit).max(0.0) / RELAXATION_TIME
    }

    fn memory(&self) -> usize {
        2
    }

    #[inline]
    fn memory_rates(&self, motion: &Relative, mount: &Mount, memory: &[f64], rates: &mut [f64]) {
        let [_, j, k] = self.axes();
        let c = self.contact(motion, mount, memory);
        let share = if c.length > c.limit { (1.0 - c.limit / c.length) / RELAXATION_TIME } else { 0.0 };
        rates[0] = c.rate[j] - share * c.z[j];
        rates[1] = c.rate[k] - share * c.z[k];
    }

    fn memory_speed(&self) -> f64 {
        1.0 / RELAXATION_TIME
    }

    fn nominal_stiffness(&self, _between: &Vec3) -> Mat3 {
        let [i, ..] = self.axes();
        let mut k = Mat3::zeros();
        k[(i, i)] = self.normal_stiffness;
        k
    }

    fn settle(&self, mount: &mut Mount, force: Option<&Vec3>) -> Result<(), String> {
        let [i, j, k] = self.axes();
        match force {
            Some(force) if force[j] != 0.0 || force[k] != 0.0 => {
                return Err(format!(
                    "{:.0} N across its normal, which friction does not hold by itself",
                    force[j].hypot(force[k])
                ));
            }
            Some(force) => mount.preload = *force,
            None => {}
        }
        if self.normal_stiffness > 0.0 && mount.preload[i] == 0.0 {
            return Err(
                "no load in the design position, which would tell the side on which it touches".into()
            );
        }
        Ok(())
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        coincident(between, "friction_plate")
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = not_negative(&[self.coefficient], &at.key("coefficient"), "");
        faults.extend(positive(&[self.stiffness], &at.key("stiffness"), "N/m"));
        faults.extend(not_negative(&[self.normal_stiffness], &at.key("normal_stiffness"), "N/m"));
        faults.extend(not_negative(&[self.load], &at.key("load"), "N"));
        faults
    }
}
