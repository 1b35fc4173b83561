//! From contact to contact: strike, flight, and the reasons for which a run ends.

use crate::map::body::{Arrival, Body, Kick, NoContact, PreImpact, Release};
use crate::map::bounce::Guide;
use crate::map::contact_time::first_contact;
use crate::map::strike::{PlannedTableMotion, Rebound, State, Strike};
use crate::map::table::actuator_load::Pose;
use crate::numbers::compensated_sum::CompensatedSum;
use crate::numbers::dispatch::{Kernel, Vector, dispatch, portable};
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::number::Number;
use crate::run::ending::Ending;
use crate::run::rules;
use crate::run::rules::{FlightTimes, Rules};

/// One contact of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<N = f64> {
    /// Number of the contact, from 1.
    pub n: u64,
    /// Time, s after release.
    pub t: N,
    /// Horizontal place of the centre of gravity, m.
    pub x: N,
    /// Angle and velocities just before it.
    pub state: State<N>,
    /// Height of the contact point above y = 0, m: 0 unless the table strikes early or late.
    pub clearance: N,
    /// α, table tilt, rad; of a table that does not strike too.
    pub alpha: N,
    /// The strike, unless the run ended before it.
    pub strike: Option<Strike<N>>,
    /// Time to the next contact, s; `None` if the run ended.
    pub flight_time: Option<N>,
    /// Ending of the run, if it ended here.
    pub ending: Option<Ending>,
}

mapped!(Contact: t, x, clearance, alpha; parts state; maybe strike; optional flight_time; same n, ending);

/// A coming contact of a run, and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComingContact {
    /// Time of the run, s.
    pub t: f64,
    /// The contact.
    pub coming: PreImpact,
    /// The table at the strike before, and the flight since then, s, if there was one.
    pub before: Option<(Pose, f64)>,
}

/// One contact of a run with 31 digits.
pub type ExtendedContact = Contact<DoubleDouble>;

/// A run with 31 digits: the reference that everything faster is held against, and the method of last resort.
/// Parameters have as many digits, from the fields on. Roots, endings, branches and touches are decided in doubles.
pub type ExtendedOrbit = Orbit<DoubleDouble>;

/// A run that is computed contact by contact.
#[derive(Clone, Copy, Debug)]
pub struct Orbit<N: Number = f64> {
    /// Body that bounces.
    pub body: Body<N>,
    rules: Rules,
    state: State<N>,
    clearance: N,
    plan: Option<PlannedTableMotion<N>>,
    n: u64,
    t: CompensatedSum<N>,
    x: CompensatedSum<N>,
    /// The first one is kept of runs that can settle only.
    flights: FlightTimes,
    /// Energy that the run should have at the coming contact; known from its first one.
    energy: Option<N>,
    last: Option<Pose>,
}

impl<N: Number> Orbit<N> {
    /// A run from its release.
    pub fn new(body: Body<N>, rules: Rules, release: &Release) -> Result<Self, NoContact> {
        Self::new_guided(body, rules, release, None)
    }

    /// [`Orbit::new`] whose table strikes by a guide, if there is one.
    pub fn new_guided(
        body: Body<N>,
        rules: Rules,
        release: &Release,
        guide: Option<&mut dyn Guide<N>>,
    ) -> Result<Self, NoContact> {
        let release = release.map(N::from_f64);
        let arrival = body.fall_to(&release, guide)?;
        let Arrival { t, state, clearance, plan, .. } = arrival;
        let mut x = CompensatedSum::of(release.x);
        x.add(arrival.way);
        Ok(Self { clearance, plan, t: CompensatedSum::of(t), x, ..Self::at(body, rules, state) })
    }

    /// A run from a state just before its first contact, at t = 0 and x = 0.
    pub fn at(body: Body<N>, rules: Rules, state: State<N>) -> Self {
        Self {
            body,
            rules,
            state,
            clearance: N::from_f64(0.0),
            plan: None,
            n: 0,
            t: CompensatedSum::of(N::from_f64(0.0)),
            x: CompensatedSum::of(N::from_f64(0.0)),
            flights: FlightTimes::default(),
            energy: None,
            last: None,
        }
    }

