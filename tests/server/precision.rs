//! Speed against accuracy over HTTP: all methods are present, counts and errors are reproducible, and times are not cached.

#[path = "../../server/physics/tests/support/decimals.rs"]
mod decimals;

use std::time::{Duration, Instant};

use axum::http::Method;
use equipoise_physics::numbers::double_double::DoubleDouble;
use serde_json::{Value, json};
use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;

use crate::support::socket::start;
use crate::support::tables::Table;
use crate::support::{Answer, Server};

const NAMES: [&str; 11] = [
    "map",
    "map_free",
    "linear",
    "extended",
    "adaptive",
    "runge_kutta_bisection",
    "runge_kutta_secant",
    "runge_kutta_step_end",
    "sampling",
    "time_stepping",
    "penalty",
];

const TEN: &str = "/v1/precision?preset=case-1&bounces=10";

fn points(answer: &Answer) -> Vec<Value> {
    answer.json()["points"].as_array().unwrap().clone()
}

fn of(points: &[Value], method: &str) -> Vec<Value> {
    points.iter().filter(|point| point["method"] == method).cloned().collect()
}

fn error(point: &Value) -> f64 {
    point["error"].as_f64().unwrap_or_else(|| panic!("no error: {point}"))
}

fn number(point: &Value, name: &str) -> f64 {
    point[name].as_f64().unwrap_or_else(|| panic!("no {name}: {point}"))
}

/// The part of an answer that does not depend on the clock.
fn counted(points: &[Value]) -> Vec<Value> {
    let names = ["method", "setting", "bounces", "steps", "evaluations", "error", "outcome", "pareto_evaluations"];
    points.iter().map(|point| names.iter().map(|name| point[name].clone()).collect()).collect()
}

#[tokio::test]
async fn every_method_is_charted_and_no_answer_is_kept() {
    let server = Server::start();
    let answer = server.get(TEN).await.expect(200);
    assert_eq!((answer.header("cache-control"), answer.header("etag")), (Some("no-store"), None));
    let again = server.get_with(TEN, &[("if-none-match", "*")]).await.expect(200);
    server.send(Method::HEAD, &format!("{TEN}&methods.0=map"), &[], "").await.expect(200);
    let (points, again) = (points(&answer), points(&again));
    assert_eq!(counted(&points), counted(&again));
    for name in NAMES {
        assert!(!of(&points, name).is_empty(), "{name}");
    }
    for point in &points {
        assert!(number(point, "cost_ns_per_bounce") > 0.0 && number(point, "repeats") >= 1.0, "{point}");
        let spread =
            [&point["spread_ns_per_bounce"][0], &point["spread_ns_per_bounce"][1]].map(|at| at.as_f64().unwrap());
        let cost = number(point, "cost_ns_per_bounce");
        assert!(spread[0] <= cost && cost <= spread[1], "{point}");
        assert_eq!(point["error"].is_null(), !point["reason"].is_null(), "{point}");
    }
}

#[tokio::test]
async fn every_body_is_charted_with_the_methods_that_hold_it() {
    let server = Server::start();
    for (scene, integrates) in [
        ("scene.table.errors.angle_bias=0.002", true),
        ("scene.table.tilt_rate=follows&scene.table.pivot.x=0", true),
        ("scene.air.drag=0.1&scene.air.rotation_drag=0.1", false),
        ("scene.table.delay=0.002", false),
    ] {
        let target = format!("/v1/precision?preset=case-1&scene.release.theta=0.02&bounces=10&{scene}");
        let points = points(&server.get(&target).await.expect(200));
        assert!(error(&of(&points, "map")[0]) < 1e-12, "{scene}");
        for point in of(&points, "runge_kutta_bisection") {
            assert_eq!(point["error"].is_number(), integrates, "{point}");
        }
        if integrates {
            let least = of(&points, "runge_kutta_bisection").iter().map(error).fold(f64::INFINITY, f64::min);
            assert!(least < 1e-10, "{scene}: {least}");
        }
    }
}

