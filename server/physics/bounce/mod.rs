//! One bounce: the strike, without friction or with it, the flight after it, and the time of the next contact.

pub mod contact_time;
pub mod decay;
pub mod energy_feedback;
pub mod flight;
pub mod friction;
pub mod map_number;
pub mod rebound;
pub mod rod;
pub mod state;
pub mod strike;
pub mod table_motion;
pub(crate) mod tilt;
