//! Requests per second of each resource, from memory and computed each time, beside a bare axum handler that sends the same bytes.

use std::collections::HashMap;
use std::fmt::Write;
use std::io;
use std::net::SocketAddr;
use std::process::Command;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::Bytes;
use axum::http::{StatusCode, Uri, header};
use axum::response::IntoResponse;
use equipoise::limits::KEPT_ANSWER_BYTES;
use tokio::net::TcpListener;

use crate::client::{Connection, Times, ask, median};
use crate::program::Program;

const CONNECTIONS: usize = 8;
const ROUND: Duration = Duration::from_millis(1500);
const ROUNDS: usize = 5;

/// A cheap target, those of every visit to the page, and some that compute.
const TARGETS: [&str; 9] = [
    "/health/live",
    "/",
    "/v1/scenes",
    "/v1/trajectories?preset=case-1&bounces=100",
    "/v1/trajectories?preset=case-1&bounces=100&format=csv",
    "/v1/trajectories?preset=case-1&bounces=10000",
    "/v1/jacobians?preset=case-1",
    "/v1/stability?preset=case-1",
    "/v1/controllers?preset=case-1",
];

pub(crate) async fn measure(short: bool) -> io::Result<String> {
    let (rounds, round_time) = if short { (2, ROUND / 6) } else { (ROUNDS, ROUND) };
    let kept = Program::start()?;
    let computing = Program::start_with(&["--answer-cache", "0"])?;
    let mut command = Command::new(std::env::current_exe()?);
    let bare = Program::spawn(command.args(["--bare", &kept.address.to_string()]))?;
    let mut text = format!(
        "### Requests per second\n\n{CONNECTIONS} connections, {rounds} rounds of {} s, in turns: the server with answers in memory, the \
         server with `--answer-cache 0`, which\ncomputes each answer, and a bare axum handler that sends the same bytes from memory \
         (`--only rates`). Ratios are over the bare handler,\nmedians over the rounds. Health, the page and `/v1/scenes` are not computed \
         for a request on either server. Answers of more than {:.0} MiB are not kept. Refusals are not\ncounted.\n\n\
         | | answer | from memory, per second | ratio | p50 | p99 | computed, per second | ratio | p50 | p99 | bare, per second | p50 | p99 |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        round_time.as_secs_f64(),
        KEPT_ANSWER_BYTES as f64 / 1_048_576.0,
    );
    let addresses = [kept.address, computing.address, bare.address];
    for target in TARGETS {
        let bytes = Connection::open(kept.address).await?.get(target).await?.body.len();
        let mut times: [Times; 3] = Default::default();
        let (mut rates, mut ratios): ([f64; 3], [Vec<f64>; 2]) = Default::default();
        for _ in 0..rounds {
            let mut round = [0.0; 3];
            for (index, address) in addresses.into_iter().enumerate() {
                let asked = ask(address, target, CONNECTIONS, round_time, Duration::ZERO).await?;
                round[index] = asked.count() as f64 / round_time.as_secs_f64();
                rates[index] += round[index] / rounds as f64;
                times[index].append(asked);
            }
            ratios[0].push(round[0] / round[2]);
            ratios[1].push(round[1] / round[2]);
        }
        let refused: u64 = times.iter().map(Times::refused).sum();
        let note = if refused > 0 { format!(" ({refused} × 503)") } else { String::new() };
        let delays =
            times.map(|mut times| [0.5, 0.99].map(|share| format!("{:.2} ms", times.quantile(share))).join(" | "));
        let [kept, computed] = ratios.map(median);
        let _ = writeln!(
            text,
            "| `{target}`{note} | {:.1} kB | {:.0} | {kept:.2} | {} | {:.0} | {computed:.2} | {} | {:.0} | {} |",
            bytes as f64 / 1e3,
            rates[0],
            delays[0],
            rates[1],
            delays[1],
            rates[2],
            delays[2],
        );
    }
    Ok(text + "\n")
}

/// A server that sends the answers of another one from memory.
pub(crate) async fn serve_bare(of: SocketAddr) -> io::Result<()> {
    let mut answers = HashMap::new();
    for target in TARGETS {
        let answer = Connection::open(of).await?.get(target).await?;
        let media_type = answer.head.lines().find_map(|line| line.strip_prefix("content-type: ")).unwrap_or_default();
        answers.insert(target, (media_type.to_owned(), Bytes::from(answer.body)));
    }
    let answers = Arc::new(answers);
    let router = Router::new().fallback(async move |uri: Uri| match answers.get(uri.to_string().as_str()) {
        Some((media_type, body)) => ([(header::CONTENT_TYPE, media_type.clone())], body.clone()).into_response(),
        None => StatusCode::NOT_FOUND.into_response(),
    });
    let listener = TcpListener::bind("127.0.0.1:0").await?;
    println!("bare http://{}/", listener.local_addr()?);
    axum::serve(listener, router).await
}
