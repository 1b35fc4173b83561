//! A body and its table, as the map sees them.
//!
//! Not here: how it falls, is struck and flies on ([`crate::body::bounce`]), and how its runs go on ([`crate::run::orbit`]).

pub mod bounce;
pub mod polygon;

use crate::body::polygon::Outline;
pub use crate::bounce::arrival::{Arrival, Kick, NoContact, PreImpact, Release, Touch};
use crate::bounce::drag::AirDrag;
use crate::bounce::friction::Friction;
use crate::bounce::rod::Rod;
use crate::numbers::number::Number;
use crate::table::control_law::{Gains, Steering};
use crate::table::noise::Noise;
use crate::table::pivot::TurningTable;
use crate::table::program::HeightProgram;

/// A body and its table: the rod with all that a scene may ask beyond the plain one, each part only where it is asked for. A point mass is a rod
/// of no length whose angle is that of its velocity.
///
/// Each part is another module's: [`crate::bounce::friction`], [`crate::table::noise`], [`crate::bounce::drag`],
/// [`crate::body::polygon`]; they meet in [`crate::body::bounce`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body<N = f64> {
    /// The rod and its table without the rest.
    pub rod: Rod<N>,
    /// True for a point mass.
    pub is_point: bool,
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

impl<N> Body<N> {
    /// A rod on a table that tilts in proportion to its angle, with nothing beyond that.
    pub fn plain(rod: Rod<N>) -> Self {
        Self {
            rod,
            is_point: false,
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

    /// Tells whether it is a rod with nothing beyond the plain one.
    pub fn is_plain_rod(&self) -> bool {
        let Self { rod: _, is_point, steering, constant_tilt, turning, program, friction, noise, lag, drag, outline } =
            self;
        !is_point
            && *steering == Steering::TiltGain
            && *constant_tilt == 0.0
            && turning.is_none()
            && program.is_none()
            && friction.is_none()
            && noise.is_none()
            && *lag == 0.0
            && drag.is_none()
            && outline.is_none()
    }

    /// The same body whose contact 1 is contact `n` of this one: its program begins there.
    #[must_use]
    pub fn from_contact(self, n: u64) -> Self {
        Self { program: self.program.map(|program| program.from_strike(n)), ..self }
    }
}

impl<N: Number> Body<N> {
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
    /// strikes by an earlier state feeds back velocities, whatever its law.
    pub fn feedback(&self) -> Option<[f64; 4]> {
        if self.steering == Steering::TiltGain && self.lag == 0.0 {
            return None;
        }
        let Gains { x, theta, x_dot, theta_dot } = self.steering.lagging(self.rod.tilt_gain, self.lag);
        Some([x, theta, x_dot, theta_dot])
    }
}
