//! One bounce of a body: how it falls, is struck and flies to its next contact.
//!
//! All of it is in any kind of number; branches and roots are decided in doubles. The plain rod's strike and flight are [`Rod::strike`] and
//! [`Rod::flight`]: its loop has nothing else in it ([`crate::run::orbit`]).

use crate::map::body::{Arrival, Body, NoContact, PreImpact, Release, Touch};
use crate::map::contact_time::{first_contact, first_contact_from_rest, first_descent};
use crate::map::flight::Flight;
use crate::map::friction;
use crate::map::friction::{Decision, Friction, actual_branch};
use crate::map::strike::{PlannedTableMotion, Rod, State, Strike, SurfaceMotion, TableMotion, Tilt};
use crate::map::table::control_law::{Steering, own_motion};
use crate::map::table::noise::{ContactErrors, NoiseModel, NoiseSample};
use crate::map::table::pivot::TurningTable;
use crate::numbers::number::{Arithmetic, Number};

/// Least time, s, from one strike to the next: a table that is timed too early strikes then.
pub const LEAST_FLIGHT: f64 = 1e-6;

/// Chooses the motion of a guided table, contact by contact.
pub trait Guide<N = f64> {
    /// Motion for the contact that the table foresees, with an error of the sensed angle (rad); `None` if it will not strike.
    fn motion(&mut self, seen: &PreImpact<N>, angle_error: f64) -> Option<PlannedTableMotion<N>>;

    /// True if the table stays with the body after this strike.
    fn stays(&self, strike: &Strike<N>) -> bool;
}

/// A contact as its table sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenContact<N> {
    /// The rod, with the energy that the table aims at from the height of the contact.
    rod: Rod<N>,
    errors: ContactErrors<N>,
    /// The motion that the table has planned or plans now, if it does.
    plan: Option<PlannedTableMotion<N>>,
}

impl<N: Arithmetic> Body<N> {
    /// Tells whether its strikes depend on its place.
    pub fn depends_on_place(&self) -> bool {
        matches!(self.steering, Steering::Feedback(_)) || self.turning.as_ref().is_some_and(TurningTable::strikes)
    }

    /// A contact as its table sees it, at a place (m), state and height (m), by the rod of this strike and errors.
    #[inline(always)]
    pub(crate) fn seen_with(
        &self,
        rod: Rod<N>,
        errors: ContactErrors<N>,
        (x, state, clearance): (N, &State<N>, N),
        plan: Option<PlannedTableMotion<N>>,
    ) -> SeenContact<N> {
        // The energy of a bounce counts from the height of its contact.
        let rod = Rod { target_energy: rod.target_energy - rod.gravity * clearance, ..rod };
        let plan = match plan {
            Some(plan) => Some(plan),
            None => self.sensed_motion(&errors, &rod, x, state, None),
        };
        SeenContact { rod, errors, plan }
    }

    #[inline(always)]
    pub(crate) fn tilt_of(&self, x: N, state: &State<N>, seen: &SeenContact<N>) -> Tilt<N> {
        let (alpha, beta) = match &seen.plan {
            Some(plan) => (plan.alpha, state.theta - plan.alpha),
            None => self.steering.angles(&self.rod, x, state, seen.errors.angle, self.constant_tilt),
        };
        Tilt::new(state.theta, alpha, beta)
    }

