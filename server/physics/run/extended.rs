//! The map with 31 digits: the reference that everything faster is held against, and the method of last resort.
//!
//! The formulas are those of the map itself ([`crate::bounce::strike`], [`crate::bounce::flight`]) in double-double numbers, and so are the
//! parameters, from the fields of the scene on. Which root of a flight is the next contact is decided in doubles, with the
//! certificate of [`crate::bounce::contact_time`]; the root is then lifted by Newton's iteration.

use crate::body::{NoContact, Release, Touch};
use crate::bounce::contact_time::TooManyPieces;
use crate::bounce::flight::Flight;
use crate::bounce::friction::Friction;
use crate::bounce::rebound::Rebound;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::bounce::{contact_time, friction};
use crate::numbers::double_double::{DoubleDouble, ROUNDING};
use crate::numbers::number::Number;
use crate::numbers::trig;
use crate::run::ending::Ending;
use crate::run::orbit::{Contact, ContactByContact, visit_contacts};
use crate::run::rules;
use crate::run::rules::{Checked, FlightTimes, Rules};
use crate::table::actuator_load::ActuatorLoad;
use crate::table::program::HeightProgram;

/// Most Newton steps of a lift: one does, except where the rod grazes the table.
const MAX_STEPS: u32 = 64;

/// Share of a root below which what a Newton step leaves out no longer counts.
const NEGLIGIBLE: f64 = 1e-33;

/// One contact of a run with 31 digits.
pub type ExtendedContact = Contact<DoubleDouble>;

/// A run that is computed contact by contact with 31 digits.
#[derive(Clone, Copy, Debug)]
pub struct ExtendedOrbit {
    rod: Rod<DoubleDouble>,
    program: Option<HeightProgram>,
    friction: Option<Friction>,
    is_point: bool,
    rules: Rules,
    state: State<DoubleDouble>,
    n: u64,
    t: DoubleDouble,
    x: DoubleDouble,
    flights: FlightTimes,
    energy: Option<DoubleDouble>,
}

impl ExtendedOrbit {
    /// A run from its release, with 31 digits.
    ///
    /// # Errors
    /// [`TooManyPieces`], which the ranges of a scene exclude.
    pub fn new(
        rod: Rod<DoubleDouble>,
        program: Option<HeightProgram>,
        friction: Option<Friction>,
        is_point: bool,
        rules: Rules,
        release: &Release,
    ) -> Result<Self, TooManyPieces> {
        let zero = DoubleDouble::from_f64(0.0);
        let mut orbit = Self {
            rod,
            program,
            friction,
            is_point,
            rules,
            state: release.state.map(DoubleDouble::from),
            n: 0,
            t: zero,
            x: release.x.into(),
            flights: FlightTimes::default(),
            energy: None,
        };
        let (sin, cos) = orbit.state.theta.sincos();
        let height = orbit.rod.contact_distance * cos;
        let clearance = DoubleDouble::from_f64(release.height) - height;
        // As in doubles: a height typed as l cos θ means a contact.
        let typed = 4.0 * f64::EPSILON * f64::max(release.height.abs(), height.to_f64().abs());
        let flight = Flight {
            start: orbit.state,
            sin_cos_theta: (sin, cos),
            clearance: if clearance.to_f64() <= typed { zero } else { clearance },
            contact_distance: orbit.rod.contact_distance,
            gravity: orbit.rod.gravity,
        };
        let gap = flight.gap(zero);
        let falls = gap.slope < zero || (gap.slope == zero && gap.bend <= zero);
        if flight.clearance == zero && falls {
            orbit.arrive(zero, orbit.state);
        } else {
            let t = first_contact(&flight)?;
            orbit.arrive(t, flight.end(t));
        }
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
        &self.rod
    }

    /// Energy per unit mass ½|v|² + Gy at a contact, m²/s².
    pub fn energy(&self, state: &State<DoubleDouble>) -> DoubleDouble {
        let spin = self.rod.radius_of_gyration * state.theta_dot;
        let speed_squared = state.x_dot * state.x_dot + state.y_dot * state.y_dot + spin * spin;
        DoubleDouble::from(0.5) * speed_squared + self.rod.gravity * self.rod.contact_distance * state.theta.sincos().1
    }

