//! Error bound of runs with state feedback, noise, a turning table or a rig that errs: that of [`crate::run::error_estimate`] with more states.
//!
//! The table then sees x too, a strike early or late has a height of its own, and a planned motion of the table is off by what the plan
//! was made from. The errors of the table are drawn as doubles, so a run with 31 digits has the same, and they are not rounded.
//! Derivatives are those of dual numbers, in two steps: over a strike, and over the flight after it.

mod landing;

use crate::body::{Arrival, Body, PreImpact};
use crate::bounce::flight::Flight;
use crate::bounce::friction::{Slide, tangential_velocity};
use crate::bounce::strike::{PlannedTableMotion, Rod, State, Strike, Tilt};
use crate::numbers::double_double;
use crate::numbers::dual::Dual;
use crate::numbers::number::{Arithmetic, Number};
use crate::run::bounce_derivative::along_states;
use crate::run::ending::Ending;
use crate::run::error_estimate::{GRAZING_SHARE, REPEATING, ROUNDING, SAFETY};
use crate::run::orbit;
use crate::run::orbit::{Contact, Orbit};
use crate::scene::Scene;
use crate::scene::model::ModelLevel;
use crate::table::control_law::{Gains, Steering};
use crate::table::program::HeightProgram;
use landing::Landing;
use nalgebra::SMatrix;

/// x, height of the contact point, θ, ẋ, ẏ, θ̇; tilt and velocities of a planned table; the held energy.
const STATES: usize = 10;
const X: usize = 0;
const HEIGHT: usize = 1;
const THETA: usize = 2;
const X_DOT: usize = 3;
const Y_DOT: usize = 4;
const THETA_DOT: usize = 5;
const PLAN: usize = 6;
const ENERGY: usize = 9;
/// Gravity, radius of gyration, strike gain, tilt gain and contact distance.
const PARAMETERS: usize = 5;
const OF_GRAVITY: usize = STATES;
const OF_GYRATION: usize = STATES + 1;
const OF_GAIN: usize = STATES + 2;
const OF_TILT: usize = STATES + 3;
const OF_DISTANCE: usize = STATES + 4;
/// One direction more, for what a step rounds on its way: the tilt of a strike, the contact time of a flight.
const ASIDE: usize = STATES + PARAMETERS;
const WIDTH: usize = ASIDE + 1;

type Number16 = Dual<WIDTH>;
type Derivative = SMatrix<f64, STATES, WIDTH>;
type States = SMatrix<f64, STATES, 1>;

/// The error of a run just before its coming contact, carried along beside its orbit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FullErrorEstimate {
    body: Body<Number16>,
    program: Option<HeightProgram>,
    holds_energy: bool,
    /// True before the first contact, from which on energy is held.
    is_first: bool,
    /// Covariance of the independent errors.
    covariance: SMatrix<f64, STATES, STATES>,
    /// Error of each state by each parameter, which is off by the same at every bounce.
    of_parameters: SMatrix<f64, STATES, PARAMETERS>,
    /// Motion that the table has planned for the coming contact.
    plan: Option<PlannedTableMotion>,
    /// The most that one rounding is off, as a share.
    unit: f64,
    /// Standard deviation of a rounding, as a share, at this bounce.
    rounding: f64,
    /// True once derivatives say nothing any more.
    lost: bool,
}

/// Tells whether the bound of a scene needs more states than [`crate::run::error_estimate`] has.
pub fn is_needed(scene: &Scene) -> bool {
    scene.beyond(&[ModelLevel::Friction]).is_some() || scene.rounds_parameters()
}

/// [`crate::run::error_estimate::run_with_bounds`] of such a scene.
pub(crate) fn run_with_bounds(
    scene: &Scene,
    orbit: &mut Orbit,
    impacts: u64,
    mut visit: impl FnMut(&Contact, f64) -> bool,
) -> Option<Ending> {
    let mut estimate = FullErrorEstimate::new(scene, orbit.t(), ROUNDING);
    orbit::run(orbit, impacts, |contact| {
        let bound = estimate.bound();
        if let (Some(strike), Some(flight_time)) = (&contact.strike, contact.flight_time) {
            let Contact { n, x, state, clearance, .. } = *contact;
            estimate.bounce(&PreImpact { clearance, ..PreImpact::at(n, x, state) }, strike, flight_time);
        }
        visit(contact, bound)
    })
}

