//! Coil (flexicoil) or rubber spring between two plates, with shear, bending and their coupling.
//!
//! A spring that is the same seen from either end has a point, at half its height, about which shear and bending do
//! not couple: there the force `ks` per sideways displacement and the moment `kb` per relative turn act independently.
//! Seen from its ends the 6 x 6 stiffness is full: sideways displacement of a plate that stays level gives the moment
//! `ks h/2`, a turned plate the force `ks h/2`. A uniform beam has `ks = 12 EI/h^3`, `kb = EI/h`. For a coil under load,
//! `ks` and `kb` are those under its load (Wahl, Mechanical Springs, 1963, chapter 7); the couple of the load itself on
//! its sideways displacement is shared by both ends (see the bushing).

use nalgebra::Vector6;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bushing_matrix::Coupled;
use super::{ForceLaw, Mount, Relative, Wrench, carry, not_negative};
use crate::error::{Fault, KeyPath};
use crate::math::{Mat3, Vec3};

/// Spring with its axis along z, between plates at `positions`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShearSpring {
    /// Stiffness along its axis, N/m.
    #[schemars(extend("minimum" = 0, "unit" = "N/m"))]
    pub axial: f64,
    /// Stiffness across, with both plates kept level, N/m.
    #[schemars(extend("minimum" = 0, "unit" = "N/m"))]
    pub shear: f64,
    /// Stiffness of the two plates against each other about x and y, N m/rad.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "N m/rad"))]
    pub bending: f64,
    /// The same about its axis, N m/rad.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "unit" = "N m/rad"))]
    pub torsion: f64,
    /// Damping along x, y, z, N s/m.
    #[serde(default)]
    pub damping: [f64; 3],
    /// Where shear and bending do not couple: share of the way from the first end to the second, 0.5 for a spring that
    /// is the same from both ends.
    #[serde(default = "half")]
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    pub shear_centre: f64,
}

fn half() -> f64 {
    0.5
}

impl ShearSpring {
    /// Examples for the contract suite.
    #[must_use]
    pub fn examples() -> Vec<Self> {
        let spring = Self {
            axial: 4.3e5,
            shear: 1.6e5,
            bending: 1.05e4,
            torsion: 2e3,
            damping: [0.0, 3e3, 2e3],
            shear_centre: 0.5,
        };
        vec![spring.clone(), Self { shear_centre: 0.3, ..spring }]
    }

    /// The two levers of the shear centre.
    #[inline]
    fn centre(&self, mount: &Mount) -> (Vec3, Vec3) {
        let c = self.shear_centre;
        (mount.p_A + c * mount.between, mount.p_B - (1.0 - c) * mount.between)
    }

    #[inline]
    fn stiff(&self, q: &Vector6<f64>) -> Vector6<f64> {
        let (s, b) = (self.shear, self.bending);
        Vector6::new(s * q[0], s * q[1], self.axial * q[2], b * q[3], b * q[4], self.torsion * q[5])
    }

    #[inline]
    fn damp(&self, q: &Vector6<f64>) -> Vector6<f64> {
        let [x, y, z] = self.damping;
        Vector6::new(x * q[0], y * q[1], z * q[2], 0.0, 0.0, 0.0)
    }
}

impl ForceLaw for ShearSpring {
    #[inline]
    fn wrench(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> Wrench {
        let (p_A, p_B) = self.centre(mount);
        Coupled::of(motion, &p_A, &p_B)
            .wrench(&motion.R_AB, &p_A, &mount.preload, |q, rate| self.stiff(q) + self.damp(rate))
    }

    fn energy(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        let (p_A, p_B) = self.centre(mount);
        Coupled::of(motion, &p_A, &p_B).energy(&mount.preload, |q| self.stiff(q))
    }

    fn dissipation(&self, motion: &Relative, mount: &Mount, _memory: &[f64]) -> f64 {
        let (p_A, p_B) = self.centre(mount);
        Coupled::of(motion, &p_A, &p_B).dissipation(|rate| self.damp(rate))
    }

    fn nominal_stiffness(&self, _between: &Vec3) -> Mat3 {
        Mat3::from_diagonal(&Vec3::new(self.shear, self.shear, self.axial))
    }

    fn settle(&self, mount: &mut Mount, force: Option<&Vec3>) -> Result<(), String> {
        carry(mount, force);
        Ok(())
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        if between.x.hypot(between.y) <= 1e-3 && between.z.abs() >= 1e-3 {
            return Ok(());
        }
        Err((
            format!("ends {:.3}, {:.3}, {:.3} m apart", between.x, between.y, between.z),
            "`positions` one above the other: the plates of the spring (`axes` turns them)".into(),
        ))
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        let mut faults = not_negative(&[self.axial], &at.key("axial"), "N/m");
        faults.extend(not_negative(&[self.shear], &at.key("shear"), "N/m"));
        faults.extend(not_negative(&[self.bending], &at.key("bending"), "N m/rad"));
        faults.extend(not_negative(&[self.torsion], &at.key("torsion"), "N m/rad"));
        faults.extend(not_negative(&self.damping, &at.key("damping"), "N s/m"));
        if !(0.0..=1.0).contains(&self.shear_centre) {
            faults.push(Fault::new(at.key("shear_centre"), self.shear_centre.to_string(), "0 to 1"));
        }
        faults
    }
}
