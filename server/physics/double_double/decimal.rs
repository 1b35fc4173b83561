//! Numbers of 31 digits as decimals, and back: how they travel.

use super::DoubleDouble;
use std::fmt;
use std::str::FromStr;

/// Digits that are written. Reading them gives the number back to half a unit of the last.
pub const SIGNIFICANT_DIGITS: usize = 32;

/// Digits that are worked with: as many as 128 bits hold.
const DIGITS: i32 = 37;

/// A text that is no decimal number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotADecimal;

impl fmt::Display for NotADecimal {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("not a decimal number")
    }
}

/// `value` in units of 10^unit, rounded: exact decimal expansions come from the standard library.
fn in_units(value: f64, unit: i32) -> i128 {
    let exponent = exponent(value);
    let Ok(decimals) = usize::try_from(exponent - unit) else { return 0 };
    let text = format!("{value:.decimals$e}");
    let (mantissa, after) = text.split_once('e').unwrap_or((&text, "0"));
    let digits: String = mantissa.chars().filter(|&character| character != '.').collect();
    // Rounding 9.99 to 1.00e1 makes the last digit one place larger.
    let carries = after.parse() != Ok(exponent);
    digits.parse::<i128>().unwrap_or(0) * if carries { 10 } else { 1 }
}

/// Of the first digit of the exact expansion, which may be one less than that of the shortest.
fn exponent(value: f64) -> i32 {
    format!("{value:.40e}").split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

impl fmt::Display for DoubleDouble {
    /// At most [`SIGNIFICANT_DIGITS`] digits, without zeros at their end; with an exponent where a plain number would be long.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.high.is_finite() || self.high == 0.0 {
            return self.high.fmt(formatter);
        }
        let mut exponent = exponent(self.high);
        let unit = exponent + 1 - DIGITS;
        let sum = in_units(self.high, unit) + in_units(self.low, unit);
        let surplus = 10i128.pow(DIGITS as u32 - SIGNIFICANT_DIGITS as u32);
        let rounded = (sum.abs() + surplus / 2) / surplus;
        let digits = rounded.to_string();
        // The low part may have carried the number over a power of ten, either way.
        exponent += digits.len() as i32 - SIGNIFICANT_DIGITS as i32;
        let digits = digits.trim_end_matches('0');
        let sign = if sum < 0 { "-" } else { "" };
        match exponent {
            -6..=-1 => write!(formatter, "{sign}0.{}{digits}", "0".repeat((-1 - exponent) as usize)),
            0..=20 => {
                let (whole, rest) = digits.split_at(digits.len().min(exponent as usize + 1));
                let zeros = "0".repeat(exponent as usize + 1 - whole.len());
                let point = if rest.is_empty() { "" } else { "." };
                write!(formatter, "{sign}{whole}{zeros}{point}{rest}")
            }
            _ => {
                let (whole, rest) = digits.split_at(1);
                let point = if rest.is_empty() { "" } else { "." };
                write!(formatter, "{sign}{whole}{point}{rest}e{exponent}")
            }
        }
    }
}

impl FromStr for DoubleDouble {
    type Err = NotADecimal;

    /// The nearest number to a decimal, of which 37 digits are read.
    fn from_str(text: &str) -> Result<Self, NotADecimal> {
        let high: f64 = text.parse().map_err(|_| NotADecimal)?;
        if !high.is_finite() || high == 0.0 {
            return Ok(Self::of(high, 0.0));
        }
        let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let exponent: i32 = exponent.parse().map_err(|_| NotADecimal)?;
        let (whole, rest) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let places: String = [whole, rest].concat().trim_start_matches(['-', '+']).to_owned();
        let leading = places.len() - places.trim_start_matches('0').len();
        let digits = &places[leading..];
        let read = digits.len().min(DIGITS as usize);
        let value: i128 = digits[..read].parse().map_err(|_| NotADecimal)?;
        let unit = exponent - rest.len() as i32 + (digits.len() - read) as i32;
        let value = if high < 0.0 { -value } else { value };
        // With few digits the unit is coarse; the rest of the nearest double goes below it.
        let pad = DIGITS - read as i32;
        let (value, unit) = (value * 10i128.pow(pad as u32), unit - pad);
        let low = format!("{}e{unit}", value - in_units(high, unit)).parse().map_err(|_| NotADecimal)?;
        Ok(Self::normalized(super::fast_two_sum(high, low)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_written() {
        for text in [
            "0.1",
            "-0.3",
            "1",
            "1024",
            "12.5",
            "3.0752150681369518503095291234567",
            "-0.0030752150681369518503095291234567",
            "9999.999999999999999999999999999",
            "1.0000000000000000000000000000001",
            "123456789012345678901.23456789",
            "1e-7",
            "-2.5e300",
            "4.656612873077392578125e-10",
        ] {
            assert_eq!(text.parse::<DoubleDouble>().unwrap().to_string(), text);
        }
        for text in ["", "e5", "1.2.3", "0x10", "--1", "1e"] {
            assert_eq!(text.parse::<DoubleDouble>(), Err(NotADecimal), "{text}");
        }
    }

    #[test]
    fn what_is_written_is_read_back() {
        let mut value = DoubleDouble::of(1.0, 0.0);
        let factor = DoubleDouble::of(-1.25, 0.0) / DoubleDouble::of(1.1, 0.0);
        for _ in 0..3000 {
            value = value * factor;
            let back: DoubleDouble = value.to_string().parse().unwrap();
            assert!(((back - value) / value).to_f64().abs() <= 6e-32, "{value} {back}");
        }
    }

    #[test]
    fn every_double_is_itself() {
        let mut value = 1e-250_f64 / 3.0;
        while value < 1e250 {
            let text = DoubleDouble::of(value, 0.0).to_string();
            assert_eq!(text.parse::<f64>(), Ok(value));
            value *= -1.7e3;
            value = value.abs();
        }
    }
}
