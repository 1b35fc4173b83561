//! The state that all routes share: the pool, the configuration, what is counted, and the way to a clean stop.

use std::ops::Deref;
use std::sync::Arc;

use axum::extract::FromRef;
use tokio::sync::watch;

use crate::api::ops::metrics::Metrics;
use crate::compute::{FairQuota, Pool};
use crate::config::Config;
use crate::http::Answers;
use crate::limits::Limits;

/// State of the server, shared by all routes. Cheap to clone.
#[derive(Debug, Clone)]
pub struct App(Arc<AppState>);

/// See [`App`].
#[derive(Debug)]
pub struct AppState {
    /// Runs CPU-bound work.
    pub pool: Pool,
    /// Answers of pure work, in memory and under way.
    pub answers: Answers,
    /// Places for live runs, shared among clients.
    pub live_quota: FairQuota,
    /// The configuration.
    pub config: Arc<Config>,
    /// Prefix of every path as clients see it.
    pub base_path: Arc<str>,
    /// Counters shown at `/metrics`.
    pub metrics: Arc<Metrics>,
    closing: watch::Sender<bool>,
}

impl Deref for App {
    type Target = AppState;

    fn deref(&self) -> &AppState {
        &self.0
    }
}

impl App {
    /// An app as configured, with nothing to do yet.
    pub fn new(config: &Config) -> Self {
        let pool = Pool::new(config.permits(), &config.limits);
        let answers = Answers::new(&pool, config.limits.answer_cache);
        Self(Arc::new(AppState {
            metrics: Arc::new(Metrics::new(&pool, answers.counts())),
            pool,
            answers,
            live_quota: FairQuota::new(config.limits.live_sessions),
            config: Arc::new(config.clone()),
            base_path: config.base_path.as_str().into(),
            closing: watch::Sender::new(false),
        }))
    }

    /// Announces that the server is about to stop: it is no longer ready, and live runs end.
    pub fn close(&self) {
        self.closing.send_replace(true);
    }

    /// Tells whether the server is about to stop.
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
