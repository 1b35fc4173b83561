//! Messages of the server to a live client, and how they are written. An impact has the numbers of trajectories, a hold the columns of
//! `/v1/catches`. The next strike is foreseen, so that a client can draw the table on its way there.
//!
//! `session` decides when messages are sent.

use std::borrow::Cow;

use axum::extract::ws::{CloseFrame, Message, Utf8Bytes};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::BUILD;
use crate::api::computed::trajectories::columns::{HoldEnd, HoldSamples, ImpactRow, LiveImpactColumns, OF_HOLD};
use crate::api::computed::trajectories::{FreeBody, columns};
use crate::api::scene::{Derived, EnergyTarget, Resolved, has_angle};
use crate::api::shared::answer_parts::{LoadAnswer, ModelChoice};
use crate::api::shared::outcome::Outcome;
use crate::api::shared::table::{Table, row_schema, table_of};
use crate::compute::Cancelled;
use crate::http::{Problem, ProblemError};
use crate::limits;
use crate::live::client_message::ClientMessage;
use crate::live::run_url;
use crate::live::run_url::LiveRun;
use crate::runs::caught::HoldPart;
use crate::runs::playback::Playback;
use crate::runs::run::Run;
use crate::words;

words! {
    /// Type of a message of a client.
    ClientMessageName = ClientMessage::names();
}

/// A message of the server.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum ServerMessage<'a> {
    /// The first message, and again after a restart.
    Hello(Box<Hello>),
    /// An impact, when it happens. Its members are the columns of `LiveImpacts`.
    Impact {
        #[serde(flatten)]
        #[expect(missing_docs, reason = "described by its schema")]
        impact: &'a ImpactMessage,
        /// The strike after this impact.
        next_strike: Option<LiveNextStrike>,
    },
    /// Several impacts at once, above 60 per second and when catching up.
    Impacts {
        #[schemars(with = "LiveImpactColumns")]
        #[expect(missing_docs, reason = "described by its schema")]
        columns: Table,
        /// The strike after the last of these impacts.
        next_strike: Option<LiveNextStrike>,
        /// Number of the last of these impacts.
        #[serde(skip)]
        last: Option<u64>,
    },
    /// The body in lasting contact with the table that caught it, or with the table of the scene after the last bounce (parameter `hold`). It is
    /// sent at the time of the first moment: motion to come, as a flight is known at its beginning. The first moment is the last one of the message
    /// before. A client that reconnects gets all of them again.
    Hold {
        #[schemars(with = "HoldSamples")]
        #[expect(missing_docs, reason = "described by its schema")]
        columns: Table,
    },
    /// Impacts that were skipped because the client was slow.
    Gap {
        /// Number of the first one.
        from: u64,
        /// Number of the last one.
        to: u64,
    },
    /// The run is over.
    End {
        #[expect(missing_docs, reason = "described by its schema")]
        outcome: &'a Outcome,
        #[expect(missing_docs, reason = "described by its schema")]
        demand: LoadAnswer,
        /// End of the contact after the last bounce. Absent unless the run was asked with `hold` and ended as `settled`, with a body that has an
        /// angle.
        #[serde(skip_serializing_if = "Option::is_none")]
        hold_end: Option<&'a HoldEnd>,
    },
    /// A message of the client cannot be carried out, and the run continues; or, in place of `hello`, there is no run, and the server closes.
    Problem {
        /// HTTP status of the same problem.
        status: u16,
        /// Kind of the problem.
        title: &'static str,
        /// The error in a sentence.
        detail: &'a str,
        /// Errors of the fields.
        errors: &'a [ProblemError],
    },
    /// A message of the client has been carried out.
    Ack(Ack<'a>),
}

