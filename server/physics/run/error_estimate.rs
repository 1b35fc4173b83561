//! Error bound of a run in doubles against the exact one, contact by contact: the rounding of every bounce, carried forward by the
//! exact derivative of the map.
//!
//! Not here: the run itself ([`crate::run::orbit`]), which does not pay for this. Norms of derivatives alone would explode, since they
//! forget that the next bounce turns what the last one stretched; a covariance does not.

use crate::bounce::contact_time;
use crate::bounce::flight::Flight;
use crate::bounce::friction::{Friction, Slide};
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::numbers::double_double;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::dual::Dual;
use crate::numbers::number::Number;
use crate::run::cancellation::CHECK_INTERVAL;
use crate::run::extended;
use crate::run::orbit::Contact;
use crate::scene::Scene;
use crate::scene::model::{Model, ModelLevel};
use crate::table::program::HeightProgram;

/// Standard deviations in a bound. Set on 28,000 random runs, none of which passed 0.8 of its bound;
/// `tests/error_estimate.rs` holds it on others against runs with 31 digits.
pub const SAFETY: f64 = 3.0;

/// Share of every rounding that is taken to be the same at each bounce: where a run comes to rest or repeats, so do they, and
/// what would grow with the root of the number of bounces grows with the number.
const REPEATING: f64 = 0.15;

/// Half a unit in the last place, as a share: the most that one rounding is off.
const ROUNDING: f64 = 0.5 * f64::EPSILON;

/// Rounding of the states (five directions), and of three parameters, which is the same at every bounce.
const DIRECTIONS: usize = 8;
/// θ, ẋ, ẏ, θ̇ and the held energy.
const STATES: usize = 5;
const OF_GRAVITY: usize = STATES;
const OF_GYRATION: usize = STATES + 1;
const OF_GAIN: usize = STATES + 2;

/// A contact is too near to grazing for a derivative to say anything when the bound on its speed is this share of it.
const GRAZING_SHARE: f64 = 0.25;

type Number8 = Dual<DIRECTIONS>;

/// The error of a run just before its coming contact, carried along beside its orbit.
#[derive(Clone, Copy, Debug)]
pub struct ErrorEstimate {
    rod: Rod<Number8>,
    program: Option<HeightProgram>,
    friction: Option<Friction>,
    is_point: bool,
    holds_energy: bool,
    /// One standard deviation in each direction, as partials beside the values they belong to.
    state: State<Number8>,
    /// Held energy, from the first contact on.
    energy: Option<Number8>,
    /// The most that one rounding is off, as a share.
    unit: f64,
    /// Standard deviation of a rounding, as a share, at this bounce.
    rounding: f64,
    /// True once derivatives say nothing any more.
    lost: bool,
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
    let mut orbit = scene.orbit().ok()?;
    let mut estimate = ErrorEstimate::of_scene(scene, orbit.t());
    for n in 0..impacts {
        if estimate.bound() > tolerance {
            return Some(n);
        }
        let contact = orbit.advance();
        if contact.flight_time.is_none() || (n.is_multiple_of(CHECK_INTERVAL) && !go_on()) {
            break;
        }
        estimate.pass(&contact);
    }
    None
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
        let rod = *model.rod();
        let mut lifted: Rod<Number8> = rod.lift();
        // Parameters that are rounded. Other factors of the strike, such as 1 − κ, act as the radius of gyration does.
        let sloped = scene.incline != std::f64::consts::FRAC_PI_2;
        lifted.gravity.partials[OF_GRAVITY] = if sloped { 2.0 * unit * rod.gravity } else { 0.0 };
        lifted.radius_of_gyration.partials[OF_GYRATION] = 1.5 * unit * rod.radius_of_gyration;
        if let Some(height) = scene.target_height {
            lifted.target_energy = target_energy(&lifted, height, unit);
        }
        if rod.strike_gain != 2.0 {
            lifted.strike_gain.partials[OF_GAIN] = 2.0 * unit * rod.strike_gain;
        }
        let release = scene.release();
        let exact = Number8::from_f64;
        let start = release.state.map(exact);
        let mut estimate = Self {
            rod: lifted,
            program: scene.program,
            friction: scene.contact_friction(),
            is_point: matches!(model, Model::Point(_)),
            holds_energy: scene.rules().holds_energy,
            state: start,
            energy: None,
            unit,
            rounding: unit,
            // Not derived for more than friction.
            lost: scene.beyond(&[ModelLevel::Friction]).is_some(),
        };
        if first > 0.0 {
            let (sin, cos) = start.theta.sincos();
            let flight = Flight {
                start,
                sin_cos_theta: (sin, cos),
                clearance: exact(release.height) - lifted.contact_distance * cos,
                contact_distance: lifted.contact_distance,
                gravity: lifted.gravity,
            };
            let doubt = 2.0 * (release.height.abs() + 2.0 * rod.contact_distance);
            estimate.fly(&flight, first, doubt);
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
        let rho = self.rod.radius_of_gyration.value;
        let State { theta, x_dot, y_dot, theta_dot } = &self.state;
        let turned = if self.is_point { 0.0 } else { rho * spread(theta) };
        let bound = SAFETY * turned.max(spread(x_dot)).max(spread(y_dot)).max(rho * spread(theta_dot));
        if bound.is_finite() { bound } else { f64::INFINITY }
    }

