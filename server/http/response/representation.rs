//! Representations (RFC 9110): entity tags, byte ranges, compression, responses without the headers of a resource, and answers that are known
//! when the server starts.

use std::io::Write;
use std::ops::Range;
use std::sync::OnceLock;

use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, HeaderValue, Response, StatusCode, header};
use flate2::Compression;
use flate2::write::GzEncoder;
use xxhash_rust::xxh3::Xxh3;

use crate::compute::{Cancelled, TimeSlice};
use crate::http::problem::Problem;
use crate::http::response::negotiate;
use crate::http::response::negotiate::{Encoding, list};
use crate::limits;

/// `Cache-Control` of answers that may be kept and are revalidated at each use, which costs no work.
const REVALIDATED: HeaderValue = HeaderValue::from_static("public, max-age=0, must-revalidate");

const VARY: HeaderValue = HeaderValue::from_static("Accept, Accept-Encoding");

const GZIP: HeaderValue = HeaderValue::from_static("gzip");

/// Headers of most answers. A map that grows is made anew.
const HEADERS: usize = 12;

/// 200 with a body and the headers that describe it.
pub(crate) fn ok(media_type: &'static str, encoding: Encoding, bytes: impl Into<Body>) -> Response<Body> {
    let mut response = with_room(bytes.into());
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(media_type));
    headers.insert(header::VARY, VARY);
    if encoding == Encoding::Gzip {
        headers.insert(header::CONTENT_ENCODING, GZIP);
    }
    response
}

/// 206 with a part of a body that is not compressed.
pub(crate) fn part(
    media_type: &'static str,
    range: &Range<usize>,
    length: usize,
    bytes: impl Into<Body>,
) -> Response<Body> {
    let mut response = ok(media_type, Encoding::Identity, bytes);
    *response.status_mut() = StatusCode::PARTIAL_CONTENT;
    response.headers_mut().insert(header::CONTENT_RANGE, content_range(range, length));
    response
}

/// A status without a body, with the same `Vary`.
pub(crate) fn status_only(status: StatusCode) -> Response<Body> {
    let mut response = with_room(Body::empty());
    *response.status_mut() = status;
    response.headers_mut().insert(header::VARY, VARY);
    response
}

/// A response with its entity tag, to be revalidated.
pub(crate) fn with_tag(mut response: Response<Body>, tag: &EntityTag) -> Response<Body> {
    response.headers_mut().insert(header::ETAG, tag.header());
    response.headers_mut().insert(header::CACHE_CONTROL, REVALIDATED);
    response
}

/// 200 with a body and room for headers.
pub(crate) fn with_room(body: Body) -> Response<Body> {
    let mut response = Response::new(body);
    *response.headers_mut() = HeaderMap::with_capacity(HEADERS);
    response
}

// Strong entity tags, known before the answer is computed, and `If-None-Match` (RFC 9110, section 13.1.2).

/// An entity tag with its quotes. Answers with different bytes have different tags, short of a collision in 128 bits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EntityTag(HeaderValue);

/// Result of `If-None-Match` for an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IfNoneMatch {
    /// The client has this answer.
    Match,
    /// The client has some answer (`*`).
    Any,
    /// The client has no answer, or another one.
    NoMatch,
}

impl EntityTag {
    /// The tag of everything that determines the bytes of an answer. Lengths separate the parts.
    pub fn of(parts: &[&[u8]]) -> Self {
        let mut hash = Xxh3::new();
        for part in parts {
            hash.update(&(part.len() as u64).to_le_bytes());
            hash.update(part);
        }
        let tag = format!("\"{:032x}\"", hash.digest128());
        Self(HeaderValue::try_from(tag).expect("hexadecimal digits in quotes"))
    }

    /// The tag as the value of `ETag`.
    pub fn header(&self) -> HeaderValue {
        self.0.clone()
    }

    /// Compares the tag with `If-None-Match`, weakly as on GET.
    pub fn if_none_match(&self, headers: &HeaderMap) -> IfNoneMatch {
        if !headers.contains_key(header::IF_NONE_MATCH) {
            return IfNoneMatch::NoMatch;
        }
        let listed = list(headers, &header::IF_NONE_MATCH);
        // The server's own tags have no comma, so splitting another's does no harm.
        let mut tags = listed.split(',').map(str::trim);
        match tags.find(|tag| *tag == "*" || tag.strip_prefix("W/").unwrap_or(tag) == self.0) {
            Some("*") => IfNoneMatch::Any,
            Some(_) => IfNoneMatch::Match,
            None => IfNoneMatch::NoMatch,
        }
    }
}

