//! Exact derivative of a bounce: of angle, velocities and held energy by the same before it, and by the parameters that are rounded.
//!
//! Not here: the errors that it carries along ([`crate::run::error_estimate`]). In closed form for a contact without friction, by dual
//! numbers with it; the tests of [`crate::run::state_errors`] hold the two together.

use crate::bounce::energy_feedback::EnergyFeedback;
use crate::bounce::flight::Flight;
use crate::bounce::friction::Friction;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::{MeasuredBounce, Strike};
use crate::numbers::dual::Dual;

/// θ, ẋ, ẏ, θ̇ and the held energy.
pub(crate) const STATES: usize = 5;
/// Numbers of a row: the states, then the parameters.
pub(crate) const WIDTH: usize = 8;

/// Indices in a row.
pub(crate) const THETA: usize = 0;
pub(crate) const X_DOT: usize = 1;
pub(crate) const Y_DOT: usize = 2;
pub(crate) const THETA_DOT: usize = 3;
pub(crate) const ENERGY: usize = 4;
pub(crate) const OF_GRAVITY: usize = STATES;
pub(crate) const OF_GYRATION: usize = STATES + 1;
pub(crate) const OF_GAIN: usize = STATES + 2;

/// Derivatives of one number by the states, and by each parameter times its error.
pub(crate) type Row = [f64; WIDTH];

/// The row of a number that is state `index`.
#[inline(always)]
pub(crate) fn unit(index: usize) -> Row {
    let mut row = [0.0; WIDTH];
    row[index] = 1.0;
    row
}

/// The sum of rows, each with a factor.
#[inline(always)]
pub(crate) fn sum<const N: usize>(terms: [(f64, &Row); N]) -> Row {
    let (first, terms) = terms.split_first().expect("a term");
    let mut row = first.1.map(|number| first.0 * number);
    for (factor, term) in terms {
        for (sum, term) in row.iter_mut().zip(*term) {
            *sum += factor * term;
        }
    }
    row
}

/// Derivative of a strike, which leaves the angle as it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrikeDerivative {
    pub(crate) x_dot: Row,
    pub(crate) y_dot: Row,
    pub(crate) theta_dot: Row,
    /// Held energy; `None` if the strike leaves it.
    pub(crate) energy: Option<Row>,
}

/// Sines and cosines of a strike: of the table's tilt α and of the angle β = θ − α.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrikeAngles {
    pub(crate) sin_alpha: f64,
    pub(crate) cos_alpha: f64,
    pub(crate) sin_beta: f64,
    pub(crate) cos_beta: f64,
}

impl StrikeAngles {
    #[inline(always)]
    pub(crate) fn new(strike: &Strike) -> Self {
        let (sin_theta, cos_theta) = strike.sin_cos_theta;
        let (sin_alpha, cos_alpha) = crate::numbers::trig::sin_cos(strike.alpha);
        Self {
            sin_alpha,
            cos_alpha,
            // Sums of angles: what they lose is a rounding of 1, and a derivative needs no more.
            sin_beta: sin_theta * cos_alpha - cos_theta * sin_alpha,
            cos_beta: cos_theta * cos_alpha + sin_theta * sin_alpha,
        }
    }
}

