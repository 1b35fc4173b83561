//! Live runs over real sockets: messages, their order, and that a run is its URL.
//!
//! Order and content are asserted, never wall-clock times. Runs are fast to keep the tests short.

use std::time::Duration;

use equipoise::compute::Peer;
use equipoise::limits;
use futures_util::SinkExt;
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::timeout;
use tokio_tungstenite::tungstenite::Message;

use crate::support::Server;
use crate::support::socket::{Client, Row, SOON, impacts_in, no_run, now_ms, numbers, open, refused, start, try_open};

/// A run of case 1 that was released some seconds ago.
fn old(seconds: u64) -> String {
    format!("/v1/live?preset=case-1&epoch_ms={}", now_ms() - 1000 * seconds)
}

#[tokio::test]
async fn a_run_is_told_in_order_with_the_values_of_the_physics() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1&speed=10").await;
    let hello = client.next().await;
    assert_eq!(hello["type"], "hello");
    assert_eq!(hello["scene"]["table"]["tilt_gain"], 1.1);
    assert_eq!((hello["model"]["name"].as_str(), &hello["paused"]), (Some("rod"), &json!(false)));
    assert!(hello["now_ms"].as_u64().unwrap() >= hello["epoch_ms"].as_u64().unwrap());
    assert!(hello["url"].as_str().unwrap().starts_with("/v1/live?scene."));
    let impacts = client.impacts(20).await;
    assert_eq!(numbers(&impacts), (1..=20).collect::<Vec<_>>());
    let scene = equipoise::api::scene::presets::find("case-1").unwrap().draft().build().unwrap();
    let mut orbit = scene.orbit().unwrap();
    assert_eq!(hello["flight_time"], orbit.t());
    for impact in impacts {
        let contact = orbit.advance();
        let after = contact.strike.unwrap().after;
        for (name, value) in [
            ("t", contact.t),
            ("x", contact.x),
            ("theta", contact.state.theta),
            ("x_dot", contact.state.x_dot),
            ("y_dot", contact.state.y_dot),
            ("theta_dot", contact.state.theta_dot),
            ("x_dot_after", after.x_dot),
            ("y_dot_after", after.y_dot),
            ("theta_dot_after", after.theta_dot),
            ("flight_time", contact.flight_time.unwrap()),
        ] {
            assert_eq!(impact[name].as_f64().unwrap().to_bits(), value.to_bits(), "{name}");
        }
    }
}

#[tokio::test]
async fn a_single_impact_says_all_of_it() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1&speed=2").await;
    let impact = client.next_of("impact").await;
    assert_eq!((impact["n"].as_u64(), impact["contact_mode"].as_str()), (Some(1), Some("frictionless")));
    assert!(impact["impulse_normal"].as_f64().unwrap() > 0.0 && impact["table_velocity_y"].is_number());
}

#[tokio::test]
async fn every_message_foresees_the_next_strike() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-5&speed=2").await;
    let hello = client.next().await;
    let (mut next, mut set, mut met) = (hello["first_strike"].clone(), false, 0);
    assert_eq!(next["target"], hello["derived"]["target"]);
    while met < 6 || next["target"]["height"] != 0.3 {
        let message = client.next().await;
        match message["type"].as_str() {
            Some("impact") => {
                for name in ["n", "t", "alpha"] {
                    assert_eq!(message[name], next[name], "{name}");
                }
                for axis in ["x", "y"] {
                    assert_eq!(message[format!("table_velocity_{axis}")], next["table_velocity"][axis], "{axis}");
                }
                met += 1;
            }
            // Many at once, if this machine is slow: the first of them is the one that was foreseen.
            Some("impacts") => {
                for name in ["n", "t", "alpha"] {
                    assert_eq!(message["columns"][name][0], next[name], "{name}");
                }
                met += message["columns"]["n"].as_array().unwrap().len();
            }
            Some("ack") => {
                assert_ne!(message["next_strike"]["alpha"], next["alpha"]);
                assert_eq!(message["next_strike"]["target"]["height"], 0.3);
            }
            other => panic!("{other:?}"),
        }
        next = message["next_strike"].clone();
        if !set && met > 0 {
            set = true;
            client.send(json!({"type": "set", "table.tilt_gain": 1.2, "table.target_height": 0.3})).await;
        }
    }
}

