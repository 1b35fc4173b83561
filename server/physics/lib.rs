//! The bounce of a planar rigid body on a tilting table: return map, contact times, Jacobians, stability and control.
//!
//! It starts from Zumel and Erdmann, "Balancing of a Planar Bouncing Object"; "eq. (n)" in these pages is an equation of that
//! paper. Not here: requests, JSON, clocks and threads; those live in the server.
//!
//! From the ground up: [`numbers`] are kinds of arithmetic; [`map`] is one bounce of any body; [`run`] goes from contact to contact and ends;
//! [`scene`] is the set of values a user may give, with the body that they make. On these stand [`analysis`], [`control`], [`catching`],
//! [`fitting`] and [`surveys`].

pub mod analysis;
pub mod catching;
pub mod control;
pub mod fitting;
pub mod map;
pub mod numbers;
pub mod run;
pub mod scene;
pub mod surveys;
