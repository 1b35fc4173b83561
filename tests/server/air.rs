//! Scenes in air that drags the body, in every resource that takes a scene.

use crate::failures::{case, number, says};
use crate::margins::margin;
use crate::support::Server;
use crate::support::socket::{open, start};
use serde_json::{Value, json};

const AIR: &str = "preset=case-1&scene.release.theta=0.05&scene.air.drag=0.2&scene.air.rotation_drag=0.1";

fn column<'a>(table: &'a Value, name: &str) -> &'a [Value] {
    table[name].as_array().unwrap()
}

#[tokio::test]
async fn air_drags_every_run() {
    let server = Server::start();
    let get = async |target: &str| server.get(target).await.expect(200).json();
    let run = get(&format!("/v1/trajectories?{AIR}&bounces=30&samples_per_flight=4")).await;
    assert_eq!(run["model"]["name"], "drag");
    assert!(number(&run["impacts"]["error_estimate"][20]) < 1e-10);
    // Between samples of a flight the velocities decay.
    let flights = &run["flights"];
    let (times, impacts) = (column(flights, "t"), column(flights, "impact"));
    for row in (1..times.len()).filter(|row| impacts[*row] == impacts[row - 1]) {
        let passed = number(&times[row]) - number(&times[row - 1]);
        for (name, rate) in [("x_dot", 0.2_f64), ("theta_dot", 0.1)] {
            let (before, after) = (number(&column(flights, name)[row - 1]), number(&column(flights, name)[row]));
            assert!((after - before * (-rate * passed).exp()).abs() < 1e-12 * (1.0 + before.abs()), "{name}");
        }
    }
    let ladder = get(&format!("/v1/ladder?{AIR}&bounces=20")).await;
    assert!(ladder.to_string().contains("\"drag\"") && ladder.to_string().contains("air.drag"), "{ladder}");
    let map = "x.field=air.drag&x.from=0&x.to=0.4&x.count=3&y.field=air.rotation_drag&y.from=0&y.to=1&y.count=2";
    let cells = get(&format!("/v1/regions?{AIR}&bounces=100&{map}")).await;
    assert_eq!(cells["counts"]["completed"], 6, "{cells}");
    let noisy = format!("/v1/ensembles?{AIR}&runs=4&bounces=60&scene.noise.timing_sd=1e-4");
    assert_eq!(get(&noisy).await["counts"]["completed"], 4);
    let zero = get("/v1/trajectories?preset=case-1&scene.air.drag=0&bounces=30").await;
    let ideal = get("/v1/trajectories?preset=case-1&bounces=30").await;
    assert_eq!(zero["impacts"], ideal["impacts"]);
    // With a height that the table holds there is a bounce to control and to repeat; without one the air takes it.
    let held = format!("{AIR}&scene.table.energy_gain=0.2&scene.table.target_height=0.2");
    for resource in ["catches", "controllers", "periodic-orbits", "precision", "throws"] {
        let rest = if resource == "throws" { "&impact=1&apex.height=0.3" } else { "" };
        server.get(&format!("/v1/{resource}?{held}{rest}")).await.expect(200);
        if ["controllers", "periodic-orbits"].contains(&resource) {
            let refused = server.get(&format!("/v1/{resource}?{AIR}")).await.expect(422);
            assert!(refused.text().contains("each one changes"), "{resource}: {}", refused.text());
        }
    }
    let linear = server.get(&format!("/v1/trajectories?{AIR}&method=linear")).await.expect(422);
    assert!(linear.text().contains("air.drag"), "{}", linear.text());
    for mixed in [
        "scene.table.delay=0.01",
        "scene.noise.timing_sd=0.001&scene.noise.model=plan",
        "scene.table.tilt_rate=follows&scene.table.pivot.x=0.02",
    ] {
        let run = get(&format!("/v1/trajectories?{AIR}&{mixed}&bounces=10")).await;
        assert_eq!(run["outcome"]["kind"], "completed", "{run}");
        let judged = get(&format!("/v1/stability?{AIR}&{mixed}&bounces=20")).await;
        assert!(judged["verdict"]["text"].is_string(), "{judged}");
    }
    let point = server.get("/v1/trajectories?preset=point-mass&scene.air.rotation_drag=0.1").await.expect(422);
    assert_eq!(point.pointers(), ["/scene/air/rotation_drag"]);
    let still = "preset=case-1&scene.contact.restitution=0.5&scene.table.strike=still&scene.air.drag=0.1";
    let held = get(&format!("/v1/trajectories?{still}&bounces=400&hold=0.1")).await;
    assert!(held["notes"].to_string().contains("hold is absent"), "{held}");
}

