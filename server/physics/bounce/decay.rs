//! Exponential decay and its integrals, accurate for any rate from 0 on, in any kind of number.
//!
//! A power series for z = ct up to 1/8, and for a longer time as many doublings as it takes. All terms of a doubling are positive, so that
//! nothing cancels, and no exponential of a platform or library is needed.

use crate::numbers::number::{Arithmetic, Mask};

/// Largest z = ct for which the series is summed.
const SERIES_END: f64 = 0.125;

/// z = ct beyond which e^(−z) is 0 in doubles.
const NOTHING_LEFT: f64 = 800.0;

/// A velocity that decays at a rate c, after a time t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay<N> {
    /// e^(−ct): share of the velocity that is left.
    pub left: N,
    /// (1 − e^(−ct))/c, s: way of a body that starts at 1 m/s. It is t for c = 0.
    pub way: N,
    /// (t − way)/c, s²: way of a body that starts at rest and is pulled by 1 m/s². It is t²/2 for c = 0.
    pub fall: N,
}

impl<N: Arithmetic> Decay<N> {
    /// The decay at a `rate` (1/s, not negative) over a time `t` (s, not negative).
    pub fn new(rate: N, t: N) -> Self {
        let number = N::from_f64;
        let (zero, one, half) = (number(0.0), number(1.0), number(0.5));
        let (is_free, free) = (rate.is_zero(), Self { left: one, way: t, fall: half * t * t });
        if is_free.all() {
            return free;
        }
        let is_over = number(NOTHING_LEFT).is_less(rate * t);
        let (mut part, mut doublings) = (t, zero);
        loop {
            let is_long = number(SERIES_END).is_less(rate * part) & !is_over;
            if !is_long.any() {
                break;
            }
            part = N::select(is_long, half * part, part);
            doublings = N::select(is_long, doublings + one, doublings);
        }
        let z = rate * part;
        // (z − 1 + e^(−z))/z² = (1 − z/3 (1 − z/4 (1 − …)))/2.
        let mut series = one;
        for term in (3..=N::SERIES_TERMS).rev() {
            series = one - z / number(f64::from(term)) * series;
        }
        let series = half * series;
        let mean = one - z * series;
        let mut decay = Self { left: one - z * mean, way: part * mean, fall: part * part * series };
        loop {
            let doubles = zero.is_less(doublings);
            if !doubles.any() {
                break;
            }
            let Self { left, way, fall } = decay;
            let twice = Self { left: left * left, way: way * (one + left), fall: fall + fall + way * way };
            decay = Self::select(doubles, twice, decay);
            doublings = doublings - one;
        }
        if is_over.any() {
            let way = one / rate;
            decay = Self::select(is_over, Self { left: zero, way, fall: (t - way) * way }, decay);
        }
        Self::select(is_free, free, decay)
    }

    #[inline(always)]
    pub(crate) fn select(mask: N::Mask, yes: Self, no: Self) -> Self {
        Self {
            left: N::select(mask, yes.left, no.left),
            way: N::select(mask, yes.way, no.way),
            fall: N::select(mask, yes.fall, no.fall),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::double_double::DoubleDouble;
    use crate::numbers::dual::Dual;
    use crate::numbers::taylor::Taylor;

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
                let third = Decay::new(Taylor::from_f64(rate), Taylor::linear(t, 1.0, 0.0)).fall.third()[0];
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
}
