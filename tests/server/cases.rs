//! The paper's cases and all reference runs through the whole server: numbers and verdicts that follow from the physics.

use serde_json::{Value, json};

use crate::support::{Server, close, numbers};
use crate::verdict;

/// Runs computed with 60 digits. A component may have ten times the error of the plain algorithm in doubles.
#[tokio::test]
async fn every_reference_agrees() {
    let server = Server::start();
    let mut agreed = 0;
    for entry in std::fs::read_dir("tests/reference").unwrap() {
        let file = entry.unwrap().path();
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let reference: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
        let request = json!({"scene": reference["scene"], "bounces": reference["impacts"]});
        let answer = server.post("/v1/trajectories", &request).await;
        agreed += 1;
        let trajectory = answer.json();
        assert_eq!(trajectory["outcome"]["kind"], reference["outcome"], "{name}");
        let contacts = reference["states"]["t"].as_array().unwrap().len();
        assert_eq!(trajectory["outcome"]["bounces"], contacts, "{name}");
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
    let verdict = async |preset: &str| server.get(&format!("/v1/stability?preset={preset}&bounces=3000")).await.json();
    for (preset, critical) in [("case-1", 1.5), ("case-2", 1.502), ("case-4", 1.2857), ("case-5", 1.2857)] {
        let stability = verdict(preset).await;
        // Energy feedback makes an elliptic bounce weakly unstable.
        let class = if matches!(preset, "case-4" | "case-5") { "weakly unstable" } else { "elliptic" };
        assert_eq!(stability["verdict"]["text"], format!("{class}, 3000 bounces survived"), "{preset}");
        assert_eq!(stability["agree"], true, "{preset}");
        close(&verdict::critical(&stability), critical, 5e-5);
    }
    let case_3 = verdict("case-3").await;
    assert_eq!(case_3["verdict"]["text"], "unstable");
    assert_eq!(case_3["nonlinear"]["outcome"]["bounces"], 49);
    close(&verdict::critical(&case_3), 1.5, 1e-12);
    close(&verdict("case-2").await["drift_speed"], -0.0733, 5e-5);
}

#[tokio::test]
async fn the_boundary_is_soft_or_hard_by_more_than_eigenvalues() {
    let server = Server::start();
    let verdict = async |target: &str| server.get(&format!("/v1/stability?{target}")).await.json();
    let soft = verdict("preset=critical-soft&bounces=20000").await;
    close(&soft["boundary"]["coefficient"], 2.0 / 3.0, 1e-12);
    assert_eq!(
        (&soft["verdict"]["text"], &soft["verdict"]["decided_by"]),
        (&json!("bounded beyond the boundary, 20000 bounces survived"), &json!("boundary"))
    );
    let hard = verdict("preset=critical-hard").await;
    close(&hard["boundary"]["coefficient"], -0.188, 5e-4);
    assert_eq!((&hard["verdict"]["text"], &hard["verdict"]["decided_by"]), (&json!("unstable"), &json!("boundary")));
    // Energy feedback holds η and not the energy: always hard. κ_c = 1 + 2/7 exactly.
    let energy = verdict(
        "preset=case-4&scene.table.tilt_gain=1.2857142857142858&scene.release.theta=1e-4&scene.release.height=0.25",
    )
    .await;
    assert_eq!(energy["boundary"]["kind"], "hard");
    assert_eq!(energy["verdict"]["text"], "unstable");
    assert_eq!(energy["nonlinear"]["outcome"]["bounces"], 112);
}

#[tokio::test]
async fn a_scene_without_a_fixed_point_is_unstable_and_says_why() {
    let server = Server::start();
    let still = server.get("/v1/stability?preset=still-lossy").await.json();
    assert_eq!(
        (&still["verdict"]["code"], &still["verdict"]["decided_by"]),
        (&json!("unstable"), &json!("fixed_point"))
    );
    assert!(still["linear"].is_null() && still["fixed_point"].is_null());
    assert!(
        still["verdict"]["reason"].as_str().unwrap().contains("every bounce loses energy"),
        "{}",
        still["verdict"]["reason"]
    );
    let run = server.get("/v1/trajectories?preset=still-lossy&bounces=1000").await.json();
    assert_eq!(run["outcome"]["kind"], "settled");
    // t = t₁ + 2 v e / (G (1 − e)), v the speed of the first impact.
    let (t, speed) = (run["impacts"]["t"][0].as_f64().unwrap(), run["impacts"]["y_dot"][0].as_f64().unwrap().abs());
    close(&run["outcome"]["settle_time"], t + 2.0 * speed * 0.8 / (9.81 * (1.0 - 0.8)), 1e-12);
}

#[tokio::test]
async fn the_lowest_exact_level_is_chosen_and_named() {
    let server = Server::start();
    for (target, level) in [
        ("preset=case-1", "rod"),
        // The table makes up the loss exactly, so e drops out.
        ("preset=case-1&scene.contact.restitution=0.3", "rod"),
        ("preset=case-4", "rod"),
        ("preset=still-lossy", "rod"),
        ("preset=still-lossy&scene.contact.restitution=1", "rod"),
        ("preset=point-mass", "point"),
    ] {
        let model = server.get(&format!("/v1/trajectories?{target}&bounces=1")).await.json()["model"].clone();
        assert_eq!(model["name"], level, "{target}");
        assert!(!model["reason"].as_str().unwrap().is_empty());
    }
}

#[tokio::test]
async fn a_point_mass_follows_equation_5() {
    let server = Server::start();
    let run = server.get("/v1/trajectories?preset=point-mass&bounces=20").await.json();
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
        assert_eq!(answer.json()["verdict"]["text"], verdict, "κ = {kappa}");
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
    let beyond = server.get("/v1/jacobians?preset=case-3&at.impact=60").await;
    assert_eq!(beyond.status, 422);
    assert_eq!(beyond.json()["errors"][0]["pointer"], "/at/impact");
    let falling = server.get("/v1/jacobians?preset=case-3&at.impact=49").await;
    assert_eq!(falling.status, 422);
    let still = server.get("/v1/jacobians?preset=still-lossy").await;
    assert_eq!(still.json()["errors"][0]["pointer"], "/at");
    // Differences were served once: the refusal says what is.
    let differences = server.get("/v1/jacobians?preset=case-1&method=finite_difference").await.expect(422).json();
    assert_eq!(differences["errors"][0]["pointer"], "/method");
    assert!(differences["errors"][0]["detail"].as_str().unwrap().contains("exact"), "{differences}");
}

#[tokio::test]
async fn samples_of_flights_are_the_closed_form() {
    let server = Server::start();
    let run = server.get("/v1/trajectories?preset=case-1&bounces=3&samples_per_flight=4").await.json();
    let flights = &run["flights"];
    assert_eq!(flights["impact"], json!([0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]));
    close(&flights["y"][0], 0.2, 0.0);
    close(&flights["t"][4], run["impacts"]["t"][0].as_f64().unwrap(), 0.0);
    // Half-way through its time, a fall from rest has covered a quarter of its height.
    let fall = 0.5 * 9.81 * run["impacts"]["t"][0].as_f64().unwrap().powi(2);
    close(&flights["y"][2], 0.2 - 0.25 * fall, 1e-15);
}

#[tokio::test]
async fn friction_is_named_where_it_acts_and_refused_where_nothing_is_derived() {
    let server = Server::start();
    let rough = "preset=case-1&scene.contact.friction=0.3&scene.table.slide=matched";
    let run = server.get(&format!("/v1/trajectories?{rough}&scene.release.theta=0.05&bounces=20")).await.json();
    assert_eq!((&run["model"]["name"], &run["outcome"]["kind"]), (&json!("friction"), &json!("completed")));
    assert!(run["impacts"]["contact_mode"].as_array().unwrap().iter().all(|mode| mode == "stick"));
    assert!(run["impacts"]["impulse_tangential"][0].as_f64().unwrap() != 0.0);
    assert!(run["impacts"]["error_estimate"][19].as_f64().unwrap() < 1e-12);
    let answer = server.get(&format!("/v1/trajectories?{rough}&method=linear")).await.expect(422);
    assert!(answer.text().contains("contact.friction is 0.3, and the method"), "{}", answer.text());
}

/// Printed and computed values of a quantity in `/v1/scenes`, with the scene of the computed one.
async fn quoted(server: &Server, name: &str, quantity: &str) -> (Option<f64>, f64, Value) {
    let preset = server.get(&format!("/v1/scenes/{name}")).await.json();
    let all = preset["computed"].as_array().unwrap();
    let index = all.iter().position(|it| it["quantity"] == quantity).unwrap_or_else(|| panic!("{name}: {quantity}"));
    let changes = all[index].get("with").cloned().unwrap_or(json!({}));
    (preset["printed"][index]["value"].as_f64(), all[index]["value"].as_f64().unwrap(), changes)
}

fn column(run: &Value, name: &str) -> Vec<f64> {
    run["impacts"][name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

fn near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}

/// Values of the paper's formulas as printed, against values from other resources.
#[tokio::test]
async fn formulas_of_the_paper_stand_beside_what_holds() {
    let server = Server::start();
    let (l, gravity) = (0.4 / 3.0, 9.81_f64);
    let squared = 2.0 * gravity * (0.2 - l);
    let weight = gravity * 2.0 / 225.0;

    let (printed, computed, _) = quoted(&server, "case-1", "fixed_point.y_dot").await;
    near(printed.unwrap(), -(2.0 * gravity * (0.2 - l * 0.3_f64.cos())).sqrt(), 5e-5);
    near(computed, -squared.sqrt(), 1e-12);

    // Eq. (15): the imaginary part with 2ẏ*²l before the roots, and with 2ẏ*√l.
    let (printed, computed, _) = quoted(&server, "case-1", "angle_eigenvalue.im").await;
    let roots = 0.1_f64.sqrt() * (weight - 0.1 * squared * l).sqrt() / weight;
    near(printed.unwrap(), 2.0 * squared * l * roots, 5e-5);
    near(computed, 2.0 * (squared * l).sqrt() * roots, 1e-12);
    near(0.6_f64.hypot(computed), 1.0, 1e-12);

    let (printed, computed, _) = quoted(&server, "case-1", "jacobian.determinant").await;
    let run = server.get("/v1/trajectories?preset=case-1&bounces=2").await.json();
    // −ẏ_c⁺ of the first strike over ẏ_c⁻ of the next; over the flight ẏ_c = ẏ + lθ̇ sin θ, and ẏ falls by Gτ.
    let at = |name: &str, n: usize| run["impacts"][name][n].as_f64().unwrap();
    let rise = at("y_dot", 1) + gravity * at("flight_time", 0) + l * at("theta_dot", 1) * at("theta", 0).sin();
    near(computed, -rise / at("contact_velocity", 1), 1e-12);
    near(printed.unwrap(), 1.0, 0.0);
    assert!((computed - 1.0).abs() > 1e-4, "{computed}");

    // Eq. (38): two bounces from V₄ = (1, 0, 0, 0), with the matrix of another resource.
    let (printed, computed, _) = quoted(&server, "critical-soft", "angle_eigenvector.second").await;
    let matrix = server.get("/v1/jacobians?preset=critical-soft").await.json()["matrix"].clone();
    let entry = |row: usize, column: usize| matrix[row][column].as_f64().unwrap();
    let times = |vector: [f64; 4]| [0, 1, 2, 3].map(|row| (0..4).map(|k| entry(row, k) * vector[k]).sum::<f64>());
    let once = times([1.0, 0.0, 0.0, 0.0]);
    let twice = times(once);
    near(twice[3] / once[3], computed, 1e-12);
    near(printed.unwrap(), -computed, 1e-12);

    let (printed, computed, _) = quoted(&server, "case-4", "energy_gain.eigenvalue").await;
    near(printed.unwrap(), 1.0 - 0.165 / 1.653, 5e-3);
    near(computed, 1.0 - 2.0 * 0.165 / 0.823_773_736_637_888_7, 1e-12);
    let (printed, computed, _) = quoted(&server, "case-5", "gravity.in_plane").await;
    assert!(printed.is_none());
    near(computed, 6.937, 5e-4);
    let (printed, computed, _) = quoted(&server, "case-2-figure", "release.theta_dot").await;
    assert_eq!((printed, computed), (Some(0.1), 0.2));
}

/// Observations from the paper's simulations, against runs of the same scenes.
#[tokio::test]
async fn ranges_and_ends_of_the_paper_stand_beside_what_runs_do() {
    let server = Server::start();
    let lasts = async |preset: &str, changes: &str| {
        let verdict = server.get(&format!("/v1/stability?preset={preset}&bounces=10000&{changes}")).await.json();
        verdict["nonlinear"]["outcome"]["kind"] == "completed"
    };
    let (printed, angle, _) = quoted(&server, "case-1", "theta.bounded").await;
    assert_eq!((printed, angle), (Some(0.4), 0.33));
    assert!(lasts("case-1", "scene.release.theta=0.33").await && !lasts("case-1", "scene.release.theta=0.34").await);
    let (printed, angle, _) = quoted(&server, "critical-soft", "theta.bounded").await;
    assert_eq!((printed, angle), (Some(0.15), 0.11));
    assert!(lasts("critical-soft", "scene.release.theta=0.1").await);
    assert!(!lasts("critical-soft", "scene.release.theta=0.15").await);
    let (printed, gain, changes) = quoted(&server, "critical-soft", "tilt_gain.bounded").await;
    assert_eq!((printed, &changes), (Some(1.5), &json!({"release": {"theta": 0.15}})));
    near(gain, 1.47, 1e-12);
    let from = "scene.release.theta=0.15&scene.table.tilt_gain";
    assert!(lasts("case-1", &format!("{from}=1.47")).await && !lasts("case-1", &format!("{from}=1.48")).await);

    // Case 4: η converges to its target, the energy does not.
    let run = server.get("/v1/trajectories?preset=case-4&bounces=4000").await.json();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (printed, energy, _) = quoted(&server, "case-4", "energy.settled").await;
    near(energy, mean(&column(&run, "energy")[2000..]), 1e-9);
    near(energy, 1.895, 5e-4);
    assert!(energy > 1.09 * printed.unwrap());
    let (printed, vertical, _) = quoted(&server, "case-4", "vertical_energy.settled").await;
    near(vertical, 1.7275, 5e-5);
    near(vertical, printed.unwrap(), 5e-3);

    // Case 5 does not behave like the lossless case.
    let (printed, growth, _) = quoted(&server, "case-5", "theta.growth").await;
    let run = server.get("/v1/trajectories?preset=case-5&bounces=30000").await.json();
    let largest = |angles: &[f64]| angles.iter().fold(0.0, |most: f64, theta| most.max(theta.abs()));
    let angles = column(&run, "theta");
    near(growth, largest(&angles[29_000..]) / largest(&angles[..1000]), 1e-12);
    near(largest(&angles[29_000..]), 0.3539, 5e-5);
    assert_eq!(printed, Some(1.0));

    // Friction: at the computed value a larger energy gain gives more contacts; a little above it, no gain does.
    let (_, friction, _) = quoted(&server, "case-4", "friction.helped").await;
    near(friction, 0.029, 0.0);
    let contacts = async |friction: f64, gain: f64| {
        let changes = format!("scene.contact.friction={friction}&scene.table.energy_gain={gain}");
        let run = server.get(&format!("/v1/trajectories?preset=case-4&bounces=100&{changes}")).await.json();
        run["outcome"]["bounces"].as_u64().unwrap()
    };
    let gains = [0.25, 0.33, 0.41, 0.5, 0.58, 0.66, 0.74, 0.82];
    let mut helped = [false; 4];
    for (index, friction) in [0.02, 0.029, 0.05, 0.1].into_iter().enumerate() {
        let before = contacts(friction, 0.165).await;
        for gain in gains {
            helped[index] |= contacts(friction, gain).await > before;
        }
    }
    assert_eq!(helped, [true, true, false, false]);

    let (printed, spin, changes) = quoted(&server, "still-lossy", "settled.theta_dot").await;
    let body = json!({"preset": "still-lossy", "scene": changes, "bounces": 1000});
    let run = server.post("/v1/trajectories", &body).await.json();
    assert_eq!(run["outcome"]["kind"], "settled");
    near(spin, *column(&run, "theta_dot").last().unwrap(), 0.0);
    assert_eq!(printed, Some(0.0));
    assert!(spin > 2.0, "{spin}");
}

// Presets with friction: each does what its description says.

const RIGS: [&str; 5] = ["rough-matched", "rough-feedback", "rough-noise", "rough-catch", "rough-juggling"];

#[tokio::test]
async fn every_rig_has_friction_and_bounces_on() {
    let server = Server::start();
    for rig in RIGS {
        let listed = server.get(&format!("/v1/scenes/{rig}")).await.expect(200).json();
        assert_eq!(listed["scene"]["contact"]["friction"], 0.3, "{rig}");
        let run = server.get(&format!("/v1/trajectories?preset={rig}&bounces=20000")).await.expect(200).json();
        assert_eq!(run["outcome"]["kind"], "completed", "{rig}: {}", run["outcome"]);
    }
}

#[tokio::test]
async fn verdicts_are_those_that_are_told() {
    let server = Server::start();
    let matched = server.get("/v1/stability?preset=rough-matched").await.expect(200).json();
    assert_eq!(matched["verdict"]["text"], "elliptic, 2000 bounces survived");
    // 1 + G(ρ² + l²)/(V²l), and without friction 1 + Gρ²/(V²l).
    let [l, height] = [0.4 / 3.0, 0.2];
    for (friction, extra) in [("0.3", l * l), ("0", 0.0)] {
        let scene = format!("preset=rough-matched&scene.contact.friction={friction}&scene.table.tilt_gain=1.2");
        let linear = server.get(&format!("/v1/stability?{scene}&bounces=10")).await.expect(200).json();
        let critical = 1.0 + (2.0 / 225.0 + extra) / (2.0 * (height - l) * l);
        assert!((verdict::critical(&linear).as_f64().unwrap() - critical).abs() < 1e-9, "{linear}");
    }
    let still = server.get("/v1/trajectories?preset=rough-matched&scene.table.slide=none").await.expect(200).json();
    assert_ne!(still["outcome"]["kind"], "completed");
    assert!(still["outcome"]["bounces"].as_u64().unwrap() <= 10, "{}", still["outcome"]);
    for rig in ["rough-feedback", "rough-catch"] {
        let stable = server.get(&format!("/v1/stability?preset={rig}")).await.expect(200).json();
        assert_eq!(stable["verdict"]["text"], "stable in place", "{rig}");
        let run = server.get(&format!("/v1/trajectories?preset={rig}&bounces=1000")).await.expect(200).json();
        for column in ["x", "theta", "x_dot", "theta_dot"] {
            let last = numbers(&run["impacts"][column])[999];
            assert!(last.abs() < 1e-9, "{rig}: {column} is {last} after 1000 impacts");
        }
    }
}

#[tokio::test]
async fn feedback_is_that_of_the_controllers() {
    let server = Server::start();
    for (rig, places) in [("rough-feedback", 1e-1), ("rough-noise", 1e-2), ("rough-juggling", 1e-2)] {
        let listed = server.get(&format!("/v1/scenes/{rig}")).await.expect(200).json();
        let mut scene = listed["scene"].clone();
        let typed = scene["table"].as_object_mut().unwrap().remove("feedback").unwrap();
        scene["table"].as_object_mut().unwrap().remove("program");
        scene["table"]["target_height"] = scene["release"]["height"].clone();
        scene["noise"] = Value::Null;
        if scene["table"]["energy_gain"] == 0.0 {
            scene["table"].as_object_mut().unwrap().remove("target_height");
        }
        let designed =
            server.post("/v1/controllers", &json!({"scene": scene, "contact": "stick"})).await.expect(200).json();
        for (name, gain) in designed["gain"].as_object().unwrap() {
            let (gain, typed) = (gain.as_f64().unwrap(), typed[name].as_f64().unwrap());
            assert!((gain - typed).abs() <= places * gain.abs(), "{rig}: {name} is {typed}, designed {gain}");
        }
    }
}

#[tokio::test]
async fn rigs_with_noise_survive() {
    let server = Server::start();
    for rig in ["rough-noise", "rough-juggling"] {
        let target = format!("/v1/ensembles?preset={rig}&runs=1000&bounces=2000&seed=1");
        let runs = server.get(&target).await.expect(200).json();
        assert_eq!(runs["counts"]["completed"], 1000, "{rig}: {}", runs["counts"]);
    }
}

#[tokio::test]
async fn the_rig_to_catch_on_is_caught_from_its_release_and_from_its_bounces() {
    let server = Server::start();
    let caught = server.get("/v1/catches?preset=rough-catch").await.expect(200).json();
    assert_eq!(caught["outcome"]["kind"], "held", "{}", caught["outcome"]);
    let demand = |name: &str| caught["demand"][name].as_f64().unwrap();
    assert!(demand("tilt") <= 0.35 && demand("speed") <= 1.0 && demand("stroke") <= 0.03, "{}", caught["demand"]);
    for impact in [1, 2, 3, 5, 8, 20, 100, 500] {
        let request = json!({
            "preset": "rough-catch",
            "bounces": impact + 100,
            "interventions": [{"impact": impact, "catch": {}}],
        });
        let run = server.post("/v1/trajectories", &request).await.expect(200).json();
        assert_eq!(run["outcome"]["kind"], "held", "from impact {impact}: {}", run["outcome"]);
    }
}

#[tokio::test]
async fn the_juggling_rig_alternates_between_its_heights() {
    let server = Server::start();
    let run = server.get("/v1/trajectories?preset=rough-juggling&bounces=2000").await.expect(200).json();
    let heights: Vec<f64> = numbers(&run["impacts"]["energy"]).iter().map(|energy| energy / 9.81).collect();
    let mean = |parity: usize| {
        let of: Vec<f64> = heights.iter().skip(100 + parity).step_by(2).copied().collect();
        of.iter().sum::<f64>() / of.len() as f64
    };
    let (low, high) = (mean(0).min(mean(1)), mean(0).max(mean(1)));
    assert!((low - 0.21).abs() < 0.005 && (high - 0.27).abs() < 0.005, "{low} m and {high} m");
}
