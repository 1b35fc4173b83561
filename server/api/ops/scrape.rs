//! `/metrics`: all metrics as Prometheus text.

use axum::Router;
use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;

use crate::api::app::App;
use crate::api::ops::metrics;
use crate::http::Problem;
use crate::http::response::negotiate;

/// The route.
pub fn routes() -> Router<App> {
    Router::new().route("/metrics", get(scrape))
}

/// The media type that Prometheus asks for by name.
const OPEN_METRICS: &str = "application/openmetrics-text";

async fn scrape(State(app): State<App>, headers: HeaderMap) -> Result<Response, Problem> {
    let mut text = app.metrics.to_open_metrics().map_err(|error| {
        tracing::error!("cannot write metrics: {error}");
        Problem::internal()
    })?;
    let media_type = if negotiate::list(&headers, &header::ACCEPT).to_ascii_lowercase().contains(OPEN_METRICS) {
        "application/openmetrics-text; version=1.0.0; charset=utf-8"
    } else {
        text = metrics::plain(&text);
        "text/plain; version=0.0.4; charset=utf-8"
    };
    let headers = [
        (header::CONTENT_TYPE, HeaderValue::from_static(media_type)),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
        (header::VARY, HeaderValue::from_static("Accept")),
    ];
    Ok((headers, text).into_response())
}
