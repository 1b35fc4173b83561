//! Sine, cosine and versine against those of libm, and the numbers of sentences.

use equipoise_physics::numbers::rounded::rounded;
use equipoise_physics::numbers::trig::{sin_cos, sin_versine};

/// Distance in units in the last place of `expected`.
fn ulps(value: f64, expected: f64) -> f64 {
    let ulp = f64::from_bits(expected.abs().to_bits() + 1) - expected.abs();
    (value - expected).abs() / ulp
}

#[test]
fn agrees_with_libm_to_one_unit_in_the_last_place() {
    let mut angle = 1e-9;
    let mut worst: f64 = 0.0;
    while angle < 3e6 {
        for signed in [angle, -angle] {
            let (sin, cos) = sin_cos(signed);
            worst = worst.max(ulps(sin, libm::sin(signed))).max(ulps(cos, libm::cos(signed)));
        }
        angle *= 1.000_37;
    }
    assert!(worst <= 1.0, "{worst} ulp");
}

#[test]
fn holds_close_to_multiples_of_half_pi() {
    for n in 1..200_000u32 {
        let angle = f64::from(n) * std::f64::consts::FRAC_PI_2;
        let (sin, cos) = sin_cos(angle);
        assert!(ulps(sin, libm::sin(angle)) <= 1.0 && ulps(cos, libm::cos(angle)) <= 1.0, "{n}");
    }
}

#[test]
fn versine_keeps_its_digits_near_zero() {
    for exponent in 1..=150 {
        let angle = 0.7 * 0.8_f64.powi(exponent);
        let half = libm::sin(0.5 * angle);
        let (sin, versine) = sin_versine(-angle);
        assert!(ulps(versine, 2.0 * half * half) <= 3.0 && ulps(sin, -libm::sin(angle)) <= 1.0, "{angle}");
    }
    assert_eq!(sin_versine(2.0), (sin_cos(2.0).0, 1.0 - sin_cos(2.0).1));
}

#[test]
fn not_a_number_stays_one() {
    for angle in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (sin, cos) = sin_cos(angle);
        assert!(sin.is_nan() && cos.is_nan());
    }
}

#[test]
fn four_digits_are_left() {
    for (value, left) in
        [(-0.021_999_999_999_999_98, "-0.022"), (0.215_855_2, "0.2159"), (0.0, "0"), (12_345.6, "12350")]
    {
        assert_eq!(rounded(value).to_string(), left);
    }
    assert!(rounded(f64::INFINITY).is_infinite() && rounded(f64::NAN).is_nan());
}
