//! The outcome of a catch, and the facts beside it, in words and numbers.

use equipoise_physics::catching::outcome;
use equipoise_physics::catching::outcome::{Catch, CatchNote, CatchOutcome, Escape, Reach};
use equipoise_physics::map::body::Touch;
use equipoise_physics::run::ending::Ending;
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::shared::outcome::{Decision, Outcome, RunEnding, ended};
use crate::charts::significant;
use crate::words;

words! {
    /// `held`: the body stays in contact up to the end of `hold`, the time that was asked for. `rests_on_edge`: a polygon came to rest on an edge.
    /// `fell`: the angle reached `topple_angle`, or another vertex met the table. `slipped`: a contact that has to stick needs more friction than
    /// there is. `beyond_limits`: the catch needs more than `table.limits` allow. `not_caught`: none of these; `detail` gives the reason.
    pub CatchOutcomeKind = outcome::CatchOutcomeKind::ALL.map(outcome::CatchOutcomeKind::name);
}

/// Outcome of a catch.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "CatchOutcome")]
pub struct CatchOutcomeAnswer {
    /// Name of the outcome.
    #[schemars(with = "CatchOutcomeKind")]
    pub kind: &'static str,
    /// Time since the release at which it was decided, s.
    pub t: f64,
    /// One sentence, with numbers.
    pub detail: String,
    /// The quantity that decided it, if one did.
    pub quantity: Option<&'static str>,
    /// Value of that quantity, in `unit`.
    pub value: Option<f64>,
    /// Limit of that quantity, in `unit`.
    pub limit: Option<f64>,
    /// Unit of both.
    pub unit: Option<&'static str>,
    /// For `rests_on_edge`, the vertices of the edge, from 0.
    pub vertices: Option<[usize; 2]>,
}

impl CatchOutcomeAnswer {
    /// The outcome of a catch.
    pub fn of(catch: &Catch, friction: f64) -> Self {
        let last = catch.strikes.last().map(|strike| strike.t);
        let end = catch.hold.as_ref().map(|hold| hold.t_end).or(last).unwrap_or(0.0);
        Self::new(&catch.outcome, catch.contact_from, end, friction)
    }

    /// The outcome of a catch whose contact began at `contact_from` and was followed up to `end`, s.
    pub fn new(outcome: &CatchOutcome, contact_from: Option<f64>, end: f64, friction: f64) -> Self {
        let from = contact_from.map_or_else(String::new, |t| format!(" from t = {} s", three(t)));
        let (t, (detail, decided)) = match *outcome {
            CatchOutcome::Held => {
                let end_of_hold = three(end);
                let detail =
                    format!("the body stays in contact{from} to the end of the time asked for, t = {end_of_hold} s");
                (end, (detail, None))
            }
            CatchOutcome::RestsOnEdge([first, second]) => {
                let detail = format!("{}, the body rests on the edge from vertex {first} to vertex {second}", at(end));
                (end, (detail, None))
            }
            CatchOutcome::Ended { t, ending } => (t, ended_as_a_run(t, ending)),
            CatchOutcome::Escaped { t, escape } => (t, escaped(t, escape, friction)),
        };
        Self {
            kind: outcome.kind().name(),
            t,
            detail,
            quantity: decided.map(|(quantity, ..)| quantity),
            value: decided.map(|(_, value, ..)| value).filter(|value| value.is_finite()),
            limit: decided.map(|(_, _, limit, _)| limit).filter(|limit| limit.is_finite()),
            unit: decided.map(|(.., unit)| unit).filter(|unit| !unit.is_empty()),
            vertices: match *outcome {
                CatchOutcome::RestsOnEdge(vertices) => Some(vertices),
                CatchOutcome::Held | CatchOutcome::Ended { .. } | CatchOutcome::Escaped { .. } => None,
            },
        }
    }
}

impl Outcome {
    /// The outcome of a run that ended with a catch, after so many impacts.
    pub fn of_catch(catch: &Catch, friction: f64, bounces: u64) -> Self {
        let CatchOutcomeAnswer { kind, t, detail, quantity, value, limit, unit, .. } =
            CatchOutcomeAnswer::of(catch, friction);
        let ending = RunEnding::Caught(catch.outcome.kind());
        Self { ending, kind, bounces, t, detail, quantity, value, limit, unit, settle_time: None, theta_dot: None }
    }
}

/// The reason for which strikes or a hold ended as a run does.
fn ended_as_a_run(t: f64, ending: Ending) -> (String, Option<Decision>) {
    match ending {
        Ending::OtherVertex(Touch { vertex, .. }) => {
            (format!("{}, vertex {vertex} of the body met the table", at(t)), None)
        }
        Ending::Missed => (format!("after t = {} s, the body never meets the table as it was planned", three(t)), None),
        Ending::OffTable { place, limit } => {
            let [from, end] = apart([place.abs(), limit]);
            let detail =
                format!("{}, the contact point is {from} m from the middle of a table that ends at {end} m", at(t));
            (detail, Some(("place", place.abs(), limit, "m")))
        }
        other => ended(&at(t), "the catch", other, apart),
    }
}

