//! A cheap HTTP/1.1 client, and statistics of its response times.

use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

/// A persistent connection.
pub(crate) struct Connection {
    socket: TcpStream,
    received: Vec<u8>,
}

/// An answer.
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Connection {
    pub(crate) async fn open(address: SocketAddr) -> io::Result<Self> {
        Self::over(TcpStream::connect(address).await?)
    }

    /// A connection over a connected socket.
    pub(crate) fn over(socket: TcpStream) -> io::Result<Self> {
        socket.set_nodelay(true)?;
        Ok(Self { socket, received: Vec::with_capacity(64 * 1024) })
    }

    /// Sends a request and reads the whole answer, whose length is in its head.
    pub(crate) async fn get(&mut self, target: &str) -> io::Result<Answer> {
        self.socket.write_all(format!("GET {target} HTTP/1.1\r\nhost: localhost\r\n\r\n").as_bytes()).await?;
        self.received.clear();
        let end = loop {
            if let Some(end) = self.received.windows(4).position(|window| window == b"\r\n\r\n") {
                break end + 4;
            }
            self.more().await?;
        };
        let head = String::from_utf8_lossy(&self.received[..end]).to_ascii_lowercase();
        let length = head.lines().find_map(|line| line.strip_prefix("content-length: ")?.parse::<usize>().ok());
        let length = length.ok_or_else(|| io::Error::other(format!("no length in {head}")))?;
        while self.received.len() < end + length {
            self.more().await?;
        }
        let status = head.get(9..12).and_then(|status| status.parse().ok()).unwrap_or_default();
        Ok(Answer { status, head, body: self.received.split_off(end) })
    }

    async fn more(&mut self) -> io::Result<()> {
        match self.socket.read_buf(&mut self.received).await? {
            0 => Err(io::ErrorKind::UnexpectedEof.into()),
            _ => Ok(()),
        }
    }
}

/// Response times of many requests, ms, and the number of those that were refused as too many.
#[derive(Default)]
pub(crate) struct Times(Vec<f64>, u64);

impl Times {
    pub(crate) fn add(&mut self, begin: Instant) {
        self.add_ms(begin.elapsed().as_secs_f64() * 1e3);
    }

    pub(crate) fn add_ms(&mut self, ms: f64) {
        self.0.push(ms);
    }

    pub(crate) fn append(&mut self, mut others: Self) {
        self.0.append(&mut others.0);
        self.1 += others.1;
    }

    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// Number of refusals, which have no time.
    pub(crate) fn refused(&self) -> u64 {
        self.1
    }

    /// Quantile of the times, ms.
    pub(crate) fn quantile(&mut self, share: f64) -> f64 {
        if self.0.is_empty() {
            return f64::NAN;
        }
        let place = (share * (self.0.len() - 1) as f64).round() as usize;
        *self.0.select_nth_unstable_by(place, f64::total_cmp).1
    }
}

/// Sends requests on `connections` connections for a while, each one `pause` after the answer to the last.
pub(crate) async fn ask(
    address: SocketAddr,
    target: &str,
    connections: usize,
    time: Duration,
    pause: Duration,
) -> io::Result<Times> {
    let begin = Instant::now();
    let clients: Vec<_> = (0..connections)
        .map(|_| {
            let target = target.to_owned();
            tokio::spawn(async move {
                let mut times = Times::default();
                let mut connection = Connection::open(address).await?;
                while begin.elapsed() < time {
                    let asked = Instant::now();
                    let answer = connection.get(&target).await?;
                    match answer.status {
                        200 => times.add(asked),
                        503 => times.1 += 1,
                        _ => return Err(io::Error::other(answer.head)),
                    }
                    if !pause.is_zero() {
                        tokio::time::sleep(pause).await;
                    }
                }
                Ok(times)
            })
        })
        .collect();
    let mut all = Times::default();
    for client in clients {
        all.append(client.await.expect("no client panics")?);
    }
    Ok(all)
}

/// Median.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
