//! Connections: accepts them, bounds them, and lets them finish when the server stops.

mod connection_slots;

mod connection;

use std::convert::Infallible;
use std::io;
use std::net::SocketAddr;
use std::pin::pin;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::extract::ConnectInfo;
use axum::http::Request;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::time::{sleep, timeout};
use tower::ServiceExt;

use crate::compute::Peer;
use crate::limits;
use crate::limits::Limits;
use crate::transport::connection::{ClientSocket, GuardedStream, full_error_response, until_client_leaves};
use crate::transport::connection_slots::{ConnectionSlots, RequestBody};

/// Serves until `stop`, then waits for unfinished answers for a bounded time.
pub async fn serve(listener: TcpListener, router: Router, limits: &Limits, stop: impl Future<Output = ()>) {
    let slots = ConnectionSlots::new(limits.connections);
    let (closing, _) = watch::channel(false);
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new())
        .header_read_timeout(limits.head_time)
        // `connection` finds out whether a client that has closed its sending half is still there.
        .half_close(true)
        // The buffer alone is no limit: it grows by doubling, and a longer head that arrives at once fits into it.
        .max_header_size(limits::HEAD_BYTES)
        .max_buf_size(limits::HEAD_BYTES)
        .max_headers(limits::HEADERS);
    let mut stop = pin!(stop);
    loop {
        let next = async {
            let (socket, from) = accept(&listener).await;
            let peer = Peer::from(from);
            (socket, from, peer, slots.acquire(peer).await)
        };
        let (socket, from, peer, guard) = tokio::select! {
            next = next => next,
            () = &mut stop => break,
        };
        let (receiving, sending) = socket.into_split();
        let client = ClientSocket::new(sending);
        let stream = GuardedStream::new(receiving, client.clone(), guard.slot().clone(), limits.stall_time);
        let (router, slot, answering) = (router.clone(), guard.slot().clone(), client.clone());
        let service = service_fn(move |mut request: Request<Incoming>| {
            let extensions = request.extensions_mut();
            extensions.insert(peer);
            extensions.insert(ConnectInfo(from));
            let (router, slot, client) = (router.clone(), slot.clone(), answering.clone());
            async move {
                let version = request.version();
                slot.set_answering(true);
                client.start_response(version);
                let request = request.map(|body| Body::new(RequestBody::new(body, slot.clone())));
                let answer = router.oneshot(request).await;
                slot.set_answering(false);
                Ok::<_, Infallible>(client.send_response(version, answer.unwrap_or_else(|never| match never {})))
            }
        });
        let connection = http.serve_connection(TokioIo::new(stream), service).with_upgrades();
        let (mut closing, stall_time) = (closing.subscribe(), limits.stall_time);
        tokio::spawn(async move {
            let mut connection = pin!(connection);
            let closes = async { drop(closing.wait_for(|closing| *closing).await) };
            let ended = tokio::select! {
                ended = until_client_leaves(connection.as_mut(), &client) => ended,
                () = guard.evicted() => return,
                () = closes => {
                    connection.as_mut().graceful_shutdown();
                    until_client_leaves(connection.as_mut(), &client).await
                }
            };
            // Any other error is a client that has gone or broken the protocol; it has got what answer there is.
            if let (Some(Err(error)), Some(status)) = (ended, client.bare_error()) {
                client.send_last(&full_error_response(status, &error), stall_time).await;
            }
        });
    }
    drop(listener);
    closing.send_replace(true);
    let _ = timeout(limits.shutdown_time, slots.all_free()).await;
}

/// Raises the limit of open files as far as possible, and lowers the numbers of connections and live runs to fit it. Returns true
/// if it has lowered them.
pub fn fit_open_files(limits: &mut Limits) -> bool {
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    let raised = setrlimit(Resource::Nofile, Rlimit { current: maximum, maximum }).is_ok();
    // None means no limit.
    let files = if raised { maximum } else { current };
    files.and_then(|files| usize::try_from(files).ok()).is_some_and(|files| fit(limits, files))
}

