//! Errors: the right status, one shape, all faults at once, each with a pointer into the JSON body, on GET and POST alike.

use crate::support::Server;
use crate::support::contract::{self, DOCUMENT};
use axum::http::Method;
use serde_json::{Value, json};

const COMPUTE: [&str; 5] = ["/v1/trajectories", "/v1/jacobians", "/v1/stability", "/v1/ensembles", "/v1/controllers"];

#[tokio::test]
async fn what_is_not_json_is_400() {
    let server = Server::start();
    for resource in COMPUTE {
        for body in ["", "{", "{\"preset\": case-1}", "{\"impacts\": NaN}", "{\"preset\": \"case-1\"} x"] {
            let headers = [("content-type", "application/json")];
            server.send(Method::POST, resource, &headers, body).await.expect(400);
        }
        for body in ["[]", "1", "null", "\"case-1\""] {
            let headers = [("content-type", "application/json")];
            server.send(Method::POST, resource, &headers, body).await.expect(422);
        }
        server.get(&format!("{resource}?preset=%zz")).await.expect(400);
    }
}

#[tokio::test]
async fn what_is_not_there_is_404() {
    let server = Server::start();
    for target in ["/v1/nothing", "/v2/trajectories", "/v1/trajectories/", "/v1/scenes/nothing", "/nothing.js", "/../x"]
    {
        let answer = server.get(target).await.expect(404);
        assert_eq!(answer.media_type(), "application/problem+json", "{target}");
    }
}

#[tokio::test]
async fn a_method_that_is_not_there_is_405() {
    let server = Server::start();
    for resource in COMPUTE {
        for method in [Method::PUT, Method::PATCH, Method::DELETE] {
            let answer = server.send(method, resource, &[], "").await.expect(405);
            assert_eq!(answer.header("allow").map(|allow| allow.replace(' ', "")).as_deref(), Some("GET,HEAD,POST"));
        }
    }
    for resource in ["/v1/scenes", "/v1/scenes/case-1", "/v1/fields", "/v1/paper"] {
        let answer =
            server.send(Method::POST, resource, &[("content-type", "application/json")], "{}").await.expect(405);
        assert_eq!(answer.header("allow").map(|allow| allow.replace(' ', "")).as_deref(), Some("GET,HEAD"));
    }
}

#[tokio::test]
async fn a_format_that_is_not_there_is_406() {
    let server = Server::start();
    for (target, there) in [
        ("/v1/trajectories?preset=case-1", "json, csv, ndjson, arrow, svg, png"),
        ("/v1/stability?preset=case-1", "json, csv, ndjson, arrow, svg, png"),
        ("/v1/scenes?", "json"),
        ("/v1/fields?", "json"),
        ("/v1/paper?", "json"),
    ] {
        for format in ["pdf", "gif", "JSON", ""] {
            let answer = server.get(&format!("{target}&format={format}")).await.expect(406);
            assert!(answer.json()["detail"].as_str().unwrap().contains(there), "{target}: {}", answer.text());
        }
        server.get_with(target, &[("accept", "text/plain")]).await.expect(406);
        server.get_with(target, &[("accept", "image/gif, application/json;q=0")]).await.expect(406);
    }
    server.get("/v1/jacobians?preset=case-1&format=svg").await.expect(406);
}

#[tokio::test]
async fn a_body_too_large_is_413_and_one_of_another_kind_415() {
    let server = Server::start();
    let large = format!("{{\"preset\": \"{}\"}}", "x".repeat(2_000_000));
    for resource in COMPUTE {
        server.send(Method::POST, resource, &[("content-type", "application/json")], &large).await.expect(413);
        let body = r#"{"preset": "case-1"}"#;
        for headers in [
            &[][..],
            &[("content-type", "text/plain")],
            &[("content-type", "application/x-www-form-urlencoded")],
            &[("content-type", "application/json; charset=utf-16")],
            &[("content-type", "application/json"), ("content-encoding", "gzip")],
        ] {
            server.send(Method::POST, resource, headers, body).await.expect(415);
        }
        let headers = [("content-type", "application/json; charset=utf-8")];
        server.send(Method::POST, resource, &headers, body).await.expect(200);
    }
}

