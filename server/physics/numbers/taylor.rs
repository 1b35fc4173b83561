//! Truncated Taylor numbers: polynomials of degree three in two variables, carried through a formula exactly.
//!
//! [`crate::numbers::dual`] gives first derivatives. Normal forms of a map need the second and third ones as well, and only along the
//! one or two directions in which the linear map is silent; so two variables are enough. Higher terms are dropped.

use crate::numbers::number::{Arithmetic, Number, decided_by_double, operators};

/// Number of monomials XᵃYᵇ with a + b ≤ 3.
const TERMS: usize = 10;

/// The exponents (a, b) of each coefficient: by degree, and within a degree by falling powers of X.
const EXPONENTS: [(usize, usize); TERMS] =
    [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)];

/// The place of XᵃYᵇ among the coefficients, for a + b ≤ 3.
const fn place(a: usize, b: usize) -> usize {
    let degree = a + b;
    degree * (degree + 1) / 2 + b
}

/// A polynomial in X and Y without the terms beyond degree three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taylor {
    /// Coefficients of 1, X, Y, X², XY, Y², X³, X²Y, XY² and Y³.
    coefficients: [f64; TERMS],
}

impl Taylor {
    /// `value` + `x`·X + `y`·Y.
    pub fn linear(value: f64, x: f64, y: f64) -> Self {
        let mut coefficients = [0.0; TERMS];
        (coefficients[0], coefficients[1], coefficients[2]) = (value, x, y);
        Self { coefficients }
    }

    /// The same with `square`[0] X² + `square`[1] XY + `square`[2] Y² added.
    #[must_use]
    pub fn plus_quadratic(mut self, square: [f64; 3]) -> Self {
        for (coefficient, more) in self.coefficients[3..6].iter_mut().zip(square) {
            *coefficient += more;
        }
        self
    }

    /// Coefficients of X and Y.
    pub fn first(&self) -> [f64; 2] {
        [self.coefficients[1], self.coefficients[2]]
    }

    /// Coefficients of X², XY and Y².
    pub fn second(&self) -> [f64; 3] {
        [self.coefficients[3], self.coefficients[4], self.coefficients[5]]
    }

    /// Coefficients of X³, X²Y, XY² and Y³.
    pub fn third(&self) -> [f64; 4] {
        [self.coefficients[6], self.coefficients[7], self.coefficients[8], self.coefficients[9]]
    }

    fn scale(mut self, factor: f64) -> Self {
        for coefficient in &mut self.coefficients {
            *coefficient *= factor;
        }
        self
    }

    /// f of it, from f, f′, f″/2 and f‴/6 at its value.
    fn compose(self, [value, first, second, third]: [f64; 4]) -> Self {
        let mut rest = self;
        rest.coefficients[0] = 0.0;
        let square = rest * rest;
        Self::from_f64(value) + rest.scale(first) + square.scale(second) + (square * rest).scale(third)
    }
}

operators! {
    #[inline] [] Taylor:
    Add add(self, other) {
        let mut sum = self;
        for (coefficient, more) in sum.coefficients.iter_mut().zip(other.coefficients) {
            *coefficient += more;
        }
        sum
    }
    Sub sub(self, other) { self + -other }
    Mul mul(self, other) {
        let mut coefficients = [0.0; TERMS];
        for (left, &(a, b)) in self.coefficients.iter().zip(&EXPONENTS) {
            for (right, &(c, d)) in other.coefficients.iter().zip(&EXPONENTS) {
                if a + b + c + d <= 3 {
                    coefficients[place(a + c, b + d)] += left * right;
                }
            }
        }
        Self { coefficients }
    }
    Div div(self, other) {
        let inverse = 1.0 / other.coefficients[0];
        let square = inverse * inverse;
        self * other.compose([inverse, -square, square * inverse, -square * square])
    }
    Neg neg(self) { self.scale(-1.0) }
}

impl Arithmetic for Taylor {
    type Mask = bool;

    decided_by_double!();

    fn is_zero(self) -> bool {
        self.coefficients == [0.0; TERMS]
    }

    fn from_f64(value: f64) -> Self {
        Self::linear(value, 0.0, 0.0)
    }

    fn sqrt(self) -> Self {
        let value = self.coefficients[0];
        let root = value.sqrt();
        let first = 0.5 / root;
        let second = -0.25 * first / value;
        self.compose([root, first, second, -0.5 * second / value])
    }

    fn sincos(self) -> (Self, Self) {
        let (sin, cos) = crate::numbers::trig::sin_cos(self.coefficients[0]);
        (self.compose([sin, cos, -0.5 * sin, -cos / 6.0]), self.compose([cos, -sin, -0.5 * cos, sin / 6.0]))
    }

    fn sin_versine(self) -> (Self, Self) {
        let (sin, versine) = crate::numbers::trig::sin_versine(self.coefficients[0]);
        let cos = 1.0 - versine;
        (self.compose([sin, cos, -0.5 * sin, -cos / 6.0]), self.compose([versine, sin, 0.5 * cos, -sin / 6.0]))
    }
}

impl Number for Taylor {
    const NEWTON_STEPS: u32 = 2;

    fn to_f64(self) -> f64 {
        self.coefficients[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(one: Taylor, other: Taylor) {
        for (one, other) in one.coefficients.iter().zip(other.coefficients) {
            assert!((one - other).abs() <= 1e-14 * (1.0 + other.abs()), "{one} is not {other}");
        }
    }

    fn sample() -> Taylor {
        Taylor { coefficients: [0.7, 0.3, -0.2, 0.5, 0.1, -0.4, 0.25, -0.15, 0.35, 0.05] }
    }

    #[test]
    fn powers_of_a_sum_have_binomial_coefficients() {
        let sum = Taylor::linear(0.0, 1.0, 1.0);
        assert_eq!((sum * sum).second(), [1.0, 2.0, 1.0]);
        assert_eq!((sum * sum * sum).third(), [1.0, 3.0, 3.0, 1.0]);
        assert_eq!((sum * sum * sum * sum).coefficients, [0.0; TERMS]);
    }

    #[test]
    fn functions_undo_each_other() {
        let z = sample();
        let one = Taylor::from_f64(1.0);
        close(z / z, one);
        close(z.sqrt() * z.sqrt(), z);
        let (sin, cos) = z.sincos();
        close(sin * sin + cos * cos, one);
        let (same, versine) = z.sin_versine();
        close(same, sin);
        close(one - versine, cos);
    }

    #[test]
    fn an_arctangent_undoes_sine_and_cosine() {
        let (z, size) = (sample(), Taylor::linear(0.6, -0.2, 0.3));
        let (sin, cos) = z.sincos();
        close(Taylor::angle_of(size * sin, size * cos), z);
    }

    #[test]
    fn the_sine_of_a_sum_is_that_of_trigonometry() {
        let (a, b) = (Taylor::linear(0.4, 1.0, 0.0), Taylor::linear(0.3, 0.0, 1.0));
        let ((sin_a, cos_a), (sin_b, cos_b)) = (a.sincos(), b.sincos());
        close((a + b).sincos().0, sin_a * cos_b + cos_a * sin_b);
        assert!(((a + b).sincos().0.third()[1] + 0.5 * crate::numbers::trig::sin_cos(0.7).1).abs() < 1e-15);
    }
}
