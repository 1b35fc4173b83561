//! Answers piece by piece: streamed row by row, one for each line of a batch, and in ranges.

use std::io::Write;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

use axum::body::Body;
use axum::http::{Method, Request};
use equipoise::api::App;
use equipoise::config::Config;
use equipoise::limits::Limits;
use equipoise::router;
use http_body_util::BodyExt;
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::timeout;
use tower::ServiceExt;

use crate::support::socket::{SOON, start};
use crate::support::{Answer, Server, contract};

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

// Many requests in one body: each line is answered as if it had been posted alone, and its errors stand in its own line.

const NDJSON: &[(&str, &str)] = &[("content-type", "application/x-ndjson")];

/// Posts lines. Returns the lines of the answer without the last one, which must count them.
async fn batch(server: &Server, resource: &str, lines: &[String]) -> Vec<Value> {
    let target = format!("/v1/batches/{resource}");
    let answer = server.send(Method::POST, &target, NDJSON, &lines.join("\n")).await.expect(200);
    let mut told: Vec<Value> = answer.text().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let problems = told.iter().filter(|line| line.get("problem").is_some()).count();
    assert_eq!(told.pop(), Some(json!({"end": {"lines": told.len(), "problems": problems}})));
    let id = answer.header("x-request-id").unwrap();
    for problem in told.iter().filter_map(|line| line.get("problem")) {
        assert_eq!(problem["request_id"], id);
    }
    told
}

#[tokio::test]
async fn a_line_is_answered_as_if_it_were_alone() {
    let server = Server::start();
    let mut names = Vec::new();
    for (template, method, operation) in contract::operations() {
        // The resources for batches themselves are one level deeper.
        let Some(name) = template.strip_prefix("/v1/").filter(|name| method == Method::POST && !name.contains('/'))
        else {
            continue;
        };
        names.push(name);
        let examples = operation["requestBody"]["content"]["application/json"]["examples"].as_object().unwrap();
        let asked: Vec<&Value> = examples.values().map(|example| &example["value"]).collect();
        let lines: Vec<String> = asked.iter().map(|body| body.to_string()).collect();
        let told = batch(&server, name, &lines).await;
        assert_eq!(told.len(), asked.len());
        for (index, (line, body)) in told.iter().zip(asked).enumerate() {
            assert_eq!(line["line"], index + 1);
            let alone = server.post(template, body).await.expect(200).json();
            match name {
                // Clock times differ from answer to answer.
                "precision" => assert_eq!(line["answer"]["bounces"], alone["bounces"], "{line:.300}"),
                _ => assert_eq!(line["answer"], alone, "{name}: {body}"),
            }
        }
    }
    // Exactly the resources that the contract lists for batches.
    let all = &contract::DOCUMENT["paths"]["/v1/batches/{resource}"]["post"]["parameters"][0]["schema"]["enum"];
    names.sort_unstable();
    assert_eq!(all, &json!(names));
}

#[tokio::test]
async fn what_is_wrong_is_told_in_its_line() {
    let server = Server::start();
    let lines = [
        r#"{"preset": "case-1"}"#,
        "",
        r#"{"preset": "case-1", "scene": {"table": {"tilt_gain": "high"}}, "steps": 3}"#,
        "{",
        r#"["preset"]"#,
        r#"{"preset": "case-1", "horizon": 2000000000000}"#,
        r#"{"preset": "case-2"}"#,
    ];
    let told = batch(&server, "stability", &lines.map(str::to_owned)).await;
    let numbers: Vec<&Value> = told.iter().map(|line| &line["line"]).collect();
    assert_eq!(numbers, [1, 3, 4, 5, 6, 7]);
    assert!(told[0]["answer"].is_object() && told[5]["answer"].is_object());
    let statuses: Vec<u64> = told[1..5].iter().map(|line| line["problem"]["status"].as_u64().unwrap()).collect();
    assert_eq!(statuses, [422, 400, 422, 422]);
    let errors = told[1]["problem"]["errors"].as_array().unwrap();
    let pointers: Vec<&Value> = errors.iter().map(|error| &error["pointer"]).collect();
    assert_eq!(pointers, ["/scene/table/tilt_gain", "/steps"]);
}

#[tokio::test]
async fn what_is_no_batch_is_refused_as_a_whole() {
    let server = Server::start();
    let post = async |target: &str, media_type: &str, body: &str| {
        server.send(Method::POST, target, &[("content-type", media_type)], body).await
    };
    let stability = "/v1/batches/stability";
    let line = r#"{"preset": "case-1"}"#;
    let unknown = post("/v1/batches/scenes", "application/x-ndjson", line).await.expect(404);
    assert!(unknown.json()["detail"].as_str().unwrap().ends_with("regions, stability, throws, trajectories"));
    let json = post(stability, "application/json", line).await.expect(415);
    assert_eq!(json.header("accept"), Some("application/x-ndjson"));
    post(&format!("{stability}?format=csv"), "application/x-ndjson", line).await.expect(406);
    post(&format!("{stability}?format=ndjson"), "application/jsonl", line).await.expect(200);
    post(&format!("{stability}?bounces=1"), "application/x-ndjson", line).await.expect(422);
    post(stability, "application/x-ndjson", " \n\n").await.expect(400);
    let large = "{}\n".repeat(Config::default().limits.body_bytes);
    post(stability, "application/x-ndjson", &large).await.expect(413);
}

