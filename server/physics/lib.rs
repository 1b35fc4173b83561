//! The bounce of a planar rigid body on a tilting table: return map, contact times, Jacobians, stability and control.
//!
//! It starts from Zumel and Erdmann, "Balancing of a Planar Bouncing Object"; "eq. (n)" in these pages is an equation of that
//! paper. Not here: requests, JSON, clocks and threads; those live in the server.
//!
//! From the ground up: [`numbers`] are kinds of arithmetic; [`bounce`] is one strike and one flight; [`table`] steers and what it
//! is asked for; [`body`] is any body that bounces; [`run`] goes from contact to contact and ends; [`scene`] is the set of values a user
//! may give, with the smallest model that is exact for it; [`batch`] runs many scenes at once. On these stand the analyses:
//! [`stability`], [`control`], [`periodic_orbits`], [`surveys`], [`catching`] and [`fitting`].

pub mod analysis;
pub mod batch;
pub mod body;
pub mod bounce;
pub mod catching;
pub mod contact;
pub mod control;
pub mod fitting;
pub mod numbers;
pub mod periodic_orbits;
pub mod run;
pub mod scene;
pub mod stability;
pub mod surveys;
pub mod table;