    /// The strike of a contact over a table at this tilt; `leverage` is [`Rod::leverage`].
    #[inline(always)]
    pub(crate) fn strike_of(
        &self,
        x: N,
        state: &State<N>,
        seen: &SeenContact<N>,
        tilt: &Tilt<N>,
        leverage: N,
        decide: impl FnMut(Decision<N>) -> N::Mask,
    ) -> Strike<N> {
        // Its table does not know of a restitution that scatters.
        let rod = match seen.errors.restitution {
            Some(restitution) => seen.rod.meeting(restitution),
            None => seen.rod,
        };
        let surface = match &self.turning {
            Some(turning) if seen.plan.is_none() => {
                let contact = x + rod.contact_distance * tilt.sin_theta;
                Some(turning.surface(self.tilt_rate(&rod, state), contact, tilt))
            }
            Some(_) | None => None,
        };
        let motion = match (&seen.plan, &surface) {
            (Some(plan), _) if self.turning.is_some() => TableMotion::Sensed(plan),
            (Some(plan), _) => TableMotion::Planned(plan),
            (None, Some(surface)) => TableMotion::Turning(surface),
            (None, None) => TableMotion::ByLaw,
        };
        strike_moving(self.friction.as_ref(), &rod, state, tilt, motion, leverage, decide)
    }

    /// Tilt rate of a table that follows its law up to a state of a flight, rad/s.
    #[inline(always)]
    pub(crate) fn tilt_rate(&self, rod: &Rod<N>, state: &State<N>) -> N {
        let State { x_dot, y_dot, theta_dot, .. } = *state;
        let mut turn = theta_dot;
        if self.is_point {
            // Gravity and wind turn the velocity, and what still air takes is along it.
            let speed_squared = x_dot * x_dot + y_dot * y_dot;
            let rests = speed_squared.is_zero();
            let mut pull = rod.gravity * x_dot;
            if let Some(drag) = &self.drag {
                pull = pull + drag.push() * y_dot;
            }
            turn = N::select(rests, speed_squared, -(pull / speed_squared));
        }
        self.steering.tilt_rate(rod, state, turn, self.drag.as_ref())
    }

    /// Motion of a table that plans `flown` s after the flight began, with the state that it foresees, for the rod at this strike.
    #[inline(always)]
    pub(crate) fn plan_with(
        &self,
        rod: &Rod<N>,
        errors: &ContactErrors<N>,
        x: N,
        seen: &State<N>,
        flown: N,
    ) -> PlannedTableMotion<N> {
        match self.sensed_motion(errors, rod, x, seen, Some(flown)) {
            Some(motion) => motion,
            None => {
                let (alpha, beta) = self.steering.angles(&self.rod, x, seen, errors.angle, self.constant_tilt);
                own_motion(rod, self.friction.as_ref(), seen, &Tilt::new(seen.theta, alpha, beta))
            }
        }
    }

    /// Tells where a flight of `flown` s is too short for the table to sense in it as long before the strike as it does.
    #[inline(always)]
    pub(crate) fn senses_late_in(&self, flown: N, horizon: N) -> N::Mask {
        flown.is_less(self.lag) | flown.is_less(horizon)
    }
}

impl<N: Number> Body<N> {
    /// The strike of a contact whose friction takes the branches that `decide` chooses.
    #[inline(always)]
    pub(crate) fn strike_deciding(
        &self,
        coming: &PreImpact<N>,
        decide: impl FnMut(Decision<N>) -> N::Mask,
    ) -> Strike<N> {
        let PreImpact { x, state, .. } = coming;
        let seen = self.seen(coming);
        let tilt = self.tilt_of(*x, state, &seen);
        self.strike_of(*x, state, &seen, &tilt, self.rod.leverage(), decide)
    }

    #[inline(always)]
    fn seen(&self, coming: &PreImpact<N>) -> SeenContact<N> {
        let PreImpact { n, x, ref state, clearance, plan } = *coming;
        self.seen_with(self.at_strike(n), self.errors(n), (x, state, clearance), plan)
    }

    /// Motion of a table that plans for contact `n`, `flown` s after the flight began, with the state that it foresees, its angle sensed with an
    /// error (rad).
    pub(crate) fn planned_motion(&self, n: u64, x: N, seen: &State<N>, error: f64, flown: N) -> PlannedTableMotion<N> {
        let errors = ContactErrors { angle: N::from_f64(error), ..self.errors(n) };
        self.plan_with(&self.at_strike(n), &errors, x, seen, flown)
    }

