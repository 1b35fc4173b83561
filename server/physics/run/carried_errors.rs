//! Errors of a run just before a contact: the rounding of every bounce, carried forward by the exact derivative of the map.
//!
//! Derivatives and roundings are those of [`Inexact`] numbers over the map itself, in two steps: over a strike, and over the flight after it.
//! Errors of the table are drawn as doubles, so a run with 31 digits has the same, and they are not rounded. Norms of derivatives alone would
//! explode, since they forget that the next bounce turns what the last one stretched; a covariance does not.

use crate::map::body::{Arrival, Body, PreImpact};
use crate::map::bounce::{Approach, LEAST_FLIGHT};
use crate::map::contact_time;
use crate::map::flight::{Flight, Gap};
use crate::map::friction::actual_branch;
use crate::map::strike::{PlannedTableMotion, State, Strike};
use crate::map::table::noise::NoiseModel;
use crate::numbers::covariance::Covariance;
use crate::numbers::dispatch::{Kernel, PortableVector, Vector, dispatch};
use crate::numbers::lanes::row::Row;
use crate::numbers::number::{Arithmetic, Number};
use crate::run::inexact::{Inexact, Origin};
use crate::run::orbit::Contact;
use crate::scene::{Name, Scene};
use std::cell::Cell;
use std::f64::consts::FRAC_PI_2;

/// Standard deviations in a bound, each rounding counted as the largest that it can be. No error of 6,000 random runs with two to four features
/// passed 0.6 of its bound, and none of other scenes 0.85; `tests/error_estimate.rs` holds it against runs with 31 digits.
pub const SAFETY: f64 = 3.0;

/// Share of every rounding that is taken to be the same at each bounce: where a run comes to rest or repeats, so do they, and
/// what would grow with the root of the number of bounces grows with the number.
const REPEATING: f64 = 0.15;

/// Half a unit in the last place, as a share: the most that one rounding is off.
pub(crate) const ROUNDING: f64 = 0.5 * f64::EPSILON;

/// Roundings of the radius of gyration, which stands for all factors of a strike that are the same at every bounce, such as 1/ρ² and 1 − κ.
const REPEATED_ROUNDINGS: f64 = 1.5;

/// A contact is too near to grazing for a derivative to say anything when the bound on its speed is this share of it.
const GRAZING_SHARE: f64 = 0.25;

/// States that carry errors, in their order; a body has the first of them that it needs. After these come tilt and velocities of a
/// planned table.
const THETA: usize = 0;
const X_DOT: usize = 1;
const Y_DOT: usize = 2;
const THETA_DOT: usize = 3;
const ENERGY: usize = 4;
const X: usize = 5;
const HEIGHT: usize = 6;
const PLAN: usize = 7;
const MOST_STATES: usize = 10;

/// A contact that a flight follows, in doubles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounce {
    before: PreImpact,
    after: State,
    /// Length of the flight, s.
    flight_time: f64,
}

impl Bounce {
    #[inline(always)]
    pub(crate) fn of<N: Number>(contact: &Contact<N>) -> Option<Self> {
        let Contact { n, x, state, clearance, strike, flight_time, .. } = contact;
        let before = PreImpact { clearance: clearance.to_f64(), ..PreImpact::at(*n, x.to_f64(), state.to_f64()) };
        Some(Self { before, after: strike.as_ref()?.after.to_f64(), flight_time: (*flight_time)?.to_f64() })
    }
}

/// Numbers with the instructions of every CPU.
type Portable<const W: usize> = Inexact<PortableVector, W>;

/// The body of a run whose numbers have the rounding with which they follow from the scene.
fn rounded_body<const W: usize>(scene: &Scene) -> Body<Portable<W>> {
    let mut body: Body<Portable<W>> = scene.body_by(|_, value| Inexact::from_f64(value));
    if scene.number(Name::Incline) == Some(FRAC_PI_2) {
        body.rod.gravity.variance = 0.0;
    }
    if !scene.is_point() {
        let rho = &mut body.rod.radius_of_gyration;
        let rounded = REPEATED_ROUNDINGS * rho.to_f64();
        rho.variance = rounded * rounded;
    }
    if body.friction.is_some() {
        // Its strike divides γ by 1 + e and multiplies by it.
        let rounded = body.rod.strike_gain.to_f64();
        body.rod.strike_gain.variance += rounded * rounded;
    }
    // Vertices do not change a run that goes on.
    Body { outline: None, ..body }
}

