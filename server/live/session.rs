//! One live client: what it hears and when, and what it may ask for.
//!
//! A single loop over the clock, the client and the server's end. Impacts are computed when they are due, never ahead;
//! what cannot be sent at once waits in the outbox. Not here: what carries it, a WebSocket or Server-Sent Events.

use std::pin::pin;
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use axum::extract::ws::{CloseFrame, Message, Utf8Bytes, close_code};
use futures_util::{Sink, SinkExt, Stream, StreamExt};
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::histogram::Histogram;
use tokio::sync::mpsc;
use tokio::time::{sleep_until, timeout};

use crate::api::scene::has_angle;
use crate::compute::{Limit, Pool, Turn};
use crate::http::{FieldError, Problem};
use crate::limits;
use crate::live::bounds::{Allowance, Bounds};
use crate::live::client_message::Order;
use crate::live::close::{Close, Unreadable};
use crate::live::outbox::Outbox;
use crate::live::server_message;
use crate::live::server_message::{Ack, Frame, Hello, Said};
use crate::runs::playback;
use crate::runs::playback::{Course, NotCaughtUp};
use crate::runs::run::Run;
use crate::runs::run_url;
use crate::runs::run_url::{Asked, NO_ANGLE};

/// What a session needs of the server.
#[derive(Debug, Clone)]
pub struct Place {
    /// Where long work is done.
    pub pool: Pool,
    /// Counts the bounces.
    pub bounces: Counter,
    /// How late impacts are looked for, s.
    pub lags: Histogram,
    /// What stands before its URLs as clients see them.
    pub base_path: Arc<str>,
    /// The bounds to keep.
    pub bounds: Bounds,
}

#[cfg(test)]
impl Place {
    /// One of its own, with these bounds.
    pub(crate) fn alone(bounds: Bounds) -> Self {
        let pool = Pool::new(1, &limits::Limits::default());
        Self { pool, bounces: Counter::default(), lags: Histogram::new([]), base_path: "".into(), bounds }
    }
}

/// The server's clock, unix ms.
pub fn wall_now() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_millis()).unwrap_or_default()
}

impl From<Frame> for Message {
    fn from(frame: Frame) -> Self {
        match frame {
            Frame::Message { text, .. } => Message::text(text),
            Frame::Ping => Message::Ping(axum::body::Bytes::new()),
            Frame::Close(code, reason) => {
                Message::Close(Some(CloseFrame { code, reason: Utf8Bytes::from_static(reason) }))
            }
        }
    }
}

/// Tells a client its run until it leaves, breaks a bound, or the server is `closing`. What there is to tell first has been
/// found by [`caught_up`].
pub async fn serve(
    asked: Asked,
    course: Result<Course, Problem>,
    mut incoming: impl Stream<Item = Result<Message, Unreadable>> + Unpin + Send,
    outgoing: impl Sink<Frame> + Unpin + Send + 'static,
    place: Place,
    closing: impl Future<Output = ()> + Send,
) {
    // One message is being sent while the next is chosen: all others wait where they can still be left out.
    let (sender, receiver) = mpsc::channel(1);
    let mut writer = tokio::spawn(write(receiver, outgoing));
    let mut outbox = Outbox::new(place.bounds.queue);
    let close = match course {
        Ok(course) => {
            let mut session = Session::new(asked, course, outbox, place);
            let close = session.run(&mut incoming, &sender, closing).await;
            outbox = session.outbox;
            close
        }
        Err(problem) => {
            outbox.push(server_message::problem(&problem));
            let overloaded = problem.status().is_server_error();
            Some(if overloaded { (close_code::AGAIN, "busy") } else { (close_code::POLICY, "over budget") })
        }
    };
    outbox.forget_impacts();
    if let Some((code, reason)) = close {
        outbox.push(Frame::Close(code, reason));
    }
    let goodbye = async {
        while let Some(frame) = outbox.pop() {
            if sender.send(frame).await.is_err() {
                break;
            }
        }
        drop(sender);
        let _ = (&mut writer).await;
        // Until the client has closed too, so that it gets all of this.
        while let Some(Ok(_)) = incoming.next().await {}
    };
    let _ = timeout(limits::GOODBYE_TIME, goodbye).await;
    writer.abort();
}

