//! Plans of a catch: strikes of least tilts that bring the body to rest upright above x = 0, and a stop.
//!
//! N strikes have one height ratio. The stop is a strike of ratio 0 by a level table: the body comes to it straight down, so that an error of
//! its time costs nothing.

mod problem;
mod shooting;

pub use problem::{FEWEST_STRIKES, MOST_STRIKES, Obstacle, PlanFailure, PlanProblem, believed_body};

use crate::catching::aim::rise_before;
use crate::catching::plan::problem::{Goal, aimed, flown, node};
use crate::catching::plan::shooting::{Solution, Trajectory, solve, solve_from_upright};
use crate::map::body::{Body, PreImpact};
use crate::map::strike::Strike;
use crate::map::table::actuator_load::{ActuatorLimits, ActuatorLoad, LoadTracker, Pose};

/// A strike of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedStrike {
    /// Time since the contact at which the plan begins, s.
    pub t: f64,
    /// The contact, with the motion of the table.
    pub coming: PreImpact,
    /// α, rad.
    pub alpha: f64,
    /// Height ratio ẏ_c⁺/|ẏ_c|: 0 of the stop.
    pub ratio: f64,
    /// The strike, and with it the motion of the table and the state just after.
    pub strike: Strike,
    /// Time to the next strike, s; `None` after the stop.
    pub flight_time: Option<f64>,
}

/// A plan from a contact to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct CatchPlan {
    /// Strikes in their order; the last is the stop.
    pub strikes: Vec<PlannedStrike>,
    /// Largest error of a joint between two bounces and of x, θ, ẋ, θ̇ at the end, in m, rad, m/s and rad/s.
    pub residual: f64,
    /// Steps of the solver.
    pub iterations: u32,
    /// Σα², rad².
    pub cost: f64,
    /// Load of the strikes on the table.
    pub load: ActuatorLoad,
}

/// Plans the strikes from a coming contact on, within the limits of the table and with no other vertex of the body on it. A finished plan is
/// checked; the solver does not steer around them. There is no plan once `go_on` says `false`.
pub fn plan_catch(
    problem: &PlanProblem,
    coming: &PreImpact,
    limits: Option<&ActuatorLimits>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<CatchPlan, PlanFailure> {
    problem.check()?;
    let body = &problem.body;
    let free = PlanProblem { body: Body { outline: None, ..*body }, ..*problem };
    let Solution { trajectory, residual, steps } = solve_from_upright(&free, &Goal::rest(), coming, go_on)?;
    let cost = trajectory.tilts.iter().map(|tilt| tilt * tilt).sum();
    let plan = trajectory.tilts.iter().map(|tilt| (*tilt, problem.ratio)).chain([(0.0, 0.0)]);
    let mut strikes = Vec::with_capacity(trajectory.nodes.len());
    let mut load = LoadTracker::default();
    let mut t = 0.0;
    for (coming, (alpha, ratio)) in trajectory.contacts().zip(plan) {
        let blocked = |obstacle| PlanFailure::Blocked { strike: coming.n as u32, obstacle };
        let (coming, strike) = aimed(body, &coming, alpha, ratio).map_err(blocked)?;
        if let Some(violation) = limits.and_then(|limits| limits.exceeded(&Pose::of(&strike).load(load.last()))) {
            return Err(blocked(Obstacle::BeyondLimits(violation)));
        }
        if let Some(touch) = body.touches(&coming, &strike) {
            return Err(blocked(Obstacle::OtherVertex(touch)));
        }
        let is_stop = ratio == 0.0;
        let flight_time = if is_stop { None } else { Some(flown(body, &coming, &strike).map_err(blocked)?.t) };
        load.track(&strike, flight_time);
        strikes.push(PlannedStrike { t, coming, alpha, ratio, strike, flight_time });
        t += flight_time.unwrap_or(0.0);
    }
    Ok(CatchPlan { strikes, residual, iterations: steps, cost, load: load.most })
}

/// Most strikes that are tried.
pub const MOST_TRIED: u32 = 12;

/// Tilt, rad, below which a plan is calm: the reach of the hold is some 0.3 rad, and more strikes take more time.
pub const CALM_TILT: f64 = 0.25;

/// Share of the least tilt so far that a further strike has to save; a plan that does not is the last that is tried.
const WORTH: f64 = 0.03;

/// Reason for a number of strikes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StrikesReason {
    /// The fewest with all tilts within this, rad.
    FewestWithin(f64),
    /// No number that was tried keeps its tilts within this, rad; the plan has the least tilt of them.
    LeastTilt(f64),
}

/// Plan with a number of strikes that was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenPlan {
    /// The plan.
    pub plan: CatchPlan,
    /// Strikes before the stop.
    pub strikes: u32,
    /// Reason for their number.
    pub reason: StrikesReason,
}

