//! The verdict beyond eigenvalues: rotation number, resonances, chaos, predictable impacts and the basin; and its code.

use crate::margins::margin;
use crate::support::Server;
use crate::support::contract::DOCUMENT;
use equipoise::api::stability::verdict_name::CODES;
use serde_json::{Value, json};

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
    assert_eq!(number(&answer, "/rotation_number/small"), linear);
    assert!((number(&answer, "/rotation_number/measured") - linear).abs() < 1e-6);
    let (p, q) = (number(&answer, "/rotation_number/resonance/p"), number(&answer, "/rotation_number/resonance/q"));
    let distance = number(&answer, "/rotation_number/resonance/distance");
    assert!((distance - (number(&answer, "/rotation_number/measured") - p / q).abs()).abs() < 1e-12 && q <= 8.0);
    assert_eq!(answer["chaos"]["chaotic"], false);
    assert_eq!(answer["chaos"]["bounces"], 500);
    assert!(answer["predictable_bounces"].is_null() && says(&answer, "predictable_bounces is null"));
    assert!(answer["basin"].is_null());
}

#[tokio::test]
async fn an_elliptic_run_that_is_chaotic_is_said_to_be() {
    let answer = verdict("scene.table.tilt_gain=1.1&scene.release.theta=0.34&bounces=500").await;
    assert_eq!(answer["verdict"]["text"], "elliptic, 500 bounces survived");
    assert_eq!(answer["chaos"]["chaotic"], true);
    assert!(answer["verdict"]["reason"].as_str().unwrap().contains("chaotic"), "{}", answer["verdict"]["reason"]);
}

#[tokio::test]
async fn a_chaotic_release_beside_a_strong_resonance_is_followed_until_it_leaves() {
    let answer = verdict("scene.table.tilt_gain=1.265755&scene.release.theta=0.15376&bounces=500").await;
    assert_eq!(answer["chaos"]["chaotic"], true);
    let horizon = number(&answer, "/predictable_bounces");
    assert!(horizon > 250.0 && horizon < 400.0, "{horizon}");
    // The run of the request survives; the release does not.
    assert_eq!(
        (&answer["verdict"]["text"], &answer["nonlinear"]["outcome"]["kind"]),
        (&"unstable".into(), &"completed".into())
    );
    assert!(answer["verdict"]["reason"].as_str().unwrap().contains("order 4"), "{}", answer["verdict"]["reason"]);
    let later = verdict("scene.table.tilt_gain=1.265755&scene.release.theta=0.15376&bounces=3000").await;
    assert_eq!(later["verdict"]["text"], "unstable");
    assert_eq!(later["nonlinear"]["outcome"]["kind"], "separating");
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
        let order = third.then_some(3).or(fourth.then_some(4));
        assert_eq!(answer["rotation_number"]["strong_resonance"]["q"].as_u64(), order, "κ = {tilt_gain}");
    }
}

#[tokio::test]
async fn beyond_the_boundary_the_period_two_orbit_is_named() {
    let answer = verdict("scene.table.tilt_gain=1.505&scene.release.theta=0.01").await;
    assert_eq!(answer["verdict"]["text"], "bounded beyond the boundary, 2000 bounces survived");
    assert!(
        answer["verdict"]["reason"].as_str().unwrap().contains("period-2 orbit at θ = ±0.1"),
        "{}",
        answer["verdict"]["reason"]
    );
    assert!(answer["rotation_number"].is_null() && says(&answer, "rotation_number is null"));
}

