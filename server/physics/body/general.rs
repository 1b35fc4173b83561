//! The rod with all that a scene may ask beyond the plain one, each part only where it is asked for: state feedback, a turning table,
//! friction, noise, air that drags it, the outline of a polygon.
//!
//! A body of its own, so that the plain rod pays for none of it. Each part is another module's: [`crate::bounce::friction`],
//! [`crate::table::noise`], [`crate::bounce::drag`], [`crate::body::polygon`]; here they meet.

use crate::body::lifted::strike_moving;
use crate::body::polygon::Outline;
use crate::body::{Arrival, Body, NoContact, PreImpact, Release, Touch};
use crate::bounce::contact_time::{first_contact, first_descent};
use crate::bounce::drag::AirDrag;
use crate::bounce::flight::Flight;
use crate::bounce::friction;
use crate::bounce::friction::Friction;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::bounce::table_motion::{PlannedTableMotion, SurfaceMotion, TableMotion};
use crate::bounce::tilt::Tilt;
use crate::numbers::number::Number;
use crate::table::control_law::{Steering, own_motion};
use crate::table::noise::{Noise, NoiseModel, NoiseSample};
use crate::table::pivot::TurningTable;
use crate::table::program::HeightProgram;
use crate::table::sensing::SensingTable;

/// Least time, s, from one strike to the next: a table that is timed too early strikes then.
pub const LEAST_FLIGHT: f64 = 1e-6;

/// A rod with what a scene asks for beyond the plain one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralBody {
    /// The rod and its table without it.
    pub rod: Rod,
    /// Control law of the tilt.
    pub steering: Steering,
    /// Tilt of the table beside its law, rad ([`crate::table::errors`]).
    pub constant_tilt: f64,
    /// Turning of the table as it strikes.
    pub turning: Option<TurningTable>,
    /// Target heights of its strikes, where they differ.
    pub program: Option<HeightProgram>,
    /// Friction and a table that moves along itself.
    pub friction: Option<Friction>,
    /// Timing and sensing errors, and the scatter of restitution.
    pub noise: Option<Noise>,
    /// Time before a strike of the state by which the table strikes, s ([`crate::table::sensing`]).
    pub lag: f64,
    /// Air that drags it in flight.
    pub drag: Option<AirDrag>,
    /// The vertices of a polygon.
    pub outline: Option<Outline>,
}

/// Chooses the motion of a guided table, contact by contact.
pub trait Guide {
    /// Motion for the contact that the table foresees, with an error of the sensed angle (rad); `None` if it will not strike.
    fn motion(&mut self, seen: &PreImpact, angle_error: f64) -> Option<PlannedTableMotion>;
}

impl GeneralBody {
    /// A rod on a table that tilts in proportion to its angle, with nothing beyond that.
    pub const fn plain(rod: Rod) -> Self {
        Self {
            rod,
            steering: Steering::TiltGain,
            constant_tilt: 0.0,
            turning: None,
            program: None,
            friction: None,
            noise: None,
            lag: 0.0,
            drag: None,
            outline: None,
        }
    }

    /// The table's tilt at a place and a state that it senses without random errors, in any kind of number, and its motion where that does not
    /// follow from the state at the strike.
    pub(crate) fn exact_motion<N: Number>(
        &self,
        rod: &Rod<N>,
        n: u64,
        x: N,
        state: &State<N>,
    ) -> (Tilt<N>, Option<PlannedTableMotion<N>>) {
        let exact = SensingTable { noise: None, ..self.table() };
        let motion = exact.motion(rod, n, x, state, None);
        let tilt = motion.map(|motion| Tilt::new(state.theta, motion.alpha, state.theta - motion.alpha));
        (tilt.unwrap_or_else(|| self.exact_tilt(rod, x, state)), motion)
    }

    /// The table's tilt at a place and a state that it senses at once and without random errors.
    fn exact_tilt<N: Number>(&self, rod: &Rod<N>, x: N, state: &State<N>) -> Tilt<N> {
        match self.constant_tilt {
            0.0 => self.steering.tilt(rod, x, state),
            constant => self.steering.sensed_tilt(rod, x, state, 0.0, constant),
        }
    }

    /// Tells whether its strikes depend on its place.
    pub fn depends_on_place(&self) -> bool {
        self.steering != Steering::TiltGain || self.turning.is_some_and(|turning| turning.strikes())
    }

