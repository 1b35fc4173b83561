//! What all methods share: the contacts they saw, the reasons for which a run ends, and the count and limit of their work.
//!
//! Not here: how they move the rod.

use equipoise_physics::body::Release;
use equipoise_physics::bounce::rebound::Rebound;
use equipoise_physics::bounce::rod::Rod;
use equipoise_physics::bounce::state::State;
use equipoise_physics::bounce::strike::Strike;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::rules::{Rules, SPEED_LIMIT};
use equipoise_physics::run::settling::{SETTLED_SHARE, stay, time_to_rest};

use crate::integrators::motion::Motion;
use crate::integrators::simulation::{SimulatedImpact, SimulationEnding, WorkCount};

/// Why a method stops.
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
    pub(crate) rod: Rod,
    pub(crate) release: Release,
    pub(crate) impacts: Vec<SimulatedImpact>,
    pub(crate) work: WorkCount,
    rules: Rules,
    wanted: u64,
    most_steps: u64,
    go_on: &'a mut dyn FnMut() -> bool,
    /// The flights before the last contact, s; 0 until there are some.
    first_flight: f64,
    last_flight: f64,
    /// How the contact point left the last contact.
    rebound: Rebound,
}

impl<'a> SimulationRun<'a> {
    pub(crate) fn new(
        rod: Rod,
        rules: Rules,
        release: Release,
        wanted: u64,
        most_steps: u64,
        go_on: &'a mut dyn FnMut() -> bool,
    ) -> Self {
        Self {
            rod,
            release,
            impacts: Vec::new(),
            work: WorkCount::default(),
            rules,
            wanted,
            most_steps,
            go_on,
            first_flight: 0.0,
            last_flight: 0.0,
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

    /// A contact: records it and gives the strike. The checks are those of [`equipoise_physics::run::orbit::Orbit::advance`], in the same order; that the flight
    /// before was too short is known only here, and ends the run at the contact before.
    pub(crate) fn contact(&mut self, t: f64, motion: &Motion) -> Result<Strike, Halt> {
        self.settle(t)?;
        let contacts = self.impacts.len() as u64;
        if contacts >= self.wanted {
            return Err(Ending::Completed.into());
        }
        let state = motion.state();
        self.impacts.push(SimulatedImpact { n: contacts + 1, t, x: motion.place[0], state });
        if state.theta.abs() >= self.rules.topple_angle {
            return Err(Ending::Toppled { theta: state.theta, limit: self.rules.topple_angle }.into());
        }
        let strike = self.rod.strike(&state);
        if strike.push >= 0.0 {
            return Err(Ending::Separating { approach: strike.approach }.into());
        }
        Ok(strike)
    }

    /// After a contact: whether there can be a flight.
    pub(crate) fn leave(&mut self, state: &State, rebound: Rebound) -> Result<(), Halt> {
        let spin = self.rod.contact_distance * state.theta_dot;
        let speed_squared = state.x_dot * state.x_dot + state.y_dot * state.y_dot + spin * spin;
        if speed_squared.is_nan() || speed_squared > SPEED_LIMIT * SPEED_LIMIT {
            return Err(Ending::Diverged { speed: speed_squared.sqrt() }.into());
        }
        if !rebound.rises() {
            let t = self.impacts.last().map_or(0.0, |impact| impact.t);
            return Err(stay(&rebound, self.rules.settles, t).into());
        }
        self.rebound = rebound;
        // Where a run can settle, the flight after its last contact decides too.
        if !self.rules.settles && self.impacts.len() as u64 >= self.wanted {
            return Err(Ending::Completed.into());
        }
        Ok(())
    }

    /// A contact without duration: [`SimulationRun::contact`] and [`SimulationRun::leave`], and the velocities changed.
    pub(crate) fn strike(&mut self, t: f64, motion: &mut Motion) -> Result<Strike, Halt> {
        let strike = self.contact(t, motion)?;
        self.leave(&strike.after, self.rebound_of(&strike, motion))?;
        motion.velocity = [strike.after.x_dot, strike.after.y_dot, strike.after.theta_dot];
        Ok(strike)
    }

    /// How the contact point leaves a contact without duration.
    pub(crate) fn rebound_of(&self, strike: &Strike, before: &Motion) -> Rebound {
        strike.rebound(self.rod.contact_distance, strike.rise_rounding(before.velocity[1], f64::EPSILON))
    }

    fn settle(&mut self, t: f64) -> Result<(), Halt> {
        let Some(before) = self.impacts.last().filter(|_| self.rules.settles) else { return Ok(()) };
        let flight_time = t - before.t;
        if self.first_flight == 0.0 {
            self.first_flight = flight_time;
        }
        if flight_time < SETTLED_SHARE * self.first_flight && self.rebound.is_slow() {
            let settle_time = before.t + time_to_rest(flight_time, self.last_flight);
            return Err(Ending::Settled { flight_time, settle_time }.into());
        }
        self.last_flight = flight_time;
        Ok(())
    }
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
