//! From contact to contact: strike, flight, and the reasons for which a run ends.
//!
//! Not here: what is recorded of a run, and which body it is; both come from outside.

use crate::map::body::{Arrival, Body, Kick, NoContact, PreImpact, Release};
use crate::map::bounce::Guide;
use crate::map::strike::{PlannedTableMotion, Rebound, State, Strike};
use crate::map::table::actuator_load::Pose;
use crate::numbers::compensated_sum::{CompensatedSum, MapNumber, RunningSum};
use crate::numbers::dispatch::{Kernel, Vector, dispatch, portable};
use crate::numbers::double_double::DoubleDouble;
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

/// A run with 31 digits: the reference that everything faster is held against, and the method of last resort. Its formulas are those of the map,
/// and its parameters have as many digits, from the fields of the scene on. Roots of a flight, endings, branches of friction and touches of other
/// vertices are decided in doubles.
pub type ExtendedOrbit = Orbit<DoubleDouble>;

/// A run that is computed contact by contact.
#[derive(Clone, Copy, Debug)]
pub struct Orbit<N: MapNumber = f64> {
    /// Body that bounces.
    pub body: Body<N>,
    rules: Rules,
    /// Just before the coming contact.
    state: State<N>,
    clearance: N,
    plan: Option<PlannedTableMotion<N>>,
    n: u64,
    t: <N as MapNumber>::Sum,
    x: <N as MapNumber>::Sum,
    /// The first one is kept of runs that can settle only.
    flights: FlightTimes,
    /// Energy that the run should have at the coming contact; known from its first one.
    energy: Option<N>,
    /// The last strike, where the table is limited.
    last: Option<Pose>,
}

impl<N: MapNumber> Orbit<N> {
    /// A run from its release.
    ///
    /// # Errors
    /// The reason if there is not even a first contact.
    pub fn new(body: Body<N>, rules: Rules, release: &Release) -> Result<Self, NoContact> {
        Self::new_guided(body, rules, release, None)
    }

    /// [`Orbit::new`] whose table strikes by a guide, if there is one.
    ///
    /// # Errors
    /// Same as [`Orbit::new`].
    pub fn new_guided(
        body: Body<N>,
        rules: Rules,
        release: &Release,
        guide: Option<&mut dyn Guide<N>>,
    ) -> Result<Self, NoContact> {
        let release = release.map(N::from_f64);
        let arrival = body.fall_to(&release, guide)?;
        let Arrival { t, state, clearance, plan, .. } = arrival;
        let mut orbit = Self { clearance, plan, ..Self::at(body, rules, state) };
        orbit.t.add(t);
        orbit.x.add(release.x);
        orbit.x.add(arrival.way);
        Ok(orbit)
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
            t: Default::default(),
            x: Default::default(),
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
        self.t.value()
    }

    /// Horizontal place of the centre of gravity at the coming contact, m.
    pub fn x(&self) -> N {
        self.x.value()
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
        PreImpact { n: n + 1, x: self.x.value(), state, clearance, plan }
    }

    /// The coming contact. After one with an ending, call it no more: the state stays that of the last contact.
    #[inline(always)]
    pub fn advance(&mut self) -> Contact<N> {
        self.advance_disturbed::<false>(|_, _| ())
    }

    /// Goes on with another table or restitution from the coming contact on. Lengths and gravity have to stay: the flight
    /// to that contact has been computed with them.
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

    /// Goes on from the end of a flight that something else than the orbit has computed: `contacts` contacts so far, the last one at
    /// `t` (s) and `x` (m).
    pub fn resume(&mut self, contacts: u64, t: N, x: N, arrival: &Arrival<N>) {
        (self.n, self.energy, self.last, self.flights.first) = (contacts, None, None, 0.0);
        (self.t, self.x) = (Default::default(), Default::default());
        self.t.add(t);
        self.x.add(x);
        self.arrive(arrival);
    }

    /// [`Orbit::advance`] by a guide, which chooses the motion of the table for the contact after this one. The contact has neither an
    /// ending nor a flight if the table stays with the body.
    pub fn advance_guided(&mut self, guide: &mut dyn Guide<N>) -> Contact<N> {
        // One number each: a run that begins at any of its contacts goes on alike.
        for sum in [&mut self.t, &mut self.x] {
            let value = sum.value();
            *sum = Default::default();
            sum.add(value);
        }
        self.advance_by::<false>(|_, _| (), Some(guide))
    }

    /// [`Orbit::advance`] with a disturbance between the strike and the flight. `PLAIN` says that the body is a plain rod
    /// ([`Body::is_plain_rod`]): a loop that has any other part of a body in it takes a third longer.
    #[inline(always)]
    pub(crate) fn advance_disturbed<const PLAIN: bool>(
        &mut self,
        disturb: impl FnOnce(&mut Self, &mut Strike<N>),
    ) -> Contact<N> {
        self.advance_by::<PLAIN>(disturb, None)
    }

