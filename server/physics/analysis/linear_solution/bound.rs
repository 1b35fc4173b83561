//! Error bound of the linear solution: what each bounce leaves out, carried on by the powers that the solution takes, and rounding.

use super::closed_form::{LinearImpact, LinearSolution, power};
use super::truncation_error::TruncationError;
use crate::analysis::linear_verdict::AngleClass;
use crate::map::strike::State;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::number::Arithmetic;
use crate::numbers::trig;
use crate::run::extended;

/// Factor of a bound over the sum of the terms that each bounce neglects. They are taken at the linear state, not at the true one.
pub const SAFETY: f64 = 1.5;

/// Points at which the neglected terms are evaluated: phases of half a turn, or bounces of a run.
const SAMPLES: u64 = 12;

impl LinearSolution {
    /// The state at the end of the fall: nothing is left out there, and it is known but for its last digit.
    pub(super) fn first(&self) -> LinearImpact {
        let Self { start, t, x, .. } = *self;
        let rho = self.rod.radius_of_gyration;
        let sizes = [rho * start.theta, start.x_dot, start.y_dot, rho * start.theta_dot];
        let largest = sizes.into_iter().map(f64::abs).fold(0.0, f64::max);
        LinearImpact { t, x, state: start, error_estimate: f64::EPSILON * largest, t_error: f64::EPSILON * t }
    }

    /// The most that rounding puts ẏ off, m/s: of each sum, and of gravity.
    fn y_rounding(&self, m: u64, state: &State) -> f64 {
        let Self { start, rod, speed, .. } = self;
        let unit = 4.0 * f64::EPSILON;
        if let Some(eigenvalue) = self.energy_eigenvalue {
            return unit * (speed.abs() + m as f64 * (power(eigenvalue, m) * self.start_excess()).abs());
        }
        let square = |one: f64, other: f64| one * one + other * other;
        let rho = rod.radius_of_gyration;
        let (sine, _) = trig::sin_cos(0.5 * (state.theta.abs() + start.theta.abs()));
        let terms = square(start.y_dot, state.y_dot)
            + square(start.x_dot, state.x_dot)
            + square(rho * start.theta_dot, rho * state.theta_dot)
            + 4.0 * rod.gravity * rod.contact_distance * sine * sine;
        unit * terms / state.y_dot.abs().max(f64::MIN_POSITIVE)
    }

    /// The most that rounding puts θ and u off after `m` bounces: of the phase, which grows with m, and of each product.
    fn angle_rounding(&self, m: u64) -> (f64, f64) {
        let (theta, u) = (self.start.theta, self.start_u());
        if theta == 0.0 && u == 0.0 {
            return (0.0, 0.0);
        }
        let (now, before) = (self.chebyshev(m).abs(), self.chebyshev(m - 1).abs());
        // Rate of change of U with the phase.
        let slope = match self.class {
            AngleClass::Elliptic => 0.5 / (self.residue * (1.0 - self.residue)).sqrt(),
            AngleClass::Parabolic => 0.0,
            AngleClass::Hyperbolic | AngleClass::Attracting => now + 1.0 / libm::sinh(self.exponent),
        };
        let off = f64::EPSILON * (4.0 * now.max(before) + m as f64 * self.exponent * slope);
        let steep = 4.0 * self.residue.abs();
        (off * ((2.0 + steep) * theta.abs() + u.abs()), off * (2.0 * u.abs() + steep * theta.abs()))
    }

    /// Terms that the bounce from a state leaves out, with 31 digits; infinite where there is no bounce.
    fn truncation_error(&self, theta: f64, u: f64, x_dot: f64, y_dot: f64) -> TruncationError {
        let number = DoubleDouble::from_f64;
        let tau = number(self.flight_time);
        let lifted =
            State { theta: number(theta), x_dot: number(x_dot), y_dot: number(y_dot), theta_dot: number(u) / tau };
        let Some((t, end)) = extended::bounce(&self.extended, &lifted) else {
            let lost = f64::INFINITY;
            return TruncationError { theta: lost, u: lost, turned: lost, drift: lost, y_dot: lost, t: lost };
        };
        let fall = number(4.0 * self.residue) * number(theta);
        let of_theta = (end.theta - (number(theta) - fall + number(u))).to_f64();
        let of_u = (end.theta_dot * tau - (number(u) - fall)).to_f64();
        let pushed = number(2.0 * self.speed) * number(self.rod.tilt_gain) * number(theta);
        let of_x = (end.x_dot - (number(x_dot) - pushed)).to_f64();
        let (of_y, next_y) = match self.energy_eigenvalue {
            Some(eigenvalue) => {
                let next = number(eigenvalue) * number(y_dot + self.speed) - number(self.speed);
                ((end.y_dot - next).to_f64(), next.to_f64())
            }
            None => (0.0, -self.speed),
        };
        let sine = (self.residue * (1.0 - self.residue)).max(0.0).sqrt() * 2.0;
        let (across, beside) = (sine * of_theta, of_u - 2.0 * self.residue * of_theta);
        let lever = if self.is_at_lower_end() { 0.0 } else { self.lever() };
        TruncationError {
            theta: of_theta.abs(),
            u: of_u.abs(),
            turned: (across * across + beside * beside).sqrt(),
            drift: (of_x - lever * of_u).abs(),
            y_dot: of_y.abs(),
            t: (t.to_f64() + 2.0 * next_y / self.rod.gravity).abs(),
        }
    }

