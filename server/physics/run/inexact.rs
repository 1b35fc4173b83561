//! Numbers that know how far rounding may have moved them, beside their derivatives.

use crate::numbers::dual::Dual;
use crate::numbers::number::{Arithmetic, Number, decided_by_double};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A dual number, and the variance that rounding in its computation has given it. Roundings count as independent of each other, each of them as
/// the largest that it can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Inexact<const W: usize> {
    pub(crate) dual: Dual<W>,
    /// In squares of the share that one rounding is off.
    pub(crate) variance: f64,
}

impl<const W: usize> Inexact<W> {
    /// An exact number that moves like this along the directions.
    #[inline(always)]
    pub(crate) fn moving(value: f64, partials: [f64; W]) -> Self {
        Self { dual: Dual { value, partials }, variance: 0.0 }
    }

    /// The result of an operation whose operands give it this variance.
    #[inline(always)]
    fn rounded(dual: Dual<W>, variance: f64) -> Self {
        Self { dual, variance: variance + dual.value * dual.value }
    }

    /// The result of a sum: with 0 it is exact.
    #[inline(always)]
    fn sum(self, other: Self, dual: Dual<W>) -> Self {
        let is_exact = self.dual.value == 0.0 || other.dual.value == 0.0;
        let variance = self.variance + other.variance;
        if is_exact { Self { dual, variance } } else { Self::rounded(dual, variance) }
    }

    /// A function of it with this value and this slope.
    #[inline(always)]
    pub(crate) fn function(self, value: f64, slope: f64) -> Self {
        Self::rounded(self.dual.chain(value, slope), self.variance * (slope * slope))
    }
}

impl<const W: usize> Add for Inexact<W> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.sum(other, self.dual + other.dual)
    }
}

impl<const W: usize> Sub for Inexact<W> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.sum(other, self.dual - other.dual)
    }
}

impl<const W: usize> Mul for Inexact<W> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (one, two) = (self.dual.value, other.dual.value);
        Self::rounded(self.dual * other.dual, self.variance * (two * two) + other.variance * (one * one))
    }
}

impl<const W: usize> Div for Inexact<W> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.dual / other.dual;
        let (share, divisor) = (quotient.value, other.dual.value);
        Self::rounded(quotient, (self.variance + other.variance * (share * share)) / (divisor * divisor))
    }
}

impl<const W: usize> Neg for Inexact<W> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { dual: -self.dual, ..self }
    }
}

impl<const W: usize> Arithmetic for Inexact<W> {
    type Mask = bool;

    decided_by_double!(crate::numbers::trig::angle_of);

    #[inline(always)]
    fn is_zero(self) -> bool {
        self.dual.is_zero() && self.variance == 0.0
    }

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self::moving(value, [0.0; W])
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.dual.value.sqrt();
        self.function(root, 0.5 / root)
    }

    #[inline(always)]
    fn sincos(self) -> (Self, Self) {
        let (sin, cos) = self.dual.value.sincos();
        (self.function(sin, cos), self.function(cos, -sin))
    }

    #[inline(always)]
    fn sin_versine(self) -> (Self, Self) {
        let (sin, versine) = self.dual.value.sin_versine();
        (self.function(sin, 1.0 - versine), self.function(versine, sin))
    }
}

impl<const W: usize> Number for Inexact<W> {
    const NEWTON_STEPS: u32 = 1;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.dual.value
    }
}
