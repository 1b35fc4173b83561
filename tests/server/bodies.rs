//! Bodies beyond the plain rod, in every resource that takes a scene: with friction, in air that drags them, and polygons.

use serde_json::{Value, json};

use crate::failures::{case, says};
use crate::support::socket::{open, start};
use crate::support::{Server, close, number};
use crate::verdict;
use crate::verdict::margin;

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
    let critical = verdict::critical(&answer).as_f64().unwrap();
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
        verdict::margin(&answer, "table.tilt_gain").is_null()
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

// Scenes in air that drags the body, in every resource that takes a scene.

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
    // With a height that the table holds there is a bounce to control and to repeat; without one the air takes it, and the answer says how fast.
    let held = format!("{AIR}&scene.table.energy_gain=0.2&scene.table.target_height=0.2");
    for resource in ["catches", "controllers", "periodic-orbits", "precision", "throws"] {
        let rest = if resource == "throws" { "&impact=1&apex.height=0.3" } else { "" };
        server.get(&format!("/v1/{resource}?{held}{rest}")).await.expect(200);
        if ["controllers", "periodic-orbits"].contains(&resource) {
            let lost = server.get(&format!("/v1/{resource}?{AIR}")).await.expect(200);
            assert!(lost.text().contains("each one changes"), "{resource}: {}", lost.text());
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

// Polygons: derived quantities, refusals, and the vertex that ends a run.

fn triangle() -> Value {
    json!([[0, 0], [0.05, 0.2], [-0.05, 0.2]])
}

/// A flat roof, upside down.
fn wide() -> Value {
    json!([[0, 0], [0.15, 0.05], [-0.15, 0.05]])
}

fn dropped(body: &Value, tilt_gain: f64, height: f64, theta: f64) -> Value {
    json!({"body": body, "table": {"tilt_gain": tilt_gain}, "release": {"height": height, "theta": theta}})
}

#[tokio::test]
async fn the_true_triangle_says_that_no_other_vertex_touches_and_how_near_one_comes() {
    let server = Server::start();
    let scene = dropped(&json!({"vertices": triangle()}), 1.1, 0.2, 0.3);
    let answer = server.post("/v1/trajectories", &json!({"scene": scene, "bounces": 2000})).await.expect(200).json();
    assert_eq!(answer["outcome"]["kind"], "completed");
    assert_eq!(answer["model"]["name"], "polygon");
    assert_eq!(answer["model"]["forced"][0]["field"], "body.vertices");
    assert_eq!(
        answer["scene"]["body"],
        json!({"vertices": [[0.0, 0.0], [0.05, 0.2], [-0.05, 0.2]], "contact_vertex": 0})
    );
    // About the centroid, two thirds of the height above the lower corner.
    let outline = &answer["derived"]["outline"];
    for (vertex, [x, y]) in [[0.0, -0.4 / 3.0], [0.05, 0.2 / 3.0], [-0.05, 0.2 / 3.0]].into_iter().enumerate() {
        close(&outline[vertex][0], x, 1e-15);
        close(&outline[vertex][1], y, 1e-15);
    }
    close(&answer["derived"]["contact_distance"], 0.4 / 3.0, 1e-15);
    let nearest = &answer["nearest_vertex"];
    close(&nearest["clearance"], 0.19787, 1e-5);
    let n = nearest["impact"].as_u64().unwrap() as usize;
    let impact = |column: &str| answer["impacts"][column][n - 1].as_f64().unwrap();
    assert_eq!(nearest["t"].as_f64().unwrap(), impact("t"));
    // By hand: heights of the two upper corners over the table's line through the lower one.
    let beta: f64 = impact("theta") - impact("alpha");
    let corner = if beta > 0.0 { -0.05 } else { 0.05 };
    close(&nearest["clearance"], corner * beta.sin() + 0.2 * beta.cos(), 1e-12);
    assert_eq!(nearest["vertex"], if beta > 0.0 { 2 } else { 1 });
    // The last line of NDJSON has it too; a rod has none.
    let lines =
        server.post("/v1/trajectories?format=ndjson", &json!({"scene": scene, "bounces": 2000})).await.expect(200);
    let last: Value = serde_json::from_str(lines.text().trim_end().rsplit('\n').next().unwrap()).unwrap();
    assert_eq!(last["end"]["nearest_vertex"], *nearest);
    assert_eq!(server.get("/v1/trajectories?preset=case-1").await.json().get("nearest_vertex"), None);
}

#[tokio::test]
async fn a_wide_polygon_ends_where_its_rod_goes_on() {
    let server = Server::start();
    let ask = async |scene: &Value| {
        server.post("/v1/trajectories", &json!({"scene": scene, "bounces": 500})).await.expect(200).json()
    };
    let polygon = ask(&dropped(&json!({"vertices": wide()}), 1.3, 0.1, 0.3)).await;
    let lengths =
        json!({"contact_distance": 0.1 / 3.0, "radius_of_gyration": (0.09_f64 / 24.0 + 0.0025 / 18.0).sqrt()});
    let rod = ask(&dropped(&lengths, 1.3, 0.1, 0.3)).await;
    assert_eq!(rod["outcome"]["kind"], "completed");
    let outcome = &polygon["outcome"];
    assert_eq!(outcome["kind"], "other_vertex");
    assert_eq!(outcome["bounces"], 3);
    assert!(outcome["detail"].as_str().unwrap().contains("vertex 1 of the body"), "{outcome}");
    // The touch comes after the last contact, when that vertex reaches y = 0.
    let since = outcome["t"].as_f64().unwrap() - polygon["impacts"]["t"][2].as_f64().unwrap();
    assert!(since > 0.2 && polygon["impacts"]["flight_time"][2].is_null(), "{outcome}");
    for column in ["theta", "y_dot", "x_dot"] {
        for n in 0..3 {
            close(&polygon["impacts"][column][n], rod["impacts"][column][n].as_f64().unwrap(), 1e-12);
        }
    }
    let request = json!({"scene": polygon["scene"], "bounces": 500});
    let ladder = server.post("/v1/ladder", &request).await.expect(200).json().to_string();
    assert!(ladder.contains("other_vertex") && ladder.contains("completed"), "{ladder}");
    let stability = server.post("/v1/stability", &json!({"scene": polygon["scene"]})).await.expect(200).json();
    assert_eq!(stability["nonlinear"]["outcome"]["kind"], "other_vertex", "{stability}");
}

#[tokio::test]
async fn a_polygon_is_the_same_in_json_and_in_a_query() {
    let server = Server::start();
    let scene = dropped(&json!({"vertices": triangle(), "contact_vertex": 0}), 1.1, 0.2, 0.3);
    let posted = server.post("/v1/trajectories", &json!({"scene": scene, "bounces": 5})).await.expect(200).json();
    let query = "scene.body.vertices.0.0=0&scene.body.vertices.0.1=0&scene.body.vertices.1.0=0.05&scene.body.vertices.1.1=0.2\
        &scene.body.vertices.2.0=-0.05&scene.body.vertices.2.1=0.2&scene.table.tilt_gain=1.1&scene.release.height=0.2\
        &scene.release.theta=0.3&bounces=5";
    assert_eq!(server.get(&format!("/v1/trajectories?{query}")).await.expect(200).json(), posted);
    let holes = query.replace("vertices.2.", "vertices.3.");
    let answer = server.get(&format!("/v1/trajectories?{holes}")).await.expect(422);
    assert_eq!(answer.pointers(), ["/scene/body/vertices"]);
}

#[tokio::test]
async fn a_polygon_replaces_another_kind_of_body_whole_and_vertices_are_replaced_whole() {
    let server = Server::start();
    let body = async |preset: &str, body: Value| {
        let request = json!({"preset": preset, "scene": {"body": body}, "bounces": 1});
        server.post("/v1/trajectories", &request).await
    };
    let from_rod = body("case-1", json!({"vertices": triangle()})).await.expect(200).json();
    assert_eq!(from_rod["scene"]["body"]["contact_vertex"], 0);
    let square = json!([[0, 0], [0.1, 0.1], [0, 0.2], [-0.1, 0.1]]);
    let other = body("triangle-polygon", json!({"vertices": square})).await.expect(200).json();
    assert_eq!(other["scene"]["body"]["vertices"].as_array().unwrap().len(), 4);
    let rod = json!({"contact_distance": 0.1, "radius_of_gyration": 0.1});
    assert_eq!(body("triangle-polygon", rod.clone()).await.expect(200).json()["scene"]["body"], rod);
    let half = body("triangle-polygon", json!({"contact_distance": 0.1})).await.expect(422);
    assert_eq!(half.pointers(), ["/scene/body/radius_of_gyration"]);
    let upside_down = body("triangle-polygon", json!({"contact_vertex": 1})).await.expect(200).json();
    assert_eq!(upside_down["scene"]["body"]["contact_vertex"], 1);
}

#[tokio::test]
async fn what_is_no_polygon_says_why_and_where() {
    let server = Server::start();
    let many: Vec<Value> = (0..33).map(|n| json!([n as f64 * 0.1, (n * n) as f64 * 1e-3])).collect();
    let l_shape = json!([[0, 0], [0.3, 0], [0.3, 0.1], [0.1, 0.1], [0.1, 0.4], [0, 0.4]]);
    let vertices = "/scene/body/vertices";
    let contact = "/scene/body/contact_vertex";
    for (body, pointer, words) in [
        (json!({"vertices": []}), vertices, "vertices are 0; a polygon has from 3 to 32"),
        (json!({"vertices": [[0, 0], [1, 1]]}), vertices, "vertices are 2"),
        (json!({"vertices": many}), vertices, "an array of 3 to 32 points"),
        (json!({"vertices": 7}), vertices, "vertices is 7"),
        (json!({"vertices": [[0, 0], [0.1], [0, 0.1]]}), "/scene/body/vertices/1", "it must be [x, y] in m"),
        (json!({"vertices": [[0, 0], [0.1, "0"], [0, 0.1]]}), "/scene/body/vertices/1/1", "y of vertex 1"),
        (json!({"vertices": [[0, 0], [11, 0], [0, 0.1]]}), "/scene/body/vertices/1/0", "from -10 to 10 m"),
        (json!({"vertices": [[0, 0], [0.1, 0.1], [0.1, 0], [0, 0.1]]}), vertices, "cross or touch"),
        (json!({"vertices": [[0, 0], [-0.05, 0.2], [0.05, 0.2]]}), vertices, "clockwise; reverse their order"),
        (json!({"vertices": [[0, 0], [0.1, 0.1], [0.2, 0.2]]}), vertices, "flat"),
        (
            json!({"vertices": [[0, 0], [0.1, 0], [0.1, 0], [0, 0.1]]}),
            vertices,
            "vertices 1 and 2 are at the same place",
        ),
        (json!({"vertices": triangle(), "contact_vertex": 3}), contact, "of 3 vertices it must be from 0 to 2"),
        (json!({"vertices": triangle(), "contact_vertex": 0.5}), contact, "a whole number"),
        (json!({"vertices": l_shape}), contact, "vertices 0 and 1 are equally low"),
        (json!({"vertices": l_shape, "contact_vertex": 3}), contact, "convex hull"),
        (
            json!({"vertices": triangle(), "contact_distance": 0.1}),
            "/scene/body/contact_distance",
            "follows from vertices",
        ),
        (json!({"vertices": triangle(), "point": true}), vertices, "a point mass has no vertices"),
        (json!({"contact_vertex": 0}), contact, "there are none"),
    ] {
        let request = json!({"preset": "case-1", "scene": {"body": body}});
        let answer = server.post("/v1/trajectories", &request).await.expect(422).json();
        let errors = answer["errors"].as_array().unwrap();
        let said = |error: &Value| error["pointer"] == pointer && error["detail"].as_str().unwrap().contains(words);
        assert!(errors.iter().any(said), "{body}: {answer}");
    }
    // At the release another vertex is below the table's line.
    let scene = dropped(&json!({"vertices": triangle()}), 1.1, 0.03, 1.5);
    let answer = server.post("/v1/trajectories", &json!({"scene": scene})).await.expect(422);
    assert_eq!(answer.pointers(), ["/scene/release/height"]);
}

#[tokio::test]
async fn what_is_derived_for_a_bounce_holds_for_a_polygon() {
    let server = Server::start();
    let scene = dropped(&json!({"vertices": triangle()}), 1.1, 0.2, 0.05);
    let lengths = json!({"contact_distance": 0.4 / 3.0, "radius_of_gyration": (0.01_f64 / 24.0 + 0.04 / 18.0).sqrt()});
    let rod = dropped(&lengths, 1.1, 0.2, 0.05);
    let (ours, its) = (
        server.post("/v1/jacobians", &json!({"scene": scene})).await.expect(200).json(),
        server.post("/v1/jacobians", &json!({"scene": rod})).await.expect(200).json(),
    );
    for (one, other) in ours["matrix"].as_array().unwrap().iter().zip(its["matrix"].as_array().unwrap()) {
        for (one, other) in one.as_array().unwrap().iter().zip(other.as_array().unwrap()) {
            close(one, other.as_f64().unwrap(), 1e-12);
        }
    }
    let stability = server.post("/v1/stability", &json!({"scene": scene})).await.expect(200).json();
    close(&verdict::critical(&stability), 1.1484, 1e-4);
    // A region runs the polygon itself, so cells far from upright end as other_vertex.
    let region = json!({
        "scene": dropped(&json!({"vertices": wide()}), 1.3, 0.1, 0.0), "bounces": 100,
        "x": {"field": "release.theta", "from": 0.0, "to": 0.3, "count": 4},
        "y": {"field": "table.tilt_gain", "from": 1.2, "to": 1.3, "count": 2},
    });
    let region = server.post("/v1/regions", &region).await.expect(200).json();
    assert!(region["counts"]["other_vertex"].as_u64().unwrap() > 0, "{region}");
    let request = json!({"scene": scene, "method": "linear"});
    let answer = server.post("/v1/trajectories", &request).await.expect(422);
    assert_eq!(answer.pointers(), ["/method"], "{}", answer.text());
    // With 31 digits the run is that of the rod with the same lengths, up to the touch of another vertex.
    let fallen = dropped(&json!({"vertices": wide()}), 1.3, 0.1, 0.3);
    let run = async |method: &str| {
        let request = json!({"scene": fallen, "method": method});
        server.post("/v1/trajectories", &request).await.expect(200).json()
    };
    let (map, exact) = (run("map").await, run("extended").await);
    assert_eq!(map["outcome"]["kind"], "other_vertex", "{map}");
    for member in ["kind", "bounces"] {
        assert_eq!(map["outcome"][member], exact["outcome"][member]);
    }
    close(&exact["outcome"]["t"], map["outcome"]["t"].as_f64().unwrap(), 1e-12);
}
