//! From contact to contact: strike, flight, and the reasons for which a run ends.
//!
//! Not here: what is recorded of a run, and which body it is; both come from outside.

use crate::body::{Arrival, Body, Kick, NoContact, PreImpact, Release};
use crate::bounce::rebound::Rebound;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::bounce::table_motion::PlannedTableMotion;
use crate::numbers::dispatch::{Kernel, dispatch};
use crate::run::ending::Ending;
use crate::run::rules::{Rules, SPEED_LIMIT};
use crate::run::settling::{SETTLED_SHARE, stay, time_to_rest};
use crate::table::actuator_load::Pose;

/// One contact of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Its number, from 1.
    pub n: u64,
    /// When, s after release.
    pub t: f64,
    /// Where the centre of gravity is, m.
    pub x: f64,
    /// Angle and velocities just before it.
    pub state: State,
    /// Height of the contact point above y = 0, m: 0 unless the table strikes early or late.
    pub clearance: f64,
    /// α, table tilt, rad; of a table that does not strike too.
    pub alpha: f64,
    /// The strike, unless the run ended before it.
    pub strike: Option<Strike>,
    /// Time to the next contact, s; none where the run ended.
    pub flight_time: Option<f64>,
    /// Why the run ended here, if it did.
    pub ending: Option<Ending>,
}

/// A sum of many terms that keeps what rounding would lose (Neumaier's form is not needed: the terms are smaller).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct CompensatedSum {
    value: f64,
    lost: f64,
}

impl CompensatedSum {
    #[inline(always)]
    fn add(&mut self, term: f64) {
        let term = term - self.lost;
        let next = self.value + term;
        self.lost = (next - self.value) - term;
        self.value = next;
    }
}

/// A run that is computed contact by contact.
#[derive(Clone, Copy, Debug)]
pub struct Orbit<B> {
    /// What bounces.
    pub body: B,
    rules: Rules,
    /// Just before the coming contact.
    state: State,
    clearance: f64,
    plan: Option<PlannedTableMotion>,
    n: u64,
    t: CompensatedSum,
    x: CompensatedSum,
    /// Of a run that can settle, s; 0 until there is one.
    first_flight: f64,
    /// s; 0 until there is one.
    last_flight: f64,
    /// Energy that the run should have at the coming contact; known from its first one.
    energy: Option<f64>,
    /// The last strike, where the table is limited.
    last: Option<Pose>,
}

impl<B: Body> Orbit<B> {
    /// A run from its release.
    ///
    /// # Errors
    /// Why there is not even a first contact.
    pub fn new(body: B, rules: Rules, release: &Release) -> Result<Self, NoContact> {
        let Arrival { t, state, clearance, plan } = body.fall(release)?;
        let mut orbit = Self { clearance, plan, ..Self::at(body, rules, state) };
        orbit.t.add(t);
        orbit.x.add(release.x);
        orbit.x.add(state.x_dot * t);
        Ok(orbit)
    }

    /// A run from a state just before its first contact, at t = 0 and x = 0.
    pub fn at(body: B, rules: Rules, state: State) -> Self {
        Self {
            body,
            rules,
            state,
            clearance: 0.0,
            plan: None,
            n: 0,
            t: CompensatedSum::default(),
            x: CompensatedSum::default(),
            first_flight: 0.0,
            last_flight: 0.0,
            energy: None,
            last: None,
        }
    }

    /// The same run, `x` (m) farther on.
    #[must_use]
    pub fn moved(mut self, x: f64) -> Self {
        self.x.add(x);
        self
    }

    /// Angle and velocities just before the coming contact.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// When the coming contact is, s after release.
    pub fn t(&self) -> f64 {
        self.t.value
    }

    /// Where the centre of gravity is at the coming contact, m.
    pub fn x(&self) -> f64 {
        self.x.value
    }

    /// How many contacts have been.
    pub fn contacts(&self) -> u64 {
        self.n
    }

    /// The coming contact. After one with an ending, call it no more: the state stays that of the last contact.
    #[inline(always)]
    pub fn advance(&mut self) -> Contact {
        self.advance_disturbed(|_, _| ())
    }

    /// [`Orbit::advance`] with a kick between the strike and the flight: `strike.after` is with it.
    pub fn advance_kicked(&mut self, kick: Kick) -> Contact {
        self.advance_disturbed(|orbit, strike| {
            strike.after.x_dot += kick.x_dot;
            strike.after.y_dot += kick.y_dot;
            strike.after.theta_dot += kick.theta_dot;
            strike.contact_rise += kick.y_dot + orbit.body.contact_distance() * kick.theta_dot * strike.sin_cos_theta.0;
            // What the kick gave is known only from the coming contact.
            orbit.energy = None;
        })
    }

    /// Goes on with another table or restitution from the coming contact on. Lengths and gravity have to stay: the flight
    /// to that contact has been computed with them.
    pub fn replace(&mut self, body: B, rules: Rules) {
        (self.body, self.rules) = (body, rules);
        self.energy = None;
        if !rules.settles {
            self.first_flight = 0.0;
        }
    }

