//! Numbers as people read them in a caption or at a tick: few digits, a true minus, powers of ten raised.
//!
//! Powers of ten are read off decimal text, so that no logarithm is needed and every digit is the same everywhere.

/// Exponent of ten of a finite number other than 0, as in 1.5·10ⁿ.
pub(crate) fn exponent(value: f64) -> i32 {
    let text = format!("{value:e}");
    text.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

/// mantissa·10^exponent, correctly rounded; 0 or infinity outside the range of doubles.
pub(crate) fn decimal(mantissa: i64, exponent: i32) -> f64 {
    format!("{mantissa}e{exponent}").parse().unwrap_or(0.0)
}

/// mantissa·10^exponent written out, without an exponent.
pub(crate) fn written_out(mantissa: i64, exponent: i32) -> String {
    let sign = if mantissa < 0 { "−" } else { "" };
    let mut digits = mantissa.unsigned_abs().to_string();
    if mantissa == 0 {
        return "0".to_owned();
    }
    if exponent >= 0 {
        digits.extend(std::iter::repeat_n('0', exponent.unsigned_abs() as usize));
        return format!("{sign}{digits}");
    }
    let decimals = exponent.unsigned_abs() as usize;
    if digits.len() <= decimals {
        digits = "0".repeat(decimals + 1 - digits.len()) + &digits;
    }
    digits.insert(digits.len() - decimals, '.');
    format!("{sign}{digits}")
}

/// A number to `digits` significant digits, trailing zeros dropped.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return if value.is_nan() { "not a number".to_owned() } else { "infinite".to_owned() };
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let text = format!("{:.*e}", digits.saturating_sub(1), value.abs());
    let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
    let power: i32 = power.parse().unwrap_or(0);
    let bare: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    let bare = bare.trim_end_matches('0');
    let places = i32::try_from(bare.len()).unwrap_or(1) - 1;
    let mantissa: i64 = bare.parse().unwrap_or(0);
    let sign = if value < 0.0 { "−" } else { "" };
    if (-4..6).contains(&power) {
        format!("{sign}{}", written_out(mantissa, power - places))
    } else {
        format!("{sign}{}·10{}", written_out(mantissa, -places), raised(power))
    }
}

/// An integer in superscript digits.
pub(crate) fn raised(value: i32) -> String {
    value
        .to_string()
        .chars()
        .map(|digit| match digit {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '4' => '⁴',
            '5' => '⁵',
            '6' => '⁶',
            '7' => '⁷',
            '8' => '⁸',
            '9' => '⁹',
            _ => '⁰',
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_readable() {
        for (value, text) in [
            (1.1, "1.1"),
            (1.285_714_285_714_285_6, "1.286"),
            (-0.05, "−0.05"),
            (2000.0, "2000"),
            (999_960.0, "1·10⁶"),
            (-3.25e-7, "−3.25·10⁻⁷"),
            (0.0, "0"),
            (-0.0, "0"),
            (f64::NAN, "not a number"),
            (f64::INFINITY, "infinite"),
        ] {
            assert_eq!(significant(value, 4), text);
        }
    }
}