#[tokio::test]
async fn the_same_url_is_the_same_run_and_from_leaves_no_gap() {
    let (_, address) = start().await;
    let url = old(60);
    let mut first = open(address, &format!("{url}&from=1")).await;
    let hello = first.next().await;
    let all = first.impacts(100).await;
    assert_eq!(numbers(&all), (1..=100).collect::<Vec<_>>());
    let mut second = open(address, &format!("{}&from=41", hello["url"].as_str().unwrap())).await;
    assert_eq!(second.impacts(60).await, all[40..]);
    // Without `from` the stream begins with the flight under way.
    let mut third = open(address, &url).await;
    let now = third.next().await["run_time"].as_f64().unwrap();
    let begin = third.impacts(1).await.remove(0);
    let t = begin["t"].as_f64().unwrap();
    assert!(t <= now + 1.0 && t + begin["flight_time"].as_f64().unwrap() > now - 1.0, "{t} {now}");
}

#[tokio::test]
async fn interventions_act_and_their_url_replays_the_run() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1&speed=10").await;
    let mut seen = client.impacts(3).await;
    let set = client.ask(json!({"type": "set", "table.tilt_gain": 1.2})).await;
    let at_set = set["impact"].as_u64().unwrap();
    let kick = client.ask(json!({"type": "kick", "theta_dot": 0.02, "x_dot": -0.001})).await;
    let at_kick = kick["impact"].as_u64().unwrap();
    client.ask(json!({"type": "speed", "value": 20})).await;
    client.ask(json!({"type": "pause"})).await;
    let mut wanted = 30 - seen.len();
    let resumed = client.ask(json!({"type": "resume"})).await;
    while wanted > 0 {
        let more = client.impacts(wanted).await;
        wanted -= more.len();
        seen.extend(more);
    }
    assert_eq!(numbers(&seen), (1..=30).collect::<Vec<_>>());
    assert_eq!((resumed["speed"].as_f64(), resumed["paused"].as_bool()), (Some(20.0), Some(false)));
    assert!(at_kick >= at_set && at_set >= 4);
    let gain = |row: &Row| row["alpha"].as_f64().unwrap() / row["theta"].as_f64().unwrap();
    for row in &seen {
        let expected = if row["n"].as_u64().unwrap() < at_set { 1.1 } else { 1.2 };
        assert!((gain(row) - expected).abs() < 1e-12, "{row:?}");
    }
    let mut replay = open(address, &format!("{}&from=1", resumed["url"].as_str().unwrap())).await;
    let hello = replay.next().await;
    assert_eq!(hello["url"], resumed["url"]);
    assert_eq!(hello["scene"]["table"]["tilt_gain"], 1.1);
    assert_eq!(replay.impacts(30).await, seen);
}

