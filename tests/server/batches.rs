//! Many requests in one body: each line is answered as if it had been posted alone, and its errors stand in its own line.

use std::num::NonZeroUsize;
use std::time::Duration;

use crate::support::Server;
use crate::support::contract;
use axum::body::Body;
use axum::http::{Method, Request};
use equipoise::api::App;
use equipoise::config::Config;
use http_body_util::BodyExt;
use serde_json::{Value, json};
use tower::ServiceExt;

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
