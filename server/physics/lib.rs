//! The bounce of a planar rigid body on a tilting table: map, contact times, Jacobians and stability.
//!
//! It starts from Zumel and Erdmann, "Balancing of a Planar Bouncing Object"; "eq. (n)" in these pages is an equation
//! of that paper. Not here: requests, JSON, clocks and threads; those live in the server.
//!
//! Where to look: [`scene`] is what a user may say; [`model`] chooses the smallest model that is exact for it; [`polygon`] is
//! a body given by its vertices;
//! [`impact`] (or [`friction`]), [`flight`] and [`contact_time`] are the three parts of one bounce; [`map`] puts them together and ends
//! a run; [`jacobian`] differentiates it, [`stability`] and [`regularity`] look at it from near and far, [`basin`] asks how far
//! aside it may start, and [`verdict`] concludes. [`periodic_orbits`] finds what comes back; [`sweep`] runs many at once, for
//! a [`region`]. [`extended`] is the map with 31 digits, to hold the others against; [`error_estimate`] says how far doubles
//! may be off it, [`linear`] gives any impact in closed form, and [`method`] chooses among the three. [`noise`] is what a
//! table's clock and its sense of angle get wrong, and [`control`] designs a law for it.

pub mod basin;
pub mod body;
pub mod contact_time;
pub mod control;
pub mod demand;
pub mod dispatch;
pub mod double_double;
pub mod dual;
pub mod ensemble;
pub mod error_estimate;
pub mod extended;
pub mod fixed_point;
pub mod flight;
pub mod friction;
pub mod grip;
pub mod impact;
pub mod jacobian;
pub mod ladder;
mod lanes;
pub mod linear;
pub mod loss;
pub mod lyapunov;
pub mod map;
pub mod margins;
pub mod method;
pub mod model;
pub mod noise;
pub mod normal_form;
pub mod number;
pub mod outcome;
pub mod periodic_orbits;
pub mod point;
pub mod polygon;
pub mod region;
pub mod regularity;
pub mod rig;
pub mod scene;
pub mod settling;
pub mod stability;
pub mod sweep;
pub mod taylor;
pub mod trig;
pub mod verdict;
