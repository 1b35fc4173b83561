//! The map with 31 digits: the reference that everything faster is held against, and the method of last resort.
//!
//! The formulas are those of the map itself ([`crate::bounce::strike`], [`crate::bounce::flight`]) in double-double numbers, and so are the
//! parameters, from the fields of the scene on. Which root of a flight is the next contact is decided in doubles, with the
//! certificate of [`crate::bounce::contact_time`]; the root is then lifted by Newton's iteration. Endings are decided in doubles too.

mod body;
mod contact_time;

use crate::body::{Arrival, NoContact, PreImpact, Release, Touch};
use crate::bounce::rebound::Rebound;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::bounce::table_motion::PlannedTableMotion;
use crate::numbers::double_double::{DoubleDouble, ROUNDING};
use crate::numbers::number::Number;
use crate::run::ending::Ending;
use crate::run::orbit::{Contact, ContactByContact, visit_contacts};
use crate::run::rules;
use crate::run::rules::{Checked, FlightTimes, Rules};
use crate::table::actuator_load::{ActuatorLoad, Pose};
use contact_time::first_contact;

pub use body::ExtendedBody;

/// One contact of a run with 31 digits.
pub type ExtendedContact = Contact<DoubleDouble>;

/// A run that is computed contact by contact with 31 digits.
#[derive(Clone, Copy, Debug)]
pub struct ExtendedOrbit {
    body: ExtendedBody,
    rules: Rules,
    state: State<DoubleDouble>,
    clearance: DoubleDouble,
    plan: Option<PlannedTableMotion<DoubleDouble>>,
    n: u64,
    t: DoubleDouble,
    x: DoubleDouble,
    flights: FlightTimes,
    energy: Option<DoubleDouble>,
    /// The last strike, where the table is limited.
    last: Option<Pose>,
}

impl ExtendedOrbit {
    /// A run from its release, with 31 digits.
    ///
    /// # Errors
    /// The reason if there is not even a first contact.
    pub fn new(body: ExtendedBody, rules: Rules, release: &Release) -> Result<Self, NoContact> {
        let zero = DoubleDouble::from_f64(0.0);
        let arrival = body.fall(release)?;
        let mut orbit = Self {
            body,
            rules,
            state: arrival.state,
            clearance: zero,
            plan: None,
            n: 0,
            t: zero,
            x: release.x.into(),
            flights: FlightTimes::default(),
            energy: None,
            last: None,
        };
        orbit.arrive(&arrival);
        Ok(orbit)
    }

    /// Angle and velocities just before the coming contact.
    pub fn state(&self) -> &State<DoubleDouble> {
        &self.state
    }

    /// Time of the coming contact, s after release.
    pub fn t(&self) -> DoubleDouble {
        self.t
    }

    /// Horizontal place of the centre of gravity at the coming contact, m.
    pub fn x(&self) -> DoubleDouble {
        self.x
    }

    /// Body that bounces; its parameters are those of a rod of no length where it is a point mass.
    pub fn rod(&self) -> &Rod<DoubleDouble> {
        &self.body.lifted.rod
    }

    /// Energy per unit mass ½|v|² + Gy at a contact, m²/s².
    pub fn energy(&self, state: &State<DoubleDouble>) -> DoubleDouble {
        let spin = self.body.lifted.rod.radius_of_gyration * state.theta_dot;
        let speed_squared = state.x_dot * state.x_dot + state.y_dot * state.y_dot + spin * spin;
        DoubleDouble::from(0.5) * speed_squared
            + self.body.lifted.rod.gravity * self.body.lifted.rod.contact_distance * state.theta.sincos().1
    }

    /// ẏ_c = ẏ + l θ̇ sin θ, vertical velocity of the contact point, m/s.
    pub fn contact_speed(&self, state: &State<DoubleDouble>) -> DoubleDouble {
        state.y_dot + self.body.lifted.rod.contact_distance * state.theta_dot * state.theta.sincos().0
    }

    /// The coming contact. After one with an ending, call it no more: the state stays that of the last contact.
    pub fn advance(&mut self) -> ExtendedContact {
        self.n += 1;
        let Self { n, x, state, clearance, plan, rules, .. } = *self;
        let coming = PreImpact { n, x, state, clearance, plan };
        let strike = self.body.strike(&coming);
        let mut contact = ExtendedContact {
            n,
            t: self.t,
            x,
            state,
            clearance,
            alpha: strike.alpha,
            strike: None,
            flight_time: None,
            ending: None,
        };
        let mut here = ExtendedAtContact {
            orbit: self,
            state,
            strike,
            speed_squared: 0.0,
            no_contact: None,
            flight_time: f64::INFINITY,
        };
        if let Some(ending) = rules::before_strike(&mut here) {
            contact.ending = Some(ending);
            return contact;
        }
        if rules.holds_energy {
            let energy = here.orbit.energy.unwrap_or(here.strike.energy);
            here.orbit.energy = Some(here.orbit.body.lifted.rod.hold_energy(&mut here.strike, energy));
        }
        let strike = here.strike;
        contact.strike = Some(strike);
        let spin = (here.orbit.body.lifted.rod.contact_distance * strike.after.theta_dot).to_f64();
        here.speed_squared = rules::speed_squared(strike.after.x_dot.to_f64(), strike.after.y_dot.to_f64(), spin);
        if let Some(ending) = rules::after_strike(&mut here) {
            contact.ending = Some(ending);
            return contact;
        }
        let flight = here.orbit.body.fly(&coming, &strike);
        match &flight {
            Ok(arrival) => here.flight_time = arrival.t.to_f64(),
            Err(no_contact) => here.no_contact = Some(*no_contact),
        }
        if let Some(ending) = rules::after_flight(&mut here) {
            contact.ending = Some(ending);
            return contact;
        }
        if let Ok(arrival) = flight {
            contact.flight_time = Some(arrival.t);
            self.flights.last = arrival.t.to_f64();
            self.arrive(&arrival);
        }
        contact
    }

