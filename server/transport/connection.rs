//! The bytes of a connection, with two additions to the HTTP library: a full answer to input that is not HTTP, and a time limit for
//! clients that do not read.

use std::future::poll_fn;
use std::io;
use std::io::IoSlice;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, ready};
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes, HttpBody};
use axum::http::{Response, StatusCode, Version, header};
use axum::response::IntoResponse;
use http_body::{Frame, SizeHint};
use rustix::net::{Shutdown, shutdown};
use tokio::io::{AsyncRead, AsyncWrite, Interest, ReadBuf};
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};
use tokio::time::{Sleep, sleep, timeout};

use crate::http::{Problem, transfer};
use crate::limits;
use crate::middleware::add_common_headers;
use crate::transport::connection_slots::ConnectionSlot;

/// A stream that holds back bare errors and gives up on a client that does not read.
#[derive(Debug)]
pub(crate) struct GuardedStream {
    socket: OwnedReadHalf,
    client: Arc<ClientSocket>,
    slot: Arc<ConnectionSlot>,
    /// Time limit while the socket accepts too little, and the bytes accepted since.
    stall: Option<(Pin<Box<Sleep>>, usize)>,
    stall_time: Duration,
    request_line: RequestLine,
}

/// Length of the line with which the bytes since the last answer begin.
#[derive(Debug, Default)]
struct RequestLine {
    bytes: usize,
    has_ended: bool,
}

impl RequestLine {
    fn read(&mut self, bytes: &[u8]) {
        if !self.has_ended {
            let end = bytes.iter().position(|byte| *byte == b'\n');
            self.bytes += end.unwrap_or(bytes.len());
            self.has_ended = end.is_some();
        }
    }

    /// True if the URL in it is longer than the limit: the rest of the line is short.
    fn is_too_long(&self) -> bool {
        self.bytes > limits::URL_BYTES + limits::METHOD_AND_VERSION_BYTES
    }
}

impl GuardedStream {
    pub(crate) fn new(
        socket: OwnedReadHalf,
        client: Arc<ClientSocket>,
        slot: Arc<ConnectionSlot>,
        stall_time: Duration,
    ) -> Self {
        Self { socket, client, slot, stall: None, stall_time, request_line: RequestLine::default() }
    }

    fn poll_socket(&mut self, context: &mut Context<'_>, buffers: &[IoSlice<'_>]) -> Poll<io::Result<usize>> {
        let written = self.client.poll_write(context, buffers);
        if let Poll::Ready(written) = written {
            self.slot.touch();
            self.request_line = RequestLine::default();
            let (took, offered) =
                (*written.as_ref().unwrap_or(&0), buffers.iter().map(|part| part.len()).sum::<usize>());
            // A client that reads a byte now and then is as slow as one that reads none.
            self.stall = self.stall.take().map(|(stall, guard)| (stall, guard + took));
            self.stall.take_if(|(_, guard)| took == offered || *guard >= limits::STALL_BYTES);
            return Poll::Ready(written);
        }
        let time = self.stall_time;
        let (stall, _) = self.stall.get_or_insert_with(|| (Box::pin(sleep(time)), 0));
        stall.as_mut().poll(context).map(|()| Err(io::ErrorKind::TimedOut.into()))
    }
}

impl AsyncWrite for GuardedStream {
    fn poll_write(self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        self.poll_write_vectored(context, &[IoSlice::new(bytes)])
    }

    fn poll_write_vectored(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffers: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let this = self.get_mut();
        if let Some(status) = buffers.first().and_then(|head| bare_error(head)) {
            // The library counts the bytes of a whole head before it looks at the URL.
            let is_long_url = status == StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE && this.request_line.is_too_long();
            this.client.withhold(if is_long_url { StatusCode::URI_TOO_LONG } else { status });
            // For the library it counts as written.
            return Poll::Ready(Ok(buffers.iter().map(|buffer| buffer.len()).sum()));
        }
        this.poll_socket(context, buffers)
    }

    fn is_write_vectored(&self) -> bool {
        true
    }

