//! Answers that are sent while they are computed.
//!
//! Computing never waits for the reader. Unread bytes are kept: at most the whole answer, which the price has bounded
//! (`Limits::answer`), accounted to the client (`Limits::held_bytes`). A reader that takes nothing is disconnected after
//! `Limits::stall_time`. So a slow reader holds neither a permit nor a place in the queue. A reader that leaves cancels the work.

use std::io::{self, Write};
use std::panic::AssertUnwindSafe;

use axum::body::{Body, Bytes};
use axum::http::Response;
use flate2::write::GzEncoder;
use futures_util::future::BoxFuture;
use futures_util::{FutureExt, StreamExt, stream};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use crate::compute::{Cancelled, Pool, TimeSlice, TimeSlices};
use crate::http::problem::Problem;
use crate::http::response::answers::Ticket;
use crate::http::response::builder::ok;
use crate::http::response::gzip;
use crate::http::response::negotiate::{Encoding, Format};

/// Receives the bytes of an answer from the work.
#[derive(Debug)]
pub struct BodyWriter {
    to: UnboundedSender<Bytes>,
    gzip: Option<GzEncoder<Vec<u8>>>,
    pool: Pool,
}

impl BodyWriter {
    /// Sends a piece of the answer. Equal pieces give equal bytes, also compressed: each piece can be decompressed at once.
    pub fn send(&mut self, piece: Vec<u8>) {
        if piece.is_empty() {
            return;
        }
        let piece = match &mut self.gzip {
            None => piece,
            Some(gzip) => {
                gzip.write_all(&piece).and_then(|()| gzip.flush()).expect("a vector takes all bytes");
                std::mem::take(gzip.get_mut())
            }
        };
        // An error means that the reader has gone; the work is cancelled by other means.
        let _ = self.to.send(Bytes::from_owner(self.pool.hold(piece)));
    }

    /// Sends a whole answer.
    pub fn send_whole(&mut self, answer: Vec<u8>, slice: &TimeSlice) -> Result<(), Cancelled> {
        match &mut self.gzip {
            None => self.send(answer),
            Some(gzip) => gzip::feed(gzip, &answer, slice)?,
        }
        Ok(())
    }

    fn finish(self) {
        if let Some(gzip) = self.gzip {
            let last = gzip.finish().expect("a vector takes all bytes");
            let _ = self.to.send(Bytes::from_owner(self.pool.hold(last)));
        }
    }
}

/// The pieces of an answer, and the work that makes them.
struct BodyPieces {
    made: UnboundedReceiver<Bytes>,
    /// Dropping it cancels the work.
    work: Option<BoxFuture<'static, Result<(), Problem>>>,
}

impl BodyPieces {
    /// The pieces that `work` writes.
    fn of<Work: Future<Output = Result<(), Problem>> + Send + 'static>(
        pool: &Pool,
        encoding: Encoding,
        work: impl FnOnce(BodyWriter) -> Work,
    ) -> Self {
        let (to, made) = unbounded_channel();
        let gzip = (encoding == Encoding::Gzip).then(gzip::encoder);
        let writer = BodyWriter { to, gzip, pool: pool.clone() };
        Self { made, work: Some(Box::pin(work(writer))) }
    }

    /// All pieces as one.
    async fn collect(mut self) -> Result<Vec<u8>, Problem> {
        let mut whole = Vec::new();
        while let Some(piece) = self.next().await? {
            whole.extend_from_slice(&piece);
        }
        Ok(whole)
    }

    /// The response, which begins with the first piece. A failure before it is a problem.
    async fn into_response(mut self, (format, encoding): (Format, Encoding)) -> Result<Response<Body>, Problem> {
        let first = self.next().await?.unwrap_or_default();
        Ok(ok(format.media_type(), encoding, self.into_body(first)))
    }

    /// The next piece; None at the end. An error if the work has failed.
    async fn next(&mut self) -> Result<Option<Bytes>, Problem> {
        loop {
            let Some(work) = &mut self.work else { return Ok(self.made.recv().await) };
            tokio::select! {
                biased;
                Some(piece) = self.made.recv() => return Ok(Some(piece)),
                ended = work => {
                    self.work = None;
                    ended?;
                }
            }
        }
    }

    /// The body from here on. Once a piece is sent, a failure has no status any more, so the body breaks off without its last line.
    fn into_body(self, first: Bytes) -> Body {
        let rest =
            stream::unfold(self, async |mut pieces| match AssertUnwindSafe(pieces.next()).catch_unwind().await {
                Ok(Ok(piece)) => piece.map(|piece| (Ok(piece), pieces)),
                Ok(Err(_)) | Err(_) => Some((Err(io::Error::other("the work has failed")), pieces)),
            });
        Body::from_stream(stream::iter([Ok(first)]).chain(rest))
    }
}

