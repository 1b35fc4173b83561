//! Named numbers, one per line (`theta 0.2`), as input of the checks of formulas. People can read the corpus and new findings.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Smaller numbers count as zero, because their products would underflow and break the identities.
const LEAST: f64 = 1e-60;

/// The numbers of an input.
pub(crate) struct Numbers<'a>(BTreeMap<&'a str, f64>);

impl<'a> Numbers<'a> {
    /// Reads an input; skips lines that are not valid.
    pub(crate) fn read(data: &'a [u8]) -> Self {
        let text = std::str::from_utf8(data).unwrap_or_default();
        let lines = text.lines().filter_map(|line| line.split_once(' '));
        Self(lines.filter_map(|(name, number)| Some((name, number.trim().parse().ok()?))).collect())
    }

    /// A number, mapped into its range.
    pub(crate) fn within(&self, name: &str, range: RangeInclusive<f64>, default: f64) -> f64 {
        let number = self.0.get(name).copied().filter(|number| !number.is_nan()).unwrap_or(default);
        let number = number.clamp(*range.start(), *range.end());
        if number.abs() < LEAST { 0.0 } else { number }
    }

    /// An index below `count`.
    pub(crate) fn choice(&self, name: &str, of: usize) -> usize {
        (self.within(name, 0.0..=1e6, 0.0) as usize).min(of - 1)
    }
}