/// The derivative of a strike of a rod without friction on a table that tilts by κθ, eq. (24) with (27) and (28). `holds` tells whether the
/// energy is held, and of which energy: `Some(true)` of this contact, `Some(false)` of the one before.
#[inline(always)]
pub(crate) fn of_strike(
    rod: &Rod<Dual<WIDTH>>,
    before: &State,
    strike: &Strike,
    angles: &StrikeAngles,
    holds: Option<bool>,
) -> StrikeDerivative {
    let State { theta_dot, x_dot, y_dot, .. } = *before;
    let StrikeAngles { sin_alpha, cos_alpha, sin_beta, cos_beta } = *angles;
    let (sin_theta, cos_theta) = strike.sin_cos_theta;
    let (l, rho) = (rod.contact_distance.value, rod.radius_of_gyration.value);
    let (kappa, gravity) = (rod.tilt_gain.value, rod.gravity.value);
    let per_rho = 1.0 / rho;
    let per_rho_squared = per_rho * per_rho;
    // δρ/ρ and δG.
    let stretched = rod.radius_of_gyration.partials[OF_GYRATION] * per_rho;
    let heavier = rod.gravity.partials[OF_GRAVITY];
    let (arm, beta_rate) = (l * sin_beta, 1.0 - kappa);
    let arm_rate = l * cos_beta * beta_rate;
    let turn = arm * per_rho_squared;
    let (impulse, speed) = (strike.impulse_normal, strike.normal_velocity);
    let per_mobility = 1.0 / (1.0 + arm * turn);

    let mut mobility = [0.0; WIDTH];
    mobility[THETA] = 2.0 * turn * arm_rate;
    mobility[OF_GYRATION] = -2.0 * arm * turn * stretched;
    let mut normal_velocity = [0.0; WIDTH];
    normal_velocity[THETA] = arm_rate * theta_dot - kappa * (sin_alpha * y_dot + cos_alpha * x_dot);
    normal_velocity[X_DOT] = -sin_alpha;
    normal_velocity[Y_DOT] = cos_alpha;
    normal_velocity[THETA_DOT] = arm;
    let spin = rho * theta_dot;
    let kinetic = [0.0, x_dot, y_dot, rho * spin, 0.0, 0.0, spin * spin * stretched, 0.0];
    let weight = gravity * l;

    let is_steady = rod.strike_gain_per_energy.value == 0.0 && rod.energy_feedback != EnergyFeedback::OneStrike;
    let (gain, gain_row) = if is_steady {
        (rod.strike_gain.value, rod.strike_gain.partials)
    } else {
        // By the five numbers that it is measured by, and by the parameters, all in one dual number.
        let along = |value, direction| Dual::along(value, direction, 1.0);
        let gain = rod.gain(&MeasuredBounce {
            potential: along(weight * cos_theta, 0),
            y_dot: along(y_dot, 1),
            speed_squared: along(strike.speed_squared, 2),
            normal_velocity: along(speed, 3),
            mobility: along(1.0 + arm * turn, 4),
        });
        let [by_potential, by_y_dot, by_square, by_speed, by_mobility, of_parameters @ ..] = gain.partials;
        let [of_gravity, of_gyration, of_gain] = of_parameters;
        let mut row = [0.0, 0.0, by_y_dot, 0.0, 0.0, of_gravity, of_gyration, of_gain];
        row[THETA] -= by_potential * weight * sin_theta;
        row[OF_GRAVITY] += by_potential * l * cos_theta * heavier;
        let measured =
            sum([(2.0 * by_square, &kinetic), (by_speed, &normal_velocity), (by_mobility, &mobility), (1.0, &row)]);
        (gain.value, measured)
    };
    // P = −γ v_nc / B.
    let (by_speed, by_gain, by_mobility) = (-gain * per_mobility, -speed * per_mobility, -impulse * per_mobility);
    let mut impulse_row = sum([(by_speed, &normal_velocity)]);
    impulse_row[THETA] += by_mobility * mobility[THETA];
    impulse_row[OF_GYRATION] += by_mobility * mobility[OF_GYRATION];
    if is_steady {
        impulse_row[OF_GAIN] += by_gain * gain_row[OF_GAIN];
    } else {
        impulse_row = sum([(1.0, &impulse_row), (by_gain, &gain_row)]);
    }
    let mut energy = kinetic;
    energy[THETA] -= weight * sin_theta;
    energy[OF_GRAVITY] -= l * (1.0 - cos_theta) * heavier;
    // The velocities are stretched onto the held energy: not at the first contact, whose energy it is.
    let stretch = if holds == Some(false) {
        let mut missing = energy.map(|number| -number);
        missing[ENERGY] = 1.0;
        sum([(1.0 / strike.speed_squared, &missing)])
    } else {
        [0.0; WIDTH]
    };
    let after = strike.after;
    let mut x_dot = sum([(after.x_dot, &stretch), (-sin_alpha, &impulse_row)]);
    let mut y_dot = sum([(after.y_dot, &stretch), (cos_alpha, &impulse_row)]);
    let mut theta_dot = sum([(after.theta_dot, &stretch), (turn, &impulse_row)]);
    x_dot[X_DOT] += 1.0;
    x_dot[THETA] -= impulse * cos_alpha * kappa;
    y_dot[Y_DOT] += 1.0;
    y_dot[THETA] -= impulse * sin_alpha * kappa;
    theta_dot[THETA_DOT] += 1.0;
    theta_dot[THETA] += impulse * arm_rate * per_rho_squared;
    theta_dot[OF_GYRATION] -= 2.0 * impulse * turn * stretched;
    let keeps_energy = is_steady && gain == 2.0 && gain_row[OF_GAIN] == 0.0;
    let held = match holds {
        None => None,
        Some(false) if keeps_energy => None,
        Some(is_first) => {
            let mut held = if is_first { energy } else { unit(ENERGY) };
            if !keeps_energy {
                // ½(2 − γ) P v_nc.
                let kept = 0.5 * (2.0 - gain);
                held = sum([
                    (1.0, &held),
                    (kept * speed, &impulse_row),
                    (kept * impulse, &normal_velocity),
                    (-0.5 * impulse * speed, &gain_row),
                ]);
            }
            Some(held)
        }
    };
    StrikeDerivative { x_dot, y_dot, theta_dot, energy: held }
}

