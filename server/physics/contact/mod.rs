//! Motion in lasting contact: after the last strike the contact point stays on the table, and the body slides, sticks or rocks.
//!
//! The contact point stays at the table's height; the table tilts about it. Between strikes a run is made of flights
//! ([`crate::run`]); here it is the solution of an ordinary differential equation, with an error bound.

mod force;
mod record;
mod request;

pub use force::{ContactForce, ContactMotion, Grip};
pub use record::{Hold, HoldEnding, HoldSample, LONGEST_HOLD, MOST_SAMPLES};
pub use request::{ContactStart, HoldLaw, HoldRequest, Touching};
