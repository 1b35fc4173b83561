//! Answers to an [`ApiRequest`]: negotiated, with an entity tag, computed only if the client does not have them, and compressed on
//! request.
//!
//! The resource decides what it computes and at which price.

use std::io;
use std::io::Write;
use std::panic::AssertUnwindSafe;

use axum::body::{Body, Bytes};
use axum::http::{HeaderValue, Response, StatusCode, header};
use axum::response::IntoResponse;
use flate2::write::GzEncoder;
use futures_util::future::BoxFuture;
use futures_util::{FutureExt, StreamExt, stream};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use crate::BUILD;
use crate::compute::{Cancelled, Pool, Price, TimeSlice, TimeSlices};
use crate::http::problem::Problem;
use crate::http::request::api_request::ApiRequest;
use crate::http::request::reader::Source;
use crate::http::response::answers::{Answers, Client, KeptAnswer, Ticket};
use crate::http::response::negotiate::{Encoding, Format};
use crate::http::response::representation::{
    BYTES, ByteRange, EntityTag, IfNoneMatch, ok, part, status_only, with_tag,
};
use crate::http::response::{negotiate, representation};
use crate::limits;

/// A resource, as far as negotiation and entity tags need it.
#[derive(Debug, Clone, Copy)]
pub struct Resource {
    /// Name in the URL, such as `trajectories`.
    pub name: &'static str,
    /// Formats of the answer; the first is the default.
    pub formats: &'static [Format],
}

impl ApiRequest {
    /// The answer of a pure resource: 304 if the client has it, else the bytes that `compute` returns, from memory or computed at
    /// `price`.
    ///
    /// `canonical` is the request with all defaults, in a fixed order. Together with build, format and encoding it must determine
    /// every byte of the answer.
    pub async fn respond(
        &self,
        answers: &Answers,
        resource: &Resource,
        canonical: &[u8],
        price: Price,
        compute: impl FnOnce(Format, &TimeSlice) -> Result<Vec<u8>, Problem> + Clone + Send + 'static,
    ) -> Result<Response<Body>, Problem> {
        let (format, encoding) = self.negotiate(resource)?;
        let work = |pool, ticket| compute_whole(pool, ticket, (format, encoding), price, compute);
        self.kept_or_computed(answers, resource, (format, encoding), canonical, work).await
    }

    /// The same for long work, which `compute` does in time slices, and which takes the memory of `price`. Formats in `streamed` are sent piece by piece, and are not kept, unless
    /// the request is for a length or a range: a length is known, and a range has its place, only in the whole.
    pub async fn respond_in_slices(
        &self,
        answers: &Answers,
        resource: &Resource,
        canonical: &[u8],
        price: Price,
        streamed: &[Format],
        compute: impl FnOnce(Format, &TimeSlices, &mut BodyWriter) -> Result<(), Problem> + Send + 'static,
    ) -> Result<Response<Body>, Problem> {
        let (format, encoding) = self.negotiate(resource)?;
        if streamed.contains(&format) && !self.is_head && !self.is_for_part() {
            let pool = answers.pool(self.peer).with_memory(price.as_bytes());
            let tag = tag(resource, (format, encoding), canonical);
            let answer = || stream_in_slices(&pool, (format, encoding), compute);
            let response = match self.held(&tag) {
                IfNoneMatch::Match => status_only(StatusCode::NOT_MODIFIED),
                // Only then is it known that there is an answer.
                IfNoneMatch::Any => answer().await.map(|_| status_only(StatusCode::NOT_MODIFIED))?,
                IfNoneMatch::NoMatch => answer().await?,
            };
            return Ok(with_tag(response, &tag));
        }
        let work = |pool: Pool, ticket: Ticket| {
            collect_in_slices(pool.with_memory(price.as_bytes()), ticket, (format, encoding), compute)
        };
        self.kept_or_computed(answers, resource, (format, encoding), canonical, work).await
    }

