//! Probes of liveness and readiness, `/health/live` and `/health/ready`; `/metrics`, in the text format of Prometheus or as OpenMetrics.

use std::sync::LazyLock;

use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use schemars::JsonSchema;
use serde::Serialize;

use crate::BUILD;
use crate::api::app::App;
use crate::api::ops::metrics;
use crate::http::response::negotiate;
use crate::http::response::representation::with_room;
use crate::http::{ApiRequest, Format, Problem};
use crate::words;

/// Path of the liveness probe.
pub const LIVE: &str = "/health/live";

/// The routes.
pub fn routes() -> Router<App> {
    Router::new().route(LIVE, get(live)).route("/health/ready", get(ready)).route("/metrics", get(scrape))
}

async fn live() -> Response {
    healthy()
}

async fn ready(State(app): State<App>) -> Result<Response, Problem> {
    if app.is_closing() { Err(Problem::overloaded("the server is shutting down")) } else { Ok(healthy()) }
}

words! {
    /// The state of the server.
    HealthStatus = ["ok"];
}

/// Answer of a probe.
#[derive(Serialize, JsonSchema)]
pub struct Health {
    #[schemars(with = "HealthStatus")]
    status: &'static str,
    build: &'static str,
    version: &'static str,
}

/// The answer to a liveness probe.
pub fn healthy() -> Response {
    static BODY: LazyLock<Bytes> = LazyLock::new(|| {
        let health = Health { status: "ok", build: BUILD, version: env!("CARGO_PKG_VERSION") };
        // Texts are written without failure.
        serde_json::to_vec(&health).unwrap_or_default().into()
    });
    let mut response = with_room(BODY.clone().into());
    response.headers_mut().insert(header::CONTENT_TYPE, HeaderValue::from_static("application/json"));
    response.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    response
}

async fn scrape(State(app): State<App>, request: ApiRequest) -> Result<Response, Problem> {
    request.read(|_| Some(()))?;
    let format =
        negotiate::format(request.format.as_deref(), &request.headers, &[Format::Prometheus, Format::OpenMetrics])?;
    let mut text = app.metrics.to_open_metrics().map_err(|error| {
        tracing::error!("cannot write metrics: {error}");
        Problem::internal()
    })?;
    if format == Format::Prometheus {
        text = metrics::plain(&text);
    }
    let headers = [
        (header::CONTENT_TYPE, HeaderValue::from_static(format.media_type())),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
        (header::VARY, HeaderValue::from_static("Accept")),
    ];
    Ok((headers, text).into_response())
}
