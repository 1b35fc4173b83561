//! The outcome of a run in words and numbers. The physics decides when a run ends.

use equipoise_physics::catching::outcome::CatchOutcomeKind;
use equipoise_physics::map::body::Touch;
use equipoise_physics::map::table::actuator_load::LimitViolation;
use equipoise_physics::run::ending::{Ending, EndingKind};
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::run::rules::SPEED_LIMIT;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Value, json};

use crate::words;

/// Ending of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunEnding {
    /// Ending of a body that bounced.
    Bouncing(EndingKind),
    /// Outcome of a body that the table caught, or tried to.
    Caught(CatchOutcomeKind),
}

/// Outcome of one of many runs, by its name alone.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct BriefOutcome {
    /// The ending.
    #[schemars(with = "OutcomeKind")]
    pub kind: &'static str,
}

/// Outcome of the run.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Outcome {
    /// The ending.
    #[serde(skip)]
    pub ending: RunEnding,
    /// Name of the ending; of a run that a catch ends, the outcome of the catch.
    #[schemars(with = "AnyOutcomeKind")]
    pub kind: &'static str,
    /// Number of contacts listed.
    pub bounces: u64,
    /// Run time of the last contact, s. For `other_vertex`, of the touch.
    pub t: f64,
    /// One sentence, with numbers.
    pub detail: String,
    /// The quantity that ended the run.
    pub quantity: Option<&'static str>,
    /// Value of that quantity, in `unit`.
    pub value: Option<f64>,
    /// Limit of that quantity, in `unit`.
    pub limit: Option<f64>,
    /// Unit of both.
    pub unit: Option<&'static str>,
    /// For `settled`, time at which the bounces end, s. By the geometric series of the flights, or the time of the contact if its strike leaves
    /// the contact point at rest. The body does not have to stand still then.
    pub settle_time: Option<f64>,
    /// For `settled`, the angular velocity with which the body goes on when its bounces end, rad/s. Absent for other endings and bodies without
    /// an angle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub theta_dot: Option<f64>,
}

/// A quantity that decided an outcome: name, value, limit and unit.
pub type Decision = (&'static str, f64, f64, &'static str);

/// The reason for which a run, a catch or a contact ended at a time in words, and the quantity that decided it. `words` writes a value and its
/// limit.
pub fn ended(
    at: &str,
    who: &str,
    ending: Ending,
    words: impl Fn([f64; 2]) -> [String; 2],
) -> (String, Option<Decision>) {
    match ending {
        Ending::Toppled { theta, limit } => {
            let [angle, largest] = words([theta, limit]);
            let detail = format!("{at}, the angle {angle} rad had reached topple_angle {largest} rad");
            (detail, Some(("theta", theta, limit, "rad")))
        }
        Ending::BeyondLimits(LimitViolation { quantity, value, limit, unit }) => {
            let [asked, most] = words([value, limit]);
            let detail = format!(
                "{at}, {who} asks for a {quantity} of {asked} {unit}; table.limits.{quantity} is {most} {unit}"
            );
            (detail, Some((quantity, value, limit, unit)))
        }
        Ending::Separating { approach } => {
            let [speed, _] = words([approach, 0.0]);
            let detail =
                format!("{at}, the contact point left the table at {speed} m/s along its normal: it could only pull");
            (detail, Some(("approach", approach, 0.0, "m/s")))
        }
        Ending::Diverged { speed } => {
            let [given, _] = words([speed, 0.0]);
            let detail = format!("{at}, the strike gave a speed of {given} m/s, beyond what doubles resolve");
            (detail, Some(("speed", speed, SPEED_LIMIT, "m/s")))
        }
        Ending::Completed
        | Ending::Sinking { .. }
        | Ending::Settled { .. }
        | Ending::OtherVertex(_)
        | Ending::Missed
        | Ending::OffTable { .. } => (format!("{at}, {who} ended as {}", ending.name()), None),
    }
}