    /// 304 if the client has the answer, else the answer: from memory, from the computation of another request, or computed by `work`.
    async fn kept_or_computed<Work: Future<Output = Result<Vec<u8>, Problem>> + Send + 'static>(
        &self,
        answers: &Answers,
        resource: &Resource,
        (format, encoding): (Format, Encoding),
        canonical: &[u8],
        work: impl FnOnce(Pool, Ticket) -> Work,
    ) -> Result<Response<Body>, Problem> {
        // Zeros separate the words, none of which has one.
        let words = [resource.name, format.name(), encoding.name()].map(str::as_bytes);
        let name = Bytes::from([words[0], words[1], words[2], canonical].join(&0).into_boxed_slice());
        let tag = tag(resource, (format, encoding), canonical);
        let client = Client { peer: self.peer, held: self.held(&tag), range: self.range(&tag) };
        let (is_permanent, media_type) = (answers.is_permanent(), format.media_type());
        let has_parts = encoding == Encoding::Identity;
        let kept = KeptAnswer { name: name.clone(), is_permanent, media_type, encoding, has_parts, tag, route: None };
        if let Some(response) = kept.clone().respond_repeatably(answers, client) {
            return Ok(response);
        }
        let bytes = answers.once(self.peer, name, work).await?;
        Ok(kept.with_bytes(answers, client, bytes))
    }

    /// Compares an answer with those that the client says it has. A query means GET or HEAD. On POST the precondition has no such meaning.
    fn held(&self, tag: &EntityTag) -> IfNoneMatch {
        if self.source == Source::Query { tag.if_none_match(&self.headers) } else { IfNoneMatch::NoMatch }
    }

    /// Tells whether it is a GET for a part of an answer.
    fn is_for_part(&self) -> bool {
        self.source == Source::Query && !self.is_head && self.headers.contains_key(header::RANGE)
    }

    /// The range of an answer that a GET asks for.
    fn range(&self, tag: &EntityTag) -> Option<ByteRange> {
        self.is_for_part().then(|| ByteRange::asked(&self.headers, tag)).flatten()
    }

    /// The answer of a measurement: `no-store` and without an entity tag, because the next one differs. Formats in `streamed` are
    /// sent piece by piece.
    pub async fn respond_uncached(
        &self,
        pool: &Pool,
        resource: &Resource,
        price: Price,
        streamed: &[Format],
        compute: impl FnOnce(Format, &TimeSlice, &mut BodyWriter) -> Result<(), Problem> + Send + 'static,
    ) -> Result<Response<Body>, Problem> {
        let (format, encoding) = self.negotiate(resource)?;
        let streams = streamed.contains(&format);
        let pool = pool.for_peer(self.peer).with_memory(price.as_bytes());
        let mut response = stream_on_worker(&pool, (format, encoding), streams, compute).await?;
        response.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
        Ok(response)
    }

    /// An answer that is sent while it is made. It is not compressed.
    pub fn respond_stream(
        &self,
        resource: &Resource,
        pieces: impl FnOnce(Format) -> Body,
    ) -> Result<Response<Body>, Problem> {
        let (format, _) = self.negotiate(resource)?;
        Ok(ok(format.media_type(), Encoding::Identity, pieces(format)))
    }

    /// Refuses a client that accepts none of the resource's formats: 406.
    pub fn accepts(&self, resource: &Resource) -> Result<(), Problem> {
        self.negotiate(resource).map(drop)
    }

    fn negotiate(&self, resource: &Resource) -> Result<(Format, Encoding), Problem> {
        let format = negotiate::format(self.format.as_deref(), &self.headers, resource.formats)?;
        let encoding = negotiate::encoding(&self.headers, self.is_for_part())?;
        Ok((format, if format.is_compressible() { encoding } else { Encoding::Identity }))
    }
}

impl KeptAnswer {
    /// 304 if the client has the answer, else the answer from memory; None if it is not there. Its bytes count as the client's until
    /// they are sent.
    pub(crate) fn respond(&self, answers: &Answers, client: Client) -> Option<Response<Body>> {
        if client.held == IfNoneMatch::Match {
            return Some(with_tag(status_only(StatusCode::NOT_MODIFIED), &self.tag));
        }
        let bytes = answers.kept(self.is_permanent, &self.name)?;
        Some(self.with_bytes(answers, client, bytes))
    }

    /// The same, with itself among the extensions, from which the middleware learns how to answer the next request like this one.
    pub(crate) fn respond_repeatably(self, answers: &Answers, client: Client) -> Option<Response<Body>> {
        let mut response = self.respond(answers, client)?;
        response.extensions_mut().insert(self);
        Some(response)
    }

    /// The answer with these bytes, for a client that does not have them by this tag: all of them, or the range that it asks for.
    pub(crate) fn with_bytes(&self, answers: &Answers, client: Client, bytes: Bytes) -> Response<Body> {
        if client.held != IfNoneMatch::NoMatch {
            return with_tag(status_only(StatusCode::NOT_MODIFIED), &self.tag);
        }
        let held = |bytes: Bytes| Bytes::from_owner(answers.pool(client.peer).hold(bytes));
        let length = bytes.len();
        let mut response = match client.range.filter(|_| self.has_parts) {
            None => ok(self.media_type, self.encoding, held(bytes)),
            Some(range) => match range.within(length) {
                // A copy, so that the whole is not held for a part.
                Some(range) => {
                    part(self.media_type, &range, length, held(Bytes::copy_from_slice(&bytes[range.clone()])))
                }
                None => return Problem::range_not_satisfiable(length).into_response(),
            },
        };
        if self.has_parts {
            response.headers_mut().insert(header::ACCEPT_RANGES, BYTES);
        }
        with_tag(response, &self.tag)
    }
}

