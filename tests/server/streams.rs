//! Answers that are streamed row by row, and their work when the reader hangs up or is slow.

use std::io::Write;
use std::time::{Duration, Instant};

use crate::support::Server;
use crate::support::socket::{SOON, start};
use equipoise::api::App;
use equipoise::router;
use http_body_util::BodyExt;
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::timeout;
use tower::ServiceExt;

const MAP: &str = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=0.95&x.to=1.6\
                   &y.field=release.theta&y.from=0&y.to=0.5";

async fn ask(address: std::net::SocketAddr, target: &str) -> TcpStream {
    let mut socket = TcpStream::connect(address).await.unwrap();
    let request = format!("GET {target} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
    socket.write_all(request.as_bytes()).await.unwrap();
    socket
}

/// Reads until `text` has arrived.
async fn read_until(socket: &mut TcpStream, text: &str) -> String {
    let mut read = Vec::new();
    while !String::from_utf8_lossy(&read).contains(text) {
        let count = timeout(SOON, socket.read_buf(&mut read)).await.expect("the server is silent").unwrap();
        assert!(count > 0, "the end came before {text:?}");
    }
    String::from_utf8_lossy(&read).into_owned()
}

/// The body of a chunked answer.
fn unchunked(answer: &str) -> String {
    let (head, mut rest) = answer.split_once("\r\n\r\n").unwrap();
    assert!(head.contains("transfer-encoding: chunked"), "{head}");
    let mut body = String::new();
    loop {
        let (size, after) = rest.split_once("\r\n").unwrap();
        let size = usize::from_str_radix(size, 16).unwrap();
        if size == 0 {
            return body;
        }
        body.push_str(&after[..size]);
        rest = &after[size + 2..];
    }
}

async fn jobs_running(app: &App) -> String {
    let request = axum::http::Request::get("/metrics").body(axum::body::Body::empty()).unwrap();
    let response = router::router(app.clone()).oneshot(request).await.unwrap();
    let bytes = axum::body::to_bytes(response.into_body(), usize::MAX).await.unwrap();
    let text = String::from_utf8(bytes.to_vec()).unwrap();
    text.lines().find(|line| line.starts_with("equipoise_jobs_running")).unwrap().to_owned()
}

/// Waits until the cores are free after a client hung up. Returns the time: a few ms on an idle machine. The work would have taken
/// seconds or minutes.
async fn freed(app: &App, left: &str) {
    let since = Instant::now();
    while app.pool.running().get() > 0 {
        assert!(since.elapsed() < Duration::from_secs(1), "{left}: the work goes on for nobody");
        tokio::time::sleep(Duration::from_millis(1)).await;
    }
    println!("{left:.40}: free {} ms after its client had left", since.elapsed().as_millis());
}

/// The reader of a million cells hangs up after the first rows, and the cores are free again.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_million_cells_end_with_their_reader() {
    let (app, address) = start().await;
    for (format, first) in
        [("ndjson", "{\"row\":1,"), ("csv", "\r\n"), ("arrow", "equipoise"), ("json", ""), ("png", "")]
    {
        let mut socket = ask(address, &format!("{MAP}&x.count=1000&y.count=1000&bounces=2000&format={format}")).await;
        if first.is_empty() {
            while app.pool.running().get() == 0 {
                tokio::time::sleep(Duration::from_millis(1)).await;
            }
        } else {
            read_until(&mut socket, first).await;
        }
        assert_eq!(jobs_running(&app).await, "equipoise_jobs_running 1", "{format}");
        drop(socket);
        freed(&app, format).await;
        assert_eq!(jobs_running(&app).await, "equipoise_jobs_running 0", "{format}");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_slow_reader_holds_no_core_and_misses_nothing() {
    let (app, address) = start().await;
    let target = format!("{MAP}&x.count=700&y.count=700&bounces=2&quantity=max_theta&format=ndjson");
    let mut socket = ask(address, &target).await;
    let begun = read_until(&mut socket, "{\"row\":0,").await;
    // The client reads nothing more until all is computed.
    let wait = async {
        while app.pool.running().get() > 0 {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    };
    timeout(SOON, wait).await.expect("the work waits for its reader");
    let mut rest = String::new();
    timeout(SOON, socket.read_to_string(&mut rest)).await.expect("the server is silent").unwrap();
    let body = unchunked(&(begun + &rest));
    assert_eq!(body.lines().count(), 701);
    assert_eq!(body, Server::start().get(&target).await.expect(200).text());
}

const ENSEMBLE: &str = "/v1/ensembles?preset=case-1-noise&scene.release.theta=0.1&runs=20000&bounces=5000";

/// Progress arrives long before the end, and a client that hangs up then frees the cores.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn who_hears_of_progress_may_leave() {
    let (app, address) = start().await;
    let precision = "/v1/precision?preset=case-1&bounces=1000";
    for (target, some) in [(ENSEMBLE, "\"done\":256,\"of\":20000}"), (precision, "\"done\":20,\"of\":")] {
        let mut socket = ask(address, &format!("{target}&format=progress")).await;
        let heard = read_until(&mut socket, some).await;
        assert!(heard.contains("{\"progress\":{\"done\":0,") && !heard.contains("\"end\""), "{heard}");
        assert_eq!(jobs_running(&app).await, "equipoise_jobs_running 1", "{target}");
        drop(socket);
        freed(&app, target).await;
    }
}

/// A client that hangs up frees the cores at any stage of any request: run, rows or pixels.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn whoever_leaves_frees_the_core() {
    let (app, address) = start().await;
    let long = "/v1/trajectories?preset=case-1&bounces=100000";
    for target in [
        long,
        &format!("{long}&format=csv"),
        &format!("{long}&format=ndjson"),
        &format!("{long}&format=arrow"),
        &format!("{long}&format=png"),
        "/v1/trajectories?preset=case-1&bounces=100000&method=extended",
        "/v1/trajectories?preset=case-1&bounces=100000&tolerance=1e-6",
        "/v1/stability?preset=case-1&bounces=20000&basin=true",
        "/v1/ladder?preset=case-1-noise&scene.release.theta=0.1&bounces=100000",
        "/v1/precision?preset=case-1&bounces=1000",
        &format!("{MAP}&x.count=1000&y.count=1000&bounces=1&quantity=residue"),
        &format!("{MAP}&x.count=300&y.count=300&bounces=1000&scene.noise.timing_sd=0.001"),
        ENSEMBLE,
    ] {
        // Different delays meet all stages of the work; some requests are done by then.
        let mut met = 0;
        for wait in [1, 30, 100, 300, 1000] {
            let socket = ask(address, target).await;
            tokio::time::sleep(Duration::from_millis(wait)).await;
            met += app.pool.running().get();
            drop(socket);
            freed(&app, target).await;
        }
        assert!(met > 0, "{target} is answered at once");
    }
}

/// Compressed lines can be read as they arrive, too.
#[tokio::test]
async fn progress_is_not_kept_back_by_its_compression() {
    let app = App::new(&equipoise::config::Config::default());
    let request = axum::http::Request::get(format!("{ENSEMBLE}&format=progress")).header("accept-encoding", "gzip");
    let response = router::router(app).oneshot(request.body(axum::body::Body::empty()).unwrap()).await.unwrap();
    assert_eq!(response.headers()["content-encoding"], "gzip");
    let mut body = response.into_body();
    let mut decoder = flate2::write::GzDecoder::new(Vec::new());
    for line in ["{\"progress\":{\"done\":0,\"of\":20000}}\n", "{\"progress\":{\"done\":256,\"of\":20000}}\n"] {
        let piece = timeout(SOON, body.frame()).await.expect("the server is silent").unwrap().unwrap();
        decoder.write_all(&piece.into_data().unwrap()).unwrap();
        decoder.flush().unwrap();
        assert_eq!(String::from_utf8_lossy(decoder.get_ref()), line);
        decoder.get_mut().clear();
    }
}

#[tokio::test]
async fn progress_has_a_tag_of_its_own() {
    let server = Server::start();
    let target = "/v1/ensembles?preset=case-1-noise&runs=100&bounces=1000";
    let told = server.get(&format!("{target}&format=progress")).await.expect(200);
    server.get_with(&format!("{target}&format=progress"), &[("if-none-match", told.etag())]).await.expect(304);
    for format in ["json", "ndjson"] {
        assert_ne!(server.head(&format!("{target}&format={format}")).await.expect(200).etag(), told.etag());
    }
    assert_eq!(server.head(&format!("{target}&format=progress")).await.expect(200).etag(), told.etag());
    let body = serde_json::json!({"preset": "case-1-noise", "runs": 100, "bounces": 1000});
    assert_eq!(server.post("/v1/ensembles?format=progress", &body).await.expect(200).raw, told.raw);
}

/// The lines equal the rows of the JSON answer.
#[tokio::test]
async fn rows_say_what_the_whole_says() {
    let server = Server::start();
    // Rows that span three blocks, and blocks of many rows.
    for (columns, rows, impacts) in [(150, 3, 40_000), (9, 400, 5)] {
        let target = format!("{MAP}&x.count={columns}&y.count={rows}&bounces={impacts}");
        let whole = server.get(&target).await.expect(200).json();
        let lines = server.get(&format!("{target}&format=ndjson")).await.expect(200);
        let lines: Vec<Value> = lines.text().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(lines.len(), rows + 1);
        for (row, line) in lines[..rows].iter().enumerate() {
            let expected = json!({"row": row, "y": whole["y"][row], "values": whole["values"][row],
                                  "outcomes": whole["outcomes"][row]});
            assert_eq!(*line, expected);
        }
        assert_eq!(lines[rows], json!({"end": {"counts": whole["counts"]}}));
    }
}

#[tokio::test]
async fn a_stream_has_a_tag_and_no_work_is_done_for_who_has_it() {
    let server = Server::start();
    let target = format!("{MAP}&x.count=30&y.count=20&bounces=50&format=ndjson");
    let plain = server.get(&target).await.expect(200);
    assert_eq!(plain.header("content-length"), None);
    server.get_with(&target, &[("if-none-match", plain.etag())]).await.expect(304);
    let packed = server.get_with(&target, &[("accept-encoding", "gzip")]).await.expect(200);
    assert_eq!((packed.header("content-encoding"), &packed.body), (Some("gzip"), &plain.body));
    assert_ne!(packed.etag(), plain.etag());
    assert_eq!(server.head(&target).await.expect(200).etag(), plain.etag());
}
