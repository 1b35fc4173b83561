//! Runs a loop with the instructions that this CPU has, chosen when it runs: the same operations in the same order, so
//! the same bits, only encoded better.
//!
//! Fused multiply-add is left out on purpose: it rounds once where two operations round twice.

#![allow(unsafe_code)]

/// Calls `work`, compiled for the best instructions there are. What `work` calls has to be `inline(always)` to gain by it.
#[inline(always)]
pub fn dispatch<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the CPU has AVX2, which is all that calling this needs.
        return unsafe { with_avx2(work) };
    }
    work()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<R>(work: impl FnOnce() -> R) -> R {
    work()
}
