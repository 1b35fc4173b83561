//! What the server says over a live connection, as it is written.
//!
//! Not here: when it is said, and what a client says (`client_message`).

use serde::Serialize;

use crate::BUILD;
use crate::api::scene::{Resolved, has_angle};
use crate::api::shared::demand::DemandAnswer;
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::outcome::Outcome;
use crate::http::{FieldError, Problem};
use crate::limits;
use crate::live::impact_message::{ImpactColumns, ImpactMessage};
use crate::live::run_url;
use crate::live::run_url::LiveRun;
use crate::runs::playback::Playback;

/// A message of the server's.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum ServerMessage<'a> {
    /// First of all, and after a restart: which run it is.
    Hello(Box<Hello<'a>>),
    /// An impact, when it happens.
    Impact(&'a ImpactMessage),
    /// Several of them.
    Impacts {
        /// Column by column.
        columns: ImpactColumns,
    },
    /// Impacts that a slow client does not get.
    Gap {
        /// The first of them.
        from: u64,
        /// The last.
        to: u64,
    },
    /// The run has ended.
    End {
        /// How.
        outcome: &'a Outcome,
        /// The most that it asked of the table.
        demand: DemandAnswer,
    },
    /// Something is wrong with a message, or with the whole run.
    Problem {
        /// What kind of problem.
        title: &'static str,
        /// What is wrong this time.
        detail: &'a str,
        /// What is wrong with which field.
        errors: &'a [FieldError],
    },
    /// A message was carried out.
    Ack(Ack<'a>),
}

/// What goes to a client, whatever carries it.
#[derive(Debug, Clone, PartialEq)]
pub enum OutgoingFrame {
    /// A message of the server's.
    Message {
        /// Its type.
        kind: &'static str,
        /// How far the run has been told with it, if it tells of it.
        id: Option<EventId>,
        /// As JSON.
        text: String,
    },
    /// Nothing to say, but still here.
    Ping,
    /// Goodbye, with a code of RFC 6455 and why.
    Close(u16, &'static str),
}

/// How far a run has been told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventId {
    /// Up to this impact.
    Impact(u64),
    /// To its end.
    End,
}

impl ServerMessage<'_> {
    /// As it is sent.
    pub fn to_frame(&self) -> OutgoingFrame {
        let (kind, id) = match self {
            ServerMessage::Hello(_) => ("hello", None),
            ServerMessage::Impact(impact) => ("impact", Some(EventId::Impact(impact.n()))),
            ServerMessage::Impacts { columns } => {
                ("impacts", columns.0.last().map(|impact| EventId::Impact(impact.n())))
            }
            ServerMessage::Gap { .. } => ("gap", None),
            ServerMessage::End { .. } => ("end", Some(EventId::End)),
            ServerMessage::Problem { .. } => ("problem", None),
            ServerMessage::Ack(_) => ("ack", None),
        };
        let text = serde_json::to_string(self).expect("messages are numbers and text under text keys");
        OutgoingFrame::Message { kind, id, text }
    }
}

/// A problem as a message.
pub fn problem(problem: &Problem) -> OutgoingFrame {
    ServerMessage::Problem { title: problem.title(), detail: problem.detail(), errors: problem.errors() }.to_frame()
}

/// Which run it is and where it is.
#[derive(Debug, Serialize)]
pub struct Hello<'a> {
    scene: Resolved<'a>,
    scene_in_force: Resolved<'a>,
    model: ModelChoice,
    epoch: u64,
    speed: f64,
    paused: bool,
    now: u64,
    run_time: f64,
    url: String,
    release: Release,
    flight_time: Option<f64>,
    build: &'static str,
}

#[derive(Debug, Serialize)]
struct Release {
    t: f64,
    x: f64,
    y: f64,
    theta: Option<f64>,
    x_dot: f64,
    y_dot: f64,
    theta_dot: Option<f64>,
}

impl<'a> Hello<'a> {
    /// Of a run that is told from `playback` on, at the wall time `now`, unix ms. Its URL begins with `base`.
    pub fn new(live: &'a LiveRun, playback: &'a Playback, base: &str, now: u64) -> Self {
        let (scene, clock) = (live.run.scene(), &live.clock);
        let release = scene.release();
        let angle = |value| has_angle(scene).then_some(value);
        Self {
            scene: Resolved(scene),
            scene_in_force: Resolved(playback.scene()),
            model: ModelChoice::of(scene),
            epoch: clock.epoch(),
            speed: clock.speed(),
            paused: clock.is_paused(),
            now,
            run_time: clock.run_time(now),
            url: format!("{base}{}", run_url::url(live)),
            release: Release {
                t: 0.0,
                x: release.x,
                y: release.height,
                theta: angle(release.state.theta),
                x_dot: release.state.x_dot,
                y_dot: release.state.y_dot,
                theta_dot: angle(release.state.theta_dot),
            },
            flight_time: Playback::new(&live.run, limits::LIVE_IMPACTS).next_t(),
            build: BUILD,
        }
    }
}

/// What was done, and the run as it is now.
#[derive(Debug, Serialize)]
pub struct Ack<'a> {
    /// The type of the message that was carried out.
    pub of: &'static str,
    /// The run's URL from now on.
    pub url: &'a str,
    /// Run time, s.
    pub run_time: f64,
    /// Wall time, unix ms.
    pub now: u64,
    /// Run time per wall time, also while paused.
    pub speed: f64,
    /// Whether it stands still.
    pub paused: bool,
    /// The impact at which it acts, for `set`, `kick` and `step`.
    pub impact: Option<u64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn json_of(frame: OutgoingFrame) -> Value {
        let OutgoingFrame::Message { kind, text, .. } = frame else { panic!("{frame:?}") };
        let json: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(json["type"], kind);
        json
    }

    #[test]
    fn messages_have_their_type() {
        assert_eq!(
            json_of(ServerMessage::Gap { from: 3, to: 9 }.to_frame()),
            json!({"type": "gap", "from": 3, "to": 9})
        );
        let wrong = json_of(problem(&Problem::invalid_at("/a", "a is wrong")));
        assert_eq!(wrong["errors"], json!([{"pointer": "/a", "detail": "a is wrong"}]));
    }
}
