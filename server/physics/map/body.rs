//! A body and its table, as the map sees them, and the beginning and the end of a flight.

use crate::map::contact_time::TooManyPieces;
use crate::map::flight::{AirDrag, Flight};
use crate::map::friction::Friction;
use crate::map::polygon::Outline;
pub use crate::map::polygon::Touch;
use crate::map::strike::{PlannedTableMotion, Rod, State, Strike};
use crate::map::table::control_law::{Gains, Steering};
use crate::map::table::noise::Noise;
use crate::map::table::pivot::TurningTable;
use crate::map::table::program::HeightProgram;
use crate::numbers::number::{Arithmetic, Number};

/// Start of a run: a free body at t = 0, before its first contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Release<N = f64> {
    /// Horizontal place of the centre of gravity, m.
    pub x: N,
    /// Height of the centre of gravity, m.
    pub height: N,
    /// Angle and velocities.
    pub state: State<N>,
}

mapped!(Release: x, height; parts state);

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

impl Kick {
    /// Adds the kick to a strike of a body whose contact point is `length` (m) from its centre of gravity.
    #[inline(always)]
    pub fn disturb(&self, strike: &mut Strike, length: f64) {
        strike.after.x_dot += self.x_dot;
        strike.after.y_dot += self.y_dot;
        strike.after.theta_dot += self.theta_dot;
        strike.contact_rise += self.y_dot + length * self.theta_dot * strike.sin_cos_theta.0;
    }
}

impl<N: Arithmetic> Body<N> {
    /// The flight from a state with the contact point at a height `clearance`, m.
    pub fn flight(&self, start: State<N>, clearance: N) -> Flight<N> {
        let Rod { contact_distance, gravity, .. } = self.rod;
        Flight { start, sin_cos_theta: start.theta.sincos(), clearance, contact_distance, gravity, drag: self.drag }
    }
}

/// End of a flight: just before a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival<N = f64> {
    /// Time since the flight began, s.
    pub t: N,
    /// Angle and velocities.
    pub state: State<N>,
    /// Height of the contact point above y = 0, m: 0 unless the table strikes early or late.
    pub clearance: N,
    /// Planned motion of the table, if it planned ahead.
    pub plan: Option<PlannedTableMotion<N>>,
    /// Way along x since the flight began, m.
    pub way: N,
}

impl<N: Number> Arrival<N> {
    /// End of a flight at a time `t` (s) at which its contact point is at y = 0.
    #[inline(always)]
    pub fn at(flight: &Flight<N>, t: N) -> Self {
        Self { t, state: flight.end(t), clearance: N::from_f64(0.0), plan: None, way: flight.travel(t).0 }
    }
}

/// A contact that is about to happen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreImpact<N = f64> {
    /// Number of the contact, from 1.
    pub n: u64,
    /// Horizontal place of the centre of gravity, m.
    pub x: N,
    /// Angle and velocities just before it.
    pub state: State<N>,
    /// Same as in [`Arrival`], m.
    pub clearance: N,
    /// Same as in [`Arrival`].
    pub plan: Option<PlannedTableMotion<N>>,
}

impl<N: Number> PreImpact<N> {
    /// A contact at y = 0, on a table that has planned nothing.
    #[inline(always)]
    pub fn at(n: u64, x: N, state: State<N>) -> Self {
        Self { n, x, state, clearance: N::from_f64(0.0), plan: None }
    }

    /// Height of the centre of gravity of this rod, m.
    pub fn height(&self, rod: &Rod<N>) -> N {
        self.clearance + rod.contact_distance * self.state.theta.sincos().1
    }
}

/// Reason for which a flight ends without a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoContact {
    /// The contact time passed its work limit.
    TooManyPieces,
    /// The contact point does not come up to y = 0 again.
    Sinking,
    /// The planned table is never met.
    Missed,
    /// Another vertex comes down first.
    OtherVertex(Touch),
}

impl From<TooManyPieces> for NoContact {
    fn from(_: TooManyPieces) -> Self {
        Self::TooManyPieces
    }
}

