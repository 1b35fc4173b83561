//! Runs whose bounces end: the body still turns, and `hold` follows it in contact.

use serde_json::{Value, json};

use crate::support::Server;

/// A table that stands still, and a contact that loses much.
const SETTLES: &str =
    "preset=still-lossy&impacts=1000&scene.contact.restitution=0.1&scene.release.theta=0.1&scene.release.x_dot=0";

fn numbers(column: &Value) -> Vec<f64> {
    column.as_array().expect("a column").iter().map(|it| it.as_f64().expect("a number")).collect()
}

#[tokio::test]
async fn a_settled_run_tells_that_the_body_still_turns() {
    let server = Server::start();
    let run = server.get(&format!("/v1/trajectories?{SETTLES}")).await.json();
    let outcome = &run["outcome"];
    assert_eq!(outcome["kind"], "settled");
    let theta_dot = outcome["theta_dot"].as_f64().unwrap();
    // It was nearly as fast before the last strike, which was weak.
    let before = *numbers(&run["impacts"]["theta_dot"]).last().unwrap();
    assert!(theta_dot > 1.0 && (theta_dot - before).abs() < 1e-6, "{outcome} {before}");
    let detail = outcome["detail"].as_str().unwrap();
    assert!(detail.ends_with(&format!("while the body still turns at {theta_dot} rad/s")), "{detail}");
    // Without `hold` there is nothing of the contact, and other endings have no such number.
    assert!(run.get("hold").is_none() && run.get("hold_end").is_none());
    let other = server.get("/v1/trajectories?preset=case-1&impacts=3").await.json();
    assert!(other["outcome"].get("theta_dot").is_none());
}

#[tokio::test]
async fn hold_goes_on_where_the_bounces_end() {
    let server = Server::start();
    let run = server.get(&format!("/v1/trajectories?{SETTLES}&hold=0.05")).await.json();
    let (hold, end, outcome) = (&run["hold"], &run["hold_end"], &run["outcome"]);
    let [t, theta, theta_dot, alpha] = ["t", "theta", "theta_dot", "alpha"].map(|name| numbers(&hold[name]));
    assert_eq!((Some(t[0]), Some(theta_dot[0])), (outcome["settle_time"].as_f64(), outcome["theta_dot"].as_f64()));
    // The law of the scene: α = κθ.
    let gain = run["scene"]["table"]["tilt_gain"].as_f64().unwrap();
    assert!(alpha.iter().zip(&theta).all(|(alpha, theta)| *alpha == gain * theta));
    assert!(numbers(&hold["normal_force"]).iter().all(|force| *force > 0.0));
    assert_eq!((end["contact"].as_str(), end["t"].as_f64()), (Some("frictionless"), t.last().copied()));
    assert_eq!(end["kind"], "completed", "{end}");
    assert!(end["error_bound"].as_f64().unwrap() < 1e-6);
    // The other formats have the impacts, and NDJSON the end.
    let lines = server.get(&format!("/v1/trajectories?{SETTLES}&hold=0.05&format=ndjson")).await.expect(200);
    let last: Value = serde_json::from_str(lines.text().lines().last().unwrap()).unwrap();
    assert_eq!(&last["end"]["hold_end"], end);
}

#[tokio::test]
async fn hold_says_why_there_is_none() {
    let server = Server::start();
    let run = server.get("/v1/trajectories?preset=case-1&impacts=3&hold=1").await.json();
    assert!(run.get("hold").is_none());
    let notes = run["notes"].as_array().unwrap();
    assert!(notes.iter().any(|note| note.as_str().unwrap().contains("`completed`, not as `settled`")), "{notes:?}");
    let long = server.get("/v1/trajectories?preset=case-1&hold=61").await;
    assert_eq!((long.status.as_u16(), &long.json()["errors"][0]["pointer"]), (422, &json!("/hold")));
}

/// Friction holds a contact on a still table; tilting it about the contact does not balance the body.
#[tokio::test]
async fn a_contact_with_friction_slides_sticks_and_falls() {
    let server = Server::start();
    let stops = "scene.body.contact_distance=0.5388&scene.body.radius_of_gyration=0.1672&scene.release.height=0.56\
                 &scene.release.theta=0.28&scene.release.theta_dot=0.88&scene.release.x_dot=0.17&scene.contact.friction=0.91\
                 &scene.contact.restitution=0&scene.table.tilt_gain=0.3&scene.table.strike=still";
    let run = server.get(&format!("/v1/trajectories?{stops}&hold=5")).await.json();
    assert_eq!(run["outcome"]["kind"], "settled");
    let end = &run["hold_end"];
    assert_eq!((end["contact"].as_str(), end["kind"].as_str()), (Some("coulomb"), Some("toppled")), "{end}");
}
