//! Metrics of the server, and their text formats for Prometheus.

use std::collections::BTreeMap;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::time::Duration;

use axum::extract::MatchedPath;
use prometheus_client::encoding::text::encode;
use prometheus_client::encoding::{EncodeLabelSet, EncodeLabelValue, LabelValueEncoder};
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::metrics::histogram::Histogram;
use prometheus_client::metrics::info::Info;
use prometheus_client::registry::Registry;

use crate::BUILD;
use crate::compute::Pool;
use crate::http::AnswerCounts;

/// All metrics.
#[derive(Debug)]
pub struct Metrics {
    registry: Registry,
    requests: Family<RequestLabels, Counter>,
    durations: Family<RouteLabels, Histogram, fn() -> Histogram>,
    /// Bounces computed for answers and live runs.
    pub bounces: Counter,
    /// Open live runs (`compute::GaugeGuard` counts them).
    pub live_sessions: Gauge,
    /// Delay of the impacts of live runs behind their due times, s.
    pub live_lags: Histogram,
}

/// Upper bounds of the histogram buckets, from 0.1 ms, the time of a small request, to 10 s, longer than any request should take.
const BUCKETS_S: [f64; 11] = [1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0];

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct RequestLabels {
    method: &'static str,
    route: Route,
    status: u16,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct RouteLabels {
    method: &'static str,
    route: Route,
}

/// The template of a request's route.
#[derive(Debug, Clone)]
pub enum Route {
    /// It shares the router's text.
    Matched(MatchedPath),
    /// The route of an answer without the router.
    Fixed(&'static str),
    /// Outside all routes.
    None,
}

impl Route {
    fn as_str(&self) -> &str {
        match self {
            Self::Matched(path) => path.as_str(),
            Self::Fixed(path) => path,
            Self::None => "none",
        }
    }
}

impl From<Option<MatchedPath>> for Route {
    fn from(path: Option<MatchedPath>) -> Self {
        path.map_or(Self::None, Self::Matched)
    }
}

impl PartialEq for Route {
    fn eq(&self, other: &Self) -> bool {
        self.as_str() == other.as_str()
    }
}

impl Eq for Route {}

impl Hash for Route {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.as_str().hash(state);
    }
}

impl EncodeLabelValue for Route {
    fn encode(&self, encoder: &mut LabelValueEncoder<'_>) -> fmt::Result {
        self.as_str().encode(encoder)
    }
}

impl Metrics {
    /// Metrics with all counts at zero. The gauges of `pool` and the counts of answers are registered with them.
    pub fn new(pool: &Pool, answers: &AnswerCounts) -> Self {
        let durations: Family<RouteLabels, Histogram, fn() -> Histogram> =
            Family::new_with_constructor(|| Histogram::new(BUCKETS_S));
        let (requests, bounces, live_sessions) = (Family::default(), Counter::default(), Gauge::default());
        let live_lags = Histogram::new(BUCKETS_S);
        let mut registry = Registry::with_prefix("equipoise");
        registry.register("build", "The build that answers", Info::new([("build", BUILD)]));
        registry.register("requests", "Requests answered", requests.clone());
        registry.register("request_duration_seconds", "Time from request head to answer head", durations.clone());
        registry.register("jobs_running", "Pieces of work being computed", pool.running().clone());
        registry.register("jobs_queued", "Pieces of work waiting for their turn", pool.queued().clone());
        let AnswerCounts { hits, misses, joined, bytes } = answers.clone();
        registry.register("answer_cache_hits", "Answers from memory", hits);
        registry.register("answer_cache_misses", "Answers that had to be computed", misses);
        registry.register("answer_cache_joined", "Requests that waited for an answer under way", joined);
        registry.register("answer_cache_bytes", "Memory of kept answers, in bytes", bytes);
        registry.register("live_sessions", "Live runs", live_sessions.clone());
        registry.register("live_lag_seconds", "Time from when an impact was due to its telling", live_lags.clone());
        registry.register("bounces", "Bounces computed", bounces.clone());
        Self { registry, requests, durations, bounces, live_sessions, live_lags }
    }

    /// Counts one answered request. `route` is the template and not the path, so clients cannot make up labels.
    pub fn record(&self, method: &str, route: Route, status: u16, duration: Duration) {
        const METHODS: [&str; 7] = ["GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"];
        let method = METHODS.into_iter().find(|known| *known == method).unwrap_or("other");
        let labels = RouteLabels { method, route };
        self.durations.get_or_create(&labels).observe(duration.as_secs_f64());
        self.requests.get_or_create(&RequestLabels { method: labels.method, route: labels.route, status }).inc();
    }

    /// All metrics as OpenMetrics.
    ///
    /// # Errors
    /// Failure of the encoder.
    pub fn to_open_metrics(&self) -> Result<String, fmt::Error> {
        let mut text = String::new();
        encode(&mut text, &self.registry)?;
        Ok(text)
    }
}

/// Converts OpenMetrics to the older Prometheus text format: a family has the name of its samples, an info becomes a gauge, and the
/// end mark is dropped.
pub(crate) fn plain(open_metrics: &str) -> String {
    let families = open_metrics.lines().filter_map(|line| line.strip_prefix("# TYPE ")?.split_once(' '));
    let families: BTreeMap<&str, &str> = families.collect();
    let mut text = String::new();
    for line in open_metrics.lines().filter(|line| *line != "# EOF") {
        let mut words = line.splitn(4, ' ');
        match (words.next(), words.next(), words.next(), words.next()) {
            (Some("#"), Some(keyword @ ("HELP" | "TYPE")), Some(name), Some(rest)) => {
                let (suffix, kind) = match families.get(name).copied() {
                    Some("counter") => ("_total", "counter"),
                    Some("info") => ("_info", "gauge"),
                    kind => ("", kind.unwrap_or("untyped")),
                };
                let rest = if keyword == "TYPE" { kind } else { rest };
                text += &format!("# {keyword} {name}{suffix} {rest}\n");
            }
            _ => text += &format!("{line}\n"),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_counted_is_shown() {
        let metrics = Metrics::new(&Pool::new(1, &crate::limits::Limits::default()), &AnswerCounts::default());
        metrics.record("GET", Route::None, 404, Duration::from_millis(1));
        metrics.record("BREW", Route::None, 405, Duration::from_millis(1));
        metrics.bounces.inc_by(7);
        let text = metrics.to_open_metrics().unwrap();
        for line in [
            "equipoise_requests_total{method=\"GET\",route=\"none\",status=\"404\"} 1",
            "equipoise_requests_total{method=\"other\",route=\"none\",status=\"405\"} 1",
            "equipoise_bounces_total 7",
            "equipoise_jobs_running 0",
        ] {
            assert!(text.lines().any(|found| found == line), "{line} is not in\n{text}");
        }
        let older = plain(&text);
        for line in [
            "# HELP equipoise_bounces_total Bounces computed.",
            "# TYPE equipoise_bounces_total counter",
            "# TYPE equipoise_build_info gauge",
            "# TYPE equipoise_jobs_running gauge",
            "# TYPE equipoise_request_duration_seconds histogram",
            "equipoise_requests_total{method=\"other\",route=\"none\",status=\"405\"} 1",
        ] {
            assert!(older.lines().any(|found| found == line), "{line} is not in\n{older}");
        }
        let samples = |text: &str| text.lines().filter(|line| !line.starts_with('#')).count();
        assert_eq!(samples(&older), samples(&text));
        assert!(!older.contains("# EOF"), "{older}");
    }
}
