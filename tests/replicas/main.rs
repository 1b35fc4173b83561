//! Replicas behind the real nginx, as in `docs/deploy`: they answer as one, and clients do not notice the loss of one.
//!
//! The tests print their figures. Without nginx they say so and end; `tests/run` installs it on CI.

mod programs;
#[path = "../support/mod.rs"]
mod support;

use std::fmt::Display;
use std::io::{Write, stdout};
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use equipoise::limits;
use equipoise::limits::Limits;
use serde_json::{Value, json};
use tokio::task::JoinHandle;

use crate::programs::{Answer, Ask, Failed, Follower, Nginx, Over, Replica, ask, begin, folder, until};
use crate::support::contract;
use crate::support::socket::{now_ms, numbers, try_open};

/// Prints a line, also when the test passes.
fn say(what: impl Display) {
    let _ = writeln!(stdout(), "{what}");
}

/// nginx; `None` if it is not installed.
fn nginx() -> Option<&'static str> {
    let program = Nginx::program();
    if program.is_none() {
        say("skip  replicas: nginx is not installed (apt-get install nginx)");
    }
    program
}

/// Requests of all kinds.
fn kinds() -> Vec<Ask> {
    let run = r#"{"preset": "case-1", "scene": {"table": {"tilt_gain": 1.3}}, "bounces": 200}"#;
    let get = |target: &str| Ask::get(target.to_owned());
    vec![
        get("/v1/trajectories?preset=case-1&bounces=100"),
        get("/v1/trajectories?preset=case-2&bounces=300&format=csv").with("accept-encoding", "gzip"),
        Ask::post("/v1/trajectories", run).with("accept", "application/x-ndjson"),
        get("/v1/stability?preset=case-1&bounces=500"),
        Ask::post("/v1/stability", run),
        get("/v1/stability?preset=case-1&bounces=200&format=svg"),
        get("/v1/trajectories?preset=case-1&bounces=200&format=png"),
        get("/v1/jacobians?preset=case-1"),
        get("/v1/periodic-orbits?preset=case-1"),
        get("/v1/ladder?preset=case-1&bounces=50"),
        get("/v1/controllers?preset=case-1"),
        Ask::post("/v1/ensembles", r#"{"preset": "case-1-noise", "runs": 50, "bounces": 50}"#),
        get(&region(20, "ndjson")),
        get("/v1/ensembles?preset=case-1-noise&runs=100&bounces=100&format=progress"),
        Ask { method: "HEAD", ..get("/v1/scenes") },
        get("/v1/fields"),
        get("/openapi.json").with("accept-encoding", "gzip"),
        // Not the page: it names the address at which it was asked.
        get("/docs"),
        get("/v1/stability?preset=case-1&bounces=-1").with("x-request-id", "wrong-1"),
        Ask::post("/v1/trajectories", r#"{"preset": "#).with("x-request-id", "wrong-2"),
    ]
}

/// A map with `side` × `side` cells; some seconds from side 200 on.
fn region(side: u32, format: &str) -> String {
    format!(
        "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=0.95&x.to=1.6&x.count={side}\
         &y.field=release.theta&y.from=0&y.to=0.5&y.count={side}&bounces=2000&format={format}"
    )
}

/// The same as JSON by POST.
fn posted_region(side: u32) -> Ask {
    let axis = |field, to: f64, from: f64| json!({"field": field, "from": from, "to": to, "count": side});
    let (x, y) = (axis("table.tilt_gain", 1.6, 0.95), axis("release.theta", 0.5, 0.0));
    Ask::post("/v1/regions", &json!({"preset": "case-1", "x": x, "y": y, "bounces": 2000}).to_string())
}

#[tokio::test]
async fn two_replicas_answer_as_one() {
    let Some(program) = nginx() else { return };
    let folder = folder("as-one");
    let [one, two] = ["one", "two"].map(|name| Replica::start(&folder, name, &[]));
    let nginx = Nginx::start(program, &folder, &[&one, &two], |conf| conf).await;
    for kind in kinds() {
        let from_one = ask(one.address, &kind).await.unwrap();
        for address in [two.address, nginx.address, nginx.address] {
            assert_eq!(ask(address, &kind).await.unwrap().lasting(), from_one.lasting(), "{kind:?}");
        }
        if let Some(tag) = from_one.headers.get("etag") {
            let again = kind.with("if-none-match", tag);
            assert_eq!(ask(two.address, &again).await.unwrap().status, if again.method == "POST" { 200 } else { 304 });
        }
    }
    assert!(one.log().len() > kinds().len() && two.log().len() > kinds().len(), "nginx asks one of them alone");

    // A run that was released a while ago and goes on.
    let query = format!("preset=case-1&speed=4&epoch_ms={}", now_ms() - 20_000);
    let addresses = [one.address, two.address, nginx.address, nginx.address];
    let followers: Vec<_> = addresses
        .into_iter()
        .flat_map(|address| [Over::WebSocket, Over::Events].map(|over| Follower::start(address, &query, over)))
        .collect();
    let before = ask(one.address, &Ask::get(format!("/v1/trajectories?{}&bounces=50", "preset=case-1"))).await.unwrap();
    until("all have heard it go on", async || followers.iter().all(|follower| follower.count() > 350)).await;
    let whole: Vec<_> = followers.iter().map(|follower| follower.heard().rows[..350].to_vec()).collect();
    assert_eq!(numbers(&whole[0]), (1..=350).collect::<Vec<_>>());
    assert_eq!(before.json()["impacts"]["t"][49], whole[0][49]["t"]);
    for rows in &whole {
        assert_eq!(*rows, whole[0]);
    }
    say("ok    replicas: two give the same bytes, ETags and live run, asked directly and through nginx");
}

#[tokio::test]
async fn ids_addresses_and_a_base_path_go_through() {
    let Some(program) = nginx() else { return };
    let folder = folder("through");
    let replica = Replica::start(&folder, "one", &["--base-path", "/rig", "--token", "0123456789abcdef"]);
    let under_rig = |conf: String| conf.replace("location / {", "location /rig/ {");
    let nginx = Nginx::start(program, &folder, &[&replica], under_rig).await;
    let bearer = |ask: Ask| ask.with("authorization", "Bearer 0123456789abcdef");
    let answer = async |kind: Ask| ask(nginx.address, &kind).await.unwrap();

    let page = answer(Ask::get("/rig")).await;
    assert!(page.status == 301 && page.headers["location"].ends_with("/rig/"), "{page:?}");
    let opened = answer(Ask::get("/rig/?preset=case-1&token=0123456789abcdef")).await;
    assert_eq!((opened.status, opened.headers["location"].as_str()), (303, "./?preset=case-1"));
    let chosen = answer(bearer(Ask::get("/rig/v1/scenes")).with("x-request-id", "lab-1").from(7)).await;
    assert_eq!((chosen.status, chosen.headers["x-request-id"].as_str()), (200, "lab-1"));
    // A request id that is unsafe in a log is replaced, and an address that the client claims is ignored.
    let lie = Ask::post("/rig/v1/stability", "{}").with("x-request-id", "a b").with("x-forwarded-for", "192.0.2.1");
    let made = answer(bearer(lie).from(8)).await;
    let id = &made.headers["x-request-id"];
    assert_eq!((made.status, made.json()["request_id"].as_str()), (422, Some(id.as_str())));
    assert_eq!(id.len(), 32);
    // Outside the prefix there is nothing.
    assert_eq!(answer(Ask::get("/v1/scenes")).await.status, 404);

    let (mut logged, told) = (Vec::new(), replica.log());
    until("nginx has logged what the replica has", async || {
        logged = nginx.log();
        logged.retain(|line| line["replicas"] != "");
        logged.len() >= told.len()
    })
    .await;
    for of_replica in &told {
        let of_nginx = logged.iter().find(|line| line["id"] == of_replica["id"]).expect("the same id in both");
        for name in ["peer", "method", "target"] {
            assert_eq!(of_nginx[name], of_replica[name], "{of_nginx} {of_replica}");
        }
        assert_eq!(of_nginx["status"], of_replica["status"].to_string());
    }
    let column = |name: &str| told.iter().map(|line| line[name].as_str().unwrap().to_owned()).collect::<Vec<_>>();
    assert_eq!(column("peer"), ["127.0.0.1", "127.0.0.7", "127.0.0.8"]);
    assert_eq!(column("id")[1..], ["lab-1".to_owned(), id.clone()]);
    assert_eq!(column("target")[0], "/rig/?preset=case-1&token=");

    // The URL of a run contains the prefix, so a client can reconnect to it; a page of this host may open it.
    let bearer = ("authorization", "Bearer 0123456789abcdef");
    let own = format!("http://{}", nginx.address);
    let run = "/rig/v1/live?preset=case-1&speed=10";
    let (mut client, _) = try_open(nginx.address, run, &[bearer, ("origin", &own)]).await.unwrap();
    let url = client.next().await["url"].as_str().unwrap().to_owned();
    assert!(url.starts_with("/rig/v1/live?scene."), "{url}");
    try_open(nginx.address, &url, &[bearer]).await.unwrap();
    assert!(try_open(nginx.address, run, &[bearer, ("origin", "http://elsewhere.example")]).await.is_err());
    say("ok    replicas: ids, addresses and a base path go through nginx");
}

#[tokio::test]
async fn what_is_too_much_is_a_problem_whoever_finds_it() {
    let Some(program) = nginx() else { return };
    let folder = folder("too-much");
    let mut replica = Replica::start(&folder, "one", &["--base-path", "/rig"]);
    let nginx = Nginx::start(program, &folder, &[&replica], |conf| conf).await;
    let answer = async |kind: Ask| ask(nginx.address, &kind).await.unwrap();
    let long = |prefix: &str, bytes: usize| format!("{prefix}{}", "a".repeat(bytes - prefix.len()));

    // A body of the largest size passes. The server refuses one byte more, also if nginx does not read the body to its end.
    let url = limits::URL_BYTES;
    let head = Ask::get("/v1/scenes").with("x-a", &"a".repeat(15_000)).with("x-b", &"b".repeat(15_000));
    for (kind, status, by_replica) in [
        (Ask::get(long("/v1/scenes?unknown=", url)), 422, true),
        (Ask::get(long("/v1/scenes?unknown=", url + 1)), 414, true),
        (Ask::get(long("/v1/scenes?unknown=", 2 * url + 100)), 414, false),
        (head, 200, true),
        (Ask::get("/v1/scenes").with("x-a", &"a".repeat(20_000)), 400, false),
        (Ask::post("/v1/stability", &padded(Limits::default().body_bytes)), 200, true),
        (Ask::post("/v1/stability", &padded(Limits::default().body_bytes + 1)), 413, false),
        // An answer with a long head does not count as a failure of the replica.
        (Ask::get(long("/rig?unknown=", url)), 308, true),
        (Ask::get("/v1/scenes"), 200, true),
    ] {
        let answer = answer(kind).await;
        let what = format!("{:?}", answer.headers);
        assert_eq!((answer.status, answer.headers.contains_key("equipoise-build")), (status, by_replica), "{what}");
        if status >= 400 {
            is_problem(&answer);
        }
    }

    // Without a replica clients get 503 with Retry-After; once a replica is back, they are served at once.
    replica.kill();
    for _ in 0..5 {
        let gone = answer(Ask::post("/v1/stability", "{}")).await;
        assert_eq!((gone.status, gone.headers["retry-after"].as_str()), (503, "2"));
        is_problem(&gone);
    }
    replica.again();
    until("it is found", async || answer(Ask::get("/v1/scenes")).await.status == 200).await;
}

/// A request with a body of `length` bytes.
fn padded(bytes: usize) -> String {
    let request = r#"{"preset": "case-1", "bounces": 10}"#;
    format!("{request}{}", " ".repeat(bytes - request.len()))
}

#[track_caller]
fn is_problem(answer: &Answer) {
    assert_eq!(answer.headers["content-type"], "application/problem+json");
    let problem = answer.json();
    let faults = contract::faults(&json!({"$ref": "#/components/schemas/Problem"}), &problem);
    assert!(faults.is_empty(), "{faults:?} in {problem}");
    assert_eq!(problem["status"], answer.status);
    assert_eq!(problem["request_id"].as_str(), Some(answer.headers["x-request-id"].as_str()));
}

/// Refusals come from the server, and do not take its replicas away from other clients.
#[tokio::test]
async fn one_client_that_asks_too_much_takes_nothing_from_others() {
    let Some(program) = nginx() else { return };
    let folder = folder("too-often");
    // Without kept answers each request needs a place.
    let narrow = ["--permits", "1", "--queue", "4", "--held-bytes", "2000000", "--answer-cache", "0"];
    let replicas = ["one", "two"].map(|name| Replica::start(&folder, name, &narrow));
    let nginx = Nginx::start(program, &folder, &[&replicas[0], &replicas[1]], |conf| conf).await;
    // One client gets 3 of the 5 places of each replica.
    let held: Vec<_> = (0..12)
        .map(|_| tokio::spawn(async move { ask(nginx.address, &Ask::get(region(1000, "json")).from(1)).await }))
        .collect();
    until("both are full of it", async || {
        let full = async |replica: &Replica| replica.metric("equipoise_jobs_running").await == 3.0;
        full(&replicas[0]).await && full(&replicas[1]).await
    })
    .await;
    for _ in 0..20 {
        let kind = Ask::get("/v1/stability?preset=case-1&bounces=2000");
        let refused = ask(nginx.address, &kind.clone().from(1)).await.unwrap();
        assert_eq!((refused.status, refused.headers["retry-after"].as_str()), (503, "2"));
        assert!(refused.headers.contains_key("equipoise-build"), "no replica is left");
        assert_eq!(ask(nginx.address, &kind.from(2)).await.unwrap().status, 200);
    }
    // Work ends when its client hangs up.
    for client in held {
        client.abort();
    }
    until("nothing is computed", async || {
        replicas[0].metric("equipoise_jobs_running").await + replicas[1].metric("equipoise_jobs_running").await == 0.0
    })
    .await;

    // The replica holds an unread answer; nginx buffers none of it.
    let long = Ask::get("/v1/trajectories?preset=case-1&bounces=40000").from(1);
    let mut unread = [begin(nginx.address, &long).await.unwrap(), begin(nginx.address, &long).await.unwrap()];
    let short = Ask::get("/v1/stability?preset=case-1&bounces=2000");
    let refused = ask(nginx.address, &short.from(1)).await.unwrap();
    assert_eq!(refused.status, 503);
    assert!(refused.json()["detail"].as_str().unwrap().contains("still to be read from this address"));
    for answer in &mut unread {
        assert!(answer.piece().await.unwrap().is_some());
    }
    say("ok    replicas: fair between the clients of nginx");
}

#[tokio::test]
async fn an_answer_comes_as_it_is_made() {
    let Some(program) = nginx() else { return };
    let folder = folder("as-made");
    let replica = Replica::start(&folder, "one", &[]);
    let nginx = Nginx::start(program, &folder, &[&replica], |conf| conf).await;
    let dear = "/v1/ensembles?preset=case-1-noise&runs=20000&bounces=5000&format=progress";
    let mut answer = begin(nginx.address, &Ask::get(dear)).await.unwrap();
    let first = answer.piece().await.unwrap().unwrap();
    assert!(first.starts_with(b"{\"progress\":{\"done\":0,"), "{}", String::from_utf8_lossy(&first));
    assert!(answer.piece().await.unwrap().unwrap().starts_with(b"{\"progress\""));
    assert_eq!(replica.metric("equipoise_jobs_running").await, 1.0);
    drop(answer);
    until("nothing is computed", async || replica.metric("equipoise_jobs_running").await == 0.0).await;
}

// Replicas that are killed, restarted and stopped under load and with many live runs.

/// Clients that send requests without a pause and compare every answer with an earlier one.
struct Load {
    asked: Arc<AtomicUsize>,
    /// Answers that broke off; nginx cannot repeat these, only the client can.
    cut: Arc<AtomicUsize>,
    ends: Arc<AtomicBool>,
    clients: Vec<JoinHandle<()>>,
}

impl Load {
    fn start(address: SocketAddr, expected: &Arc<Vec<(Ask, Answer)>>, clients: usize) -> Self {
        let (asked, cut, ends) = <(Arc<AtomicUsize>, Arc<AtomicUsize>, Arc<AtomicBool>)>::default();
        let client = |start: usize| {
            let (asked, cut, ends, expected) = (asked.clone(), cut.clone(), ends.clone(), expected.clone());
            tokio::spawn(async move {
                for (kind, right) in expected.iter().cycle().skip(start * 3) {
                    if ends.load(Ordering::Relaxed) {
                        break;
                    }
                    match ask(address, kind).await {
                        Ok(answer) => assert_eq!(answer.lasting(), right.lasting(), "{kind:?}"),
                        Err(Failed::Cut) => drop(cut.fetch_add(1, Ordering::Relaxed)),
                        Err(Failed::Unanswered(why)) => panic!("{kind:?}: {why}"),
                    }
                    asked.fetch_add(1, Ordering::Relaxed);
                }
            })
        };
        let clients = (0..clients).map(client).collect();
        Self { asked, cut, ends, clients }
    }

    fn asked(&self) -> usize {
        self.asked.load(Ordering::Relaxed)
    }

    fn cut(&self) -> usize {
        self.cut.load(Ordering::Relaxed)
    }

    /// Goes on until `count` more requests have been answered.
    async fn more(&self, count: usize) {
        let enough = self.asked() + count;
        until("the load goes on", async || {
            assert!(self.asked() >= enough || self.clients.iter().all(|client| !client.is_finished()), "see above");
            self.asked() >= enough
        })
        .await;
    }

    async fn end(self) {
        self.ends.store(true, Ordering::Relaxed);
        for client in self.clients {
            client.await.expect("no answer was wrong");
        }
    }
}

/// Waits until every client has received `count` more impacts.
async fn all_hear(followers: &[Follower], more: usize) {
    let before: Vec<_> = followers.iter().map(Follower::count).collect();
    until("all hear their runs go on", async || {
        assert!(followers.iter().all(Follower::is_well), "see above");
        followers.iter().zip(&before).all(|(follower, before)| follower.count() >= before + more)
    })
    .await;
}

fn breaks(followers: &[Follower]) -> Vec<usize> {
    followers.iter().map(|follower| follower.heard().breaks).collect()
}

/// Long work, equal on both replicas: answers that are sent when ready (POST), and answers that are streamed.
async fn work_on(replicas: [&Replica; 2], nginx: &Nginx) -> Vec<JoinHandle<Result<Answer, Failed>>> {
    let (address, mut asked) = (nginx.address, Vec::new());
    for kind in [Ask::get(streamed()), Ask::get(streamed()), posted_region(SIDE), posted_region(SIDE)] {
        asked.push(match kind.method {
            "POST" => tokio::spawn(async move { ask(address, &kind).await }),
            _ => {
                // The answer has begun once its head and a first piece are here.
                let mut begun = begin(address, &kind).await.unwrap();
                let first = begun.piece().await.unwrap().unwrap();
                tokio::spawn(async move {
                    let mut answer = begun.whole().await?;
                    answer.body.splice(0..0, first);
                    Ok(answer)
                })
            }
        });
        let count = asked.len() as f64;
        until("it is computed", async || {
            replicas[0].metric("equipoise_jobs_running").await + replicas[1].metric("equipoise_jobs_running").await
                == count
        })
        .await;
    }
    for replica in replicas {
        assert_eq!(replica.metric("equipoise_jobs_running").await, 2.0, "nginx asks one of them alone");
    }
    asked
}

/// Size of a map that takes a second or more on any number of cores.
const SIDE: u32 = 200;

fn streamed() -> String {
    region(SIDE, "ndjson")
}

#[tokio::test]
async fn what_is_computed_when_a_replica_is_lost_is_computed_by_another() {
    let Some(program) = nginx() else { return };
    let folder = folder("under-way");
    // A stop takes less even on the slowest machine; the computation takes this long even on the fastest.
    // Without kept answers equal requests are computed each for itself.
    let patient = ["--shutdown-time", "60", "--permits", "1", "--answer-cache", "0"];
    let [mut one, two] = ["one", "two"].map(|name| Replica::start(&folder, name, &patient));
    let nginx = Nginx::start(program, &folder, &[&one, &two], |conf| conf).await;
    let mut right = Vec::new();
    for kind in [Ask::get(streamed()), posted_region(SIDE)] {
        right.push(ask(two.address, &kind).await.unwrap());
    }

    // Answers that have begun break off visibly; nginx repeats all others.
    let asked = work_on([&one, &two], &nginx).await;
    one.kill();
    let mut cut = 0;
    for (index, answer) in asked.into_iter().enumerate() {
        match answer.await.unwrap() {
            Ok(answer) => assert_eq!(answer.lasting(), right[index / 2].lasting()),
            Err(Failed::Cut) if index < 2 => cut += 1,
            Err(failed) => panic!("{failed:?}"),
        }
    }
    assert_eq!(cut, 1);
    // The log has a line once the answer is sent.
    let mut again = Vec::new();
    until("nginx has asked another", async || {
        again = asked_again(&nginx);
        !again.is_empty()
    })
    .await;
    assert!(again.len() == 1 && again[0]["method"] == "POST", "{again:?}");

    // A replica that is stopped finishes it.
    one.again();
    let asked = work_on([&one, &two], &nginx).await;
    one.stop();
    for (index, answer) in asked.into_iter().enumerate() {
        assert_eq!(answer.await.unwrap().expect("nothing breaks off").lasting(), right[index / 2].lasting());
    }
    assert_eq!(one.end().await, Some(0));
    say(
        "ok    replicas: long work on both: of one killed, a POST was computed by the other and a stream broke off, which could be seen; of one \
         stopped, all arrived whole",
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_replica_that_is_killed_or_stopped_is_missed_by_nobody() {
    let Some(program) = nginx() else { return };
    let folder = folder("loss");
    // More than the slowest machine can send.
    let patient = ["--shutdown-time", "60", "--queue", "1000", "--queue-time", "60"];
    let mut one = Replica::start(&folder, "one", &patient);
    let mut two = Replica::start(&folder, "two", &patient);
    let nginx = Nginx::start(program, &folder, &[&one, &two], |conf| conf).await;
    let address = nginx.address;
    let mut expected = Vec::new();
    for kind in kinds() {
        let answer = ask(one.address, &kind).await.unwrap();
        expected.push((kind, answer));
    }
    let queries = ["case-1", "triangle-polygon", "case-5", "point-mass"]
        .map(|preset| format!("preset={preset}&speed=2&epoch_ms={}", now_ms()));
    let follow = |count| -> Vec<_> {
        let over = |index: usize| if index % 8 < 4 { Over::WebSocket } else { Over::Events };
        (0..count).map(|index| Follower::start(address, &queries[index % queries.len()], over(index))).collect()
    };
    let mut followers = follow(96);
    let load = Load::start(address, &Arc::new(expected), 4);
    all_hear(&followers, 3).await;
    load.more(100).await;

    // Kill it at random moments, several times.
    let (mut moved, mut worst) = (0, 0);
    for _ in 0..KILLS {
        let before = breaks(&followers);
        one.kill();
        load.more(100).await;
        all_hear(&followers, 3).await;
        let lost: Vec<_> = breaks(&followers).iter().zip(&before).map(|(after, before)| after - before).collect();
        worst = worst.max(*lost.iter().max().unwrap());
        moved += lost.iter().sum::<usize>();
        // It comes back and gets its share again.
        let logged = one.log().len();
        one.again();
        until("it is asked again", async || one.log().len() > logged + 20).await;
        let more = follow(8);
        all_hear(&more, 3).await;
        assert!(one.metric("equipoise_live_sessions").await >= 4.0);
        followers.extend(more);
    }
    assert_eq!(worst, 1, "once is enough to come back");
    let asked = load.asked();
    say(format_args!(
        "ok    replicas: one of two killed {KILLS} times under {asked} requests: 0 errors, {} broke off half sent; live clients came back {moved} \
         times, {} refused on the way; at most {:.2} s without an impact",
        load.cut(),
        refused(&followers),
        silence(&followers).as_secs_f64(),
    ));

    let (before, cut, refused_before) = (breaks(&followers), load.cut(), refused(&followers));
    two.stop();
    assert_eq!(two.end().await, Some(0));
    load.more(100).await;
    all_hear(&followers, 3).await;
    assert_eq!(load.cut(), cut, "an answer broke off");
    let lost: Vec<_> = breaks(&followers).iter().zip(&before).map(|(after, before)| after - before).collect();
    assert_eq!(lost.iter().max(), Some(&1));
    let stopped = load.asked() - asked;
    load.end().await;

    // No client misses an impact or gets one twice, and all get the same ones.
    let (mut impacts, mut runs) = (0, vec![Vec::new(); queries.len()]);
    for (index, follower) in followers.iter().enumerate() {
        let heard = follower.heard();
        impacts += heard.rows.len();
        assert_eq!(numbers(&heard.rows), (1..=heard.rows.len() as u64).collect::<Vec<_>>(), "a gap, or one twice");
        let run = &mut runs[index % queries.len()];
        let common = run.len().min(heard.rows.len());
        assert_eq!(heard.rows[..common], run[..common]);
        if run.is_empty() {
            *run = heard.rows.clone();
        }
    }
    say(format_args!(
        "ok    replicas: one of two stopped under {stopped} requests: 0 errors, 0 broke off; live clients came back {} times, {} refused on the \
         way. In all {} clients heard {impacts} impacts, 0 gaps, 0 twice; nginx asked another replica {} times",
        lost.iter().sum::<usize>(),
        refused(&followers) - refused_before,
        followers.len(),
        asked_again(&nginx).len(),
    ));
}

/// Number of kills.
const KILLS: usize = 5;

fn refused(followers: &[Follower]) -> usize {
    followers.iter().map(|follower| follower.heard().refused).sum()
}

fn silence(followers: &[Follower]) -> Duration {
    followers.iter().map(|follower| follower.heard().silence).max().unwrap()
}

/// Requests that nginx sent to more than one replica.
fn asked_again(nginx: &Nginx) -> Vec<Value> {
    nginx.log().into_iter().filter(|line| line["replicas"].as_str().unwrap().contains(", ")).collect()
}