pub(crate) fn rounded_parameters(scene: &Scene) -> usize {
    let count = Cell::new(0);
    rounded_body::<8>(scene).map(|number| {
        count.set(count.get() + usize::from(number.variance != 0.0));
        number
    });
    count.get()
}

/// Errors of the first `S` states of a run, in `W` directions of dual numbers: the states, parameters that are off by the same at every bounce,
/// and in the last one the contact time.
#[derive(Clone, Copy, Debug)]
pub struct CarriedErrors<const S: usize, const W: usize> {
    /// Parameters, with one standard deviation of each in its direction; a run with 31 digits has them to its own digits.
    body: Body<Portable<W>>,
    errors: StateErrors<S, W>,
}

/// The errors beside the parameters.
#[derive(Clone, Copy, Debug)]
struct StateErrors<const S: usize, const W: usize> {
    holds_energy: bool,
    /// True from the first strike on, which sets the energy that is held.
    has_energy: bool,
    /// Covariance of the independent errors.
    covariance: Covariance<S, W>,
    /// Each state moves along its own direction, and has an error by each parameter.
    states: [Row<W>; S],
    plan: Option<PlannedTableMotion>,
    /// The most that one rounding is off, as a share.
    unit: f64,
    /// Standard deviation of a rounding, as a share, at this bounce.
    rounding: f64,
    /// True once derivatives say nothing any more.
    lost: bool,
}

impl<const S: usize, const W: usize> CarriedErrors<S, W> {
    pub(crate) const PARAMETERS: usize = W - 1 - S;

    /// `BALLISTIC`: a body that [`lands_plainly`].
    pub(crate) fn new<const BALLISTIC: bool>(scene: &Scene, first: f64, unit: f64) -> Self {
        let next = Cell::new(S);
        let body = rounded_body(scene).map(|mut number: Portable<W>| {
            if number.variance != 0.0 {
                // What is left shares the last one.
                number.partials.0[next.get().min(W - 2)] = unit * number.variance.sqrt();
                (number.variance, number.origin) = (0.0, Origin::Given);
                next.set(next.get() + 1);
            }
            number
        });
        let mut errors = StateErrors {
            holds_energy: scene.rules().holds_energy,
            has_energy: false,
            covariance: Covariance::ZERO,
            states: std::array::from_fn(Row::unit),
            plan: None,
            unit,
            rounding: unit,
            lost: false,
        };
        if first > 0.0 {
            let release = scene.release().map(Inexact::from_f64);
            let flight = Flight { drag: body.drag, ..body.rod.flight_from(&release) };
            errors.fly::<_, BALLISTIC>(&body, &flight, 1, release.x, first);
        }
        Self { body, errors }
    }

    #[inline(always)]
    pub(crate) fn bound(&self) -> f64 {
        let Self { body, errors, .. } = self;
        if errors.lost {
            return f64::INFINITY;
        }
        let rho = body.rod.radius_of_gyration.to_f64();
        let variance =
            |state: usize| errors.covariance.variance(state).max(0.0) + of_parameters::<S, W>(&errors.states[state]);
        let turned = if body.is_point { 0.0 } else { rho * rho * variance(THETA) };
        let (x_dot, y_dot, spin) = (variance(X_DOT), variance(Y_DOT), rho * rho * variance(THETA_DOT));
        if (turned + x_dot + y_dot + spin).is_finite() {
            SAFETY * turned.max(x_dot).max(y_dot).max(spin).sqrt()
        } else {
            f64::INFINITY
        }
    }

    /// Goes on over a strike and its ballistic flight to a table that strikes just at the end. `PLAIN`: a plain rod, whose bounce has no other
    /// part of a body in it.
    #[inline(always)]
    pub(crate) fn pass_ballistic<const PLAIN: bool>(&mut self, contact: &Bounce) {
        let Self { body, errors } = self;
        if !errors.lost {
            // Functions that are not inlined have no better instructions.
            dispatch(BounceErrors::<S, W, PLAIN> { body, errors, contact });
        }
    }

