//! The HTTP resources, a folder each: the request that is read, the answer that is computed, the picture that is drawn.
//!
//! This file lists the routes; the state that they share is the [`App`].

pub mod app;
pub mod batches;
pub mod catches;
pub mod contract;
pub mod controllers;
pub mod ensembles;
pub mod failures;
pub mod fits;
pub mod formats;
pub mod jacobians;
pub mod ladder;
pub mod live;
pub mod ops;
mod paper;
pub mod periodic_orbits;
pub mod precision;
pub mod previews;
pub mod probe;
pub mod regions;
pub mod resource;
pub mod scene;
pub mod scenes;
pub mod schemas;
pub mod shared;
pub mod stability;
pub mod throws;
pub mod trajectories;
pub mod vocabulary;

use std::path::Path;

use axum::Router;

pub use crate::api::app::App;
use crate::api::contract::Contract;
use crate::api::resource::Endpoint;
use crate::runs::interventions::intervention_schema;

/// Resources that compute an answer: each at `/v1/<name>`, and for many requests at once at `/v1/batches/<name>`.
pub(crate) const COMPUTED: [Endpoint; 13] = [
    Endpoint::of::<catches::Catches>(),
    Endpoint::of::<controllers::Controllers>(),
    Endpoint::of::<ensembles::Ensembles>(),
    Endpoint::of::<fits::Fits>(),
    Endpoint::of::<jacobians::Jacobians>(),
    Endpoint::of::<ladder::Ladder>(),
    Endpoint::of::<periodic_orbits::PeriodicOrbits>(),
    Endpoint::of::<precision::Precision>(),
    Endpoint::of::<previews::Previews>(),
    Endpoint::of::<regions::Regions>(),
    Endpoint::of::<stability::Stability>(),
    Endpoint::of::<throws::Throws>(),
    Endpoint::of::<trajectories::Trajectories>(),
];

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
        .merge(ops::scrape::routes())
        .merge(failures::routes())
        .merge(paper::routes())
        .merge(scenes::routes())
        .merge(live::routes())
        .merge(probe::routes())
        .merge(batches::routes(&COMPUTED));
    COMPUTED.into_iter().map(Endpoint::routes).fold(others, Router::merge)
}