/// Gives the parameters of a rod their errors, in numbers that round by the share `unit`: each by as many roundings as [`Scene::parameters`]
/// makes. They are off by the same at every bounce; a run with 31 digits has them to its own digits.
fn round_parameters(scene: &Scene, rod: &mut Rod<Number16>, unit: f64) {
    let sloped = scene.incline != std::f64::consts::FRAC_PI_2;
    rod.gravity.partials[OF_GRAVITY] = if sloped { 2.0 * unit * rod.gravity.value } else { 0.0 };
    rod.radius_of_gyration.partials[OF_GYRATION] = 1.5 * unit * rod.radius_of_gyration.value;
    let off = scene.table_errors();
    if rod.strike_gain.value != 2.0 {
        rod.strike_gain.partials[OF_GAIN] = scene.strike_gain_roundings() * unit * rod.strike_gain.value;
    }
    if off.speed != 0.0 {
        // (1 + e)((1 + ε)κ_E).
        rod.strike_gain_per_energy.partials[OF_GAIN] = 4.0 * unit * rod.strike_gain_per_energy.value;
    }
    if off.tilt_gain != 0.0 {
        // κ(1 + ε): near κ(1 + ε) = 1 the swing has little but this.
        rod.tilt_gain.partials[OF_TILT] = 2.0 * unit * rod.tilt_gain.value;
    }
    if off.offset != 0.0 {
        // √(a² + d²).
        rod.contact_distance.partials[OF_DISTANCE] = 2.0 * unit * rod.contact_distance.value;
    }
}

impl FullErrorEstimate {
    /// The error estimate of a run with 31 digits, just before its first contact at `first`, s after release.
    pub(crate) fn of_extended_run(scene: &Scene, first: f64) -> Self {
        Self::new(scene, first, double_double::ROUNDING)
    }

    /// The error estimate of the run of a scene, just before its first contact at `first` (s after release), in numbers that round by
    /// the share `unit`.
    fn new(scene: &Scene, first: f64, unit: f64) -> Self {
        let mut body: Body<Number16> = scene.body_in();
        let program = body.program.take();
        round_parameters(scene, &mut body.rod, unit);
        let mut estimate = Self {
            body,
            program,
            holds_energy: scene.rules().holds_energy,
            is_first: true,
            covariance: SMatrix::zeros(),
            of_parameters: SMatrix::zeros(),
            plan: None,
            unit,
            rounding: unit,
            lost: false,
        };
        if let Some(height) = scene.target_height {
            estimate.aim(height);
        }
        let release = scene.release();
        if first > 0.0 {
            let flight = scene.model().rod.flight_from(release);
            let doubt = 2.0 * (release.height.abs() + 2.0 * flight.contact_distance);
            estimate.fly(&flight, 1, release.x, first, doubt);
        }
        estimate
    }

    /// Takes the target of strike `n`, if targets differ.
    fn aim_at(&mut self, n: u64) {
        if let Some(program) = self.program {
            self.aim(program.at(n));
        }
    }

    /// The energy of a target height, m, off by its rounding and that of the energy which it is compared with.
    fn aim(&mut self, height: f64) {
        let rod = &mut self.body.rod;
        let energy = rod.gravity.value * height;
        rod.target_energy = Number16::from_f64(energy);
        rod.target_energy.partials[OF_GAIN] =
            self.unit * (2.0 * energy.abs() + rod.gravity.value * rod.contact_distance.value);
        rod.target_energy.partials[OF_GRAVITY] = rod.gravity.partials[OF_GRAVITY] * height;
    }

    /// Same as [`crate::run::error_estimate::ErrorEstimate::bound`].
    pub(crate) fn bound(&self) -> f64 {
        let rho = self.body.rod.radius_of_gyration.value;
        let variance =
            |state: usize| self.covariance[(state, state)].max(0.0) + self.of_parameters.row(state).norm_squared();
        let parts = [rho * rho * variance(THETA), variance(X_DOT), variance(Y_DOT), rho * rho * variance(THETA_DOT)];
        let sum: f64 = parts.iter().sum();
        if self.lost || !sum.is_finite() {
            return f64::INFINITY;
        }
        SAFETY * parts.into_iter().fold(0.0, f64::max).sqrt()
    }

