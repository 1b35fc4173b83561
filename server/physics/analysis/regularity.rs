//! Regularity of a run: its rotation about the fixed point, its chaos indicator, and the horizon of prediction.
//!
//! All three come from one pass over the first contacts of a run, which carries the exact derivative of the map along.

use crate::analysis::fixed_point::FixedPoint;
use crate::analysis::jacobian::eigenvalues;
use crate::analysis::linear_verdict::LinearVerdict;
use crate::analysis::repeating::RepeatingBounce;
use crate::analysis::return_map::{ARC, COMPONENTS, ReturnMap, SPIN, X, X_DOT, Y_DOT, contact_of, parts};
use crate::analysis::small_deviations::SmallDeviations;
use crate::analysis::swing::eigenvectors;
use crate::map::body::{Body, PreImpact};
use crate::map::strike::{PlannedTableMotion, State};
use crate::numbers::dispatch::{self, Kernel, dispatch};
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::run::orbit::{Contact, Orbit};
use std::f64::consts::TAU;

/// Maximum number of contacts watched. Four tangents cost about one bounce, with friction half as much again.
pub const WATCHED: u64 = 500;

/// Minimum number of turns that a rotation is averaged over. The average then has two or three digits.
pub const FEWEST: usize = 50;

/// Mean growth factor above which a run is chaotic: it tends to 2 from below for regular runs, and grows for others.
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
    /// Number of the contact, from 1.
    pub n: u64,
    /// Horizontal place of the centre of gravity, m.
    pub x: f64,
    /// Angle and velocities just before it.
    pub state: State,
    /// Length of the flight, s.
    pub flight_time: f64,
}

impl WatchedContact {
    /// A contact that has a flight after it.
    pub fn of(contact: &Contact) -> Option<Self> {
        let Contact { n, x, state, flight_time, .. } = *contact;
        flight_time.map(|flight_time| Self { n, x, state, flight_time })
    }
}

/// Watches the first contacts of a run about a bounce that repeats, up to `impacts` and [`WATCHED`]. `None` with noise.
pub fn measure_regularity(mut orbit: Orbit, small: &SmallDeviations, impacts: u64) -> Option<Regularity> {
    let first = orbit.coming();
    let mut contacts = Vec::new();
    for _ in 0..impacts.min(WATCHED) {
        let Some(contact) = WatchedContact::of(&orbit.advance()) else { break };
        contacts.push(contact);
    }
    regularity_of(&orbit.body, &first, &contacts, small)
}

/// [`measure_regularity`] of contacts that have been computed, at most [`WATCHED`] from the first one on, `first`.
pub fn regularity_of(
    body: &Body,
    first: &PreImpact,
    contacts: &[WatchedContact],
    small: &SmallDeviations,
) -> Option<Regularity> {
    if body.noise.is_some() {
        return None;
    }
    // A point mass falls straight down.
    let undisturbed = first.state.theta == 0.0 && first.state.theta_dot == 0.0;
    let flight_time = small.fixed_point.flight_time;
    let carried = if body.is_plain_rod() {
        dispatch(TangentLoop { tangents: &mut Tangents::<4>::new(body, first, flight_time), contacts })
    } else {
        Tangents::<5>::new(body, first, flight_time).carry_all::<false>(contacts)
    };
    let mut sum = 0.0;
    let growth: Vec<f64> = carried
        .iter()
        .map(|(norm, _)| {
            sum += libm::log(*norm);
            sum
        })
        .take_while(|now| now.is_finite())
        .collect();
    let mut advances = Vec::with_capacity(contacts.len());
    let mut turns = match &small.found {
        Some(bounce) => RotationCounter::about(bounce),
        None => RotationCounter::new(&small.fixed_point, &small.linear),
    };
    // One contact more than was passed, if its growth was no number.
    for (contact, (_, plan)) in contacts.iter().zip(&carried).take(growth.len() + 1) {
        advances.extend(turns.as_mut().and_then(|turns| turns.pass(contact, plan.as_ref())));
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
    let rotation = turns.map(|turns| {
        let per_turn = TAU * turns.period as f64;
        let linear = turns.rotation / per_turn;
        let measured = weighted_average(&advances).filter(|_| advances.len() >= FEWEST).map(|mean| mean / per_turn);
        Rotation { measured, linear, resonance: nearest_resonance(measured.unwrap_or(linear)) }
    });
    let chaos = (watched == WATCHED && !undisturbed).then(|| {
        let indicator = means / watched as f64;
        ChaosIndicator { indicator, chaotic: indicator > CHAOTIC, impacts: watched }
    });
    Some(Regularity { rotation, chaos, growth })
}

/// Norm of the tangents after a contact, by which they are divided, and the motion that the table had planned for it.
type Carried = (f64, Option<PlannedTableMotion>);

/// Carries tangents over contacts of a plain rod. Logarithms follow later, out of the loop.
struct TangentLoop<'a> {
    tangents: &'a mut Tangents<4>,
    contacts: &'a [WatchedContact],
}

