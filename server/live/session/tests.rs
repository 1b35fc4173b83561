//! Sessions over channels instead of a socket, with slow, silent and idle clients.

use std::cell::Cell;
use std::future::{pending, ready};
use std::sync::Arc;
use std::task::Poll;
use std::time::Duration;

use axum::extract::ws::Message;
use equipoise_physics::scene::{Name, Value as FieldValue};
use futures_util::{FutureExt, StreamExt, sink, stream};
use serde_json::Value;
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::time::{Instant, sleep, timeout};

use crate::api::scene::presets;
use crate::limits;
use crate::limits::Limits;
use crate::live::catch_up::catch_up_with;
use crate::live::clock::Clock;
use crate::live::outbox::Unreadable;
use crate::live::run_url::{LiveRequest, LiveRun};
use crate::live::server_message::OutgoingFrame;
use crate::live::session::{Inbox, SessionBounds, SessionContext, serve, wall_now};
use crate::runs::run::Run;
use crate::runs::run::tests::case;

/// The client's ends of a connection that takes one message at a time.
struct Client {
    says: Sender<Result<Message, Unreadable>>,
    hears: Receiver<Message>,
}

fn open(request: LiveRequest, bounds: SessionBounds) -> Client {
    open_with(request, SessionContext::for_test(bounds))
}

fn open_with(request: LiveRequest, context: SessionContext) -> Client {
    let (says, incoming) = channel(1);
    let (outgoing, hears) = channel(1);
    let incoming = stream::unfold(incoming, async |mut from| from.recv().await.map(|message| (message, from)));
    let outgoing = sink::unfold(outgoing, async |to: Sender<Message>, frame: OutgoingFrame| {
        to.send(frame.into()).await.map(|()| to)
    });
    tokio::spawn(async move {
        let playback = catch_up_with(&request, &context).await;
        let incoming = Inbox::new(Box::pin(incoming));
        serve(request, playback, incoming, Box::pin(outgoing), context, std::future::pending()).await;
    });
    Client { says, hears }
}

fn bounds() -> SessionBounds {
    SessionBounds::for_websocket(&Limits::default())
}

/// A run of a preset that is released now.
fn now(preset: &str, speed: f64) -> LiveRequest {
    LiveRequest { live: LiveRun { run: case(preset), clock: Clock::new(wall_now(), speed) }, from: None }
}

impl Client {
    async fn hear(&mut self) -> Option<Message> {
        timeout(Duration::from_secs(20), self.hears.recv()).await.expect("the session is silent")
    }

    /// All messages up to the end, as JSON, and the close code.
    async fn rest(&mut self) -> (Vec<Value>, Option<u16>) {
        let (mut texts, mut code) = (vec![], None);
        while let Some(message) = self.hear().await {
            match message {
                Message::Text(text) => texts.push(serde_json::from_str(&text).unwrap()),
                Message::Close(frame) => code = frame.map(|frame| frame.code),
                _ => {}
            }
        }
        (texts, code)
    }
}

#[tokio::test]
async fn a_slow_client_gets_a_gap_and_no_impact_twice_or_out_of_order() {
    let bounds = SessionBounds { queue: 4, ..bounds() };
    let mut client = open(now("still-lossy", 20.0), bounds);
    assert!(client.hear().await.is_some());
    sleep(Duration::from_millis(500)).await;
    let (mut next, mut gaps, mut texts) = (1, 0, 0);
    loop {
        let Some(Message::Text(text)) = client.hear().await else { break };
        texts += 1;
        let message: Value = serde_json::from_str(&text).unwrap();
        let (first, last) = match message["type"].as_str().unwrap() {
            "impact" => (message["n"].as_u64().unwrap(), message["n"].as_u64().unwrap()),
            "impacts" => {
                let n = message["columns"]["n"].as_array().unwrap();
                (n[0].as_u64().unwrap(), n[n.len() - 1].as_u64().unwrap())
            }
            "gap" => {
                gaps += 1;
                (message["from"].as_u64().unwrap(), message["to"].as_u64().unwrap())
            }
            _ => break,
        };
        assert_eq!(first, next, "{message}");
        next = last + 1;
    }
    assert!(gaps > 0 && texts > 2 && next > 5, "{gaps} {texts} {next}");
}

#[tokio::test]
async fn a_client_that_stays_behind_is_closed_with_1013() {
    let bounds = SessionBounds { behind: Duration::from_millis(300), ..bounds() };
    let mut client = open(now("case-1", 20.0), bounds);
    sleep(Duration::from_millis(600)).await;
    assert_eq!(client.rest().await.1, Some(1013));
}

#[tokio::test]
async fn a_catch_up_waits_for_its_client() {
    let mut request = now("case-1", 1.0);
    request.live.clock = Clock::new(wall_now() - 600_000, 1.0);
    request.from = Some(1);
    let bounds = SessionBounds { queue: 256, ..bounds() };
    let mut client = open(request, bounds);
    let mut next = 1;
    while next < 1000 {
        sleep(Duration::from_millis(20)).await;
        let Some(Message::Text(text)) = client.hear().await else { panic!("closed at {next}") };
        let message: Value = serde_json::from_str(&text).unwrap();
        if message["type"] == "impacts" {
            for n in message["columns"]["n"].as_array().unwrap() {
                assert_eq!(*n, next);
                next += 1;
            }
        }
    }
}

