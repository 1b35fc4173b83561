//! Fits: fields from measured impacts with their intervals, what data cannot tell, data that are wrong, and the limits.

use std::sync::Arc;

use axum::body::Body;
use axum::http::{Method, Request};
use equipoise::api::App;
use equipoise::api::computed::fits::stages;
use equipoise::{limits, router};
use equipoise_physics::fitting::MOST_UNKNOWNS;
use http_body_util::BodyExt;
use serde_json::{Value, json};
use tower::ServiceExt;

use crate::support::tables::Table;
use crate::support::{Answer, Server, number_at};
use crate::verdict::margin;

pub(crate) const FITS: &str = "/v1/fits";
/// Noise of a lab: 2 mrad, 1 ms.
pub(crate) const SD: [(&str, f64); 2] = [("theta", 2e-3), ("t", 1e-3)];

/// Normal deviates by SplitMix64 and Box–Muller.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().max(f64::MIN_POSITIVE).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// Times and angles of the run of a scene on case 1, with so many times the noise of a lab, on a clock that does not start at the release.
pub(crate) async fn measured(server: &Server, scene: &Value, impacts: u64, noise: f64, seed: u64) -> Value {
    let body = json!({"preset": "case-1", "scene": scene, "bounces": impacts});
    let run = server.post("/v1/trajectories", &body).await.expect(200).json();
    let mut random = Noise(seed);
    let mut column = |name: &str, sd: f64, offset: f64| -> Vec<f64> {
        let exact = run["impacts"][name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap());
        exact.map(|value| value + offset + noise * sd * random.normal()).collect()
    };
    json!({"theta": column("theta", SD[0].1, 0.0), "t": column("t", SD[1].1, 12.3)})
}

pub(crate) fn request(measured: Value, scene: Value, unknown: &[&str]) -> Value {
    json!({"preset": "case-1", "scene": scene, "measured": measured, "unknown": unknown})
}

#[tokio::test]
async fn fields_come_from_measured_impacts_with_intervals_and_a_verdict() {
    let server = Server::start();
    let data = measured(&server, &json!({"release": {"theta": 0.2}}), 60, 1.0, 18).await;
    let mut body =
        request(data, json!({"table": {"tilt_gain": 1.14}, "gravity": 9.5}), &["table.tilt_gain", "gravity"]);
    body["sd"] = json!({"theta": SD[0].1, "t": SD[1].1});
    let fit = server.post(FITS, &body).await.expect(200).json();
    assert_eq!(fit["quality"]["kind"], "good", "{fit}");
    for (place, (path, unit, truth)) in [("table.tilt_gain", "1", 1.1), ("gravity", "m/s²", 9.81)].iter().enumerate() {
        let estimate = &fit["estimates"][place];
        assert_eq!((&estimate["field"], &estimate["unit"]), (&json!(path), &json!(unit)));
        assert_eq!(estimate["identifiable"], true);
        let (value, sd) = (number_at(estimate, "/value"), number_at(estimate, "/sd"));
        // Gravity is told by the swing alone, because the speed of the strikes is unknown too.
        assert!((value - truth).abs() < 5.0 * sd && sd < 0.06 * truth, "{estimate}");
        // With given deviations the interval is normal.
        let half = 0.5 * (number_at(estimate, "/interval/1") - number_at(estimate, "/interval/0"));
        assert!((half / sd - 1.959_964).abs() < 1e-5, "{estimate}");
        assert_eq!(number_at(&fit, &format!("/correlation/{place}/{place}")), 1.0);
        let fitted = fit["scene"].pointer(&format!("/{}", path.replace('.', "/")));
        assert_eq!(fitted, Some(&estimate["value"]));
    }
    assert_eq!(fit["correlation"][0][1], fit["correlation"][1][0]);
    // χ² is the sum of the residuals over their deviations, 120 values less 2 fields and the states of the windows.
    let squares: f64 = SD
        .iter()
        .flat_map(|(name, sd)| {
            fit["residuals"][name].as_array().unwrap().iter().map(move |value| (value.as_f64().unwrap() / sd).powi(2))
        })
        .sum();
    assert!((squares / number_at(&fit, "/chi_squared") - 1.0).abs() < 1e-9, "{squares}");
    let freedom = number_at(&fit, "/degrees_of_freedom");
    assert!((90.0..=118.0).contains(&freedom), "{freedom}");
    assert!(fit["residuals"]["x"].as_array().unwrap().iter().all(Value::is_null));
    // The verdict and its margins are those of /v1/stability for the fitted scene.
    let alone = server.post("/v1/stability", &json!({"scene": fit["scene"]})).await.expect(200).json();
    assert_eq!(fit["stability"]["verdict"], alone["verdict"]);
    assert_eq!(fit["stability"]["nonlinear"], alone["nonlinear"]);
    let (own, alone) = (margin(&fit["stability"], "table.tilt_gain"), margin(&alone, "table.tilt_gain"));
    assert!(fit["stability"]["spectral_margin"].is_null(), "{}", fit["stability"]);
    for side in ["below", "above"] {
        let margin = &own[side];
        assert_eq!((&margin["limit"], &margin["margin"]), (&alone[side]["limit"], &alone[side]["margin"]));
        let (value, sd) = (number_at(margin, "/margin"), number_at(margin, "/sd"));
        let (least, most) = (number_at(margin, "/least"), number_at(margin, "/most"));
        // The ends of the region lie 2.45 standard deviations off, in two dimensions.
        assert!(least < value && value < most && value - least < 2.6 * sd && most - value < 2.6 * sd, "{margin}");
    }
    assert_eq!(fit["stability"]["holds"], true, "{}", fit["stability"]);
}

