//! HTTP/1.1 over real sockets: required headers, and clients that close their sending half.

mod support;

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use equipoise::api::App;
use equipoise::config::Config;
use support::socket::{SOON, start, start_with};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::{sleep, timeout};

/// A request that takes seconds of work.
const MAP: &str = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=0.95&x.to=1.6&x.count=1000\
                   &y.field=release.theta&y.from=0&y.to=0.5&y.count=1000&bounces=2000";

/// A smaller request, which still does not run inline.
const SHORT: &str = "/v1/stability?preset=case-1&bounces=2000";

async fn send(address: SocketAddr, request: &str) -> TcpStream {
    let mut socket = TcpStream::connect(address).await.unwrap();
    socket.write_all(request.as_bytes()).await.unwrap();
    socket
}

/// All bytes up to the end of a connection.
async fn whole(mut socket: TcpStream) -> String {
    let mut answer = Vec::new();
    let _ = timeout(SOON, socket.read_to_end(&mut answer)).await.expect("the server is silent");
    String::from_utf8_lossy(&answer).into_owned()
}

fn body(answer: &str) -> &str {
    answer.split_once("\r\n\r\n").unwrap_or_else(|| panic!("no head in {answer:?}")).1
}

/// The body of a chunked answer. A chunk size may begin with zeros.
fn unchunked(answer: &str) -> String {
    let (mut rest, mut whole) = (body(answer), String::new());
    loop {
        let (size, after) = rest.split_once("\r\n").unwrap();
        let size = usize::from_str_radix(size, 16).unwrap();
        if size == 0 {
            return whole;
        }
        whole.push_str(&after[..size]);
        rest = &after[size + 2..];
    }
}

#[tokio::test]
async fn a_request_says_once_under_which_name_it_asks() {
    let (_, address) = start().await;
    for (version, headers, status) in [
        ("1.1", "host: localhost\r\n", 200),
        ("1.1", "Host: 127.0.0.1:8080\r\n", 200),
        ("1.0", "", 200),
        ("1.0", "host: localhost\r\n", 200),
        ("1.1", "", 400),
        ("1.1", "host: localhost\r\nhost: localhost\r\n", 400),
        ("1.1", "host: localhost\r\nhost: evil.example\r\n", 400),
        ("1.0", "host: localhost\r\nhost: localhost\r\n", 400),
        ("1.1", "host:\r\n", 400),
        ("1.1", "host: a b\r\n", 400),
        ("1.1", "host: user@localhost\r\n", 400),
        ("1.1", "host: localhost:port\r\n", 400),
    ] {
        let answer =
            whole(send(address, &format!("GET /v1/scenes HTTP/{version}\r\n{headers}connection: close\r\n\r\n")).await)
                .await;
        assert!(answer.starts_with(&format!("HTTP/{version} {status} ")), "{headers:?}: {answer:.200}");
        if status == 400 {
            let problem: serde_json::Value = serde_json::from_str(body(&answer)).unwrap();
            assert!(problem["detail"].as_str().unwrap().contains("Host"), "{problem}");
        }
    }
}

#[tokio::test]
async fn a_transfer_coding_that_is_not_understood_is_501() {
    let (_, address) = start().await;
    let chunks = "10\r\n{\"preset\":\"case-\r\n3\r\n1\"}\r\n0\r\n\r\n";
    for (codings, status) in [
        ("transfer-encoding: chunked\r\n", 200),
        ("Transfer-Encoding: CHUNKED\r\n", 200),
        ("transfer-encoding: gzip, chunked\r\n", 501),
        ("transfer-encoding: gzip\r\ntransfer-encoding: chunked\r\n", 501),
        ("transfer-encoding: identity, chunked\r\n", 501),
        ("transfer-encoding: gzip\r\n", 501),
        ("transfer-encoding: nonsense\r\n", 501),
        ("transfer-encoding: chunked, gzip\r\n", 501),
        ("transfer-encoding: chunked, chunked\r\n", 400),
        ("content-length: x\r\n", 400),
    ] {
        let request =
            format!("POST /v1/stability HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\n{codings}");
        let closing = if status == 200 { "connection: close\r\n" } else { "" };
        let answer = whole(send(address, &format!("{request}{closing}\r\n{chunks}")).await).await;
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{codings:?}: {answer:.200}");
        if status == 501 {
            let problem: serde_json::Value = serde_json::from_str(body(&answer)).unwrap();
            assert_eq!(problem["status"], 501);
            assert!(problem["detail"].as_str().unwrap().contains("only chunked is understood"), "{problem}");
            assert!(answer.contains("connection: close\r\n"), "{answer}");
        }
    }
}

