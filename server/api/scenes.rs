//! The routes `scenes` and `fields`: presets, and the table of scene fields.

use axum::Router;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::Response;
use axum::routing::get;
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::app::App;
use crate::api::contract::Contract;
use crate::api::scene::fields::Fields;
use crate::api::scene::presets;
use crate::api::shared;
use crate::compute::{Cancelled, Price, TimeSlice};
use crate::http::{ApiRequest, Format, Problem, Resource};

/// Paths of the presets and of the table of fields.
pub fn routes() -> Router<App> {
    Router::new()
        .route("/v1/scenes", get(scenes))
        .route("/v1/scenes/{name}", get(scene))
        .route("/v1/fields", get(fields))
}

/// Adds the paths to the contract.
pub fn describe(contract: &mut Contract) {
    contract.document::<Scenes>("Scenes", "scenes", "listScenes", RESOURCE.formats);
    contract.document::<presets::Shown>("Scenes", "scenes/{name}", "getScene", RESOURCE.formats);
    contract.path_name("/v1/scenes/{name}", "Name", "PresetName", "case-1", "Name of a preset.");
    contract.document::<Fields>("Scenes", "fields", "listFields", RESOURCE.formats);
}

/// Answer of `/v1/scenes`.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Presets")]
struct Scenes {
    items: Vec<&'static presets::Shown>,
}

async fn scenes(State(app): State<App>, api_request: ApiRequest) -> Result<Response<Body>, Problem> {
    let price = presets::all().iter().map(presets::Preset::price).sum();
    fixed(&app, &api_request, "scenes", price, |slice| {
        let go_on = || slice.should_continue();
        Some(Scenes { items: presets::all().iter().map(|preset| preset.shown(&go_on)).collect::<Option<_>>()? })
    })
    .await
}

async fn scene(
    State(app): State<App>,
    Path(name): Path<String>,
    api_request: ApiRequest,
) -> Result<Response<Body>, Problem> {
    let Some(preset) = presets::find(&name) else {
        let names = presets::names().join(", ");
        return Err(Problem::not_found(format!("there is no scene of this name; there are {names}")));
    };
    let price = preset.price();
    fixed(&app, &api_request, &format!("scenes/{name}"), price, |slice| preset.shown(&|| slice.should_continue())).await
}

async fn fields(State(app): State<App>, api_request: ApiRequest) -> Result<Response<Body>, Problem> {
    fixed(&app, &api_request, "fields", 0, |_| Some(Fields::all())).await
}

/// Documents that depend on the build alone.
pub(crate) const RESOURCE: Resource = Resource { name: "fixed", formats: &[Format::Json] };

/// Answers with a value that depends on the build alone. `answer` returns None when the client has gone.
pub(crate) async fn fixed<T: Serialize>(
    app: &App,
    api_request: &ApiRequest,
    canonical: &str,
    price: u64,
    answer: impl FnOnce(&TimeSlice) -> Option<T> + Clone + Send + 'static,
) -> Result<Response<Body>, Problem> {
    api_request.read(|_| Some(()))?;
    let price = Price::bounces(price);
    let compute = move |_, slice: &TimeSlice| shared::write::json(&answer(slice).ok_or(Cancelled)?, slice);
    api_request.respond(&app.answers.permanent(), &RESOURCE, canonical.as_bytes(), price, compute).await
}
