//! Random errors of the sensed place and velocities, scatter of restitution, and a delay between sensing and strike, in every resource that
//! takes a scene.

use crate::failures::{case, number, says};
use crate::margins::margin;
use crate::support::Server;
use serde_json::{Value, json};

/// Case 4 on a table that senses with errors and meets another restitution at every impact.
const ERRS: &str = "preset=case-4&scene.release.theta=0.1&scene.noise.x_sd=0.001&scene.noise.x_dot_sd=0.01&scene.noise.y_dot_sd=0.02\
                    &scene.noise.theta_dot_sd=0.03&scene.noise.restitution_sd=0.02";

#[tokio::test]
async fn ensembles_count_runs_with_further_errors() {
    let server = Server::start();
    let answer = server.get(&format!("/v1/ensembles?{ERRS}&runs=20&bounces=60")).await.expect(200).json();
    let survived = answer["counts"]["completed"].as_u64().unwrap();
    assert!(survived > 0, "{answer}");
    assert!(!answer["notes"].to_string().contains("has no noise"), "{answer}");
    let picture = server.get(&format!("/v1/ensembles?{ERRS}&runs=20&bounces=60&format=svg")).await.expect(200);
    for said in ["σ_ẏ = 0.02 m/s", "σ_e = 0.02"] {
        assert!(picture.text().contains(said), "{said}");
    }
    // Every run is that of its number.
    let mut alone = 0;
    for run in 0..20 {
        let target = format!("/v1/trajectories?{ERRS}&bounces=60&scene.noise.run={run}");
        let run = server.get(&target).await.expect(200).json();
        alone += u64::from(run["outcome"]["kind"] == "completed");
    }
    assert_eq!(alone, survived);
}

#[tokio::test]
async fn a_run_with_further_errors_is_on_the_rung_of_noise() {
    let server = Server::start();
    let run = server.get(&format!("/v1/trajectories?{ERRS}&bounces=30")).await.expect(200).json();
    assert_eq!(run["model"]["name"], "noise");
    let reason = run["model"]["reason"].as_str().unwrap();
    assert!(reason.contains("0.02 m/s in vertical velocity") && reason.contains("0.02 in restitution"), "{reason}");
    let bounds = run["impacts"]["error_estimate"].as_array().unwrap();
    assert!(bounds.iter().all(|bound| bound.as_f64().is_some_and(|bound| bound < 1e-6)), "{bounds:?}");
    let ladder = server.get(&format!("/v1/ladder?{ERRS}&bounces=30")).await.expect(200).json();
    assert_eq!(ladder["rungs"].as_array().unwrap().last().unwrap()["name"], "noise");
    let verdict = server.get(&format!("/v1/stability?{ERRS}&bounces=30")).await.expect(200).json();
    assert_eq!((&verdict["verdict"]["code"], &verdict["linear"]), (&json!("random"), &Value::Null));
    assert!(verdict["notes"].to_string().contains("noise.x_sd"), "{verdict}");
    let map =
        "x.field=noise.restitution_sd&x.from=0&x.to=0.3&x.count=4&y.field=noise.y_dot_sd&y.from=0&y.to=0.1&y.count=2";
    let cells = server.get(&format!("/v1/regions?{ERRS}&bounces=60&{map}")).await.expect(200).json();
    assert_eq!(cells["outcomes"].as_array().unwrap().len(), 2, "{cells}");
}

#[tokio::test]
async fn analyses_that_do_not_know_further_errors_refuse_them() {
    let server = Server::start();
    let errs = "preset=case-1&scene.noise.theta_dot_sd=0.03";
    server.get(&format!("/v1/catches?{errs}")).await.expect(200);
    server.get(&format!("/v1/throws?{errs}&impact=1&apex.height=0.3")).await.expect(200);
    let query = format!("/v1/trajectories?{errs}&method=linear");
    let refused = server.get(&query).await.expect(422);
    assert!(refused.text().contains("noise.theta_dot_sd"), "{query}: {}", refused.text());
    for query in ["periodic-orbits", "precision", "jacobians"].map(|resource| format!("/v1/{resource}?{errs}")) {
        let answer = server.get(&query).await.expect(200).json();
        assert!(answer["notes"].to_string().contains("without random errors"), "{query}: {}", answer["notes"]);
    }
    let point = json!({"preset": "point-mass", "scene": {"noise": {"theta_dot_sd": 0.1}}});
    let refused = server.post("/v1/trajectories", &point).await.expect(422);
    assert_eq!(refused.pointers(), ["/scene/noise/theta_dot_sd"]);
    let point =
        json!({"preset": "point-mass", "scene": {"noise": {"x_dot_sd": 0.01, "restitution_sd": 0.1}}, "bounces": 20});
    server.post("/v1/trajectories", &point).await.expect(200);
}

const LATE: &str = "preset=case-1&scene.release.theta=0.02&scene.table.delay=0.002";

