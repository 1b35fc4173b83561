//! One live client: sends it the impacts when they happen, and carries out its messages.
//!
//! A single loop waits for the clock, the client and the end of the server. Impacts are computed when they are due, never ahead;
//! messages that cannot be sent at once wait in the outbox. The carrier is a WebSocket or an event stream.

use std::pin::pin;
use std::time::Duration;

use axum::extract::ws::{Message, close_code};
use futures_util::{Sink, Stream, StreamExt};
use tokio::sync::mpsc;
use tokio::time::{Instant, sleep_until};

use crate::api::catches::request::never_caught;
use crate::api::scene::has_angle;
use crate::api::trajectories::columns::ImpactRow;
use crate::http::{Problem, ValidationError};
use crate::limits;
use crate::live::bounds::{SessionContext, TokenBucket};
use crate::live::client_message::ClientMessage;
use crate::live::close;
use crate::live::close::{Close, Unreadable};
use crate::live::impact_message::{HoldMessage, ImpactMessage};
use crate::live::next_strike::NextStrike;
use crate::live::outbox::Outbox;
use crate::live::run_url;
use crate::live::run_url::{LiveRequest, LiveRun};
use crate::live::server_message;
use crate::live::server_message::{Ack, Hello, OutgoingFrame, ServerMessage};
use crate::runs::held::HoldPart;
use crate::runs::interventions::NO_ANGLE;
use crate::runs::playback::{Playback, Step};
use crate::runs::run::ThrowOrder;

/// Serves a client until it leaves, breaks a bound, or the server is `closing`. [`crate::live::catch_up`] gives `playback`.
pub async fn serve(
    request: LiveRequest,
    playback: Result<Playback, Problem>,
    mut incoming: impl Stream<Item = Result<Message, Unreadable>> + Unpin + Send,
    outgoing: impl Sink<OutgoingFrame> + Unpin + Send + 'static,
    context: SessionContext,
    closing: impl Future<Output = ()> + Send,
) {
    let mut session = match playback {
        Ok(playback) => Session::new(request, playback, context),
        Err(problem) => return close::refuse(&problem, incoming, outgoing).await,
    };
    // One message is being sent while the next is chosen. All others wait in the outbox, where impacts can be skipped.
    let (sender, writer) = close::writer(outgoing);
    let close = session.run(&mut incoming, &sender, closing).await;
    let mut outbox = session.outbox;
    outbox.drop_impacts();
    if let Some((code, reason)) = close {
        outbox.push(OutgoingFrame::Close(code, reason));
    }
    close::say_goodbye(outbox, incoming, sender, writer).await;
}

struct Session {
    live: LiveRun,
    playback: Playback,
    /// Number of the first impact to send.
    first: u64,
    outbox: Outbox,
    context: SessionContext,
    /// True while past impacts are being sent, as fast as the client reads them.
    catching_up: bool,
    /// Run time at which the client came, s. So a run that is too fast to catch up is paced as well.
    came_at: f64,
    next_compute: Instant,
    next_ping: Instant,
    opened: Instant,
    last_heard: Instant,
    last_message: Instant,
    message_rate: TokenBucket,
}

impl Session {
    fn new(request: LiveRequest, playback: Playback, context: SessionContext) -> Self {
        let now = Instant::now();
        Self {
            came_at: request.live.clock.run_time((context.wall)()),
            live: request.live,
            playback,
            first: request.from.unwrap_or(1),
            outbox: Outbox::new(context.bounds.queue, request.columns),
            catching_up: true,
            next_compute: now,
            next_ping: now + context.bounds.ping,
            opened: now,
            last_heard: now,
            last_message: now,
            message_rate: TokenBucket::new(context.bounds.messages_per_s, now),
            context,
        }
    }