/// The plan of the fewest strikes whose tilts are calm; if there is none, the plan of the least tilt, with more strikes as
/// long as each of them lowers the tilt. `problem.strikes` is ignored.
/// Fails with the reason for which there is no plan of [`MOST_TRIED`] strikes, if there is none at all.
pub fn choose_plan(
    problem: &PlanProblem,
    coming: &PreImpact,
    limits: Option<&ActuatorLimits>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<ChosenPlan, PlanFailure> {
    let calm = limits.map_or(CALM_TILT, |limits| limits.tilt.min(CALM_TILT));
    let mut best: Option<(CatchPlan, u32)> = None;
    let mut failure = PlanFailure::Strikes(0);
    for strikes in FEWEST_STRIKES..=MOST_TRIED {
        let made = plan_catch(&PlanProblem { strikes, ..*problem }, coming, limits, go_on);
        let Ok(plan) = made.inspect_err(|reason| failure = *reason) else { continue };
        let tilt = plan.load.tilt;
        if tilt <= calm {
            return Ok(ChosenPlan { plan, strikes, reason: StrikesReason::FewestWithin(calm) });
        }
        let least = best.as_ref().map_or(f64::INFINITY, |(best, _)| best.load.tilt);
        if tilt < least {
            best = Some((plan, strikes));
        }
        if tilt > (1.0 - WORTH) * least {
            break;
        }
    }
    let (plan, strikes) = best.ok_or(failure)?;
    Ok(ChosenPlan { plan, strikes, reason: StrikesReason::LeastTilt(calm) })
}

/// A plan that is made again at each strike for the strikes that are left.
///
/// The last strikes before the stop are fewer than the four numbers that are to vanish. They change the tilts of the plan before by as much as
/// the error of the end is worth.
#[derive(Clone, Debug)]
pub struct Replanner {
    /// The problem of the strikes that are left before the stop.
    problem: PlanProblem,
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
    pub fn new(problem: PlanProblem) -> Result<Self, PlanFailure> {
        problem.check()?;
        Ok(Self { problem, last: None })
    }

    /// Plans on with another restitution.
    pub fn believe(&mut self, restitution: f64) {
        self.problem.body.rod.restitution = restitution;
    }

    /// The strike of a coming contact. All after the last one are stops: a table that is wrong about the restitution needs several.
    pub fn next(&mut self, coming: &PreImpact, go_on: &mut dyn FnMut() -> bool) -> Result<NextStrike, PlanFailure> {
        let Self { problem, last } = self;
        if problem.strikes == 0 {
            return Ok(NextStrike { alpha: 0.0, ratio: 0.0 });
        }
        let warm = last.take().map(|mut trajectory| {
            (trajectory.clearance, trajectory.nodes[0]) = (coming.clearance, node(coming));
            trajectory
        });
        let mut trajectory = plan_on(problem, warm, coming, go_on)?.trajectory;
        let alpha = trajectory.tilts.remove(0);
        trajectory.nodes.remove(0);
        problem.strikes -= 1;
        *last = Some(trajectory);
        Ok(NextStrike { alpha, ratio: problem.ratio })
    }
}

/// The plan to rest if there is one, else to near it; from the plan before, else from a body that bounces upright.
fn plan_on(
    problem: &PlanProblem,
    warm: Option<Trajectory>,
    first: &PreImpact,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Solution, PlanFailure> {
    let tilts = warm.as_ref().map_or_else(Vec::new, |warm| warm.tilts.clone());
    let rest = (problem.strikes >= FEWEST_STRIKES).then(Goal::rest);
    let mut failure = PlanFailure::Strikes(problem.strikes);
    for goal in rest.into_iter().chain([Goal::near_rest(tilts)]) {
        let warm = warm.clone().and_then(|start| solve(problem, &goal, start, go_on).ok());
        match warm.map_or_else(|| solve_from_upright(problem, &goal, first, go_on), Ok) {
            Ok(solution) => return Ok(solution),
            Err(reason) => failure = reason,
        }
    }
    Err(failure)
}

/// Difference from the belief below which strikes are taken to confirm it: noise of rounding, not of the contact.
const CONFIRMED: f64 = 1e-6;

/// A strike that was aimed, until the next contact shows what it did.
#[derive(Clone, Copy, Debug)]
struct AimedStrike {
    /// Height of the centre of gravity, m.
    height: f64,
    /// ẏ before, m/s.
    y_dot: f64,
    /// Change of ẏ for each unit of 1 + e, m/s.
    unit: f64,
}

/// Least squares of 1 + e over the strikes so far; strong strikes weigh more.
#[derive(Clone, Copy, Debug, Default)]
pub struct LearnedRestitution {
    /// ΣJ², m²/s².
    squares: f64,
    /// ΣJP, m²/s².
    products: f64,
    last: Option<AimedStrike>,
}

impl LearnedRestitution {
    /// Remembers a strike of `body` at the tilt `alpha` (rad) with the height ratio `ratio`.
    pub fn aimed(&mut self, body: &Body, coming: &PreImpact, alpha: f64, ratio: f64) {
        self.last = aimed(body, coming, alpha, ratio).ok().map(|(_, strike)| AimedStrike {
            height: coming.height(&body.rod),
            y_dot: coming.state.y_dot,
            unit: (strike.after.y_dot - coming.state.y_dot) / (1.0 + body.rod.restitution),
        });
    }

    /// The restitution that the strikes have shown up to a coming contact, if it is not that of `body`.
    pub fn seen(&mut self, body: &Body, coming: &PreImpact) -> Option<f64> {
        let AimedStrike { height: from, y_dot, unit } = self.last.take()?;
        let (rise, _) = rise_before(body, coming.height(&body.rod) - from, coming.state.y_dot);
        let change = rise - y_dot;
        self.squares += unit * unit;
        self.products += unit * change;
        let shown = self.products / self.squares - 1.0;
        // A sum that is not a number shows nothing.
        ((shown - body.rod.restitution).abs() > CONFIRMED).then_some(shown.clamp(0.0, 1.0))
    }
}
