//! The paper's cases and all reference runs, through the whole server: numbers and verdicts that physics fixes.

mod support;

use serde_json::{Value, json};
use support::Server;

fn close(value: &Value, expected: f64, tolerance: f64) {
    let number = value.as_f64().unwrap_or(f64::NAN);
    assert!((number - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}

/// Runs computed with 60 digits. A component may be off by ten times what the plain algorithm in doubles is off.
#[tokio::test]
async fn every_reference_agrees() {
    let server = Server::start();
    let mut agreed = 0;
    for entry in std::fs::read_dir("tests/reference").unwrap() {
        let file = entry.unwrap().path();
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let reference: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
        let request = json!({"scene": reference["scene"], "impacts": reference["impacts"]});
        let answer = server.post("/v1/trajectories", &request).await;
        agreed += 1;
        let trajectory = answer.json();
        assert_eq!(trajectory["outcome"]["kind"], reference["outcome"], "{name}");
        let contacts = reference["states"]["t"].as_array().unwrap().len();
        assert_eq!(trajectory["outcome"]["impacts"], contacts, "{name}");
        let allowed = (10.0 * reference["plain_double_error"].as_f64().unwrap()).max(1e-13);
        for column in ["t", "x", "theta", "x_dot", "y_dot", "theta_dot"] {
            let values = trajectory["impacts"][column].as_array().unwrap();
            assert_eq!(values.len(), contacts, "{name}: {column}");
            for (n, (value, exact)) in values.iter().zip(reference["states"][column].as_array().unwrap()).enumerate() {
                let exact: f64 = exact.as_str().unwrap().parse().unwrap();
                let error = (value.as_f64().unwrap() - exact).abs();
                assert!(error <= allowed, "{name}: {column} at contact {} is off by {error:e}", n + 1);
            }
        }
    }
    assert!(agreed >= 22, "{agreed} references agreed");
}

#[tokio::test]
async fn verdicts_and_limits_are_those_of_the_physics() {
    let server = Server::start();
    let verdict = async |preset: &str| server.get(&format!("/v1/stability?preset={preset}&impacts=3000")).await.json();
    for (preset, critical) in [("case-1", 1.5), ("case-2", 1.502), ("case-4", 1.2857), ("case-5", 1.2857)] {
        let stability = verdict(preset).await;
        // Energy feedback makes an elliptic bounce weakly unstable.
        let class = if matches!(preset, "case-4" | "case-5") { "weakly unstable" } else { "elliptic" };
        assert_eq!(stability["verdict"], format!("{class}, 3000 bounces survived"), "{preset}");
        assert_eq!(stability["agree"], true, "{preset}");
        close(&stability["linear"]["tilt_gain"]["critical"], critical, 5e-5);
    }
    let case_3 = verdict("case-3").await;
    assert_eq!(case_3["verdict"], "unstable");
    assert_eq!(case_3["nonlinear"]["impacts"], 49);
    close(&case_3["linear"]["tilt_gain"]["critical"], 1.5, 1e-12);
    close(&verdict("case-2").await["drift_speed"], -0.0733, 5e-5);
}

#[tokio::test]
async fn the_boundary_is_soft_or_hard_by_more_than_eigenvalues() {
    let server = Server::start();
    let verdict = async |target: &str| server.get(&format!("/v1/stability?{target}")).await.json();
    let soft = verdict("preset=critical-soft&impacts=20000").await;
    close(&soft["boundary"]["coefficient"], 2.0 / 3.0, 1e-12);
    assert_eq!(
        (&soft["verdict"], &soft["decided_by"]),
        (&json!("bounded beyond the boundary, 20000 bounces survived"), &json!("boundary"))
    );
    let hard = verdict("preset=critical-hard").await;
    close(&hard["boundary"]["coefficient"], -0.188, 5e-4);
    assert_eq!((&hard["verdict"], &hard["decided_by"]), (&json!("unstable"), &json!("boundary")));
    // Energy feedback holds η and not the energy: always hard. κ_c = 1 + 2/7 exactly.
    let energy = verdict(
        "preset=case-4&scene.table.tilt_gain=1.2857142857142858&scene.release.theta=1e-4&scene.release.height=0.25",
    )
    .await;
    assert_eq!(energy["boundary"]["kind"], "hard");
    assert_eq!(energy["verdict"], "unstable");
    assert_eq!(energy["nonlinear"]["impacts"], 112);
}

#[tokio::test]
async fn a_scene_without_a_fixed_point_has_no_verdict_and_says_why() {
    let server = Server::start();
    let still = server.get("/v1/stability?preset=still-lossy").await.json();
    assert!(still["verdict"].is_null() && still["linear"].is_null() && still["agree"].is_null());
    assert!(still["reason"].as_str().unwrap().contains("every bounce loses energy"), "{}", still["reason"]);
    let run = server.get("/v1/trajectories?preset=still-lossy&impacts=1000").await.json();
    assert_eq!(run["outcome"]["kind"], "settled");
    // t = t₁ + 2 v e / (G (1 − e)), v the speed of the first impact.
    let (t, speed) = (run["impacts"]["t"][0].as_f64().unwrap(), run["impacts"]["y_dot"][0].as_f64().unwrap().abs());
    close(&run["outcome"]["settle_time"], t + 2.0 * speed * 0.8 / (9.81 * (1.0 - 0.8)), 1e-12);
}

#[tokio::test]
async fn the_lowest_exact_rung_is_chosen_and_named() {
    let server = Server::start();
    for (target, rung) in [
        ("preset=case-1", "rod"),
        // The table makes up the loss exactly: e drops out.
        ("preset=case-1&scene.contact.restitution=0.3", "rod"),
        ("preset=case-4", "rod"),
        ("preset=still-lossy", "rod"),
        ("preset=still-lossy&scene.contact.restitution=1", "rod"),
        ("preset=point-mass", "point"),
    ] {
        let model = server.get(&format!("/v1/trajectories?{target}&impacts=1")).await.json()["model"].clone();
        assert_eq!(model["name"], rung, "{target}");
        assert!(!model["reason"].as_str().unwrap().is_empty());
    }
}

#[tokio::test]
async fn a_point_mass_follows_equation_5() {
    let server = Server::start();
    let run = server.get("/v1/trajectories?preset=point-mass&impacts=20").await.json();
    let angles = run["impacts"]["theta"].as_array().unwrap();
    let first = angles[0].as_f64().unwrap();
    for (n, angle) in angles.iter().enumerate() {
        close(angle, first * 0.2_f64.powi(i32::try_from(n).unwrap()), 1e-15);
    }
    assert!(run["impacts"]["theta_dot"][0].is_null());
    for (kappa, verdict) in
        [("0.4", "stable in place"), ("0.99", "stable in place"), ("1.01", "unstable"), ("-0.1", "unstable")]
    {
        let answer = server.get(&format!("/v1/stability?preset=point-mass&scene.table.tilt_gain={kappa}")).await;
        assert_eq!(answer.json()["verdict"], verdict, "κ = {kappa}");
    }
}

#[tokio::test]
async fn derivatives_are_served_where_they_exist() {
    let server = Server::start();
    let fixed = server.get("/v1/jacobians?preset=case-1").await.json();
    close(&fixed["residue"], 0.2, 1e-14);
    close(&fixed["determinant"], 1.0, 1e-12);
    let ninth = server.get("/v1/jacobians?preset=case-1&period=9").await.json();
    // R over n bounces is sin²(nσ/2), cos σ = 1 − 2R.
    let rotation = (1.0_f64 - 0.4).acos();
    close(&ninth["residue"], (4.5 * rotation).sin().powi(2), 1e-12);
    let state =
        json!({"preset": "case-1", "at": {"state": {"theta": 0.2, "x_dot": 0.1, "y_dot": -1.2, "theta_dot": 3}}});
    let exact = server.post("/v1/jacobians", &state).await.json();
    let mut differences = state.clone();
    differences["method"] = json!("finite_difference");
    let differences = server.post("/v1/jacobians", &differences).await.json();
    for row in 0..4 {
        for column in 0..4 {
            close(&differences["matrix"][row][column], exact["matrix"][row][column].as_f64().unwrap(), 1e-6);
        }
    }
    let beyond = server.get("/v1/jacobians?preset=case-3&at.impact=60").await;
    assert_eq!(beyond.status, 422);
    assert_eq!(beyond.json()["errors"][0]["pointer"], "/at/impact");
    let falling = server.get("/v1/jacobians?preset=case-3&at.impact=49").await;
    assert_eq!(falling.status, 422);
    let still = server.get("/v1/jacobians?preset=still-lossy").await;
    assert_eq!(still.json()["errors"][0]["pointer"], "/at");
}

#[tokio::test]
async fn samples_of_flights_are_the_closed_form() {
    let server = Server::start();
    let run = server.get("/v1/trajectories?preset=case-1&impacts=3&samples_per_flight=4").await.json();
    let flights = &run["flights"];
    assert_eq!(flights["impact"], json!([0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]));
    close(&flights["y"][0], 0.2, 0.0);
    close(&flights["t"][4], run["impacts"]["t"][0].as_f64().unwrap(), 0.0);
    // Half-way through the fall from rest a quarter of it is done.
    let fall = 0.5 * 9.81 * run["impacts"]["t"][0].as_f64().unwrap().powi(2);
    close(&flights["y"][2], 0.2 - 0.25 * fall, 1e-15);
}

#[tokio::test]
async fn friction_is_named_where_it_acts_and_refused_where_nothing_is_derived() {
    let server = Server::start();
    let rough = "preset=case-1&scene.contact.friction=0.3&scene.table.slide=matched";
    let run = server.get(&format!("/v1/trajectories?{rough}&scene.release.theta=0.05&impacts=20")).await.json();
    assert_eq!((&run["model"]["name"], &run["outcome"]["kind"]), (&json!("friction"), &json!("completed")));
    assert!(run["impacts"]["contact_mode"].as_array().unwrap().iter().all(|mode| mode == "stick"));
    assert!(run["impacts"]["impulse_tangential"][0].as_f64().unwrap() != 0.0);
    assert!(run["impacts"]["error_estimate"][19].as_f64().unwrap() < 1e-12);
    for target in [
        format!("/v1/periodic-orbits?{rough}&period=2"),
        format!("/v1/precision?{rough}"),
        format!("/v1/trajectories?{rough}&method=linear"),
    ] {
        let answer = server.get(&target).await;
        assert_eq!(answer.status, 422, "{target}");
        assert!(answer.text().contains("not available with friction"), "{target}: {}", answer.text());
    }
}
