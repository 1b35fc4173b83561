//! Bounds on the vertices of a polygon and on the lengths that follow from them.

use std::ops::RangeInclusive;

/// Fewest vertices.
pub const FEWEST_VERTICES: usize = 3;

/// Most vertices. Each flight examines all of them.
pub const MAX_VERTICES: usize = 32;

/// Farthest coordinate of a vertex from zero, m: a body of the greatest l, drawn anywhere about it.
pub const FARTHEST: f64 = 10.0;

/// Range of l and ρ, m: the same as for a rod.
pub const LENGTHS: RangeInclusive<f64> = 1e-3..=10.0;
