//! A number in a lane: the bits of `f64`, without a branch.

use crate::numbers::number::{Number, Real};
use crate::numbers::{arctangent, trig};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number that knows how far its sine and cosine reach.
pub(crate) trait Lane: Real {
    /// Largest angle, rad; beyond it they are wrong, and the caller has to look.
    const REACH: f64;

    /// Largest argument of [`Lane::arctangent`].
    const RATIO: f64;

    /// Arctangent, rad, of a number from 0 to [`Lane::RATIO`].
    fn arctangent(self) -> Self;
}

macro_rules! lane {
    ($(#[$doc:meta])* $name:ident, $reach:expr, $sincos:expr, $sin_versine:expr, $ratio:expr, $arctangent:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub(crate) struct $name(f64);

        lane!($name, Add add +, Sub sub -, Mul mul *, Div div /);

        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl Number for $name {
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                Self(value)
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.0
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }

            #[inline(always)]
            fn sincos(self) -> (Self, Self) {
                let (sin, cos) = $sincos(self.0);
                (Self(sin), Self(cos))
            }

            #[inline(always)]
            fn sin_versine(self) -> (Self, Self) {
                let (sin, versine) = $sin_versine(self.0);
                (Self(sin), Self(versine))
            }
        }

        impl Real for $name {
            #[inline(always)]
            fn magnitude(self) -> Self {
                Self(self.0.abs())
            }
        }

        impl Lane for $name {
            const REACH: f64 = $reach;
            const RATIO: f64 = $ratio;

            #[inline(always)]
            fn arctangent(self) -> Self {
                Self($arctangent(self.0))
            }
        }
    };
    ($name:ident, $($trait:ident $method:ident $operator:tt),*) => {
        $(impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        })*
    };
}

lane!(
    /// For angles that need no reduction.
    Near,
    trig::SMALL,
    |angle| (trig::sin_small(angle), trig::cos_small(angle)),
    |angle| (trig::sin_small(angle), trig::versine_small(angle)),
    arctangent::SMALL,
    arctangent::arctangent_small
);
lane!(
    /// For angles that do.
    Far,
    trig::REDUCIBLE,
    trig::sin_cos_reducible,
    trig::sin_versine_reducible,
    arctangent::REDUCIBLE,
    arctangent::arctangent_reducible
);
