//! Regularity of a run: its rotation about the fixed point, its chaos indicator, and the horizon of prediction.
//!
//! All of it comes from one watch over the first contacts of a run, with the exact derivative of the map carried along.
//! Not here: what is concluded from it ([`crate::stability::verdict`]).

use crate::body::general::GeneralBody;
use crate::bounce::friction::Friction;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::numbers::dual::Dual;
use crate::numbers::trig;
use crate::run::orbit::Orbit;
use crate::scene::model::Model;
use crate::stability::fixed_point::FixedPoint;
use crate::stability::linear_verdict::LinearVerdict;
use crate::table::control_law::Steering;
use std::f64::consts::TAU;

/// Contacts that are watched at most. Four tangents cost some four bounces each.
pub const WATCHED: u64 = 500;

/// Fewest turns from which a rotation is measured; its average has two or three digits there.
pub const FEWEST: usize = 50;

/// The mean growth factor above which a run is called chaotic. Regular ones tend to 2 from below, chaotic ones grow with
/// their length; `tests/regularity.rs` measures how often this is wrong: on other bodies than it was chosen on, 10 of 694
/// regular and 6 of 48 chaotic runs. On the same runs the alignment of tangents (SALI) and
/// the bare growth (FLI) separate as well, halves of a weighted average of the rotation half as well.
pub const CHAOTIC: f64 = 2.2;

/// Share of V that a run may be off and still be called predicted.
pub const TOLERANCE: f64 = 1e-3;

/// Largest denominator of the resonances that are named.
pub const HIGHEST_ORDER: u32 = 8;

/// A rational number of turns a bounce.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Turns.
    pub p: u32,
    /// Bounces for them: the order.
    pub q: u32,
    /// Distance of the rotation number from p/q, without sign.
    pub distance: f64,
}

/// Mean turns a bounce about the fixed point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// As the run did; none where it did not last long enough, or stands at the fixed point.
    pub measured: Option<f64>,
    /// σ/2π, that of small deviations.
    pub linear: f64,
    /// Nearest to the measured one, or to the linear one where there is none.
    pub resonance: Resonance,
}

/// Growth of small deviations from a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChaosIndicator {
    /// Mean exponential growth factor of nearby orbits (P. M. Cincotta and C. Simó, 2000): 2 for regular runs.
    pub indicator: f64,
    /// True if the indicator is above [`CHAOTIC`].
    pub chaotic: bool,
    /// Contacts that were watched for it.
    pub impacts: u64,
}

/// The measurements over the first contacts of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Regularity {
    /// `None` if small deviations do not circle.
    pub rotation: Option<Rotation>,
    /// `None` if the run ended before [`WATCHED`] contacts, or stands at the fixed point.
    pub chaos: Option<ChaosIndicator>,
    /// ln of the largest growth of deviations so far, for each contact that was passed.
    pub growth: Vec<f64>,
}

impl Regularity {
    /// Cost in bounces: one for each contact and one for each of its four tangents.
    pub fn bounces(&self) -> u64 {
        5 * self.growth.len() as u64
    }

    /// The contact before which deviations as large as rounding have grown beyond `tolerance`, both as a share of V: where
    /// ln(tolerance/rounding) is used up by the growth of the product of the derivatives along the run, in the Frobenius
    /// norm with ρδθ divided by the flight time. None where it is not used up over the contacts watched.
    pub fn predictable_impacts(&self, tolerance: f64) -> Option<u64> {
        let budget = libm::log(tolerance / (0.5 * f64::EPSILON));
        self.growth.iter().position(|growth| *growth >= budget).map(|index| index as u64 + 1)
    }
}

/// Watches the first contacts of a run, up to `impacts` and [`WATCHED`]. `None` for a point mass, and with state feedback or noise.
pub fn measure_regularity(
    mut orbit: Orbit<Model>,
    fixed_point: &FixedPoint,
    linear: &LinearVerdict,
    impacts: u64,
) -> Option<Regularity> {
    let (rod, friction) = match orbit.body {
        Model::Rod(rod) => (rod, None),
        Model::General(GeneralBody { rod, steering: Steering::TiltGain, friction, noise: None, outline: _ }) => {
            (rod, friction)
        }
        Model::General(_) | Model::Point(_) => return None,
    };
    let undisturbed = orbit.state().theta == 0.0 && orbit.state().theta_dot == 0.0;
    let mut tangents = Tangents::new(&rod, friction, fixed_point.flight_time);
    let mut turns = RotationCounter::new(fixed_point, linear);
    let (mut advances, mut growth) = (Vec::new(), Vec::new());
    // MEGNO: Y(n) = (2/n) Σ k ln(δ_k/δ_{k−1}), and its mean over n.
    let (mut weighted, mut means, mut last, mut largest) = (0.0, 0.0, 0.0, 0.0);
    for n in 1..=impacts.min(WATCHED) {
        let contact = orbit.advance();
        let Some(flight_time) = contact.flight_time else { break };
        advances.extend(turns.as_mut().and_then(|turns| turns.next(&contact.state)));
        tangents.pass(&contact.state, flight_time);
        let now = tangents.growth();
        if !now.is_finite() {
            break;
        }
        let n = n as f64;
        weighted += n * (now - last);
        means += 2.0 * weighted / n;
        last = now;
        largest = f64::max(largest, now);
        growth.push(largest);
    }
    let watched = growth.len() as u64;
    let rotation = turns.and(linear.rotation).map(|rotation| {
        let linear = rotation / TAU;
        let measured = weighted_average(&advances).filter(|_| advances.len() >= FEWEST).map(|mean| mean / TAU);
        Rotation { measured, linear, resonance: nearest_resonance(measured.unwrap_or(linear)) }
    });
    let chaos = (watched == WATCHED && !undisturbed).then(|| {
        let indicator = means / watched as f64;
        ChaosIndicator { indicator, chaotic: indicator > CHAOTIC, impacts: watched }
    });
    Some(Regularity { rotation, chaos, growth })
}

