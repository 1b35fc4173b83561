//! Periodic orbits: states that come back after a number of contacts, found by Newton's iteration with exact derivatives.
//!
//! f^k(x) = x alone is singular, since orbits come in families: by their energy, where nothing steers it, and by their mean
//! drift. So it is closed with the scene's energy and with zero drift. That is more equations than unknowns, all of which
//! an orbit satisfies; they are solved by least squares, and a remainder means that there is no orbit.
//! Following an orbit along a parameter is in [`branch`], judging it in [`multipliers`].

pub mod branch;
pub mod multipliers;
mod orbit;

pub use orbit::{OrbitFailure, OrbitProblem, PeriodicOrbit, find, find_at_theta};
