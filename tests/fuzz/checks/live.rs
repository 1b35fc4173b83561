//! Input from clients of live runs: the URL of the run, and the messages that change it.

use equipoise::api::computed::catches::request::strategy_name;
use equipoise::api::scene::{has_angle, value_to_json};
use equipoise::http::{Errors, Problem, Reader, Source};
use equipoise::limits;
use equipoise::live::client_message::ClientMessage;
use equipoise::live::run_url;
use equipoise::live::run_url::{LiveRequest, LiveRun};
use equipoise::runs::run::ThrowOrder;
use equipoise_physics::catching::settings::CatchSettings;
use equipoise_physics::control::bounce_model::STATE;
use serde_json::{Map, Value, json};

use super::{problem, query};

/// The server's clock at the request for the run, unix ms.
const NOW: u64 = 1_800_000_000_000;

/// Time between two messages, ms, and number of impacts between them.
const PACE: (u64, u64) = (731, 3);

/// The server's clock at the message of a number.
fn now(n: u64) -> u64 {
    NOW + PACE.0 * n
}

/// The first line is the query of a run's URL, the others are messages. After each message the run's URL reads back as the same run.
pub(crate) fn check(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let (first, messages) = text.split_once('\n').unwrap_or((text, ""));
    let mut run = begin(first);
    for (message, n) in messages.lines().zip(1..) {
        let order = match ClientMessage::read(message) {
            Ok(order) => order,
            Err(refused) => {
                let sent = serde_json::from_str::<Value>(message).ok();
                let has_doubles = refused.errors().iter().any(|error| error.detail.ends_with("twice in one object"));
                problem::hold(&refused, sent.as_ref().filter(|_| !has_doubles), message.len());
                continue;
            }
        };
        let again = ClientMessage::read(&written(&order)).unwrap_or_else(|refused| panic!("{message}: {refused:?}"));
        assert_eq!(again, order, "{message}");
        let Some(run) = &mut run else { continue };
        let changed = carried_out(run, &order, n);
        if !run_url::is_too_long(&changed) {
            *run = changed;
            reads_back(run, None, now(n));
        }
    }
}

/// The run of a query; the run of a preset if the query is not valid.
fn begin(text: &str) -> Option<LiveRun> {
    let fields = match query::tree(text) {
        Ok(fields) => fields,
        Err(refused) => {
            problem::hold(&refused, None, text.len());
            return None;
        }
    };
    match read(&fields, NOW) {
        Ok(LiveRequest { live: run, from, .. }) => {
            reads_back(&run, from, NOW);
            Some(run)
        }
        Err(refused) => {
            problem::hold(&refused, Some(&Value::Object(fields)), text.len());
            None
        }
    }
}

fn read(fields: &Map<String, Value>, now: u64) -> Result<LiveRequest, Problem> {
    let mut errors = Errors::default();
    let mut reader = Reader::new(fields, String::new(), Source::Query, &mut errors);
    let asked = run_url::read(&mut reader, now);
    reader.finish();
    errors.into_result()?;
    Ok(asked.expect("where there is no run, the errors say why"))
}

/// Panics unless the run's URL reads back as the run.
fn reads_back(run: &LiveRun, from: Option<u64>, now: u64) {
    let url = run_url::url(run);
    let query = url.split_once('?').expect("a query").1;
    let query = from.map_or_else(|| query.to_owned(), |from| format!("{query}&from={from}"));
    let asked = query::tree(&query).and_then(|fields| read(&fields, now));
    let asked = asked.unwrap_or_else(|refused| panic!("{url} was refused: {refused:?}"));
    assert_eq!(asked, LiveRequest { live: run.clone(), from }, "{url}");
    assert_eq!(run_url::url(&asked.live), url);
}

/// The JSON text of a message.
fn written(order: &ClientMessage) -> String {
    let mut message = json!({"type": order.name()});
    match order {
        ClientMessage::Pause | ClientMessage::Resume | ClientMessage::Step | ClientMessage::Restart => {}
        ClientMessage::Speed(speed) => message["value"] = json!(speed),
        ClientMessage::Set(changes) => {
            for (name, value) in changes {
                message[name.row().path] = value_to_json(*value);
            }
        }
        ClientMessage::Kick(kick) => {
            for (name, value) in [("x_dot", kick.x_dot), ("y_dot", kick.y_dot), ("theta_dot", kick.theta_dot)] {
                message[name] = json!(value);
            }
        }
        ClientMessage::Catch(settings) => {
            let CatchSettings { strategy, ratio, strikes, brake, state_weights, input_weight, hold_speed, hold } =
                settings;
            message["strategy"] = json!(strategy_name(*strategy));
            for (name, value) in [("ratio", *ratio), ("strikes", strikes.map(f64::from)), ("brake", *brake)] {
                if let Some(value) = value {
                    message[name] = json!(value);
                }
            }
            message["weights"] = json!({"state": {}, "input": input_weight});
            for (name, weight) in STATE.iter().zip(state_weights) {
                message["weights"]["state"][name] = json!(weight);
            }
            message["hold_speed"] = json!(hold_speed);
            message["hold"] = json!(hold);
        }
        ClientMessage::Throw(target) => message["apex"] = json!({"height": target.height, "theta": target.theta}),
    }
    message.to_string()
}

/// The run after a message, as in a session; unchanged if the run refuses the message.
fn carried_out(run: &LiveRun, order: &ClientMessage, n: u64) -> LiveRun {
    let (now, impact) = (now(n), PACE.1 * n);
    let mut changed = run.clone();
    match order {
        ClientMessage::Pause => changed.clock.pause(now),
        ClientMessage::Resume => changed.clock.resume(now),
        ClientMessage::Speed(speed) => changed.clock.set_speed(now, *speed),
        ClientMessage::Step => {
            if changed.clock.is_paused() {
                let to = changed.clock.run_time(now) + 0.3;
                changed.clock.step(now, to);
            }
        }
        ClientMessage::Set(changes) => {
            if let Err(errors) = changed.run.set(impact, changes) {
                assert!(!errors.is_empty());
                assert_eq!(changed, *run, "what is refused leaves the run as it was");
            }
        }
        ClientMessage::Kick(kick) => {
            if kick.theta_dot == 0.0 || has_angle(run.run.scene()) {
                // Too many kicks, or a sum of kicks that is too large.
                let _ = changed.run.kick(impact, *kick);
            }
        }
        ClientMessage::Catch(settings) => {
            if has_angle(run.run.scene()) {
                let _ = changed.run.catch(impact, *settings);
            }
        }
        ClientMessage::Throw(target) => {
            if has_angle(run.run.scene()) {
                let t = n.is_multiple_of(2).then_some(0.3 * impact as f64);
                let _ = changed.run.throw(impact, ThrowOrder { apex: *target, t });
            }
        }
        ClientMessage::Restart => changed = run.restarted(now, impact),
    }
    changed.clock.forget_beyond(limits::LIVE_CLOCK_ENTRIES);
    changed
}
