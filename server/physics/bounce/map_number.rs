//! Kinds of numbers in which whole runs are computed, and how their times add up.

use crate::bounce::state::State;
use crate::numbers::compensated_sum::CompensatedSum;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::dual::Dual;
use crate::numbers::number::Number;
use crate::numbers::second_order::SecondOrder;
use crate::numbers::taylor::Taylor;
use std::fmt::Debug;

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

impl<const K: usize> MapNumber for SecondOrder<K> {
    type Sum = CompensatedSum<Self>;
}

impl MapNumber for Taylor {
    type Sum = CompensatedSum<Self>;
}

impl<N: Number> State<N> {
    /// The state in doubles.
    pub fn to_f64(&self) -> State {
        self.map(N::to_f64)
    }
}