    /// The most that a bounce leaves out about an angle, with ẏ within `aside` of `excess` from the fixed point.
    fn worst_about(&self, theta: f64, u: f64, x_dot: f64, excess: f64, aside: f64) -> TruncationError {
        if self.energy_eigenvalue.is_none() {
            return self.truncation_error(theta, u, x_dot, self.on_energy(theta, x_dot, u / self.flight_time));
        }
        let y_dot = -self.speed + excess;
        let upper = self.truncation_error(theta, u, x_dot, y_dot + aside);
        if aside == 0.0 { upper } else { upper.or(self.truncation_error(theta, u, x_dot, y_dot - aside)) }
    }

    /// Bounds on the error of the state and of the time after `m` bounces.
    pub(super) fn errors(&self, m: u64, state: &State) -> (f64, f64) {
        let count = m as f64;
        let decay = self.energy_eigenvalue.map_or(0.0, f64::abs);
        // Σ|λ|^k: how often a bounce counts for ẏ, and how many bounces of the approach to the wanted energy there are.
        let approach = if decay < 1.0 { (1.0 - power(decay, m)) / (1.0 - decay) } else { count };
        let sine = (self.residue * (1.0 - self.residue)).max(0.0).sqrt() * 2.0;
        let (mut theta, mut u, mut drift, mut y_dot, mut t) = (0.0, 0.0, 0.0, 0.0_f64, 0.0);
        if self.class == AngleClass::Elliptic {
            let [always, first] = self.circling;
            let sum = |of: fn(&TruncationError) -> f64| count * of(&always) + approach * of(&first);
            let turned = sum(|out| out.turned);
            theta = turned / sine;
            u = turned * (1.0 + (2.0 * self.residue / sine) * (2.0 * self.residue / sine)).sqrt();
            (drift, t) = (sum(|out| out.drift), sum(|out| out.t));
            y_dot = approach * (always.y_dot + first.y_dot);
        } else {
            let forced = self.along(m, 0.0).iter().fold(0.0, |most: f64, (_, out)| most.max(out.y_dot)) * approach;
            let samples = self.along(m, if self.energy_eigenvalue.is_some() { forced } else { 0.0 });
            for pair in samples.windows(2) {
                let gap = (pair[1].0 - pair[0].0) as f64;
                let mut most = [0.0_f64; 4];
                for (k, out) in pair {
                    let left = (m - 1).saturating_sub(*k);
                    let (now, before) = (self.chebyshev(left + 1), self.chebyshev(left));
                    let terms = [
                        grown(now * (1.0 - 4.0 * self.residue) - before, out.theta) + grown(now, out.u),
                        grown(4.0 * self.residue * now, out.theta) + grown(now - before, out.u),
                        out.drift,
                        out.t,
                    ];
                    for (most, term) in most.iter_mut().zip(terms) {
                        *most = most.max(term);
                    }
                    y_dot = y_dot.max(approach * out.y_dot);
                }
                (theta, u) = (theta + gap * most[0], u + gap * most[1]);
                (drift, t) = (drift + gap * most[2], t + gap * most[3]);
            }
        }
        // The samples are compared with flights from their own ẏ.
        t += count * 2.0 * y_dot / self.rod.gravity;
        let rho = self.rod.radius_of_gyration;
        let (theta_rounding, u_rounding) = self.angle_rounding(m);
        (theta, u) = (theta + theta_rounding, u + u_rounding);
        let reached = (self.flight_time * state.theta_dot).abs().max(self.start_u().abs());
        // 2Vκθ a bounce, which the drift is left of, is rounded each time.
        let widest = if self.class == AngleClass::Elliptic {
            (self.start.theta.abs() + self.start_u().abs()) / sine
        } else {
            self.start.theta.abs().max(state.theta.abs())
        };
        // The terms that bounces leave out are taken at the linear state, so the bound fails for errors as large as the deviation.
        let lost = theta.max(u) > widest.max(reached);
        let pushed = 2.0 * (self.speed * self.rod.tilt_gain).abs() * widest;
        let speeds = self.start.x_dot.abs() + state.x_dot.abs();
        drift += 4.0 * f64::EPSILON * (speeds + count * pushed);
        let lever = if self.is_at_lower_end() {
            drift += 2.0 * (self.speed * self.rod.tilt_gain).abs() * count * theta;
            0.0
        } else {
            let lever = self.lever().abs();
            drift += 4.0 * f64::EPSILON * lever * (self.start_u().abs() + (self.flight_time * state.theta_dot).abs());
            lever
        };
        let x_dot = lever * u + drift;
        let spin = rho * u / self.flight_time + 4.0 * f64::EPSILON * (rho * state.theta_dot).abs();
        if self.energy_eigenvalue.is_none() {
            let (sin, _) = trig::sin_cos(state.theta);
            let weight = self.rod.gravity * self.rod.contact_distance;
            y_dot = (state.x_dot.abs() * x_dot
                + (rho * state.theta_dot).abs() * spin
                + weight * (sin.abs() + theta) * theta
                + x_dot * x_dot
                + spin * spin)
                / state.y_dot.abs().max(f64::MIN_POSITIVE);
        }
        y_dot += self.y_rounding(m, state);
        let bound = SAFETY * (rho * theta).max(x_dot).max(y_dot).max(spin);
        // 1 − λ^m and 1 − λ are both rounded.
        let late =
            if decay < 1.0 { count * self.start_excess().abs() / ((1.0 - decay) * self.rod.gravity) } else { 0.0 };
        let late = if self.energy_eigenvalue.is_some() { late } else { 0.0 };
        let t_bound = SAFETY * (t + 4.0 * f64::EPSILON * (self.t + count * self.flight_time + late));
        (
            if lost || bound.is_nan() { f64::INFINITY } else { bound },
            if lost || t_bound.is_nan() { f64::INFINITY } else { t_bound },
        )
    }

