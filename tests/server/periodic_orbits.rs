//! Periodic orbits over HTTP: the orbit, its branch in every format, and refusals that say why.

use crate::support::Server;
use crate::support::tables::Table;
use serde_json::{Value, json};

const SOFT: &str = "/v1/periodic-orbits?preset=case-1&family=symmetric&theta=0.05&sweep.field=table.tilt_gain\
                    &sweep.from=1.4&sweep.to=1.7&sweep.points=120";

#[tokio::test]
async fn the_branch_springs_from_the_critical_gain_in_every_format() {
    let server = Server::start();
    let answer = server.get(SOFT).await.expect(200).json();
    let change = &answer["changes"][0];
    assert_eq!(change["kind"], "period_doubling");
    assert!((change["value"].as_f64().unwrap() - 1.5).abs() < 1e-10, "{change}");
    assert_eq!(answer["changes"][1]["kind"], "pitchfork");
    let count = answer["branch"]["value"].as_array().unwrap().len();
    let table = Table::parse(server.get(&format!("{SOFT}&format=csv")).await.expect(200).text()).unwrap();
    assert_eq!(table.column("value").len(), count);
    let lines = server.get(&format!("{SOFT}&format=ndjson")).await.expect(200);
    assert_eq!(lines.text().lines().count(), count + 1);
    let picture = server.get(&format!("{SOFT}&format=svg")).await.expect(200);
    assert!(picture.text().contains("stroke-dasharray=\"6 4\"") && picture.text().contains("= 1.5"));
}

#[tokio::test]
async fn an_orbit_is_answered_with_its_evidence() {
    let body =
        json!({"preset": "case-1", "scene": {"table": {"tilt_gain": 1.55}}, "family": "symmetric", "theta": 0.2});
    let answer = Server::start().post("/v1/periodic-orbits", &body).await.expect(200).json();
    assert!(answer["residual"].as_f64().unwrap() < 1e-12 && answer["drift"].as_f64().unwrap().abs() < 1e-12);
    assert_eq!((&answer["period"], &answer["least_period"]), (&json!(2), &json!(2)));
    assert_eq!(answer["branch"], Value::Null);
}

#[tokio::test]
async fn that_nothing_repeats_is_an_answer() {
    let server = Server::start();
    for (query, moves) in [
        ("preset=still-lossy&period=1", &["y_dot"][..]),
        ("preset=case-1&scene.air.drag=0.05", &["y_dot"]),
        ("preset=case-1&scene.contact.restitution=0.9&scene.table.assumed_restitution=0.95", &["y_dot"]),
        ("preset=case-1&scene.table.errors.angle_bias=0.001", &["x_dot", "y_dot"]),
        ("preset=case-1&scene.body.offset=0.001", &["x_dot", "y_dot"]),
    ] {
        let answer = server.get(&format!("/v1/periodic-orbits?{query}")).await.expect(200).json();
        let found = &answer["nothing_repeats"];
        assert!(found["reason"].as_str().unwrap().contains("beside the upright bounce"), "{query}: {answer}");
        assert_eq!((&answer["least_period"], &answer["states"]["theta"]), (&Value::Null, &json!([])), "{query}");
        let change = found["moves"]["change"].as_object().unwrap();
        let moved: Vec<_> = change.iter().filter(|(_, by)| by.as_f64().unwrap().abs() > 1e-6).collect();
        let mut named: Vec<_> = moved.iter().map(|(name, _)| name.as_str()).collect();
        named.sort_unstable();
        assert_eq!(named, moves, "{query}: {found}");
        // The map from that state, as another resource computes it.
        let at = |part: &str| found["moves"]["state"][part].as_f64().unwrap();
        let state = ["theta", "x_dot", "y_dot", "theta_dot"].map(|part| format!("&at.state.{part}={}", at(part)));
        let from = format!("/v1/jacobians?{}{}", query.replace("&period=1", ""), state.concat());
        let jacobian = server.get(&from).await.expect(200).json();
        let (told, again) = (found["moves"]["flight_time"].as_f64(), jacobian["flight_time"].as_f64());
        assert!((told.unwrap() - again.unwrap()).abs() < 1e-12, "{query}: {told:?} {again:?}");
    }
    let table = server.get("/v1/periodic-orbits?preset=still-lossy&format=csv").await.expect(200);
    assert_eq!(table.text().lines().count(), 1, "{}", table.text());
    let swept = "preset=still-lossy&sweep.field=table.tilt_gain&sweep.from=1.1&sweep.to=1.2";
    server.get(&format!("/v1/periodic-orbits?{swept}")).await.expect(422);
}

