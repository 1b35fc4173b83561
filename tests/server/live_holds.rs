//! Live runs that go on in contact after their bounces, over real sockets.

use crate::support::Server;
use crate::support::socket::{Client, impacts_in, open, start};
use serde_json::{Value, json};

/// A table that stands still, and a contact that loses much: thirteen bounces in half a second.
const SETTLES: &str = "preset=still-lossy&scene.contact.restitution=0.1&scene.release.theta=0.1&scene.release.x_dot=0";

/// A run up to its end: numbers of its impacts, columns of its holds without the rows that stand in two messages, and the end.
async fn to_the_end(client: &mut Client) -> (Vec<u64>, Value, Value) {
    let (mut impacts, mut hold) = (vec![], json!({}));
    for row in client.impacts(0).await {
        impacts.push(row["n"].as_u64().unwrap());
    }
    loop {
        let message = client.next().await;
        match message["type"].as_str() {
            Some("hold") => extend(&mut hold, &message["columns"]),
            Some("end") => return (impacts, hold, message),
            _ => impacts.extend(impacts_in(&message).iter().map(|row| row["n"].as_u64().unwrap())),
        }
    }
}

/// Adds the columns of a message; its first row may be known.
fn extend(hold: &mut Value, columns: &Value) {
    let follows = hold["t"].as_array().is_some_and(|known| known.last() == columns["t"].as_array().unwrap().first());
    for (name, column) in columns.as_object().unwrap() {
        let fresh = &column.as_array().unwrap()[usize::from(follows)..];
        match hold[name].as_array_mut() {
            Some(known) => known.extend_from_slice(fresh),
            None => hold[name] = column.clone(),
        }
    }
}

/// The trajectory of a live run's URL: the same scene, interventions and hold.
async fn trajectory(url: &str) -> Value {
    let query = url.split_once('?').unwrap().1.split('&');
    let clock = |part: &&str| !["epoch_ms=", "speed=", "clock."].iter().any(|name| part.starts_with(name));
    let query: Vec<&str> = query.filter(clock).collect();
    Server::start().get(&format!("/v1/trajectories?{}&bounces=1000", query.join("&"))).await.json()
}

#[tokio::test]
async fn a_run_with_hold_goes_on_as_its_trajectory_does() {
    let (_, address) = start().await;
    for (hold, kind) in [(0.05, "completed"), (30.0, "toppled")] {
        let mut client = open(address, &format!("/v1/live?{SETTLES}&speed=20&hold={hold}")).await;
        let hello = client.next_of("hello").await;
        let url = hello["url"].as_str().unwrap();
        assert!(url.contains(&format!("&hold={hold:?}")), "{url}");
        let (impacts, told, end) = to_the_end(&mut client).await;
        let run = trajectory(url).await;
        assert_eq!((&told, &end["hold_end"]), (&run["hold"], &run["hold_end"]));
        assert_eq!((&end["outcome"], &end["demand"]), (&run["outcome"], &run["demand"]));
        assert_eq!((end["outcome"]["kind"].as_str(), end["hold_end"]["kind"].as_str()), (Some("settled"), Some(kind)));
        // The URL replays it; after the last impact it begins with the contact.
        let next = impacts.len() + 1;
        for (from, count) in [(1, impacts.len()), (next, 0), (next + 1, 0)] {
            let mut again = open(address, &format!("{url}&from={from}")).await;
            let (sent, told_again, end_again) = to_the_end(&mut again).await;
            assert_eq!((sent.len(), &end_again), (count, &end), "from {from}");
            assert_eq!(told_again, if from > next { json!({}) } else { told.clone() }, "from {from}");
        }
    }
}

