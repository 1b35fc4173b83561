//! A sum of many terms that keeps what rounding would lose.

use super::number::Arithmetic;

/// A compensated sum (W. Kahan 1965). Neumaier's form is not needed where the terms are smaller than the sum, or few are not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompensatedSum<N = f64> {
    pub(crate) value: N,
    /// Part of `value` that no term gave.
    pub(crate) lost: N,
}

impl<N: Arithmetic> Default for CompensatedSum<N> {
    #[inline(always)]
    fn default() -> Self {
        Self { value: N::from_f64(0.0), lost: N::from_f64(0.0) }
    }
}

impl<N: Arithmetic> CompensatedSum<N> {
    #[inline(always)]
    pub(crate) fn add(&mut self, term: N) {
        let term = term - self.lost;
        let next = self.value + term;
        self.lost = (next - self.value) - term;
        self.value = next;
    }
}
