//! The laws by which a table steers the energy: errors that say why, and every resource on the presets that have them.

use crate::margins::margin;
use crate::support::Server;
use serde_json::{Value, json};

const G: f64 = 9.81;

fn numbers(column: &Value) -> Vec<f64> {
    column.as_array().expect("a column").iter().map(|cell| cell.as_f64().expect("a number")).collect()
}

#[tokio::test]
async fn contradictions_say_why() {
    let server = Server::start();
    let steered = |table: Value| json!({"preset": "case-1", "scene": {"table": table}});
    let program = "an array of 1 to 16 numbers from 0.001 to 100 m";
    for (request, pointer, words) in [
        (steered(json!({"energy_law": "one_strike"})), "target_height", "energy_law `one_strike` needs the height"),
        (json!({"preset": "case-4", "scene": {"table": {"energy_law": "one_strike"}}}), "energy_gain", "has no gain"),
        (
            steered(json!({"energy_law": "one_strike", "target_height": 0.3, "energy_measure": "vertical"})),
            "energy_measure",
            "total energy",
        ),
        (
            steered(json!({"energy_law": "one_strike", "target_height": 0.3, "strike": "still"})),
            "energy_law",
            "strike says `still`",
        ),
        (
            json!({"preset": "case-4", "scene": {"table": {"program": [0.2, 0.3]}}}),
            "program",
            "leave one of them out (null takes a preset's back)",
        ),
        (steered(json!({"program": []})), "program", program),
        (steered(json!({"program": vec![0.2; 17]})), "program", program),
        (steered(json!({"program": 0.2})), "program", program),
        (steered(json!({"program": [0.2, 200]})), "program", "at index 1 is 200; it must be from 0.001 to 100 m"),
        (steered(json!({"program": [0.2, "0.3"]})), "program", "at index 1 is \"0.3\"; it must be a number"),
        (steered(json!({"energy_measure": "both"})), "energy_measure", "\"vertical\" or \"total\""),
    ] {
        let answer = server.post("/v1/trajectories", &request).await.expect(422);
        assert_eq!(answer.pointers(), [format!("/scene/table/{pointer}")], "{request}");
        assert!(
            answer.text().contains(&serde_json::to_string(words).unwrap().trim_matches('"').to_owned()),
            "{request}: {}",
            answer.text()
        );
    }
}

#[tokio::test]
async fn a_program_is_asked_for_by_body_and_by_query() {
    let server = Server::start();
    let scene = json!({"table": {"energy_gain": null, "target_height": null, "energy_law": "one_strike", "program": [0.2, 0.3]}});
    let posted = server.post("/v1/trajectories", &json!({"preset": "case-4", "scene": scene})).await.expect(200);
    let query = "preset=case-4&scene.table.energy_gain=null&scene.table.target_height=null&scene.table.energy_law=one_strike\
                 &scene.table.program.0=0.2&scene.table.program.1=0.3";
    let asked = server.get(&format!("/v1/trajectories?{query}")).await.expect(200);
    assert_eq!(asked.raw, posted.raw);
    assert_eq!(asked.json()["scene"]["table"]["program"], json!([0.2, 0.3]));
    let holes = query.replace("program.1", "program.2");
    assert_eq!(server.get(&format!("/v1/trajectories?{holes}")).await.expect(422).pointers(), ["/scene/table/program"]);
}

#[tokio::test]
async fn scenes_without_the_fields_do_not_say_them() {
    let server = Server::start();
    for preset in ["case-1", "case-4", "case-5"] {
        let scene = server.get(&format!("/v1/scenes/{preset}")).await.expect(200).json()["scene"].clone();
        for field in ["energy_measure", "energy_law", "program"] {
            assert_eq!(scene["table"].get(field), None, "{preset}: {field}");
        }
    }
}

