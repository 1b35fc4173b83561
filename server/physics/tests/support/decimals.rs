//! Decimals of numbers of 31 digits, by the standard library.

use equipoise_physics::numbers::double_double::DoubleDouble;

/// Digits that a number is read by.
const DIGITS: usize = 37;

/// The nearest number to a decimal.
pub(crate) fn number(text: &str) -> DoubleDouble {
    let high: f64 = text.parse().unwrap();
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let (whole, rest) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let exponent = exponent.parse::<i32>().unwrap() - rest.len() as i32;
    let places = [whole, rest].concat().replace('-', "");
    let digits = places.trim_start_matches('0');
    // With few digits the unit is coarse; the rest of the nearest double goes below it.
    let padded = format!("{digits:0<DIGITS$}");
    let unit = exponent + digits.len() as i32 - DIGITS as i32;
    let value = padded[..DIGITS].parse::<i128>().unwrap() * if high < 0.0 { -1 } else { 1 };
    let low: f64 = format!("{}e{unit}", value - in_units(high, unit)).parse().unwrap();
    DoubleDouble::from(high) + DoubleDouble::from(low)
}

/// `value` in units of 10^unit, rounded half to even: exact decimal expansions come from the standard library. Less than one unit is
/// none.
pub(crate) fn in_units(value: f64, unit: i32) -> i128 {
    let exponent = exponent(value);
    let Ok(decimals) = usize::try_from(exponent - unit) else { return 0 };
    let text = format!("{value:.decimals$e}");
    let (mantissa, after) = text.split_once('e').unwrap();
    // Rounding 9.99 to 1.00e1 makes the last digit one place larger.
    let carries = after.parse() != Ok(exponent);
    mantissa.replace('.', "").parse::<i128>().unwrap() * if carries { 10 } else { 1 }
}

/// Place of the first digit of the exact expansion, which may be one less than that of the shortest.
pub(crate) fn exponent(value: f64) -> i32 {
    format!("{value:.40e}").split_once('e').unwrap().1.parse().unwrap()
}