/// A frame for any carrier.
#[derive(Debug, Clone, PartialEq)]
pub enum OutgoingFrame {
    /// A message of the server.
    Message {
        /// Type of the message.
        kind: &'static str,
        /// Position in the run, if the message has one.
        id: Option<EventId>,
        /// The message as JSON.
        text: String,
    },
    /// A sign of life without a message.
    Ping,
    /// A close, with a code of RFC 6455 and the reason.
    Close(u16, &'static str),
}

impl From<OutgoingFrame> for Message {
    fn from(frame: OutgoingFrame) -> Self {
        match frame {
            OutgoingFrame::Message { text, .. } => Message::text(text),
            OutgoingFrame::Ping => Message::Ping(axum::body::Bytes::new()),
            OutgoingFrame::Close(code, reason) => {
                Message::Close(Some(CloseFrame { code, reason: Utf8Bytes::from_static(reason) }))
            }
        }
    }
}

/// Position of a message in its run, sent as the id of an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventId {
    /// After this impact.
    Impact(u64),
    /// At the end.
    End,
}

impl<'a> ServerMessage<'a> {
    /// The end of a run, if it has ended.
    pub fn end(playback: &'a Playback) -> Option<Self> {
        let hold_end = playback.rest().map(|(_, end)| end);
        playback.outcome().map(|outcome| Self::End { outcome, demand: playback.load().into(), hold_end })
    }

    /// Impacts, and the strike after the last of them.
    pub fn impacts(impacts: &'a [ImpactMessage]) -> Self {
        if let [impact] = impacts {
            return Self::Impact { impact, next_strike: impact.next_strike };
        }
        let rows: Vec<_> = impacts.iter().map(|impact| impact.row).collect();
        let columns = table_of(columns::of_live_runs().map(|column| &column.row), &rows);
        let last = impacts.last();
        Self::Impacts { columns, next_strike: last.and_then(|last| last.next_strike), last: last.map(ImpactMessage::n) }
    }

    /// Samples of a hold.
    pub fn hold(part: &HoldPart) -> Self {
        Self::Hold { columns: table_of(&OF_HOLD, part.samples()) }
    }

    /// The message as a frame.
    pub fn to_frame(&self) -> OutgoingFrame {
        let (kind, id) = match self {
            ServerMessage::Hello(_) => ("hello", None),
            ServerMessage::Impact { impact, .. } => ("impact", Some(EventId::Impact(impact.n()))),
            ServerMessage::Impacts { last, .. } => ("impacts", last.map(EventId::Impact)),
            ServerMessage::Hold { .. } => ("hold", None),
            ServerMessage::Gap { .. } => ("gap", None),
            ServerMessage::End { .. } => ("end", Some(EventId::End)),
            ServerMessage::Problem { .. } => ("problem", None),
            ServerMessage::Ack(_) => ("ack", None),
        };
        let text = serde_json::to_string(self).expect("messages are numbers and text under text keys");
        OutgoingFrame::Message { kind, id, text }
    }
}

/// A problem as a frame.
pub fn problem(problem: &Problem) -> OutgoingFrame {
    let status = problem.status().as_u16();
    let (title, detail, errors) = (problem.title(), problem.detail(), problem.errors());
    ServerMessage::Problem { status, title, detail, errors }.to_frame()
}

/// The run and its present state.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(inline)]
pub struct Hello {
    /// The scene that the run was released with.
    scene: Resolved,
    /// The scene with everything that has been set so far.
    scene_in_force: Resolved,
    /// Quantities that follow from the scene of the release.
    derived: Derived,
    model: ModelChoice,
    /// Wall time of the release since 1970, ms.
    #[schemars(with = "f64")]
    epoch_ms: u64,
    /// Ratio of run time to wall time, no unit.
    speed: f64,
    paused: bool,
    /// The server's clock since 1970, ms.
    #[schemars(with = "f64")]
    now_ms: u64,
    /// Run time now, since the release, s.
    run_time: f64,
    /// Address that replays this run.
    url: String,
    /// The state at the release.
    release: FreeBody,
    /// Time from the release to the first contact, s.
    flight_time: Option<f64>,
    first_strike: Option<LiveNextStrike>,
    build: &'static str,
}