/// A client closes its sending half after the request and reads, like `nc -N`.
async fn half_closed(address: SocketAddr, request: &str) -> String {
    let mut socket = send(address, request).await;
    socket.shutdown().await.unwrap();
    whole(socket).await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_client_that_closes_its_sending_half_gets_the_same_answer() {
    let (app, address) = start().await;
    let small = MAP.replace("=1000", "=120");
    for target in ["/v1/scenes", SHORT, &small, &format!("{SHORT}&format=svg"), "/v1/stability?preset=none"] {
        for version in ["1.0", "1.1"] {
            let request = format!("GET {target} HTTP/{version}\r\nhost: localhost\r\nconnection: close\r\n\r\n");
            let expected = whole(send(address, &request).await).await;
            let answer = half_closed(address, &request).await;
            assert!(answer.starts_with(&format!("HTTP/{version} ")), "{target}: {answer:.200}");
            if answer.starts_with(&format!("HTTP/{version} 200")) {
                assert!(body(&answer) == body(&expected), "{target}: {answer:.200}");
            } else {
                assert_eq!(body(&answer).len(), body(&expected).len(), "{target}");
            }
        }
    }
    // The request comes in pieces with pauses.
    for target in [
        format!("{small}&format=ndjson"),
        format!("{small}&format=csv"),
        "/v1/precision?preset=case-1&bounces=20&format=progress".into(),
    ] {
        let request = format!("GET {target} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
        let answer = half_closed(address, &request).await;
        let told = unchunked(&answer);
        if target.contains("precision") {
            assert!(told.lines().last().unwrap().starts_with("{\"end\":"), "{told:.300}");
        } else {
            assert!(told == unchunked(&whole(send(address, &request).await).await), "{target}");
        }
    }
    // Several requests at once, and one with a body.
    let post = "POST /v1/stability HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 19\r\n\r\n{\"preset\":\"case-1\"}";
    let get = format!("GET {SHORT} HTTP/1.1\r\nhost: localhost\r\n\r\n");
    let answers = half_closed(address, &format!("{post}{get}{post}")).await;
    assert_eq!(answers.matches("HTTP/1.1 200 OK").count(), 3, "{answers:.2000}");
    assert_eq!(app.metrics.live_sessions.get(), 0);
}

#[tokio::test]
async fn a_client_that_closes_its_sending_half_hears_a_run_to_its_end() {
    let (app, address) = start().await;
    let target = "/v1/live/events?preset=still-lossy&speed=2";
    let request = format!("GET {target} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
    let answer = half_closed(address, &request).await;
    assert!(unchunked(&answer).ends_with("id: end\n\n"), "{answer:.500}");
    // Before the first impact the server probed the client with leading zeros of a chunk size, which change nothing.
    let asked = answer.split("\r\n").filter(|line| line.len() > 1 && line.starts_with('0')).count();
    assert!(asked > 0, "{answer:.2000}");
    assert_eq!(app.metrics.live_sessions.get(), 0);
}

/// Waits until no work is under way. Returns the time: a few ms on an idle machine.
async fn freed(app: &App, left: &str) {
    let since = Instant::now();
    while app.pool.running().get() > 0 || app.metrics.live_sessions.get() > 0 {
        assert!(since.elapsed() < Duration::from_secs(1), "{left}: the work goes on for nobody");
        sleep(Duration::from_millis(1)).await;
    }
    println!("{left}: free {} ms after its client had left", since.elapsed().as_millis());
}

async fn begun(app: &App) {
    let begin = async {
        while app.pool.running().get() == 0 && app.metrics.live_sessions.get() == 0 {
            sleep(Duration::from_millis(1)).await;
        }
    };
    timeout(SOON, begin).await.expect("nothing begins");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_client_that_has_gone_is_known_from_one_that_waits() {
    let (app, address) = start().await;
    let batch = {
        let line = "{\"preset\": \"case-1\", \"x\": {\"field\": \"table.tilt_gain\", \"from\": 0.95, \"to\": 1.6, \"count\": 1000}, \
                    \"y\": {\"field\": \"release.theta\", \"from\": 0, \"to\": 0.5, \"count\": 1000}, \"bounces\": 2000}";
        let length = line.len();
        format!(
            "POST /v1/batches/regions HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/x-ndjson\r\ncontent-length: {length}\r\n\r\n{line}"
        )
    };
    let get = |target: &str, version: &str| format!("GET {target} HTTP/{version}\r\nhost: localhost\r\n\r\n");
    let paused = "/v1/live/events?preset=case-1&speed=0.05";
    for (what, request) in [
        ("HTTP/1.1", get(MAP, "1.1")),
        ("HTTP/1.0", get(MAP, "1.0")),
        // The server has not yet read the bytes after the request.
        ("the next request behind it", get(MAP, "1.1").repeat(2)),
        ("half of the next request", get(MAP, "1.1") + "GET / HT"),
        ("an answer in lines", get(&format!("{MAP}&format=ndjson"), "1.1")),
        ("a batch", batch),
        ("events", get(paused, "1.1")),
    ] {
        let mut socket = send(address, &request).await;
        begun(&app).await;
        // At once, and after a while of only listening.
        drop(socket);
        freed(&app, what).await;
        socket = send(address, &request).await;
        begun(&app).await;
        socket.shutdown().await.unwrap();
        let mut heard = [0; 4096];
        let _ = timeout(Duration::from_millis(60), async {
            while socket.read(&mut heard).await.is_ok_and(|count| count > 0) {}
        })
        .await;
        assert_ne!(
            app.pool.running().get() + app.metrics.live_sessions.get(),
            0,
            "{what}: given up while its client waits"
        );
        drop(socket);
        freed(&app, &format!("{what}, half closed before")).await;
    }
}

/// The server probes a client with the first bytes of the answer; the client reads each byte once.
#[tokio::test]
async fn a_client_that_waits_reads_no_byte_twice() {
    let (_, address) = start_with(&Config { permits: std::num::NonZeroUsize::new(1), ..Config::default() }).await;
    let small = MAP.replace("=1000", "=200");
    let request = format!("GET {small} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
    let mut socket = send(address, &request).await;
    socket.shutdown().await.unwrap();
    let mut first = [0; 3];
    timeout(SOON, socket.read_exact(&mut first)).await.expect("no byte ahead").unwrap();
    let rest = whole(socket).await;
    assert_eq!(&first, b"HTT");
    assert!(rest.starts_with("P/1.1 200 OK\r\n"), "{rest:.100}");
}
