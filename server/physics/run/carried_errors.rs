//! Errors of a run just before a contact: the rounding of every bounce, carried forward by the exact derivative of the map.
//!
//! Derivatives are those of dual numbers over the map itself, in two steps: over a strike, and over the flight after it. Errors of the table are
//! drawn as doubles, so a run with 31 digits has the same, and they are not rounded. Norms of derivatives alone would explode, since they
//! forget that the next bounce turns what the last one stretched; a covariance does not.

use crate::map::body::{Arrival, Body, PreImpact};
use crate::map::bounce::{Approach, LEAST_FLIGHT};
use crate::map::contact_time;
use crate::map::flight::{AirDrag, Decay, Flight, Gap};
use crate::map::friction::Slide;
use crate::map::strike::{PlannedTableMotion, Rod, State, Strike, Tilt};
use crate::map::table::control_law::{Gains, Steering};
use crate::map::table::noise::NoiseModel;
use crate::numbers::compensated_sum::MapNumber;
use crate::numbers::covariance::Covariance;
use crate::numbers::dual::Dual;
use crate::numbers::number::{Arithmetic, Number};
use crate::run::orbit::Contact;
use crate::scene::Scene;

/// Standard deviations in a bound, each rounding counted as the largest that it can be. No error of 1,000 random runs with two to four features
/// and of 8,000 others passed 0.8 of its bound; `tests/error_estimate.rs` holds it against runs with 31 digits.
pub const SAFETY: f64 = 2.0;

/// Share of every rounding that is taken to be the same at each bounce: where a run comes to rest or repeats, so do they, and
/// what would grow with the root of the number of bounces grows with the number.
const REPEATING: f64 = 0.15;

/// Half a unit in the last place, as a share: the most that one rounding is off.
pub(crate) const ROUNDING: f64 = 0.5 * f64::EPSILON;

/// A contact is too near to grazing for a derivative to say anything when the bound on its speed is this share of it.
const GRAZING_SHARE: f64 = 0.25;

/// States that carry errors, in their order; a body has the first of them that it needs. After these come tilt and velocities of a
/// planned table.
const THETA: usize = 0;
const X_DOT: usize = 1;
const Y_DOT: usize = 2;
const THETA_DOT: usize = 3;
const X: usize = 4;
const HEIGHT: usize = 5;
const PLAN: usize = 6;

/// A contact that a flight follows, in doubles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounce {
    before: PreImpact,
    strike: Strike,
    /// Length of the flight, s.
    flight_time: f64,
}

impl Bounce {
    #[inline(always)]
    pub(crate) fn of<N: MapNumber>(contact: &Contact<N>) -> Option<Self> {
        let Contact { n, x, state, clearance, strike, flight_time, .. } = contact;
        let before = PreImpact { clearance: clearance.to_f64(), ..PreImpact::at(*n, x.to_f64(), state.to_f64()) };
        Some(Self { before, strike: strike.as_ref()?.map(N::to_f64), flight_time: (*flight_time)?.to_f64() })
    }
}

/// Errors of the parameters of a run, one standard deviation of each. They are off by the same at every bounce; a run with 31 digits has
/// them to its own digits.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RoundedParameters {
    holds_energy: bool,
    gravity: f64,
    radius_of_gyration: f64,
    strike_gain: f64,
    strike_gain_per_energy: f64,
    /// True if strikes aim at a height.
    aims: bool,
    /// Share of each gain of the tilt.
    tilt: f64,
    contact_distance: f64,
    constant_tilt: f64,
}

impl RoundedParameters {
    /// As many roundings of the share `unit` as [`Scene::body_by`] makes. Other factors of the strike, such as 1 − κ, act as the radius of
    /// gyration does.
    pub(crate) fn of(scene: &Scene, unit: f64) -> Self {
        let Body { rod, is_point, constant_tilt, friction, noise, lag, .. } = scene.model();
        // A strike with friction, or one that is planned, divides γ by 1 + e and multiplies by it.
        let exact = friction.is_none() && noise.is_none() && lag == 0.0;
        let off = scene.table_errors();
        let only_if = |rounded: bool, number: f64| if rounded { unit * number.abs() } else { 0.0 };
        Self {
            holds_energy: scene.rules().holds_energy,
            gravity: only_if(scene.incline != std::f64::consts::FRAC_PI_2, 2.0 * rod.gravity),
            radius_of_gyration: only_if(!is_point, 1.5 * rod.radius_of_gyration),
            strike_gain: only_if(rod.strike_gain != 2.0 || !exact, scene.strike_gain_roundings() * rod.strike_gain),
            // (1 + e)((1 + ε)κ_E).
            strike_gain_per_energy: only_if(off.speed != 0.0, 4.0 * rod.strike_gain_per_energy),
            aims: scene.target_height.is_some() || scene.program.is_some(),
            // κ(1 + ε): near κ(1 + ε) = 1 the swing has little but this.
            tilt: only_if(off.tilt_gain != 0.0, 2.0),
            // √(a² + d²).
            contact_distance: only_if(!is_point && off.offset != 0.0, 2.0 * rod.contact_distance),
            // κ(b + δ) + c.
            constant_tilt: only_if(
                constant_tilt != off.tilt_offset,
                4.0 * (constant_tilt - off.tilt_offset).abs() + constant_tilt.abs(),
            ),
        }
    }

