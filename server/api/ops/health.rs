//! Liveness and readiness probes, `/health/live` and `/health/ready`.

use std::sync::LazyLock;

use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
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
    static BODY: LazyLock<Bytes> = LazyLock::new(|| {
        let body = json!({"status": "ok", "build": BUILD, "version": env!("CARGO_PKG_VERSION")});
        body.to_string().into()
    });
    let headers = [(header::CONTENT_TYPE, "application/json"), (header::CACHE_CONTROL, "no-store")];
    (headers, BODY.clone()).into_response()
}
