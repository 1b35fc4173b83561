//! Parts that all methods share: the result of a simulation, contacts seen, checks of endings, and the count and limit of work.

use equipoise_physics::map::body::{Body, PreImpact, Release};
use equipoise_physics::map::contact_time::first_contact_from_rest;
use equipoise_physics::map::strike::{Rebound, Rod, State, Strike};
use equipoise_physics::map::table::actuator_load::ActuatorLoad;
use equipoise_physics::numbers::trig;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::rules;
use equipoise_physics::run::rules::{FlightTimes, Rules};

/// One contact, as a method saw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulatedImpact {
    /// Number of the contact, from 1.
    pub n: u64,
    /// Time, s after release.
    pub t: f64,
    /// Horizontal place of the centre of gravity, m.
    pub x: f64,
    /// Angle and velocities just before it.
    pub state: State,
}

/// Ending of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SimulationEnding {
    /// An ending that runs of the map have too.
    Run(equipoise_physics::run::ending::Ending),
    /// The rod is below the table and falls, and no contact was seen.
    Missed {
        /// Time at which that was noticed, s.
        t: f64,
    },
    /// It took all the steps that it was given.
    OutOfSteps {
        /// Number of steps.
        steps: u64,
    },
}

impl SimulationEnding {
    /// Name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Run(ending) => ending.name(),
            Self::Missed { .. } => "missed",
            Self::OutOfSteps { .. } => "out_of_steps",
        }
    }
}

/// Work of a simulation: counts, the same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WorkCount {
    /// Steps, or looks at the flight, those that a method tried and gave up included.
    pub steps: u64,
    /// Evaluations of the right-hand side of the equations of motion.
    pub accelerations: u64,
    /// Evaluations of the gap between contact point and table.
    pub gaps: u64,
}

/// Result of a method on a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// The contacts that it saw.
    pub impacts: Vec<SimulatedImpact>,
    /// Ending of the run.
    pub ending: SimulationEnding,
    /// Work that it took.
    pub work: WorkCount,
}

// The part that all methods share: contacts seen, checks of endings, and the count and limit of work.
//
// Not here: how they move the rod.

/// Reason for which a method stops.
pub(crate) enum Halt {
    /// The run is over.
    Ended(SimulationEnding),
    /// Nobody waits for it any more.
    Stopped,
}

impl From<Ending> for Halt {
    fn from(ending: Ending) -> Self {
        Self::Ended(SimulationEnding::Run(ending))
    }
}

/// Steps between two questions whether to go on: far under a millisecond.
const STEPS_PER_QUESTION: u64 = 128;

/// A run that a method is on.
pub(crate) struct SimulationRun<'a> {
    /// Lengths and gravity of the body.
    pub(crate) rod: Rod,
    /// The body that is struck.
    body: Body,
    pub(crate) release: Release,
    pub(crate) impacts: Vec<SimulatedImpact>,
    pub(crate) work: WorkCount,
    rules: Rules,
    wanted: u64,
    most_steps: u64,
    go_on: &'a mut dyn FnMut() -> bool,
    /// The flights before the last contact.
    flights: FlightTimes,
    /// Rebound of the contact point from the last contact.
    rebound: Rebound,
}

impl<'a> SimulationRun<'a> {
    pub(crate) fn new(
        body: Body,
        rules: Rules,
        release: Release,
        wanted: u64,
        most_steps: u64,
        go_on: &'a mut dyn FnMut() -> bool,
    ) -> Self {
        Self {
            rod: body.rod,
            body,
            release,
            impacts: Vec::new(),
            work: WorkCount::default(),
            rules,
            wanted,
            most_steps,
            go_on,
            flights: FlightTimes::default(),
            rebound: Rebound { rise: 0.0, along_normal: 0.0, rounding: 0.0 },
        }
    }

    /// The rod at t = 0. Whether the release is a contact already is read as the map reads it.
    pub(crate) fn start(&self) -> (Motion, bool) {
        let State { theta, x_dot, y_dot, theta_dot } = self.release.state;
        let motion =
            Motion { place: [self.release.x, self.release.height, theta], velocity: [x_dot, y_dot, theta_dot] };
        (motion, first_contact_from_rest(&self.rod.flight_from(&self.release)) == Ok(0.0))
    }

    /// [`Motion::gap`], counted.
    #[inline]
    pub(crate) fn gap(&mut self, motion: &Motion) -> f64 {
        self.work.gaps += 1;
        motion.gap(self.rod.contact_distance)
    }

    /// A step of free flight by Runge-Kutta, counted.
    #[inline]
    pub(crate) fn fly(&mut self, motion: &Motion, step: f64) -> Motion {
        self.work.accelerations += 4;
        let gravity = self.rod.gravity;
        motion.runge_kutta(step, |_, _| [0.0, -gravity, 0.0])
    }

