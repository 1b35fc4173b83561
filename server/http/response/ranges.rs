//! Byte ranges of answers that are not compressed (RFC 9110, section 14). An answer to a GET has at most one range; a list of ranges is
//! answered with the whole.

use std::ops::Range;

use axum::http::{HeaderMap, HeaderValue, header};

use crate::http::response::etag::EntityTag;

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
