//! The resources, one file each: what they are called, what they read, compute and write.
//!
//! Thin: a route reads with `wire`, computes with `equipoise-physics` under a permit of `compute`, and writes with
//! `wire`. What all of them share is the `App`.

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

use std::sync::Arc;

use axum::Router;
use axum::extract::FromRef;
use equipoise_physics::scene::Scene;
use serde::Serialize;
use tokio::sync::watch;

use crate::api::ops::metrics::Metrics;
use crate::api::scene::resolved::Resolved;
use crate::api::shared::table::Table;
use crate::charts::{NoPixels, png};
use crate::compute::{Cancelled, Pool, Shares, Turn};
use crate::config::Config;
use crate::http::output::written;
use crate::http::{Format, Problem};
use crate::limits::Limits;

/// What routes share. Cheap to clone.
#[derive(Debug, Clone)]
pub struct App {
    /// Where work is done.
    pub pool: Pool,
    /// Places for live runs.
    pub live_places: Shares,
    /// What was set.
    pub config: Arc<Config>,
    /// What stands before every path as clients see it.
    pub base_path: Arc<str>,
    /// What is counted.
    pub metrics: Arc<Metrics>,
    closing: Arc<watch::Sender<bool>>,
}

impl App {
    /// An app as configured, with nothing to do yet.
    pub fn new(config: &Config) -> Self {
        let pool = Pool::new(config.permits(), &config.limits);
        Self {
            metrics: Arc::new(Metrics::new(&pool)),
            pool,
            live_places: Shares::new(config.limits.live_sessions),
            config: Arc::new(config.clone()),
            base_path: config.base_path.as_str().into(),
            closing: Arc::new(watch::Sender::new(false)),
        }
    }

    /// Says that the server is about to stop: it is no longer ready, and live runs end.
    pub fn close(&self) {
        self.closing.send_replace(true);
    }

    /// Whether the server is about to stop.
    pub fn is_closing(&self) -> bool {
        *self.closing.borrow()
    }

    /// Waits until the server is about to stop.
    pub async fn closing(&self) {
        let mut closing = self.closing.subscribe();
        // An error would mean that the sender is gone, which is in `self`.
        let _ = closing.wait_for(|closing| *closing).await;
    }
}

impl FromRef<App> for Limits {
    fn from_ref(app: &App) -> Self {
        app.config.limits
    }
}

/// All resources. Each states its full path, so that a path is found by searching for it.
pub fn all() -> Router<App> {
    Router::new()
        .merge(crate::api::ops::page::routes())
        .merge(crate::api::ops::contract::routes())
        .merge(crate::api::ops::health::routes())
        .merge(crate::api::ops::metrics::routes())
        .merge(crate::api::failures::routes())
        .merge(crate::api::scene::routes())
        .merge(crate::api::trajectories::routes())
        .merge(crate::api::jacobians::routes())
        .merge(crate::api::controllers::routes())
        .merge(crate::api::ladder::routes())
        .merge(crate::api::live::routes())
        .merge(crate::api::periodic_orbits::routes())
        .merge(crate::api::precision::routes())
        .merge(crate::api::stability::routes())
        .merge(crate::api::regions::routes())
        .merge(crate::api::ensembles::routes())
        .merge(crate::api::batches::routes())
}

/// An answer as JSON.
fn json(answer: &impl Serialize, turn: &Turn) -> Result<Vec<u8>, Problem> {
    written(&|| turn.go_on(), |out| Ok(serde_json::to_writer(out, answer)?))
}

/// A table as CSV.
fn csv(table: &Table, turn: &Turn) -> Result<Vec<u8>, Problem> {
    written(&|| turn.go_on(), |out| table.write_csv(out))
}

/// A table as NDJSON, and what ends it.
fn ndjson(table: &Table, end: &impl Serialize, turn: &Turn) -> Result<Vec<u8>, Problem> {
    written(&|| turn.go_on(), |out| table.write_ndjson(end, out))
}

/// A picture as it is asked for: as it was drawn, or in pixels.
fn picture(svg: String, format: Format, turn: &Turn) -> Result<Vec<u8>, Problem> {
    if format == Format::Svg {
        return Ok(svg.into_bytes());
    }
    png(&svg, || turn.go_on()).map_err(|none| match none {
        NoPixels::Cancelled => Cancelled.into(),
        NoPixels::Unfit => Problem::internal(),
    })
}

/// A request with all defaults filled in: the scene, and whatever else determines the answer.
fn canonical(scene: &Scene, rest: &impl Serialize) -> Vec<u8> {
    canonical_of(&(Resolved(scene), rest))
}

/// The same where a scene and the rest do not say it.
fn canonical_of(request: &impl Serialize) -> Vec<u8> {
    // Writing to memory does not fail.
    serde_json::to_vec(request).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::shared::table::{Cells, Column};
    use equipoise_physics::numbers::double_double::DoubleDouble;

    #[test]
    fn a_large_table_is_not_written_for_nobody() {
        let cells = Cells::Decimals(vec![Some(DoubleDouble::from(0.1)); 100_000]);
        let table = Table(vec![Column { name: "t", unit: "s", cells }]);
        type Way = fn(&Table, &Turn) -> Result<Vec<u8>, Problem>;
        let ways: [Way; 3] = [|table, turn| json(table, turn), csv, |table, turn| ndjson(table, &"end", turn)];
        for write in ways {
            let turn = Turn::alone();
            assert!(write(&table, &turn).unwrap().len() > 3_000_000);
            turn.cancel().set();
            assert_eq!(write(&table, &turn).unwrap_err().status(), 503);
        }
    }
}
