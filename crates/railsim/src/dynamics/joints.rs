//! Connections as the right-hand side evaluates them.

use crate::body::{Kinematics, Wrench};
use crate::connection::lanes::{self, BushingBlock};
use crate::connection::{Law, Pair, Pose, Relative};
use crate::dynamics::model::Link;
use crate::math::Vec3;

/// Connections as a run evaluates them: bushings go side by side; of the others, all between the same two bodies see one relative
/// motion.
#[derive(Debug)]
pub(super) struct Joints {
    blocks: Vec<BushingBlock>,
    /// Bodies A and B of each joint of other connections.
    pairs: Vec<(usize, usize)>,
    motions: Vec<Relative>,
    /// What its connections add up to, on B about A's centre of mass, in A's axes.
    sums: Vec<Wrench>,
    /// Joint and link of every connection that is in no block.
    single: Vec<(usize, usize)>,
}

impl Joints {
    pub fn new(links: &[Link]) -> Self {
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        let (mut beside, mut single) = (Vec::new(), Vec::new());
        for (i, link) in links.iter().enumerate() {
            match &link.law {
                Law::Bushing(bushing) if link.axes.is_none() && lanes::fits(bushing) => {
                    beside.push(([link.a, link.b], bushing, &link.mount));
                }
                _ => {
                    let pair = (link.a, link.b);
                    let joint = pairs.iter().position(|p| *p == pair).unwrap_or_else(|| {
                        pairs.push(pair);
                        pairs.len() - 1
                    });
                    single.push((joint, i));
                }
            }
        }
        let still = Relative::between(&Pose::at(Vec3::zeros()), &Pose::at(Vec3::zeros()));
        let (motions, sums) = (vec![still; pairs.len()], vec![Wrench::zero(); pairs.len()]);
        Self { blocks: BushingBlock::arrange(&beside), pairs, motions, sums, single }
    }

    /// What all connections do to the bodies, added to `wrench` (inertial axes); rates of what they remember, into `dx`.
    #[inline(always)]
    pub fn act(
        &mut self,
        links: &[Link],
        kinematics: &[Kinematics],
        x: &[f64],
        dx: &mut [f64],
        wrench: &mut [Wrench],
    ) {
        let Joints { blocks, pairs, motions, sums, single } = self;
        for block in &*blocks {
            block.apply(|body| &kinematics[body].pose, wrench);
        }
        for ((motion, sum), (a, b)) in motions.iter_mut().zip(sums.iter_mut()).zip(&*pairs) {
            *motion = Relative::between(&kinematics[*a].pose, &kinematics[*b].pose);
            *sum = Wrench::zero();
        }
        for (joint, link) in &*single {
            let link = &links[*link];
            sums[*joint] += link.wrench(&motions[*joint], x);
            if !link.memory.is_empty() {
                link.memory_rates(&motions[*joint], x, dx);
            }
        }
        for ((motion, sum), (a, b)) in motions.iter().zip(&*sums).zip(&*pairs) {
            let pair = Pair::new(sum, motion, &kinematics[*a].pose.R);
            wrench[*a] += pair.on_A;
            wrench[*b] += pair.on_B;
        }
    }
}
