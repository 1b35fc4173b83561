//! Tables beyond the ideal one, in every resource that takes a scene: constant and random errors, ends, delays, and laws that steer the energy.

use serde_json::{Value, json};

use crate::failures::{case, says};
use crate::support::socket::{open, start};
use crate::support::{Server, number, numbers};
use crate::verdict::margin;

const BIASED: &str = "preset=case-1&scene.release.theta=0.05&scene.table.errors.angle_bias=0.002";

async fn ask(target: &str) -> Value {
    Server::start().get(target).await.expect(200).json()
}

#[tokio::test]
async fn a_bias_leaves_no_bounce_in_place_and_the_verdict_says_how_it_drifts() {
    let answer = ask(&format!("/v1/stability?{BIASED}&scene.table.length=0.5")).await;
    assert_eq!((&answer["verdict"]["text"], &answer["fixed_point"]), (&json!("unstable"), &Value::Null), "{answer}");
    let drift = &answer["steady_drift"];
    // c = κb, θ* = −c/(κ − 1), −G tan θ* to second order in θ*.
    let lean = -1.1 * 0.002 / (1.1 - 1.0);
    assert!((number(&drift["theta"]) - lean).abs() < 1e-12);
    let acceleration = number(&drift["acceleration"]);
    assert!((acceleration / (-9.81 * lean.tan()) - 1.0).abs() < 4.0 * lean * lean, "{drift}");
    assert!((number(&drift["time_on_table"]) - (0.5 / acceleration).sqrt()).abs() < 1e-12);
    assert_eq!(answer["nonlinear"]["outcome"]["kind"], "off_table");
    assert!(answer["verdict"]["reason"].as_str().unwrap().contains("square to the body"), "{answer}");
    assert_eq!(answer["model"]["name"], "rig_errors");
}

#[tokio::test]
async fn an_error_of_a_gain_is_judged_in_terms_of_the_gain_as_it_is_set() {
    let ideal = ask("/v1/stability?preset=case-1").await;
    let wrong = ask("/v1/stability?preset=case-1&scene.table.errors.tilt_gain=0.1").await;
    let gain = |answer: &Value| margin(answer, "table.tilt_gain");
    assert_eq!(gain(&wrong)["value"], 1.1);
    for side in ["below", "above"] {
        let limit = |answer: &Value| number(&gain(answer)[side]["limit"]);
        assert!((limit(&wrong) - limit(&ideal) / 1.1).abs() < 1e-12);
    }
    assert!(wrong["notes"].to_string().contains("1.1 times its law"), "{wrong}");
    let margins =
        ask("/v1/stability?preset=case-1&scene.table.errors.tilt_gain=0.1&tolerances.0.field=body.contact_distance&tolerances.0.tolerance=0.001").await;
    let most = number(&gain(&margins)["above"]["most"]);
    assert!((1.1 + most - 1.5 / 1.1).abs() < 0.02, "{margins}");
}

#[tokio::test]
async fn feedback_of_the_place_moves_the_bounce() {
    let scene = "preset=case-1&scene.table.tilt_gain=null&scene.table.feedback.x=0.2&scene.table.feedback.theta=-1.9\
                 &scene.table.feedback.x_dot=0.15&scene.table.feedback.theta_dot=-0.1&scene.release.theta=0.05";
    let answer = ask(&format!("/v1/stability?{scene}&scene.table.errors.tilt_offset=0.002")).await;
    assert!((number(&answer["fixed_point"]["x"]) - 0.002 / 0.2).abs() < 1e-15, "{answer}");
    assert!(answer.get("steady_drift").is_none());
    let ideal = ask(&format!("/v1/stability?{scene}")).await;
    // The offset and the place cancel in the tilt but for rounding.
    let eigenvalues = |of: &Value| of["linear"]["eigenvalues"].as_array().unwrap().clone();
    for (one, other) in eigenvalues(&answer).iter().zip(&eigenvalues(&ideal)) {
        for part in ["re", "im"] {
            assert!((number(&one[part]) - number(&other[part])).abs() < 1e-13, "{one} {other}");
        }
    }
    assert_eq!(answer["linear"]["class"], ideal["linear"]["class"]);
    assert_eq!(eigenvalues(&answer).len(), eigenvalues(&ideal).len());
}

