//! Vectors of doubles, one kind for each kind of instructions. Each operation gives the bits of the same operation on single doubles.

#![allow(unsafe_code)]

use std::fmt::Debug;

/// Work that gains by it. Not a closure, since those are not inlined on demand, and what is not inlined is not recompiled.
pub trait Kernel {
    /// Result of the work.
    type Output;

    /// Does it, with the vectors that the CPU has. Implementations and all they call have to be `inline(always)`.
    fn call<V: Vector>(self) -> Self::Output;
}

/// A vector of doubles. Dispatched work gets the kind that its instructions have ([`crate::numbers::dispatch`]).
///
/// # Safety
/// A value is its [`Vector::LANES`] doubles in a row and nothing else.
pub unsafe trait Vector: Copy + Debug + Send + Sync + 'static {
    /// Number of doubles in it.
    const LANES: usize;

    /// A truth value for each of them.
    type Mask: Copy + Debug;

    /// The same number everywhere.
    fn splat(value: f64) -> Self;

    /// Sum.
    fn add(one: Self, other: Self) -> Self;

    /// Difference.
    fn sub(one: Self, other: Self) -> Self;

    /// Product.
    fn mul(one: Self, other: Self) -> Self;

    /// Quotient.
    fn div(one: Self, other: Self) -> Self;

    /// Square root.
    fn sqrt(one: Self) -> Self;

    /// Absolute value.
    fn magnitude(one: Self) -> Self;

    /// The other sign.
    fn negated(one: Self) -> Self;

    /// Tells where it is less than another.
    fn is_less(one: Self, other: Self) -> Self::Mask;

    /// Tells where it is at most another.
    fn is_at_most(one: Self, other: Self) -> Self::Mask;

    /// The one where the mask says yes, the other one elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The truth values as bits, the first one lowest.
    fn bits(mask: Self::Mask) -> u32;

    /// Yes where both say it.
    fn both(one: Self::Mask, other: Self::Mask) -> Self::Mask;

    /// Yes where either says it.
    fn either(one: Self::Mask, other: Self::Mask) -> Self::Mask;

    /// Yes where it says no.
    fn not(mask: Self::Mask) -> Self::Mask;

    /// Does work by a call of its own, compiled for the instructions of this kind.
    ///
    /// # Safety
    /// The CPU has to have them.
    unsafe fn run<W: Kernel>(work: W) -> W::Output;
}

