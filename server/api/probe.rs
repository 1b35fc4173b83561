//! `/v1/probe?target=…`: the verdict on a query of `/v1/stability` as gauges. Prometheus writes the query of each rig into `target` by
//! relabelling, as for the blackbox exporter.

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;
use serde_json::json;

use crate::api::app::App;
use crate::api::computed::stability::computed;
use crate::api::computed::stability::request::StabilityRequest;
use crate::api::contract::Contract;
use crate::api::formats::{ProbeFormat, WriteAnswer};
use crate::api::resource;
use crate::api::resource::{ResourceRequest, Work};
use crate::api::shared::write::canonical_of;
use crate::http::{ApiRequest, Problem};

/// The route.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/probe", get(probe))
}

/// Adds the path to the contract.
pub fn describe(contract: &mut Contract) {
    let target = json!({
        "name": TARGET.0,
        "in": "query",
        "required": true,
        "description": "A query of `/v1/stability`, percent-encoded.",
        "schema": {"type": "string"},
        "example": "preset=case-1",
    });
    contract.gauges("/v1/probe", "probe", "Probe", target);
}

/// Name of the parameter, and the pointer under which the errors of its query are.
const TARGET: (&str, &str) = ("target", "/target");

async fn probe(State(app): State<App>, asked: ApiRequest) -> Result<Response<Body>, Problem> {
    let (name, pointer) = TARGET;
    let query = asked.read(|reader| {
        reader.require(&[name]);
        reader.text(name).map(str::to_owned)
    })?;
    let target = asked.target(pointer, &query)?;
    let request = target.read_below(pointer, StabilityRequest::read)?;
    resource::respond(app, target, request, WORK).await
}

/// The verdict as gauges alone.
const WORK: Work<StabilityRequest, ProbeFormat> = Work::Pure {
    canonical: canonical_of,
    compute: |request, format, slice, bounces| format.write(&computed(request, slice, bounces)?, slice),
};