    /// Goes on over any strike and flight.
    pub(crate) fn pass(&mut self, contact: &Bounce) {
        let Self { body, errors } = self;
        if !errors.lost {
            errors.pass::<_, false, false>(body, contact);
        }
    }
}

/// The errors carried over a bounce with a ballistic flight to a table that strikes just at its end.
struct BounceErrors<'a, const S: usize, const W: usize, const PLAIN: bool> {
    body: &'a Body<Portable<W>>,
    errors: &'a mut StateErrors<S, W>,
    contact: &'a Bounce,
}

impl<const S: usize, const W: usize, const PLAIN: bool> Kernel for BounceErrors<'_, S, W, PLAIN> {
    type Output = ();

    #[inline(always)]
    fn call<V: Vector>(self) {
        let body = if PLAIN {
            Body::plain(self.body.rod.map(Inexact::in_vectors::<V>))
        } else {
            self.body.map(Inexact::in_vectors::<V>)
        };
        self.errors.pass::<V, PLAIN, true>(&body, self.contact);
    }
}

impl<const S: usize, const W: usize> StateErrors<S, W> {
    /// The last direction.
    const ASIDE: usize = W - 1;

    /// 1 at each parameter.
    #[inline(always)]
    fn parameters() -> Row<W> {
        let mut parameters = Row::ZERO;
        parameters.0[S..Self::ASIDE].fill(1.0);
        parameters
    }

    /// A number that moves along the direction of a state, if that is one of the states.
    #[inline(always)]
    fn along<V: Vector>(&self, value: f64, state: usize) -> Inexact<V, W> {
        if state < S {
            Inexact::given(value, self.states[state], Origin::State(state))
        } else {
            Inexact::from_f64(value)
        }
    }

    #[inline(always)]
    fn along_state<V: Vector>(&self, state: &State) -> State<Inexact<V, W>> {
        State {
            theta: self.along(state.theta, THETA),
            x_dot: self.along(state.x_dot, X_DOT),
            y_dot: self.along(state.y_dot, Y_DOT),
            theta_dot: self.along(state.theta_dot, THETA_DOT),
        }
    }

    /// Goes on over a strike and its flight. `PLAIN`: a plain rod. `BALLISTIC`: no air, and a strike just at the end.
    #[inline(always)]
    fn pass<V: Vector, const PLAIN: bool, const BALLISTIC: bool>(
        &mut self,
        body: &Body<Inexact<V, W>>,
        contact: &Bounce,
    ) {
        let Bounce { before: PreImpact { n, x, clearance, state, .. }, after, flight_time } = *contact;
        self.rounding = self.unit * (1.0 + 2.0 * REPEATING * REPEATING * n as f64).sqrt();
        let before = PreImpact {
            n,
            x: self.along(x, X),
            clearance: self.along(clearance, HEIGHT),
            state: self.along_state(&state),
            plan: self.plan.map(|plan| PlannedTableMotion {
                alpha: self.along(plan.alpha, PLAN),
                normal_velocity: self.along(plan.normal_velocity, PLAN + 1),
                tangential_velocity: self.along(plan.tangential_velocity, PLAN + 2),
            }),
        };
        let rod = &body.rod;
        let mut struck: Strike<_> =
            if PLAIN { rod.strike(&before.state) } else { body.strike_deciding(&before, actual_branch) };
        let mut energy = Inexact::from_f64(0.0);
        if self.holds_energy {
            let own = struck.energy;
            let held = if self.has_energy { self.along(own.to_f64(), ENERGY) } else { own };
            energy = rod.hold_energy(&mut struck, held);
            self.has_energy = true;
        }
        let (sin, cos) = (struck.sin_cos_theta.0.to_f64(), struck.sin_cos_theta.1.to_f64());
        self.carry(&struck.after, energy, before.x, before.clearance, None, None);
        let start = self.along_state(&after);
        let flight = Flight {
            start,
            sin_cos_theta: (start.theta.function(sin, cos), start.theta.function(cos, -sin)),
            clearance: self.along(clearance, HEIGHT),
            contact_distance: rod.contact_distance,
            gravity: rod.gravity,
            drag: if BALLISTIC { None } else { body.drag },
        };
        self.fly::<V, BALLISTIC>(body, &flight, n + 1, self.along(x, X), flight_time);
    }

