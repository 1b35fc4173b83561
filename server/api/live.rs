//! `/v1/live` and `/v1/live/events`: a run as it happens, over a WebSocket or as Server-Sent Events.

use std::future::ready;

use axum::Router;
use axum::extract::State;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response, Sse};
use axum::routing::get;
use futures_util::{Sink, SinkExt, Stream, StreamExt};
use serde_json::json;

use crate::api::app::App;
use crate::api::contract::{Contract, errors, reference};
use crate::api::schemas::component;
use crate::compute::{GaugeGuard, Peer, QuotaExceeded, Reservation};
use crate::http::request::fields::{FieldList, Fields};
use crate::http::security::origin;
use crate::http::{ApiRequest, Format, Problem, Resource};
use crate::limits;
use crate::live::outbox::Unreadable;
use crate::live::run_url::{LiveParameters, PATH};
use crate::live::server_message::{OutgoingFrame, ServerMessage};
use crate::live::session::{Inbox, SessionBounds, SessionContext, wall_now};
use crate::live::sse::EventsRequest;
use crate::live::{catch_up, client_message, outbox, run_url, session, sse};

const SUBPROTOCOL: &str = "equipoise.v1";

const EVENTS_PATH: &str = "/v1/live/events";

const EVENTS: Resource = Resource { name: "live/events", formats: &[Format::Events] };

/// The routes.
pub fn routes() -> Router<App> {
    Router::new().route(PATH, get(live)).route(EVENTS_PATH, get(live_events))
}

/// Adds both paths and their messages to the contract.
pub fn describe(contract: &mut Contract) {
    let mut fields = FieldList::default();
    LiveParameters::describe_fields(&mut fields);
    let mut parameters = contract.parameters("live", &fields);
    let server = contract.messages::<ServerMessage<'static>>("live");
    let client: Vec<_> = client_message::schemas()
        .map(|(name, schema)| {
            let name = component(&format!("live.{name}"));
            contract.schema(&name, schema);
            reference("schemas", &name)
        })
        .collect();
    let live = json!({
        "tags": ["Live"],
        "operationId": "live",
        "parameters": parameters,
        "x-messages": {"server": server, "client": client},
        "responses": errors(&["400", "403", "422", "503"]),
    });
    contract.path(PATH, json!({"get": live}));
    parameters.extend(["LiveAfter", "LiveLastEventId"].map(|name| reference("parameters", name)));
    let server: Vec<_> = server.into_iter().filter(|message| *message != reference("schemas", "LiveAck")).collect();
    let events = json!({
        "tags": ["Live"],
        "operationId": "liveEvents",
        "parameters": parameters,
        "x-messages": {"server": server},
        "responses": errors(&["400", "403", "405", "406", "422", "503"]),
    });
    contract.path(EVENTS_PATH, json!({"get": events}));
}

type Upgrade = Result<WebSocketUpgrade, WebSocketUpgradeRejection>;

/// The origin is checked first, then the address. An address that is not a valid run is told over the WebSocket: many clients hide
/// the body of a refused handshake. Such a connection takes no place of a run. A request that is no handshake gets the errors of its
/// address before those of the handshake.
async fn live(
    State(app): State<App>,
    upgrade: Upgrade,
    headers: HeaderMap,
    api_request: Result<ApiRequest, Problem>,
) -> Result<Response, Problem> {
    let read = api_request
        .and_then(|api_request| Ok((api_request.read(|reader| run_url::read(reader, wall_now()))?, api_request.peer)));
    let upgrade = match upgrade {
        Ok(upgrade) => upgrade,
        Err(rejection) => return read.map(|_| not_a_websocket(&rejection, &headers)),
    };
    origin::check(&headers, &app.config.allow_origin)?;
    let upgrade = upgrade
        .protocols([SUBPROTOCOL])
        .max_message_size(limits::LIVE_FRAME_BYTES)
        .max_frame_size(limits::LIVE_FRAME_BYTES)
        .read_buffer_size(limits::LIVE_READ_BYTES)
        .write_buffer_size(limits::LIVE_WRITE_BYTES)
        .max_write_buffer_size(limits::LIVE_WRITE_MOST_BYTES);
    let (request, peer) = match read {
        Ok(read) => read,
        Err(problem) => {
            return Ok(upgrade.on_upgrade(async move |socket| {
                let (outgoing, incoming) = halves(socket);
                outbox::refuse(&problem, incoming, outgoing).await;
            }));
        }
    };
    let (gauge, context) = admit(&app, peer, SessionBounds::for_websocket(&app.config.limits))?;
    Ok(upgrade.on_upgrade(async move |socket| {
        let _gauge = gauge;
        let (outgoing, incoming) = halves(socket);
        let mut incoming = Inbox::new(incoming);
        let Some(playback) = incoming.attend(catch_up::catch_up_with(&request, &context)).await else { return };
        session::serve(request, playback, incoming, outgoing, context, app.closing()).await;
    }))
}

/// The two directions of a WebSocket.
fn halves(
    socket: WebSocket,
) -> (
    impl Sink<OutgoingFrame> + Unpin + Send + 'static,
    impl Stream<Item = Result<Message, Unreadable>> + Unpin + Send + 'static,
) {
    let (outgoing, incoming) = socket.split();
    let incoming = incoming.map(|message| message.map_err(unreadable));
    let outgoing = outgoing.with(|frame| ready(Ok::<_, axum::Error>(Message::from(frame))));
    (outgoing, incoming)
}

/// The reason why the library cannot read a message.
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

/// Refuses a run that cannot be caught up with at once: a client of events sees the status and reconnects only after a 200.
async fn live_events(State(app): State<App>, api_request: ApiRequest) -> Result<Response, Problem> {
    let events_request = api_request.read(|reader| sse::read(reader, &api_request.headers, wall_now()))?;
    api_request.accepts(&EVENTS)?;
    origin::check(&api_request.headers, &app.config.allow_origin)?;
    let EventsRequest::Run(request) = events_request else { return Ok(StatusCode::NO_CONTENT.into_response()) };
    let (gauge, context) = admit(&app, api_request.peer, SessionBounds::for_sse(&app.config.limits))?;
    let playback = catch_up::catch_up_with(&request, &context).await?;
    let told = sse::events(*request, playback, context, async move { app.closing().await }, gauge);
    // A proxy that buffers would delay the run.
    Ok(([("x-accel-buffering", "no")], Sse::new(told)).into_response())
}

/// Takes a place for one more live run. A server that closes still gives places: the client hears of the end at once and reconnects,
/// while a browser takes any status of an event stream other than 200 for the end of the run.
fn admit(app: &App, peer: Peer, bounds: SessionBounds) -> Result<((GaugeGuard, Reservation), SessionContext), Problem> {
    let reservation = app.live_quota.try_reserve(peer).map_err(|QuotaExceeded { held, free }| {
        Problem::overloaded(format!(
            "{held} live runs are open from this address, and {free} places are left for others"
        ))
    })?;
    let gauge = GaugeGuard::new(&app.metrics.live_sessions);
    let (pool, base_path) = (app.pool.for_peer(peer), app.base_path.clone());
    let (bounces, lags) = (app.metrics.bounces.clone(), app.metrics.live_lags.clone());
    Ok(((gauge, reservation), SessionContext { wall: wall_now, pool, bounces, lags, base_path, bounds }))
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