    fn poll_flush(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.client.flushed();
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<io::Result<()>> {
        // After a bare error there is still an answer to send.
        Poll::Ready(if self.client.bare_error().is_some() { Ok(()) } else { self.client.shutdown() })
    }
}

impl AsyncRead for GuardedStream {
    fn poll_read(mut self: Pin<&mut Self>, context: &mut Context<'_>, into: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        let before = into.filled().len();
        let polled = Pin::new(&mut self.socket).poll_read(context, into);
        if into.filled().len() > before {
            self.slot.touch();
            self.request_line.read(&into.filled()[before..]);
        }
        polled
    }
}

/// The library's words for a request whose last transfer coding is not `chunked`; otherwise it treats it like any bad request.
const UNKNOWN_CODING: &str = "invalid transfer-encoding parsed";

/// Status of an error that the HTTP library answers by itself: a head without a body, and without the header that all answers of
/// this server have.
fn bare_error(head: &[u8]) -> Option<StatusCode> {
    let status = head.strip_prefix(b"HTTP/1.1 ").or_else(|| head.strip_prefix(b"HTTP/1.0 "))?.get(..3)?;
    let status = StatusCode::from_bytes(status).ok().filter(StatusCode::is_client_error)?;
    let text = std::str::from_utf8(head).ok()?;
    let is_bare =
        text.ends_with("\r\n\r\n") && text.contains("content-length: 0\r\n") && !text.contains("equipoise-build");
    is_bare.then_some(status)
}

/// The full answer, head and body, in place of a bare error. `error` is the reason why the library has ended the connection.
pub(crate) fn full_error_response(status: StatusCode, error: &hyper::Error) -> Vec<u8> {
    let problem = match status {
        _ if error.to_string() == UNKNOWN_CODING => transfer::not_implemented(None),
        StatusCode::URI_TOO_LONG => Problem::url_too_long(format_args!("more than {}", limits::URL_BYTES)),
        StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE => {
            let (headers, bytes) = (limits::HEADERS, limits::HEAD_BYTES);
            Problem::other(status, format!("the request head is over the limit of {headers} headers or {bytes} bytes"))
        }
        _ => Problem::other(status, "the request is not valid HTTP/1.1"),
    };
    let (status, body) = (problem.status(), problem.to_json());
    let mut response = problem.into_response();
    add_common_headers(response.headers_mut());
    let mut answer =
        format!("HTTP/1.1 {status}\r\nconnection: close\r\ncontent-length: {}\r\n", body.len()).into_bytes();
    response.headers_mut().remove(header::CONNECTION);
    for (name, value) in response.headers() {
        for part in [name.as_str().as_bytes(), b": ", value.as_bytes(), b"\r\n"] {
            answer.extend_from_slice(part);
        }
    }
    answer.extend_from_slice(b"\r\n");
    answer.extend_from_slice(&body);
    answer
}

// The sending half of one connection, and whether its client is still there.
//
// A client that has gone and a client that has only finished sending look alike: both have closed their sending half. `nc -N` and
// many scripts close it with their request and wait for the answer. Only bytes tell them apart: to a connection whose program has
// gone, the client's system answers them with a reset. So while such a client waits, the server sends bytes ahead that come next
// in any case, one at a time: the first bytes of the status line, or, between two pieces of a body, zeros before the size of the
// next chunk (RFC 9112, section 7.1). The client reads the same answer as without them.
//
// The first byte goes out at once, the next ones ever later. So a client that has gone is detected within a round trip, and one
// that goes later within three times the time since it closed its half. There is no byte to send once all of these are out, or
// between the pieces of an HTTP/1.0 answer. Then the next piece, or the answer, detects it.

/// Event of a client that closes its sending half. On Linux it is distinct from bytes that wait to be read, such as a next request.
#[cfg(target_os = "linux")]
const CLOSED: Interest = Interest::PRIORITY;
#[cfg(not(target_os = "linux"))]
const CLOSED: Interest = Interest::READABLE;

/// The sending half of a connection, and the state of the answer.
#[derive(Debug)]
pub(crate) struct ClientSocket {
    socket: OwnedWriteHalf,
    state: Mutex<SendState>,
}

#[derive(Debug)]
struct SendState {
    expected: Expected,
    /// True if the HTTP library has written all it had.
    is_flushed: bool,
    /// Bytes of the status line that were sent ahead.
    sent_ahead: usize,
    /// Zeros that were sent ahead of the size of a chunk.
    zeros: usize,
    /// Number of writes.
    writes: u64,
    /// Status of a bare error that the HTTP library would have written.
    bare_error: Option<StatusCode>,
}

/// The next bytes that the client waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Expected {
    /// None, or the rest of a complete answer.
    Nothing,
    /// A status line that begins with these bytes.
    Head(&'static [u8]),
    /// The next chunk of an answer.
    Chunk,
    /// More bytes of an answer that ends with the connection.
    Bytes,
}

impl ClientSocket {
    pub(crate) fn new(socket: OwnedWriteHalf) -> Arc<Self> {
        let state = SendState {
            expected: Expected::Nothing,
            is_flushed: true,
            sent_ahead: 0,
            zeros: 0,
            writes: 0,
            bare_error: None,
        };
        Arc::new(Self { socket, state: Mutex::new(state) })
    }