/// The nearest rational with a denominator of at most [`HIGHEST_ORDER`], the least one if there are two.
pub fn nearest_resonance(turns: f64) -> Resonance {
    let mut nearest = Resonance { p: 0, q: 1, distance: f64::INFINITY };
    for q in 1..=HIGHEST_ORDER {
        let p = (turns * f64::from(q)).round().max(0.0);
        let distance = (turns - p / f64::from(q)).abs();
        // Only a truly nearer one: 2/8 is 1/4.
        if distance < nearest.distance - 1e-12 {
            nearest = Resonance { p: p as u32, q, distance };
        }
    }
    nearest
}

/// The average of a sequence with the weights exp(−1/(s(1 − s))), 0 < s < 1: along a regular run it converges faster than any
/// power of the length (S. Das, Y. Saiki, E. Sander and J. A. Yorke, 2017). None for an empty one.
pub fn weighted_average(values: &[f64]) -> Option<f64> {
    let length = values.len() as f64 + 1.0;
    let (mut sum, mut weights) = (0.0, 0.0);
    for (index, value) in values.iter().enumerate() {
        let s = (index as f64 + 1.0) / length;
        let weight = libm::exp(-1.0 / (s * (1.0 - s)));
        sum += weight * value;
        weights += weight;
    }
    (weights > 0.0).then(|| sum / weights)
}

/// Turns about the fixed point from contact to contact, counted in the coordinates in which the linear map is a rotation.
///
/// With u = τθ̇ that map is θ' = (1 − 4R)θ + u, u' = u − 4Rθ; then (sin σ · θ, u − 2Rθ) turns by σ, sin σ = 2√(R(1 − R)).
#[derive(Clone, Copy, Debug)]
pub struct RotationCounter {
    flight_time: f64,
    residue: f64,
    sine: f64,
    rotation: f64,
    angle: Option<f64>,
}

impl RotationCounter {
    /// Turns about a fixed point at which the angle circles; none elsewhere.
    pub fn new(fixed_point: &FixedPoint, linear: &LinearVerdict) -> Option<Self> {
        let residue = linear.residue?;
        let rotation = linear.rotation?;
        let sine = 2.0 * (residue * (1.0 - residue)).max(0.0).sqrt();
        (sine > 0.0).then_some(Self { flight_time: fixed_point.flight_time, residue, sine, rotation, angle: None })
    }

    /// The angle turned since the state before, rad, within half a turn of the linear one: how many whole turns there were
    /// between two contacts is no more than a name. None for the first state, and at the fixed point itself.
    pub fn next(&mut self, state: &State) -> Option<f64> {
        let across = self.sine * state.theta;
        let along = self.flight_time * state.theta_dot - 2.0 * self.residue * state.theta;
        if across == 0.0 && along == 0.0 {
            self.angle = None;
            return None;
        }
        let angle = trig::atan2(across, along);
        let last = self.angle.replace(angle)?;
        let excess = angle - last - self.rotation;
        Some(self.rotation + excess - TAU * (excess / TAU).round())
    }
}

/// Four small deviations, carried along a run by the exact derivative of its map: the product of the derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Tangents {
    lifted: Rod<Dual<4>>,
    friction: Option<Friction>,
    /// ρ/τ and ρ, which bring angles and spins to m/s beside the velocities.
    scales: [f64; 4],
    /// θ, ẋ, ẏ and θ̇ of the four, divided by e^growth.
    rows: [[f64; 4]; 4],
    growth: f64,
}

impl Tangents {
    /// The deviations by 1 m/s in each component, for flights of some `flight_time`, s.
    pub fn new(rod: &Rod, friction: Option<Friction>, flight_time: f64) -> Self {
        let rho = rod.radius_of_gyration;
        let scales = [rho / flight_time, 1.0, 1.0, rho];
        let mut rows = [[0.0; 4]; 4];
        for (index, row) in rows.iter_mut().enumerate() {
            // Half of 1 m/s each, so that the norm of all is 1 m/s.
            row[index] = 0.5 / scales[index];
        }
        Self { lifted: rod.lift(), friction, scales, rows, growth: 0.0 }
    }

    /// ln of how much the largest has grown, by the Frobenius norm of the product.
    pub fn growth(&self) -> f64 {
        self.growth
    }

    /// Carries them over a contact and the flight after it.
    pub fn pass(&mut self, before: &State, flight_time: f64) {
        let dual = |value, row: usize| Dual { value, partials: self.rows[row] };
        let State { theta, x_dot, y_dot, theta_dot } = *before;
        let state = State {
            theta: dual(theta, 0),
            x_dot: dual(x_dot, 1),
            y_dot: dual(y_dot, 2),
            theta_dot: dual(theta_dot, 3),
        };
        let rod = &self.lifted;
        let strike = match self.friction {
            None => rod.strike(&state),
            Some(friction) => friction.strike_by_tilt_gain(rod, &state),
        };
        let flight = rod.flight(&strike);
        let end = flight.end(flight.lift_root(flight_time));
        self.rows = [end.theta, end.x_dot, end.y_dot, end.theta_dot].map(|component| component.partials);
        let mut norm_squared = 0.0;
        for (row, scale) in self.rows.iter().zip(self.scales) {
            for partial in row {
                norm_squared += (scale * partial) * (scale * partial);
            }
        }
        let norm = norm_squared.sqrt();
        self.growth += libm::log(norm);
        for partial in self.rows.iter_mut().flatten() {
            *partial /= norm;
        }
    }
}
