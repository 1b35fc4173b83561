//! Live runs of random scenes: the same impacts and ending as the trajectory, or the same refusal.

use std::net::SocketAddr;

use proptest::prelude::*;
use serde_json::{Value, json};
use tokio::runtime::Runtime;

use super::made::query;
use super::support::Server;
use super::support::socket::{impacts_in, now_ms, open, start};
use super::{hold_each, resource};

/// Speed of the runs.
const SPEED: f64 = 20.0;

#[test]
fn live_runs_of_random_scenes() {
    let (runtime, server) = (Runtime::new().expect("a runtime"), Server::start());
    let (_app, address) = runtime.block_on(start());
    let resource = resource("/v1/live", |_| 0);
    hold_each(
        &resource,
        (1..15_u64).prop_map(|impacts| json!({"bounces": impacts, "method": "map"})),
        60,
        &runtime,
        |request, _| runtime.block_on(watched(&server, address, request)),
    );
}

/// Watches a run. Returns true if there was one.
async fn watched(server: &Server, address: SocketAddr, request: &Value) -> bool {
    let impacts = request["bounces"].as_u64().expect("a number");
    let mut scene = request.clone();
    scene.as_object_mut().expect("an object").retain(|name, _| ["preset", "scene"].contains(&name.as_str()));
    let told = server.post("/v1/trajectories", request).await;
    let trajectory = told.json();
    // Released so long ago that the last impact is due.
    let t = trajectory["outcome"]["t"].as_f64().unwrap_or_default();
    let epoch = now_ms() as f64 - 1000.0 * (t / SPEED).ceil();
    if epoch < 0.0 {
        return false;
    }
    let url = format!("/v1/live?{}&speed={SPEED}&epoch_ms={epoch}&from=1", query(&scene));
    let mut client = open(address, &url).await;
    let first = client.next().await;
    if first["type"] == "problem" && told.status == 422 {
        assert_eq!((&first["status"], &first["errors"]), (&json!(422), &trajectory["errors"]), "{url}");
        return false;
    }
    assert_eq!(told.status, 200, "{url}");
    // The rest of the run may be too expensive.
    if first["type"] == "problem" {
        assert!(first["detail"].as_str().is_some_and(|it| it.contains("catching up")), "{first} to {url}");
        return false;
    }
    let ends = trajectory["outcome"]["kind"] != "completed";
    let mut rows = Vec::new();
    let end = loop {
        if !ends && rows.len() as u64 >= impacts {
            rows.truncate(impacts as usize);
            break None;
        }
        let message = client.next().await;
        if message["type"] == "end" {
            break Some(message);
        }
        rows.extend(impacts_in(&message));
    };
    let columns = trajectory["impacts"].as_object().expect("columns");
    let listed = columns["n"].as_array().expect("a column").len();
    assert_eq!(rows.len(), listed, "{url}");
    for (place, row) in rows.iter().enumerate() {
        for name in
            ["n", "t", "x", "theta", "x_dot", "y_dot", "theta_dot", "alpha", "energy", "contact_velocity", "clearance"]
        {
            assert_eq!(row[name], columns[name][place], "{name} of impact {} in {url}", place + 1);
        }
    }
    if let Some(end) = end {
        assert_eq!(end["outcome"], trajectory["outcome"], "{url}");
        assert_eq!(end["demand"], trajectory["demand"], "{url}");
    }
    true
}
