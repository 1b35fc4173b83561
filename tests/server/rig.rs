//! Rigs with constant errors and tables with ends, in every resource that takes a scene.

use crate::failures::{case, number, says};
use crate::margins::margin;
use crate::support::Server;
use crate::support::socket::{open, start};
use serde_json::{Value, json};

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
    let refused = server.get(&format!("/v1/periodic-orbits?{BIASED}")).await.expect(422);
    assert!(refused.text().contains("beside the upright bounce each one changes"), "{}", refused.text());
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
    let critical = |answer: &Value| number(&crate::margins::critical(answer));
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
