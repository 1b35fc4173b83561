//! Live runs that are caught, held and thrown, over real sockets.

use crate::support::Server;
use crate::support::socket::{Client, Row, impacts_in, open, start};
use serde_json::{Value, json};

/// A run up to its end: impacts, times of its holds, and the message of the end.
async fn to_the_end(client: &mut Client) -> (Vec<Row>, Vec<f64>, Value) {
    let (mut rows, mut held) = (client.impacts(0).await, Vec::<f64>::new());
    loop {
        let message = client.next().await;
        match message["type"].as_str() {
            Some("hold") => {
                let times = message["columns"]["t"].as_array().unwrap();
                let times: Vec<f64> = times.iter().map(|t| t.as_f64().unwrap()).collect();
                let follows = held.last() == times.first();
                held.extend(&times[usize::from(follows)..]);
            }
            Some("end") => return (rows, held, message),
            _ => rows.extend(impacts_in(&message)),
        }
    }
}

#[tokio::test]
async fn a_run_is_caught_and_its_url_replays_it() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1&speed=20").await;
    client.impacts(3).await;
    let ack = client.ask(json!({"type": "catch", "strategy": "bounce_down", "hold": 2})).await;
    let from = ack["impact"].as_u64().unwrap();
    assert!(from > 3);
    let (_, held, end) = to_the_end(&mut client).await;
    assert_eq!(end["outcome"]["kind"], "held");
    assert!((held.last().unwrap() - held[0] - 2.0).abs() < 1e-9 && held.is_sorted(), "{held:?}");
    assert!(end["demand"]["speed"].as_f64().unwrap() > 0.1);
    let url = ack["url"].as_str().unwrap();
    let mut again = open(address, &format!("{url}&from=1")).await;
    let (rows, held_again, end_again) = to_the_end(&mut again).await;
    assert_eq!((&held_again, &end_again), (&held, &end));
    assert!(rows.len() as u64 > from && rows.last().unwrap()["flight_time"].is_null());
    // The trajectory with the same interventions is the same run.
    let query = url.split_once('?').unwrap().1.split('&');
    let query: Vec<&str> = query.filter(|part| !part.starts_with("epoch_ms=") && !part.starts_with("speed=")).collect();
    let run = Server::start().get(&format!("/v1/trajectories?{}&bounces=1000", query.join("&"))).await.json();
    assert_eq!(run["outcome"], end["outcome"]);
    assert_eq!(run["impacts"]["n"].as_array().unwrap().len(), rows.len());
    for (place, row) in rows.iter().enumerate() {
        for column in ["t", "theta", "alpha", "impulse_normal", "table_velocity_y", "flight_time", "energy"] {
            assert_eq!(run["impacts"][column][place], row[column], "{column} of impact {}", place + 1);
        }
    }
}

#[tokio::test]
async fn a_body_that_is_held_is_thrown_and_caught_again() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1&speed=2").await;
    client.ask(json!({"type": "catch", "strategy": "brake", "hold": 30})).await;
    client.next_of("hold").await;
    for (message, part) in [
        (json!({"type": "catch"}), "holds the body already"),
        (json!({"type": "kick", "theta_dot": 0.1}), "holds the body"),
        (json!({"type": "throw", "apex": {"height": 0.01}}), "is not above"),
    ] {
        client.send(message).await;
        let problem = client.next_of("problem").await;
        assert!(problem["detail"].as_str().unwrap().contains(part), "{problem}");
    }
    client.ask(json!({"type": "speed", "value": 20})).await;
    let thrown = client.ask(json!({"type": "throw", "apex": {"height": 0.3}})).await;
    let impact = loop {
        let row = client.impacts(1).await.remove(0);
        if row["n"] == thrown["impact"] {
            break row;
        }
    };
    assert!(impact["flight_time"].as_f64().unwrap() > 0.3, "{impact:?}");
    client.impacts(2).await;
    let url = client.ask(json!({"type": "catch", "strategy": "bounce_down", "hold": 1})).await["url"].clone();
    let (_, _, end) = to_the_end(&mut client).await;
    assert_eq!(end["outcome"]["kind"], "held");
    let (_, _, end_again) = to_the_end(&mut open(address, &format!("{}&from=1", url.as_str().unwrap())).await).await;
    assert_eq!(end_again, end);
}

#[tokio::test]
async fn what_cannot_be_caught_is_a_problem() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=point-mass&speed=2").await;
    for message in [json!({"type": "catch"}), json!({"type": "throw", "apex": {"height": 0.3}})] {
        client.send(message).await;
        let problem = client.next_of("problem").await;
        assert!(problem["detail"].as_str().unwrap().contains("needs a body with an angle of its own"), "{problem}");
    }
    let server = Server::start();
    let both = "preset=case-1&interventions.0.impact=3&interventions.0.catch.strategy=auto&interventions.0.throw.apex.height=0.3";
    let refused = server.get(&format!("/v1/trajectories?{both}")).await.expect(422);
    assert_eq!(refused.pointers(), ["/interventions/0/throw"]);
    server.get(&format!("/v1/trajectories?{both}&interventions.0.throw.t=2")).await.expect(200);
    let wrong = "preset=case-1&interventions.0.impact=3&interventions.0.catch.hold=0&interventions.1.impact=4&interventions.1.throw.t=1";
    let refused = server.get(&format!("/v1/trajectories?{wrong}")).await.expect(422);
    assert_eq!(refused.pointers(), ["/interventions/0/catch/hold", "/interventions/1/throw/apex"]);
}
