//! Planning again at each strike, from the state that has come, so that an error of the table or of what it believes does not grow.

use super::bounce::Node;
use super::failure::{FEWEST_STRIKES, MOST_STRIKES, PlanFailure};
use super::problem::{Goal, PlanProblem};
use super::shooting::{Solution, solve, solve_from_upright};
use super::trajectory::Trajectory;
use crate::body::PreImpact;

/// A plan that is made again at each strike for the strikes that are left.
///
/// The last strikes before the stop are fewer than the four numbers that are to vanish. They change the tilts of the plan before by as much as
/// the error of the end is worth.
#[derive(Clone, Debug)]
pub struct Replanner {
    problem: PlanProblem,
    /// Strikes that are left before the stop.
    left: u32,
    /// The plan for them, as it was made at the strike before.
    last: Option<Trajectory>,
}

/// Strike that a plan wants next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NextStrike {
    /// α, rad.
    pub alpha: f64,
    /// Height ratio; 0 for the stop.
    pub ratio: f64,
}

impl Replanner {
    /// A planner at the first contact of a catch.
    ///
    /// # Errors
    /// [`PlanFailure::Strikes`] for a number of strikes out of range.
    pub fn new(problem: PlanProblem) -> Result<Self, PlanFailure> {
        if !(FEWEST_STRIKES..=MOST_STRIKES).contains(&problem.strikes) {
            return Err(PlanFailure::Strikes(problem.strikes));
        }
        Ok(Self { problem, left: problem.strikes, last: None })
    }

    /// Number of strikes that are left before the stop.
    pub fn left(&self) -> u32 {
        self.left
    }

    /// Plans on with another restitution.
    pub fn believe(&mut self, restitution: f64) {
        self.problem.body.rod.restitution = restitution;
    }

    /// The strike of a coming contact. All after the last one are stops: a table that is wrong about the restitution needs several.
    ///
    /// # Errors
    /// The reason for which there is no plan.
    pub fn next(&mut self, coming: &PreImpact, go_on: &mut dyn FnMut() -> bool) -> Result<NextStrike, PlanFailure> {
        if self.left == 0 {
            return Ok(NextStrike { alpha: 0.0, ratio: 0.0 });
        }
        let problem = PlanProblem { strikes: self.left, ..self.problem };
        let first = Node { x: coming.x, state: coming.state };
        let warm = self.last.take().map(|mut trajectory| {
            trajectory.nodes[0] = first.to_vector();
            trajectory
        });
        let solution = Self::plan(&problem, coming.clearance, warm, (&first, go_on))?;
        let Solution { trajectory: Trajectory { mut nodes, mut tilts }, .. } = solution;
        let alpha = tilts.remove(0);
        nodes.remove(0);
        self.left -= 1;
        self.last = Some(Trajectory { nodes, tilts });
        Ok(NextStrike { alpha, ratio: self.problem.ratio })
    }

    /// The plan to rest if there is one, else to near it; from the plan before, else from a body that bounces upright.
    fn plan(
        problem: &PlanProblem,
        clearance: f64,
        warm: Option<Trajectory>,
        (first, go_on): (&Node, &mut dyn FnMut() -> bool),
    ) -> Result<Solution, PlanFailure> {
        let tilts = warm.as_ref().map_or_else(Vec::new, |warm| warm.tilts.clone());
        let near = Goal::NearRest { tilts };
        let mut failure = PlanFailure::Strikes(problem.strikes);
        let goals = if problem.strikes >= FEWEST_STRIKES { &[Goal::Rest, near][..] } else { &[near][..] };
        for goal in goals {
            let warm = warm.clone().and_then(|start| solve(problem, goal, clearance, start, go_on).ok());
            match warm.map_or_else(|| solve_from_upright(problem, goal, clearance, first, go_on), Ok) {
                Ok(solution) => return Ok(solution),
                Err(reason) => failure = reason,
            }
        }
        Err(failure)
    }
}
