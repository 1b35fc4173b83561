//! A catch as data: its strikes, its hold, what it asks of the table, and how it ends.

use crate::catching::plan::{PlanFailure, StrikesReason};
use crate::catching::settings::{Approach, CatchSettings};
use crate::control::lqr::DesignFailure;
use crate::map::strike::{Rod, State, Strike};
use crate::map::table::actuator_load::ActuatorLoad;
use crate::run::ending::Ending;
use crate::run::lasting_contact::Hold;
use crate::run::orbit::Contact;

/// One strike of a catch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CatchStrike {
    /// Number of the contact, from 1.
    pub n: u64,
    /// Time of the run, s.
    pub t: f64,
    /// Horizontal place of the centre of gravity, m.
    pub x: f64,
    /// Angle and velocities just before it.
    pub state: State,
    /// Height of the contact point above y = 0, m: 0 unless the table strikes early or late.
    pub clearance: f64,
    /// ẏ_c just before, m/s.
    pub contact_speed: f64,
    /// The strike.
    pub strike: Strike,
    /// Time to the next contact, s; `None` after the last strike.
    pub flight_time: Option<f64>,
}

impl CatchStrike {
    pub(super) fn of(rod: &Rod, contact: &Contact) -> Option<Self> {
        let Contact { n, t, x, state, clearance, strike, flight_time, .. } = *contact;
        let contact_speed = rod.contact_speed(&state);
        strike.map(|strike| Self { n, t, x, state, clearance, contact_speed, strike, flight_time })
    }

    /// Height ratio ẏ_c⁺/|ẏ_c| that it reached.
    pub fn ratio(&self) -> f64 {
        self.strike.contact_rise / -self.contact_speed
    }
}

/// Reason for which a catch ended that no run ends for, and without having caught the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Escape {
    /// A strike at this tilt (rad) pushes the contact point down: no speed of the table can reach the height ratio.
    NoLift(f64),
    /// No gain is known at this contact speed, m/s.
    NoLaw(f64),
    /// No plan reaches rest from this contact.
    NoPlan(PlanFailure),
    /// The strikes did not end by this number.
    TooManyStrikes(u64),
    /// The contact slipped: without slip it needs this |F_t|/F_n.
    Slipped(f64),
    /// The contact was lost: no force of the table keeps it.
    ContactLost,
    /// The hold passed its work limit.
    HoldTooLong,
}

/// Outcome of a catch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CatchOutcome {
    /// The body stayed in contact for all the time that was followed.
    Held,
    /// A polygon lies on the edge between these two vertices.
    RestsOnEdge([usize; 2]),
    /// Its strikes or its hold ended as runs end.
    Ended {
        /// s.
        t: f64,
        /// Reason.
        ending: Ending,
    },
    /// They ended as no run ends.
    Escaped {
        /// s.
        t: f64,
        /// Reason.
        escape: Escape,
    },
}

/// Outcomes by name, without their numbers. Their order is that of counts and of codes in maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum CatchOutcomeKind {
    /// [`CatchOutcome::Held`].
    Held,
    /// [`CatchOutcome::RestsOnEdge`].
    RestsOnEdge,
    /// |θ| reached the topple angle, or another vertex met the table.
    Fell,
    /// [`Escape::Slipped`].
    Slipped,
    /// The table would have to go beyond one of its limits.
    BeyondLimits,
    /// Any other reason for which it was not caught.
    NotCaught,
}

names!(
    CatchOutcomeKind: Held => "held", RestsOnEdge => "rests_on_edge", Fell => "fell", Slipped => "slipped",
        BeyondLimits => "beyond_limits", NotCaught => "not_caught"
);

impl CatchOutcome {
    /// The outcome without its numbers.
    pub fn kind(&self) -> CatchOutcomeKind {
        match self {
            Self::Held => CatchOutcomeKind::Held,
            Self::RestsOnEdge(_) => CatchOutcomeKind::RestsOnEdge,
            Self::Ended { ending: Ending::Toppled { .. } | Ending::OtherVertex(_), .. } => CatchOutcomeKind::Fell,
            Self::Ended { ending: Ending::BeyondLimits(_), .. } => CatchOutcomeKind::BeyondLimits,
            Self::Escaped { escape: Escape::Slipped(_), .. } => CatchOutcomeKind::Slipped,
            Self::Ended { .. } | Self::Escaped { .. } => CatchOutcomeKind::NotCaught,
        }
    }

    /// True if the body came to stay on the table: upright, or on an edge.
    pub fn is_caught(&self) -> bool {
        matches!(self.kind(), CatchOutcomeKind::Held | CatchOutcomeKind::RestsOnEdge)
    }
}

