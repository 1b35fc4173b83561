//! A body drawn as a polygon: the centre of gravity, l and ρ that follow from its vertices, and whether any other vertex
//! than the one of contact touches the table.

mod outline;
mod vertices;

pub(crate) use outline::ClearRange;
pub use outline::{FLUSH, Outline, Touch, VertexClearance};
pub use vertices::{FARTHEST, FEWEST_VERTICES, LENGTHS, MAX_VERTICES, PolygonError, Vertices};
