//! What the server says over a live connection, as it is written.
//!
//! Not here: when it is said, and what a client says (`client_message`).

use equipoise_physics::body::Body;
use equipoise_physics::bounce::state::State;
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::scene::model::Model;
use serde::{Serialize, Serializer};

use crate::BUILD;
use crate::api::scene::{Resolved, has_angle};
use crate::api::shared::demand::DemandAnswer;
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::outcome::Outcome;
use crate::http::{FieldError, Problem};
use crate::limits;
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
            ServerMessage::Impact(impact) => ("impact", Some(EventId::Impact(impact.n))),
            ServerMessage::Impacts { columns } => ("impacts", columns.0.last().map(|impact| EventId::Impact(impact.n))),
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

/// An impact as it is told.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImpactMessage {
    /// Its number, from 1.
    pub n: u64,
    /// When, s after release.
    pub t: f64,
    before: Before,
    after: Option<After>,
    alpha: f64,
    table_velocity: Option<Velocity>,
    flight_time: Option<f64>,
    energy: f64,
    contact_speed: f64,
    impulse_normal: Option<f64>,
    impulse_tangential: Option<f64>,
    contact_mode: Option<&'static str>,
    clearance: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Before {
    x: f64,
    theta: f64,
    x_dot: f64,
    y_dot: f64,
    theta_dot: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct After {
    x_dot: f64,
    y_dot: f64,
    theta_dot: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Velocity {
    x: f64,
    y: f64,
}

impl ImpactMessage {
    /// Of a contact of this body; a point mass has no angle of its own.
    pub fn new(body: &Model, has_angle: bool, contact: &Contact) -> Self {
        let State { theta, x_dot, y_dot, theta_dot } = contact.state;
        let angle = |value| has_angle.then_some(value);
        // What a run that diverged has overflown to does not exist.
        let struck = contact.strike.filter(|strike| {
            let State { x_dot, y_dot, theta_dot, .. } = strike.after;
            [x_dot, y_dot, theta_dot, strike.impulse_normal, strike.table_velocity.0, strike.table_velocity.1]
                .iter()
                .all(|value| value.is_finite())
        });
        Self {
            n: contact.n,
            t: contact.t,
            before: Before { x: contact.x, theta, x_dot, y_dot, theta_dot: angle(theta_dot) },
            after: struck.map(|strike| After {
                x_dot: strike.after.x_dot,
                y_dot: strike.after.y_dot,
                theta_dot: angle(strike.after.theta_dot),
            }),
            alpha: contact.alpha,
            table_velocity: struck.map(|strike| Velocity { x: strike.table_velocity.0, y: strike.table_velocity.1 }),
            flight_time: contact.flight_time,
            energy: body.energy(&contact.state) + body.rod().gravity * contact.clearance,
            contact_speed: body.contact_speed(&contact.state),
            impulse_normal: struck.map(|strike| strike.impulse_normal),
            impulse_tangential: struck.map(|strike| strike.impulse_tangential),
            contact_mode: contact.strike.map(|strike| strike.mode.name()),
            clearance: contact.clearance,
        }
    }

    /// Time to the next one, s of run time.
    pub fn flight_time(&self) -> Option<f64> {
        self.flight_time
    }
}

/// Impacts column by column.
#[derive(Debug)]
pub struct ImpactColumns(pub Vec<ImpactMessage>);

impl Serialize for ImpactColumns {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        fn column<T: Serialize>(impacts: &[ImpactMessage], of: impl Fn(&ImpactMessage) -> T) -> Vec<T> {
            impacts.iter().map(of).collect()
        }
        #[derive(Serialize)]
        struct Named {
            n: Vec<u64>,
            t: Vec<f64>,
            x: Vec<f64>,
            theta: Vec<f64>,
            x_dot: Vec<f64>,
            y_dot: Vec<f64>,
            theta_dot: Vec<Option<f64>>,
            x_dot_after: Vec<Option<f64>>,
            y_dot_after: Vec<Option<f64>>,
            theta_dot_after: Vec<Option<f64>>,
            alpha: Vec<f64>,
            flight_time: Vec<Option<f64>>,
            energy: Vec<f64>,
            contact_speed: Vec<f64>,
            clearance: Vec<f64>,
        }
        let all = &self.0;
        let named = Named {
            n: column(all, |impact| impact.n),
            t: column(all, |impact| impact.t),
            x: column(all, |impact| impact.before.x),
            theta: column(all, |impact| impact.before.theta),
            x_dot: column(all, |impact| impact.before.x_dot),
            y_dot: column(all, |impact| impact.before.y_dot),
            theta_dot: column(all, |impact| impact.before.theta_dot),
            x_dot_after: column(all, |impact| impact.after.map(|after| after.x_dot)),
            y_dot_after: column(all, |impact| impact.after.map(|after| after.y_dot)),
            theta_dot_after: column(all, |impact| impact.after.and_then(|after| after.theta_dot)),
            alpha: column(all, |impact| impact.alpha),
            flight_time: column(all, |impact| impact.flight_time),
            energy: column(all, |impact| impact.energy),
            contact_speed: column(all, |impact| impact.contact_speed),
            clearance: column(all, |impact| impact.clearance),
        };
        named.serialize(serializer)
    }
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