/// A server with one permit, and the body of a batch under way.
async fn under_way(lines: &[Value]) -> (App, Body) {
    let app = App::new(&Config { permits: NonZeroUsize::new(1), ..Config::default() });
    let body = lines.iter().map(|line| format!("{line}\n")).collect::<String>();
    let request = Request::post("/v1/batches/trajectories").header(NDJSON[0].0, NDJSON[0].1).body(Body::from(body));
    let response = equipoise::router::router(app.clone()).oneshot(request.unwrap()).await.unwrap();
    assert_eq!(response.status(), 200);
    (app, response.into_body())
}

/// The next line of a body.
async fn next_line(body: &mut Body) -> String {
    let mut line = String::new();
    while !line.ends_with('\n') {
        let piece = body.frame().await.expect("more lines").unwrap().into_data().unwrap();
        line.push_str(std::str::from_utf8(&piece).unwrap());
    }
    line
}

#[tokio::test]
async fn nothing_is_computed_before_it_is_taken_and_nothing_for_who_has_gone() {
    let (app, mut body) = under_way(&vec![json!({"preset": "case-1", "bounces": 3000}); 20]).await;
    assert!(next_line(&mut body).await.starts_with(r#"{"line":1,"answer":{"#));
    let bounces = app.metrics.bounces.get();
    assert!((3000..=9000).contains(&bounces), "{bounces}");
    drop(body);
    let ended = async {
        while app.pool.running().get() + app.pool.queued().get() > 0 {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    };
    tokio::time::timeout(Duration::from_secs(30), ended).await.expect("the work ends");
    assert!(app.metrics.bounces.get() <= 9000);
}

#[tokio::test]
async fn a_server_that_stops_says_which_lines_are_left() {
    let (app, mut body) = under_way(&vec![json!({"preset": "case-1", "bounces": 10}); 4]).await;
    next_line(&mut body).await;
    app.close();
    let mut last = String::new();
    for number in 2..=4 {
        last = next_line(&mut body).await;
        assert!(last.starts_with(&format!("{{\"line\":{number},")), "{last}");
    }
    let last: Value = serde_json::from_str(&last).unwrap();
    assert_eq!(last["problem"]["status"], 503, "{last}");
    assert!(next_line(&mut body).await.starts_with(r#"{"end":{"lines":4,"#));
    assert!(body.frame().await.is_none());
}

// One range of an answer, for programs that read a file by parts: polars and DuckDB ask for the length, then for ranges.

const RUN: &str = "/v1/trajectories?preset=case-1&bounces=50&format=csv";

/// A map, which is streamed if it is asked for as a whole.
const SMALL_MAP: &str = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=1&x.to=1.6&x.count=9\
                   &y.field=release.theta&y.from=0&y.to=0.5&y.count=7&bounces=20&format=csv";

const TARGETS: [&str; 6] = [
    RUN,
    SMALL_MAP,
    "/v1/scenes/case-1",
    "/v1/stability?preset=case-1&bounces=50&format=png",
    "/v1/trajectories?preset=case-1&bounces=50&format=arrow",
    "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=1&x.to=1.6&x.count=9&y.field=release.theta&y.from=0&y.to=0.5&y.count=7&bounces=20&format=arrow",
];

async fn range(server: &Server, target: &str, range: &str) -> Answer {
    server.get_with(target, &[("range", range)]).await
}

/// The length that HEAD tells.
async fn length(server: &Server, target: &str) -> usize {
    let head = server.head(target).await.expect(200);
    assert_eq!(head.header("accept-ranges"), Some("bytes"), "{target}");
    head.header("content-length").unwrap_or_else(|| panic!("{target}: no length")).parse().unwrap()
}

#[tokio::test]
async fn parts_put_together_are_the_whole() {
    // With answers in memory and without.
    for answer_cache in [1 << 20, 0] {
        for target in TARGETS {
            let whole = Server::start().get(target).await.expect(200);
            let limits = Limits { answer_cache, ..Limits::default() };
            let server = Server::with(&Config { limits, ..Config::default() });
            let length = length(&server, target).await;
            assert_eq!(length, whole.raw.len(), "{target}");
            let mut parts = Vec::new();
            let step = length / 3 + 1;
            for first in (0..length).step_by(step) {
                let last = first + step - 1;
                let part = range(&server, target, &format!("bytes={first}-{last}")).await.expect(206);
                let expected = format!("bytes {first}-{}/{length}", last.min(length - 1));
                assert_eq!(part.header("content-range"), Some(expected.as_str()), "{target}");
                for name in ["etag", "content-type", "vary", "cache-control", "accept-ranges"] {
                    if name != "accept-ranges" {
                        assert_eq!(part.header(name), whole.header(name), "{target}: {name}");
                    }
                    assert!(part.header(name).is_some(), "{target}: {name}");
                }
                parts.extend_from_slice(&part.raw);
            }
            assert!(parts == whole.raw, "{target}");
            let end = range(&server, target, "bytes=-5").await.expect(206);
            assert_eq!(end.raw, whole.raw[length - 5..], "{target}");
            let rest = range(&server, target, &format!("bytes={}-", length - 1)).await.expect(206);
            assert_eq!(rest.raw, whole.raw[length - 1..], "{target}");
            assert_eq!(server.get(target).await.expect(200).raw, whole.raw, "{target}");
        }
    }
}

#[tokio::test]
async fn a_range_beyond_the_end_is_416() {
    let server = Server::start();
    for target in [RUN, SMALL_MAP] {
        let length = length(&server, target).await;
        for beyond in [format!("bytes={length}-"), "bytes=99999999999999999999-".to_owned(), "bytes=-0".to_owned()] {
            // The second one is answered from memory.
            for _ in 0..2 {
                let refused = range(&server, target, &beyond).await.expect(416);
                assert_eq!(refused.header("content-range"), Some(format!("bytes */{length}").as_str()), "{target}");
                assert_eq!(refused.media_type(), "application/problem+json", "{target}");
            }
        }
    }
}

#[tokio::test]
async fn other_ranges_get_the_whole() {
    let server = Server::start();
    let whole = server.get(RUN).await.expect(200);
    for invalid in ["bytes=0-1,4-5", "bytes=5-2", "rows=0-1", "bytes", "bytes=x-"] {
        assert_eq!(range(&server, RUN, invalid).await.expect(200).raw, whole.raw, "{invalid}");
    }
    // Ranges are for GET alone.
    let head = server.send(Method::HEAD, RUN, &[("range", "bytes=0-1")], "").await.expect(200);
    assert_eq!(head.header("content-length"), Some(whole.raw.len().to_string().as_str()));
    let headers = [("range", "bytes=0-1"), ("content-type", "application/json")];
    let body = json!({"preset": "case-1", "bounces": 50}).to_string();
    let post = server.send(Method::POST, "/v1/trajectories?format=csv", &headers, &body).await.expect(200);
    assert_eq!(post.raw, whole.raw);
    // A measurement differs each time.
    let measured = "/v1/precision?preset=case-1&bounces=2&methods.0=map&format=csv";
    assert_eq!(range(&server, measured, "bytes=0-1").await.expect(200).header("accept-ranges"), None);
    // Errors have no ranges.
    range(&server, "/v1/trajectories?preset=case-1&bounces=0", "bytes=0-1").await.expect(422);
}

#[tokio::test]
async fn a_range_of_another_answer_is_not_cut() {
    let server = Server::start();
    for target in [RUN, SMALL_MAP] {
        let whole = server.get(target).await.expect(200);
        let own = server.get_with(target, &[("range", "bytes=2-4"), ("if-range", whole.etag())]).await.expect(206);
        assert_eq!(own.raw, whole.raw[2..5]);
        for other in ["\"other\"", &format!("W/{}", whole.etag()), "Mon, 23 Nov 2026 10:00:00 GMT"] {
            let answer = server.get_with(target, &[("range", "bytes=2-4"), ("if-range", other)]).await.expect(200);
            assert_eq!(answer.raw, whole.raw, "{target}: {other}");
        }
        let held = server.get_with(target, &[("range", "bytes=2-4"), ("if-none-match", whole.etag())]).await;
        held.expect(304);
    }
}

/// A range is one of the bytes without compression, also for a client that takes gzip, as fsspec does. Whole answers are compressed.
#[tokio::test]
async fn a_part_is_not_compressed() {
    let server = Server::start();
    for target in [RUN, SMALL_MAP] {
        let whole = server.get(target).await.expect(200);
        // Twice: the second ones are answered from memory.
        for _ in 0..2 {
            let packed = server.get_with(target, &[("accept-encoding", "gzip")]).await.expect(200);
            assert_eq!((packed.header("content-encoding"), packed.header("accept-ranges")), (Some("gzip"), None));
            assert_eq!(packed.body, whole.body, "{target}");
            let part =
                server.get_with(target, &[("range", "bytes=0-3"), ("accept-encoding", "gzip")]).await.expect(206);
            assert_eq!((part.header("content-encoding"), part.etag()), (None, whole.etag()), "{target}");
            assert_eq!(part.raw, whole.raw[..4], "{target}");
            let headers = [("range", "bytes=0-3"), ("accept-encoding", "gzip, identity;q=0")];
            let refused = server.get_with(target, &headers).await.expect(200);
            assert_eq!(refused.header("content-encoding"), Some("gzip"), "{target}");
        }
    }
}