// Byte ranges of answers that are not compressed (RFC 9110, section 14). An answer to a GET has at most one range; a list of ranges is
// answered with the whole.

/// The unit of ranges, in `Accept-Ranges`.
pub(crate) const BYTES: HeaderValue = HeaderValue::from_static("bytes");

/// A range that a client asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ByteRange {
    /// From a byte to a byte, both included, or to the end.
    From(u64, Option<u64>),
    /// So many bytes at the end.
    Last(u64),
}

impl ByteRange {
    /// The range of a request, if it is one and `If-Range` does not name another answer. An invalid one counts as none.
    pub(crate) fn asked(headers: &HeaderMap, tag: &EntityTag) -> Option<Self> {
        let is_same = headers.get_all(header::IF_RANGE).iter().all(|named| *named == tag.header());
        let mut ranges = headers.get_all(header::RANGE).iter();
        let (Some(range), None, true) = (ranges.next(), ranges.next(), is_same) else { return None };
        Self::parse(range.to_str().ok()?)
    }

    fn parse(text: &str) -> Option<Self> {
        let (unit, range) = text.split_once('=')?;
        let (first, last) = range.trim().split_once('-').filter(|_| unit.trim().eq_ignore_ascii_case("bytes"))?;
        let is_number = |digits: &str| digits.bytes().all(|digit| digit.is_ascii_digit());
        // A number beyond 64 bits is beyond every answer.
        let number = |digits: &str| (!digits.is_empty()).then(|| digits.parse().unwrap_or(u64::MAX));
        if !is_number(first) || !is_number(last) {
            return None;
        }
        match (number(first), number(last)) {
            (Some(first), last) if last.is_none_or(|last| first <= last) => Some(Self::From(first, last)),
            (None, Some(count)) => Some(Self::Last(count)),
            _ => None,
        }
    }

    /// The bytes of an answer of this length; None if it has none of them.
    pub(crate) fn within(self, length: usize) -> Option<Range<usize>> {
        let clamped = |place: u64| usize::try_from(place).unwrap_or(usize::MAX).min(length);
        let bytes = match self {
            Self::From(first, last) => clamped(first)..last.map_or(length, |last| clamped(last.saturating_add(1))),
            Self::Last(count) => length - clamped(count)..length,
        };
        Some(bytes).filter(|bytes| !bytes.is_empty())
    }
}

/// The value of `Content-Range` for some bytes of an answer.
pub(crate) fn content_range(bytes: &Range<usize>, length: usize) -> HeaderValue {
    HeaderValue::try_from(format!("bytes {}-{}/{length}", bytes.start, bytes.end - 1)).expect("digits and signs")
}

// Compresses answers. Equal input gives equal bytes: one algorithm in plain Rust at one level.

/// Fast rather than small: digits of doubles hardly get smaller at higher levels.
const FAST: Compression = Compression::new(1);

/// Compresses an answer to one request.
pub fn gzip(bytes: &[u8], slice: &TimeSlice) -> Result<Vec<u8>, Cancelled> {
    compress(bytes, FAST, slice)
}

/// Compresses bytes that are sent many times, as small as possible.
pub fn gzip_best(bytes: &[u8]) -> Vec<u8> {
    compress(bytes, Compression::best(), &TimeSlice::unbounded()).expect("nobody cancels it")
}

fn compress(bytes: &[u8], level: Compression, slice: &TimeSlice) -> Result<Vec<u8>, Cancelled> {
    // The header has no time, name or system, so that equal answers are equal bytes.
    let mut encoder = GzEncoder::new(Vec::with_capacity(bytes.len() / 2), level);
    feed(&mut encoder, bytes, slice)?;
    Ok(encoder.finish().expect("a vector takes all bytes"))
}

/// An encoder for pieces, at the level of `gzip`.
pub(crate) fn encoder() -> GzEncoder<Vec<u8>> {
    GzEncoder::new(Vec::new(), FAST)
}