    fn arrive(&mut self, arrival: &Arrival<DoubleDouble>) {
        let Arrival { t, state, clearance, plan, .. } = *arrival;
        self.t = self.t + t;
        self.x = self.x + arrival.way();
        (self.state, self.clearance, self.plan) = (state, clearance, plan);
    }
}

/// A run with 31 digits at a contact.
struct ExtendedAtContact<'a> {
    orbit: &'a mut ExtendedOrbit,
    state: State<DoubleDouble>,
    strike: Strike<DoubleDouble>,
    /// Same as [`rules::speed_squared`], from the strike on.
    speed_squared: f64,
    /// Reason for which the flight meets no table, if there is one.
    no_contact: Option<NoContact>,
    /// Length of the flight, s, from its end on; infinite without a next contact.
    flight_time: f64,
}

impl Checked for ExtendedAtContact<'_> {
    fn rules(&self) -> &Rules {
        &self.orbit.rules
    }

    fn t(&self) -> f64 {
        self.orbit.t.to_f64()
    }

    fn touch(&self) -> Option<Touch> {
        self.orbit.body.touches(self.state.theta, self.strike.alpha)
    }

    fn contact_place(&self) -> f64 {
        (self.orbit.x + self.orbit.body.lifted.rod.contact_distance * self.strike.sin_cos_theta.0).to_f64()
    }

    fn load(&mut self) -> ActuatorLoad {
        let (x, y) = self.strike.table_velocity;
        let pose = Pose { alpha: self.strike.alpha.to_f64(), velocity: (x.to_f64(), y.to_f64()) };
        pose.load(self.orbit.last.replace(pose).map(|last| (last, self.orbit.flights.last)))
    }

    fn theta(&self) -> f64 {
        self.state.theta.to_f64()
    }

    fn push(&self) -> f64 {
        self.strike.push.to_f64()
    }

    fn approach(&self) -> f64 {
        self.strike.approach.to_f64()
    }

    fn speed_squared(&self) -> f64 {
        self.speed_squared
    }

    fn contact_rise(&self) -> f64 {
        self.strike.contact_rise.to_f64()
    }

    fn rise_rounding(&self) -> f64 {
        self.orbit.body.rise_rounding(&self.state, &self.strike)
    }

    fn rebound(&self) -> Rebound {
        self.strike.rebound(self.orbit.body.lifted.rod.contact_distance, self.rise_rounding())
    }

    fn no_contact(&self) -> Option<NoContact> {
        self.no_contact
    }

    fn flight_time(&self) -> f64 {
        self.flight_time
    }

    fn flights(&mut self) -> &mut FlightTimes {
        &mut self.orbit.flights
    }

    fn time_after(&self, seconds: f64) -> f64 {
        (self.orbit.t + DoubleDouble::from(seconds)).to_f64()
    }
}

impl ContactByContact for ExtendedOrbit {
    type Number = DoubleDouble;

    fn next_contact(&mut self) -> ExtendedContact {
        self.advance()
    }
}

/// Visits contact after contact up to number `impacts`, as [`crate::run::orbit::run`].
pub fn run(orbit: &mut ExtendedOrbit, impacts: u64, mut visit: impl FnMut(&ExtendedContact) -> bool) -> Option<Ending> {
    visit_contacts(orbit, impacts, &mut visit)
}

/// A state in doubles.
pub fn in_doubles(state: &State<DoubleDouble>) -> State {
    state.map(DoubleDouble::to_f64)
}

/// One bounce from a state just before a contact: the length of the flight, s, and the state at its end. `None` if there is
/// no strike or no next contact.
pub fn bounce(rod: &Rod<DoubleDouble>, state: &State<DoubleDouble>) -> Option<(DoubleDouble, State<DoubleDouble>)> {
    let strike = rod.strike(state);
    let flies = strike.push.to_f64() < 0.0 && strike.rises(state.y_dot, ROUNDING);
    let flight = rod.flight(&strike);
    let t = flies.then(|| first_contact(&flight).ok())??;
    Some((t, flight.end(t)))
}