    /// Goes on over contact `n` of the run and the flight after it.
    pub(crate) fn bounce(&mut self, coming: &PreImpact, strike: &Strike, flight_time: f64) {
        if self.lost {
            return;
        }
        let n = coming.n;
        self.aim_at(n);
        self.rounding = self.unit * (1.0 + 2.0 * REPEATING * REPEATING * n as f64).sqrt();
        let PreImpact { x, clearance, state, .. } = *coming;
        let plan = self.plan;
        let along = |value, direction| Number16::along(value, direction, 1.0);
        let lifted = PreImpact {
            n,
            x: along(x, X),
            clearance: along(clearance, HEIGHT),
            state: along_states(&state, THETA),
            plan: plan.map(|plan| PlannedTableMotion {
                alpha: along(plan.alpha, PLAN),
                normal_velocity: along(plan.normal_velocity, PLAN + 1),
                tangential_velocity: along(plan.tangential_velocity, PLAN + 2),
            }),
        };
        let alpha = self.body.tilt(&lifted).alpha + along(0.0, ASIDE);
        let tilt = Tilt::new(lifted.state.theta, alpha, lifted.state.theta - alpha);
        let mut struck = self.body.strike_at(&lifted, &tilt);
        let mut energy = Number16::from_f64(0.0);
        if self.holds_energy {
            let held = if self.is_first { struck.energy } else { along(struck.energy.value, ENERGY) };
            energy = self.body.rod.hold_energy(&mut struck, held);
        }
        let after = struck.after;
        let zero = Number16::from_f64(0.0);
        let derivative = rows(&[
            lifted.x,
            lifted.clearance,
            after.theta,
            after.x_dot,
            after.y_dot,
            after.theta_dot,
            zero,
            zero,
            zero,
            energy,
        ]);
        let turned = self.rounding * (self.rounded_tilt(coming, strike.alpha) + state.theta.abs());
        self.carry(&derivative, turned);
        self.round_strike(&state, x, strike);
        self.is_first = false;
        let flight = Flight {
            start: strike.after,
            sin_cos_theta: strike.sin_cos_theta,
            clearance,
            contact_distance: self.body.rod.contact_distance.value,
            gravity: self.body.rod.gravity.value,
            drag: self.body.drag.and_then(|drag| drag.map(Number::to_f64)),
        };
        self.fly(&flight, n + 1, x, flight_time, 0.0);
    }

    /// Sizes of the terms of a tilt, rad; a planned one is a state.
    fn rounded_tilt(&self, coming: &PreImpact, alpha: f64) -> f64 {
        let State { theta, x_dot, theta_dot, .. } = coming.state;
        match self.body.steering {
            _ if self.plan.is_some() => alpha.abs(),
            Steering::TiltGain => {
                2.0 * (alpha.abs() + (self.body.rod.tilt_gain.value * self.body.lag.value * theta_dot).abs())
            }
            Steering::Feedback(gains) => {
                let gains = gains.map(|gain| gain.value);
                let Gains { x, theta: by_theta, x_dot: by_x_dot, theta_dot: by_theta_dot } = gains;
                let terms = [x * coming.x, by_theta * theta, by_x_dot * x_dot, by_theta_dot * theta_dot];
                let earlier = self.body.lag.value * ((x * x_dot).abs() + (by_theta * theta_dot).abs());
                alpha.abs() + 2.0 * (terms.map(f64::abs).iter().sum::<f64>() + earlier)
            }
        }
    }

    /// J Σ Jᵀ with an error of standard deviation `aside` along [`ASIDE`], and J X + J_p.
    fn carry(&mut self, derivative: &Derivative, aside: f64) {
        let by_states = derivative.fixed_columns::<STATES>(0);
        let off: States = derivative.column(ASIDE) * aside;
        self.covariance = by_states * self.covariance * by_states.transpose() + off * off.transpose();
        self.of_parameters = by_states * self.of_parameters + derivative.fixed_columns::<PARAMETERS>(STATES);
    }

    /// Adds independent errors, one standard deviation of each state.
    fn add(&mut self, deviations: &[(usize, f64)]) {
        for &(state, deviation) in deviations {
            self.covariance[(state, state)] += deviation * deviation;
        }
    }

    /// Adds an error of several states at once, one standard deviation of each.
    fn add_along(&mut self, parts: &[(usize, f64)]) {
        let mut direction = States::zeros();
        for &(state, part) in parts {
            direction[state] = part;
        }
        self.covariance += direction * direction.transpose();
    }