async fn write(mut receiver: mpsc::Receiver<Frame>, mut outgoing: impl Sink<Frame> + Unpin) {
    while let Some(frame) = receiver.recv().await {
        if outgoing.send(frame).await.is_err() {
            return;
        }
    }
    // What was said last has been flushed; dropping the other half ends the connection.
}

/// The run where the telling begins. Little work is done here, much in the pool.
///
/// # Errors
/// Where it is too far back, or the pool is busy.
pub async fn caught_up(asked: &Asked, place: &Place) -> Result<Course, Problem> {
    let until = asked.run.clock.run_time(wall_now());
    let limit = place.bounds.catch_up;
    let little = Limit { most: limit.most.min(limits::INLINE_BOUNCES), ..limit };
    let course = match place.pool.run_inline(|turn| playback::catch_up(asked, until, &little, turn)).await {
        None | Some(Err(NotCaughtUp::OverBudget(_))) => {
            let asked = asked.clone();
            let work = move |turn: &Turn| playback::catch_up(&asked, until, &limit, turn).map_err(Problem::from);
            place.pool.run_apart(work).await?
        }
        Some(other) => other?,
    };
    place.bounces.inc_by(course.next_n().unwrap_or_default());
    Ok(course)
}

struct Session {
    run: Run,
    course: Course,
    /// The first impact that the client wants to hear of.
    first: u64,
    outbox: Outbox,
    place: Place,
    /// Whether impacts of before the client came are being told, as fast as it takes them.
    catching_up: bool,
    /// The run time at which it came, s. A run so fast that it never catches up is still paced.
    came_at: f64,
    next_pump: Instant,
    next_ping: Instant,
    opened: Instant,
    last_heard: Instant,
    last_order: Instant,
    allowance: Allowance,
}

impl Session {
    fn new(asked: Asked, course: Course, outbox: Outbox, place: Place) -> Self {
        let now = Instant::now();
        Self {
            came_at: asked.run.clock.run_time(wall_now()),
            run: asked.run,
            course,
            first: asked.from.unwrap_or(1),
            outbox,
            catching_up: true,
            next_pump: now,
            next_ping: now + place.bounds.ping,
            opened: now,
            last_heard: now,
            last_order: now,
            allowance: Allowance::new(place.bounds.messages_per_s, now),
            place,
        }
    }

