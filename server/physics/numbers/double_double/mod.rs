//! Numbers of some 31 digits, as the unevaluated sum of two doubles: the arithmetic of the reference method.
//!
//! Only what the bounce needs. No fused operations, so the bits are the same on every CPU; algorithms of T. J. Dekker (1971),
//! D. E. Knuth (1969) and, with their error bounds, M. Joldes, J.-M. Muller and V. Popescu (2017). The sine and cosine of the
//! crate that offers such numbers (`twofloat` 0.8) hold 21 digits.

mod decimal;
mod trig;

pub use decimal::SIGNIFICANT_DIGITS;

use crate::numbers::number::operators;

/// Relative error of one rounding: a fifth of the proved bound for these operations, ten times the errors that occur.
pub(crate) const ROUNDING: f64 = 2e-32;

/// A number of some 31 digits: `high + low`, where `low` is at most half a unit in the last place of `high`.
///
/// A product or quotient is off by less than 1e-31 of itself, a sum by less than 4e-32 of itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

/// a + b and what rounding it lost.
#[inline(always)]
const fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let other = sum - a;
    (sum, (a - (sum - other)) + (b - other))
}

/// The same where |a| ≥ |b| or a = 0.
#[inline(always)]
const fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// Two halves of 26 bits each.
#[inline(always)]
const fn split(a: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * a;
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// a·b and what rounding it lost.
#[inline(always)]
const fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    (product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

impl DoubleDouble {
    /// A constant given as two doubles.
    const fn of(high: f64, low: f64) -> Self {
        Self { high, low }
    }

    /// The nearest double.
    #[inline(always)]
    pub fn to_f64(self) -> f64 {
        self.high
    }

    #[inline(always)]
    fn normalized((high, low): (f64, f64)) -> Self {
        Self { high, low }
    }

    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        let (product, lost) = two_product(self.high, factor);
        Self::normalized(fast_two_sum(product, lost + self.low * factor))
    }

    #[inline(always)]
    fn squared(self) -> Self {
        let product = self.high * self.high;
        let (high, low) = split(self.high);
        let lost = ((high * high - product) + 2.0 * (high * low)) + low * low;
        Self::normalized(fast_two_sum(product, lost + 2.0 * (self.high * self.low)))
    }
}

operators! {
    #[inline(always)] [] DoubleDouble:
    Add add(self, other) {
        let (high, lost) = two_sum(self.high, other.high);
        let (low, lost_low) = two_sum(self.low, other.low);
        let (high, low) = fast_two_sum(high, lost + low);
        Self::normalized(fast_two_sum(high, lost_low + low))
    }
    Sub sub(self, other) { self + -other }
    Mul mul(self, other) {
        let (product, lost) = two_product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        Self::normalized(fast_two_sum(product, lost + cross))
    }
    Div div(self, other) {
        let first = self.high / other.high;
        let rest = self - other.scaled(first);
        Self::normalized(fast_two_sum(first, rest.high / other.high))
    }
    Neg neg(self) { Self { high: -self.high, low: -self.low } }
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_lost_is_exact() {
        for (a, b) in [(1.0 / 3.0, 3.0), (1e17, 1.0), (-0.1, 1e5 / 7.0), (5.0, -1.0 / 9.0)] {
            let (sum, lost) = two_sum(a, b);
            assert_eq!(sum, a + b);
            assert_eq!(lost, if a.abs() > b.abs() { b - (sum - a) } else { a - (sum - b) });
            let (product, lost) = two_product(a, b);
            assert_eq!(lost, a.mul_add(b, -product));
        }
    }
}
