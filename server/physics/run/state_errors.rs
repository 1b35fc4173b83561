//! Errors of the numbers that a run carries from bounce to bounce: a covariance, and what each rounded parameter adds.
//!
//! Not here: which errors a bounce makes ([`crate::run::error_estimate`]). A strike changes three velocities and a flight two numbers, so
//! these steps cost much less than products of whole matrices.

use crate::run::bounce_derivative::{
    ENERGY, FlightDerivative, OF_GRAVITY, Row, STATES, StrikeDerivative, THETA, THETA_DOT, WIDTH, X_DOT, Y_DOT, sum,
};

/// Standard deviations and errors in common of θ, ẋ, ẏ, θ̇ and the held energy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StateErrors {
    /// Covariance of the independent errors, a row for each state; then the error by each parameter, which is off by the same at every
    /// bounce.
    rows: [Row; STATES],
}

/// The variance of a number: that of its independent errors, which rounding may leave below 0, and that by each parameter.
#[inline(always)]
fn total(independent: f64, errors: &Row) -> f64 {
    let of_parameters: f64 = errors[STATES..].iter().map(|error| error * error).sum();
    if independent < 0.0 { of_parameters } else { independent + of_parameters }
}

/// J Σ Jᵀ of two numbers, from J Σ of one and J of the other.
#[inline(always)]
fn covariance(errors: &Row, derivative: &Row) -> f64 {
    let [a, b, c, d, e, ..] = *errors;
    let [p, q, r, s, t, ..] = *derivative;
    ((a * p + b * q) + (c * r + d * s)) + e * t
}

impl StateErrors {
    /// No errors.
    pub(crate) const NONE: Self = Self { rows: [[0.0; WIDTH]; STATES] };

    /// Variance of a state.
    #[inline(always)]
    pub(crate) fn variance(&self, state: usize) -> f64 {
        total(self.rows[state][state], &self.rows[state])
    }

    /// Standard deviation of a sum of three states, each with a factor.
    #[inline(always)]
    pub(crate) fn deviation_of_sum(&self, [(a, one), (b, other), (c, third)]: [(f64, usize); 3]) -> f64 {
        let row = sum([(a, &self.rows[one]), (b, &self.rows[other]), (c, &self.rows[third])]);
        total(a * row[one] + b * row[other] + c * row[third], &row).sqrt()
    }

    /// Adds an independent error of one state, of so much variance.
    #[inline(always)]
    pub(crate) fn add(&mut self, state: usize, variance: f64) {
        self.rows[state][state] += variance;
    }

    /// Adds an error of three states at once, one standard deviation of each.
    #[inline(always)]
    pub(crate) fn add_along(&mut self, states: [usize; 3], direction: [f64; 3]) {
        for (row, one) in states.into_iter().zip(direction) {
            for (column, other) in states.into_iter().zip(direction) {
                self.rows[row][column] += one * other;
            }
        }
    }

    /// The change of a number with the errors: its covariance with the states before, and its errors by the parameters.
    #[inline(always)]
    fn carry(&self, derivative: &Row) -> Row {
        let [theta, x_dot, y_dot, theta_dot, energy, of_parameters @ ..] = *derivative;
        let mut carried = sum([
            (theta, &self.rows[THETA]),
            (x_dot, &self.rows[X_DOT]),
            (y_dot, &self.rows[Y_DOT]),
            (theta_dot, &self.rows[THETA_DOT]),
            (energy, &self.rows[ENERGY]),
        ]);
        for (error, own) in carried[STATES..].iter_mut().zip(of_parameters) {
            *error += own;
        }
        carried
    }

    /// Takes the covariances of a state with the others from its own row.
    #[inline(always)]
    fn mirror(&mut self, state: usize) {
        for other in 0..STATES {
            self.rows[other][state] = self.rows[state][other];
        }
    }

