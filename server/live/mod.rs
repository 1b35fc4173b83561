//! Live runs: what a run is (a value), what is said about it, and the session that tells it as it happens.
//!
//! Not here: how a connection becomes a WebSocket (`routes::live`), and the physics.

pub mod address;
pub mod bounds;
pub mod clock;
pub mod close;
pub mod course;
pub mod events;
pub mod messages;
pub mod order;
pub mod outbox;
pub mod run;
pub mod session;

#[cfg(test)]
mod session_tests;
