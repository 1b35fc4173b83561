//! Sums of many terms, and the kinds of numbers in which whole runs are computed.

use crate::numbers::double_double::DoubleDouble;
use crate::numbers::dual::Dual;
use crate::numbers::number::{Arithmetic, Number};
use crate::numbers::taylor::Taylor;
use std::fmt::Debug;

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

/// A number in which whole runs are computed.
pub trait MapNumber: Number + Debug {
    /// A sum of many terms.
    type Sum: RunningSum<Self>;
}

/// A sum of many terms, one added after the other.
pub trait RunningSum<N>: Copy + Debug + Default {
    /// Adds a term.
    fn add(&mut self, term: N);

    /// The sum so far.
    fn value(&self) -> N;
}

impl<N: Number + Debug> RunningSum<N> for CompensatedSum<N> {
    #[inline(always)]
    fn add(&mut self, term: N) {
        CompensatedSum::add(self, term);
    }

    #[inline(always)]
    fn value(&self) -> N {
        self.value
    }
}

impl RunningSum<Self> for DoubleDouble {
    fn add(&mut self, term: Self) {
        *self = *self + term;
    }

    fn value(&self) -> Self {
        *self
    }
}

impl MapNumber for f64 {
    type Sum = CompensatedSum;
}

impl MapNumber for DoubleDouble {
    type Sum = Self;
}

impl<const K: usize> MapNumber for Dual<K> {
    type Sum = CompensatedSum<Self>;
}

impl MapNumber for Taylor {
    type Sum = CompensatedSum<Self>;
}