#[tokio::test]
async fn tables_end_runs_of_every_kind() {
    let server = Server::start();
    let ended = format!("{BIASED}&scene.table.length=0.2");
    let run = server.get(&format!("/v1/trajectories?{ended}&bounces=100")).await.expect(200).json();
    assert_eq!((&run["outcome"]["kind"], &run["outcome"]["quantity"]), (&json!("off_table"), &json!("place")));
    assert_eq!((&run["outcome"]["limit"], &run["outcome"]["unit"]), (&json!(0.1), &json!("m")));
    let noisy = format!("/v1/ensembles?{ended}&runs=4&bounces=100&scene.noise.timing_sd=1e-6");
    assert_eq!(server.get(&noisy).await.expect(200).json()["counts"]["off_table"], 4);
    let map =
        "x.field=release.theta&x.from=0.01&x.to=0.02&x.count=3&y.field=release.x_dot&y.from=0&y.to=0.01&y.count=2";
    let cells = server.get(&format!("/v1/regions?{ended}&bounces=200&{map}")).await.expect(200).json();
    assert_eq!(cells["counts"]["off_table"], 6, "{cells}");
    let ladder = server.get(&format!("/v1/ladder?{ended}&bounces=100")).await.expect(200).json();
    let rungs = ladder["rungs"].as_array().unwrap();
    assert_eq!(rungs.last().unwrap()["name"], "rig_errors", "{ladder}");
    let caught = server.get("/v1/catches?preset=case-1&scene.table.length=1").await.expect(200).json();
    assert_eq!(caught["outcome"]["kind"], "held", "{caught}");
    server.get(&format!("/v1/throws?{ended}&impact=1&apex.height=0.3")).await.expect(200);
    // Feedback of x takes a constant tilt back.
    let law = server.get(&format!("/v1/controllers?{BIASED}")).await.expect(200).json();
    assert!(number(&law["scene"]["table"]["feedback"]["x"]) != 0.0, "{law}");
    let orbit = server.get(&format!("/v1/periodic-orbits?{BIASED}")).await.expect(200);
    assert!(orbit.text().contains("beside the upright bounce each one changes"), "{}", orbit.text());
}

const TURNING: &str = "preset=case-1&scene.release.theta=0.05&scene.table.tilt_rate=follows&scene.table.pivot.x=0";

#[tokio::test]
async fn tables_that_turn_do_so_in_every_run() {
    let server = Server::start();
    let get = async |target: &str| server.get(target).await.expect(200).json();
    let run = get(&format!("/v1/trajectories?{TURNING}&bounces=30")).await;
    assert_eq!(run["model"]["name"], "turning_table");
    let small = "preset=case-1&scene.release.theta=0.05";
    let ideal = get(&format!("/v1/trajectories?{small}&bounces=30")).await;
    let last = |answer: &Value| number(&answer["impacts"]["y_dot"].as_array().unwrap()[20]);
    assert!((last(&run) - last(&ideal)).abs() > 0.01, "{run}");
    assert!(number(&run["impacts"]["error_estimate"][20]) < 1e-10);
    // The turning is taken off, or the pivot is under the contact.
    for scene in ["tilt_rate=corrected&scene.table.pivot.x=0", "tilt_rate=follows&scene.table.pivot.depth=0.1"] {
        let same = get(&format!("/v1/trajectories?{small}&scene.table.{scene}&bounces=30")).await;
        for column in ["t", "x", "theta", "x_dot", "y_dot", "theta_dot"] {
            assert_eq!(same["impacts"][column], ideal["impacts"][column], "{column}");
        }
        let verdict = get(&format!("/v1/stability?{small}&scene.table.{scene}")).await;
        assert_eq!(verdict["linear"], get(&format!("/v1/stability?{small}")).await["linear"]);
    }
    let map = "x.field=table.pivot.x&x.from=0&x.to=0.2&x.count=3&y.field=table.pivot.depth&y.from=0&y.to=0.1&y.count=2";
    let cells = get(&format!("/v1/regions?{TURNING}&bounces=200&{map}")).await;
    assert_eq!(cells["counts"]["completed"], 0, "{cells}");
    let jacobian = get(&format!("/v1/jacobians?{TURNING}&at.impact=2")).await;
    assert_eq!(jacobian["state_order"].as_array().unwrap().len(), 5);
    let noisy = format!("/v1/ensembles?{TURNING}&runs=4&bounces=100&scene.noise.timing_sd=1e-4");
    assert_eq!(get(&noisy).await["counts"]["completed"], 4);
    for resource in ["catches", "controllers", "throws"] {
        let rest = if resource == "throws" { "&impact=1&apex.height=0.3" } else { "" };
        get(&format!("/v1/{resource}?{TURNING}{rest}")).await;
    }
    let orbit = get(&format!("/v1/periodic-orbits?{TURNING}")).await;
    assert!(number(&orbit["residual"]) < 1e-12 && orbit["states"]["x"][0] == json!(0.0), "{orbit}");
    let settled = "preset=case-1&scene.contact.restitution=0.5&scene.table.strike=still&scene.release.theta=0.1&scene.table.tilt_rate=follows";
    let held = get(&format!("/v1/trajectories?{settled}&scene.table.pivot.x=0&bounces=400&hold=0.1")).await;
    assert!(held["notes"].to_string().contains("hold is absent"), "{held}");
}

#[tokio::test]
async fn a_live_run_ends_where_its_table_does() {
    let (_, address) = start().await;
    let scene = format!("{BIASED}&scene.table.length=0.2");
    let mut client = open(address, &format!("/v1/live?{scene}&epoch_ms=1000&from=1")).await;
    let end = client.next_of("end").await;
    let run = ask(&format!("/v1/trajectories?{scene}&bounces=100")).await;
    assert_eq!(run["outcome"]["kind"], "off_table");
    for name in ["kind", "bounces", "t", "limit", "value"] {
        assert_eq!(end["outcome"][name], run["outcome"][name], "{name} of {end}");
    }
    assert_eq!(client.rows.len() as u64, run["outcome"]["bounces"].as_u64().unwrap());
}

