//! Runs a loop with the instructions that this CPU has, chosen when it runs: the same operations in the same order, so
//! the same bits, only encoded better (three operands with AVX2, twice the registers with AVX-512).
//!
//! Fused multiply-add is left out on purpose: it rounds once where two operations round twice.

#![allow(unsafe_code)]

/// Work that gains by it. Not a closure, since those are not inlined on demand, and what is not inlined is not recompiled.
pub trait Work {
    /// What it gives.
    type Output;

    /// Does it. Implementations and all they call have to be `inline(always)`.
    fn call(self) -> Self::Output;
}

/// Does `work`, compiled for the best instructions there are.
#[inline]
pub fn dispatch<W: Work>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::is_x86_feature_detected as has;
        if has!("avx512f") && has!("avx512vl") && has!("avx512dq") {
            // SAFETY: the CPU has just these features, which is all that calling this needs.
            return unsafe { with_avx512(work) };
        }
        if has!("avx2") {
            // SAFETY: as above.
            return unsafe { with_avx2(work) };
        }
    }
    work.call()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq")]
fn with_avx512<W: Work>(work: W) -> W::Output {
    work.call()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn with_avx2<W: Work>(work: W) -> W::Output {
    work.call()
}
