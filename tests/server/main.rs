//! The promises of the server, a file for each: requests to the router in this process, and answers that fit `openapi.yaml`.
//!
//! They are one test program: a program for each file took ten seconds more to build, and 300 MB. Tests that start the server as a program,
//! and the longest ones, have programs of their own beside this folder.

#[path = "../support/mod.rs"]
mod support;

mod access;
mod air;
mod arrow;
mod availability;
mod batches;
mod budget;
mod caching;
mod cases;
mod catch_failures;
mod catches;
mod contract;
mod controllers;
mod dashboards;
mod deploy;
mod energy;
mod ensembles;
mod errors;
mod events;
mod failures;
mod fit_progress;
mod fit_tables;
mod fits;
mod formats;
mod friction;
mod holds;
mod hostile;
mod joining;
mod ladder;
mod live;
mod live_bridges;
mod live_catches;
mod live_holds;
mod margins;
mod methods;
mod page;
mod periodic_orbits;
mod pictures;
mod polygon;
mod precision;
mod presets;
mod ranges;
mod regions;
mod repeats;
mod rig;
mod scrape;
mod sensing;
mod shell;
mod sign_in;
mod streams;
mod verdict;