    /// Carries the errors over a step to these states, whose last direction is `aside` off if they have one.
    #[inline(always)]
    fn carry<V: Vector>(
        &mut self,
        state: &State<Inexact<V, W>>,
        energy: Inexact<V, W>,
        x: Inexact<V, W>,
        clearance: Inexact<V, W>,
        plan: Option<PlannedTableMotion<Inexact<V, W>>>,
        aside: Option<f64>,
    ) {
        let State { theta, x_dot, y_dot, theta_dot } = *state;
        let [alpha, normal, tangential] = plan
            .map_or([Inexact::from_f64(0.0); 3], |plan| [plan.alpha, plan.normal_velocity, plan.tangential_velocity]);
        let states: [Inexact<V, W>; MOST_STATES] =
            [theta, x_dot, y_dot, theta_dot, energy, x, clearance, alpha, normal, tangential];
        let (mut rows, mut change, mut added) = ([Row::ZERO; S], [false; S], [0.0; S]);
        let mut off = Row::ZERO;
        for index in 0..S {
            let Inexact { variance, partials, origin, .. } = states[index];
            rows[index] = partials;
            change[index] = origin != Origin::State(index);
            if change[index] {
                added[index] = self.rounding * self.rounding * variance;
                off.0[index] = aside.unwrap_or(0.0) * partials.0[Self::ASIDE];
                self.states[index] = partials.product::<V>(&Self::parameters()).plus::<V>(&Row::unit(index));
            }
        }
        self.covariance.carry::<V>(&rows, &change, &added, aside.map(|_| &off));
    }

    /// Variance of a number, by all but what its own step rounds.
    #[inline(always)]
    fn variance<V: Vector>(&self, number: &Inexact<V, W>) -> f64 {
        let partials = &number.partials;
        let independent = self.covariance.times::<V>(partials).dot::<V, S>(partials);
        independent.max(0.0) + of_parameters::<S, W>(partials)
    }

    /// Carries the errors over a flight of length `t` from the place `x` to contact `n`.
    #[inline(always)]
    fn fly<V: Vector, const BALLISTIC: bool>(
        &mut self,
        body: &Body<Inexact<V, W>>,
        flight: &Flight<Inexact<V, W>>,
        n: u64,
        x: Inexact<V, W>,
        t: f64,
    ) {
        let landing = if BALLISTIC { Some(land_plainly(flight, t)) } else { land(body, flight, n, x, t) };
        let Some(Landing { arrival, time, speed }) = landing else {
            self.lost = true;
            return;
        };
        let per_speed = 1.0 / speed.to_f64();
        let grazing_squared = SAFETY * SAFETY * self.variance(&speed) * per_speed * per_speed;
        let time_variance = self.variance(&time).max(if BALLISTIC { 0.0 } else { self.variance(&arrival.t) });
        // The second order of the contact time: its error times the relative error of the speed it divides by.
        let late = self.rounding * time.variance.sqrt() + (time_variance * grazing_squared).sqrt();
        let plain = flight.map(Number::to_f64);
        self.lost |= grazing_squared.is_nan()
            || grazing_squared >= GRAZING_SHARE * GRAZING_SHARE
            || (plain.bulge() > plain.gravity
                && (body.drag.is_some() || body.noise.is_some() || !self.same_root(plain, t, speed.to_f64().abs())));
        let Arrival { state, clearance, way, plan, .. } = arrival;
        self.plan = plan.map(|plan| plan.map(Number::to_f64));
        self.carry(&state, self.along(0.0, ENERGY), x + way, clearance, plan, Some(late));
    }

    /// Tells whether all flights within the bound of errors after the strike end at one root. Fast spins have several.
    #[cold]
    #[inline(never)]
    fn same_root(&self, flight: Flight, t: f64, speed: f64) -> bool {
        let l = flight.contact_distance;
        let deviation = |state: usize| self.variance(&self.along::<PortableVector>(0.0, state)).sqrt();
        let reach =
            SAFETY * (deviation(Y_DOT) + l * deviation(THETA_DOT) + 2.0 * l * deviation(THETA) / t) + ROUNDING * l / t;
        [-reach, reach].into_iter().all(|reach| {
            let mut aside = flight;
            aside.start.y_dot += reach;
            (aside.clearance > 0.0 || aside.gap(0.0).slope > 0.0)
                && contact_time::first_contact(&aside)
                    .is_ok_and(|root| (root - t).abs() <= 4.0 * reach.abs() * t / speed + 1e-12 * t)
        })
    }
}

