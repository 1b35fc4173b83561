//! Numbers of 31 digits as decimals: how they travel.

use super::DoubleDouble;
use num_bigint::BigUint;
use std::fmt;
use std::sync::LazyLock;

/// Digits that are written. Reading them gives the number back to half a unit of the last.
pub const SIGNIFICANT_DIGITS: usize = 32;

/// Digits that each double is rounded to.
const DIGITS: i32 = 37;

/// 10^[`DIGITS`], the first number with more.
const TOO_MANY: u128 = 10u128.pow(DIGITS as u32);

/// Units of the digits that are worked with in one of the last digit that is written.
const SURPLUS: u128 = 10u128.pow(DIGITS as u32 - SIGNIFICANT_DIGITS as u32);

/// Powers of ten up to the one that gives the smallest double [`DIGITS`] digits.
static POWERS_OF_TEN: LazyLock<Vec<BigUint>> = LazyLock::new(|| {
    let powers = std::iter::successors(Some(BigUint::from(1u8)), |power| Some(power * 10u8));
    powers.take(DIGITS as usize + 324).collect()
});

impl DoubleDouble {
    /// The sum of both doubles, each rounded to the 37th digit of the leading one, in units of that digit; and the exponent of the
    /// leading one's first digit.
    fn digits(self) -> (u128, i32) {
        let (_, size) = libm::frexp(self.high);
        // ⌊log₁₀⌋ of the power of two below the number. The number has the same, or one more.
        let mut exponent = ((size - 1) * 78_913) >> 18;
        let mut high = in_units(self.high, exponent + 1 - DIGITS);
        if high.0 >= TOO_MANY {
            exponent += 1;
            high = in_units(self.high, exponent + 1 - DIGITS);
        }
        let low = match in_units(self.low, exponent + 1 - DIGITS) {
            // Less than one unit is none.
            (0, _) => 0,
            (_, rounded) => rounded,
        };
        (if (self.high < 0.0) == (self.low < 0.0) { high.1 + low } else { high.1 - low }, exponent)
    }
}

/// |value| in units of 10^unit: its whole part, and that rounded half to even.
fn in_units(value: f64, unit: i32) -> (u128, u128) {
    const MANTISSA_BITS: i32 = f64::MANTISSA_DIGITS as i32;
    let (fraction, exponent) = libm::frexp(value.abs());
    let mantissa = libm::ldexp(fraction, MANTISSA_BITS) as u64;
    let exponent = exponent - MANTISSA_BITS;
    let ten = |power: i32| &POWERS_OF_TEN[power.max(0) as usize];
    let product = ten(-unit) * mantissa;
    let (halves, is_exact) = if unit <= 0 && exponent < 0 {
        let shift = (-exponent - 1) as u64;
        (&product >> shift, product.trailing_zeros().is_none_or(|zeros| zeros >= shift))
    } else {
        let (dividend, divisor) = (product << (exponent.max(0) + 1), ten(unit) << (-exponent).max(0));
        let quotient = &dividend / &divisor;
        let is_exact = &quotient * &divisor == dividend;
        (quotient, is_exact)
    };
    let halves = u128::try_from(halves).unwrap_or(u128::MAX);
    let whole = halves / 2;
    (whole, whole + u128::from(halves % 2 == 1 && (!is_exact || whole % 2 == 1)))
}

impl fmt::Display for DoubleDouble {
    /// Writes at most [`SIGNIFICANT_DIGITS`] digits, without zeros at their end; with an exponent where a plain number would be long.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.high.is_finite() || self.high == 0.0 {
            return self.high.fmt(formatter);
        }
        let (sum, exponent) = self.digits();
        let rounded = ((sum + SURPLUS / 2) / SURPLUS).to_string();
        // The low part may carry the number over a power of ten, either way.
        let exponent = exponent + rounded.len() as i32 - SIGNIFICANT_DIGITS as i32;
        let digits = rounded.trim_end_matches('0');
        if self.high < 0.0 {
            formatter.write_str("-")?;
        }
        let places = match exponent {
            -6..=-1 => return write!(formatter, "0.{:0<zeros$}{digits}", "", zeros = (-1 - exponent) as usize),
            0..=20 => exponent as usize + 1,
            _ => 1,
        };
        match digits.split_at_checked(places) {
            Some((whole, rest)) if !rest.is_empty() => write!(formatter, "{whole}.{rest}")?,
            _ => write!(formatter, "{digits:0<places$}")?,
        }
        if (0..=20).contains(&exponent) { Ok(()) } else { write!(formatter, "e{exponent}") }
    }
}
