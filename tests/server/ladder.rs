//! The model hierarchy over HTTP: the smallest model for a scene, demands on the table, limits and noise.

use serde_json::{Value, json};

use crate::support::Server;
use crate::verdict::margin;

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
            server.post("/v1/trajectories", &json!({"scene": step["scene"], "bounces": 100})).await.expect(200).json();
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
    let run = server.get("/v1/trajectories?preset=case-4&bounces=60").await.expect(200).json();
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

    let limited = format!("/v1/trajectories?preset=case-4&bounces=60&scene.table.limits.stroke={}", 0.99 * stroke);
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
        server.get(&format!("/v1/trajectories?preset=case-1&bounces=40&{query}")).await.expect(200).json()
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
    let ask = async |query: &str| server.get(&format!("/v1/stability?bounces=50&{query}")).await.expect(200).json();
    let tolerances = "tolerances.0.field=body.contact_distance&tolerances.0.tolerance=0.01&tolerances.1.field=body.radius_of_gyration&tolerances.1.tolerance=0.004";
    let over = ask(&format!("preset=case-1&{tolerances}")).await;
    assert_eq!(over["over_tolerances"]["holds"], true);
    let worst = &over["over_tolerances"]["worst"];
    let (l, rho) = (&worst[0]["value"], &worst[1]["value"]);
    let there =
        ask(&format!("preset=case-1&scene.body.contact_distance={l}&scene.body.radius_of_gyration={rho}")).await;
    let [there_above, above] = [&there, &over].map(|answer| margin(answer, "table.tilt_gain")["above"].clone());
    assert_eq!(there_above["margin"], above["least"]);
    assert!(there.get("over_tolerances").is_none());
    // With a wrong belief about restitution a lossy contact needs energy feedback.
    let open = ask("preset=case-1&scene.contact.restitution=0.5&tolerances.0.field=contact.restitution&tolerances.0.tolerance=0.01").await["over_tolerances"].clone();
    assert!(open["holds"].is_null() && open["reason"].as_str().unwrap().contains("no bounce repeats"), "{open}");
    let held =
        ask("preset=case-4-total&tolerances.0.field=contact.restitution&tolerances.0.tolerance=0.01").await["over_tolerances"]
            .clone();
    assert_eq!(held["holds"], true);
    assert!(
        held["apex_height"]["least"].as_f64().unwrap() < 0.25 && held["apex_height"]["most"].as_f64().unwrap() > 0.25
    );
    let refused = server
        .get("/v1/stability?preset=case-1&tolerances.0.field=contact.restitution&tolerances.0.tolerance=-1")
        .await
        .expect(422);
    assert_eq!(refused.pointers(), ["/tolerances/0/tolerance"]);
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
        let target = format!(
            "/v1/stability?{query}&bounces=500&tolerances.0.field=body.contact_distance&tolerances.0.tolerance=0.0001"
        );
        let answer = server.get(&target).await.expect(200).json();
        assert_eq!(
            (&answer["verdict"]["code"], &answer["over_tolerances"]["holds"]),
            (&json!(code), &json!(holds)),
            "{query}"
        );
        let reason = answer["over_tolerances"]["reason"].as_str().unwrap();
        assert!(reason.contains("small deviations stay bounded for every body"), "{reason}");
        assert_eq!(reason.contains(&format!("`{code}`")), !holds, "{reason}");
    }
}

#[tokio::test]
async fn further_fields_may_have_tolerances_or_are_refused_by_name() {
    let server = Server::start();
    let ask = async |tolerances: &Value| {
        let body = json!({"preset": "case-4-total", "bounces": 50, "tolerances": tolerances});
        server.post("/v1/stability", &body).await.expect(200).json()
    };
    let of = |field: &str, off: f64| json!({"field": field, "tolerance": off});
    let answer = ask(&json!([of("table.errors.speed", 0.05), of("gravity", 0.1)])).await;
    let over = &answer["over_tolerances"];
    assert_eq!(over["holds"], true, "{over}");
    let (said, worst) = (&over["tolerances"], &over["worst"]);
    assert_eq!(said[1], json!({"field": "gravity", "unit": "m/s²", "tolerance": 0.1}));
    // The worst of the values has this margin by itself.
    let query: String = worst.as_array().unwrap().iter().fold(String::new(), |query, field| {
        format!("{query}&scene.{}={}", field["field"].as_str().unwrap(), field["value"])
    });
    let there = server.get(&format!("/v1/stability?preset=case-4-total&bounces=50{query}")).await.expect(200).json();
    let [there_above, above] = [&there, &answer].map(|answer| margin(answer, "table.tilt_gain")["above"].clone());
    assert_eq!(there_above["margin"], above["least"]);
    let open = ask(&json!([of("table.errors.angle_bias", 0.001)])).await["over_tolerances"].clone();
    assert!(open["holds"].is_null() && open["reason"].as_str().unwrap().contains("table.errors.angle_bias"), "{open}");
    let further = [of("gravity", 0.1), of("release.height", 0.1), of("table.errors.speed", 0.1)];
    let fourth = [&further[..], &[of("contact.restitution", 0.1), of("table.delay", 0.01)]].concat();
    let first = "/tolerances/0/field";
    for (tolerances, pointer) in [
        (json!([of("table.tilt_gain", 0.1)]), first),
        (json!([of("body.contact_distance", 1.5)]), "/tolerances/0/tolerance"),
        (json!([of("noise.x_sd", 0.001)]), first),
        (json!([of("table.strike", 0.1)]), first),
        (json!([of("table.speed", 0.1)]), first),
        (json!([{"tolerance": 0.1}]), first),
        (json!([{"field": "gravity"}]), "/tolerances/0/tolerance"),
        (json!([of("gravity", -0.1)]), "/tolerances/0/tolerance"),
        (json!([of("gravity", 0.1), of("gravity", 0.1)]), "/tolerances/1/field"),
        (json!([of("gravity", 0.1), 5]), "/tolerances/1"),
        (json!(fourth), "/tolerances/4/field"),
        (json!({"contact_distance": 0.1}), "/tolerances"),
        (json!([{}, {}, {}, {}, {}, {}, {}]), "/tolerances"),
    ] {
        let body = json!({"preset": "case-4", "tolerances": tolerances});
        let refused = server.post("/v1/stability", &body).await.expect(422);
        assert_eq!(refused.pointers(), [pointer], "{tolerances}");
    }
}

#[tokio::test]
async fn a_query_can_take_a_value_back() {
    let server = Server::start();
    let query = "preset=case-1&bounces=20&scene.table.tilt_gain=null&scene.table.feedback.theta=-1.1";
    let run = server.get(&format!("/v1/trajectories?{query}")).await.expect(200).json();
    assert!(run["scene"]["table"].get("tilt_gain").is_none());
    assert_eq!(run["outcome"]["kind"], "completed");
    // In a JSON body the string "null" is a string.
    let body = json!({"preset": "case-1", "scene": {"table": {"tilt_gain": "null"}}});
    assert_eq!(server.post("/v1/trajectories", &body).await.expect(422).pointers(), ["/scene/table/tilt_gain"]);
}
