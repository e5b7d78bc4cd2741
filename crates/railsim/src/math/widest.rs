//! The widest instructions that the processor has, found at run time.

/// Work that is compiled twice, for every processor and for AVX2. `run` is to be `#[inline(always)]`, and so is what it calls.
///
/// No fused multiply-add is among the instructions that are let in: both do the same operations in the same order, so that which of them runs
/// changes no bit. Results are the same bytes on every run of one machine with any number of threads, and on all machines whose mathematical library
/// rounds alike. It need not: glibc chooses sin, cos, exp, ln, pow, atan with or without fused multiply-add when it is
/// loaded, and they differ in the last bit. The right-hand side calls it for contacts on the textbook's cone, angles beyond
/// 0.12 rad ([`super::angle::small`]), track curves and falling friction; tables, profiles and irregularities are made with it.
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