    /// True if the strike gain or the energy that it depends on is rounded.
    fn rounds_gain(&self) -> bool {
        self.strike_gain != 0.0 || self.strike_gain_per_energy != 0.0 || self.aims
    }

    /// Number of parameters that are off, the held energy among them.
    pub(crate) fn count(&self) -> usize {
        let Self { holds_energy, gravity, radius_of_gyration, tilt, contact_distance, constant_tilt, .. } = *self;
        let others = [gravity, radius_of_gyration, tilt, contact_distance, constant_tilt];
        let others = others.iter().filter(|deviation| **deviation != 0.0).count();
        usize::from(holds_energy) + usize::from(self.rounds_gain()) + others
    }
}

/// Errors of the first `S` states of a run, in `W` directions of dual numbers: the states, parameters that are off by the same at every bounce,
/// and in the last one what a step rounds on its way (the tilt of a strike, the contact time of a flight).
#[derive(Clone, Copy, Debug)]
pub struct CarriedErrors<const S: usize, const W: usize> {
    /// Parameters, with one standard deviation of each in its direction.
    body: Body<Dual<W>>,
    /// 1/ρ², 1/m².
    leverage: Dual<W>,
    /// The parameters alone, with the program of targets.
    values: Body,
    /// Direction of the strike gain and of the energy that it depends on.
    of_gain: usize,
    holds_energy: bool,
    /// The held energy, whose own error is the first parameter; `None` before the first contact, which sets it.
    energy: Option<Dual<W>>,
    /// Covariance of the independent errors.
    covariance: Covariance<S>,
    /// Each state moves along its own direction, and has an error by each parameter.
    states: [[f64; W]; S],
    /// Motion that the table has planned for the coming contact.
    plan: Option<PlannedTableMotion>,
    /// The last strike and the flight after it, whose end is to come.
    flying: Option<Flying>,
    /// The most that one rounding is off, as a share.
    unit: f64,
    /// Standard deviation of a rounding, as a share, at this bounce.
    rounding: f64,
    /// True once derivatives say nothing any more.
    lost: bool,
}

impl<const S: usize, const W: usize> CarriedErrors<S, W> {
    /// The last direction.
    const ASIDE: usize = W - 1;

    /// Direction of the error that the held energy has of its own.
    const OF_ENERGY: usize = S;

    /// Most parameters.
    pub(crate) const PARAMETERS: usize = W - 1 - S;

    pub(crate) fn new(scene: &Scene, first: f64, unit: f64) -> Self {
        let values = scene.model();
        let mut body: Body<Dual<W>> = Body { program: None, ..values.map(Dual::from_f64) };
        let off = RoundedParameters::of(scene, unit);
        let mut next = Self::OF_ENERGY + usize::from(off.holds_energy);
        // The last direction takes what is left.
        let mut direction = |is_off: bool| {
            let direction = next.min(Self::ASIDE - 1);
            next += usize::from(is_off);
            direction
        };
        let rod = &mut body.rod;
        rod.gravity.partials[direction(off.gravity != 0.0)] = off.gravity;
        rod.radius_of_gyration.partials[direction(off.radius_of_gyration != 0.0)] = off.radius_of_gyration;
        let of_gain = direction(off.rounds_gain());
        rod.strike_gain.partials[of_gain] = off.strike_gain;
        rod.strike_gain_per_energy.partials[of_gain] = off.strike_gain_per_energy;
        let of_tilt = direction(off.tilt != 0.0);
        rod.tilt_gain.partials[of_tilt] = off.tilt * rod.tilt_gain.value;
        if let Steering::Feedback(gains) = &mut body.steering {
            for gain in [&mut gains.x, &mut gains.theta, &mut gains.x_dot, &mut gains.theta_dot] {
                gain.partials[of_tilt] = off.tilt * gain.value;
            }
        }
        rod.contact_distance.partials[direction(off.contact_distance != 0.0)] = off.contact_distance;
        body.constant_tilt.partials[direction(off.constant_tilt != 0.0)] = off.constant_tilt;
        let mut errors = Self {
            leverage: body.rod.leverage(),
            body,
            values,
            of_gain,
            holds_energy: off.holds_energy,
            energy: None,
            covariance: Covariance::ZERO,
            states: std::array::from_fn(|state| std::array::from_fn(|index| f64::from(u8::from(index == state)))),
            plan: None,
            flying: None,
            unit,
            rounding: unit,
            lost: false,
        };
        if let Some(height) = scene.target_height {
            errors.aim(height);
        }
        if first > 0.0 {
            let release = scene.release();
            let free = errors.body.rod.flight_from(&release.map(Dual::from_f64));
            let flight = Flight { drag: errors.body.drag, ..free };
            let doubt = 2.0 * (release.height.abs() + 2.0 * flight.contact_distance.value);
            errors.fly::<false>(&flight, 1, Dual::from_f64(release.x), first, doubt);
        }
        errors
    }

