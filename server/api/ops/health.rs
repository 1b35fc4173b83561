//! Liveness and readiness probes, `/health/live` and `/health/ready`.

use axum::extract::State;
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Json, Router};
use serde_json::json;

use crate::BUILD;
use crate::api::app::App;
use crate::http::Problem;

/// The routes.
pub fn routes() -> Router<App> {
    Router::new().route("/health/live", get(live)).route("/health/ready", get(ready))
}

async fn live() -> Response {
    healthy()
}

async fn ready(State(app): State<App>) -> Result<Response, Problem> {
    if app.is_closing() { Err(Problem::overloaded("the server is shutting down")) } else { Ok(healthy()) }
}

fn healthy() -> Response {
    let body = Json(json!({"status": "ok", "build": BUILD, "version": env!("CARGO_PKG_VERSION")}));
    ([(header::CACHE_CONTROL, HeaderValue::from_static("no-store"))], body).into_response()
}