/// Every resource on juggling: it answers, or says why not.
#[tokio::test]
async fn juggling_in_every_resource() {
    let server = Server::start();
    let get = async |target: &str| server.get(&format!("/v1/{target}")).await;
    let run = get("trajectories?preset=juggling&bounces=3000").await.expect(200).json();
    assert_eq!(run["outcome"]["kind"], "completed");
    for (n, energy) in numbers(&run["impacts"]["energy"]).iter().enumerate().skip(1) {
        // Before contact n + 1 the body has the energy of strike n.
        let target = G * if n % 2 == 1 { 0.2 } else { 0.3 };
        assert!((energy / target - 1.0).abs() <= 4e-15, "contact {}: {energy}", n + 1);
    }
    assert!(numbers(&run["impacts"]["error_estimate"])[100] < 1e-9);
    let same = get("trajectories?preset=juggling&bounces=20&method=extended").await.expect(200).json();
    assert_eq!(same["outcome"]["bounces"], 20);
    let linear = get("trajectories?preset=juggling&method=linear").await.expect(422);
    assert!(linear.text().contains("steers the vertical energy or none"), "{}", linear.text());

    let stability = get("stability?preset=juggling").await.expect(200).json();
    assert_eq!(stability["verdict"]["text"], "elliptic, 2000 bounces survived");
    assert!(stability["notes"].to_string().contains("one cycle (2 strikes"), "{}", stability["notes"]);
    let cycle = stability["notes"]
        .as_array()
        .unwrap()
        .iter()
        .any(|note| note.as_str().unwrap().contains("small deviations stay small"));
    assert!(cycle, "{}", stability["notes"]);
    let orbit = get("periodic-orbits?preset=juggling").await.expect(200).json();
    assert_eq!((&orbit["period"], &orbit["stable"]), (&json!(2), &json!(true)), "{orbit}");
    assert_eq!(get("periodic-orbits?preset=juggling&period=3").await.expect(422).pointers(), ["/period"]);
    let symmetric = get("periodic-orbits?preset=juggling&family=symmetric&theta=0.1").await.expect(422);
    assert_eq!(symmetric.pointers(), ["/family"]);

    // The bounces that repeat begin with the one from the last height.
    let jacobian = get("jacobians?preset=juggling").await.expect(200).json();
    let fall = jacobian["at"]["state"]["y_dot"].as_f64().unwrap();
    assert!((fall + (2.0 * G * (0.3 - 0.4 / 3.0)).sqrt()).abs() < 1e-12, "{jacobian}");
    let map = "regions?preset=juggling&bounces=300&x.field=table.tilt_gain&x.from=1.02&x.to=1.8&x.count=6\
               &y.field=release.theta&y.from=0.01&y.to=0.3&y.count=5";
    follows_the_runs(&server, map, "juggling").await;
    for target in ["ensembles?preset=juggling&runs=4&bounces=50", "ladder?preset=juggling", "previews?preset=juggling"]
    {
        get(target).await.expect(200);
    }
    get("precision?preset=juggling&bounces=20").await.expect(200);
    let design = get("controllers?preset=juggling").await.expect(422);
    assert!(design.text().contains("no bounce repeats"), "{}", design.text());
    let basin = get("stability?preset=juggling&basin=true&bounces=500").await.expect(200).json();
    assert!(basin["basin"]["theta"].as_f64().unwrap() > 0.05, "{}", basin["basin"]);
}

/// The cells of a map are what runs of their scenes say.
async fn follows_the_runs(server: &Server, map: &str, preset: &str) {
    let region = server.get(&format!("/v1/{map}")).await.expect(200).json();
    let (x, y) = (numbers(&region["x"]), numbers(&region["y"]));
    for (row, theta) in y.iter().enumerate() {
        for (column, gain) in x.iter().enumerate() {
            let target = format!(
                "/v1/trajectories?preset={preset}&bounces=300&scene.table.tilt_gain={gain}&scene.release.theta={theta}"
            );
            let run = server.get(&target).await.expect(200).json();
            assert_eq!(region["values"][row][column].as_f64(), run["outcome"]["bounces"].as_f64(), "{target}");
        }
    }
}

