//! From contact to contact: strike, flight, and the reasons for which a run ends.
//!
//! Not here: what is recorded of a run, and which body it is; both come from outside.

use crate::contact_time::{self, TooManyPieces};
use crate::dispatch::{Work, dispatch};
use crate::flight::Flight;
use crate::impact::{Rod, State, Strike};
use crate::outcome::Outcome;

/// Fastest speed, m/s, of the centre of gravity or of the contact point about it, that a run may reach: beyond it
/// doubles no longer resolve a flight, and only a wrong energy feedback gets there.
pub const SPEED_LIMIT: f64 = 1e6;

/// A run that loses energy has settled (Zeno) when a flight is shorter than this share of its first.
pub const SETTLED_SHARE: f64 = 1e-9;

/// What starts a run: a free body at t = 0, before its first contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Release {
    /// Horizontal place of the centre of gravity, m.
    pub x: f64,
    /// Height of the centre of gravity, m.
    pub height: f64,
    /// Angle and velocities.
    pub state: State,
}

/// Velocities that something else than the table gives a body, just after a strike.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kick {
    /// Added to the horizontal velocity, m/s.
    pub x_dot: f64,
    /// Added to the vertical velocity, m/s.
    pub y_dot: f64,
    /// Added to the angular velocity, rad/s.
    pub theta_dot: f64,
}

/// A body that bounces: its strike and its flights.
pub trait Body: Copy {
    /// Time of the first contact (0 if it is on the table already and does not rise), and the state just before it.
    ///
    /// # Errors
    /// [`TooManyPieces`] where the contact time passed its work limit; likewise in [`Body::fly`].
    fn fall(&self, release: &Release) -> Result<(f64, State), TooManyPieces>;

    /// The strike at a contact.
    fn strike(&self, before: &State) -> Strike;

    /// Keeps rounding off the energy of a strike: as [`Rod::hold_energy`].
    fn hold_energy(&self, strike: &mut Strike, energy: f64) -> f64;

    /// Length of the flight after a strike, s, and the state at its end.
    ///
    /// # Errors
    /// As [`Body::fall`].
    fn fly(&self, strike: &Strike) -> Result<(f64, State), TooManyPieces>;

    /// l, m: how far the contact point is from the centre of gravity.
    fn contact_distance(&self) -> f64;

    /// Height of the centre of gravity at a contact, m.
    fn contact_height(&self, state: &State) -> f64;

    /// Energy per unit mass ½|v|² + Gy at a contact, m²/s².
    fn energy(&self, state: &State) -> f64;

    /// Vertical velocity of the contact point, m/s.
    fn contact_speed(&self, state: &State) -> f64;
}

impl Body for Rod {
    fn fall(&self, release: &Release) -> Result<(f64, State), TooManyPieces> {
        let sin_cos_theta = crate::trig::sin_cos(release.state.theta);
        let height = self.contact_distance * sin_cos_theta.1;
        let clearance = release.height - height;
        // A height typed as l cos θ means a contact, whatever the last digit.
        let clearance =
            if clearance <= 4.0 * f64::EPSILON * release.height.abs().max(height.abs()) { 0.0 } else { clearance };
        let flight = Flight {
            start: release.state,
            sin_cos_theta,
            clearance,
            contact_distance: self.contact_distance,
            gravity: self.gravity,
        };
        let gap = flight.gap(0.0);
        if clearance == 0.0 && (gap.slope < 0.0 || (gap.slope == 0.0 && gap.bend <= 0.0)) {
            return Ok((0.0, release.state));
        }
        let t = contact_time::first_contact(&flight)?;
        Ok((t, flight.end(t)))
    }

    #[inline(always)]
    fn strike(&self, before: &State) -> Strike {
        Rod::strike(self, before)
    }

    #[inline(always)]
    fn hold_energy(&self, strike: &mut Strike, energy: f64) -> f64 {
        Rod::hold_energy(self, strike, energy)
    }

    #[inline(always)]
    fn fly(&self, strike: &Strike) -> Result<(f64, State), TooManyPieces> {
        let flight = self.flight(strike);
        let t = contact_time::first_contact(&flight)?;
        Ok((t, flight.end(t)))
    }

    fn contact_distance(&self) -> f64 {
        self.contact_distance
    }

    fn contact_height(&self, state: &State) -> f64 {
        self.contact_distance * crate::trig::sin_cos(state.theta).1
    }

    fn energy(&self, state: &State) -> f64 {
        Rod::energy(self, state)
    }

    fn contact_speed(&self, state: &State) -> f64 {
        Rod::contact_speed(self, state)
    }
}

/// Why a run ended, with the number that decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ending {
    /// |θ| reached the topple angle; both in rad.
    Toppled {
        /// θ at the contact.
        theta: f64,
        /// The topple angle.
        limit: f64,
    },
    /// The contact point does not approach the moving table: it could only pull.
    Separating {
        /// Velocity relative to the table along its normal, m/s, ≥ 0.
        approach: f64,
    },
    /// The contact point does not rise after the strike, so there is no next contact from above.
    Sinking {
        /// Its vertical velocity after the strike, m/s, ≤ 0.
        contact_rise: f64,
    },
    /// Flights have shrunk to nothing (Zeno).
    Settled {
        /// The flight that was too short, s.
        flight_time: f64,
        /// When it comes to rest, s, from the geometric tail of its flights.
        settle_time: f64,
    },
    /// A speed passed [`SPEED_LIMIT`], or the next contact could not be found within its work limit.
    Diverged {
        /// The larger of the speeds, m/s; not finite where the arithmetic overflowed.
        speed: f64,
    },
    /// It went on to the last contact asked for.
    Completed,
}

