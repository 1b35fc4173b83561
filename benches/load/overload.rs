//! Response times of a server whose queue is full: refusals, and requests that still get through.

use std::fmt::Write;
use std::io;
use std::time::{Duration, Instant};

use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;
use tokio::time::sleep;

use crate::client::{Connection, Times};
use crate::program::Program;

const LOOKS: usize = 1000;

/// A request that takes some 20 s of all cores.
const DEAR: &str = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=0.95&x.to=1.6&x.count=1000\
                    &y.field=release.theta&y.from=0&y.to=0.5&y.count=1000&bounces=2000";

pub(crate) async fn measure(short: bool) -> io::Result<String> {
    let looks = if short { LOOKS / 10 } else { LOOKS };
    let mut text = format!(
        "### Overload\n\nOne client requests more and more expensive regions until it gets 503. Then each of these requests is sent {looks} times, \
         in turns\n(`--only overload`). The server keeps no answers (`--answer-cache 0`), so that equal requests are computed each.\n\n| | status | p50 | p99 | most |\n|---|---|---|---|---|\n",
    );
    let server = Program::start_with(&["--answer-cache", "0"])?;
    let mut held = Vec::new();
    let mut asking = Connection::open(server.address).await?;
    let request = format!("GET {DEAR} HTTP/1.1\r\nhost: localhost\r\n\r\n");
    while held.len() < 64 {
        let mut socket = TcpStream::connect(server.address).await?;
        socket.write_all(request.as_bytes()).await?;
        held.push(socket);
    }
    sleep(Duration::from_secs(1)).await;
    for target in [DEAR, "/health/ready", "/metrics", "/v1/trajectories?preset=case-1&bounces=100"] {
        let (mut times, mut most, mut status) = (Times::default(), 0.0_f64, 0);
        for _ in 0..looks {
            let begin = Instant::now();
            status = asking.get(target).await?.status;
            times.add(begin);
            most = most.max(begin.elapsed().as_secs_f64() * 1e3);
            sleep(Duration::from_millis(2)).await;
        }
        let [p50, p99] = [0.5, 0.99].map(|share| times.quantile(share));
        let name = target.split('&').next().unwrap_or_default();
        let _ = writeln!(text, "| `{name}…` | {status} | {p50:.2} ms | {p99:.2} ms | {most:.1} ms |");
    }
    drop(held);
    Ok(text + "\n")
}