/// Tells whether a rod flies ballistically to a table that strikes just at the end of a flight, as its law says.
pub(crate) fn lands_plainly(body: &Body) -> bool {
    !body.is_point && body.noise.is_none() && body.lag == 0.0 && body.drag.is_none()
}

#[inline(always)]
fn land_plainly<V: Vector, const W: usize>(flight: &Flight<Inexact<V, W>>, t: f64) -> Landing<V, W> {
    let (time, speed) = lifted(t, &flight.gap(Inexact::from_f64(t)));
    Landing { arrival: Arrival::at(flight, aside(time)), time, speed }
}

/// The end of a flight of length `t` from a place `x` to contact `n`; `None` if it is not found.
fn land<V: Vector, const W: usize>(
    body: &Body<Inexact<V, W>>,
    flight: &Flight<Inexact<V, W>>,
    n: u64,
    x: Inexact<V, W>,
    t: f64,
) -> Option<Landing<V, W>> {
    let timing = body.noise.map_or(0.0, |noise| noise.draw(n).timing);
    let plans = body.noise.is_some_and(|noise| noise.model == NoiseModel::Plan);
    let root = if plans {
        level_root(&flight.map(Number::to_f64))?
    } else if timing != 0.0 && t <= LEAST_FLIGHT {
        0.0
    } else {
        t - timing
    };
    let gap = flight.gap(Inexact::from_f64(root));
    // A root of 0 is a release on the table, or a strike as soon as there can be one.
    let (time, mut speed) = if root > 0.0 { lifted(root, &gap) } else { (Inexact::from_f64(0.0), gap.slope) };
    let arrival = body.arrive(&Approach { flight: *flight, t: aside(time), n, x }, None).ok()?;
    if let Some(plan) = arrival.plan.filter(|_| plans) {
        if (arrival.t.to_f64() - t).abs() > SAME_TIME * t {
            return None;
        }
        // The plane may be met more nearly along it than y = 0 is.
        let own = plan.approach(&body.rod, &arrival.state);
        speed = if own.to_f64().abs() < speed.to_f64().abs() { own } else { speed };
    }
    Some(Landing { arrival, time, speed })
}

/// The end of a flight, its time off along the last direction.
struct Landing<V, const W: usize> {
    arrival: Arrival<Inexact<V, W>>,
    /// Contact time at y = 0, s.
    time: Inexact<V, W>,
    /// Slope of the gap where the contact is, m/s.
    speed: Inexact<V, W>,
}

/// Largest share of a flight by which its end, found once more, may be off it.
const SAME_TIME: f64 = 1e-9;

/// A number whose rounding is counted along the last direction.
#[inline(always)]
fn aside<V: Vector, const W: usize>(number: Inexact<V, W>) -> Inexact<V, W> {
    let mut partials = number.partials;
    partials.0[W - 1] += 1.0;
    Inexact::given(number.value, partials, Origin::Given)
}

/// A root of a gap and the slope there, from the gap at the root in doubles: ∂τ = −∂g/ġ.
#[inline(always)]
fn lifted<V: Vector, const W: usize>(root: f64, gap: &Gap<Inexact<V, W>>) -> (Inexact<V, W>, Inexact<V, W>) {
    let step = -(gap.value / gap.slope);
    let mut time = Inexact::from_f64(root) + step;
    time.variance = step.variance + root * root;
    (time, gap.slope + gap.bend * step)
}

/// Time at which the contact point is at y = 0, s.
fn level_root(flight: &Flight) -> Option<f64> {
    if flight.clearance < 0.0 {
        contact_time::first_descent(flight).ok()?
    } else if flight.clearance == 0.0 && flight.gap(0.0).slope <= 0.0 {
        Some(0.0)
    } else {
        contact_time::first_contact(flight).ok()
    }
}

/// Variance of a number by the parameters.
#[inline(always)]
fn of_parameters<const S: usize, const W: usize>(row: &Row<W>) -> f64 {
    row.0[S..W - 1].iter().map(|error| error * error).sum()
}
