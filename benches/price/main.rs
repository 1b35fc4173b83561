//! Prices against time: `cargo bench --bench price` asks random requests of every resource, with scenes from the whole ranges of
//! their fields, and compares the seconds of a core that each takes with those that its price stands for. Printed is the worst ratio
//! of each resource and the request that has it; `-- --seed N` draws others, `-- --requests N` more, `-- --only NAME` of one
//! resource, and `-- --all` prints every one.
//!
//! A price is in bounces of the plain rod, for which runs of case 1 are timed in between; of a region it is in bounces of lanes, a
//! sixth of that. Seconds are those that the system books for this process, so other work on the machine disturbs them little.
//! Reading the request is not in them.
//!
//! Flights of a scene that spins have thousands of pieces, which are no matter of any price: their requests stand apart.

mod draw;

use std::hint::black_box;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::http::{Request as Sent, StatusCode, header};
use clap::Parser;
use draw::{Draw, RESOURCES, Request, put};
use equipoise::api::App;
use equipoise::config::Config;
use equipoise::limits;
use http_body_util::BodyExt;
use rustix::time::{ClockId, clock_gettime};
use serde_json::{Value, json};
use tokio::time::timeout;
use tower::ServiceExt;

/// Most that the time of a request may be of the time that its price stands for.
const LIMIT: f64 = 3.0;

/// Bounces of a region's lanes in the time of one plain bounce.
const LANES: f64 = 6.0;

/// Dearest request that is asked, in seconds by its price.
const MOST_S: f64 = 0.25;

/// Time to wait for an answer.
const PATIENCE: Duration = Duration::from_secs(30);

/// Turns of the body in one flight from which on it counts as spinning.
const SPINS: f64 = 8.0;

#[derive(Parser)]
struct Arguments {
    #[arg(long, default_value = "1")]
    seed: u64,
    #[arg(long, default_value = "400")]
    requests: usize,
    #[arg(long)]
    only: Option<String>,
    #[arg(long)]
    all: bool,
    /// Given by cargo.
    #[arg(long)]
    bench: bool,
}

/// A request that was answered.
struct Found {
    ratio: f64,
    time_s: f64,
    price: f64,
    text: String,
}

struct Servers {
    /// Answers.
    open: Router,
    /// Has no budget, and so says what each request would cost.
    closed: Router,
}

#[tokio::main(flavor = "current_thread")]
async fn main() {
    let arguments = Arguments::parse();
    let mut config = Config::parse_from(["equipoise", "--permits", "1"]);
    let open = equipoise::router::router(App::new(&config));
    (config.limits.work, config.limits.region_work, config.limits.ensemble_work) = (0, 0, 0);
    let closed = equipoise::router::router(App::new(&config));
    let servers = Servers { open, closed };
    println!("plain bounce: {:.1} ns", 1e9 * bounce_s());
    println!("| resource | requests | worst ratio | of them above {LIMIT} | spinning: requests | worst ratio |");
    println!("|---|---|---|---|---|---|");
    let mut worst = Vec::new();
    for resource in RESOURCES {
        if arguments.only.as_deref().is_some_and(|only| only != resource) {
            continue;
        }
        let mut draw = Draw(arguments.seed);
        let (mut plain, mut spinning) = (Vec::new(), Vec::new());
        // What is measured by the clock takes its time.
        let wanted = if resource == "precision" { arguments.requests.div_ceil(20) } else { arguments.requests };
        while plain.len() + spinning.len() < wanted {
            let request = draw.request(resource);
            let Some(found) = servers.measure(resource, &request).await else { continue };
            let spins = found.ratio > LIMIT && servers.spins(&request.body).await;
            if spins { &mut spinning } else { &mut plain }.push(found);
        }
        for found in [&mut plain, &mut spinning] {
            found.sort_by(|one, other| other.ratio.total_cmp(&one.ratio));
        }
        let most = |found: &[Found]| found.first().map_or("–".to_owned(), |found| format!("{:.2}", found.ratio));
        let above = plain.iter().filter(|found| found.ratio > LIMIT).count();
        println!(
            "| {resource} | {} | {} | {above} | {} | {} |",
            plain.len(),
            most(&plain),
            spinning.len(),
            most(&spinning)
        );
        let shown = if arguments.all { plain.len() } else { 1 };
        worst.extend(plain.into_iter().take(shown).chain(spinning.into_iter().take(1)).map(|found| (resource, found)));
    }
    println!();
    for (resource, Found { ratio, time_s, price, text }) in worst {
        println!("{ratio:.2}: {:.3} ms for {price} bounces, {resource} {text}", 1e3 * time_s);
    }
}

