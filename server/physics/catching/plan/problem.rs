//! Problem of a plan: the body, its bounces with their derivatives, and the reasons for which there is no plan.

use crate::catching::aim::Aim;
use crate::map::body::{Arrival, Body, NoContact, PreImpact, Touch};
use crate::map::friction::{Friction, RestitutionLaw, Slide};
use crate::map::strike::{Rod, State, Strike};
use crate::map::table::actuator_load::LimitViolation;
use crate::numbers::dual::{Dual, SecondOrder};
use crate::numbers::number::{Arithmetic, Number};
use crate::run::rules::SPEED_LIMIT;
use nalgebra::{Matrix5, Matrix6, Vector5};
use thiserror::Error;

/// Strikes of equal height ratio, and a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanProblem {
    /// The body as the table believes it to be ([`believed_body`]). A finished plan is checked against its outline.
    pub body: Body,
    /// Number N of strikes before the stop.
    pub strikes: u32,
    /// Height ratio of each of them, > 0.
    pub ratio: f64,
}

impl PlanProblem {
    pub(super) fn check(&self) -> Result<(), PlanFailure> {
        let is_in_range = (FEWEST_STRIKES..=MOST_STRIKES).contains(&self.strikes);
        if is_in_range { Ok(()) } else { Err(PlanFailure::Strikes(self.strikes)) }
    }
}

/// A rod of the restitution that the table believes in, in contacts with friction μ with which the table moves along.
pub fn believed_body(rod: Rod, friction: f64) -> Body {
    // All laws agree on a contact point that is at rest on the table.
    let friction = Friction { coefficient: friction, law: RestitutionLaw::Poisson, slide: Slide::Matched };
    Body { friction: Some(friction), ..Body::plain(rod) }
}

/// The end of a plan, and the tilts from which it counts changes.
#[derive(Clone, Debug)]
pub(super) struct Goal {
    /// True for x = θ = ẋ = θ̇ = 0 at the end with the least Σ(α − α₀)². False for an end as near to that as changes of the tilts are worth:
    /// Σ(α − α₀)² + w(x²/l² + θ² + ẋ²/(Gl) + θ̇²l/G) is least. The last strikes of a plan are too few for all four.
    pub(super) must_rest: bool,
    /// w, rad². An end at rest has it for steps that do not grow along the bounces, and no answer depends on it.
    pub(super) end_weight: f64,
    /// α₀ of the strikes, rad; 0 without one.
    tilts: Vec<f64>,
}

impl Goal {
    pub(super) fn rest() -> Self {
        Self { must_rest: true, end_weight: 1e4, tilts: Vec::new() }
    }

    /// An end near rest, with changes from these tilts, rad.
    pub(super) fn near_rest(tilts: Vec<f64>) -> Self {
        Self { must_rest: false, end_weight: 100.0, tilts }
    }

    /// α₀ of a strike, from 0.
    pub(super) fn free_tilt(&self, strike: usize) -> f64 {
        self.tilts.get(strike).copied().unwrap_or(0.0)
    }
}

/// Number of variables that a bounce depends on nonlinearly: θ, ẋ, θ̇, ẏ and α. The next place is x and a way that does not depend on x.
pub(super) const VARIABLES: usize = 5;

pub(super) struct LinearizedBounce {
    pub(super) next: Vector5<f64>,
    /// Derivative of the next node by the node.
    pub(super) by_node: Matrix5<f64>,
    /// Derivative of the next node by the tilt.
    pub(super) by_tilt: Vector5<f64>,
    rows: [SecondOrder<VARIABLES>; 5],
}

impl LinearizedBounce {
    /// Second derivative of the weighted sum of the next node's components, by the node's components and the tilt.
    pub(super) fn curvature(&self, weights: &Vector5<f64>) -> Matrix6<f64> {
        Matrix6::from_fn(|row, column| match (row, column) {
            (0, _) | (_, 0) => 0.0,
            _ => {
                let second = |component: &SecondOrder<VARIABLES>| component.partials[row - 1].partials[column - 1];
                self.rows.iter().zip(weights).map(|(component, weight)| weight * second(component)).sum()
            }
        })
    }
}

/// A contact of a plan as a vector: x, θ, ẋ, θ̇ and ẏ, so that the four that are to vanish come first.
pub(super) fn node(coming: &PreImpact) -> Vector5<f64> {
    let State { theta, x_dot, y_dot, theta_dot } = coming.state;
    Vector5::new(coming.x, theta, x_dot, theta_dot, y_dot)
}

/// The contact with this node and with its contact point `clearance` (m) above y = 0.
pub(super) fn contact_at(n: u64, node: &Vector5<f64>, clearance: f64) -> PreImpact {
    let [x, theta, x_dot, theta_dot, y_dot] = (*node).into();
    PreImpact { clearance, ..PreImpact::at(n, x, State { theta, x_dot, y_dot, theta_dot }) }
}

