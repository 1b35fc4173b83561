//! Friction over HTTP: one-sided derivatives, verdicts with their reasons, regions.

use crate::margins;
use crate::support::Server;
use serde_json::{Value, json};

#[tokio::test]
async fn a_derivative_names_what_the_contact_does() {
    let server = Server::start();
    let rough = "preset=case-1&scene.contact.friction=0.3&scene.table.slide=matched&scene.release.theta=0.05";
    let exact = server.get(&format!("/v1/jacobians?{rough}&at.impact=5&period=3")).await.json();
    assert_eq!(
        (&exact["contact_mode"], &exact["smooth"], &exact["one_sided"]),
        (&json!("stick"), &json!(true), &json!([]))
    );
}

#[tokio::test]
async fn on_a_kink_both_sides_are_told() {
    let server = Server::start();
    // v_t = cos α ẋ + sin α ẏ + l cos β θ̇ = 0, with friction too small to hold the contact.
    let (theta, y_dot, kappa, l) = (-0.4_f64, -1.5, 2.0, 0.4 / 3.0);
    let alpha = kappa * theta;
    let theta_dot = -alpha.sin() * y_dot / (l * (theta - alpha).cos());
    let body = json!({
        "preset": "case-1",
        "scene": {"contact": {"friction": 0.05}, "table": {"tilt_gain": kappa}},
        "at": {"state": {"theta": theta, "y_dot": y_dot, "theta_dot": theta_dot}},
    });
    let answer = server.post("/v1/jacobians", &body).await.json();
    assert_eq!(answer["smooth"], false, "{answer}");
    let sides = answer["one_sided"].as_array().unwrap();
    let mut modes: Vec<_> = sides.iter().map(|side| side["contact_mode"].as_str().unwrap()).collect();
    modes.sort_unstable();
    assert_eq!(modes, ["reverse_slide", "slide"]);
    assert_eq!(answer["matrix"], sides[0]["matrix"]);
    assert_ne!(sides[0]["matrix"], sides[1]["matrix"]);
    assert_eq!(sides[1]["eigenvalues"].as_array().unwrap().len(), 4);
}

#[tokio::test]
async fn a_matched_table_is_judged_by_its_own_boundary() {
    let server = Server::start();
    let scene = |friction: f64, kappa: f64, theta: f64| {
        format!(
            "preset=case-1&scene.contact.friction={friction}&scene.table.slide=matched&scene.table.tilt_gain={kappa}&scene.release.theta={theta}"
        )
    };
    let wide = scene(0.3, 2.4, 0.05);
    let answer = server.get(&format!("/v1/stability?{wide}")).await.json();
    assert_eq!(answer["verdict"]["text"], "elliptic, 2000 bounces survived", "{answer}");
    // 1 + G(ρ² + l²)/(V²l) for the paper's body and height; 1.5 without friction.
    let critical = margins::critical(&answer).as_f64().unwrap();
    assert!((critical - 2.5).abs() < 1e-12, "{critical}");
    let notes = answer["notes"].to_string();
    assert!(notes.contains("stick cone"), "{notes}");
    // 1/2 + ap + 2a²/3 with a = 1.5 and p = 1/3.
    assert!((answer["boundary"]["coefficient"].as_f64().unwrap() - 2.5).abs() < 1e-12, "{}", answer["boundary"]);
    assert!(answer["boundary"]["kind"] == "soft" && answer["rotation_number"]["measured"].is_number());
    let jacobian = server.get(&format!("/v1/jacobians?{wide}")).await.json();
    assert_eq!((&jacobian["smooth"], &jacobian["contact_mode"]), (&json!(true), &json!("stick")));
    assert_eq!(jacobian["residue"], answer["linear"]["residue"]);
    // Near the edge of the stick cone, 0.075 rad, the contact slides and the run falls; outside, the reason names the cone.
    let answer = server.get(&format!("/v1/stability?{}", scene(0.05, 2.0, 0.05))).await.json();
    assert_eq!(
        (&answer["verdict"]["text"], &answer["nonlinear"]["outcome"]["bounces"]),
        (&json!("unstable"), &json!(16))
    );
    let answer = server.get(&format!("/v1/stability?{}", scene(0.05, 2.0, 0.1))).await.json();
    assert!(
        answer["verdict"]["reason"].as_str().unwrap().contains("outside the stick cone"),
        "{}",
        answer["verdict"]["reason"]
    );
}

#[tokio::test]
async fn a_table_that_only_tilts_is_unstable_for_any_friction() {
    let server = Server::start();
    let rough = "preset=case-1&scene.contact.friction=0.05&scene.release.theta=0.05";
    let answer = server.get(&format!("/v1/stability?{rough}")).await.json();
    assert_eq!((&answer["verdict"]["text"], &answer["verdict"]["decided_by"]), (&json!("unstable"), &json!("linear")));
    assert!(answer["nonlinear"]["outcome"]["bounces"].as_u64().unwrap() <= 10);
    assert!(
        answer["verdict"]["reason"].as_str().unwrap().contains("sticks for any friction above 0"),
        "{}",
        answer["verdict"]["reason"]
    );
    let linear = &answer["linear"];
    assert!(
        margins::margin(&answer, "table.tilt_gain").is_null()
            && linear["residue"].is_null()
            && answer["drift_speed"].is_null()
    );
    let eigenvalues = linear["eigenvalues"].as_array().unwrap();
    assert!(eigenvalues[0]["re"].as_f64().unwrap() > 1.0 && eigenvalues.len() == 4);
    let jacobian = server.get(&format!("/v1/jacobians?{rough}")).await.json();
    for (one, other) in jacobian["eigenvalues"].as_array().unwrap().iter().zip(eigenvalues) {
        let [one, other] = [one, other].map(|value| value["re"].as_f64().unwrap());
        assert!((one - other).abs() < 1e-12, "{one} {other}");
    }
    assert!(jacobian["residue"].is_null() && jacobian["contact_mode"] == "stick");
    for format in ["svg", "csv"] {
        assert_eq!(server.get(&format!("/v1/stability?{rough}&format={format}")).await.status, 200);
    }
}