    /// Takes the target of strike `n`, if targets differ.
    #[inline(always)]
    fn aim_at(&mut self, n: u64) {
        if let Some(program) = self.values.program {
            self.aim(program.at(n));
        }
    }

    /// The energy of a target height, m, off by its rounding and that of the energy which it is compared with.
    fn aim(&mut self, height: f64) {
        let Rod { gravity, contact_distance, .. } = self.body.rod;
        let mut energy = gravity * Dual::from_f64(height);
        energy.partials[self.of_gain] = self.unit * (2.0 * energy.value.abs() + gravity.value * contact_distance.value);
        self.body.rod.target_energy = energy;
    }

    /// Same as [`crate::run::error_estimate::ErrorEstimate::bound`].
    #[inline(always)]
    pub(crate) fn bound(&self) -> f64 {
        if self.lost {
            return f64::INFINITY;
        }
        let rho = self.values.rod.radius_of_gyration;
        let variance =
            |state: usize| self.covariance.variance(state).max(0.0) + of_parameters::<S, W>(&self.states[state]);
        let turned = if self.body.is_point { 0.0 } else { rho * rho * variance(THETA) };
        let (x_dot, y_dot, spin) = (variance(X_DOT), variance(Y_DOT), rho * rho * variance(THETA_DOT));
        if (turned + x_dot + y_dot + spin).is_finite() {
            SAFETY * turned.max(x_dot).max(y_dot).max(spin).sqrt()
        } else {
            f64::INFINITY
        }
    }

    /// A number that moves along the direction of a state, if that is one of the states.
    #[inline(always)]
    fn along(&self, value: f64, state: usize) -> Dual<W> {
        if state < S { Dual { value, partials: self.states[state] } } else { Dual::from_f64(value) }
    }

    #[inline(always)]
    fn along_state(&self, state: &State) -> State<Dual<W>> {
        State {
            theta: self.along(state.theta, THETA),
            x_dot: self.along(state.x_dot, X_DOT),
            y_dot: self.along(state.y_dot, Y_DOT),
            theta_dot: self.along(state.theta_dot, THETA_DOT),
        }
    }

    /// Goes on over the strike of a contact; [`CarriedErrors::end_flight`] has to follow. `PLAIN` as in [`crate::run::orbit`].
    #[inline(always)]
    pub(crate) fn strike<const PLAIN: bool>(&mut self, contact: &Bounce) {
        if self.lost {
            return;
        }
        let Bounce { before: PreImpact { n, x, clearance, state, .. }, strike, .. } = contact;
        if !PLAIN {
            self.aim_at(*n);
        }
        self.rounding = self.unit * (1.0 + 2.0 * REPEATING * REPEATING * *n as f64).sqrt();
        let before = PreImpact {
            n: *n,
            x: self.along(*x, X),
            clearance: self.along(*clearance, HEIGHT),
            state: self.along_state(state),
            plan: self.plan.map(|plan| PlannedTableMotion {
                alpha: self.along(plan.alpha, PLAN),
                normal_velocity: self.along(plan.normal_velocity, PLAN + 1),
                tangential_velocity: self.along(plan.tangential_velocity, PLAN + 2),
            }),
        };
        let (tilt, mut struck) = if PLAIN {
            let tilt = turned_aside(self.plain_tilt(before.state.theta, strike.sin_cos_theta));
            (tilt, self.body.rod.strike_with(&before.state, &tilt, self.leverage))
        } else {
            self.body.strike_over(&before, turned_aside)
        };
        let turned = self.rounding * self.rounded_tilt(&contact.before, strike.alpha);
        let held = self.holds_energy.then(|| {
            let held = self.energy.map_or(struck.energy, |energy| Dual { value: struck.energy.value, ..energy });
            self.body.rod.hold_energy(&mut struck, held)
        });
        let (after, zero, covariance) = (struck.after, Dual::from_f64(0.0), self.covariance);
        let states =
            [after.theta, after.x_dot, after.y_dot, after.theta_dot, before.x, before.clearance, zero, zero, zero];
        self.carry(&states, turned);
        if let Some(energy) = held {
            self.hold(&covariance, &states, energy, turned, strike);
        }
        self.round_strike::<PLAIN>(&contact.before, &tilt, strike);
        let Strike { after: start, sin_cos_theta, .. } = *strike;
        let Rod { contact_distance, gravity, .. } = self.values.rod;
        let flight = Flight { start, sin_cos_theta, clearance: *clearance, contact_distance, gravity, drag: None };
        self.flying = Some(Flying { flight, n: n + 1, x: *x, flight_time: contact.flight_time });
    }