/// Faults as a query and as a body, with their expected pointers.
fn faults() -> Vec<(&'static str, Value, Vec<&'static str>)> {
    vec![
        ("", json!({}), vec!["/preset", "/scene"]),
        ("preset=nothing", json!({"preset": "nothing"}), vec!["/preset"]),
        ("preset=case-1&bounces=0", json!({"preset": "case-1", "bounces": 0}), vec!["/bounces"]),
        ("preset=case-1&bounces=100001", json!({"preset": "case-1", "bounces": 100_001}), vec!["/bounces"]),
        ("preset=case-1&bounces=1.5", json!({"preset": "case-1", "bounces": 1.5}), vec!["/bounces"]),
        ("preset=case-1&bounces=many", json!({"preset": "case-1", "bounces": "many"}), vec!["/bounces"]),
        ("preset=case-1&impact=3", json!({"preset": "case-1", "impact": 3}), vec!["/impact"]),
        (
            "preset=case-1&scene.table.tilt_gain=5000",
            json!({"preset": "case-1", "scene": {"table": {"tilt_gain": 5000}}}),
            vec!["/scene/table/tilt_gain"],
        ),
        (
            "preset=case-1&scene.table.tilt=1",
            json!({"preset": "case-1", "scene": {"table": {"tilt": 1}}}),
            vec!["/scene/table/tilt"],
        ),
        ("preset=case-1&scene.table=1", json!({"preset": "case-1", "scene": {"table": 1}}), vec!["/scene/table"]),
        (
            "preset=case-1&scene.contact.law=hooke",
            json!({"preset": "case-1", "scene": {"contact": {"law": "hooke"}}}),
            vec!["/scene/contact/law"],
        ),
        (
            "preset=case-1&scene.gravity=-1&scene.contact.restitution=1.5&scene.release.thetadot=1&bounces=0",
            json!({"preset": "case-1", "bounces": 0,
                   "scene": {"gravity": -1, "contact": {"restitution": 1.5}, "release": {"thetadot": 1}}}),
            vec!["/bounces", "/scene/contact/restitution", "/scene/gravity", "/scene/release/thetadot"],
        ),
        (
            "scene.body.contact_distance=0.1&scene.body.radius_of_gyration=0.1",
            json!({"scene": {"body": {"contact_distance": 0.1, "radius_of_gyration": 0.1}}}),
            vec!["/scene/release/height", "/scene/table/tilt_gain"],
        ),
        (
            "preset=case-1&scene.release.height=0.01",
            json!({"preset": "case-1", "scene": {"release": {"height": 0.01}}}),
            vec!["/scene/release/height"],
        ),
    ]
}

#[tokio::test]
async fn faults_are_found_at_once_and_at_the_same_place_on_get_and_post() {
    let server = Server::start();
    for (query, body, expected) in faults() {
        for resource in ["/v1/trajectories", "/v1/stability"] {
            for mut pointers in [
                server.get(&format!("{resource}?{query}")).await.expect(422).pointers(),
                server.post(resource, &body).await.expect(422).pointers(),
            ] {
                pointers.sort();
                // If all of these fields are missing, the error may point to any of them.
                let anywhere = body == json!({}) && !pointers.is_empty();
                assert!(pointers == expected || anywhere, "{resource}?{query}: {pointers:?}, not {expected:?}");
            }
        }
    }
}

#[tokio::test]
async fn a_fault_says_value_limits_and_unit() {
    let server = Server::start();
    for (path, value, words) in [
        ("scene.table.tilt_gain", "5000", &["tilt_gain", "5000", "-100", "100", "no unit"][..]),
        ("scene.release.theta_dot", "201", &["theta_dot", "201", "-200", "200", "rad/s"]),
        ("scene.gravity", "0", &["gravity", "0", "0.1", "100", "m/s²"]),
        ("scene.contact.law", "hooke", &["law", "hooke", "poisson", "newton", "stronge"]),
    ] {
        let answer = server.get(&format!("/v1/trajectories?preset=case-1&{path}={value}")).await.expect(422);
        let problem = answer.json();
        let detail = problem["errors"][0]["detail"].as_str().unwrap();
        for word in words {
            assert!(detail.contains(word), "{path}: {word} is not in {detail:?}");
        }
    }
}

/// A name of version 0.2 is refused, in queries and bodies, with the name that it has since.
#[tokio::test]
async fn an_old_name_is_refused_with_the_new_one() {
    let server = Server::start();
    for (path, old, new) in [
        ("trajectories?preset=case-1", "impacts", "bounces"),
        ("stability?preset=case-1", "impacts", "bounces"),
        ("trajectories?preset=case-1", "epoch", "epoch_ms"),
        ("live/events?preset=case-1", "epoch", "epoch_ms"),
        ("live/events?preset=case-1", "clock.0.wall", "wall_ms"),
        ("probe?target=preset%3Dcase-1%26impacts%3D5", "target.impacts", "bounces"),
    ] {
        let target = if path.contains("%3D") { format!("/v1/{path}") } else { format!("/v1/{path}&{old}=5") };
        let told = server.get(&target).await.expect(422).json();
        let pointer = format!("/{}", old.replace('.', "/"));
        let error = told["errors"].as_array().unwrap().iter().find(|error| error["pointer"] == pointer);
        let detail = error.unwrap_or_else(|| panic!("{target}: {told}"))["detail"].as_str().unwrap();
        assert!(detail.contains(&format!("since 0.3 it is `{new}`")), "{target}: {detail}");
    }
}

