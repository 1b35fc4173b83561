//! Error bound of a run in doubles against the exact one, contact by contact: the rounding of every bounce, carried forward by the
//! exact derivative of the map.
//!
//! Not here: the run itself ([`crate::run::orbit`]), which does not pay for this. Norms of derivatives alone would explode, since they
//! forget that the next bounce turns what the last one stretched; a covariance does not.

use crate::bounce::contact_time;
use crate::bounce::flight::Flight;
use crate::bounce::friction::{Friction, Slide};
use crate::bounce::strike::{Rod, State, Strike};
use crate::numbers::double_double;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::numbers::trig::sin_cos;
use crate::run::bounce_derivative;
use crate::run::bounce_derivative::{
    FlightDerivative, HeldEnergy, OF_GAIN, OF_GRAVITY, OF_GYRATION, STATES, StrikeAngles, UncertainRod, WIDTH,
};
use crate::run::cancellation::CHECK_INTERVAL;
use crate::run::ending::Ending;
use crate::run::extended;
use crate::run::orbit::{Contact, ContactByContact, Orbit, visit_contacts};
use crate::run::state_errors::StateErrors;
use crate::scene::Scene;
use crate::scene::model::ModelLevel;
use crate::table::program::HeightProgram;
use std::cell::Cell;

/// Standard deviations in a bound. Set on 28,000 random runs, none of which passed 0.8 of its bound;
/// `tests/error_estimate.rs` holds it on others against runs with 31 digits.
pub const SAFETY: f64 = 3.0;

/// Share of every rounding that is taken to be the same at each bounce: where a run comes to rest or repeats, so do they, and
/// what would grow with the root of the number of bounces grows with the number.
pub(crate) const REPEATING: f64 = 0.15;

/// Half a unit in the last place, as a share: the most that one rounding is off.
pub(crate) const ROUNDING: f64 = 0.5 * f64::EPSILON;

/// A contact is too near to grazing for a derivative to say anything when the bound on its speed is this share of it.
pub(crate) const GRAZING_SHARE: f64 = 0.25;

type Number8 = Dual<WIDTH>;

/// The error of a run just before its coming contact, carried along beside its orbit.
#[derive(Clone, Copy, Debug)]
pub struct ErrorEstimate {
    rod: UncertainRod,
    program: Option<HeightProgram>,
    friction: Option<Friction>,
    is_point: bool,
    holds_energy: bool,
    errors: StateErrors,
    energy: HeldEnergy,
    /// True from a strike, just after which these errors are, to the end of the flight that follows.
    is_flying: bool,
    /// The last flight and its length, s.
    flight: Flight,
    flight_time: f64,
    /// The most that one rounding is off, as a share.
    unit: f64,
    /// Standard deviation of a rounding, as a share, at this bounce.
    rounding: f64,
    /// True once derivatives say nothing any more.
    lost: bool,
}

/// A run in doubles with the errors of its contacts.
#[derive(Clone, Copy, Debug)]
struct EstimatedOrbit<'a> {
    orbit: Orbit,
    estimate: ErrorEstimate,
    /// [`ErrorEstimate::bound`] at the last contact.
    bound: &'a Cell<f64>,
}

impl ContactByContact for EstimatedOrbit<'_> {
    type Number = f64;

    #[inline(always)]
    fn next_contact<const PLAIN: bool>(&mut self) -> Contact {
        let estimate = &mut self.estimate;
        // The errors of the last flight are carried between strike and flight: the CPU does it while the bounce waits for its own numbers.
        let contact = self.orbit.advance_disturbed::<PLAIN>(
            #[inline(always)]
            |_, strike| estimate.pass_flight(strike.sin_cos_theta),
        );
        // A run may end before the strike.
        if estimate.is_flying {
            estimate.pass_flight(estimate.end_of_flight());
        }
        self.bound.set(estimate.bound());
        estimate.pass_strike(&contact);
        contact
    }
}

/// [`crate::run::orbit::run`] with the bound at each contact, as [`ErrorEstimate::bound`].
pub fn run_with_bounds(
    scene: &Scene,
    orbit: &Orbit,
    impacts: u64,
    mut visit: impl FnMut(&Contact, f64) -> bool,
) -> Option<Ending> {
    let estimate = ErrorEstimate::of_scene(scene, orbit.t());
    let bound = Cell::new(0.0);
    let visit = |contact: &Contact| visit(contact, bound.get());
    let mut run = EstimatedOrbit { orbit: *orbit, estimate, bound: &bound };
    visit_contacts(&mut run, orbit.body.is_plain_rod(), impacts, visit)
}