#[tokio::test]
async fn a_silent_client_is_pinged_and_then_given_up() {
    let bounds = SessionBounds { ping: Duration::from_millis(50), silence: Duration::from_millis(250), ..bounds() };
    let mut client = open(now("case-1", 1.0), bounds);
    let (mut pings, mut code) = (0, None);
    while let Some(message) = client.hear().await {
        match message {
            Message::Ping(_) => pings += 1,
            Message::Close(frame) => code = frame.map(|frame| frame.code),
            _ => {}
        }
    }
    assert!(pings >= 2);
    assert_eq!(code, Some(1008));
}

#[tokio::test]
async fn a_client_is_let_go_at_the_end_of_its_time() {
    let mut client = open(now("case-1", 10.0), SessionBounds { lifetime: Duration::from_millis(500), ..bounds() });
    let (texts, code) = client.rest().await;
    assert_eq!(code, Some(1001));
    assert!(texts.len() > 1 && texts[0]["type"] == "hello", "{texts:?}");
}

#[tokio::test]
async fn a_client_that_answers_pings_stays_until_it_is_idle() {
    let bounds = SessionBounds {
        ping: Duration::from_millis(50),
        silence: Duration::from_secs(1),
        idle: Duration::from_millis(2000),
        ..bounds()
    };
    let mut client = open(now("case-1", 1.0), bounds);
    client.says.send(Ok(Message::text(r#"{"type":"pause"}"#))).await.unwrap();
    let (mut pongs, mut code) = (0, None);
    while let Some(message) = client.hear().await {
        match message {
            Message::Ping(_) if client.says.send(Ok(Message::Pong(axum::body::Bytes::new()))).await.is_ok() => {
                pongs += 1;
            }
            Message::Close(frame) => code = frame.map(|frame| frame.code),
            _ => {}
        }
    }
    assert_eq!((code, pongs >= 10), (Some(1000), true), "{pongs}");
}

thread_local! {
    /// A clock that a test sets, unix ms.
    static SET_CLOCK: Cell<u64> = const { Cell::new(1_700_000_000_000) };
}

/// Ten seconds of a run are due at once: eight million impacts. Time is virtual, and passes only while the session waits.
#[tokio::test(start_paused = true)]
async fn a_run_of_a_million_bounces_a_second_takes_no_core() {
    let clock = || SET_CLOCK.with(Cell::get);
    let mut draft = presets::find("case-1").unwrap().draft();
    draft.set(Name::Theta, Some(FieldValue::Number(0.0))).unwrap();
    draft.set(Name::Height, Some(FieldValue::Number(0.133_333_334))).unwrap();
    let live = LiveRun { run: Run::new(draft.build().unwrap()), clock: Clock::new(clock() + 1, 20.0) };
    let context = SessionContext { wall: clock, ..SessionContext::for_test(bounds()) };
    let bounces = context.bounces.clone();
    let mut client = open_with(LiveRequest { live, from: Some(1) }, context);
    assert!(matches!(client.hear().await, Some(Message::Text(_))));
    let (begin, before) = (Instant::now(), bounces.get());
    SET_CLOCK.set(clock() + 10_000);
    for batch in 1..=100 {
        let Some(Message::Text(text)) = client.hear().await else { panic!("closed at {batch}") };
        let message: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(message["columns"]["n"].as_array().map(Vec::len), Some(limits::LIVE_BATCH), "{}", message["type"]);
        let batches = begin.elapsed().div_duration_f64(limits::LIVE_BATCH_TIME).ceil();
        let computed = bounces.get() - before;
        assert!(computed as f64 <= batches * limits::LIVE_BATCH as f64, "{computed} in {batches} batches");
    }
}

#[tokio::test]
async fn work_ends_with_its_client_and_messages_wait_for_it() {
    let [one, two] = ["1", "2"].map(|text| Ok(Message::text(text)));
    let messages = stream::iter([one.clone(), two.clone()]).chain(stream::once(ready(Ok(Message::Close(None)))));
    let mut inbox = Inbox::new(messages);
    let held = Arc::new(());
    let work = {
        let held = held.clone();
        async move {
            pending::<()>().await;
            drop(held);
        }
    };
    assert_eq!(inbox.attend(work).await, None);
    assert_eq!(Arc::strong_count(&held), 1, "the work goes on");
    let mut inbox = Inbox::new(stream::iter([one.clone(), two.clone()]).chain(stream::pending()));
    let mut polls = 0;
    let work = std::future::poll_fn(|context| {
        polls += 1;
        context.waker().wake_by_ref();
        if polls > 4 { Poll::Ready(5) } else { Poll::Pending }
    });
    assert_eq!(inbox.attend(work).await, Some(5));
    assert_eq!((inbox.next().await, inbox.next().await), (Some(one), Some(two)));
    assert!(inbox.next().now_or_never().is_none());
}