    /// Goes on over a contact of the run and the flight after it; over one without a flight it does nothing.
    #[inline(always)]
    pub fn pass(&mut self, contact: &Contact) {
        self.bounce(contact.n, &contact.state, contact.flight_time);
    }

    /// The same with a contact of 31 digits.
    pub fn pass_extended(&mut self, contact: &extended::ExtendedContact) {
        let state = extended::in_doubles(&contact.state);
        let flight_time = contact.flight_time.map(DoubleDouble::to_f64);
        self.bounce(contact.n, &state, flight_time);
    }

    #[inline(always)]
    fn bounce(&mut self, n: u64, state: &State, flight_time: Option<f64>) {
        let Some(flight_time) = flight_time else { return };
        if self.lost {
            return;
        }
        let State { theta, x_dot, y_dot, theta_dot } = *state;
        if let Some(program) = &self.program {
            self.rod.target_energy = target_energy(&self.rod, program.at(n), self.unit);
        }
        self.rounding = self.unit * (1.0 + 2.0 * REPEATING * REPEATING * n as f64).sqrt();
        for (number, value) in [
            (&mut self.state.theta, theta),
            (&mut self.state.x_dot, x_dot),
            (&mut self.state.y_dot, y_dot),
            (&mut self.state.theta_dot, theta_dot),
        ] {
            number.value = value;
        }
        let mut strike = match self.friction {
            None => self.rod.strike(&self.state),
            Some(friction) => friction.strike_by_tilt_gain(&self.rod, &self.state),
        };
        let mut energy = Number8::from_f64(0.0);
        if self.holds_energy {
            let held = self.energy.map(|held| Dual { value: strike.energy.value, ..held });
            let should = held.unwrap_or(strike.energy);
            energy = self.rod.hold_energy(&mut strike, should);
        }
        self.round_strike(&mut strike, &mut energy);
        self.energy = Some(energy);
        let flight = self.rod.flight(&strike);
        self.fly(&flight, flight_time, 0.0);
    }