    /// The tilt of a table that follows [`Rod::tilt`], with sine and cosine of the angle. What the sine of β loses to sums is a rounding of 1; a
    /// derivative needs no more.
    #[inline(always)]
    fn plain_tilt(&self, theta: Dual<W>, (sin, cos): (f64, f64)) -> Tilt<Dual<W>> {
        let alpha = self.body.rod.tilt_gain * theta;
        let (sin_alpha, cos_alpha) = alpha.sincos();
        let (sine, cosine) = (sin_alpha.value, cos_alpha.value);
        Tilt {
            alpha,
            sin_theta: theta.chain(sin, cos),
            versine_theta: theta.chain(1.0 - cos, sin),
            sin_alpha,
            cos_alpha,
            sin_beta: (theta - alpha).chain(sin * cosine - cos * sine, cos * cosine + sin * sine),
        }
    }

    /// Sizes of the terms of the angles of a strike, rad; a planned tilt is a state.
    #[inline(always)]
    fn rounded_tilt(&self, coming: &PreImpact, alpha: f64) -> f64 {
        let theta = coming.state.theta;
        let Body { rod, steering, constant_tilt, noise, lag, .. } = &self.values;
        if self.plan.is_some() {
            return alpha.abs() + theta.abs();
        }
        if *steering == Steering::TiltGain && *constant_tilt == 0.0 && noise.is_none() && *lag == 0.0 {
            // β = (1 − κ)θ.
            return alpha.abs() + ((1.0 - rod.tilt_gain) * theta).abs();
        }
        self.law_terms(coming, alpha) + theta.abs()
    }

    /// Sizes of the terms of the law of the tilt, rad.
    fn law_terms(&self, coming: &PreImpact, alpha: f64) -> f64 {
        let State { theta, x_dot, theta_dot, .. } = coming.state;
        let Body { rod, steering, lag, .. } = &self.values;
        let [of_place, of_turn] = self.growths();
        let terms = match steering {
            Steering::TiltGain => 2.0 * (alpha.abs() + (rod.tilt_gain * lag * theta_dot).abs() * of_turn),
            Steering::Feedback(gains) => {
                let Gains { x, theta: by_theta, x_dot: by_x_dot, theta_dot: by_theta_dot } = *gains;
                let terms =
                    [x * coming.x, by_theta * theta, of_place * by_x_dot * x_dot, of_turn * by_theta_dot * theta_dot];
                let earlier = lag * (of_place * (x * x_dot).abs() + of_turn * (by_theta * theta_dot).abs());
                alpha.abs() + 2.0 * (terms.map(f64::abs).iter().sum::<f64>() + earlier)
            }
        };
        if self.values.is_point { terms + self.velocity_angle_terms(&coming.state) } else { terms }
    }

    /// Sizes of what rounding leaves of the angle of a sensed velocity in the law of the tilt, rad.
    fn velocity_angle_terms(&self, state: &State) -> f64 {
        let Body { rod, steering, lag, .. } = &self.values;
        let gain = match steering {
            Steering::TiltGain => rod.tilt_gain,
            Steering::Feedback(gains) => gains.theta,
        };
        let [growth, _] = self.growths();
        let (along, down) = (growth * state.x_dot.abs(), growth * (state.y_dot.abs() + rod.gravity * lag));
        let slowest = along.max((state.y_dot + rod.gravity * lag).abs());
        gain.abs() * (along + down) / slowest
    }

    /// Largest factors by which velocities of place and rotation were larger when the table sensed them.
    fn growths(&self) -> [f64; 2] {
        let Body { drag, lag, .. } = &self.values;
        let Some(AirDrag { linear, rotational, .. }) = drag.filter(|_| *lag != 0.0) else { return [1.0; 2] };
        [linear, rotational].map(|rate| (1.0 + rate * lag) / Decay::new(rate, *lag).left)
    }

    /// Sizes of the terms of the tilt rate at a contact, rad/s.
    fn rate_terms(&self, n: u64, state: &State) -> f64 {
        let Body { rod, steering, noise, drag, .. } = &self.values;
        let errors = noise.and_then(|noise| noise.sensing(n)).unwrap_or_default();
        let [of_place, of_turn] = self.growths();
        let x_dot = of_place * (state.x_dot.abs() + errors.x_dot.abs());
        let mut theta_dot = of_turn * (state.theta_dot.abs() + errors.theta_dot.abs());
        if self.values.is_point {
            theta_dot = self.body.tilt_rate(&self.body.rod, &state.map(Dual::from_f64)).value.abs();
        }
        let [along, _, spin] =
            drag.map_or([0.0; 3], |drag| AirDrag { wind: -drag.wind.abs(), ..drag }.taken([x_dot, 0.0, theta_dot]));
        match steering {
            Steering::TiltGain => (rod.tilt_gain * theta_dot).abs(),
            Steering::Feedback(gains) => {
                gains.x.abs() * x_dot
                    + gains.x_dot.abs() * along
                    + gains.theta.abs() * theta_dot
                    + gains.theta_dot.abs() * spin
            }
        }
    }

