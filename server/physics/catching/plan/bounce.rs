//! One bounce of a plan: the exact strike of a table that aims, and the exact flight to the next contact, with their derivatives.

use super::failure::Obstacle;
use crate::body::Touch;
use crate::body::polygon::Outline;
use crate::bounce::contact_time::{TooManyPieces, first_contact, first_descent};
use crate::bounce::flight::Flight;
use crate::bounce::friction::{Friction, RestitutionLaw, Slide, actual_branch};
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::bounce::table_motion::{PlannedTableMotion, TableMotion};
use crate::bounce::tilt::Tilt;
use crate::catching::aim::Aim;
use crate::numbers::number::{Arithmetic, Number};
use crate::numbers::second_order::SecondOrder;
use crate::run::rules::SPEED_LIMIT;
use nalgebra::{Matrix5, Matrix6, Vector5};

/// Node of a plan: place and state just before a contact. As a vector: x, θ, ẋ, θ̇ and ẏ, so that the four that are to vanish come first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<N = f64> {
    /// Horizontal place of the centre of gravity, m.
    pub x: N,
    /// Angle and velocities.
    pub state: State<N>,
}

/// Number of variables that a bounce depends on nonlinearly: θ, ẋ, θ̇, ẏ and α. The next place is x and a way that does not depend on x.
const VARIABLES: usize = 5;

/// A bounce and its derivatives.
pub(super) struct LinearizedBounce {
    pub(super) next: Vector5<f64>,
    /// Derivative of the next node by the node.
    pub(super) by_node: Matrix5<f64>,
    /// Derivative of the next node by the tilt.
    pub(super) by_tilt: Vector5<f64>,
    /// The next node with derivatives.
    rows: [SecondOrder<VARIABLES>; 5],
}

impl LinearizedBounce {
    /// Second derivative of the weighted sum of the next node's components, by the node's components and the tilt.
    pub(super) fn curvature(&self, weights: &Vector5<f64>) -> Matrix6<f64> {
        Matrix6::from_fn(|row, column| match (row, column) {
            (0, _) | (_, 0) => 0.0,
            _ => {
                self.rows.iter().zip(weights).map(|(row_of, weight)| weight * row_of.second[row - 1][column - 1]).sum()
            }
        })
    }
}

/// A rod as the table believes it to be, in contacts with friction μ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BouncingRod {
    /// The rod, with the restitution that the table believes in.
    pub rod: Rod,
    /// μ, of a contact with which the table moves along.
    pub friction: f64,
}

impl Node {
    pub(super) fn to_vector(self) -> Vector5<f64> {
        let State { theta, x_dot, y_dot, theta_dot } = self.state;
        Vector5::new(self.x, theta, x_dot, theta_dot, y_dot)
    }

    pub(super) fn from_vector(vector: &Vector5<f64>) -> Self {
        let [x, theta, x_dot, theta_dot, y_dot] = (*vector).into();
        Self { x, state: State { theta, x_dot, y_dot, theta_dot } }
    }
}

impl BouncingRod {
    /// The motion of the table at a node and a tilt (rad) that gives the height ratio `ratio`, with the strike and its P_n.
    fn strike<N: Number>(&self, node: &Node<N>, alpha: N, ratio: f64) -> (PlannedTableMotion<N>, Strike<N>, f64) {
        let rod = self.rod.lift::<N>();
        let aim = Aim::new(&rod, self.friction, &node.state, alpha);
        let impulse = aim.impulse_for(N::from_f64(ratio));
        let motion = aim.motion(impulse);
        // All laws agree on a contact point that is at rest on the table.
        let friction =
            Friction { coefficient: N::from_f64(self.friction), law: RestitutionLaw::Poisson, slide: Slide::Matched };
        let tilt = Tilt::new(node.state.theta, alpha, node.state.theta - alpha);
        let strike =
            friction.strike(&rod, &node.state, &tilt, TableMotion::Planned(&motion), rod.leverage(), actual_branch);
        (motion, strike, impulse.to_f64())
    }

