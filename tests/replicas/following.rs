//! Clients that follow a live run over several connections and keep all messages.

use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use serde_json::Value;
use tokio::task::JoinHandle;
use tokio::time::sleep;
use tokio_tungstenite::tungstenite::Error;

use crate::asking::{Ask, begin};
use crate::support::socket::{Row, held, impacts_in, try_open};

/// Transport of a client.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Over {
    WebSocket,
    Events,
}

/// Everything that a client received.
#[derive(Debug)]
pub(crate) struct Heard {
    pub(crate) rows: Vec<Row>,
    /// Connections that broke or were closed.
    pub(crate) breaks: usize,
    /// Reconnects that were answered with 503.
    pub(crate) refused: usize,
    /// Longest time without an impact.
    pub(crate) silence: Duration,
    last: Instant,
}

/// A client that reconnects until it is dropped.
pub(crate) struct Follower {
    heard: Arc<Mutex<Heard>>,
    task: JoinHandle<()>,
}

impl Follower {
    /// Follows a run from its first impact.
    pub(crate) fn start(address: SocketAddr, query: &str, over: Over) -> Self {
        let (rows, silence, last) = (Vec::new(), Duration::ZERO, Instant::now());
        let heard = Arc::new(Mutex::new(Heard { rows, breaks: 0, refused: 0, silence, last }));
        let (keep, query) = (heard.clone(), query.to_owned());
        let task = tokio::spawn(async move {
            loop {
                match over {
                    Over::WebSocket => listen(address, &query, &keep).await,
                    Over::Events => follow(address, &query, &keep).await,
                }
                sleep(Duration::from_millis(20)).await;
            }
        });
        Self { heard, task }
    }

    pub(crate) fn heard(&self) -> MutexGuard<'_, Heard> {
        self.heard.lock().unwrap()
    }

    pub(crate) fn count(&self) -> usize {
        self.heard().rows.len()
    }

    /// True while it listens. It stops after an error.
    pub(crate) fn is_well(&self) -> bool {
        !self.task.is_finished()
    }
}

impl Drop for Follower {
    fn drop(&mut self) {
        self.task.abort();
    }
}

fn keep(heard: &Mutex<Heard>, message: &Value) {
    let mut heard = heard.lock().unwrap();
    for row in impacts_in(message) {
        heard.silence = heard.silence.max(heard.last.elapsed());
        heard.last = Instant::now();
        heard.rows.push(row);
    }
}

/// Number of the last impact received.
fn last(heard: &Mutex<Heard>) -> u64 {
    heard.lock().unwrap().rows.last().map_or(0, |row| row["n"].as_u64().unwrap())
}

/// One WebSocket, from the next impact on.
async fn listen(address: SocketAddr, query: &str, heard: &Mutex<Heard>) {
    let url = format!("/v1/live?{query}&from={}", last(heard) + 1);
    match try_open(address, &url, &[]).await {
        Ok((mut client, _)) => {
            while let Ok(message) = client.hear().await {
                assert_ne!(message["type"], "problem", "{message}");
                keep(heard, &message);
            }
            heard.lock().unwrap().breaks += 1;
        }
        Err(Error::Http(response)) => refused(response.status().as_u16(), heard),
        Err(other) => panic!("{url}: {other}"),
    }
}

/// One event stream, with reconnection as in browsers.
async fn follow(address: SocketAddr, query: &str, heard: &Mutex<Heard>) {
    let ask = Ask::get(format!("/v1/live/events?{query}&from=1")).with("accept", "text/event-stream");
    let ask = match last(heard) {
        0 => ask,
        last => ask.with("last-event-id", &last.to_string()),
    };
    let mut answer = begin(address, &ask).await.expect("nginx answers");
    if answer.status != 200 {
        return refused(answer.status, heard);
    }
    let mut text = Vec::new();
    while let Ok(Some(piece)) = answer.piece().await {
        text.extend(piece);
        while let Some(end) = text.windows(2).position(|pair| pair == b"\n\n") {
            let event = String::from_utf8(text.drain(..end + 2).collect()).unwrap();
            if let Some(message) = event.lines().find_map(|line| line.strip_prefix("data: ")) {
                keep(heard, &held(message));
            }
        }
    }
    heard.lock().unwrap().breaks += 1;
}

fn refused(status: u16, heard: &Mutex<Heard>) {
    assert_eq!(status, 503);
    heard.lock().unwrap().refused += 1;
}
