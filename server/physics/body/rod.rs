//! The plain rod as a body: its falls and its flights.

use crate::body::{Arrival, Body, NoContact, PreImpact, Release};
use crate::bounce::contact_time;
use crate::bounce::contact_time::TooManyPieces;
use crate::bounce::flight::Flight;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;

impl Rod {
    /// Time of the first contact (0 if it is on the table already and does not rise), s, and the state just before it.
    ///
    /// # Errors
    /// [`TooManyPieces`] where the contact time passed its work limit; likewise in [`Rod::fly`].
    pub fn fall(&self, release: &Release) -> Result<(f64, State), TooManyPieces> {
        let flight = self.flight_from(release);
        let gap = flight.gap(0.0);
        if flight.clearance == 0.0 && (gap.slope < 0.0 || (gap.slope == 0.0 && gap.bend <= 0.0)) {
            return Ok((0.0, release.state));
        }
        let t = contact_time::first_contact(&flight)?;
        Ok((t, flight.end(t)))
    }

    /// The flight that begins at a release.
    pub(crate) fn flight_from(&self, release: &Release) -> Flight {
        let sin_cos_theta = crate::numbers::trig::sin_cos(release.state.theta);
        let height = self.contact_distance * sin_cos_theta.1;
        let clearance = release.height - height;
        // A height typed as l cos θ means a contact, whatever the last digit.
        let clearance =
            if clearance <= 4.0 * f64::EPSILON * release.height.abs().max(height.abs()) { 0.0 } else { clearance };
        Flight {
            start: release.state,
            sin_cos_theta,
            clearance,
            contact_distance: self.contact_distance,
            gravity: self.gravity,
        }
    }

    /// Length of the flight after a strike, s, and the state at its end.
    ///
    /// # Errors
    /// Same as [`Rod::fall`].
    #[inline(always)]
    pub fn fly(&self, strike: &Strike) -> Result<(f64, State), TooManyPieces> {
        let flight = self.flight(strike);
        let t = contact_time::first_contact(&flight)?;
        Ok((t, flight.end(t)))
    }
}

impl Body for Rod {
    fn fall(&self, release: &Release) -> Result<Arrival, NoContact> {
        Ok(Rod::fall(self, release)?.into())
    }

    #[inline(always)]
    fn strike(&self, coming: &PreImpact) -> Strike {
        Rod::strike(self, &coming.state)
    }

    #[inline(always)]
    fn hold_energy(&self, strike: &mut Strike, energy: f64) -> f64 {
        Rod::hold_energy(self, strike, energy)
    }

    #[inline(always)]
    fn fly(&self, _: &PreImpact, strike: &Strike) -> Result<Arrival, NoContact> {
        Ok(Rod::fly(self, strike)?.into())
    }

    fn contact_distance(&self) -> f64 {
        self.contact_distance
    }

    fn contact_height(&self, state: &State) -> f64 {
        self.contact_distance * crate::numbers::trig::sin_cos(state.theta).1
    }

    fn energy(&self, state: &State) -> f64 {
        Rod::energy(self, state)
    }

    fn contact_speed(&self, state: &State) -> f64 {
        Rod::contact_speed(self, state)
    }
}
