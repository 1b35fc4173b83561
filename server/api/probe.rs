//! `/v1/probe?target=…`: the verdict on a query of `/v1/stability` as OpenMetrics. Prometheus writes the query of each rig into `target` by
//! relabelling, as for the blackbox exporter.

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use crate::api::app::App;
use crate::api::resource;
use crate::api::resource::ResourceRequest;
use crate::api::stability::Stability;
use crate::api::stability::request::StabilityRequest;
use crate::http::{ApiRequest, Format, Problem};

/// The route.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/probe", get(probe))
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
    resource::respond::<Stability>(app, target, request, &[Format::OpenMetrics]).await
}
