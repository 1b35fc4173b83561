//! Digits of a double-double, exactly rounded: with powers of ten of 192 bits, and with the standard library in the few places where
//! those do not tell.

use super::DoubleDouble;
use super::powers::{LEAST, MOST, Power};

/// Digits that are worked with: as many as 128 bits hold.
pub(super) const DIGITS: i32 = 37;

/// 10^[`DIGITS`], the first number with more.
const TOO_MANY: u128 = 10u128.pow(DIGITS as u32);

/// The digits of a number that is neither 0 nor infinite, in units of the 37th of its leading double, and the exponent of that one's
/// first digit.
pub(super) fn digits(number: &DoubleDouble) -> (i128, i32) {
    let DoubleDouble { high, low } = *number;
    quick_digits(high, low).unwrap_or_else(|| {
        let exponent = exponent(high);
        let unit = exponent + 1 - DIGITS;
        (in_units(high, unit) + in_units(low, unit), exponent)
    })
}

/// The same wherever 192 bits tell, which is practically everywhere.
pub(super) fn quick_digits(high: f64, low: f64) -> Option<(i128, i32)> {
    let (of_high, exponent) = first_digits(high)?;
    let of_low = match scaled(low, DIGITS - 1 - exponent).filter(|_| low.is_finite())? {
        // Less than one unit is none, as in `in_units`.
        (0, _) => 0,
        (_, rounded) => rounded,
    };
    let signed =
        |value: f64, units: u128| i128::try_from(units).ok().map(|units| if value < 0.0 { -units } else { units });
    Some((signed(high, of_high)?.checked_add(signed(low, of_low)?)?, exponent))
}

/// |value| in units of 10^−power, cut to a whole number and rounded half to even. `None` if 192 bits of the power do not tell, or
/// where it is too many for 37 digits and a bit.
fn scaled(value: f64, power: i32) -> Option<(u128, u128)> {
    const HALF: u128 = 1 << 127;
    let Power { significand, exponent: last, is_exact } = Power::of_ten(power);
    let (mantissa, exponent) = parts(value);
    let mut product = [0u64; 4];
    let mut carry = 0;
    for (word, factor) in product.iter_mut().zip(significand) {
        let sum = u128::from(mantissa) * u128::from(*factor) + carry;
        *word = sum as u64;
        carry = sum >> 64;
    }
    product[3] = carry as u64;
    // The product is in units of 2^−shift.
    let shift = -(exponent + last);
    if shift < 64 || window(&product, shift + 128) != 0 {
        return None;
    }
    let (whole, fraction) = (window(&product, shift), window(&product, shift - 128));
    let rest = window(&product, shift - 256);
    // The most that is missing from the fraction: what was cut from the power, times the mantissa, and what was cut here.
    let missing = match (is_exact, shift) {
        (true, _) => 0,
        (false, 64..128) => u128::from(mantissa) << (128 - shift),
        (false, _) => u128::from(mantissa).checked_shr(shift as u32 - 128).unwrap_or(0) + 1,
    } + 1;
    // Nearer to the next whole number than 2^−64 is for the exact expansion too: it decides how many digits there are.
    fraction.checked_add(missing.max(1 << 64))?;
    let up = match is_exact {
        true => (fraction, rest) > (HALF, 0) || ((fraction, rest) == (HALF, 0) && whole & 1 == 1),
        false if fraction > HALF => true,
        false if fraction + missing < HALF => false,
        false => return None,
    };
    Some((whole, whole + u128::from(up)))
}

/// A finite double as `mantissa · 2^exponent`, without its sign.
pub(super) fn parts(value: f64) -> (u64, i32) {
    const MANTISSA_BITS: u32 = f64::MANTISSA_DIGITS - 1;
    let bits = value.to_bits();
    let (mantissa, exponent) = (bits & ((1 << MANTISSA_BITS) - 1), (bits >> MANTISSA_BITS) as i32 & 0x7ff);
    match exponent {
        0 => (mantissa, -1074),
        _ => (mantissa | 1 << MANTISSA_BITS, exponent - 1075),
    }
}

/// 128 bits of a number from bit `start` on; there are zeros on both sides of it.
fn window(words: &[u64; 4], start: i32) -> u128 {
    let (place, bit) = (start.div_euclid(64), start.rem_euclid(64));
    let word =
        |offset| usize::try_from(place + offset).ok().and_then(|at| words.get(at)).map_or(0, |&word| u128::from(word));
    let low = word(0) | word(1) << 64;
    if bit == 0 { low } else { low >> bit | word(2) << (128 - bit) }
}

/// `value` in units of its 37th digit, rounded half to even, and the exponent of its first digit. None as for [`scaled`].
fn first_digits(value: f64) -> Option<(u128, i32)> {
    let (mantissa, exponent) = parts(value);
    let bits = exponent + 63 - mantissa.leading_zeros() as i32;
    // ⌊bits log₁₀ 2⌋, which a number between two powers of two has, or one more.
    let low = (bits * 78_913) >> 18;
    for exponent in [low, low + 1] {
        let power = DIGITS - 1 - exponent;
        if !(LEAST..=MOST).contains(&power) {
            return None;
        }
        let (whole, rounded) = scaled(value, power)?;
        if whole + 1 < TOO_MANY {
            return Some((rounded, exponent));
        }
        if whole < TOO_MANY {
            return None;
        }
    }
    None
}

/// `value` in units of 10^unit, rounded half to even: exact decimal expansions come from the standard library. Slow; less than one
/// unit is none.
pub(super) fn in_units(value: f64, unit: i32) -> i128 {
    let exponent = exponent(value);
    let Ok(decimals) = usize::try_from(exponent - unit) else { return 0 };
    let text = format!("{value:.decimals$e}");
    let (mantissa, after) = text.split_once('e').unwrap_or((&text, "0"));
    let digits: String = mantissa.chars().filter(|&character| character != '.').collect();
    // Rounding 9.99 to 1.00e1 makes the last digit one place larger.
    let carries = after.parse() != Ok(exponent);
    digits.parse::<i128>().unwrap_or(0) * if carries { 10 } else { 1 }
}

/// Place of the first digit of the exact expansion, which may be one less than that of the shortest.
pub(super) fn exponent(value: f64) -> i32 {
    format!("{value:.40e}").split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}
