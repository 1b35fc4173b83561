//! Live runs: a run on the wall clock, its URL, its messages, and the session that tells it to one client.
//!
//! The handshake of a WebSocket is in `api::live`.

pub mod client_message;
pub mod server_message;
pub mod sse;

pub mod catch_up;
pub mod clock;
pub mod outbox;
pub mod run_url;
pub mod session;