    /// Carries the errors over a step to states with these derivatives, which rounds `aside` on its way.
    #[inline(always)]
    fn carry(&mut self, states: &[Dual<W>; 9], aside: f64) {
        let mut off = [0.0; S];
        for (off, state) in off.iter_mut().zip(states) {
            *off = aside * state.partials[Self::ASIDE];
        }
        self.covariance = self.covariance.carried(|state| &states[state].partials);
        self.covariance.add_along(&off, 1.0);
        for (index, (row, state)) in self.states.iter_mut().zip(states).enumerate() {
            *row = state.partials;
            row[..S].fill(0.0);
            (row[index], row[Self::ASIDE]) = (1.0, 0.0);
        }
    }

    /// Variance of a number, by all but what its own step rounds.
    #[inline(always)]
    fn variance(&self, number: &Dual<W>) -> f64 {
        let with = self.covariance.times(&number.partials);
        product(&with, &number.partials).max(0.0) + of_parameters::<S, W>(&number.partials)
    }

    /// Holds an energy from a strike on, with the covariance before that strike and the states after it.
    ///
    /// The energy is a parameter of its own: of each state the part that goes with it, c/σ for a covariance c and a standard deviation σ of the
    /// energy, is set apart from the others. Most strikes leave the energy as it is.
    #[inline(always)]
    fn hold(
        &mut self,
        before: &Covariance<S>,
        states: &[Dual<W>; 9],
        mut energy: Dual<W>,
        turned: f64,
        strike: &Strike,
    ) {
        if self.energy.is_some() && energy.partials[..S].iter().all(|partial| *partial == 0.0) {
            return;
        }
        let rounding = self.rounding * self.rounded_energy(strike);
        let row = energy.partials;
        let with = before.times(&row);
        let (old, aside) = (row[Self::OF_ENERGY], row[Self::ASIDE] * turned);
        let deviation = (product(&with, &row).max(0.0) + old * old + aside * aside + rounding * rounding).sqrt();
        let per_deviation = if deviation > 0.0 { 1.0 / deviation } else { 0.0 };
        let (mut last, mut now) = ([0.0; S], [0.0; S]);
        for (index, (state, Dual { partials, .. })) in self.states.iter_mut().zip(states).enumerate() {
            let both = product(&with, partials) + aside * (turned * partials[Self::ASIDE]);
            last[index] = state[Self::OF_ENERGY];
            now[index] = (both + old * partials[Self::OF_ENERGY]) * per_deviation;
            state[Self::OF_ENERGY] = now[index];
        }
        self.covariance.add_along(&last, 1.0);
        self.covariance.add_along(&now, -1.0);
        energy.partials[..S].fill(0.0);
        (energy.partials[Self::OF_ENERGY], energy.partials[Self::ASIDE]) = (deviation, 0.0);
        self.energy = Some(energy);
    }

    /// Terms of the energy before a strike, m²/s².
    #[inline(always)]
    fn energy_terms(&self, strike: &Strike) -> f64 {
        let weight = self.values.rod.gravity * self.values.rod.contact_distance;
        1.5 * strike.speed_squared + 2.0 * weight * (1.0 - strike.sin_cos_theta.1)
    }

    /// Terms of the held energy that a strike rounds, which are those that it changes, m²/s².
    fn rounded_energy(&self, strike: &Strike) -> f64 {
        let gain = strike.energy_gain;
        let set = if self.energy.is_none() { self.energy_terms(strike) } else { 0.0 };
        set + if gain == 0.0 { 0.0 } else { (strike.energy + gain).abs() + 4.0 * gain.abs() }
    }

    /// Adds an independent error of a state.
    #[inline(always)]
    fn add(&mut self, state: usize, deviation: f64) {
        if state < S {
            self.covariance.add(state, deviation);
        }
    }

    /// Adds an error of several states at once, one standard deviation of each.
    #[inline(always)]
    fn add_along<const K: usize>(&mut self, parts: [(usize, f64); K]) {
        let mut direction = [0.0; S];
        for (state, part) in parts {
            if state < S {
                direction[state] = part;
            }
        }
        self.covariance.add_along(&direction, 1.0);
    }