    /// Velocity of the surface by the turning of the table, if it turns, for a body at `x` (m) over a table tilted like this.
    pub(crate) fn surface<N: Number>(
        &self,
        rod: &Rod<N>,
        x: N,
        state: &State<N>,
        tilt: &Tilt<N>,
    ) -> Option<SurfaceMotion<N>> {
        self.turning.map(|turning| turning.surface(rod, &self.steering, x, state, tilt))
    }

    /// The rod at strike `n`.
    pub(crate) fn at_strike(&self, n: u64) -> Rod {
        self.program.map_or(self.rod, |program| program.applied(&self.rod, n))
    }

    /// [`GeneralBody::at_strike`] as a table sees it whose contacts are not at y = 0: the energy of a bounce counts from there.
    fn seen_at(&self, n: u64, clearance: f64) -> Rod {
        let rod = self.at_strike(n);
        Rod { target_energy: rod.target_energy - rod.gravity * clearance, ..rod }
    }

    /// The rod at the impact of contact `n`, whose restitution may scatter.
    fn at_impact(&self, n: u64, rod: Rod) -> Rod {
        match self.noise {
            Some(noise) if noise.further.restitution_sd != 0.0 => rod.meeting(noise.restitution(n, rod.restitution)),
            Some(_) | None => rod,
        }
    }

    fn table(&self) -> SensingTable<'_> {
        let Self { ref steering, constant_tilt, friction, ref noise, lag, .. } = *self;
        SensingTable { steering, constant_tilt, friction, noise: noise.as_ref(), lag }
    }

    fn draw(&self, n: u64) -> NoiseSample {
        self.noise.map_or(NoiseSample { timing: 0.0, angle: 0.0 }, |noise| noise.draw(n))
    }

    /// The contact number `n` that ends a flight from `x` whose contact point is at y = 0 at the time `t`. A guided table asks `guide`
    /// for its motion.
    fn arrive(
        &self,
        flight: &Flight,
        t: f64,
        n: u64,
        x: f64,
        guide: Option<&mut dyn Guide>,
    ) -> Result<Arrival, NoContact> {
        let arrival = self.meet_timed(flight, t, n, x, guide)?;
        if let Some(outline) = &self.outline
            && let Some(touch) = outline.first_touch(flight, t.min(arrival.t))?
        {
            return Err(NoContact::OtherVertex(touch));
        }
        Ok(arrival)
    }

    /// End of a flight at a table that strikes about the time `t`, when the contact point is at y = 0.
    fn meet_timed(
        &self,
        flight: &Flight,
        t: f64,
        n: u64,
        x: f64,
        guide: Option<&mut dyn Guide>,
    ) -> Result<Arrival, NoContact> {
        let NoiseSample { timing, angle } = self.draw(n);
        let struck = if timing == 0.0 { t } else { (t + timing).max(LEAST_FLIGHT) };
        let state = flight.end(struck);
        let clearance = if timing == 0.0 { 0.0 } else { flight.gap(struck).value };
        let seen = PreImpact { clearance, ..PreImpact::at(n, x + state.x_dot * struck, state) };
        let is_guided = guide.is_some();
        let guided = guide.and_then(|guide| guide.motion(&seen, angle));
        match self.noise.map(|noise| noise.model) {
            None | Some(NoiseModel::Strike) => {
                let late = || {
                    let table = self.table();
                    let late = table.senses_late_in(struck);
                    late.then(|| table.motion(&self.seen_at(n, clearance), n, seen.x, &state, Some(struck))).flatten()
                };
                Ok(Arrival { t: struck, state, clearance, plan: guided.or_else(late), travel: None })
            }
            // A guide that does not plan follows the body.
            Some(NoiseModel::Plan) if is_guided && guided.is_none() => Ok((t, flight.end(t)).into()),
            Some(NoiseModel::Plan) => {
                let plan = guided.unwrap_or_else(|| {
                    let rod = self.at_strike(n);
                    self.table().motion(&rod, n, seen.x, &state, Some(struck)).unwrap_or_else(|| {
                        let tilt = self.steering.sensed_tilt(&rod, seen.x, &state, angle, self.constant_tilt);
                        own_motion(&rod, self.friction, &state, &tilt)
                    })
                });
                match self.meet(flight, struck, &state, plan) {
                    // Released onto the table: it is on the plane, whatever was planned for later.
                    Err(NoContact::Missed) if t == 0.0 => Ok((LEAST_FLIGHT, flight.end(LEAST_FLIGHT)).into()),
                    met => met,
                }
            }
        }
    }

    /// End of a flight at the table that was set out to strike at time `struck` the state `seen`, with its contact at y = 0.
    fn meet(&self, flight: &Flight, struck: f64, seen: &State, plan: PlannedTableMotion) -> Result<Arrival, NoContact> {
        let relative = plan.relative(flight, struck, seen);
        if relative.gravity <= 0.0 {
            return Err(NoContact::Missed);
        }
        let t = first_descent(&relative)?.ok_or(NoContact::Missed)?.max(LEAST_FLIGHT);
        Ok(Arrival { t, state: flight.end(t), clearance: flight.gap(t).value, plan: Some(plan), travel: None })
    }

    fn flight(&self, from: &PreImpact, strike: &Strike) -> Flight {
        Flight { clearance: from.clearance, ..self.rod.flight(strike) }
    }

    /// [`Body::fall`] to the table of a guide, or to the body's own without one.
    ///
    /// # Errors
    /// Same as [`Body::fall`].
    pub fn fall_to(&self, release: &Release, guide: Option<&mut dyn Guide>) -> Result<Arrival, NoContact> {
        if let Some(drag) = self.drag {
            return self.fall_in_air(drag, release);
        }
        let (t, _) = self.rod.fall(release)?;
        self.arrive(&self.rod.flight_from(release), t, 1, release.x, guide)
    }

    /// [`Body::fly`] to the table of a guide, or to the body's own without one.
    ///
    /// # Errors
    /// Same as [`Body::fly`].
    pub fn fly_to(
        &self,
        from: &PreImpact,
        strike: &Strike,
        guide: Option<&mut dyn Guide>,
    ) -> Result<Arrival, NoContact> {
        if let Some(drag) = self.drag {
            return self.fly_in_air(drag, from, strike);
        }
        let flight = self.flight(from, strike);
        let t = if flight.clearance < 0.0 {
            first_descent(&flight)?.ok_or(NoContact::Sinking)?
        } else {
            first_contact(&flight)?
        };
        self.arrive(&flight, t, from.n + 1, from.x, guide)
    }
}

