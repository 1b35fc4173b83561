//! Live runs as Server-Sent Events over real sockets: the same run as over a WebSocket, complete after a reconnect.
//!
//! Wall-clock times are never asserted. The messages of a run are tested in `live.rs`.

use std::net::SocketAddr;
use std::time::Duration;

use crate::support::contract;
use crate::support::socket::{Row, SOON, held, impacts_in, now_ms, numbers, open, start};
use equipoise::api::App;
use equipoise::compute::Peer;
use equipoise::limits;
use serde_json::{Value, json};
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::net::TcpStream;
use tokio::time::{sleep, timeout};

/// An HTTP/1.0 answer, which ends with the connection.
struct Answer {
    head: String,
    body: BufReader<TcpStream>,
}

async fn get(address: SocketAddr, url: &str, headers: &str) -> Answer {
    send(address, format!("GET {url} HTTP/1.0\r\nhost: {address}\r\n{headers}\r\n").as_bytes()).await
}

async fn send(address: SocketAddr, request: &[u8]) -> Answer {
    let mut socket = TcpStream::connect(address).await.unwrap();
    socket.write_all(request).await.unwrap();
    let (mut head, mut body) = (String::new(), BufReader::new(socket));
    while !head.ends_with("\r\n\r\n") {
        assert!(timeout(SOON, body.read_line(&mut head)).await.expect("an answer").unwrap() > 0, "{head}");
    }
    let mut lines = head.lines();
    let status = lines.next().and_then(|line| line.split(' ').nth(1)).expect("a status");
    let headers = lines.filter_map(|line| line.split_once(": "));
    let headers = headers.map(|(name, value)| (name.to_ascii_lowercase(), value.to_owned())).collect();
    contract::hold_head("/v1/live/events", status, &headers);
    Answer { head: head.to_ascii_lowercase(), body }
}

/// One event: id and message.
#[derive(Debug)]
struct Event {
    id: Option<String>,
    message: Value,
}

impl Answer {
    /// The next event; `None` at the end of the stream.
    async fn event(&mut self) -> Option<Event> {
        let (mut id, mut kind, mut message) = (None, None, None);
        loop {
            let mut line = String::new();
            if timeout(SOON, self.body.read_line(&mut line)).await.expect("the server is silent").unwrap() == 0 {
                return None;
            }
            let line = line.strip_suffix('\n').unwrap();
            if let Some(message) = message.take_if(|_| line.is_empty()) {
                let message: Value = message;
                assert_eq!(message["type"], kind.unwrap_or_default());
                return Some(Event { id, message });
            }
            match line.split_once(": ") {
                Some(("id", text)) => id = Some(text.to_owned()),
                Some(("event", text)) => kind = Some(text.to_owned()),
                Some(("data", text)) => message = Some(held(text)),
                Some(("retry", text)) => assert_eq!(text.parse::<u128>(), Ok(limits::LIVE_RETRY_TIME.as_millis())),
                _ => assert!(line.is_empty() || line.starts_with(':'), "{line}"),
            }
        }
    }

    /// At least `count` impacts and the last id; fewer if the run ends.
    async fn impacts(&mut self, count: usize) -> (Vec<Row>, String) {
        let (mut rows, mut last) = (vec![], String::new());
        while rows.len() < count
            && let Some(Event { id, message }) = self.event().await
        {
            let more = impacts_in(&message);
            if let Some(row) = more.last() {
                assert_eq!(id, Some(row["n"].to_string()));
            }
            rows.extend(more);
            last = id.unwrap_or(last);
        }
        (rows, last)
    }

    async fn problem(mut self) -> Value {
        let mut text = String::new();
        timeout(SOON, self.body.read_to_string(&mut text)).await.expect("a whole answer").unwrap();
        let problem: Value = serde_json::from_str(&text).unwrap();
        let faults = contract::faults(&json!({"$ref": "#/components/schemas/Problem"}), &problem);
        assert!(faults.is_empty(), "{faults:?} in {text}");
        assert!(self.head.starts_with(&format!("http/1.0 {} ", problem["status"])), "{}", self.head);
        assert!(self.head.contains("content-type: application/problem+json"));
        problem
    }
}