impl Hello {
    /// The run from `playback` on, at the wall time `now`, unix ms. Its URL begins with `base`.
    ///
    /// # Errors
    /// `go_on` said `false`.
    pub fn new(
        live: &LiveRun,
        playback: &Playback,
        (base, now): (&str, u64),
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Self, Cancelled> {
        let (scene, clock) = (live.run.scene(), &live.clock);
        let (release, mut released) = (scene.release(), Playback::new(&live.run, limits::LIVE_BOUNCES));
        Ok(Self {
            scene: Resolved(**scene),
            scene_in_force: Resolved(*playback.scene()),
            derived: Derived::of(scene),
            model: ModelChoice::of(scene),
            epoch_ms: clock.epoch(),
            speed: clock.speed(),
            paused: clock.is_paused(),
            now_ms: now,
            run_time: clock.run_time(now),
            url: format!("{base}{}", run_url::url(live)),
            release: FreeBody::new(has_angle(scene), 0.0, [release.x, release.height], &release.state),
            flight_time: released.next_t(),
            first_strike: LiveNextStrike::of(&mut released, &live.run, go_on)?,
            build: BUILD,
        })
    }
}

/// Acknowledgement of a message, with the state of the run.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(inline)]
pub struct Ack<'a> {
    /// Type of the message.
    #[schemars(with = "ClientMessageName")]
    pub of: &'static str,
    /// Address that replays the run so far.
    pub url: &'a str,
    /// Run time, s.
    pub run_time: f64,
    /// The server's clock since 1970, ms.
    #[schemars(with = "f64")]
    pub now_ms: u64,
    /// Ratio of run time to wall time, also while paused, no unit.
    pub speed: f64,
    /// True if the run is paused.
    pub paused: bool,
    /// Number of the impact to which a `set`, `kick`, `catch` or `throw` applies, or to which a `step` proceeds.
    pub impact: Option<u64>,
    /// The strike that comes next, with everything that has been set.
    pub next_strike: Option<LiveNextStrike>,
}

/// An impact: an object of its columns, and the strike after it.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactMessage {
    /// The impact.
    pub row: ImpactRow,
    /// The strike after it.
    pub next_strike: Option<LiveNextStrike>,
}

impl ImpactMessage {
    /// Number of the impact, from 1.
    pub fn n(&self) -> u64 {
        self.row.contact.n
    }

    /// Time to the next one, s of run time.
    pub fn flight_time(&self) -> Option<f64> {
        self.row.contact.flight_time
    }
}

impl Serialize for ImpactMessage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_map(None)?;
        for column in columns::of_live_runs() {
            column.row.read.write_member(&self.row, column.row.name, &mut object)?;
        }
        object.end()
    }
}

impl JsonSchema for ImpactMessage {
    fn schema_name() -> Cow<'static, str> {
        "ImpactMessage".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut schema = Schema::try_from(row_schema("", &columns::live_words())).unwrap_or_default();
        // Members of a message are added.
        schema.remove("additionalProperties");
        schema
    }
}

/// The next strike as the server foresees it, with everything that has been set so far. A client draws the table on its way there. The run can end
/// at that contact without a strike. Null after the end, and while the table holds the body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct LiveNextStrike {
    /// Number of the impact.
    n: u64,
    /// Run time since the release, s.
    t: f64,
    /// Horizontal position of the contact point, m.
    x: f64,
    /// Height of the contact point, m. 0 unless the table strikes early or late.
    y: f64,
    /// Angle of the table, rad.
    alpha: f64,
    /// Null if it is too large for a double.
    table_velocity: Option<TableVelocity>,
    target: Option<EnergyTarget>,
}

/// Velocity of the table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct TableVelocity {
    /// Horizontal velocity, m/s.
    pub x: f64,
    /// Vertical velocity, m/s.
    pub y: f64,
}

impl LiveNextStrike {
    /// The strike that a run comes to next. None after its end.
    ///
    /// # Errors
    /// `go_on` said `false`.
    pub fn of(playback: &mut Playback, run: &Run, go_on: &mut dyn FnMut() -> bool) -> Result<Option<Self>, Cancelled> {
        let Some(t) = playback.next_t() else { return Ok(None) };
        let Some((coming, strike, scene)) = playback.foresee(run, go_on)? else { return Ok(None) };
        let (x, y) = strike.table_velocity;
        Ok(Some(Self {
            n: coming.n,
            t,
            x: coming.x + playback.body().rod.contact_distance * strike.sin_cos_theta.0,
            y: coming.clearance,
            alpha: strike.alpha,
            // + 0.0 turns −0, the velocity of a table at rest, into 0.
            table_velocity: (x.is_finite() && y.is_finite()).then_some(TableVelocity { x: x + 0.0, y: y + 0.0 }),
            target: EnergyTarget::of(&scene, coming.n),
        }))
    }
}

