//! The point mass of the paper's opening example, eq. (3) to (5): a body without an angle, on a table that tilts by κ
//! times the angle of its velocity.
//!
//! A body of its own, never a cheaper level of a rod: a rod's table follows the rod's angle. Its arithmetic is that of a
//! rod whose contact point is its centre of gravity.

use crate::body::{Arrival, Body, NoContact, PreImpact, Release};
use crate::bounce::map_number::MapNumber;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::numbers::number::Number;
use crate::table::program::HeightProgram;

/// A point mass. In its states `theta` is the angle of the velocity from straight down, counter-clockwise, and
/// `theta_dot` is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMass<N = f64> {
    rod: Rod<N>,
    /// Target heights of its strikes, where they differ.
    pub(crate) program: Option<HeightProgram>,
}

impl<N: Number> PointMass<N> {
    /// The point mass with the table, gravity and restitution of `rod`, whose own lengths drop out.
    pub fn new(rod: Rod<N>) -> Self {
        let (contact_distance, radius_of_gyration) = (N::from_f64(0.0), N::from_f64(1.0));
        Self { rod: Rod { contact_distance, radius_of_gyration, ..rod }, program: None }
    }

    /// The same point mass on a table with this program.
    #[must_use]
    pub(crate) fn with_program(self, program: Option<HeightProgram>) -> Self {
        Self { program, ..self }
    }

    /// Parameters, as those of a rod of no length.
    pub fn parameters(&self) -> &Rod<N> {
        &self.rod
    }

    /// [`PointMass::parameters`] at strike `n`.
    pub(crate) fn at_strike(&self, n: u64) -> Rod<N> {
        self.program.map_or(self.rod, |program| program.applied(&self.rod, n))
    }
}

impl<N: MapNumber> PointMass<N> {
    /// The state with these velocities (m/s) just before a contact.
    pub fn state(x_dot: N, y_dot: N) -> State<N> {
        State { theta: N::fall_angle(x_dot, y_dot), x_dot, y_dot, theta_dot: N::from_f64(0.0) }
    }

    fn turned((t, arrival): (N, State<N>)) -> Arrival<N> {
        (t, Self::state(arrival.x_dot, arrival.y_dot)).into()
    }
}

impl<N: MapNumber> Body for PointMass<N> {
    type Number = N;

    fn fall(&self, release: &Release) -> Result<Arrival<N>, NoContact> {
        Ok(Self::turned(self.rod.fall(release)?))
    }

    fn strike(&self, coming: &PreImpact<N>) -> Strike<N> {
        self.at_strike(coming.n).strike(&coming.state)
    }

    fn hold_energy(&self, strike: &mut Strike<N>, energy: N) -> N {
        self.rod.hold_energy(strike, energy)
    }

    fn fly(&self, _: &PreImpact<N>, strike: &Strike<N>) -> Result<Arrival<N>, NoContact> {
        Ok(Self::turned(self.rod.fly(strike)?))
    }

    fn contact_distance(&self) -> N {
        self.rod.contact_distance
    }

    fn contact_height(&self, _: &State<N>) -> N {
        N::from_f64(0.0)
    }

    fn energy(&self, state: &State<N>) -> N {
        self.rod.energy(state)
    }

    fn contact_speed(&self, state: &State<N>) -> N {
        state.y_dot
    }
}
