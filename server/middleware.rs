//! All middleware, in one place and in order.

use std::any::Any;
use std::convert::Infallible;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Instant;

use axum::Router;
use axum::body::{Body, HttpBody, to_bytes};
use axum::extract::{ConnectInfo, MatchedPath, Request};
use axum::http::uri::PathAndQuery;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri, Version, header};
use axum::response::{IntoResponse, Redirect, Response};
use axum::routing::Route;
use futures_util::FutureExt;
use tower::{Layer, Service, ServiceBuilder, service_fn};
use tower_http::catch_panic::{CatchPanic, CatchPanicLayer};
use tower_http::cors::{AllowOrigin, CorsLayer};
use tracing::{Instrument, Span};

use crate::BUILD;
use crate::api::App;
use crate::api::ops::{health, metrics};
use crate::compute::Peer;
use crate::config::Config;
use crate::http::problem::{MEDIA_TYPE, shortened};
use crate::http::response::answers;
use crate::http::response::answers::{Client, KeptAnswer};
use crate::http::response::representation::ByteRange;
use crate::http::security::token::TOKEN_PARAMETER;
use crate::http::security::{host, origin, token};
use crate::http::{HostName, Origin, Problem, REQUEST_ID, RequestContext, peer, transfer};
use crate::limits;
use crate::logging::{AccessLogEntry, request_span};

/// Surrounds a router with middleware, from the outside in:
///
/// 1. `identify` gives each request its id, peer and origin, and each answer its common headers, and writes the access log. It refuses
///    requests for other servers or in an unsupported form. This comes before CORS, which would permit pages of a foreign name.
/// 2. CORS, if origins are allowed. It comes before the token, which a browser does not send in a preflight.
/// 3. `guard` refuses requests without the token, if there is one, and work for pages of other sites. It answers liveness probes, and
///    requests that repeat an earlier one, from memory. Others go on in a span of the log. It turns errors of libraries into problems:
///    405, refused upgrades and others. The layers up to here surround the router as a whole, because it adds `Allow` outside the
///    layers of its routes.
/// 4. `measure` counts requests. It needs the route's template, so it is inside the router, and it is outside panics, to count them
///    too. It refuses a long URL before it is read.
/// 5. A panic becomes a 500.
///
/// A layer of axum costs about a microsecond for each request, most of it for copies of the layers within. So these are functions that
/// call the next one, and checks share one where their order permits it.
///
/// HEAD needs no layer: the router answers it like GET without the body. Bodies are bounded where they are read.
pub fn apply_layers(router: Router<App>, app: App) -> Router {
    let hosts = app.config.hosts().map(Into::into);
    let edge = Arc::new(EdgeConfig { base: app.base_path.clone(), hosts, app: app.clone() });
    let measured = app.clone();
    let within = ServiceBuilder::new()
        .layer_fn(move |mut route: CatchPanic<Route, PanicToProblem>| {
            let app = measured.clone();
            // The route begins when its answer is awaited.
            service_fn(move |request| measure(app.clone(), Measured::of(&request), route.call(request)))
        })
        .layer(CatchPanicLayer::custom(panic_to_problem as PanicToProblem));
    let routes = router.layer(within).with_state(app.clone());
    let guarding = edge.clone();
    let guarded = service_fn(move |request| guard(guarding.clone(), request, routes.clone()).map(Ok));
    let origins = &app.config.allow_origin;
    if origins.is_empty() {
        Router::new().fallback_service(service_fn(move |request| identify(edge.clone(), request, guarded.clone())))
    } else {
        let guarded = cors(origins).layer(guarded);
        Router::new().fallback_service(service_fn(move |request| identify(edge.clone(), request, guarded.clone())))
    }
}

