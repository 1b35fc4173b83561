//! Strong entity tags, known before the answer is computed, and `If-None-Match` (RFC 9110, section 13.1.2).

use axum::http::{HeaderMap, HeaderValue, header};
use xxhash_rust::xxh3::Xxh3;

use crate::http::response::negotiate::list;

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

#[cfg(test)]
mod tests {
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
}