/// Declares a kind of vectors and its operations, each by what the CPU has for it.
macro_rules! vector {
    ($(#[$about:meta])* $name:ident($inner:ty), $lanes:literal, $mask:ty, $(#[$features:meta])? $(fn $method:ident($($argument:ident: $kind:ty),*) -> $answer:ty $operation:block)*) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug)]
        #[repr(transparent)]
        pub(crate) struct $name($inner);

        // SAFETY: it is the CPU's vector of so many doubles, or an array of them.
        unsafe impl Vector for $name {
            const LANES: usize = $lanes;
            type Mask = $mask;

            unsafe fn run<W: Kernel>(work: W) -> W::Output {
                #[inline(never)]
                $(#[$features])?
                fn call<W: Kernel>(work: W) -> W::Output {
                    work.call::<$name>()
                }
                // SAFETY: the caller promises that the CPU has the features.
                #[allow(unused_unsafe, reason = "some are there on every CPU")]
                unsafe {
                    call(work)
                }
            }

            $(#[inline(always)]
            #[allow(unused_unsafe, reason = "some operations are there on every CPU")]
            fn $method($($argument: $kind),*) -> $answer {
                // SAFETY: a value of this kind is made in work that is dispatched to a CPU with its instructions, and nowhere else.
                unsafe { $operation }
            })*
        }
    };
}

#[cfg(target_arch = "x86_64")]
pub(crate) use x86_64::{Avx2, Avx512, Sse2};

#[cfg(target_arch = "x86_64")]
mod x86_64 {
    use crate::numbers::lanes::vector::{Kernel, Vector};
    use std::arch::x86_64::*;

    vector! {
        /// Eight doubles, with AVX-512.
        Avx512(__m512d), 8, u8,
        #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
        fn splat(value: f64) -> Self { Avx512(_mm512_set1_pd(value)) }
        fn add(a: Self, b: Self) -> Self { Avx512(_mm512_add_pd(a.0, b.0)) }
        fn sub(a: Self, b: Self) -> Self { Avx512(_mm512_sub_pd(a.0, b.0)) }
        fn mul(a: Self, b: Self) -> Self { Avx512(_mm512_mul_pd(a.0, b.0)) }
        fn div(a: Self, b: Self) -> Self { Avx512(_mm512_div_pd(a.0, b.0)) }
        fn sqrt(a: Self) -> Self { Avx512(_mm512_sqrt_pd(a.0)) }
        fn magnitude(a: Self) -> Self { Avx512(_mm512_abs_pd(a.0)) }
        fn negated(a: Self) -> Self { Avx512(_mm512_xor_pd(a.0, _mm512_set1_pd(-0.0))) }
        fn is_less(a: Self, b: Self) -> u8 { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a.0, b.0) }
        fn is_at_most(a: Self, b: Self) -> u8 { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a.0, b.0) }
        fn select(mask: u8, yes: Self, no: Self) -> Self { Avx512(_mm512_mask_blend_pd(mask, no.0, yes.0)) }
        fn bits(mask: u8) -> u32 { u32::from(mask) }
        fn both(a: u8, b: u8) -> u8 { a & b }
        fn either(a: u8, b: u8) -> u8 { a | b }
        fn not(a: u8) -> u8 { !a }
    }

    vector! {
        /// Four doubles, with AVX2.
        Avx2(__m256d), 4, Self,
        #[target_feature(enable = "avx2")]
        fn splat(value: f64) -> Self { Avx2(_mm256_set1_pd(value)) }
        fn add(a: Self, b: Self) -> Self { Avx2(_mm256_add_pd(a.0, b.0)) }
        fn sub(a: Self, b: Self) -> Self { Avx2(_mm256_sub_pd(a.0, b.0)) }
        fn mul(a: Self, b: Self) -> Self { Avx2(_mm256_mul_pd(a.0, b.0)) }
        fn div(a: Self, b: Self) -> Self { Avx2(_mm256_div_pd(a.0, b.0)) }
        fn sqrt(a: Self) -> Self { Avx2(_mm256_sqrt_pd(a.0)) }
        fn magnitude(a: Self) -> Self { Avx2(_mm256_andnot_pd(_mm256_set1_pd(-0.0), a.0)) }
        fn negated(a: Self) -> Self { Avx2(_mm256_xor_pd(a.0, _mm256_set1_pd(-0.0))) }
        fn is_less(a: Self, b: Self) -> Self { Avx2(_mm256_cmp_pd::<_CMP_LT_OQ>(a.0, b.0)) }
        fn is_at_most(a: Self, b: Self) -> Self { Avx2(_mm256_cmp_pd::<_CMP_LE_OQ>(a.0, b.0)) }
        fn select(mask: Self, yes: Self, no: Self) -> Self { Avx2(_mm256_blendv_pd(no.0, yes.0, mask.0)) }
        fn bits(mask: Self) -> u32 { _mm256_movemask_pd(mask.0) as u32 }
        fn both(a: Self, b: Self) -> Self { Avx2(_mm256_and_pd(a.0, b.0)) }
        fn either(a: Self, b: Self) -> Self { Avx2(_mm256_or_pd(a.0, b.0)) }
        fn not(a: Self) -> Self { Avx2(_mm256_xor_pd(a.0, _mm256_castsi256_pd(_mm256_set1_epi64x(-1)))) }
    }

    vector! {
        /// Two doubles, with the instructions of every CPU of this kind.
        Sse2(__m128d), 2, Self,
        fn splat(value: f64) -> Self { Sse2(_mm_set1_pd(value)) }
        fn add(a: Self, b: Self) -> Self { Sse2(_mm_add_pd(a.0, b.0)) }
        fn sub(a: Self, b: Self) -> Self { Sse2(_mm_sub_pd(a.0, b.0)) }
        fn mul(a: Self, b: Self) -> Self { Sse2(_mm_mul_pd(a.0, b.0)) }
        fn div(a: Self, b: Self) -> Self { Sse2(_mm_div_pd(a.0, b.0)) }
        fn sqrt(a: Self) -> Self { Sse2(_mm_sqrt_pd(a.0)) }
        fn magnitude(a: Self) -> Self { Sse2(_mm_andnot_pd(_mm_set1_pd(-0.0), a.0)) }
        fn negated(a: Self) -> Self { Sse2(_mm_xor_pd(a.0, _mm_set1_pd(-0.0))) }
        fn is_less(a: Self, b: Self) -> Self { Sse2(_mm_cmplt_pd(a.0, b.0)) }
        fn is_at_most(a: Self, b: Self) -> Self { Sse2(_mm_cmple_pd(a.0, b.0)) }
        fn select(mask: Self, yes: Self, no: Self) -> Self {
            Sse2(_mm_or_pd(_mm_and_pd(mask.0, yes.0), _mm_andnot_pd(mask.0, no.0)))
        }
        fn bits(mask: Self) -> u32 { _mm_movemask_pd(mask.0) as u32 }
        fn both(a: Self, b: Self) -> Self { Sse2(_mm_and_pd(a.0, b.0)) }
        fn either(a: Self, b: Self) -> Self { Sse2(_mm_or_pd(a.0, b.0)) }
        fn not(a: Self) -> Self { Sse2(_mm_xor_pd(a.0, _mm_castsi128_pd(_mm_set1_epi64x(-1)))) }
    }
}

