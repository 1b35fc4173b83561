//! Errors of the numbers that a run carries from bounce to bounce: a covariance, and what each rounded parameter adds.
//!
//! Not here: which errors a bounce makes ([`crate::run::error_estimate`]). A strike changes three velocities and a flight two numbers, and
//! the covariance is symmetric, so these steps cost much less than products of whole matrices.

use crate::numbers::symmetric::{Symmetric, product};
use crate::run::bounce_derivative::{
    FlightDerivative, OF_ENERGY, OF_GRAVITY, PARAMETERS, Row, STATES, StrikeDerivative, THETA, THETA_DOT, X_DOT, Y_DOT,
};

/// A number for each state.
pub(crate) type OfStates = [f64; STATES];

/// A number for each parameter.
pub(crate) type OfParameters = [f64; PARAMETERS];

/// Standard deviations and errors in common of θ, ẋ, ẏ and θ̇.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StateErrors {
    /// Covariance of the independent errors.
    covariance: Symmetric,
    /// Error of each state by each parameter, which is off by the same at every bounce.
    of_parameters: [OfParameters; STATES],
}

/// The variance of a number: that of its independent errors, which rounding may leave below 0, and that by each parameter.
#[inline(always)]
fn total(independent: f64, [a, b, c, d]: &OfParameters) -> f64 {
    let of_parameters = (a * a + b * b) + (c * c + d * d);
    if independent < 0.0 { of_parameters } else { independent + of_parameters }
}

/// The part of a row by the states, and that by the parameters.
#[inline(always)]
fn split([a, b, c, d, e, f, g, h]: &Row) -> (OfStates, OfParameters) {
    ([*a, *b, *c, *d], [*e, *f, *g, *h])
}

/// The error by each parameter of a number with these derivatives by the states, and its own.
#[inline(always)]
fn carry(errors: &[OfParameters; STATES], [a, b, c, d]: &OfStates, own: &OfParameters) -> OfParameters {
    let [theta, x_dot, y_dot, theta_dot] = errors;
    std::array::from_fn(|parameter| {
        ((a * theta[parameter] + b * x_dot[parameter]) + (c * y_dot[parameter] + d * theta_dot[parameter]))
            + own[parameter]
    })
}

impl StateErrors {
    /// No errors.
    pub(crate) const NONE: Self = Self { covariance: Symmetric::ZERO, of_parameters: [[0.0; PARAMETERS]; STATES] };

    /// Variance of each state.
    #[inline(always)]
    pub(crate) fn variances(&self) -> OfStates {
        let Symmetric { first: [theta, ..], second: [x_dot, ..], third: [y_dot, _], fourth: theta_dot } =
            self.covariance;
        let [of_theta, of_x_dot, of_y_dot, of_theta_dot] = &self.of_parameters;
        [total(theta, of_theta), total(x_dot, of_x_dot), total(y_dot, of_y_dot), total(theta_dot, of_theta_dot)]
    }

    /// Variance of aθ + ẏ + bθ̇.
    #[inline(always)]
    pub(crate) fn variance_of_sum(&self, a: f64, b: f64) -> f64 {
        let Symmetric { first: [tt, _, ty, tw], third: [yy, yw], fourth: ww, .. } = self.covariance;
        let [theta, _, y_dot, theta_dot] = &self.of_parameters;
        let of_parameters = std::array::from_fn(|index| a * theta[index] + y_dot[index] + b * theta_dot[index]);
        total(a * (a * tt + 2.0 * (ty + b * tw)) + yy + b * (2.0 * yw + b * ww), &of_parameters)
    }

    /// Adds an independent error of each state, of so much variance.
    #[inline(always)]
    pub(crate) fn add(&mut self, [theta, x_dot, y_dot, theta_dot]: OfStates) {
        let covariance = &mut self.covariance;
        covariance.first[0] += theta;
        covariance.second[0] += x_dot;
        covariance.third[0] += y_dot;
        covariance.fourth += theta_dot;
    }

    /// Adds an error of ẋ, ẏ and θ̇ at once, one standard deviation of each.
    #[inline(always)]
    pub(crate) fn add_along(&mut self, [x, y, w]: [f64; 3]) {
        let Symmetric { second: [xx, xy, xw], third: [yy, yw], fourth: ww, .. } = &mut self.covariance;
        *xx += x * x;
        *xy += x * y;
        *xw += x * w;
        *yy += y * y;
        *yw += y * w;
        *ww += w * w;
    }

    /// The same of θ and ẏ.
    #[inline(always)]
    pub(crate) fn add_along_flight(&mut self, theta: f64, y: f64) {
        let Symmetric { first: [tt, _, ty, _], third: [yy, _], .. } = &mut self.covariance;
        *tt += theta * theta;
        *ty += theta * y;
        *yy += y * y;
    }