    fn state(&self) -> MutexGuard<'_, SendState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn expect(&self, expected: Expected) {
        self.state().expected = expected;
    }

    /// Notes that an answer is being computed.
    pub(crate) fn start_response(&self, version: Version) {
        self.expect(Expected::Head(if version == Version::HTTP_10 { b"HTTP/1.0 " } else { b"HTTP/1.1 " }));
    }

    /// Notes that an answer is complete, or will be sent piece by piece.
    pub(crate) fn send_response(self: &Arc<Self>, version: Version, answer: Response<Body>) -> Response<Body> {
        if answer.body().size_hint().exact().is_some() {
            self.expect(Expected::Nothing);
            return answer;
        }
        self.expect(if version == Version::HTTP_10 { Expected::Bytes } else { Expected::Chunk });
        let client = self.clone();
        answer.map(|body| Body::new(TrackedBody { body, client }))
    }

    /// Writes the bytes of the HTTP library, without those that were sent ahead.
    pub(crate) fn poll_write(&self, context: &mut Context<'_>, buffers: &[IoSlice<'_>]) -> Poll<io::Result<usize>> {
        let mut state = self.state();
        state.is_flushed = false;
        let sent_ahead = state.sent_ahead;
        let mut cut;
        let mut rest = buffers;
        if sent_ahead > 0 {
            cut = buffers.to_vec();
            let mut after = cut.as_mut_slice();
            IoSlice::advance_slices(&mut after, sent_ahead);
            rest = after;
        }
        loop {
            ready!(self.socket.as_ref().poll_write_ready(context))?;
            match self.socket.try_write_vectored(rest) {
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => return Poll::Ready(Err(error)),
                Ok(written) => {
                    (state.sent_ahead, state.zeros) = (0, 0);
                    state.writes += 1;
                    return Poll::Ready(Ok(sent_ahead + written));
                }
            }
        }
    }

    /// Notes that the HTTP library has written all it had.
    pub(crate) fn flushed(&self) {
        self.state().is_flushed = true;
    }

    /// Holds back a bare error. It is answered in full when the connection has ended and the reason is known.
    pub(crate) fn withhold(&self, status: StatusCode) {
        self.state().bare_error = Some(status);
    }

    pub(crate) fn bare_error(&self) -> Option<StatusCode> {
        self.state().bare_error
    }

    /// Writes the last answer of a connection. Gives up after `time`.
    pub(crate) async fn send_last(&self, mut answer: &[u8], time: Duration) {
        let writing = async {
            while !answer.is_empty() {
                self.socket.writable().await?;
                match self.socket.try_write(answer) {
                    Ok(written) => answer = &answer[written..],
                    Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                    Err(error) => return Err(error),
                }
            }
            self.shutdown()
        };
        // If it fails, there is nobody to tell.
        let _ = timeout(time, writing).await;
    }

    pub(crate) fn shutdown(&self) -> io::Result<()> {
        match shutdown(self.socket.as_ref(), Shutdown::Write) {
            // The client has closed the connection first.
            Err(rustix::io::Errno::NOTCONN) => Ok(()),
            done => done.map_err(Into::into),
        }
    }

    /// Waits until the client has closed its sending half.
    async fn half_closed(&self) -> io::Result<()> {
        while !self.socket.ready(CLOSED).await?.is_read_closed() {
            sleep(limits::PRESENCE_TIME).await;
        }
        Ok(())
    }

    /// Sends the next probe byte, if there is one, unless something has been written since `writes`.
    fn probe(&self, writes: &mut Option<u64>) -> io::Result<()> {
        let mut state = self.state();
        if writes.replace(state.writes).is_some_and(|before| before != state.writes) || !state.is_flushed {
            return Ok(());
        }
        let next = match state.expected {
            Expected::Head(line) => line.get(state.sent_ahead..=state.sent_ahead),
            Expected::Chunk if state.zeros < limits::PRESENCE_ZEROS => Some(b"0".as_slice()),
            Expected::Chunk | Expected::Bytes | Expected::Nothing => None,
        };
        let Some(byte) = next else { return Ok(()) };
        match self.socket.try_write(byte) {
            Ok(written) if state.expected == Expected::Chunk => state.zeros += written,
            Ok(written) => state.sent_ahead += written,
            // The client already has unread bytes.
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// Waits until the client has gone.
    async fn wait_until_gone(self: Arc<Self>) {
        if self.half_closed().await.is_err() {
            return;
        }
        let begin = Instant::now();
        let mut writes = None;
        while self.probe(&mut writes).is_ok() {
            let next = limits::PRESENCE_TIME.max(2 * begin.elapsed());
            tokio::select! {
                biased;
                // A reset.
                _ = self.socket.ready(Interest::ERROR) => return,
                () = sleep(next) => {}
            }
        }
    }
}

/// Drives a connection to its end and returns its result, or None as soon as the client has gone while it waits for an answer.
/// Dropping the connection cancels the work for it.
pub(crate) async fn until_client_leaves<C: Future>(
    mut connection: Pin<&mut C>,
    client: &Arc<ClientSocket>,
) -> Option<C::Output> {
    let mut look = None;
    let driven = poll_fn(|context| {
        if let Poll::Ready(ended) = connection.as_mut().poll(context) {
            return Poll::Ready(Some(ended));
        }
        if client.state().expected == Expected::Nothing {
            look = None;
            return Poll::Pending;
        }
        let look = look.get_or_insert_with(|| Box::pin(client.clone().wait_until_gone()));
        look.as_mut().poll(context).map(|()| None)
    });
    driven.await
}

/// A body that is sent while it is made.
struct TrackedBody {
    body: Body,
    client: Arc<ClientSocket>,
}

impl HttpBody for TrackedBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

/// The last piece is made, or the client has gone.
impl Drop for TrackedBody {
    fn drop(&mut self) {
        self.client.expect(Expected::Nothing);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_bare_errors_are_replaced() {
        let bare = b"HTTP/1.1 400 Bad Request\r\nconnection: close\r\ncontent-length: 0\r\ndate: x\r\n\r\n";
        assert_eq!(bare_error(bare), Some(StatusCode::BAD_REQUEST));
        let own = b"HTTP/1.1 404 Not Found\r\ncontent-length: 0\r\nequipoise-build: 1\r\n\r\n";
        assert_eq!(bare_error(own), None);
        assert_eq!(bare_error(b"HTTP/1.1 200 OK\r\ncontent-length: 0\r\n\r\n"), None);
        assert_eq!(bare_error(b"HTTP/1.1 400 B\r\ncontent-length: 9\r\n\r\n"), None);
        assert_eq!(bare_error(b"{\"t\":[1,2]}"), None);
    }
}
