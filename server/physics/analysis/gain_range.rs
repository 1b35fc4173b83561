//! The stable range of the tilt gain, or of a factor on a state feedback, where the bounce stays the same for every gain.
//!
//! There the derivative of the map is linear in the gain, and with one input so is its characteristic polynomial: the ends follow from two of
//! them without a search ([`crate::control::margin`]). Not here: gains that move the bounce ([`crate::analysis::limits`]).

use crate::analysis::jacobian::{eigenvalues, modulus};
use crate::analysis::repeating::{ON_CIRCLE, RepeatingBounce, SOLVED};
use crate::analysis::return_map::{ReturnMap, Y_DOT};
use crate::control::margin::{characteristic, critical_values};
use crate::map::table::control_law::{Gains, Steering};
use nalgebra::DMatrix;

/// Share of the coefficients of a polynomial up to which one is 0.
const ROUNDING: f64 = 1e-9;

/// Distance from the unit circle, in values of the gain, at which the stability between two ends is read.
const BESIDE: f64 = 1.0;

/// A range of gains that keep small deviations bounded; empty if `lower` is above `upper`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StableGains {
    /// Its lower end, or −∞.
    pub lower: f64,
    /// Its upper end, or ∞.
    pub upper: f64,
}

impl StableGains {
    /// No gain.
    const NONE: Self = Self { lower: f64::INFINITY, upper: f64::NEG_INFINITY };
}

/// Characteristic polynomials without the factors of the neutral directions and of the height, the constant coefficient first, by a gain:
/// `without` + gain · `per_gain`.
struct Polynomials {
    without: Vec<f64>,
    per_gain: Vec<f64>,
}

/// The map with another tilt gain, or with a factor on its state feedback.
fn with_gain(map: &ReturnMap, gain: f64) -> ReturnMap {
    let mut body = *map.body();
    match &mut body.steering {
        Steering::TiltGain => body.rod.tilt_gain = gain,
        Steering::Feedback(Gains { x, theta, x_dot, theta_dot }) => {
            [x, theta, x_dot, theta_dot].into_iter().for_each(|part| *part *= gain);
        }
    }
    map.with_body(&body)
}

impl Polynomials {
    /// Those about a bounce; `None` if the bounce moves with the gain, or if the polynomials are not linear in it.
    fn of(map: &ReturnMap, bounce: &RepeatingBounce) -> Option<Self> {
        let fall = map.components().iter().position(|&index| index == Y_DOT)?;
        let apart = bounce.moves_alone(fall);
        let at = |gain: f64| {
            let map = with_gain(map, gain);
            let found = map.derivative(&bounce.at)?;
            let off = (map.reduced(&found.image) - map.reduced(&bounce.at)).amax();
            let matrix = if apart { found.matrix.remove_row(fall).remove_column(fall) } else { found.matrix };
            (off <= 10.0 * SOLVED * bounce.at[Y_DOT].abs()).then(|| characteristic(&matrix))
        };
        let (mut without, one, two) = (at(0.0)?, at(1.0)?, at(2.0)?);
        let size = without.iter().chain(&two).fold(1.0_f64, |size, part| size.max(part.abs()));
        let mut per_gain: Vec<f64> = one.iter().zip(&without).map(|(one, zero)| one - zero).collect();
        let bends = |n: usize| (two[n] - one[n] - per_gain[n]).abs() > ROUNDING * size;
        if (0..two.len()).any(bends) {
            return None;
        }
        let vanishes = |polynomial: &[f64]| polynomial.iter().sum::<f64>().abs() <= ROUNDING * size;
        while without.len() > 1 && vanishes(&without) && vanishes(&per_gain) {
            (without, per_gain) = (less_one(&without), less_one(&per_gain));
        }
        Some(Self { without, per_gain })
    }

    /// The largest modulus of a root for a gain.
    fn radius(&self, gain: f64) -> f64 {
        let degree = self.without.len() - 1;
        let coefficient = |n: usize| self.without[n] + gain * self.per_gain[n];
        let companion = DMatrix::from_fn(degree, degree, |row, column| match (row, column) {
            (row, column) if column + 1 == degree => -coefficient(row),
            (row, column) if row == column + 1 => 1.0,
            _ => 0.0,
        });
        if degree == 0 {
            return 0.0;
        }
        eigenvalues(&companion).map_or(f64::INFINITY, |values| values.into_iter().map(modulus).fold(0.0, f64::max))
    }
}

/// A polynomial divided by z − 1.
fn less_one(polynomial: &[f64]) -> Vec<f64> {
    let mut quotient: Vec<f64> = polynomial[1..].to_vec();
    for n in (0..quotient.len().saturating_sub(1)).rev() {
        quotient[n] += quotient[n + 1];
    }
    quotient
}

/// The range of tilt gains of a bounce that contains the own one or is next to it, or of factors on the state feedback about 1; `None` if it has
/// to be searched.
pub fn stable_gains(map: &ReturnMap, bounce: &RepeatingBounce) -> Option<StableGains> {
    let polynomials = Polynomials::of(map, bounce)?;
    let (own, least) = match map.body().steering {
        Steering::TiltGain => (map.body().rod.tilt_gain, f64::NEG_INFINITY),
        Steering::Feedback(_) => (1.0, 0.0),
    };
    let mut ends = critical_values(&polynomials.without, &polynomials.per_gain);
    ends.retain(|end| end.is_finite() && *end > least);
    ends.extend([least, f64::INFINITY]);
    ends.sort_by(f64::total_cmp);
    let between = |low: f64, high: f64| match (low.is_finite(), high.is_finite()) {
        (true, true) => 0.5 * (low + high),
        (true, false) => low + BESIDE,
        (false, true) => high - BESIDE,
        (false, false) => own,
    };
    let mut ranges: Vec<StableGains> = Vec::new();
    for pair in ends.windows(2) {
        let (lower, upper) = (pair[0], pair[1]);
        if polynomials.radius(between(lower, upper)) > 1.0 + ON_CIRCLE {
            continue;
        }
        match ranges.last_mut() {
            Some(last) if last.upper == lower => last.upper = upper,
            _ => ranges.push(StableGains { lower, upper }),
        }
    }
    let away = |range: &StableGains| (range.lower - own).max(own - range.upper).max(0.0);
    let nearest = ranges.into_iter().min_by(|one, other| away(one).total_cmp(&away(other)));
    Some(nearest.unwrap_or(StableGains::NONE))
}
