//! `stability`: the verdict on a scene.

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use super::App;
use crate::compute::{Cancel, Cancelled, Price};
use crate::http::{Ask, Format, Problem, Resource};
use crate::limits;
use crate::wire::scene;
use crate::wire::stability::Stability;

const RESOURCE: Resource =
    Resource { name: "stability", formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Svg, Format::Png] };

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/stability", get(stability).post(stability))
}

async fn stability(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let (scene, impacts, basin) = ask.read(|reader| {
        let scene = scene::read(reader);
        let impacts = reader.integer("impacts", 1..=limits::IMPACTS).unwrap_or(2000);
        let basin = reader.boolean("basin").unwrap_or(false);
        Some((scene?, impacts, basin))
    })?;
    let price = Price::bounces(Stability::price(impacts, basin)).within(&limits::WORK)?;
    let canonical = super::canonical(&scene, &(impacts, basin));
    let metrics = app.metrics.clone();
    ask.respond(&app.pool, &RESOURCE, &canonical, price, move |format: Format, cancel: &Cancel| {
        let stability = Stability::compute(&scene, impacts, basin, || !cancel.is_set()).ok_or(Cancelled)?;
        metrics.bounces.inc_by(stability.bounces());
        match format {
            Format::Csv => Ok(stability.to_table().to_csv()),
            Format::Ndjson => Ok(stability.to_table().to_ndjson(&stability.end())),
            Format::Svg | Format::Png => super::picture(stability.to_picture(), format, cancel),
            _ => super::json(&stability),
        }
    })
    .await
}