/// The last contact, of the first `impacts`, up to which the map in doubles is within `tolerance` of the exact run (m/s,
/// as [`ErrorEstimate::bound`]). `None` if it is over all of them, or to the end of the run.
///
/// `go_on` is asked now and then; a `false` gives none too.
pub fn predictable_impacts(
    scene: &Scene,
    impacts: u64,
    tolerance: f64,
    mut go_on: impl FnMut() -> bool,
) -> Option<u64> {
    let mut last = None;
    run_with_bounds(scene, &scene.orbit().ok()?, impacts, |contact, bound| {
        if bound > tolerance {
            last = Some(contact.n - 1);
        }
        last.is_none() && (!contact.n.is_multiple_of(CHECK_INTERVAL) || go_on())
    });
    last
}

impl ErrorEstimate {
    /// The error estimate of the run of a scene in doubles, just before its first contact at `first` (s after release).
    pub fn of_scene(scene: &Scene, first: f64) -> Self {
        Self::new(scene, first, ROUNDING)
    }

    /// The same of [`crate::run::extended`].
    pub fn of_extended_run(scene: &Scene, first: f64) -> Self {
        Self::new(scene, first, double_double::ROUNDING)
    }

    fn new(scene: &Scene, first: f64, unit: f64) -> Self {
        let model = scene.model();
        let rod = model.rod;
        let mut lifted: Rod<Number8> = rod.lift();
        // Parameters that are rounded. Other factors of the strike, such as 1 − κ, act as the radius of gyration does.
        let sloped = scene.incline != std::f64::consts::FRAC_PI_2;
        lifted.gravity.partials[OF_GRAVITY] = if sloped { 2.0 * unit * rod.gravity } else { 0.0 };
        lifted.radius_of_gyration.partials[OF_GYRATION] = 1.5 * unit * rod.radius_of_gyration;
        if let Some(height) = scene.target_height {
            lifted.target_energy = target_energy(lifted.gravity, rod.contact_distance, height, unit);
        }
        if rod.strike_gain != 2.0 {
            lifted.strike_gain.partials[OF_GAIN] = scene.strike_gain_roundings() * unit * rod.strike_gain;
        }
        let release = scene.release();
        let mut estimate = Self {
            rod: UncertainRod::new(lifted),
            program: scene.program,
            friction: scene.contact_friction(),
            is_point: model.is_point,
            holds_energy: scene.rules().holds_energy,
            errors: StateErrors::NONE,
            energy: None,
            is_flying: false,
            flight: rod.flight_from(release),
            flight_time: first,
            unit,
            rounding: unit,
            // Not derived for more than friction, and for parameters that errors of the rig round.
            lost: scene.beyond(&[ModelLevel::Friction]).is_some() || scene.rounds_parameters(),
        };
        if first > 0.0 {
            let doubt = 2.0 * (release.height.abs() + 2.0 * rod.contact_distance);
            let end = estimate.flight.end(first);
            estimate.fly(sin_cos(end.theta), doubt);
        }
        estimate
    }

    /// Bound on the largest of |ρδθ| (m), |δẋ|, |δẏ| and |ρδθ̇| (m/s) just before the coming contact; infinite once nothing is
    /// known any more. Of a point mass, on that of |δẋ| and |δẏ|.
    #[inline(always)]
    pub fn bound(&self) -> f64 {
        if self.lost {
            return f64::INFINITY;
        }
        let rho = self.rod.plain.radius_of_gyration;
        let [theta, x_dot, y_dot, theta_dot] = self.errors.variances();
        let turned = if self.is_point { 0.0 } else { rho * rho * theta };
        let spin = rho * rho * theta_dot;
        if (turned + x_dot + y_dot + spin).is_finite() {
            SAFETY * turned.max(x_dot).max(y_dot).max(spin).sqrt()
        } else {
            f64::INFINITY
        }
    }

    /// Goes on over a contact of the run and the flight after it; over one without a flight it does nothing.
    #[inline(always)]
    pub fn pass(&mut self, contact: &Contact) {
        self.pass_strike(contact);
        self.pass_flight(self.end_of_flight());
    }

    /// Goes on over the strike of a contact; [`ErrorEstimate::pass_flight`] has to follow.
    #[inline(always)]
    fn pass_strike(&mut self, contact: &Contact) {
        if let (Some(strike), Some(flight_time)) = (&contact.strike, contact.flight_time) {
            self.bounce(contact.n, &contact.state, strike, flight_time);
        }
    }

    /// The same with a contact of 31 digits.
    pub fn pass_extended(&mut self, contact: &extended::ExtendedContact) {
        if let (Some(strike), Some(flight_time)) = (&contact.strike, contact.flight_time) {
            let state = extended::in_doubles(&contact.state);
            self.bounce(contact.n, &state, &strike.map(DoubleDouble::to_f64), flight_time.to_f64());
            self.pass_flight(self.end_of_flight());
        }
    }