#[tokio::test]
async fn a_trajectory_with_the_same_interventions_is_the_same_run() {
    let (_, address) = start().await;
    let server = Server::start();
    let did = "interventions.0.impact=4&interventions.0.set.table.tilt_gain=1.2&interventions.1.impact=9&\
               interventions.1.kick.theta_dot=0.02&interventions.1.kick.x_dot=-0.001";
    let seen = open(address, &format!("/v1/live?preset=case-1&speed=20&{did}")).await.impacts(40).await;
    let query = format!("preset=case-1&bounces=40&{did}");
    let run = server.get(&format!("/v1/trajectories?{query}")).await.json();
    for (place, row) in seen.iter().enumerate() {
        for column in ["n", "t", "theta", "x_dot", "y_dot", "theta_dot", "alpha", "energy", "contact_velocity"] {
            assert_eq!(run["impacts"][column][place], row[column], "{column} of impact {}", place + 1);
        }
    }
    assert_eq!((&run["outcome"]["kind"], &run["outcome"]["bounces"]), (&json!("completed"), &json!(40)));
    assert_eq!(run["predictable_bounces"], 0);
    assert!(run["notes"][0].as_str().unwrap().contains("changed under way"), "{}", run["notes"]);
    let body = json!({"preset": "case-1", "bounces": 40, "interventions": [
        {"impact": 4, "set": {"table": {"tilt_gain": 1.2}}}, {"impact": 9, "kick": {"theta_dot": 0.02, "x_dot": -0.001}}]});
    assert_eq!(server.post("/v1/trajectories", &body).await.json(), run);
    let refused = server.get(&format!("/v1/trajectories?{query}&tolerance=1e-6")).await;
    assert_eq!(refused.json()["errors"][0]["pointer"], "/tolerance");
    let refused = server.get(&format!("/v1/trajectories?{query}&method=linear")).await;
    assert_eq!(refused.json()["errors"][0]["pointer"], "/method");
    let plain = server.get("/v1/trajectories?preset=case-1&bounces=40").await.json();
    assert_eq!(plain["impacts"]["theta"].as_array().unwrap()[..4], run["impacts"]["theta"].as_array().unwrap()[..4]);
    assert_ne!(plain["impacts"]["theta"], run["impacts"]["theta"]);
}

#[tokio::test]
async fn a_paused_run_goes_on_step_by_step() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1&speed=0.05").await;
    client.next().await;
    client.send(json!({"type": "step"})).await;
    assert!(client.next_of("problem").await["detail"].as_str().unwrap().contains("paused"));
    let paused = client.ask(json!({"type": "pause"})).await;
    assert_eq!((paused["paused"].as_bool(), paused["speed"].as_f64()), (Some(true), Some(0.05)));
    for n in 1..=20 {
        let step = client.ask(json!({"type": "step"})).await;
        assert_eq!(step["impact"], n);
        let row = client.impacts(1).await.remove(0);
        assert_eq!((row["n"].as_u64(), &row["t"]), (Some(n), &step["run_time"]));
    }
    // Another client with its URL finds it paused at the same place.
    let last = client.ask(json!({"type": "pause"})).await;
    let mut other = open(address, last["url"].as_str().unwrap()).await;
    let hello = other.next().await;
    assert_eq!((&hello["paused"], &hello["run_time"]), (&json!(true), &last["run_time"]));
    assert_eq!(numbers(&other.impacts(1).await), [20]);
}

#[tokio::test]
async fn a_run_ends_and_begins_anew() {
    let (_, address) = start().await;
    let epoch = now_ms() - 3_600_000;
    let mut client = open(address, &format!("/v1/live?preset=case-3&epoch_ms={epoch}&from=1")).await;
    client.next().await;
    let end = client.next_of("end").await;
    assert_eq!((end["outcome"]["kind"].as_str(), end["outcome"]["bounces"].as_u64()), (Some("sinking"), Some(49)));
    assert_eq!(client.rows.len(), 49);
    assert_eq!(client.rows[48]["flight_time"], Value::Null);
    client.rows.clear();
    client.send(json!({"type": "kick", "theta_dot": 0.1})).await;
    assert!(client.next().await["detail"].as_str().unwrap().contains("has ended at impact 49"));
    client.ask(json!({"type": "speed", "value": 10})).await;
    client.send(json!({"type": "restart"})).await;
    let hello = client.next().await;
    assert_eq!((hello["type"].as_str(), hello["speed"].as_f64()), (Some("hello"), Some(10.0)));
    assert!(hello["epoch_ms"].as_u64().unwrap() > epoch);
    assert_eq!(numbers(&client.impacts(3).await), [1, 2, 3]);
}

#[tokio::test]
async fn a_restart_keeps_what_was_set() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1&speed=5").await;
    client.ask(json!({"type": "set", "table.tilt_gain": 1.2, "contact.restitution": 0.8})).await;
    client.ask(json!({"type": "kick", "y_dot": 0.1})).await;
    client.send(json!({"type": "restart"})).await;
    let hello = client.next_of("hello").await;
    assert_eq!(hello["scene"]["table"]["tilt_gain"], 1.2);
    assert_eq!(hello["scene"]["contact"]["restitution"], 0.8);
    assert!(!hello["url"].as_str().unwrap().contains("interventions"));
}