#[tokio::test]
async fn the_verdict_on_a_turning_table_is_not_that_of_the_linear_analysis() {
    let scene = format!("{TURNING}&scene.table.pivot.depth=0.05");
    let answer = ask(&format!("/v1/stability?{scene}&bounces=1000&basin=true&tolerances.0.field=body.contact_distance&tolerances.0.tolerance=0.001")).await;
    let bounces = number(&answer["nonlinear"]["outcome"]["bounces"]);
    assert_eq!(
        (&answer["verdict"]["text"], &answer["verdict"]["decided_by"]),
        (&json!("unstable"), &json!("lyapunov")),
        "{answer}"
    );
    assert!((number(&answer["swing_pump"]["critical_bounces"]) / bounces - 1.0).abs() < 0.3, "{answer}");
    let ideal = ask("/v1/stability?preset=case-1&scene.release.theta=0.05").await;
    // The pivot is aside, so its own strikes move the end a little.
    let critical = |answer: &Value| number(&crate::verdict::critical(answer));
    assert!((critical(&answer) - critical(&ideal)).abs() < 0.01, "{answer}");
    assert!(answer["boundary"].is_null() && answer["lyapunov"].is_null());
    assert!(number(&answer["basin"]["theta"]) > 0.0, "{answer}");
    assert_eq!((&answer["over_tolerances"]["holds"], &answer["loss_of_stability"]), (&json!(false), &json!([])));
    // Without a closed form the return map decides.
    let fed = ask(&format!("/v1/stability?{scene}&scene.table.energy_gain=0.2&scene.table.target_height=0.2")).await;
    assert!(
        fed["verdict"]["code"] == "weakly_attracting"
            && fed["verdict"]["reason"].as_str().unwrap().contains("third order"),
        "{fed}"
    );
    let matched = "scene.contact.friction=0.5&scene.table.slide=matched&scene.table.tilt_rate=follows";
    let damped =
        ask(&format!("/v1/stability?preset=case-1&{matched}&scene.table.pivot.depth=0.05&scene.release.theta=0.03"))
            .await;
    assert_eq!(damped["verdict"]["text"], "stable, drifting", "{damped}");
    let picture = Server::start().get(&format!("/v1/stability?{scene}&format=svg")).await;
    picture.expect(200);
    let refused = Server::start().get(&format!("/v1/regions?{TURNING}&quantity=residue&x.field=table.tilt_gain&x.from=1&x.to=1.4&x.count=3&y.field=release.theta&y.from=0&y.to=0.1&y.count=2")).await;
    assert!(refused.expect(422).text().contains("table.tilt_rate"));
}

#[tokio::test]
async fn the_angle_of_the_velocity_of_a_point_mass_is_sensed_wrong() {
    let biased = ask("/v1/stability?preset=point-mass&scene.table.errors.angle_bias=0.01").await;
    assert_eq!(biased["verdict"]["code"], "stable_drifting", "{biased}");
    // The table is level at φ = −b, so the body goes on at the speed V tan b.
    let speed = (2.0 * 9.81 * 0.2_f64).sqrt();
    let drift = number(&biased["fixed_point"]["x_dot"]) / speed;
    assert!((drift + 0.01_f64.tan()).abs() < 1e-3, "{}", biased["fixed_point"]);
}

#[tokio::test]
async fn the_gallery_has_a_rig_that_the_ideal_analysis_calls_stable() {
    let case = case("biased-angle").await;
    assert_eq!(says(&case, "residue")["right"], false);
    assert_eq!(says(&case, "lean")["right"], true);
    let detail = case["truth"]["detail"].as_str().unwrap();
    assert!(detail.contains("off_table"), "{detail}");
    // The time on the table of a body at its lean is near that of the run.
    let run = ask(
        "/v1/trajectories?preset=case-1&scene.release.theta=0&scene.table.errors.angle_bias=0.002&scene.table.length=1&bounces=100",
    );
    let end = number(&run.await["outcome"]["t"]);
    let lean = -0.022_f64;
    assert!((end / (1.0 / (9.81 * -lean.tan())).sqrt() - 1.0).abs() < 0.3, "{end}");
}

#[tokio::test]
async fn the_gallery_has_a_turning_table_that_the_analysis_of_a_still_one_calls_stable() {
    let case = case("turning-table").await;
    assert_eq!(says(&case, "residue")["right"], false);
    assert_eq!(says(&case, "energy of the swing")["right"], true);
    let detail = case["truth"]["detail"].as_str().unwrap();
    assert!(detail.contains("it has 2000 contacts"), "{detail}");
}

// The laws by which a table steers the energy: errors that say why, and every resource on the presets that have them.

const G: f64 = 9.81;

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

// Random errors of the sensed place and velocities, scatter of restitution, and a delay between sensing and strike, in every resource that
// takes a scene.

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