    /// The motion of the table for contact `n` after a flight of `flown` s with its contact point `clearance` (m) above y = 0, if that flight is
    /// shorter than the time from sensing to the strike.
    pub(crate) fn late_motion(
        &self,
        n: u64,
        x: N,
        state: &State<N>,
        clearance: N,
        flown: N,
    ) -> Option<PlannedTableMotion<N>> {
        let horizon = N::from_f64(self.noise.map_or(0.0, |noise| noise.horizon));
        if !self.senses_late_in(flown, horizon) {
            return None;
        }
        let rod = self.at_strike(n);
        let seen = Rod { target_energy: rod.target_energy - rod.gravity * clearance, ..rod };
        self.sensed_motion(&self.errors(n), &seen, x, state, Some(flown))
    }

    #[inline(always)]
    pub(crate) fn at_strike(&self, n: u64) -> Rod<N> {
        match &self.program {
            Some(program) => program.applied(&self.rod, n),
            None => self.rod,
        }
    }

    #[inline(always)]
    pub(crate) fn errors(&self, n: u64) -> ContactErrors<N> {
        match &self.noise {
            Some(noise) => noise.errors(n, self.rod.restitution),
            None => ContactErrors::none(),
        }
    }

    fn draw(&self, n: u64) -> NoiseSample {
        self.noise.map_or(NoiseSample { timing: 0.0, angle: 0.0 }, |noise| noise.draw(n))
    }
}

/// The later of a time and [`LEAST_FLIGHT`], s.
fn not_too_early<N: Number>(t: N) -> N {
    if t.to_f64() < LEAST_FLIGHT { N::from_f64(LEAST_FLIGHT) } else { t }
}

/// A flight from a place `x` (m) towards contact `n`, whose contact point is at y = 0 after a time `t` (s).
pub(crate) struct Approach<N> {
    pub(crate) flight: Flight<N>,
    pub(crate) t: N,
    pub(crate) n: u64,
    pub(crate) x: N,
}

impl<N: Number> Body<N> {
    /// The first contact, with the table of a guide or with the body's own without one; at t = 0 if it is on the table already and does not rise.
    pub fn fall_to(&self, release: &Release<N>, guide: Option<&mut dyn Guide<N>>) -> Result<Arrival<N>, NoContact> {
        let flight = Flight { drag: self.drag, ..self.rod.flight_from(release) };
        let t = first_contact_from_rest(&flight)?;
        self.arrive(&Approach { flight, t, n: 1, x: release.x }, guide)
    }

    /// [`Body::fly`] to the table of a guide, or to the body's own without one.
    pub fn fly_to(
        &self,
        from: &PreImpact<N>,
        strike: &Strike<N>,
        guide: Option<&mut dyn Guide<N>>,
    ) -> Result<Arrival<N>, NoContact> {
        let flight = Flight { clearance: from.clearance, drag: self.drag, ..self.rod.flight(strike) };
        let is_below = from.clearance.to_f64() < 0.0;
        let t = if is_below { first_descent(&flight)?.ok_or(NoContact::Sinking)? } else { first_contact(&flight)? };
        self.arrive(&Approach { flight, t, n: from.n + 1, x: from.x }, guide)
    }

    /// The contact that ends a flight. A guided table asks `guide` for its motion.
    pub(crate) fn arrive(
        &self,
        approach: &Approach<N>,
        guide: Option<&mut dyn Guide<N>>,
    ) -> Result<Arrival<N>, NoContact> {
        let mut arrival = self.meet_timed(approach, guide)?;
        if self.is_point {
            arrival.state = Self::point_state(arrival.state.x_dot, arrival.state.y_dot);
        }
        if let Some(outline) = &self.outline {
            let until = approach.t.to_f64().min(arrival.t.to_f64());
            if let Some(touch) = outline.first_touch(&approach.flight.map(N::to_f64), until)? {
                return Err(NoContact::OtherVertex(touch));
            }
        }
        Ok(arrival)
    }

