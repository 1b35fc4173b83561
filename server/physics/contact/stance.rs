//! The vertex on which a body stands on the table: the rod from the centre of gravity to it, and the clearance of the others.

use crate::body::polygon::Outline;
use crate::bounce::strike::Rod;
use crate::contact::request::HoldRequest;
use crate::numbers::trig;

/// A body that stands on one of its vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stance {
    /// The rod from the centre of gravity to the vertex.
    pub(super) rod: Rod,
    /// Angle of that rod when θ = 0, rad: 0 for the contact vertex.
    pub(super) turn: f64,
    /// The vertex of a polygon.
    vertex: usize,
    outline: Option<Outline>,
}

/// The end of a vertex on the table by the landing of another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Landing {
    /// θ̇⁺/θ̇⁻; not positive if the body stops on the edge.
    pub(super) ratio: f64,
    /// |P_t|/P_n of the impulse.
    pub(super) needed_friction: f64,
    /// True if the centre of gravity is between the two vertices, so that the edge bears the body.
    pub(super) bears: bool,
    /// Both vertices, the smaller index first.
    pub(super) edge: [usize; 2],
    /// The body on its new vertex.
    pub(super) stance: Stance,
}

impl Stance {
    /// The body on its contact vertex.
    pub(super) fn new(request: &HoldRequest) -> Self {
        let vertex = request.outline.map_or(0, |outline| outline.contact_vertex());
        Self { rod: request.rod, turn: 0.0, vertex, outline: request.outline }
    }

    /// From the centre of gravity to a vertex, at the angle θ.
    fn arm(&self, vertex: usize, theta: f64) -> [f64; 2] {
        let (sin, cos) = trig::sin_cos(theta);
        let place = self.outline.as_ref().and_then(|outline| outline.vertices().get(vertex).copied());
        let [x, y] = place.unwrap_or([0.0, -self.rod.contact_distance]);
        [x * cos - y * sin, x * sin + y * cos]
    }

    /// The vertex nearest to the table beside the one that stands on it and `without`, with its distance from the table, m.
    pub(super) fn nearest(&self, theta: f64, alpha: f64, without: Option<usize>) -> Option<(usize, f64)> {
        let outline = self.outline.as_ref()?;
        let (sin, cos) = trig::sin_cos(theta - alpha);
        let here = outline.vertices().get(self.vertex)?;
        let mut nearest: Option<(usize, f64)> = None;
        for (vertex, [x, y]) in outline.vertices().iter().enumerate() {
            if vertex == self.vertex || Some(vertex) == without {
                continue;
            }
            let clearance = (x - here[0]) * sin + (y - here[1]) * cos;
            if nearest.is_none_or(|(_, least)| clearance < least) {
                nearest = Some((vertex, clearance));
            }
        }
        nearest
    }

    /// Plastic landing of `vertex` at the angle θ of a body that turns about its present vertex at θ̇.
    ///
    /// The angular momentum about the landing vertex is kept: θ̇⁺/θ̇⁻ = (ρ² + r_A·r_B)/(ρ² + |r_B|²) if both vertices stick. On a table
    /// without friction the impulse is vertical, and the horizontal parts of both arms take their place.
    pub(super) fn land(&self, vertex: usize, theta: f64, sticks: bool) -> Landing {
        let (from, onto) = (self.arm(self.vertex, theta), self.arm(vertex, theta));
        let share = if sticks { 1.0 } else { 0.0 };
        let rho_squared = self.rod.radius_of_gyration * self.rod.radius_of_gyration;
        let ratio = (rho_squared + from[0] * onto[0] + share * from[1] * onto[1])
            / (rho_squared + onto[0] * onto[0] + share * onto[1] * onto[1]);
        // The centre of gravity moves at θ̇(r_y, −r_x) about a vertex at r from it. A body that stops loses all of that.
        let kept = ratio.max(0.0);
        let impulse = [kept * onto[1] - from[1], from[0] - kept * onto[0]];
        let outline = self.outline.as_ref();
        let place = outline.and_then(|outline| outline.vertices().get(vertex).copied()).unwrap_or_default();
        let distance = (place[0] * place[0] + place[1] * place[1]).sqrt();
        Landing {
            ratio,
            needed_friction: if sticks { (impulse[0] / impulse[1]).abs() } else { 0.0 },
            bears: from[0] * onto[0] < 0.0,
            edge: [self.vertex.min(vertex), self.vertex.max(vertex)],
            stance: Self {
                rod: Rod { contact_distance: distance, ..self.rod },
                turn: libm::atan2(place[0], -place[1]),
                vertex,
                outline: self.outline,
            },
        }
    }

    /// The vertex on the table.
    pub(super) fn vertex(&self) -> usize {
        self.vertex
    }
}
