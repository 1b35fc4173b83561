//! Dual numbers: a value with its partial derivatives, carried through a formula exactly (forward differentiation).
//!
//! Not a general automatic differentiation library: only what [`Number`] asks for.

use crate::numbers::number::{Arithmetic, Number, decided_by_double};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its derivatives in `K` directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const K: usize> {
    /// The value itself.
    pub value: f64,
    /// Derivatives, one for each direction.
    pub partials: [f64; K],
}

impl<const K: usize> Dual<K> {
    /// A value that moves by `rate` along direction `direction` and along no other.
    ///
    /// # Panics
    /// If `direction >= K`.
    pub fn along(value: f64, direction: usize, rate: f64) -> Self {
        let mut partials = [0.0; K];
        partials[direction] = rate;
        Self { value, partials }
    }

    /// A function of it with this value and this slope.
    #[inline(always)]
    pub(crate) fn chain(self, value: f64, slope: f64) -> Self {
        let mut partials = self.partials;
        for partial in &mut partials {
            *partial *= slope;
        }
        Self { value, partials }
    }

    /// This value with the derivatives of both numbers joined.
    #[inline(always)]
    fn joined(self, other: Self, value: f64, join: impl Fn(f64, f64) -> f64) -> Self {
        let mut partials = self.partials;
        for (partial, other) in partials.iter_mut().zip(other.partials) {
            *partial = join(*partial, other);
        }
        Self { value, partials }
    }
}

impl<const K: usize> Add for Dual<K> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.joined(other, self.value + other.value, |left, right| left + right)
    }
}

impl<const K: usize> Sub for Dual<K> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.joined(other, self.value - other.value, |left, right| left - right)
    }
}

impl<const K: usize> Mul for Dual<K> {
    type Output = Self;
    #[inline(always)]
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the rule of products adds")]
    fn mul(self, other: Self) -> Self {
        self.joined(other, self.value * other.value, |left, right| other.value * left + self.value * right)
    }
}

impl<const K: usize> Div for Dual<K> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        let (inverse, slope) = (1.0 / other.value, -quotient / other.value);
        self.joined(other, quotient, |left, right| inverse * left + slope * right)
    }
}

impl<const K: usize> Neg for Dual<K> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let mut partials = self.partials;
        for partial in &mut partials {
            *partial = -*partial;
        }
        Self { value: -self.value, partials }
    }
}

impl<const K: usize> Arithmetic for Dual<K> {
    type Mask = bool;

    decided_by_double!(crate::numbers::trig::angle_of);

    #[inline(always)]
    fn is_zero(self) -> bool {
        self.value.is_zero() && self.partials.into_iter().all(f64::is_zero)
    }

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self { value, partials: [0.0; K] }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, 0.5 / root)
    }

    #[inline(always)]
    fn sincos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sincos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }

    #[inline(always)]
    fn sin_versine(self) -> (Self, Self) {
        let (sin, versine) = self.value.sin_versine();
        (self.chain(sin, 1.0 - versine), self.chain(versine, sin))
    }
}

impl<const K: usize> Number for Dual<K> {
    const NEWTON_STEPS: u32 = 1;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sin_cos_is_ours_and_differentiates() {
        let (sin, cos) = Arithmetic::sincos(Dual::<1>::along(0.7, 0, 2.0));
        assert_eq!((sin.value, cos.value), crate::numbers::trig::sin_cos(0.7));
        assert_eq!(sin.partials[0], 2.0 * cos.value);
        assert_eq!(cos.partials[0], -2.0 * sin.value);
    }

    #[test]
    fn quotient_rule() {
        let x = Dual::<1>::along(3.0, 0, 1.0);
        let one = Dual::from_f64(1.0);
        let ratio = (x * x + one) / (x - one);
        // d/dx (x² + 1)/(x − 1) = (x² − 2x − 1)/(x − 1)² = 1/2 at 3.
        assert_eq!((ratio.value, ratio.partials[0]), (5.0, 0.5));
    }
}
