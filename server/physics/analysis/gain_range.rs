//! The stable range of the tilt gain, or of a factor on a state feedback, where the bounce stays the same for every gain.
//!
//! There the derivative of the map is linear in the gain, so that the ends follow from two of them without a search
//! ([`crate::control::bounce_model`]). Not here: gains that move the bounce ([`crate::analysis::limits`]).

use crate::analysis::jacobian::{eigenvalues, modulus};
use crate::analysis::repeating::{ON_CIRCLE, RepeatingBounce, SOLVED};
use crate::analysis::return_map::{ReturnMap, Y_DOT};
use crate::control::bounce_model::crossings;
use crate::map::table::control_law::{Gains, Steering};
use nalgebra::DMatrix;

/// Share of the entries of a matrix up to which one is 0.
const ROUNDING: f64 = 1e-9;

/// A range of gains that keep small deviations bounded; empty if `lower` is above `upper`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StableGains {
    /// Lower end; −∞ if there is none.
    pub lower: f64,
    /// Upper end; ∞ if there is none.
    pub upper: f64,
}

/// Derivative of the map by a gain about the own one, for the components that act on others.
struct ByGain {
    own: DMatrix<f64>,
    per_gain: DMatrix<f64>,
    /// The determinants at the own gain, and one and two beyond.
    determinants: [f64; 3],
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

impl ByGain {
    /// `None` if the bounce moves with the gain, or if the derivative is not linear in it.
    fn of(map: &ReturnMap, bounce: &RepeatingBounce, gain: f64) -> Option<Self> {
        let at = |gain: f64| {
            let map = with_gain(map, gain);
            let found = map.derivative(&bounce.at)?;
            let off = (map.reduced(&found.image) - map.reduced(&bounce.at)).amax();
            (off <= 10.0 * SOLVED * bounce.at[Y_DOT].abs()).then_some(found.matrix)
        };
        let mut matrices = [at(gain)?, at(gain + 1.0)?, at(gain + 2.0)?];
        let size = matrices.iter().map(DMatrix::amax).fold(1.0, f64::max);
        let bend = &matrices[2] - &matrices[1] * 2.0 + &matrices[0];
        if bend.amax() > ROUNDING * size {
            return None;
        }
        // What acts on nothing else has an eigenvalue of its own, whatever the gain is.
        let alone = |matrix: &DMatrix<f64>, column: usize| {
            (0..matrix.nrows()).all(|row| row == column || matrix[(row, column)].abs() <= ROUNDING * size)
        };
        while let Some(column) = (0..matrices[0].ncols()).find(|&column| {
            let stays = (matrices[2][(column, column)] - matrices[0][(column, column)]).abs() <= ROUNDING * size;
            stays && matrices.iter().all(|matrix| alone(matrix, column))
        }) {
            matrices = matrices.map(|matrix| matrix.remove_row(column).remove_column(column));
        }
        let determinants = std::array::from_fn(|n| matrices[n].determinant());
        let [own, next, _] = matrices;
        Some(Self { per_gain: next - &own, own, determinants })
    }

    /// The largest modulus of an eigenvalue at a distance from the own gain.
    fn radius(&self, away: f64) -> f64 {
        eigenvalues(&(&self.own + &self.per_gain * away))
            .map_or(f64::INFINITY, |values| values.into_iter().map(modulus).fold(0.0, f64::max))
    }

    /// Distances from the own gain at which an eigenvalue is ±1, or two have the product 1.
    fn crossings(&self) -> Option<Vec<f64>> {
        let size = self.own.nrows();
        if size > 2 {
            return Some(crossings(&self.own, &self.per_gain)?.into_iter().map(|factor| factor - 1.0).collect());
        }
        let (trace, by_trace) = (self.own.trace(), self.per_gain.trace());
        let [determinant, next, last] = self.determinants;
        let by_determinant = next - determinant;
        if size == 2 && (last - next - by_determinant).abs() > ROUNDING * last.abs().max(1.0) {
            return None;
        }
        let of_one = |sign: f64| match size {
            2 => -(1.0 - sign * trace + determinant) / (by_determinant - sign * by_trace),
            _ => (sign - trace) / by_trace,
        };
        let mut found = vec![of_one(1.0), of_one(-1.0)];
        if size == 2 && by_determinant.abs() > ROUNDING {
            found.push((1.0 - determinant) / by_determinant);
        }
        Some(found)
    }
}

/// The range of tilt gains of a bounce that contains the own one or is next to it, or of factors on the state feedback about 1; `None` if it has
/// to be searched.
pub fn stable_gains(map: &ReturnMap, bounce: &RepeatingBounce) -> Option<StableGains> {
    let (gain, least) = match map.body().steering {
        Steering::TiltGain => (map.body().rod.tilt_gain, f64::NEG_INFINITY),
        Steering::Feedback(_) => (1.0, 0.0),
    };
    let by_gain = ByGain::of(map, bounce, gain)?;
    let mut ends: Vec<f64> = by_gain.crossings()?.into_iter().map(|away| gain + away).collect();
    ends.retain(|end| end.is_finite() && *end > least);
    ends.extend([least, f64::INFINITY]);
    ends.sort_by(f64::total_cmp);
    let between = |low: f64, high: f64| match (low.is_finite(), high.is_finite()) {
        (true, true) => 0.5 * (low + high),
        (true, false) => low + 1.0,
        (false, true) => high - 1.0,
        (false, false) => gain,
    };
    let mut ranges: Vec<StableGains> = Vec::new();
    for pair in ends.windows(2) {
        let (lower, upper) = (pair[0], pair[1]);
        if by_gain.radius(between(lower, upper) - gain) > 1.0 + ON_CIRCLE {
            continue;
        }
        match ranges.last_mut() {
            Some(last) if last.upper == lower => last.upper = upper,
            _ => ranges.push(StableGains { lower, upper }),
        }
    }
    let away = |range: &StableGains| (range.lower - gain).max(gain - range.upper).max(0.0);
    let none = StableGains { lower: f64::INFINITY, upper: f64::NEG_INFINITY };
    Some(ranges.into_iter().min_by(|one, other| away(one).total_cmp(&away(other))).unwrap_or(none))
}