    #[inline(always)]
    fn bounce(&mut self, n: u64, state: &State, strike: &Strike, flight_time: f64) {
        if self.lost {
            return;
        }
        if let Some(program) = &self.program {
            let Rod { gravity, .. } = self.rod.lifted;
            let energy = target_energy(gravity, self.rod.plain.contact_distance, program.at(n), self.unit);
            self.rod.set_target_energy(energy);
        }
        self.rounding = self.unit * (1.0 + 2.0 * REPEATING * REPEATING * n as f64).sqrt();
        let angles = StrikeAngles::new(&self.rod, strike);
        let derivative = match &self.friction {
            None => {
                let held = self.holds_energy.then_some(self.energy);
                bounce_derivative::of_strike(&self.rod, state, strike, &angles, held)
            }
            Some(friction) => bounce_derivative::of_strike_with_friction(friction, &self.rod.lifted, state),
        };
        let mut errors = self.errors.after_strike(&derivative);
        if let Some(energy) = &derivative.energy {
            let rounding = self.rounding * self.energy_parts(strike);
            let held = errors.hold(self.errors, derivative, *energy, rounding * rounding);
            (errors, self.energy) = (held.0, Some(held.1));
        }
        self.round_strike(&mut errors, state, strike, &angles);
        self.errors = errors;
        (self.flight, self.flight_time) = (self.rod.plain.flight(strike), flight_time);
        self.is_flying = true;
    }

    /// Goes on to the end of the flight, if there is one, with sin θ and cos θ there.
    #[inline(always)]
    fn pass_flight(&mut self, end: (f64, f64)) {
        if self.is_flying {
            self.is_flying = false;
            self.fly(end, 0.0);
        }
    }

    /// Sine and cosine of the angle at the end of the flight.
    fn end_of_flight(&self) -> (f64, f64) {
        sin_cos(self.flight.end(self.flight_time).theta)
    }

    /// Terms of the energy before a strike, m²/s².
    #[inline(always)]
    fn parts(&self, strike: &Strike) -> f64 {
        let weight = self.rod.plain.gravity * self.rod.plain.contact_distance;
        1.5 * strike.speed_squared + 2.0 * weight * (1.0 - strike.sin_cos_theta.1)
    }

    /// Terms of the held energy that a strike rounds, which are those that it changes, m²/s².
    fn energy_parts(&self, strike: &Strike) -> f64 {
        if self.energy.is_none() {
            self.parts(strike)
        } else if strike.energy_gain != 0.0 {
            (strike.energy + strike.energy_gain).abs() + 4.0 * strike.energy_gain.abs()
        } else {
            0.0
        }
    }

    /// Adds what the strike rounds: the impulse along its own direction, the energy along the velocity, the tilt, and each sum.
    #[inline(always)]
    fn round_strike(&self, errors: &mut StateErrors, before: &State, strike: &Strike, angles: &StrikeAngles) {
        let l = self.rod.plain.contact_distance;
        let StrikeAngles { sin_alpha, cos_alpha, cos_beta, arm, turn, per_mobility, per_square, .. } = *angles;
        let impulse = strike.impulse_normal;
        let State { x_dot, y_dot, theta_dot, .. } = strike.after;
        let terms =
            (cos_alpha * before.y_dot).abs() + (sin_alpha * before.x_dot).abs() + (arm * before.theta_dot).abs();
        let gain = if self.friction.is_none() && self.rod.is_steady {
            self.rod.plain.strike_gain.abs() * per_mobility
        } else {
            impulse.abs() / strike.normal_velocity.abs()
        };
        let along = self.rounding * (2.0 * gain * terms + 3.0 * impulse.abs());
        let stretch = if self.holds_energy { self.rounding * self.parts(strike) * per_square } else { 0.0 };
        let of_sums = [
            0.0,
            2.0 * x_dot.abs() + 3.0 * (impulse * sin_alpha).abs(),
            2.0 * y_dot.abs() + impulse.abs(),
            2.0 * theta_dot.abs() + 3.0 * (impulse * turn).abs(),
        ];
        errors.add(of_sums.map(|parts| (self.rounding * parts) * (self.rounding * parts)));
        // α and β are rounded before their sines are: a table that is turned a little, by which the impulse changes so much.
        let beta = (1.0 - self.rod.plain.tilt_gain) * before.theta;
        let turned = self.rounding * (strike.alpha.abs() + beta.abs());
        let across = cos_alpha * before.x_dot + sin_alpha * before.y_dot + l * cos_beta * before.theta_dot;
        let change = gain * across + 2.0 * impulse * turn * (l * cos_beta) * per_mobility;
        let mut directions = [
            [-sin_alpha * along, cos_alpha * along, turn * along],
            [x_dot * stretch, y_dot * stretch, theta_dot * stretch],
            [
                turned * (-cos_alpha * impulse - sin_alpha * change),
                turned * (-sin_alpha * impulse + cos_alpha * change),
                turned * (turn * change - l * cos_beta * self.rod.leverage * impulse),
            ],
        ];
        if let Some(friction) = self.friction {
            // The impulse along the table takes the place of the energy, which is not held with friction. It follows the normal one, and
            // the sliding, a sum, unless the table matches that.
            let (sin, cos) = (sin_alpha * strike.sin_cos_theta.0, cos_alpha * strike.sin_cos_theta.1);
            let (reach, tangential) = (l * (cos + sin), strike.impulse_tangential);
            let terms =
                (cos_alpha * before.x_dot).abs() + (sin_alpha * before.y_dot).abs() + (reach * before.theta_dot).abs();
            let terms = if friction.slide == Slide::Matched { 0.0 } else { terms };
            let aside = self.rounding * (2.0 * terms + 3.0 * tangential.abs())
                + along * (tangential / impulse).abs()
                + turned * (2.0 * impulse.abs() + strike.normal_velocity.abs());
            directions[1] = [cos_alpha * aside, sin_alpha * aside, reach * self.rod.leverage * aside];
        }
        for direction in directions {
            errors.add_along(direction);
        }
    }

