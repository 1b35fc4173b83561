//! Requests per second of the server and of bare axum handlers: `cargo bench --bench http`; `-- --only TEXT` measures targets with this
//! text alone, and `-- --seconds N` each of them for about so long.
//!
//! First answers that are asked for again, beside a handler that sends the same bytes from memory; then `/v1/trajectories` computed
//! each time, beside handlers that send the same bytes from memory, that serialize the same columns, and that compute the same run and
//! serialize its columns with nothing around it. The last of these is measured beside the bytes from memory too: no server that
//! computes its answers gets further. Both sides are measured in turns over the same number of connections on loopback, so that the
//! ratio holds on a noisy machine. The server has its own transport, log and allocator, as in the program. Clients share the cores, so
//! every rate contains their time too.

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
use equipoise::api::computed::trajectories::columns::{ImpactColumn, ImpactRow, of_trajectories};
use equipoise::api::scene::presets;
use equipoise::api::shared::table::{Column, Gathered, Table};
use equipoise::config::Config;
use equipoise::logging::LogFormat;
use equipoise::{logging, router, transport};
use equipoise_physics::analysis::method::{RunMethod, run_by};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};

const CONNECTIONS: usize = 8;
const ROUND: Duration = Duration::from_millis(200);
const PATH: &str = "/v1/trajectories?preset=case-1&bounces=100";
const IMPACTS: usize = 100;

/// Answers that are asked for again, with their media types.
const AGAIN: [(&str, &str); 6] = [
    ("/health/live", "application/json"),
    ("/", "text/html; charset=utf-8"),
    (PATH, "application/json"),
    ("/v1/stability?preset=case-1", "application/json"),
    ("/v1/scenes", "application/json"),
    ("/v1/controllers?preset=case-1", "application/json"),
];

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// The command line.
#[derive(Parser)]
struct Options {
    /// Text in the targets to measure.
    #[arg(long, default_value = "")]
    only: String,
    /// Time for each target, s.
    #[arg(long, default_value = "12")]
    seconds: f64,
    /// Given by cargo.
    #[arg(long, hide = true)]
    bench: bool,
}

#[tokio::main]
async fn main() -> std::io::Result<()> {
    let options = Options::parse();
    logging::init(LogFormat::Text).expect("RUST_LOG can be read");
    let rounds = (options.seconds / (2.0 * ROUND.as_secs_f64())).ceil() as usize;
    println!("{CONNECTIONS} connections, {rounds} rounds of {ROUND:?}; medians");
    let ours = serve_ours(&["equipoise"]).await?;
    for (path, media_type) in AGAIN.into_iter().filter(|(path, _)| path.contains(&options.only)) {
        let bare = serve_bytes(path, media_type, ask(ours, path).await?.into()).await?;
        compare(path, ours, bare, path, rounds).await;
    }
    if !format!("computed {PATH}").contains(&options.only) {
        return Ok(());
    }
    let ours = serve_ours(&["equipoise", "--answer-cache", "0"]).await?;
    let bytes = Bytes::from(ask(ours, PATH).await?);
    let in_memory = serve_bytes(PATH, "application/json", bytes.clone()).await?;
    compare("computed each time, beside the bytes from memory", ours, in_memory, PATH, rounds).await;
    let columns: serde_json::Value = serde_json::from_slice(&bytes)?;
    let columns: Arc<Columns> = Arc::new(serde_json::from_value(columns["impacts"].clone())?);
    let answer = move || async move { Json(Columns::clone(&columns)) };
    let bare = serve(Router::new().route("/v1/trajectories", get(answer))).await?;
    compare("computed each time, beside columns serialized from memory", ours, bare, PATH, rounds).await;
    let answer = || async { Json(computed()) };
    let columns_alone = serve(Router::new().route("/v1/trajectories", get(answer))).await?;
    compare("computed each time, beside a run and its columns alone", ours, columns_alone, PATH, rounds).await;
    compare("a run and its columns alone, beside the bytes from memory", columns_alone, in_memory, PATH, rounds).await;
    Ok(())
}

/// The columns of the run, computed without a server around it.
fn computed() -> Table {
    let scene = presets::find("case-1").expect("a preset").draft().build().expect("a test builds every preset");
    let body = scene.model();
    let mut rows = Vec::with_capacity(IMPACTS);
    let run = run_by(&scene, RunMethod::Map, IMPACTS as u64, |impact| {
        rows.push(ImpactRow {
            error_estimate: Some(impact.error_estimate),
            ..ImpactRow::new(&body, true, impact.contact)
        });
        true
    });
    run.expect("the map applies to every scene");
    let column = |column: &'static ImpactColumn| {
        let mut values = Gathered::with_capacity(column.row.read, rows.len());
        values.extend(&rows);
        Column { name: column.row.name, unit: column.row.unit, cells: values.into_cells() }
    };
    Table(of_trajectories(false).map(column).collect())
}

/// The server as the program serves it.
async fn serve_ours(command: &[&str]) -> std::io::Result<SocketAddr> {
    let listener = TcpListener::bind("127.0.0.1:0").await?;
    let address = listener.local_addr()?;
    let config = Config::parse_from(command);
    let router = router::router(App::new(&config));
    tokio::spawn(async move { transport::serve(listener, router, &config.limits, std::future::pending()).await });
    Ok(address)
}

/// A bare handler that sends these bytes.
async fn serve_bytes(path: &str, media_type: &'static str, bytes: Bytes) -> std::io::Result<SocketAddr> {
    let answer = move || {
        let bytes = bytes.clone();
        async move { ([(header::CONTENT_TYPE, media_type)], bytes) }
    };
    serve(Router::new().route(path.split('?').next().unwrap_or(path), get(answer))).await
}

/// Measures both servers in turns, and prints the medians.
async fn compare(title: &str, ours: SocketAddr, bare: SocketAddr, path: &'static str, rounds: usize) {
    let mut columns: [Vec<f64>; 3] = Default::default();
    for _ in 0..rounds {
        let (ours, bare) = (rate(ours, path).await, rate(bare, path).await);
        for (column, value) in columns.iter_mut().zip([ours, bare, ours / bare]) {
            column.push(value);
        }
    }
    let [ours, bare, ratio] = columns.map(|mut column| {
        column.sort_by(f64::total_cmp);
        column[rounds / 2]
    });
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

/// A bare axum server.
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
