//! A body on the table: the question (law of the table, duration) and the answer (samples, ending, load on the table).

use crate::map::body::{Body, PreImpact};
use crate::map::strike::Rod;
use crate::map::strike::Strike;
use crate::map::table::actuator_load::{ActuatorLimits, ActuatorLoad, Pose};
use crate::map::table::control_law::{Gains, Steering};
use crate::run::ending::Ending;
use crate::run::orbit::{ComingContact, Contact};
use crate::run::rules::Rules;
use crate::scene::Scene;
use crate::scene::capability::Analysis;

/// The body as a lasting contact begins. The contact point is on the table, and as fast as the table vertically.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactStart {
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
    /// Vertical velocity of the table's surface at the contact, m/s, up positive; negative where it brakes the body.
    pub table_speed: f64,
    /// The table at the strike before it, and the time since then, s, 0 if the contact begins with it; `None` if the table waited at the tilt of
    /// its law.
    pub before: Option<(Pose, f64)>,
}

/// Law of the table during the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoldLaw {
    /// α = c − K·(x, θ, ẋ, θ̇), with c in rad.
    Tilting(Gains, f64),
    /// A table at a constant tilt, rad, whose surface moves along x with the acceleration a = c − K·(x, θ, ẋ, θ̇), m/s²: level and with c = 0 it
    /// balances a contact that sticks.
    CartPole {
        /// K.
        gains: Gains,
        /// c, m/s².
        acceleration: f64,
        /// Tilt of the table, rad.
        tilt: f64,
    },
    /// A level table at rest. A polygon rocks on it until an edge rests.
    Level,
}

/// x, θ, ẋ, θ̇ of the centre of gravity: m, rad, m/s, rad/s.
pub type Motion<N = f64> = [N; 4];

impl ContactStart {
    pub(super) fn motion(&self) -> Motion {
        [self.x, self.theta, self.x_dot, self.theta_dot]
    }

    /// The contact at time `t`, s, after the last strike: until then body and table move as the strike left the body.
    pub fn after(last: &Contact, strike: &Strike, t: f64) -> Self {
        let (after, time) = (strike.after, t - last.t);
        Self {
            t,
            x: last.x + after.x_dot * time,
            theta: last.state.theta + after.theta_dot * time,
            x_dot: after.x_dot,
            theta_dot: after.theta_dot,
            table_speed: strike.contact_rise,
            before: Some((Pose::of(strike), time)),
        }
    }

    /// The contact of a rod with a table that meets it at the speed of its contact point, without a strike.
    pub fn meeting(rod: &Rod, at: &ComingContact) -> Self {
        let ComingContact { t, coming: PreImpact { x, state, .. }, before } = *at;
        Self {
            t,
            x,
            theta: state.theta,
            x_dot: state.x_dot,
            theta_dot: state.theta_dot,
            table_speed: rod.contact_speed(&state),
            before,
        }
    }
}

impl HoldLaw {
    /// α = κθ.
    pub fn tilt_gain(gain: f64) -> Self {
        Self::Tilting(Gains { theta: -gain, ..Gains::default() }, 0.0)
    }
}

/// A body in contact, and how long to follow it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoldRequest {
    /// The body: l, ρ, G, friction, vertices and air count.
    pub body: Body,
    /// The angle that counts as toppled, limits and ends of the table.
    pub rules: Rules,
    /// Law of the table.
    pub law: HoldLaw,
    /// Law of the table while it brakes, if it is another: the body then weighs G + a.
    pub brake_law: Option<HoldLaw>,
    /// Beginning of the contact.
    pub start: ContactStart,
    /// Deceleration of a table that moves vertically at the beginning, m/s²; until it stands.
    pub brake: Option<f64>,
    /// Time in contact, s; at most [`super::LONGEST_HOLD`].
    pub duration: f64,
}

impl HoldRequest {
    /// A body in contact with a table that does not move vertically and goes by one law, for so long (s).
    pub fn new(body: &Body, rules: &Rules, law: HoldLaw, start: ContactStart, duration: f64) -> Self {
        Self { body: *body, rules: *rules, law, brake_law: None, start, brake: None, duration }
    }
}

/// Rate at which a table in contact goes to the tilt of a law or a throw, rad/s: 1 rad in the time ρ/√(Gl) in which a lean of the body grows
/// e-fold, or the limit of the table if that is less.
pub fn moving_rate(rod: &Rod, limits: Option<&ActuatorLimits>) -> f64 {
    let growth = (rod.gravity * rod.contact_distance).sqrt() / rod.radius_of_gyration;
    limits.map_or(growth, |limits| growth.min(limits.tilt_rate))
}

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

impl HoldSample {
    pub(super) fn motion(&self) -> Motion {
        [self.x, self.theta, self.x_dot, self.theta_dot]
    }

    /// |F|/N: friction that a contact without slip needs.
    pub(super) fn needed_friction(&self) -> f64 {
        (self.tangential_force / self.normal_force).abs()
    }
}

/// Reason for which the motion was followed no further.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HoldEnding {
    /// The time asked for is over.
    Completed,
    /// It ended as a run does: by the angle, another vertex, a limit or an end of the table.
    Ended(Ending),
    /// No force N > 0 keeps the contact point on the table: the body leaves it.
    ContactLost,
    /// The table that balances a sticking contact needs more friction than there is.
    Slipped {
        /// |F_t|/F_n that would be needed.
        needed: f64,
    },
    /// The polygon lies still on the edge between these two vertices.
    RestsOnEdge {
        /// Indices in the order in which the vertices were given, the smaller first.
        vertices: [usize; 2],
    },
    /// The caller stopped it.
    Stopped,
    /// The work limit was reached.
    TooLong,
}

impl HoldEnding {
    /// Tells whether two endings are of one kind.
    pub(super) fn is_alike(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Ended(one), Self::Ended(other)) => one.name() == other.name(),
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }
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

/// The motion in contact for so long (s) after the last strike of a run that settled: it begins at `settle_time` (s), to which the body
/// drifts and turns as the strike left it. `None` without a strike, and where the scene lacks what the motion in contact needs.
///
/// The table keeps its law, tilts about the contact point, and moves along itself if `table.slide` is `matched`.
pub fn rest_of_run(scene: &Scene, last: &Contact, settle_time: f64, duration: f64) -> Option<HoldRequest> {
    if Analysis::LastingContact.lack(scene).is_some() {
        return None;
    }
    let start = ContactStart { table_speed: 0.0, ..ContactStart::after(last, &last.strike?, settle_time) };
    Some(under_scene(scene, start, duration))
}

/// Work by which the contact after the bounces of any run of a scene is priced, for so long (s).
pub fn work_of_rest(scene: &Scene, duration: f64) -> u64 {
    if scene.is_point() { 0 } else { under_scene(scene, ContactStart::default(), duration).work() }
}

fn under_scene(scene: &Scene, start: ContactStart, duration: f64) -> HoldRequest {
    let body = scene.running_model();
    let gains = match body.steering {
        Steering::TiltGain => Gains { theta: -body.rod.tilt_gain, ..Gains::default() },
        Steering::Feedback(gains) => gains,
    };
    HoldRequest::new(&body, &scene.rules(), HoldLaw::Tilting(gains, body.constant_tilt), start, duration)
}
