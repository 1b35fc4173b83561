//! Readers of the values of command-line flags, with errors that name the limits and the unit.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::time::Duration;

/// Reads a whole number within a range.
pub(crate) fn within<T: FromStr + PartialOrd + Display + Copy>(
    range: RangeInclusive<T>,
    unit: &'static str,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let value = text.parse().ok().filter(|value| range.contains(value));
        value.ok_or_else(|| format!("it must be a whole number from {} to {} {unit}", range.start(), range.end()))
    }
}

/// Reads a time of whole seconds.
pub(crate) fn seconds(range: RangeInclusive<u64>) -> impl Fn(&str) -> Result<Duration, String> + Clone {
    let number = within(range, "seconds");
    move |text| number(text).map(Duration::from_secs)
}
