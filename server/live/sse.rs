//! Live runs as Server-Sent Events: the position of a client that reconnects, and the form of events.
//!
//! The client only listens. A session sends it the same messages as over a WebSocket.

use std::convert::Infallible;

use axum::extract::ws::Message;
use axum::http::HeaderMap;
use axum::response::sse::Event;
use futures_util::{Stream, StreamExt, sink, stream};
use serde_json::Value;
use tokio::sync::{mpsc, oneshot};

use crate::http::Reader;
use crate::http::request::reader;
use crate::http::request::reader::Source;
use crate::limits;
use crate::live::run_url::LiveRequest;
use crate::live::server_message::{EventId, OutgoingFrame};
use crate::live::session::{Inbox, SessionContext};
use crate::live::{run_url, session};
use crate::runs::playback::Playback;

/// Id of the last event of a run.
const END: &str = "end";

/// A request for events.
#[derive(Debug)]
pub enum EventsRequest {
    /// A run.
    Run(Box<LiveRequest>),
    /// The client has already got the end.
    AlreadyEnded,
}

/// Reads a live run and the id of its last event that the client got: from the header that browsers send when they reconnect, or
/// from the parameter. Returns None if something is wrong; the reader then has the errors.
pub fn read(reader: &mut Reader<'_, '_>, headers: &HeaderMap, now: u64) -> Option<EventsRequest> {
    const NAME: &str = "after";
    let has_epoch = reader.has("epoch_ms");
    let parameter = reader.text(NAME).map(str::to_owned);
    let header = headers.get("last-event-id").map(|id| String::from_utf8_lossy(id.as_bytes()).into_owned());
    let mut request = run_url::read(reader, now)?;
    let Some(last) = header.filter(|id| !id.is_empty()).or(parameter) else {
        return Some(EventsRequest::Run(request.into()));
    };
    if last == END {
        return Some(EventsRequest::AlreadyEnded);
    }
    let heard = reader::integer(&Value::from(last), Source::Query, &(1..=limits::LIVE_BOUNCES));
    let problem = match heard {
        Ok(heard) if has_epoch => {
            request.from = Some(heard + 1);
            return Some(EventsRequest::Run(request.into()));
        }
        // Without an epoch it would be released now, and so be another run.
        Ok(_) => "is of a run whose epoch_ms is not given; come back to the address in `url` of `hello`".to_owned(),
        Err(error) => format!("{error}, or `{END}`"),
    };
    reader.refuse(NAME, format!("{NAME} {problem}"));
    None
}

/// The events of a run. The session ends when the client goes, which drops the events, or at `closing`. It keeps `held` until then.
pub fn events(
    request: LiveRequest,
    playback: Playback,
    context: SessionContext,
    closing: impl Future<Output = ()> + Send + 'static,
    held: impl Send + 'static,
) -> impl Stream<Item = Result<Event, Infallible>> + Send + 'static {
    let (to, events) = mpsc::channel(1);
    let (here, gone) = oneshot::channel::<Infallible>();
    let outgoing = sink::unfold(to, async |to: mpsc::Sender<Event>, frame| match event(frame) {
        Some(event) => to.send(event).await.map(|()| to),
        None => Ok(to),
    });
    let incoming = stream::once(async {
        let _ = gone.await;
        Ok(Message::Close(None))
    });
    tokio::spawn(async move {
        let _held = held;
        let incoming = Inbox::new(Box::pin(incoming));
        session::serve(request, Ok(playback), incoming, Box::pin(outgoing), context, closing).await;
    });
    let first = Event::default().retry(limits::LIVE_RETRY_TIME);
    let rest = stream::unfold((events, here), async |(mut events, here)| {
        events.recv().await.map(|event| (event, (events, here)))
    });
    stream::iter([first]).chain(rest).map(Ok)
}

/// A frame as an event. A close ends the events.
fn event(frame: OutgoingFrame) -> Option<Event> {
    match frame {
        OutgoingFrame::Message { kind, id, text } => {
            let event = Event::default().event(kind).data(text);
            Some(match id {
                Some(EventId::Impact(n)) => event.id(n.to_string()),
                Some(EventId::End) => event.id(END),
                None => event,
            })
        }
        OutgoingFrame::Ping => Some(Event::default().comment("")),
        OutgoingFrame::Close(..) => None,
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use axum::response::{IntoResponse, Sse};
    use http_body_util::BodyExt;
    use prometheus_client::metrics::gauge::Gauge;

    use super::*;
    use crate::compute::GaugeGuard;
    use crate::limits::Limits;
    use crate::live::clock::Clock;
    use crate::live::run_url::LiveRun;
    use crate::live::session::{SessionBounds, wall_now};
    use crate::runs::run::tests::case;

    /// Everything that a client gets that begins to read late.
    async fn heard(preset: &str, bounds: SessionBounds) -> String {
        let live = LiveRun { run: case(preset), clock: Clock::new(wall_now(), 20.0) };
        let request = LiveRequest { live, from: None };
        let context = SessionContext::for_test(bounds);
        let playback = crate::live::catch_up::catch_up_with(&request, &context).await.unwrap();
        let sessions = Gauge::default();
        let events = events(request, playback, context, std::future::pending(), GaugeGuard::new(&sessions));
        tokio::time::sleep(Duration::from_millis(500)).await;
        let body = Sse::new(events).into_response().into_body().collect().await.unwrap().to_bytes();
        String::from_utf8(body.to_vec()).unwrap()
    }

    #[tokio::test]
    async fn a_slow_client_is_told_what_it_misses_and_the_end() {
        let text = heard("still-lossy", SessionBounds { queue: 4, ..SessionBounds::for_sse(&Limits::default()) }).await;
        assert!(text.contains("event: gap\n"), "{text}");
        assert!(text.ends_with("id: end\n\n"), "{text}");
    }

    #[tokio::test]
    async fn a_client_is_pinged_and_let_go_in_time() {
        let (ping, lifetime) = (Duration::from_millis(50), Duration::from_millis(700));
        let text =
            heard("case-1", SessionBounds { ping, lifetime, ..SessionBounds::for_sse(&Limits::default()) }).await;
        assert!(text.starts_with("retry: ") && text.contains("\n\n:") && !text.contains("id: end"), "{text}");
    }
}