impl Outcome {
    /// The outcome of a run that ended at contact `bounces`, at time `t`, s.
    pub fn new(ending: Ending, bounces: u64, t: f64) -> Self {
        let at = format!("at contact {bounces}, t = {t} s");
        let t = if let Ending::OtherVertex(touch) = ending { t + touch.t } else { t };
        let (detail, decided) = match ending {
            Ending::OtherVertex(Touch { vertex, t: 0.0 }) => (
                format!("{at}, vertex {vertex} of the body was below the table's line: another one would have struck"),
                None,
            ),
            Ending::OtherVertex(Touch { vertex, t: since }) => (
                format!(
                    "{since} s after {}, vertex {vertex} of the body came down to y = 0 before the one that bounces",
                    if bounces == 0 { "the release".to_owned() } else { format!("contact {bounces}") }
                ),
                None,
            ),
            Ending::OffTable { place, limit } => (
                format!("{at}, the contact point came down at {place} m, beyond the end of the table at {limit} m"),
                Some(("place", place.abs(), limit, "m")),
            ),
            Ending::Missed => {
                (format!("after contact {bounces}, the body never meets the table as it was planned"), None)
            }
            Ending::Completed => (format!("all {bounces} contacts were computed, up to t = {t} s"), None),
            Ending::Sinking { contact_rise } if contact_rise > 0.0 => (
                format!(
                    "{at}, below y = 0, the contact point left at {contact_rise} m/s: it does not rise up to y = 0 again"
                ),
                Some(("contact_rise", contact_rise, 0.0, "m/s")),
            ),
            Ending::Sinking { contact_rise } => (
                format!(
                    "{at}, the strike left the contact point at {contact_rise} m/s vertically: it does not rise again"
                ),
                Some(("contact_rise", contact_rise, 0.0, "m/s")),
            ),
            Ending::Settled { flight_time: 0.0, .. } => (
                format!("{at}, the strike left the contact point at rest: the bounces end there"),
                Some(("flight_time", 0.0, 0.0, "s")),
            ),
            Ending::Settled { flight_time, settle_time } => (
                format!("{at}, the next flight would take {flight_time} s; the bounces end at t = {settle_time} s"),
                Some(("flight_time", flight_time, 0.0, "s")),
            ),
            Ending::Diverged { speed } if speed <= SPEED_LIMIT => (
                format!(
                    "after contact {bounces}, t = {t} s, the body turns so often that doubles do not resolve its next contact"
                ),
                None,
            ),
            other => ended(&at, "the strike", other, |numbers| numbers.map(|number| number.to_string())),
        };
        let settle_time = if let Ending::Settled { settle_time, .. } = ending { Some(settle_time) } else { None };
        Self {
            ending: RunEnding::Bouncing(ending.into()),
            kind: ending.name(),
            bounces,
            t,
            detail,
            quantity: decided.map(|(quantity, ..)| quantity),
            value: decided.map(|(_, value, ..)| value).filter(|value| value.is_finite()),
            limit: decided.map(|(_, _, limit, _)| limit),
            unit: decided.map(|(.., unit)| unit),
            settle_time,
            theta_dot: None,
        }
    }

    /// The same outcome of a run of a body with an angle, whose `last` contact is known: bounces that end do not stop its rotation.
    #[must_use]
    pub fn turning(mut self, last: Option<&Contact>) -> Self {
        if self.ending == RunEnding::Bouncing(EndingKind::Settled)
            && let Some(strike) = last.and_then(|last| last.strike)
        {
            let theta_dot = strike.after.theta_dot;
            self.theta_dot = Some(theta_dot);
            if theta_dot != 0.0 {
                self.detail.push_str(&format!(", while the body still turns at {theta_dot} rad/s"));
            }
        }
        self
    }

    /// Headline of the run, in plain words.
    pub fn headline(&self) -> String {
        match self.ending {
            RunEnding::Bouncing(ending) => headline(ending, self.bounces),
            RunEnding::Caught(outcome) => {
                let (verb, reason) = caught_words(outcome);
                format!("{verb} after bounce {}: {reason}", self.bounces)
            }
        }
    }
}

