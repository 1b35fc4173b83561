//! Exact derivative of a bounce: of angle, velocities and held energy by angle and velocities before it, and by the parameters that are
//! rounded. The held energy is one of the parameters, since most strikes leave it as it is.
//!
//! Not here: the errors that it carries along ([`crate::run::error_estimate`]). In closed form for a contact without friction, by dual
//! numbers with it; the tests of [`crate::run::state_errors`] hold the two together.

use crate::bounce::flight::Flight;
use crate::bounce::friction::Friction;
use crate::bounce::strike::{EnergyFeedback, MeasuredBounce, Rod, State, Strike};
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;

/// θ, ẋ, ẏ and θ̇.
pub(crate) const STATES: usize = 4;
/// Gravity, radius of gyration, strike gain and the held energy.
pub(crate) const PARAMETERS: usize = 4;
/// Numbers of a row: the states, then the parameters.
pub(crate) const WIDTH: usize = STATES + PARAMETERS;

/// Indices in a row.
pub(crate) const THETA: usize = 0;
pub(crate) const X_DOT: usize = 1;
pub(crate) const Y_DOT: usize = 2;
pub(crate) const THETA_DOT: usize = 3;
pub(crate) const OF_GRAVITY: usize = STATES;
pub(crate) const OF_GYRATION: usize = STATES + 1;
pub(crate) const OF_GAIN: usize = STATES + 2;
pub(crate) const OF_ENERGY: usize = STATES + 3;

/// Derivatives of one number by the states, and by each parameter times its error.
pub(crate) type Row = [f64; WIDTH];

/// A row plus another with a factor.
#[inline(always)]
fn plus(row: &Row, factor: f64, other: &Row) -> Row {
    std::array::from_fn(|index| row[index] + factor * other[index])
}

/// A rod whose parameters are off by rounding, with what of it does not change from strike to strike.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UncertainRod {
    /// Parameters, with one standard deviation of each in its direction.
    pub(crate) lifted: Rod<Dual<WIDTH>>,
    /// The parameters alone.
    pub(crate) plain: Rod,
    /// 1/ρ², 1/m².
    pub(crate) leverage: f64,
    /// δρ/ρ.
    stretched: f64,
    /// True where the strike gain does not depend on the energy.
    pub(crate) is_steady: bool,
    /// True where strikes leave the energy exactly.
    keeps_energy: bool,
}

impl UncertainRod {
    pub(crate) fn new(lifted: Rod<Dual<WIDTH>>) -> Self {
        let plain: Rod = lifted.map(|number| number.value);
        let rho = lifted.radius_of_gyration;
        let is_steady = plain.strike_gain_per_energy == 0.0 && plain.energy_feedback != EnergyFeedback::OneStrike;
        let keeps_energy = is_steady && plain.strike_gain == 2.0 && lifted.strike_gain.partials[OF_GAIN] == 0.0;
        let stretched = rho.partials[OF_GYRATION] / rho.value;
        Self { lifted, plain, leverage: plain.leverage(), stretched, is_steady, keeps_energy }
    }

    /// δG, m/s².
    #[inline(always)]
    pub(crate) fn heavier(&self) -> f64 {
        self.lifted.gravity.partials[OF_GRAVITY]
    }

    /// Takes another target energy.
    #[inline(always)]
    pub(crate) fn set_target_energy(&mut self, energy: Dual<WIDTH>) {
        (self.lifted.target_energy, self.plain.target_energy) = (energy, energy.value);
    }
}

/// Derivative of a strike, which leaves the angle as it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrikeDerivative {
    pub(crate) x_dot: Row,
    pub(crate) y_dot: Row,
    pub(crate) theta_dot: Row,
    /// Energy held from the strike on; `None` if the strike leaves it.
    pub(crate) energy: Option<Row>,
}

/// Sines and cosines of a strike, of the table's tilt α and of the angle β = θ − α, and what follows from them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrikeAngles {
    pub(crate) sin_alpha: f64,
    pub(crate) cos_alpha: f64,
    pub(crate) cos_beta: f64,
    /// l sin β, m, and the same over ρ², 1/m.
    pub(crate) arm: f64,
    pub(crate) turn: f64,
    /// 1/B.
    pub(crate) per_mobility: f64,
    /// 1/|v|² before the strike, s²/m².
    pub(crate) per_square: f64,
}

impl StrikeAngles {
    #[inline(always)]
    pub(crate) fn new(rod: &UncertainRod, strike: &Strike) -> Self {
        Self::at(rod, strike, crate::numbers::trig::sin_cos(strike.alpha))
    }

