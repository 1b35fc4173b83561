//! The sending half of one connection, and whether its client is still there.
//!
//! A client that has gone and a client that has only finished sending look alike: both have closed their sending half. `nc -N` and
//! many scripts close it with their request and wait for the answer. Only bytes tell them apart: to a connection whose program has
//! gone, the client's system answers them with a reset. So while such a client waits, the server sends bytes ahead that come next
//! in any case, one at a time: the first bytes of the status line, or, between two pieces of a body, zeros before the size of the
//! next chunk (RFC 9112, section 7.1). The client reads the same answer as without them.
//!
//! The first byte goes out at once, the next ones ever later. So a client that has gone is detected within a round trip, and one
//! that goes later within three times the time since it closed its half. There is no byte to send once all of these are out, or
//! between the pieces of an HTTP/1.0 answer. Then the next piece, or the answer, detects it.

use std::future::poll_fn;
use std::io::{self, IoSlice};
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, ready};
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes, HttpBody};
use axum::http::{Response, StatusCode, Version};
use http_body::{Frame, SizeHint};
use rustix::net::{Shutdown, shutdown};
use tokio::io::Interest;
use tokio::net::tcp::OwnedWriteHalf;
use tokio::time::{sleep, timeout};

use crate::limits;

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