#[tokio::test]
async fn a_run_without_hold_ends_with_its_bounces() {
    let (_, address) = start().await;
    for (query, kind) in [(SETTLES.to_owned(), "settled"), ("preset=case-3&hold=1".to_owned(), "sinking")] {
        let mut client = open(address, &format!("/v1/live?{query}&speed=20")).await;
        let hello = client.next_of("hello").await;
        assert_eq!(hello["url"].as_str().unwrap().contains("hold"), query.contains("hold"));
        let (impacts, hold, end) = to_the_end(&mut client).await;
        assert_eq!((hold, end.get("hold_end"), end["outcome"]["kind"].as_str()), (json!({}), None, Some(kind)));
        assert_eq!(end["outcome"]["bounces"], json!(impacts.len()));
    }
    let server = Server::start();
    for (hold, pointer) in [("61", "/hold"), ("-1", "/hold"), ("long", "/hold")] {
        let refused = server.get(&format!("/v1/live?{SETTLES}&hold={hold}")).await.expect(422);
        assert_eq!(refused.pointers(), [pointer]);
    }
}

/// A run of a body that is nearly upright, paused at a moment of its contact, in s after the last bounce. The contact has 2 s.
async fn paused_in_contact(since: f64) -> String {
    let scene = SETTLES.replace("theta=0.1", "theta=0.001");
    let run = Server::start().get(&format!("/v1/trajectories?{scene}&bounces=1000")).await.json();
    let t = run["outcome"]["settle_time"].as_f64().unwrap() + since;
    format!("/v1/live?{scene}&hold=2&epoch_ms=1000&clock.0.wall_ms=1000&clock.0.run={t}&clock.0.speed=0&from=1")
}

#[tokio::test]
async fn a_contact_is_paused_and_stepped_through() {
    let (_, address) = start().await;
    let mut client = open(address, &paused_in_contact(0.0).await).await;
    let mut end_of_part = client.next_of("hold").await["columns"]["t"].as_array().unwrap().last().cloned();
    for _ in 0..3 {
        let stepped = client.ask(json!({"type": "step"})).await;
        assert_eq!((&stepped["run_time"], &stepped["next_strike"]), (&end_of_part.unwrap(), &Value::Null));
        // A part is sent when it begins.
        let part = client.next_of("hold").await;
        assert_eq!(part["columns"]["t"][0], stepped["run_time"]);
        end_of_part = part["columns"]["t"].as_array().unwrap().last().cloned();
    }
    for (message, part) in [
        (json!({"type": "kick", "theta_dot": 0.1}), "the table holds the body"),
        (json!({"type": "catch"}), "the table holds the body already"),
    ] {
        client.send(message).await;
        let problem = client.next_of("problem").await;
        assert!(problem["detail"].as_str().unwrap().contains(part), "{problem}");
    }
    client.ask(json!({"type": "speed", "value": 20})).await;
    let resumed = client.ask(json!({"type": "resume"})).await;
    let mut again = open(address, &format!("{}&from=1", resumed["url"].as_str().unwrap())).await;
    let (_, hold, end) = to_the_end(&mut again).await;
    assert_eq!(to_the_end(&mut client).await.2, end);
    assert_eq!(hold["t"].as_array().unwrap().last(), Some(&end["hold_end"]["t"]));
}

#[tokio::test]
async fn a_body_in_contact_is_thrown_and_its_url_replays_it() {
    let (_, address) = start().await;
    let mut client = open(address, &paused_in_contact(0.2).await).await;
    client.next_of("hold").await;
    let thrown = client.ask(json!({"type": "throw", "apex": {"height": 0.3}})).await;
    client.ask(json!({"type": "speed", "value": 20})).await;
    let resumed = client.ask(json!({"type": "resume"})).await;
    let (impacts, _, end) = to_the_end(&mut client).await;
    assert!(end["outcome"]["bounces"].as_u64() > thrown["impact"].as_u64());
    let url = resumed["url"].as_str().unwrap();
    assert!(url.contains("throw.t=") && url.contains("&hold=2.0"), "{url}");
    let mut again = open(address, &format!("{url}&from=1")).await;
    let (all, _, end_again) = to_the_end(&mut again).await;
    assert_eq!((&end_again, all.last()), (&end, impacts.last()));
    let run = trajectory(url).await;
    assert_eq!((&run["outcome"], &run["hold_end"]), (&end["outcome"], &end["hold_end"]));
    assert_eq!(run["impacts"]["n"].as_array().unwrap().len(), all.len());
}
