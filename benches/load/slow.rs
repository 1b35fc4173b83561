//! Response times beside ten thousand connections that send nothing, or a byte now and then.

use std::fmt::Write;
use std::io;
use std::net::SocketAddr;
use std::time::Duration;

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::task::JoinHandle;
use tokio::time::{sleep, timeout};

use crate::client::{ask, median};
use crate::program::Program;

const SLOW: u64 = 10_000;
const ROUND: Duration = Duration::from_secs(10);
const ROUNDS: usize = 3;
const TARGET: &str = "/v1/trajectories?preset=case-1&bounces=100";

pub(crate) async fn measure(short: bool) -> io::Result<String> {
    let (rounds, round_time) = if short { (1, ROUND / 5) } else { (ROUNDS, ROUND) };
    let mut text = format!(
        "### Slow and silent connections\n\n{SLOW} connections. Every second one is silent; the others send a byte of a head every five \
         seconds. Connections that the server closes\nare opened again. Beside them 8 clients send 100 requests a second each for \
         `{TARGET}`,\nanswered from memory, on persistent connections (`--only slow`).\n\n\
         | round | p50 alone | p99 alone | p50 beside them | p99 beside them | ratio of p99 | server CPU for slow connections | server memory |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let server = Program::start()?;
    let others = async || ask(server.address, TARGET, 8, round_time, Duration::from_millis(9)).await;
    let mut ratios = Vec::new();
    for round in 1..=rounds {
        let begin_s = server.cpu_s();
        let mut before = others().await?;
        let alone_s = server.cpu_s() - begin_s;
        let slow: Vec<JoinHandle<()>> = (0..SLOW).map(|index| tokio::spawn(be_slow(server.address, index))).collect();
        sleep(Duration::from_secs(10)).await;
        let begin_s = server.cpu_s();
        let mut beside = others().await?;
        let cpu = (server.cpu_s() - begin_s - alone_s) / round_time.as_secs_f64();
        let memory = server.memory_mib();
        slow.iter().for_each(JoinHandle::abort);
        sleep(Duration::from_secs(3)).await;
        let [[p50, p99], [beside_p50, beside_p99]] =
            [&mut before, &mut beside].map(|times| [0.5, 0.99].map(|share| times.quantile(share)));
        if before.refused() + beside.refused() > 0 {
            return Err(io::Error::other("a request was refused"));
        }
        let ratio = beside_p99 / p99;
        ratios.push(ratio);
        let _ = writeln!(
            text,
            "| {round} | {p50:.2} ms | {p99:.2} ms | {beside_p50:.2} ms | {beside_p99:.2} ms | {ratio:.2} | {:.0} % of a core | {memory:.0} MiB |",
            100.0 * cpu
        );
    }
    let _ = writeln!(text, "\nMedian ratio of p99: {:.2}.\n", median(ratios));
    Ok(text)
}

/// Holds a connection open for as long as the server allows.
pub(crate) async fn be_slow(address: SocketAddr, index: u64) {
    // Not all at once: that would measure the rate of new connections.
    sleep(Duration::from_micros(500 * index)).await;
    loop {
        if let Ok(mut socket) = TcpStream::connect(address).await {
            let head = b"GET / HTTP/1.1\r\nhost: localhost\r\nx-slow: ".iter().chain(std::iter::repeat(&b'x'));
            let mut sent = head.take_while(|_| index.is_multiple_of(2));
            let mut buffer = [0; 1024];
            // Until the server closes it.
            loop {
                match timeout(Duration::from_secs(5), socket.read(&mut buffer)).await {
                    Ok(Ok(0) | Err(_)) => break,
                    Ok(Ok(_)) => {}
                    Err(_) => {
                        if let Some(byte) = sent.next()
                            && socket.write_all(&[*byte]).await.is_err()
                        {
                            break;
                        }
                    }
                }
            }
        }
        sleep(Duration::from_millis(100)).await;
    }
}
