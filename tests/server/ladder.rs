//! The model hierarchy over HTTP: the smallest model for a scene, demands on the table, limits and noise.

use crate::support::Server;
use serde_json::{Value, json};

#[tokio::test]
async fn a_ladder_says_what_was_needed() {
    let server = Server::start();
    let ask = async |query: &str| server.get(&format!("/v1/ladder?{query}")).await.expect(200).json();
    let small = ask("preset=case-1&scene.release.theta=0.0001").await;
    assert_eq!((&small["rung"], &small["enough"]), (&json!("rod"), &json!("linear")));
    let wide = ask("preset=case-1").await;
    assert_eq!((&wide["rung"], &wide["enough"]), (&json!("rod"), &json!("rod")));
    let rough = ask("preset=case-1&scene.contact.friction=0.05&scene.release.theta=0.05").await;
    assert_eq!((&rough["rung"], &rough["enough"]), (&json!("friction"), &json!("friction")));
    let step = rough["rungs"].as_array().unwrap().last().unwrap().clone();
    assert_eq!(
        (&step["forced"]["field"], &step["change"]["same_outcome"]),
        (&json!("contact.friction"), &json!(false))
    );
    // On a matched table, friction changes the law only in scale; it still needs its model.
    let noisy = ask("preset=case-1&scene.noise.timing_sd=1e-9&tolerance=0.01").await;
    assert_eq!((&noisy["rung"], &noisy["enough"]), (&json!("noise"), &json!("rod")));
    // The scene of every rung is a valid request.
    for step in rough["rungs"].as_array().unwrap() {
        let run =
            server.post("/v1/trajectories", &json!({"scene": step["scene"], "impacts": 100})).await.expect(200).json();
        if step["name"] != "linear" {
            assert_eq!(run["outcome"], step["outcome"]);
        }
    }
    let wedge = json!({"scene": {
        "body": {"vertices": [[0.0, 0.0], [0.05, 0.2], [-0.05, 0.2]]}, "contact": {"friction": 0.2},
        "table": {"tilt_gain": 1.1, "slide": "matched"}, "release": {"height": 0.2, "theta": 0.02},
    }});
    let wedge = server.post("/v1/ladder", &wedge).await.expect(200).json();
    let names: Vec<_> = wedge["rungs"].as_array().unwrap().iter().map(|step| step["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["linear", "rod", "friction", "polygon"]);
    assert_eq!(wedge["enough"], "friction");
    assert!(wedge["rungs"][2]["scene"]["body"]["contact_distance"].is_number(), "{wedge}");
    let point = ask("preset=point-mass").await;
    assert_eq!(point["rungs"].as_array().unwrap().len(), 1);
}

#[tokio::test]
async fn a_run_says_what_it_asked_of_the_table() {
    let server = Server::start();
    let run = server.get("/v1/trajectories?preset=case-4&impacts=60").await.expect(200).json();
    let column =
        |name: &str| run["impacts"][name].as_array().unwrap().iter().filter_map(Value::as_f64).collect::<Vec<_>>();
    let largest = |values: Vec<f64>| values.into_iter().map(f64::abs).fold(0.0, f64::max);
    assert_eq!(run["demand"]["tilt"], json!(largest(column("alpha"))));
    let speeds = column("table_velocity_x").iter().zip(column("table_velocity_y")).map(|(x, y)| x.hypot(y)).collect();
    let speed = run["demand"]["speed"].as_f64().unwrap();
    assert!((speed - largest(speeds)).abs() < 1e-12);
    let (alpha, t) = (column("alpha"), column("t"));
    let rates = (1..60).map(|n| (alpha[n] - alpha[n - 1]) / (t[n] - t[n - 1])).collect();
    assert!((run["demand"]["tilt_rate"].as_f64().unwrap() - largest(rates)).abs() < 1e-9);
    let stroke = run["demand"]["stroke"].as_f64().unwrap();
    assert!(stroke > 0.0 && stroke < speed * 1.0, "{stroke}");

    let limited = format!("/v1/trajectories?preset=case-4&impacts=60&scene.table.limits.stroke={}", 0.99 * stroke);
    let ended = server.get(&limited).await.expect(200).json();
    assert_eq!((&ended["outcome"]["kind"], &ended["outcome"]["quantity"]), (&json!("beyond_limits"), &json!("stroke")));
    assert_eq!(ended["outcome"]["unit"], "m");
    let within = limited.replace(&(0.99 * stroke).to_string(), &(1.01 * stroke).to_string());
    assert_eq!(server.get(&within).await.json()["outcome"]["kind"], "completed");
    let refused = server.get(&format!("{limited}&method=linear")).await.expect(422);
    assert!(refused.text().contains("limits"), "{}", refused.text());
}

#[tokio::test]
async fn noise_depends_on_its_seed_and_is_off_at_zero() {
    let server = Server::start();
    let run = async |query: &str| {
        server.get(&format!("/v1/trajectories?preset=case-1&impacts=40&{query}")).await.expect(200).json()
    };
    let (first, again) = (
        run("scene.noise.timing_sd=0.003&scene.noise.seed=7").await,
        run("scene.noise.seed=7&scene.noise.timing_sd=0.003").await,
    );
    assert_eq!(first, again);
    assert_eq!(first["model"]["name"], "noise");
    let other = run("scene.noise.timing_sd=0.003&scene.noise.seed=8").await;
    assert_ne!(first["impacts"]["theta"], other["impacts"]["theta"]);
    let off = run("scene.noise.timing_sd=0&scene.noise.seed=7").await;
    let plain = run("").await;
    assert_eq!((&off["impacts"], &off["model"]["name"]), (&plain["impacts"], &json!("rod")));
    // The strike happens at the contact point's place at that time.
    let cells = |name: &str| first["impacts"][name].as_array().unwrap().clone();
    assert!(cells("clearance").iter().all(|cell| cell.as_f64().unwrap() != 0.0));
    let sensed = run("scene.noise.angle_sd=0.01&scene.noise.model=plan").await;
    let (alpha, theta) = (&sensed["impacts"]["alpha"][0], &sensed["impacts"]["theta"][0]);
    let error = alpha.as_f64().unwrap() / 1.1 - theta.as_f64().unwrap();
    assert!(error != 0.0 && error.abs() < 0.06, "{error}");
}

#[tokio::test]
async fn two_ways_of_tilting_are_an_error_that_says_how_to_mend_it() {
    let server = Server::start();
    let both = json!({"preset": "case-1", "scene": {"table": {"feedback": {"theta": -1.1}}}});
    let answer = server.post("/v1/trajectories", &both).await.expect(422);
    assert_eq!(answer.pointers(), ["/scene/table/tilt_gain"]);
    assert!(answer.text().contains("null takes"), "{}", answer.text());
    let one = json!({"preset": "case-1", "scene": {"table": {"feedback": {"theta": -1.1}, "tilt_gain": null}}});
    let run = server.post("/v1/trajectories", &one).await.expect(200).json();
    assert_eq!(run["scene"]["table"]["feedback"], json!({"x": 0.0, "theta": -1.1, "x_dot": 0.0, "theta_dot": 0.0}));
}

#[tokio::test]
async fn margins_hold_for_every_body_within_the_tolerances() {
    let server = Server::start();
    let ask = async |query: &str| server.get(&format!("/v1/stability?impacts=50&{query}")).await.expect(200).json();
    let tolerances = "tolerances.contact_distance=0.01&tolerances.radius_of_gyration=0.004";
    let margins = ask(&format!("preset=case-1&{tolerances}")).await["margins"].clone();
    assert_eq!(margins["holds"], true);
    let (least, worst) = (margins["tilt_gain"]["critical"]["least"].as_f64().unwrap(), &margins["tilt_gain"]["worst"]);
    let (l, rho) = (&worst["contact_distance"], &worst["radius_of_gyration"]);
    let there =
        ask(&format!("preset=case-1&scene.body.contact_distance={l}&scene.body.radius_of_gyration={rho}")).await;
    assert_eq!(there["linear"]["tilt_gain"]["critical"], json!(least));
    assert!(there.get("margins").is_none());
    // With a wrong belief about restitution a lossy contact needs energy feedback.
    let open = ask("preset=case-1&scene.contact.restitution=0.5&tolerances.restitution=0.01").await["margins"].clone();
    assert!(open["holds"].is_null() && open["reason"].as_str().unwrap().contains("no bounce repeats"), "{open}");
    let held = ask("preset=case-4-total&tolerances.restitution=0.01").await["margins"].clone();
    assert_eq!(held["holds"], true);
    assert!(
        held["apex_height"]["least"].as_f64().unwrap() < 0.25 && held["apex_height"]["most"].as_f64().unwrap() > 0.25
    );
    let refused = server.get("/v1/stability?preset=case-1&tolerances.restitution=-1").await.expect(422);
    assert_eq!(refused.pointers(), ["/tolerances/restitution"]);
}

#[tokio::test]
async fn margins_hold_only_where_the_verdict_does() {
    let server = Server::start();
    for (query, code, holds) in [
        ("preset=case-1", "elliptic", true),
        ("preset=case-4", "weakly_unstable", false),
        ("preset=case-4-total", "elliptic", true),
        // The residue is above 1/2, where swings die out.
        ("preset=case-4&scene.table.tilt_gain=1.2&scene.release.theta=0.1", "weakly_attracting", true),
        // The linear verdict is stable; the start is outside the basin.
        ("preset=case-1&scene.table.tilt_gain=1.3", "unstable", false),
    ] {
        let target = format!("/v1/stability?{query}&impacts=500&tolerances.contact_distance=0.0001");
        let answer = server.get(&target).await.expect(200).json();
        assert_eq!((&answer["verdict_code"], &answer["margins"]["holds"]), (&json!(code), &json!(holds)), "{query}");
        let reason = answer["margins"]["reason"].as_str().unwrap();
        assert!(reason.contains("small deviations stay bounded for every body"), "{reason}");
        assert_eq!(reason.contains(&format!("`{code}`")), !holds, "{reason}");
    }
}

#[tokio::test]
async fn further_fields_may_have_tolerances_or_are_refused_by_name() {
    let server = Server::start();
    let ask = async |tolerances: &Value| {
        let body = json!({"preset": "case-4-total", "impacts": 50, "tolerances": tolerances});
        server.post("/v1/stability", &body).await.expect(200).json()["margins"].clone()
    };
    let parameter = |path: &str, off: f64| json!({"parameter": path, "tolerance": off});
    let margins = ask(&json!({"parameters": [parameter("table.errors.speed", 0.05), parameter("gravity", 0.1)]})).await;
    assert_eq!(margins["holds"], true, "{margins}");
    let (said, worst) = (&margins["tolerances"]["parameters"], &margins["tilt_gain"]["worst"]["parameters"]);
    assert_eq!(said[1], json!({"parameter": "gravity", "unit": "m/s²", "value": 0.1}));
    // The worst of the values has this margin by itself.
    let query: String = worst.as_array().unwrap().iter().fold(String::new(), |query, field| {
        format!("{query}&scene.{}={}", field["parameter"].as_str().unwrap(), field["value"])
    });
    let there = server.get(&format!("/v1/stability?preset=case-4-total&impacts=50{query}")).await.expect(200).json();
    assert_eq!(there["linear"]["tilt_gain"]["critical"], margins["tilt_gain"]["critical"]["least"]);
    let plain = ask(&json!({"restitution": 0.01})).await;
    assert!(plain["tolerances"].get("parameters").is_none(), "{plain}");
    assert_eq!(plain, ask(&json!({"restitution": 0.01, "parameters": []})).await);
    let open = ask(&json!({"parameters": [parameter("table.errors.angle_bias", 0.001)]})).await;
    assert!(open["holds"].is_null() && open["reason"].as_str().unwrap().contains("table.errors.angle_bias"), "{open}");
    let first = "/tolerances/parameters/0/parameter";
    for (parameters, pointer) in [
        (json!([parameter("table.tilt_gain", 0.1)]), first),
        (json!([parameter("body.contact_distance", 0.001)]), first),
        (json!([parameter("noise.x_sd", 0.001)]), first),
        (json!([parameter("table.strike", 0.1)]), first),
        (json!([parameter("table.speed", 0.1)]), first),
        (json!([{"tolerance": 0.1}]), first),
        (json!([{"parameter": "gravity"}]), "/tolerances/parameters/0/tolerance"),
        (json!([parameter("gravity", -0.1)]), "/tolerances/parameters/0/tolerance"),
        (json!([parameter("gravity", 0.1), parameter("gravity", 0.1)]), "/tolerances/parameters/1/parameter"),
        (json!([parameter("gravity", 0.1), 5]), "/tolerances/parameters/1"),
        (json!({"gravity": 0.1}), "/tolerances/parameters"),
        (json!([{}, {}, {}, {}]), "/tolerances/parameters"),
    ] {
        let body = json!({"preset": "case-4", "tolerances": {"parameters": parameters}});
        let refused = server.post("/v1/stability", &body).await.expect(422);
        assert_eq!(refused.pointers(), [pointer], "{parameters}");
    }
}

#[tokio::test]
async fn a_query_can_take_a_value_back() {
    let server = Server::start();
    let query = "preset=case-1&impacts=20&scene.table.tilt_gain=null&scene.table.feedback.theta=-1.1";
    let run = server.get(&format!("/v1/trajectories?{query}")).await.expect(200).json();
    assert!(run["scene"]["table"].get("tilt_gain").is_none());
    assert_eq!(run["outcome"]["kind"], "completed");
    // In a JSON body the string "null" is a string.
    let body = json!({"preset": "case-1", "scene": {"table": {"tilt_gain": "null"}}});
    assert_eq!(server.post("/v1/trajectories", &body).await.expect(422).pointers(), ["/scene/table/tilt_gain"]);
}
