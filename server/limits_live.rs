//! Fixed limits of live runs, with their units, meanings and reasons; part of `limits`.

use std::time::Duration;

use super::Limit;

/// Bytes of one message from a live client. The longest valid one sets a few fields.
pub const LIVE_MESSAGE_BYTES: usize = 8 * 1024;

/// Messages a second that a live client may send, averaged over a few seconds. A dragged slider sends up to 60.
pub const LIVE_MESSAGES_PER_S: u32 = 120;

/// Read buffer of a live client, bytes; its messages are short. The library clears its default of 128 KiB at every read, which takes
/// two thirds of all work with a thousand clients.
pub const LIVE_READ_BYTES: usize = 4 * 1024;

/// Bytes that wait before the socket is written to.
pub const LIVE_WRITE_BYTES: usize = 16 * 1024;

/// Most bytes that wait in the socket's buffer: several of the longest messages. Beyond it messages wait in the outbox, where impacts
/// can be skipped.
pub const LIVE_WRITE_MOST_BYTES: usize = 1024 * 1024;

/// Impacts that wait for a slow live client before the oldest are skipped with a `gap`: four batches.
pub const LIVE_QUEUE: usize = 1024;

/// Time that a live client may be behind before it is closed with 1013. It is under the default `stall_time`, which would close the
/// connection without a reason.
pub const LIVE_BEHIND_TIME: Duration = Duration::from_secs(20);

/// Bytes of a message that close the connection. A message between this and `LIVE_MESSAGE_BYTES` is refused, and the run goes on.
pub const LIVE_FRAME_BYTES: usize = 4 * LIVE_MESSAGE_BYTES;

/// Impacts in one message: 20 numbers of up to 20 bytes each, so about 90 KiB.
pub const LIVE_BATCH: usize = 256;

/// Impacts per second of wall time above which they come in batches. No display shows more.
pub const LIVE_SINGLE_PER_S: f64 = 60.0;

/// Time from one such batch to the next.
pub const LIVE_BATCH_TIME: Duration = Duration::from_millis(50);

/// Work of a live run between two batches, in bounces, besides the limit of `LIVE_BATCH` impacts, which is 5,120 a second. A run that
/// needs more falls behind its clock.
pub const LIVE_BATCH_BOUNCES: u64 = 4096;

/// Impacts of a live run, after which it is `completed`: a month at four a second. Otherwise a run that bounces in place never ends.
pub const LIVE_BOUNCES: u64 = 10_000_000;

/// Interventions in one run. All of them are in its URL, which must stay under `URL_BYTES`.
pub const LIVE_INTERVENTIONS: usize = 100;

/// Clock entries in a live run's URL. Older entries change nothing from now on, and are left out.
pub const LIVE_CLOCK_ENTRIES: usize = 16;

/// Time between pings to a live client.
pub const LIVE_PING_TIME: Duration = Duration::from_secs(20);

/// Time without a message or pong from a live client, after which it counts as gone.
pub const LIVE_SILENCE_TIME: Duration = Duration::from_secs(60);

/// Time after which a client of events reconnects.
pub const LIVE_RETRY_TIME: Duration = Duration::from_secs(1);

/// Price of sending one past impact, in bounces. About 100,000 of them can be sent at once.
pub const LIVE_IMPACT_PRICE: u64 = 100;

/// Work of catching up with an old `epoch_ms` or `from`: a run of `LIVE_BOUNCES` to its end, so that every run can be reconnected to, and
/// the last impacts sent again. About 0.7 s of one core, and 2 s with noise.
pub const LIVE_CATCH_UP: Limit =
    Limit { name: "work of catching up with this run", most: LIVE_BOUNCES + 1_000_000, unit: "bounces" };
