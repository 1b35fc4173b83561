//! Regularity of a run: its rotation about the fixed point, its chaos indicator, and the horizon of prediction.
//!
//! All three come from one pass over the first contacts of a run, which carries the exact derivative of the map along.
//! Not here: what is concluded from it ([`crate::analysis::verdict`]).

use crate::analysis::fixed_point::FixedPoint;
use crate::analysis::linear_verdict::LinearVerdict;
use crate::map::body::Body;
use crate::map::friction::Friction;
use crate::map::strike::{Rod, State};
use crate::map::table::control_law::Steering;
use crate::numbers::dispatch::{Kernel, Vector, dispatch};
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::numbers::trig;
use crate::run::orbit::Orbit;
use std::f64::consts::TAU;

/// Maximum number of contacts that are watched. The four tangents of a contact cost about as much as one bounce, with friction half as
/// much again.
pub const WATCHED: u64 = 500;

/// Minimum number of turns that a rotation is averaged over. The average then has two or three digits.
pub const FEWEST: usize = 50;

/// Mean growth factor above which a run is called chaotic. It tends to 2 from below for regular runs, and grows with the length of
/// chaotic ones.
///
/// `tests/regularity.rs` measures the error rate on bodies other than those it was chosen on: 12 of 762 regular and 4 of 44
/// chaotic runs are misjudged. On the same runs the alignment of tangents (SALI) and the bare growth (FLI) separate equally well;
/// comparing a weighted average of the rotation over the two halves of a run separates half as well.
pub const CHAOTIC: f64 = 2.2;

/// Error, as a share of V, up to which a run counts as predicted.
pub const TOLERANCE: f64 = 1e-3;

/// Largest denominator of the resonances that are named.
pub const HIGHEST_ORDER: u32 = 8;

/// A rational number of turns a bounce.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Number of turns.
    pub p: u32,
    /// Number of bounces in these turns: the order of the resonance.
    pub q: u32,
    /// Absolute distance of the rotation number from p/q.
    pub distance: f64,
}

/// Mean turns a bounce about the fixed point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// Rotation of the run; `None` if the run is too short or stands at the fixed point.
    pub measured: Option<f64>,
    /// Rotation of small deviations, σ/2π.
    pub linear: f64,
    /// Resonance nearest to the measured rotation, or to the linear one if none was measured.
    pub resonance: Resonance,
}

/// Growth of small deviations from a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChaosIndicator {
    /// Mean exponential growth factor of nearby orbits (P. M. Cincotta and C. Simó, 2000): 2 for regular runs.
    pub indicator: f64,
    /// True if the indicator is above [`CHAOTIC`].
    pub chaotic: bool,
    /// Number of contacts that were watched.
    pub impacts: u64,
}

/// The measurements over the first contacts of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Regularity {
    /// `None` if small deviations do not circle.
    pub rotation: Option<Rotation>,
    /// `None` if the run ended before [`WATCHED`] contacts, or stands at the fixed point.
    pub chaos: Option<ChaosIndicator>,
    /// Logarithm of the largest growth of deviations so far, for each contact that was passed.
    pub growth: Vec<f64>,
}

impl Regularity {
    /// Cost in bounces: one for each contact and one for each of its four tangents.
    pub fn bounces(&self) -> u64 {
        5 * self.growth.len() as u64
    }

    /// Number of contacts until a deviation as large as rounding has grown to `tolerance`; both are shares of V.
    ///
    /// The growth is that of the product of the derivatives along the run, in the Frobenius norm with ρδθ divided by the flight
    /// time. `None` if it stays below ln(tolerance/rounding) over the contacts watched.
    pub fn predictable_impacts(&self, tolerance: f64) -> Option<u64> {
        let budget = libm::log(tolerance / (0.5 * f64::EPSILON));
        self.growth.iter().position(|growth| *growth >= budget).map(|index| index as u64 + 1)
    }
}

/// A contact that is watched, and the flight after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WatchedContact {
    /// Angle and velocities just before it.
    pub state: State,
    /// Length of the flight, s.
    pub flight_time: f64,
}

/// Rod and friction of a model that can be watched.
fn watched_rod(model: &Body) -> Option<(Rod, Option<Friction>)> {
    match *model {
        Body {
            rod,
            is_point: false,
            steering: Steering::TiltGain,
            constant_tilt: 0.0,
            turning,
            program: None,
            friction,
            noise: None,
            lag: 0.0,
            drag: None,
            outline: _,
        } if turning.is_none_or(|turning| !turning.acts(friction.as_ref())) => Some((rod, friction)),
        _ => None,
    }
}

