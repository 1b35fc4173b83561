//! `live`: a run told as it happens, over a WebSocket, or as Server-Sent Events to a client that only listens.

use std::future::ready;

use axum::Router;
use axum::extract::State;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{Message, WebSocketUpgrade};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response, Sse};
use axum::routing::get;
use futures_util::{SinkExt, StreamExt};

use super::App;
use crate::compute::Counted;
use crate::http::problem::shortened;
use crate::http::{Ask, Format, Problem, Resource};
use crate::limits;
use crate::live::address::{self, PATH};
use crate::live::bounds::Bounds;
use crate::live::events::{self, Wanted};
use crate::live::session::{self, Place};

const SUBPROTOCOL: &str = "equipoise.v1";

const EVENTS: Resource = Resource { name: "live/events", formats: &[Format::Events] };

/// Their paths.
pub fn routes() -> Router<App> {
    Router::new().route(PATH, get(live)).route("/v1/live/events", get(live_events))
}

type Upgrade = Result<WebSocketUpgrade, WebSocketUpgradeRejection>;

/// What is wrong with the run is told first, so that a page whose WebSocket was refused can ask why.
async fn live(State(app): State<App>, upgrade: Upgrade, ask: Ask) -> Result<Response, Problem> {
    let asked = ask.read(|reader| address::read(reader, session::wall_now()))?;
    let upgrade = match upgrade {
        Ok(upgrade) => upgrade,
        Err(rejection) => return Ok(not_a_websocket(&rejection, &ask.headers)),
    };
    check_origin(&ask.headers)?;
    let (counted, place) = admit(&app, Bounds::default())?;
    let upgrade = upgrade
        .protocols([SUBPROTOCOL])
        .max_message_size(limits::LIVE_FRAME_BYTES)
        .max_frame_size(limits::LIVE_FRAME_BYTES);
    Ok(upgrade.on_upgrade(async move |socket| {
        let _counted = counted;
        let (outgoing, incoming) = socket.split();
        let outgoing = outgoing.with(|frame| ready(Ok::<_, axum::Error>(Message::from(frame))));
        let course = session::caught_up(&asked, &place).await;
        session::serve(asked, course, incoming, outgoing, place, app.closing()).await;
    }))
}

/// Here a run that cannot be caught up with is refused at once: a client of events sees the status, and comes back only
/// where it is 200.
async fn live_events(State(app): State<App>, ask: Ask) -> Result<Response, Problem> {
    let wanted = ask.read(|reader| events::read(reader, &ask.headers, session::wall_now()))?;
    ask.accepts(&EVENTS)?;
    check_origin(&ask.headers)?;
    let Wanted::Run(asked) = wanted else { return Ok(StatusCode::NO_CONTENT.into_response()) };
    let (counted, place) = admit(&app, Bounds::of_a_listener())?;
    let course = session::caught_up(&asked, &place).await?;
    let told = events::tell(*asked, course, place, async move { app.closing().await }, counted);
    // A proxy that gathers bytes before it passes them on would make the run late.
    Ok(([("x-accel-buffering", "no")], Sse::new(told)).into_response())
}

/// A place for one more live run, if there is one.
fn admit(app: &App, bounds: Bounds) -> Result<(Counted, Place), Problem> {
    if app.is_closing() {
        return Err(Problem::overloaded("the server is shutting down"));
    }
    let counted = Counted::one(&app.metrics.live_sessions);
    let most = limits::LIVE_SESSIONS;
    if app.metrics.live_sessions.get() > most as i64 {
        return Err(Problem::overloaded(format!("{most} live runs are open, which is the limit")));
    }
    Ok((counted, Place { pool: app.pool.clone(), bounces: app.metrics.bounces.clone(), bounds }))
}

fn not_a_websocket(rejection: &WebSocketUpgradeRejection, headers: &HeaderMap) -> Response {
    let wants =
        headers.get(header::UPGRADE).is_some_and(|upgrade| upgrade.as_bytes().eq_ignore_ascii_case(b"websocket"));
    if wants && !matches!(rejection, WebSocketUpgradeRejection::InvalidWebSocketVersionHeader(_)) {
        return Problem::not_readable(format!("the WebSocket handshake is not valid: {rejection}")).into_response();
    }
    let detail = format!("{PATH} is a WebSocket (version 13, subprotocol {SUBPROTOCOL}); open it as one");
    let mut response = Problem::other(StatusCode::UPGRADE_REQUIRED, detail).into_response();
    let headers = response.headers_mut();
    headers.insert(header::UPGRADE, HeaderValue::from_static("websocket"));
    headers.insert(header::CONNECTION, HeaderValue::from_static("upgrade"));
    headers.insert(header::SEC_WEBSOCKET_VERSION, HeaderValue::from_static("13"));
    response
}

/// A page of another host must not open a run in its visitor's name; a program has no origin.
fn check_origin(headers: &HeaderMap) -> Result<(), Problem> {
    let Some(origin) = headers.get(header::ORIGIN) else { return Ok(()) };
    let host = headers.get(header::HOST).and_then(|host| host.to_str().ok());
    if origin.to_str().ok().zip(host).is_some_and(|(origin, host)| is_same_host(origin, host)) {
        return Ok(());
    }
    let shown = shortened(&String::from_utf8_lossy(origin.as_bytes()));
    let detail = format!("the origin {shown} is not this server's host; open the page from it, or send no Origin");
    Err(Problem::other(StatusCode::FORBIDDEN, detail))
}

fn is_same_host(origin: &str, host: &str) -> bool {
    let Some((scheme, authority)) = origin.split_once("://") else { return false };
    let port = if scheme == "https" { ":443" } else { ":80" };
    let bare = |text: &str| text.strip_suffix(port).unwrap_or(text).to_ascii_lowercase();
    bare(authority) == bare(host)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_origin_is_of_the_same_host_and_port() {
        assert!(is_same_host("http://localhost:8080", "localhost:8080"));
        assert!(is_same_host("https://Example.org", "example.org:443"));
        assert!(is_same_host("http://[::1]", "[::1]"));
        for (origin, host) in [
            ("http://localhost:8081", "localhost:8080"),
            ("http://localhost.evil.org", "localhost"),
            ("null", "localhost"),
            ("https://example.org:80", "example.org"),
        ] {
            assert!(!is_same_host(origin, host), "{origin} {host}");
        }
    }
}
