//! equipoise: a server that computes whether a bouncing object can be balanced.
//!
//! Tests send requests to its router, without sockets. The physics is the crate `equipoise-physics`.

pub mod api;
pub mod charts;
pub mod cli;
pub mod comparison;
pub mod compute;
pub mod config;
pub mod failure_cases;
mod flags;
pub mod http;
pub mod integrators;
pub mod limits;
pub mod live;
pub mod logging;
pub mod memory;
pub mod middleware;
pub mod program;
pub mod router;
pub mod runs;
pub mod transport;

/// The version, and a hash of everything that can change an answer: equal builds give equal answers.
pub const BUILD: &str = env!("EQUIPOISE_BUILD");
