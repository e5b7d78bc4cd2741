//! Bushings side by side: the same law as [`Bushing`], several at once in vector lanes.
//!
//! Bushings are most of a vehicle's connections and their law has no branch. A block holds [`LANES`] of them, between whatever
//! bodies, in arrays that the compiler puts into vector registers, four lanes to a register where the right-hand side runs on AVX2.

use super::bushing::{Bushing, translational};
use super::{Mount, Relative, Wrench};
use crate::math::{Mat3, Vec3};

/// Bushings in one block.
pub const LANES: usize = 8;

type Lane = [f64; LANES];

/// Constants of up to [`LANES`] bushings without rotational terms. An empty lane has neither stiffness nor preload.
#[derive(Debug, Clone)]
pub struct BushingBlock {
    /// Which relative motion each lane has.
    joint: [usize; LANES],
    used: usize,
    p_A: [Lane; 3],
    p_B: [Lane; 3],
    preload: [Lane; 3],
    stiffness: [Lane; 3],
    damping: [Lane; 3],
}

impl BushingBlock {
    /// A block without bushings.
    #[must_use]
    pub fn empty() -> Self {
        let none = [[0.0; LANES]; 3];
        Self {
            joint: [0; LANES],
            used: 0,
            p_A: none,
            p_B: none,
            preload: none,
            stiffness: none,
            damping: none,
        }
    }

    /// No room left.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.used == LANES
    }

    /// Adds a bushing that sees relative motion number `joint`. False, and nothing added, where the block is full or the bushing
    /// has rotational terms.
    pub fn add(&mut self, joint: usize, bushing: &Bushing, mount: &Mount) -> bool {
        if self.is_full() || bushing.rotational_stiffness.is_some() || bushing.rotational_damping.is_some() {
            return false;
        }
        let l = self.used;
        self.joint[l] = joint;
        for i in 0..3 {
            self.p_A[i][l] = mount.p_A[i];
            self.p_B[i][l] = mount.p_B[i];
            self.preload[i][l] = mount.preload[i];
            self.stiffness[i][l] = bushing.stiffness[i];
            self.damping[i][l] = bushing.damping[i];
        }
        self.used += 1;
        true
    }

    /// Adds each bushing's wrench on B about A's centre of mass (A's axes) to the sum of its joint.
    ///
    /// # Panics
    /// Where a joint that was named in [`Self::add`] has no motion or no sum.
    #[inline(always)]
    pub fn apply(&self, motions: &[Relative], sums: &mut [Wrench]) {
        let mut at = Motions::still();
        for (l, joint) in self.joint[..self.used].iter().enumerate() {
            at.set(l, &motions[*joint]);
        }
        let mut out = [[0.0; LANES]; 6];
        self.wrenches(&at, &mut out);
        for (l, joint) in self.joint[..self.used].iter().enumerate() {
            let sum = &mut sums[*joint];
            sum.f += Vec3::new(out[0][l], out[1][l], out[2][l]);
            sum.m += Vec3::new(out[3][l], out[4][l], out[5][l]);
        }
    }

    #[inline(always)]
    fn wrenches(&self, at: &Motions, out: &mut [Lane; 6]) {
        for l in 0..LANES {
            let of = |lanes: &[Lane; 3]| Vec3::new(lanes[0][l], lanes[1][l], lanes[2][l]);
            let mount = Mount {
                preload: of(&self.preload),
                ..Mount::new(of(&self.p_A), of(&self.p_B), Vec3::zeros())
            };
            let wrench = translational(&of(&self.stiffness), &of(&self.damping), &at.lane(l), &mount);
            for i in 0..3 {
                out[i][l] = wrench.f[i];
                out[3 + i][l] = wrench.m[i];
            }
        }
    }
}

/// Relative motions, lane by lane.
struct Motions {
    r: [Lane; 3],
    /// Column by column.
    R: [Lane; 9],
    v: [Lane; 3],
    w: [Lane; 3],
}

impl Motions {
    fn still() -> Self {
        let (three, nine) = ([[0.0; LANES]; 3], [[0.0; LANES]; 9]);
        Self { r: three, R: nine, v: three, w: three }
    }

    #[inline(always)]
    fn set(&mut self, l: usize, motion: &Relative) {
        for i in 0..3 {
            self.r[i][l] = motion.r_AB[i];
            self.v[i][l] = motion.v_AB[i];
            self.w[i][l] = motion.w_AB[i];
        }
        for i in 0..9 {
            self.R[i][l] = motion.R_AB[i];
        }
    }

    #[inline(always)]
    fn lane(&self, l: usize) -> Relative {
        let of = |lanes: &[Lane; 3]| Vec3::new(lanes[0][l], lanes[1][l], lanes[2][l]);
        let R = &self.R;
        Relative {
            r_AB: of(&self.r),
            R_AB: Mat3::new(R[0][l], R[3][l], R[6][l], R[1][l], R[4][l], R[7][l], R[2][l], R[5][l], R[8][l]),
            v_AB: of(&self.v),
            w_AB: of(&self.w),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connection::{ForceLaw, Pose};
    use crate::math::rotation;

    /// A full and a half-filled block give what the law gives one by one, to the bit.
    #[test]
    fn side_by_side_is_one_by_one() {
        let bushing = Bushing {
            stiffness: [3.5e7, 1.0e7, 4.0e6],
            damping: [2.0e4, 3.0e4, 4.0e4],
            ..Bushing::examples().remove(0)
        };
        for count in [LANES, 3] {
            let mut block = BushingBlock::empty();
            let (mut motions, mut mounts) = (Vec::new(), Vec::new());
            for l in 0..count {
                let f = 0.01 * l as f64;
                let a = Pose::at(Vec3::new(f, 0.1, -0.2));
                let b = Pose {
                    r: Vec3::new(1.0, 0.3 - f, 0.4),
                    R: rotation::rot_z(f) * rotation::rot_x(-0.02),
                    v: Vec3::new(0.1, f, 0.3),
                    w: Vec3::new(0.2, -0.1, f),
                };
                motions.push(Relative::between(&a, &b));
                mounts.push(Mount {
                    preload: Vec3::new(0.0, 10.0 * f, -5e4),
                    ..Mount::new(Vec3::new(0.5, f, 0.1), Vec3::new(-0.5, 0.2, f), Vec3::zeros())
                });
                assert!(block.add(l, &bushing, &mounts[l]));
            }
            assert_eq!(block.is_full(), count == LANES);
            let mut sums = vec![Wrench::zero(); count];
            block.apply(&motions, &mut sums);
            for l in 0..count {
                assert_eq!(sums[l], bushing.wrench(&motions[l], &mounts[l], &[]), "lane {l}");
            }
        }
        assert!(!BushingBlock::empty().add(
            0,
            &Bushing::examples()[1],
            &Mount::new(Vec3::zeros(), Vec3::zeros(), Vec3::zeros())
        ));
    }
}
