//! The bytes of a connection, with two additions to the HTTP library: a full answer to input that is not HTTP, and a time limit for
//! clients that do not read.

use std::io::{self, IoSlice};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::http::{StatusCode, header};
use axum::response::IntoResponse;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::tcp::OwnedReadHalf;
use tokio::time::{Sleep, sleep};

use crate::http::{Problem, transfer};
use crate::limits;
use crate::middleware::add_common_headers;
use crate::transport::client_socket::ClientSocket;
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