    /// The errors just after a strike, but for those that it makes.
    #[inline(always)]
    pub(crate) fn after_strike(&self, strike: &StrikeDerivative) -> Self {
        let [(by_x, own_x), (by_y, own_y), (by_w, own_w)] =
            [split(&strike.x_dot), split(&strike.y_dot), split(&strike.theta_dot)];
        let [x, y, w] = [&by_x, &by_y, &by_w].map(|derivative| self.covariance.times(derivative));
        let covariance = Symmetric {
            first: [self.covariance.first[0], x[THETA], y[THETA], w[THETA]],
            second: [product(&by_x, &x), product(&by_y, &x), product(&by_w, &x)],
            third: [product(&by_y, &y), product(&by_w, &y)],
            fourth: product(&by_w, &w),
        };
        let before = &self.of_parameters;
        let of_parameters =
            [before[THETA], carry(before, &by_x, &own_x), carry(before, &by_y, &own_y), carry(before, &by_w, &own_w)];
        Self { covariance, of_parameters }
    }

    /// Holds another energy from a strike on, whose derivative by what was `before` the strike is `energy`, with an independent error of so
    /// much variance. These errors are those after the strike. Gives the error of the energy by each parameter.
    ///
    /// The energy is a parameter of its own: of each state the part that goes with it, c/σ for a covariance c and a standard deviation σ of the
    /// energy, is set apart from the others.
    #[inline(never)]
    pub(crate) fn hold(
        mut self,
        before: Self,
        strike: StrikeDerivative,
        energy: Row,
        variance: f64,
    ) -> (Self, OfParameters) {
        let (by_states, own) = split(&energy);
        let mut of_energy = carry(&before.of_parameters, &by_states, &own);
        let old = of_energy[OF_ENERGY - STATES];
        let with = before.covariance.times(&by_states);
        let square = product(&with, &by_states).max(0.0) + old * old + variance;
        let per_square = if square > 0.0 { 1.0 / square } else { 0.0 };
        let [x, y, w] =
            [&strike.x_dot, &strike.y_dot, &strike.theta_dot].map(|derivative| product(&split(derivative).0, &with));
        let carried = [with[THETA], x, y, w];
        let last = self.of_parameters.map(|errors| errors[OF_ENERGY - STATES]);
        let all: OfStates = std::array::from_fn(|state| carried[state] + old * last[state]);
        let change = |one: usize, other: usize| last[one] * last[other] - all[one] * all[other] * per_square;
        let Symmetric { first, second, third, fourth } = &mut self.covariance;
        for (other, sum) in first.iter_mut().enumerate() {
            *sum += change(THETA, other);
        }
        for (other, sum) in second.iter_mut().enumerate() {
            *sum += change(X_DOT, X_DOT + other);
        }
        for (other, sum) in third.iter_mut().enumerate() {
            *sum += change(Y_DOT, Y_DOT + other);
        }
        *fourth += change(THETA_DOT, THETA_DOT);
        for (errors, all) in self.of_parameters.iter_mut().zip(all) {
            errors[OF_ENERGY - STATES] = all * per_square.sqrt();
        }
        of_energy[OF_ENERGY - STATES] = square.sqrt();
        (self, of_energy)
    }

    /// The errors at the end of a flight, but for those that it makes, and the variance of its length, s².
    #[inline(always)]
    pub(crate) fn after_flight(&self, flight: &FlightDerivative) -> (Self, f64) {
        let FlightDerivative { t, by_theta, by_y_dot, by_theta_dot, .. } = *flight;
        let Symmetric { first: [tt, tx, ty, tw], second: [xx, xy, xw], third: [yy, yw], fourth: ww } = self.covariance;
        let by_time =
            |theta: f64, y_dot: f64, theta_dot: f64| by_theta * theta + by_y_dot * y_dot + by_theta_dot * theta_dot;
        // θ' = θ + tθ̇ + θ̇τ and ẏ' = ẏ − tG − Gτ: with the states before, and with τ.
        let (turning, falling) = (flight.end.theta_dot, -flight.gravity);
        let with_time = [by_time(tt, ty, tw), by_time(tx, xy, xw), by_time(ty, yy, yw), by_time(tw, yw, ww)];
        let time_variance = by_time(with_time[THETA], with_time[Y_DOT], with_time[THETA_DOT]);
        let theta = [
            tt + t * tw + turning * with_time[THETA],
            tx + t * xw + turning * with_time[X_DOT],
            ty + t * yw + turning * with_time[Y_DOT],
            tw + t * ww + turning * with_time[THETA_DOT],
        ];
        let theta_time = by_time(theta[THETA], theta[Y_DOT], theta[THETA_DOT]);
        let y_time = with_time[Y_DOT] + falling * time_variance;
        let covariance = Symmetric {
            first: [
                theta[THETA] + t * theta[THETA_DOT] + turning * theta_time,
                theta[X_DOT],
                theta[Y_DOT] + falling * theta_time,
                theta[THETA_DOT],
            ],
            second: [xx, xy + falling * with_time[X_DOT], xw],
            third: [yy + falling * (with_time[Y_DOT] + y_time), yw + falling * with_time[THETA_DOT]],
            fourth: ww,
        };
        let [of_theta, of_x_dot, of_y_dot, of_theta_dot] = self.of_parameters;
        let mut of_time: OfParameters =
            std::array::from_fn(|index| by_time(of_theta[index], of_y_dot[index], of_theta_dot[index]));
        of_time[OF_GRAVITY - STATES] += flight.of_gravity;
        let turned = std::array::from_fn(|index| of_theta[index] + t * of_theta_dot[index] + turning * of_time[index]);
        let mut fallen: OfParameters = std::array::from_fn(|index| of_y_dot[index] + falling * of_time[index]);
        fallen[OF_GRAVITY - STATES] -= t * flight.heavier;
        let of_parameters = [turned, of_x_dot, fallen, of_theta_dot];
        (Self { covariance, of_parameters }, total(time_variance, &of_time))
    }

