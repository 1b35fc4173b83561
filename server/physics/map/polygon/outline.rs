//! The outline of a polygonal body about its centre of gravity, and which of its vertices meets the table.

use super::vertices::{LENGTHS, PolygonError, Vertices, cross, dot, minus};
use crate::map::contact_time::{TooManyPieces, first_descent_before};
use crate::map::flight::Flight;
use crate::map::strike::State;
use crate::numbers::number::Arithmetic;
use crate::numbers::trig;
use std::f64::consts::{FRAC_PI_2, PI};

/// A vertex of the body, other than the one that bounces, on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Index of the vertex, from 0.
    pub vertex: usize,
    /// Time since the last contact, or since the release, s.
    pub t: f64,
}

/// Depth below the table at which a vertex still counts as flush with it, as a share of the body's size.
pub const FLUSH: f64 = 1e-9;

/// Lead over the contact vertex with which another vertex counts as earlier, as a share of the flight.
const EARLIER: f64 = 1e-12;

/// A polygon about its centre of gravity, turned so that at θ = 0 that stands straight above the contact vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline {
    /// In the order in which they were given.
    vertices: Vertices,
    /// Index of the contact vertex.
    pub contact_vertex: usize,
    /// l, m.
    pub contact_distance: f64,
    /// ρ, m.
    pub radius_of_gyration: f64,
    pub(crate) clear: ClearRange,
}

/// Angles and motions of an outline at which only its contact vertex touches the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClearRange<N = f64> {
    /// Angles from the table's normal, rad, between which no other vertex is below a table that the contact vertex touches.
    pub(crate) least: N,
    pub(crate) greatest: N,
    /// Distance of the farthest vertex from the centre of gravity, m.
    pub(crate) reach: N,
    /// Distance from the contact vertex to the one farthest from it, m.
    pub(crate) size: N,
}

mapped!(ClearRange: least, greatest, reach, size);

impl ClearRange {
    /// That of a body without other vertices.
    pub(crate) const ALL: Self =
        Self { least: f64::NEG_INFINITY, greatest: f64::INFINITY, reach: 0.0, size: f64::INFINITY };
}

impl<N: Arithmetic> ClearRange<N> {
    /// Tells whether an angle is between its ends. At an angle where a vertex may be below, it is false too.
    #[inline(always)]
    pub(crate) fn contains(&self, angle: N) -> N::Mask {
        self.least.is_less(angle) & angle.is_less(self.greatest)
    }
}

/// A vertex near the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexClearance {
    /// Index in the order in which the vertices were given, from 0.
    pub vertex: usize,
    /// Distance from the table, m; negative below it.
    pub clearance: f64,
}

impl Outline {
    /// The body of these vertices on one of them. Fails if they are no simple polygon, l or ρ is out of its range,
    /// or the contact vertex can never be the only one on a flat table.
    pub fn new(vertices: &Vertices, contact_vertex: usize) -> Result<Self, PolygonError> {
        vertices.check()?;
        let count = vertices.count;
        if contact_vertex >= count {
            return Err(PolygonError::of_contact_vertex(format!(
                "contact_vertex is {contact_vertex}; of {count} vertices it must be from 0 to {}",
                count - 1
            )));
        }
        let (least, most) = (LENGTHS.start(), LENGTHS.end());
        let vertices = &vertices.about_the_first();
        let (centre, radius_of_gyration) = vertices.centre_and_radius();
        if !LENGTHS.contains(&radius_of_gyration) {
            return Err(PolygonError::new(format!(
                "the polygon has a radius of gyration of {radius_of_gyration} m; it must be from {least} to {most} m"
            )));
        }
        let down = minus(vertices.places[contact_vertex], centre);
        let contact_distance = dot(down, down).sqrt();
        if !LENGTHS.contains(&contact_distance) {
            return Err(PolygonError::of_contact_vertex(format!(
                "contact_vertex {contact_vertex} is {contact_distance} m from the centre of gravity; it must be from {least} to {most} m"
            )));
        }
        let down = down.map(|it| it / contact_distance);
        let mut turned = *vertices;
        for place in &mut turned.places[..count] {
            let from_centre = minus(*place, centre);
            *place = [cross(down, from_centre), -dot(from_centre, down)];
        }
        turned.places[contact_vertex] = [0.0, -contact_distance];
        let mut outline =
            Self { vertices: turned, contact_vertex, contact_distance, radius_of_gyration, clear: ClearRange::ALL };
        // Seen from a corner of the hull, all lies within less than half a turn.
        let (mut left, mut right) = (0.0_f64, 0.0_f64);
        let (mut size, mut reach) = (0.0_f64, contact_distance);
        for (_, [x, y]) in outline.others() {
            let angle = libm::atan2(x, y + contact_distance);
            (left, right) = (left.min(angle), right.max(angle));
            size = size.max(dot([x, y + contact_distance], [x, y + contact_distance]).sqrt());
            reach = reach.max(dot([x, y], [x, y]).sqrt());
        }
        if right - left > PI - FLUSH {
            return Err(PolygonError::of_contact_vertex(format!(
                "contact_vertex {contact_vertex} is no corner of the polygon's convex hull: another vertex always reaches a flat table \
                 before it"
            )));
        }
        // A vertex r from the contact vertex, at an angle a from the body's axis, is r cos(a − β) above the table.
        outline.clear = ClearRange { least: right - FRAC_PI_2, greatest: left + FRAC_PI_2, reach, size };
        Ok(outline)
    }

