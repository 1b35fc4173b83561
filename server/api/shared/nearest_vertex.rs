//! The smallest distance of a polygon's other vertices from the table.

use equipoise_physics::map::polygon::{Outline, VertexClearance};
use equipoise_physics::numbers::trig::sin_cos;
use equipoise_physics::run::orbit::Contact;
use serde::Serialize;

/// The vertex that was nearest to the table at any contact of a run.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct NearestVertex {
    vertex: usize,
    clearance: f64,
    impact: u64,
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
