//! Numbers of second order: a value with its first and second partial derivatives, carried through a formula exactly.
//!
//! [`crate::numbers::dual`] has first derivatives only; [`crate::numbers::taylor`] has third ones of two variables.

use crate::numbers::number::{Arithmetic, Number, decided_by_double};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its derivatives by `K` variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondOrder<const K: usize> {
    /// The value itself.
    pub value: f64,
    /// First derivatives.
    pub first: [f64; K],
    /// Second derivatives; the matrix is symmetric.
    pub second: [[f64; K]; K],
}

impl<const K: usize> SecondOrder<K> {
    /// The variable number `variable`, at `value`.
    ///
    /// # Panics
    /// If `variable >= K`.
    pub fn variable(value: f64, variable: usize) -> Self {
        let mut first = [0.0; K];
        first[variable] = 1.0;
        Self { value, first, second: [[0.0; K]; K] }
    }

    /// f of it, from f, f′ and f″ at its value.
    #[inline(always)]
    fn compose(&self, value: f64, slope: f64, bend: f64) -> Self {
        Self {
            value,
            first: std::array::from_fn(|i| slope * self.first[i]),
            second: std::array::from_fn(|i| {
                std::array::from_fn(|j| slope * self.second[i][j] + bend * (self.first[i] * self.first[j]))
            }),
        }
    }

    /// f of two numbers that is linear in them.
    #[inline(always)]
    fn combine(&self, other: &Self, value: f64, left: f64, right: f64) -> Self {
        Self {
            value,
            first: std::array::from_fn(|i| left * self.first[i] + right * other.first[i]),
            second: std::array::from_fn(|i| {
                std::array::from_fn(|j| left * self.second[i][j] + right * other.second[i][j])
            }),
        }
    }
}

impl<const K: usize> Add for SecondOrder<K> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.combine(&other, self.value + other.value, 1.0, 1.0)
    }
}

impl<const K: usize> Sub for SecondOrder<K> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.combine(&other, self.value - other.value, 1.0, -1.0)
    }
}

impl<const K: usize> Mul for SecondOrder<K> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let mut product = self.combine(&other, self.value * other.value, other.value, self.value);
        for i in 0..K {
            for j in 0..K {
                product.second[i][j] += self.first[i] * other.first[j] + other.first[i] * self.first[j];
            }
        }
        product
    }
}

impl<const K: usize> Div for SecondOrder<K> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.value;
        let square = inverse * inverse;
        let mut quotient = self * other.compose(inverse, -square, 2.0 * square * inverse);
        quotient.value = self.value / other.value;
        quotient
    }
}

impl<const K: usize> Neg for SecondOrder<K> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.compose(-self.value, -1.0, 0.0)
    }
}

impl<const K: usize> Arithmetic for SecondOrder<K> {
    type Mask = bool;

    decided_by_double!(crate::numbers::trig::angle_of);

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self { value, first: [0.0; K], second: [[0.0; K]; K] }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let slope = 0.5 / root;
        self.compose(root, slope, -0.5 * slope / self.value)
    }

    #[inline(always)]
    fn sincos(self) -> (Self, Self) {
        let (sin, cos) = crate::numbers::trig::sin_cos(self.value);
        (self.compose(sin, cos, -sin), self.compose(cos, -sin, -cos))
    }

    #[inline(always)]
    fn sin_versine(self) -> (Self, Self) {
        let (sin, versine) = crate::numbers::trig::sin_versine(self.value);
        let cos = 1.0 - versine;
        (self.compose(sin, cos, -sin), self.compose(versine, sin, cos))
    }
}

impl<const K: usize> Number for SecondOrder<K> {
    const NEWTON_STEPS: u32 = 2;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(one: SecondOrder<2>, other: SecondOrder<2>) {
        let parts = |number: SecondOrder<2>| {
            let [[a, b], [c, d]] = number.second;
            [number.value, number.first[0], number.first[1], a, b, c, d]
        };
        for (one, other) in parts(one).into_iter().zip(parts(other)) {
            assert!((one - other).abs() < 1e-14, "{one} is not {other}");
        }
    }

    #[test]
    fn a_product_has_its_mixed_derivative() {
        let (x, y) = (SecondOrder::<2>::variable(3.0, 0), SecondOrder::variable(5.0, 1));
        let product = x * x * y;
        assert_eq!((product.value, product.first, product.second), (45.0, [30.0, 9.0], [[10.0, 6.0], [6.0, 0.0]]));
    }

    #[test]
    fn functions_undo_each_other() {
        let (x, y) = (SecondOrder::<2>::variable(0.7, 0), SecondOrder::variable(0.4, 1));
        let z = x * y + x;
        let one = SecondOrder::from_f64(1.0);
        close(z / z, one);
        close(z.sqrt() * z.sqrt(), z);
        let (sin, cos) = z.sincos();
        close(sin * sin + cos * cos, one);
        let (same, versine) = z.sin_versine();
        close(same, sin);
        close(one - versine, cos);
    }
}