/// Verb and reason of a headline for a body that the table caught, or tried to.
fn caught_words(outcome: CatchOutcomeKind) -> (&'static str, &'static str) {
    match outcome {
        CatchOutcomeKind::Held => ("Caught", "the table holds it"),
        CatchOutcomeKind::RestsOnEdge => ("Caught", "it lies still on an edge"),
        CatchOutcomeKind::Fell => ("Falls", "it tipped over while the table caught it"),
        CatchOutcomeKind::Slipped => ("Not caught", "its foot slipped on the table"),
        CatchOutcomeKind::BeyondLimits => ("Not caught", "the catch asks more of the table than its limits allow"),
        CatchOutcomeKind::NotCaught => ("Not caught", "the table could not follow it"),
    }
}

/// Headline of a run that ended at contact `bounces`, in plain words.
pub fn headline(ending: EndingKind, bounces: u64) -> String {
    let (verb, reason) = match ending {
        EndingKind::Completed => return format!("Keeps balance for {bounces} bounces"),
        EndingKind::Toppled => ("Falls", "it had tipped over"),
        EndingKind::Separating => ("Falls", "its foot was leaving the table already"),
        EndingKind::Sinking => ("Falls", "the table struck too steeply"),
        EndingKind::Settled => ("Comes to rest", "its bounces died out"),
        EndingKind::Diverged => ("Cannot be followed", "it became too fast to compute"),
        EndingKind::OtherVertex => ("Falls", "another corner touched the table"),
        EndingKind::Missed => ("Falls", "it never met the table again"),
        EndingKind::BeyondLimits => ("Falls", "the strike asks more of the table than its limits allow"),
        EndingKind::OffTable => ("Falls", "the table ended before it"),
    };
    if bounces == 0 {
        format!("{verb} before its first bounce: {reason}")
    } else {
        format!("{verb} at bounce {bounces}: {reason}")
    }
}

words! {
    /// Ending of a run.
    pub OutcomeKind = EndingKind::ALL.map(EndingKind::name);

    /// A name of OutcomeKind or of CatchOutcomeKind.
    pub AnyOutcomeKind = any_outcome_kinds();
}

/// Names of the endings of runs, in the contract.
pub fn outcome_kinds() -> Value {
    let meanings = EndingKind::ALL.map(|ending| format!("- `{}`: {}", ending.name(), meaning(ending)));
    json!({"type": "string", "enum": EndingKind::ALL.map(EndingKind::name), "description": meanings.join("\n")})
}

/// Names of the endings of runs and of the outcomes of catches. One list, because generators do not join two.
fn any_outcome_kinds() -> Vec<&'static str> {
    let mut names = EndingKind::ALL.map(EndingKind::name).to_vec();
    names.extend(["held", "rests_on_edge", "fell", "slipped", "not_caught"]);
    names
}

/// Meaning of an ending for clients, as the contract states it.
fn meaning(ending: EndingKind) -> &'static str {
    match ending {
        EndingKind::Completed => "all impacts requested.",
        EndingKind::Toppled => "the angle reached `topple_angle`.",
        EndingKind::Separating => "the contact point was moving away from the table, which would have had to pull.",
        EndingKind::Sinking => {
            "the strike left the contact point moving down, for example sliding down a tilted table (or, with noise, too slow to \
             rise to y = 0), so there is no next contact from above."
        }
        EndingKind::Settled => {
            "the bounces ended in a finite time. This is possible if strikes can remove energy: a loss that the table does not make \
             up, an energy gain, or friction. Either a flight was shorter than 1e-9 of the first, with the contact point as slow \
             along the table's normal as upwards, so that it was no graze; or a strike left the contact point at rest up to \
             rounding, as restitution 0 does on a flat table that stands still or if the contact sticks. Only the bounces end: the \
             contact point stays on the table, and the body continues to turn and to slide."
        }
        EndingKind::Diverged => {
            "a quantity left the range in which it has a meaning, or the body turns so often in one flight that doubles do not \
             resolve its angle."
        }
        EndingKind::OtherVertex => {
            "another vertex of a polygon was below the line of the table at the contact (by more than 1e-9 of the body's size, \
             since an edge may lie on the table), or came down to y = 0 after it, before the contact vertex did. A vertex that the \
             strike left below the line has to rise first."
        }
        EndingKind::Missed => "the planned plane was never met.",
        EndingKind::BeyondLimits => "the strike needed more than `table.limits` allow.",
        EndingKind::OffTable => "the contact point came down beyond an end of the table (`table.length`).",
    }
}
