//! Bounds of one live client: times, numbers and rates, from the server's limits, and the parts of the server that it uses. Tests use
//! smaller ones.

use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::histogram::Histogram;
use tokio::time::Instant;

use crate::compute::Pool;
use crate::limits;
use crate::limits::{Limit, Limits};

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
