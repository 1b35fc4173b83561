//! General simulation methods: how they move the rod, and how they notice contacts.

use std::convert::Infallible;
use std::f64::consts::PI;

use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use differential_equations::status::Status;
use equipoise_physics::map::flight::Flight;
use equipoise_physics::map::strike::{Rebound, State, Strike};
use equipoise_physics::numbers::trig;
use equipoise_physics::run::ending::Ending;

use crate::integrators::simulation::{Halt, Motion, SimulationRun, bisect};

// Runge-Kutta of order 4 with a fixed step, the first thing that is tried.
//
// A free flight is a parabola, which the method follows without error: all that is off comes from the contacts. One that begins and
// ends within a step is not seen.

/// Treatment of a contact within a step, by a method with fixed steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// The strike is at the end of the step.
    StepEnd,
    /// The step is done again up to where the chord of the gap is zero.
    Secant,
    /// The step is done again and again, until the contact is known to the last digit.
    Bisection,
}

pub(crate) fn marching(run: &mut SimulationRun, step: f64, location: Location) -> Result<Infallible, Halt> {
    let (mut motion, at_contact) = run.start();
    // Steps are counted from the last contact, so that rounding of t does not add up.
    let (mut contact_t, mut steps) = (0.0, 0.0);
    if at_contact {
        run.strike(0.0, &mut motion)?;
    }
    let mut gap = run.gap(&motion);
    loop {
        let t = contact_t + steps * step;
        run.step(t, &motion)?;
        let next = run.fly(&motion, step);
        let next_gap = run.gap(&next);
        // After a strike at the end of a step the contact point may be below the table, on its way up.
        let falls = next_gap < gap;
        if next_gap > 0.0 || (gap <= 0.0 && !falls) {
            (motion, gap, steps) = (next, next_gap, steps + 1.0);
            continue;
        }
        let part = match location {
            Location::StepEnd => step,
            Location::Secant if gap > 0.0 => step * (gap / (gap - next_gap)),
            Location::Secant => 0.0,
            Location::Bisection => bisect(step, |part| {
                let there = run.fly(&motion, part);
                run.gap(&there) > 0.0
            }),
        };
        motion = if location == Location::StepEnd { next } else { run.fly(&motion, part) };
        (contact_t, steps) = (t + part, 0.0);
        run.strike(contact_t, &mut motion)?;
        gap = run.gap(&motion);
    }
}

// An ODE library's Runge-Kutta 5(4) with steps of its own choice (Dormand and Prince 1980), and events on its dense output.
//
// The tolerance is for the flight, which is a parabola and has no error. So each step is ten times the last, for any tolerance, and the
// method does not examine the gap within a step. The contact is located here, by halving on the dense output: the
// library's own search for events is off by 4e-4 at the first contact of the paper's case 1.

struct FreeFlight {
    gravity: f64,
}

impl ODE<f64, [f64; 6]> for FreeFlight {
    fn diff(&self, _: f64, motion: &[f64; 6], change: &mut [f64; 6]) {
        *change = [motion[3], motion[4], motion[5], 0.0, -self.gravity, 0.0];
    }
}

/// No flight is longer, s: the library wants an end.
const HORIZON: f64 = 1e6;

pub(crate) fn adaptive(run: &mut SimulationRun, tolerance: f64) -> Result<Infallible, Halt> {
    let (mut motion, at_contact) = run.start();
    let mut t = 0.0;
    if at_contact {
        run.strike(t, &mut motion)?;
    }
    loop {
        t += fly(run, tolerance, t, &mut motion)?;
        run.strike(t, &mut motion)?;
    }
}

/// Integrates one flight, from just after a contact to the next one. Returns its duration, s.
fn fly(run: &mut SimulationRun, tolerance: f64, t: f64, motion: &mut Motion) -> Result<f64, Halt> {
    let flight = FreeFlight { gravity: run.rod.gravity };
    let mut solver = ExplicitRungeKutta::dopri5().rtol(tolerance).atol(tolerance).max_steps(usize::MAX);
    // The step control fails for numbers that are not finite, and for a tolerance below rounding.
    let failed = |_| Halt::from(Ending::Diverged { speed: motion.velocity[0].abs().max(motion.velocity[1].abs()) });
    let evaluations = solver.init(&flight, 0.0, HORIZON, &numbers(motion)).map_err(failed)?;
    run.work.accelerations += evaluations.function as u64;
    let mut gap = run.gap(motion);
    loop {
        run.step(t + solver.t(), &rod(solver.y()))?;
        let evaluations = solver.step(&flight).map_err(failed)?;
        run.work.accelerations += evaluations.function as u64;
        if matches!(solver.status(), Status::RejectedStep) {
            continue;
        }
        let next_gap = run.gap(&rod(solver.y()));
        if next_gap > 0.0 || (gap <= 0.0 && next_gap >= gap) {
            gap = next_gap;
            continue;
        }
        let begin = solver.t_prev();
        let end = solver.t();
        // Within the step the library has no reason to refuse; what it would leave out is the step's end.
        let mut dense =
            |part: f64| solver.interpolate((begin + part).min(end)).map_or(rod(solver.y()), |there| rod(&there));
        let part = bisect(end - begin, |part| run.gap(&dense(part)) > 0.0);
        *motion = dense(part);
        return Ok(begin + part);
    }
}

fn numbers(motion: &Motion) -> [f64; 6] {
    let ([x, y, theta], [x_dot, y_dot, theta_dot]) = (motion.place, motion.velocity);
    [x, y, theta, x_dot, y_dot, theta_dot]
}

fn rod(&[x, y, theta, x_dot, y_dot, theta_dot]: &[f64; 6]) -> Motion {
    Motion { place: [x, y, theta], velocity: [x_dot, y_dot, theta_dot] }
}