    /// The same run, `x` (m) farther on.
    #[must_use]
    pub fn moved(mut self, x: f64) -> Self {
        self.x.add(N::from_f64(x));
        self
    }

    /// Angle and velocities just before the coming contact.
    pub fn state(&self) -> &State<N> {
        &self.state
    }

    /// Time of the coming contact, s after release.
    pub fn t(&self) -> N {
        self.t.value
    }

    /// Horizontal place of the centre of gravity at the coming contact, m.
    pub fn x(&self) -> N {
        self.x.value
    }

    /// Number of contacts so far.
    pub fn contacts(&self) -> u64 {
        self.n
    }

    /// The coming contact with the strike that the table makes ready for. The run may still end there without one.
    pub fn foresee(&self) -> (PreImpact<N>, Strike<N>) {
        let coming = self.coming();
        (coming, self.body.strike(&coming))
    }

    /// The coming contact.
    pub fn coming(&self) -> PreImpact<N> {
        let Self { n, state, clearance, plan, .. } = *self;
        PreImpact { n: n + 1, x: self.x.value, state, clearance, plan }
    }

    /// The coming contact. After one with an ending, call it no more: the state stays that of the last contact.
    #[inline(always)]
    pub fn advance(&mut self) -> Contact<N> {
        self.advance_by::<false>(|_, _| (), None)
    }

    /// The contacts from here on, the last of them the one at which the run ends. A run that never ends has no last one.
    pub fn into_contacts(mut self) -> impl Iterator<Item = Contact<N>> {
        let mut over = false;
        std::iter::from_fn(move || {
            if over {
                return None;
            }
            let contact = self.advance();
            over = contact.ending.is_some();
            Some(contact)
        })
    }

    /// Goes on with another table or restitution. Lengths and gravity have to stay: the present flight came from them.
    pub fn replace(&mut self, body: Body<N>, rules: Rules) {
        (self.body, self.rules) = (body, rules);
        self.energy = None;
        if !rules.settles {
            self.flights.first = 0.0;
        }
    }

    /// Counts contacts that something else than the orbit has computed, and that no flight follows.
    pub fn stay(&mut self, contacts: u64) {
        self.n = contacts;
    }

    /// Goes on after a flight computed elsewhere: `contacts` contacts so far, the last one at `t` (s) and `x` (m).
    pub fn resume(&mut self, contacts: u64, t: N, x: N, arrival: &Arrival<N>) {
        (self.n, self.energy, self.last, self.flights.first) = (contacts, None, None, 0.0);
        (self.t, self.x) = (CompensatedSum::of(t), CompensatedSum::of(x));
        self.arrive(arrival);
    }

    /// [`Orbit::advance`] by a guide, which chooses the motion of the table for the contact after this one. The contact has neither an
    /// ending nor a flight if the table stays with the body.
    pub fn advance_guided(&mut self, guide: &mut dyn Guide<N>) -> Contact<N> {
        // One number each: a run that begins at any of its contacts goes on alike.
        (self.t, self.x) = (CompensatedSum::of(self.t.value), CompensatedSum::of(self.x.value));
        self.advance_by::<false>(|_, _| (), Some(guide))
    }

