//! Prices against time. `cargo bench --bench price` sends random requests to every resource, with scenes from the whole ranges of
//! their fields. It compares the core-seconds of each request with the time that its price stands for, and prints the worst ratio of
//! each resource with its request. Requests whose work is mostly lasting contact are drawn beside them (`catches+contact`), and the worst
//! ten of each are printed. Options: `-- --seed N` draws other requests, `-- --requests N` more, `-- --only NAME` those of one
//! resource; `-- --all` prints every request; `-- --most SECONDS` sends dearer ones too.
//!
//! A price counts bounces of the plain rod; runs of case 1 are timed in between to convert it. The price of a region counts bounces of
//! lanes, a sixth of that. Core-seconds are the CPU time of this process as the system counts it, so other work on the machine disturbs
//! them little. The time to read the request is left out.
//!
//! Flights of a fast spinning scene have thousands of pieces, which no price counts. Such requests are listed apart.

mod contact;
mod draw;

use std::hint::black_box;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::http::{Request as Sent, StatusCode, header};
use clap::Parser;
use contact::CONTACTS;
use draw::{Draw, RESOURCES, Request, put};
use equipoise::api::App;
use equipoise::config::Config;
use equipoise::limits;
use http_body_util::BodyExt;
use rand::SeedableRng;
use rand_xoshiro::SplitMix64;
use rustix::time::{ClockId, clock_gettime};
use serde_json::{Value, json};
use tokio::time::timeout;
use tower::ServiceExt;

/// Largest allowed ratio of a request's time to the time that its price stands for.
const LIMIT: f64 = 3.0;

/// Bounces in lanes that take the time of one plain bounce.
const LANES: f64 = 6.0;

/// Time to wait for an answer.
const PATIENCE: Duration = Duration::from_secs(30);

/// Turns of the body in one flight beyond which it counts as spinning.
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
    /// Price of the most expensive request that is sent, s.
    #[arg(long, default_value = "0.25")]
    most: f64,
    /// Argument that cargo passes to every benchmark.
    #[arg(long)]
    bench: bool,
}

/// A request with its price and time.
struct Found {
    ratio: f64,
    time_s: f64,
    price: f64,
    text: String,
}

struct Servers {
    /// The server that answers.
    open: Router,
    /// A server without a budget, whose refusals name the price of each request.
    closed: Router,
    /// Price of the most expensive request that is sent, s.
    most_s: f64,
}

#[tokio::main(flavor = "current_thread")]
async fn main() {
    let arguments = Arguments::parse();
    // Requests are sent again, and each time has to be that of computing.
    let mut config = Config::parse_from(["equipoise", "--permits", "1", "--answer-cache", "0"]);
    let open = equipoise::router::router(App::new(&config));
    (config.limits.work, config.limits.region_work, config.limits.ensemble_work) = (0, 0, 0);
    let closed = equipoise::router::router(App::new(&config));
    let servers = Servers { open, closed, most_s: arguments.most };
    println!("plain bounce: {:.1} ns", 1e9 * bounce_s());
    println!("| resource | requests | worst ratio | of them above {LIMIT} | spinning: requests | worst ratio |");
    println!("|---|---|---|---|---|---|");
    let mut worst = Vec::new();
    let all = RESOURCES.map(|resource| (resource, false)).into_iter().chain(CONTACTS.map(|resource| (resource, true)));
    for (resource, is_contact) in all {
        let name = if is_contact { format!("{resource}+contact") } else { resource.to_owned() };
        if arguments.only.as_deref().is_some_and(|only| only != name) {
            continue;
        }
        let mut draw = Draw(SplitMix64::seed_from_u64(arguments.seed));
        let (mut plain, mut spinning) = (Vec::new(), Vec::new());
        // Clock times take their time to measure.
        let wanted = if resource == "precision" { arguments.requests.div_ceil(20) } else { arguments.requests };
        while plain.len() + spinning.len() < wanted {
            let request = if is_contact { draw.contact(resource) } else { draw.request(resource) };
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
            "| {name} | {} | {} | {above} | {} | {} |",
            plain.len(),
            most(&plain),
            spinning.len(),
            most(&spinning)
        );
        let shown = match (arguments.all, is_contact) {
            (true, _) => plain.len(),
            (false, true) => 10,
            (false, false) => 1,
        };
        worst.extend(plain.into_iter().take(shown).chain(spinning.into_iter().take(1)).map(|found| (resource, found)));
    }
    println!();
    for (resource, Found { ratio, time_s, price, text }) in worst {
        println!("{ratio:.2}: {:.3} ms for {price} bounces, {resource} {text}", 1e3 * time_s);
    }
}

impl Servers {
    /// Ratio of a request's time to that of its price. None if it is refused or too expensive to send.
    async fn measure(&self, resource: &str, request: &Request) -> Option<Found> {
        let (status, refusal) = ask(&self.closed, resource, request).await?;
        let detail: Value = serde_json::from_slice(&refusal).ok()?;
        let (_, rest) = detail["detail"].as_str().filter(|_| status == 422)?.split_once(" would be ")?;
        let (price, unit) = rest.split_once(" bounces")?;
        let price: f64 = price.parse().ok().filter(|_| !unit.is_empty())?;
        // Requests that compute in time slices have their picture in the price.
        let drawing = match request.accept {
            "image/svg+xml" if !in_turns(resource) => limits::SVG_PRICE,
            "image/png" if !in_turns(resource) => limits::SVG_PRICE + limits::PNG_PRICE,
            _ => 0,
        };
        let price = price + drawing as f64;
        let lanes = if resource == "regions" { LANES } else { 1.0 };
        if price * 70e-9 / lanes > self.most_s {
            return None;
        }
        let (mut time_s, mut rounds, mut spent) = (f64::INFINITY, 0, 0.0);
        // Short requests are sent again, because the first time finds caches cold.
        while rounds < 2 || (rounds < 20 && spent < 0.002) {
            let reading = clock_s();
            ask(&self.closed, resource, request).await?;
            let start = clock_s();
            let (status, _) = ask(&self.open, resource, request).await.unwrap_or_else(|| {
                println!("no answer in {PATIENCE:?}: {resource} {}", request.body);
                (StatusCode::OK, Vec::new())
            });
            let end = clock_s();
            // Some requests are refused only while they are computed.
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

    /// True if the body turns many times in a flight of the scene, or of a scene at a corner of its region. With `noise.model=plan` it may
    /// do so in any scene.
    async fn spins(&self, body: &Value) -> bool {
        let model = &body["scene"]["noise"]["model"];
        if model == "plan" {
            return true;
        }
        let mut corners = vec![body["scene"].clone()];
        for axis in [&body["x"], &body["y"]] {
            let Some(path) = axis["field"].as_str() else { continue };
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
            let mut body = json!({"scene": scene, "preset": body["preset"], "bounces": 1000, "method": "map"});
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
            // The last flight may not have ended.
            if run["outcome"]["kind"] == "diverged" {
                return true;
            }
        }
        false
    }
}

/// True if a resource computes in time slices, so that its price is that of its runs.
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

/// CPU time of this process as the system counts it, s.
fn clock_s() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Time of a plain bounce now, s: the median of a few short runs.
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
