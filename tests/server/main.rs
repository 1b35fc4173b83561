//! The promises of the server, a file for each: requests to the router in this process, and answers that fit `openapi.yaml`.
//!
//! They are one test program: a program for each file took ten seconds more to build, and 300 MB. Tests that start the server as a program,
//! and the longest ones, have programs of their own beside this folder.

#[path = "../support/mod.rs"]
mod support;

mod access;
mod availability;
mod bodies;
mod caching;
mod cases;
mod catches;
mod contract;
mod controllers;
mod dashboards;
mod deploy;
mod ensembles;
mod errors;
mod events;
mod failures;
mod fits;
mod formats;
mod holds;
mod hostile;
mod ladder;
mod live;
mod page;
mod periodic_orbits;
mod precision;
mod regions;
mod rig;
mod shell;
mod streams;
mod verdict;
