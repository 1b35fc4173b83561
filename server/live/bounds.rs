//! What one live client may take: times, numbers and rates, each from the server's limits unless a test wants less.

use std::time::{Duration, Instant};

use crate::compute::Limit;
use crate::limits;
use crate::limits::Limits;

/// The bounds of one session, so that a test can wait for them.
#[derive(Debug, Clone, Copy)]
pub struct SessionBounds {
    /// Impacts that may wait for a slow client.
    pub queue: usize,
    /// Time that a client may be behind.
    pub behind: Duration,
    /// Time between pings.
    pub ping: Duration,
    /// Time without a word from the client, pongs included.
    pub silence: Duration,
    /// All the time it is told a run.
    pub lifetime: Duration,
    /// Time without a message, when the run has ended or is paused.
    pub idle: Duration,
    /// Whether it stays when the run has ended, for a client that may begin it anew.
    pub stays: bool,
    /// Messages a second.
    pub messages_per_s: u32,
    /// Work of catching up.
    pub catch_up: Limit,
}

impl SessionBounds {
    /// Those of a client that talks.
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

    /// Those of a client that only listens, and so is never heard.
    pub fn for_sse(limits: &Limits) -> Self {
        let lifetime = limits.events_time;
        Self { silence: lifetime, lifetime, stays: false, ..Self::for_websocket(limits) }
    }
}

/// Messages that a client may still send: so many a second, saved up for three seconds.
#[derive(Debug)]
pub struct TokenBucket {
    per_s: f64,
    left: f64,
    at: Instant,
}

impl TokenBucket {
    /// Three seconds' worth.
    pub fn new(per_s: u32, now: Instant) -> Self {
        Self { per_s: per_s.into(), left: 3.0 * f64::from(per_s), at: now }
    }

    /// Whether one more message is within it.
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
