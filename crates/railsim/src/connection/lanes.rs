//! Bushings side by side: the same law as [`Bushing`], several at once in vector lanes.
//!
//! Bushings are most of a vehicle's connections and their law has no branch. Those between the same two bodies see one relative
//! motion, so a lane is such a joint with its bushings one after the other, and a block is [`LANES`] joints, between whatever
//! bodies, in arrays that the compiler puts into vector registers: relative motions, bushings and what the two bodies get.

use super::bushing::{Bushing, translational};
use super::{Mount, Pair, Pose, Relative, Wrench};
use crate::math::{Mat3, Vec3};

/// Joints in one block.
pub const LANES: usize = 4;

type Lane = [f64; LANES];

/// A bushing with the two bodies that it is between.
pub type Beside<'a> = ([usize; 2], &'a Bushing, &'a Mount);

/// Whether a bushing can go beside others: only its rotational terms cannot.
#[must_use]
pub fn fits(bushing: &Bushing) -> bool {
    bushing.rotational_stiffness.is_none() && bushing.rotational_damping.is_none()
}

/// The bushings of up to [`LANES`] joints.
#[derive(Debug, Clone)]
pub struct BushingBlock {
    /// Bodies A and B of each lane; a lane that is not used has the first one's, for no stiffness and no preload.
    bodies: [[usize; 2]; LANES],
    used: usize,
    rows: Vec<Row>,
}

/// Constants of one bushing in each lane.
#[derive(Debug, Clone, Default)]
struct Row {
    p_A: [Lane; 3],
    p_B: [Lane; 3],
    preload: [Lane; 3],
    stiffness: [Lane; 3],
    damping: [Lane; 3],
}

impl BushingBlock {
    /// Blocks for all `bushings`; those of one joint keep their order.
    #[must_use]
    pub fn arrange(bushings: &[Beside]) -> Vec<Self> {
        let mut sorted = bushings.to_vec();
        sorted.sort_by_key(|(bodies, ..)| *bodies);
        let mut joints: Vec<&[Beside]> = sorted.chunk_by(|a, b| a.0 == b.0).collect();
        // Joints with as many bushings together: the fewest empty places.
        joints.sort_by_key(|joint| std::cmp::Reverse(joint.len()));
        joints.chunks(LANES).map(Self::new).collect()
    }

    fn new(joints: &[&[Beside]]) -> Self {
        let mut block = Self { bodies: [joints[0][0].0; LANES], used: joints.len(), rows: Vec::new() };
        block.rows.resize(joints.iter().map(|joint| joint.len()).max().unwrap_or(0), Row::default());
        for (l, joint) in joints.iter().enumerate() {
            for (row, (bodies, bushing, mount)) in block.rows.iter_mut().zip(*joint) {
                block.bodies[l] = *bodies;
                row.set(l, bushing, mount);
            }
        }
        block
    }

    /// Adds to the `wrenches` of the bodies (inertial axes) what the bushings do, bodies being where `pose` says.
    ///
    /// # Panics
    /// Where a body that was named in [`Self::arrange`] has no wrench.
    #[inline(always)]
    pub fn apply<'p>(&self, pose: impl Fn(usize) -> &'p Pose, wrenches: &mut [Wrench]) {
        let (a, b) = (Poses::of(|l| pose(self.bodies[l][0])), Poses::of(|l| pose(self.bodies[l][1])));
        let mut motions = Motions::default();
        for l in 0..LANES {
            motions.set(l, &Relative::between(&a.lane(l), &b.lane(l)));
        }
        let mut sums = Wrenches::default();
        for row in &self.rows {
            row.add(&motions, &mut sums);
        }
        let (mut on_A, mut on_B) = (Wrenches::default(), Wrenches::default());
        for l in 0..LANES {
            let pair = Pair::new(&sums.lane(l), &motions.lane(l), &matrix(&a.R, l));
            on_A.add(l, &pair.on_A);
            on_B.add(l, &pair.on_B);
        }
        for (l, [a, b]) in self.bodies[..self.used].iter().enumerate() {
            wrenches[*a] += on_A.lane(l);
            wrenches[*b] += on_B.lane(l);
        }
    }
}

