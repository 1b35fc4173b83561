//! The rod as general methods see it: six numbers that obey second-order equations of motion, and a gap to the table.
//!
//! Not here: contacts.

use equipoise_physics::map::strike::State;
use equipoise_physics::numbers::trig;

/// Place and velocity of the rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    /// x and y of the centre of gravity, m, and θ.
    pub(crate) place: [f64; 3],
    /// ẋ, ẏ, θ̇.
    pub(crate) velocity: [f64; 3],
}

impl Motion {
    pub(crate) fn state(&self) -> State {
        let [x_dot, y_dot, theta_dot] = self.velocity;
        State { theta: self.place[2], x_dot, y_dot, theta_dot }
    }

    /// Height of the contact point over y = 0, m.
    pub(crate) fn gap(&self, contact_distance: f64) -> f64 {
        self.place[1] - contact_distance * trig::sin_cos(self.place[2]).1
    }

    /// (l sin θ, −l cos θ), from the centre of gravity to the contact point.
    pub(crate) fn arm(&self, contact_distance: f64) -> [f64; 2] {
        let (sin, cos) = trig::sin_cos(self.place[2]);
        [contact_distance * sin, -(contact_distance * cos)]
    }

    /// Velocity of the contact point.
    pub(crate) fn contact_velocity(&self, contact_distance: f64) -> [f64; 2] {
        let [x, y] = self.arm(contact_distance);
        let [x_dot, y_dot, theta_dot] = self.velocity;
        [x_dot - theta_dot * y, y_dot + theta_dot * x]
    }

    /// One step of the classical Runge-Kutta method of order 4 (Kutta 1901): four accelerations.
    pub(crate) fn runge_kutta(&self, step: f64, acceleration: impl Fn(&Self, f64) -> [f64; 3]) -> Self {
        let half = 0.5 * step;
        let a1 = acceleration(self, 0.0);
        let at2 = self.moved(half, &self.velocity, &a1);
        let a2 = acceleration(&at2, half);
        let at3 = self.moved(half, &at2.velocity, &a2);
        let a3 = acceleration(&at3, half);
        let at4 = self.moved(step, &at3.velocity, &a3);
        let a4 = acceleration(&at4, step);
        let mean = |k1: f64, k2: f64, k3: f64, k4: f64| (k1 + 2.0 * (k2 + k3) + k4) / 6.0;
        let per_row = |row: usize| mean(self.velocity[row], at2.velocity[row], at3.velocity[row], at4.velocity[row]);
        self.moved(
            step,
            &std::array::from_fn(per_row),
            &std::array::from_fn(|row| mean(a1[row], a2[row], a3[row], a4[row])),
        )
    }

    fn moved(&self, time: f64, velocity: &[f64; 3], acceleration: &[f64; 3]) -> Self {
        Self {
            place: std::array::from_fn(|row| self.place[row] + time * velocity[row]),
            velocity: std::array::from_fn(|row| self.velocity[row] + time * acceleration[row]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between contacts, where there is more to it than a parabola: a pendulum, against itself with steps of a hundredth.
    #[test]
    fn runge_kutta_is_of_order_4() {
        let after = |steps: u32| {
            let step = 1.0 / f64::from(steps);
            let start = Motion { place: [0.0, 0.0, 1.0], velocity: [0.0, 0.0, 2.0] };
            (0..steps).fold(start, |motion, _| {
                motion.runge_kutta(step, |motion, _| [0.0, 0.0, -9.0 * trig::sin_cos(motion.place[2]).0])
            })
        };
        let fine = after(2000).place[2];
        let error = |steps| (after(steps).place[2] - fine).abs();
        let order = (error(20) / error(40)).log2();
        assert!((order - 4.0).abs() < 0.2, "order {order}, errors {:e} {:e}", error(20), error(40));
    }
}