    /// Adds what the strike rounds: the impulse along its own direction, the energy along the velocity, the tilt, and each sum.
    #[inline(always)]
    fn round_strike(&self, strike: &mut Strike<Number8>, energy: &mut Number8) {
        let before = &self.state;
        let (l, rho) = (self.rod.contact_distance.value, self.rod.radius_of_gyration.value);
        let (sin_alpha, cos_alpha) = crate::numbers::trig::sin_cos(strike.alpha.value);
        let beta = (1.0 - self.rod.tilt_gain.value) * before.theta.value;
        let (sin_beta, cos_beta) = crate::numbers::trig::sin_cos(beta);
        let (impulse, turn) = (strike.impulse_normal.value, l * sin_beta / (rho * rho));
        let State { theta, x_dot, y_dot, theta_dot } = &mut strike.after;
        let terms = (cos_alpha * before.y_dot.value).abs()
            + (sin_alpha * before.x_dot.value).abs()
            + (l * sin_beta * before.theta_dot.value).abs();
        let gain = impulse.abs() / strike.normal_velocity.value.abs();
        let along = self.rounding * (2.0 * gain * terms + 3.0 * impulse.abs());
        let weight = self.rod.gravity.value * l;
        let (_, versine) = crate::numbers::trig::sin_versine(before.theta.value);
        let parts = 1.5 * strike.speed_squared.value + 2.0 * weight * versine;
        let stretch = if self.holds_energy { self.rounding * parts / strike.speed_squared.value } else { 0.0 };
        // A held energy is rounded only if the strike changes it.
        let energy_parts = if self.energy.is_none() {
            parts
        } else if strike.energy_gain.value != 0.0 {
            energy.value.abs() + 4.0 * strike.energy_gain.value.abs()
        } else {
            0.0
        };
        let sums = [
            0.0,
            self.rounding * (2.0 * x_dot.value.abs() + 3.0 * (impulse * sin_alpha).abs()),
            self.rounding * (2.0 * y_dot.value.abs() + impulse.abs()),
            self.rounding * (2.0 * theta_dot.value.abs() + 3.0 * (impulse * turn).abs()),
            self.rounding * energy_parts,
        ];
        // α and β are rounded before their sines are: a table that is turned a little, by which the impulse changes so much.
        let turned = self.rounding * (strike.alpha.value.abs() + beta.abs());
        let across =
            cos_alpha * before.x_dot.value + sin_alpha * before.y_dot.value + l * cos_beta * before.theta_dot.value;
        let lever = l * sin_beta / rho;
        let change = gain * across + 2.0 * impulse * lever * (l * cos_beta / rho) / (1.0 + lever * lever);
        let mut directions = [
            [0.0, -sin_alpha * along, cos_alpha * along, turn * along, 0.0],
            [0.0, x_dot.value * stretch, y_dot.value * stretch, theta_dot.value * stretch, 0.0],
            [
                0.0,
                turned * (-cos_alpha * impulse - sin_alpha * change),
                turned * (-sin_alpha * impulse + cos_alpha * change),
                turned * (turn * change - l * cos_beta / (rho * rho) * impulse),
                0.0,
            ],
        ];
        if let Some(friction) = self.friction {
            // The impulse along the table takes the place of the energy, which is not held with friction. It follows the normal one, and
            // the sliding, a sum, unless the table matches that.
            let (sin, cos) = (sin_alpha * strike.sin_cos_theta.0.value, cos_alpha * strike.sin_cos_theta.1.value);
            let (arm, tangential) = (l * (cos + sin), strike.impulse_tangential.value);
            let terms = (cos_alpha * before.x_dot.value).abs()
                + (sin_alpha * before.y_dot.value).abs()
                + (arm * before.theta_dot.value).abs();
            let terms = if friction.slide == Slide::Matched { 0.0 } else { terms };
            let aside = self.rounding * (2.0 * terms + 3.0 * tangential.abs())
                + along * (tangential / impulse).abs()
                + turned * (2.0 * impulse.abs() + strike.normal_velocity.value.abs());
            directions[1] = [0.0, cos_alpha * aside, sin_alpha * aside, arm / (rho * rho) * aside, 0.0];
        }
        add([theta, x_dot, y_dot, theta_dot, energy], &sums, &directions);
        let (sin, cos) = &mut strike.sin_cos_theta;
        sin.partials = strike.after.theta.partials.map(|partial| cos.value * partial);
        cos.partials = strike.after.theta.partials.map(|partial| -sin.value * partial);
    }

    /// Carries the error over a flight of length `t`, in which terms of `doubt` m more are rounded.
    #[inline(always)]
    fn fly(&mut self, flight: &Flight<Number8>, t: f64, doubt: f64) {
        let time = flight.lift_root(t);
        let State { mut theta, x_dot, mut y_dot, theta_dot } = flight.end(time);
        let (sin, _) = theta.sincos();
        let contact_speed = y_dot + flight.contact_distance * theta_dot * sin;
        let (l, gravity) = (flight.contact_distance.value, flight.gravity.value);
        let speed = contact_speed.value.abs();
        let grazing = SAFETY * spread(&contact_speed) / speed;
        self.lost |= grazing.is_nan() || grazing >= GRAZING_SHARE || !self.same_root(flight, t, speed);
        let turned = (theta_dot.value * t).abs();
        let reach = l * (flight.sin_cos_theta.0.value.abs() * turned.min(1.0) + (0.5 * turned * turned).min(2.0));
        let parts = t * (flight.start.y_dot.value.abs() + gravity * t) + 3.0 * reach + doubt;
        // The second order of the contact time: its error times the relative error of the speed it divides by.
        let late = self.rounding * (t + parts / speed) + spread(&time) * grazing;
        let sums = [
            self.rounding * if turned > 0.0 { theta.value.abs() + turned } else { 0.0 },
            0.0,
            self.rounding * (y_dot.value.abs() + gravity * t),
            0.0,
            0.0,
        ];
        let directions = [[theta_dot.value * late, 0.0, -gravity * late, 0.0, 0.0], [0.0; STATES]];
        let (mut x_dot, mut theta_dot) = (x_dot, theta_dot);
        let mut energy = self.energy.unwrap_or(Number8::from_f64(0.0));
        add([&mut theta, &mut x_dot, &mut y_dot, &mut theta_dot, &mut energy], &sums, &directions);
        if self.is_point {
            // The angle is that of the velocity.
            let per_square = 1.0 / (x_dot.value * x_dot.value + y_dot.value * y_dot.value);
            theta.partials = std::array::from_fn(|index| {
                (x_dot.value * y_dot.partials[index] - y_dot.value * x_dot.partials[index]) * per_square
            });
        }
        self.energy = self.energy.map(|_| energy);
        self.state = State { theta, x_dot, y_dot, theta_dot };
    }