#[tokio::test]
async fn margins_over_the_region_do_not_depend_on_the_order_of_the_fields() {
    let server = Server::start();
    let data = measured(&server, &json!({"release": {"theta": 0.2}}), 60, 1.0, 3).await;
    let mut found = Vec::new();
    for unknown in [["table.tilt_gain", "body.radius_of_gyration"], ["body.radius_of_gyration", "table.tilt_gain"]] {
        let mut body = request(data.clone(), json!({}), &unknown);
        body["sd"] = json!({"theta": SD[0].1, "t": SD[1].1});
        found.push(server.post(FITS, &body).await.expect(200).json()["stability"]["margins"].clone());
    }
    assert_eq!(found[0].as_array().unwrap().len(), 1, "{found:?}");
    for side in ["below", "above"] {
        let [one, other] = [0, 1].map(|order| &found[order][0][side]);
        let sd = number_at(one, "/sd");
        for name in ["/margin", "/sd", "/least", "/most"] {
            assert!((number_at(one, name) - number_at(other, name)).abs() < 0.1 * sd, "{name}: {one} {other}");
        }
        assert!(number_at(one, "/margin") - number_at(one, "/least") > 2.2 * sd, "{one}");
    }
}

#[tokio::test]
async fn exact_data_give_the_exact_fields() {
    let server = Server::start();
    let truth = json!({"release": {"theta": 0.2}, "table": {"tilt_gain": 1.234}});
    let data = measured(&server, &truth, 30, 0.0, 1).await;
    let fit = server.post(FITS, &request(data, json!({}), &["table.tilt_gain"])).await.expect(200).json();
    assert!((number_at(&fit, "/estimates/0/value") - 1.234).abs() < 1e-5, "{}", fit["estimates"]);
}