#[tokio::test]
async fn a_delay_is_judged_as_the_feedback_that_it_is() {
    let server = Server::start();
    let late = server.get(&format!("/v1/stability?{LATE}")).await.expect(200).json();
    assert_eq!(
        (&late["verdict"]["text"], margin(&late, "table.tilt_gain")),
        (&json!("unstable"), Value::Null),
        "{late}"
    );
    assert_eq!(late["model"]["name"], "delay");
    let notes = late["notes"].to_string();
    assert!(notes.contains("state feedback K") && notes.contains("no tilt_gain above 0 balances"), "{notes}");
    let fed = "preset=case-1&scene.release.theta=0.02&scene.table.tilt_gain=null&scene.table.feedback.theta=-1.1\
               &scene.table.feedback.theta_dot=0.0022";
    let fed = server.get(&format!("/v1/stability?{fed}")).await.expect(200).json();
    let radius = |answer: &Value| number(&answer["linear"]["spectral_radius"]);
    assert!((radius(&late) - radius(&fed)).abs() < 1e-12);
    let jacobian = server.get(&format!("/v1/jacobians?{LATE}")).await.expect(200).json();
    assert_eq!(jacobian["state_order"].as_array().unwrap().len(), 4);
    let largest = number(&jacobian["eigenvalues"][0]["modulus"]);
    assert!((largest - radius(&late)).abs() < 1e-8, "{jacobian}");
    let map =
        "x.field=table.delay&x.from=0.001&x.to=0.002&x.count=2&y.field=table.tilt_gain&y.from=1.1&y.to=1.2&y.count=2";
    let cells = server.get(&format!("/v1/regions?{LATE}&{map}&quantity=spectral_radius")).await.expect(200).json();
    assert!((number(&cells["values"][0][1]) - radius(&late)).abs() < 1e-12, "{cells}");
}

#[tokio::test]
async fn a_table_that_predicts_has_the_run_of_an_ideal_one() {
    let server = Server::start();
    let ideal = server.get("/v1/trajectories?preset=case-1&bounces=50").await.expect(200).json();
    let target = "/v1/trajectories?preset=case-1&bounces=50&scene.table.delay=0.05&scene.table.prediction=flight";
    let late = server.get(target).await.expect(200).json();
    assert_eq!((&late["impacts"], &late["model"]), (&ideal["impacts"], &ideal["model"]));
    let caught = server.get("/v1/catches?preset=case-1&scene.table.delay=0.01&scene.table.prediction=flight").await;
    caught.expect(200);
}

#[tokio::test]
async fn analyses_that_do_not_know_a_delay_refuse_it_or_say_so() {
    let server = Server::start();
    for resource in ["catches", "controllers", "throws"] {
        let rest = if resource == "throws" { "&impact=1&apex.height=0.3" } else { "" };
        server.get(&format!("/v1/{resource}?{LATE}{rest}")).await.expect(200);
    }
    for scene in [LATE, "preset=point-mass&scene.table.delay=0.01"] {
        let refused = server.get(&format!("/v1/trajectories?{scene}&method=linear")).await.expect(422);
        assert!(refused.text().contains("table.delay"), "{scene}: {}", refused.text());
    }
    let basin = server.get(&format!("/v1/stability?{LATE}&basin=true&bounces=20")).await.expect(200).json();
    assert!(number(&basin["basin"]["theta"]) > 0.05, "{basin}");
    // The motion that the table plans before the last strike belongs to the state.
    let long =
        server.get("/v1/jacobians?preset=case-1&scene.release.theta=0&scene.table.delay=0.4").await.expect(200).json();
    assert_eq!(
        (&long["at"]["kind"], long["state_order"].as_array().unwrap().len()),
        (&json!("fixed_point"), 7),
        "{long}"
    );
    let sinking = "preset=case-1&scene.contact.restitution=0.8&scene.table.assumed_restitution=0.9";
    let nothing = server.get(&format!("/v1/jacobians?{sinking}")).await.expect(422);
    assert!(nothing.text().contains("\"/at\""), "{}", nothing.text());
    let settled = "preset=case-1&scene.release.theta=0&scene.table.strike=still&scene.contact.restitution=0.3&scene.table.delay=0.01&bounces=500";
    let held = server.get(&format!("/v1/trajectories?{settled}&hold=1")).await.expect(200).json();
    assert_eq!(held["outcome"]["kind"], "settled", "{}", held["outcome"]);
    assert!(held["hold"].is_null() && held["notes"].to_string().contains("table.delay"), "{}", held["notes"]);
    let long = server
        .get("/v1/stability?preset=case-1&scene.release.theta=0&scene.table.delay=0.5&bounces=20")
        .await
        .expect(200)
        .json();
    assert!(long["notes"].to_string().contains("before the last strike"), "{long}");
}

#[tokio::test]
async fn live_runs_take_another_delay() {
    let server = Server::start();
    let fields = server.get("/v1/fields").await.expect(200).json();
    let rows = fields["items"].as_array().unwrap();
    for path in ["table.delay", "table.prediction"] {
        let row = rows.iter().find(|row| row["field"] == path).unwrap();
        assert_eq!(row["live"], true, "{row}");
    }
    let ladder = server.get(&format!("/v1/ladder?{LATE}&bounces=30")).await.expect(200).json();
    assert_eq!(ladder["rungs"].as_array().unwrap().last().unwrap()["name"], "delay");
    let survived = server.get(&format!("/v1/ensembles?{LATE}&scene.noise.angle_sd=0.0001&runs=3&bounces=20")).await;
    survived.expect(200);
}

#[tokio::test]
async fn the_gallery_has_a_late_rig_that_the_ideal_analysis_calls_stable() {
    let case = case("late-sensing").await;
    assert_eq!(says(&case, "residue")["right"], false);
    assert_eq!(says(&case, "closed loop")["right"], true);
}