    #[inline(always)]
    fn advance_by<const PLAIN: bool>(
        &mut self,
        disturb: impl FnOnce(&mut Self, &mut Strike<N>),
        guide: Option<&mut dyn Guide<N>>,
    ) -> Contact<N> {
        self.n += 1;
        let Self { n, state, clearance, plan, .. } = *self;
        let coming = PreImpact { n, x: self.x.value(), state, clearance, plan };
        let mut strike = if PLAIN { self.body.rod.strike(&state) } else { self.body.strike(&coming) };
        let mut contact = Contact {
            n,
            t: self.t.value(),
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
            // The strike, onto the energy that the run should have.
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
            None if PLAIN => body.rod.fly(&strike).map(Arrival::from).map_err(NoContact::from),
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
fn rebound<N: MapNumber>(body: &Body<N>, before: State<N>, strike: Strike<N>) -> Rebound {
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
    /// The motion that the table has planned for the coming contact, if it has.
    pub(crate) plan: Option<PlannedTableMotion<N>>,
    /// The last strike, where the table is limited, and the flight after it, s; 0 where there is none.
    pub(crate) last: (Pose<N>, N),
}

impl<N: Copy> LaneRunState<N> {
    /// The same in other numbers.
    pub(crate) fn map<M>(&self, function: impl Fn(N) -> M) -> LaneRunState<M> {
        let (last, time) = self.last;
        LaneRunState {
            state: self.state.map(&function),
            clearance: function(self.clearance),
            x: CompensatedSum { value: function(self.x.value), lost: function(self.x.lost) },
            energy: function(self.energy),
            first_flight: function(self.first_flight),
            plan: self.plan.map(|plan| plan.map(&function)),
            last: (last.map(&function), function(time)),
        }
    }

    /// Goes through its numbers with those of another; through a plan only where both have one.
    #[inline(always)]
    pub(crate) fn zip<M: Copy>(&mut self, other: &LaneRunState<M>, mut visit: impl FnMut(&mut N, M)) {
        let Self { state, clearance, x, energy, first_flight, plan, last: (last, time) } = self;
        state.zip(&other.state, &mut visit);
        visit(clearance, other.clearance);
        visit(&mut x.value, other.x.value);
        visit(&mut x.lost, other.x.lost);
        visit(energy, other.energy);
        visit(first_flight, other.first_flight);
        if let (Some(plan), Some(other)) = (plan, &other.plan) {
            plan.zip(other, &mut visit);
        }
        let (other_last, other_time) = &other.last;
        visit(&mut last.alpha, other_last.alpha);
        visit(&mut last.velocity.0, other_last.velocity.0);
        visit(&mut last.velocity.1, other_last.velocity.1);
        visit(time, *other_time);
    }
}

impl Orbit {
    /// [`Orbit::advance`] with a kick between the strike and the flight: `strike.after` is with it.
    pub fn advance_kicked(&mut self, kick: Kick) -> Contact {
        self.advance_disturbed::<false>(|orbit, strike| {
            kick.disturb(strike, orbit.body.rod.contact_distance);
            // The energy after the kick is known only at the coming contact.
            orbit.energy = None;
        })
    }

    /// The run as a lane keeps it.
    pub(crate) fn lane_state(&self) -> LaneRunState {
        let energy = self.energy.unwrap_or_else(|| self.foresee().1.energy);
        let Self { state, clearance, x, plan, .. } = *self;
        let last = self.last.map_or((Pose { alpha: 0.0, velocity: (0.0, 0.0) }, 0.0), |last| (last, self.flights.last));
        LaneRunState { state, clearance, x, energy, first_flight: self.flights.first, plan, last }
    }

    /// Goes on where a lane has brought the run after so many contacts. Its time is not kept in lanes.
    pub(crate) fn set_lane_state(&mut self, contacts: u64, lane_state: &LaneRunState) {
        let LaneRunState { state, clearance, x, energy, first_flight, plan, last: (last, time) } = *lane_state;
        (self.n, self.state, self.clearance, self.x, self.energy) = (contacts, state, clearance, x, Some(energy));
        self.plan = plan;
        self.last = (time != 0.0).then_some(last);
        self.flights = FlightTimes { first: first_flight, last: time };
    }

    /// A run under way, just before a contact.
    pub fn under_way(body: Body, rules: Rules, from: &ComingContact) -> Self {
        let ComingContact { t, coming: PreImpact { n, x, state, clearance, plan }, before } = *from;
        let (last, flight_time) = before.unzip();
        let mut orbit = Self { clearance, plan, n: n - 1, last, ..Self::at(body, rules, state) };
        orbit.flights.last = flight_time.unwrap_or(0.0);
        orbit.t.add(t);
        orbit.x.add(x);
        orbit
    }

    /// Rules that end the run.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }
}

/// Visits contact after contact up to number `impacts`, which ends as [`Ending::Completed`] unless it ended otherwise;
/// the visitor may stop it early by returning `false`, and then there is no ending.
pub fn run<N: MapNumber>(orbit: &mut Orbit<N>, impacts: u64, visit: impl FnMut(&Contact<N>) -> bool) -> Option<Ending> {
    if orbit.body.is_plain_rod() {
        dispatch(RunLoop::<_, _, true> { orbit, impacts, visit })
    } else {
        // Its bounce is a function of its own, so other instructions for the loop about it would only take time to compile.
        portable(RunLoop::<_, _, false> { orbit, impacts, visit })
    }
}

/// The loop over the contacts of a run.
struct RunLoop<'a, N: MapNumber, V, const PLAIN: bool> {
    orbit: &'a mut Orbit<N>,
    impacts: u64,
    visit: V,
}

impl<N: MapNumber, V: FnMut(&Contact<N>) -> bool, const PLAIN: bool> Kernel for RunLoop<'_, N, V, PLAIN> {
    type Output = Option<Ending>;

    #[inline(always)]
    fn call<P: Vector>(mut self) -> Self::Output {
        loop {
            let mut contact = self.orbit.advance_disturbed::<PLAIN>(|_, _| ());
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
