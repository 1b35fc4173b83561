//! Live runs for programs that pass them on: dates and columns of impacts, and addresses that are not valid runs.

use std::collections::BTreeSet;
use std::time::Duration;

use crate::support::Server;
use crate::support::socket::{Row, SOON, impacts_in, no_run, now_ms, open, refused, start, start_with, try_open};
use clap::Parser;
use equipoise::compute::Peer;
use equipoise::config::Config;
use serde_json::json;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::time::timeout;

fn dates(rows: &[Row]) -> Vec<u64> {
    rows.iter().map(|row| row["time_ms"].as_u64().unwrap()).collect()
}

#[tokio::test]
async fn an_impact_has_the_date_of_its_trajectory_and_comes_then() {
    let (_, address) = start().await;
    let epoch = now_ms() - 20_000;
    let query = format!("preset=case-5&epoch_ms={epoch}");
    let run = Server::start().get(&format!("/v1/trajectories?{query}&bounces=60")).await.json();
    let mut client = open(address, &format!("/v1/live?{query}&from=1")).await;
    let rows = client.impacts(60).await;
    for (place, row) in rows.iter().enumerate() {
        assert_eq!(row["time_ms"], run["impacts"]["time_ms"][place], "impact {}", place + 1);
    }
    // None of them is sent before its time.
    assert!(dates(&rows).into_iter().all(|date| date <= now_ms()));
}

#[tokio::test]
async fn dates_have_speeds_pauses_and_steps_in_them_and_the_url_replays_them() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1&speed=2").await;
    let hello = client.next().await;
    let mut seen = client.impacts(3).await;
    let pause = client.ask(json!({"type": "pause"})).await;
    let step = client.ask(json!({"type": "step"})).await;
    let (epoch, stepped_to) = (hello["epoch_ms"].as_u64().unwrap(), step["impact"].as_u64().unwrap() as usize);
    seen.extend(client.impacts(stepped_to - 3).await);
    // The clock that was paused shows the run time of the step when the step is made.
    assert_eq!(seen[stepped_to - 1]["time_ms"], step["now_ms"]);
    assert!(step["now_ms"].as_u64() >= pause["now_ms"].as_u64());
    for row in &seen[..stepped_to - 1] {
        let expected = epoch as f64 + 500.0 * row["t"].as_f64().unwrap();
        assert!((row["time_ms"].as_f64().unwrap() - expected).abs() <= 0.5, "{row:?} {expected}");
    }
    let resume = client.ask(json!({"type": "resume"})).await;
    seen.extend(client.impacts(4).await);
    let (at, from) = (resume["now_ms"].as_f64().unwrap(), resume["run_time"].as_f64().unwrap());
    for row in &seen[stepped_to..] {
        let expected = at + 500.0 * (row["t"].as_f64().unwrap() - from);
        assert!((row["time_ms"].as_f64().unwrap() - expected).abs() <= 0.5, "{row:?} {expected}");
    }
    let mut replay = open(address, &format!("{}&from=1", resume["url"].as_str().unwrap())).await;
    assert_eq!(replay.impacts(seen.len()).await, seen);
}

#[tokio::test]
async fn a_single_impact_has_the_columns_of_many() {
    let (_, address) = start().await;
    let query = format!("/v1/live?preset=case-1&epoch_ms={}", now_ms() - 10_000);
    let mut single = None;
    let mut client = open(address, "/v1/live?preset=case-2&speed=1").await;
    while single.is_none() {
        let message = client.next().await;
        single = (message["type"] == "impact").then_some(message);
    }
    let single = single.unwrap();
    let mut many = open(address, &format!("{query}&from=1")).await;
    let columns = loop {
        let message = many.next().await;
        if message["type"] == "impacts" {
            break message["columns"].clone();
        }
    };
    let members = impacts_in(&single).remove(0);
    assert!(members.values().all(|value| !value.is_object() && !value.is_array()), "{single}");
    let columns: BTreeSet<_> = columns.as_object().unwrap().keys().collect();
    assert!(members.keys().eq(columns), "{members:?}");
}

#[tokio::test]
async fn an_address_that_is_no_run_is_told_over_the_websocket() {
    let (app, address) = start().await;
    let server = Server::start();
    // All places are taken: none is needed for a problem.
    let home = Peer::at([127, 0, 0, 1].into());
    let _all: Vec<_> = std::iter::from_fn(|| app.live_quota.try_reserve(home).ok()).collect();
    for query in [
        "preset=case-9",
        "preset=case-1&speed=0&columns=wide",
        "preset=case-1&scene.table.tilt_gain=5000&interventions.0.impact=0",
        "preset=case-1&preset=case-2",
        "preset=%ff",
        "",
    ] {
        let problem = no_run(address, &format!("/v1/live?{query}")).await;
        let mut plain = server.get(&format!("/v1/live?{query}")).await.json();
        for name in ["status", "title", "detail"] {
            assert_eq!(problem[name], plain[name], "{query}");
        }
        let errors = plain["errors"].take();
        assert_eq!(problem["errors"], if errors.is_null() { json!([]) } else { errors }, "{query}");
    }
    assert_eq!(app.metrics.live_sessions.get(), 0);
    // A valid run needs a place, and the status says so.
    assert_eq!(refused(address, "/v1/live?preset=case-1", &[]).await["status"], 503);
}

/// A client that never answers the close, and one that goes on sending.
#[tokio::test]
async fn a_connection_without_a_run_ends_by_itself() {
    let (_, address) = start().await;
    for sends in [false, true] {
        let (mut client, _) = try_open(address, "/v1/live?preset=case-9", &[]).await.unwrap();
        let socket = client.socket.get_mut();
        let ended = timeout(SOON, async {
            // A text frame `{}` with the masking key 0.
            while sends && socket.write_all(&[0x81, 0x82, 0, 0, 0, 0, b'{', b'}']).await.is_ok() {
                tokio::time::sleep(Duration::from_millis(20)).await;
            }
            // A reset is an end too: the server has not read all that was sent.
            let _ = socket.read_to_end(&mut vec![]).await;
        });
        ended.await.expect("the connection stays open");
    }
}

#[tokio::test]
async fn only_a_page_that_may_ask_is_told_what_is_wrong_with_its_address() {
    let allowed = Config::parse_from(["equipoise", "--allow-origin", "http://notebook.lab:*"]);
    let (_, address) = start_with(&allowed).await;
    let wrong = "/v1/live?preset=case-9";
    for origin in ["http://elsewhere.example", "http://notebook.lab.example:8888", "https://notebook.lab:8888"] {
        assert_eq!(refused(address, wrong, &[("origin", origin)]).await["status"], 403, "{origin}");
    }
    for origin in ["http://notebook.lab", "http://notebook.lab:8888", "http://notebook.lab:8889"] {
        let (mut client, _) = try_open(address, wrong, &[("origin", origin)]).await.unwrap();
        assert_eq!(client.next().await["status"], 422, "{origin}");
    }
}