/// Counts bound the work, on machines of any speed.
#[tokio::test]
async fn work_is_bounded() {
    let server = Server::start();
    let longest =
        server.get("/v1/precision?preset=case-1&bounces=1000&methods.0=time_stepping&methods.1=sampling").await;
    for point in points(&longest.expect(200)) {
        assert!(number(&point, "steps") <= 1e6, "{point}");
    }
    assert_eq!(server.get("/v1/precision?preset=case-1&bounces=1001").await.expect(422).pointers(), ["/bounces"]);
}

#[tokio::test]
async fn errors_are_those_of_the_methods() {
    let answer = Server::start().get("/v1/precision?preset=case-1&bounces=20").await.expect(200);
    let points = points(&answer);
    for name in ["map", "map_free"] {
        let map = &of(&points, name)[0];
        assert!(error(map) <= 1e-12, "{map}");
        assert_eq!((&map["steps"], &map["error_at"]), (&json!(20), &json!(20)));
    }
    assert!(error(&of(&points, "linear")[0]) > 1e-3, "0.3 rad is no small angle");
    for name in ["runge_kutta_secant", "runge_kutta_step_end", "time_stepping"] {
        let own = of(&points, name);
        let (coarse, fine) = (&own[0], &own[own.len() - 1]);
        assert!(error(coarse) > 10.0 * error(fine), "{coarse} {fine}");
        assert!(number(coarse, "steps") < number(fine, "steps"), "{coarse} {fine}");
    }
    for name in ["adaptive", "runge_kutta_bisection", "sampling"] {
        let map = &of(&points, "map")[0];
        for point in of(&points, name) {
            assert!(error(&point) < 1e-10, "a parabola and a located contact lose nothing: {point}");
            assert!(number(&point, "evaluations") > 20.0 * number(map, "evaluations"), "{point}");
        }
    }
}

/// The Pareto front, computed from cost and error.
#[tokio::test]
async fn the_front_is_what_nothing_beats() {
    let points = points(&Server::start().get(TEN).await.expect(200));
    for (flag, cost) in [("pareto", "cost_ns_per_bounce"), ("pareto_evaluations", "evaluations")] {
        let place = |point: &Value| Some((point[cost].as_f64()?, point["error"].as_f64()?));
        let places: Vec<_> = points.iter().filter_map(place).collect();
        for point in &points {
            let beaten = place(point)
                .is_none_or(|own| places.iter().any(|other| other.0 <= own.0 && other.1 <= own.1 && *other != own));
            assert_eq!(point[flag], !beaten, "{flag}: {point}");
        }
        assert!(points.iter().any(|point| point[flag] == true && point["method"].as_str().unwrap().starts_with("map")));
    }
}

#[tokio::test]
async fn a_run_that_ends_early_is_compared_where_it_ends() {
    let answer =
        Server::start().get("/v1/precision?preset=case-1&scene.table.tilt_gain=3&bounces=100").await.expect(200);
    let reference = &answer.json()["reference"]["outcome"];
    assert!(reference["kind"] != "completed" && reference["bounces"].as_u64().unwrap() < 100, "{reference}");
    let points = points(&answer);
    let map = &of(&points, "map")[0];
    assert_eq!((&map["outcome"]["kind"], &map["error_at"]), (&reference["kind"], &reference["bounces"]));
    assert!(error(map) < 1e-9, "{map}");
    let linear = &of(&points, "linear")[0];
    assert!(linear["error"].is_null() && linear["reason"].as_str().unwrap().contains("reference"), "{linear}");
}