    /// Adds what a strike rounds beside its tilt: the impulses along their own directions, the energy along the velocity, and each sum.
    #[inline(always)]
    fn round_strike<const PLAIN: bool>(&mut self, coming: &PreImpact, tilt: &Tilt<Dual<W>>, strike: &Strike) {
        let (before, rounding) = (&coming.state, self.rounding);
        let tilt = tilt.map(|number| number.value);
        let (l, leverage) = (self.values.rod.contact_distance, self.leverage.value);
        let (sin, cos, across, reach) = (tilt.sin_alpha, tilt.cos_alpha, l * tilt.sin_beta, l * tilt.cos_beta());
        let Body { rod, turning, friction, noise, .. } = self.values;
        let [struck, dragged] = match turning {
            Some(turning) if !PLAIN => {
                turning.rounded_terms(self.rate_terms(coming.n, before), rod.contact_distance, coming.x, &tilt)
            }
            _ => [0.0; 2],
        };
        let (impulse, tangential) = (strike.impulse_normal, strike.impulse_tangential);
        let State { x_dot, y_dot, theta_dot, .. } = strike.after;
        let planned = self.plan.map_or(0.0, |plan| plan.normal_velocity.abs());
        let terms = (cos * before.y_dot).abs() + (sin * before.x_dot).abs() + (across * before.theta_dot).abs();
        let gain = (impulse / strike.approach).abs();
        let along = rounding * (2.0 * gain * (terms + planned + struck) + 3.0 * impulse.abs());
        self.add_along([(X_DOT, -sin * along), (Y_DOT, cos * along), (THETA_DOT, across * leverage * along)]);
        if let Some(friction) = friction.filter(|_| !PLAIN) {
            let turns_by_errors = turning.is_some() && noise.is_some_and(|noise| noise.sensing(coming.n).is_some());
            let slides = friction.slide == Slide::None || self.plan.is_some() || turns_by_errors;
            let terms = if slides {
                let [x, y, spin] = [cos * before.x_dot, sin * before.y_dot, reach * before.theta_dot];
                x.abs() + y.abs() + spin.abs() + (x + y + spin).abs()
            } else {
                0.0
            };
            let aside =
                rounding * (2.0 * (terms + dragged) + 3.0 * tangential.abs()) + along * (tangential / impulse).abs();
            self.add_along([(X_DOT, cos * aside), (Y_DOT, sin * aside), (THETA_DOT, reach * leverage * aside)]);
        }
        if self.holds_energy {
            let stretch = rounding * self.energy_terms(strike) / strike.speed_squared;
            self.add_along([(X_DOT, x_dot * stretch), (Y_DOT, y_dot * stretch), (THETA_DOT, theta_dot * stretch)]);
        }
        let turn = leverage * ((impulse * across).abs() + (tangential * reach).abs());
        let pushed = impulse.abs() + tangential.abs();
        self.add(X_DOT, rounding * (2.0 * x_dot.abs() + 3.0 * ((impulse * sin).abs() + tangential.abs())));
        self.add(Y_DOT, rounding * (2.0 * y_dot.abs() + pushed));
        self.add(THETA_DOT, rounding * (2.0 * theta_dot.abs() + 3.0 * turn));
    }

    /// Goes on to the end of the flight after the last strike, if there is one.
    #[inline(always)]
    pub(crate) fn end_flight<const PLAIN: bool>(&mut self) {
        let Some(Flying { flight, n, x, flight_time }) = self.flying.take() else { return };
        let start = self.along_state(&flight.start);
        let (sin, cos) = flight.sin_cos_theta;
        let flight = Flight {
            start,
            sin_cos_theta: (start.theta.chain(sin, cos), start.theta.chain(cos, -sin)),
            clearance: self.along(flight.clearance, HEIGHT),
            contact_distance: self.body.rod.contact_distance,
            gravity: self.body.rod.gravity,
            drag: if PLAIN { None } else { self.body.drag },
        };
        self.fly::<PLAIN>(&flight, n, self.along(x, X), flight_time, 0.0);
    }