#[tokio::test]
async fn a_region_may_have_friction_as_a_side() {
    let server = Server::start();
    let target = "/v1/regions?preset=case-1&scene.table.slide=matched&scene.release.theta=0.02&bounces=400\
        &x.field=contact.friction&x.from=0&x.to=0.06&x.count=13&y.field=table.tilt_gain&y.from=1.2&y.to=2.4&y.count=5";
    let map = server.get(target).await.json();
    let (mut survived, mut fell) = (0, 0);
    for (row, kappa) in map["y"].as_array().unwrap().iter().enumerate() {
        for (column, friction) in map["x"].as_array().unwrap().iter().enumerate() {
            let run = format!(
                "/v1/trajectories?preset=case-1&scene.table.slide=matched&scene.release.theta=0.02&bounces=400\
                 &scene.contact.friction={friction}&scene.table.tilt_gain={kappa}"
            );
            let run = server.get(&run).await.json();
            let cell = &map["values"][row][column];
            assert_eq!(cell, &run["outcome"]["bounces"], "μ = {friction}, κ = {kappa}");
            if *cell == 400 { survived += 1 } else { fell += 1 }
        }
    }
    assert!(survived > 10 && fell > 10, "{survived} {fell}");
}

#[tokio::test]
async fn a_tolerance_is_held_with_friction_too() {
    let server = Server::start();
    let rough =
        "preset=case-1&scene.contact.friction=0.3&scene.table.slide=matched&scene.release.theta=0.05&bounces=100";
    for (tolerance, method) in [(1e-9, "map"), (1e-20, "extended")] {
        let run = server.get(&format!("/v1/trajectories?{rough}&tolerance={tolerance:e}")).await.json();
        assert_eq!(run["method"]["name"], method, "{}", run["method"]);
        assert!(run["impacts"]["error_estimate"][99].as_f64().unwrap() <= tolerance);
    }
}

/// Contacts that lose their speed come to rest, at the same contact and time for every resource and method.
#[tokio::test]
async fn a_contact_that_loses_its_speed_has_settled_everywhere() {
    let server = Server::start();
    let rod = "scene.body.contact_distance=0.5388&scene.body.radius_of_gyration=0.1672&scene.release.height=0.56\
               &scene.release.theta=0.28&scene.release.theta_dot=0.88&scene.release.x_dot=0.17&scene.contact.friction=0.91";
    // Numbers with 31 digits are strings.
    let positive = |flight: &Value| match flight {
        Value::String(digits) => digits.parse::<f64>().unwrap() > 0.0,
        flight => flight.as_f64().unwrap() > 0.0,
    };
    // A table that makes up all that the strike loses along its normal; a heavy body, which keeps cos 2α of its rise at e = 1; and a dead
    // stop on a still table.
    let heavy = "scene.body.contact_distance=0.01&scene.body.radius_of_gyration=5&scene.release.height=0.3\
                 &scene.release.theta=0.5&scene.contact.friction=10";
    for (rod, table, contacts) in [
        (rod, "scene.contact.restitution=0&scene.table.tilt_gain=2.08", 8),
        (heavy, "scene.contact.restitution=1&scene.table.tilt_gain=1", 35),
        (rod, "scene.contact.restitution=0&scene.table.tilt_gain=0.3&scene.table.strike=still", 1),
    ] {
        let query = format!("{rod}&{table}");
        let mut times = Vec::new();
        for method in ["map", "extended"] {
            let run =
                server.get(&format!("/v1/trajectories?{query}&bounces=100&method={method}")).await.expect(200).json();
            assert_eq!(run["outcome"]["kind"], "settled", "{method} {table}: {}", run["outcome"]);
            assert_eq!(run["outcome"]["bounces"], contacts, "{method} {table}: {}", run["outcome"]);
            let flights = run["impacts"]["flight_time"].as_array().unwrap();
            let (last, others) = flights.split_last().unwrap();
            assert!(last.is_null() && others.iter().all(positive), "{flights:?}");
            times.push(run["outcome"]["settle_time"].as_f64().unwrap());
        }
        assert!((times[0] - times[1]).abs() < 1e-12, "{table}: {times:?}");
        let region = format!(
            "/v1/regions?{query}&x.field=release.x&x.from=0&x.to=1&x.count=2&y.field=topple_angle&y.from=1.5&y.to=1.6\
             &y.count=2&bounces=100"
        );
        let map = server.get(&region).await.expect(200).json();
        assert_eq!((&map["counts"]["settled"], &map["values"][1][1]), (&json!(4), &json!(contacts)), "{table}");
        let ensemble = server.get(&format!("/v1/ensembles?{query}&runs=5&bounces=100")).await.expect(200).json();
        assert_eq!(ensemble["counts"]["settled"], 5, "{table}: {}", ensemble["counts"]);
        let verdict = server.get(&format!("/v1/stability?{query}")).await.expect(200).json();
        assert_eq!(verdict["nonlinear"]["outcome"]["kind"], "settled", "{table}: {}", verdict["nonlinear"]);
    }
}
