//! Ranges of values, their map onto pixels, and ticks at 1, 2 and 5 times powers of ten, or at powers of ten for logarithms.

/// Largest value that a range holds, so that its width is finite.
const LARGEST: f64 = 1e300;

/// Least width of a range over its largest value. Less would be rounding noise drawn large, and labels of ten digits.
const NARROWEST: f64 = 1e-5;

/// Width below which a range about 0 counts as none.
const TINIEST: f64 = 1e-290;

/// An interval of values, never empty, always finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Range {
    /// The interval between two values, widened if they are almost equal.
    pub(crate) fn new(low: f64, high: f64) -> Self {
        let low = low.clamp(-LARGEST, LARGEST);
        let high = high.clamp(-LARGEST, LARGEST);
        let largest = low.abs().max(high.abs());
        if largest < TINIEST {
            return Self { low: -1.0, high: 1.0 };
        }
        if high - low < largest * NARROWEST {
            let (middle, half) = (0.5 * low + 0.5 * high, 0.5 * largest * NARROWEST);
            return Self { low: middle - half, high: middle + half };
        }
        Self { low, high }
    }

    /// The interval around all finite values, with a margin on both sides; −1 to 1 without values.
    pub(crate) fn around(values: impl IntoIterator<Item = f64>) -> Self {
        let mut bounds: Option<(f64, f64)> = None;
        for value in values.into_iter().filter(|value| value.is_finite()) {
            let (low, high) = bounds.unwrap_or((value, value));
            bounds = Some((low.min(value), high.max(value)));
        }
        let Some((low, high)) = bounds else { return Self { low: -1.0, high: 1.0 } };
        // A single value gets so much room that its ticks are short numbers.
        let margin = if high - low < low.abs().max(high.abs()) * NARROWEST {
            0.1 * low.abs().max(high.abs())
        } else {
            0.06 * high - 0.06 * low
        };
        Self::new(low - margin, high + margin)
    }
}

/// A linear scale: a range of values along a range of pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    pub(crate) range: Range,
    from: f64,
    to: f64,
}

impl Scale {
    /// Puts the low end of the range at pixel `from` and the high end at `to`.
    pub(crate) fn linear(range: Range, from: f64, to: f64) -> Self {
        Self { range, from, to }
    }

    /// The pixel of a value. Values outside the range are put on the nearer end.
    pub(crate) fn at(&self, value: f64) -> f64 {
        let share = (value - self.range.low) / (self.range.high - self.range.low);
        self.from + share.clamp(0.0, 1.0) * (self.to - self.from)
    }
}

/// Ticks of an axis.
#[derive(Debug)]
pub(crate) struct Ticks {
    /// Labels are in units of 10 to this power.
    pub(crate) power: i32,
    /// Values in rising order, with labels.
    pub(crate) marks: Vec<(f64, String)>,
}

/// Ticks inside a range, at most `most` of them (two at least), at multiples of 1, 2 or 5 times a power of ten.
pub(crate) fn ticks(range: Range, most: u32) -> Ticks {
    let finest = (range.high - range.low) / f64::from(most.max(2));
    let mut power_of_step = exponent(finest);
    let unit = decimal(1, power_of_step);
    let multiple = match finest / unit {
        share if share <= 1.0 => 1,
        share if share <= 2.0 => 2,
        share if share <= 5.0 => 5,
        _ => {
            power_of_step += 1;
            1
        }
    };
    let step = decimal(multiple, power_of_step);
    let largest = exponent(range.low.abs().max(range.high.abs()));
    let power = if (-3..5).contains(&largest) { 0 } else { largest };
    // The quotients are below most/NARROWEST, so they fit; a hair of tolerance keeps a tick that stands on an end.
    let (first, last) = ((range.low / step - 1e-9).ceil() as i64, (range.high / step + 1e-9).floor() as i64);
    let marks = (first..=last)
        .map(|n| n * multiple)
        .map(|mantissa| (decimal(mantissa, power_of_step), written_out(mantissa, power_of_step - power)))
        .collect();
    Ticks { power, marks }
}

/// Ticks at whole numbers inside a range of logarithms, at most `most` of them (two at least), labelled as powers of ten.
pub(crate) fn decades(range: Range, most: u32) -> Ticks {
    let (first, last) = (range.low.ceil() as i32, range.high.floor() as i32);
    let count = last.saturating_sub(first).saturating_add(1).max(1);
    let step = count.div_euclid(most.max(2) as i32) + i32::from(count.rem_euclid(most.max(2) as i32) > 0);
    let whole = (first..=last).filter(|power| power.rem_euclid(step.max(1)) == 0);
    let label = |power: i32| if power == 0 { "1".to_owned() } else { format!("10{}", raised(power)) };
    Ticks { power: 0, marks: whole.map(|power| (f64::from(power), label(power))).collect() }
}

// Numbers as people read them in a caption or at a tick: few digits, a true minus, powers of ten raised.
//
// Powers of ten are read off decimal text, so that no logarithm is needed and every digit is the same everywhere.

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
    fn decades_are_powers_of_ten() {
        let labels = |low, high, most| {
            decades(Range { low, high }, most).marks.into_iter().map(|(_, label)| label).collect::<Vec<_>>()
        };
        assert_eq!(labels(-2.3, 1.0, 6), ["10⁻²", "10⁻¹", "1", "10¹"]);
        assert_eq!(labels(-16.0, 0.0, 6), ["10⁻¹⁵", "10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "1"]);
    }

    fn labels(low: f64, high: f64) -> Vec<String> {
        ticks(Range { low, high }, 6).marks.into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_one_two_five() {
        assert_eq!(labels(0.0, 1.0), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(-0.31, 0.33), ["−0.2", "0", "0.2"]);
        assert_eq!(labels(0.0, 6.0), ["0", "1", "2", "3", "4", "5", "6"]);
        assert_eq!(labels(-12_000.0, 12_000.0), ["−10000", "−5000", "0", "5000", "10000"]);
    }

    #[test]
    fn powers_of_ten_leave_the_labels() {
        let ticks = ticks(Range { low: 0.0, high: 3e-7 }, 6);
        assert_eq!(ticks.power, -7);
        assert_eq!(ticks.marks.last().map(|(value, label)| (*value, label.as_str())), Some((3e-7, "3.0")));
    }

    #[test]
    fn any_range_has_some_ticks_and_not_too_many() {
        let ends = [0.0, 1e-310, 1e-300, 1e-9, 0.3, 0.300_000_000_1, 1.0, 7.7e20, 1e300, f64::MAX, f64::INFINITY];
        for a in ends {
            for b in ends {
                for (low, high) in [(a, b), (-a, b), (-a, -b)] {
                    let range = Range::new(low.min(high), low.max(high));
                    let around = Range::around([low, high, f64::NAN]);
                    for range in [range, around] {
                        let count = ticks(range, 6).marks.len();
                        assert!((1..=8).contains(&count), "{low:e} to {high:e}: {count} ticks in {range:?}");
                    }
                }
            }
        }
    }

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
