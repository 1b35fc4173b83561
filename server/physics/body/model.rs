//! Any body that a scene may ask for, as one type.
//!
//! Not here: the choice of the smallest one that is exact ([`crate::scene::model`]).

use crate::body::general::GeneralBody;
use crate::body::point::PointMass;
use crate::body::polygon::Outline;
use crate::body::{Arrival, Body, NoContact, PreImpact, Release, Touch};
use crate::bounce::drag::AirDrag;
use crate::bounce::friction::Friction;
use crate::bounce::map_number::MapNumber;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::numbers::number::Number;
use crate::table::control_law::{Gains, Steering};
use crate::table::noise::Noise;
use crate::table::pivot::TurningTable;
use crate::table::program::HeightProgram;

/// The model that runs a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a run has one, and it is Copy: the vertices of a polygon stand in it")]
pub enum Model<N = f64> {
    /// A rod; its strike gain says which of the levels it stands on.
    Rod(Rod<N>),
    /// A point mass.
    Point(PointMass<N>),
    /// A rod with more than that.
    General(GeneralBody<N>),
}

impl<N: Number> Model<N> {
    /// The rod in it, or what a point mass has of one.
    pub fn rod(&self) -> &Rod<N> {
        match self {
            Self::Rod(rod) => rod,
            Self::Point(point) => point.parameters(),
            Self::General(general) => &general.rod,
        }
    }

    /// The same model whose contact 1 is contact `n` of this one: its program begins there.
    #[must_use]
    pub fn from_contact(mut self, n: u64) -> Self {
        let program = match &mut self {
            Self::Rod(_) => return self,
            Self::Point(point) => &mut point.program,
            Self::General(general) => &mut general.program,
        };
        *program = program.map(|program| program.from_strike(n));
        self
    }

    /// Target heights of its strikes, if they differ.
    pub fn program(&self) -> Option<&HeightProgram> {
        match self {
            Self::Rod(_) => None,
            Self::Point(point) => point.program.as_ref(),
            Self::General(general) => general.program.as_ref(),
        }
    }

    /// The friction of its contact; `None` without friction on a table that does not move along itself.
    pub fn friction(&self) -> Option<Friction> {
        match self {
            Self::Rod(_) | Self::Point(_) => None,
            Self::General(general) => general.friction,
        }
    }

    /// Turning of its table as it strikes, if it turns.
    pub fn turning(&self) -> Option<TurningTable> {
        match self {
            Self::Rod(_) | Self::Point(_) => None,
            Self::General(general) => general.turning,
        }
    }

    /// Air that drags it, if it does.
    pub fn drag(&self) -> Option<AirDrag> {
        match self {
            Self::Rod(_) | Self::Point(_) => None,
            Self::General(general) => general.drag,
        }
    }

    /// Errors of its table, if there are any.
    pub fn noise(&self) -> Option<Noise> {
        match self {
            Self::Rod(_) | Self::Point(_) => None,
            Self::General(general) => general.noise,
        }
    }

    /// Outline of a polygon.
    pub fn outline(&self) -> Option<&Outline> {
        match self {
            Self::Rod(_) | Self::Point(_) => None,
            Self::General(general) => general.outline.as_ref(),
        }
    }

    /// Time before a strike of the state by which its table strikes, s.
    pub fn lag(&self) -> f64 {
        match self {
            Self::Rod(_) | Self::Point(_) => 0.0,
            Self::General(general) => general.lag,
        }
    }
}

impl Model {
    /// K of its state feedback, in the order of [`crate::control::bounce_model::STATE`]; `None` for a table with a tilt gain. A table that
    /// strikes by an earlier state feeds back velocities, whatever its law.
    pub fn feedback(&self) -> Option<[f64; 4]> {
        match self {
            Self::Rod(_) | Self::Point(_) => None,
            Self::General(GeneralBody { steering: Steering::TiltGain, lag: 0.0, .. }) => None,
            Self::General(GeneralBody { rod, steering, lag, .. }) => {
                let Gains { x, theta, x_dot, theta_dot } = steering.lagging(rod.tilt_gain, *lag);
                Some([x, theta, x_dot, theta_dot])
            }
        }
    }
}

/// Calls the same method of whichever body it is: a branch that a run always takes the same way, not a virtual call.
macro_rules! either {
    ($model:expr, $body:ident => $call:expr) => {
        match $model {
            Model::Rod($body) => $call,
            Model::Point($body) => $call,
            Model::General($body) => $call,
        }
    };
}

impl<N: MapNumber> Body for Model<N> {
    type Number = N;

    fn fall(&self, release: &Release) -> Result<Arrival<N>, NoContact> {
        either!(self, body => Body::fall(body, release))
    }

    #[inline(always)]
    fn strike(&self, coming: &PreImpact<N>) -> Strike<N> {
        either!(self, body => Body::strike(body, coming))
    }

    #[inline(always)]
    fn touches(&self, coming: &PreImpact<N>, strike: &Strike<N>) -> Option<Touch> {
        either!(self, body => body.touches(coming, strike))
    }

    #[inline(always)]
    fn hold_energy(&self, strike: &mut Strike<N>, energy: N) -> N {
        either!(self, body => Body::hold_energy(body, strike, energy))
    }

    #[inline(always)]
    fn rise_rounding(&self, before: &State<N>, strike: &Strike<N>) -> f64 {
        either!(self, body => body.rise_rounding(before, strike))
    }

    #[inline(always)]
    fn fly(&self, from: &PreImpact<N>, strike: &Strike<N>) -> Result<Arrival<N>, NoContact> {
        either!(self, body => Body::fly(body, from, strike))
    }

    fn contact_distance(&self) -> N {
        either!(self, body => Body::contact_distance(body))
    }

    fn contact_height(&self, state: &State<N>) -> N {
        either!(self, body => Body::contact_height(body, state))
    }

    fn energy(&self, state: &State<N>) -> N {
        either!(self, body => Body::energy(body, state))
    }

    fn contact_speed(&self, state: &State<N>) -> N {
        either!(self, body => Body::contact_speed(body, state))
    }
}