    async fn run(
        &mut self,
        incoming: &mut (impl Stream<Item = Result<Message, Unreadable>> + Unpin),
        sender: &mpsc::Sender<Frame>,
        closing: impl Future<Output = ()>,
    ) -> Close {
        let mut closing = pin!(closing);
        self.greet(wall_now());
        loop {
            while self.catching_up && self.outbox.is_empty() {
                let _slot = self.place.pool.slot().await;
                self.pump(wall_now());
            }
            if !self.catching_up && Instant::now() >= self.next_pump {
                let _slot = self.place.pool.slot().await;
                self.place.lags.observe(self.next_pump.elapsed().as_secs_f64());
                self.pump(wall_now());
            }
            if let Some(close) = self.overdue(Instant::now()) {
                return Some(close);
            }
            tokio::select! {
                () = &mut closing => return Some((close_code::AWAY, "the server is shutting down")),
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
                            let _slot = self.place.pool.slot().await;
                            if let Some(close) = self.hear(&message) {
                                return Some(close);
                            }
                        }
                    }
                }
                () = sleep_until(self.wake().into()) => {}
            }
        }
    }

    /// Says which run it is.
    fn greet(&mut self, now: u64) {
        let hello = Hello::new(&self.run, &self.course, &self.place.base_path, now);
        self.outbox.push(Said::Hello(Box::new(hello)).to_frame());
        if let Some(outcome) = self.course.outcome() {
            self.outbox.push(Said::End { outcome, demand: self.course.demand().into() }.to_frame());
        }
    }

    /// Computes what is due, but not too much at a time, and sets when to look again.
    fn pump(&mut self, now: u64) {
        let begin = Instant::now();
        let run_time = self.run.clock.run_time(now);
        let (mut told, mut spent, mut last_flight) = (0, 0, None);
        while told < limits::LIVE_BATCH
            && spent < limits::LIVE_BATCH_BOUNCES
            && self.course.next_t().is_some_and(|t| t <= run_time)
        {
            let (impact, price) = self.course.tell(&self.run);
            (told, spent, last_flight) = (told + 1, spent + price.as_bounces(), impact.flight_time());
            if impact.n >= self.first {
                self.outbox.push_impact(impact);
            }
            if let Some(outcome) = self.course.outcome() {
                self.outbox.push(Said::End { outcome, demand: self.course.demand().into() }.to_frame());
            }
        }
        self.place.bounces.inc_by(told as u64);
        let Some(t) = self.course.next_t() else {
            self.catching_up = false;
            self.next_pump = begin + self.place.bounds.idle;
            return;
        };
        self.catching_up &= t <= self.came_at.min(run_time);
        let batch = begin + limits::LIVE_BATCH_TIME;
        if t <= run_time {
            self.next_pump = batch;
            return;
        }
        // Looked at once a second at least, since the wall clock may be set.
        let wait_ms = self.run.clock.wall_time(t).map_or(1000.0, |wall| wall.ceil() - now as f64).clamp(1.0, 1000.0);
        let due = begin + Duration::from_millis(wait_ms as u64);
        let is_fast = last_flight.is_some_and(|flight| flight * limits::LIVE_SINGLE_PER_S < self.run.clock.speed());
        self.next_pump = if is_fast { due.max(batch) } else { due };
    }

    /// The bound that has been broken, if one has; pings on the way.
    fn overdue(&mut self, now: Instant) -> Option<(u16, &'static str)> {
        let bounds = &self.place.bounds;
        if now >= self.next_ping {
            self.outbox.push(Frame::Ping);
            self.next_ping = now + bounds.ping;
        }
        if now >= self.opened + bounds.lifetime {
            return Some((close_code::AWAY, "open for the time that the limit allows"));
        }
        if now >= self.last_heard + bounds.silence {
            return Some((close_code::POLICY, "no answer to pings"));
        }
        if !bounds.stays && self.course.outcome().is_some() && self.outbox.is_empty() {
            return Some((close_code::NORMAL, "the run has ended"));
        }
        if self.is_idle() && now >= self.last_order + bounds.idle {
            return Some((close_code::NORMAL, "idle"));
        }
        let is_behind = self.outbox.waiting_since().is_some_and(|since| now >= since + bounds.behind);
        (is_behind || self.outbox.answers() > limits::LIVE_QUEUE).then_some((close_code::AGAIN, "too far behind"))
    }

    fn is_idle(&self) -> bool {
        self.course.next_n().is_none() || self.run.clock.is_paused()
    }

    /// When to look at the time again.
    fn wake(&self) -> Instant {
        let bounds = &self.place.bounds;
        let idle = self.is_idle().then(|| self.last_order + bounds.idle);
        let behind = self.outbox.waiting_since().map(|since| since + bounds.behind);
        let pump = (!self.catching_up && self.course.next_n().is_some()).then_some(self.next_pump);
        let end = (self.last_heard + bounds.silence).min(self.opened + bounds.lifetime);
        [Some(self.next_ping), idle, behind, pump].into_iter().flatten().fold(end, Instant::min)
    }

    /// Takes a message.
    fn hear(&mut self, message: &Message) -> Option<(u16, &'static str)> {
        let now = Instant::now();
        let is_order = !matches!(message, Message::Ping(_) | Message::Pong(_));
        if is_order {
            self.last_order = now;
        }
        // Pings too: each is answered.
        if !self.allowance.takes(now) {
            let most = self.place.bounds.messages_per_s;
            let detail = format!("more than {most} messages a second, which is the limit");
            self.outbox.push(server_message::problem(&Problem::invalid_at("", detail)));
            return Some((close_code::POLICY, "too many messages"));
        }
        if !is_order {
            return None;
        }
        let done = match message {
            Message::Text(text) if text.len() > limits::LIVE_MESSAGE_BYTES => {
                let (bytes, most) = (text.len(), limits::LIVE_MESSAGE_BYTES);
                Err(Problem::invalid_at("", format!("the message has {bytes} bytes; the limit is {most} bytes")))
            }
            Message::Text(text) => Order::read(text).and_then(|order| self.carry_out(&order, wall_now())),
            _ => Err(Problem::invalid_at("", "the message is binary; it must be JSON text")),
        };
        if let Err(problem) = done {
            self.outbox.push(server_message::problem(&problem));
        }
        None
    }

    fn carry_out(&mut self, order: &Order, now: u64) -> Result<(), Problem> {
        if !self.catching_up {
            // What is due has happened before the order.
            self.pump(now);
        }
        let mut run = self.run.clone();
        let mut impact = None;
        match order {
            Order::Pause => run.clock.pause(now),
            Order::Resume => run.clock.resume(now),
            Order::Speed(speed) => run.clock.set_speed(now, *speed),
            Order::Step => {
                let (n, t) = self.coming()?;
                if !run.clock.is_paused() {
                    return Err(Problem::invalid_at(
                        "/type",
                        "step is for a paused run, and this one is not; send pause",
                    ));
                }
                run.clock.step(now, t);
                impact = Some(n);
            }
            Order::Set(changes) => {
                let (n, _) = self.coming()?;
                run.set(n, changes).map_err(|errors| {
                    let place = |path: &str| if path.is_empty() { String::new() } else { format!("/{path}") };
                    Problem::invalid(
                        errors
                            .into_iter()
                            .map(|error| FieldError { pointer: place(error.path), detail: error.detail })
                            .collect(),
                    )
                })?;
                impact = Some(n);
            }
            Order::Kick(kick) => {
                let (n, _) = self.coming()?;
                if kick.theta_dot != 0.0 && !has_angle(run.scene()) {
                    return Err(Problem::invalid_at("/theta_dot", NO_ANGLE));
                }
                run.kick(n, *kick).map_err(|detail| Problem::invalid_at("", detail))?;
                impact = Some(n);
            }
            Order::Restart => {
                let reached = self.course.next_n().or(self.course.outcome().map(|outcome| outcome.impacts));
                self.run = run.restarted(now, reached.unwrap_or_default());
                self.course = Course::new(&self.run);
                (self.first, self.catching_up, self.next_pump) = (1, false, Instant::now());
                self.outbox.forget_impacts();
                self.greet(now);
                run = self.run.clone();
            }
        }
        run.clock.forget_beyond(limits::LIVE_CLOCK_ENTRIES);
        if matches!(order, Order::Set(_) | Order::Kick(_)) && run_url::is_too_long(&run) {
            let most = limits::URL_BYTES;
            let detail = format!("the run's URL would be over the limit of {most} bytes; restart keeps what was set");
            return Err(Problem::invalid_at("", detail));
        }
        self.run = run;
        self.next_pump = Instant::now();
        let ack = Ack {
            of: order.name(),
            url: &format!("{}{}", self.place.base_path, run_url::url(&self.run)),
            run_time: self.run.clock.run_time(now),
            now,
            speed: self.run.clock.speed(),
            paused: self.run.clock.is_paused(),
            impact,
        };
        self.outbox.push(Said::Ack(ack).to_frame());
        Ok(())
    }

    /// The coming impact, its number and its time.
    fn coming(&self) -> Result<(u64, f64), Problem> {
        self.course.next_n().zip(self.course.next_t()).ok_or_else(|| {
            let n = self.course.outcome().map_or(0, |outcome| outcome.impacts);
            Problem::invalid_at("/type", format!("the run has ended at impact {n}; send restart to begin anew"))
        })
    }
}