#[tokio::test]
async fn the_basin_is_looked_for_when_asked() {
    let dent = verdict("basin=true&bounces=1000&scene.table.tilt_gain=1.266").await;
    let far = verdict("basin=true&bounces=1000").await;
    assert!(number(&dent, "/basin/unbroken") < 0.2 && number(&far, "/basin/unbroken") > 0.3);
    let (theta, unbroken) = (number(&far, "/basin/theta"), number(&far, "/basin/unbroken"));
    assert_eq!(theta == unbroken, far["basin"]["holes"].as_array().unwrap().is_empty());
    let server = Server::start();
    for preset in ["point-mass", "still-lossy"] {
        let answer = server.get(&format!("/v1/stability?preset={preset}&basin=true")).await.expect(200).json();
        let why = answer["no_basin"].as_str().unwrap();
        assert!(answer["basin"].is_null() && says(&answer, &format!("basin is null: {why}")), "{preset}");
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
    server.get("/v1/stability?preset=case-1&bounces=600").await.expect(200);
    let watch = 5 * 500;
    assert_eq!(bounces().await, 600 + watch);
    // The basin: most angles of its fine scan survive.
    server.get("/v1/stability?preset=case-1&bounces=600&basin=true").await.expect(200);
    let basin = bounces().await - 2 * (600 + watch);
    assert!((128 * 600..=448 * 600).contains(&basin), "{basin}");
}

#[tokio::test]
async fn what_cannot_be_said_is_null_with_its_reason() {
    // An upright run, one that is too short, and one with errors at random.
    for query in
        ["preset=case-1&scene.release.theta=0", "preset=case-1&bounces=100", "preset=case-1&scene.noise.timing_sd=1e-4"]
    {
        let answer = Server::start().get(&format!("/v1/stability?{query}")).await.expect(200).json();
        assert!(answer["chaos"].is_null(), "{query}");
        assert!(says(&answer, "chaos is null") || says(&answer, "chaos and predictable_bounces are null"), "{query}");
    }
}

/// The answer of another preset.
async fn of(preset: &str, query: &str) -> Value {
    Server::start().get(&format!("/v1/stability?preset={preset}&{query}")).await.expect(200).json()
}

#[tokio::test]
async fn energy_feedback_is_weakly_unstable_or_weakly_attracting() {
    // The drift of case 5 lowers ℓ.
    for (preset, growth) in [("case-4", 0.0221), ("case-5", 0.02115)] {
        let answer = of(preset, "").await;
        assert_eq!(answer["verdict"]["text"], "weakly unstable, 2000 bounces survived", "{preset}");
        assert_eq!(answer["verdict"]["decided_by"], "lyapunov");
        assert_eq!(answer["linear"]["kind"], "elliptic");
        assert_eq!(answer["lyapunov"]["kind"], "repelling");
        assert!((number(&answer, "/lyapunov/coefficient") - growth).abs() < 2e-4);
    }
    let answer = of("case-5", "scene.table.tilt_gain=1.2").await;
    assert_eq!(answer["verdict"]["text"], "weakly attracting, 2000 bounces survived");
    assert_eq!(
        (&answer["lyapunov"]["kind"], &answer["lyapunov"]["escape_bounces"]),
        (&"attracting".into(), &Value::Null)
    );
}

#[tokio::test]
async fn a_feedback_without_x_and_x_dot_leaves_the_drift() {
    let steered = "scene.release.x_dot=0.5&scene.release.theta=0.05&scene.table.energy_gain=0.45&scene.table.target_height=0.2\
                   &scene.table.energy_measure=total";
    let tilted = verdict(steered).await;
    let law = "scene.table.tilt_gain=null&scene.table.feedback.theta=-1.1";
    let fed_back = verdict(&format!("{steered}&{law}&basin=true")).await;
    assert_eq!(fed_back["verdict"]["text"], tilted["verdict"]["text"]);
    for part in ["fixed_point", "linear", "drift_speed", "lyapunov", "rotation_number"] {
        assert_eq!(fed_back[part], tilted[part], "{part}");
    }
    assert!(fed_back["notes"].to_string().contains("which is a tilt_gain of 1.1"), "{fed_back}");
    assert!(number(&fed_back, "/basin/theta") > 0.1);
    let damped = verdict(&format!("{steered}&{law}&scene.table.feedback.theta_dot=-0.02")).await;
    assert_eq!((&damped["verdict"]["text"], &damped["agree"]), (&"stable, drifting".into(), &true.into()), "{damped}");
    assert!(number(&damped, "/fixed_point/x_dot") == number(&damped, "/drift_speed"));
    // The drift is kept.
    let kept = |value: &&Value| (number(value, "/modulus") - 1.0).abs() < 1e-9;
    assert_eq!(damped["linear"]["eigenvalues"].as_array().unwrap().iter().filter(kept).count(), 1);
}

#[tokio::test]
async fn a_run_that_leaves_in_the_end_is_not_called_outside_the_basin() {
    for (theta, fall) in [(0.04, 1332), (0.02, 5354), (0.01, 21453)] {
        let query = format!("scene.table.energy_gain=0.45&scene.table.target_height=0.2&scene.release.theta={theta}");
        let short = verdict(&query).await;
        let long = verdict(&format!("{query}&bounces=30000")).await;
        assert_eq!(short["verdict"]["code"], if fall > 2000 { "weakly_unstable" } else { "unstable" });
        assert_eq!(
            (&long["verdict"]["text"], &long["nonlinear"]["outcome"]["bounces"]),
            (&json!("unstable"), &json!(fall))
        );
        assert!((number(&short, "/lyapunov/escape_bounces") / f64::from(fall) - 1.0).abs() < 0.02);
        for answer in [short, long] {
            assert_eq!(answer["verdict"]["decided_by"], "lyapunov");
            assert!(
                !answer["verdict"]["reason"].as_str().unwrap().contains("basin"),
                "{}",
                answer["verdict"]["reason"]
            );
        }
    }
}

#[tokio::test]
async fn lyapunov_is_null_with_a_note_where_it_does_not_apply() {
    for (preset, query) in [("case-1", ""), ("case-3", ""), ("point-mass", ""), ("still-lossy", "")] {
        let answer = of(preset, query).await;
        assert!(answer["lyapunov"].is_null() && says(&answer, "lyapunov"), "{preset}: {}", answer["notes"]);
    }
}

#[tokio::test]
async fn a_soft_loss_of_stability_is_told_from_a_hard_one() {
    // Beyond the upper end of κ_E the height flips softly.
    let query = "scene.table.target_height=0.2&scene.release.height=0.21&scene.release.theta=0.01";
    let within = verdict(&format!("{query}&scene.table.energy_gain=0.1")).await;
    let upper = number(&margin(&within, "table.energy_gain"), "/above/limit");
    let farther = format!("{query}&scene.table.energy_gain={}", 1.03 * upper);
    let left = verdict(&farther).await;
    let small = left["verdict"]["reason"].as_str().unwrap().contains("a run from this release left");
    assert!(
        left["verdict"]["code"] == "unstable" && small,
        "wide swings beside two heights: {}",
        left["verdict"]["reason"]
    );
    let beyond = verdict(&farther.replace("theta=0.01", "theta=0.001")).await;
    assert_eq!(
        beyond["verdict"]["text"], "bounded beyond the boundary, 2000 bounces survived",
        "{}",
        beyond["verdict"]["reason"]
    );
    assert_eq!(beyond["verdict"]["decided_by"], "boundary");
    let end = |answer: &Value, field: &str| {
        let ends = answer["loss_of_stability"].as_array().unwrap().clone();
        ends.into_iter().find(|end| end["field"] == field).unwrap_or_else(|| panic!("{field}: {answer}"))
    };
    let heights = &end(&beyond, "table.energy_gain")["heights"];
    assert!(heights[0].as_f64().unwrap() < 0.2 && heights[1].as_f64().unwrap() > 0.2, "{heights}");
    assert!(end(&within, "table.energy_gain")["heights"].is_null());
    // At the gain margin of the controller stability is lost softly, to a swing.
    let law = Server::start().get("/v1/controllers?preset=case-1").await.expect(200).json();
    let upper = number(&law, "/margins/0/above/limit");
    let gains = ["x", "theta", "x_dot", "theta_dot"]
        .map(|name| {
            format!(
                "scene.table.feedback.{name}={}",
                1.001 * upper * number(&law, &format!("/scene/table/feedback/{name}"))
            )
        })
        .join("&");
    let answer = verdict(&format!("{gains}&scene.table.tilt_gain=null&scene.release.theta=0.05&bounces=20000")).await;
    assert_eq!(
        answer["verdict"]["text"], "bounded beyond the boundary, 20000 bounces survived",
        "{}",
        answer["verdict"]["reason"]
    );
    let end = end(&answer, "table.feedback");
    assert_eq!((&end["kind"], &end["bifurcation"]), (&"soft".into(), &"period_doubling".into()));
    assert!((end["swing"].as_f64().unwrap() - 0.125).abs() < 0.01, "{end}");
    assert!((number(&answer, "/nonlinear/max_theta") - 0.125).abs() < 0.02);
}

#[tokio::test]
async fn the_code_of_a_verdict_stands_for_its_words() {
    assert_eq!(DOCUMENT["components"]["schemas"]["VerdictCode"]["enum"], json!(CODES));
    let server = Server::start();
    let mut seen = std::collections::BTreeSet::new();
    for query in [
        "preset=case-1",
        "preset=case-1&scene.table.tilt_gain=1.6",
        "preset=case-1&scene.table.tilt_gain=1.505&scene.release.theta=0.01",
        "preset=case-1-noise",
        "preset=case-4",
        "preset=point-mass",
        "preset=still-lossy",
        "preset=critical-hard",
    ] {
        let answer = server.get(&format!("/v1/stability?{query}&bounces=500")).await.expect(200).json();
        let words = answer["verdict"]["text"].as_str().unwrap();
        // The part before the length of the run; "stable, drifting" has no length.
        let name = if words.starts_with("stable") { words } else { words.split(',').next().unwrap() };
        let code = name.replace(',', "").replace(" the ", " ").replace(' ', "_");
        assert_eq!(answer["verdict"]["code"], code, "{query}: {words}");
        seen.insert(code);
    }
    assert!(seen.len() >= 4, "{seen:?}");
}
