//! Everything that surrounds the routes, in one place and in order.

use std::any::Any;
use std::time::Instant;

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::{MatchedPath, Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, Uri, header};
use axum::middleware::{Next, from_fn, from_fn_with_state, map_response};
use axum::response::{IntoResponse, Response};
use tower::ServiceBuilder;
use tower_http::catch_panic::CatchPanicLayer;

use crate::http::Problem;
use crate::http::problem::{MEDIA_TYPE, shortened};
use crate::routes::App;
use crate::{BUILD, limits};

/// Surrounds a router. The order, from the outside in:
///
/// 1. `sealed` puts the headers on that every answer has, those of the layers below included.
/// 2. `told` makes a problem of every error that libraries answer with on their own: 405, refused upgrades … These two
///    stand around the router as a whole, because it adds `Allow` outside of the layers of its routes.
/// 3. `measured` knows the route's template, so it stands within; outside of panics, which are counted as well.
/// 4. Panics become a 500.
/// 5. `bounded` refuses a URL before anybody reads it.
///
/// HEAD needs no layer: the router answers it like GET and leaves out the body. Bodies are bounded where they are read.
pub fn surround(router: Router<App>, app: App) -> Router {
    let within = ServiceBuilder::new()
        .layer(from_fn_with_state(app.clone(), measured))
        .layer(CatchPanicLayer::custom(panicked))
        .layer(from_fn(bounded));
    let around = ServiceBuilder::new().layer(map_response(sealed)).layer(from_fn(told));
    Router::new().fallback_service(router.layer(within).with_state(app)).layer(around)
}

/// Only what this server itself serves may be loaded, and only its own pages may frame it.
const CONTENT_SECURITY_POLICY: &str = "default-src 'self'; base-uri 'none'; frame-ancestors 'self'; object-src 'none'";

async fn sealed(mut response: Response) -> Response {
    seal(response.headers_mut());
    response
}

/// Adds the headers that every answer has.
pub fn seal(headers: &mut HeaderMap) {
    const BUILD_HEADER: HeaderName = HeaderName::from_static("equipoise-build");
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
    // The panic's own text is in the log already: the standard library writes it there.
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