impl Body for GeneralBody {
    fn fall(&self, release: &Release) -> Result<Arrival, NoContact> {
        self.fall_to(release, None)
    }

    // Out of the loop of the plain rod, which shares its code with this one; likewise below.
    #[inline(never)]
    fn strike(&self, coming: &PreImpact) -> Strike {
        let PreImpact { n, x, state, clearance, plan } = coming;
        let seen = self.seen_at(*n, *clearance);
        let plan = plan.or_else(|| self.table().motion(&seen, *n, *x, state, None));
        let rod = self.at_impact(*n, seen);
        let tilt = match plan {
            Some(plan) => Tilt::new(state.theta, plan.alpha, state.theta - plan.alpha),
            None => {
                let error = self.noise.map_or(0.0, |noise| noise.angle_error(*n));
                self.steering.sensed_tilt(&rod, *x, state, error, self.constant_tilt)
            }
        };
        let surface = self.surface(&rod, *x, state, &tilt);
        let motion = match (&plan, &surface) {
            (Some(plan), _) => TableMotion::Planned(plan),
            (None, Some(surface)) => TableMotion::Turning(surface),
            (None, None) => TableMotion::ByLaw,
        };
        strike_moving(self.friction.as_ref(), &rod, state, &tilt, motion)
    }

    #[inline(never)]
    fn touches(&self, coming: &PreImpact, strike: &Strike) -> Option<Touch> {
        let nearest = self.outline.as_ref()?.below_table(coming.state.theta - strike.alpha)?;
        Some(Touch { vertex: nearest.vertex, t: 0.0 })
    }

    fn hold_energy(&self, strike: &mut Strike, energy: f64) -> f64 {
        self.rod.hold_energy(strike, energy)
    }

    #[inline(always)]
    fn rise_rounding(&self, before: &State, strike: &Strike) -> f64 {
        match self.friction {
            Some(_) => friction::rise_rounding(&self.rod, before, strike, f64::EPSILON),
            None => strike.rise_rounding(before.y_dot, f64::EPSILON),
        }
    }

    #[inline(never)]
    fn fly(&self, from: &PreImpact, strike: &Strike) -> Result<Arrival, NoContact> {
        self.fly_to(from, strike, None)
    }

    fn contact_distance(&self) -> f64 {
        self.rod.contact_distance
    }

    fn contact_height(&self, state: &State) -> f64 {
        Body::contact_height(&self.rod, state)
    }

    fn energy(&self, state: &State) -> f64 {
        self.rod.energy(state)
    }

    fn contact_speed(&self, state: &State) -> f64 {
        self.rod.contact_speed(state)
    }
}