    /// Adds what a strike rounds beside its tilt: the impulses along their own directions, the energy along the velocity, and each sum.
    fn round_strike(&mut self, before: &State, x: f64, strike: &Strike) {
        let rod = self.body.rod.map(|number| number.value);
        let (l, rho, rounding) = (rod.contact_distance, rod.radius_of_gyration, self.rounding);
        let tilt = Tilt::new(before.theta, strike.alpha, before.theta - strike.alpha);
        let (sin, cos, across, reach) = (tilt.sin_alpha, tilt.cos_alpha, l * tilt.sin_beta, l * tilt.cos_beta());
        let [struck, dragged] = self.body.turning.map_or([0.0; 2], |turning| {
            turning.map(|number| number.value).rounded_terms(
                &rod,
                &self.body.steering.map(|gain| gain.value),
                x,
                before,
                &tilt,
            )
        });
        let leverage = 1.0 / (rho * rho);
        let (impulse, tangential) = (strike.impulse_normal, strike.impulse_tangential);
        let State { x_dot, y_dot, theta_dot, .. } = strike.after;
        let terms = (cos * before.y_dot).abs()
            + (sin * before.x_dot).abs()
            + (across * before.theta_dot).abs()
            + self.plan.map_or(0.0, |plan| plan.normal_velocity.abs())
            + struck;
        let gain = (impulse / strike.approach).abs();
        let along = rounding * (2.0 * gain * terms + 3.0 * impulse.abs());
        self.add_along(&[(X_DOT, -sin * along), (Y_DOT, cos * along), (THETA_DOT, across * leverage * along)]);
        if let Some(friction) = self.body.friction {
            let slides = friction.slide == Slide::None || self.plan.is_some();
            let terms = if slides {
                (cos * before.x_dot).abs()
                    + (sin * before.y_dot).abs()
                    + (reach * before.theta_dot).abs()
                    + tangential_velocity(&rod, before, &tilt).abs()
                    + dragged
            } else {
                dragged
            };
            let aside = rounding * (2.0 * terms + 3.0 * tangential.abs()) + along * (tangential / impulse).abs();
            self.add_along(&[(X_DOT, cos * aside), (Y_DOT, sin * aside), (THETA_DOT, reach * leverage * aside)]);
        }
        if self.holds_energy {
            let parts = 1.5 * strike.speed_squared + 2.0 * rod.gravity * l * (1.0 - strike.sin_cos_theta.1);
            let stretch = rounding * parts / strike.speed_squared;
            self.add_along(&[(X_DOT, x_dot * stretch), (Y_DOT, y_dot * stretch), (THETA_DOT, theta_dot * stretch)]);
            let energy_parts = if self.is_first { parts } else { 4.0 * strike.energy_gain.abs() };
            self.add(&[(ENERGY, rounding * (energy_parts + if strike.energy_gain == 0.0 { 0.0 } else { parts }))]);
        }
        let turn = leverage * ((impulse * across).abs() + (tangential * reach).abs());
        let pushed = impulse.abs() + tangential.abs();
        self.add(&[
            (X_DOT, rounding * (2.0 * x_dot.abs() + 3.0 * ((impulse * sin).abs() + tangential.abs()))),
            (Y_DOT, rounding * (2.0 * y_dot.abs() + pushed)),
            (THETA_DOT, rounding * (2.0 * theta_dot.abs() + 3.0 * turn)),
        ]);
    }

