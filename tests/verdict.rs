//! The verdict draws on more than eigenvalues: rotation, resonances, chaos, the horizon and the basin, where they exist.

mod support;

use serde_json::Value;
use support::Server;

async fn verdict(query: &str) -> Value {
    Server::start().get(&format!("/v1/stability?preset=case-1&{query}")).await.expect(200).json()
}

fn number(answer: &Value, pointer: &str) -> f64 {
    answer.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} is no number: {answer}"))
}

fn says(answer: &Value, words: &str) -> bool {
    answer["notes"].as_array().unwrap().iter().any(|note| note.as_str().unwrap().contains(words))
}

#[tokio::test]
async fn a_regular_run_turns_steadily() {
    let answer = verdict("scene.release.theta=0.001").await;
    let linear = number(&answer, "/linear/rotation") / std::f64::consts::TAU;
    assert_eq!(number(&answer, "/rotation_number/linear"), linear);
    assert!((number(&answer, "/rotation_number/measured") - linear).abs() < 1e-6);
    let (p, q) = (number(&answer, "/rotation_number/resonance/p"), number(&answer, "/rotation_number/resonance/q"));
    let distance = number(&answer, "/rotation_number/resonance/distance");
    assert!((distance - (number(&answer, "/rotation_number/measured") - p / q).abs()).abs() < 1e-12 && q <= 8.0);
    assert_eq!(answer["chaos"]["chaotic"], false);
    assert_eq!(answer["chaos"]["impacts"], 500);
    assert!(answer["predictable_impacts"].is_null() && says(&answer, "predictable_impacts is null"));
    assert!(answer["basin"].is_null());
}

#[tokio::test]
async fn an_elliptic_run_that_is_chaotic_is_said_to_be() {
    let answer = verdict("scene.table.tilt_gain=1.265755&scene.release.theta=0.15376&impacts=500").await;
    assert_eq!(answer["verdict"], "elliptic, 500 bounces survived");
    assert_eq!(answer["chaos"]["chaotic"], true);
    assert!(answer["reason"].as_str().unwrap().contains("chaotic"), "{}", answer["reason"]);
    let horizon = number(&answer, "/predictable_impacts");
    assert!(horizon > 250.0 && horizon < 400.0, "{horizon}");
    // One contact more, and it falls.
    let later = verdict("scene.table.tilt_gain=1.265755&scene.release.theta=0.15376&impacts=3000").await;
    assert_eq!(later["verdict"], "unstable");
}

#[tokio::test]
async fn resonances_of_order_3_and_4_are_named_where_they_are() {
    for (tilt_gain, third, fourth) in [(1.1, false, false), (1.25, false, true), (1.375, true, false)] {
        let answer = verdict(&format!("scene.table.tilt_gain={tilt_gain}&scene.release.theta=0.01")).await;
        assert_eq!(
            (says(&answer, "resonance 1/3"), says(&answer, "resonance 1/4")),
            (third, fourth),
            "κ = {tilt_gain}"
        );
    }
}

#[tokio::test]
async fn beyond_the_boundary_the_period_two_orbit_is_named() {
    let answer = verdict("scene.table.tilt_gain=1.505&scene.release.theta=0.01").await;
    assert_eq!(answer["verdict"], "bounded beyond the boundary");
    assert!(answer["reason"].as_str().unwrap().contains("period-2 orbit at θ = ±0.1"), "{}", answer["reason"]);
    assert!(answer["rotation_number"].is_null() && says(&answer, "rotation_number is null"));
}

#[tokio::test]
async fn the_basin_is_looked_for_when_asked() {
    let dent = verdict("basin=true&impacts=1000&scene.table.tilt_gain=1.266").await;
    let far = verdict("basin=true&impacts=1000").await;
    assert!(number(&dent, "/basin/unbroken") < 0.2 && number(&far, "/basin/unbroken") > 0.3);
    let (theta, unbroken) = (number(&far, "/basin/theta"), number(&far, "/basin/unbroken"));
    assert_eq!(theta == unbroken, far["basin"]["holes"].as_array().unwrap().is_empty());
    let server = Server::start();
    for preset in ["point-mass", "still-lossy"] {
        let answer = server.get(&format!("/v1/stability?preset={preset}&basin=true")).await.expect(200).json();
        assert!(answer["basin"].is_null() && says(&answer, "basin is null"), "{preset}");
    }
    server.get("/v1/stability?preset=case-1&basin=maybe").await.expect(422);
}

#[tokio::test]
async fn all_bounces_of_a_verdict_are_counted() {
    let server = Server::start();
    let bounces = async || {
        let text = server.get("/metrics").await.expect(200).text().to_owned();
        let line = text.lines().find(|line| line.starts_with("equipoise_bounces_total ")).unwrap();
        line.rsplit(' ').next().unwrap().parse::<u64>().unwrap()
    };
    server.get("/v1/stability?preset=case-1&impacts=600").await.expect(200);
    let watch = 5 * 500;
    assert_eq!(bounces().await, 600 + watch);
    // With it the basin: most angles of its fine scan survive, and no run is longer.
    server.get("/v1/stability?preset=case-1&impacts=600&basin=true").await.expect(200);
    let basin = bounces().await - 2 * (600 + watch);
    assert!((128 * 600..=448 * 600).contains(&basin), "{basin}");
}

#[tokio::test]
async fn what_cannot_be_said_is_null_with_its_reason() {
    // Upright, too short, and of a body that has no angle.
    for query in ["preset=case-1&scene.release.theta=0", "preset=case-1&impacts=100", "preset=point-mass"] {
        let answer = Server::start().get(&format!("/v1/stability?{query}")).await.expect(200).json();
        assert!(answer["chaos"].is_null(), "{query}");
        assert!(says(&answer, "chaos is null") || says(&answer, "chaos and predictable_impacts are null"), "{query}");
    }
}
