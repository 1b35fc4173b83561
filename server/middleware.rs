//! Everything that surrounds the routes, in one place and in order.

use std::any::Any;
use std::io::{Write, stderr};
use std::net::IpAddr;
use std::sync::Arc;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::{MatchedPath, Request, State};
use axum::http::uri::PathAndQuery;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri, header};
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::{IntoResponse, Redirect, Response};
use serde::Serialize;
use tower::ServiceBuilder;
use tower::util::option_layer;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::cors::CorsLayer;

use crate::compute::Peer;
use crate::config::Config;
use crate::http::problem::{MEDIA_TYPE, shortened};
use crate::http::{Asked, Origin, Problem, REQUEST_ID, peer};
use crate::routes::App;
use crate::{BUILD, limits};

/// Surrounds a router. The order, from the outside in:
///
/// 1. `received` puts the headers on that every answer has, knows who asks and under which id, and writes the log: all that
///    happens to a request happens within it.
/// 2. CORS, if there are origins to allow: before the token, which a browser does not send when it asks whether it may.
/// 3. `told` makes a problem of every error that libraries answer with on their own: 405, refused upgrades … Up to here they
///    stand around the router as a whole, because it adds `Allow` outside of the layers of its routes.
/// 4. `guarded` lets nobody past without the token, if there is one.
/// 5. `measured` knows the route's template, so it stands within; outside of panics, which are counted as well.
/// 6. Panics become a 500.
/// 7. `bounded` refuses a URL before anybody reads it.
///
/// HEAD needs no layer: the router answers it like GET and leaves out the body. Bodies are bounded where they are read.
pub fn surround(router: Router<App>, app: App) -> Router {
    let door = Arc::new(Door { base: app.base_path.clone(), config: app.config.clone() });
    let origins = &app.config.allow_origin;
    let cors = (!origins.is_empty()).then(|| cors(origins));
    let within = ServiceBuilder::new()
        .layer(from_fn_with_state(app.clone(), measured))
        .layer(CatchPanicLayer::custom(panicked))
        .layer(from_fn(bounded));
    let around = ServiceBuilder::new()
        .layer(from_fn_with_state(door.clone(), received))
        .layer(option_layer(cors))
        .layer(from_fn(told))
        .layer(from_fn_with_state(door, guarded));
    Router::new().fallback_service(router.layer(within).with_state(app)).layer(around)
}

/// What is asked of a request before anything else.
#[derive(Debug)]
struct Door {
    base: Arc<str>,
    config: Arc<Config>,
}

impl Door {
    /// Who asks: the peer of the connection or, if that is a proxy to be believed, whom it names.
    fn peer(&self, request: &Request) -> Peer {
        let peer = peer(request.extensions());
        if !self.config.trust_proxy.iter().any(|proxies| proxies.has(peer)) {
            return peer;
        }
        // The last one is what the proxy itself has seen; those before it anybody can send.
        let named = request.headers().get_all("x-forwarded-for").into_iter().next_back();
        let last = named.and_then(|named| named.to_str().ok()?.rsplit(',').next()?.trim().parse().ok());
        last.map_or(peer, Peer::at)
    }
}

/// Only what this server itself serves may be loaded, and only its own pages may frame it.
const CONTENT_SECURITY_POLICY: &str = "default-src 'self'; base-uri 'none'; frame-ancestors 'self'; object-src 'none'";

fn cors(origins: &[Origin]) -> CorsLayer {
    CorsLayer::new()
        .allow_origin(origins.iter().map(Origin::header).collect::<Vec<_>>())
        .allow_methods([Method::GET, Method::HEAD, Method::POST])
        .allow_headers([
            header::AUTHORIZATION,
            header::CONTENT_TYPE,
            header::IF_NONE_MATCH,
            HeaderName::from_static("last-event-id"),
            REQUEST_ID,
        ])
        .expose_headers([BUILD_HEADER, REQUEST_ID, header::ETAG, header::RETRY_AFTER])
        .max_age(limits::PREFLIGHT_TIME)
}

async fn received(State(door): State<Arc<Door>>, mut request: Request, next: Next) -> Response {
    let begin = Instant::now();
    let peer = door.peer(&request);
    request.extensions_mut().insert(peer);
    let logged = door.config.access_log.then(|| (request.method().clone(), request.uri().clone()));
    let asked = Asked::new(request.headers(), door.base.clone());
    let mut response = match strip(request.uri_mut(), &door.base) {
        Ok(()) => asked.clone().answer(next.run(request)).await,
        Err(elsewhere) => elsewhere.into_response(),
    };
    seal(response.headers_mut());
    response.headers_mut().insert(REQUEST_ID, asked.header());
    if let Some((method, uri)) = logged {
        let line = Line {
            time: SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64(),
            id: &asked.id,
            peer: peer.address(),
            method: method.as_str(),
            target: &shown(&uri),
            status: response.status().as_u16(),
            ms: begin.elapsed().as_secs_f64() * 1e3,
        };
        // A log that nobody takes is no reason to answer nobody.
        let _ = writeln!(stderr().lock(), "{}", serde_json::to_string(&line).unwrap_or_default());
    }
    response
}

/// A line of the access log. Written as JSON, so that nothing a client sends can look like another line.
#[derive(Serialize)]
struct Line<'a> {
    /// Unix time, s.
    time: f64,
    id: &'a str,
    peer: IpAddr,
    method: &'a str,
    target: &'a str,
    status: u16,
    /// From the request's head to the answer's.
    ms: f64,
}

