//! The HTTP resources, a folder each: the request that is read, the answer that is computed, the picture that is drawn.
//!
//! This file lists the routes; the state that they share is the [`App`].

pub mod app;
pub mod batches;
pub mod computed;
pub mod contract;
pub mod failures;
pub mod formats;
pub mod live;
pub mod ops;
mod paper;
pub(crate) mod prelude;
pub mod probe;
pub mod resource;
pub mod scene;
pub mod scenes;
pub mod schemas;
pub mod shared;

use std::path::Path;

use axum::Router;

pub use crate::api::app::App;
use crate::api::computed::COMPUTED;
use crate::api::contract::Contract;
use crate::api::resource::Endpoint;
use crate::runs::interventions::intervention_schema;

/// The parts of the contract that follow from the code.
pub fn contract_parts() -> serde_json::Value {
    let mut contract = Contract::default();
    for endpoint in COMPUTED {
        endpoint.describe(&mut contract);
    }
    contract.schema("Intervention", intervention_schema());
    live::describe(&mut contract);
    scenes::describe(&mut contract);
    failures::describe(&mut contract);
    paper::describe(&mut contract);
    probe::describe(&mut contract);
    batches::describe(&mut contract, &COMPUTED);
    contract.part::<ops::health::Health>();
    contract.finish()
}

/// All routes; the page's files from `web`, if that is given.
pub fn all(web: Option<&Path>) -> Router<App> {
    let others = Router::new()
        .merge(ops::page::routes(web))
        .merge(ops::contract::routes())
        .merge(ops::health::routes())
        .merge(failures::routes())
        .merge(paper::routes())
        .merge(scenes::routes())
        .merge(live::routes())
        .merge(probe::routes())
        .merge(batches::routes(&COMPUTED));
    COMPUTED.into_iter().map(Endpoint::routes).fold(others, Router::merge)
}
