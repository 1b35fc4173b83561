//! The little that a formula of the bounce needs of a number, so that each formula is written once and runs on plain
//! numbers, on many of them side by side, on dual numbers and whatever comes next.
//!
//! No ordering on purpose: decisions (which root, which outcome) are taken by masks, or in `f64` and lifted afterwards.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Answers to a question about a number: one, or one for each of many numbers side by side.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Tells whether any answer is yes.
    fn any(self) -> bool;

    /// Tells whether every answer is yes.
    fn all(self) -> bool;
}

impl Mask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }

    #[inline(always)]
    fn all(self) -> bool {
        self
    }
}

/// Arithmetic, root, sine and cosine, and choices by comparison: enough for the strike, the gap of a flight and its slope. It is that of one
/// number, or of many side by side.
pub trait Arithmetic:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Answers to a question about it.
    type Mask: Mask;

    /// Relative rounding of one operation.
    const UNIT: f64 = f64::EPSILON;

    /// Terms of a power series of an exponential that reach the number's last digit, and that of its derivatives, for arguments up to 1/8.
    const SERIES_TERMS: u32 = 14;

    /// The number that stands for a constant.
    fn from_f64(value: f64) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Sine and cosine of an angle in rad. Not `sin_cos`, which on `f64` is the platform's.
    fn sincos(self) -> (Self, Self);

    /// sin u and 1 − cos u of an angle in rad, both with full relative accuracy near zero.
    fn sin_versine(self) -> (Self, Self);

    /// Angle of the vector (`x`, `y`) from the x axis, rad.
    fn angle_of(y: Self, x: Self) -> Self;

    /// Tells whether it is less than another, as doubles. No comparison holds for a value that is not a number.
    fn is_less(self, other: Self) -> Self::Mask;

    /// Tells whether it is at most another, as doubles.
    fn is_at_most(self, other: Self) -> Self::Mask;

    /// The one number where `mask` says yes, the other one elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Absolute value.
    #[inline(always)]
    fn magnitude(self) -> Self {
        Self::select(self.is_less(Self::from_f64(0.0)), -self, self)
    }

    /// Tells whether it is exactly 0, with all its digits and derivatives: a part of a formula that such a number leaves out.
    #[inline(always)]
    fn is_zero(self) -> Self::Mask {
        self.magnitude().is_at_most(Self::from_f64(0.0))
    }
}

/// One number, by whose nearest double branches are decided.
pub trait Number: Arithmetic<Mask = bool> {
    /// Steps of Newton's iteration that carry a root over from doubles to this kind of number. Each doubles the degree up to which its
    /// derivatives are exact: 1, 3, 7, …
    const NEWTON_STEPS: u32 = 0;

    /// The nearest double, to decide by.
    fn to_f64(self) -> f64;
}

/// Does some work in a function of its own. Operations on large numbers do: inlined, one bounce of them would be megabytes of code.
#[inline(never)]
pub(crate) fn apart<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// Angle in rad of the point (x, y), −π to π.
/// The angle in doubles, turned by the little that is left, tan δ = δ to second order.
#[inline(always)]
pub(crate) fn angle_of<N: Number>(y: N, x: N) -> N {
    let (across, along) = (y.to_f64(), x.to_f64());
    let mut angle = N::from_f64(libm::atan2(across, along));
    for _ in 0..N::NEWTON_STEPS {
        if across == 0.0 && along == 0.0 {
            return N::from_f64(0.0);
        }
        let (sin, cos) = angle.sincos();
        angle = angle + (y * cos - x * sin) / (y * sin + x * cos);
    }
    angle
}

/// Answers for one number, by its nearest double, and its angles.
macro_rules! decided_by_double {
    () => {
        #[inline(always)]
        fn angle_of(y: Self, x: Self) -> Self {
            crate::numbers::number::angle_of(y, x)
        }

        #[inline(always)]
        fn is_less(self, other: Self) -> bool {
            self.to_f64() < other.to_f64()
        }

        #[inline(always)]
        fn is_at_most(self, other: Self) -> bool {
            self.to_f64() <= other.to_f64()
        }

        #[inline(always)]
        fn select(mask: bool, yes: Self, no: Self) -> Self {
            if mask { yes } else { no }
        }
    };
}

/// Operators of a kind of number, each by its formula; `apart` if they are functions of their own.
macro_rules! operators {
    (# $inline:tt $generics:tt $type:ty: $($rest:tt)*) => { operators!(# $inline $generics $type, apart if false: $($rest)*); };
    (# $inline:tt $generics:tt $type:ty, apart if $apart:tt: $($trait:ident $method:ident $arguments:tt $formula:block)*) => {
        $(operators!(@one # $inline $generics $type, $apart $trait $method $arguments $formula);)*
    };
    (@one # $inline:tt [$($generics:tt)*] $type:ty, $apart:tt $trait:ident $method:ident($one:ident $(, $other:ident)?) $formula:block) => {
        impl<$($generics)*> std::ops::$trait for $type {
            type Output = Self;
            # $inline
            #[allow(clippy::suspicious_arithmetic_impl, reason = "a derivative of a product is a sum")]
            #[allow(unused_braces, reason = "they make the condition one token")]
            fn $method($one $(, $other: Self)?) -> Self {
                if $apart { crate::numbers::number::apart(move || $formula) } else { $formula }
            }
        }
    };
}

pub(crate) use {decided_by_double, operators};