#[tokio::test]
async fn live_runs_fly_through_the_same_air() {
    let (_, address) = start().await;
    let still = "preset=case-1&scene.contact.restitution=0.5&scene.table.strike=still&scene.air.drag=0.1";
    let mut client = open(address, &format!("/v1/live?{still}&epoch_ms=1000&from=1")).await;
    let end = client.next_of("end").await;
    let run = Server::start().get(&format!("/v1/trajectories?{still}&bounces=400")).await.expect(200).json();
    for name in ["kind", "bounces", "t"] {
        assert_eq!(end["outcome"][name], run["outcome"][name], "{name} of {end}");
    }
}

#[tokio::test]
async fn the_case_on_an_air_table_is_stable_in_place_below_its_target() {
    let server = Server::start();
    let get = async |target: &str| server.get(target).await.expect(200).json();
    let answer = get("/v1/stability?preset=air-table&bounces=500").await;
    assert!(answer["verdict"]["text"].as_str().unwrap().starts_with("stable in place"), "{answer}");
    assert_eq!(answer["verdict"]["decided_by"], "linear");
    assert_eq!((&answer["drift_speed"], &answer["linear"]["residue"]), (&Value::Null, &Value::Null));
    let height = number(&answer["fixed_point"]["apex_height"]);
    assert!(height > 0.2 && height < 0.25 && answer["notes"].to_string().contains("does not know the air"), "{answer}");
    let run = get("/v1/trajectories?preset=air-table&bounces=2000").await;
    let last = number(column(&run["impacts"], "y_dot").last().unwrap());
    assert!((last - number(&answer["fixed_point"]["y_dot"])).abs() < 1e-9, "{last}");
    let jacobian = get("/v1/jacobians?preset=air-table").await;
    let radius = number(&jacobian["eigenvalues"][0]["modulus"]);
    assert!((radius - number(&answer["linear"]["spectral_radius"])).abs() < 1e-9, "{jacobian}");
    let found = get("/v1/stability?preset=air-table&bounces=200&tolerances.0.field=body.contact_distance&tolerances.0.tolerance=0.001").await;
    assert!(margin(&found, "table.tilt_gain")["above"]["least"].is_number(), "{found}");
    let picture = server.get("/v1/stability?preset=air-table&bounces=200&format=svg").await.expect(200);
    assert!(picture.text().contains("<svg"));
    let map = "x.field=air.drag&x.from=0.01&x.to=0.1&x.count=2&y.field=table.tilt_gain&y.from=1.1&y.to=1.2&y.count=2";
    let cells = get(&format!("/v1/regions?preset=air-table&quantity=spectral_radius&{map}")).await;
    assert!(cells["values"].as_array().unwrap().iter().flat_map(|row| row.as_array().unwrap()).all(Value::is_number));
    let budget = get("/v1/stability?preset=air-table&bounces=60&budget=true").await["budget"].to_string();
    assert!(budget.contains("air.rotation_drag"), "{budget}");
}

#[tokio::test]
async fn measured_impacts_tell_the_drag() {
    let server = Server::start();
    let run = server.get(&format!("/v1/trajectories?{AIR}&bounces=40")).await.expect(200).json();
    let measured = |name: &str| run["impacts"][name].clone();
    let body = json!({
        "preset": "case-1",
        "scene": {"release": {"theta": 0.05}, "air": {"drag": 0.1, "rotation_drag": 0.1}},
        "measured": {"n": measured("n"), "t": measured("t"), "theta": measured("theta")},
        "unknown": ["air.drag"],
        "sd": {"t": 1e-5, "theta": 1e-5},
    });
    let answer = server.post("/v1/fits", &body).await.expect(200).json();
    let drag = &answer["estimates"][0];
    assert!((number(&drag["value"]) - 0.2).abs() < 1e-3, "{drag}");
}

#[tokio::test]
async fn the_gallery_has_an_air_table_on_which_bounces_die_out() {
    let case = case("air-drag").await;
    assert_eq!(says(&case, "residue")["right"], false);
    assert_eq!(says(&case, "run of the scene")["right"], true);
    assert!(case["truth"]["detail"].as_str().unwrap().contains("no bounce repeats"), "{case}");
}