    /// Carries the errors over a flight of length `t` from the place `x` to contact `n`, in which terms of `doubt` m more are rounded.
    #[inline(always)]
    fn fly<const PLAIN: bool>(&mut self, flying: &Flight<Dual<W>>, n: u64, x: Dual<W>, t: f64, doubt: f64) {
        let flight = flying.map(Number::to_f64);
        let Body { is_point, ref noise, lag, .. } = self.values;
        let is_plain = PLAIN || !is_point && noise.is_none() && lag == 0.0;
        let landing = if is_plain { Some(Self::land_plainly(flying, t)) } else { self.land(flying, n, x, t) };
        let Some(Landing { arrival, time, speed, parts }) = landing else {
            self.lost = true;
            return;
        };
        let (l, per_speed) = (flight.contact_distance, 1.0 / speed.value.abs());
        let grazing_squared = SAFETY * SAFETY * self.variance(&speed) * per_speed * per_speed;
        let mut time_variance = self.variance(&time);
        if !is_plain {
            time_variance = time_variance.max(self.variance(&arrival.t));
        }
        let turned = (flight.start.theta_dot * t).abs();
        let reach = l * (flight.sin_cos_theta.0.abs() * turned.min(1.0) + (0.5 * turned * turned).min(2.0));
        let fallen = flight.start.y_dot.abs() + flight.gravity * t;
        let mut parts = parts + t * fallen + 3.0 * reach + flight.clearance.abs() + doubt;
        let rounding = self.rounding;
        let drag = self.values.drag.filter(|_| !PLAIN);
        // A decay rounds its share, and the exponent of that.
        let [of_place, of_turn] =
            drag.map_or([0.0; 2], |drag| [drag.linear, drag.rotational].map(|rate| 4.0 + 16.0 * rate * t));
        let pushed = drag.map_or(0.0, |drag| drag.push().abs()) * t;
        parts += of_place * t * fallen + of_turn * l * turned;
        // The second order of the contact time: its error times the relative error of the speed it divides by.
        let late = rounding * (t + parts * per_speed) + (time_variance * grazing_squared).sqrt();
        self.lost |= grazing_squared.is_nan()
            || grazing_squared >= GRAZING_SHARE * GRAZING_SHARE
            || (flight.bulge() > flight.gravity && !self.same_root(flight, t, speed.value.abs()));
        let Arrival { state, clearance, way, plan, .. } = arrival;
        let [alpha, normal, tangential] =
            plan.map_or([Dual::from_f64(0.0); 3], |plan| [plan.alpha, plan.normal_velocity, plan.tangential_velocity]);
        let place = if S > X { x + way } else { x };
        self.carry(
            &[state.theta, state.x_dot, state.y_dot, state.theta_dot, place, clearance, alpha, normal, tangential],
            late,
        );
        let end = state.map(Number::to_f64);
        self.add(X, rounding * (x.value.abs() + (2.0 + of_place) * (t * (flight.start.x_dot.abs() + pushed))));
        let of_theta = if turned > 0.0 { end.theta.abs() + turned } else { 0.0 };
        self.add(THETA, rounding * (of_theta + of_turn * turned));
        self.add(Y_DOT, rounding * (end.y_dot.abs() + flight.gravity * t + of_place * fallen));
        if drag.is_some() {
            self.add(X_DOT, rounding * of_place * (end.x_dot.abs() + 2.0 * pushed));
            self.add(THETA_DOT, rounding * of_turn * end.theta_dot.abs());
        }
        if !is_plain {
            self.plan = plan.map(|plan| plan.map(Number::to_f64));
            self.round_plan(&flight, n, x.value, &end, t, parts, per_speed);
        }
    }

    /// Adds what a flight to a table that plans, or that strikes early or late, rounds beside the rest.
    #[allow(clippy::too_many_arguments, reason = "numbers of one flight")]
    fn round_plan(&mut self, flight: &Flight, n: u64, x: f64, end: &State, t: f64, parts: f64, per_speed: f64) {
        let rounding = self.rounding;
        if self.body.noise.is_some() {
            self.add(HEIGHT, rounding * parts);
        }
        let Some(plan) = self.plan else { return };
        let l = flight.contact_distance;
        let [of_place, of_turn] = self.growths();
        let fallen = flight.gravity * self.values.lag;
        let speeds = of_place * (end.x_dot.abs() + end.y_dot.abs() + fallen) + of_turn * l * end.theta_dot.abs();
        let seen = PreImpact::at(n, x + flight.start.x_dot * t, *end);
        let [struck, dragged] = self.values.turning.map_or([0.0; 2], |turning| {
            let tilt = Tilt::new(end.theta, plan.alpha, end.theta - plan.alpha);
            turning.rounded_terms(self.rate_terms(n, end), l, seen.x, &tilt)
        });
        self.add(PLAN, rounding * (self.law_terms(&seen, plan.alpha) + plan.alpha.abs()));
        self.add(PLAN + 1, 6.0 * rounding * (speeds + plan.normal_velocity.abs() + struck));
        self.add(PLAN + 2, 6.0 * rounding * (speeds + dragged));
        if self.body.noise.is_some() {
            // The time at which the plane is met is rounded on its own.
            let met = rounding * (t + (parts + speeds * t) * per_speed);
            let rise = flight.gap(t).slope;
            let [along, up, spin] =
                flight.drag.map_or([0.0; 3], |drag| drag.taken([end.x_dot, end.y_dot, end.theta_dot]));
            let rates = [
                (X, end.x_dot),
                (HEIGHT, rise),
                (THETA, end.theta_dot),
                (X_DOT, -along),
                (Y_DOT, -flight.gravity - up),
                (THETA_DOT, -spin),
            ];
            self.add_along(rates.map(|(state, rate)| (state, rate * met)));
        }
    }

    /// The end of a flight of length `t` to a table that strikes just then.
    #[inline(always)]
    fn land_plainly(flight: &Flight<Dual<W>>, t: f64) -> Landing<W> {
        let (time, speed) = lifted(t, &flight.gap(Dual::from_f64(t)));
        Landing { arrival: Arrival::at(flight, aside(time)), time, speed, parts: 0.0 }
    }

