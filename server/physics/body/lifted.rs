//! The rod with all that a scene may ask beyond the plain one, in any kind of number: the strike, and the motion that a table plans.
//!
//! Branches are decided in doubles. Not here: falls and flights, whose ends are found in other ways for other numbers.

use crate::body::PreImpact;
use crate::bounce::drag::AirDrag;
use crate::bounce::friction::{Friction, actual_branch};
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::bounce::table_motion::{PlannedTableMotion, SurfaceMotion, TableMotion};
use crate::bounce::tilt::Tilt;
use crate::numbers::number::Number;
use crate::table::control_law::{Steering, own_motion};
use crate::table::noise::Noise;
use crate::table::pivot::TurningTable;
use crate::table::program::HeightProgram;
use crate::table::sensing::SensingTable;

/// A rod in some kind of number, with what a scene asks for beyond the plain one.
#[derive(Clone, Copy, Debug)]
pub struct LiftedBody<N> {
    /// The rod and its table; of a point mass, a rod of no length.
    pub rod: Rod<N>,
    /// Control law of the tilt.
    pub steering: Steering,
    /// Tilt of the table beside its law, rad.
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
}

impl<N: Number> LiftedBody<N> {
    /// Same as [`crate::body::Body::strike`].
    pub fn strike(&self, coming: &PreImpact<N>) -> Strike<N> {
        self.strike_at(coming, &self.tilt(coming))
    }

    /// The table's tilt at a contact.
    pub(crate) fn tilt(&self, coming: &PreImpact<N>) -> Tilt<N> {
        let PreImpact { n, x, state, plan, .. } = coming;
        match plan {
            Some(plan) => Tilt::new(state.theta, plan.alpha, state.theta - plan.alpha),
            None => match self.table().alpha(&self.rod, *n, *x, state) {
                Some(alpha) => Tilt::new(state.theta, alpha, state.theta - alpha),
                None => self.sensed_tilt(*x, state, self.noise.map_or(0.0, |noise| noise.angle_error(*n))),
            },
        }
    }

    /// The strike of a table at this tilt.
    pub(crate) fn strike_at(&self, coming: &PreImpact<N>, tilt: &Tilt<N>) -> Strike<N> {
        let PreImpact { n, x, state, clearance, plan } = coming;
        let seen = self.seen_at(*n, *clearance);
        let plan = plan.or_else(|| self.table().motion(&seen, *n, *x, state, None));
        let mut rod = seen;
        if let Some(noise) = self.noise.filter(|noise| noise.further.restitution_sd != 0.0) {
            rod = rod.meeting(N::from_f64(noise.restitution(*n, rod.restitution.to_f64())));
        }
        let surface = self.turning.map(|turning| turning.surface(&rod, &self.steering, *x, state, tilt));
        let motion = match (&plan, &surface) {
            (Some(plan), _) => TableMotion::Planned(plan),
            (None, Some(surface)) => TableMotion::Turning(surface),
            (None, None) => TableMotion::ByLaw,
        };
        strike_moving(self.friction.as_ref(), &rod, state, tilt, motion)
    }

    /// Motion of a table that plans for contact `n`, `flown` s after the flight began, with the state that it foresees, its angle sensed with an
    /// error (rad).
    pub(crate) fn planned_motion(&self, n: u64, x: N, seen: &State<N>, error: f64, flown: N) -> PlannedTableMotion<N> {
        let rod = self.at_strike(n);
        let own = || own_motion(&rod, self.friction, seen, &self.sensed_tilt(x, seen, error));
        self.table().motion(&rod, n, x, seen, Some(flown)).unwrap_or_else(own)
    }

    fn table(&self) -> SensingTable<'_> {
        let Self { ref steering, constant_tilt, friction, ref noise, lag, .. } = *self;
        SensingTable { steering, constant_tilt, friction, noise: noise.as_ref(), lag }
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
        let table = self.table();
        let late = table.senses_late_in(flown.to_f64());
        late.then(|| table.motion(&self.seen_at(n, clearance), n, x, state, Some(flown))).flatten()
    }

    /// The rod at strike `n`; the energy of a bounce counts from its contact.
    fn seen_at(&self, n: u64, clearance: N) -> Rod<N> {
        let mut rod = self.at_strike(n);
        if self.noise.is_some() {
            rod.target_energy = rod.target_energy - rod.gravity * clearance;
        }
        rod
    }

    fn sensed_tilt(&self, x: N, state: &State<N>, error: f64) -> Tilt<N> {
        self.steering.sensed_tilt(&self.rod, x, state, error, self.constant_tilt)
    }

    fn at_strike(&self, n: u64) -> Rod<N> {
        self.program.map_or(self.rod, |program| program.applied(&self.rod, n))
    }
}

/// The strike of a rod over a table tilted and moving like this, with friction or without.
#[inline(always)]
pub(crate) fn strike_moving<N: Number>(
    friction: Option<&Friction>,
    rod: &Rod<N>,
    before: &State<N>,
    tilt: &Tilt<N>,
    motion: TableMotion<'_, N>,
) -> Strike<N> {
    match (friction, motion) {
        (None, TableMotion::ByLaw) => rod.strike_with(before, tilt, rod.leverage()),
        (None, TableMotion::Turning(SurfaceMotion { normal: None, tangential, .. })) => {
            let strike = rod.strike_with(before, tilt, rod.leverage());
            let (x, y) = strike.table_velocity;
            let table_velocity = (x + *tangential * tilt.cos_alpha, y + *tangential * tilt.sin_alpha);
            Strike { table_velocity, ..strike }
        }
        (friction, motion) => {
            let friction = friction.unwrap_or(&Friction::SMOOTH);
            friction.strike(rod, before, tilt, motion, rod.leverage(), actual_branch)
        }
    }
}
