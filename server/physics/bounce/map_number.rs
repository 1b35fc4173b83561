//! Kinds of numbers in which whole runs are computed: how their flights end, and how their times add up.

use crate::bounce::contact_time::TooManyPieces;
use crate::bounce::drag::flight::DragFlight;
use crate::bounce::flight::Flight;
use crate::bounce::state::State;
use crate::bounce::{contact_time, drag, lifted_contact};
use crate::numbers::compensated_sum::CompensatedSum;
use crate::numbers::double_double::{DoubleDouble, ROUNDING};
use crate::numbers::number::Number;
use crate::numbers::trig;
use std::fmt::Debug;

/// A number in which whole runs are computed.
pub trait MapNumber: Number + PartialOrd + Debug {
    /// Relative rounding of one operation.
    const UNIT: f64;

    /// A sum of many terms.
    type Sum: RunningSum<Self>;

    /// Same as [`contact_time::first_contact`].
    ///
    /// # Errors
    /// [`TooManyPieces`] where the work limit is passed; likewise in the other three.
    fn first_contact(flight: &Flight<Self>) -> Result<Self, TooManyPieces>;

    /// Same as [`contact_time::first_descent`].
    ///
    /// # Errors
    /// Same as [`MapNumber::first_contact`].
    fn first_descent(flight: &Flight<Self>) -> Result<Option<Self>, TooManyPieces>;

    /// Same as [`MapNumber::first_contact`], through air.
    ///
    /// # Errors
    /// Same as [`MapNumber::first_contact`].
    fn first_contact_in_air(flight: &DragFlight<Self>) -> Result<Self, TooManyPieces>;

    /// Same as [`MapNumber::first_descent`], through air.
    ///
    /// # Errors
    /// Same as [`MapNumber::first_contact`].
    fn first_descent_in_air(flight: &DragFlight<Self>) -> Result<Option<Self>, TooManyPieces>;

    /// Angle of a velocity from straight down, rad.
    fn fall_angle(x_dot: Self, y_dot: Self) -> Self;
}

/// A sum of many terms, one added after the other.
pub trait RunningSum<N>: Copy + Debug + Default {
    /// Adds a term.
    fn add(&mut self, term: N);

    /// The sum so far.
    fn value(&self) -> N;
}

impl RunningSum<f64> for CompensatedSum {
    #[inline(always)]
    fn add(&mut self, term: f64) {
        CompensatedSum::add(self, term);
    }

    #[inline(always)]
    fn value(&self) -> f64 {
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

    #[inline(always)]
    fn first_contact(flight: &Flight) -> Result<f64, TooManyPieces> {
        contact_time::first_contact(flight)
    }

    #[inline(always)]
    fn first_descent(flight: &Flight) -> Result<Option<f64>, TooManyPieces> {
        contact_time::first_descent(flight)
    }

    fn first_contact_in_air(flight: &DragFlight) -> Result<f64, TooManyPieces> {
        drag::contact_time::first_contact(flight)
    }

    fn first_descent_in_air(flight: &DragFlight) -> Result<Option<f64>, TooManyPieces> {
        drag::contact_time::first_descent(flight)
    }

    #[inline(always)]
    fn fall_angle(x_dot: f64, y_dot: f64) -> f64 {
        trig::atan2(x_dot, -y_dot)
    }
}

impl MapNumber for DoubleDouble {
    const UNIT: f64 = ROUNDING;
    type Sum = Self;

    fn first_contact(flight: &Flight<Self>) -> Result<Self, TooManyPieces> {
        lifted_contact::first_contact(flight)
    }

    fn first_descent(flight: &Flight<Self>) -> Result<Option<Self>, TooManyPieces> {
        lifted_contact::first_descent(flight)
    }

    fn first_contact_in_air(flight: &DragFlight<Self>) -> Result<Self, TooManyPieces> {
        lifted_contact::first_contact_in_air(flight)
    }

    fn first_descent_in_air(flight: &DragFlight<Self>) -> Result<Option<Self>, TooManyPieces> {
        lifted_contact::first_descent_in_air(flight)
    }

    /// The angle in doubles, turned by the little that is left. Its square is lost.
    fn fall_angle(x_dot: Self, y_dot: Self) -> Self {
        if x_dot == Self::from_f64(0.0) && y_dot == x_dot {
            return x_dot;
        }
        let angle = Self::from_f64(trig::atan2(x_dot.to_f64(), -y_dot.to_f64()));
        let (sin, cos) = angle.sincos();
        angle + (x_dot * cos + y_dot * sin) / (x_dot * sin - y_dot * cos)
    }
}

impl<N: Number> State<N> {
    /// The state in doubles.
    pub fn to_f64(&self) -> State {
        self.map(N::to_f64)
    }
}
