//! Runs whose bounces end: the body still turns, and `hold` follows it in contact.

use serde_json::{Value, json};

use crate::support::{Server, numbers};

/// A table that stands still, and a contact that loses much.
const SETTLES: &str =
    "preset=still-lossy&bounces=1000&scene.contact.restitution=0.1&scene.release.theta=0.1&scene.release.x_dot=0";

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
    let other = server.get("/v1/trajectories?preset=case-1&bounces=3").await.json();
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
    let lines = server.get(&format!("/v1/trajectories?{SETTLES}&hold=0.05&format=ndjson")).await.expect(200);
    let last: Value = serde_json::from_str(lines.text().lines().last().unwrap()).unwrap();
    assert_eq!(&last["end"]["hold_end"], end);
}

/// Rows of NDJSON or CSV against the columns of JSON: those of a phase have its numbers, and nothing where it has no such column.
fn assert_rows(rows: &[Value], phase: &str, columns: &Value) {
    let names: Vec<&String> = rows[0].as_object().unwrap().keys().collect();
    let columns = columns.as_object().unwrap();
    assert!(columns.keys().all(|name| names.contains(&name)), "{names:?}");
    let of_phase: Vec<&Value> = rows.iter().filter(|row| row["phase"] == phase).collect();
    assert_eq!(of_phase.len(), columns["t"].as_array().unwrap().len());
    for (n, row) in of_phase.into_iter().enumerate() {
        for name in names.iter().filter(|name| !["phase", "time_ms"].contains(&name.as_str())) {
            assert_eq!(&row[name.as_str()], columns.get(*name).map_or(&Value::Null, |column| &column[n]), "{name} {n}");
        }
    }
}

#[tokio::test]
async fn tables_have_the_impacts_and_then_the_contact() {
    let server = Server::start();
    for method in ["map", "extended"] {
        let run = format!("/v1/trajectories?{SETTLES}&hold=0.05&epoch_ms=1763675170123&method={method}");
        let json = server.get(&run).await.json();
        let text = server.get(&format!("{run}&format=ndjson")).await;
        let rows: Vec<Value> =
            text.expect(200).text().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let rows = &rows[..rows.len() - 1];
        assert_rows(rows, "impact", &json["impacts"]);
        let mut hold = json["hold"].clone();
        if method == "extended" {
            // The numbers of a column have one form: here text with 32 digits.
            for name in ["t", "x", "theta", "x_dot", "theta_dot", "alpha"] {
                let number = |row: &Value| row[name].as_str().unwrap().parse::<f64>().unwrap();
                let told: Vec<f64> = rows.iter().filter(|row| row["phase"] == "hold").map(number).collect();
                assert_eq!(told, numbers(&hold[name]));
                let texts = rows.iter().filter(|row| row["phase"] == "hold").map(|row| row[name].clone());
                hold[name] = texts.collect();
            }
        }
        assert_rows(rows, "hold", &hold);
        // The contact has dates as the impacts have.
        let since = |row: &Value| row["time_ms"].as_f64().unwrap() - 1_763_675_170_123.0;
        let t = |row: &Value| row["t"].as_f64().unwrap_or_else(|| row["t"].as_str().unwrap().parse().unwrap());
        assert!(rows.iter().all(|row| (since(row) - 1e3 * t(row)).abs() <= 0.5));
        // CSV has the same rows.
        let csv = server.get(&format!("{run}&format=csv")).await.expect(200);
        let mut lines = csv.text().split_terminator("\r\n");
        let header: Vec<&str> = lines.next().unwrap().split(',').collect();
        assert_eq!((header[0], header[1], header[2]), ("phase", "n", "time_ms"));
        let names = rows[0].as_object().unwrap();
        assert_eq!(header.len(), names.len());
        // A unit may follow the name: `theta_dot_rad_per_s` is `theta_dot`, not `theta`.
        let is_of = |header: &str, name: &str| header == name || header.starts_with(&format!("{name}_"));
        let longest = |header: &&str| names.keys().filter(|name| is_of(header, name)).max_by_key(|name| name.len());
        let order: Vec<&String> = header.iter().filter_map(longest).collect();
        assert_eq!(order.len(), names.len());
        for (line, row) in lines.zip(rows) {
            for (cell, name) in line.split(',').zip(&order) {
                let value = &row[name.as_str()];
                let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                assert_eq!(cell, if value.is_null() { "" } else { &text }, "{name}");
            }
        }
    }
}

#[tokio::test]
async fn a_table_has_the_columns_of_its_request_whatever_the_outcome() {
    let server = Server::start();
    let header = async |query: &str| {
        let csv = server.get(&format!("/v1/trajectories?{query}&format=csv")).await.expect(200);
        let text = csv.text();
        (text.lines().next().unwrap().to_owned(), text.lines().count())
    };
    let (settled, _) = header(&format!("{SETTLES}&hold=0.05")).await;
    let (other, rows) = header("preset=case-1&bounces=3&hold=0.05").await;
    assert_eq!((settled, rows), (other, 4));
    let (without, _) = header("preset=case-1&bounces=3").await;
    assert!(without.starts_with("n,t_s,x_m,") && without.ends_with(",error_estimate_m_per_s"), "{without}");
}

#[tokio::test]
async fn hold_says_why_there_is_none() {
    let server = Server::start();
    let run = server.get("/v1/trajectories?preset=case-1&bounces=3&hold=1").await.json();
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