#[tokio::test]
async fn what_has_no_answer_is_refused_with_its_reason() {
    let server = Server::start();
    for (query, pointer, part) in [
        ("preset=point-mass&family=symmetric&theta=0.1", "/family", "a body with an angle of its own"),
        ("preset=point-mass&guess.theta=0.1&guess.y_dot=-1", "/guess", "no theta"),
        ("preset=case-1&period=2", "", "give a guess"),
        ("preset=case-1&theta=0.1", "/theta", "family"),
        ("preset=case-1&period=65", "/period", "64"),
        ("preset=case-1&period=3&guess.theta=0.9&guess.y_dot=-0.2&guess.theta_dot=3", "/guess", ""),
        ("preset=case-1&period=1&format=svg", "/sweep", "sweep"),
        ("preset=case-1&period=1&sweep.field=table.strike&sweep.from=1&sweep.to=2", "/sweep/field", "number"),
        ("preset=case-1&period=1&sweep.field=table.tilt_gain&sweep.from=1&sweep.to=200", "/sweep/to", "100"),
    ] {
        let answer = server.get(&format!("/v1/periodic-orbits?{query}")).await.expect(422);
        assert_eq!(answer.pointers(), [pointer], "{query}: {}", answer.json());
        assert!(answer.json()["detail"].as_str().unwrap().contains(part), "{query}: {}", answer.json());
    }
}

#[tokio::test]
async fn with_energy_feedback_the_symmetric_orbit_is_the_one_asked_for_or_none() {
    let server = Server::start();
    let ask = |theta: f64| {
        format!(
            "/v1/periodic-orbits?preset=case-1&scene.table.tilt_gain=1.4&scene.table.energy_gain=0.2&scene.table.target_height=0.2\
             &family=symmetric&theta={theta}"
        )
    };
    for theta in [0.05, 0.2, -0.4, 0.9] {
        let refused = server.get(&ask(theta)).await.expect(422);
        assert_eq!(refused.pointers(), ["/theta"]);
        assert!(refused.json()["detail"].as_str().unwrap().contains("target height"), "{}", refused.json());
    }
    // Either error names the angle of the orbit that exists.
    let refused = server.get(&ask(0.05)).await.expect(422).json();
    let detail = refused["detail"].as_str().unwrap();
    let named = detail.split("through theta ").nth(1).and_then(|rest| rest.split(' ').next()).expect(detail);
    for theta in [named.parse::<f64>().unwrap(), -named.parse::<f64>().unwrap()] {
        let orbit = server.get(&ask(theta)).await.expect(200).json();
        assert!((orbit["states"]["theta"][0].as_f64().unwrap() - theta).abs() < 1e-6, "{}", orbit["states"]);
        assert_eq!(orbit["least_period"], 2);
    }
}

#[tokio::test]
async fn eigenvalues_are_those_that_jacobians_gives_at_the_same_state() {
    let server = Server::start();
    let scene = "preset=case-1&scene.table.tilt_gain=1.24&scene.table.energy_gain=0.2&scene.table.target_height=0.2";
    let orbit = server
        .get(&format!(
            "/v1/periodic-orbits?{scene}&period=4&guess.theta=0.2&guess.x_dot=0&guess.theta_dot=0&guess.y_dot=-1.1"
        ))
        .await
        .expect(200)
        .json();
    let state = |name: &str| orbit["states"][name][0].as_f64().unwrap();
    let [theta, x_dot, y_dot, theta_dot] = ["theta", "x_dot", "y_dot", "theta_dot"].map(state);
    let jacobian = server
        .get(&format!(
            "/v1/jacobians?{scene}&period=4&at.state.theta={theta}&at.state.x_dot={x_dot}&at.state.y_dot={y_dot}&at.state.theta_dot={theta_dot}"
        ))
        .await
        .expect(200)
        .json();
    for n in 0..4 {
        for part in ["re", "im"] {
            let [one, other] = [&orbit, &jacobian].map(|answer| answer["eigenvalues"][n][part].as_f64().unwrap());
            assert!((one - other).abs() < 1e-8, "{n}: {one} and {other}");
        }
    }
}

#[tokio::test]
async fn a_matched_table_with_friction_has_its_branch_and_a_tilting_one_its_orbit() {
    let server = Server::start();
    let rough = "preset=case-1&scene.contact.friction=0.3";
    let matched = format!(
        "/v1/periodic-orbits?{rough}&scene.table.slide=matched&family=symmetric&theta=0.05&sweep.field=table.tilt_gain&sweep.from=2.4\
         &sweep.to=2.7&sweep.points=60"
    );
    let answer = server.get(&matched).await.expect(200).json();
    let change = &answer["changes"][0];
    assert_eq!(change["kind"], "period_doubling");
    assert!((change["value"].as_f64().unwrap() - 2.5).abs() < 1e-6, "{change}");
    assert!(answer["notes"].to_string().contains("two eigenvalues are 1"), "{}", answer["notes"]);
    server.get(&format!("{matched}&format=svg")).await.expect(200);
    let upright = server.get(&format!("/v1/periodic-orbits?{rough}&period=1")).await.expect(200).json();
    assert_eq!(upright["stable"], false, "{upright}");
    let refused = server.get(&format!("/v1/periodic-orbits?{rough}&family=symmetric&theta=0.1")).await.expect(422);
    assert!(refused.text().contains("sticks to a table that moves along with it"), "{}", refused.text());
    assert_eq!(refused.pointers(), ["/theta"]);
}
