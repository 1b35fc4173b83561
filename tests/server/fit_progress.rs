//! Progress of fits: lines that rise to the end, a problem in place of the end, and a reader that leaves.

use crate::fits::{FITS, SD, measured, request};
use crate::support::Server;
use axum::body::Body;
use axum::http::Request;
use equipoise::api::App;
use equipoise::api::fits::progress::stages;
use equipoise::router;
use http_body_util::BodyExt;
use serde_json::{Value, json};
use tower::ServiceExt;

/// The lines of a fit that tells its progress.
async fn told(server: &Server, body: &Value) -> Vec<Value> {
    let answer = server.post(&format!("{FITS}?format=progress"), body).await.expect(200);
    assert_eq!(answer.media_type(), "application/x-ndjson");
    answer.text().lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[tokio::test]
async fn progress_rises_to_the_end_and_the_end_is_the_plain_answer() {
    let server = Server::start();
    let mut data = measured(&server, &json!({"release": {"theta": 0.2}}), 60, 1.0, 21).await;
    data["theta"][10] = json!(data["theta"][10].as_f64().unwrap() + 0.1);
    let plain = request(data, json!({"table": {"tilt_gain": 1.2}}), &["table.tilt_gain"]);
    let mut given = plain.clone();
    given["sd"] = json!({"theta": SD[0].1, "t": SD[1].1});
    // Deviations that are not given count as 5 mrad and 2 ms.
    for (body, sd) in [(plain, [("theta", 5e-3), ("t", 2e-3)]), (given, SD)] {
        let answer = server.post(FITS, &body).await.expect(200);
        let raw = server.post(&format!("{FITS}?format=progress"), &body).await.expect(200);
        let svg = server.post(&format!("{FITS}?format=svg"), &body).await.expect(200);
        let last = raw.text().lines().last().unwrap();
        assert!(last.starts_with(&format!("{{\"end\":{},\"pictures\":", answer.text())), "{last:.300}");
        let lines = told(&server, &body).await;
        let (end, steps) = lines.split_last().unwrap();
        assert_eq!(end["pictures"]["residuals"].as_str(), Some(svg.text()));
        let steps: Vec<&Value> = steps.iter().map(|line| &line["progress"]).collect();
        let of = steps[0]["of"].as_u64().unwrap();
        let start = json!({"done": 0, "of": of, "stage": "numbers", "search": 0, "iterations": 0, "residual": null});
        assert_eq!(steps[0], &start);
        for pair in steps.windows(2) {
            for name in ["done", "iterations"] {
                assert!(pair[0][name].as_u64() <= pair[1][name].as_u64(), "{} {}", pair[0], pair[1]);
            }
            assert_eq!(pair[1]["of"], of);
        }
        let last = steps.last().unwrap();
        assert_eq!((&last["stage"], last["done"].as_u64()), (&json!("verdict"), Some(of)));
        assert_eq!(last["iterations"], end["end"]["iterations"]);
        let mut met: Vec<&str> = steps.iter().map(|step| step["stage"].as_str().unwrap()).collect();
        met.dedup();
        assert_eq!(met, stages());
        // Each iteration on the way to the best has a line.
        let found = |step: &&&Value| step["residual"].is_number();
        let mut iterations: Vec<u64> =
            steps.iter().filter(found).map(|it| it["iterations"].as_u64().unwrap()).collect();
        iterations.dedup();
        assert_eq!(iterations, (0..iterations.len() as u64).collect::<Vec<_>>());
        // The last residual is that of the answer.
        let (mut squares, mut count) = (0.0, 0.0);
        for (name, sd) in sd {
            let column = end["end"]["residuals"][name].as_array().unwrap();
            for (row, value) in column.iter().enumerate().filter(|(row, _)| name != "theta" || *row != 10) {
                assert!(end["end"]["residuals"]["outlier"][row] == false || row == 10);
                squares += (value.as_f64().unwrap() / sd).powi(2);
                count += 1.0;
            }
        }
        let residual = steps.iter().rfind(found).unwrap()["residual"].as_f64().unwrap();
        assert!((residual / (squares / count).sqrt() - 1.0).abs() < 1e-9, "{residual} {squares} {count}");
        let first = steps.iter().find(found).unwrap()["residual"].as_f64().unwrap();
        assert!(residual < 0.5 * first, "{first} {residual}");
    }
}

#[tokio::test]
async fn without_a_fit_the_last_line_is_the_problem() {
    let server = Server::start();
    let good = measured(&server, &json!({"release": {"theta": 0.2}}), 20, 1.0, 2).await;
    let first = |name: &str| json!(good[name].as_array().unwrap()[..3]);
    let body = request(json!({"t": first("t"), "theta": first("theta")}), json!({}), &["table.tilt_gain"]);
    let refused = server.post(FITS, &body).await.expect(422).json();
    let lines = told(&server, &body).await;
    assert!(lines.len() > 2, "{lines:?}");
    for name in ["title", "status", "detail", "errors"] {
        assert_eq!(lines.last().unwrap()["problem"][name], refused[name]);
    }
    // A fault that is seen without a fit is an answer of its own.
    let faulty = request(json!({"t": [0.1]}), json!({}), &["table.tilt_gain"]);
    server.post(&format!("{FITS}?format=progress"), &faulty).await.expect(422);
}

#[tokio::test]
async fn who_has_heard_enough_of_a_fit_frees_the_server() {
    let server = Server::start();
    let data = measured(&server, &json!({"release": {"theta": 0.2}}), 1000, 1.0, 7).await;
    let unknown = ["table.tilt_gain", "body.radius_of_gyration", "gravity"];
    let body = request(data, json!({}), &unknown).to_string();
    let app = App::new(&equipoise::config::Config::default());
    let asked = Request::post(format!("{FITS}?format=progress")).header("content-type", "application/json");
    let response = router::router(app.clone()).oneshot(asked.body(Body::from(body)).unwrap()).await.unwrap();
    let (mut body, mut heard) = (response.into_body(), String::new());
    while !heard.contains("\"starts\"") {
        let piece = body.frame().await.expect("more lines").unwrap().into_data().unwrap();
        heard.push_str(std::str::from_utf8(&piece).unwrap());
    }
    assert!(!heard.contains("\"end\""), "the work is too short to be left");
    assert_eq!(app.pool.running().get(), 1);
    drop(body);
    while app.pool.running().get() > 0 {
        tokio::task::yield_now().await;
    }
}
