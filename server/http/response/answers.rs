//! Answers of pure work: kept in memory under the name of their request, and computed once for all requests that wait for them
//! together.
//!
//! A name determines every byte of its answer, and names are compared as a whole: two requests never share an answer by a collision
//! of hashes. An answer in memory takes no place in the queue. One that is computed is admitted, priced and counted for the client
//! that asked first. It has the best place in the queue of all clients that wait for it, and its work is cancelled when the last
//! request for it has gone. Errors are not kept.

use std::collections::HashMap;
use std::fmt;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::panic::AssertUnwindSafe;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};

use axum::body::Bytes;
use axum::extract::{MatchedPath, Request};
use axum::http::uri::PathAndQuery;
use axum::http::{HeaderName, Method, header};
use futures_util::FutureExt;
use futures_util::future::{BoxFuture, Shared, WeakShared};
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::gauge::Gauge;
use quick_cache::sync::Cache;
use quick_cache::{OptionsBuilder, Weighter};
use xxhash_rust::xxh3::xxh3_64_with_seed;

use crate::compute::{Crowd, Peer, Pool};
use crate::http::problem::Problem;
use crate::http::response::negotiate::Encoding;
use crate::http::response::representation::{ByteRange, EntityTag, IfNoneMatch};
use crate::http::security::host::FromProxy;
use crate::limits;

/// Kept answers, answers under way, and the pool that computes them. Cheap to clone; clones share their answers.
#[derive(Debug, Clone)]
pub struct Answers {
    pool: Pool,
    shared: Arc<SharedAnswers>,
    is_permanent: bool,
}

/// Counts of [`Answers`].
#[derive(Debug, Clone, Default)]
pub struct AnswerCounts {
    /// Answers from memory.
    pub hits: Counter,
    /// Answers that had to be computed.
    pub misses: Counter,
    /// Requests that waited for an answer which another one had begun.
    pub joined: Counter,
    /// Bytes of kept answers, with their names and the requests for them.
    pub bytes: Gauge,
}

struct SharedAnswers {
    /// None if no memory is granted.
    kept: Option<Cache<Bytes, Bytes, InBytes, NameHash>>,
    /// Requests for kept answers; None as above.
    repeats: Option<Repeats>,
    /// Answers that depend on the build alone. They are few, and never dropped.
    permanent: RwLock<HashMap<Bytes, Bytes>>,
    /// Answers under way by name; of several with one name the newest.
    running: Mutex<HashMap<Bytes, Running>>,
    counts: AnswerCounts,
}

type Computation = BoxFuture<'static, Result<Bytes, Problem>>;

/// An answer under way.
struct Running {
    peer: Peer,
    /// Clients that wait for it.
    crowd: Crowd,
    state: Arc<AtomicBool>,
    answer: WeakShared<Computation>,
}

impl Answers {
    /// No answers yet, in at most so many bytes of memory. Without memory, each request is computed for itself.
    pub fn new(pool: &Pool, bytes: usize) -> Self {
        let for_repeats = bytes / limits::REPEATS_SHARE;
        let for_answers = bytes - for_repeats;
        let options = || {
            OptionsBuilder::new()
                .shards(limits::ANSWER_CACHE_SHARDS)
                .estimated_items_capacity(for_answers.div_ceil(limits::ANSWER_CACHE_TYPICAL_BYTES))
                .weight_capacity(for_answers as u64)
                .build()
                .expect("both capacities are set")
        };
        let is_on = bytes > 0;
        let shared = SharedAnswers {
            kept: is_on.then(|| Cache::with_options(options(), InBytes, NameHash::default(), Default::default())),
            repeats: is_on.then(|| Repeats::new(for_repeats)),
            permanent: RwLock::default(),
            running: Mutex::default(),
            counts: AnswerCounts::default(),
        };
        Self { pool: pool.clone(), shared: Arc::new(shared), is_permanent: false }
    }

    /// The same answers, for requests whose answers depend on the build alone. They are kept whatever the memory.
    pub fn permanent(&self) -> Self {
        Self { is_permanent: true, ..self.clone() }
    }

    /// Hits, misses and bytes.
    pub fn counts(&self) -> &AnswerCounts {
        &self.shared.counts
    }

    /// The pool of this client.
    pub(crate) fn pool(&self, peer: Peer) -> Pool {
        self.pool.for_peer(peer)
    }

