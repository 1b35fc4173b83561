//! Sine and cosine with the same bits on every machine, the few inverse functions that answers need, and doubles as numbers of the formulas.
//!
//! The platform's own libm differs between CPUs (fused and unfused variants); ours does not, and is twice as fast
//! since both functions share one reduction. Kernels and constants: fdlibm (Sun Microsystems, 1993), whose error
//! is below 1 ulp.

use crate::numbers::number::{Arithmetic, Number, decided_by_double};

/// π/2 in three pieces: the first two of 33 bits, so that their products with |n| < 2²⁰ are exact, and the rest.
const HALF_PI_HIGH: f64 = 1.570_796_326_734_125_6;
const HALF_PI_MIDDLE: f64 = 6.077_100_506_303_966e-11;
const HALF_PI_LOW: f64 = 2.022_266_248_795_950_6e-21;

/// Adding and subtracting it rounds to an integer, whose low bits then stand in the low bits of the sum.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Largest angle, in rad, that the three-piece reduction takes (n < 2²⁰); beyond it the slow exact one is used.
pub(crate) const REDUCIBLE: f64 = 1.6e6;

/// Largest angle, in rad, that needs no reduction: π/4.
pub(crate) const SMALL: f64 = std::f64::consts::FRAC_PI_4;

/// Sine and cosine of an angle in rad; error below 1 ulp at every finite angle, NaN for what is not finite.
#[inline(always)]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    if angle.abs() <= SMALL { (sin_small(angle), cos_small(angle)) } else { sin_cos_reduced(angle) }
}

/// sin u and 1 − cos u of an angle in rad; relative error of either below 2 ulp where |u| ≤ π/4, absolute below
/// 1 ulp of 1 elsewhere.
#[inline(always)]
pub fn sin_versine(angle: f64) -> (f64, f64) {
    if angle.abs() <= SMALL {
        return (sin_small(angle), versine_small(angle));
    }
    let (sin, cos) = sin_cos_reduced(angle);
    (sin, 1.0 - cos)
}

/// Sine where |x| ≤ [`SMALL`].
#[inline(always)]
pub(crate) fn sin_small<N: Arithmetic>(x: N) -> N {
    sin_kernel(x, None)
}

/// Cosine where |x| ≤ [`SMALL`].
#[inline(always)]
pub(crate) fn cos_small<N: Arithmetic>(x: N) -> N {
    cos_kernel(x, None)
}

/// 1 − cos x where |x| ≤ [`SMALL`].
#[inline(always)]
pub(crate) fn versine_small<N: Arithmetic>(x: N) -> N {
    let z = x * x;
    N::from_f64(0.5) * z - z * z * cos_tail(z)
}

#[inline]
fn sin_cos_reduced(angle: f64) -> (f64, f64) {
    // Not a number is beyond it as well.
    if angle.abs() <= REDUCIBLE { sin_cos_reducible(angle) } else { libm::sincos(angle) }
}

/// Sine and cosine of an angle from those of its rest, after `n` quarter turns.
#[inline(always)]
fn after_quarter_turns<N: Arithmetic>(n: N, sin: N, cos: N) -> (N, N) {
    let number = N::from_f64;
    // Quarter turns beside whole turns, from −2 to 2. sin changes its sign at 2, −2 and −1, cos at 1, 2 and −2.
    let quarters = n - number(4.0) * ((number(0.25) * n + number(ROUNDING)) - number(ROUNDING));
    let size = quarters.magnitude();
    let is_opposite = number(1.5).is_less(size);
    let swaps = number(0.5).is_less(size) & !is_opposite;
    let flip = |mask, value: N| N::select(mask, -value, value);
    (
        flip(quarters.is_less(number(-0.5)) | is_opposite, N::select(swaps, cos, sin)),
        flip(number(0.5).is_less(quarters) | is_opposite, N::select(swaps, sin, cos)),
    )
}

/// Sine and cosine where |angle| ≤ [`REDUCIBLE`], without a branch; the bits of [`sin_cos`].
#[inline(always)]
pub(crate) fn sin_cos_reducible<N: Arithmetic>(angle: N) -> (N, N) {
    let number = N::from_f64;
    let rounded = angle * number(std::f64::consts::FRAC_2_PI) + number(ROUNDING);
    let n = rounded - number(ROUNDING);
    let first = angle - n * number(HALF_PI_HIGH);
    let correction = n * number(HALF_PI_MIDDLE);
    let second = first - correction;
    let rest = n * number(HALF_PI_LOW) - ((first - second) - correction);
    let reduced = second - rest;
    let tail = (second - reduced) - rest;
    after_quarter_turns(n, sin_kernel(reduced, Some(tail)), cos_kernel(reduced, Some(tail)))
}

