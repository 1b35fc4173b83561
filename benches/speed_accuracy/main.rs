//! Error over time per bounce of all methods and of common software: `cargo bench --bench speed_accuracy`. It measures the methods as
//! `/v1/precision` does, takes the other software from the last `benches/peers/run`, and prints the part of `docs/measurements.md` that
//! `benches/run accuracy` writes. Options: `-- --peers FILE` takes the other software from a file, `-- --chart FILE` writes the chart.
//!
//! Both have the same scene, the paper's case 1, and the same error at impact 100.

mod page;

use std::error::Error;
use std::path::PathBuf;

use axum::body::Body;
use axum::http::{Request, header};
use clap::Parser;
use equipoise::api::App;
use equipoise::charts::{CostAndError, SYMBOLS, Series, SpeedAccuracy, speed_accuracy};
use equipoise::comparison::METHODS;
use equipoise::config::Config;
use http_body_util::BodyExt;
use serde::Deserialize;
use tower::ServiceExt;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The command line.
#[derive(Parser)]
struct Options {
    /// Measurement of other software.
    #[arg(long)]
    peers: Option<PathBuf>,
    /// File of the chart, as SVG.
    #[arg(long)]
    chart: Option<PathBuf>,
    /// Given by cargo.
    #[arg(long, hide = true)]
    bench: bool,
}

/// Answer of `/v1/precision`, as far as it is used here.
#[derive(Deserialize)]
struct Precision {
    reference: Reference,
    points: Vec<Point>,
}

#[derive(Deserialize)]
struct Reference {
    rounding: f64,
}

/// A method with a setting.
#[derive(Deserialize)]
struct Point {
    method: String,
    setting: Option<Setting>,
    cost_ns_per_bounce: f64,
    spread_ns_per_bounce: [f64; 2],
    evaluations: Option<u64>,
    error: Option<f64>,
    outcome: Outcome,
}

#[derive(Deserialize)]
struct Outcome {
    kind: String,
    bounces: u64,
}

#[derive(Deserialize)]
struct Setting {
    name: String,
    value: f64,
    unit: String,
}

/// Measurement of `benches/peers/run`.
#[derive(Deserialize)]
struct Measurement {
    machine: Machine,
    peers: Vec<Peer>,
}

#[derive(Deserialize)]
struct Machine {
    processor: String,
    cores: usize,
    load_average: f64,
}

/// Other software with a setting, or the reason why it was not measured.
#[derive(Deserialize)]
#[serde(untagged)]
enum Peer {
    Measured(MeasuredPeer),
    Skipped { name: String, skipped: String },
}

#[derive(Deserialize)]
struct MeasuredPeer {
    name: String,
    version: String,
    setting: String,
    ns_per_bounce: f64,
    impacts: u64,
    error_at_10: Option<f64>,
    error_at_100: Option<f64>,
}

#[tokio::main]
async fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    let target = std::env::var("CARGO_TARGET_DIR").map_or_else(|_| PathBuf::from(ROOT).join("target"), PathBuf::from);
    let file = options.peers.unwrap_or_else(|| target.join("peers/peers.json"));
    let text = std::fs::read_to_string(&file)
        .map_err(|error| format!("{}: {error}; run benches/peers/run first", file.display()))?;
    let measurement: Measurement = serde_json::from_str(&text)?;
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let precision = precision().await?;
    let skipped = |peer: &Peer| match peer {
        Peer::Skipped { name, skipped } => Some(format!("{name}: {skipped}")),
        Peer::Measured(_) => None,
    };
    for reason in measurement.peers.iter().filter_map(skipped) {
        eprintln!("not measured: {reason}");
    }
    if let Some(file) = options.chart {
        std::fs::write(file, draw(&precision, &measurement))?;
    }
    let load = load.split(' ').next().unwrap_or("unknown");
    print!("{}", page::write(&precision, &measurement, load));
    Ok(())
}

/// Measures the methods.
async fn precision() -> Result<Precision, Box<dyn Error>> {
    let router = equipoise::router::router(App::new(&Config::parse_from(["equipoise"])));
    let request = Request::get("/v1/precision?preset=case-1").header(header::HOST, "localhost").body(Body::empty())?;
    let bytes = router.oneshot(request).await?.into_body().collect().await?.to_bytes();
    Ok(serde_json::from_slice(&bytes)?)
}

/// Name of this program among the peers.
const OWN: &str = "equipoise";

/// All measured settings.
fn measured(measurement: &Measurement) -> impl Iterator<Item = &MeasuredPeer> {
    measurement.peers.iter().filter_map(|peer| match peer {
        Peer::Measured(peer) => Some(peer),
        Peer::Skipped { .. } => None,
    })
}

/// The measured settings of other software.
fn others(measurement: &Measurement) -> impl Iterator<Item = &MeasuredPeer> {
    measured(measurement).filter(|peer| peer.name != OWN)
}

/// This program's map, timed as the other software is.
fn own(measurement: &Measurement) -> Option<&MeasuredPeer> {
    measured(measurement).find(|peer| peer.name == OWN)
}

/// Names of other software, fastest first.
fn names(measurement: &Measurement) -> Vec<&str> {
    let mut names = Vec::new();
    for peer in others(measurement) {
        if !names.contains(&peer.name.as_str()) {
            names.push(&peer.name);
        }
    }
    names
}

/// Draws methods and other software in one chart.
fn draw(precision: &Precision, measurement: &Measurement) -> String {
    let mut series = Vec::new();
    for (method, symbol) in METHODS.iter().zip(SYMBOLS) {
        let points = precision.points.iter().enumerate().filter(|(_, point)| point.method == method.name);
        let points = points.filter_map(|(index, point)| {
            let [low, high] = point.spread_ns_per_bounce;
            Some(CostAndError { index, cost: [low, point.cost_ns_per_bounce, high], error: point.error? })
        });
        series.push(Series { symbol, name: method.name, label: method.title, points: points.collect() });
    }
    for (name, symbol) in names(measurement).into_iter().zip(SYMBOLS.iter().cycle()) {
        let points = others(measurement).enumerate().filter(|(_, peer)| peer.name == name);
        let points = points.filter_map(|(index, peer)| {
            Some(CostAndError { index, cost: [peer.ns_per_bounce; 3], error: peer.error_at_100? })
        });
        series.push(Series { symbol: symbol.open(), name, label: name, points: points.collect() });
    }
    series.retain(|series| !series.points.is_empty());
    let mut front: Vec<(f64, f64)> =
        series.iter().flat_map(|series| &series.points).map(|point| (point.cost[1], point.error)).collect();
    front.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut least = f64::INFINITY;
    front.retain(|(_, error)| {
        let is_better = *error < least;
        least = least.min(*error);
        is_better
    });
    speed_accuracy(&SpeedAccuracy {
        title: "Speed against accuracy",
        subtitle: "the paper's case 1, 100 bounces: errors of this program's methods and of common software",
        caption: "Filled symbols: methods of this program; bars are quartiles. Open symbols: common software. Each point is a step or a \
                  tolerance. No point lies below the Pareto front. A setting whose run ends before impact 100 is not drawn.",
        cost: ("time", "ns per bounce"),
        error: "error at impact 100",
        series: &series,
        front: &front,
        rounding: precision.reference.rounding,
    })
}