#[tokio::test]
async fn a_field_that_the_data_do_not_tell_has_a_reason_in_place_of_an_interval() {
    let server = Server::start();
    let swinging = measured(&server, &json!({"release": {"theta": 0.2}}), 40, 1.0, 6).await;
    // Without a swing no data tell κ, whatever a fit finds in their noise.
    let upright = measured(&server, &json!({"release": {"theta": 0}}), 60, 1.0, 40).await;
    for (data, path, word) in
        [(swinging, "contact.restitution", "makes up"), (upright, "table.tilt_gain", "table.tilt_gain")]
    {
        let fit = server.post(FITS, &request(data, json!({}), &[path])).await.expect(200).json();
        let estimate = &fit["estimates"][0];
        assert_eq!(estimate["identifiable"], false, "{estimate}");
        assert!(estimate["sd"].is_null() && estimate["interval"].is_null(), "{estimate}");
        assert!(estimate["detail"].as_str().unwrap().contains(word), "{estimate}");
        assert_eq!(fit["correlation"], json!([[null]]));
        assert!(fit["stability"]["holds"].is_null());
        // The scene keeps its value.
        let preset = server.get("/v1/scenes/case-1").await.json();
        let pointer = format!("/{}", path.replace('.', "/"));
        assert_eq!(fit["scene"].pointer(&pointer), preset["scene"].pointer(&pointer));
    }
}

#[tokio::test]
async fn outliers_and_missed_impacts_are_named() {
    let server = Server::start();
    let scene = json!({"release": {"theta": 0.2}});
    let clean = measured(&server, &scene, 40, 1.0, 9).await;
    let mut wrong = clean.clone();
    wrong["theta"][10] = json!(clean["theta"][10].as_f64().unwrap() + 0.1);
    let fit = server.post(FITS, &request(wrong, json!({}), &["table.tilt_gain"])).await.expect(200).json();
    let flags = fit["residuals"]["outlier"].as_array().unwrap();
    assert_eq!(flags.iter().position(|flag| flag == true), Some(10));
    assert!(fit["notes"].to_string().contains("row 11"), "{}", fit["notes"]);
    let mut missed = clean;
    for name in ["theta", "t"] {
        missed[name].as_array_mut().unwrap().remove(17);
    }
    let fit = server.post(FITS, &request(missed, json!({}), &["table.tilt_gain"])).await.expect(200).json();
    assert!(fit["notes"].to_string().contains("missed"), "{}", fit["notes"]);
    assert_eq!(fit["residuals"]["n"].as_array().unwrap().last(), Some(&json!(40)));
}