    /// The vertices about the centre of gravity at θ = 0, m, in the order in which they were given.
    pub fn vertices(&self) -> &[[f64; 2]] {
        self.vertices.places()
    }

    fn others(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        let contact_vertex = self.contact_vertex;
        self.vertices().iter().copied().enumerate().filter(move |(vertex, _)| *vertex != contact_vertex)
    }

    /// The vertex beside the contact vertex that is nearest to the table, or deepest below it, where that touches the
    /// contact vertex: given sin β, cos β of β = θ − α.
    pub fn nearest(&self, sin_cos_beta: (f64, f64)) -> VertexClearance {
        self.nearest_beside(self.contact_vertex, None, sin_cos_beta)
    }

    /// [`Outline::nearest`] of a body that stands on any of its vertices, without one of the others.
    pub(crate) fn nearest_beside(
        &self,
        stands: usize,
        without: Option<usize>,
        (sin, cos): (f64, f64),
    ) -> VertexClearance {
        let [x_stands, y_stands] = self.vertices.places[stands];
        let mut nearest = VertexClearance { vertex: stands, clearance: f64::INFINITY };
        for (vertex, [x, y]) in self.vertices().iter().enumerate() {
            let clearance = (x - x_stands) * sin + (y - y_stands) * cos;
            if vertex != stands && Some(vertex) != without && clearance < nearest.clearance {
                nearest = VertexClearance { vertex, clearance };
            }
        }
        nearest
    }

    /// [`Outline::nearest`] at an angle β (rad) from the table's normal, where it is below the table by more than [`FLUSH`] of the body's
    /// size: an edge may lie on it.
    pub fn below_table(&self, beta: f64) -> Option<VertexClearance> {
        if self.clear.contains(beta) {
            return None;
        }
        let nearest = self.nearest(trig::sin_cos(beta));
        (nearest.clearance < -FLUSH * self.clear.size).then_some(nearest)
    }

    /// The first vertex that comes down to y = 0 in a flight of the contact vertex, before that arrives at the time
    /// `arrival`; one that is below y = 0 already, or flush with it and sinking, has to rise first.
    pub fn first_touch(&self, flight: &Flight, arrival: f64) -> Result<Option<Touch>, TooManyPieces> {
        let State { theta, theta_dot, .. } = flight.start;
        let (sin, cos) = flight.sin_cos_theta;
        let drop = flight.clearance + flight.contact_distance * cos;
        let fall = flight.travel(arrival).1;
        let end_theta = flight.end(arrival).theta;
        let (end_sin, end_cos) = trig::sin_cos(end_theta);
        // The common case, of all vertices at once: each has a height without inflection, and ends no lower than the contact vertex.
        let contact_is_up = drop + fall - self.contact_distance * end_cos >= -0.5 * FLUSH * self.clear.size;
        let is_concave = |distance: f64| flight.drag.is_none() && distance * theta_dot * theta_dot <= flight.gravity;
        if contact_is_up && self.clear.contains(end_theta) && is_concave(self.clear.reach) {
            return Ok(None);
        }
        let mut first: Option<Touch> = None;
        for (vertex, [x, y]) in self.others() {
            let distance = dot([x, y], [x, y]).sqrt();
            // A vertex that ends above y = 0, and whose height has no inflection, comes down later.
            let below = drop + fall + (x * end_sin + y * end_cos) < -FLUSH * self.clear.size;
            if !below && is_concave(distance) {
                continue;
            }
            let clearance = drop + (x * sin + y * cos);
            let own = Flight {
                start: State { theta: theta + libm::atan2(x, -y), ..flight.start },
                // An angle φ on, with sin φ = x/r, cos φ = −y/r.
                sin_cos_theta: if distance == 0.0 {
                    (0.0, 1.0)
                } else {
                    ((cos * x - sin * y) / distance, -(cos * y + sin * x) / distance)
                },
                clearance: if clearance.abs() <= FLUSH * self.clear.size { 0.0 } else { clearance },
                contact_distance: distance,
                gravity: flight.gravity,
                drag: flight.drag,
            };
            let limit = first.map_or(arrival * (1.0 - EARLIER), |touch| touch.t);
            if let Some(t) = first_descent_before(&own, limit)?
                && t < limit
            {
                first = Some(Touch { vertex, t });
            }
        }
        Ok(first)
    }
}
