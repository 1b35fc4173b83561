//! Numbers of 31 digits as decimals, and back: how they travel.

use super::DoubleDouble;
use super::digits::{DIGITS, digits, in_units};
use std::fmt;
use std::str::FromStr;

/// Digits that are written. Reading them gives the number back to half a unit of the last.
pub const SIGNIFICANT_DIGITS: usize = 32;

/// Units of the digits that are worked with in one of the last digit that is written.
const SURPLUS: u128 = 10u128.pow(DIGITS as u32 - SIGNIFICANT_DIGITS as u32);

/// A text that is no decimal number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotADecimal;

impl fmt::Display for NotADecimal {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("not a decimal number")
    }
}

/// A number as text, without an allocation.
#[derive(Clone, Copy, Debug)]
pub struct Decimal {
    bytes: [u8; Self::BYTES],
    length: usize,
}

impl Decimal {
    /// At least the longest: a sign, `0.`, five zeros and all digits.
    const BYTES: usize = 48;

    fn empty() -> Self {
        Self { bytes: [0; Self::BYTES], length: 0 }
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        std::str::from_utf8(&self.bytes[..self.length]).expect("digits are ASCII")
    }

    fn push(&mut self, text: &[u8]) {
        self.bytes[self.length..][..text.len()].copy_from_slice(text);
        self.length += text.len();
    }

    fn push_zeros(&mut self, count: usize) {
        self.bytes[self.length..][..count].fill(b'0');
        self.length += count;
    }

    /// An exponent of at most three digits.
    fn push_exponent(&mut self, exponent: i32) {
        self.push(if exponent < 0 { b"e-" } else { b"e" });
        let mut digits = [0; 3];
        let (mut rest, mut first) = (exponent.unsigned_abs(), digits.len());
        while rest > 0 {
            first -= 1;
            digits[first] = b'0' + (rest % 10) as u8;
            rest /= 10;
        }
        self.push(&digits[first..]);
    }
}

/// Writes a number below 10^`places` with zeros before it.
fn write_digits(mut number: u64, places: &mut [u8]) {
    const PAIRS: [[u8; 2]; 100] = {
        let mut pairs = [[0; 2]; 100];
        let mut number = 0;
        while number < 100 {
            pairs[number] = [b'0' + (number / 10) as u8, b'0' + (number % 10) as u8];
            number += 1;
        }
        pairs
    };
    for pair in places.rchunks_exact_mut(2) {
        pair.copy_from_slice(&PAIRS[(number % 100) as usize]);
        number /= 100;
    }
}

impl DoubleDouble {
    /// The number as a decimal: at most [`SIGNIFICANT_DIGITS`] digits, without zeros at their end; with an exponent where a plain
    /// number would be long.
    pub fn to_decimal(&self) -> Decimal {
        let mut text = Decimal::empty();
        if self.high.is_nan() {
            text.push(b"NaN");
            return text;
        }
        if self.high.is_sign_negative() {
            text.push(b"-");
        }
        if self.high.is_infinite() || self.high == 0.0 {
            text.push(if self.high == 0.0 { b"0" } else { b"inf" });
            return text;
        }
        let (sum, mut exponent) = digits(self);
        let rounded = (sum.unsigned_abs() + SURPLUS / 2) / SURPLUS;
        const SPLIT: u128 = 10u128.pow(16);
        let mut places = [0; SIGNIFICANT_DIGITS + 2];
        write_digits((rounded / SPLIT) as u64, &mut places[..SIGNIFICANT_DIGITS - 14]);
        write_digits((rounded % SPLIT) as u64, &mut places[SIGNIFICANT_DIGITS - 14..]);
        let first = places.iter().position(|&digit| digit != b'0').unwrap_or(places.len() - 1);
        // The low part may have carried the number over a power of ten, either way.
        exponent += 2 - first as i32;
        let end = places.iter().rposition(|&digit| digit != b'0').map_or(places.len(), |last| last + 1);
        let digits = &places[first..end];
        match exponent {
            -6..=-1 => {
                text.push(b"0.");
                text.push_zeros((-1 - exponent) as usize);
                text.push(digits);
            }
            0..=20 => {
                let (whole, rest) = digits.split_at(digits.len().min(exponent as usize + 1));
                text.push(whole);
                text.push_zeros(exponent as usize + 1 - whole.len());
                if !rest.is_empty() {
                    text.push(b".");
                    text.push(rest);
                }
            }
            _ => {
                let (whole, rest) = digits.split_at(1);
                text.push(whole);
                if !rest.is_empty() {
                    text.push(b".");
                    text.push(rest);
                }
                text.push_exponent(exponent);
            }
        }
        text
    }
}

impl fmt::Display for DoubleDouble {
    /// Same as [`DoubleDouble::to_decimal`].
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.to_decimal().as_str())
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