#[tokio::test]
async fn wrong_data_are_refused_by_column_and_row() {
    let server = Server::start();
    let good = measured(&server, &json!({"release": {"theta": 0.2}}), 20, 1.0, 2).await;
    let first = |name: &str, count: usize| json!(good[name].as_array().unwrap()[..count]);
    let degrees: Vec<f64> = good["theta"].as_array().unwrap().iter().map(|it| 57.3 * it.as_f64().unwrap()).collect();
    let milliseconds: Vec<f64> = good["t"].as_array().unwrap().iter().map(|it| 1e3 * it.as_f64().unwrap()).collect();
    let changes = [
        ("/measured/theta/3", json!("0.1 rad"), "/measured/theta/3", "must be a number"),
        ("/measured/theta/3", json!(true), "/measured/theta/3", "must be a number"),
        ("/measured/t/3", json!(0.0), "/measured/t/3", "rise"),
        ("/measured/t", Value::Null, "/measured/t", "missing"),
        ("/measured/t", json!([]), "/measured/t", "no values"),
        ("/measured/t", json!(vec![Value::Null; 20]), "/measured/t", "no values"),
        ("/measured/t", json!(1.5), "/measured/t", "array"),
        ("/measured/t", json!(milliseconds), "/measured/t", "ms"),
        ("/measured/theta", json!(degrees), "/measured/theta/", "degrees"),
        ("/measured/theta", first("theta", 19), "/measured/theta", "19"),
        ("/measured", json!({"t": [0.1]}), "/measured", "at least 2"),
        ("/measured", json!({"t": first("t", 3), "theta": first("theta", 3)}), "/measured", "values"),
        ("/measured", Value::Null, "/measured", "missing"),
        ("/measured/n", json!([1, 2]), "/measured/n", "2"),
        ("/measured/n", json!((0..20).map(|n| 20 - n).collect::<Vec<_>>()), "/measured/n/1", "rise"),
        ("/measured/n", json!([0.5]), "/measured/n/0", "whole number"),
        ("/measured/height", json!([1]), "/measured/height", "unknown field"),
        ("/unknown", json!([]), "/unknown", "empty"),
        ("/unknown", Value::Null, "/unknown", "missing"),
        ("/unknown", json!(["table.kappa"]), "/unknown/0", "no field"),
        ("/unknown", json!([1]), "/unknown/0", "text"),
        ("/unknown", json!(["gravity", "gravity"]), "/unknown/1", "twice"),
        ("/unknown", json!(["contact.law"]), "/unknown/0", "no number"),
        ("/unknown", json!(["noise.timing_sd"]), "/unknown/0", "no number"),
        ("/unknown", json!(["table.assumed_restitution"]), "/unknown/0", "first guess"),
        ("/sd", json!({"t": 0}), "/sd/t", "0.000000001"),
        ("/sd", json!({"t": "1 ms"}), "/sd/t", "must be a number"),
        ("/sd", json!({"height": 0.1}), "/sd/height", "unknown field"),
        ("/impacts", json!(5), "/impacts", "unknown field"),
    ];
    for (place, value, pointer, word) in changes {
        let mut body = request(good.clone(), json!({}), &["table.tilt_gain"]);
        let (parent, name) = place.rsplit_once('/').unwrap();
        match body.pointer_mut(parent).unwrap() {
            Value::Array(items) => items[name.parse::<usize>().unwrap()] = value,
            parent => parent[name] = value,
        }
        let answer = server.post(FITS, &body).await.expect(422);
        let pointers = answer.pointers();
        assert!(pointers.iter().any(|found| found.starts_with(pointer)), "{place}: {pointers:?} {}", answer.text());
        assert!(answer.text().contains(word), "{place}: no {word:?} in {}", answer.text());
    }
    // All faults of the form at once.
    let faults = json!({"preset": "case-1", "measured": {"t": ["a", 1, "b"]}, "unknown": ["x"], "sd": {"t": -1}});
    let pointers = server.post(FITS, &faults).await.expect(422).pointers();
    assert_eq!(pointers, ["/measured/t/0", "/measured/t/2", "/unknown/0", "/sd/t"]);
    // A JSON number cannot be NaN.
    let headers = [("content-type", "application/json")];
    let nan = r#"{"preset": "case-1", "measured": {"t": [NaN]}, "unknown": ["gravity"]}"#;
    server.send(Method::POST, FITS, &headers, nan).await.expect(400);
}

#[tokio::test]
async fn rows_unknowns_and_work_have_limits() {
    let server = Server::start();
    let times = |count: usize| (0..count).map(|n| n as f64 * 0.23).collect::<Vec<_>>();
    let rows = request(json!({"t": times(limits::FIT_IMPACTS + 1)}), json!({}), &["gravity"]);
    let answer = server.post(FITS, &rows).await.expect(422);
    assert_eq!(answer.pointers(), ["/measured/t"]);
    assert!(answer.text().contains(&limits::FIT_IMPACTS.to_string()), "{}", answer.text());
    let many = request(json!({"t": times(20)}), json!({}), &["gravity"; MOST_UNKNOWNS + 1]);
    let answer = server.post(FITS, &many).await.expect(422);
    assert_eq!(answer.pointers(), ["/unknown"]);
    // Ten million impacts lie between two measured ones.
    let mut far = request(json!({"t": times(3)}), json!({}), &["gravity"]);
    far["measured"]["n"] = json!([1, 2, limits::BOUNCES]);
    let answer = server.post(FITS, &far).await.expect(422);
    assert!(answer.text().contains("bounces"), "{}", answer.text());
}

