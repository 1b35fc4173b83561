//! Requests per second of `GET /v1/trajectories` and of a bare axum handler that serializes the same columns from memory:
//! `cargo bench --bench http`. Both are measured in turns over the same number of connections on loopback, so that the ratio holds
//! on a noisy machine.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use axum::routing::get;
use axum::{Json, Router};
use clap::Parser;
use equipoise::api::App;
use equipoise::config::Config;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};

const CONNECTIONS: usize = 8;
const ROUND: Duration = Duration::from_millis(1500);
const ROUNDS: usize = 7;
const PATH: &str = "/v1/trajectories?preset=case-1&impacts=100";

#[tokio::main]
async fn main() -> std::io::Result<()> {
    let app = App::new(&Config::parse_from(["equipoise"]));
    let ours = serve(equipoise::router::router(app)).await?;
    let answer = ask(ours, PATH).await?;
    let columns: serde_json::Value = serde_json::from_slice(&answer)?;
    let columns: Arc<Columns> = Arc::new(serde_json::from_value(columns["impacts"].clone())?);
    let bare =
        serve(Router::new().route("/v1/trajectories", get(move || async move { Json(Columns::clone(&columns)) })))
            .await?;
    println!("{} bytes each, {CONNECTIONS} connections, {ROUNDS} rounds of {ROUND:?}", answer.len());
    let mut ratios = Vec::new();
    for _ in 0..ROUNDS {
        let (ours, bare) = (rate(ours).await, rate(bare).await);
        println!("equipoise {ours:.0}/s, bare axum from memory {bare:.0}/s, ratio {:.2}", ours / bare);
        ratios.push(ours / bare);
    }
    ratios.sort_by(f64::total_cmp);
    println!("median ratio {:.2}", ratios[ROUNDS / 2]);
    Ok(())
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
async fn rate(address: SocketAddr) -> f64 {
    let count = Arc::new(AtomicU64::new(0));
    let start = Instant::now();
    let clients: Vec<_> = (0..CONNECTIONS)
        .map(|_| {
            let count = count.clone();
            tokio::spawn(async move {
                let mut stream = TcpStream::connect(address).await?;
                stream.set_nodelay(true)?;
                while start.elapsed() < ROUND {
                    exchange(&mut stream, PATH).await?;
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