    #[inline(always)]
    fn advance_disturbed(&mut self, disturb: impl FnOnce(&mut Self, &mut Strike)) -> Contact {
        self.n += 1;
        let Self { n, state, clearance, plan, .. } = *self;
        let coming = PreImpact { n, x: self.x.value, state, clearance, plan };
        let mut strike = self.body.strike(&coming);
        let mut contact = Contact {
            n,
            t: self.t.value,
            x: coming.x,
            state,
            clearance,
            alpha: strike.alpha,
            strike: None,
            flight_time: None,
            ending: None,
        };
        if let Some(touch) = self.body.touches(&coming, &strike) {
            contact.ending = Some(Ending::OtherVertex(touch));
            return contact;
        }
        if state.theta.abs() >= self.rules.topple_angle {
            contact.ending = Some(Ending::Toppled { theta: state.theta, limit: self.rules.topple_angle });
            return contact;
        }
        if let Some(limits) = &self.rules.limits {
            let pose = Pose { alpha: strike.alpha, velocity: strike.table_velocity };
            let demand = pose.demand(self.last.replace(pose).map(|last| (last, self.last_flight)));
            if let Some(excess) = limits.exceeded(&demand) {
                contact.ending = Some(Ending::BeyondLimits(excess));
                return contact;
            }
        }
        if strike.push >= 0.0 {
            contact.ending = Some(Ending::Separating { approach: strike.approach });
            return contact;
        }
        if self.rules.holds_energy {
            self.energy = Some({
                let energy = self.energy.unwrap_or(strike.energy);
                self.body.hold_energy(&mut strike, energy)
            });
        }
        disturb(self, &mut strike);
        contact.strike = Some(strike);
        let after = strike.after;
        let spin = self.body.contact_distance() * after.theta_dot;
        let speed_squared = after.x_dot * after.x_dot + after.y_dot * after.y_dot + spin * spin;
        if speed_squared.is_nan() || speed_squared > SPEED_LIMIT * SPEED_LIMIT {
            contact.ending = Some(Ending::Diverged { speed: speed_squared.sqrt() });
            return contact;
        }
        let rises = strike.contact_rise > self.body.rise_rounding(&state, &strike);
        if !rises {
            contact.ending = self.rebound(&contact).map(|rebound| stay(&rebound, self.rules.settles, contact.t));
            return contact;
        }
        let arrival = match self.body.fly(&coming, &strike) {
            Ok(arrival) => arrival,
            Err(none) => {
                contact.ending = Some(none.ending(strike.contact_rise, speed_squared.sqrt()));
                return contact;
            }
        };
        let flight_time = arrival.t;
        if self.rules.settles
            && self.is_short(flight_time)
            && self.rebound(&contact).is_some_and(|rebound| rebound.is_slow())
        {
            let settle_time = contact.t + time_to_rest(flight_time, self.last_flight);
            contact.ending = Some(Ending::Settled { flight_time, settle_time });
            return contact;
        }
        self.last_flight = flight_time;
        contact.flight_time = Some(flight_time);
        self.t.add(flight_time);
        self.x.add(arrival.state.x_dot * flight_time);
        (self.state, self.clearance, self.plan) = (arrival.state, arrival.clearance, arrival.plan);
        contact
    }

    /// Tells whether a flight of a run that can settle is too short beside the first.
    #[inline(always)]
    fn is_short(&mut self, flight_time: f64) -> bool {
        if self.first_flight == 0.0 {
            self.first_flight = flight_time;
        }
        flight_time < SETTLED_SHARE * self.first_flight
    }

    /// How the contact point leaves a contact, if there was a strike.
    #[cold]
    #[inline(never)]
    fn rebound(&self, contact: &Contact) -> Option<Rebound> {
        let strike = contact.strike.as_ref()?;
        let rounding = self.body.rise_rounding(&contact.state, strike);
        Some(strike.rebound(self.body.contact_distance(), rounding))
    }
}

/// A run between two contacts, as lanes keep it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneRunState {
    /// Just before the coming contact.
    pub(crate) state: State,
    /// Energy that the run should have there, m²/s².
    pub(crate) energy: f64,
    /// As in [`Orbit`], s.
    pub(crate) first_flight: f64,
}

impl LaneRunState {
    /// One contact and the flight after it, or why the run ends.
    pub(crate) fn advance<B: Body>(self, body: B, rules: Rules) -> Result<Self, Ending> {
        let Self { state, energy, first_flight } = self;
        let mut orbit = Orbit { energy: Some(energy), first_flight, ..Orbit::at(body, rules, state) };
        let ending = orbit.advance().ending;
        let Orbit { state, first_flight, .. } = orbit;
        ending.map_or(Ok(Self { state, energy: orbit.energy.unwrap_or(energy), first_flight }), Err)
    }
}

/// Visits contact after contact up to number `impacts`, which ends as [`Ending::Completed`] unless it ended otherwise;
/// the visitor may stop it early by returning `false`, and then there is no ending.
pub fn run<B: Body>(orbit: &mut Orbit<B>, impacts: u64, visit: impl FnMut(&Contact) -> bool) -> Option<Ending> {
    dispatch(RunLoop { orbit, impacts, visit })
}

struct RunLoop<'a, B, V> {
    orbit: &'a mut Orbit<B>,
    impacts: u64,
    visit: V,
}

impl<B: Body, V: FnMut(&Contact) -> bool> Kernel for RunLoop<'_, B, V> {
    type Output = Option<Ending>;

    #[inline(always)]
    fn call(mut self) -> Self::Output {
        loop {
            let mut contact = self.orbit.advance();
            if contact.ending.is_none() && contact.n >= self.impacts {
                contact.ending = Some(Ending::Completed);
                contact.flight_time = None;
            }
            if !(self.visit)(&contact) {
                return None;
            }
            if contact.ending.is_some() {
                return contact.ending;
            }
        }
    }
}