#[tokio::test]
async fn a_bad_message_is_a_problem_and_the_run_goes_on() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1&speed=10").await;
    for (text, pointer) in [
        ("nonsense".to_owned(), None),
        (r#"{"type":"stop"}"#.to_owned(), Some("/type")),
        (r#"{"type":"speed","value":21}"#.to_owned(), Some("/value")),
        (r#"{"type":"set","gravity":1}"#.to_owned(), Some("/gravity")),
        (r#"{"type":"set","table.energy_gain":0.1}"#.to_owned(), Some("/table.target_height")),
        (r#"{"type":"kick","theta_dot":500}"#.to_owned(), Some("/theta_dot")),
        (format!(r#"{{"type":"pause","x":"{}"}}"#, "x".repeat(limits::LIVE_MESSAGE_BYTES)), Some("")),
    ] {
        client.socket.send(Message::text(text.clone())).await.unwrap();
        let problem = client.next_of("problem").await;
        assert!(!problem["title"].as_str().unwrap().is_empty());
        assert_eq!(problem["errors"][0]["pointer"].as_str(), pointer, "{text:.50}: {problem}");
    }
    client.socket.send(Message::binary(vec![1_u8])).await.unwrap();
    assert!(client.next_of("problem").await["detail"].as_str().unwrap().contains("binary"));
    let seen = numbers(&client.impacts(10).await);
    assert_eq!(seen, (1..=10).collect::<Vec<_>>());
}

#[tokio::test]
async fn a_kick_turns_no_point_mass() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=point-mass&speed=10").await;
    let hello = client.next().await;
    assert_eq!((&hello["release"]["theta"], &hello["release"]["theta_dot"]), (&Value::Null, &Value::Null));
    client.send(json!({"type": "kick", "theta_dot": 0.1})).await;
    assert_eq!(client.next_of("problem").await["errors"][0]["pointer"], "/theta_dot");
    let ack = client.ask(json!({"type": "kick", "x_dot": 0.01})).await;
    let n = ack["impact"].as_u64().unwrap() as usize;
    assert_eq!(client.impacts(n).await[n - 1]["theta_dot_after"], Value::Null);
}

#[tokio::test]
async fn messages_are_limited_in_size_and_number() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1").await;
    client.socket.send(Message::text("x".repeat(limits::LIVE_FRAME_BYTES + 1))).await.unwrap();
    assert_eq!(client.closed().await, Some(1009));
    for message in [Message::text("{}"), Message::Ping("".into()), Message::Pong("".into())] {
        let mut client = open(address, "/v1/live?preset=case-1").await;
        for _ in 0..4 * limits::LIVE_MESSAGES_PER_S {
            if client.socket.send(message.clone()).await.is_err() {
                break;
            }
        }
        assert_eq!(client.closed().await, Some(1008), "{message}");
    }
}

/// A client's frame with the masking key 0, which leaves the payload unchanged.
fn frame(first: u8, payload: &[u8]) -> Vec<u8> {
    [&[first, 0x80 | u8::try_from(payload.len()).unwrap(), 0, 0, 0, 0], payload].concat()
}

#[tokio::test]
async fn what_cannot_be_read_is_closed_with_the_code_that_says_why() {
    let (app, address) = start().await;
    let oversize = [&[0x81, 0xff], u64::MAX.to_be_bytes().as_slice(), &[0; 4]].concat();
    for (broken, code, what) in [
        (frame(0xf1, b"{}"), 1002, "reserved bits"),
        (frame(0x83, b"{}"), 1002, "an opcode that there is not"),
        (frame(0x8b, b""), 1002, "a control frame that there is not"),
        (vec![0x81, 0x02, b'{', b'}'], 1002, "no mask"),
        (frame(0x09, b""), 1002, "a ping in pieces"),
        (frame(0x80, b"{}"), 1002, "the next piece of nothing"),
        ([frame(0x01, b"{"), frame(0x81, b"}")].concat(), 1002, "a message within a message"),
        (frame(0x88, b"x"), 1002, "half a close code"),
        (frame(0x88, &[3, 0xed]), 1002, "a close code that nobody may send"),
        (frame(0x81, b"\xff\xfe"), 1007, "text that is not UTF-8"),
        ([frame(0x01, b"\xc3"), frame(0x80, b"(")].concat(), 1007, "the same in pieces"),
        (frame(0x88, b"\x03\xe8\xff"), 1007, "the reason of a close that is not UTF-8"),
        (oversize, 1009, "a frame of 2^64 - 1 bytes"),
    ] {
        let mut client = open(address, "/v1/live?preset=case-1").await;
        client.socket.get_mut().write_all(&broken).await.unwrap();
        assert_eq!(client.closed().await, Some(code), "{what}");
    }
    timeout(SOON, async {
        while app.metrics.live_sessions.get() > 0 {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    })
    .await
    .expect("a session goes on for nobody");
}

#[tokio::test]
async fn interventions_are_limited() {
    let (_, address) = start().await;
    let mut url = "/v1/live?preset=case-1&speed=0.05".to_owned();
    for index in 0..limits::LIVE_INTERVENTIONS {
        url += &format!("&interventions.{index}.impact={}&interventions.{index}.kick.x_dot=0", index + 100);
    }
    assert!(url.len() < limits::URL_BYTES);
    let mut client = open(address, &url).await;
    client.ask(json!({"type": "pause"})).await;
    client.send(json!({"type": "kick", "x_dot": 0.1})).await;
    let problem = client.next_of("problem").await;
    assert!(problem["detail"].as_str().unwrap().contains("100 interventions"), "{problem}");
    url += "&interventions.100.impact=200&interventions.100.kick.x_dot=0";
    assert_eq!(no_run(address, &url).await["errors"][0]["pointer"], "/interventions");
}

#[tokio::test]
async fn an_epoch_too_old_is_refused() {
    let (_, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1&epoch_ms=0&from=1").await;
    let problem = client.next().await;
    assert_eq!(
        (problem["type"].as_str(), problem["title"].as_str()),
        (Some("problem"), Some("The request costs too much"))
    );
    assert_eq!(client.closed().await, Some(1008));
}

#[tokio::test]
async fn a_run_that_settles_ends_without_spinning() {
    let (app, address) = start().await;
    let mut client = open(address, "/v1/live?preset=still-lossy&speed=20").await;
    let end = client.next_of("end").await;
    let impacts = end["outcome"]["bounces"].as_u64().unwrap();
    assert_eq!(numbers(&client.rows), (1..=impacts).collect::<Vec<_>>());
    assert!(app.metrics.bounces.get() <= impacts + 1);
}

#[tokio::test]
async fn a_run_of_a_million_bounces_a_second_leaves_nothing_out() {
    let (_, address) = start().await;
    let low = "scene.release.theta=0&scene.release.height=0.133333334&speed=20";
    let seen = numbers(&open(address, &format!("/v1/live?preset=case-1&{low}")).await.impacts(2000).await);
    assert!(seen.into_iter().eq(1..=2000), "the client keeps up");
}

#[tokio::test]
async fn what_is_no_run_or_no_websocket_is_a_problem() {
    let (app, address) = start().await;
    let foreign = [("origin", "http://elsewhere.example")];
    assert_eq!(refused(address, "/v1/live?preset=case-1", &foreign).await["status"], 403);
    let own = format!("http://{address}");
    let _own = try_open(address, "/v1/live?preset=case-1", &[("origin", &own)]).await.unwrap();
    let home = Peer::at([127, 0, 0, 1].into());
    let _all: Vec<_> = std::iter::from_fn(|| app.live_quota.try_reserve(home).ok()).collect();
    assert_eq!(refused(address, "/v1/live?preset=case-1", &[]).await["status"], 503);
    let plain = async |head: &str| {
        let mut socket = TcpStream::connect(address).await.unwrap();
        socket.write_all(format!("{head}host: localhost\r\nconnection: close\r\n\r\n").as_bytes()).await.unwrap();
        let mut answer = String::new();
        socket.read_to_string(&mut answer).await.unwrap();
        answer
    };
    let answer = plain("GET /v1/live?preset=case-1 HTTP/1.1\r\n").await;
    assert!(answer.starts_with("HTTP/1.1 426") && answer.contains("upgrade: websocket"), "{answer}");
    assert!(answer.contains("application/problem+json"));
    assert!(plain("GET /v1/live?preset=case-9 HTTP/1.1\r\n").await.starts_with("HTTP/1.1 422"));
    assert!(plain("POST /v1/live HTTP/1.1\r\n").await.starts_with("HTTP/1.1 405"));
}

#[tokio::test]
async fn the_subprotocol_is_agreed_on() {
    let (_, address) = start().await;
    let offered = [("sec-websocket-protocol", "other, equipoise.v1")];
    let (_, protocol) = try_open(address, "/v1/live?preset=case-1", &offered).await.unwrap();
    assert_eq!(protocol.as_deref(), Some("equipoise.v1"));
}

#[tokio::test]
async fn a_server_that_closes_says_so() {
    let (app, address) = start().await;
    let mut client = open(address, "/v1/live?preset=case-1").await;
    client.next().await;
    assert_eq!(app.metrics.live_sessions.get(), 1);
    app.close();
    assert_eq!(client.closed().await, Some(1001));
    // A late client gets the same close code.
    assert_eq!(open(address, "/v1/live?preset=case-1").await.closed().await, Some(1001));
    timeout(SOON, async {
        while app.metrics.live_sessions.get() > 0 {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    })
    .await
    .expect("the session goes on for nobody");
}

// Live runs that are caught, held and thrown, over real sockets.

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

// Live runs that go on in contact after their bounces, over real sockets.

/// A table that stands still, and a contact that loses much: thirteen bounces in half a second.
const SETTLES: &str = "preset=still-lossy&scene.contact.restitution=0.1&scene.release.theta=0.1&scene.release.x_dot=0";

/// A run up to its end: numbers of its impacts, columns of its holds without the rows that stand in two messages, and the end.
async fn numbers_to_the_end(client: &mut Client) -> (Vec<u64>, Value, Value) {
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
        let (impacts, told, end) = numbers_to_the_end(&mut client).await;
        let run = trajectory(url).await;
        assert_eq!((&told, &end["hold_end"]), (&run["hold"], &run["hold_end"]));
        assert_eq!((&end["outcome"], &end["demand"]), (&run["outcome"], &run["demand"]));
        assert_eq!((end["outcome"]["kind"].as_str(), end["hold_end"]["kind"].as_str()), (Some("settled"), Some(kind)));
        // The URL replays it; after the last impact it begins with the contact.
        let next = impacts.len() + 1;
        for (from, count) in [(1, impacts.len()), (next, 0), (next + 1, 0)] {
            let mut again = open(address, &format!("{url}&from={from}")).await;
            let (sent, told_again, end_again) = numbers_to_the_end(&mut again).await;
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
        let (impacts, hold, end) = numbers_to_the_end(&mut client).await;
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
    let (_, hold, end) = numbers_to_the_end(&mut again).await;
    assert_eq!(numbers_to_the_end(&mut client).await.2, end);
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
    let (impacts, _, end) = numbers_to_the_end(&mut client).await;
    assert!(end["outcome"]["bounces"].as_u64() > thrown["impact"].as_u64());
    let url = resumed["url"].as_str().unwrap();
    assert!(url.contains("throw.t=") && url.contains("&hold=2.0"), "{url}");
    let mut again = open(address, &format!("{url}&from=1")).await;
    let (all, _, end_again) = numbers_to_the_end(&mut again).await;
    assert_eq!((&end_again, all.last()), (&end, impacts.last()));
    let run = trajectory(url).await;
    assert_eq!((&run["outcome"], &run["hold_end"]), (&end["outcome"], &end["hold_end"]));
    assert_eq!(run["impacts"]["n"].as_array().unwrap().len(), all.len());
}