type PanicToProblem = fn(Box<dyn Any + Send + 'static>) -> Response;

/// Settings of the outer layers.
#[derive(Debug)]
struct EdgeConfig {
    base: Arc<str>,
    app: App,
    /// Host names that are answered; None if every name is.
    hosts: Option<Vec<HostName>>,
}

impl EdgeConfig {
    /// Tells whether the connection comes from a trusted proxy.
    fn is_from_proxy(&self, request: &Request) -> bool {
        // Compares the whole address: an IPv6 peer is a network.
        let from = request.extensions().get::<ConnectInfo<SocketAddr>>().map(|ConnectInfo(from)| from.ip());
        from.is_some_and(|from| self.app.config.trust_proxy.iter().any(|proxies| proxies.has(from)))
    }

    /// The client: the peer of the connection or, behind a trusted proxy, the one that the proxy names.
    fn peer(&self, request: &Request) -> Peer {
        let peer = peer(request.extensions());
        if !self.is_from_proxy(request) {
            return peer;
        }
        // The last entry is the one that the proxy has seen. Anyone can send the entries before it.
        let named = request.headers().get_all("x-forwarded-for").into_iter().next_back();
        let last = named.and_then(|named| named.to_str().ok()?.rsplit(',').next()?.trim().parse().ok());
        last.map_or(peer, Peer::at)
    }
}

/// Only this server's own files may be loaded, and only its own pages may frame it.
const CONTENT_SECURITY_POLICY: &str = "default-src 'self'; base-uri 'none'; frame-ancestors 'self'; object-src 'none'";

fn cors(origins: &[Origin]) -> CorsLayer {
    let origins = origins.to_vec();
    CorsLayer::new()
        .allow_origin(AllowOrigin::predicate(move |origin, _| origins.iter().any(|allowed| allowed.is(origin))))
        .allow_methods([Method::GET, Method::HEAD, Method::POST])
        .allow_headers([
            header::AUTHORIZATION,
            header::CONTENT_TYPE,
            header::IF_NONE_MATCH,
            header::IF_RANGE,
            header::RANGE,
            HeaderName::from_static("last-event-id"),
            REQUEST_ID,
        ])
        .expose_headers([
            BUILD_HEADER,
            REQUEST_ID,
            header::ACCEPT_RANGES,
            header::CONTENT_RANGE,
            header::ETAG,
            header::RETRY_AFTER,
        ])
        .max_age(limits::PREFLIGHT_TIME)
}

async fn identify(
    edge: Arc<EdgeConfig>,
    mut request: Request,
    mut next: impl Service<Request, Response = Response, Error = Infallible>,
) -> Result<Response, Infallible> {
    let peer = edge.peer(&request);
    edge.app.pool.note_request(peer);
    if edge.is_from_proxy(&request) {
        request.extensions_mut().insert(peer);
        request.extensions_mut().insert(host::FromProxy);
    }
    let logged = edge.app.config.access_log.then(|| (Instant::now(), request.method().clone(), request.uri().clone()));
    let context = RequestContext::new(request.headers(), edge.base.clone());
    let id = context.header();
    let mut response = match strip_base(request.uri_mut(), &edge.base) {
        Ok(()) => {
            let answer = async {
                match check_address(&edge, &request) {
                    Ok(()) => next.call(request).await,
                    Err(problem) => Ok(problem.into_response()),
                }
            };
            context.scope(answer).await?
        }
        Err(elsewhere) => elsewhere.into_response(),
    };
    add_common_headers(response.headers_mut());
    response.headers_mut().insert(REQUEST_ID, id);
    if let Some((begin, method, uri)) = logged {
        let entry = AccessLogEntry {
            id: response.headers()[REQUEST_ID].to_str().unwrap_or_default(),
            peer: peer.address(),
            method: method.as_str(),
            target: &redacted(&uri),
            status: response.status().as_u16(),
            ms: begin.elapsed().as_secs_f64() * 1e3,
        };
        entry.write();
    }
    Ok(response)
}

/// The target up to a token in it, however the parameter's name is encoded.
fn redacted(uri: &Uri) -> String {
    let target = uri.path_and_query().map_or("*", PathAndQuery::as_str);
    let end = end_of_name(target.as_bytes()).unwrap_or(target.len());
    target[..end].chars().take(limits::URL_BYTES).collect()
}

/// End of the first `token=` in a target. Each character may be percent-encoded, in either case.
fn end_of_name(target: &[u8]) -> Option<usize> {
    let escaped = |labels: usize| {
        let digits = target.get(labels..)?.strip_prefix(b"%")?.get(..2)?;
        let digits = Some(digits).filter(|digits| digits.iter().all(u8::is_ascii_hexdigit))?;
        u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()
    };
    // Each character with its end.
    let mut characters = Vec::with_capacity(target.len());
    let mut labels = 0;
    while labels < target.len() {
        let (byte, length) = escaped(labels).map_or((target[labels], 1), |byte| (byte, 3));
        labels += length;
        characters.push((byte, labels));
    }
    let name = [TOKEN_PARAMETER.as_bytes(), b"="].concat();
    let found = characters.windows(name.len()).find(|window| {
        let letters = window.iter().map(|(byte, _)| byte);
        letters.zip(&name).all(|(byte, letter)| byte.eq_ignore_ascii_case(letter))
    });
    found.and_then(|window| Some(window.last()?.1))
}

/// Removes the base path, if a proxy has left it on. The page has relative addresses, which need the slash after it.
fn strip_base(uri: &mut Uri, base: &str) -> Result<(), Redirect> {
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

/// Headers that every answer has.
const COMMON_HEADERS: [(HeaderName, HeaderValue); 4] = [
    (BUILD_HEADER, HeaderValue::from_static(BUILD)),
    (header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(CONTENT_SECURITY_POLICY)),
    (header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")),
    (header::REFERRER_POLICY, HeaderValue::from_static("no-referrer")),
];

/// Adds the headers that every answer has.
pub fn add_common_headers(headers: &mut HeaderMap) {
    for (name, value) in COMMON_HEADERS {
        // A page may have a policy of its own.
        headers.entry(name).or_insert(value);
    }
}

/// Refuses a request for another server, or in an unsupported form.
fn check_address(edge: &EdgeConfig, request: &Request) -> Result<(), Problem> {
    let headers = request.headers();
    // A test without a socket has no HTTP version.
    let version = request.extensions().get::<ConnectInfo<SocketAddr>>().map(|_| request.version());
    host::check_form(version.unwrap_or(Version::HTTP_10), headers)?;
    edge.hosts.as_ref().map_or(Ok(()), |allowed| host::check_name(request.uri(), headers, allowed))?;
    transfer::check(headers)
}

async fn guard(edge: Arc<EdgeConfig>, mut request: Request, mut routes: Router) -> Response {
    let config = &edge.app.config;
    if let Some(token) = &config.token {
        request = match token::require(token, &config.limits, request).await {
            Ok(request) => request,
            Err(answer) => return answer,
        };
    }
    let (method, uri) = (request.method().clone(), request.uri().clone());
    let response = match refusal(config, &request) {
        Some(answer) => answer,
        None => {
            let app = &edge.app;
            if let Some(alive) = liveness(app, &request) {
                return alive;
            }
            let name = answers::name_of(&request);
            if let Some(again) = name.as_ref().and_then(|name| repeated(app, &request, name)) {
                return again;
            }
            let id = RequestContext::current().map_or_else(Span::none, |context| request_span(context.id()));
            let Ok(mut response) = async { routes.call(request).await }.instrument(id).await;
            if let (Some(name), Some(kept)) = (name, response.extensions_mut().remove::<KeptAnswer>()) {
                app.answers.expect_again(name, kept);
            }
            response
        }
    };
    let status = response.status();
    let is_error = status.is_client_error() || status.is_server_error();
    let is_problem = !is_error || response.headers().get(header::CONTENT_TYPE) == Some(&MEDIA_TYPE);
    if is_problem { response } else { to_problem(response, &method, &uri).await }
}

/// The answer from memory to a request that repeats an earlier one. It is counted as if it had been read again.
fn repeated(app: &App, request: &Request, name: &[u8]) -> Option<Response> {
    let begin = Instant::now();
    let kept = app.answers.repeated(name)?;
    let headers = request.headers();
    let held = kept.tag.if_none_match(headers);
    let client = Client { peer: peer(request.extensions()), held, range: ByteRange::asked(headers, &kept.tag) };
    let response = kept.respond(&app.answers, client)?;
    Some(counted(app, request.method(), kept.route.clone().into(), begin, response))
}

/// The answer to a liveness probe by GET, which tells only that requests are answered.
fn liveness(app: &App, request: &Request) -> Option<Response> {
    let begin = Instant::now();
    let is_probe = *request.method() == Method::GET && request.uri().path_and_query()? == health::LIVE;
    is_probe.then(|| counted(app, request.method(), metrics::Route::Fixed(health::LIVE), begin, health::healthy()))
}

/// Does what the router does with an answer, for one that did not come from it.
fn counted(app: &App, method: &Method, route: metrics::Route, begin: Instant, mut response: Response) -> Response {
    if let Some(bytes) = response.body().size_hint().exact() {
        response.headers_mut().insert(header::CONTENT_LENGTH, bytes.into());
    }
    app.metrics.record(method.as_str(), route, response.status().as_u16(), begin.elapsed());
    response
}

/// Refuses work for a page of another site.
fn refusal(config: &Config, request: &Request) -> Option<Response> {
    let (origins, embedding) = (&config.allow_origin, config.allow_embedding);
    let checked = origin::check_site(request.method(), request.uri().path(), request.headers(), origins, embedding);
    checked.err().map(IntoResponse::into_response)
}

/// Part of a request that is counted, or refused for its length.
struct Measured {
    begin: Instant,
    method: Method,
    route: Option<MatchedPath>,
    /// Length of the target.
    bytes: usize,
}

impl Measured {
    fn of(request: &Request) -> Self {
        Self {
            begin: Instant::now(),
            method: request.method().clone(),
            route: request.extensions().get().cloned(),
            bytes: request.uri().path_and_query().map_or(0, |path| path.as_str().len()),
        }
    }
}

async fn measure<A: IntoResponse>(
    app: App,
    Measured { begin, method, route, bytes }: Measured,
    answer: impl Future<Output = Result<A, Infallible>>,
) -> Result<Response, Infallible> {
    let mut response = if bytes > limits::URL_BYTES {
        Problem::url_too_long(bytes).into_response()
    } else {
        answer.await?.into_response()
    };
    if let Some(kept) = response.extensions_mut().get_mut::<KeptAnswer>() {
        kept.route.clone_from(&route);
    }
    app.metrics.record(method.as_str(), route.into(), response.status().as_u16(), begin.elapsed());
    Ok(response)
}

/// Turns an error of a library into a problem.
async fn to_problem(response: Response, method: &Method, uri: &Uri) -> Response {
    let status = response.status();
    let (parts, body) = response.into_parts();
    let problem = match (status, parts.headers.get(header::ALLOW).and_then(|allow| allow.to_str().ok())) {
        (StatusCode::METHOD_NOT_ALLOWED, Some(allow)) => {
            Problem::method_not_allowed(method.as_str(), &shortened(uri.path()), allow)
        }
        _ => Problem::other(status, body_text(body).await.unwrap_or_else(|| status.to_string())),
    };
    let mut response = problem.into_response();
    for (name, value) in &parts.headers {
        // Headers of the old body are left out.
        if *name != header::CONTENT_TYPE && *name != header::CONTENT_LENGTH && *name != header::ALLOW {
            response.headers_mut().entry(name).or_insert_with(|| value.clone());
        }
    }
    response
}

/// The text of a library's error, if it is short UTF-8 text.
async fn body_text(body: Body) -> Option<String> {
    let bytes = to_bytes(body, 1024).await.ok()?;
    String::from_utf8(bytes.to_vec()).ok().filter(|text| !text.is_empty())
}

fn panic_to_problem(_: Box<dyn Any + Send + 'static>) -> Response {
    // The panic itself is already in the log.
    tracing::error!("the request failed with a panic");
    Problem::internal().into_response()
}

/// The answer to an unknown path.
pub async fn not_found(uri: Uri) -> Problem {
    Problem::not_found(format!("there is nothing at {}; /docs says what there is", shortened(uri.path())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_is_shown_up_to_the_secret_however_its_name_is_written() {
        for (target, body_text) in [
            ("/?preset=case-1&token=SECRET", "/?preset=case-1&token="),
            ("/?%74oken=SECRET&a=b", "/?%74oken="),
            ("/?t%6fk%65n%3DSECRET", "/?t%6fk%65n%3D"),
            ("/?TO%4BEN=SECRET", "/?TO%4BEN="),
            ("/token=SECRET", "/token="),
            ("/v1/scenes?a=%22%0a%", "/v1/scenes?a=%22%0a%"),
            ("/?a=%+7&%zz%7", "/?a=%+7&%zz%7"),
            ("/?%2574oken=1", "/?%2574oken=1"),
        ] {
            assert_eq!(redacted(&target.parse().unwrap()), body_text);
        }
    }
}