#[tokio::test]
async fn the_total_energy_holds_and_the_swing_keeps_its_size() {
    let server = Server::start();
    let total = server.get("/v1/stability?preset=case-4-total&bounces=3000").await.expect(200).json();
    assert_eq!(total["verdict"]["text"], "elliptic, 3000 bounces survived");
    assert_eq!((&total["lyapunov"]["coefficient"], &total["lyapunov"]["kind"]), (&json!(0.0), &json!("neutral")));
    assert_eq!(total["boundary"]["kind"], "soft");
    let vertical = server.get("/v1/stability?preset=case-4&bounces=3000").await.expect(200).json();
    assert_eq!(vertical["lyapunov"]["kind"], "repelling");
    assert_eq!(vertical["linear"]["eigenvalues"], total["linear"]["eigenvalues"], "the first order is the same");
    let run = server.get("/v1/trajectories?preset=case-4-total&bounces=300").await.expect(200).json();
    let energy = numbers(&run["impacts"]["energy"]);
    let target = run["derived"]["target"]["energy"].as_f64().unwrap();
    assert!((energy[299] / target - 1.0).abs() <= 1e-12, "{}", energy[299]);
    let linear = server.get("/v1/trajectories?preset=case-4-total&method=linear").await.expect(422);
    assert!(linear.text().contains("vertical energy"), "{}", linear.text());
    let map = "regions?preset=case-4-total&bounces=300&x.field=table.tilt_gain&x.from=1.02&x.to=1.5&x.count=6\
               &y.field=release.theta&y.from=0.05&y.to=0.5&y.count=5";
    follows_the_runs(&server, map, "case-4-total").await;
    let one_strike = server
        .get("/v1/stability?preset=case-4-total&scene.table.energy_gain=null&scene.table.energy_law=one_strike")
        .await
        .expect(200)
        .json();
    let (found, eigenvalue) = (margin(&one_strike, "table.energy_gain"), &one_strike["linear"]["energy_eigenvalue"]);
    assert_eq!((&found, eigenvalue), (&Value::Null, &json!(0.0)), "{one_strike}");
}

