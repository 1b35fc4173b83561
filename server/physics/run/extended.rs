//! The map with 31 digits: the reference that everything faster is held against, and the method of last resort.
//!
//! The formulas are those of the map itself ([`crate::map::strike`], [`crate::map::flight`]) in double-double numbers, and so are the
//! parameters, from the fields of the scene on. Which root of a flight is the next contact is decided in doubles, with the
//! certificate of [`crate::map::contact_time`]; the root is then lifted by Newton's iteration. Endings, branches of friction and touches of
//! other vertices are decided in doubles too.

use crate::map::contact_time::first_contact;
use crate::map::strike::{Rod, State};
use crate::numbers::double_double::{DoubleDouble, ROUNDING};
use crate::run::orbit::{Contact, Orbit};

/// One contact of a run with 31 digits.
pub type ExtendedContact = Contact<DoubleDouble>;

/// A run that is computed contact by contact with 31 digits.
pub type ExtendedOrbit = Orbit<DoubleDouble>;

/// A state in doubles.
pub fn in_doubles(state: &State<DoubleDouble>) -> State {
    state.to_f64()
}

/// One bounce from a state just before a contact: the length of the flight, s, and the state at its end. `None` if there is
/// no strike or no next contact.
pub fn bounce(rod: &Rod<DoubleDouble>, state: &State<DoubleDouble>) -> Option<(DoubleDouble, State<DoubleDouble>)> {
    let strike = rod.strike(state);
    let flies = strike.push.to_f64() < 0.0 && strike.rises(state.y_dot, ROUNDING);
    let flight = rod.flight(&strike);
    let t = flies.then(|| first_contact(&flight).ok())??;
    Some((t, flight.end(t)))
}
