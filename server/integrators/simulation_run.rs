//! The part that all methods share: contacts seen, checks of endings, and the count and limit of work.
//!
//! Not here: how they move the rod.

use equipoise_physics::map::body::{Body, PreImpact, Release};
use equipoise_physics::map::strike::{Rebound, Rod, State, Strike};
use equipoise_physics::map::table::actuator_load::ActuatorLoad;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::rules;
use equipoise_physics::run::rules::{FlightTimes, Rules};

use crate::integrators::motion::Motion;
use crate::integrators::simulation::{SimulatedImpact, SimulationEnding, WorkCount};

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
        (motion, self.rod.fall(&self.release).is_ok_and(|(t, _)| t == 0.0))
    }

    /// [`Motion::gap`], counted.
    pub(crate) fn gap(&mut self, motion: &Motion) -> f64 {
        self.work.gaps += 1;
        motion.gap(self.rod.contact_distance)
    }

    /// A step of free flight by Runge-Kutta, counted.
    pub(crate) fn fly(&mut self, motion: &Motion, step: f64) -> Motion {
        self.work.accelerations += 4;
        let gravity = self.rod.gravity;
        motion.runge_kutta(step, |_, _| [0.0, -gravity, 0.0])
    }

    /// Before every step: whether there may be one.
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