    /// Carries the errors over a flight of length `t` from the place `x` to contact `n`, in which terms of `doubt` m more are rounded.
    fn fly(&mut self, flight: &Flight, n: u64, x: f64, t: f64, doubt: f64) {
        // A plan is made for the coming target.
        self.aim_at(n);
        let along = |value, direction| Number16::along(value, direction, 1.0);
        let start = along_states(&flight.start, THETA);
        let flying = Flight {
            start,
            sin_cos_theta: start.theta.sincos(),
            clearance: along(flight.clearance, HEIGHT),
            contact_distance: self.body.rod.contact_distance,
            gravity: self.body.rod.gravity,
            drag: self.body.drag,
        };
        let Some(landing) = Landing::new(&self.body, (flight, &flying), (n, along(x, X)), t, along(0.0, ASIDE)) else {
            self.lost = true;
            return;
        };
        let Landing { arrival, speed, times, parts } = landing;
        let deviation_of_time = times.iter().map(|time| self.deviation(time)).fold(0.0, f64::max);
        let Arrival { state, clearance, plan, .. } = arrival;
        let zero = Number16::from_f64(0.0);
        let [alpha, normal, tangential] =
            plan.map_or([zero; 3], |plan| [plan.alpha, plan.normal_velocity, plan.tangential_velocity]);
        let derivative = rows(&[
            along(x, X) + arrival.way,
            clearance,
            state.theta,
            state.x_dot,
            state.y_dot,
            state.theta_dot,
            alpha,
            normal,
            tangential,
            along(0.0, ENERGY),
        ]);
        let off = self.deviation(&speed);
        let (l, speed) = (flight.contact_distance, speed.value.abs());
        let grazing = SAFETY * off / speed;
        let turned = (flight.start.theta_dot * t).abs();
        let reach = l * (flight.sin_cos_theta.0.abs() * turned.min(1.0) + (0.5 * turned * turned).min(2.0));
        let parts =
            parts + t * (flight.start.y_dot.abs() + flight.gravity * t) + 3.0 * reach + flight.clearance.abs() + doubt;
        let parts = match flight.drag {
            None => parts,
            Some(drag) => {
                let decayed = (4.0 + 16.0 * drag.linear * t) * t * (flight.start.y_dot.abs() + flight.gravity * t);
                parts + decayed + (4.0 + 16.0 * drag.rotational * t) * l * turned
            }
        };
        let late = self.rounding * (t + parts / speed) + deviation_of_time * grazing;
        let bulges = flight.bulge() > flight.gravity;
        self.carry(&derivative, late);
        let end = if flight.drag.is_some() { state.map(|number| number.value) } else { flight.end(t) };
        let rounding = self.rounding;
        if let Some(drag) = flight.drag {
            // A decay rounds its share, and the exponent of that.
            let of_place = rounding * (4.0 + 16.0 * drag.linear * t);
            let of_turn = rounding * (4.0 + 16.0 * drag.rotational * t);
            let fallen = flight.start.y_dot.abs() + flight.gravity * t;
            self.add(&[
                (X, of_place * (flight.start.x_dot * t).abs()),
                (X_DOT, of_place * end.x_dot.abs()),
                (Y_DOT, of_place * fallen),
                (THETA, of_turn * turned),
                (THETA_DOT, of_turn * end.theta_dot.abs()),
            ]);
        }
        let whole = x.abs() + 2.0 * (flight.start.x_dot * t).abs();
        self.add(&[
            (X, rounding * whole),
            (THETA, rounding * if turned > 0.0 { end.theta.abs() + turned } else { 0.0 }),
            (Y_DOT, rounding * (end.y_dot.abs() + flight.gravity * t)),
        ]);
        if self.body.noise.is_some() {
            self.add(&[(HEIGHT, rounding * parts)]);
        }
        if let Some(plan) = plan {
            let speeds =
                end.x_dot.abs() + end.y_dot.abs() + flight.gravity * self.body.lag.value + l * end.theta_dot.abs();
            let seen = PreImpact::at(n, x + flight.start.x_dot * t, end);
            let of_tilt = self.rounded_tilt(&seen, plan.alpha.value) + plan.alpha.value.abs();
            self.add(&[
                (PLAN, rounding * of_tilt),
                (PLAN + 1, 6.0 * rounding * (speeds + plan.normal_velocity.value.abs())),
                (PLAN + 2, 6.0 * rounding * speeds),
            ]);
            if self.body.noise.is_some() {
                // The time at which the plane is met is rounded on its own.
                let met = rounding * (t + (parts + speeds * t) / speed);
                let rise = flight.gap(t).slope;
                let parts = [(X, end.x_dot), (HEIGHT, rise), (THETA, end.theta_dot), (Y_DOT, -flight.gravity)];
                self.add_along(&parts.map(|(state, rate)| (state, rate * met)));
            }
        }
        self.plan = plan.map(|plan| PlannedTableMotion {
            alpha: plan.alpha.value,
            normal_velocity: plan.normal_velocity.value,
            tangential_velocity: plan.tangential_velocity.value,
        });
        // Of a fast spin the flight may have other roots nearby.
        self.lost |= grazing.is_nan() || grazing >= GRAZING_SHARE || bulges;
    }

    /// Standard deviation of a number.
    fn deviation(&self, number: &Number16) -> f64 {
        let by_states = States::from_fn(|state, _| number.partials[state]);
        let of_parameters = self.of_parameters.transpose() * by_states
            + SMatrix::<f64, PARAMETERS, 1>::from_fn(|parameter, _| number.partials[STATES + parameter]);
        let independent = (by_states.transpose() * self.covariance * by_states)[0];
        (independent.max(0.0) + of_parameters.norm_squared()).sqrt()
    }
}

fn rows(components: &[Number16; STATES]) -> Derivative {
    Derivative::from_fn(|row, column| components[row].partials[column])
}