impl Kernel for TangentLoop<'_> {
    type Output = Vec<Carried>;

    #[inline(always)]
    fn call<V: dispatch::Vector>(self) -> Self::Output {
        self.tangents.carry_all::<true>(self.contacts)
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

/// Share of the first swing below which turns are not counted: an attracting bounce's swing is then rounding or shift.
const DIED_OUT: f64 = 1e-3;

/// Counts turns about the fixed point from contact to contact, in coordinates in which the linear map is a rotation.
///
/// With u = τθ̇ the linear map of an angle with a residue is θ' = (1 − 4R)θ + u, u' = u − 4Rθ. It turns (sin σ · θ, u − 2Rθ) by σ,
/// sin σ = 2√(R(1 − R)). Elsewhere they are the imaginary and the real part of p·(s − s*), with the left eigenvector p of λ = |λ|e^{iσ}.
#[derive(Clone, Copy, Debug)]
pub struct RotationCounter {
    /// Fixed point and the two coordinates by the components of [`deviation`].
    at: [f64; ROWS],
    across: [f64; ROWS],
    along: [f64; ROWS],
    rotation: f64,
    period: u64,
    /// Least distance from the fixed point, in the coordinates; share of the first one, and itself.
    least: (f64, f64),
    angle: Option<f64>,
}

impl RotationCounter {
    /// A counter for a fixed point at which the angle circles, by its residue; `None` for other fixed points.
    pub fn new(fixed_point: &FixedPoint, linear: &LinearVerdict) -> Option<Self> {
        let residue = linear.residue?;
        let rotation = linear.rotation?;
        let sine = 2.0 * (residue * (1.0 - residue)).max(0.0).sqrt();
        let (mut across, mut along) = ([0.0; ROWS], [0.0; ROWS]);
        across[ARC] = sine;
        (along[ARC], along[SPIN]) = (-2.0 * residue, fixed_point.flight_time);
        let at = [0.0; ROWS];
        (sine > 0.0).then_some(Self { at, across, along, rotation, period: 1, least: (0.0, 0.0), angle: None })
    }

    /// A counter for a bounce that repeats, by the complex pair of eigenvalues that swings the angle most; `None` without such a pair.
    pub fn about(bounce: &RepeatingBounce) -> Option<Self> {
        let map = &bounce.map;
        let arc = map.place_of(ARC)?;
        let pairs = eigenvalues(&bounce.matrix)?.into_iter().filter(|value| value.im > 1e-9);
        let directions = pairs.filter_map(|value| Some((value, eigenvectors(&bounce.matrix, value)?)));
        let (value, (_, left)) = directions
            .max_by(|(_, (one, _)), (_, (other, _))| one[arc].norm_sqr().total_cmp(&other[arc].norm_sqr()))?;
        let rho = map.body.rod.radius_of_gyration;
        let (mut at, mut across, mut along) = ([0.0; ROWS], [0.0; ROWS], [0.0; ROWS]);
        for (p, index) in left.iter().zip(map.components()) {
            let length = if index == ARC || index == SPIN { rho } else { 1.0 };
            at[index] = bounce.at[index] / length;
            (along[index], across[index]) = (p.re * length, p.im * length);
        }
        let rotation = libm::atan2(value.im, value.re);
        Some(Self { at, across, along, rotation, period: map.period, least: (DIED_OUT, 0.0), angle: None })
    }

    /// [`RotationCounter::next`] at a contact that the map comes to after whole periods, with the motion that the table had planned for it.
    fn pass(&mut self, contact: &WatchedContact, plan: Option<&PlannedTableMotion>) -> Option<f64> {
        if (contact.n - 1).is_multiple_of(self.period) { self.next(&contact.state, contact.x, plan) } else { None }
    }

    /// The angle turned since the previous state, rad. The number of whole turns between two contacts cannot be observed, so the
    /// angle is taken within half a turn of the linear one. `None` for the first state, and at the fixed point itself.
    pub fn next(&mut self, state: &State, x: f64, plan: Option<&PlannedTableMotion>) -> Option<f64> {
        let here = parts(&PreImpact { plan: plan.copied(), ..PreImpact::at(1, x, *state) });
        let (mut across, mut along) = (0.0, 0.0);
        for (((value, at), one), other) in here.into_iter().zip(self.at).zip(self.across).zip(self.along) {
            if one != 0.0 || other != 0.0 {
                across += one * (value - at);
                along += other * (value - at);
            }
        }
        let (share, least) = self.least;
        let size = libm::hypot(across, along);
        if size == 0.0 || size < least {
            self.angle = None;
            return None;
        }
        if least == 0.0 {
            self.least.1 = share * size;
        }
        let angle = libm::atan2(across, along);
        let last = self.angle.replace(angle)?;
        let excess = angle - last - self.rotation;
        Some(self.rotation + excess - TAU * (excess / TAU).round())
    }
}

/// Number of rows of tangents: θ, ẋ, ẏ, θ̇ and x at a contact, tilt and velocities of a table that has planned its motion for it.
const ROWS: usize = COMPONENTS;

/// Rows of K tangents: rad, m/s, rad/s, m, rad, m/s.
pub type Rows<const K: usize> = [[f64; K]; ROWS];

/// Tangents of a run, carried by the exact derivative of its map: four, and a fifth where strikes depend on x.
#[derive(Clone, Copy, Debug)]
pub struct Tangents<const K: usize> {
    body: Body<Dual<K>>,
    leverage: Dual<K>,
    /// Factors that convert the rows to m/s: ρ/τ, 1, 1, ρ, 1/τ, V, 1 and 1; 0 for those that are no part of the state.
    scales: [f64; ROWS],
    /// The tangents, over their norm.
    pub rows: Rows<K>,
    plan: Option<PlannedTableMotion>,
}

impl<const K: usize> Tangents<K> {
    /// Equal deviations in each component, with a joint norm of 1 m/s, before a contact of a run with flights of about `flight_time`, s.
    pub fn new(body: &Body, first: &PreImpact, flight_time: f64) -> Self {
        let rho = body.rod.radius_of_gyration;
        let speed = 0.5 * body.rod.gravity * flight_time;
        let angle = if body.is_point { 0.0 } else { rho };
        let place = if K > X && ReturnMap::new(body, 1).components().contains(&X) { 1.0 / flight_time } else { 0.0 };
        let scales = [angle / flight_time, 1.0, 1.0, angle, place, speed, 1.0, 1.0];
        let count = scales[..K].iter().filter(|scale| **scale != 0.0).count();
        let mut rows = [[0.0; K]; ROWS];
        for index in (0..K).filter(|&index| scales[index] != 0.0) {
            rows[index][index] = 1.0 / (count as f64).sqrt() / scales[index];
        }
        let body: Body<Dual<K>> = Body { outline: None, ..*body }.map(Dual::from_f64);
        Self { leverage: body.rod.leverage(), body, scales, rows, plan: first.plan }
    }

    /// Carries the tangents over a contact and the flight after it, and gives the norm by which they are divided.
    pub fn pass(&mut self, contact: &WatchedContact) -> f64 {
        let is_plain = K == X && self.body.is_plain_rod();
        if is_plain { self.carry::<true>(contact) } else { self.carry::<false>(contact) }
    }

    /// Carries the tangents over contacts; `PLAIN` says that the body is a plain rod.
    #[inline(always)]
    fn carry_all<const PLAIN: bool>(&mut self, contacts: &[WatchedContact]) -> Vec<Carried> {
        let mut carried = Vec::with_capacity(contacts.len());
        for contact in contacts {
            let plan = self.plan;
            carried.push((self.carry::<PLAIN>(contact), plan));
        }
        carried
    }

    #[inline(always)]
    fn carry<const PLAIN: bool>(&mut self, contact: &WatchedContact) -> f64 {
        let count = if PLAIN { X } else { ROWS };
        if PLAIN {
            self.pass_plain(contact);
        } else {
            self.pass_any(contact);
        }
        // Tangent by tangent and with one division, since the next contact waits for it.
        let mut squares = [0.0; K];
        for (row, scale) in self.rows[..count].iter().zip(self.scales) {
            for (square, partial) in squares.iter_mut().zip(row) {
                *square += (scale * partial) * (scale * partial);
            }
        }
        let mut pairs = squares.chunks(2).map(|pair| pair.iter().sum::<f64>());
        let first = pairs.next().unwrap_or_default();
        let norm = pairs.fold(first, |sum, pair| sum + pair).sqrt();
        let per_norm = 1.0 / norm;
        for row in &mut self.rows[..count] {
            for partial in row {
                *partial *= per_norm;
            }
        }
        norm
    }

    #[inline(always)]
    fn pass_plain(&mut self, contact: &WatchedContact) {
        let dual = |value, row: usize| Dual { value, partials: self.rows[row] };
        let State { theta, x_dot, y_dot, theta_dot } = contact.state;
        let state = State {
            theta: dual(theta, ARC),
            x_dot: dual(x_dot, X_DOT),
            y_dot: dual(y_dot, Y_DOT),
            theta_dot: dual(theta_dot, SPIN),
        };
        let rod = &self.body.rod;
        let strike = rod.strike_with(&state, &rod.tilt(state.theta), self.leverage);
        let flight = rod.flight(&strike);
        let end = flight.end(flight.lift_root(contact.flight_time));
        for (row, component) in self.rows.iter_mut().zip([end.theta, end.x_dot, end.y_dot, end.theta_dot]) {
            *row = component.partials;
        }
    }

    fn pass_any(&mut self, contact: &WatchedContact) {
        let values = parts(&PreImpact { plan: self.plan, ..PreImpact::at(contact.n, contact.x, contact.state) });
        let lifted = std::array::from_fn(|row| Dual { value: values[row], partials: self.rows[row] });
        let coming = contact_of(contact.n, lifted, self.body.is_point, self.plan.is_some());
        let end = self.body.pass(&coming, contact.flight_time);
        self.rows = end.map_or([[f64::NAN; K]; ROWS], |end| parts(&end).map(|part| part.partials));
        self.plan = end.map_or(self.plan, |end| end.plan.map(|plan| plan.map(|part| part.value)));
    }
}
