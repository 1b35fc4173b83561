//! Control laws: designed laws hold in runs, typed laws are judged, and impossible ones are refused with a reason.

use serde_json::{Value, json};

use crate::support::contract::DOCUMENT;
use crate::support::{Server, contract, number_at};

/// Place and angle at each contact of a run of `scene` from a release.
async fn run(server: &Server, scene: &Value, release: Value, impacts: u64) -> (String, Vec<(f64, f64)>) {
    let mut scene = scene.clone();
    for (name, value) in release.as_object().unwrap() {
        scene["release"][name] = value.clone();
    }
    let answer = server.post("/v1/trajectories", &json!({"scene": scene, "bounces": impacts})).await.expect(200).json();
    let column = |name: &str| -> Vec<f64> {
        answer["impacts"][name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let states = column("x").into_iter().zip(column("theta")).collect();
    (answer["outcome"]["kind"].as_str().unwrap().to_owned(), states)
}

/// The contact after which |x| and |θ| stay below 1e-9.
fn at_rest(states: &[(f64, f64)]) -> usize {
    states.iter().rposition(|(x, theta)| x.abs().max(theta.abs()) >= 1e-9).map_or(1, |last| last + 2)
}

#[tokio::test]
async fn a_law_brings_the_body_to_rest_in_place() {
    let server = Server::start();
    let law = server.get("/v1/controllers?preset=case-1").await.expect(200).json();
    assert!(number_at(&law, "/residual") < 1e-13 && number_at(&law, "/spectral_radius") < 0.8, "{law}");
    assert_eq!(law["state_order"], json!(["x", "theta", "x_dot", "theta_dot"]));
    assert!(law["scene"]["table"].get("tilt_gain").is_none_or(Value::is_null), "{}", law["scene"]["table"]);
    assert_eq!(law["scene"]["table"]["feedback"], law["gain"]);
    assert!(law["applied"].is_null() && law["given"].is_null());
    let (outcome, states) = run(&server, &law["scene"], json!({"theta": 0.3, "x": 0.2}), 400).await;
    assert_eq!(outcome, "completed");
    assert!(at_rest(&states) <= 100, "{}", at_rest(&states));
    // In the long run the deviation shrinks at the rate of the largest eigenvalue.
    let fall = states[20].1.hypot(states[20].0) / states[50].1.hypot(states[50].0);
    let decades = 30.0 / number_at(&law, "/bounces_per_decade");
    assert!((fall.log10() - decades).abs() < 0.7, "{fall} {decades}");
}

#[tokio::test]
async fn a_law_for_the_sticking_contact_holds_where_proportional_tilt_falls() {
    let server = Server::start();
    let rough = "preset=case-1&scene.contact.friction=0.2&scene.contact.restitution=0.5&scene.release.theta=0.05";
    let law = server.get(&format!("/v1/controllers?{rough}")).await.expect(200).json();
    assert_eq!(law["contact"], "stick");
    let (outcome, states) = run(&server, &law["scene"], json!({"theta": 0.05}), 5000).await;
    assert_eq!(outcome, "completed");
    assert!(at_rest(&states) <= 250, "{}", at_rest(&states));
    let proportional = server.get(&format!("/v1/trajectories?{rough}&bounces=5000")).await.expect(200).json();
    assert!(number_at(&proportional, "/outcome/bounces") < 10.0);
    // A law for another kind of contact is predicted to fail on this one, and fails.
    let other = server.get(&format!("/v1/controllers?{rough}&contact=frictionless")).await.expect(200).json();
    assert_eq!((&other["contact"], &other["applied"]["contact"]), (&json!("frictionless"), &json!("stick")));
    assert_eq!(other["applied"]["stable"], false);
    let (outcome, states) = run(&server, &other["scene"], json!({"theta": 0.05}), 1000).await;
    assert!(outcome != "completed" || at_rest(&states) > 1000, "{outcome}");
}

#[tokio::test]
async fn without_a_weight_on_x_it_comes_to_rest_anywhere() {
    let server = Server::start();
    let law = server.get("/v1/controllers?preset=case-1&weights.state.x=0").await.expect(200).json();
    assert_eq!((&law["gain"]["x"], law["eigenvalues"].as_array().unwrap().len()), (&json!(0.0), 3));
    assert_eq!(
        (law["matrices"]["a"].as_array().unwrap().len(), law["matrices"]["b"].as_array().unwrap().len()),
        (3, 3)
    );
    let (_, states) = run(&server, &law["scene"], json!({"theta": 0.2, "x": 5.0}), 300).await;
    let (x, theta) = states[299];
    assert!(theta.abs() < 1e-9 && (x - 5.0).abs() < 1.0 && (x - states[298].0).abs() < 1e-9, "{x} {theta}");
}

#[tokio::test]
async fn gains_typed_by_hand_are_judged() {
    let server = Server::start();
    let designed = server.get("/v1/controllers?preset=case-1").await.json();
    let ask = async |feedback: Value| {
        let scene = json!({"table": {"tilt_gain": null, "feedback": feedback}});
        server.post("/v1/controllers", &json!({"preset": "case-1", "scene": scene})).await.expect(200).json()
    };
    let same = ask(designed["gain"].clone()).await;
    assert_eq!(same["given"]["eigenvalues"], designed["eigenvalues"]);
    assert_eq!((&same["gain"], &same["given"]["stable"]), (&designed["gain"], &json!(true)));
    // α = κθ as a state feedback circles and does not die out. With the wrong sign it falls.
    for (theta, radius) in [(-1.1, 1.0), (1.0, 2.0)] {
        let given = ask(json!({"theta": theta})).await["given"].clone();
        assert_eq!((&given["stable"], &given["margins"]), (&json!(false), &json!([])));
        assert!(number_at(&given, "/spectral_radius") > radius - 1e-6, "{given}");
    }
}

#[tokio::test]
async fn a_scene_needs_no_law_to_be_given_one() {
    let server = Server::start();
    let scene =
        json!({"body": {"contact_distance": 0.2, "radius_of_gyration": 0.1}, "release": {"height": 0.3, "theta": 0.1}});
    let law = server.post("/v1/controllers", &json!({"scene": scene})).await.expect(200).json();
    let (outcome, states) = run(&server, &law["scene"], json!({}), 400).await;
    assert_eq!((outcome.as_str(), at_rest(&states) <= 200), ("completed", true), "{}", at_rest(&states));
}

/// κ = 1 + R·G(ρ² + s)/(V²l) with R = 0.2; s = l² for a matched sticking contact, 0 without friction.
#[tokio::test]
async fn the_proportional_law_beside_it_has_the_residue_of_case_1() {
    let server = Server::start();
    let base =
        json!({"body": {"contact_distance": 0.2, "radius_of_gyration": 0.1}, "release": {"height": 0.3, "theta": 0.1}});
    // V² = 2·9.81·(0.3 − 0.2), and twice that for a target height of 0.4.
    for (scene, kappa) in [
        (json!({}), 1.05),
        (json!({"table": {"feedback": {"theta": -1.3}}}), 1.05),
        (json!({"table": {"slide": "matched"}, "contact": {"friction": 0.3}}), 1.25),
        (json!({"table": {"energy_gain": 0.1, "target_height": 0.4}}), 1.025),
        (json!({"table": {"tilt_gain": 1.0}}), 1.0),
        (json!({"table": {"tilt_gain": 1.3}}), 1.3),
    ] {
        let mut whole = base.clone();
        for (group, values) in scene.as_object().unwrap() {
            whole[group] = values.clone();
        }
        let answer = server.post("/v1/controllers", &json!({"scene": whole})).await.expect(200);
        let target = answer.json()["regions"]["proportional"].as_str().unwrap().to_owned();
        let query = target.split_once('?').unwrap().1.split_once("&x.field").unwrap().0.to_owned();
        let stability = server.get(&format!("/v1/stability?{query}")).await.expect(200).json();
        let told = number_at(&stability, "/scene/table/tilt_gain");
        assert!((told - kappa).abs() < 1e-12, "{scene}: {told} {kappa}");
        if whole["table"].get("tilt_gain").is_none() {
            let residue = number_at(&stability, "/linear/residue");
            assert!((residue - 0.2).abs() < 1e-12, "{scene}: {residue}");
        }
    }
    // A scene without a law and one with κ = 1 are different requests.
    let mut tags = Vec::new();
    for table in [json!({}), json!({"tilt_gain": 1.0})] {
        let mut whole = base.clone();
        whole["table"] = table;
        let answer = server.post("/v1/controllers", &json!({"scene": whole})).await.expect(200);
        tags.push(answer.header("etag").unwrap().to_owned());
    }
    assert_ne!(tags[0], tags[1]);
}

#[tokio::test]
async fn basins_are_a_request_away() {
    let server = Server::start();
    let law = server.get("/v1/controllers?preset=case-1").await.expect(200).json();
    let mut survivors = Vec::new();
    for name in ["designed", "proportional"] {
        let target = law["regions"][name].as_str().unwrap().replace("count=81", "count=15");
        let map = server.get(&target).await.expect(200).json();
        survivors.push(number_at(&map, "/counts/completed"));
        assert_eq!(number_at(&map, "/values/7/7"), 300.0, "{name}: upright and at rest it stays");
    }
    // The designed law survives on nearly half of the grid, the tilt gain only close to upright.
    assert!(survivors[0] > 80.0 && survivors[1] > 5.0 && survivors[1] < 30.0, "{survivors:?}");
    // A map over two gains of a law: with too little gain on the angle, runs fall.
    let gains = format!(
        "/v1/regions?{}&x.field=table.feedback.theta&x.from=-1.3&x.to=-1&x.count=7&y.field=table.feedback.theta_dot\
         &y.from=-0.06&y.to=0&y.count=3&bounces=200",
        law["regions"]["designed"].as_str().unwrap().split_once('?').unwrap().1.split_once("&x.field").unwrap().0
    );
    let map = server.get(&gains).await.expect(200).json();
    assert_eq!((number_at(&map, "/values/1/3"), number_at(&map, "/values/1/6") < 20.0), (200.0, true), "{map}");
    let map = server.get(&format!("{gains}&quantity=spectral_radius")).await.expect(200).json();
    assert!(number_at(&map, "/values/1/3") < 0.9 && number_at(&map, "/values/1/6") > 1.1, "{map}");
}

#[tokio::test]
async fn where_the_height_is_lost_the_law_is_about_the_bounce_of_the_release() {
    let server = Server::start();
    let whole = server.get("/v1/controllers?preset=case-1").await.expect(200).json();
    assert_eq!(whole["y_dot_change"], Value::Null);
    for (scene, largest) in [
        ("&scene.air.drag=0.02", 0.01),
        ("&scene.contact.restitution=0.9&scene.table.assumed_restitution=0.91", 0.02),
        ("&scene.contact.restitution=0.9&scene.table.errors.speed=-0.001", 0.02),
    ] {
        let law = server.get(&format!("/v1/controllers?preset=case-1{scene}")).await.expect(200).json();
        let (change, speed) = (number_at(&law, "/y_dot_change"), number_at(&law, "/fixed_point/y_dot"));
        assert!(change > 0.0 && change < largest, "{scene}: {change}");
        assert!((speed - number_at(&whole, "/fixed_point/y_dot")).abs() < 1e-9, "{scene}: {speed}");
        let notes = law["notes"].to_string();
        assert!(law["stable"] == true && notes.contains("no bounce repeats") && !notes.contains("  "), "{law}");
        // A run under the law loses that much a bounce, while its swing dies out.
        let (_, states) = run(&server, &law["scene"], json!({"theta": 0.01, "theta_dot": 0.0}), 30).await;
        let (_, last) = states.last().unwrap();
        assert!(states.len() == 30 && last.abs() < 1e-4, "{scene}: {} contacts, {last} rad", states.len());
    }
}

#[tokio::test]
async fn what_cannot_be_designed_says_why() {
    let server = Server::start();
    for (query, pointer, words) in [
        ("preset=point-mass", "/scene/body/point", "a body with an angle of its own"),
        ("preset=juggling", "/scene", "no bounce repeats"),
        ("preset=case-1&scene.release.height=0.13333333333333333&scene.release.theta=0", "/scene", "no upright bounce"),
        ("preset=case-1&weights.state.theta=-1", "/weights/state/theta", "from 0"),
        ("preset=case-1&weights.input=0", "/weights/input", "from 0.000001"),
        ("preset=case-1&weights.state.psi=1", "/weights/state/psi", "unknown"),
        ("preset=case-1&weights=1", "/weights", "object"),
        ("preset=case-1&contact=glue", "/contact", "frictionless"),
        ("preset=case-1&weights.state.x=0&weights.state.x_dot=0", "/weights", "without a weight does not die out"),
        (
            "preset=case-1&weights.state.x=0&weights.state.theta=0&weights.state.x_dot=0&weights.state.theta_dot=0",
            "/weights",
            "weight",
        ),
    ] {
        let answer = server.get(&format!("/v1/controllers?{query}")).await.expect(422);
        assert_eq!(answer.pointers(), [pointer], "{query}");
        assert!(answer.text().contains(words), "{query}: {}", answer.text());
    }
    for body in [json!({"preset": "case-1", "weights": {"input": 0}}), json!({"preset": "case-1", "contact": "glue"})] {
        assert!(!contract::faults(&DOCUMENT["components"]["schemas"]["ControllerRequest"], &body).is_empty(), "{body}");
    }
}

/// Weights over many powers of ten, and rods of many kinds.
#[tokio::test]
async fn no_weights_break_it() {
    let server = Server::start();
    let (mut laws, mut refused) = (0, 0);
    for number in 0..600_u32 {
        // Every power of ten is a digit of the scrambled number.
        let power = |place: u32| f64::from(number.wrapping_mul(2_654_435_761) / 7_u32.pow(place) % 13) - 6.0;
        let weight = |place| 10_f64.powf(power(place));
        let scene = json!({
            "body": {"contact_distance": 10_f64.powf(power(1) / 4.0), "radius_of_gyration": 10_f64.powf(power(2) / 4.0)},
            "contact": {"friction": f64::from(number % 3), "restitution": f64::from(number % 2)},
            "table": {"slide": if number % 5 == 0 { "matched" } else { "none" }},
            "release": {"height": 10_f64.powf(power(1) / 4.0) + weight(3).min(50.0)},
        });
        let state = json!({"x": weight(4), "theta": weight(5), "x_dot": weight(6), "theta_dot": weight(7)});
        let body = json!({"scene": scene, "weights": {"state": state, "input": weight(8)}});
        let answer = server.post("/v1/controllers", &body).await;
        match answer.status.as_u16() {
            200 => {
                laws += 1;
                let law = answer.json();
                assert!(law["spectral_radius"].as_f64().unwrap() < 1.0 && law["residual"].as_f64().unwrap() < 1e-8);
                for format in ["svg", "csv", "ndjson"] {
                    let headers = [("content-type", "application/json")];
                    let target = format!("/v1/controllers?format={format}");
                    if number % 20 == 0 {
                        server.send(axum::http::Method::POST, &target, &headers, &body.to_string()).await.expect(200);
                    }
                }
            }
            422 => refused += 1,
            other => panic!("{other} to {body}: {}", answer.text()),
        }
    }
    assert!(laws > 300 && refused > 0, "{laws} laws, {refused} refused");
}

#[tokio::test]
async fn a_law_is_differentiated_and_judged_like_any_table() {
    let server = Server::start();
    for contact in ["", "&scene.contact.friction=0.2&scene.contact.restitution=0.5&scene.release.theta=0.05"] {
        let law = server.get(&format!("/v1/controllers?preset=case-1{contact}")).await.expect(200).json();
        let scene = &law["scene"];
        let verdict = server.post("/v1/stability", &json!({"scene": scene})).await.expect(200).json();
        assert_eq!(
            (&verdict["verdict"]["text"], &verdict["agree"]),
            (&json!("stable in place"), &json!(true)),
            "{verdict}"
        );
        // The verdict has the eigenvalue of the height too.
        let moduli = |answer: &Value| -> Vec<f64> {
            let values = answer["eigenvalues"].as_array().unwrap();
            values.iter().map(|value| value["modulus"].as_f64().unwrap()).collect()
        };
        let (own, designed) = (moduli(&verdict["linear"]), moduli(&law));
        assert!(own.len() == designed.len() + 1, "{own:?} {designed:?}");
        // With friction the run settles on a bounce a little lower than the one that the law is designed for.
        for value in designed.into_iter().take(if contact.is_empty() { 4 } else { 1 }) {
            let within = if contact.is_empty() { 1e-9 } else { 0.02 };
            assert!(own.iter().any(|own| (own - value).abs() < within), "{value} of {own:?}");
        }
        let order = json!(["rho_theta", "x_dot", "y_dot", "rho_theta_dot", "x"]);
        for at in
            [json!("fixed_point"), json!({"state": {"x": 0.1, "theta": 0.02, "y_dot": -1.1}}), json!({"impact": 4})]
        {
            let body = json!({"scene": scene, "at": at});
            let exact = server.post("/v1/jacobians", &body).await.expect(200).json();
            assert_eq!((&exact["state_order"], exact["eigenvalues"].as_array().unwrap().len()), (&order, 5));
            if at == "fixed_point" && contact.is_empty() {
                // The closed loop, and the height, which no feedback controls.
                for value in law["eigenvalues"].as_array().unwrap() {
                    let near = |other: &Value| {
                        (number_at(other, "/re") - number_at(value, "/re"))
                            .hypot(number_at(other, "/im") - number_at(value, "/im"))
                    };
                    assert!(exact["eigenvalues"].as_array().unwrap().iter().any(|other| near(other) < 1e-9), "{value}");
                }
            }
        }
        for format in ["svg", "csv", "ndjson"] {
            let headers = [("content-type", "application/json")];
            let body = json!({"scene": scene}).to_string();
            let target = format!("/v1/stability?format={format}");
            server.send(axum::http::Method::POST, &target, &headers, &body).await.expect(200);
        }
    }
    // The wrong sign, and a start outside the basin.
    let law = server.get("/v1/controllers?preset=case-1").await.json()["scene"].clone();
    for (feedback, release, decided_by) in
        [(json!({"theta": 1.0}), json!({}), "linear"), (json!({}), json!({"theta": 1.2}), "nonlinear")]
    {
        let mut scene = law.clone();
        for (group, changes) in [("feedback", feedback), ("release", release)] {
            let target = if group == "feedback" { &mut scene["table"]["feedback"] } else { &mut scene["release"] };
            for (name, value) in changes.as_object().unwrap() {
                target[name] = value.clone();
            }
        }
        let verdict = server
            .post(
                "/v1/stability",
                &json!({"scene": scene, "tolerances": [{"field": "contact.restitution", "tolerance": 0.0}]}),
            )
            .await;
        let verdict = verdict.expect(200).json();
        assert_eq!(
            (&verdict["verdict"]["text"], &verdict["verdict"]["decided_by"]),
            (&json!("unstable"), &json!(decided_by)),
            "{verdict}"
        );
    }
}

#[tokio::test]
async fn weights_may_be_the_diagonal_of_a_matrix() {
    let server = Server::start();
    let ask =
        async |weights: Value| server.post("/v1/controllers", &json!({"preset": "case-1", "weights": weights})).await;
    let named =
        ask(json!({"state": {"x": 2, "theta": 20, "x_dot": 0.1, "theta_dot": 0.2}, "input": 5})).await.expect(200);
    let listed = ask(json!({"state": [2, 20, 0.1, 0.2], "input": 5})).await.expect(200);
    assert_eq!(named.json(), listed.json());
    assert_eq!(ask(json!({"state": [2, 20, 0.1]})).await.expect(422).pointers(), ["/weights/state"]);
    assert_eq!(ask(json!({"state": [2, -20, 0.1, 0.2]})).await.expect(422).pointers(), ["/weights/state/1"]);
    let query =
        "preset=case-1&weights.state.0=2&weights.state.1=20&weights.state.2=0.1&weights.state.3=0.2&weights.input=5";
    assert_eq!(server.get(&format!("/v1/controllers?{query}")).await.expect(200).json()["gain"], listed.json()["gain"]);
}

/// The law for a rig is told to the table of that rig, and its run comes to rest where the answer says.
#[tokio::test]
async fn a_law_is_for_the_rig_as_it_is() {
    let server = Server::start();
    let held = json!({"energy_gain": 0.2, "target_height": 0.2});
    for (table, air) in [
        (json!({"errors": {"tilt_gain": 0.02, "angle_bias": 0.001, "tilt_offset": 0.002}}), Value::Null),
        (json!({"delay": 0.003}), Value::Null),
        (json!({"delay": 0.003, "prediction": "flight"}), Value::Null),
        (json!({"tilt_rate": "follows", "pivot": {"x": 0.02, "depth": 0.03}}), Value::Null),
        (json!({"errors": {"tilt_offset": 0.002}}), json!({"drag": 0.05, "rotation_drag": 0.05})),
    ] {
        let mut scene = json!({"table": held, "release": {"theta": 0.05}});
        for (name, value) in table.as_object().unwrap() {
            scene["table"][name] = value.clone();
        }
        if !air.is_null() {
            scene["air"] = air;
        }
        let law = server.post("/v1/controllers", &json!({"preset": "case-1", "scene": scene})).await.expect(200).json();
        let (outcome, states) = run(&server, &law["scene"], json!({}), 600).await;
        let (x, theta) = states[599];
        let off = x - number_at(&law, "/fixed_point/x");
        assert!(outcome == "completed" && off.abs() < 1e-9 && theta.abs() < 1e-9, "{scene}: {off} {theta}");
        let verdict = server.post("/v1/stability", &json!({"scene": law["scene"]})).await.expect(200).json();
        assert_eq!(verdict["verdict"]["text"], "stable in place", "{scene}");
    }
}
