//! The smallest distance of a polygon's other vertices from the table.

use equipoise_physics::map::polygon::{Outline, VertexClearance};
use equipoise_physics::numbers::trig::sin_cos;
use equipoise_physics::run::orbit::Contact;
use schemars::JsonSchema;
use serde::Serialize;

/// For a polygon: the vertex, other than the contact vertex, that was nearest to the table at any contact. It shows how far the run is from
/// ending as `other_vertex`. Absent for other bodies, and without a contact.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct NearestVertex {
    /// Number of the vertex, from 0.
    vertex: usize,
    /// Distance of the vertex from the line of the table, m. Negative below it.
    clearance: f64,
    /// Number of the impact.
    impact: u64,
    /// Time since the release, s.
    t: f64,
}

impl NearestVertex {
    /// The nearer of the nearest vertex so far and the nearest at a contact.
    pub(crate) fn or(so_far: Option<Self>, outline: &Outline, contact: &Contact) -> Self {
        let VertexClearance { vertex, clearance } = outline.nearest(sin_cos(contact.state.theta - contact.alpha));
        match so_far {
            Some(nearest) if nearest.clearance <= clearance => nearest,
            _ => Self { vertex, clearance, impact: contact.n, t: contact.t },
        }
    }
}
