//! A plan on its way: nodes and tilts that do not join yet, and their bounces, linearized.

use super::bounce::{BouncingRod, LinearizedBounce, Node};
use super::failure::Obstacle;
use super::problem::PlanProblem;
use crate::bounce::strike::State;
use nalgebra::{Vector4, Vector5};

/// Nodes and tilts of a plan.
#[derive(Clone, Debug)]
pub(super) struct Trajectory {
    /// Nodes just before each strike and before the stop.
    pub(super) nodes: Vec<Vector5<f64>>,
    /// Tilts of the strikes, rad.
    pub(super) tilts: Vec<f64>,
}

/// All bounces of a trajectory, linearized.
pub(super) struct Linearization {
    pub(super) bounces: Vec<LinearizedBounce>,
    /// Gap between the end of each bounce and the next node.
    pub(super) gaps: Vec<Vector5<f64>>,
    /// Largest component of a gap.
    pub(super) largest_gap: f64,
    /// Sum of all components.
    pub(super) sum_of_gaps: f64,
}

impl Trajectory {
    /// A body that bounces upright from the first node on, struck by a level table.
    pub(super) fn upright(problem: &PlanProblem, first: &Node) -> Self {
        let mut nodes = vec![first.to_vector()];
        let mut speed = problem.body.rod.contact_speed(&first.state);
        for _ in 0..problem.strikes {
            speed *= problem.ratio;
            let state = State { theta: 0.0, x_dot: 0.0, y_dot: speed, theta_dot: 0.0 };
            nodes.push(Node { x: 0.0, state }.to_vector());
        }
        Self { nodes, tilts: vec![0.0; problem.strikes as usize] }
    }

    /// Linearizes every bounce at its own node. The first contact is `clearance` (m) above y = 0.
    ///
    /// # Errors
    /// The first strike that cannot be, from 1, and the reason.
    pub(super) fn linearized(
        &self,
        body: &BouncingRod,
        clearance: f64,
        ratio: f64,
    ) -> Result<Linearization, (u32, Obstacle)> {
        let mut bounces = Vec::with_capacity(self.tilts.len());
        let mut gaps = Vec::with_capacity(self.tilts.len());
        let (mut largest_gap, mut sum_of_gaps) = (0.0_f64, 0.0);
        for (place, (tilt, pair)) in self.tilts.iter().zip(self.nodes.windows(2)).enumerate() {
            let clearance = if place == 0 { clearance } else { 0.0 };
            let bounce = body
                .linearized(&Node::from_vector(&pair[0]), clearance, *tilt, ratio)
                .map_err(|obstacle| (place as u32 + 1, obstacle))?;
            let gap = bounce.next - pair[1];
            largest_gap = largest_gap.max(gap.amax());
            sum_of_gaps += gap.abs().sum();
            gaps.push(gap);
            bounces.push(bounce);
        }
        Ok(Linearization { bounces, gaps, largest_gap, sum_of_gaps })
    }

    /// x, θ, ẋ and θ̇ before the stop.
    pub(super) fn end(&self) -> Vector4<f64> {
        self.nodes.last().map_or_else(Vector4::zeros, |node| node.fixed_rows::<4>(0).into_owned())
    }
}