#[tokio::test]
async fn what_cannot_run_says_why() {
    let server = Server::start();
    let points = points(&server.get("/v1/precision?preset=point-mass&bounces=10").await.expect(200));
    assert!(error(&of(&points, "map")[0]) < 1e-12);
    for name in ["linear", "adaptive", "penalty"] {
        for point in of(&points, name) {
            assert_eq!(
                (&point["outcome"]["kind"], &point["cost_ns_per_bounce"]),
                (&json!("unavailable"), &Value::Null)
            );
            assert!(point["reason"].as_str().unwrap().contains("body.point is true"), "{point}");
        }
    }
    // A missing resource is answered at once.
    let target = "/v1/precision?preset=point-mass&bounces=10&methods.0=map&methods.1=adaptive&format=progress";
    let answer = server.get(target).await.expect(200);
    let done: Vec<u64> = answer
        .text()
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).unwrap()["progress"]["done"].as_u64())
        .collect();
    assert_eq!(done, [0, 1, 2, 3, 4, 5, 6, 12]);
}

/// Friction, state feedback and a program of heights, each with its unavailable methods.
#[tokio::test]
async fn larger_models_are_compared_too() {
    let server = Server::start();
    let feedback =
        json!({"tilt_gain": null, "feedback": {"x": 0.05, "theta": -1.2, "x_dot": 0.06, "theta_dot": -0.02}});
    let matched =
        json!({"contact": {"friction": 0.3, "restitution": 0.7}, "table": {"slide": "matched", "tilt_gain": 1.5}});
    for (preset, scene, without) in [
        ("case-1", json!({"table": feedback}), vec!["linear"]),
        ("case-1", json!({"contact": {"friction": 0.05}}), vec!["linear", "penalty"]),
        ("case-1", matched, vec!["linear", "penalty"]),
        ("juggling", json!({}), vec!["linear"]),
    ] {
        let body = json!({"preset": preset, "scene": scene, "bounces": 6});
        let answer = server.post("/v1/precision", &body).await.expect(200);
        let points = points(&answer);
        for name in NAMES {
            let own = of(&points, name);
            assert!(!own.is_empty(), "{name}");
            let unavailable =
                own.iter().all(|point| point["outcome"]["kind"] == "unavailable" && point["reason"].is_string());
            assert_eq!(unavailable, without.contains(&name), "{name}: {body} {}", own[0]);
        }
        for name in ["map", "map_free", "adaptive", "runge_kutta_bisection", "sampling"] {
            for point in of(&points, name) {
                assert!(error(&point) < 1e-10, "{body}: {point}");
            }
        }
    }
    let noisy = server.get("/v1/precision?preset=case-1-noise&bounces=6").await.expect(200).json();
    assert!(noisy["notes"].to_string().contains("without random errors"), "{}", noisy["notes"]);
}

#[tokio::test]
async fn unknown_methods_are_refused_with_those_there_are() {
    let server = Server::start();
    let body = json!({"preset": "case-1", "methods": ["map", "guess", 3]});
    let answer = server.post("/v1/precision", &body).await.expect(422);
    assert_eq!(answer.pointers(), ["/methods/1", "/methods/2"]);
    let detail = answer.json()["errors"][0]["detail"].to_string();
    assert!(NAMES.iter().all(|name| detail.contains(name)), "{detail}");
    let empty = json!({"preset": "case-1", "methods": []});
    assert_eq!(server.post("/v1/precision", &empty).await.expect(422).pointers(), ["/methods"]);
    assert_eq!(server.get("/v1/precision?preset=case-1&axis=luck").await.expect(422).pointers(), ["/axis"]);
}