/// Watches the first contacts of a run, up to `impacts` and [`WATCHED`]. `None` for a point mass, and with state feedback, noise, a delay, a
/// turning table, drag or a program of heights.
pub fn measure_regularity(
    mut orbit: Orbit,
    fixed_point: &FixedPoint,
    linear: &LinearVerdict,
    impacts: u64,
) -> Option<Regularity> {
    watched_rod(&orbit.body)?;
    let mut contacts = Vec::new();
    for _ in 0..impacts.min(WATCHED) {
        let contact = orbit.advance();
        let Some(flight_time) = contact.flight_time else { break };
        contacts.push(WatchedContact { state: contact.state, flight_time });
    }
    regularity_of(&orbit.body, &contacts, fixed_point, linear)
}

/// [`measure_regularity`] of contacts that have been computed, at most [`WATCHED`] from the first one on.
pub fn regularity_of(
    model: &Body,
    contacts: &[WatchedContact],
    fixed_point: &FixedPoint,
    linear: &LinearVerdict,
) -> Option<Regularity> {
    let (rod, friction) = watched_rod(model)?;
    let undisturbed = contacts.first().is_some_and(|first| first.state.theta == 0.0 && first.state.theta_dot == 0.0);
    let mut tangents = Tangents::new(&rod, friction, fixed_point.flight_time);
    let norms = dispatch(TangentLoop { tangents: &mut tangents, contacts });
    let growth: Vec<f64> =
        norms.into_iter().map(|norm| tangents.grow(norm)).take_while(|now| now.is_finite()).collect();
    let mut advances = Vec::with_capacity(contacts.len());
    let mut turns = RotationCounter::new(fixed_point, linear);
    // One contact more than was passed, if its growth was no number.
    for contact in &contacts[..contacts.len().min(growth.len() + 1)] {
        advances.extend(turns.as_mut().and_then(|turns| turns.next(&contact.state)));
    }
    // MEGNO: Y(n) = (2/n) Σ k ln(δ_k/δ_{k−1}), and its mean over n.
    let (mut weighted, mut means, mut last, mut largest) = (0.0, 0.0, 0.0, 0.0);
    let largest_growth = |(index, now): (usize, &f64)| {
        let n = (index + 1) as f64;
        weighted += n * (now - last);
        means += 2.0 * weighted / n;
        last = *now;
        largest = f64::max(largest, *now);
        largest
    };
    let growth: Vec<f64> = growth.iter().enumerate().map(largest_growth).collect();
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

/// Carries tangents over contacts, and gives their norm after each. Logarithms follow later, out of the loop.
struct TangentLoop<'a> {
    tangents: &'a mut Tangents,
    contacts: &'a [WatchedContact],
}

impl Kernel for TangentLoop<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn call<V: Vector>(self) -> Self::Output {
        let mut norms = Vec::with_capacity(self.contacts.len());
        for contact in self.contacts {
            norms.push(self.tangents.carry(&contact.state, contact.flight_time));
        }
        norms
    }
}

/// The nearest rational with a denominator of at most [`HIGHEST_ORDER`]; the smaller denominator wins a tie.
pub fn nearest_resonance(turns: f64) -> Resonance {
    let mut nearest = Resonance { p: 0, q: 1, distance: f64::INFINITY };
    for q in 1..=HIGHEST_ORDER {
        let p = (turns * f64::from(q)).round().max(0.0);
        let distance = (turns - p / f64::from(q)).abs();
        // The margin keeps rounding from replacing 1/4 by 2/8.
        if distance < nearest.distance - 1e-12 {
            nearest = Resonance { p: p as u32, q, distance };
        }
    }
    nearest
}

/// The average of a sequence with the weights exp(−1/(s(1 − s))), 0 < s < 1. Along a regular run it converges faster than any
/// power of the length (S. Das, Y. Saiki, E. Sander and J. A. Yorke, 2017). `None` for an empty sequence.
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

/// Counts turns about the fixed point from contact to contact, in coordinates in which the linear map is a rotation.
///
/// With u = τθ̇ the linear map is θ' = (1 − 4R)θ + u, u' = u − 4Rθ. It turns (sin σ · θ, u − 2Rθ) by σ, sin σ = 2√(R(1 − R)).
#[derive(Clone, Copy, Debug)]
pub struct RotationCounter {
    flight_time: f64,
    residue: f64,
    sine: f64,
    rotation: f64,
    angle: Option<f64>,
}

