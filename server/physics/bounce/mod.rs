//! One bounce: the strike, without friction or with it, the flight after it, and the time of the next contact.

pub mod contact_time;
pub mod flight;
pub mod friction;
pub mod strike;