impl Ending {
    /// Its name in answers.
    pub fn name(self) -> &'static str {
        Outcome::from(self).name()
    }
}

/// What decides, beside the physics, when a run ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// |θ| at which a contact counts as toppled, rad; infinite for a body without an angle.
    pub topple_angle: f64,
    /// Whether the strikes lose energy for good, so that a run can settle.
    pub settles: bool,
    /// Whether rounding is kept off the energy ([`Orbit`]); not where a settling run loses it to G l (1 − cos θ).
    pub holds_energy: bool,
}

impl Rules {
    /// The map alone: nothing but what the physics itself forbids ends a run, and nothing is corrected.
    pub const BARE_MAP: Self = Self { topple_angle: f64::INFINITY, settles: false, holds_energy: false };
}

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
    /// The strike, unless the run ended before it.
    pub strike: Option<Strike>,
    /// Time to the next contact, s; none where the run ended.
    pub flight_time: Option<f64>,
    /// Why the run ended here, if it did.
    pub ending: Option<Ending>,
}

/// A sum of many terms that keeps what rounding would lose (Neumaier's form is not needed: the terms are smaller).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sum {
    value: f64,
    lost: f64,
}

impl Sum {
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
    n: u64,
    t: Sum,
    x: Sum,
    /// Of those that shrink, s; 0 until there is one.
    first_flight: f64,
    last_flight: f64,
    /// Energy that the run should have at the coming contact; known from its first one.
    energy: Option<f64>,
}

impl<B: Body> Orbit<B> {
    /// A run from its release.
    ///
    /// # Errors
    /// [`TooManyPieces`] where not even the first contact can be found within the work limit; the ranges of a scene
    /// exclude it.
    pub fn new(body: B, rules: Rules, release: &Release) -> Result<Self, TooManyPieces> {
        let (t, state) = body.fall(release)?;
        let mut orbit = Self::at(body, rules, state);
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
            n: 0,
            t: Sum::default(),
            x: Sum::default(),
            first_flight: 0.0,
            last_flight: 0.0,
            energy: None,
        }
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
        let state = self.state;
        let mut contact = Contact {
            n: self.n,
            t: self.t.value,
            x: self.x.value,
            state,
            strike: None,
            flight_time: None,
            ending: None,
        };
        if state.theta.abs() >= self.rules.topple_angle {
            contact.ending = Some(Ending::Toppled { theta: state.theta, limit: self.rules.topple_angle });
            return contact;
        }
        let mut strike = self.body.strike(&state);
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
        if strike.contact_rise <= 0.0 {
            contact.ending = Some(Ending::Sinking { contact_rise: strike.contact_rise });
            return contact;
        }
        let Ok((flight_time, next)) = self.body.fly(&strike) else {
            contact.ending = Some(Ending::Diverged { speed: speed_squared.sqrt() });
            return contact;
        };
        if self.rules.settles {
            if let Some(ending) = self.settle(flight_time) {
                contact.ending = Some(ending);
                return contact;
            }
            self.last_flight = flight_time;
        }
        contact.flight_time = Some(flight_time);
        self.t.add(flight_time);
        self.x.add(next.x_dot * flight_time);
        self.state = next;
        contact
    }

    fn settle(&mut self, flight_time: f64) -> Option<Ending> {
        if self.first_flight == 0.0 {
            self.first_flight = flight_time;
        }
        (flight_time < SETTLED_SHARE * self.first_flight).then(|| {
            let ratio = flight_time / self.last_flight;
            Ending::Settled { flight_time, settle_time: self.t.value + flight_time / (1.0 - ratio) }
        })
    }
}

/// One contact in the midst of a run, with the energy that it should have there, and the flight after it: the state just
/// before the next contact and the energy there, or why the run ends.
pub(crate) fn contact(body: Rod, rules: Rules, state: State, energy: f64) -> Result<(State, f64), Ending> {
    let mut orbit = Orbit { energy: Some(energy), ..Orbit::at(body, rules, state) };
    match orbit.advance().ending {
        None => Ok((orbit.state, orbit.energy.unwrap_or(energy))),
        Some(ending) => Err(ending),
    }
}

/// Visits contact after contact up to number `impacts`, which ends as [`Ending::Completed`] unless it ended otherwise;
/// the visitor may stop it early by returning `false`, and then there is no ending.
pub fn run<B: Body>(orbit: &mut Orbit<B>, impacts: u64, visit: impl FnMut(&Contact) -> bool) -> Option<Ending> {
    dispatch(Run { orbit, impacts, visit })
}

struct Run<'a, B, V> {
    orbit: &'a mut Orbit<B>,
    impacts: u64,
    visit: V,
}

impl<B: Body, V: FnMut(&Contact) -> bool> Work for Run<'_, B, V> {
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

impl<N: crate::number::Number> Rod<N> {
    /// The flight that follows a strike.
    #[inline(always)]
    pub fn flight(&self, strike: &Strike<N>) -> Flight<N> {
        Flight {
            start: strike.after,
            sin_cos_theta: strike.sin_cos_theta,
            clearance: N::from_f64(0.0),
            contact_distance: self.contact_distance,
            gravity: self.gravity,
        }
    }
}
