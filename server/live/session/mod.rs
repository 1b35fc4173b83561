//! One live client: sends it the impacts when they happen, and carries out its messages.
//!
//! A single loop waits for the clock, the client and the end of the server. Impacts are computed when they are due, never ahead;
//! messages that cannot be sent at once wait in the outbox. The carrier is a WebSocket or an event stream.

mod course;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use axum::extract::ws::{Message, close_code};
use futures_util::future::{Either, select};
use futures_util::{Sink, Stream, StreamExt};
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::histogram::Histogram;
use tokio::sync::mpsc;
use tokio::time::{Instant, sleep_until};

use crate::compute::{Cancelled, Pool, Price, TimeSlice};
use crate::http::Problem;
use crate::limits;
use crate::limits::{Limit, Limits};
use crate::live::client_message::ClientMessage;
use crate::live::outbox::{Close, Outbox, Unreadable};
use crate::live::run_url::LiveRequest;
use crate::live::server_message::OutgoingFrame;
use crate::live::session::course::{Course, GoOn, Told, Unapplied};
use crate::live::{outbox, server_message};
use crate::runs::playback::Playback;

/// Serves a client until it leaves, breaks a bound, or the server is `closing`. [`crate::live::catch_up`] gives `playback`.
pub async fn serve(
    request: LiveRequest,
    playback: Result<Playback, Problem>,
    mut incoming: Inbox<impl Stream<Item = Result<Message, Unreadable>> + Unpin + Send>,
    outgoing: impl Sink<OutgoingFrame> + Unpin + Send + 'static,
    context: SessionContext,
    closing: impl Future<Output = ()> + Send,
) {
    let mut session = match playback {
        Ok(playback) => Session::new(request, playback, context),
        Err(problem) => return outbox::refuse(&problem, incoming, outgoing).await,
    };
    // One message is being sent while the next is chosen. All others wait in the outbox, where impacts can be skipped.
    let (sender, writer) = outbox::writer(outgoing);
    let mut closing = pin!(closing);
    // A client that comes during a shutdown is told its run too.
    let close = match session.greet(&mut incoming).await {
        Err(close) => close,
        Ok(()) => tokio::select! {
            () = &mut closing => Some((close_code::AWAY, "the server is shutting down")),
            close = session.run(&mut incoming, &sender) => close,
        },
    };
    let mut outbox = session.outbox;
    outbox.drop_impacts();
    if let Some((code, reason)) = close {
        outbox.push(OutgoingFrame::Close(code, reason));
    }
    outbox::say_goodbye(outbox, incoming, sender, writer).await;
}

struct Session {
    course: Course,
    outbox: Outbox,
    context: SessionContext,
    next_ping: Instant,
    opened: Instant,
    last_heard: Instant,
    last_message: Instant,
    message_rate: TokenBucket,
}

impl Session {
    fn new(request: LiveRequest, playback: Playback, context: SessionContext) -> Self {
        let now = Instant::now();
        let outbox = Outbox::new(context.bounds.queue);
        Self {
            course: Course::new(request, playback, (context.wall)(), context.bounds.idle),
            outbox,
            next_ping: now + context.bounds.ping,
            opened: now,
            last_heard: now,
            last_message: now,
            message_rate: TokenBucket::new(context.bounds.messages_per_s, now),
            context,
        }
    }

