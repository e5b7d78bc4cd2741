//! Connections: force elements between two body-fixed points.
//!
//! A law gives equal and opposite wrenches on its two ends, the energy that it stores and the power that it
//! dissipates; an energy audit of a whole run then finds most sign errors. The family is closed: one arm of
//! [`Law`] and one file for each kind.
//!
//! Some laws remember: a damper with end stiffness how far that is drawn, friction how far it has given way before it
//! slides. They say how many numbers that takes ([`ForceLaw::memory`]); these stand at the end of the state vector,
//! every function of the law is given them, and [`ForceLaw::memory_rates`] gives their derivatives, so that every
//! integrator, the linearisation and the energy audit treat them as any other state. All are elastic elongations, zero
//! where the connection carries nothing at rest: a vehicle in equilibrium has zeros there.

pub mod along;
mod anti_roll_bar;
mod bump_stop;
mod bushing;
mod bushing_matrix;
mod coupler;
mod friction;
mod friction_plate;
pub mod lanes;
mod maxwell;
mod point_damper;
mod point_spring;
mod shear_spring;
mod traction_rod;

pub use along::Along;
pub use anti_roll_bar::AntiRollBar;
pub use bump_stop::BumpStop;
pub use bushing::Bushing;
pub use bushing_matrix::BushingMatrix;
pub use coupler::Coupler;
pub use friction::{Friction, RELAXATION_TIME};
pub use friction_plate::FrictionPlate;
pub use maxwell::Maxwell;
pub use point_damper::PointDamper;
pub use point_spring::PointSpring;
pub use shear_spring::ShearSpring;
pub use traction_rod::TractionRod;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use crate::body::{Pose, Relative, Wrench};
use crate::error::{Fault, KeyPath};
use crate::math::{Mat3, Vec3};

/// Where a connection is fixed, and what it carries in the design position. All in the connection's own axes, which are
/// the bodies' unless it says otherwise.
#[derive(Debug, Clone, Copy)]
pub struct Mount {
    /// Point on body A from its centre of mass, m.
    pub p_A: Vec3,
    /// Point on body B from its centre of mass, m.
    pub p_B: Vec3,
    /// From A's point to B's in the design position, m.
    pub between: Vec3,
    /// Force on B in the design position, N (on A the opposite), of laws with three directions.
    pub preload: Vec3,
    /// Elongation in the design position against the free length, m, of laws with one direction.
    pub stretched: f64,
}

impl Mount {
    /// Without preload.
    #[must_use]
    pub fn new(p_A: Vec3, p_B: Vec3, between: Vec3) -> Self {
        Self { p_A, p_B, between, preload: Vec3::zeros(), stretched: 0.0 }
    }
}

/// What a law does to its two ends, inertial axes.
#[derive(Debug, Clone, Copy)]
pub struct Pair {
    /// On body A.
    pub on_A: Wrench,
    /// On body B.
    pub on_B: Wrench,
}

impl Pair {
    /// From the wrench on B about A's centre of mass in A's axes, as [`ForceLaw::wrench`] gives it.
    #[inline(always)]
    #[must_use]
    pub fn new(on_B_about_A: &Wrench, motion: &Relative, R_IA: &Mat3) -> Self {
        let f = R_IA * on_B_about_A.f;
        let m = on_B_about_A.m;
        Self {
            on_A: Wrench { f: -f, m: -(R_IA * m) },
            on_B: Wrench { f, m: R_IA * (m - motion.r_AB.cross(&on_B_about_A.f)) },
        }
    }
}