/// The drift is a part of a total energy that is held: V² = 2G(y* − l) − c², in every resource.
#[tokio::test]
async fn a_drift_is_a_part_of_the_total_energy() {
    let server = Server::start();
    let get = async |target: &str| server.get(&format!("/v1/{target}")).await;
    let held = "preset=case-1&scene.release.theta=0&scene.table.target_height=0.2&scene.release.x_dot";
    let total = "scene.table.energy_gain=0.45&scene.table.energy_measure=total";
    let expected = (2.0 * G * (0.2 - 0.4 / 3.0) - 0.25_f64).sqrt();
    for law in [total, "scene.table.energy_law=one_strike"] {
        let scene = format!("{held}=0.5&{law}");
        let stability = get(&format!("stability?{scene}")).await.expect(200).json();
        let place = &stability["fixed_point"];
        assert!((place["y_dot"].as_f64().unwrap() + expected).abs() < 1e-12, "{place}");
        assert_eq!((&place["x_dot"], &stability["drift_speed"]), (&json!(0.5), &json!(0.5)));
        assert_eq!(
            (&stability["agree"], &stability["boundary"]["kind"]),
            (&json!(true), &json!("soft")),
            "{stability}"
        );
        let note = "has that of the drift of 0.5 m/s in it";
        assert!(stability["notes"].to_string().contains(note), "{}", stability["notes"]);
        for method in ["map", "extended"] {
            let run = get(&format!("trajectories?{scene}&bounces=300&method={method}")).await.expect(200).json();
            let last = run["impacts"]["y_dot"][299].clone();
            let last = last.as_f64().unwrap_or_else(|| last.as_str().unwrap().parse().unwrap());
            assert!((last + expected).abs() < 1e-12, "{law} {method}: {last}");
        }
        let jacobian = get(&format!("jacobians?{scene}")).await.expect(200).json();
        for component in ["theta", "x_dot", "y_dot", "theta_dot"] {
            assert_eq!(jacobian["at"]["state"][component], place[component], "{law} {component}");
        }
        let eigenvalue = stability["linear"]["energy_eigenvalue"].as_f64().unwrap();
        assert!((jacobian["determinant"].as_f64().unwrap() - eigenvalue).abs() < 1e-12, "{jacobian}");
        // Lanes.
        let map = format!(
            "regions?{scene}&quantity=residue&x.field=table.tilt_gain&x.from=1.02&x.to=1.4&x.count=2\
             &y.field=release.x_dot&y.from=0&y.to=0.5&y.count=2"
        );
        let region = get(&map).await.expect(200).json();
        let gain = region["x"][0].as_f64().unwrap();
        for (row, x_dot) in numbers(&region["y"]).into_iter().enumerate() {
            let of = format!("stability?{held}={x_dot}&{law}&scene.table.tilt_gain={gain}");
            let residue = get(&of).await.expect(200).json()["linear"]["residue"].as_f64().unwrap();
            assert!((region["values"][row][0].as_f64().unwrap() - residue).abs() < 1e-12, "{of}");
        }
        // Periodic orbits have no drift, and all of the energy.
        let orbit = get(&format!("periodic-orbits?{scene}")).await.expect(200).json();
        let whole = (2.0 * G * (0.2 - 0.4 / 3.0)).sqrt();
        assert!((orbit["states"]["y_dot"][0].as_f64().unwrap() + whole).abs() < 1e-12, "{orbit}");
        let fast = get(&format!("stability?{held}=1.5&{law}")).await.expect(200).json();
        assert!(
            fast["verdict"]["code"] == "unstable"
                && fast["verdict"]["reason"].to_string().contains("no bounce that repeats"),
            "{fast}"
        );
        let fast = get(&format!("jacobians?{held}=1.5&{law}")).await.expect(422);
        assert!(fast.text().contains("no bounce that repeats"), "{}", fast.text());
    }
    let law = "scene.table.energy_law=one_strike&scene.contact.restitution=0.8&scene.table.assumed_restitution=0.9";
    let design = get(&format!("controllers?{held}=0.5&{law}")).await.expect(200).json();
    assert!((design["energy_eigenvalue"].as_f64().unwrap() + 0.1 / 1.9).abs() < 1e-12, "{design}");
}

/// A run that begins to juggle under way: the heights take the place of the target height.
#[tokio::test]
async fn a_run_begins_to_juggle() {
    let server = Server::start();
    let juggle = json!({"table": {"energy_gain": 0, "energy_law": "one_strike", "program": [0.2, 0.3]}});
    let request = json!({"preset": "case-4", "bounces": 40, "interventions": [{"impact": 20, "set": juggle}]});
    let run = server.post("/v1/trajectories", &request).await.expect(200).json();
    let energy = numbers(&run["impacts"]["energy"]);
    let gravity = run["derived"]["gravity_in_plane"].as_f64().unwrap();
    // Strike 20 takes the second height of the cycle.
    for (n, height) in [(21, 0.3), (22, 0.2), (39, 0.3), (40, 0.2)] {
        let energy: f64 = energy[n - 1];
        assert!((energy / (gravity * height) - 1.0).abs() <= 1e-14, "contact {n}: {energy}");
    }
    let both = json!({"table": {"target_height": 0.3, "program": [0.2, 0.3]}});
    let request = json!({"preset": "case-4", "interventions": [{"impact": 20, "set": both}]});
    let refused = server.post("/v1/trajectories", &request).await.expect(422);
    assert!(refused.text().contains("say the same thing"), "{}", refused.text());
}