    /// Carries the errors over the flight to an end with these sin θ and cos θ. In it terms of `doubt` m more are rounded.
    #[inline(always)]
    fn fly(&mut self, end: (f64, f64), doubt: f64) {
        let Self { errors: struck, flight, flight_time: t, .. } = *self;
        let over = FlightDerivative::new(&flight, t, end, self.rod.heavier());
        let (mut errors, time_variance) = struck.after_flight(&over);
        let FlightDerivative { end, sin_cos_theta: (sin, cos), contact_speed, .. } = over;
        let (l, gravity, speed) = (flight.contact_distance, flight.gravity, contact_speed.abs());
        // ẏ_c = ẏ + l θ̇ sin θ.
        let of_speed = errors.variance_of_sum(l * end.theta_dot * cos, l * sin);
        let per_speed = over.per_speed.abs();
        let grazing_squared = SAFETY * SAFETY * of_speed * per_speed * per_speed;
        let turned = (end.theta_dot * t).abs();
        let reach = l * (flight.sin_cos_theta.0.abs() * turned.min(1.0) + (0.5 * turned * turned).min(2.0));
        let parts = t * (flight.start.y_dot.abs() + gravity * t) + 3.0 * reach + doubt;
        // The second order of the contact time: its error times the relative error of the speed it divides by.
        let late = self.rounding * (t + parts * per_speed) + (time_variance * grazing_squared).sqrt();
        let of_theta = self.rounding * if turned > 0.0 { end.theta.abs() + turned } else { 0.0 };
        let of_y_dot = self.rounding * (end.y_dot.abs() + gravity * t);
        errors.add([of_theta * of_theta, 0.0, of_y_dot * of_y_dot, 0.0]);
        errors.add_along_flight(end.theta_dot * late, -gravity * late);
        if self.is_point {
            errors.set_angle_of_velocity(end.x_dot, end.y_dot);
        }
        self.lost |= grazing_squared.is_nan()
            || grazing_squared >= GRAZING_SHARE * GRAZING_SHARE
            || (flight.bulge() > gravity && !same_root(struck.variances(), flight, t, speed));
        self.errors = errors;
    }
}

/// Tells whether all flights within the bound, of errors just after the strike, end at the same root of the gap. Only a fast spin has
/// more than one.
#[cold]
#[inline(never)]
fn same_root(struck: [f64; STATES], flight: Flight, t: f64, speed: f64) -> bool {
    let l = flight.contact_distance;
    let [theta, _, y_dot, theta_dot] = struck.map(f64::sqrt);
    let reach = SAFETY * (y_dot + l * theta_dot + 2.0 * l * theta / t) + ROUNDING * l / t;
    [-reach, reach].into_iter().all(|reach| {
        let mut aside = flight;
        aside.start.y_dot += reach;
        (aside.clearance > 0.0 || aside.gap(0.0).slope > 0.0)
            && contact_time::first_contact(&aside)
                .is_ok_and(|root| (root - t).abs() <= 4.0 * reach.abs() * t / speed + 1e-12 * t)
    })
}

/// The energy of a target height, m, off by its rounding and that of the energy which it is compared with.
fn target_energy(gravity: Number8, contact_distance: f64, height: f64, unit: f64) -> Number8 {
    let mut energy = Number8::from_f64(gravity.value * height);
    energy.partials[OF_GAIN] = unit * (2.0 * energy.value.abs() + gravity.value * contact_distance);
    energy.partials[OF_GRAVITY] = gravity.partials[OF_GRAVITY] * height;
    energy
}
