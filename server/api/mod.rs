//! The HTTP resources, a folder each: the request that is read, the answer that is computed, the picture that is drawn.
//!
//! This file lists the routes; the state that they share is the [`App`].

pub mod app;
pub mod batches;
pub mod controllers;
pub mod ensembles;
pub mod failures;
pub mod jacobians;
pub mod ladder;
pub mod live;
pub mod ops;
pub mod periodic_orbits;
pub mod precision;
pub mod regions;
pub mod scene;
pub mod shared;
pub mod stability;
pub mod trajectories;

use axum::Router;

pub use crate::api::app::App;

/// All resources. Each states its full path, so that a path is found by searching for it.
pub fn all() -> Router<App> {
    Router::new()
        .merge(ops::page::routes())
        .merge(ops::contract::routes())
        .merge(ops::health::routes())
        .merge(ops::scrape::routes())
        .merge(failures::routes())
        .merge(scene::routes())
        .merge(trajectories::routes())
        .merge(jacobians::routes())
        .merge(controllers::routes())
        .merge(ladder::routes())
        .merge(live::routes())
        .merge(periodic_orbits::routes())
        .merge(precision::routes())
        .merge(stability::routes())
        .merge(regions::routes())
        .merge(ensembles::routes())
        .merge(batches::routes())
}