impl RotationCounter {
    /// A counter for a fixed point at which the angle circles; `None` for other fixed points.
    pub fn new(fixed_point: &FixedPoint, linear: &LinearVerdict) -> Option<Self> {
        let residue = linear.residue?;
        let rotation = linear.rotation?;
        let sine = 2.0 * (residue * (1.0 - residue)).max(0.0).sqrt();
        (sine > 0.0).then_some(Self { flight_time: fixed_point.flight_time, residue, sine, rotation, angle: None })
    }

    /// The angle turned since the previous state, rad. The number of whole turns between two contacts cannot be observed, so the
    /// angle is taken within half a turn of the linear one. `None` for the first state, and at the fixed point itself.
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

/// θ, ẋ, ẏ and θ̇ of four tangents, rad, m/s and rad/s.
pub type Rows = [[f64; 4]; 4];

/// Four tangents of a run, carried along by the exact derivative of its map. Together they are the product of the derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Tangents {
    rod: Rod<Dual<4>>,
    /// 1/ρ², 1/m².
    leverage: Dual<4>,
    friction: Option<Friction<Dual<4>>>,
    /// Factors that convert θ, ẋ, ẏ and θ̇ to m/s: ρ/τ, 1, 1 and ρ.
    scales: [f64; 4],
    /// Divided by e^growth.
    rows: Rows,
    growth: f64,
}

impl Tangents {
    /// Equal deviations in each component, with a joint norm of 1 m/s, for flights of about `flight_time`, s.
    pub fn new(rod: &Rod, friction: Option<Friction>, flight_time: f64) -> Self {
        let rho = rod.radius_of_gyration;
        let scales = [rho / flight_time, 1.0, 1.0, rho];
        let mut rows = [[0.0; 4]; 4];
        for (index, row) in rows.iter_mut().enumerate() {
            // Four deviations of 0.5 m/s have a joint norm of 1 m/s.
            row[index] = 0.5 / scales[index];
        }
        let friction = friction.map(|friction| friction.map(Dual::from_f64));
        let rod: Rod<Dual<4>> = rod.lift();
        Self { leverage: rod.leverage(), rod, friction, scales, rows, growth: 0.0 }
    }

    /// Logarithm of the growth of the product of the derivatives, in the Frobenius norm.
    pub fn growth(&self) -> f64 {
        self.growth
    }

    /// The tangents, divided by their growth.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Carries the tangents over a contact and the flight after it.
    pub fn pass(&mut self, before: &State, flight_time: f64) {
        let norm = self.carry(before, flight_time);
        self.grow(norm);
    }

    /// The growth after tangents of this norm.
    fn grow(&mut self, norm: f64) -> f64 {
        self.growth += libm::log(norm);
        self.growth
    }

    /// Carries the tangents over a contact and the flight after it, and gives the norm by which they are divided.
    #[inline(always)]
    fn carry(&mut self, before: &State, flight_time: f64) -> f64 {
        self.rows = self.carried(before, flight_time);
        // Tangent by tangent and with one division, since the next contact waits for it.
        let mut squares = [0.0; 4];
        for (row, scale) in self.rows.iter().zip(self.scales) {
            for (square, partial) in squares.iter_mut().zip(row) {
                *square += (scale * partial) * (scale * partial);
            }
        }
        let [a, b, c, d] = squares;
        let norm = ((a + b) + (c + d)).sqrt();
        let per_norm = 1.0 / norm;
        for row in &mut self.rows {
            for partial in row {
                *partial *= per_norm;
            }
        }
        norm
    }

    /// The tangents after a contact and the flight after it.
    #[inline(always)]
    fn carried(&self, before: &State, flight_time: f64) -> Rows {
        let dual = |value, row: usize| Dual { value, partials: self.rows[row] };
        let State { theta, x_dot, y_dot, theta_dot } = *before;
        let state = State {
            theta: dual(theta, 0),
            x_dot: dual(x_dot, 1),
            y_dot: dual(y_dot, 2),
            theta_dot: dual(theta_dot, 3),
        };
        let strike = match &self.friction {
            None => self.rod.strike_with(&state, &self.rod.tilt(state.theta), self.leverage),
            Some(friction) => friction.strike_by_tilt_gain(&self.rod, &state),
        };
        let flight = self.rod.flight(&strike);
        let end = flight.end(flight.lift_root(flight_time));
        [end.theta, end.x_dot, end.y_dot, end.theta_dot].map(|component| component.partials)
    }
}