/// The entity tag of an answer.
fn tag(resource: &Resource, (format, encoding): (Format, Encoding), canonical: &[u8]) -> EntityTag {
    let parts = [resource.name, BUILD, format.name(), encoding.name()].map(str::as_bytes);
    EntityTag::of(&[parts[0], parts[1], parts[2], parts[3], canonical])
}

async fn compute_whole(
    pool: Pool,
    ticket: Ticket,
    (format, encoding): (Format, Encoding),
    price: Price,
    compute: impl FnOnce(Format, &TimeSlice) -> Result<Vec<u8>, Problem> + Clone + Send + 'static,
) -> Result<Vec<u8>, Problem> {
    // Compression is part of the work: it takes as long as computing, and is cancelled with it.
    let work = move |slice: &TimeSlice| {
        if let Some(kept) = ticket.begin() {
            return Ok(kept.into());
        }
        let bytes = compute(format, slice)?;
        Ok::<_, Problem>(if encoding == Encoding::Gzip { representation::gzip(&bytes, slice)? } else { bytes })
    };
    pool.with_memory(price.as_bytes()).run(with_drawing(price, format), work).await
}

/// The price of an answer in this format. Drawing and pixels cost extra.
fn with_drawing(price: Price, format: Format) -> Price {
    match format {
        Format::Svg => price.and(Price::bounces(limits::SVG_PRICE)),
        Format::Png => price.and(Price::bounces(limits::SVG_PRICE + limits::PNG_PRICE)),
        Format::Json
        | Format::Csv
        | Format::Ndjson
        | Format::Arrow
        | Format::Progress
        | Format::Events
        | Format::OpenMetrics
        | Format::Prometheus => price,
    }
}

// Answers that are sent while they are computed.
//
// Computing never waits for the reader. Unread bytes are kept: at most the whole answer, which the price has bounded
// (`Limits::answer`), accounted to the client (`Limits::held_bytes`). A reader that takes nothing is disconnected after
// `Limits::stall_time`. So a slow reader holds neither a permit nor a place in the queue. A reader that leaves cancels the work.

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
            Some(gzip) => representation::feed(gzip, &answer, slice)?,
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
        let gzip = (encoding == Encoding::Gzip).then(representation::encoder);
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
    use std::sync::atomic::{AtomicUsize, Ordering};

    use axum::extract::{FromRequest, Request};
    use http_body_util::BodyExt;

    use super::*;
    use crate::limits::Limits;

    static RESOURCE: Resource = Resource { name: "test", formats: &[Format::Json, Format::Csv] };

    async fn get(query: &str, headers: &[(&str, &str)], work: &'static AtomicUsize) -> Response<Body> {
        let request = headers.iter().fold(Request::get(query), |request, (name, value)| request.header(*name, *value));
        let request = ApiRequest::from_request(request.body(Body::empty()).unwrap(), &Limits::default()).await.unwrap();
        let compute = |format: Format, _: &TimeSlice| {
            work.fetch_add(1, Ordering::Relaxed);
            Ok(format.name().repeat(1000).into_bytes())
        };
        request
            .respond(
                &Answers::new(&Pool::new(1, &Limits::default()), 0),
                &RESOURCE,
                b"canonical",
                Price::bounces(1),
                compute,
            )
            .await
            .unwrap()
    }

    #[tokio::test]
    async fn what_the_client_has_is_not_computed() {
        static WORK: AtomicUsize = AtomicUsize::new(0);
        let first = get("/", &[], &WORK).await;
        let tag = first.headers()[header::ETAG].to_str().unwrap().to_owned();
        assert_eq!((first.status().as_u16(), WORK.load(Ordering::Relaxed)), (200, 1));
        let second = get("/", &[("if-none-match", &tag)], &WORK).await;
        assert_eq!((second.status().as_u16(), WORK.load(Ordering::Relaxed)), (304, 1));
        for name in [header::ETAG, header::VARY, header::CACHE_CONTROL] {
            assert_eq!(first.headers()[&name], second.headers()[&name]);
        }
        assert_eq!(get("/?format=csv", &[("if-none-match", &tag)], &WORK).await.status(), 200);
        assert_eq!(get("/", &[("if-none-match", &tag), ("accept-encoding", "gzip")], &WORK).await.status(), 200);
    }

    #[tokio::test]
    async fn the_body_is_as_negotiated() {
        static WORK: AtomicUsize = AtomicUsize::new(0);
        let plain = get("/", &[("accept", "text/csv")], &WORK).await;
        assert_eq!(plain.headers()[header::CONTENT_TYPE], "text/csv; charset=utf-8; header=present");
        assert!(plain.headers().get(header::CONTENT_ENCODING).is_none());
        assert_eq!(plain.into_body().collect().await.unwrap().to_bytes().len(), 3000);
        let packed = get("/", &[("accept-encoding", "gzip")], &WORK).await;
        assert_eq!(packed.headers()[header::CONTENT_ENCODING], "gzip");
        assert!(packed.into_body().collect().await.unwrap().to_bytes().len() < 300);
    }

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
