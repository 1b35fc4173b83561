//! Derivatives by dual numbers.

use equipoise_physics::numbers::dual::{Dual, SecondOrder, ThirdOrder};
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

/// Coefficients of 1, X, Y, X², XY, Y², X³, X²Y, XY² and Y³.
fn coefficients(number: ThirdOrder<2>) -> Vec<f64> {
    let value = [number.value.value.value];
    [&value[..], &number.first(), &number.value.second(), &number.third()].concat()
}

fn close(one: ThirdOrder<2>, other: ThirdOrder<2>) {
    for (one, other) in coefficients(one).into_iter().zip(coefficients(other)) {
        assert!((one - other).abs() <= 1e-14 * (1.0 + other.abs()), "{one} is not {other}");
    }
}

fn sample() -> ThirdOrder<2> {
    let [x, y] = [[1.0, 0.0], [0.0, 1.0]].map(|rates| ThirdOrder::linear(0.0, rates));
    let number = ThirdOrder::from_f64;
    ThirdOrder::linear(0.7, [0.3, -0.2]).plus_quadratic([0.5, 0.1, -0.4])
        + number(0.25) * x * x * x
        + number(-0.15) * x * x * y
        + number(0.35) * x * y * y
        + number(0.05) * y * y * y
}

#[test]
fn powers_of_a_sum_have_binomial_coefficients() {
    let sum = ThirdOrder::linear(0.0, [1.0, 1.0]);
    assert_eq!((sum * sum).value.second(), [1.0, 2.0, 1.0]);
    assert_eq!((sum * sum * sum).third(), [1.0, 3.0, 3.0, 1.0]);
    assert_eq!(coefficients(sum * sum * sum * sum), [0.0; 10]);
    let given = [0.7, 0.3, -0.2, 0.5, 0.1, -0.4, 0.25, -0.15, 0.35, 0.05];
    assert!(coefficients(sample()).into_iter().zip(given).all(|(one, other)| (one - other).abs() < 1e-16));
}

#[test]
fn functions_undo_each_other() {
    let z = sample();
    let one = ThirdOrder::from_f64(1.0);
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
    let (z, size) = (sample(), ThirdOrder::linear(0.6, [-0.2, 0.3]));
    let (sin, cos) = z.sincos();
    close(ThirdOrder::angle_of(size * sin, size * cos), z);
}

#[test]
fn the_sine_of_a_sum_is_that_of_trigonometry() {
    let (a, b) = (ThirdOrder::linear(0.4, [1.0, 0.0]), ThirdOrder::linear(0.3, [0.0, 1.0]));
    let ((sin_a, cos_a), (sin_b, cos_b)) = (a.sincos(), b.sincos());
    close((a + b).sincos().0, sin_a * cos_b + cos_a * sin_b);
    assert!(((a + b).sincos().0.third()[1] + 0.5 * trig::sin_cos(0.7).1).abs() < 1e-15);
}
