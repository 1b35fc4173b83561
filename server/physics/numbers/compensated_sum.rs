//! Sums of many terms.

use crate::numbers::number::Arithmetic;

/// A compensated sum (W. Kahan 1965); a plain one of numbers with more digits than doubles have. Neumaier's form is not needed where the terms
/// are smaller than the sum, or few are not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CompensatedSum<N = f64> {
    pub(crate) value: N,
    /// Part of `value` that no term gave.
    pub(crate) lost: N,
}

mapped!(CompensatedSum: value, lost);

impl<N: Arithmetic> CompensatedSum<N> {
    /// The sum of one term, never −0.
    #[inline(always)]
    pub(crate) fn of(term: N) -> Self {
        Self { value: N::from_f64(0.0) + term, lost: N::from_f64(0.0) }
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, term: N) {
        if N::UNIT < f64::EPSILON {
            self.value = self.value + term;
            return;
        }
        let term = term - self.lost;
        let next = self.value + term;
        self.lost = (next - self.value) - term;
        self.value = next;
    }
}
