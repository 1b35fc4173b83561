//! The rod as general methods see it: six numbers that obey second-order equations of motion, and a gap to the table.
//!
//! Not here: contacts.

use equipoise_physics::impact::State;
use equipoise_physics::trig;

/// Place and velocity of the rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    /// x and y of the centre of gravity, m, and θ.
    pub(super) place: [f64; 3],
    /// ẋ, ẏ, θ̇.
    pub(super) velocity: [f64; 3],
}

impl Motion {
    pub(super) fn state(&self) -> State {
        let [x_dot, y_dot, theta_dot] = self.velocity;
        State { theta: self.place[2], x_dot, y_dot, theta_dot }
    }

    /// Height of the contact point over y = 0, m.
    pub(super) fn gap(&self, contact_distance: f64) -> f64 {
        self.place[1] - contact_distance * trig::sin_cos(self.place[2]).1
    }

    /// (l sin θ, −l cos θ), from the centre of gravity to the contact point.
    pub(super) fn arm(&self, contact_distance: f64) -> [f64; 2] {
        let (sin, cos) = trig::sin_cos(self.place[2]);
        [contact_distance * sin, -(contact_distance * cos)]
    }

    /// Velocity of the contact point.
    pub(super) fn contact_velocity(&self, contact_distance: f64) -> [f64; 2] {
        let [x, y] = self.arm(contact_distance);
        let [x_dot, y_dot, theta_dot] = self.velocity;
        [x_dot - theta_dot * y, y_dot + theta_dot * x]
    }

    /// One step of the classical Runge-Kutta method of order 4 (Kutta 1901): four accelerations.
    pub(super) fn runge_kutta(&self, step: f64, acceleration: impl Fn(&Self, f64) -> [f64; 3]) -> Self {
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