    /// The errors just after a strike, but for those that it makes.
    #[inline(always)]
    pub(crate) fn after_strike(&self, strike: &StrikeDerivative) -> Self {
        let StrikeDerivative { x_dot, y_dot, theta_dot, energy } = strike;
        let mut rows = self.rows;
        rows[X_DOT] = self.carry(x_dot);
        rows[Y_DOT] = self.carry(y_dot);
        rows[THETA_DOT] = self.carry(theta_dot);
        if let Some(energy) = energy {
            rows[ENERGY] = self.carry(energy);
            let with = [X_DOT, Y_DOT, THETA_DOT, ENERGY].map(|state| covariance(&rows[state], energy));
            [rows[ENERGY][X_DOT], rows[ENERGY][Y_DOT], rows[ENERGY][THETA_DOT], rows[ENERGY][ENERGY]] = with;
        } else {
            for state in [X_DOT, Y_DOT, THETA_DOT] {
                rows[ENERGY][state] = rows[state][ENERGY];
            }
        }
        let carried = [rows[X_DOT], rows[Y_DOT], rows[THETA_DOT]];
        rows[X_DOT][X_DOT] = covariance(&carried[0], x_dot);
        rows[X_DOT][Y_DOT] = covariance(&carried[0], y_dot);
        rows[X_DOT][THETA_DOT] = covariance(&carried[0], theta_dot);
        rows[Y_DOT][Y_DOT] = covariance(&carried[1], y_dot);
        rows[Y_DOT][THETA_DOT] = covariance(&carried[1], theta_dot);
        rows[THETA_DOT][THETA_DOT] = covariance(&carried[2], theta_dot);
        rows[Y_DOT][X_DOT] = rows[X_DOT][Y_DOT];
        rows[THETA_DOT][X_DOT] = rows[X_DOT][THETA_DOT];
        rows[THETA_DOT][Y_DOT] = rows[Y_DOT][THETA_DOT];
        for state in [X_DOT, Y_DOT, THETA_DOT] {
            rows[THETA][state] = rows[state][THETA];
            rows[state][ENERGY] = rows[ENERGY][state];
        }
        rows[THETA][ENERGY] = rows[ENERGY][THETA];
        Self { rows }
    }

    /// The errors at the end of a flight, but for those that it makes, and the standard deviation of its length, s.
    #[inline(always)]
    pub(crate) fn after_flight(&self, flight: &FlightDerivative) -> (Self, f64) {
        let FlightDerivative { t, by_theta, by_y_dot, by_theta_dot, .. } = *flight;
        let Self { mut rows } = *self;
        let mut time = sum([(by_theta, &rows[THETA]), (by_y_dot, &rows[Y_DOT]), (by_theta_dot, &rows[THETA_DOT])]);
        time[OF_GRAVITY] += flight.of_gravity;
        let time_variance = by_theta * time[THETA] + by_y_dot * time[Y_DOT] + by_theta_dot * time[THETA_DOT];
        // θ' = θ + tθ̇ + θ̇τ and ẏ' = ẏ − tG − Gτ, with all but themselves, with τ, and with each other.
        let (turning, falling) = (flight.end.theta_dot, -flight.gravity);
        rows[THETA] = sum([(1.0, &rows[THETA]), (t, &rows[THETA_DOT]), (turning, &time)]);
        rows[Y_DOT] = sum([(1.0, &rows[Y_DOT]), (falling, &time)]);
        rows[Y_DOT][OF_GRAVITY] -= t * flight.heavier;
        let theta_time = time[THETA] + t * time[THETA_DOT] + turning * time_variance;
        let y_dot_time = time[Y_DOT] + falling * time_variance;
        rows[THETA][THETA] += t * rows[THETA][THETA_DOT] + turning * theta_time;
        rows[THETA][Y_DOT] += falling * theta_time;
        rows[Y_DOT][Y_DOT] += falling * y_dot_time;
        let mut end = Self { rows };
        end.mirror(THETA);
        end.mirror(Y_DOT);
        (end, total(time_variance, &time).sqrt())
    }

