//! A compliant contact: the table as a spring and a damper along its normal, which hold the rod for a short while.
//!
//! The contact begins at the end of the step in which the gap closed; from then on the table's plane moves with the velocity that the
//! strike gives it, at the tilt of that moment. It ends when the spring and the damper no longer push. The stiffness follows from
//! the step: undamped, the contact lasts [`STEPS_PER_CONTACT`] steps, k = (π/(N h))²/B with B = 1/(effective mass). The damping is the one
//! with which a contact that cannot pull gives back e without gravity (Schwager and Pöschel 2007):
//! e = exp(−2ζ arccos ζ/√(1 − ζ²)), and its continuation beyond ζ = 1.

use std::convert::Infallible;
use std::f64::consts::PI;

use equipoise_physics::map::strike::{Rebound, Strike};

use crate::integrators::motion::Motion;
use crate::integrators::simulation_run::{Halt, SimulationRun};
use crate::integrators::time_stepping::per_impulse;

/// Steps of an undamped contact. More make the table softer; with fewer, Runge-Kutta itself damps the contact, which smaller steps do not
/// mend as they only make the table harder: with 16 it takes 6e-6 of the speed, with 8 2e-4.
pub const STEPS_PER_CONTACT: f64 = 16.0;

/// Largest damping ratio for which Runge-Kutta is stable at that stiffness (2ζω₀h < 2.78): restitutions under 0.005 become 0.005.
const MOST_DAMPING: f64 = 7.0;

pub(crate) fn simulate(run: &mut SimulationRun, step: f64) -> Result<Infallible, Halt> {
    let damping = damping_ratio(run.rod.restitution);
    let (mut motion, mut meets) = run.start();
    let mut steps = 0.0;
    let mut gap = run.gap(&motion);
    loop {
        if meets {
            let strike = run.contact(steps * step, &motion)?;
            let spring = Spring::new(run, &motion, &strike, damping, step);
            let mut elapsed = 0.0;
            loop {
                run.step(steps * step, &motion)?;
                run.work.accelerations += 4;
                motion = motion.runge_kutta(step, |motion, part| spring.acceleration(motion, elapsed + part));
                (steps, elapsed) = (steps + 1.0, elapsed + step);
                if spring.lets_go(&motion, elapsed) {
                    break;
                }
            }
            run.leave(&motion.state(), spring.rebound(&motion))?;
            gap = run.gap(&motion);
        }
        run.step(steps * step, &motion)?;
        let next = run.fly(&motion, step);
        let next_gap = run.gap(&next);
        meets = next_gap <= 0.0 && (gap > 0.0 || next_gap < gap);
        (motion, gap, steps) = (next, next_gap, steps + 1.0);
    }
}

/// The table during one contact.
struct Spring {
    contact_distance: f64,
    gravity: f64,
    radius_of_gyration: f64,
    /// The table's normal, a point of its plane at the beginning, and its velocity.
    normal: [f64; 2],
    point: [f64; 2],
    velocity: [f64; 2],
    /// Per unit mass: 1/s² and 1/s.
    stiffness: f64,
    damping: f64,
}

impl Spring {
    fn new(run: &SimulationRun, motion: &Motion, strike: &Strike, damping_ratio: f64, step: f64) -> Self {
        let rod = run.rod;
        let direction = per_impulse(&motion.state(), strike);
        let turn = rod.radius_of_gyration * direction[2];
        let weight = direction[0] * direction[0] + direction[1] * direction[1] + turn * turn;
        let frequency = PI / (STEPS_PER_CONTACT * step);
        let arm = motion.arm(rod.contact_distance);
        Self {
            contact_distance: rod.contact_distance,
            gravity: rod.gravity,
            radius_of_gyration: rod.radius_of_gyration,
            normal: [direction[0], direction[1]],
            point: [motion.place[0] + arm[0], motion.place[1] + arm[1]],
            velocity: [strike.table_velocity.0, strike.table_velocity.1],
            stiffness: frequency * frequency / weight,
            damping: 2.0 * damping_ratio * frequency / weight,
        }
    }

    /// Height of the contact point above the table's plane, and the rate at which it rises.
    fn clearance(&self, motion: &Motion, elapsed: f64) -> (f64, f64) {
        let arm = motion.arm(self.contact_distance);
        let velocity = motion.contact_velocity(self.contact_distance);
        let along = |row: usize| {
            let depth = motion.place[row] + arm[row] - self.point[row] - self.velocity[row] * elapsed;
            (depth * self.normal[row], (velocity[row] - self.velocity[row]) * self.normal[row])
        };
        let ((x, x_rate), (y, y_rate)) = (along(0), along(1));
        (x + y, x_rate + y_rate)
    }

    /// The contact point as the table lets go of it. It is never at rest: a spring gives something back.
    fn rebound(&self, motion: &Motion) -> Rebound {
        let velocity = motion.contact_velocity(self.contact_distance);
        let along_normal = velocity[0] * self.normal[0] + velocity[1] * self.normal[1];
        Rebound { rise: velocity[1], along_normal, rounding: 0.0 }
    }

    fn force(&self, motion: &Motion, elapsed: f64) -> f64 {
        let (clearance, rate) = self.clearance(motion, elapsed);
        (-(self.stiffness * clearance + self.damping * rate)).max(0.0)
    }

    fn acceleration(&self, motion: &Motion, elapsed: f64) -> [f64; 3] {
        let force = self.force(motion, elapsed);
        let [x, y] = self.normal.map(|share| share * force);
        let arm = motion.arm(self.contact_distance);
        let torque = arm[0] * y - arm[1] * x;
        [x, y - self.gravity, torque / (self.radius_of_gyration * self.radius_of_gyration)]
    }

    fn lets_go(&self, motion: &Motion, elapsed: f64) -> bool {
        let (_, rate) = self.clearance(motion, elapsed);
        rate > 0.0 && self.force(motion, elapsed) == 0.0
    }
}

/// ζ of a contact that gives back this share of the speed.
fn damping_ratio(restitution: f64) -> f64 {
    let (mut low, mut high) = (0.0, MOST_DAMPING);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high || middle < f64::EPSILON {
            return low;
        }
        if given_back(middle) > restitution {
            low = middle;
        } else {
            high = middle;
        }
    }
}

fn given_back(damping: f64) -> f64 {
    let root = ((1.0 - damping) * (1.0 + damping)).abs().sqrt();
    if root == 0.0 {
        return libm::exp(-2.0);
    }
    let angle = if damping < 1.0 { libm::acos(damping) } else { libm::log(damping + root) };
    libm::exp(-2.0 * damping * angle / root)
}
