//! Methods of a run: the one requested, or the cheapest that holds the tolerance, with a true error estimate.

#[path = "../../server/physics/tests/support/decimals.rs"]
mod decimals;

use std::time::{Duration, Instant};

use crate::support::socket::start;
use crate::support::{Answer, Server};
use equipoise_physics::numbers::double_double::DoubleDouble;
use serde_json::{Value, json};
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;

fn number(value: &Value) -> DoubleDouble {
    match value {
        Value::String(digits) => decimals::number(digits),
        value => DoubleDouble::from(value.as_f64().unwrap()),
    }
}

fn column(answer: &Value, name: &str) -> Vec<DoubleDouble> {
    answer["impacts"][name].as_array().unwrap().iter().map(number).collect()
}

/// Largest of |ρδθ|, |δẋ|, |δẏ| and |ρδθ̇| at each impact.
fn errors(answer: &Value, exact: &Value) -> Vec<f64> {
    let rho = answer["scene"]["body"]["radius_of_gyration"].as_f64().unwrap_or(0.0);
    let mut largest = Vec::new();
    for (name, scale) in [("theta", rho), ("x_dot", 1.0), ("y_dot", 1.0), ("theta_dot", rho)] {
        let pairs = column(answer, name).into_iter().zip(column(exact, name));
        let errors: Vec<f64> = pairs.map(|(value, exact)| scale * (value - exact).to_f64().abs()).collect();
        largest.resize(errors.len(), 0.0);
        largest.iter_mut().zip(errors).for_each(|(largest, error)| *largest = f64::max(*largest, error));
    }
    largest
}

/// All reference runs with 60 digits and without friction.
fn references() -> Vec<(String, Value)> {
    let files = std::fs::read_dir("tests/reference").unwrap().map(|entry| entry.unwrap().path());
    let named = files.map(|file| (file.file_stem().unwrap().to_string_lossy().into_owned(), file));
    let plain = named.filter(|(name, _)| !name.starts_with("friction"));
    let read = |file| serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    plain.map(|(name, file)| (name, read(file))).collect()
}

#[tokio::test]
async fn extended_gives_the_references_digit_by_digit() {
    let server = Server::start();
    for (name, reference) in references() {
        let request = json!({"scene": reference["scene"], "bounces": reference["impacts"], "method": "extended"});
        let answer = server.post("/v1/trajectories", &request).await.expect(200).json();
        assert_eq!(answer["outcome"]["kind"], reference["outcome"], "{name}");
        let plain = reference["plain_double_error"].as_f64().unwrap();
        for quantity in ["t", "x", "theta", "x_dot", "y_dot", "theta_dot"] {
            let exact: Vec<DoubleDouble> =
                reference["states"][quantity].as_array().unwrap().iter().map(number).collect();
            let values = column(&answer, quantity);
            assert_eq!(values.len(), exact.len(), "{name}: {quantity}");
            for (value, exact) in values.into_iter().zip(exact) {
                let (error, size) = ((value - exact).to_f64().abs(), exact.to_f64().abs());
                // The reference has 25 digits.
                let allowed = f64::max(1e-23 * size, plain * 1e-15).max(1e-25);
                assert!(error <= allowed, "{name}: {quantity} is {value}, off by {error:e}, allowed {allowed:e}");
            }
        }
    }
}