    /// Sets the angle to that of the velocity, as that of a point mass is.
    #[inline(always)]
    pub(crate) fn set_angle_of_velocity(&mut self, x_dot: f64, y_dot: f64) {
        let per_square = 1.0 / (x_dot * x_dot + y_dot * y_dot);
        let (by_x_dot, by_y_dot) = (-y_dot * per_square, x_dot * per_square);
        let mut row = sum([(by_x_dot, &self.rows[X_DOT]), (by_y_dot, &self.rows[Y_DOT])]);
        row[THETA] = by_x_dot * row[X_DOT] + by_y_dot * row[Y_DOT];
        self.rows[THETA] = row;
        self.mirror(THETA);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounce::contact_time::first_contact;
    use crate::bounce::energy_feedback::EnergyFeedback;
    use crate::bounce::flight::Flight;
    use crate::bounce::friction::{Friction, RestitutionLaw, Slide};
    use crate::bounce::rod::Rod;
    use crate::bounce::state::State;
    use crate::numbers::dual::Dual;
    use crate::run::bounce_derivative::{
        OF_GAIN, OF_GYRATION, StrikeAngles, along_states, of_strike, of_strike_with_friction,
    };

    type Number = Dual<WIDTH>;

    /// A rod with errors of its parameters that are not small.
    fn rod(law: EnergyFeedback, per_energy: f64, strike_gain: f64) -> Rod<Number> {
        let plain = Rod { gravity: 8.0, strike_gain, ..Rod::lossless(0.13, 0.1, 1.3) };
        let mut rod: Rod<Number> = plain.lift();
        rod.energy_feedback = law;
        rod.strike_gain_per_energy.value = per_energy;
        rod.target_energy.value = 2.0;
        rod.gravity.partials[OF_GRAVITY] = 0.3;
        rod.radius_of_gyration.partials[OF_GYRATION] = 0.02;
        rod.strike_gain.partials[OF_GAIN] = 0.1;
        rod.target_energy.partials[OF_GAIN] = 0.2;
        rod.target_energy.partials[OF_GRAVITY] = 0.05;
        rod
    }

    const STATES_BEFORE: [State; 3] = [
        State { theta: 0.2, x_dot: 0.3, y_dot: -1.1, theta_dot: -0.7 },
        State { theta: -0.4, x_dot: -0.1, y_dot: -1.6, theta_dot: 1.9 },
        State { theta: 0.01, x_dot: 0.2, y_dot: -0.9, theta_dot: 0.4 },
    ];

    /// A covariance and errors by parameters without symmetry of any kind but its own.
    fn start() -> StateErrors {
        let factor: [[f64; STATES]; STATES] =
            std::array::from_fn(|row| std::array::from_fn(|column| ((3 * row + 5 * column + 1) % 7) as f64 - 2.5));
        let product = |one: &[f64; STATES], other: &[f64; STATES]| -> f64 {
            one.iter().zip(other).map(|(one, other)| one * other).sum()
        };
        let rows = std::array::from_fn(|row| {
            let [a, b, c, d, e] = std::array::from_fn(|column| product(&factor[row], &factor[column]));
            [a, b, c, d, e, 0.5 * row as f64, -1.0, 0.25 - row as f64]
        });
        StateErrors { rows }
    }

    /// J Σ Jᵀ and J X + J_p, from the rows of J.
    fn carried_by_duals(errors: &StateErrors, derivative: &[Row; STATES]) -> [Row; STATES] {
        let combine = |one: &Row, index: usize| -> f64 {
            one.iter().zip(&errors.rows).map(|(factor, errors)| factor * errors[index]).sum()
        };
        std::array::from_fn(|row| {
            let one = &derivative[row];
            std::array::from_fn(|column| match derivative.get(column) {
                Some(other) => (0..STATES).map(|state| combine(one, state) * other[state]).sum(),
                None => combine(one, column) + one[column],
            })
        })
    }

    fn assert_alike(ours: &StateErrors, theirs: &[Row; STATES], case: &str) {
        let size = theirs.iter().flatten().fold(0.0_f64, |size, number| size.max(number.abs()));
        for (ours, theirs) in ours.rows.iter().flatten().zip(theirs.iter().flatten()) {
            assert!((ours - theirs).abs() <= 1e-12 * size, "{case}: {ours} and {theirs}");
        }
    }

    /// Errors over a bounce in closed form, and the derivative of the same bounce by dual numbers.
    fn compare(rod: &Rod<Number>, friction: Option<Friction>, holds: Option<bool>, before: &State, case: &str) {
        let plain: Rod = rod.map(|number| number.value);
        let dual = along_states(before);
        let (strike, mut lifted) = match friction {
            None => (plain.strike(before), rod.strike(&dual)),
            Some(friction) => (friction.strike_by_tilt_gain(&plain, before), friction.strike_by_tilt_gain(rod, &dual)),
        };
        let energy = match holds {
            None => Number { value: 0.0, partials: [0.0; WIDTH] },
            Some(is_first) => {
                let held = if is_first { lifted.energy } else { Dual::along(strike.energy, ENERGY, 1.0) };
                rod.hold_energy(&mut lifted, held)
            }
        };
        let flight: Flight = plain.flight(&strike);
        let t = first_contact(&flight).unwrap();
        let lifted_flight = rod.flight(&lifted);
        let time = lifted_flight.lift_root(t);
        let end = lifted_flight.end(time);
        let derivative = [end.theta, end.x_dot, end.y_dot, end.theta_dot, energy].map(|number| number.partials);

        let ours = match friction {
            None => of_strike(rod, before, &strike, &StrikeAngles::new(&strike), holds),
            Some(friction) => of_strike_with_friction(&friction, rod, before),
        };
        let mut errors = start();
        if holds.is_none() {
            // Without a held energy there are no errors of it.
            for row in &mut errors.rows {
                row[ENERGY] = 0.0;
            }
            errors.rows[ENERGY] = [0.0; WIDTH];
        }
        let over = FlightDerivative::new(&flight, t, rod.gravity.partials[OF_GRAVITY]);
        let (after, time_deviation) = errors.after_strike(&ours).after_flight(&over);
        assert_alike(&after, &carried_by_duals(&errors, &derivative), case);
        let mut of_time = [[0.0; WIDTH]; STATES];
        of_time[0] = time.partials;
        let carried = carried_by_duals(&errors, &of_time)[0];
        let expected = total(carried[0], &carried).sqrt();
        assert!((time_deviation - expected).abs() <= 1e-12 * expected, "{case}: {time_deviation} and {expected}");
        let speed = lifted_flight.gap(time).slope;
        let mut of_speed = [[0.0; WIDTH]; STATES];
        of_speed[0] = speed.partials;
        let carried = carried_by_duals(&errors, &of_speed)[0];
        let (sin, cos) = over.sin_cos_theta;
        let l = flight.contact_distance;
        let terms = [(l * over.end.theta_dot * cos, THETA), (1.0, Y_DOT), (l * sin, THETA_DOT)];
        let (ours, expected) = (after.deviation_of_sum(terms), total(carried[0], &carried).sqrt());
        assert!((ours - expected).abs() <= 1e-11 * expected, "{case}: {ours} and {expected}");
    }

    #[test]
    fn errors_are_carried_as_dual_numbers_carry_them() {
        let laws = [
            (EnergyFeedback::Vertical, 0.0, 2.0, true),
            (EnergyFeedback::Vertical, 0.0, 2.0, false),
            (EnergyFeedback::Vertical, 0.0, 1.8, false),
            (EnergyFeedback::Vertical, 0.3, 1.9, false),
            (EnergyFeedback::Total, 0.2, 2.0, false),
            (EnergyFeedback::OneStrike, 0.0, 2.0, false),
        ];
        for before in &STATES_BEFORE {
            for (law, per_energy, gain, exact) in laws {
                let mut rod = rod(law, per_energy, gain);
                if exact {
                    rod.strike_gain.partials[OF_GAIN] = 0.0;
                }
                for holds in [None, Some(true), Some(false)] {
                    let case = format!("{law:?} {per_energy} {gain} {exact}, {holds:?}, {before:?}");
                    compare(&rod, None, holds, before, &case);
                }
            }
        }
    }

    #[test]
    fn errors_are_carried_over_friction() {
        for before in &STATES_BEFORE {
            for slide in [Slide::Matched, Slide::None] {
                let friction = Friction { coefficient: 0.4, law: RestitutionLaw::Stronge, slide };
                compare(
                    &rod(EnergyFeedback::Vertical, 0.0, 2.0),
                    Some(friction),
                    None,
                    before,
                    &format!("{friction:?}"),
                );
            }
        }
    }

    #[test]
    fn the_angle_of_a_velocity_is_off_as_the_velocity_is() {
        let mut errors = start();
        let before = errors;
        let (x_dot, y_dot) = (0.3, -1.2);
        errors.set_angle_of_velocity(x_dot, y_dot);
        let per_square = 1.0 / (x_dot * x_dot + y_dot * y_dot);
        let mut derivative = [[0.0; WIDTH]; STATES];
        (derivative[THETA][X_DOT], derivative[THETA][Y_DOT]) = (-y_dot * per_square, x_dot * per_square);
        for (state, row) in derivative.iter_mut().enumerate().skip(X_DOT) {
            row[state] = 1.0;
        }
        assert_alike(&errors, &carried_by_duals(&before, &derivative), "angle of the velocity");
    }
}