/// Compresses a large piece, with checks for cancellation.
pub(crate) fn feed(encoder: &mut GzEncoder<Vec<u8>>, bytes: &[u8], slice: &TimeSlice) -> Result<(), Cancelled> {
    for step in bytes.chunks(limits::GZIP_STEP_BYTES) {
        slice.check()?;
        encoder.write_all(step).expect("a vector takes all bytes");
    }
    Ok(())
}

// Answers that are known when the server starts: pages, scripts, the contract. Each is compressed once, on first demand.

/// Bytes of a media type, and their compressed form.
#[derive(Debug)]
pub struct StaticAsset {
    media_type: &'static str,
    identity: Form,
    gzip: OnceLock<Option<Form>>,
}

/// Bytes as they are sent, with their tag.
#[derive(Debug)]
struct Form {
    bytes: Bytes,
    tag: OnceLock<EntityTag>,
}

impl From<Bytes> for Form {
    fn from(bytes: Bytes) -> Self {
        Self { bytes, tag: OnceLock::new() }
    }
}

impl StaticAsset {
    /// An asset of these bytes.
    pub fn new(media_type: &'static str, bytes: impl Into<Bytes>) -> Self {
        Self { media_type, identity: Form::from(bytes.into()), gzip: OnceLock::new() }
    }

    /// The answer to a GET or HEAD: 304 if the client has these bytes.
    pub fn answer(&self, headers: &HeaderMap) -> Result<Response<Body>, Problem> {
        let encoding = negotiate::encoding(headers, false)?;
        let compressed = (encoding == Encoding::Gzip).then(|| self.gzip()).flatten();
        let (encoding, form) = match compressed {
            Some(gzip) => (Encoding::Gzip, gzip),
            None => (Encoding::Identity, &self.identity),
        };
        let tag = form.tag.get_or_init(|| EntityTag::of(&[self.media_type.as_bytes(), &form.bytes]));
        let response = match tag.if_none_match(headers) {
            IfNoneMatch::Match | IfNoneMatch::Any => status_only(StatusCode::NOT_MODIFIED),
            IfNoneMatch::NoMatch => ok(self.media_type, encoding, form.bytes.clone()),
        };
        Ok(with_tag(response, tag))
    }