/// A body and its table: the rod with all that a scene may ask beyond the plain one, each part only where it is asked for. A point mass is a rod
/// of no length whose angle is that of its velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body<N = f64> {
    /// The rod and its table without the rest.
    pub rod: Rod<N>,
    /// True for a point mass.
    pub is_point: bool,
    /// Control law of the tilt.
    pub steering: Steering<N>,
    /// Tilt of the table beside its law, rad ([`crate::map::table::errors`]).
    pub constant_tilt: N,
    /// Turning of the table as it strikes.
    pub turning: Option<TurningTable<N>>,
    /// Target heights of its strikes, where they differ.
    pub program: Option<HeightProgram>,
    /// Friction and a table that moves along itself.
    pub friction: Option<Friction<N>>,
    /// Timing and sensing errors, and the scatter of restitution.
    pub noise: Option<Noise>,
    /// Time before a strike of the state by which the table strikes, s ([`crate::map::table::sensing`]).
    pub lag: N,
    /// Air that drags it in flight.
    pub drag: Option<AirDrag<N>>,
    /// The vertices of a polygon.
    pub outline: Option<Outline>,
}

mapped!(
    Body: constant_tilt, lag; parts rod, steering; maybe turning, friction; vanishing drag;
    same is_point, program, noise, outline
);

impl<N: Number> Body<N> {
    /// A rod on a table that tilts in proportion to its angle, with nothing beyond that.
    pub fn plain(rod: Rod<N>) -> Self {
        Self {
            rod,
            is_point: false,
            steering: Steering::TiltGain,
            constant_tilt: N::from_f64(0.0),
            turning: None,
            program: None,
            friction: None,
            noise: None,
            lag: N::from_f64(0.0),
            drag: None,
            outline: None,
        }
    }

    /// Tells whether it is a rod with nothing beyond the plain one.
    pub fn is_plain_rod(&self) -> bool {
        let Self { rod: _, is_point, steering, constant_tilt, turning, program, friction, noise, lag, drag, outline } =
            self;
        !is_point
            && matches!(steering, Steering::TiltGain)
            && constant_tilt.is_zero()
            && turning.is_none()
            && program.is_none()
            && friction.is_none()
            && noise.is_none()
            && lag.is_zero()
            && drag.is_none()
            && outline.is_none()
    }

    /// Friction of its contacts, if it is not 0.
    pub fn rough(&self) -> Option<Friction<N>> {
        self.friction.filter(|friction| friction.coefficient.to_f64() != 0.0)
    }

    /// The same body whose contact 1 is contact `n` of this one: its program begins there.
    #[must_use]
    pub fn from_contact(self, n: u64) -> Self {
        Self { program: self.program.map(|program| program.from_strike(n)), ..self }
    }

    /// A point mass with the table, gravity and restitution of `rod`, whose own lengths drop out: the paper's opening example, eq. (3) to (5).
    ///
    /// In its states `theta` is the angle of the velocity from straight down, counter-clockwise, and `theta_dot` is 0; its table tilts by κ
    /// times that angle.
    pub fn point(rod: Rod<N>) -> Self {
        let (contact_distance, radius_of_gyration) = (N::from_f64(0.0), N::from_f64(1.0));
        Self { is_point: true, ..Self::plain(Rod { contact_distance, radius_of_gyration, ..rod }) }
    }
}

impl Body {
    /// K of its state feedback, in the order of [`crate::control::bounce_model::STATE`]; `None` for a table with a tilt gain. A table that
    /// strikes by an earlier state of a rod feeds back velocities, whatever its law.
    pub fn feedback(&self) -> Option<[f64; 4]> {
        if self.steering == Steering::TiltGain && (self.lag == 0.0 || self.is_point) {
            return None;
        }
        let Gains { x, theta, x_dot, theta_dot } =
            self.steering.lagging(self.rod.tilt_gain, self.lag, self.drag.as_ref());
        Some([x, theta, x_dot, theta_dot])
    }
}