    /// [`BouncingRod::strike`] in doubles.
    ///
    /// # Errors
    /// The reason for which there is none.
    pub(super) fn aimed(&self, node: &Node, alpha: f64, ratio: f64) -> Result<(PlannedTableMotion, Strike), Obstacle> {
        if self.rod.contact_speed(&node.state) >= 0.0 {
            return Err(Obstacle::Rising);
        }
        let (motion, strike, impulse) = self.strike(node, alpha, ratio);
        // An impulse that is not a number does not push either.
        if impulse.gt(&0.0) { Ok((motion, strike)) } else { Err(Obstacle::CannotPush) }
    }

    /// Time of the flight after a strike at a height `clearance` (m) of the contact point, s.
    ///
    /// # Errors
    /// The reason for which there is no next contact.
    pub(super) fn flight_time(&self, strike: &Strike, clearance: f64) -> Result<f64, Obstacle> {
        let flight = Flight { clearance, ..self.rod.flight(strike) };
        let found = if clearance < 0.0 {
            first_descent(&flight).ok().flatten()
        } else if strike.contact_rise > 0.0 || clearance > 0.0 {
            first_contact(&flight).ok()
        } else {
            None
        };
        found.filter(|t| t.is_finite()).ok_or(Obstacle::ContactLost)
    }

    /// Another vertex that touches the table at a strike of a body at `theta` (rad), or in the flight after it.
    pub(super) fn touch(
        &self,
        outline: &Outline,
        theta: f64,
        strike: &Strike,
        flight_time: Option<f64>,
        clearance: f64,
    ) -> Option<Obstacle> {
        if let Some(below) = outline.below_table(theta - strike.alpha) {
            return Some(Obstacle::OtherVertex(Touch { vertex: below.vertex, t: 0.0 }));
        }
        let flight = Flight { clearance, ..self.rod.flight(strike) };
        match outline.first_touch(&flight, flight_time?) {
            Ok(touch) => touch.map(Obstacle::OtherVertex),
            Err(TooManyPieces) => Some(Obstacle::ContactLost),
        }
    }

    /// Time of the flight from a node and the next node.
    ///
    /// # Errors
    /// The reason for which there is none.
    fn bounce(&self, node: &Node, clearance: f64, alpha: f64, ratio: f64) -> Result<(f64, Node), Obstacle> {
        let (_, strike) = self.aimed(node, alpha, ratio)?;
        let t = self.flight_time(&strike, clearance)?;
        let state = self.rod.flight(&strike).end(t);
        let fast = [state.x_dot, state.y_dot, self.rod.contact_distance * state.theta_dot];
        if fast.iter().any(|speed| !speed.abs().lt(&SPEED_LIMIT)) {
            return Err(Obstacle::ContactLost);
        }
        Ok((t, Node { x: node.x + strike.after.x_dot * t, state }))
    }

    /// [`BouncingRod::bounce`] with its derivatives.
    ///
    /// # Errors
    /// Same as [`BouncingRod::bounce`].
    pub(super) fn linearized(
        &self,
        node: &Node,
        clearance: f64,
        alpha: f64,
        ratio: f64,
    ) -> Result<LinearizedBounce, Obstacle> {
        let (t, next) = self.bounce(node, clearance, alpha, ratio)?;
        let State { theta, x_dot, y_dot, theta_dot } = node.state;
        let variable = SecondOrder::<VARIABLES>::variable;
        let start = Node {
            x: SecondOrder::from_f64(node.x),
            state: State {
                theta: variable(theta, 0),
                x_dot: variable(x_dot, 1),
                theta_dot: variable(theta_dot, 2),
                y_dot: variable(y_dot, 3),
            },
        };
        let (_, strike, _) = self.strike(&start, variable(alpha, 4), ratio);
        let flight = Flight { clearance: SecondOrder::from_f64(clearance), ..self.rod.lift().flight(&strike) };
        let time = flight.lift_root(t);
        let end = flight.end(time);
        let rows = [start.x + strike.after.x_dot * time, end.theta, end.x_dot, end.theta_dot, end.y_dot];
        Ok(LinearizedBounce {
            next: next.to_vector(),
            by_node: Matrix5::from_fn(|row, column| match column {
                0 => f64::from(u8::from(row == 0)),
                _ => rows[row].first[column - 1],
            }),
            by_tilt: Vector5::from_fn(|row, _| rows[row].first[VARIABLES - 1]),
            rows,
        })
    }
}
