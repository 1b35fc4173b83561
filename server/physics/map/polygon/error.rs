//! Reasons for which vertices are no body, in words with numbers, limits and units.

use super::bounds::{FARTHEST, FEWEST_VERTICES, LENGTHS, MAX_VERTICES};
use std::fmt;

/// Reason for which vertices are no body. Vertices are counted from 0; edge i goes from vertex i to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PolygonError {
    /// Fewer than three vertices: how many.
    TooFew(usize),
    /// More than [`MAX_VERTICES`]: how many.
    TooMany(usize),
    /// A coordinate farther from zero than [`FARTHEST`], or not finite.
    TooFar {
        /// Index of the vertex.
        vertex: usize,
        /// The coordinate, m.
        coordinate: f64,
    },
    /// Two vertices at one place.
    Repeated(usize, usize),
    /// Two edges that cross or touch.
    Crossing(usize, usize),
    /// Vertices on a line, or nearly: the area, m², and the least that it may be.
    Flat {
        /// The area, m².
        area: f64,
        /// The least that it may be, m².
        least: f64,
    },
    /// Vertices in clockwise order.
    Clockwise,
    /// No vertex is lower than all others, so it has to be said which is the contact: two of the lowest.
    NoLowest(usize, usize),
    /// The contact vertex is none of the vertices.
    NoSuchVertex {
        /// The contact vertex.
        contact_vertex: usize,
        /// Number of vertices.
        count: usize,
    },
    /// The contact vertex is too near the centre of gravity, or too far.
    ContactDistance {
        /// The contact vertex.
        contact_vertex: usize,
        /// l, m.
        contact_distance: f64,
    },
    /// The body is too small, or too large: ρ, m.
    RadiusOfGyration(f64),
    /// The contact vertex is no corner of the convex hull, so that another vertex always reaches a flat table before it.
    Hidden(usize),
}

impl PolygonError {
    /// Tells whether the choice of the contact vertex is wrong, and not the polygon.
    pub fn is_of_contact_vertex(&self) -> bool {
        matches!(self, Self::NoLowest(..) | Self::NoSuchVertex { .. } | Self::ContactDistance { .. } | Self::Hidden(_))
    }
}

impl fmt::Display for PolygonError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (least, most) = (LENGTHS.start(), LENGTHS.end());
        match self {
            Self::TooFew(count) => {
                write!(f, "vertices are {count}; a polygon has from {FEWEST_VERTICES} to {MAX_VERTICES}")
            }
            Self::TooMany(count) => {
                write!(f, "vertices are {count}; a polygon may have from {FEWEST_VERTICES} to {MAX_VERTICES}")
            }
            Self::TooFar { vertex, coordinate } => {
                write!(
                    f,
                    "vertex {vertex} has a coordinate {coordinate} m; it must be from -{FARTHEST} to {FARTHEST} m"
                )
            }
            Self::Repeated(a, b) => write!(f, "vertices {a} and {b} are at the same place; leave one of them out"),
            Self::Crossing(a, b) => {
                write!(
                    f,
                    "the edges that start at vertices {a} and {b} cross or touch; the outline must not meet itself"
                )
            }
            Self::Flat { area, least } => {
                write!(f, "the polygon is flat: its area is {area} m², and at its length it must be {least} m² or more")
            }
            Self::Clockwise => f.write_str("the vertices go clockwise; reverse their order"),
            Self::NoLowest(a, b) => write!(
                f,
                "contact_vertex is missing: it would be the lowest vertex, and vertices {a} and {b} are equally low"
            ),
            Self::NoSuchVertex { contact_vertex, count } => {
                write!(f, "contact_vertex is {contact_vertex}; of {count} vertices it must be from 0 to {}", count - 1)
            }
            Self::ContactDistance { contact_vertex, contact_distance } => write!(
                f,
                "contact_vertex {contact_vertex} is {contact_distance} m from the centre of gravity; it must be from {least} \
                 to {most} m"
            ),
            Self::RadiusOfGyration(radius) => {
                write!(f, "the polygon has a radius of gyration of {radius} m; it must be from {least} to {most} m")
            }
            Self::Hidden(vertex) => write!(
                f,
                "contact_vertex {vertex} is no corner of the polygon's convex hull: another vertex always reaches a flat \
                 table before it"
            ),
        }
    }
}
