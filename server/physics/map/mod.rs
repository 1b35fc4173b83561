//! The return map of a body: from just before a contact to just before the next one.
//!
//! Read a bounce from top to bottom in two files: [`bounce`] has the table that senses and plans, the strike over it, and the flight to the next
//! contact; [`strike`] has the formulas of the strike itself. Then, as needed:
//!
//! - [`body`]: what bounces, with all parts that a scene may ask for, and the beginning and the end of a flight.
//! - [`flight`]: the motion between contacts, and the gap over y = 0 with its derivatives, in vacuum and in air. [`contact_time`]: which zero of
//!   the gap is the next contact.
//! - [`friction`]: the impulse with friction. [`polygon`]: the other vertices of a body.
//! - [`table`]: the law of the table, its errors, noise, delay, pivot, program of heights, and the load on its actuators.

pub mod body;
pub mod bounce;
pub mod contact_time;
pub mod flight;
pub mod friction;
pub mod polygon;
pub mod strike;
pub mod table;
