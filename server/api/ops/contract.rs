//! `/openapi.yaml`, the contract as it was written, and `/openapi.json`, the same for programs.

use std::sync::LazyLock;

use axum::Router;
use axum::http::HeaderMap;
use axum::routing::get;

use crate::api::app::App;
use crate::http::response::static_asset::StaticAsset;

static YAML: LazyLock<StaticAsset> =
    LazyLock::new(|| StaticAsset::new("application/yaml", include_bytes!("../../../openapi.yaml").as_slice()));

static JSON: LazyLock<StaticAsset> = LazyLock::new(|| {
    StaticAsset::new("application/json", include_bytes!(concat!(env!("OUT_DIR"), "/openapi.json")).as_slice())
});

/// Both paths.
pub fn routes() -> Router<App> {
    Router::new()
        .route("/openapi.yaml", get(async |headers: HeaderMap| YAML.answer(&headers)))
        .route("/openapi.json", get(async |headers: HeaderMap| JSON.answer(&headers)))
}