    /// Sets the angle to that of the velocity, as that of a point mass is.
    #[inline(always)]
    pub(crate) fn set_angle_of_velocity(&mut self, x_dot: f64, y_dot: f64) {
        let per_square = 1.0 / (x_dot * x_dot + y_dot * y_dot);
        let (by_x_dot, by_y_dot) = (-y_dot * per_square, x_dot * per_square);
        let [_, x, y, w] = self.covariance.times(&[0.0, by_x_dot, by_y_dot, 0.0]);
        self.covariance.first = [by_x_dot * x + by_y_dot * y, x, y, w];
        let [_, of_x_dot, of_y_dot, _] = self.of_parameters;
        self.of_parameters[THETA] =
            std::array::from_fn(|index| by_x_dot * of_x_dot[index] + by_y_dot * of_y_dot[index]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounce::contact_time::first_contact;
    use crate::bounce::flight::Flight;
    use crate::bounce::friction::{Friction, RestitutionLaw, Slide};
    use crate::bounce::strike::{EnergyFeedback, Rod, State};
    use crate::numbers::dual::Dual;
    use crate::numbers::number::Arithmetic as _;
    use crate::numbers::trig::sin_cos;
    use crate::run::bounce_derivative::{
        HeldEnergy, OF_GAIN, OF_GYRATION, StrikeAngles, UncertainRod, WIDTH, along_states, of_strike,
        of_strike_with_friction,
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

    /// Errors of a held energy by each parameter.
    const HELD: OfParameters = [0.03, -0.02, 0.1, 0.4];

    /// A covariance and errors by parameters without symmetry of any kind but its own.
    fn start() -> StateErrors {
        let factor: [OfStates; STATES] =
            std::array::from_fn(|row| std::array::from_fn(|column| ((3 * row + 5 * column + 1) % 7) as f64 - 2.5));
        let with = |one: usize, other: usize| product(&factor[one], &factor[other]);
        let covariance = Symmetric {
            first: [with(0, 0), with(0, 1), with(0, 2), with(0, 3)],
            second: [with(1, 1), with(1, 2), with(1, 3)],
            third: [with(2, 2), with(2, 3)],
            fourth: with(3, 3),
        };
        let of_parameters =
            std::array::from_fn(|row| [0.5 * row as f64, -1.0, 0.25 - row as f64, 0.2 + 0.1 * row as f64]);
        StateErrors { covariance, of_parameters }
    }

    /// Covariance of some numbers with all their errors but those by gravity, gyration and gain; then those.
    type Joint<const N: usize> = [([f64; N], [f64; PARAMETERS - 1]); N];

    /// The joint errors of numbers with these derivatives by the states before and by the parameters.
    fn carried_by_duals<const N: usize>(errors: &StateErrors, derivatives: &[Row; N]) -> Joint<N> {
        let of_parameters = derivatives.map(|row| {
            let (by_states, own) = split(&row);
            carry(&errors.of_parameters, &by_states, &own)
        });
        std::array::from_fn(|one| {
            let with = errors.covariance.times(&split(&derivatives[one]).0);
            let [a, b, c, of_energy] = of_parameters[one];
            let covariance = std::array::from_fn(|other| {
                product(&with, &split(&derivatives[other]).0) + of_energy * of_parameters[other][3]
            });
            (covariance, [a, b, c])
        })
    }

    /// The joint errors of the states, and of a held energy.
    fn joint(errors: &StateErrors, held: OfParameters) -> Joint<5> {
        let rows = errors.covariance.rows();
        let of_parameters: [OfParameters; 5] =
            std::array::from_fn(|row| *errors.of_parameters.get(row).unwrap_or(&held));
        std::array::from_fn(|one| {
            let independent = |other: usize| if one.max(other) < STATES { rows[one][other] } else { 0.0 };
            let [a, b, c, of_energy] = of_parameters[one];
            let covariance = std::array::from_fn(|other| independent(other) + of_energy * of_parameters[other][3]);
            (covariance, [a, b, c])
        })
    }

    fn assert_alike(ours: &Joint<5>, theirs: &Joint<5>, case: &str) {
        let numbers =
            |errors: &Joint<5>| errors.map(|(covariance, own)| [covariance.to_vec(), own.to_vec()].concat()).concat();
        let size = numbers(theirs).into_iter().fold(0.0_f64, |size, number| size.max(number.abs()));
        for (ours, theirs) in numbers(ours).into_iter().zip(numbers(theirs)) {
            assert!((ours - theirs).abs() <= 1e-12 * size, "{case}: {ours} and {theirs}");
        }
    }

    /// Variance of a number with this derivative.
    fn variance_by_duals(errors: &StateErrors, derivative: Row) -> f64 {
        let [(covariance, own)] = carried_by_duals(errors, &[derivative]);
        covariance[0] + own.iter().map(|error| error * error).sum::<f64>()
    }

    /// Errors over a bounce in closed form, and the derivative of the same bounce by dual numbers.
    fn compare(rod: &Rod<Number>, friction: Option<Friction>, held: Option<HeldEnergy>, before: &State, case: &str) {
        let uncertain = UncertainRod::new(*rod);
        let (plain, dual) = (uncertain.plain, along_states(before, THETA));
        let (strike, mut lifted) = match friction {
            None => (plain.strike(before), rod.strike(&dual)),
            Some(friction) => (
                friction.strike_by_tilt_gain(&plain, before),
                friction.map(Number::from_f64).strike_by_tilt_gain(rod, &dual),
            ),
        };
        let mut errors = start();
        let energy = match held {
            None => {
                // Without a held energy there are no errors of it.
                for row in &mut errors.of_parameters {
                    row[OF_ENERGY - STATES] = 0.0;
                }
                Number { value: 0.0, partials: [0.0; WIDTH] }
            }
            Some(held) => {
                let held = held.map_or(lifted.energy, |[a, b, c, d]| Number {
                    value: strike.energy,
                    partials: [0.0, 0.0, 0.0, 0.0, a, b, c, d],
                });
                rod.hold_energy(&mut lifted, held)
            }
        };
        let flight: Flight = plain.flight(&strike);
        let t = first_contact(&flight).unwrap();
        let lifted_flight = rod.flight(&lifted);
        let time = lifted_flight.lift_root(t);
        let end = lifted_flight.end(time);
        let expected = [end.theta, end.x_dot, end.y_dot, end.theta_dot, energy].map(|number| number.partials);

        let ours = match friction {
            None => of_strike(&uncertain, before, &strike, &StrikeAngles::new(&uncertain, &strike), held),
            Some(friction) => of_strike_with_friction(&friction, rod, before),
        };
        let (mut struck, mut holds) = (errors.after_strike(&ours), held.flatten().unwrap_or([0.0; PARAMETERS]));
        if let Some(energy) = ours.energy {
            (struck, holds) = struck.hold(errors, ours, energy, 0.0);
        }
        let at_end = sin_cos(flight.end(t).theta);
        let over = FlightDerivative::new(&flight, t, at_end, rod.gravity.partials[OF_GRAVITY]);
        let (after, time_variance) = struck.after_flight(&over);
        assert_alike(&joint(&after, holds), &carried_by_duals(&errors, &expected), case);
        let expected = variance_by_duals(&errors, time.partials);
        assert!((time_variance - expected).abs() <= 1e-12 * expected, "{case}: {time_variance} and {expected}");
        let expected = variance_by_duals(&errors, lifted_flight.gap(time).slope.partials);
        let l = flight.contact_distance;
        let ours = after.variance_of_sum(l * over.end.theta_dot * at_end.1, l * at_end.0);
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
                for held in [None, Some(None), Some(Some(HELD))] {
                    let case = format!("{law:?} {per_energy} {gain} {exact}, {held:?}, {before:?}");
                    compare(&rod, None, held, before, &case);
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
        // The last row is that of no energy.
        let mut derivatives = [[0.0; WIDTH]; 5];
        (derivatives[THETA][X_DOT], derivatives[THETA][Y_DOT]) = (-y_dot * per_square, x_dot * per_square);
        for state in [X_DOT, Y_DOT, THETA_DOT] {
            derivatives[state][state] = 1.0;
        }
        let theirs = carried_by_duals(&before, &derivatives);
        assert_alike(&joint(&errors, [0.0; PARAMETERS]), &theirs, "angle of the velocity");
    }
}
