//! A live run and the position in it: what becomes due, and the messages that change it. A session computes with a copy, which takes the
//! place of the original once the work is done, and is dropped with the work if the client leaves.

use std::mem::take;
use std::time::Duration;

use equipoise_physics::scene::capability::Analysis;
use tokio::time::Instant;

use crate::api::computed::trajectories::columns::ImpactRow;
use crate::api::scene::has_angle;
use crate::api::shared::refusal::lacking;
use crate::compute::Cancelled;
use crate::http::{Problem, ProblemError};
use crate::limits;
use crate::live::client_message::ClientMessage;
use crate::live::run_url;
use crate::live::run_url::{LiveRequest, LiveRun};
use crate::live::server_message::{Ack, Hello, ImpactMessage, LiveNextStrike, OutgoingFrame, ServerMessage};
use crate::runs::caught::HoldPart;
use crate::runs::interventions::NO_ANGLE;
use crate::runs::playback::{Playback, Step};
use crate::runs::run::ThrowOrder;

/// Asks whether to go on.
pub(super) type GoOn<'a> = &'a mut dyn FnMut() -> bool;

/// Something to tell the client.
#[derive(Debug, Clone)]
pub(super) enum Told {
    /// An impact.
    Impact(Box<ImpactMessage>),
    /// Any other message.
    Frame(OutgoingFrame),
    /// A new run begins: impacts of the one before that still wait are no more of interest.
    NewRun,
}

/// A live run and the position in it.
#[derive(Debug, Clone)]
pub(super) struct Course {
    pub(super) live: LiveRun,
    pub(super) playback: Playback,
    /// Number of the first impact to send.
    first: u64,
    /// True while past impacts are being sent, as fast as the client reads them.
    pub(super) catching_up: bool,
    /// Run time at which the client came, s. So a run that is too fast to catch up is paced as well.
    came_at: f64,
    pub(super) next_compute: Instant,
    /// Time without a message while the run is paused or has ended.
    idle: Duration,
    /// Messages that are not in the outbox yet.
    told: Vec<Told>,
    /// Steps that are not counted yet.
    made: u64,
}

/// Reason for which a message changes nothing.
pub(super) enum Unapplied {
    /// It cannot be applied.
    Refused(Problem),
    /// The work was stopped.
    Cancelled,
}

impl From<Problem> for Unapplied {
    fn from(problem: Problem) -> Self {
        Self::Refused(problem)
    }
}

impl From<Cancelled> for Unapplied {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl Course {
    pub(super) fn new(request: LiveRequest, playback: Playback, wall: u64, idle: Duration) -> Self {
        Self {
            came_at: request.live.clock.run_time(wall),
            live: request.live,
            playback,
            first: request.from.unwrap_or(1),
            catching_up: true,
            next_compute: Instant::now(),
            idle,
            told: Vec::new(),
            made: 0,
        }
    }

    /// Messages to send and steps to count since the last question.
    pub(super) fn take_told(&mut self) -> (Vec<Told>, u64) {
        (take(&mut self.told), take(&mut self.made))
    }

    fn tell(&mut self, frame: OutgoingFrame) {
        self.told.push(Told::Frame(frame));
    }

    /// Tells the run, and its end if it has ended.
    pub(super) fn tell_hello(&mut self, base_path: &str, now: u64, go_on: GoOn<'_>) -> Result<(), Cancelled> {
        let hello = Hello::new(&self.live, &self.playback, (base_path, now), go_on)?;
        let frame = ServerMessage::Hello(Box::new(hello)).to_frame();
        self.tell(frame);
        self.tell_end();
        Ok(())
    }

    /// Tells the end of the run, if it has ended.
    fn tell_end(&mut self) {
        if let Some(end) = ServerMessage::end(&self.playback) {
            let frame = end.to_frame();
            self.tell(frame);
        }
    }

