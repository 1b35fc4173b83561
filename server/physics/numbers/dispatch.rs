//! Runs a loop with the instructions that this CPU has, chosen when it runs: the same operations in the same order, so
//! the same bits, only encoded better (three operands with AVX2, twice the registers with AVX-512).
//!
//! Fused multiply-add is left out on purpose: it rounds once where two operations round twice.

#![allow(unsafe_code)]

#[cfg(not(target_arch = "x86_64"))]
pub(crate) use crate::numbers::lanes::vector::Pair as PortableVector;
#[cfg(target_arch = "x86_64")]
pub(crate) use crate::numbers::lanes::vector::Sse2 as PortableVector;
#[cfg(target_arch = "x86_64")]
use crate::numbers::lanes::vector::{Avx2, Avx512};
pub use crate::numbers::lanes::vector::{Kernel, Vector};

/// A kind of instructions to compile for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// AVX-512 (F, VL and DQ).
    Avx512,
    /// AVX2.
    Avx2,
    /// Instructions of every CPU of this kind.
    Portable,
}

impl InstructionSet {
    /// All of them, the best first.
    pub const ALL: [Self; 3] = [Self::Avx512, Self::Avx2, Self::Portable];

    /// The best that this CPU can take.
    pub fn best() -> Self {
        Self::ALL.into_iter().find(|path| path.is_there()).unwrap_or(Self::Portable)
    }

    /// Tells whether this CPU can take it.
    #[inline]
    pub fn is_there(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            match self {
                Self::Avx512 => has!("avx512f") && has!("avx512vl") && has!("avx512dq"),
                Self::Avx2 => has!("avx2"),
                Self::Portable => true,
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            self == Self::Portable
        }
    }
}

/// Does `work`, compiled for the best instructions there are.
#[inline]
pub fn dispatch<W: Kernel>(work: W) -> W::Output {
    dispatch_on(InstructionSet::best(), work)
}

/// Does `work` on one path, or on the portable one where this CPU cannot take it; the bits are the same on all.
#[inline]
pub fn dispatch_on<W: Kernel>(path: InstructionSet, work: W) -> W::Output {
    match path {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the CPU has just these features, which is all that calling this needs.
        InstructionSet::Avx512 if path.is_there() => unsafe { Avx512::run(work) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        InstructionSet::Avx2 if path.is_there() => unsafe { Avx2::run(work) },
        _ => portable(work),
    }
}

/// Does `work` with the instructions of every CPU of this kind.
#[inline]
pub fn portable<W: Kernel>(work: W) -> W::Output {
    work.call::<PortableVector>()
}
