//! `stability`: the verdict on a scene.

pub mod answer;
pub mod evidence;
pub mod margins;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use crate::api::app::App;
use crate::api::scene::read_scene;
use crate::api::shared::write;
use crate::api::stability::answer::{Request, Stability};
use crate::compute::{Cancelled, Price, Turn};
use crate::http::{Ask, Format, Problem, Resource};

const RESOURCE: Resource =
    Resource { name: "stability", formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Svg, Format::Png] };

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/stability", get(stability).post(stability))
}

pub(crate) async fn stability(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let (scene, request) = ask.read(|reader| {
        let scene = read_scene(reader);
        let request = Request::read(reader);
        Some((scene?, request))
    })?;
    let price = Price::bounces(Stability::price(&scene, &request)).within(&app.config.limits.of_work())?;
    let canonical = write::canonical(&scene, &request.canonical());
    let metrics = app.metrics.clone();
    ask.respond(&app.pool, &RESOURCE, &canonical, price, move |format: Format, turn: &Turn| {
        let stability = Stability::compute(&scene, &request, || turn.go_on()).ok_or(Cancelled)?;
        metrics.bounces.inc_by(stability.bounces());
        match format {
            Format::Csv => write::csv(&stability.to_table(), turn),
            Format::Ndjson => write::ndjson(&stability.to_table(), &stability.end(), turn),
            Format::Svg | Format::Png => write::picture(stability.to_picture(), format, turn),
            _ => write::json(&stability, turn),
        }
    })
    .await
}