    /// Computes due impacts, up to a limit, and sets the time of the next computation.
    pub(super) fn compute_due(&mut self, now: u64, go_on: GoOn<'_>) -> Result<(), Cancelled> {
        let begin = Instant::now();
        let run_time = self.live.clock.run_time(now);
        let (mut told, mut spent, mut last_flight) = (0, 0, None);
        let mut held: Option<HoldPart> = None;
        while told < limits::LIVE_BATCH
            && spent < limits::LIVE_BATCH_BOUNCES
            && self.playback.next_t().is_some_and(|t| t <= run_time)
        {
            let (step, price) = self.playback.advance(&self.live.run, go_on)?;
            (told, spent) = (told + 1, spent + price.as_bounces());
            match step {
                Step::Impact(contact) => {
                    self.tell_hold(held.take());
                    last_flight = contact.flight_time;
                    if contact.n >= self.first {
                        let has_angle = has_angle(self.live.run.scene());
                        let time_ms = Some(self.live.clock.date(contact.t));
                        let row = ImpactRow { time_ms, ..ImpactRow::new(self.playback.body(), has_angle, contact) };
                        let next_strike = LiveNextStrike::of(&mut self.playback, &self.live.run, go_on)?;
                        self.told.push(Told::Impact(Box::new(ImpactMessage { row, next_strike })));
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
            self.tell_end();
        }
        self.tell_hold(held);
        self.made += told as u64;
        let Some(t) = self.playback.next_t() else {
            self.catching_up = false;
            self.next_compute = begin + self.idle;
            return Ok(());
        };
        self.catching_up &= t <= self.came_at.min(run_time);
        let batch = begin + limits::LIVE_BATCH_TIME;
        if t <= run_time {
            self.next_compute = batch;
            return Ok(());
        }
        // At least once a second, since the wall clock may be set.
        let wait_ms = self.live.clock.wall_time(t).map_or(1000.0, |wall| wall.ceil() - now as f64).clamp(1.0, 1000.0);
        let due = begin + Duration::from_millis(wait_ms as u64);
        let is_fast = last_flight.is_some_and(|flight| flight * limits::LIVE_SINGLE_PER_S < self.live.clock.speed());
        self.next_compute = if is_fast { due.max(batch) } else { due };
        Ok(())
    }

    /// Sends samples of a hold, if there are any.
    fn tell_hold(&mut self, part: Option<HoldPart>) {
        if let Some(part) = part {
            let frame = ServerMessage::hold(&part).to_frame();
            self.tell(frame);
        }
    }

    /// Applies a message of the client. The run is unchanged if it cannot be.
    pub(super) fn apply(
        &mut self,
        message: &ClientMessage,
        (base_path, now): (&str, u64),
        go_on: GoOn<'_>,
    ) -> Result<(), Unapplied> {
        if !self.catching_up {
            // Due impacts have happened before the message.
            self.compute_due(now, go_on)?;
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
                    let detail = "step is for a paused run, and this one is not; send pause";
                    return Err(Problem::invalid_at("/type", detail).into());
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
                            .map(|error| ProblemError { pointer: pointer(error.path), detail: error.detail })
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
                    return Err(Problem::invalid_at("/type", detail).into());
                }
                if kick.theta_dot != 0.0 && !has_angle(live.run.scene()) {
                    return Err(Problem::invalid_at("/theta_dot", NO_ANGLE).into());
                }
                live.run.kick(n, *kick).map_err(|detail| Problem::invalid_at("", detail))?;
                impact = Some(n);
            }
            ClientMessage::Catch(settings) => {
                let (n, _) = self.next_impact()?;
                self.can_be_caught(&live)?;
                if let Some(t) = self.playback.held_until() {
                    let detail = format!("the table holds the body already (until t = {t} s at least); throw it first");
                    return Err(Problem::invalid_at("/type", detail).into());
                }
                live.run.catch(n, *settings).map_err(|detail| Problem::invalid_at("", detail))?;
                impact = Some(n);
            }
            ClientMessage::Throw(target) => {
                let (n, _) = self.next_impact()?;
                self.can_be_caught(&live)?;
                self.playback.try_throw(target).map_err(|failure| Problem::invalid_at("/apex", failure.to_string()))?;
                let order = ThrowOrder { apex: *target, t: self.playback.held_until() };
                live.run.throw(n, order).map_err(|detail| Problem::invalid_at("", detail))?;
                impact = Some(n);
            }
            ClientMessage::Restart => {
                let reached = self.playback.next_n().or(self.playback.outcome().map(|outcome| outcome.bounces));
                self.live = live.restarted(now, reached.unwrap_or_default());
                self.playback = Playback::new(&self.live.run, limits::LIVE_BOUNCES);
                (self.first, self.catching_up, self.next_compute) = (1, false, Instant::now());
                self.told.push(Told::NewRun);
                self.tell_hello(base_path, now, go_on)?;
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
            return Err(Problem::invalid_at("", detail).into());
        }
        self.live = live;
        self.next_compute = Instant::now();
        let ack = Ack {
            of: message.name(),
            url: &format!("{base_path}{}", run_url::url(&self.live)),
            run_time: self.live.clock.run_time(now),
            now_ms: now,
            speed: self.live.clock.speed(),
            paused: self.live.clock.is_paused(),
            impact,
            next_strike: LiveNextStrike::of(&mut self.playback, &self.live.run, go_on)?,
        };
        let frame = ServerMessage::Ack(ack).to_frame();
        self.tell(frame);
        Ok(())
    }

    /// Refuses a catch or a throw of a body for which there is none.
    fn can_be_caught(&self, live: &LiveRun) -> Result<(), Problem> {
        lacking(live.run.scene(), Analysis::Catch).map_or(Ok(()), |detail| Err(Problem::invalid_at("/type", detail)))
    }

    /// Number and time of the next impact.
    fn next_impact(&self) -> Result<(u64, f64), Problem> {
        self.playback.next_n().zip(self.playback.next_t()).ok_or_else(|| {
            let n = self.playback.outcome().map_or(0, |outcome| outcome.bounces);
            Problem::invalid_at("/type", format!("the run has ended at impact {n}; send restart to begin anew"))
        })
    }
}