    /// ẏ_c = ẏ + l θ̇ sin θ, vertical velocity of the contact point, m/s.
    pub fn contact_speed(&self, state: &State<DoubleDouble>) -> DoubleDouble {
        state.y_dot + self.rod.contact_distance * state.theta_dot * state.theta.sincos().0
    }

    /// The coming contact. After one with an ending, call it no more: the state stays that of the last contact.
    pub fn advance(&mut self) -> ExtendedContact {
        self.n += 1;
        let Self { state, rules, .. } = *self;
        let rod = self.program.map_or(self.rod, |program| program.applied(&self.rod, self.n));
        let strike = match self.friction {
            None => rod.strike(&state),
            Some(friction) => friction.strike_by_tilt_gain(&rod, &state),
        };
        let mut contact = ExtendedContact {
            n: self.n,
            t: self.t,
            x: self.x,
            state,
            clearance: DoubleDouble::from_f64(0.0),
            alpha: strike.alpha,
            strike: None,
            flight_time: None,
            ending: None,
        };
        let mut here = ExtendedAtContact { orbit: self, state, strike, speed_squared: 0.0, flight_time: None };
        if let Some(ending) = rules::before_strike(&mut here) {
            contact.ending = Some(ending);
            return contact;
        }
        if rules.holds_energy {
            let energy = here.orbit.energy.unwrap_or(here.strike.energy);
            here.orbit.energy = Some(here.orbit.rod.hold_energy(&mut here.strike, energy));
        }
        let strike = here.strike;
        contact.strike = Some(strike);
        let spin = (here.orbit.rod.contact_distance * strike.after.theta_dot).to_f64();
        here.speed_squared = rules::speed_squared(strike.after.x_dot.to_f64(), strike.after.y_dot.to_f64(), spin);
        if let Some(ending) = rules::after_strike(&mut here) {
            contact.ending = Some(ending);
            return contact;
        }
        let flight = here.orbit.rod.flight(&strike);
        here.flight_time = first_contact(&flight).ok();
        let flight_time = here.flight_time;
        if let Some(ending) = rules::after_flight(&mut here) {
            contact.ending = Some(ending);
            return contact;
        }
        if let Some(t) = flight_time {
            contact.flight_time = Some(t);
            self.flights.last = t.to_f64();
            self.arrive(t, flight.end(t));
        }
        contact
    }

    fn arrive(&mut self, t: DoubleDouble, state: State<DoubleDouble>) {
        self.t = self.t + t;
        self.x = self.x + state.x_dot * t;
        self.state = if self.is_point { State { theta: fall_angle(&state), ..state } } else { state };
    }
}

/// A run with 31 digits at a contact.
struct ExtendedAtContact<'a> {
    orbit: &'a mut ExtendedOrbit,
    state: State<DoubleDouble>,
    strike: Strike<DoubleDouble>,
    /// Same as [`rules::speed_squared`], from the strike on.
    speed_squared: f64,
    /// Length of the flight, s, from its end on; `None` if it passed its work limit.
    flight_time: Option<DoubleDouble>,
}

