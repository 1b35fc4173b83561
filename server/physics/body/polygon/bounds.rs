//! Bounds on the vertices of a polygon and on the lengths that follow from them.

use std::ops::RangeInclusive;

/// Most vertices. Every one is looked at in every flight.
pub const MAX_VERTICES: usize = 32;

/// Farthest coordinate of a vertex from zero, m: a body of the greatest l, drawn anywhere about it.
pub const FARTHEST: f64 = 10.0;

/// l and ρ that may follow, m: those that may be said of a rod.
pub const LENGTHS: RangeInclusive<f64> = 1e-3..=10.0;
