//! Requests per second of each resource, beside a bare axum handler that sends the same bytes from memory.

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
    "/v1/trajectories?preset=case-1&impacts=100",
    "/v1/trajectories?preset=case-1&impacts=100&format=csv",
    "/v1/trajectories?preset=case-1&impacts=10000",
    "/v1/jacobians?preset=case-1",
    "/v1/stability?preset=case-1",
    "/v1/controllers?preset=case-1",
];

pub(crate) async fn measure() -> io::Result<String> {
    let ours = Program::start()?;
    let mut command = Command::new(std::env::current_exe()?);
    let bare = Program::spawn(command.args(["--bare", &ours.address.to_string()]))?;
    let mut text = format!(
        "## Requests per second\n\n{CONNECTIONS} connections, {ROUNDS} rounds of {} s, in turns with a bare axum handler that sends the \
         same bytes from memory\n(`--only rates`). The ratio is the median over the rounds.\n\n\
         | | answer | per second | bare | ratio | p50 | p99 | bare p50 | bare p99 |\n|---|---|---|---|---|---|---|---|---|\n",
        ROUND.as_secs_f64(),
    );
    for target in TARGETS {
        let bytes = Connection::open(ours.address).await?.get(target).await?.body.len();
        let (mut all, mut rates, mut ratios) = ([Times::default(), Times::default()], [0.0; 2], Vec::new());
        for _ in 0..ROUNDS {
            let mut round = [0.0; 2];
            for (index, address) in [ours.address, bare.address].into_iter().enumerate() {
                let times = ask(address, target, CONNECTIONS, ROUND, Duration::ZERO).await?;
                round[index] = times.count() as f64 / ROUND.as_secs_f64();
                rates[index] += round[index] / ROUNDS as f64;
                all[index].append(times);
            }
            ratios.push(round[0] / round[1]);
        }
        let [own, other] = &mut all;
        let quantiles = [own.quantile(0.5), own.quantile(0.99), other.quantile(0.5), other.quantile(0.99)];
        let [p50, p99, bare_p50, bare_p99] = quantiles.map(|ms| format!("{ms:.2} ms"));
        let (kb, [rate, bare], ratio) = (bytes as f64 / 1e3, rates, median(ratios));
        let _ = writeln!(
            text,
            "| `{target}` | {kb:.1} kB | {rate:.0} | {bare:.0} | {ratio:.2} | {p50} | {p99} | {bare_p50} | {bare_p99} |"
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
