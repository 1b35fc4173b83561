//! `precision`: speed against accuracy. The one resource that measures a clock, so nothing of it is kept.

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use super::App;
use crate::compute::Cancel;
use crate::http::{Ask, Format, Problem, Resource};
use crate::limits;
use crate::wire::precision::{Precision, Request};
use crate::wire::scene;

const RESOURCE: Resource =
    Resource { name: "precision", formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Svg, Format::Png] };

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/precision", get(precision).post(precision))
}

async fn precision(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let (scene, request) = ask.read(|reader| {
        let scene = scene::read_frictionless(reader);
        let request = Request::read(reader);
        Some((scene?, request?))
    })?;
    let price = request.price().within(&limits::WORK)?;
    let metrics = app.metrics.clone();
    ask.respond_afresh(&app.pool, &RESOURCE, price, move |format: Format, cancel: &Cancel| {
        let precision = Precision::compute(&scene, &request, cancel)?;
        metrics.bounces.inc_by(precision.bounces());
        match format {
            Format::Csv => Ok(precision.to_table().to_csv()),
            Format::Ndjson => Ok(precision.to_table().to_ndjson(&precision.end())),
            Format::Svg | Format::Png => super::picture(precision.to_picture(), format, cancel),
            _ => super::json(&precision),
        }
    })
    .await
}