// The exact flight on a grid of times, as in scripts that know the parabola and not its contact time.
//
// The method misses a contact between two samples if the gap is open again at the second.

pub(crate) fn sampling(run: &mut SimulationRun, step: f64) -> Result<Infallible, Halt> {
    let (mut motion, at_contact) = run.start();
    let mut contact_t = 0.0;
    let mut flight = if at_contact {
        let strike = run.strike(0.0, &mut motion)?;
        run.rod.flight(&strike)
    } else {
        Flight {
            start: motion.state(),
            sin_cos_theta: trig::sin_cos(motion.place[2]),
            clearance: run.gap(&motion),
            contact_distance: run.rod.contact_distance,
            gravity: run.rod.gravity,
            drag: None,
        }
    };
    loop {
        let mut looks = 0.0;
        let end = loop {
            run.step(contact_t, &motion)?;
            looks += 1.0;
            run.work.gaps += 1;
            if flight.gap(looks * step).value <= 0.0 {
                break looks * step;
            }
        };
        let begin = end - step;
        let t = begin
            + bisect(step, |part| {
                run.work.gaps += 1;
                flight.gap(begin + part).value > 0.0
            });
        motion = after(&motion, &flight, t);
        contact_t += t;
        let strike = run.strike(contact_t, &mut motion)?;
        flight = run.rod.flight(&strike);
    }
}

/// The rod a time after the start of its flight. Its height at a contact is that of a contact.
fn after(start: &Motion, flight: &Flight, t: f64) -> Motion {
    let end = flight.end(t);
    let x = start.place[0] + end.x_dot * t;
    let y = flight.contact_distance * trig::sin_cos(end.theta).1;
    Motion { place: [x, y, end.theta], velocity: [end.x_dot, end.y_dot, end.theta_dot] }
}

// Time stepping after Moreau (1988) and Jean (1999), as engines of many contacts do it: velocities and impulses of a whole step, the
// gap at its middle, Newton's restitution between the velocities at its ends.
//
// With U the relative velocity along the normal, 0 ≤ U⁺ + e U⁻ ⊥ P ≥ 0 while the gap is closed. The table moves as the strike says,
// so that impulse comes from the strike of the map, with its part along the table where there is friction; a step's share of gravity is
// added, which a closed contact has to carry too. A contact is known to half a step: the method is of order 1.

pub(crate) fn time_stepping(run: &mut SimulationRun, step: f64) -> Result<Infallible, Halt> {
    let (mut motion, at_contact) = run.start();
    if at_contact {
        run.strike(0.0, &mut motion)?;
    }
    // At a release from its contact height the strike has just been.
    let mut was_closed = at_contact;
    let (half, gravity) = (0.5 * step, run.rod.gravity);
    let mut steps = 0.0;
    loop {
        let t = steps * step;
        run.step(t, &motion)?;
        let middle = drift(&motion, half);
        let closed = run.gap(&middle) <= 0.0;
        let mut velocity = motion.velocity;
        velocity[1] -= gravity * step;
        // While a contact stays closed, only a table that is approached strikes again.
        if closed && (!was_closed || run.foresee(&middle).push < 0.0) {
            let strike = run.contact(t + half, &middle)?;
            run.leave(&strike.after, run.rebound_of(&strike, &middle))?;
            let direction = per_impulse(&middle.state(), &strike);
            let turn = run.rod.radius_of_gyration * direction[2];
            let weight = direction[0] * direction[0] + direction[1] * direction[1] + turn * turn;
            let impulse = strike.impulse_normal + step * gravity * direction[1] / weight;
            velocity = std::array::from_fn(|row| velocity[row] + direction[row] * impulse.max(0.0));
        }
        motion = drift(&Motion { velocity, ..middle }, half);
        was_closed = closed;
        steps += 1.0;
    }
}

fn drift(motion: &Motion, time: f64) -> Motion {
    Motion { place: std::array::from_fn(|row| motion.place[row] + time * motion.velocity[row]), ..*motion }
}

/// Change of the velocities by a unit of impulse along the table's normal, with what comes along the table by it; the strike shows it.
pub(crate) fn per_impulse(before: &State, strike: &Strike) -> [f64; 3] {
    let after = strike.after;
    [after.x_dot - before.x_dot, after.y_dot - before.y_dot, after.theta_dot - before.theta_dot]
        .map(|change| change / strike.impulse_normal)
}

// A compliant contact: the table as a spring and a damper along its normal, which hold the rod for a short while.
//
// The contact begins at the end of the step in which the gap closed; from then on the table's plane moves with the velocity that the
// strike gives it, at the tilt of that moment. It ends when the spring and the damper no longer push. The stiffness follows from
// the step: undamped, the contact lasts [`STEPS_PER_CONTACT`] steps, k = (π/(N h))²/B with B = 1/(effective mass). The damping is the one
// with which a contact that cannot pull gives back e without gravity (Schwager and Pöschel 2007):
// e = exp(−2ζ arccos ζ/√(1 − ζ²)), and its continuation beyond ζ = 1.

/// Steps of an undamped contact. More make the table softer; with fewer, Runge-Kutta itself damps the contact, which smaller steps do not
/// mend as they only make the table harder: with 16 it takes 6e-6 of the speed, with 8 2e-4.
pub const STEPS_PER_CONTACT: f64 = 16.0;

/// Largest damping ratio for which Runge-Kutta is stable at that stiffness (2ζω₀h < 2.78): restitutions under 0.005 become 0.005.
const MOST_DAMPING: f64 = 7.0;

pub(crate) fn penalty(run: &mut SimulationRun, step: f64) -> Result<Infallible, Halt> {
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
