//! The context of the request that the current task answers: its id, and the base path that clients see.

use std::sync::Arc;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use axum::http::{HeaderMap, HeaderName, HeaderValue};

use crate::limits;

/// The header of the request id, in requests and answers.
pub const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");

tokio::task_local! {
    static CURRENT: RequestContext;
}

/// The context of a request, which problems show.
#[derive(Debug, Clone)]
pub struct RequestContext {
    /// Id of the request as the value of a header: letters, digits and `-._`.
    id: HeaderValue,
    /// Path in front of every other path, as clients see it.
    pub base: Arc<str>,
}

impl RequestContext {
    /// The context of a request with these headers. The id is the one that a proxy or the client chose, or a new one.
    pub fn new(headers: &HeaderMap, base: Arc<str>) -> Self {
        let is_plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"-._".contains(byte);
        let is_fine = |id: &&HeaderValue| {
            (1..=limits::REQUEST_ID_BYTES).contains(&id.len()) && id.as_bytes().iter().all(is_plain)
        };
        Self { id: headers.get(REQUEST_ID).filter(is_fine).cloned().unwrap_or_else(fresh), base }
    }

    /// Runs `future` in this context.
    pub async fn scope<T>(self, future: impl Future<Output = T>) -> T {
        CURRENT.scope(self, future).await
    }

    /// The context of the current task, if it answers a request.
    pub fn current() -> Option<Self> {
        CURRENT.try_with(Clone::clone).ok()
    }

    /// Id of the request: letters, digits and `-._`.
    pub fn id(&self) -> &str {
        self.id.to_str().expect(IS_PLAIN)
    }

    /// The id as the value of a header.
    pub fn header(&self) -> HeaderValue {
        self.id.clone()
    }
}

const IS_PLAIN: &str = "an id is letters, digits and -._";

/// A new id. It is unique in this process, and very probably elsewhere.
fn fresh() -> HeaderValue {
    static COUNT: AtomicU64 = AtomicU64::new(1);
    static PROCESS: LazyLock<String> = LazyLock::new(|| {
        let begin = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
        format!("{:016x}-", xxhash_rust::xxh3::xxh3_64(format!("{begin} {}", std::process::id()).as_bytes()))
    });
    let id = [PROCESS.as_str(), &COUNT.fetch_add(1, Ordering::Relaxed).to_string()].concat();
    HeaderValue::try_from(id).expect(IS_PLAIN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_is_taken_only_where_it_can_stand_in_a_log() {
        let id = |value: &'static [u8]| {
            let headers = [(REQUEST_ID, HeaderValue::from_bytes(value).unwrap())].into_iter().collect();
            RequestContext::new(&headers, "".into()).id().to_owned()
        };
        assert_eq!(id(b"a-1.b_2"), "a-1.b_2");
        for hostile in [b"".as_slice(), b"a b", b"a\"b", b"\xff", &[b'x'; 65]] {
            let made = id(hostile);
            assert!(made.len() > 16 && made.bytes().all(|byte| byte.is_ascii_hexdigit() || byte == b'-'), "{made}");
        }
        assert_ne!(id(b""), id(b""));
    }
}