impl Checked for ExtendedAtContact<'_> {
    fn rules(&self) -> &Rules {
        &self.orbit.rules
    }

    fn t(&self) -> f64 {
        self.orbit.t.to_f64()
    }

    // No scene with further vertices or with limits is run with 31 digits (`crate::run::method`).
    fn touch(&self) -> Option<Touch> {
        None
    }

    fn load(&mut self) -> ActuatorLoad {
        ActuatorLoad::default()
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
        match self.orbit.friction {
            None => self.strike.rise_rounding(self.state.y_dot, ROUNDING),
            Some(_) => friction::rise_rounding(&self.orbit.rod, &self.state, &self.strike, ROUNDING),
        }
    }

    fn rebound(&self) -> Rebound {
        self.strike.rebound(self.orbit.rod.contact_distance, self.rise_rounding())
    }

    fn no_contact(&self) -> Option<NoContact> {
        self.flight_time.is_none().then_some(NoContact::TooManyPieces)
    }

    /// Infinite without a next contact.
    fn flight_time(&self) -> f64 {
        self.flight_time.map_or(f64::INFINITY, DoubleDouble::to_f64)
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

/// The length of a flight: the root certified in doubles, lifted.
fn first_contact(flight: &Flight<DoubleDouble>) -> Result<DoubleDouble, TooManyPieces> {
    let start = in_doubles(&flight.start);
    let mut rounded = Flight {
        start,
        sin_cos_theta: (flight.sin_cos_theta.0.to_f64(), flight.sin_cos_theta.1.to_f64()),
        clearance: flight.clearance.to_f64(),
        contact_distance: flight.contact_distance.to_f64(),
        gravity: flight.gravity.to_f64(),
    };
    let root = match short_flight(flight, &mut rounded) {
        Some(root) => root,
        None => contact_time::first_contact(&rounded)?,
    };
    let mut t = DoubleDouble::from_f64(root);
    let mut last = f64::INFINITY;
    for _ in 0..MAX_STEPS {
        let gap = flight.gap(t);
        let step = gap.value / gap.slope;
        let size = step.to_f64().abs();
        // Steps that shrink no more have met rounding, or a graze that doubles see and these digits do not.
        if size.is_nan() || size >= last {
            break;
        }
        // The second derivative too (Chebyshev): its term is so small that doubles hold it. What that leaves out is of third
        // order in the step.
        let bent = 0.5 * step.to_f64() * gap.bend.to_f64() / gap.slope.to_f64();
        let next = t - (step + DoubleDouble::from(step.to_f64() * bent));
        // The trivial root at the start is no contact.
        if next.to_f64() <= 0.0 {
            break;
        }
        t = next;
        let stiffness = (rounded.gravity + rounded.bulge()) / gap.slope.to_f64().abs() + start.theta_dot.abs();
        if size * (size * stiffness) * (size * stiffness) <= NEGLIGIBLE * root {
            break;
        }
        last = size;
    }
    Ok(t)
}

/// Largest share of the rise that doubles may miss where the root is looked for in them.
const RESOLVED: f64 = 0.01;

/// The length of a flight that rises too slowly for doubles, whose sum ẏ + lθ̇ sin θ is rounding: 2ẏ_c/(G − lθ̇² cos θ), where that is
/// so short that the gap is concave all the way, so that it has no other root. Where it is not, the contact point goes on rising, and
/// `rounded` is made to rise.
fn short_flight(flight: &Flight<DoubleDouble>, rounded: &mut Flight) -> Option<f64> {
    if rounded.clearance != 0.0 {
        return None;
    }
    let State { y_dot, theta_dot, .. } = flight.start;
    let rise = (y_dot + flight.contact_distance * theta_dot * flight.sin_cos_theta.0).to_f64();
    let State { y_dot, theta_dot, .. } = rounded.start;
    let turned = rounded.contact_distance * theta_dot * rounded.sin_cos_theta.0;
    let missed = (y_dot + turned - rise).abs();
    if rise <= 0.0 || missed <= RESOLVED * rise {
        return None;
    }
    let bend = rounded.gravity - rounded.bulge() * rounded.sin_cos_theta.1;
    let root = 2.0 * rise / bend;
    if bend > 0.0 && 10.0 * rounded.bulge() * theta_dot.abs() * root <= bend {
        return Some(root);
    }
    rounded.start.y_dot += 4.0 * f64::EPSILON * (y_dot.abs() + turned.abs());
    None
}

/// The angle of a velocity from straight down, rad: that in doubles, turned by the little that is left. Its square is lost.
fn fall_angle(state: &State<DoubleDouble>) -> DoubleDouble {
    let State { x_dot, y_dot, .. } = *state;
    if x_dot == DoubleDouble::from_f64(0.0) && y_dot == x_dot {
        return x_dot;
    }
    let angle = DoubleDouble::from_f64(trig::atan2(x_dot.to_f64(), -y_dot.to_f64()));
    let (sin, cos) = angle.sincos();
    angle + (x_dot * cos + y_dot * sin) / (x_dot * sin - y_dot * cos)
}
