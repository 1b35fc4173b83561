//! The resources, one file each: what they are called, what they read, compute and write.
//!
//! Thin: a route reads with `wire`, computes with `equipoise-physics` under a permit of `compute`, and writes with
//! `wire`. What all of them share is the `App`.

pub mod assets;
pub mod contract;
pub mod health;
pub mod metrics;

use std::path::PathBuf;
use std::sync::Arc;

use axum::Router;
use tokio::sync::watch;

use crate::compute::Pool;
use crate::config::Config;
use metrics::Metrics;

/// What routes share. Cheap to clone.
#[derive(Debug, Clone)]
pub struct App {
    /// Where work is done.
    pub pool: Pool,
    /// What is counted.
    pub metrics: Arc<Metrics>,
    /// The folder of the page's files, if not the embedded ones.
    pub web: Option<PathBuf>,
    closing: Arc<watch::Sender<bool>>,
}

impl App {
    /// An app as configured, with nothing to do yet.
    pub fn new(config: &Config) -> Self {
        let pool = Pool::new(config.permits());
        let metrics = Arc::new(Metrics::new(&pool));
        Self { pool, metrics, web: config.web.clone(), closing: Arc::new(watch::Sender::new(false)) }
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

/// All resources. Each states its full path, so that a path is found by searching for it.
pub fn all() -> Router<App> {
    Router::new().merge(assets::routes()).merge(contract::routes()).merge(health::routes()).merge(metrics::routes())
}
