//! Messages of a live client, and how they are read.
//!
//! `session` carries them out.

use equipoise_physics::catching::settings::CatchSettings;
use equipoise_physics::catching::throw::ThrowTarget;
use equipoise_physics::map::body::Kick;
use equipoise_physics::scene::{Name, Value as FieldValue};
use serde_json::{Value, json};

use crate::api::scene::fields::live_paths;
use crate::http::request::fields::{Absence, FieldList, Fields, Object, number};
use crate::http::request::reader::join;
use crate::http::request::tree as json_body;
use crate::http::{Errors, Problem, Reader, Source};
use crate::live::clock::SPEEDS;
use crate::request_fields;
use crate::runs::interventions::{read_kick, read_set};

/// A message of the client.
#[derive(Debug, Clone, PartialEq)]
pub enum ClientMessage {
    /// Pause the clock.
    Pause,
    /// Resume the clock.
    Resume,
    /// Move a paused clock to the next impact.
    Step,
    /// Release the run again, now.
    Restart,
    /// Change the speed.
    Speed(f64),
    /// Set these fields from the next impact on.
    Set(Vec<(Name, FieldValue)>),
    /// Kick the body just after the next impact.
    Kick(Kick),
    /// Catch the body from the next impact on, and hold it.
    Catch(CatchSettings),
    /// Throw the body at the next impact, or from the table that holds it.
    Throw(ThrowTarget),
}

/// The type of a message: its fields besides the type, and how they are read.
#[derive(Clone, Copy)]
struct MessageType {
    describe: fn(&mut FieldList),
    read: fn(&mut Reader<'_, '_>) -> Option<ClientMessage>,
}

/// The types by name.
const TYPES: [(&str, MessageType); 9] = {
    use ClientMessage::{Catch, Kick as Kicked, Pause, Restart, Resume, Speed, Step, Throw};
    const fn fields(
        describe: fn(&mut FieldList),
        read: fn(&mut Reader<'_, '_>) -> Option<ClientMessage>,
    ) -> MessageType {
        MessageType { describe, read }
    }
    [
        ("pause", fields(|_| (), |_| Some(Pause))),
        ("resume", fields(|_| (), |_| Some(Resume))),
        ("step", fields(|_| (), |_| Some(Step))),
        ("restart", fields(|_| (), |_| Some(Restart))),
        (
            "speed",
            fields(SpeedMessage::describe_fields, |reader| Some(Speed(SpeedMessage::read_fields(reader)?.value))),
        ),
        ("set", fields(|list| list.properties.extend(live_paths()), read_changes)),
        ("kick", fields(Kick::describe_fields, |reader| read_kick(reader).map(Kicked))),
        ("catch", fields(CatchSettings::describe_fields, |reader| CatchSettings::read_fields(reader).map(Catch))),
        ("throw", fields(ThrowMessage::describe_fields, |reader| Some(Throw(ThrowMessage::read_fields(reader)?.apex)))),
    ]
};

/// Reads the fields that a message sets, all but its type.
fn read_changes(reader: &mut Reader<'_, '_>) -> Option<ClientMessage> {
    let mut paths = reader.fields().clone();
    paths.shift_remove("type");
    for (key, value) in reader.fields() {
        reader.value(key);
        if value.is_object() {
            reader.errors().push(join("", key), "an object has no place here; name fields by dotted path");
        }
    }
    read_set(&paths, "", Source::Json, reader.errors()).map(ClientMessage::Set)
}

request_fields! {
    /// A change of the speed.
    struct SpeedMessage {
        /// Ratio of run time to wall time, no unit.
        value: f64 = number(SPEEDS, "").required(),
    }
}

request_fields! {
    /// A throw.
    struct ThrowMessage {
        /// The top of the flight after the throw.
        apex: ThrowTarget = Object.required(),
    }
}

/// Schemas of all messages, by their types.
pub fn schemas() -> impl Iterator<Item = (&'static str, Value)> {
    TYPES.iter().map(|(name, kind)| {
        let mut list = FieldList::default();
        list.properties.insert("type".to_owned(), json!({"type": "string", "const": name}));
        list.require("type");
        (kind.describe)(&mut list);
        let mut schema = list.into_schema();
        if matches!(*name, "set" | "kick") {
            schema["minProperties"] = json!(2);
        }
        (*name, schema)
    })
}

