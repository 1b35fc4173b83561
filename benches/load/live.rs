//! Delay of impacts on many live clients.

use std::fmt::Write;
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use futures_util::StreamExt;
use tokio::net::TcpStream;
use tokio::time::sleep;
use tokio_tungstenite::client_async_with_config;
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;
use tokio_tungstenite::tungstenite::{Error, Message};

use crate::client::Times;
use crate::program::Program;

const TIME: Duration = Duration::from_secs(20);

pub(crate) async fn measure(short: bool) -> io::Result<String> {
    let time = if short { TIME / 10 } else { TIME };
    let mut text = format!(
        "### Live runs\n\nRuns of case 1 over WebSockets, released one after the other, watched for {} s (`--only live`). p50, p99 and \
         p99.9 are delays from\nthe moment of an impact to its arrival at the client, which includes the clients' own use of the cores.\n\n\
         | clients | speed | impacts per second | p50 | p99 | p99.9 | server CPU | server memory |\n|---|---|---|---|---|---|---|---|\n",
        time.as_secs(),
    );
    for (clients, speed) in [(1, 1), (1000, 1), (1000, 5)] {
        let server = Program::start()?;
        let counts = Arc::new(AtomicBool::new(false));
        let watching: Vec<_> =
            (0..clients).map(|index| tokio::spawn(watch(server.address, index, speed, counts.clone()))).collect();
        // All clients are connected and have received their first impacts.
        sleep(Duration::from_secs(6)).await;
        let (begin, before) = (Instant::now(), server.cpu_s());
        counts.store(true, Ordering::Relaxed);
        sleep(time).await;
        counts.store(false, Ordering::Relaxed);
        let (cpu, memory) = ((server.cpu_s() - before) / begin.elapsed().as_secs_f64(), server.memory_mib());
        drop(server);
        let mut late = Times::default();
        for client in watching {
            late.append(client.await.expect("no client panics").map_err(io::Error::other)?);
        }
        let rate = late.count() as f64 / time.as_secs_f64();
        let [p50, p99, p999] = [0.5, 0.99, 0.999].map(|share| late.quantile(share));
        let _ = writeln!(
            text,
            "| {clients} | {speed} | {rate:.0} | {p50:.1} ms | {p99:.1} ms | {p999:.1} ms | {:.0} % of a core | {memory:.0} MiB |",
            100.0 * cpu
        );
    }
    Ok(text + "\n")
}

/// Watches a run until the server is gone. Counts impacts while `counts` is set.
async fn watch(address: SocketAddr, index: u64, speed: u32, counts: Arc<AtomicBool>) -> Result<Times, Error> {
    // Clients arrive over the first seconds.
    sleep(Duration::from_millis(4 * index)).await;
    let url = format!("ws://{address}/v1/live?preset=case-1&speed={speed}");
    let config = WebSocketConfig::default().read_buffer_size(4096);
    let (mut socket, _) = client_async_with_config(url, TcpStream::connect(address).await?, Some(config)).await?;
    let (mut epoch_ms, mut late) = (0.0, Times::default());
    while let Some(Ok(message)) = socket.next().await {
        let Message::Text(text) = message else { continue };
        let now_ms = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64() * 1e3;
        if text.starts_with(r#"{"type":"hello""#) {
            epoch_ms = numbers_after(&text, r#""epoch_ms":"#).next().expect("a hello says when the run began");
        } else if counts.load(Ordering::Relaxed) {
            for t in numbers_after(&text, r#""t":"#) {
                late.add_ms(now_ms - (epoch_ms + 1e3 * t / f64::from(speed)));
            }
        }
    }
    Ok(late)
}

/// The number or list of numbers after a name. Parsing the whole JSON would take longer than the delay that is measured.
fn numbers_after(text: &str, name: &str) -> impl Iterator<Item = f64> {
    let rest = text.split_once(name).map_or("", |(_, rest)| rest);
    let end = if rest.starts_with('[') { rest.find(']') } else { rest.find([',', '}']) };
    rest[..end.unwrap_or_default()].trim_start_matches('[').split(',').filter_map(|number| number.parse().ok())
}
