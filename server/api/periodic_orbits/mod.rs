//! `periodic-orbits`: what comes back, and its branches.

pub mod answer;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use crate::api::app::App;
use crate::api::periodic_orbits::answer::{PeriodicOrbits, Request};
use crate::api::scene::read_frictionless_scene;
use crate::api::shared::write;
use crate::compute::{Cancelled, Price, Turn};
use crate::http::{Ask, Format, Problem, Resource};

const RESOURCE: Resource = Resource {
    name: "periodic-orbits",
    formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Svg, Format::Png],
};

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/periodic-orbits", get(periodic_orbits).post(periodic_orbits))
}

pub(crate) async fn periodic_orbits(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let (scene, request) = ask.read(|reader| {
        let scene = read_frictionless_scene(reader);
        let request = Request::read(reader);
        Some((scene?, request?))
    })?;
    let price = Price::bounces(request.price()).within(&app.config.limits.of_work())?;
    let canonical = write::canonical(&scene, &request);
    let metrics = app.metrics.clone();
    ask.respond(&app.pool, &RESOURCE, &canonical, price, move |format: Format, turn: &Turn| {
        let orbits = match PeriodicOrbits::compute(&scene, &request, || turn.go_on()) {
            Ok(orbits) => orbits,
            Err(Some((pointer, detail))) => return Err(Problem::invalid_at(pointer, detail)),
            Err(None) => return Err(Cancelled.into()),
        };
        metrics.bounces.inc_by(orbits.bounces());
        match format {
            Format::Csv => write::csv(orbits.to_table(), turn),
            Format::Ndjson => write::ndjson(orbits.to_table(), &orbits.end(), turn),
            Format::Svg | Format::Png => {
                let picture = orbits.to_picture();
                let picture =
                    picture.ok_or_else(|| Problem::invalid_at("/sweep", "the picture is of a branch; give a sweep"))?;
                write::picture(picture, format, turn)
            }
            _ => write::json(&orbits, turn),
        }
    })
    .await
}
