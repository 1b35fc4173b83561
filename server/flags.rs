//! Parsers of flags, whose errors name the range and the unit.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::time::Duration;

/// Parses a whole number within a range.
pub(crate) fn within<T: FromStr + PartialOrd + Display + Copy>(
    range: RangeInclusive<T>,
    unit: &'static str,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let value = text.parse().ok().filter(|value| range.contains(value));
        value.ok_or_else(|| format!("it must be a whole number from {} to {} {unit}", range.start(), range.end()))
    }
}

/// Parses yes or no, as queries do.
pub(crate) fn yes_or_no(text: &str) -> Result<bool, String> {
    match text {
        "true" | "1" => Ok(true),
        "false" | "0" => Ok(false),
        _ => Err("it must be true or false, or 1 or 0".to_owned()),
    }
}

/// Parses a time in whole seconds.
pub(crate) fn seconds(range: RangeInclusive<u64>) -> impl Fn(&str) -> Result<Duration, String> + Clone {
    let number = within(range, "seconds");
    move |text| number(text).map(Duration::from_secs)
}
