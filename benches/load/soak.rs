//! Mixed load for hours: growth of memory, and every answer but an intended 503 correct.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::io;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use futures_util::StreamExt;
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;
use tokio::task::JoinHandle;
use tokio::time::{sleep, timeout};
use tokio_tungstenite::client_async;

use crate::client::{Connection, Times};
use crate::program::{Program, load_average};
use crate::slow::be_slow;

const ASKING: u64 = 16;
const LIVE: u64 = 200;
const LEAVING: u64 = 4;
const SLOW: u64 = 500;

/// Response times and outcomes of all clients.
#[derive(Default)]
struct Book {
    statuses: BTreeMap<String, u64>,
    times: Times,
}

type Shared = Arc<Mutex<Book>>;

pub(crate) async fn measure(time: Duration) -> io::Result<String> {
    let server = Program::start()?;
    let address = server.address;
    let book = Shared::default();
    let mut tasks: Vec<JoinHandle<()>> = Vec::new();
    tasks.extend((0..ASKING).map(|index| tokio::spawn(ask_for_anything(address, index, book.clone()))));
    tasks.extend((0..LIVE).map(|index| tokio::spawn(watch(address, index, book.clone()))));
    tasks.extend((0..LEAVING).map(|index| tokio::spawn(leave(address, index))));
    tasks.extend((0..SLOW).map(|index| tokio::spawn(be_slow(address, index))));
    let warm = (time / 10).min(Duration::from_secs(60));
    sleep(warm).await;
    let (begin, cpu) = (server.memory_mib(), server.cpu_s());
    let start = Instant::now();
    // Memory goes up and down with the answers under way, so only means show growth.
    let mut tenths = [0.0; 10];
    for mean in &mut tenths {
        const LOOKS: u32 = 60;
        for _ in 0..LOOKS {
            sleep((time - warm) / 10 / LOOKS).await;
            *mean += server.memory_mib() / f64::from(LOOKS);
        }
    }
    let growth = tenths[7..].iter().sum::<f64>() / tenths[..3].iter().sum::<f64>() - 1.0;
    let cpu = (server.cpu_s() - cpu) / start.elapsed().as_secs_f64();
    tasks.iter().for_each(JoinHandle::abort);
    // After all clients have left, no work is under way.
    sleep(Duration::from_secs(2)).await;
    let metrics = Connection::open(address).await?.get("/metrics").await?;
    let metrics = String::from_utf8_lossy(&metrics.body).into_owned();
    let left: Vec<&str> = ["jobs_running ", "jobs_queued ", "live_sessions "]
        .iter()
        .filter_map(|name| metrics.lines().find_map(|line| line.strip_prefix("equipoise_")?.strip_prefix(name)))
        .collect();
    let kept: f64 = metrics
        .lines()
        .find_map(|line| line.strip_prefix("equipoise_answer_cache_bytes ")?.parse().ok())
        .unwrap_or(f64::NAN);
    let mut book = std::mem::take(&mut *book.lock().expect("nobody panics with it"));
    let mut text = format!(
        "### Mixed load\n\nFor {:.0} minutes {ASKING} clients send requests of all kinds and prices, half of them new, {LIVE} watch live runs for a while \
         each, {LEAVING} hang up in the\nmiddle of expensive answers, and {SLOW} connections are slow or silent (`--only soak --minutes {:.0}`). \
         The load average was {}.\n\n",
        time.as_secs_f64() / 60.0,
        time.as_secs_f64() / 60.0,
        load_average(),
    );
    let _ = writeln!(
        text,
        "- Memory: {begin:.0} MiB after {:.0} s; means over each tenth of the time {} MiB; from the first three to the last three \
         {:+.1} %. CPU {:.0} % of a core.\n- Answers kept in memory at the end: {:.0} MiB.",
        warm.as_secs_f64(),
        tenths.map(|mean| format!("{mean:.0}")).join(", "),
        100.0 * growth,
        100.0 * cpu,
        kept / 1_048_576.0,
    );
    let [p50, p99] = [0.5, 0.99].map(|share| book.times.quantile(share));
    let _ = writeln!(text, "- Response times: p50 {p50:.1} ms, p99 {p99:.0} ms.");
    let ends: Vec<String> = book.statuses.iter().map(|(name, count)| format!("{count} × {name}")).collect();
    let _ = writeln!(text, "- Outcomes: {}.", ends.join(", "));
    let _ = writeln!(text, "- Two seconds after all clients had left: running, waiting and live {}.", left.join(", "));
    Ok(text + "\n")
}