impl ClientMessage {
    /// Names of all messages, as in `type`.
    pub fn names() -> impl Iterator<Item = &'static str> {
        TYPES.iter().map(|(name, _)| *name)
    }

    /// The `type` of the message.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Pause => "pause",
            Self::Resume => "resume",
            Self::Step => "step",
            Self::Restart => "restart",
            Self::Speed(_) => "speed",
            Self::Set(_) => "set",
            Self::Kick(_) => "kick",
            Self::Catch(_) => "catch",
            Self::Throw(_) => "throw",
        }
    }

    /// Reads a message.
    ///
    /// # Errors
    /// All errors of the message.
    pub fn read(text: &str) -> Result<Self, Problem> {
        let fields = json_body::object(text.as_bytes()).map_err(|problem| of_a_message(&problem))?;
        let mut errors = Errors::default();
        let mut reader = Reader::new(&fields, String::new(), Source::Json, &mut errors);
        reader.require(&["type"]);
        let Some(kind) = reader.choice("type", &TYPES) else {
            return errors.into_result().and_then(|()| Err(Problem::internal()));
        };
        let message = (kind.read)(&mut reader);
        reader.finish();
        errors.into_result()?;
        message.ok_or_else(Problem::internal)
    }
}

/// The JSON reader speaks of a body; here it is a message.
fn of_a_message(problem: &Problem) -> Problem {
    let named = |detail: &str| detail.replacen("the body", "the message", 1);
    match problem.errors() {
        [] => Problem::not_readable(named(problem.detail())),
        errors => {
            let mut errors = errors.to_vec();
            errors.iter_mut().for_each(|error| error.detail = named(&error.detail));
            Problem::invalid(errors)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use equipoise_physics::catching::settings::Strategy;

    fn refused(text: &str) -> Vec<String> {
        let problem = ClientMessage::read(text).unwrap_err();
        assert!(problem.status().is_client_error(), "{text}: {problem:?}");
        problem.into_errors().into_iter().map(|error| error.pointer).collect()
    }

    #[test]
    fn orders_are_read() {
        assert_eq!(ClientMessage::read(r#"{"type":"pause"}"#).unwrap(), ClientMessage::Pause);
        assert_eq!(ClientMessage::read(r#"{"type":"speed","value":2}"#).unwrap(), ClientMessage::Speed(2.0));
        assert_eq!(
            ClientMessage::read(r#"{"type":"set","table.tilt_gain":1.3,"contact.restitution":0.5}"#).unwrap(),
            ClientMessage::Set(vec![
                (Name::Restitution, FieldValue::Number(0.5)),
                (Name::TiltGain, FieldValue::Number(1.3))
            ])
        );
        let kick = Kick { theta_dot: 0.5, ..Kick::default() };
        assert_eq!(ClientMessage::read(r#"{"type":"kick","theta_dot":0.5}"#).unwrap(), ClientMessage::Kick(kick));
        let settings = CatchSettings { strategy: Some(Strategy::Brake), hold: 2.0, ..CatchSettings::default() };
        assert_eq!(
            ClientMessage::read(r#"{"type":"catch","strategy":"brake","hold":2}"#).unwrap(),
            ClientMessage::Catch(settings)
        );
        assert_eq!(
            ClientMessage::read(r#"{"type":"throw","apex":{"height":0.4}}"#).unwrap(),
            ClientMessage::Throw(ThrowTarget { height: 0.4, theta: 0.0 })
        );
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        for (text, pointers) in [
            ("pause", vec![]),
            ("[]", vec![""]),
            ("{}", vec!["/type"]),
            (r#"{"type":"stop"}"#, vec!["/type"]),
            (r#"{"type":"pause","for":1}"#, vec!["/for"]),
            (r#"{"type":"speed"}"#, vec!["/value"]),
            (r#"{"type":"speed","value":0}"#, vec!["/value"]),
            (r#"{"type":"set"}"#, vec![""]),
            (r#"{"type":"set","table.tilt_gain":"1"}"#, vec!["/table.tilt_gain"]),
            (r#"{"type":"set","table":{"tilt_gain":2}}"#, vec!["/table"]),
            (
                r#"{"type":"set","gravity":1,"colour":2,"table.tilt_gain":null}"#,
                vec!["/colour", "/gravity", "/table.tilt_gain"],
            ),
            (r#"{"type":"kick"}"#, vec![""]),
            (r#"{"type":"kick","theta_dot":1e3,"y":1}"#, vec!["/theta_dot", "/y"]),
            (r#"{"type":"catch","strategy":"net"}"#, vec!["/strategy"]),
            (r#"{"type":"catch","strategy":"brake","ratio":0.5,"hold":900}"#, vec!["/hold", "/ratio"]),
            (r#"{"type":"throw"}"#, vec!["/apex"]),
            (
                r#"{"type":"throw","apex":{"height":-1,"theta":1e9,"y":2}}"#,
                vec!["/apex/height", "/apex/theta", "/apex/y"],
            ),
        ] {
            let mut found = refused(text);
            found.sort();
            assert_eq!(found, pointers, "{text}");
        }
    }

    #[test]
    fn a_message_is_called_a_message() {
        assert!(ClientMessage::read("nonsense").unwrap_err().detail().starts_with("the message is not JSON"));
        assert_eq!(ClientMessage::read("[]").unwrap_err().detail(), "the message must be a JSON object");
    }
}