/// Scenes beyond the plain rod: the first impacts are those of the map, but for rounding, and both runs end alike.
#[tokio::test]
async fn extended_takes_every_scene() {
    let server = Server::start();
    let feedback =
        json!({"tilt_gain": null, "feedback": {"x": 0.05, "theta": -1.2, "x_dot": 0.06, "theta_dot": -0.02}});
    for scene in [
        json!({"table": feedback}),
        json!({"table": feedback, "contact": {"friction": 0.3}, "release": {"theta": 0.05}}),
        json!({"noise": {"timing_sd": 0.005, "angle_sd": 0.002}}),
        json!({"noise": {"timing_sd": 0.005, "angle_sd": 0.002, "model": "plan"}, "table": feedback}),
        json!({"table": {"limits": {"tilt": 0.5, "speed": 3}}}),
    ] {
        let run = async |method: &str| {
            let request = json!({"preset": "case-1", "scene": scene, "bounces": 40, "method": method});
            server.post("/v1/trajectories", &request).await.expect(200).json()
        };
        let (map, exact) = (run("map").await, run("extended").await);
        assert_eq!(map["outcome"]["kind"], exact["outcome"]["kind"], "{scene}");
        assert_eq!(map["outcome"]["bounces"], exact["outcome"]["bounces"], "{scene}");
        for quantity in ["t", "x", "theta", "x_dot", "y_dot", "theta_dot", "alpha", "energy"] {
            let (ours, its) = (column(&map, quantity), column(&exact, quantity));
            for (ours, its) in ours.into_iter().zip(its).take(5) {
                assert!((ours - its).to_f64().abs() <= 1e-11, "{quantity}: {ours} and {its}, {scene}");
            }
        }
        let estimates = map["impacts"]["error_estimate"].as_array().unwrap();
        for (n, (error, estimate)) in errors(&map, &exact).into_iter().zip(estimates).enumerate() {
            let Some(estimate) = estimate.as_f64().filter(|estimate| *estimate < 1e-3) else { continue };
            assert!(error <= estimate, "contact {} is off by {error:e}, estimated {estimate:e}, {scene}", n + 1);
        }
        assert!(estimates[2].as_f64().is_some_and(|estimate| estimate < 1e-9), "{scene}: {}", estimates[2]);
        for (tolerance, method) in [(1e-8, "map"), (1e-20, "extended")] {
            let request = json!({"preset": "case-1", "scene": scene, "bounces": 5, "tolerance": tolerance});
            let answer = server.post("/v1/trajectories", &request).await.expect(200).json();
            assert_eq!(answer["method"]["name"], method, "{scene}");
            assert_eq!(answer["predictable_bounces"], Value::Null, "{scene}");
        }
        let (ours, its) = (&map["impacts"]["clearance"], &exact["impacts"]["clearance"]);
        for (ours, its) in ours.as_array().unwrap().iter().zip(its.as_array().unwrap()).take(5) {
            assert!((ours.as_f64().unwrap() - its.as_f64().unwrap()).abs() <= 1e-12, "{ours} and {its}, {scene}");
        }
    }
}