/// The reason for which a catch ended as no run does.
fn escaped(t: f64, escape: Escape, friction: f64) -> (String, Option<Decision>) {
    let detail = match escape {
        Escape::NoLift(alpha) => {
            format!("{}, a strike at a tilt of {} rad pushes the contact point down, at any speed", at(t), three(alpha))
        }
        Escape::NoLaw(speed) => format!(
            "{}, no feedback is known for a contact speed of {} m/s: its Riccati equation was not solved",
            at(t),
            three(speed)
        ),
        Escape::NoPlan(failure) => format!("{}, no plan was found that brings the body to rest: {failure}", at(t)),
        Escape::TooManyStrikes(strikes) => {
            format!("{}, the bounces had not ended after {strikes} strikes, the most of one catch", at(t))
        }
        Escape::Slipped(needed) => {
            let [least, there] = apart([needed, friction]);
            let detail = format!(
                "{}, the contact slips: it needs a coefficient of friction of {least}, and contact.friction is {there}",
                at(t)
            );
            return (detail, Some(("friction", needed, friction, "")));
        }
        Escape::ContactLost => format!("{}, the body leaves the table: only a pull would keep it there", at(t)),
        Escape::HoldTooLong => format!("{}, the motion in contact had taken the most steps of one catch", at(t)),
    };
    (detail, None)
}

/// A number in words: three significant digits.
fn three(value: f64) -> String {
    significant(value, 3)
}

/// A time in words, s.
fn at(t: f64) -> String {
    format!("at t = {} s", three(t))
}

/// A value beside its limit in words: three significant digits, or as many as tell them apart.
fn apart(value_and_limit: [f64; 2]) -> [String; 2] {
    const MOST: usize = 17;
    let told = (3..=MOST).map(|digits| value_and_limit.map(|number| significant(number, digits)));
    told.into_iter().find(|[value, limit]| value != limit).unwrap_or_else(|| value_and_limit.map(three))
}

/// A fact about a catch, in a sentence.
pub fn note_text(note: &CatchNote) -> String {
    match *note {
        CatchNote::EnergyFeedbackNeverSettles(time) => format!(
            "the scene's own table would not catch: with table.energy_gain and this target the speed falls only as 1/t, and passes 5 mm/s after \
             {} s",
            three(time)
        ),
        CatchNote::MovesAlongItself => {
            "the table of a catch moves along itself with a contact that has friction, as with table.slide `matched`; the scene's own table \
             does not"
                .to_owned()
        }
        CatchNote::WrongBelief { aimed, reached } => format!(
            "the table's belief about restitution is wrong: the first strike aimed at a ratio of {} and reached {}",
            three(aimed),
            three(reached)
        ),
        CatchNote::KeepsHeight { aimed, reached } => format!(
            "with this belief about restitution each strike reaches a ratio of {} in place of {}, at least 1: the body does not lose height",
            three(reached),
            three(aimed)
        ),
        CatchNote::LearnedRestitution { assumed, shown } => format!(
            "the first strikes showed a restitution of {} in place of {}, which the table assumed; the plan went on with that",
            three(shown),
            three(assumed)
        ),
        CatchNote::RodeAlong(speed) => format!(
            "the table met the contact point at its own speed of {} m/s, without an impulse, and braked in contact",
            three(speed)
        ),
        CatchNote::StillTurning(theta_dot) => format!(
            "as the contact began, the body still turned at {} rad/s: the bounces had ended, its motion had not",
            three(theta_dot)
        ),
        CatchNote::PlanGivenUp(n) => format!(
            "no new plan was found at contact {n}; the strikes from there on are those of bounce_down"
        ),
        CatchNote::OutOfReach(Reach { theta, limit }) => format!(
            "the contact began out of reach: θ + θ̇ρ/√(Gl) was {} rad, and the table can turn back {} rad",
            three(theta),
            three(limit)
        ),
        CatchNote::NotYetUpright(theta) => format!(
            "at the end of the hold the body was at {} rad, not within 1 mrad of upright; a longer `hold` shows the rest",
            three(theta)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::apart;

    #[test]
    fn words_have_three_digits_or_as_many_as_tell_a_value_from_its_limit() {
        assert_eq!(apart([1.623_456, std::f64::consts::FRAC_PI_2]), ["1.62", "1.57"]);
        assert_eq!(apart([0.300_041, 0.3]), ["0.30004", "0.3"]);
        assert_eq!(apart([0.3, 0.3]), ["0.3", "0.3"]);
    }
}