/// Runs `compute` in time slices. The answer begins with the first piece.
pub(crate) async fn stream_in_slices(
    pool: &Pool,
    (format, encoding): (Format, Encoding),
    compute: impl FnOnce(Format, &TimeSlices, &mut BodyWriter) -> Result<(), Problem> + Send + 'static,
) -> Result<Response<Body>, Problem> {
    let pieces = pieces_in_slices(pool, (format, encoding), compute);
    pieces.into_response((format, encoding)).await
}

/// Runs `compute` in time slices, and returns the whole answer.
pub(crate) async fn collect_in_slices(
    pool: Pool,
    ticket: Ticket,
    (format, encoding): (Format, Encoding),
    compute: impl FnOnce(Format, &TimeSlices, &mut BodyWriter) -> Result<(), Problem> + Send + 'static,
) -> Result<Vec<u8>, Problem> {
    let compute = move |format, slices: &TimeSlices, writer: &mut BodyWriter| {
        // A kept answer would have its own encoding, so this one is computed.
        ticket.begin();
        compute(format, slices, writer)
    };
    pieces_in_slices(&pool, (format, encoding), compute).collect().await
}

fn pieces_in_slices(
    pool: &Pool,
    (format, encoding): (Format, Encoding),
    compute: impl FnOnce(Format, &TimeSlices, &mut BodyWriter) -> Result<(), Problem> + Send + 'static,
) -> BodyPieces {
    let working = pool.clone();
    BodyPieces::of(pool, encoding, |mut writer| async move {
        let compute = move |slices: &TimeSlices| {
            compute(format, slices, &mut writer)?;
            writer.finish();
            Ok(())
        };
        working.run_in_slices(compute).await
    })
}

/// Runs `compute` on one thread. If it `streams`, the answer begins with the first piece, else it is whole.
pub(crate) async fn stream_on_worker(
    pool: &Pool,
    (format, encoding): (Format, Encoding),
    streams: bool,
    compute: impl FnOnce(Format, &TimeSlice, &mut BodyWriter) -> Result<(), Problem> + Send + 'static,
) -> Result<Response<Body>, Problem> {
    let working = pool.clone();
    let pieces = BodyPieces::of(pool, encoding, |mut writer| async move {
        let compute = move |slice: &TimeSlice| {
            compute(format, slice, &mut writer)?;
            writer.finish();
            Ok(())
        };
        working.run_on_worker(compute).await
    });
    if streams {
        return pieces.into_response((format, encoding)).await;
    }
    let whole = pieces.collect().await?;
    Ok(ok(format.media_type(), encoding, Bytes::from_owner(pool.hold(whole))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use http_body_util::BodyExt;

    async fn answer(
        streams: bool,
        compute: impl FnOnce(&mut BodyWriter) -> Result<(), Problem> + Send + 'static,
    ) -> Result<Response<Body>, Problem> {
        let compute = |_: Format, _: &TimeSlice, out: &mut BodyWriter| compute(out);
        let pool = Pool::new(1, &crate::limits::Limits::default());
        stream_on_worker(&pool, (Format::Ndjson, Encoding::Identity), streams, compute).await
    }

    #[tokio::test]
    async fn what_fails_before_the_first_byte_is_a_problem() {
        for streams in [true, false] {
            let problem = answer(streams, |_| Err(Problem::internal())).await.unwrap_err();
            assert_eq!(problem.status(), 500);
        }
    }

    #[tokio::test]
    async fn what_fails_after_it_breaks_off() {
        for panics in [true, false] {
            let (go, wait) = std::sync::mpsc::channel();
            let compute = move |out: &mut BodyWriter| {
                out.send(b"first\n".to_vec());
                wait.recv().unwrap();
                if panics { panic!("on purpose") } else { Err(Problem::internal()) }
            };
            let mut body = answer(true, compute).await.unwrap().into_body();
            assert_eq!(body.frame().await.unwrap().unwrap().into_data().unwrap(), "first\n");
            go.send(()).unwrap();
            assert!(body.frame().await.unwrap().is_err());
        }
    }

    #[tokio::test]
    async fn a_stream_begins_before_the_work_ends_and_a_whole_answer_does_not() {
        let (go, wait) = std::sync::mpsc::channel();
        let compute = move |out: &mut BodyWriter| {
            out.send(b"a\n".to_vec());
            wait.recv().unwrap();
            out.send(b"b\n".to_vec());
            Ok(())
        };
        let response = answer(true, compute).await.unwrap();
        go.send(()).unwrap();
        assert_eq!(response.into_body().collect().await.unwrap().to_bytes(), "a\nb\n");
        let pieces = |out: &mut BodyWriter| {
            out.send(b"a".to_vec());
            out.send(b"b".to_vec());
            Ok(())
        };
        let response = answer(false, pieces).await.unwrap();
        assert_eq!(axum::body::HttpBody::size_hint(response.body()).exact(), Some(2));
    }
}