#[tokio::test]
async fn every_format_has_every_point() {
    let server = Server::start();
    let asked = "/v1/precision?preset=case-1&bounces=10&methods.0=map&methods.1=linear&methods.2=sampling";
    let count = points(&server.get(asked).await.expect(200)).len();
    let table = Table::parse(server.get(&format!("{asked}&format=csv")).await.expect(200).text()).unwrap();
    assert_eq!(table.column("method").len(), count);
    let lines = server.get(&format!("{asked}&format=ndjson")).await.expect(200);
    assert_eq!(lines.text().lines().count(), count + 1);
    for (axis, title) in [("time", "clock time"), ("evaluations", "evaluations of motion and gap")] {
        let picture = server.get(&format!("{asked}&axis={axis}&format=svg")).await.expect(200);
        for part in [title, "Pareto front", "sampled flight", "error at impact 10"] {
            assert!(picture.text().contains(part), "{axis}: {part}");
        }
    }
    let steps = server.get(&format!("{asked}&axis=steps&format=svg")).await.expect(200);
    assert!(steps.text().contains("different work") && !steps.text().contains("Pareto front"), "steps have no front");
    let progress = server.get(&format!("{asked}&format=progress")).await.expect(200);
    assert_eq!((progress.header("cache-control"), progress.header("etag")), (Some("no-store"), None));
    let lines: Vec<Value> = progress.text().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    // One line at the start, one for each run and one for each timing.
    let of = 2 * count;
    let expected: Vec<Value> = (0..=of).map(|done| json!({"progress": {"done": done, "of": of}})).collect();
    assert_eq!(lines[..lines.len() - 1], expected);
    let whole = lines.last().unwrap()["end"]["points"].as_array().unwrap();
    assert_eq!(counted(whole), counted(&points(&server.get(asked).await)));
    // The pictures are of this measurement: each has all points that have an error, by their places in the answer.
    let pictures = lines.last().unwrap()["pictures"].as_object().unwrap();
    let drawn: Vec<usize> = (0..whole.len()).filter(|index| whole[*index]["error"].is_number()).collect();
    for (axis, cost) in [("time", "cost_ns_per_bounce"), ("evaluations", "evaluations"), ("steps", "steps")] {
        let picture = roxmltree::Document::parse(pictures[axis].as_str().unwrap()).unwrap();
        let attributes = |name| picture.descendants().filter_map(move |node| node.attribute(name));
        let numbers: Vec<usize> =
            attributes("data-point").flat_map(|list| list.split(' ')).map(|number| number.parse().unwrap()).collect();
        let has_cost = |index: &usize| whole[*index][cost].as_f64().is_some_and(|cost| cost > 0.0);
        let expected: Vec<usize> = drawn.iter().copied().filter(has_cost).collect();
        assert_eq!(numbers, expected, "{axis}");
        let marks: Vec<&str> = attributes("data-mark").collect();
        let methods: Vec<&str> = expected.iter().map(|index| whole[*index]["method"].as_str().unwrap()).collect();
        assert_eq!(marks, methods, "{axis}");
        assert_eq!(attributes("data-curve").count(), usize::from(axis != "steps"), "{axis}");
    }
    let pixels = server.get(&format!("{asked}&format=png")).await.expect(200);
    assert_eq!((pixels.media_type(), pixels.header("cache-control")), ("image/png", Some("no-store")));
}

#[tokio::test]
async fn what_the_map_alone_looks_at_ends_no_run() {
    let server = Server::start();
    let limited = "preset=triangle-polygon&scene.table.limits.tilt=0&bounces=5&methods.0=map&methods.1=extended";
    let answer = server.get(&format!("/v1/precision?{limited}")).await.expect(200);
    assert!(points(&answer).iter().all(|point| point["outcome"]["kind"] == "completed"), "{}", answer.text());
    let notes = answer.json()["notes"].to_string();
    assert!(notes.contains("table.limits end none of these runs") && notes.contains("no other vertex ends"), "{notes}");
    let run = server.get("/v1/trajectories?preset=triangle-polygon&scene.table.limits.tilt=0").await.json();
    assert_eq!(run["outcome"]["kind"], "beyond_limits");
}

// Methods of a run: the one requested, or the cheapest that holds the tolerance, with a true error estimate.

fn digits_of(value: &Value) -> DoubleDouble {
    match value {
        Value::String(digits) => decimals::number(digits),
        value => DoubleDouble::from(value.as_f64().unwrap()),
    }
}

fn column(answer: &Value, name: &str) -> Vec<DoubleDouble> {
    answer["impacts"][name].as_array().unwrap().iter().map(digits_of).collect()
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
                reference["states"][quantity].as_array().unwrap().iter().map(digits_of).collect();
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