/// A query for a preset that was released some seconds ago.
fn old(preset: &str, seconds: u64) -> String {
    format!("preset={preset}&epoch_ms={}", now_ms() - 1000 * seconds)
}

async fn no_sessions(app: &App) {
    timeout(SOON, async {
        while app.metrics.live_sessions.get() > 0 {
            sleep(Duration::from_millis(5)).await;
        }
    })
    .await
    .expect("the session goes on for nobody");
}

#[tokio::test]
async fn events_are_what_the_websocket_says() {
    let (app, address) = start().await;
    let query = old("case-1", 60);
    let mut socket = open(address, &format!("/v1/live?{query}&from=1")).await;
    let mut hello = socket.next().await;
    let mut events = get(address, &format!("/v1/live/events?{query}&from=1"), "accept: text/event-stream\r\n").await;
    assert!(events.head.starts_with("http/1.0 200") && events.head.contains("content-type: text/event-stream"));
    let first = events.event().await.unwrap();
    assert_eq!(first.id, None);
    for name in ["now_ms", "run_time"] {
        hello[name] = first.message[name].clone();
    }
    assert_eq!(first.message, hello);
    let (rows, _) = events.impacts(100).await;
    assert_eq!(numbers(&rows), (1..=rows.len() as u64).collect::<Vec<_>>());
    assert_eq!(rows[..100], socket.impacts(100).await);
    assert_eq!(app.metrics.live_sessions.get(), 2);
    drop((socket, events));
    no_sessions(&app).await;
}

#[tokio::test]
async fn a_client_that_comes_back_misses_nothing_and_hears_nothing_twice() {
    let (_, address) = start().await;
    let url = format!("/v1/live/events?{}&from=1&speed=10", old("case-1", 5));
    let mut whole = get(address, &url, "").await;
    let (mut rows, mut last) = get(address, &url, "").await.impacts(3).await;
    for turn in 0..4 {
        // The header outranks the parameter, and both outrank `from`.
        let (url, header) = match turn % 2 {
            0 => (format!("{url}&after=1"), format!("last-event-id: {last}\r\n")),
            _ => (format!("{url}&after={last}"), "last-event-id: \r\n".to_owned()),
        };
        let more = get(address, &url, &header).await.impacts(5).await;
        rows.extend(more.0);
        last = more.1;
    }
    assert_eq!(numbers(&rows), (1..=rows.len() as u64).collect::<Vec<_>>());
    assert_eq!(last, rows.len().to_string());
    let (all, _) = whole.impacts(rows.len()).await;
    assert_eq!(all[..rows.len()], rows);
}

#[tokio::test]
async fn a_contact_after_the_bounces_comes_before_the_end() {
    let (_, address) = start().await;
    let url = format!("/v1/live/events?{}&scene.contact.restitution=0.1&hold=0.1", old("still-lossy", 60));
    let mut whole = get(address, &format!("{url}&from=1"), "").await;
    let mut events = vec![];
    while let Some(event) = whole.event().await {
        events.push(event);
    }
    let kinds = |events: &[Event]| events.iter().map(|one| one.message["type"].clone()).collect::<Vec<_>>();
    assert_eq!(kinds(&events), ["hello", "impacts", "hold", "end"]);
    assert_eq!((&events[2].id, events[3].id.as_deref()), (&None, Some("end")));
    let [hold, end] = [&events[2].message, &events[3].message];
    assert_eq!(hold["columns"]["t"].as_array().unwrap().last(), Some(&end["hold_end"]["t"]));
    // A client that has the last impact gets the contact again, and the end.
    let mut again = get(address, &url, &format!("last-event-id: {}\r\n", events[1].id.as_ref().unwrap())).await;
    again.event().await.unwrap();
    for known in [hold, end] {
        assert_eq!(&again.event().await.unwrap().message, known);
    }
    assert!(again.event().await.is_none());
}