#[cfg(not(target_arch = "x86_64"))]
pub(crate) use pair::Pair;

#[cfg(not(target_arch = "x86_64"))]
mod pair {
    use crate::numbers::lanes::vector::{Kernel, Vector};
    use crate::numbers::number::Arithmetic;

    type Both = [bool; 2];

    vector! {
        /// Two doubles, on any other CPU.
        Pair([f64; 2]), 2, Both,
        fn splat(value: f64) -> Self { Pair([value; 2]) }
        fn add(a: Self, b: Self) -> Self { Pair([a.0[0] + b.0[0], a.0[1] + b.0[1]]) }
        fn sub(a: Self, b: Self) -> Self { Pair([a.0[0] - b.0[0], a.0[1] - b.0[1]]) }
        fn mul(a: Self, b: Self) -> Self { Pair([a.0[0] * b.0[0], a.0[1] * b.0[1]]) }
        fn div(a: Self, b: Self) -> Self { Pair([a.0[0] / b.0[0], a.0[1] / b.0[1]]) }
        fn sqrt(a: Self) -> Self { Pair(a.0.map(f64::sqrt)) }
        fn magnitude(a: Self) -> Self { Pair(a.0.map(f64::abs)) }
        fn negated(a: Self) -> Self { Pair([-a.0[0], -a.0[1]]) }
        fn is_less(a: Self, b: Self) -> Both { [a.0[0] < b.0[0], a.0[1] < b.0[1]] }
        fn is_at_most(a: Self, b: Self) -> Both { [a.0[0] <= b.0[0], a.0[1] <= b.0[1]] }
        fn select(mask: Both, yes: Self, no: Self) -> Self {
            Pair([f64::select(mask[0], yes.0[0], no.0[0]), f64::select(mask[1], yes.0[1], no.0[1])])
        }
        fn bits(mask: Both) -> u32 { u32::from(mask[0]) | u32::from(mask[1]) << 1 }
        fn both(a: Both, b: Both) -> Both { [a[0] & b[0], a[1] & b[1]] }
        fn either(a: Both, b: Both) -> Both { [a[0] | b[0], a[1] | b[1]] }
        fn not(a: Both) -> Both { [!a[0], !a[1]] }
    }
}

/// Does work of lanes by a call of its own, so that the code about it stays short.
#[inline(always)]
pub(crate) fn run_apart<V: Vector, W: Kernel>(work: W) -> W::Output {
    // SAFETY: a number of this kind is there, so the CPU has its instructions.
    unsafe { V::run(work) }
}

/// Doubles in vectors as they stand in memory.
#[inline(always)]
pub(in crate::numbers) fn lanes<V: Vector, const K: usize>(vectors: &[V; K]) -> &[f64] {
    // SAFETY: a vector is its doubles and nothing else ([`Vector::LANES`] of them), so K of them are an array of doubles.
    unsafe { std::slice::from_raw_parts(vectors.as_ptr().cast(), K * V::LANES) }
}

/// [`lanes`], to change them.
#[inline(always)]
pub(in crate::numbers) fn lanes_mut<V: Vector, const K: usize>(vectors: &mut [V; K]) -> &mut [f64] {
    // SAFETY: as in `lanes`.
    unsafe { std::slice::from_raw_parts_mut(vectors.as_mut_ptr().cast(), K * V::LANES) }
}

/// The first doubles as a vector. Panics if they are fewer than its lanes; likewise in [`write`].
#[inline(always)]
pub(in crate::numbers) fn read<V: Vector>(numbers: &[f64]) -> V {
    assert!(numbers.len() >= V::LANES);
    // SAFETY: so many doubles are there, and a vector is its doubles and nothing else.
    unsafe { numbers.as_ptr().cast::<V>().read_unaligned() }
}

/// Puts a vector in place of the first doubles.
#[inline(always)]
pub(in crate::numbers) fn write<V: Vector>(vector: V, numbers: &mut [f64]) {
    assert!(numbers.len() >= V::LANES);
    // SAFETY: as in `read`.
    unsafe { numbers.as_mut_ptr().cast::<V>().write_unaligned(vector) }
}
