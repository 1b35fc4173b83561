//! The return map of a body: from just before a contact to just before the next one.
//!
//! [`bounce`] has one bounce from top to bottom; [`body`] is what bounces, with its table. Their parts are the strike with or without
//! friction, the flight in vacuum or in air, the time of the next contact, the [`table`], and the vertices of a polygon.

pub mod body;
pub mod bounce;
pub mod contact_time;
pub mod flight;
pub mod friction;
pub mod polygon;
pub mod strike;
pub mod table;
