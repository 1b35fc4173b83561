//! `stability`: the verdict on a scene.

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use super::App;
use crate::compute::{Cancel, Cancelled, Price};
use crate::http::{Ask, Format, Problem, Resource};
use crate::wire::scene;
use crate::wire::stability::{Request, Stability};

const RESOURCE: Resource =
    Resource { name: "stability", formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Svg, Format::Png] };

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/stability", get(stability).post(stability))
}

pub(super) async fn stability(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let (scene, request) = ask.read(|reader| {
        let scene = scene::read(reader);
        let request = Request::read(reader);
        Some((scene?, request))
    })?;
    let price = Price::bounces(Stability::price(&scene, &request)).within(&app.config.limits.of_work())?;
    let canonical = super::canonical(&scene, &request.canonical());
    let metrics = app.metrics.clone();
    ask.respond(&app.pool, &RESOURCE, &canonical, price, move |format: Format, cancel: &Cancel| {
        let stability = Stability::compute(&scene, &request, || !cancel.is_set()).ok_or(Cancelled)?;
        metrics.bounces.inc_by(stability.bounces());
        match format {
            Format::Csv => super::csv(&stability.to_table(), cancel),
            Format::Ndjson => super::ndjson(&stability.to_table(), &stability.end(), cancel),
            Format::Svg | Format::Png => super::picture(stability.to_picture(), format, cancel),
            _ => super::json(&stability, cancel),
        }
    })
    .await
}