    /// The most that bounces leave out at any phase, with ẏ within `aside` of its fixed point, and with the first excess of it.
    pub(super) fn on_circle(&self, aside: f64) -> [TruncationError; 2] {
        let (theta, u) = (self.start.theta, self.start_u());
        let sine = 2.0 * (self.residue * (1.0 - self.residue)).sqrt();
        let (across, beside) = (sine * theta, u - 2.0 * self.residue * theta);
        let radius = (across * across + beside * beside).sqrt();
        let mut most = [TruncationError::default(); 2];
        for index in 0..2 * SAMPLES {
            let (sin, cos) = trig::sin_cos(index as f64 * std::f64::consts::PI / SAMPLES as f64);
            let theta = radius * sin / sine;
            let u = radius * cos + 2.0 * self.residue * theta;
            let x_dot = self.start.x_dot + self.lever() * (u - self.start_u());
            most[0] = most[0].or(self.worst_about(theta, u, x_dot, 0.0, aside));
            if self.energy_eigenvalue.is_some() {
                most[1] = most[1].or(self.worst_about(theta, u, x_dot, self.start_excess(), aside));
            }
        }
        most
    }

    /// Terms that bounces before the `m`-th leave out, some of them, each with its number; the last stands for the end as well.
    fn along(&self, m: u64, aside: f64) -> Vec<(u64, TruncationError)> {
        let mut samples = Vec::new();
        if m == 0 {
            return samples;
        }
        let ks = (0..=SAMPLES).map(|index| (u128::from(m - 1) * u128::from(index) / u128::from(SAMPLES)) as u64);
        let mut last = None;
        for k in ks.chain([m - 1]) {
            if last.replace(k) == Some(k) {
                continue;
            }
            let at = |k: u64| {
                let (theta, u) = self.angle(k);
                let state = self.state(theta, u, k);
                self.worst_about(theta, u, state.x_dot, state.y_dot + self.speed, aside)
            };
            // The angle turns at each bounce where R > ½, and ẋ is not alike on both sides.
            let other = if self.residue > 0.5 && k + 1 < m { at(k + 1) } else { TruncationError::default() };
            samples.push((k, at(k).or(other)));
        }
        // A bounce more, so that the gaps between samples add up to m.
        if let Some(&(_, out)) = samples.last() {
            samples.push((m, out));
        }
        samples
    }
}

/// Size that is left after a growth that may be infinite: nothing of nothing.
fn grown(growth: f64, size: f64) -> f64 {
    if size == 0.0 { 0.0 } else { growth.abs() * size }
}