/// The contract of a force law. It knows the motion of body B as seen from body A, in A's axes, and what it remembers: so it
/// cannot depend on where the two are, and gives equal and opposite forces with balanced moments by construction.
pub trait ForceLaw {
    /// Force on B (N) and its moment about A's centre of mass (N m), in A's axes; on A the opposite.
    fn wrench(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> Wrench;
    /// Stored energy, J, zero in the design position; the preload's work is part of it.
    fn energy(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> f64;
    /// Dissipated power, W, never negative.
    fn dissipation(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> f64;
    /// Numbers that the law remembers.
    fn memory(&self) -> usize {
        0
    }
    /// Rates of what it remembers, written to `rates`.
    fn memory_rates(&self, _motion: &Relative, _mount: &Mount, _memory: &[f64], _rates: &mut [f64]) {}
    /// Fastest rate at which the memory alone can settle, 1/s: a step has to follow it in every state, not only in the
    /// one in which the vehicle is linearised.
    fn memory_speed(&self) -> f64 {
        0.0
    }
    /// Translational stiffness in the design position, N/m, with which preloads are shared out; zero, as here, for a law
    /// that cannot carry.
    fn nominal_stiffness(&self, _between: &Vec3) -> Mat3 {
        Mat3::zeros()
    }
    /// Sets what `mount` carries in the design position: `force` on B (N) where one has been solved for it, else what
    /// the law itself says (its free length).
    ///
    /// # Errors
    /// What the law cannot carry, in words.
    fn settle(&self, _mount: &mut Mount, force: Option<&Vec3>) -> Result<(), String> {
        match force {
            Some(force) => Err(format!("{:.0} N on a kind that carries nothing at rest", force.norm())),
            None => Ok(()),
        }
    }
    /// The ends that the law asks for; what is wrong with them, as found and allowed.
    fn check_ends(&self, _between: &Vec3) -> Result<(), (String, String)> {
        Ok(())
    }
    /// Parameters outside their range, by key below `at`.
    fn faults(&self, at: &KeyPath) -> Vec<Fault>;
}

macro_rules! family {
    ($($(#[$doc:meta])* $kind:ident = $name:literal,)*) => {
        /// Every kind of connection, as written: the table's `kind` names the arm.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        #[serde(tag = "kind", rename_all = "snake_case")]
        pub enum Law {
            $($(#[$doc])* $kind($kind),)*
        }

        /// The kinds that [`Law`] knows, sorted.
        pub const KINDS: &[&str] = &[$($name),*];

        macro_rules! each {
            ($self:ident, $law:ident => $call:expr) => {
                match $self {
                    $(Law::$kind($law) => $call,)*
                }
            };
        }

        impl Law {
            /// One or more examples of every arm, for the contract suite.
            #[must_use]
            pub fn examples() -> Vec<Self> {
                let mut all = Vec::new();
                $(all.extend($kind::examples().into_iter().map(Self::$kind));)*
                all
            }

            /// The kind, as written.
            #[must_use]
            pub fn kind(&self) -> &'static str {
                match self {
                    $(Self::$kind(_) => $name,)*
                }
            }
        }
    };
}

// Keep this list sorted.
family! {
    /// Torsion bar between a bogie and a body that roll against each other.
    AntiRollBar = "anti_roll_bar",
    /// Stop that is met after a clearance, progressive.
    BumpStop = "bump_stop",
    /// Three translational (and three rotational) spring-dampers.
    Bushing = "bushing",
    /// Full stiffness and damping matrices of six directions.
    BushingMatrix = "bushing_matrix",
    /// Coupler or draft gear with slack.
    Coupler = "coupler",
    /// Coulomb friction in one direction.
    Friction = "friction",
    /// Coulomb friction in a plane, under its own load.
    FrictionPlate = "friction_plate",
    /// Spring and damper in series.
    Maxwell = "maxwell",
    /// Viscous damper.
    PointDamper = "point_damper",
    /// Spring.
    PointSpring = "point_spring",
    /// Coil or rubber spring between two plates, with shear and bending.
    ShearSpring = "shear_spring",
    /// Rod with elastic ends along its line.
    TractionRod = "traction_rod",
}

impl ForceLaw for Law {
    #[inline(always)]
    fn wrench(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> Wrench {
        each!(self, law => law.wrench(motion, mount, memory))
    }

    fn energy(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> f64 {
        each!(self, law => law.energy(motion, mount, memory))
    }

    fn dissipation(&self, motion: &Relative, mount: &Mount, memory: &[f64]) -> f64 {
        each!(self, law => law.dissipation(motion, mount, memory))
    }

    fn memory(&self) -> usize {
        each!(self, law => law.memory())
    }

    fn memory_rates(&self, motion: &Relative, mount: &Mount, memory: &[f64], rates: &mut [f64]) {
        each!(self, law => law.memory_rates(motion, mount, memory, rates));
    }

    fn memory_speed(&self) -> f64 {
        each!(self, law => law.memory_speed())
    }

    fn nominal_stiffness(&self, between: &Vec3) -> Mat3 {
        each!(self, law => law.nominal_stiffness(between))
    }

    fn settle(&self, mount: &mut Mount, force: Option<&Vec3>) -> Result<(), String> {
        each!(self, law => law.settle(mount, force))
    }

    fn check_ends(&self, between: &Vec3) -> Result<(), (String, String)> {
        each!(self, law => law.check_ends(between))
    }

    fn faults(&self, at: &KeyPath) -> Vec<Fault> {
        each!(self, law => law.faults(at))
    }
}

impl Law {
    /// The law of the mirrored connection, on the other side of the vehicle.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        match self {
            Self::BushingMatrix(law) => Self::BushingMatrix(law.mirrored()),
            other => other.clone(),
        }
    }
}

/// A fault for each value that is negative or not finite.
fn not_negative(values: &[f64], at: &KeyPath, unit: &str) -> Vec<Fault> {
    ranged(values, at, unit, ">=", |v| v >= 0.0)
}

/// A fault for each value that is not above zero or not finite.
fn positive(values: &[f64], at: &KeyPath, unit: &str) -> Vec<Fault> {
    ranged(values, at, unit, ">", |v| v > 0.0)
}

fn ranged(values: &[f64], at: &KeyPath, unit: &str, sign: &str, holds: fn(f64) -> bool) -> Vec<Fault> {
    values
        .iter()
        .enumerate()
        .filter(|(_, v)| !(v.is_finite() && holds(**v)))
        .map(|(i, v)| {
            let key = if values.len() == 1 { at.clone() } else { at.index(i) };
            Fault::new(key, format!("{v}"), format!("a finite number {sign} 0 {unit}"))
        })
        .collect()
}

/// The preload of a law with three directions is whatever it is to carry.
fn carry(mount: &mut Mount, force: Option<&Vec3>) {
    if let Some(force) = force {
        mount.preload = *force;
    }
}

/// Ends of a line apart, ends of an axis as they are.
fn ends_along(along: Along, between: &Vec3) -> Result<(), (String, String)> {
    if along == Along::Line && between.norm() < along::APART {
        return Err((
            format!("ends {:.4} m apart", between.norm()),
            "`positions`: two points at least 1 mm apart, between which the element acts".into(),
        ));
    }
    Ok(())
}

/// For a law that is not the same for pull and push: its ends have to tell which is which.
fn directed(along: Along, between: &Vec3) -> Result<(), (String, String)> {
    if along.is_directed(between) {
        return Ok(());
    }
    Err((
        "ends that coincide along the element".into(),
        "`positions` apart: they tell pull from push, which differ for this element".into(),
    ))
}

/// Ends that coincide in the design position.
fn coincident(between: &Vec3, what: &str) -> Result<(), (String, String)> {
    if between.norm() <= 1e-9 {
        return Ok(());
    }
    Err((
        format!("ends {:.3} m apart", between.norm()),
        format!("`position`: the ends of a {what} coincide in the design position"),
    ))
}
