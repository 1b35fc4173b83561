//! The answer: samples of a motion in contact, how it ends, and what it asks of the table.

use crate::table::actuator_load::{ActuatorLoad, LimitViolation};

/// Longest time in contact that is followed, s.
pub const LONGEST_HOLD: f64 = 60.0;

/// Most samples of a motion in contact.
pub const MOST_SAMPLES: usize = 602;

/// The body and the table at a moment of the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoldSample {
    /// Time of the run, s.
    pub t: f64,
    /// Horizontal place of the centre of gravity, m.
    pub x: f64,
    /// Angle, rad.
    pub theta: f64,
    /// Horizontal velocity of the centre of gravity, m/s.
    pub x_dot: f64,
    /// Angular velocity, rad/s.
    pub theta_dot: f64,
    /// Tilt of the table, rad.
    pub alpha: f64,
    /// Force of the table along its normal per unit mass, m/s².
    pub normal_force: f64,
    /// Force of the table along itself per unit mass, m/s².
    pub tangential_force: f64,
    /// Height of the table's surface at the contact over its height at the beginning, m.
    pub table_y: f64,
    /// Vertical velocity of the table's surface at the contact, m/s.
    pub table_y_dot: f64,
    /// Way along x of the table's surface under the contact since the beginning, m: 0 unless the table moves along itself.
    pub table_x: f64,
}

/// Reason for which the motion was followed no further.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoldEnding {
    /// The time asked for is over.
    Completed,
    /// No force N > 0 keeps the contact point on the table: the body leaves it.
    ContactLost,
    /// The table that balances a sticking contact needs more friction than there is.
    Slipped {
        /// |F_t|/F_n that would be needed.
        needed: f64,
    },
    /// |θ| reached the topple angle.
    Toppled,
    /// Another vertex of the polygon came down to the table.
    OtherVertex(usize),
    /// The polygon lies still on the edge between these two vertices.
    RestsOnEdge {
        /// Indices in the order in which the vertices were given, the smaller first.
        vertices: [usize; 2],
    },
    /// The table would go beyond a limit.
    BeyondLimits(LimitViolation),
    /// The caller stopped it.
    Stopped,
    /// The work limit was reached.
    TooLong,
}

/// A motion in contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Hold {
    /// The motion, evenly in time, and its last moment.
    pub samples: Vec<HoldSample>,
    /// Ending.
    pub ending: HoldEnding,
    /// Time of the ending, s.
    pub t_end: f64,
    /// Time from which |θ| stays within 1 mrad up to the end of a completed motion, s.
    pub theta_within: Option<f64>,
    /// Time from which |x| stays within 1 mm up to the end of a completed motion, s.
    pub x_within: Option<f64>,
    /// Estimated bound on the largest of |δx|, |ρδθ|, |δẋ|, |ρδθ̇| over all samples (m, m/s). Infinite if solutions of two
    /// accuracies do not end alike.
    pub error_bound: f64,
    /// Load on the table: tilt, tilt rate, speed of the surface at the contact, vertical way.
    pub load: ActuatorLoad,
    /// Way along x of the table's surface from end to end, m.
    pub travel: f64,
    /// Largest |θ|, rad.
    pub most_theta: f64,
    /// Largest |F_t|/F_n at the contact: friction that a contact without slip needs.
    pub least_friction: f64,
}
