//! Fits of tables: what trajectories write is read as the JSON that has the same columns.

use axum::http::Method;
use serde_json::{Value, json};

use crate::fits::FITS;
use crate::support::{Answer, Server};

const RUN: &str = "/v1/trajectories?preset=case-1&release.theta=0.2&bounces=30";
const REQUEST: &str = "preset=case-1&table.tilt_gain=1.14&unknown.0=table.tilt_gain&sd.t=0.001&sd.theta=0.002";

async fn sent(server: &Server, media_type: &str, query: &str, body: impl AsRef<[u8]>) -> Answer {
    server.send(Method::POST, &format!("{FITS}?{query}"), &[("content-type", media_type)], body).await
}

#[tokio::test]
async fn a_run_of_the_server_is_fitted_as_it_is() {
    let server = Server::start();
    let run = server.get(RUN).await.expect(200).json();
    let mut measured = json!({});
    for name in ["n", "t", "theta", "x_dot", "y_dot", "theta_dot", "x"] {
        measured[name] = run["impacts"][name].clone();
    }
    let body = json!({
        "preset": "case-1", "scene": {"table": {"tilt_gain": 1.14}}, "measured": measured, "unknown": ["table.tilt_gain"],
        "sd": {"t": 0.001, "theta": 0.002},
    });
    for format in ["json", "csv", "ndjson", "progress"] {
        let url = format!("{FITS}?format={format}");
        let told = server.post(&url, &body).await.expect(200);
        let csv = server.get(&format!("{RUN}&format=csv")).await.expect(200);
        let arrow = server.get(&format!("{RUN}&format=arrow")).await.expect(200);
        for (media_type, table) in [("text/csv; charset=utf-8", csv), ("application/vnd.apache.arrow.stream", arrow)] {
            let answer =
                sent(&server, media_type, &format!("{REQUEST}&format={format}"), &table.body).await.expect(200);
            assert!(answer.body == told.body, "{media_type}, {format}");
            assert_eq!(answer.headers.get("etag"), told.headers.get("etag"));
        }
    }
}

#[tokio::test]
async fn degrees_and_gaps_of_a_spreadsheet_are_read() {
    let server = Server::start();
    let run = server.get(RUN).await.expect(200).json();
    let column = |name: &str| run["impacts"][name].as_array().unwrap().clone();
    let (times, mut angles) = (column("t"), column("theta"));
    angles[7] = Value::Null;
    let rows = times.iter().zip(&angles).map(|(t, theta)| {
        let degrees = theta.as_f64().map_or(String::new(), |theta| theta.to_degrees().to_string());
        format!("{t},{degrees}\r\n")
    });
    let table = format!("\u{feff}\"t [s]\",theta_deg\r\n{}", rows.collect::<String>());
    let fit = sent(&server, "text/csv", REQUEST, table).await.expect(200).json();
    let estimate = fit["estimates"][0]["value"].as_f64().unwrap();
    assert!((estimate - 1.1).abs() < 1e-3, "{fit}");
}

#[tokio::test]
async fn faults_of_a_table_have_places() {
    let server = Server::start();
    for (media_type, query, table, status, pointer) in [
        ("text/csv", "preset=case-1&unknown.0=gravity", "t,angle\n1,2\n", 422, "/measured/angle"),
        ("text/csv", "preset=case-1&unknown.0=gravity", "t,theta\n1,x\n", 422, "/measured/theta/0"),
        ("text/csv", "preset=case-1&unknown.0=gravity&measured.t.0=1", "t\n1\n", 422, "/measured"),
        ("text/csv", "preset=case-1&unknowns.0=gravity", "t\n1\n", 422, "/unknown"),
        ("text/csv", "preset=case-1", "t,theta\n1\n", 422, "/measured"),
        ("text/csv", "preset=case-1", "\n", 422, "/measured"),
        ("application/vnd.apache.arrow.stream", "preset=case-1", "t\n", 400, ""),
        ("text/plain", "preset=case-1", "t\n", 415, ""),
    ] {
        let problem = sent(&server, media_type, query, table).await.expect(status);
        let errors = problem.json()["errors"].clone();
        assert_eq!(errors[0]["pointer"].as_str().unwrap_or_default(), pointer, "{errors}");
        let listed = "application/json, text/csv, application/vnd.apache.arrow.stream";
        assert!(status != 415 || problem.text().contains(listed) && problem.headers["accept"] == listed);
    }
    // A stream of Arrow that ends within a batch, at any byte, and one with another byte.
    let arrow = server.get(&format!("{RUN}&format=arrow")).await.expect(200).body;
    for end in (0..arrow.len()).step_by(97) {
        let mut changed = arrow.clone();
        changed[end] ^= 0x55;
        for table in [&arrow[..end], &changed] {
            let answer = sent(&server, "application/vnd.apache.arrow.stream", "preset=case-1", table).await;
            assert!([400, 422].contains(&answer.status.as_u16()), "{end}: {}", answer.status);
        }
    }
    // Other resources take JSON alone.
    let other = server.send(Method::POST, "/v1/stability", &[("content-type", "text/csv")], "t\n1").await.expect(415);
    assert_eq!(other.headers["accept"], "application/json");
}