    /// [`StrikeAngles::new`] with sine and cosine of the tilt.
    #[inline(always)]
    pub(crate) fn at(rod: &UncertainRod, strike: &Strike, (sin_alpha, cos_alpha): (f64, f64)) -> Self {
        let (sin_theta, cos_theta) = strike.sin_cos_theta;
        // Sums of angles: what they lose is a rounding of 1, and a derivative needs no more.
        let sin_beta = sin_theta * cos_alpha - cos_theta * sin_alpha;
        let cos_beta = cos_theta * cos_alpha + sin_theta * sin_alpha;
        let arm = rod.plain.contact_distance * sin_beta;
        let turn = arm * rod.leverage;
        let (per_mobility, per_square) = (1.0 / (1.0 + arm * turn), 1.0 / strike.speed_squared);
        Self { sin_alpha, cos_alpha, cos_beta, arm, turn, per_mobility, per_square }
    }
}

/// The energy that a run holds: before its first contact, which sets it, `None`; then its error by each parameter.
pub(crate) type HeldEnergy = Option<[f64; PARAMETERS]>;

/// The derivative of a strike of a rod without friction on a table that tilts by κθ, eq. (24) with (27) and (28). `held` is `None` in runs
/// that hold no energy.
#[inline(always)]
pub(crate) fn of_strike(
    rod: &UncertainRod,
    before: &State,
    strike: &Strike,
    angles: &StrikeAngles,
    held: Option<HeldEnergy>,
) -> StrikeDerivative {
    let State { theta_dot, x_dot, y_dot, .. } = *before;
    let StrikeAngles { sin_alpha, cos_alpha, cos_beta, arm, turn, per_mobility, per_square, .. } = *angles;
    let (sin_theta, cos_theta) = strike.sin_cos_theta;
    let Rod { contact_distance: l, radius_of_gyration: rho, tilt_gain: kappa, gravity, .. } = rod.plain;
    let (stretched, heavier) = (rod.stretched, rod.heavier());
    let arm_rate = l * cos_beta * (1.0 - kappa);
    let (impulse, speed) = (strike.impulse_normal, strike.normal_velocity);

    let (mobility_by_theta, mobility_of_gyration) = (2.0 * turn * arm_rate, -2.0 * arm * turn * stretched);
    let speed_by_theta = arm_rate * theta_dot - kappa * (sin_alpha * y_dot + cos_alpha * x_dot);
    let spin = rho * theta_dot;
    let weight = gravity * l;
    let energy = [
        -weight * sin_theta,
        x_dot,
        y_dot,
        rho * spin,
        -l * (1.0 - cos_theta) * heavier,
        spin * spin * stretched,
        0.0,
        0.0,
    ];
    let (gain, gain_row) = if rod.is_steady {
        (rod.plain.strike_gain, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, rod.lifted.strike_gain.partials[OF_GAIN], 0.0])
    } else {
        of_gain(rod, strike, *angles, energy, [speed_by_theta, mobility_by_theta, mobility_of_gyration])
    };
    // P = −γ v_nc / B.
    let (by_speed, by_gain, by_mobility) = (-gain * per_mobility, -speed * per_mobility, -impulse * per_mobility);
    let mut impulse_row = [
        by_speed * speed_by_theta + by_mobility * mobility_by_theta,
        -by_speed * sin_alpha,
        by_speed * cos_alpha,
        by_speed * arm,
        0.0,
        by_mobility * mobility_of_gyration,
        by_gain * gain_row[OF_GAIN],
        0.0,
    ];
    if !rod.is_steady {
        impulse_row[OF_GAIN] = 0.0;
        impulse_row = plus(&impulse_row, by_gain, &gain_row);
    }
    // The velocities are stretched onto the held energy: not at the first contact, whose energy it is.
    let after = strike.after;
    let missing = match held {
        Some(Some([of_gravity, of_gyration, of_gain, of_energy])) => [
            -energy[THETA] * per_square,
            -energy[X_DOT] * per_square,
            -energy[Y_DOT] * per_square,
            -energy[THETA_DOT] * per_square,
            (of_gravity - energy[OF_GRAVITY]) * per_square,
            (of_gyration - energy[OF_GYRATION]) * per_square,
            of_gain * per_square,
            of_energy * per_square,
        ],
        Some(None) | None => [0.0; WIDTH],
    };
    let along = |by_stretch: f64, by_impulse: f64| -> Row {
        std::array::from_fn(|index| by_stretch * missing[index] + by_impulse * impulse_row[index])
    };
    let mut x_dot = along(after.x_dot, -sin_alpha);
    let mut y_dot = along(after.y_dot, cos_alpha);
    let mut theta_dot = along(after.theta_dot, turn);
    // α and β turn with θ.
    let turned = impulse * kappa;
    x_dot[THETA] -= turned * cos_alpha;
    y_dot[THETA] -= turned * sin_alpha;
    theta_dot[THETA] += impulse * arm_rate * rod.leverage;
    theta_dot[OF_GYRATION] -= 2.0 * impulse * turn * stretched;
    x_dot[X_DOT] += 1.0;
    y_dot[Y_DOT] += 1.0;
    theta_dot[THETA_DOT] += 1.0;
    let energy = match held {
        None => None,
        Some(Some(_)) if rod.keeps_energy => None,
        Some(held) => {
            let from = held.map_or(energy, |[of_gravity, of_gyration, of_gain, of_energy]| {
                [0.0, 0.0, 0.0, 0.0, of_gravity, of_gyration, of_gain, of_energy]
            });
            // ½(2 − γ) P v_nc.
            let kept = 0.5 * (2.0 - gain);
            let normal_velocity = [speed_by_theta, -sin_alpha, cos_alpha, arm, 0.0, 0.0, 0.0, 0.0];
            let with_impulse = plus(&from, kept * speed, &impulse_row);
            let with_speed = plus(&with_impulse, kept * impulse, &normal_velocity);
            Some(plus(&with_speed, -0.5 * impulse * speed, &gain_row))
        }
    };
    StrikeDerivative { x_dot, y_dot, theta_dot, energy }
}

