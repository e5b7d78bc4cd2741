//! The widest instructions that the processor has, found at run time.

/// Work that is compiled twice, for every processor and for AVX2. `run` is to be `#[inline(always)]`, and so is what it calls.
///
/// No fused multiply-add is among the instructions that are let in: both do the same operations in the same order, and the bytes do not depend on the machine.
pub trait Work {
    /// Does it.
    fn run(&mut self);
}

/// Does the work with AVX2 where the processor has it.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)] // the one way to call code for instructions that not every processor has
#[inline]
pub fn run(work: &mut impl Work) {
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has just said that it has AVX2.
        unsafe { with_avx2(work) }
    } else {
        work.run();
    }
}

/// Does the work.
#[cfg(not(target_arch = "x86_64"))]
pub fn run(work: &mut impl Work) {
    work.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2(work: &mut impl Work) {
    work.run();
}