/// A request of a kind, by number.
fn target(number: u64) -> String {
    // Half of the scenes are new, and computed. The others have been asked for before, and are in memory.
    const KNOWN: u64 = 997;
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let draw = if number.is_multiple_of(2) { number } else { number % KNOWN };
    let gain = 1.0 + 0.5 * (draw as f64 * GOLDEN).fract();
    let scene = format!("preset=case-1&scene.table.tilt_gain={gain}");
    match number % 9 {
        0 => format!("/v1/trajectories?{scene}&bounces=100"),
        1 => format!("/v1/stability?{scene}"),
        2 => format!("/v1/stability?{scene}&format=png"),
        3 => format!("/v1/jacobians?{scene}"),
        4 => format!("/v1/ensembles?{scene}&scene.noise.timing_sd=0.001&runs=50&bounces=100"),
        5 => format!("/v1/trajectories?{scene}&bounces=10000"),
        6 => region(&scene, 60),
        7 => "/v1/scenes".to_owned(),
        _ => format!("/v1/trajectories?{scene}&bounces=0"),
    }
}

fn region(scene: &str, side: u32) -> String {
    format!(
        "/v1/regions?{scene}&x.field=contact.restitution&x.from=0.2&x.to=0.9&x.count={side}\
         &y.field=release.theta&y.from=0&y.to=0.5&y.count={side}&bounces=200"
    )
}

async fn ask_for_anything(address: SocketAddr, index: u64, book: Shared) {
    let mut number = 1000 * index;
    loop {
        // A new connection now and then.
        let Ok(mut connection) = Connection::open(address).await else { continue };
        for _ in 0..50 {
            number += 1;
            let target = target(number);
            let begin = Instant::now();
            let answer = timeout(Duration::from_secs(60), connection.get(&target)).await;
            let mut book = book.lock().expect("nobody panics with it");
            book.times.add(begin);
            let end = match answer {
                Ok(Ok(answer)) if target.ends_with("bounces=0") && answer.status == 422 => "422 as expected".to_owned(),
                Ok(Ok(answer)) => answer.status.to_string(),
                Ok(Err(error)) => format!("broken connection ({error})"),
                Err(_) => "no answer in a minute".to_owned(),
            };
            let is_broken = !end.starts_with(|first: char| first.is_ascii_digit());
            *book.statuses.entry(end).or_default() += 1;
            if is_broken {
                break;
            }
        }
        sleep(Duration::from_millis(10)).await;
    }
}

/// Watches one run after the other for a while.
async fn watch(address: SocketAddr, index: u64, book: Shared) {
    let mut number = index;
    loop {
        sleep(Duration::from_millis(20 * (number % 100))).await;
        number += LIVE;
        let speed = 1 + number % 5;
        let Ok(stream) = TcpStream::connect(address).await else { continue };
        let end = match client_async(format!("ws://{address}/v1/live?preset=case-1&speed={speed}"), stream).await {
            Err(error) => format!("refused live run ({error})"),
            Ok((mut socket, _)) => {
                let told = async { while let Some(Ok(_)) = socket.next().await {} };
                match timeout(Duration::from_secs(5 + number % 20), told).await {
                    Ok(()) => "live run that the server ended".to_owned(),
                    Err(_) => "live run".to_owned(),
                }
            }
        };
        *book.lock().expect("nobody panics with it").statuses.entry(end).or_default() += 1;
    }
}

/// Requests expensive work and hangs up before the answer.
async fn leave(address: SocketAddr, index: u64) {
    loop {
        if let Ok(mut socket) = TcpStream::connect(address).await {
            let request = format!("GET {} HTTP/1.1\r\nhost: localhost\r\n\r\n", region("preset=case-1", 1000));
            let _ = socket.write_all(request.as_bytes()).await;
            sleep(Duration::from_millis(500 + 100 * index)).await;
        }
        sleep(Duration::from_secs(2)).await;
    }
}
