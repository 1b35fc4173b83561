//! Live runs: what a run is (a value), what is said about it, and the session that tells it as it happens.
//!
//! Not here: how a connection becomes a WebSocket (`routes::live`), and the physics.

pub mod client_message;
pub mod server_message;
pub mod sse;

pub mod bounds;
pub mod close;
pub mod outbox;
pub mod session;

#[cfg(test)]
mod session_tests;
