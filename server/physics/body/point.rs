//! The point mass of the paper's opening example, eq. (3) to (5): a body without an angle, on a table that tilts by κ
//! times the angle of its velocity.
//!
//! A body of its own, never a cheaper level of a rod: a rod's table follows the rod's angle. Its arithmetic is that of a
//! rod whose contact point is its centre of gravity.

use crate::body::{Arrival, Body, NoContact, PreImpact, Release};
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::table::program::HeightProgram;

/// A point mass. In its states `theta` is the angle of the velocity from straight down, counter-clockwise, and
/// `theta_dot` is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMass {
    rod: Rod,
    /// Target heights of its strikes, where they differ.
    pub(crate) program: Option<HeightProgram>,
}

impl PointMass {
    /// The point mass with the table, gravity and restitution of `rod`, whose own lengths drop out.
    pub fn new(rod: Rod) -> Self {
        Self { rod: Rod { contact_distance: 0.0, radius_of_gyration: 1.0, ..rod }, program: None }
    }

    /// The same point mass on a table with this program.
    #[must_use]
    pub(crate) fn with_program(self, program: Option<HeightProgram>) -> Self {
        Self { program, ..self }
    }

    /// Parameters, as those of a rod of no length.
    pub fn parameters(&self) -> &Rod {
        &self.rod
    }

    /// [`PointMass::parameters`] at strike `n`.
    pub(crate) fn at_strike(&self, n: u64) -> Rod {
        self.program.map_or(self.rod, |program| program.applied(&self.rod, n))
    }

    /// The state with these velocities (m/s) just before a contact.
    pub fn state(x_dot: f64, y_dot: f64) -> State {
        State { theta: crate::numbers::trig::atan2(x_dot, -y_dot), x_dot, y_dot, theta_dot: 0.0 }
    }

    fn turned((t, arrival): (f64, State)) -> Arrival {
        (t, Self::state(arrival.x_dot, arrival.y_dot)).into()
    }
}

impl Body for PointMass {
    fn fall(&self, release: &Release) -> Result<Arrival, NoContact> {
        Ok(Self::turned(self.rod.fall(release)?))
    }

    fn strike(&self, coming: &PreImpact) -> Strike {
        self.at_strike(coming.n).strike(&coming.state)
    }

    fn hold_energy(&self, strike: &mut Strike, energy: f64) -> f64 {
        self.rod.hold_energy(strike, energy)
    }

    fn fly(&self, _: &PreImpact, strike: &Strike) -> Result<Arrival, NoContact> {
        Ok(Self::turned(self.rod.fly(strike)?))
    }

    fn contact_distance(&self) -> f64 {
        0.0
    }

    fn contact_height(&self, _: &State) -> f64 {
        0.0
    }

    fn energy(&self, state: &State) -> f64 {
        self.rod.energy(state)
    }

    fn contact_speed(&self, state: &State) -> f64 {
        state.y_dot
    }
}
