//! Clients that ask for the same answer at the same time share one computation, over real connections: it is done once, and it lasts as
//! long as one of them waits.

use std::net::SocketAddr;

use crate::support::socket;
use equipoise::api::App;
use equipoise::config::Config;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::timeout;

/// Work of some seconds, which counts its bounces on the way.
const TARGET: &str = "/v1/regions?preset=case-1&bounces=2000&x.field=release.theta&x.from=-1&x.to=1&x.count=300&y.field=table.tilt_gain&y.from=1&y.to=1.4&y.count=300";

/// Addresses of two clients, told by a trusted proxy.
const CLIENTS: [&str; 2] = ["192.0.2.1", "198.51.100.2"];

/// A server that believes this machine who its clients are.
async fn start() -> (App, SocketAddr) {
    socket::start_with(&Config { trust_proxy: vec!["127.0.0.1".parse().unwrap()], ..Config::default() }).await
}

/// A request of a client on a connection of its own.
async fn ask(address: SocketAddr, client: &str) -> TcpStream {
    let mut stream = TcpStream::connect(address).await.unwrap();
    let head =
        format!("GET {TARGET} HTTP/1.1\r\nhost: localhost\r\nx-forwarded-for: {client}\r\nconnection: close\r\n\r\n");
    stream.write_all(head.as_bytes()).await.unwrap();
    stream
}

/// A request of a client for another region, of the same size.
async fn ask_for_another(address: SocketAddr, client: &str, number: usize) -> TcpStream {
    let mut stream = TcpStream::connect(address).await.unwrap();
    let target = TARGET.replace("y.to=1.4", &format!("y.to=1.{}", 41 + number));
    let head =
        format!("GET {target} HTTP/1.1\r\nhost: localhost\r\nx-forwarded-for: {client}\r\nconnection: close\r\n\r\n");
    stream.write_all(head.as_bytes()).await.unwrap();
    stream
}

/// Body of the answer, which has to be a 200 of the announced length.
async fn answer(mut stream: TcpStream) -> String {
    let mut text = String::new();
    timeout(6 * socket::SOON, stream.read_to_string(&mut text)).await.expect("an answer").unwrap();
    let (head, body) = text.split_once("\r\n\r\n").unwrap();
    assert!(head.starts_with("HTTP/1.1 200 "), "{head}");
    assert!(head.contains(&format!("content-length: {}\r\n", body.len())), "{head}");
    body.to_owned()
}

/// Waits until the metrics of a server are so.
async fn until(what: &str, is_so: impl Fn() -> bool) {
    let waiting = async {
        while !is_so() {
            tokio::task::yield_now().await;
        }
    };
    timeout(socket::SOON, waiting).await.unwrap_or_else(|_| panic!("{what}"));
}

/// Two clients that wait for one computation: their connections in the order of their requests.
async fn joined(app: &App, address: SocketAddr) -> [TcpStream; 2] {
    let counts = app.answers.counts();
    let first = ask(address, CLIENTS[0]).await;
    // Others join work that has left the queue.
    until("the work begins", || app.metrics.bounces.get() > 0).await;
    let second = ask(address, CLIENTS[1]).await;
    until("the second client joins", || counts.joined.get() + counts.misses.get() == 2).await;
    assert_eq!((counts.misses.get(), counts.joined.get()), (1, 1));
    [first, second]
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn either_client_may_leave_and_the_other_gets_the_answer() {
    let mut answers = Vec::new();
    for leaves in 0..2 {
        let (app, address) = start().await;
        let mut clients = joined(&app, address).await.map(Some);
        drop(clients[leaves].take());
        let [stays] = clients.into_iter().flatten().collect::<Vec<_>>().try_into().unwrap();
        answers.push((answer(stays).await, app.metrics.bounces.get()));
        let counts = app.answers.counts();
        assert_eq!((counts.hits.get(), counts.misses.get(), counts.joined.get()), (0, 1, 1));
    }
    // Both ran to the end, and neither began again.
    assert!(answers[0] == answers[1]);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn work_ends_when_both_clients_have_left() {
    let (app, address) = start().await;
    drop(joined(&app, address).await);
    until("the work ends", || app.pool.running().get() == 0).await;
    let counts = app.answers.counts();
    assert_eq!((counts.misses.get(), counts.joined.get(), counts.bytes.get()), (1, 1, 0));
}

/// The first client has many regions under way, and the second one waits for one of them, the last: it gets half of all blocks, not the
/// last place among those of the first.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn who_joins_does_not_wait_behind_the_other_work_of_the_first_client() {
    const OTHERS: usize = 6;
    let mut attempts = 0;
    let (app, address, [first, second], others) = loop {
        let (app, address) = start().await;
        let mut others = Vec::new();
        for number in 0..OTHERS {
            others.push(ask_for_another(address, CLIENTS[0], number).await);
            until("it is under way", || app.pool.running().get() == number as i64 + 1).await;
        }
        let first = ask(address, CLIENTS[0]).await;
        until("it is under way", || app.pool.running().get() == OTHERS as i64 + 1).await;
        let second = ask(address, CLIENTS[1]).await;
        let counts = app.answers.counts();
        let asked = || counts.joined.get() + counts.misses.get() == OTHERS as u64 + 2;
        until("the second client asks", asked).await;
        if counts.joined.get() == 1 {
            break (app, address, [first, second], others);
        }
        // Its worker had not begun yet, and others join only then.
        attempts += 1;
        assert!(attempts < 10, "the second client never joins");
    };
    let (begun, first, second) = (app.metrics.bounces.get(), answer(first), answer(second));
    let (first, second) = tokio::join!(first, second);
    let until_joined = app.metrics.bounces.get() - begun;
    assert!(first == second);
    drop(others);
    until("the others end", || app.pool.running().get() == 0).await;
    let alone = app.metrics.bounces.get();
    answer(ask_for_another(address, CLIENTS[1], OTHERS).await).await;
    let alone = app.metrics.bounces.get() - alone;
    // In its turn among seven the joined region would end with the others, after six times as many bounces.
    assert!(until_joined < 4 * alone, "{until_joined} bounces until it was done, {alone} of its own");
}