    /// Tells whether all flights within the bound end at the same root of the gap. Only a fast spin has more than one.
    #[inline]
    fn same_root(&self, flight: &Flight<Number8>, t: f64, speed: f64) -> bool {
        let State { theta, y_dot, theta_dot, .. } = &flight.start;
        let l = flight.contact_distance.value;
        if l * theta_dot.value * theta_dot.value <= flight.gravity.value {
            return true;
        }
        let reach = SAFETY * (spread(y_dot) + l * spread(theta_dot) + 2.0 * l * spread(theta) / t) + ROUNDING * l / t;
        let plain = Flight {
            start: flight.start.map(|number| number.value),
            sin_cos_theta: (flight.sin_cos_theta.0.value, flight.sin_cos_theta.1.value),
            clearance: flight.clearance.value,
            contact_distance: l,
            gravity: flight.gravity.value,
        };
        [-reach, reach].into_iter().all(|reach| {
            let mut aside = plain;
            aside.start.y_dot += reach;
            (aside.clearance > 0.0 || aside.gap(0.0).slope > 0.0)
                && contact_time::first_contact(&aside)
                    .is_ok_and(|root| (root - t).abs() <= 4.0 * reach.abs() * t / speed + 1e-12 * t)
        })
    }
}

/// The energy of a target height, m, off by its rounding and that of the energy which it is compared with.
fn target_energy(rod: &Rod<Number8>, height: f64, unit: f64) -> Number8 {
    let mut energy = Number8::from_f64(rod.gravity.value * height);
    let weight = rod.gravity.value * rod.contact_distance.value;
    energy.partials[OF_GAIN] = unit * (2.0 * energy.value.abs() + weight);
    energy.partials[OF_GRAVITY] = rod.gravity.partials[OF_GRAVITY] * height;
    energy
}

/// The standard deviation of a number.
#[inline(always)]
fn spread<const K: usize>(number: &Dual<K>) -> f64 {
    number.partials.iter().map(|partial| partial * partial).sum::<f64>().sqrt()
}

/// Adds independent errors to five numbers: one to each, and two along directions. Their covariance gains D, and is factored
/// again into as many directions as there are numbers (Cholesky); the directions of parameters stay.
#[inline(always)]
fn add<const N: usize>(numbers: [&mut Number8; STATES], sums: &[f64; STATES], directions: &[[f64; STATES]; N]) {
    let mut covariance = [[0.0; STATES]; STATES];
    for row in 0..STATES {
        for column in 0..=row {
            let (one, other) = (&numbers[row].partials, &numbers[column].partials);
            let mut sum = if row == column { sums[row] * sums[row] } else { 0.0 };
            for index in 0..STATES {
                sum += one[index] * other[index];
            }
            for direction in directions {
                sum += direction[row] * direction[column];
            }
            covariance[row][column] = sum;
        }
    }
    // Without square roots on the way (L D Lᵀ): they would all wait for one another. `scaled` is L D.
    let mut factor = [[0.0; STATES]; STATES];
    let mut scaled = [[0.0; STATES]; STATES];
    let mut per_pivot = [0.0; STATES];
    for column in 0..STATES {
        for row in column..STATES {
            let known: f64 = (0..column).map(|index| scaled[row][index] * factor[column][index]).sum();
            scaled[row][column] = covariance[row][column] - known;
        }
        let pivot = scaled[column][column];
        per_pivot[column] = if pivot > 0.0 { 1.0 / pivot } else { 0.0 };
        for row in column..STATES {
            factor[row][column] = scaled[row][column] * per_pivot[column];
        }
    }
    let roots = per_pivot.map(f64::sqrt);
    for (row, scaled) in scaled.iter().enumerate() {
        for column in 0..=row {
            factor[row][column] = scaled[column] * roots[column];
        }
    }
    for (number, row) in numbers.into_iter().zip(factor) {
        number.partials[..STATES].copy_from_slice(&row);
    }
}