    async fn run(
        &mut self,
        incoming: &mut (impl Stream<Item = Result<Message, Unreadable>> + Unpin),
        sender: &mpsc::Sender<OutgoingFrame>,
        closing: impl Future<Output = ()>,
    ) -> Close {
        let mut closing = pin!(closing);
        self.send_hello((self.context.wall)());
        loop {
            while self.catching_up && self.outbox.is_empty() {
                let _slot = self.context.pool.inline_slot().await;
                self.compute_due((self.context.wall)());
            }
            if !self.catching_up && Instant::now() >= self.next_compute {
                let _slot = self.context.pool.inline_slot().await;
                self.context.lags.observe(self.next_compute.elapsed().as_secs_f64());
                self.compute_due((self.context.wall)());
            }
            if let Some(close) = self.broken_bound(Instant::now()) {
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
                            let _slot = self.context.pool.inline_slot().await;
                            if let Some(close) = self.handle(&message) {
                                return Some(close);
                            }
                        }
                    }
                }
                () = sleep_until(self.next_wakeup()) => {}
            }
        }
    }

    /// Sends the run, and its end if it has ended.
    fn send_hello(&mut self, now: u64) {
        let hello = Hello::new(&self.live, &self.playback, &self.context.base_path, now);
        self.outbox.push(ServerMessage::Hello(Box::new(hello)).to_frame());
        self.send_end();
    }

    /// Sends the end of the run, if it has ended.
    fn send_end(&mut self) {
        if let Some(end) = ServerMessage::end(&self.playback) {
            self.outbox.push(end.to_frame());
        }
    }

    /// Computes due impacts, up to a limit, and sets the time of the next computation.
    fn compute_due(&mut self, now: u64) {
        let begin = Instant::now();
        let run_time = self.live.clock.run_time(now);
        let (mut told, mut spent, mut last_flight) = (0, 0, None);
        let mut held: Option<HoldPart> = None;
        while told < limits::LIVE_BATCH
            && spent < limits::LIVE_BATCH_BOUNCES
            && self.playback.next_t().is_some_and(|t| t <= run_time)
        {
            let (step, price) = self.playback.advance(&self.live.run);
            (told, spent) = (told + 1, spent + price.as_bounces());
            match step {
                Step::Impact(contact) => {
                    self.tell_hold(held.take());
                    last_flight = contact.flight_time;
                    if contact.n >= self.first {
                        let has_angle = has_angle(self.live.run.scene());
                        let time = Some(self.live.clock.date(contact.t));
                        let row = ImpactRow { time, ..ImpactRow::new(self.playback.body(), has_angle, contact) };
                        let next_strike = NextStrike::of(&mut self.playback, &self.live.run);
                        self.outbox.push_impact(ImpactMessage { row, next_strike });
                    }
                }
                Step::Hold(part) => {
                    last_flight = Some(part.length());
                    held = match held.take().map(|before| before.joined(&part)) {
                        Some(Ok(joined)) => Some(joined),
                        Some(Err(before)) => {
                            self.tell_hold(Some(before));
                            Some(part)
                        }
                        None => Some(part),
                    };
                }
                Step::End => self.tell_hold(held.take()),
            }
            self.send_end();
        }
        self.tell_hold(held);
        self.context.bounces.inc_by(told as u64);
        let Some(t) = self.playback.next_t() else {
            self.catching_up = false;
            self.next_compute = begin + self.context.bounds.idle;
            return;
        };
        self.catching_up &= t <= self.came_at.min(run_time);
        let batch = begin + limits::LIVE_BATCH_TIME;
        if t <= run_time {
            self.next_compute = batch;
            return;
        }
        // At least once a second, since the wall clock may be set.
        let wait_ms = self.live.clock.wall_time(t).map_or(1000.0, |wall| wall.ceil() - now as f64).clamp(1.0, 1000.0);
        let due = begin + Duration::from_millis(wait_ms as u64);
        let is_fast = last_flight.is_some_and(|flight| flight * limits::LIVE_SINGLE_PER_S < self.live.clock.speed());
        self.next_compute = if is_fast { due.max(batch) } else { due };
    }

    /// Sends samples of a hold, if there are any.
    fn tell_hold(&mut self, part: Option<HoldPart>) {
        if let Some(part) = part {
            self.outbox.push(ServerMessage::Hold(&HoldMessage(part)).to_frame());
        }
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
        if !bounds.stays && self.playback.outcome().is_some() && self.outbox.is_empty() {
            return Some((close_code::NORMAL, "the run has ended"));
        }
        if self.is_idle() && now >= self.last_message + bounds.idle {
            return Some((close_code::NORMAL, "idle"));
        }
        let is_behind = self.outbox.waiting_since().is_some_and(|since| now >= since + bounds.behind);
        (is_behind || self.outbox.answers() > limits::LIVE_QUEUE).then_some((close_code::AGAIN, "too far behind"))
    }

    fn is_idle(&self) -> bool {
        self.playback.next_n().is_none() || self.live.clock.is_paused()
    }

    /// Time at which to look at the clock again.
    fn next_wakeup(&self) -> Instant {
        let bounds = &self.context.bounds;
        let idle = self.is_idle().then(|| self.last_message + bounds.idle);
        let behind = self.outbox.waiting_since().map(|since| since + bounds.behind);
        let compute = (!self.catching_up && self.playback.next_n().is_some()).then_some(self.next_compute);
        let end = (self.last_heard + bounds.silence).min(self.opened + bounds.lifetime);
        [Some(self.next_ping), idle, behind, compute].into_iter().flatten().fold(end, Instant::min)
    }

    /// Handles a message of the client.
    fn handle(&mut self, message: &Message) -> Option<(u16, &'static str)> {
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
            return Some((close_code::POLICY, "too many messages"));
        }
        if !is_client_message {
            return None;
        }
        let done = match message {
            Message::Text(text) if text.len() > limits::LIVE_MESSAGE_BYTES => {
                let (bytes, most) = (text.len(), limits::LIVE_MESSAGE_BYTES);
                Err(Problem::invalid_at("", format!("the message has {bytes} bytes; the limit is {most} bytes")))
            }
            Message::Text(text) => {
                ClientMessage::read(text).and_then(|message| self.apply(&message, (self.context.wall)()))
            }
            Message::Binary(_) | Message::Ping(_) | Message::Pong(_) | Message::Close(_) => {
                Err(Problem::invalid_at("", "the message is binary; it must be JSON text"))
            }
        };
        if let Err(problem) = done {
            self.outbox.push(server_message::problem(&problem));
        }
        None
    }

    fn apply(&mut self, message: &ClientMessage, now: u64) -> Result<(), Problem> {
        if !self.catching_up {
            // Due impacts have happened before the message.
            self.compute_due(now);
        }
        let mut live = self.live.clone();
        let mut impact = None;
        match message {
            ClientMessage::Pause => live.clock.pause(now),
            ClientMessage::Resume => live.clock.resume(now),
            ClientMessage::Speed(speed) => live.clock.set_speed(now, *speed),
            ClientMessage::Step => {
                let (n, t) = self.next_impact()?;
                if !live.clock.is_paused() {
                    return Err(Problem::invalid_at(
                        "/type",
                        "step is for a paused run, and this one is not; send pause",
                    ));
                }
                live.clock.step(now, t);
                impact = Some(n);
            }
            ClientMessage::Set(changes) => {
                let (n, _) = self.next_impact()?;
                live.run.set(n, changes).map_err(|errors| {
                    let pointer = |path: &str| if path.is_empty() { String::new() } else { format!("/{path}") };
                    Problem::invalid(
                        errors
                            .into_iter()
                            .map(|error| ValidationError { pointer: pointer(error.path), detail: error.detail })
                            .collect(),
                    )
                })?;
                impact = Some(n);
            }
            ClientMessage::Kick(kick) => {
                let (n, _) = self.next_impact()?;
                if let Some(t) = self.playback.held_until() {
                    let detail =
                        format!("the table holds the body (until t = {t} s at least); a kick acts after an impact");
                    return Err(Problem::invalid_at("/type", detail));
                }
                if kick.theta_dot != 0.0 && !has_angle(live.run.scene()) {
                    return Err(Problem::invalid_at("/theta_dot", NO_ANGLE));
                }
                live.run.kick(n, *kick).map_err(|detail| Problem::invalid_at("", detail))?;
                impact = Some(n);
            }
            ClientMessage::Catch(settings) => {
                let (n, _) = self.next_impact()?;
                self.can_be_caught(&live)?;
                if let Some(t) = self.playback.held_until() {
                    let detail = format!("the table holds the body already (until t = {t} s at least); throw it first");
                    return Err(Problem::invalid_at("/type", detail));
                }
                live.run.catch(n, *settings).map_err(|detail| Problem::invalid_at("", detail))?;
                impact = Some(n);
            }
            ClientMessage::Throw(target) => {
                let (n, _) = self.next_impact()?;
                self.can_be_caught(&live)?;
                self.playback.try_throw(target).map_err(|failure| Problem::invalid_at("/apex", failure.to_string()))?;
                let order = ThrowOrder { target: *target, t: self.playback.held_until() };
                live.run.throw(n, order).map_err(|detail| Problem::invalid_at("", detail))?;
                impact = Some(n);
            }
            ClientMessage::Restart => {
                let reached = self.playback.next_n().or(self.playback.outcome().map(|outcome| outcome.impacts));
                self.live = live.restarted(now, reached.unwrap_or_default());
                self.playback = Playback::new(&self.live.run, limits::LIVE_IMPACTS);
                (self.first, self.catching_up, self.next_compute) = (1, false, Instant::now());
                self.outbox.drop_impacts();
                self.send_hello(now);
                live = self.live.clone();
            }
        }
        live.clock.forget_beyond(limits::LIVE_CLOCK_ENTRIES);
        let adds = matches!(
            message,
            ClientMessage::Set(_) | ClientMessage::Kick(_) | ClientMessage::Catch(_) | ClientMessage::Throw(_)
        );
        if adds && run_url::is_too_long(&live) {
            let most = limits::URL_BYTES;
            let detail = format!("the run's URL would be over the limit of {most} bytes; restart keeps what was set");
            return Err(Problem::invalid_at("", detail));
        }
        self.live = live;
        self.next_compute = Instant::now();
        let ack = Ack {
            of: message.name(),
            url: &format!("{}{}", self.context.base_path, run_url::url(&self.live)),
            run_time: self.live.clock.run_time(now),
            now,
            speed: self.live.clock.speed(),
            paused: self.live.clock.is_paused(),
            impact,
            next_strike: NextStrike::of(&mut self.playback, &self.live.run),
        };
        self.outbox.push(ServerMessage::Ack(ack).to_frame());
        Ok(())
    }

    /// Refuses a catch or a throw of a body for which there is none.
    fn can_be_caught(&self, live: &LiveRun) -> Result<(), Problem> {
        never_caught(live.run.scene()).map_or(Ok(()), |(_, detail)| Err(Problem::invalid_at("/type", detail)))
    }

    /// Number and time of the next impact.
    fn next_impact(&self) -> Result<(u64, f64), Problem> {
        self.playback.next_n().zip(self.playback.next_t()).ok_or_else(|| {
            let n = self.playback.outcome().map_or(0, |outcome| outcome.impacts);
            Problem::invalid_at("/type", format!("the run has ended at impact {n}; send restart to begin anew"))
        })
    }
}