    /// [`Orbit::advance`] with a disturbance between the strike and the flight, and by a guide if there is one. `PLAIN` says that the body is a
    /// plain rod ([`Body::is_plain_rod`]): a loop that has any other part of a body in it takes a third longer.
    #[inline(always)]
    fn advance_by<const PLAIN: bool>(
        &mut self,
        disturb: impl FnOnce(&mut Self, &mut Strike<N>),
        guide: Option<&mut dyn Guide<N>>,
    ) -> Contact<N> {
        self.n += 1;
        let Self { n, state, clearance, plan, .. } = *self;
        let coming = PreImpact { n, x: self.x.value, state, clearance, plan };
        let mut strike = if PLAIN { self.body.rod.strike(&state) } else { self.body.strike(&coming) };
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
        let Self { body, rules, flights, last, .. } = self;
        contact.ending = rules.before_strike(
            state.theta.to_f64(),
            [strike.push.to_f64(), strike.approach.to_f64()],
            || if PLAIN { None } else { body.touches(&coming, &strike) },
            || (coming.x + body.rod.contact_distance * strike.sin_cos_theta.0).to_f64(),
            || {
                let (x, y) = strike.table_velocity;
                let pose = Pose { alpha: strike.alpha.to_f64(), velocity: (x.to_f64(), y.to_f64()) };
                pose.load(last.replace(pose).map(|last| (last, flights.last)))
            },
        );
        if contact.ending.is_some() {
            return contact;
        }
        if self.rules.holds_energy {
            let energy = self.energy.unwrap_or(strike.energy);
            self.energy = Some(self.body.rod.hold_energy(&mut strike, energy));
        }
        disturb(self, &mut strike);
        contact.strike = Some(strike);
        let Self { body, rules, flights, .. } = self;
        let after = strike.after;
        let spin = (body.rod.contact_distance * after.theta_dot).to_f64();
        let speed_squared = rules::speed_squared(after.x_dot.to_f64(), after.y_dot.to_f64(), spin);
        let rise = strike.contact_rise.to_f64();
        let rounding =
            if PLAIN { strike.rise_rounding(state.y_dot, N::UNIT) } else { body.rise_rounding(&state, &strike) };
        contact.ending =
            rules.after_strike(contact.t.to_f64(), speed_squared, [rise, rounding], || rebound(body, state, strike));
        if contact.ending.is_some() {
            return contact;
        }
        let flight = match guide {
            None if PLAIN => {
                let flight = body.rod.flight(&strike);
                first_contact(&flight).map(|t| Arrival::at(&flight, t)).map_err(NoContact::from)
            }
            None => body.fly(&coming, &strike),
            Some(guide) if guide.stays(&strike) => return contact,
            guide => body.fly_to(&coming, &strike, guide),
        };
        contact.ending = rules.after_flight(
            flight.map(|arrival| arrival.t.to_f64()),
            flights,
            [rise, speed_squared],
            || rebound(body, state, strike),
            |seconds| (contact.t + N::from_f64(seconds)).to_f64(),
        );
        if let (Ok(arrival), None) = (flight, contact.ending) {
            contact.flight_time = Some(arrival.t);
            self.arrive(&arrival);
        }
        contact
    }

    #[inline(always)]
    fn arrive(&mut self, arrival: &Arrival<N>) {
        self.flights.last = arrival.t.to_f64();
        self.t.add(arrival.t);
        self.x.add(arrival.way);
        (self.state, self.clearance, self.plan) = (arrival.state, arrival.clearance, arrival.plan);
    }
}

/// The rebound of the contact point from a strike. Takes copies, so that the loop keeps its own in registers.
#[cold]
#[inline(never)]
fn rebound<N: Number>(body: &Body<N>, before: State<N>, strike: Strike<N>) -> Rebound {
    strike.rebound(body.rod.contact_distance, body.rise_rounding(&before, &strike))
}

/// A run between two contacts, or many side by side, as lanes keep them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneRunState<N = f64> {
    /// Just before the coming contact.
    pub(crate) state: State<N>,
    /// Height of the contact point there, as in [`Arrival`], m.
    pub(crate) clearance: N,
    /// Horizontal place of the centre of gravity there, m.
    pub(crate) x: CompensatedSum<N>,
    /// Energy that the run should have there, m²/s².
    pub(crate) energy: N,
    /// Same as in [`FlightTimes`], s.
    pub(crate) first_flight: N,
    pub(crate) plan: Option<PlannedTableMotion<N>>,
    /// The last strike, where the table is limited.
    pub(crate) last: Pose<N>,
    /// The flight after it, s; 0 where there is none.
    pub(crate) last_flight: N,
}