#[tokio::test]
async fn error_estimates_hold_and_are_not_idle() {
    let server = Server::start();
    let mut ratios = Vec::new();
    for (name, reference) in references() {
        let run = async |method: &str| {
            let request = json!({"scene": reference["scene"], "bounces": reference["impacts"], "method": method});
            server.post("/v1/trajectories", &request).await.expect(200).json()
        };
        let (map, exact) = (run("map").await, run("extended").await);
        let estimates = map["impacts"]["error_estimate"].as_array().unwrap();
        for (n, (error, estimate)) in errors(&map, &exact).into_iter().zip(estimates).enumerate() {
            let Some(estimate) = estimate.as_f64().filter(|estimate| *estimate < 1e-3) else { continue };
            assert!(error <= estimate, "{name}: contact {} is off by {error:e}, estimated {estimate:e}", n + 1);
            ratios.push(estimate / error.max(2.3e-16));
        }
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    println!("{} estimates, median {median:.1} times the error", ratios.len());
    assert!(median <= 100.0, "{median}");
}

#[tokio::test]
async fn auto_takes_the_cheapest_that_holds_the_tolerance() {
    let server = Server::start();
    let ask =
        async |query: &str| server.get(&format!("/v1/trajectories?preset=case-1&{query}")).await.expect(200).json();
    for (query, name) in [
        ("bounces=100", "map"),
        ("bounces=100&tolerance=1e-9", "map"),
        ("bounces=5000&tolerance=1e-6&scene.release.theta=1e-4", "map"),
        ("bounces=1000&tolerance=1e-20", "extended"),
    ] {
        let answer = ask(query).await;
        assert_eq!(answer["method"]["name"], name, "{query}");
        let exact = ask(&format!("{query}&method=extended")).await;
        let tolerance = query.split('&').find_map(|part| part.strip_prefix("tolerance=")?.parse::<f64>().ok());
        if let Some(tolerance) = tolerance {
            let worst = errors(&answer, &exact).into_iter().fold(0.0, f64::max);
            assert!(worst <= tolerance, "{query}: {worst:e}");
            assert_eq!(answer["predictable_bounces"], Value::Null);
        }
    }
}

#[tokio::test]
async fn an_impossible_tolerance_is_refused_with_the_horizon() {
    let server = Server::start();
    let chaotic = "/v1/trajectories?preset=case-1&scene.table.tilt_gain=1.55&scene.release.theta=0.02";
    let refused = server.get(&format!("{chaotic}&bounces=1000&tolerance=1e-3")).await.expect(422);
    assert_eq!(refused.pointers(), ["/tolerance"]);
    let detail = refused.json()["errors"][0]["detail"].as_str().unwrap().to_owned();
    let horizon: u64 = detail.split("at most ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((100..1000).contains(&horizon), "{detail}");
    server.get(&format!("{chaotic}&bounces={horizon}&tolerance=1e-3")).await.expect(200);
    // Without a tolerance the run is computed, with its predictable impacts.
    let run = server.get(&format!("{chaotic}&bounces={horizon}")).await.expect(200).json();
    let predictable = run["predictable_bounces"].as_u64().unwrap();
    assert!(predictable > 10 && predictable < horizon, "{predictable} of {horizon}");
    for (query, pointer) in [("tolerance=0", "/tolerance"), ("tolerance=2", "/tolerance"), ("method=euler", "/method")]
    {
        assert_eq!(server.get(&format!("{chaotic}&{query}")).await.expect(422).pointers(), [pointer]);
    }
    let still = server.get("/v1/trajectories?preset=still-lossy&method=linear").await.expect(422);
    assert_eq!(still.pointers(), ["/method"]);
    assert!(still.text().contains("does not apply"), "{}", still.text());
}

#[tokio::test]
async fn decimals_are_the_same_in_every_format() {
    let server = Server::start();
    let ask = async |format: &str| -> Answer {
        let target = "/v1/trajectories?preset=case-3&bounces=60&method=extended&samples_per_flight=2&format=";
        server.get(&format!("{target}{format}")).await.expect(200)
    };
    let json = ask("json").await.json();
    let digits = json["impacts"]["theta"][7].as_str().unwrap();
    assert!(digits.len() > 30, "{digits}");
    assert_eq!(json["impacts"]["flight_time"].as_array().unwrap().last(), Some(&Value::Null));
    assert!(ask("csv").await.text().contains(&format!(",{digits},")));
    assert!(ask("ndjson").await.text().contains(&format!("\"theta\":\"{digits}\"")));
    assert!(ask("svg").await.text().starts_with("<svg"));
}

/// Exactly upright no deviation can grow, for any κ beyond the critical value.
#[tokio::test]
async fn the_linear_solution_keeps_an_upright_body_upright() {
    let server = Server::start();
    for tilt_gain in [1.6, 30.0] {
        let query =
            format!("preset=case-1&scene.release.theta=0&scene.table.tilt_gain={tilt_gain}&bounces=5000&method=linear");
        let run = server.get(&format!("/v1/trajectories?{query}")).await.expect(200).json();
        assert_eq!((&run["outcome"]["kind"], &run["outcome"]["bounces"]), (&json!("completed"), &json!(5000)));
        for name in ["theta", "x_dot", "y_dot", "theta_dot", "error_estimate"] {
            let largest = run["impacts"][name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap().abs());
            let largest = largest.fold(0.0, f64::max);
            assert!(largest < if name == "y_dot" { 2.0 } else { 1e-9 }, "κ = {tilt_gain}: {name} {largest}");
        }
    }
}

/// The price assumes a run to its last contact. Even so, the longest run is within the work of a request.
#[tokio::test]
async fn the_longest_run_may_be_asked_for_by_every_method() {
    let server = Server::start();
    for method in ["method=map", "method=linear", "method=extended", "tolerance=1e-3", "tolerance=1e-20"] {
        let target = format!(
            "/v1/trajectories?preset=case-1&scene.release.theta=0.9&scene.topple_angle=0.8&bounces=100000&{method}"
        );
        let run = server.get(&target).await.expect(200).json();
        assert_eq!(run["outcome"]["kind"], "toppled", "{method}");
    }
    server.get("/v1/trajectories?preset=critical-hard&bounces=100000&method=linear").await.expect(200);
}

/// A client that hangs up frees the core, both while the run is computed and while its answer is written, in any format.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_answer_ends_with_its_reader() {
    let (app, address) = start().await;
    for (is_written, request) in [
        (false, "method=extended&format=json"),
        (false, "tolerance=1e-14&format=csv"),
        (true, "method=extended&format=json"),
        (true, "method=extended&format=csv"),
        (true, "method=extended&format=ndjson"),
        (true, "method=map&format=json"),
    ] {
        let computed = app.metrics.bounces.get();
        let mut socket = TcpStream::connect(address).await.unwrap();
        let target = format!("/v1/trajectories?preset=case-1&bounces=100000&{request}");
        socket.write_all(format!("GET {target} HTTP/1.1\r\nhost: localhost\r\n\r\n").as_bytes()).await.unwrap();
        while app.pool.running().get() == 0 || (is_written && app.metrics.bounces.get() == computed) {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
        drop(socket);
        let left = Instant::now();
        // A few ms on an idle machine.
        while app.pool.running().get() > 0 {
            assert!(left.elapsed() < Duration::from_secs(1), "{request}: the work goes on for nobody");
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
        println!("{request}, written {is_written}: given up after {:.1} ms", 1e3 * left.elapsed().as_secs_f64());
    }
}