/// The strike gain and its derivative, where it depends on the energy. `energy` is the derivative of ½|v|² + G l (cos θ − 1); the other three
/// are those of the normal velocity and of the mobility by θ, and of the mobility by ρ.
#[inline(never)]
fn of_gain(
    rod: &UncertainRod,
    strike: &Strike,
    angles: StrikeAngles,
    energy: Row,
    [speed_by_theta, mobility_by_theta, mobility_of_gyration]: [f64; 3],
) -> (f64, Row) {
    let StrikeAngles { sin_alpha, cos_alpha, arm, turn, .. } = angles;
    let (sin_theta, cos_theta) = strike.sin_cos_theta;
    let l = rod.plain.contact_distance;
    let weight = rod.plain.gravity * l;
    // By the five numbers that it is measured by, and by the parameters, all in one dual number.
    let along = |value, direction| Dual::along(value, direction, 1.0);
    let measured = rod.lifted.map(|number| {
        let [.., of_gravity, of_gyration, of_gain, _] = number.partials;
        Dual { value: number.value, partials: [0.0, 0.0, 0.0, 0.0, 0.0, of_gravity, of_gyration, of_gain] }
    });
    let y_dot = energy[Y_DOT];
    let gain = measured.gain(&MeasuredBounce {
        potential: along(weight * cos_theta, 0),
        y_dot: along(y_dot, 1),
        speed_squared: along(strike.speed_squared, 2),
        normal_velocity: along(strike.normal_velocity, 3),
        mobility: along(1.0 + arm * turn, 4),
    });
    let [by_potential, by_y_dot, by_square, by_speed, by_mobility, of_gravity, of_gyration, of_gain] = gain.partials;
    // |v|² twice as its half.
    let row = [
        by_speed * speed_by_theta + by_mobility * mobility_by_theta - by_potential * weight * sin_theta,
        2.0 * by_square * energy[X_DOT] - by_speed * sin_alpha,
        2.0 * by_square * y_dot + by_speed * cos_alpha + by_y_dot,
        2.0 * by_square * energy[THETA_DOT] + by_speed * arm,
        of_gravity + by_potential * l * cos_theta * rod.heavier(),
        of_gyration + 2.0 * by_square * energy[OF_GYRATION] + by_mobility * mobility_of_gyration,
        of_gain,
        0.0,
    ];
    (gain.value, row)
}

/// The derivative of a strike with friction, of which no energy is held.
#[inline(always)]
pub(crate) fn of_strike_with_friction(friction: &Friction, rod: &Rod<Dual<WIDTH>>, before: &State) -> StrikeDerivative {
    let State { x_dot, y_dot, theta_dot, .. } =
        friction.map(Dual::from_f64).strike_by_tilt_gain(rod, &along_states::<WIDTH>(before, THETA)).after;
    StrikeDerivative { x_dot: x_dot.partials, y_dot: y_dot.partials, theta_dot: theta_dot.partials, energy: None }
}

/// A state of which each number moves along its own direction, θ along number `first`.
pub(crate) fn along_states<const N: usize>(state: &State, first: usize) -> State<Dual<N>> {
    let State { theta, x_dot, y_dot, theta_dot } = *state;
    State {
        theta: Dual::along(theta, first + THETA, 1.0),
        x_dot: Dual::along(x_dot, first + X_DOT, 1.0),
        y_dot: Dual::along(y_dot, first + Y_DOT, 1.0),
        theta_dot: Dual::along(theta_dot, first + THETA_DOT, 1.0),
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
    pub(crate) per_speed: f64,
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
    pub(crate) fn new(flight: &Flight, t: f64, (sin, cos): (f64, f64), gravity_error: f64) -> Self {
        let end = flight.end(t);
        let l = flight.contact_distance;
        let contact_speed = end.y_dot + l * end.theta_dot * sin;
        let per_speed = 1.0 / contact_speed;
        Self {
            t,
            end,
            sin_cos_theta: (sin, cos),
            contact_speed,
            per_speed,
            gravity: flight.gravity,
            by_theta: l * (flight.sin_cos_theta.0 - sin) * per_speed,
            by_y_dot: -t * per_speed,
            by_theta_dot: -l * sin * t * per_speed,
            heavier: gravity_error,
            of_gravity: 0.5 * t * t * gravity_error * per_speed,
        }
    }
}