    /// Says hello.
    async fn greet(
        &mut self,
        incoming: &mut Inbox<impl Stream<Item = Result<Message, Unreadable>> + Unpin>,
    ) -> Result<(), Close> {
        let (base_path, now) = (self.context.base_path.clone(), (self.context.wall)());
        self.advance(incoming, move |course: &mut Course, go_on: GoOn<'_>| course.tell_hello(&base_path, now, go_on))
            .await
    }

    async fn run(
        &mut self,
        incoming: &mut Inbox<impl Stream<Item = Result<Message, Unreadable>> + Unpin>,
        sender: &mpsc::Sender<OutgoingFrame>,
    ) -> Close {
        loop {
            while self.course.catching_up && self.outbox.is_empty() {
                if let Err(close) = self.compute_due(incoming).await {
                    return close;
                }
            }
            if !self.course.catching_up && Instant::now() >= self.course.next_compute {
                let due = self.course.next_compute;
                if let Err(close) = self.compute_due(incoming).await {
                    return close;
                }
                self.context.lags.observe(due.elapsed().as_secs_f64());
            }
            if let Some(close) = self.broken_bound(Instant::now()) {
                return Some(close);
            }
            tokio::select! {
                permit = sender.reserve(), if !self.outbox.is_empty() => {
                    let Ok(permit) = permit else { return None };
                    if let Some(frame) = self.outbox.pop() {
                        permit.send(frame);
                    }
                }
                message = incoming.next() => {
                    self.last_heard = Instant::now();
                    match message {
                        None | Some(Ok(Message::Close(_))) => return None,
                        Some(Err(unreadable)) => return unreadable.close(),
                        Some(Ok(message)) => {
                            if let Err(close) = self.handle(&message, incoming).await {
                                return close;
                            }
                        }
                    }
                }
                () = sleep_until(self.next_wakeup()) => {}
            }
        }
    }

    async fn compute_due(
        &mut self,
        incoming: &mut Inbox<impl Stream<Item = Result<Message, Unreadable>> + Unpin>,
    ) -> Result<(), Close> {
        let wall = self.context.wall;
        self.advance(incoming, move |course: &mut Course, go_on: GoOn<'_>| course.compute_due(wall(), go_on)).await
    }

    /// Does work that must be done. The session ends if the server is overloaded: the client comes back to the run's URL.
    async fn advance(
        &mut self,
        incoming: &mut Inbox<impl Stream<Item = Result<Message, Unreadable>> + Unpin>,
        work: impl FnOnce(&mut Course, GoOn<'_>) -> Result<(), Cancelled> + Clone + Send + 'static,
    ) -> Result<(), Close> {
        self.work(incoming, work).await?.map_err(|problem| {
            self.outbox.push(server_message::problem(&problem));
            Some((close_code::AGAIN, "busy"))
        })
    }

    /// Works on the course: on this thread if it is done soon, else in the pool, until the client leaves.
    ///
    /// # Errors
    /// The client has left. Inside, the server is overloaded.
    async fn work<T: Send + 'static>(
        &mut self,
        incoming: &mut Inbox<impl Stream<Item = Result<Message, Unreadable>> + Unpin>,
        work: impl FnOnce(&mut Course, GoOn<'_>) -> Result<T, Cancelled> + Clone + Send + 'static,
    ) -> Result<Result<T, Problem>, Close> {
        let mut course = self.course.clone();
        let job = move |slice: &TimeSlice| {
            let done = work(&mut course, &mut || slice.should_continue())?;
            Ok::<_, Problem>((course, done))
        };
        let done = incoming.attend(self.context.pool.run(Price::bounces(0), job)).await;
        let Some(done) = done else { return Err(incoming.close()) };
        let (course, done) = match done {
            Ok(done) => done,
            Err(problem) => return Ok(Err(problem)),
        };
        self.course = course;
        let (told, made) = self.course.take_told();
        self.context.bounces.inc_by(made);
        for told in told {
            match told {
                Told::Impact(impact) => self.outbox.push_impact(*impact),
                Told::Frame(frame) => self.outbox.push(frame),
                Told::NewRun => self.outbox.drop_impacts(),
            }
        }
        Ok(Ok(done))
    }

    /// Returns the close for a broken bound, if there is one. Sends pings.
    fn broken_bound(&mut self, now: Instant) -> Option<(u16, &'static str)> {
        let bounds = &self.context.bounds;
        if now >= self.next_ping {
            self.outbox.push(OutgoingFrame::Ping);
            self.next_ping = now + bounds.ping;
        }
        if now >= self.opened + bounds.lifetime {
            return Some((close_code::AWAY, "open for the time that the limit allows"));
        }
        if now >= self.last_heard + bounds.silence {
            return Some((close_code::POLICY, "no answer to pings"));
        }
        if !bounds.stays && self.course.playback.outcome().is_some() && self.outbox.is_empty() {
            return Some((close_code::NORMAL, "the run has ended"));
        }
        if self.is_idle() && now >= self.last_message + bounds.idle {
            return Some((close_code::NORMAL, "idle"));
        }
        let is_behind = self.outbox.waiting_since().is_some_and(|since| now >= since + bounds.behind);
        (is_behind || self.outbox.answers() > limits::LIVE_QUEUE).then_some((close_code::AGAIN, "too far behind"))
    }

    fn is_idle(&self) -> bool {
        self.course.playback.next_n().is_none() || self.course.live.clock.is_paused()
    }

    /// Time at which to look at the clock again.
    fn next_wakeup(&self) -> Instant {
        let bounds = &self.context.bounds;
        let idle = self.is_idle().then(|| self.last_message + bounds.idle);
        let behind = self.outbox.waiting_since().map(|since| since + bounds.behind);
        let compute =
            (!self.course.catching_up && self.course.playback.next_n().is_some()).then_some(self.course.next_compute);
        let end = (self.last_heard + bounds.silence).min(self.opened + bounds.lifetime);
        [Some(self.next_ping), idle, behind, compute].into_iter().flatten().fold(end, Instant::min)
    }

    /// Handles a message of the client.
    async fn handle(
        &mut self,
        message: &Message,
        incoming: &mut Inbox<impl Stream<Item = Result<Message, Unreadable>> + Unpin>,
    ) -> Result<(), Close> {
        let now = Instant::now();
        let is_client_message = !matches!(message, Message::Ping(_) | Message::Pong(_));
        if is_client_message {
            self.last_message = now;
        }
        // Pings count too: each is answered.
        if !self.message_rate.try_take(now) {
            let most = self.context.bounds.messages_per_s;
            let detail = format!("more than {most} messages a second, which is the limit");
            self.outbox.push(server_message::problem(&Problem::invalid_at("", detail)));
            return Err(Some((close_code::POLICY, "too many messages")));
        }
        if !is_client_message {
            return Ok(());
        }
        let done = match message {
            Message::Text(text) if text.len() > limits::LIVE_MESSAGE_BYTES => {
                let (bytes, most) = (text.len(), limits::LIVE_MESSAGE_BYTES);
                Err(Problem::invalid_at("", format!("the message has {bytes} bytes; the limit is {most} bytes")))
            }
            Message::Text(text) => match ClientMessage::read(text) {
                Ok(message) => self.apply(message, incoming).await?,
                Err(problem) => Err(problem),
            },
            Message::Binary(_) | Message::Ping(_) | Message::Pong(_) | Message::Close(_) => {
                Err(Problem::invalid_at("", "the message is binary; it must be JSON text"))
            }
        };
        if let Err(problem) = done {
            self.outbox.push(server_message::problem(&problem));
        }
        Ok(())
    }

    async fn apply(
        &mut self,
        message: ClientMessage,
        incoming: &mut Inbox<impl Stream<Item = Result<Message, Unreadable>> + Unpin>,
    ) -> Result<Result<(), Problem>, Close> {
        let (base_path, now) = (self.context.base_path.clone(), (self.context.wall)());
        let apply = move |course: &mut Course, go_on: GoOn<'_>| match course.apply(&message, (&base_path, now), go_on) {
            Ok(()) => Ok(Ok(())),
            Err(Unapplied::Refused(problem)) => Ok(Err(problem)),
            Err(Unapplied::Cancelled) => Err(Cancelled),
        };
        Ok(self.work(incoming, apply).await?.and_then(|applied| applied))
    }
}

// Messages of a live client, which may come while work for it is under way: work ends with the client.

type Incoming = Result<Message, Unreadable>;

/// Messages of a client. Those that came during work wait for their turn.
#[derive(Debug)]
pub struct Inbox<S> {
    stream: S,
    waiting: VecDeque<Incoming>,
}

impl<S: Stream<Item = Incoming> + Unpin> Inbox<S> {
    /// The messages of this stream.
    pub fn new(stream: S) -> Self {
        Self { stream, waiting: VecDeque::new() }
    }

    /// Waits for work that the client waits for. `None` if the client leaves before, which drops the work.
    pub async fn attend<T>(&mut self, work: impl Future<Output = T>) -> Option<T> {
        let mut work = pin!(work);
        // A client that sends more than this is not read until the work is done.
        while self.waiting.len() < limits::LIVE_QUEUE {
            match select(work.as_mut(), self.stream.next()).await {
                Either::Left((done, _)) => return Some(done),
                Either::Right((None | Some(Ok(Message::Close(_))), _)) => return None,
                Either::Right((Some(Err(unreadable)), _)) => {
                    self.waiting = VecDeque::from([Err(unreadable)]);
                    return None;
                }
                Either::Right((Some(message), _)) => self.waiting.push_back(message),
            }
        }
        Some(work.await)
    }

    /// The close for a client that has left during work.
    fn close(&self) -> crate::live::outbox::Close {
        self.waiting.front().and_then(|last| last.as_ref().err()).and_then(|unreadable| unreadable.close())
    }
}

impl<S: Stream<Item = Incoming> + Unpin> Stream for Inbox<S> {
    type Item = Incoming;

    fn poll_next(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Incoming>> {
        match self.waiting.pop_front() {
            Some(message) => Poll::Ready(Some(message)),
            None => self.stream.poll_next_unpin(context),
        }
    }
}

// Bounds of one live client: times, numbers and rates, from the server's limits, and the parts of the server that it uses. Tests use
// smaller ones.

/// The server's clock, unix ms.
pub fn wall_now() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_millis()).unwrap_or_default()
}

/// Parts of the server that a session uses.
#[derive(Debug, Clone)]
pub struct SessionContext {
    /// The clock of the runs, unix ms: [`wall_now`], except in tests.
    pub wall: fn() -> u64,
    /// Runs long work.
    pub pool: Pool,
    /// Counts the bounces.
    pub bounces: Counter,
    /// Delay of computing due impacts, s.
    pub lags: Histogram,
    /// Path in front of the run's URL, as clients see it.
    pub base_path: Arc<str>,
    /// Bounds of the session.
    pub bounds: SessionBounds,
}

#[cfg(test)]
impl SessionContext {
    /// A context with these bounds and a pool of its own.
    pub(crate) fn for_test(bounds: SessionBounds) -> Self {
        let pool = Pool::new(1, &Limits::default());
        let (bounces, lags) = (Counter::default(), Histogram::new([]));
        Self { wall: wall_now, pool, bounces, lags, base_path: "".into(), bounds }
    }
}

/// Bounds of one session.
#[derive(Debug, Clone, Copy)]
pub struct SessionBounds {
    /// Impacts that may wait for a slow client.
    pub queue: usize,
    /// Time that a client may be behind.
    pub behind: Duration,
    /// Time between pings.
    pub ping: Duration,
    /// Time without a message or pong from the client.
    pub silence: Duration,
    /// Lifetime of the connection.
    pub lifetime: Duration,
    /// Time without a message while the run is paused or has ended.
    pub idle: Duration,
    /// True if the session stays open after the end of the run, for a client that may restart it.
    pub stays: bool,
    /// Messages per second.
    pub messages_per_s: u32,
    /// Work of catching up.
    pub catch_up: Limit,
}

impl SessionBounds {
    /// Bounds of a WebSocket.
    pub fn for_websocket(limits: &Limits) -> Self {
        Self {
            queue: limits::LIVE_QUEUE,
            behind: limits::LIVE_BEHIND_TIME,
            ping: limits::LIVE_PING_TIME,
            silence: limits::LIVE_SILENCE_TIME,
            lifetime: limits.live_time,
            idle: limits.live_idle_time,
            stays: true,
            messages_per_s: limits::LIVE_MESSAGES_PER_S,
            catch_up: limits::LIVE_CATCH_UP,
        }
    }

    /// Bounds of an event stream, whose client never sends anything.
    pub fn for_sse(limits: &Limits) -> Self {
        let lifetime = limits.events_time;
        Self { silence: lifetime, lifetime, stays: false, ..Self::for_websocket(limits) }
    }
}

/// A token bucket for messages: so many per second, saved up for three seconds.
#[derive(Debug)]
pub struct TokenBucket {
    per_s: f64,
    left: f64,
    at: Instant,
}

impl TokenBucket {
    /// A full bucket.
    pub fn new(per_s: u32, now: Instant) -> Self {
        Self { per_s: per_s.into(), left: 3.0 * f64::from(per_s), at: now }
    }

    /// Takes a token if there is one.
    pub fn try_take(&mut self, now: Instant) -> bool {
        let earned = (now - self.at).as_secs_f64() * self.per_s;
        (self.left, self.at) = ((self.left + earned).min(3.0 * self.per_s), now);
        if self.left < 1.0 {
            return false;
        }
        self.left -= 1.0;
        true
    }
}
