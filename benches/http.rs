//! Requests per second of the server and of bare axum handlers: `cargo bench --bench http`.
//!
//! First answers that are asked for again, beside a handler that sends the same bytes from memory; then `/v1/trajectories` computed
//! each time, beside a handler that serializes the same columns from memory. Both sides are measured in turns over the same number of
//! connections on loopback, so that the ratio holds on a noisy machine.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::http::header;
use axum::routing::get;
use axum::{Json, Router};
use clap::Parser;
use equipoise::api::App;
use equipoise::config::Config;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};

const CONNECTIONS: usize = 8;
const ROUND: Duration = Duration::from_millis(800);
const ROUNDS: usize = 7;
const PATH: &str = "/v1/trajectories?preset=case-1&impacts=100";

/// Answers that are asked for again, with their media types.
const AGAIN: [(&str, &str); 6] = [
    ("/health/live", "application/json"),
    ("/", "text/html; charset=utf-8"),
    (PATH, "application/json"),
    ("/v1/stability?preset=case-1", "application/json"),
    ("/v1/scenes", "application/json"),
    ("/v1/controllers?preset=case-1", "application/json"),
];

#[tokio::main]
async fn main() -> std::io::Result<()> {
    let ours = serve(equipoise::router::router(App::new(&Config::parse_from(["equipoise"])))).await?;
    println!("{CONNECTIONS} connections, {ROUNDS} rounds of {ROUND:?}; medians");
    for (path, media_type) in AGAIN {
        let bytes = Bytes::from(ask(ours, path).await?);
        let answer = move || {
            let bytes = bytes.clone();
            async move { ([(header::CONTENT_TYPE, media_type)], bytes) }
        };
        let bare = serve(Router::new().route(path.split('?').next().unwrap_or(path), get(answer))).await?;
        compare(path, ours, bare, path).await;
    }
    let ours =
        serve(equipoise::router::router(App::new(&Config::parse_from(["equipoise", "--answer-cache", "0"])))).await?;
    let columns: serde_json::Value = serde_json::from_slice(&ask(ours, PATH).await?)?;
    let columns: Arc<Columns> = Arc::new(serde_json::from_value(columns["impacts"].clone())?);
    let answer = move || async move { Json(Columns::clone(&columns)) };
    let bare = serve(Router::new().route("/v1/trajectories", get(answer))).await?;
    compare("computed each time, beside columns serialized from memory", ours, bare, PATH).await;
    Ok(())
}

/// Measures both servers in turns, and prints the medians.
async fn compare(title: &str, ours: SocketAddr, bare: SocketAddr, path: &'static str) {
    let mut rounds = Vec::new();
    for _ in 0..ROUNDS {
        let (ours, bare) = (rate(ours, path).await, rate(bare, path).await);
        rounds.push((ours, bare, ours / bare));
    }
    rounds.sort_by(|one, other| one.2.total_cmp(&other.2));
    let (ours, bare, ratio) = rounds[ROUNDS / 2];
    println!("{title}: equipoise {ours:.0}/s, bare axum {bare:.0}/s, ratio {ratio:.2}");
}

/// The columns of the answer in memory.
#[derive(Clone, serde::Serialize, serde::Deserialize)]
struct Columns {
    n: Vec<u64>,
    contact_mode: Vec<Option<String>>,
    #[serde(flatten)]
    numbers: std::collections::BTreeMap<String, Vec<Option<f64>>>,
}

async fn serve(router: Router) -> std::io::Result<SocketAddr> {
    let listener = TcpListener::bind("127.0.0.1:0").await?;
    let address = listener.local_addr()?;
    tokio::spawn(async move { axum::serve(listener, router).await });
    Ok(address)
}

/// Measures requests per second over one round.
async fn rate(address: SocketAddr, path: &'static str) -> f64 {
    let count = Arc::new(AtomicU64::new(0));
    let start = Instant::now();
    let clients: Vec<_> = (0..CONNECTIONS)
        .map(|_| {
            let count = count.clone();
            tokio::spawn(async move {
                let mut stream = TcpStream::connect(address).await?;
                stream.set_nodelay(true)?;
                while start.elapsed() < ROUND {
                    exchange(&mut stream, path).await?;
                    count.fetch_add(1, Ordering::Relaxed);
                }
                std::io::Result::Ok(())
            })
        })
        .collect();
    for client in clients {
        client.await.expect("no client panics").expect("every request is answered");
    }
    count.load(Ordering::Relaxed) as f64 / start.elapsed().as_secs_f64()
}

async fn ask(address: SocketAddr, path: &str) -> std::io::Result<Vec<u8>> {
    exchange(&mut TcpStream::connect(address).await?, path).await
}

/// Sends a request on a persistent connection and reads the whole answer.
async fn exchange(stream: &mut TcpStream, path: &str) -> std::io::Result<Vec<u8>> {
    stream.write_all(format!("GET {path} HTTP/1.1\r\nhost: localhost\r\n\r\n").as_bytes()).await?;
    let mut received = Vec::with_capacity(64 * 1024);
    loop {
        let head = received.windows(4).position(|window| window == b"\r\n\r\n").map(|end| end + 4);
        if let Some(head) = head {
            let headers = String::from_utf8_lossy(&received[..head]).to_ascii_lowercase();
            assert!(headers.starts_with("http/1.1 200"), "{headers}");
            let length = headers.lines().find_map(|line| line.strip_prefix("content-length: ")?.parse::<usize>().ok());
            let length = length.expect("both servers say how long an answer is");
            while received.len() < head + length {
                stream.read_buf(&mut received).await?;
            }
            return Ok(received.split_off(head));
        }
        if stream.read_buf(&mut received).await? == 0 {
            return Err(std::io::ErrorKind::UnexpectedEof.into());
        }
    }
}
