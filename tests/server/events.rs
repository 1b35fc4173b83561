//! Live runs as Server-Sent Events over real sockets: the same run as over a WebSocket, complete after a reconnect.
//!
//! Wall-clock times are never asserted. The messages of a run are tested in `live.rs`.

use std::collections::BTreeSet;
use std::net::SocketAddr;
use std::time::Duration;

use clap::Parser;
use equipoise::api::App;
use equipoise::compute::Peer;
use equipoise::config::Config;
use equipoise::limits;
use serde_json::{Value, json};
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::net::TcpStream;
use tokio::time::{sleep, timeout};

use crate::support::socket::{
    Row, SOON, held, impacts_in, no_run, now_ms, numbers, open, refused, start, start_with, try_open,
};
use crate::support::{Server, contract};

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

// Live runs for programs that pass them on: dates and columns of impacts, and addresses that are not valid runs.

fn dates(rows: &[Row]) -> Vec<u64> {
    rows.iter().map(|row| row["time_ms"].as_u64().unwrap()).collect()
}

#[tokio::test]
async fn an_impact_has_the_date_of_its_trajectory_and_comes_then() {
    let (_, address) = start().await;
    let epoch = now_ms() - 20_000;
    let query = format!("preset=case-5&epoch_ms={epoch}");
    let run = Server::start().get(&format!("/v1/trajectories?{query}&bounces=60")).await.json();
    let mut client = open(address, &format!("/v1/live?{query}&from=1")).await;
    let rows = client.impacts(60).await;
    for (place, row) in rows.iter().enumerate() {
        assert_eq!(row["time_ms"], run["impacts"]["time_ms"][place], "impact {}", place + 1);
    }
    // None of them is sent before its time.
    assert!(dates(&rows).into_iter().all(|date| date <= now_ms()));
}

#[tokio::test]
async fn dates_have_speeds_pauses_and_steps_in_them_and_the_url_replays_them() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1&speed=2").await;
    let hello = client.next().await;
    let mut seen = client.impacts(3).await;
    let pause = client.ask(json!({"type": "pause"})).await;
    let step = client.ask(json!({"type": "step"})).await;
    let (epoch, stepped_to) = (hello["epoch_ms"].as_u64().unwrap(), step["impact"].as_u64().unwrap() as usize);
    seen.extend(client.impacts(stepped_to - 3).await);
    // The clock that was paused shows the run time of the step when the step is made.
    assert_eq!(seen[stepped_to - 1]["time_ms"], step["now_ms"]);
    assert!(step["now_ms"].as_u64() >= pause["now_ms"].as_u64());
    for row in &seen[..stepped_to - 1] {
        let expected = epoch as f64 + 500.0 * row["t"].as_f64().unwrap();
        assert!((row["time_ms"].as_f64().unwrap() - expected).abs() <= 0.5, "{row:?} {expected}");
    }
    let resume = client.ask(json!({"type": "resume"})).await;
    seen.extend(client.impacts(4).await);
    let (at, from) = (resume["now_ms"].as_f64().unwrap(), resume["run_time"].as_f64().unwrap());
    for row in &seen[stepped_to..] {
        let expected = at + 500.0 * (row["t"].as_f64().unwrap() - from);
        assert!((row["time_ms"].as_f64().unwrap() - expected).abs() <= 0.5, "{row:?} {expected}");
    }
    let mut replay = open(address, &format!("{}&from=1", resume["url"].as_str().unwrap())).await;
    assert_eq!(replay.impacts(seen.len()).await, seen);
}

#[tokio::test]
async fn a_single_impact_has_the_columns_of_many() {
    let (_, address) = start().await;
    let query = format!("/v1/live?preset=case-1&epoch_ms={}", now_ms() - 10_000);
    let mut single = None;
    let mut client = open(address, "/v1/live?preset=case-2&speed=1").await;
    while single.is_none() {
        let message = client.next().await;
        single = (message["type"] == "impact").then_some(message);
    }
    let single = single.unwrap();
    let mut many = open(address, &format!("{query}&from=1")).await;
    let columns = loop {
        let message = many.next().await;
        if message["type"] == "impacts" {
            break message["columns"].clone();
        }
    };
    let members = impacts_in(&single).remove(0);
    assert!(members.values().all(|value| !value.is_object() && !value.is_array()), "{single}");
    let columns: BTreeSet<_> = columns.as_object().unwrap().keys().collect();
    assert!(members.keys().eq(columns), "{members:?}");
}

#[tokio::test]
async fn an_address_that_is_no_run_is_told_over_the_websocket() {
    let (app, address) = start().await;
    let server = Server::start();
    // All places are taken: none is needed for a problem.
    let home = Peer::at([127, 0, 0, 1].into());
    let _all: Vec<_> = std::iter::from_fn(|| app.live_quota.try_reserve(home).ok()).collect();
    for query in [
        "preset=case-9",
        "preset=case-1&speed=0&columns=wide",
        "preset=case-1&scene.table.tilt_gain=5000&interventions.0.impact=0",
        "preset=case-1&preset=case-2",
        "preset=%ff",
        "",
    ] {
        let problem = no_run(address, &format!("/v1/live?{query}")).await;
        let mut plain = server.get(&format!("/v1/live?{query}")).await.json();
        for name in ["status", "title", "detail"] {
            assert_eq!(problem[name], plain[name], "{query}");
        }
        let errors = plain["errors"].take();
        assert_eq!(problem["errors"], if errors.is_null() { json!([]) } else { errors }, "{query}");
    }
    assert_eq!(app.metrics.live_sessions.get(), 0);
    // A valid run needs a place, and the status says so.
    assert_eq!(refused(address, "/v1/live?preset=case-1", &[]).await["status"], 503);
}

/// A client that never answers the close, and one that goes on sending.
#[tokio::test]
async fn a_connection_without_a_run_ends_by_itself() {
    let (_, address) = start().await;
    for sends in [false, true] {
        let (mut client, _) = try_open(address, "/v1/live?preset=case-9", &[]).await.unwrap();
        let socket = client.socket.get_mut();
        let ended = timeout(SOON, async {
            // A text frame `{}` with the masking key 0.
            while sends && socket.write_all(&[0x81, 0x82, 0, 0, 0, 0, b'{', b'}']).await.is_ok() {
                tokio::time::sleep(Duration::from_millis(20)).await;
            }
            // A reset is an end too: the server has not read all that was sent.
            let _ = socket.read_to_end(&mut vec![]).await;
        });
        ended.await.expect("the connection stays open");
    }
}

#[tokio::test]
async fn only_a_page_that_may_ask_is_told_what_is_wrong_with_its_address() {
    let allowed = Config::parse_from(["equipoise", "--allow-origin", "http://notebook.lab:*"]);
    let (_, address) = start_with(&allowed).await;
    let wrong = "/v1/live?preset=case-9";
    for origin in ["http://elsewhere.example", "http://notebook.lab.example:8888", "https://notebook.lab:8888"] {
        assert_eq!(refused(address, wrong, &[("origin", origin)]).await["status"], 403, "{origin}");
    }
    for origin in ["http://notebook.lab", "http://notebook.lab:8888", "http://notebook.lab:8889"] {
        let (mut client, _) = try_open(address, wrong, &[("origin", origin)]).await.unwrap();
        assert_eq!(client.next().await["status"], 422, "{origin}");
    }
}