/// The derivative of a strike with friction, of which no energy is held.
#[inline(always)]
pub(crate) fn of_strike_with_friction(friction: &Friction, rod: &Rod<Dual<WIDTH>>, before: &State) -> StrikeDerivative {
    let State { x_dot, y_dot, theta_dot, .. } = friction.strike_by_tilt_gain(rod, &along_states(before)).after;
    StrikeDerivative { x_dot: x_dot.partials, y_dot: y_dot.partials, theta_dot: theta_dot.partials, energy: None }
}

/// A state of which each number moves along its own direction.
pub(crate) fn along_states(state: &State) -> State<Dual<WIDTH>> {
    let State { theta, x_dot, y_dot, theta_dot } = *state;
    State {
        theta: Dual::along(theta, THETA, 1.0),
        x_dot: Dual::along(x_dot, X_DOT, 1.0),
        y_dot: Dual::along(y_dot, Y_DOT, 1.0),
        theta_dot: Dual::along(theta_dot, THETA_DOT, 1.0),
    }
}

/// The derivative of a flight of given length, with the contact time implicit: ∂τ = −∂g/ẏ_c.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlightDerivative {
    /// Length, s.
    pub(crate) t: f64,
    /// State at the end.
    pub(crate) end: State,
    /// sin θ, cos θ there.
    pub(crate) sin_cos_theta: (f64, f64),
    /// ẏ_c there, m/s.
    pub(crate) contact_speed: f64,
    /// G, m/s².
    pub(crate) gravity: f64,
    /// ∂τ by θ, ẏ and θ̇ at the start.
    pub(crate) by_theta: f64,
    pub(crate) by_y_dot: f64,
    pub(crate) by_theta_dot: f64,
    /// Error of G, and of τ by it.
    pub(crate) heavier: f64,
    pub(crate) of_gravity: f64,
}

impl FlightDerivative {
    #[inline(always)]
    pub(crate) fn new(flight: &Flight, t: f64, gravity_error: f64) -> Self {
        let end = flight.end(t);
        let (sin, cos) = crate::numbers::trig::sin_cos(end.theta);
        let l = flight.contact_distance;
        let contact_speed = end.y_dot + l * end.theta_dot * sin;
        let per_speed = 1.0 / contact_speed;
        Self {
            t,
            end,
            sin_cos_theta: (sin, cos),
            contact_speed,
            gravity: flight.gravity,
            by_theta: l * (flight.sin_cos_theta.0 - sin) * per_speed,
            by_y_dot: -t * per_speed,
            by_theta_dot: -l * sin * t * per_speed,
            heavier: gravity_error,
            of_gravity: 0.5 * t * t * gravity_error * per_speed,
        }
    }
}