#[tokio::test]
async fn residuals_are_the_rows_of_every_format() {
    let server = Server::start();
    let data = measured(&server, &json!({"release": {"theta": 0.2}}), 30, 1.0, 4).await;
    let body = request(data, json!({}), &["table.tilt_gain"]);
    let json = server.post(FITS, &body).await.expect(200).json();
    let csv = server.post(&format!("{FITS}?format=csv"), &body).await.expect(200);
    let table = Table::parse(csv.text()).unwrap();
    let names = [
        "n",
        "row",
        "window",
        "theta_rad",
        "x_dot_m_per_s",
        "y_dot_m_per_s",
        "theta_dot_rad_per_s",
        "x_m",
        "t_s",
        "outlier",
    ];
    assert_eq!((table.names.as_slice(), table.rows.len()), (names.map(str::to_owned).as_slice(), 30));
    let ndjson = server.post(&format!("{FITS}?format=ndjson"), &body).await.expect(200);
    let lines: Vec<Value> = ndjson.text().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 31);
    for (row, line) in lines[..30].iter().enumerate() {
        assert_eq!(line["theta"], json["residuals"]["theta"][row]);
    }
    for name in ["estimates", "chi_squared", "quality", "scene", "stability", "notes"] {
        assert_eq!(lines[30]["end"][name], json[name]);
    }
    let svg = server.post(&format!("{FITS}?format=svg"), &body).await.expect(200);
    assert!(svg.text().contains("table.tilt_gain ="), "{:.600}", svg.text());
    server.post(&format!("{FITS}?format=png"), &body).await.expect(200);
    // A request is too large for an address.
    let asked = server.get(FITS).await.expect(405);
    assert_eq!(asked.header("allow"), Some("POST"));
}

#[tokio::test]
async fn the_same_data_give_the_same_bytes_and_other_data_another_tag() {
    let server = Server::start();
    let data = measured(&server, &json!({"release": {"theta": 0.2}}), 20, 1.0, 5).await;
    let body = request(data, json!({}), &["table.tilt_gain"]);
    let first = server.post(FITS, &body).await.expect(200);
    let again = Server::start().post(FITS, &body).await.expect(200);
    assert_eq!((first.etag(), &first.raw), (again.etag(), &again.raw));
    let mut tags = vec![first.etag().to_owned()];
    for (place, value) in [
        ("/measured/t/0", json!(12.0)),
        ("/unknown/0", json!("gravity")),
        ("/sd", json!({"t": 0.001})),
        ("/scene", json!({"release": {"theta": 0.1}})),
        ("/measured/n", json!((2..22).collect::<Vec<_>>())),
    ] {
        let mut other = body.clone();
        let (parent, name) = place.rsplit_once('/').unwrap();
        match other.pointer_mut(parent).unwrap() {
            Value::Array(items) => items[name.parse::<usize>().unwrap()] = value,
            parent => parent[name] = value,
        }
        tags.push(server.post(FITS, &other).await.expect(200).etag().to_owned());
    }
    let count = tags.len();
    tags.sort();
    tags.dedup();
    assert_eq!(tags.len(), count);
}

/// Jobs under way.
async fn running(server: &Server) -> bool {
    !server.get("/metrics").await.text().contains("equipoise_jobs_running 0")
}

#[tokio::test]
async fn a_client_that_leaves_ends_the_work() {
    let server = Arc::new(Server::start());
    let data = measured(&server, &json!({"release": {"theta": 0.2}}), 1000, 1.0, 7).await;
    let unknown = ["table.tilt_gain", "body.radius_of_gyration", "gravity"];
    let (asked, body) = (server.clone(), request(data, json!({}), &unknown));
    let first = tokio::spawn(async move { asked.post(FITS, &body).await });
    while !running(&server).await {
        assert!(!first.is_finished(), "the work is too short to be seen");
        tokio::task::yield_now().await;
    }
    first.abort();
    while running(&server).await {
        tokio::task::yield_now().await;
    }
}

// Fits of tables: what trajectories write is read as the JSON that has the same columns.

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

// Progress of fits: lines that rise to the end, a problem in place of the end, and a reader that leaves.

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
