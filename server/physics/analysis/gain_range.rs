//! The stable range of the tilt gain, or of a factor on a state feedback, where the bounce stays the same for every gain.
//!
//! There the derivative of the map is linear in the gain, so that the ends follow from two of them without a search. Not here: gains that move the bounce ([`crate::analysis::limits`]).

use crate::analysis::jacobian::{eigenvalues, modulus};
use crate::analysis::repeating::{ON_CIRCLE, RepeatingBounce};
use crate::analysis::return_map::ReturnMap;
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

/// Derivative of a map by a gain about the own one.
pub(crate) struct ByGain {
    pub(crate) own: DMatrix<f64>,
    pub(crate) per_gain: DMatrix<f64>,
}

/// A map with another tilt gain, or with a factor on its state feedback.
fn with_gain(map: &ReturnMap, gain: f64) -> ReturnMap {
    let mut map = *map;
    match &mut map.body.steering {
        Steering::TiltGain => map.body.rod.tilt_gain = gain,
        Steering::Feedback(Gains { x, theta, x_dot, theta_dot }) => {
            [x, theta, x_dot, theta_dot].into_iter().for_each(|part| *part *= gain);
        }
    }
    map
}

impl ByGain {
    /// That of the components that act on others; `None` if the bounce moves with the gain, or if the derivative is not linear in it.
    fn of(bounce: &RepeatingBounce, gain: f64) -> Option<Self> {
        let at = |gain: f64| {
            let found = with_gain(&bounce.map, gain).derivative(&bounce.at)?;
            bounce.map.is_near(&bounce.at, &found.image).then_some(found.matrix)
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
        let [own, next, _] = matrices;
        let found = Self { per_gain: next - &own, own };
        // The general crossings do not hold where a pair circles already.
        (found.own.nrows() != 2 || found.determinant().is_some()).then_some(found)
    }

    /// The determinant at the own gain and its derivative by the gain, where it is linear in it.
    fn determinant(&self) -> Option<(f64, f64)> {
        let [own, next, last] = [0.0, 1.0, 2.0].map(|away| self.at(away).determinant());
        ((last - 2.0 * next + own).abs() <= ROUNDING * last.abs().max(1.0)).then_some((own, next - own))
    }

    fn at(&self, away: f64) -> DMatrix<f64> {
        &self.own + &self.per_gain * away
    }

    /// Distances from the own gain at which an eigenvalue is ±1, or two have the product 1.
    fn crossings(&self) -> Option<Vec<f64>> {
        let (trace, by_trace) = (self.own.trace(), self.per_gain.trace());
        match (self.own.nrows(), self.determinant()) {
            (0 | 1, _) => Some([1.0, -1.0].map(|sign| (sign - trace) / by_trace).to_vec()),
            (2, Some((determinant, by_determinant))) => {
                let of_one = |sign: f64| -(1.0 - sign * trace + determinant) / (by_determinant - sign * by_trace);
                let pair = (by_determinant.abs() > ROUNDING).then_some((1.0 - determinant) / by_determinant);
                Some([of_one(1.0), of_one(-1.0)].into_iter().chain(pair).collect())
            }
            _ => crossings(&self.own, &self.per_gain),
        }
    }

    /// The range of gains above `least` that contains the own one or is next to it; `None` if eigenvalues do not converge.
    pub(crate) fn stable(&self, gain: f64, least: f64) -> Option<StableGains> {
        // A difference that is rounding is 0.
        let end = |away: f64| if (gain + away).abs() <= 4.0 * f64::EPSILON * gain.abs() { 0.0 } else { gain + away };
        let mut ends: Vec<f64> = self.crossings()?.into_iter().map(end).collect();
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
            let is_stable = |away: f64| {
                let values = eigenvalues(&self.at(away));
                values.is_some_and(|values| values.into_iter().all(|value| modulus(value) <= 1.0 + ON_CIRCLE))
            };
            if !(is_stable(between(lower, upper) - gain) || (lower < gain && gain < upper && is_stable(0.0))) {
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
}

impl RepeatingBounce {
    /// The range of tilt gains of the bounce that contains the own one or is next to it, or of factors on the state feedback about 1; `None` if it
    /// has to be searched.
    pub fn stable_gains(&self) -> Option<StableGains> {
        let (gain, least) = match self.map.body.steering {
            Steering::TiltGain => (self.map.body.rod.tilt_gain, f64::NEG_INFINITY),
            Steering::Feedback(_) => (1.0, 0.0),
        };
        ByGain::of(self, gain)?.stable(gain, least)
    }
}

/// Distances g for which M = C + gD has an eigenvalue 1 or −1, or two with the product 1, in no order, for a C without any; C is `closed`
/// and D is `change`. `None` if eigenvalues do not converge.
///
/// 1/g is an eigenvalue of −(C ∓ 1)⁻¹D, or of the pencil of the second compound of M, whose eigenvalues are the products of two of M.
fn crossings(closed: &DMatrix<f64>, change: &DMatrix<f64>) -> Option<Vec<f64>> {
    let size = closed.nrows();
    let mut inverse = Vec::new();
    for sign in [1.0, -1.0] {
        let there = (closed - DMatrix::identity(size, size) * sign).try_inverse()?;
        inverse.extend(eigenvalues(&(-there * change))?);
    }
    let count = size * (size - 1) / 2;
    let there = (compound(closed, closed) - DMatrix::identity(count, count)).try_inverse()?;
    let mut pencil = DMatrix::zeros(2 * count, 2 * count);
    pencil.view_mut((0, 0), (count, count)).copy_from(&(&there * compound(closed, change) * -2.0));
    pencil.view_mut((0, count), (count, count)).copy_from(&-(&there * compound(change, change)));
    pencil.view_mut((count, 0), (count, count)).fill_with_identity();
    inverse.extend(eigenvalues(&pencil)?);
    Some(inverse.into_iter().filter(|value| value.im == 0.0).map(|value| 1.0 / value.re).collect())
}

/// The symmetric bilinear form of two matrices that is the second compound of one with itself.
fn compound(one: &DMatrix<f64>, other: &DMatrix<f64>) -> DMatrix<f64> {
    let size = one.nrows();
    let pairs: Vec<_> = (0..size).flat_map(|high| (0..high).map(move |low| (low, high))).collect();
    DMatrix::from_fn(pairs.len(), pairs.len(), |row, column| {
        let ((p, q), (r, s)) = (pairs[row], pairs[column]);
        let minor = |a: &DMatrix<f64>, b: &DMatrix<f64>| a[(p, r)] * b[(q, s)] - a[(p, s)] * b[(q, r)];
        0.5 * (minor(one, other) + minor(other, one))
    })
}
