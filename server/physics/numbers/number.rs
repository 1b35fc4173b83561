//! The little that a formula of the bounce needs of a number, so that each formula is written once and runs on plain
//! numbers, dual numbers and whatever comes next.
//!
//! No ordering on purpose: decisions (which root, which outcome) are taken in `f64` and lifted afterwards.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Arithmetic, root, sine and cosine: enough for the strike, the gap of a flight and its slope.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Terms of a power series of an exponential that reach the number's last digit, and that of its derivatives, for arguments up to 1/8.
    const SERIES_TERMS: u32 = 14;

    /// Steps of Newton's iteration that carry a root over from doubles to this kind of number. Each doubles the degree up to which its
    /// derivatives are exact: 1, 3, 7, …
    const NEWTON_STEPS: u32 = 0;

    /// Relative rounding of one operation.
    const UNIT: f64 = f64::EPSILON;

    /// The number that stands for a constant.
    fn from_f64(value: f64) -> Self;

    /// The nearest double, to decide by.
    fn to_f64(self) -> f64;

    /// Tells whether it is exactly 0, with all its digits and derivatives: a part of a formula that such a number leaves out.
    #[inline(always)]
    fn is_zero(self) -> bool {
        self.to_f64() == 0.0
    }
    /// Square root.
    fn sqrt(self) -> Self;

    /// Sine and cosine of an angle in rad. Not `sin_cos`, which on `f64` is the platform's.
    fn sincos(self) -> (Self, Self);

    /// Angle of the point (x, y) from the x axis, rad, −π to π.
    ///
    /// The angle in doubles, turned by the little that is left, tan δ = δ to second order.
    #[inline(always)]
    fn atan2(y: Self, x: Self) -> Self {
        let (across, along) = (y.to_f64(), x.to_f64());
        let mut angle = Self::from_f64(crate::numbers::trig::atan2(across, along));
        for _ in 0..Self::NEWTON_STEPS {
            if across == 0.0 && along == 0.0 {
                return Self::from_f64(0.0);
            }
            let (sin, cos) = angle.sincos();
            angle = angle + (y * cos - x * sin) / (y * sin + x * cos);
        }
        angle
    }

    /// sin u and 1 − cos u of an angle in rad, both with full relative accuracy near zero.
    fn sin_versine(self) -> (Self, Self);
}

/// A number with a size: what error bounds need. Still no ordering.
pub trait Real: Number {
    /// Absolute value.
    fn magnitude(self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }
}

impl Number for f64 {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn sincos(self) -> (Self, Self) {
        crate::numbers::trig::sin_cos(self)
    }

    #[inline(always)]
    fn sin_versine(self) -> (Self, Self) {
        crate::numbers::trig::sin_versine(self)
    }
}
