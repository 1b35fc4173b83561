//! A connection's bytes, with two things that the HTTP library leaves out: its own answers to what is not HTTP have no
//! body, and it waits for ever for a client that takes no bytes.

use std::io::{self, IoSlice};
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::http::StatusCode;
use axum::response::IntoResponse;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::time::{Sleep, sleep};

use super::places::Place;
use crate::http::Problem;
use crate::limits;
use crate::middleware::seal;

/// A socket that puts a problem in the place of a bare error, and gives up on a client that does not read.
#[derive(Debug)]
pub(super) struct Stream {
    socket: TcpStream,
    place: Arc<Place>,
    /// What is still to be written in the place of a bare error.
    instead: Option<Vec<u8>>,
    /// Runs while the socket takes too little, and what it has taken since.
    stall: Option<(Pin<Box<Sleep>>, usize)>,
    stall_time: Duration,
}

impl Stream {
    pub(super) fn new(socket: TcpStream, place: Arc<Place>, stall_time: Duration) -> Self {
        Self { socket, place, instead: None, stall: None, stall_time }
    }

    fn poll_socket(&mut self, context: &mut Context<'_>, buffers: &[IoSlice<'_>]) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.socket).poll_write_vectored(context, buffers);
        if let Poll::Ready(written) = written {
            self.place.moved();
            let (took, offered) =
                (*written.as_ref().unwrap_or(&0), buffers.iter().map(|part| part.len()).sum::<usize>());
            // A client that takes a byte now and then is as slow as one that takes none.
            self.stall = self.stall.take().map(|(stall, taken)| (stall, taken + took));
            self.stall.take_if(|(_, taken)| took == offered || *taken >= limits::STALL_BYTES);
            return Poll::Ready(written);
        }
        let time = self.stall_time;
        let (stall, _) = self.stall.get_or_insert_with(|| (Box::pin(sleep(time)), 0));
        stall.as_mut().poll(context).map(|()| Err(io::ErrorKind::TimedOut.into()))
    }
}

impl AsyncWrite for Stream {
    fn poll_write(self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        self.poll_write_vectored(context, &[IoSlice::new(bytes)])
    }

    fn poll_write_vectored(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffers: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let this = self.get_mut();
        if this.instead.is_none() {
            this.instead = buffers.first().and_then(|head| bare_error(head)).map(told);
        }
        let Some(mut rest) = this.instead.take() else {
            return this.poll_socket(context, buffers);
        };
        while !rest.is_empty() {
            match this.poll_socket(context, &[IoSlice::new(&rest)]) {
                Poll::Ready(Ok(0)) => return Poll::Ready(Err(io::ErrorKind::WriteZero.into())),
                Poll::Ready(Ok(written)) => drop(rest.drain(..written)),
                Poll::Ready(Err(error)) => return Poll::Ready(Err(error)),
                Poll::Pending => {
                    this.instead = Some(rest);
                    return Poll::Pending;
                }
            }
        }
        // To the library, its own head has been written.
        Poll::Ready(Ok(buffers.iter().map(|buffer| buffer.len()).sum()))
    }

    fn is_write_vectored(&self) -> bool {
        true
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.socket).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.socket).poll_shutdown(context)
    }
}

impl AsyncRead for Stream {
    fn poll_read(mut self: Pin<&mut Self>, context: &mut Context<'_>, into: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        let before = into.filled().len();
        let polled = Pin::new(&mut self.socket).poll_read(context, into);
        if into.filled().len() > before {
            self.place.moved();
        }
        polled
    }
}

/// The status of an error that the HTTP library answers with by itself: a head without a body, and without the header
/// that all answers of this server have.
fn bare_error(head: &[u8]) -> Option<StatusCode> {
    let status = head.strip_prefix(b"HTTP/1.1 ").or_else(|| head.strip_prefix(b"HTTP/1.0 "))?.get(..3)?;
    let status = StatusCode::from_bytes(status).ok().filter(StatusCode::is_client_error)?;
    let text = std::str::from_utf8(head).ok()?;
    let is_bare =
        text.ends_with("\r\n\r\n") && text.contains("content-length: 0\r\n") && !text.contains("equipoise-build");
    is_bare.then_some(status)
}

/// The whole answer, head and body, that says what the bare error only hints at.
fn told(status: StatusCode) -> Vec<u8> {
    let problem = match status {
        StatusCode::URI_TOO_LONG => Problem::url_too_long("more than 65534"),
        StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE => {
            let (headers, bytes) = (limits::HEADERS, limits::HEAD_BYTES);
            Problem::other(status, format!("the request head is over the limit of {headers} headers or {bytes} bytes"))
        }
        _ => Problem::other(status, "the request is not valid HTTP/1.1"),
    };
    let body = problem.to_json();
    let mut response = problem.into_response();
    seal(response.headers_mut());
    let mut answer =
        format!("HTTP/1.1 {status}\r\nconnection: close\r\ncontent-length: {}\r\n", body.len()).into_bytes();
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