    /// The compressed form, if it is smaller.
    fn gzip(&self) -> Option<&Form> {
        let compressed = self.gzip.get_or_init(|| {
            let gzip = gzip_best(&self.identity.bytes);
            (gzip.len() < self.identity.bytes.len()).then(|| Form::from(Bytes::from(gzip)))
        });
        compressed.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use axum::http::{HeaderValue, header};

    use super::*;

    #[test]
    fn every_part_counts() {
        let tag = |parts: &[&str]| EntityTag::of(&parts.iter().map(|part| part.as_bytes()).collect::<Vec<_>>());
        let one = tag(&["trajectories", "json", "{}"]);
        assert_eq!(one, tag(&["trajectories", "json", "{}"]));
        for other in [["stability", "json", "{}"], ["trajectories", "csv", "{}"], ["trajectories", "json", "{ }"]] {
            assert_ne!(one, tag(&other));
        }
        assert_ne!(tag(&["ab", "c"]), tag(&["a", "bc"]));
        assert_eq!(one.header().len(), 34);
    }

    #[test]
    fn if_none_match_is_a_list() {
        let tag = EntityTag::of(&[b"x"]);
        let own = tag.0.to_str().unwrap();
        for (held, expected) in [
            (own.to_owned(), IfNoneMatch::Match),
            (format!("W/{own}"), IfNoneMatch::Match),
            (format!("\"other\", {own}"), IfNoneMatch::Match),
            ("*".to_owned(), IfNoneMatch::Any),
            ("\"other\"".to_owned(), IfNoneMatch::NoMatch),
            (own.trim_matches('"').to_owned(), IfNoneMatch::NoMatch),
            (String::new(), IfNoneMatch::NoMatch),
        ] {
            let headers: HeaderMap = [(header::IF_NONE_MATCH, held.parse().unwrap())].into_iter().collect();
            assert_eq!(tag.if_none_match(&headers), expected, "{held}");
        }
        assert_eq!(tag.if_none_match(&HeaderMap::new()), IfNoneMatch::NoMatch);
    }

    fn asked(range: &str, if_range: Option<&str>) -> Option<ByteRange> {
        let mut headers: HeaderMap = [(header::RANGE, range.parse().unwrap())].into_iter().collect();
        if let Some(tag) = if_range {
            headers.insert(header::IF_RANGE, tag.parse().unwrap());
        }
        ByteRange::asked(&headers, &EntityTag::of(&[b"x"]))
    }

    #[test]
    fn a_range_is_cut_at_the_end() {
        for (range, length, expected) in [
            ("bytes=0-0", 10, Some(0..1)),
            ("bytes=2-5", 10, Some(2..6)),
            ("bytes=2-", 10, Some(2..10)),
            ("Bytes = 9-20", 10, Some(9..10)),
            ("bytes=0-99999999999999999999999", 10, Some(0..10)),
            ("bytes=-3", 10, Some(7..10)),
            ("bytes=-30", 10, Some(0..10)),
            ("bytes=10-", 10, None),
            ("bytes=99999999999999999999999-", 10, None),
            ("bytes=-0", 10, None),
            ("bytes=0-0", 0, None),
            ("bytes=-1", 0, None),
        ] {
            assert_eq!(asked(range, None).unwrap().within(length), expected, "{range} of {length}");
        }
    }

    #[test]
    fn other_ranges_are_not_looked_at() {
        for range in ["bytes", "bytes=", "bytes=-", "bytes=5-2", "bytes=1-2,4-5", "bytes=a-2", "bytes=+1-2", "rows=0-1"]
        {
            assert_eq!(asked(range, None), None, "{range}");
        }
    }

    #[test]
    fn a_range_of_another_answer_is_none() {
        let tag = EntityTag::of(&[b"x"]).header();
        let tag = tag.to_str().unwrap();
        assert_eq!(asked("bytes=0-0", Some(tag)), Some(ByteRange::From(0, Some(0))));
        for other in ["\"other\"", &format!("W/{tag}"), "Mon, 23 Nov 2026 10:00:00 GMT"] {
            assert_eq!(asked("bytes=0-0", Some(other)), None, "{other}");
        }
    }

    #[test]
    fn what_goes_in_comes_out() {
        let bytes: Vec<u8> = (0..300_000_u32).flat_map(|n| n.to_string().into_bytes()).collect();
        for packed in [gzip(&bytes, &TimeSlice::unbounded()).unwrap(), gzip_best(&bytes)] {
            assert!(packed.len() < bytes.len() / 2);
            assert_eq!(packed[4..8], [0; 4], "a time in the header would make equal answers differ");
            let mut unpacked = Vec::new();
            flate2::read::GzDecoder::new(packed.as_slice()).read_to_end(&mut unpacked).unwrap();
            assert_eq!(unpacked, bytes);
        }
    }

    #[test]
    fn nobody_waiting_is_nothing_to_do() {
        let slice = TimeSlice::unbounded();
        slice.cancel().set();
        assert_eq!(gzip(b"text", &slice), Err(Cancelled));
    }

    fn accepting_gzip() -> HeaderMap {
        [(header::ACCEPT_ENCODING, HeaderValue::from_static("gzip"))].into_iter().collect()
    }

    #[test]
    fn compressed_where_it_helps() {
        let long = StaticAsset::new("text/css", "a { color: red }\n".repeat(100));
        assert_eq!(long.answer(&accepting_gzip()).unwrap().headers()[header::CONTENT_ENCODING], "gzip");
        assert!(long.answer(&HeaderMap::new()).unwrap().headers().get(header::CONTENT_ENCODING).is_none());
        let short = StaticAsset::new("text/css", "a{}");
        assert!(short.answer(&accepting_gzip()).unwrap().headers().get(header::CONTENT_ENCODING).is_none());
    }

    #[test]
    fn each_form_has_its_tag() {
        let page = StaticAsset::new("text/html", "text ".repeat(100));
        let tag = |headers: &HeaderMap| page.answer(headers).unwrap().headers()[header::ETAG].clone();
        let mut held = accepting_gzip();
        assert_ne!(tag(&held), tag(&HeaderMap::new()));
        held.insert(header::IF_NONE_MATCH, tag(&held));
        assert_eq!(page.answer(&held).unwrap().status(), StatusCode::NOT_MODIFIED);
        held.remove(header::ACCEPT_ENCODING);
        assert_eq!(page.answer(&held).unwrap().status(), StatusCode::OK);
    }
}
