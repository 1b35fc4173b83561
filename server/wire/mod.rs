//! Requests and answers as clients see them: scenes, presets, tables of numbers, and the shape of every answer.
//!
//! Not the physics' own types, so that these can change without breaking a client; and no HTTP.

mod contacts;
pub mod controller;
pub mod ensemble;
mod evidence;
pub mod failure;
pub mod fields;
pub mod jacobian;
pub mod ladder;
pub mod margins;
pub mod nearest_vertex;
pub mod outcome;
mod paper;
pub mod periodic_orbits;
pub mod precision;
pub mod presets;
pub mod progress;
pub mod region;
pub mod region_rows;
pub mod scene;
pub mod stability;
pub mod table;
pub mod tile;
pub mod trajectory;
