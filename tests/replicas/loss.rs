//! Replicas that are killed, restarted and stopped under load and with many live runs.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use serde_json::Value;
use tokio::task::JoinHandle;

use crate::asking::{Answer, Ask, Failed, ask, begin};
use crate::following::{Follower, Over};
use crate::programs::{Nginx, Replica, folder, until};
use crate::support::socket::{now_ms, numbers};
use crate::{kinds, nginx, posted_region, region, say};

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
