//! `scenes` and `fields`: what there is to start from, and what a scene may say.

use axum::Router;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::Response;
use axum::routing::get;
use serde::Serialize;

use super::App;
use crate::compute::Price;
use crate::http::{Ask, Format, Problem, Resource};
use crate::wire::fields::Fields;
use crate::wire::presets;

/// Its paths.
pub fn routes() -> Router<App> {
    Router::new()
        .route("/v1/scenes", get(scenes))
        .route("/v1/scenes/{name}", get(scene))
        .route("/v1/fields", get(fields))
}

async fn scenes(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    #[derive(Serialize)]
    struct Scenes {
        scenes: Vec<presets::Shown>,
    }
    fixed(&app, &ask, "scenes", || Scenes {
        scenes: presets::all().iter().filter_map(presets::Preset::shown).collect(),
    })
    .await
}

async fn scene(State(app): State<App>, Path(name): Path<String>, ask: Ask) -> Result<Response<Body>, Problem> {
    let Some(shown) = presets::find(&name).and_then(presets::Preset::shown) else {
        let names = presets::names().join(", ");
        return Err(Problem::not_found(format!("there is no scene of this name; there are {names}")));
    };
    fixed(&app, &ask, &format!("scenes/{name}"), || shown).await
}

async fn fields(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    fixed(&app, &ask, "fields", Fields::all).await
}

/// An answer that depends on nothing but the build.
async fn fixed<T: Serialize>(
    app: &App,
    ask: &Ask,
    canonical: &str,
    answer: impl FnOnce() -> T + Send + 'static,
) -> Result<Response<Body>, Problem> {
    const RESOURCE: Resource = Resource { name: "fixed", formats: &[Format::Json] };
    ask.read(|_| Some(()))?;
    ask.respond(&app.pool, &RESOURCE, canonical.as_bytes(), Price::bounces(0), move |_, cancel| {
        super::json(&answer(), cancel)
    })
    .await
}
