//! Numbers with names, a line each (`theta 0.2`), as the checks of formulas read them: so that a corpus can be read, and what was
//! found can be read at once.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Smaller ones count as zero: products of those would underflow, where no identity is exact.
const LEAST: f64 = 1e-60;

/// The numbers of an input.
pub(crate) struct Numbers<'a>(BTreeMap<&'a str, f64>);

impl<'a> Numbers<'a> {
    /// Reads what can be read; lines that are none are left out.
    pub(crate) fn read(data: &'a [u8]) -> Self {
        let text = std::str::from_utf8(data).unwrap_or_default();
        let lines = text.lines().filter_map(|line| line.split_once(' '));
        Self(lines.filter_map(|(name, number)| Some((name, number.trim().parse().ok()?))).collect())
    }

    /// A number, brought into its range.
    pub(crate) fn within(&self, name: &str, range: RangeInclusive<f64>, default: f64) -> f64 {
        let number = self.0.get(name).copied().filter(|number| !number.is_nan()).unwrap_or(default);
        let number = number.clamp(*range.start(), *range.end());
        if number.abs() < LEAST { 0.0 } else { number }
    }

    /// One of so many, counted from 0.
    pub(crate) fn choice(&self, name: &str, of: usize) -> usize {
        (self.within(name, 0.0..=1e6, 0.0) as usize).min(of - 1)
    }
}
