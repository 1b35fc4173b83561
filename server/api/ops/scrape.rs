//! `/metrics`: all metrics, in the text format of Prometheus or as OpenMetrics.

use axum::Router;
use axum::extract::State;
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;

use crate::api::app::App;
use crate::api::ops::metrics;
use crate::http::response::negotiate;
use crate::http::{ApiRequest, Format, Problem};

/// The route.
pub fn routes() -> Router<App> {
    Router::new().route("/metrics", get(scrape))
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