    /// The end of a flight of length `t` from a place `x` to contact `n`; `None` if it is not found.
    #[inline(always)]
    fn land(&mut self, flight: &Flight<Dual<W>>, n: u64, x: Dual<W>, t: f64) -> Option<Landing<W>> {
        let timing = self.body.noise.map_or(0.0, |noise| noise.draw(n).timing);
        let plans = self.body.noise.is_some_and(|noise| noise.model == NoiseModel::Plan);
        let root = if plans {
            level_root(&flight.map(Number::to_f64))?
        } else if timing != 0.0 && t <= LEAST_FLIGHT {
            0.0
        } else {
            t - timing
        };
        // A root of 0 is a release on the table, or a strike as soon as there can be one.
        let lift = |gap: Gap<Dual<W>>| if root > 0.0 { lifted(root, &gap) } else { (Dual::from_f64(0.0), gap.slope) };
        let (time, mut speed) = lift(flight.gap(Dual::from_f64(root)));
        // A plan is made for the coming target.
        self.aim_at(n);
        let approach = Approach { flight: *flight, t: aside(time), n, x };
        let arrival = self.body.arrive(&approach, None).ok()?;
        let mut parts = 0.0;
        if let Some(plan) = arrival.plan.filter(|_| plans) {
            if (arrival.t.value - t).abs() > SAME_TIME * t {
                return None;
            }
            // The plane may be met more nearly along it than y = 0 is.
            let own = plan.approach(&self.body.rod, &arrival.state);
            speed = if own.value.abs() < speed.value.abs() { own } else { speed };
            // The place of the plane is a difference of l sin θ as it is struck and as it was planned.
            let across = 3.0 * flight.contact_distance.value * flight.sin_cos_theta.0.value * plan.alpha.value;
            let planned = plan.normal_velocity.value * (root + timing);
            parts = planned.abs() + (flight.start.x_dot.value * t).abs() + across.abs();
        }
        Some(Landing { arrival, time, speed, parts })
    }

    /// Tells whether all flights within the bound, of errors just after the strike, end at the same root of the gap. Only a fast spin has
    /// more than one.
    #[cold]
    #[inline(never)]
    fn same_root(&self, flight: Flight, t: f64, speed: f64) -> bool {
        if self.body.drag.is_some() || self.body.noise.is_some() {
            return false;
        }
        let l = flight.contact_distance;
        let deviation = |state: usize| self.variance(&self.along(0.0, state)).sqrt();
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

/// A flight whose end is to come.
#[derive(Clone, Copy, Debug)]
struct Flying {
    flight: Flight,
    /// Number of the coming contact.
    n: u64,
    /// Horizontal place at the start, m.
    x: f64,
    flight_time: f64,
}

/// The end of a flight, its time off by what the flight rounds.
struct Landing<const W: usize> {
    arrival: Arrival<Dual<W>>,
    /// Contact time at y = 0, s.
    time: Dual<W>,
    /// Slope of the gap where the contact is, m/s.
    speed: Dual<W>,
    /// Sizes of further terms that are rounded, m.
    parts: f64,
}

/// Largest share of a flight by which its end, found once more, may be off it.
const SAME_TIME: f64 = 1e-9;

/// A number that moves along the last direction too.
#[inline(always)]
fn aside<const W: usize>(mut number: Dual<W>) -> Dual<W> {
    number.partials[W - 1] += 1.0;
    number
}

/// The tilt of a table that turns along the last direction too.
#[inline(always)]
fn turned_aside<const W: usize>(mut tilt: Tilt<Dual<W>>) -> Tilt<Dual<W>> {
    let Tilt { sin_alpha, cos_alpha, .. } = tilt.map(|number| number.value);
    let cos_beta = tilt.map(|number| number.value).cos_beta();
    tilt.alpha = aside(tilt.alpha);
    tilt.sin_alpha.partials[W - 1] += cos_alpha;
    tilt.cos_alpha.partials[W - 1] -= sin_alpha;
    tilt.sin_beta.partials[W - 1] -= cos_beta;
    tilt
}

/// A root of a gap and the slope there, from the gap at the root in doubles: ∂τ = −∂g/ġ.
#[inline(always)]
fn lifted<const W: usize>(root: f64, gap: &Gap<Dual<W>>) -> (Dual<W>, Dual<W>) {
    let step = -(gap.value / gap.slope);
    (Dual::from_f64(root) + step, gap.slope + gap.bend * step)
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

/// The scalar product of a vector with the beginning of a row.
#[inline(always)]
fn product<const S: usize, const W: usize>(vector: &[f64; S], row: &[f64; W]) -> f64 {
    vector.iter().zip(row).map(|(one, other)| one * other).sum()
}

/// Variance of a number by the parameters.
#[inline(always)]
fn of_parameters<const S: usize, const W: usize>(row: &[f64; W]) -> f64 {
    row[S..W - 1].iter().map(|error| error * error).sum()
}