#[tokio::test]
async fn every_range_of_the_contract_is_kept() {
    let server = Server::start();
    for (name, schema) in DOCUMENT["components"]["schemas"].as_object().unwrap() {
        let Some(path) = name.strip_prefix("scene.") else { continue };
        let pointer = format!("/{}", name.replace('.', "/"));
        for (limit, outwards) in [("minimum", -1.0), ("maximum", 1.0)] {
            let Some(limit) = schema[limit].as_f64() else { continue };
            let step = if schema["type"] == "integer" { 1.0 } else { f64::max(1.0, limit.abs()) * 1e-9 };
            let ask = async |value: f64| {
                let target = format!("/v1/trajectories?preset=case-1&bounces=1&scene.{path}={value}");
                server.get(&target).await
            };
            let outside = ask(limit + outwards * step).await.expect(422);
            assert!(outside.pointers().contains(&pointer), "{path}: {}", outside.text());
            // A value within its range may contradict another field; the error must then say so.
            let within = ask(limit).await;
            if within.status != 200 {
                let detail = within.expect(422).json()["detail"].to_string();
                assert!(!detail.contains("it must be from") && !detail.contains("not available"), "{path}: {detail}");
            }
        }
    }
}

#[tokio::test]
async fn two_ways_of_saying_one_thing_are_a_fault() {
    let server = Server::start();
    for scene in [
        json!({"body": {"point": true, "contact_distance": 0.1}}),
        json!({"table": {"strike": "still", "energy_gain": 0.1, "target_height": 0.2}}),
        json!({"table": {"energy_gain": 0.1}}),
    ] {
        let answer = server.post("/v1/trajectories", &json!({"preset": "case-1", "scene": scene})).await.expect(422);
        assert!(!answer.pointers().is_empty(), "{}", answer.text());
    }
    // A body of another kind replaces the preset's body whole, so this is no contradiction.
    let point = json!({"preset": "case-1", "scene": {"body": {"point": true}, "release": {"theta": null}}});
    server.post("/v1/trajectories", &point).await.expect(200);
}

#[tokio::test]
async fn only_finite_numbers_are_numbers() {
    let server = Server::start();
    for value in ["NaN", "inf", "-inf", "infinity", "1e999", "0x1", "1_000", "", " 1", "1,5"] {
        let value = value.replace(' ', "%20");
        let target = format!("/v1/trajectories?preset=case-1&scene.table.tilt_gain={value}");
        let answer = server.get(&target).await.expect(422);
        assert_eq!(answer.pointers(), ["/scene/table/tilt_gain"], "{value}");
    }
    let body = r#"{"preset": "case-1", "scene": {"table": {"tilt_gain": 1e999}}}"#;
    let headers = [("content-type", "application/json")];
    let answer = server.send(Method::POST, "/v1/trajectories", &headers, body).await.expect(422);
    assert_eq!(answer.pointers(), ["/scene/table/tilt_gain"]);
}

#[tokio::test]
async fn work_beyond_the_budget_is_refused_with_its_price() {
    let server = Server::start();
    let target = "/v1/trajectories?preset=case-1&bounces=100000&samples_per_flight=256";
    let answer = server.get(target).await.expect(422);
    let digits = answer.json()["detail"].as_str().unwrap().chars().filter(char::is_ascii_digit).count();
    assert!(digits >= 8, "price and limit: {}", answer.text());
}

#[tokio::test]
async fn a_jacobian_has_one_place() {
    let server = Server::start();
    for (query, body, pointer) in [
        ("at=apex", json!({"at": "apex"}), "/at"),
        ("at.impact=0", json!({"at": {"impact": 0}}), "/at/impact"),
        ("at.state.theta=0.1", json!({"at": {"state": {"theta": 0.1}}}), "/at/state"),
        ("at.state.psi=1", json!({"at": {"state": {"psi": 1}}}), "/at/state"),
        ("period=0", json!({"period": 0}), "/period"),
        ("method=guess", json!({"method": "guess"}), "/method"),
    ] {
        let mut whole = body.clone();
        whole["preset"] = json!("case-1");
        let schema = &DOCUMENT["components"]["schemas"]["JacobianRequest"];
        assert!(!contract::faults(schema, &whole).is_empty(), "{query}: the contract allows it");
        let mut get = server.get(&format!("/v1/jacobians?preset=case-1&{query}")).await.expect(422).pointers();
        let mut post = server.post("/v1/jacobians", &whole).await.expect(422).pointers();
        get.sort();
        post.sort();
        assert_eq!(get, post, "{query}");
        assert!(get.iter().all(|found| found.starts_with(pointer)), "{query}: {get:?}");
    }
    // The run does not reach this impact.
    let answer = server.get("/v1/jacobians?preset=case-3&at.impact=5000").await.expect(422);
    assert_eq!(answer.pointers(), ["/at/impact"]);
}
