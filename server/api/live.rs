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

use crate::api::app::App;
use crate::compute::{Counted, NoShare, Share};
use crate::http::security::origin;
use crate::http::{Ask, Format, Problem, Resource};
use crate::limits;
use crate::live::bounds::Bounds;
use crate::live::close::Unreadable;
use crate::live::session;
use crate::live::session::Place;
use crate::live::sse;
use crate::live::sse::Wanted;
use crate::runs::run_url;
use crate::runs::run_url::PATH;

const SUBPROTOCOL: &str = "equipoise.v1";

const EVENTS: Resource = Resource { name: "live/events", formats: &[Format::Events] };

/// Their paths.
pub fn routes() -> Router<App> {
    Router::new().route(PATH, get(live)).route("/v1/live/events", get(live_events))
}

type Upgrade = Result<WebSocketUpgrade, WebSocketUpgradeRejection>;

/// What is wrong with the run is told first, so that a page whose WebSocket was refused can ask why.
async fn live(State(app): State<App>, upgrade: Upgrade, ask: Ask) -> Result<Response, Problem> {
    let asked = ask.read(|reader| run_url::read(reader, session::wall_now()))?;
    let upgrade = match upgrade {
        Ok(upgrade) => upgrade,
        Err(rejection) => return Ok(not_a_websocket(&rejection, &ask.headers)),
    };
    origin::check(&ask.headers, &app.config.allow_origin)?;
    let (counted, place) = admit(&app, &ask, Bounds::of_a_talker(&app.config.limits))?;
    let upgrade = upgrade
        .protocols([SUBPROTOCOL])
        .max_message_size(limits::LIVE_FRAME_BYTES)
        .max_frame_size(limits::LIVE_FRAME_BYTES)
        .read_buffer_size(limits::LIVE_READ_BYTES)
        .write_buffer_size(limits::LIVE_WRITE_BYTES)
        .max_write_buffer_size(limits::LIVE_WRITE_MOST_BYTES);
    Ok(upgrade.on_upgrade(async move |socket| {
        let _counted = counted;
        let (outgoing, incoming) = socket.split();
        let incoming = incoming.map(|message| message.map_err(unreadable));
        let outgoing = outgoing.with(|frame| ready(Ok::<_, axum::Error>(Message::from(frame))));
        let course = session::caught_up(&asked, &place).await;
        session::serve(asked, course, incoming, outgoing, place, app.closing()).await;
    }))
}

/// What the library says of a message that it cannot read.
fn unreadable(error: axum::Error) -> Unreadable {
    use tungstenite::Error::{Capacity, Protocol, Utf8};
    use tungstenite::error::ProtocolError::ResetWithoutClosingHandshake;
    match error.into_inner().downcast_ref() {
        Some(Capacity(_)) => Unreadable::TooLarge,
        Some(Utf8(_)) => Unreadable::NotUtf8,
        Some(Protocol(ResetWithoutClosingHandshake)) => Unreadable::Gone,
        Some(Protocol(_)) => Unreadable::Broken,
        _ => Unreadable::Gone,
    }
}

/// Here a run that cannot be caught up with is refused at once: a client of events sees the status, and comes back only
/// where it is 200.
async fn live_events(State(app): State<App>, ask: Ask) -> Result<Response, Problem> {
    let wanted = ask.read(|reader| sse::read(reader, &ask.headers, session::wall_now()))?;
    ask.accepts(&EVENTS)?;
    origin::check(&ask.headers, &app.config.allow_origin)?;
    let Wanted::Run(asked) = wanted else { return Ok(StatusCode::NO_CONTENT.into_response()) };
    let (counted, place) = admit(&app, &ask, Bounds::of_a_listener(&app.config.limits))?;
    let course = session::caught_up(&asked, &place).await?;
    let told = sse::tell(*asked, course, place, async move { app.closing().await }, counted);
    // A proxy that gathers bytes before it passes them on would make the run late.
    Ok(([("x-accel-buffering", "no")], Sse::new(told)).into_response())
}

/// A place for one more live run, if there is one. Also while the server closes: a run that is told so at once is come back to,
/// and a browser takes an answer of events other than 200 for the end.
fn admit(app: &App, ask: &Ask, bounds: Bounds) -> Result<((Counted, Share), Place), Problem> {
    let share = app.live_places.take(ask.peer).map_err(|NoShare { held, free }| {
        Problem::overloaded(format!(
            "{held} live runs are open from this address, and {free} places are left for others"
        ))
    })?;
    let counted = Counted::one(&app.metrics.live_sessions);
    let (pool, base_path) = (app.pool.of(ask.peer), app.base_path.clone());
    let (bounces, lags) = (app.metrics.bounces.clone(), app.metrics.live_lags.clone());
    Ok(((counted, share), Place { pool, bounces, lags, base_path, bounds }))
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