fn fit(limits: &mut Limits, files: usize) -> bool {
    let files = files.saturating_sub(limits::OTHER_FILES);
    if limits.connections + limits.live_sessions <= files {
        return false;
    }
    // With few files, there are some for both.
    let live_runs = files.saturating_sub(limits.connections).max(files / 4);
    limits.live_sessions = limits.live_sessions.min(live_runs).max(1);
    limits.connections = limits.connections.min(files.saturating_sub(limits.live_sessions)).max(1);
    true
}

async fn accept(listener: &TcpListener) -> (TcpStream, SocketAddr) {
    loop {
        match listener.accept().await {
            Ok((socket, from)) => {
                // Sends the small messages of live runs at once. It fails only on a closed connection.
                let _ = socket.set_nodelay(true);
                return (socket, from);
            }
            Err(error) if is_of_one_connection(&error) => {}
            Err(error) => {
                // Out of file descriptors or memory: an immediate retry would only load a core.
                tracing::error!("cannot accept a connection: {error}");
                sleep(Duration::from_millis(200)).await;
            }
        }
    }
}

fn is_of_one_connection(error: &io::Error) -> bool {
    use io::ErrorKind::{ConnectionAborted, ConnectionRefused, ConnectionReset};
    matches!(error.kind(), ConnectionAborted | ConnectionRefused | ConnectionReset)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::App;
    use crate::compute::{Cancelled, Pool, Price, TimeSlice};
    use crate::config::Config;
    use crate::http::Problem;
    use crate::router::router;
    use axum::routing::get;
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    use tokio::sync::oneshot;

    async fn start() -> (std::net::SocketAddr, oneshot::Sender<()>, tokio::task::JoinHandle<()>) {
        start_with(router(App::new(&Config::default()))).await
    }

    async fn start_with(router: Router) -> (std::net::SocketAddr, oneshot::Sender<()>, tokio::task::JoinHandle<()>) {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let (stop, stopped) = oneshot::channel();
        let stop_signal = async { drop(stopped.await) };
        let serving = tokio::spawn(async move { serve(listener, router, &Limits::default(), stop_signal).await });
        (address, stop, serving)
    }

    #[tokio::test]
    async fn what_is_not_http_is_told_in_a_problem_too() {
        let (address, _stop, _serving) = start().await;
        let long = format!("GET /{} HTTP/1.1\r\n\r\n", "x".repeat(65_600));
        let many = format!("GET / HTTP/1.1\r\n{}\r\n", "a: b\r\n".repeat(limits::HEADERS + 1));
        for (request, status) in [
            ("nonsense\r\n\r\n", 400),
            ("GET / HTTP/1.1\r\nno colon\r\n\r\n", 400),
            ("HEAD / HTTP/9.9\r\n\r\n", 400),
            (long.as_str(), 414),
            (many.as_str(), 431),
        ] {
            let mut socket = TcpStream::connect(address).await.unwrap();
            socket.write_all(request.as_bytes()).await.unwrap();
            let mut answer = String::new();
            // A server that closes with unread bytes resets the connection, but the client has its answer by then.
            let _ = socket.read_to_string(&mut answer).await;
            let (head, body) = answer.split_once("\r\n\r\n").unwrap();
            assert!(head.starts_with(&format!("HTTP/1.1 {status} ")), "{head}");
            assert!(head.contains("content-type: application/problem+json") && head.contains("equipoise-build: "));
            assert!(head.contains(&format!("content-length: {}", body.len())));
            let problem: serde_json::Value = serde_json::from_str(body).unwrap();
            assert_eq!(problem["status"], status);
        }
    }

    #[tokio::test]
    async fn a_head_has_as_many_bytes_as_the_message_says() {
        let (address, _stop, _serving) = start().await;
        let rest = "GET /health/live HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\na: \r\n\r\n".len();
        let of_bytes = |bytes: usize| {
            let value = "x".repeat(bytes - rest);
            format!("GET /health/live HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\na: {value}\r\n\r\n")
        };
        let long_url = |bytes: usize| format!("GET /{} HTTP/1.1\r\nhost: localhost\r\n\r\n", "x".repeat(bytes));
        let too_large = "over the limit of 100 headers or 65536 bytes";
        let too_long = "more than 8192 bytes of path and query";
        for (request, status, words) in [
            (of_bytes(65_000), 200, "ok"),
            (of_bytes(limits::HEAD_BYTES), 200, "ok"),
            (of_bytes(limits::HEAD_BYTES + 1), 431, too_large),
            (of_bytes(66_000), 431, too_large),
            (of_bytes(90_000), 431, too_large),
            (of_bytes(1_000_000), 431, too_large),
            (long_url(66_000), 414, too_long),
            (long_url(90_000), 414, too_long),
            (long_url(1_000_000), 414, too_long),
        ] {
            // In one piece, in small pieces, and after another request on the same connection.
            for (pieces, before) in [(1, ""), (40, ""), (2, "GET /health/live HTTP/1.1\r\nhost: localhost\r\n\r\n")] {
                let mut socket = TcpStream::connect(address).await.unwrap();
                if !before.is_empty() {
                    socket.write_all(before.as_bytes()).await.unwrap();
                    let mut answer = Vec::new();
                    while !answer.ends_with(b"}") && !answer.ends_with(b"ok\n") && !answer.ends_with(b"ok") {
                        assert_ne!(socket.read_buf(&mut answer).await.unwrap(), 0);
                    }
                }
                for piece in request.as_bytes().chunks(request.len().div_ceil(pieces)) {
                    // The server may answer before it has read all.
                    let _ = socket.write_all(piece).await;
                    tokio::task::yield_now().await;
                }
                let mut answer = String::new();
                let _ = socket.read_to_string(&mut answer).await;
                assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{} bytes: {answer}", request.len());
                assert!(answer.contains(words), "{} bytes: {answer}", request.len());
            }
        }
    }

    #[test]
    fn few_files_are_shared_between_connections_and_live_runs() {
        let fitted = |files| {
            let mut limits = Limits::default();
            fit(&mut limits, files).then_some((limits.connections, limits.live_sessions))
        };
        let Limits { connections, live_sessions, .. } = Limits::default();
        let enough = connections + live_sessions + limits::OTHER_FILES;
        assert_eq!(fitted(enough), None);
        assert_eq!(fitted(enough - 1), Some((connections - 1, live_sessions)));
        assert_eq!(fitted(1024), Some((720, 240)));
        assert_eq!(fitted(0), Some((1, 1)));
    }

    #[tokio::test]
    async fn a_stop_ends_idle_connections_and_accepts_no_more() {
        let (address, stop, serving) = start().await;
        let mut idle = TcpStream::connect(address).await.unwrap();
        idle.write_all(b"GET /health/live HTTP/1.1\r\nhost: localhost\r\n\r\n").await.unwrap();
        let mut answer = [0; 15];
        idle.read_exact(&mut answer).await.unwrap();
        assert_eq!(&answer, b"HTTP/1.1 200 OK");
        stop.send(()).unwrap();
        timeout(Duration::from_secs(2), serving).await.expect("nothing is under way").unwrap();
        assert!(TcpStream::connect(address).await.is_err());
    }

    #[tokio::test]
    async fn a_client_that_goes_away_frees_its_core() {
        let (begun, mut begin) = tokio::sync::mpsc::unbounded_channel();
        let (ended, mut end) = tokio::sync::mpsc::unbounded_channel();
        let pool = Pool::new(1, &Limits::default());
        let work = get(async move || {
            let dear = Price::bounces(limits::INLINE_BOUNCES + 1);
            let endless = move |slice: &TimeSlice| -> Result<String, Problem> {
                begun.send(()).unwrap();
                while slice.should_continue() {
                    std::thread::yield_now();
                }
                ended.send(()).unwrap();
                Err(Cancelled.into())
            };
            pool.run(dear, endless).await
        });
        let (address, _stop, _serving) = start_with(Router::new().route("/", work)).await;
        let mut socket = TcpStream::connect(address).await.unwrap();
        socket.write_all(b"GET / HTTP/1.1\r\nhost: localhost\r\n\r\n").await.unwrap();
        begin.recv().await.unwrap();
        drop(socket);
        timeout(Duration::from_secs(1), end.recv()).await.expect("the work goes on for nobody");
    }
}