#[cfg(test)]
mod tests {
    use equipoise_physics::catching::settings::{CatchSettings, Strategy};
    use equipoise_physics::map::body::Kick;
    use equipoise_physics::scene::{Name, Value as FieldValue};
    use serde_json::{Value, json};

    use super::*;
    use crate::runs::run::tests::case;

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

    /// The next strike, with nobody to stop it.
    fn next_strike(playback: &mut Playback, run: &Run) -> Option<LiveNextStrike> {
        LiveNextStrike::of(playback, run, &mut || true).unwrap()
    }

    /// Compares each foreseen strike with the contact that comes.
    fn follow(run: &Run, impacts: u64) {
        let mut playback = Playback::new(run, impacts);
        while let Some(next) = next_strike(&mut playback, run) {
            let (contact, _) = playback.next_impact(run, &mut || true).unwrap().unwrap();
            assert_eq!((next.n, next.t.to_bits()), (contact.n, contact.t.to_bits()));
            assert_eq!((next.y, next.alpha.to_bits()), (contact.clearance, contact.alpha.to_bits()), "at {}", next.n);
            let foot = contact.x + playback.body().rod.contact_distance * contact.state.theta.sin();
            assert!((next.x - foot).abs() <= 1e-12, "{next:?}");
            let velocity = next.table_velocity.unwrap();
            if let Some(strike) = contact.strike {
                assert_eq!((velocity.x, velocity.y), strike.table_velocity);
            }
            assert_eq!(next.target, EnergyTarget::of(playback.scene(), next.n));
        }
    }

    #[test]
    fn every_strike_comes_as_it_was_foreseen() {
        for preset in crate::api::scene::presets::all() {
            follow(&case(preset.name), 300);
        }
    }

    #[test]
    fn strikes_of_a_catch_come_as_they_were_foreseen() {
        let mut run = case("case-1");
        run.catch(3, CatchSettings { strategy: Some(Strategy::BounceDown), ..CatchSettings::default() }).unwrap();
        run.kick(5, Kick { theta_dot: 0.2, ..Kick::default() }).unwrap();
        run.set(6, &[(Name::Restitution, FieldValue::Number(0.9))]).unwrap();
        follow(&run, 300);
    }

    #[test]
    fn a_change_is_foreseen_once_it_is_known() {
        let mut run = case("case-4");
        let before = next_strike(&mut Playback::new(&run, 100), &run).unwrap();
        run.set(1, &[(Name::TiltGain, FieldValue::Number(1.3)), (Name::TargetHeight, FieldValue::Number(0.4))])
            .unwrap();
        let after = next_strike(&mut Playback::new(&run, 100), &run).unwrap();
        assert!((after.alpha - 1.3 / 1.1 * before.alpha).abs() < 1e-15);
        assert_ne!((after.target, after.table_velocity), (before.target, before.table_velocity));
        follow(&run, 100);
    }

    #[test]
    fn the_table_makes_up_the_loss() {
        // Eq. (25) for a rod that falls upright: with e = 1/2 the table comes up with a third of the speed that it meets.
        let mut run = case("case-4");
        let zero = [(Name::EnergyGain, FieldValue::Number(0.0))];
        run.set(1, &zero).unwrap();
        let mut playback = Playback::new(&run, 100);
        let next = next_strike(&mut playback, &run).unwrap();
        let (contact, _) = playback.next_impact(&run, &mut || true).unwrap().unwrap();
        let (sin, cos) = next.alpha.sin_cos();
        let beta = contact.state.theta - contact.alpha;
        let state = contact.state;
        let normal =
            cos * state.y_dot - sin * state.x_dot + playback.body().rod.contact_distance * state.theta_dot * beta.sin();
        let velocity = next.table_velocity.unwrap();
        assert!((velocity.y * cos - velocity.x * sin + normal / 3.0).abs() < 1e-12);
        assert!((velocity.y * sin + velocity.x * cos).abs() < 1e-12);
        assert_eq!(next.target, None);
    }
}