    /// Before every step: whether there may be one.
    #[inline]
    pub(crate) fn step(&mut self, t: f64, motion: &Motion) -> Result<(), Halt> {
        if motion.place[1] < -self.rod.contact_distance && motion.velocity[1] <= 0.0 {
            return Err(Halt::Ended(SimulationEnding::Missed { t }));
        }
        if self.work.steps >= self.most_steps {
            return Err(Halt::Ended(SimulationEnding::OutOfSteps { steps: self.most_steps }));
        }
        if self.work.steps.is_multiple_of(STEPS_PER_QUESTION) && !(self.go_on)() {
            return Err(Halt::Stopped);
        }
        self.work.steps += 1;
        Ok(())
    }

    /// The strike of the coming contact, if it is now.
    pub(crate) fn foresee(&self, motion: &Motion) -> Strike {
        self.body.strike(&PreImpact::at(self.impacts.len() as u64 + 1, motion.place[0], motion.state()))
    }

    /// A contact: records it and gives the strike. The checks before a strike are made here. That the flight before was too short is
    /// known only now, and ends the run at the contact before.
    pub(crate) fn contact(&mut self, t: f64, motion: &Motion) -> Result<Strike, Halt> {
        let state = motion.state();
        let contacts = self.impacts.len() as u64;
        if let Some(before) = self.impacts.last().filter(|_| self.rules.settles) {
            let flight_time = t - before.t;
            let time_after = |seconds| before.t + seconds;
            go_on(self.rules.after_flight(
                Ok(flight_time),
                &mut self.flights,
                [self.rebound.rise, 0.0],
                || self.rebound,
                time_after,
            ))?;
            self.flights.last = flight_time;
        }
        go_on(rules::completed(contacts, self.wanted))?;
        let strike = self.foresee(motion);
        self.impacts.push(SimulatedImpact { n: contacts + 1, t, x: motion.place[0], state });
        // The rules of a method have neither limits nor ends of the table.
        let push = [strike.push, strike.approach];
        go_on(self.rules.before_strike(state.theta, push, || None, || 0.0, ActuatorLoad::default))?;
        Ok(strike)
    }

    /// The end of a contact, with the state just after it: the checks between a strike and its flight. A method never knows that there is no
    /// further contact, only that it has seen none ([`SimulationRun::step`]).
    pub(crate) fn leave(&mut self, state: &State, rebound: Rebound) -> Result<(), Halt> {
        self.rebound = rebound;
        let spin = self.rod.contact_distance * state.theta_dot;
        let speed_squared = rules::speed_squared(state.x_dot, state.y_dot, spin);
        let t = self.impacts.last().map_or(0.0, |impact| impact.t);
        go_on(self.rules.after_strike(t, speed_squared, [rebound.rise, rebound.rounding], || rebound))?;
        // For a run that may settle, the flight after its last contact decides too.
        if self.rules.settles { Ok(()) } else { go_on(rules::completed(self.impacts.len() as u64, self.wanted)) }
    }

    /// A contact without duration: [`SimulationRun::contact`] and [`SimulationRun::leave`], and the velocities changed.
    pub(crate) fn strike(&mut self, t: f64, motion: &mut Motion) -> Result<Strike, Halt> {
        let strike = self.contact(t, motion)?;
        self.leave(&strike.after, self.rebound_of(&strike, motion))?;
        motion.velocity = [strike.after.x_dot, strike.after.y_dot, strike.after.theta_dot];
        Ok(strike)
    }

    /// Rebound of the contact point from a contact without duration.
    pub(crate) fn rebound_of(&self, strike: &Strike, before: &Motion) -> Rebound {
        strike.rebound(self.rod.contact_distance, self.body.rise_rounding(&before.state(), strike))
    }
}

/// Halts the run at an ending.
fn go_on(ending: Option<Ending>) -> Result<(), Halt> {
    ending.map_or(Ok(()), |ending| Err(ending.into()))
}

/// Halves a stretch of time until its ends are neighbours: `is_above` holds at the answer (or it is 0) and not just after it.
pub(crate) fn bisect(mut end: f64, mut is_above: impl FnMut(f64) -> bool) -> f64 {
    let mut begin = 0.0;
    loop {
        let middle = 0.5 * (begin + end);
        if middle <= begin || middle >= end || !middle.is_normal() {
            return begin;
        }
        if is_above(middle) {
            begin = middle;
        } else {
            end = middle;
        }
    }
}

// The rod as general methods see it: six numbers that obey second-order equations of motion, and a gap to the table.
//
// Not here: contacts.

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
