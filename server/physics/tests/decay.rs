//! The decay of velocities in air, against 31 digits, its derivatives and its limits.

use equipoise_physics::map::flight::Decay;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::numbers::dual::{Dual, ThirdOrder};
use equipoise_physics::numbers::number::Arithmetic;

/// e^z for z ≥ 0: its power series, in which nothing cancels.
fn growth(z: DoubleDouble) -> DoubleDouble {
    let mut sum = DoubleDouble::from_f64(1.0);
    for term in (1..200).rev() {
        sum = DoubleDouble::from_f64(1.0) + z / DoubleDouble::from_f64(f64::from(term)) * sum;
    }
    sum
}

const RATES: [f64; 7] = [1e-300, 1e-9, 1e-3, 0.12, 1.0, 3.7, 10.0];
const TIMES: [f64; 6] = [1e-12, 1e-6, 0.01, 0.4, 1.7, 4.0];

#[test]
fn doubles_agree_with_31_digits_and_those_with_the_exponential_series() {
    for rate in RATES {
        for t in TIMES {
            let (ours, more) = (Decay::new(rate, t), Decay::new(DoubleDouble::from(rate), DoubleDouble::from(t)));
            for (ours, more) in [(ours.left, more.left), (ours.way, more.way), (ours.fall, more.fall)] {
                let off = (DoubleDouble::from(ours) - more).to_f64().abs();
                assert!(off <= (4.0 + 16.0 * rate * t) * f64::EPSILON * more.to_f64().abs(), "{rate} {t}: {off}");
            }
            let left = DoubleDouble::from_f64(1.0) / growth(DoubleDouble::from(rate) * DoubleDouble::from(t));
            assert!((left - more.left).to_f64().abs() <= 1e-29 * left.to_f64(), "{rate} {t}");
            // Both integrals, from the velocity: 1 − left = c way and t − way = c fall.
            let rate = DoubleDouble::from(rate);
            let one = DoubleDouble::from_f64(1.0);
            assert!((one - more.left - rate * more.way).to_f64().abs() < 1e-30);
            assert!((DoubleDouble::from(t) - more.way - rate * more.fall).to_f64().abs() <= 1e-30 * t);
        }
    }
}

#[test]
fn a_rate_of_zero_is_no_decay_and_a_small_rate_nearly_none() {
    for t in TIMES {
        assert_eq!(Decay::new(0.0, t), Decay { left: 1.0, way: t, fall: 0.5 * t * t });
        let Decay { left, way, fall } = Decay::new(1e-9, t);
        assert!((1.0 - left - 1e-9 * t).abs() <= 1e-16 && (t - way).abs() <= 1e-9 * t * t);
        assert!((0.5 * t * t - fall).abs() <= 1e-9 * t * t * t + 1e-16 * t * t);
    }
}

#[test]
fn its_derivatives_are_those_of_the_decay() {
    for rate in RATES {
        for t in TIMES {
            let decay = Decay::new(rate, t);
            let Decay { left, way, fall } = Decay::new(Dual::from_f64(rate), Dual::<1>::along(t, 0, 1.0));
            let share = 1e-14 * (1.0 + rate * t);
            let near = |ours: f64, exact: f64| (ours - exact).abs() <= share * exact.abs();
            assert!(near(left.partials[0], -rate * decay.left), "{rate} {t}");
            // A way that is nearly over changes by the rest of two terms.
            assert!((way.partials[0] - decay.left).abs() <= share, "{rate} {t}");
            assert!(near(fall.partials[0], decay.way), "{rate} {t}");
            let third = Decay::new(ThirdOrder::from_f64(rate), ThirdOrder::linear(t, [1.0, 0.0])).fall.third()[0];
            assert!((third + rate * decay.left / 6.0).abs() <= 1e-12 * rate.max(1e-280), "{rate} {t} {third}");
        }
    }
}

#[test]
fn a_long_decay_ends_at_the_terminal_speed() {
    let Decay { left, way, fall } = Decay::new(10.0, 1e6);
    assert_eq!(left, 0.0);
    assert!((way - 0.1).abs() < 1e-15 && (fall - (1e6 - 0.1) / 10.0).abs() < 1e-9, "{way} {fall}");
    let (before, after) = (Decay::new(10.0, 79.999), Decay::new(10.0, 80.001));
    assert!(before.left < 1e-300 && (after.way - before.way).abs() < 1e-16);
    assert!((after.fall - before.fall - 0.002 * after.way).abs() < 1e-14);
}
