//! Kinds of numbers in which whole runs are computed, and how their times add up.

use crate::bounce::state::State;
use crate::numbers::compensated_sum::CompensatedSum;
use crate::numbers::double_double::{DoubleDouble, ROUNDING};
use crate::numbers::dual::Dual;
use crate::numbers::number::Number;
use crate::numbers::second_order::SecondOrder;
use crate::numbers::taylor::Taylor;
use crate::numbers::trig;
use std::fmt::Debug;

/// A number in which whole runs are computed.
pub trait MapNumber: Number + Debug {
    /// Relative rounding of one operation.
    const UNIT: f64;

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
    const UNIT: f64 = f64::EPSILON;
    type Sum = CompensatedSum;
}

impl MapNumber for DoubleDouble {
    const UNIT: f64 = ROUNDING;
    type Sum = Self;
}

impl<const K: usize> MapNumber for Dual<K> {
    const UNIT: f64 = f64::EPSILON;
    type Sum = CompensatedSum<Self>;
}

impl<const K: usize> MapNumber for SecondOrder<K> {
    const UNIT: f64 = f64::EPSILON;
    type Sum = CompensatedSum<Self>;
}

impl MapNumber for Taylor {
    const UNIT: f64 = f64::EPSILON;
    type Sum = CompensatedSum<Self>;
}

/// Angle of a velocity from straight down, rad: that of doubles, turned by the little that is left, tan δ = δ to second order.
#[inline(always)]
pub fn fall_angle<N: Number>(x_dot: N, y_dot: N) -> N {
    let (across, down) = (x_dot.to_f64(), -y_dot.to_f64());
    let mut angle = N::from_f64(trig::atan2(across, down));
    if across == 0.0 && down == 0.0 && N::NEWTON_STEPS > 0 {
        return N::from_f64(0.0);
    }
    for _ in 0..N::NEWTON_STEPS {
        let (sin, cos) = angle.sincos();
        angle = angle + (x_dot * cos + y_dot * sin) / (x_dot * sin - y_dot * cos);
    }
    angle
}

impl<N: Number> State<N> {
    /// The state in doubles.
    pub fn to_f64(&self) -> State {
        self.map(N::to_f64)
    }
}