#[tokio::test]
async fn a_run_that_has_ended_is_over() {
    let (app, address) = start().await;
    let url = format!("/v1/live/events?{}&from=1", old("case-3", 3600));
    for (header, impacts) in [("", 49), ("last-event-id: 40\r\n", 9), ("last-event-id: 49\r\n", 0)] {
        let mut events = get(address, &url, header).await;
        let (rows, last) = events.impacts(usize::MAX).await;
        assert_eq!((rows.len(), last.as_str()), (impacts, "end"), "{header}");
    }
    let mut over = get(address, &url, "last-event-id: end\r\n").await;
    assert!(over.head.starts_with("http/1.0 204"), "{}", over.head);
    assert_eq!(over.body.read_to_end(&mut vec![]).await.unwrap(), 0);
    no_sessions(&app).await;
}

#[tokio::test]
async fn an_id_that_is_none_is_refused() {
    let (app, address) = start().await;
    let query = old("case-1", 5);
    for id in ["x", "-1", "0", "1.5", "10000001", "99999999999999999999999", "end ", "END", "1@2", "%00", "1,2"] {
        let url = format!("/v1/live/events?{query}&after={}", id.replace(' ', "%20"));
        let problem = get(address, &url, "").await.problem().await;
        assert_eq!((&problem["status"], &problem["errors"][0]["pointer"]), (&422.into(), &"/after".into()), "{id}");
    }
    let raw =
        [format!("GET /v1/live/events?{query} HTTP/1.0\r\nlast-event-id: ").as_bytes(), b"\xff\xfe\r\n\r\n"].concat();
    let problem = send(address, &raw).await.problem().await;
    assert_eq!(problem["errors"][0]["pointer"], "/after");
    // Without an epoch this would be another run, released now.
    let problem = get(address, "/v1/live/events?preset=case-1", "last-event-id: 5\r\n").await.problem().await;
    assert!(problem["errors"][0]["detail"].as_str().unwrap().contains("epoch"), "{problem}");
    assert_eq!(app.metrics.live_sessions.get(), 0);
}

#[tokio::test]
async fn what_is_no_run_or_not_to_be_had_is_a_problem() {
    let (app, address) = start().await;
    let status = async |query: &str, headers: &str| {
        get(address, &format!("/v1/live/events?{query}"), headers).await.problem().await["status"].as_u64().unwrap()
    };
    assert_eq!(status("preset=case-9", "").await, 422);
    assert_eq!(status("preset=case-1&epoch_ms=0&from=1", "").await, 422, "too old to catch up with");
    assert_eq!(status("preset=case-1", "accept: application/json\r\n").await, 406);
    assert_eq!(status("preset=case-1&format=csv", "").await, 406);
    assert_eq!(status("preset=case-1", "origin: http://elsewhere.example\r\n").await, 403);
    let post = format!("POST /v1/live/events HTTP/1.0\r\nhost: {address}\r\ncontent-length: 0\r\n\r\n");
    assert_eq!(send(address, post.as_bytes()).await.problem().await["status"], 405);
    assert_eq!(app.metrics.live_sessions.get(), 0);
    let home = Peer::at([127, 0, 0, 1].into());
    let _all: Vec<_> = std::iter::from_fn(|| app.live_quota.try_reserve(home).ok()).collect();
    assert_eq!(status("preset=case-1", "").await, 503);
}

#[tokio::test]
async fn head_opens_no_run() {
    let (app, address) = start().await;
    let request = "HEAD /v1/live/events?preset=case-1 HTTP/1.0\r\n\r\n";
    let mut head = send(address, request.as_bytes()).await;
    assert!(head.head.starts_with("http/1.0 200") && head.head.contains("text/event-stream"), "{}", head.head);
    assert_eq!(head.body.read_to_end(&mut vec![]).await.unwrap(), 0);
    no_sessions(&app).await;
}

#[tokio::test]
async fn a_server_that_closes_ends_the_events() {
    let (app, address) = start().await;
    let mut events = get(address, "/v1/live/events?preset=case-1&speed=10", "").await;
    events.impacts(2).await;
    app.close();
    while events.event().await.is_some() {}
    no_sessions(&app).await;
    // During a shutdown a late client is accepted and closed: a browser would take a refusal for the end of the run.
    let mut late = get(address, "/v1/live/events?preset=case-1", "").await;
    assert!(late.head.starts_with("http/1.0 200"), "{}", late.head);
    assert_eq!(late.event().await.expect("it says which run it is").message["type"], "hello");
    while late.event().await.is_some() {}
}
