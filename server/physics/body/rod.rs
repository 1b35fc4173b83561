//! Falls and flights of the plain rod.

use crate::body::Release;
use crate::bounce::contact_time::{TooManyPieces, first_contact, first_contact_from_rest};
use crate::bounce::flight::Flight;
use crate::bounce::map_number::MapNumber;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;

impl<N: MapNumber> Rod<N> {
    /// Time of the first contact (0 if it is on the table already and does not rise), s, and the state just before it.
    ///
    /// # Errors
    /// [`TooManyPieces`] where the contact time passed its work limit; likewise in [`Rod::fly`].
    pub fn fall(&self, release: &Release<N>) -> Result<(N, State<N>), TooManyPieces> {
        let flight = self.flight_from(release);
        let t = first_contact_from_rest(&flight)?;
        Ok((t, flight.end(t)))
    }

    /// The flight that begins at a release.
    pub(crate) fn flight_from(&self, release: &Release<N>) -> Flight<N> {
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

    /// Length of the flight after a strike, s, and the state at its end.
    ///
    /// # Errors
    /// Same as [`Rod::fall`].
    #[inline(always)]
    pub fn fly(&self, strike: &Strike<N>) -> Result<(N, State<N>), TooManyPieces> {
        let flight = self.flight(strike);
        let t = first_contact(&flight)?;
        Ok((t, flight.end(t)))
    }
}