/// A target without the secret that may be in it.
fn shown(uri: &Uri) -> String {
    let target = uri.path_and_query().map_or("*", PathAndQuery::as_str);
    let end = target.find(TOKEN_PARAMETER).map_or(target.len(), |start| start + TOKEN_PARAMETER.len());
    target[..end].chars().take(limits::URL_BYTES).collect()
}

/// Takes the base path away, where a proxy has left it on. The page there has relative addresses, which need its slash.
fn strip(uri: &mut Uri, base: &str) -> Result<(), Redirect> {
    let path_and_query = uri.path_and_query().map_or("", PathAndQuery::as_str);
    let Some(rest) = path_and_query.strip_prefix(base).filter(|_| !base.is_empty()) else { return Ok(()) };
    if rest.is_empty() || rest.starts_with('?') {
        return Err(Redirect::permanent(&format!("{base}/{rest}")));
    }
    let mut parts = uri.clone().into_parts();
    if rest.starts_with('/') {
        parts.path_and_query = rest.parse().ok();
        *uri = Uri::from_parts(parts).unwrap_or_default();
    }
    Ok(())
}

const BUILD_HEADER: HeaderName = HeaderName::from_static("equipoise-build");

/// Adds the headers that every answer has.
pub fn seal(headers: &mut HeaderMap) {
    for (name, value) in [
        (BUILD_HEADER, BUILD),
        (header::CONTENT_SECURITY_POLICY, CONTENT_SECURITY_POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
    ] {
        // A page may have a policy of its own.
        headers.entry(name).or_insert(HeaderValue::from_static(value));
    }
}

/// What a browser is given the token by, once.
const TOKEN_PARAMETER: &str = "token=";

async fn guarded(State(door): State<Arc<Door>>, request: Request, next: Next) -> Response {
    let Some(token) = &door.config.token else { return next.run(request).await };
    let (path, query) = (request.uri().path(), request.uri().query().unwrap_or_default());
    if path.starts_with("/health/") || token.is_in(request.headers()) {
        return next.run(request).await;
    }
    let (given, others): (Vec<_>, Vec<_>) = query.split('&').partition(|part| part.starts_with(TOKEN_PARAMETER));
    if path == "/" && given.first().is_some_and(|given| token.is(&given[TOKEN_PARAMETER.len()..])) {
        let page = if others.is_empty() { "./".to_owned() } else { format!("./?{}", others.join("&")) };
        let mut response = Redirect::to(&page).into_response();
        response.headers_mut().insert(header::SET_COOKIE, token.cookie());
        response.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
        return response;
    }
    Problem::unauthorized().into_response()
}

async fn measured(State(app): State<App>, route: Option<MatchedPath>, request: Request, next: Next) -> Response {
    let (begin, method) = (Instant::now(), request.method().clone());
    let response = next.run(request).await;
    let route = route.as_ref().map_or("none", MatchedPath::as_str);
    app.metrics.answered(method.as_str(), route, response.status().as_u16(), begin.elapsed());
    response
}

async fn told(request: Request, next: Next) -> Response {
    let (method, uri) = (request.method().clone(), request.uri().clone());
    let response = next.run(request).await;
    let status = response.status();
    let is_error = status.is_client_error() || status.is_server_error();
    if !is_error || response.headers().get(header::CONTENT_TYPE) == Some(&MEDIA_TYPE) {
        return response;
    }
    let (parts, body) = response.into_parts();
    let problem = match (status, parts.headers.get(header::ALLOW).and_then(|allow| allow.to_str().ok())) {
        (StatusCode::METHOD_NOT_ALLOWED, Some(allow)) => {
            Problem::method_not_allowed(method.as_str(), &shortened(uri.path()), allow)
        }
        _ => Problem::other(status, said(body).await.unwrap_or_else(|| status.to_string())),
    };
    let mut response = problem.into_response();
    for (name, value) in &parts.headers {
        // What describes the old body is gone with it.
        if *name != header::CONTENT_TYPE && *name != header::CONTENT_LENGTH && *name != header::ALLOW {
            response.headers_mut().entry(name).or_insert_with(|| value.clone());
        }
    }
    response
}

/// The text of a library's error, if it is one that can be shown.
async fn said(body: Body) -> Option<String> {
    let bytes = to_bytes(body, 1024).await.ok()?;
    String::from_utf8(bytes.to_vec()).ok().filter(|text| !text.is_empty())
}

fn panicked(_: Box<dyn Any + Send + 'static>) -> Response {
    // The standard library has written the panic's own text to the log; which request it was stands beside it.
    if let Some(asked) = Asked::under_way() {
        let _ = writeln!(stderr().lock(), "equipoise: request {} failed with the panic above", asked.id);
    }
    Problem::internal().into_response()
}

async fn bounded(request: Request, next: Next) -> Response {
    let bytes = request.uri().path_and_query().map_or(0, |path| path.as_str().len());
    if bytes > limits::URL_BYTES {
        return Problem::url_too_long(bytes).into_response();
    }
    next.run(request).await
}

/// The answer where there is no route.
pub async fn not_found(uri: Uri) -> Problem {
    Problem::not_found(format!("there is nothing at {}; /docs says what there is", shortened(uri.path())))
}
