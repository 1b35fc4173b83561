//! Speed against accuracy over HTTP: all methods are present, counts and errors are reproducible, and times are not cached.

use crate::support::csv::Table;
use crate::support::{Answer, Server};
use axum::http::Method;
use serde_json::{Value, json};

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