mapped!(LaneRunState: clearance, energy, first_flight, last_flight; parts state, x, last; maybe plan);

impl Orbit {
    /// [`Orbit::advance`] with a kick between the strike and the flight: `strike.after` is with it.
    pub fn advance_kicked(&mut self, kick: Kick) -> Contact {
        let disturb = |orbit: &mut Self, strike: &mut Strike| {
            kick.disturb(strike, orbit.body.rod.contact_distance);
            // The energy after the kick is known only at the coming contact.
            orbit.energy = None;
        };
        self.advance_by::<false>(disturb, None)
    }

    pub(crate) fn lane_state(&self) -> LaneRunState {
        let energy = self.energy.unwrap_or_else(|| self.foresee().1.energy);
        let Self { state, clearance, x, plan, .. } = *self;
        let none = Pose { alpha: 0.0, velocity: (0.0, 0.0) };
        let (last, last_flight) = self.last.map_or((none, 0.0), |last| (last, self.flights.last));
        LaneRunState { state, clearance, x, energy, first_flight: self.flights.first, plan, last, last_flight }
    }

    /// Goes on where a lane has brought the run after so many contacts. Its time is not kept in lanes.
    pub(crate) fn set_lane_state(&mut self, contacts: u64, lane_state: &LaneRunState) {
        let LaneRunState { state, clearance, x, energy, first_flight, plan, last, last_flight } = *lane_state;
        (self.n, self.state, self.clearance, self.x, self.energy) = (contacts, state, clearance, x, Some(energy));
        self.plan = plan;
        self.last = (last_flight != 0.0).then_some(last);
        self.flights = FlightTimes { first: first_flight, last: last_flight };
    }

    /// A run under way, just before a contact.
    pub fn under_way(body: Body, rules: Rules, from: &ComingContact) -> Self {
        let ComingContact { t, coming: PreImpact { n, x, state, clearance, plan }, before } = *from;
        let (last, flight_time) = before.unzip();
        let flights = FlightTimes { first: 0.0, last: flight_time.unwrap_or(0.0) };
        let (t, x) = (CompensatedSum::of(t), CompensatedSum::of(x));
        Self { clearance, plan, n: n - 1, t, x, flights, last, ..Self::at(body, rules, state) }
    }

    /// Rules that end the run.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }
}

/// Visits contacts up to number `impacts` ([`Ending::Completed`]) or an earlier end; `None` if `visit` said `false`.
pub fn run<N: Number>(orbit: &mut Orbit<N>, impacts: u64, visit: impl FnMut(&Contact<N>) -> bool) -> Option<Ending> {
    // Other instructions would only take time to compile: more digits gain nothing by them, and any other body has a bounce that is a
    // function of its own.
    if !orbit.body.is_plain_rod() {
        portable(RunLoop::<_, _, false> { orbit, impacts, visit })
    } else if N::UNIT < f64::EPSILON {
        portable(RunLoop::<_, _, true> { orbit, impacts, visit })
    } else {
        dispatch(RunLoop::<_, _, true> { orbit, impacts, visit })
    }
}

struct RunLoop<'a, N: Number, V, const PLAIN: bool> {
    orbit: &'a mut Orbit<N>,
    impacts: u64,
    visit: V,
}

impl<N: Number, V: FnMut(&Contact<N>) -> bool, const PLAIN: bool> Kernel for RunLoop<'_, N, V, PLAIN> {
    type Output = Option<Ending>;

    #[inline(always)]
    fn call<P: Vector>(mut self) -> Self::Output {
        loop {
            let mut contact = self.orbit.advance_by::<PLAIN>(|_, _| (), None);
            if contact.ending.is_none()
                && let Some(ending) = rules::completed(contact.n, self.impacts)
            {
                (contact.ending, contact.flight_time) = (Some(ending), None);
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