/// Reach of a lasting contact.
///
/// To first order a contact without friction has θ̈ = (Gl/ρ²)(θ − α), so its growing part u = θ + θ̇ρ/√(Gl) follows u̇ = (√(Gl)/ρ)(u − α): a
/// table that tilts up to α_max turns it back for |u| < α_max only. A contact that sticks has ρ² + l² in place of ρ² and a/G ≤ μ, the
/// acceleration that friction transmits, in place of α.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// |u| as the contact begins, rad.
    pub theta: f64,
    /// Largest |u| that can be turned back, rad.
    pub limit: f64,
}

/// Demands of a catch on the table, over strikes and hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CatchDemand {
    /// Largest tilt, tilt rate, speed and stroke.
    pub load: ActuatorLoad,
    /// True if the table moved from one strike to another, or in contact; otherwise its tilt rate and stroke are not known.
    pub moves: bool,
    /// Way of the table along x in contact, m.
    pub travel: f64,
    /// Friction that a contact without slip needs.
    pub least_friction: f64,
    /// Largest force along the normal in contact, per unit mass, m/s².
    pub most_normal_force: f64,
}

/// A note on a catch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CatchNote {
    /// The energy feedback of the scene with its target would not catch: it slows down as 2/(aGt), a = (1 + e)κ_E/2, and comes down to
    /// [`super::settings::HOLD_SPEED`] only after this time, s.
    EnergyFeedbackNeverSettles(f64),
    /// The scene's table does not move along itself; the table of a catch moves along with a contact that has friction.
    MovesAlongItself,
    /// The table believes a restitution that is wrong, so that the first strike reached a ratio other than the one aimed for.
    WrongBelief {
        /// Height ratio aimed for.
        aimed: f64,
        /// Height ratio reached.
        reached: f64,
    },
    /// With what the table believes about restitution each strike reaches a ratio of at least 1, so that the body does not lose height.
    KeepsHeight {
        /// Height ratio aimed for.
        aimed: f64,
        /// e + (1 + e)(r − ê)/(1 + ê), with ê as believed.
        reached: f64,
    },
    /// The strikes of a plan showed a restitution other than the one that the table believed in; it planned on with that.
    LearnedRestitution {
        /// The belief.
        assumed: f64,
        /// The restitution shown, from the strikes up to the last contact.
        shown: f64,
    },
    /// The contact began at this vertical velocity of the contact point (m/s); the table moved along with it and braked.
    RodeAlong(f64),
    /// The body was still turning as the contact began, rad/s: the bounces had ended, its motion had not.
    StillTurning(f64),
    /// The plan could not be made again at this contact, or not with tilts that a table can do; the strikes from there on are those of `bounce_down`.
    PlanGivenUp(u64),
    /// The contact began outside its [`Reach`].
    OutOfReach(Reach),
    /// At the end of the hold the body was at this θ, rad, not within 1 mrad of upright.
    NotYetUpright(f64),
}

/// A strategy that was compared with the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The strategy with its numbers.
    pub approach: Approach,
    /// Demand on the table, up to the end.
    pub demand: CatchDemand,
    /// Beginning of its lasting contact, s.
    pub contact_from: Option<f64>,
    /// End of the catch, s: [`Catch::end`].
    pub end: f64,
    /// Outcome. One that is not caught rules the strategy out.
    pub outcome: CatchOutcome,
    /// True for the one that was taken.
    pub taken: bool,
}

/// A catch.
#[derive(Clone, Debug, PartialEq)]
pub struct Catch {
    /// Settings that were asked for.
    pub settings: CatchSettings,
    /// The strategy that was used, with its numbers.
    pub approach: Approach,
    /// Reason for the number of strikes of a plan, if it was chosen.
    pub strikes_reason: Option<StrikesReason>,
    /// The strategies that were compared, if none was asked for.
    pub candidates: Vec<Candidate>,
    /// Strikes.
    pub strikes: Vec<CatchStrike>,
    /// Beginning of the lasting contact, s.
    pub contact_from: Option<f64>,
    /// The lasting contact.
    pub hold: Option<Hold>,
    /// Demands on the table.
    pub demand: CatchDemand,
    /// Reach, if there was a lasting contact.
    pub reach: Option<Reach>,
    /// Facts beside it.
    pub notes: Vec<CatchNote>,
    /// Outcome.
    pub outcome: CatchOutcome,
}

impl Catch {
    /// Time of its end, s: of the lasting contact, else of the last strike.
    pub fn end(&self) -> f64 {
        let struck = || self.strikes.last().map(|last| last.t);
        self.hold.as_ref().map(|hold| hold.t_end).or_else(struck).unwrap_or(0.0)
    }
}

/// Reason for which there is no catch to tell of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CatchFailure {
    /// A point mass has no angle to hold.
    Point,
    /// The weights give no law in contact.
    NoLaw(DesignFailure),
    /// The caller stopped it.
    Stopped,
}

impl From<DesignFailure> for CatchFailure {
    fn from(why: DesignFailure) -> Self {
        Self::NoLaw(why)
    }
}
