//! Natural logarithm without a branch, so that lanes compute it too. Method and constants: fdlibm (Sun Microsystems, 1993), as in `libm`.

const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
const L: [f64; 7] = [
    6.666_666_666_666_735e-1,
    3.999_999_999_940_942e-1,
    2.857_142_874_366_239e-1,
    2.222_219_843_214_978_4e-1,
    1.818_357_216_161_805e-1,
    1.531_383_769_920_937_3e-1,
    1.479_819_860_511_658_6e-1,
];

/// The upper halves of 1 and of √½, as `f64` has them.
const ONE: u64 = 0x3ff0_0000;
const ROOT_HALF: u64 = 0x3fe6_a09e;

/// 2⁵², whose last bit counts ones.
const COUNTING: f64 = 4_503_599_627_370_496.0;

/// ln x of a normal x > 0, with the bits of `libm::log`.
#[inline(always)]
pub(crate) fn ln_normal(x: f64) -> f64 {
    const MANTISSA: u64 = (1 << 52) - 1;
    // x = 2ᵏ(1 + f) with √½ < 1 + f < √2.
    let shifted = x.to_bits() + ((ONE - ROOT_HALF) << 32);
    let k = (f64::from_bits((shifted >> 52) | COUNTING.to_bits()) - COUNTING) - 1023.0;
    let f = f64::from_bits((shifted & MANTISSA) + (ROOT_HALF << 32)) - 1.0;
    let half_square = 0.5 * f * f;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let odd = w * (L[1] + w * (L[3] + w * L[5]));
    let even = z * (L[0] + w * (L[2] + w * (L[4] + w * L[6])));
    s * (half_square + (even + odd)) + k * LN2_LOW - half_square + f + k * LN2_HIGH
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_those_of_libm() {
        for exponent in -1022..1023 {
            let mut x = f64::from_bits(((exponent + 1023) as u64) << 52);
            for step in 0..200_u64 {
                assert_eq!(ln_normal(x).to_bits(), libm::log(x).to_bits(), "{x:e}");
                x = f64::from_bits(x.to_bits() + (step * step * 112_345_678_901) % (1 << 45) + 1);
            }
        }
        for x in [1.0, f64::MIN_POSITIVE, f64::MAX, 1.0 - f64::EPSILON / 2.0, 1.0 + f64::EPSILON] {
            assert_eq!(ln_normal(x).to_bits(), libm::log(x).to_bits(), "{x:e}");
        }
    }
}