    /// The contact after `from`, whose flight takes `flight_time` (s) at its value; `None` where another vertex comes first.
    pub fn pass(&self, from: &PreImpact<N>, flight_time: f64) -> Option<PreImpact<N>> {
        self.land(from, &self.strike(from), flight_time)
    }

    /// The same after this strike of `from`.
    pub(crate) fn land(&self, from: &PreImpact<N>, strike: &Strike<N>, flight_time: f64) -> Option<PreImpact<N>> {
        let flight = Flight { clearance: from.clearance, drag: self.drag, ..self.rod.flight(strike) };
        let approach = Approach { t: flight.lift_root(flight_time), flight, n: from.n + 1, x: from.x };
        let Arrival { state, clearance, plan, way, .. } = self.arrive(&approach, None).ok()?;
        Some(PreImpact { n: from.n + 1, x: from.x + way, state, clearance, plan })
    }

    /// End of a flight at a table that strikes about the time when the contact point is at y = 0.
    fn meet_timed(&self, approach: &Approach<N>, guide: Option<&mut dyn Guide<N>>) -> Result<Arrival<N>, NoContact> {
        let Approach { ref flight, t, n, x } = *approach;
        let NoiseSample { timing, angle } = self.draw(n);
        let arrival = if timing == 0.0 {
            Arrival::at(flight, t)
        } else {
            let struck = not_too_early(t + N::from_f64(timing));
            Arrival { clearance: flight.gap(struck).value, ..Arrival::at(flight, struck) }
        };
        let Arrival { t: struck, mut state, clearance, way, .. } = arrival;
        if self.is_point {
            state = Self::point_state(state.x_dot, state.y_dot);
        }
        let x = x + way;
        let is_guided = guide.is_some();
        let guided = guide.and_then(|guide| guide.motion(&PreImpact { n, x, state, clearance, plan: None }, angle));
        match self.noise.map(|noise| noise.model) {
            None | Some(NoiseModel::Strike) => {
                let late = || self.late_motion(n, x, &state, clearance, struck);
                Ok(Arrival { plan: guided.or_else(late), ..arrival })
            }
            // A guide that does not plan follows the body.
            Some(NoiseModel::Plan) if is_guided && guided.is_none() => Ok(Arrival::at(flight, t)),
            Some(NoiseModel::Plan) => {
                let plan = guided.unwrap_or_else(|| self.planned_motion(n, x, &state, angle, struck));
                match Self::meet(flight, struck, &state, plan) {
                    // Released onto the table: it is on the plane, whatever was planned for later.
                    Err(NoContact::Missed) if t.to_f64() == 0.0 => Ok(Arrival::at(flight, N::from_f64(LEAST_FLIGHT))),
                    met => met,
                }
            }
        }
    }

    /// End of a flight at the table that was set out to strike at time `struck` the state `seen`, with its contact at y = 0.
    fn meet(
        flight: &Flight<N>,
        struck: N,
        seen: &State<N>,
        plan: PlannedTableMotion<N>,
    ) -> Result<Arrival<N>, NoContact> {
        let relative = plan.relative(flight, struck, seen);
        if relative.gravity.to_f64() <= 0.0 {
            return Err(NoContact::Missed);
        }
        let t = not_too_early(first_descent(&relative)?.ok_or(NoContact::Missed)?);
        Ok(Arrival { clearance: flight.gap(t).value, plan: Some(plan), ..Arrival::at(flight, t) })
    }

    /// The strike at a contact.
    // Too large for the loop that it is called from; likewise below.
    #[inline(never)]
    pub fn strike(&self, coming: &PreImpact<N>) -> Strike<N> {
        self.strike_deciding(coming, actual_branch)
    }