/// sin u and 1 − cos u where |angle| ≤ [`REDUCIBLE`], without a branch; the bits of [`sin_versine`].
#[inline(always)]
pub(crate) fn sin_versine_reducible<N: Arithmetic>(angle: N) -> (N, N) {
    let (sin, cos) = sin_cos_reducible(angle);
    let is_small = angle.magnitude().is_at_most(N::from_f64(SMALL));
    (sin, N::select(is_small, versine_small(angle), N::from_f64(1.0) - cos))
}

/// sin(x + tail) for |x| ≤ π/4. Terms are paired rather than nested: half the latency, the same error; and a tail of zero
/// changes no bit.
#[inline(always)]
fn sin_kernel<N: Arithmetic>(x: N, tail: Option<N>) -> N {
    let number = N::from_f64;
    const S: [f64; 6] = [
        -1.666_666_666_666_663_2e-1,
        8.333_333_333_322_49e-3,
        -1.984_126_982_985_795e-4,
        2.755_731_370_707_006_8e-6,
        -2.505_076_025_340_686_3e-8,
        1.589_690_995_211_55e-10,
    ];
    let z = x * x;
    let w = z * z;
    let v = z * x;
    let r = (number(S[1]) + z * number(S[2])) + w * ((number(S[3]) + z * number(S[4])) + w * number(S[5]));
    let bend = (v * z) * r;
    let bend = match tail {
        Some(tail) => bend + tail * (number(1.0) - number(0.5) * z),
        None => bend,
    };
    x + (v * number(S[0]) + bend)
}

/// cos(x + tail) for |x| ≤ π/4.
#[inline(always)]
fn cos_kernel<N: Arithmetic>(x: N, tail: Option<N>) -> N {
    let z = x * x;
    let half = N::from_f64(0.5) * z;
    let one = N::from_f64(1.0) - half;
    let bend = z * z * cos_tail(z);
    let bend = match tail {
        Some(tail) => bend - x * tail,
        None => bend,
    };
    one + (((N::from_f64(1.0) - one) - half) + bend)
}

/// (cos x − 1 + x²/2)/x⁴ for z = x², |x| ≤ π/4.
#[inline(always)]
fn cos_tail<N: Arithmetic>(z: N) -> N {
    let number = N::from_f64;
    const C: [f64; 6] = [
        4.166_666_666_666_66e-2,
        -1.388_888_888_887_411e-3,
        2.480_158_728_947_673e-5,
        -2.755_731_435_139_066_3e-7,
        2.087_572_321_298_175e-9,
        -1.135_964_755_778_819_5e-11,
    ];
    let w = z * z;
    ((number(C[0]) + z * number(C[1])) + w * (number(C[2]) + z * number(C[3])))
        + (w * w) * (number(C[4]) + z * number(C[5]))
}

impl Arithmetic for f64 {
    type Mask = bool;

    decided_by_double!();

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn sincos(self) -> (Self, Self) {
        sin_cos(self)
    }

    #[inline(always)]
    fn sin_versine(self) -> (Self, Self) {
        sin_versine(self)
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }
}

impl Number for f64 {
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_branch_the_bits_are_the_same() {
        let mut angle = 1e-9;
        while angle < REDUCIBLE {
            for signed in [angle, -angle] {
                assert_eq!(sin_cos(signed), sin_cos_reducible(signed));
                assert_eq!(sin_versine(signed), sin_versine_reducible(signed));
            }
            angle *= 1.000_93;
        }
    }

    #[test]
    fn a_tail_of_zero_changes_no_bit() {
        for step in -1000..=1000 {
            let x = f64::from(step) * 7.8e-4;
            assert_eq!(sin_kernel(x, Some(0.0)).to_bits(), sin_kernel(x, None).to_bits());
            assert_eq!(cos_kernel(x, Some(0.0)).to_bits(), cos_kernel(x, None).to_bits());
        }
    }
}
