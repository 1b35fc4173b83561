//! Requests that repeat: a GET whose answer is in memory is known by its target and by the headers that choose its form, so that the
//! next one like it is answered without being read again.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::{MatchedPath, Request};
use axum::http::uri::PathAndQuery;
use axum::http::{HeaderName, Method, header};
use quick_cache::sync::Cache;
use quick_cache::{OptionsBuilder, Weighter};
use xxhash_rust::xxh3::xxh3_64_with_seed;

use crate::compute::Peer;
use crate::http::response::etag::{EntityTag, IfNoneMatch};
use crate::http::response::negotiate::Encoding;
use crate::http::response::ranges::ByteRange;
use crate::http::security::host::FromProxy;
use crate::limits;

/// An answer that is kept under its name: all of it but its bytes.
#[derive(Debug, Clone)]
pub(crate) struct KeptAnswer {
    /// Name among the answers.
    pub(crate) name: Bytes,
    /// True if it depends on the build alone.
    pub(crate) is_permanent: bool,
    pub(crate) media_type: &'static str,
    pub(crate) encoding: Encoding,
    /// True if `Range` gives a part of it.
    pub(crate) has_parts: bool,
    pub(crate) tag: EntityTag,
    /// Route of the request. The route itself adds it.
    pub(crate) route: Option<MatchedPath>,
}

/// A client, with what it has and what it wants of an answer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Client {
    pub(crate) peer: Peer,
    pub(crate) held: IfNoneMatch,
    /// None for the whole answer.
    pub(crate) range: Option<ByteRange>,
}

/// Kept answers by the requests for them.
pub(crate) struct Repeats(Cache<Bytes, Arc<KeptAnswer>, InBytes, NameHash>);

impl Repeats {
    /// No requests yet, in at most so many bytes of memory.
    pub(crate) fn new(bytes: usize) -> Self {
        let options = OptionsBuilder::new()
            .shards(limits::ANSWER_CACHE_SHARDS)
            .estimated_items_capacity(bytes.div_ceil(limits::REPEAT_TYPICAL_BYTES))
            .weight_capacity(bytes as u64)
            .build()
            .expect("both capacities are set");
        Self(Cache::with_options(options, InBytes, NameHash::default(), Default::default()))
    }

    pub(crate) fn find(&self, request: &[u8]) -> Option<Arc<KeptAnswer>> {
        self.0.get(request)
    }

    pub(crate) fn insert(&self, request: Vec<u8>, answer: KeptAnswer) {
        self.0.insert(request.into_boxed_slice().into(), Arc::new(answer));
    }

    /// Memory in use, bytes.
    pub(crate) fn bytes(&self) -> u64 {
        self.0.weight()
    }
}

/// Headers that determine the bytes of some answer, of any client. The page names its own host.
const DETERMINING: [HeaderName; 3] = [header::ACCEPT, header::ACCEPT_ENCODING, header::HOST];

/// Headers that do so behind a trusted proxy.
const OF_PROXY: [HeaderName; 2] =
    [HeaderName::from_static("x-forwarded-host"), HeaderName::from_static("x-forwarded-proto")];

/// All that determines the answer to a GET of a valid length, as one name; None for other requests. Access, `If-None-Match` and all that
/// does not change the bytes are not in it.
pub(crate) fn name_of(request: &Request) -> Option<Vec<u8>> {
    let target = request.uri().path_and_query().map(PathAndQuery::as_str)?;
    if *request.method() != Method::GET || target.len() > limits::URL_BYTES {
        return None;
    }
    let mut name = Vec::with_capacity(target.len() + 128);
    name.extend_from_slice(target.as_bytes());
    let of_proxy = if request.extensions().get::<FromProxy>().is_some() { &OF_PROXY[..] } else { &[] };
    for (number, header) in (1..).zip(DETERMINING.iter().chain(of_proxy)) {
        for value in request.headers().get_all(header) {
            // Neither a target nor a header has such bytes.
            name.extend_from_slice(&[0, number]);
            name.extend_from_slice(value.as_bytes());
        }
    }
    if request.headers().contains_key(header::RANGE) {
        // A part is not compressed.
        name.extend_from_slice(&[0, 0]);
    }
    Some(name)
}

/// Weighs a request with its answer's name and its entry.
#[derive(Debug, Clone)]
struct InBytes;

impl Weighter<Bytes, Arc<KeptAnswer>> for InBytes {
    fn weight(&self, request: &Bytes, answer: &Arc<KeptAnswer>) -> u64 {
        (request.len() + answer.name.len() + limits::REPEAT_OVERHEAD) as u64
    }
}

/// Hash of names, which are a thousand bytes long. The seed is random, so that no client can choose names that collide.
#[derive(Debug, Clone)]
pub(crate) struct NameHash(u64);

impl Default for NameHash {
    fn default() -> Self {
        Self(RandomState::new().build_hasher().finish())
    }
}

impl BuildHasher for NameHash {
    type Hasher = NameHasher;

    fn build_hasher(&self) -> NameHasher {
        NameHasher(self.0)
    }
}

/// See [`NameHash`].
#[derive(Debug)]
pub(crate) struct NameHasher(u64);

impl Hasher for NameHasher {
    fn write(&mut self, bytes: &[u8]) {
        self.0 = xxh3_64_with_seed(bytes, self.0);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}
