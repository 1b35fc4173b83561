//! Derivatives by dual numbers.

use equipoise_physics::numbers::dual::{Dual, SecondOrder};
use equipoise_physics::numbers::number::Arithmetic;
use equipoise_physics::numbers::trig;

#[test]
fn sin_cos_is_ours_and_differentiates() {
    let (sin, cos) = Arithmetic::sincos(Dual::<1>::along(0.7, 0, 2.0));
    assert_eq!((sin.value, cos.value), trig::sin_cos(0.7));
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

/// The variable number `variable`, at `value`.
fn variable(value: f64, variable: usize) -> SecondOrder<2> {
    Dual::along(Dual::along(value, variable, 1.0), variable, 1.0)
}

#[test]
fn a_product_has_its_mixed_derivative() {
    let (x, y) = (variable(3.0, 0), variable(5.0, 1));
    let product = x * x * y;
    assert_eq!((product.value.value, product.value.partials), (45.0, [30.0, 9.0]));
    assert_eq!(product.partials.map(|first| first.partials), [[10.0, 6.0], [6.0, 0.0]]);
}

#[test]
fn second_derivatives_are_those_of_formulas() {
    let (x, y) = (variable(0.7, 0), variable(0.4, 1));
    let second = |number: SecondOrder<2>| number.partials.map(|first| first.partials);
    let (sin, cos) = trig::sin_cos(0.7);
    let (sine, cosine) = x.sincos();
    assert_eq!((second(sine)[0][0], second(cosine)[0][0]), (-sin, -cos));
    // √x has −¼x^(−3/2), and 1/y 2/y³.
    let one = SecondOrder::from_f64(1.0);
    assert!((second(x.sqrt())[0][0] + 0.25 / (0.7 * 0.7_f64.sqrt())).abs() < 1e-15);
    assert!((second(one / y)[1][1] - 2.0 / (0.4 * 0.4 * 0.4)).abs() < 1e-13);
}