impl Row {
    fn set(&mut self, l: usize, bushing: &Bushing, mount: &Mount) {
        put(&mut self.p_A, l, &mount.p_A);
        put(&mut self.p_B, l, &mount.p_B);
        put(&mut self.preload, l, &mount.preload);
        put(&mut self.stiffness, l, &Vec3::from(bushing.stiffness));
        put(&mut self.damping, l, &Vec3::from(bushing.damping));
    }

    #[inline(always)]
    fn add(&self, motions: &Motions, sums: &mut Wrenches) {
        for l in 0..LANES {
            let mount = Mount {
                preload: vector(&self.preload, l),
                ..Mount::new(vector(&self.p_A, l), vector(&self.p_B, l), Vec3::zeros())
            };
            let (stiffness, damping) = (vector(&self.stiffness, l), vector(&self.damping, l));
            sums.add(l, &translational(&stiffness, &damping, &motions.lane(l), &mount));
        }
    }
}

/// [`Pose`]s, lane by lane; matrices column by column.
struct Poses {
    r: [Lane; 3],
    R: [Lane; 9],
    v: [Lane; 3],
    w: [Lane; 3],
}

impl Poses {
    #[inline(always)]
    fn of<'p>(pose: impl Fn(usize) -> &'p Pose) -> Self {
        let poses = [pose(0), pose(1), pose(2), pose(3)];
        Self {
            r: vectors(|l| &poses[l].r),
            R: matrices(|l| &poses[l].R),
            v: vectors(|l| &poses[l].v),
            w: vectors(|l| &poses[l].w),
        }
    }

    #[inline(always)]
    fn lane(&self, l: usize) -> Pose {
        Pose { r: vector(&self.r, l), R: matrix(&self.R, l), v: vector(&self.v, l), w: vector(&self.w, l) }
    }
}

/// [`Relative`] motions, lane by lane.
#[derive(Default)]
struct Motions {
    r: [Lane; 3],
    R: [Lane; 9],
    v: [Lane; 3],
    w: [Lane; 3],
}

impl Motions {
    #[inline(always)]
    fn set(&mut self, l: usize, motion: &Relative) {
        put(&mut self.r, l, &motion.r_AB);
        put_matrix(&mut self.R, l, &motion.R_AB);
        put(&mut self.v, l, &motion.v_AB);
        put(&mut self.w, l, &motion.w_AB);
    }

    #[inline(always)]
    fn lane(&self, l: usize) -> Relative {
        Relative {
            r_AB: vector(&self.r, l),
            R_AB: matrix(&self.R, l),
            v_AB: vector(&self.v, l),
            w_AB: vector(&self.w, l),
        }
    }
}

/// [`Wrench`]es, lane by lane.
#[derive(Default)]
struct Wrenches {
    f: [Lane; 3],
    m: [Lane; 3],
}

impl Wrenches {
    #[inline(always)]
    fn add(&mut self, l: usize, wrench: &Wrench) {
        for i in 0..3 {
            self.f[i][l] += wrench.f[i];
            self.m[i][l] += wrench.m[i];
        }
    }

    #[inline(always)]
    fn lane(&self, l: usize) -> Wrench {
        Wrench { f: vector(&self.f, l), m: vector(&self.m, l) }
    }
}

// Lane by lane in a literal: the compiler then gathers registers, where a loop would store number by number.
#[inline(always)]
fn lanes(of: impl Fn(usize) -> f64) -> Lane {
    [of(0), of(1), of(2), of(3)]
}

#[inline(always)]
fn vectors<'v>(of: impl Fn(usize) -> &'v Vec3) -> [Lane; 3] {
    [lanes(|l| of(l)[0]), lanes(|l| of(l)[1]), lanes(|l| of(l)[2])]
}

#[inline(always)]
fn matrices<'m>(of: impl Fn(usize) -> &'m Mat3) -> [Lane; 9] {
    let column = |i: usize| [lanes(|l| of(l)[i]), lanes(|l| of(l)[i + 1]), lanes(|l| of(l)[i + 2])];
    let ([a, b, c], [d, e, f], [g, h, i]) = (column(0), column(3), column(6));
    [a, b, c, d, e, f, g, h, i]
}

