//! One connection's socket, and who is at its other end: a client that has gone, or one that has only said all it has to say.
//!
//! Both have closed their sending half, so to the server they look alike. `nc -N` and many scripts close it with their request and wait
//! for the answer; a client that has gone takes nothing any more. Only bytes tell them apart: a system answers those to a connection
//! that its program has left with a reset. So while an answer is made for such a client, bytes go out that stand before it in any
//! case, one at a time: the first ones of its status line, and between two pieces of a body that is sent piece by piece zeros before
//! the size of the next one (RFC 9112, section 7.1). What the client reads is the answer that it would have read.
//!
//! The first byte goes out at once, the next ones ever later: who has gone is known by the time that a byte takes to get there
//! and a reset to come back, and who goes later by three times the time since it closed its half. There is no byte
//! to send when all of these have been; nor between the pieces of an answer of HTTP/1.0. Then the next piece, or the answer, tells.

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

/// Event that says that the client has closed its sending half, as closely as the system tells. Linux tells it from bytes that wait
/// to be read, as a next request does.
#[cfg(target_os = "linux")]
const CLOSED: Interest = Interest::PRIORITY;
#[cfg(not(target_os = "linux"))]
const CLOSED: Interest = Interest::READABLE;

/// The sending half of a connection, and how far it is with the answer.
#[derive(Debug)]
pub(crate) struct ClientSocket {
    socket: OwnedWriteHalf,
    state: Mutex<SendState>,
}

#[derive(Debug)]
struct SendState {
    expected: Expected,
    /// True if the HTTP library has written all that it had.
    is_flushed: bool,
    /// Bytes of the status line that went out ahead of it.
    sent_ahead: usize,
    /// Zeros that went out ahead of the size of a chunk.
    zeros: usize,
    /// Number of writes.
    writes: u64,
    /// Status of a bare error that the HTTP library wanted to write.
    bare_error: Option<StatusCode>,
}

/// What the client waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Expected {
    /// Nothing, or the rest of an answer that is made.
    Nothing,
    /// An answer, whose status line begins so.
    Head(&'static [u8]),
    /// The next chunk of one.
    Chunk,
    /// The next bytes of one whose end is the connection's.
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

    /// An answer is being made.
    pub(crate) fn start_response(&self, version: Version) {
        self.expect(Expected::Head(if version == Version::HTTP_10 { b"HTTP/1.0 " } else { b"HTTP/1.1 " }));
    }

    /// An answer is made, or its pieces will be while it is sent.
    pub(crate) fn send_response(self: &Arc<Self>, version: Version, answer: Response<Body>) -> Response<Body> {
        if answer.body().size_hint().exact().is_some() {
            self.expect(Expected::Nothing);
            return answer;
        }
        self.expect(if version == Version::HTTP_10 { Expected::Bytes } else { Expected::Chunk });
        let client = self.clone();
        answer.map(|body| Body::new(TrackedBody { body, client }))
    }

    /// Writes what the HTTP library has to write, but for what went out ahead of it.
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

    /// Notes that the HTTP library has written all that it had.
    pub(crate) fn flushed(&self) {
        self.state().is_flushed = true;
    }

    /// Keeps a bare error from being written: [`ClientSocket::bare_error`] is asked for it when the connection has ended, and it is known
    /// what was wrong.
    pub(crate) fn withhold(&self, status: StatusCode) {
        self.state().bare_error = Some(status);
    }

    pub(crate) fn bare_error(&self) -> Option<StatusCode> {
        self.state().bare_error
    }

    /// Writes an answer at the end of a connection. Gives up after `time`.
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
        // Nobody is left to tell that it failed.
        let _ = timeout(time, writing).await;
    }

    pub(crate) fn shutdown(&self) -> io::Result<()> {
        match shutdown(self.socket.as_ref(), Shutdown::Write) {
            // The client was faster.
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

    /// Sends a byte that stands before what comes, if there is one left, unless something has been written since `writes`.
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
            // Bytes wait already for a client that takes none.
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

/// Drives a connection to its end, which it gives, or until its client has gone while it waits for an answer. What is worked on for
/// the client is dropped with the connection.
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

/// A body that is made piece by piece while it is sent.
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

/// Its last piece is made, or nobody wants it.
impl Drop for TrackedBody {
    fn drop(&mut self) {
        self.client.expect(Expected::Nothing);
    }
}
