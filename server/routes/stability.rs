//! `stability`: the verdict on a scene.

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use super::App;
use crate::compute::{Cancelled, Price, Turn};
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
    ask.respond(&app.pool, &RESOURCE, &canonical, price, move |format: Format, turn: &Turn| {
        let stability = Stability::compute(&scene, &request, || turn.go_on()).ok_or(Cancelled)?;
        metrics.bounces.inc_by(stability.bounces());
        match format {
            Format::Csv => super::csv(&stability.to_table(), turn),
            Format::Ndjson => super::ndjson(&stability.to_table(), &stability.end(), turn),
            Format::Svg | Format::Png => super::picture(stability.to_picture(), format, turn),
            _ => super::json(&stability, turn),
        }
    })
    .await
}