    /// Tells whether [`Answers::permanent`] was called.
    pub(crate) fn is_permanent(&self) -> bool {
        self.is_permanent
    }

    /// The kept answer of this name, to be sent.
    pub(crate) fn kept(&self, is_permanent: bool, name: &[u8]) -> Option<Bytes> {
        let answer = self.find(is_permanent, name);
        if answer.is_some() {
            self.shared.counts.hits.inc();
        }
        answer
    }

    /// The kept answer of this name, not counted.
    pub(crate) fn find(&self, is_permanent: bool, name: &[u8]) -> Option<Bytes> {
        if is_permanent {
            return self.shared.permanent.read().unwrap_or_else(PoisonError::into_inner).get(name).cloned();
        }
        self.shared.kept.as_ref()?.get(name)
    }

    /// Keeps an answer, if it is not too large.
    pub(crate) fn keep(&self, name: Bytes, answer: Bytes) {
        if self.is_permanent {
            self.shared.permanent.write().unwrap_or_else(PoisonError::into_inner).insert(name, answer);
            return;
        }
        let Some(kept) = self.shared.kept.as_ref() else { return };
        if answer.len() <= limits::KEPT_ANSWER_BYTES {
            kept.insert(name, answer);
            self.shared.count_bytes();
        }
    }

    /// The kept answer to a request that is known by this name (see [`repeats::name_of`]).
    pub(crate) fn repeated(&self, request: &[u8]) -> Option<Arc<KeptAnswer>> {
        self.shared.repeats.as_ref()?.find(request)
    }

    /// Keeps the answer to a request that is known by this name.
    pub(crate) fn expect_again(&self, request: Vec<u8>, answer: KeptAnswer) {
        if let Some(repeats) = &self.shared.repeats {
            repeats.insert(request, answer);
            self.shared.count_bytes();
        }
    }

    /// The answer of this name, which was not in memory: from the computation of another request, or computed by `compute`.
    pub(crate) async fn once<Work>(
        &self,
        peer: Peer,
        name: Bytes,
        compute: impl FnOnce(Pool, Ticket) -> Work,
    ) -> Result<Bytes, Problem>
    where
        Work: Future<Output = Result<Vec<u8>, Problem>> + Send + 'static,
    {
        let ticket = || Ticket { answers: self.clone(), name: name.clone(), has_begun: Arc::default() };
        if !self.is_permanent && self.shared.kept.is_none() {
            return compute(self.pool(peer), ticket()).await.map(Bytes::from);
        }
        // Until this request has gone, the computation has a place of its client.
        let (computation, _member) = {
            let mut running = self.running();
            // The client that asked first may wait for its turn behind its own requests. Others need not wait with it.
            let other = running.get(&name).filter(|other| other.peer == peer || other.state.load(Ordering::Relaxed));
            match other.and_then(|other| Some((other.answer.upgrade()?, &other.crowd))) {
                Some((computation, crowd)) => {
                    self.shared.counts.joined.inc();
                    (computation, self.pool.join(crowd, peer))
                }
                None => {
                    // It may have been kept since it was looked for: answers are kept first, and then no longer under way.
                    if let Some(answer) = self.kept(self.is_permanent, &name) {
                        return Ok(answer);
                    }
                    self.shared.counts.misses.inc();
                    let ticket = ticket();
                    let state = ticket.has_begun.clone();
                    let (crowd, member) = Crowd::begin(peer);
                    let pool = self.pool(peer).for_crowd(&crowd);
                    let computation = self.start(&ticket, compute(pool, ticket.clone()));
                    let answer = computation.downgrade().expect("it has not been polled");
                    running.insert(name.clone(), Running { peer, crowd, state, answer });
                    (computation, member)
                }
            }
        };
        computation.await
    }

    fn start(
        &self,
        ticket: &Ticket,
        work: impl Future<Output = Result<Vec<u8>, Problem>> + Send + 'static,
    ) -> Shared<Computation> {
        let entry = RunningEntry(ticket.clone());
        let computation = async move {
            // A panic would leave the other requests waiting. The panic itself is already in the log.
            let computed = AssertUnwindSafe(work).catch_unwind().await.unwrap_or_else(|_| {
                tracing::error!("the request failed with a panic");
                Err(Problem::internal())
            });
            let answer = Bytes::from(computed?.into_boxed_slice());
            let RunningEntry(Ticket { answers, name, .. }) = &entry;
            answers.keep(name.clone(), answer.clone());
            Ok(answer)
        };
        computation.boxed().shared()
    }

