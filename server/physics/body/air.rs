//! Falls and flights of the general body through air that drags it.
//!
//! Not here: what no flight through air has, such as planned motions of the table and other vertices; scenes refuse them.

use crate::body::general::{GeneralBody, LEAST_FLIGHT};
use crate::body::{Arrival, NoContact, PreImpact, Release};
use crate::bounce::contact_time::TooManyPieces;
use crate::bounce::drag::AirDrag;
use crate::bounce::drag::contact_time::{first_contact, first_descent};
use crate::bounce::drag::flight::DragFlight;
use crate::bounce::flight::Flight;
use crate::bounce::strike::Strike;

impl GeneralBody {
    /// [`crate::body::Body::fall`] through air.
    pub(super) fn fall_in_air(&self, drag: AirDrag, release: &Release) -> Result<Arrival, NoContact> {
        let flight = DragFlight { free: self.rod.flight_from(release), drag };
        let gap = flight.gap(0.0);
        let falls = gap.slope < 0.0 || (gap.slope == 0.0 && gap.bend <= 0.0);
        let t = if flight.free.clearance == 0.0 && falls { 0.0 } else { first_contact(&flight)? };
        Ok(self.arrive_in_air(&flight, t, 1))
    }

    /// [`crate::body::Body::fly`] through air.
    pub(super) fn fly_in_air(&self, drag: AirDrag, from: &PreImpact, strike: &Strike) -> Result<Arrival, NoContact> {
        let free = Flight { clearance: from.clearance, ..self.rod.flight(strike) };
        let flight = DragFlight { free, drag };
        let t = if from.clearance < 0.0 {
            first_descent(&flight)?.ok_or(NoContact::Sinking)?
        } else {
            first_contact(&flight)?
        };
        Ok(self.arrive_in_air(&flight, t, from.n + 1))
    }

    /// The contact number `n` that ends a flight whose contact point is at y = 0 at the time `t`.
    fn arrive_in_air(&self, flight: &DragFlight, t: f64, n: u64) -> Arrival {
        let timing = self.noise.map_or(0.0, |noise| noise.draw(n).timing);
        let struck = if timing == 0.0 { t } else { (t + timing).max(LEAST_FLIGHT) };
        let clearance = if timing == 0.0 { 0.0 } else { flight.gap(struck).value };
        Arrival { t: struck, state: flight.end(struck), clearance, plan: None, travel: Some(flight.travel(struck).0) }
    }

    /// Length of the flight after a strike at y = 0, s.
    pub(crate) fn flight_time(&self, strike: &Strike) -> Result<f64, TooManyPieces> {
        let free = self.rod.flight(strike);
        match self.drag {
            Some(drag) => first_contact(&DragFlight { free, drag }),
            None => crate::bounce::contact_time::first_contact(&free),
        }
    }
}