    /// Another vertex that is below the table's line at a strike.
    #[inline(never)]
    pub fn touches(&self, coming: &PreImpact<N>, strike: &Strike<N>) -> Option<Touch> {
        let nearest = self.outline.as_ref()?.below_table((coming.state.theta - strike.alpha).to_f64())?;
        Some(Touch { vertex: nearest.vertex, t: 0.0 })
    }

    /// Size of a rise of the contact point after a strike that is rounding, m/s.
    #[inline(always)]
    pub fn rise_rounding(&self, before: &State<N>, strike: &Strike<N>) -> f64 {
        match self.friction {
            Some(_) => friction::rise_rounding(&self.rod, before, strike, N::UNIT),
            None => strike.rise_rounding(before.y_dot, N::UNIT),
        }
    }

    /// The flight after the strike of a contact.
    #[inline(never)]
    pub fn fly(&self, from: &PreImpact<N>, strike: &Strike<N>) -> Result<Arrival<N>, NoContact> {
        self.fly_to(from, strike, None)
    }

    /// The state of a point mass with these velocities, m/s, just before a contact.
    pub fn point_state(x_dot: N, y_dot: N) -> State<N> {
        State { theta: N::angle_of(x_dot, -y_dot), x_dot, y_dot, theta_dot: N::from_f64(0.0) }
    }

    /// Height of the centre of gravity above that of the contact point, m.
    pub fn contact_height(&self, state: &State<N>) -> N {
        if self.is_point { N::from_f64(0.0) } else { self.rod.contact_distance * state.theta.sincos().1 }
    }

    /// Energy per unit mass ½|v|² + Gy with the contact point at y = 0, m²/s².
    pub fn energy(&self, state: &State<N>) -> N {
        self.rod.energy(state)
    }

    /// Vertical velocity of the contact point, m/s.
    pub fn contact_speed(&self, state: &State<N>) -> N {
        if self.is_point { state.y_dot } else { self.rod.contact_speed(state) }
    }
}

/// The strike of a rod over a table tilted and moving like this, with friction or without.
#[inline(always)]
fn strike_moving<N: Arithmetic>(
    friction: Option<&Friction<N>>,
    rod: &Rod<N>,
    before: &State<N>,
    tilt: &Tilt<N>,
    motion: TableMotion<'_, N>,
    leverage: N,
    decide: impl FnMut(Decision<N>) -> N::Mask,
) -> Strike<N> {
    match (friction, motion) {
        (None, TableMotion::ByLaw) => rod.strike_with(before, tilt, leverage),
        (None, TableMotion::Turning(SurfaceMotion { normal: None, tangential, .. })) => {
            let strike = rod.strike_with(before, tilt, leverage);
            let (x, y) = strike.table_velocity;
            let table_velocity = (x + *tangential * tilt.cos_alpha, y + *tangential * tilt.sin_alpha);
            Strike { table_velocity, ..strike }
        }
        (friction, motion) => {
            let smooth = Friction::smooth();
            let friction = friction.unwrap_or(&smooth);
            friction.strike(rod, before, tilt, motion, leverage, decide)
        }
    }
}

impl<N: Number> Rod<N> {
    /// The flight that begins at a release.
    pub fn flight_from(&self, release: &Release<N>) -> Flight<N> {
        let start = release.state;
        let sin_cos_theta = start.theta.sincos();
        let height = self.contact_distance * sin_cos_theta.1;
        let clearance = release.height - height;
        // A height typed as l cos θ means a contact, whatever the last digit.
        let typed = 4.0 * f64::EPSILON * release.height.to_f64().abs().max(height.to_f64().abs());
        Flight {
            start,
            sin_cos_theta,
            clearance: if clearance.to_f64() <= typed { N::from_f64(0.0) } else { clearance },
            contact_distance: self.contact_distance,
            gravity: self.gravity,
            drag: None,
        }
    }
}