    fn running(&self) -> MutexGuard<'_, HashMap<Bytes, Running>> {
        self.shared.running.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl SharedAnswers {
    fn count_bytes(&self) {
        let kept = self.kept.as_ref().map_or(0, Cache::weight);
        let repeats = self.repeats.as_ref().map_or(0, Repeats::bytes);
        self.counts.bytes.set(i64::try_from(kept + repeats).unwrap_or(i64::MAX));
    }
}

impl fmt::Debug for SharedAnswers {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("SharedAnswers").field("counts", &self.counts).finish_non_exhaustive()
    }
}

/// The place of a computation among those under way.
#[derive(Debug, Clone)]
pub(crate) struct Ticket {
    answers: Answers,
    name: Bytes,
    has_begun: Arc<AtomicBool>,
}

impl Ticket {
    /// Says that the work has left the queue, so that requests of other clients join it. Returns the answer if another computation
    /// has kept it meanwhile.
    pub(crate) fn begin(&self) -> Option<Bytes> {
        self.has_begun.store(true, Ordering::Relaxed);
        self.answers.find(self.answers.is_permanent, &self.name)
    }
}

/// Removes a computation from those under way when it ends or is cancelled.
struct RunningEntry(Ticket);

impl Drop for RunningEntry {
    fn drop(&mut self) {
        let Ticket { answers, name, has_begun } = &self.0;
        let mut running = answers.running();
        if running.get(name).is_some_and(|entry| Arc::ptr_eq(&entry.state, has_begun)) {
            running.remove(name);
        }
    }
}

/// Weighs an answer with its name and its entry.
#[derive(Debug, Clone)]
struct InBytes;

impl Weighter<Bytes, Bytes> for InBytes {
    fn weight(&self, name: &Bytes, answer: &Bytes) -> u64 {
        (name.len() + answer.len() + limits::KEPT_ANSWER_OVERHEAD) as u64
    }
}

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

#[cfg(test)]
mod tests {
    use tokio::sync::oneshot;

    use super::*;
    use crate::limits::Limits;

    /// Two requests of one client for an answer that is computed by `work` once both wait.
    async fn waiting_for(
        answers: &Answers,
        work: impl FnOnce() -> Result<Vec<u8>, Problem> + Send + 'static,
    ) -> [Result<Bytes, Problem>; 2] {
        let (go, wait) = oneshot::channel();
        let ask = |answers: Answers| async move {
            let compute = |_, ticket: Ticket| async move {
                ticket.begin();
                wait.await.unwrap();
                work()
            };
            answers.once(Peer::NOBODY, Bytes::from_static(b"name"), compute).await
        };
        let first = tokio::spawn(ask(answers.clone()));
        while answers.counts().misses.get() == 0 {
            tokio::task::yield_now().await;
        }
        let again = answers.clone();
        let second = tokio::spawn(async move {
            let never = async |_: Pool, _: Ticket| -> Result<Vec<u8>, Problem> { unreachable!("it joins the first") };
            again.once(Peer::NOBODY, Bytes::from_static(b"name"), never).await
        });
        while answers.counts().joined.get() == 0 {
            tokio::task::yield_now().await;
        }
        go.send(()).unwrap();
        [first.await.unwrap(), second.await.unwrap()]
    }

    #[tokio::test]
    async fn all_who_wait_get_the_answer_the_error_or_the_panic() {
        type Work = fn() -> Result<Vec<u8>, Problem>;
        let works: [(Work, Result<&[u8], u16>); 3] = [
            (|| Ok(b"answer".to_vec()), Ok(b"answer")),
            (|| Err(Problem::not_readable("on purpose")), Err(400)),
            (|| panic!("on purpose"), Err(500)),
        ];
        for (work, expected) in works {
            let answers = Answers::new(&Pool::new(1, &Limits::default()), 1 << 20);
            for answer in waiting_for(&answers, work).await {
                assert_eq!(answer.as_deref().map_err(|problem| problem.status().as_u16()), expected);
            }
            assert!(answers.running().is_empty());
            assert_eq!(answers.find(false, b"name").is_some(), expected.is_ok());
        }
    }
}