/// The contact with the motion of a table at the tilt `alpha` (rad) that gives the height ratio `ratio`, and its strike.
pub(super) fn aimed<N: Number>(
    body: &Body<N>,
    coming: &PreImpact<N>,
    alpha: N,
    ratio: f64,
) -> Result<(PreImpact<N>, Strike<N>), Obstacle> {
    let aim = Aim::new(body, &coming.state, alpha);
    if aim.contact_speed.to_f64() >= 0.0 {
        return Err(Obstacle::Rising);
    }
    let impulse = aim.impulse_for(N::from_f64(ratio));
    // An impulse that is not a number does not push either.
    if !impulse.to_f64().gt(&0.0) {
        return Err(Obstacle::CannotPush);
    }
    let coming = PreImpact { plan: Some(aim.motion(impulse)), ..*coming };
    Ok((coming, body.strike(&coming)))
}

pub(super) fn flown<N: Number>(
    body: &Body<N>,
    struck: &PreImpact<N>,
    strike: &Strike<N>,
) -> Result<Arrival<N>, Obstacle> {
    let rises = strike.contact_rise.to_f64() > 0.0 || struck.clearance.to_f64() != 0.0;
    let arrival = if rises { body.fly(struck, strike) } else { Err(NoContact::Sinking) };
    arrival
        .map_err(Obstacle::from)
        .and_then(|arrival| if arrival.t.to_f64().is_finite() { Ok(arrival) } else { Err(Obstacle::ContactLost) })
}

impl LinearizedBounce {
    /// The bounce of a body from a contact of a plan, with a strike at the tilt `alpha` (rad) and the height ratio `ratio`.
    pub(super) fn new(
        body: &Body<SecondOrder<VARIABLES>>,
        from: &PreImpact,
        alpha: f64,
        ratio: f64,
    ) -> Result<Self, Obstacle> {
        let constant = SecondOrder::from_f64;
        let variable = |value, index| Dual::along(Dual::along(value, index, 1.0), index, 1.0);
        let State { theta, x_dot, y_dot, theta_dot } = from.state;
        let state = State {
            theta: variable(theta, 0),
            x_dot: variable(x_dot, 1),
            theta_dot: variable(theta_dot, 2),
            y_dot: variable(y_dot, 3),
        };
        let coming =
            PreImpact { clearance: constant(from.clearance), ..PreImpact::at(from.n, constant(from.x), state) };
        let (struck, strike) = aimed(body, &coming, variable(alpha, 4), ratio)?;
        let arrival = flown(body, &struck, &strike)?;
        let State { theta, x_dot, y_dot, theta_dot } = arrival.state;
        let fast = [x_dot, y_dot, body.rod.contact_distance * theta_dot].map(Number::to_f64);
        if fast.iter().any(|speed| !speed.abs().lt(&SPEED_LIMIT)) {
            return Err(Obstacle::ContactLost);
        }
        let rows = [coming.x + arrival.way, theta, x_dot, theta_dot, y_dot];
        Ok(Self {
            next: rows.map(Number::to_f64).into(),
            by_node: Matrix5::from_fn(|row, column| match column {
                0 => f64::from(u8::from(row == 0)),
                _ => rows[row].value.partials[column - 1],
            }),
            by_tilt: Vector5::from_fn(|row, _| rows[row].value.partials[VARIABLES - 1]),
            rows,
        })
    }
}

impl From<NoContact> for Obstacle {
    fn from(no_contact: NoContact) -> Self {
        match no_contact {
            NoContact::OtherVertex(touch) => Self::OtherVertex(touch),
            NoContact::TooManyPieces | NoContact::Sinking | NoContact::Missed => Self::ContactLost,
        }
    }
}

/// Fewest strikes before the stop: four numbers are to vanish, and each strike has one tilt.
pub const FEWEST_STRIKES: u32 = 4;

/// Most strikes before the stop.
pub const MOST_STRIKES: u32 = 40;

/// Reason for which a bounce of a plan cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum Obstacle {
    #[error("the contact point does not come down to the table")]
    Rising,
    #[error("the table would have to pull")]
    CannotPush,
    #[error("the flight after it meets no table")]
    ContactLost,
    #[error("vertex {} {}", .0.vertex, met(.0))]
    OtherVertex(Touch),
    #[error("it needs {0}")]
    BeyondLimits(LimitViolation),
}

/// Reason for which there is no plan.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum PlanFailure {
    /// Fewer strikes than [`super::FEWEST_STRIKES`], or more than [`super::MOST_STRIKES`]: how many.
    #[error("a plan has from {FEWEST_STRIKES} to {MOST_STRIKES} strikes before its stop, not {0}")]
    Strikes(u32),
    #[error(
        "the tilts of {strikes} strikes did not converge in {iterations} steps: an error of {residual} (m, rad, m/s or rad/s) is left"
    )]
    NotConverged {
        strikes: u32,
        iterations: u32,
        /// Largest error that is left, in m, rad, m/s and rad/s.
        residual: f64,
    },
    #[error("strike {strike} of the plan cannot be: {obstacle}")]
    Blocked {
        /// Number of the strike, from 1 at the contact where the plan begins.
        strike: u32,
        obstacle: Obstacle,
    },
}

fn met(touch: &Touch) -> String {
    match touch.t {
        0.0 => "is below the tilted table".to_owned(),
        t => format!("comes down to the table {t} s after it"),
    }
}