impl Servers {
    /// A request's time over that of its price; none where it cannot be, or costs too much to ask.
    async fn measure(&self, resource: &str, request: &Request) -> Option<Found> {
        let (status, refusal) = ask(&self.closed, resource, request).await?;
        let detail: Value = serde_json::from_slice(&refusal).ok()?;
        let (_, rest) = detail["detail"].as_str().filter(|_| status == 422)?.split_once(" would be ")?;
        let (price, unit) = rest.split_once(" bounces")?;
        let price: f64 = price.parse().ok().filter(|_| !unit.is_empty())?;
        // What computes in turns has its picture in the price.
        let drawing = match request.accept {
            "image/svg+xml" if !in_turns(resource) => limits::SVG_PRICE,
            "image/png" if !in_turns(resource) => limits::SVG_PRICE + limits::PNG_PRICE,
            _ => 0,
        };
        let price = price + drawing as f64;
        let lanes = if resource == "regions" { LANES } else { 1.0 };
        if price * 70e-9 / lanes > MOST_S {
            return None;
        }
        let (mut time_s, mut rounds, mut spent) = (f64::INFINITY, 0, 0.0);
        // What is short is done again: the first time finds caches cold.
        while rounds < 2 || (rounds < 20 && spent < 0.002) {
            let reading = clock_s();
            ask(&self.closed, resource, request).await?;
            let start = clock_s();
            let (status, _) = ask(&self.open, resource, request).await.unwrap_or_else(|| {
                println!("no answer in {PATIENCE:?}: {resource} {}", request.body);
                (StatusCode::OK, Vec::new())
            });
            let end = clock_s();
            // Some find only while they compute that there is no answer.
            if status != 200 && status != 422 {
                return None;
            }
            time_s = time_s.min((end - start) - (start - reading));
            (rounds, spent) = (rounds + 1, spent + end - reading);
            if spent > 1.0 {
                break;
            }
        }
        let ratio = time_s / (price.max(1.0) * bounce_s() / lanes);
        let gzip = if request.gzip { " gzip" } else { "" };
        Some(Found { ratio, time_s, price, text: format!("{}{gzip} {}", request.accept, request.body) })
    }

    /// True if a flight of the scene, or of one at a corner of its region, turns the body many times. A run that carries out plans
    /// made for other times may do so anywhere.
    async fn spins(&self, body: &Value) -> bool {
        let model = &body["scene"]["noise"]["model"];
        if model == "plan" {
            return true;
        }
        let mut corners = vec![body["scene"].clone()];
        for axis in [&body["x"], &body["y"]] {
            let Some(path) = axis["parameter"].as_str() else { continue };
            let ends = corners.iter().flat_map(|scene| {
                ["from", "to"].map(|end| {
                    let mut scene = scene.clone();
                    put(&mut scene, path, axis[end].clone());
                    scene
                })
            });
            corners = ends.collect();
        }
        for scene in corners {
            let mut body = json!({"scene": scene, "preset": body["preset"], "impacts": 1000, "method": "map"});
            if body["preset"].is_null() {
                body.as_object_mut().expect("an object").remove("preset");
            }
            let request = Request { body, accept: "application/json", gzip: false };
            let Some((_, bytes)) = ask(&self.open, "trajectories", &request).await else { return true };
            let run: Value = serde_json::from_slice(&bytes).unwrap_or_default();
            let column = |name: &str| -> Vec<f64> {
                let cells = run["impacts"][name].as_array().map(Vec::as_slice).unwrap_or_default();
                cells.iter().map(|cell| cell.as_f64().unwrap_or(0.0)).collect()
            };
            let (t, spin) = (column("t"), column("theta_dot"));
            let flights = std::iter::once(&0.0).chain(&t).zip(&t).zip(&spin);
            if flights
                .into_iter()
                .any(|((start, end), spin)| (end - start) * spin.abs() > SPINS * std::f64::consts::TAU)
            {
                return true;
            }
            // The last flight may have had no end.
            if run["outcome"]["kind"] == "diverged" {
                return true;
            }
        }
        false
    }
}

/// Tells whether a resource computes in turns, and its price is that of its runs alone.
fn in_turns(resource: &str) -> bool {
    ["regions", "ensembles"].contains(&resource)
}

async fn ask(server: &Router, resource: &str, request: &Request) -> Option<(StatusCode, Vec<u8>)> {
    let mut sent = Sent::post(format!("/v1/{resource}"))
        .header(header::HOST, "localhost")
        .header(header::CONTENT_TYPE, "application/json")
        .header(header::ACCEPT, request.accept);
    if request.gzip {
        sent = sent.header(header::ACCEPT_ENCODING, "gzip");
    }
    let sent = sent.body(Body::from(request.body.to_string())).expect("a request that HTTP allows");
    let answer = async {
        let response = server.clone().oneshot(sent).await.expect("the router never fails");
        let status = response.status();
        Some((status, response.into_body().collect().await.ok()?.to_bytes().to_vec()))
    };
    timeout(PATIENCE, answer).await.ok()?
}

/// Seconds of a core that the system has booked for this process.
fn clock_s() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Seconds of a plain bounce now: the median of a few short runs.
fn bounce_s() -> f64 {
    use equipoise_physics::run::orbit::run;
    use equipoise_physics::scene::{Draft, Name, Value};
    const BOUNCES: u64 = 2000;
    let mut draft = Draft::default();
    for (name, number) in [
        (Name::ContactDistance, 0.127_37),
        (Name::RadiusOfGyration, 0.073_54),
        (Name::TiltGain, 1.2),
        (Name::Height, 0.2),
        (Name::Theta, 0.1),
    ] {
        draft.set(name, Some(Value::Number(number))).expect("a value in its range");
    }
    let scene = draft.build().expect("a scene");
    let mut times: Vec<f64> = (0..7)
        .map(|_| {
            let mut orbit = black_box(&scene).orbit().expect("it meets the table");
            let start = clock_s();
            black_box(run(&mut orbit, BOUNCES, |_| true));
            (clock_s() - start) / BOUNCES as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[3]
}
