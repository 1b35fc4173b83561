//! Periodic orbits over HTTP: the orbit, its branch in every format, and refusals that say why.

mod support;

use serde_json::{Value, json};
use support::Server;
use support::csv::Table;

const SOFT: &str = "/v1/periodic-orbits?preset=case-1&family=symmetric&theta=0.05&sweep.parameter=table.tilt_gain\
                    &sweep.from=1.4&sweep.to=1.7&sweep.points=120";

#[tokio::test]
async fn the_branch_springs_from_the_critical_gain_in_every_format() {
    let server = Server::start();
    let answer = server.get(SOFT).await.expect(200).json();
    let change = &answer["changes"][0];
    assert_eq!(change["kind"], "period_doubling");
    assert!((change["parameter"].as_f64().unwrap() - 1.5).abs() < 1e-10, "{change}");
    assert_eq!(answer["changes"][1]["kind"], "pitchfork");
    let count = answer["branch"]["parameter"].as_array().unwrap().len();
    let table = Table::parse(server.get(&format!("{SOFT}&format=csv")).await.expect(200).text()).unwrap();
    assert_eq!(table.column("parameter").len(), count);
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
async fn what_has_no_answer_is_refused_with_its_reason() {
    let server = Server::start();
    for (query, pointer, part) in [
        ("preset=point-mass&period=1", "/scene", "point mass"),
        ("preset=still-lossy&period=1", "/scene", "loses energy"),
        ("preset=case-1&period=2", "", "give a guess"),
        ("preset=case-1&theta=0.1", "/theta", "family"),
        ("preset=case-1&period=65", "/period", "64"),
        ("preset=case-1&period=3&guess.theta=0.9&guess.y_dot=-0.2&guess.theta_dot=3", "/guess", ""),
        ("preset=case-1&period=1&format=svg", "/sweep", "sweep"),
        ("preset=case-1&period=1&sweep.parameter=table.strike&sweep.from=1&sweep.to=2", "/sweep/parameter", "number"),
        ("preset=case-1&period=1&sweep.parameter=table.tilt_gain&sweep.from=1&sweep.to=200", "/sweep/to", "100"),
    ] {
        let answer = server.get(&format!("/v1/periodic-orbits?{query}")).await.expect(422);
        assert_eq!(answer.pointers(), [pointer], "{query}: {}", answer.json());
        assert!(answer.json()["detail"].as_str().unwrap().contains(part), "{query}: {}", answer.json());
    }
}