#[inline(always)]
fn vector(lanes: &[Lane; 3], l: usize) -> Vec3 {
    Vec3::new(lanes[0][l], lanes[1][l], lanes[2][l])
}

#[inline(always)]
fn put(lanes: &mut [Lane; 3], l: usize, vector: &Vec3) {
    for i in 0..3 {
        lanes[i][l] = vector[i];
    }
}

#[inline(always)]
fn matrix(lanes: &[Lane; 9], l: usize) -> Mat3 {
    let [xx, yx, zx, xy, yy, zy, xz, yz, zz] = lanes;
    Mat3::new(xx[l], xy[l], xz[l], yx[l], yy[l], yz[l], zx[l], zy[l], zz[l])
}

#[inline(always)]
fn put_matrix(lanes: &mut [Lane; 9], l: usize, matrix: &Mat3) {
    for i in 0..9 {
        lanes[i][l] = matrix[i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connection::ForceLaw;
    use crate::math::rotation;

    /// Full and half-filled lanes and blocks give, to rounding, what the law gives one by one.
    #[test]
    fn side_by_side_is_one_by_one() {
        let bushing = Bushing {
            stiffness: [3.5e7, 1.0e7, 4.0e6],
            damping: [2.0e4, 3.0e4, 4.0e4],
            ..Bushing::examples().remove(0)
        };
        let pose = |body: usize| {
            let f = 0.01 * body as f64;
            Pose {
                r: Vec3::new(1.0, 0.3 - f, 0.4 * f),
                R: rotation::rot_z(f) * rotation::rot_x(-0.02),
                v: Vec3::new(0.1, f, 0.3),
                w: Vec3::new(0.2, -0.1, f),
            }
        };
        let mount = |i: usize| {
            let f = 0.01 * i as f64;
            let (p_A, p_B) = (Vec3::new(0.5, f, 0.1), Vec3::new(-0.5, 0.2, f));
            Mount { preload: Vec3::new(0.0, 10.0 * f, -5e4), ..Mount::new(p_A, p_B, Vec3::zeros()) }
        };
        // Bushings of each joint: the first body with each of the others.
        for counts in [&[1][..], &[2, 3, 1, 2, 3], &[3, 3, 3, 3], &[9, 2, 9]] {
            let poses: Vec<Pose> = (0..=counts.len()).map(pose).collect();
            let joints: Vec<[usize; 2]> =
                (0..counts.len()).flat_map(|j| vec![[0, j + 1]; counts[j]]).collect();
            let mounts: Vec<Mount> = (0..joints.len()).map(mount).collect();
            // In no order of the joints.
            let mut given: Vec<Beside> =
                joints.iter().zip(&mounts).map(|(bodies, mount)| (*bodies, &bushing, mount)).collect();
            given.sort_by_key(|(bodies, ..)| std::cmp::Reverse(*bodies));
            let (mut ours, mut theirs) =
                (vec![Wrench::zero(); poses.len()], vec![Wrench::zero(); poses.len()]);
            for block in BushingBlock::arrange(&given) {
                block.apply(|body| &poses[body], &mut ours);
            }
            for ([a, b], bushing, mount) in given {
                let motion = Relative::between(&poses[a], &poses[b]);
                let pair = Pair::new(&bushing.wrench(&motion, mount, &[]), &motion, &poses[a].R);
                theirs[a] += pair.on_A;
                theirs[b] += pair.on_B;
            }
            for (body, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
                assert!((ours.f - theirs.f).norm() < 1e-13 * theirs.f.norm(), "{body} of {counts:?}");
                assert!((ours.m - theirs.m).norm() < 1e-13 * theirs.m.norm(), "{body} of {counts:?}");
            }
        }
        assert_eq!(BushingBlock::arrange(&[]).len(), 0);
        assert!(fits(&Bushing::examples()[0]) && !fits(&Bushing::examples()[1]));
    }
}
