//! Arctangent of a positive number without a branch, for lanes: the bits of `libm::atan2`.
//!
//! Polynomial and constants: fdlibm (Sun Microsystems, 1993).

use crate::numbers::number::Arithmetic;

/// Largest number that needs no reduction: the last one below 7/16.
pub(crate) const SMALL: f64 = 0.437_499_999_999_999_94;

/// Largest number that [`arctangent_reducible`] takes: far beyond it the arctangent is π/2.
pub(crate) const REDUCIBLE: f64 = 1e15;

/// Arctangent of 0 ≤ x ≤ [`SMALL`].
#[inline(always)]
pub(crate) fn arctangent_small<N: Arithmetic>(x: N) -> N {
    x - x * bend(x * x)
}

/// Arctangent of 0 ≤ x ≤ [`REDUCIBLE`].
///
/// atan x = atan c + atan((x − c)/(1 + cx)), for the nearest c of 1/2, 1, 3/2 and ∞.
#[inline(always)]
pub(crate) fn arctangent_reducible<N: Arithmetic>(x: N) -> N {
    let number = N::from_f64;
    // The arctangent of c in two parts, and the quotient's two sides.
    let arctangent = |c: usize, above, below| [number(ARCTANGENTS[c][0]), number(ARCTANGENTS[c][1]), above, below];
    let mut near = arctangent(3, number(-1.0), x);
    near = nearer(x, 2.4375, arctangent(2, x - number(1.5), number(1.0) + number(1.5) * x), near);
    near = nearer(x, 1.1875, arctangent(1, x - number(1.0), x + number(1.0)), near);
    near = nearer(x, 0.6875, arctangent(0, number(2.0) * x - number(1.0), number(2.0) + x), near);
    let [high, low, above, below] = near;
    let reduced = above / below;
    let far = high - ((reduced * bend(reduced * reduced) - low) - reduced);
    N::select(x.is_at_most(number(SMALL)), arctangent_small(x), far)
}

/// `yes` where x is less than `end`, else `no`.
#[inline(always)]
fn nearer<N: Arithmetic>(x: N, end: f64, yes: [N; 4], no: [N; 4]) -> [N; 4] {
    let mask = x.is_less(N::from_f64(end));
    let [a, b, c, d] = yes;
    let [e, f, g, h] = no;
    [N::select(mask, a, e), N::select(mask, b, f), N::select(mask, c, g), N::select(mask, d, h)]
}

/// Arctangents of 1/2, 1, 3/2 and ∞, each a double and what it leaves out.
const ARCTANGENTS: [[f64; 2]; 4] = [
    [4.636_476_090_008_061e-1, 2.269_877_745_296_168_7e-17],
    [std::f64::consts::FRAC_PI_4, 3.061_616_997_868_383e-17],
    [9.827_937_232_473_29e-1, 1.390_331_103_123_099_8e-17],
    [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17],
];

/// 1 − (atan x)/x for z = x², |x| ≤ 7/16.
#[inline(always)]
fn bend<N: Arithmetic>(z: N) -> N {
    let number = N::from_f64;
    const A: [f64; 11] = [
        3.333_333_333_333_293e-1,
        -1.999_999_999_987_648_3e-1,
        1.428_571_427_250_346_6e-1,
        -1.111_111_040_546_235_6e-1,
        9.090_887_133_436_507e-2,
        -7.691_876_205_044_83e-2,
        6.661_073_137_387_531e-2,
        -5.833_570_133_790_573_5e-2,
        4.976_877_994_615_932e-2,
        -3.653_157_274_421_691_6e-2,
        1.628_582_011_536_578_2e-2,
    ];
    let w = z * z;
    let odd = z
        * (number(A[0])
            + w * (number(A[2]) + w * (number(A[4]) + w * (number(A[6]) + w * (number(A[8]) + w * number(A[10]))))));
    let even = w * (number(A[1]) + w * (number(A[3]) + w * (number(A[5]) + w * (number(A[7]) + w * number(A[9])))));
    odd + even
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bits_are_those_of_libm() {
        let mut x = 1e-300;
        while x < REDUCIBLE {
            assert_eq!(arctangent_reducible(x).to_bits(), libm::atan2(x, 1.0).to_bits(), "{x}");
            x *= if x < 1e-3 { 1.37 } else { 1.000_071 };
        }
        assert_eq!(arctangent_reducible(0.0).to_bits(), 0);
    }

    #[test]
    fn without_reduction_the_bits_are_the_same() {
        for step in 0..100_000 {
            let x = SMALL * f64::from(step) / 1e5;
            assert_eq!(arctangent_small(x).to_bits(), arctangent_reducible(x).to_bits(), "{x}");
        }
    }

    #[test]
    fn the_ends_of_the_ranges_are_those_of_libm() {
        assert_eq!(SMALL.next_up(), 7.0 / 16.0);
        for end in [SMALL, 0.6875, 1.1875, 2.4375] {
            for x in [end.next_down(), end, end.next_up()] {
                assert_eq!(arctangent_reducible(x).to_bits(), libm::atan2(x, 1.0).to_bits(), "{x}");
            }
        }
    }
}
