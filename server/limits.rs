//! Every limit the server keeps, in one place: its unit, what it means and why it has this value.
//!
//! First those that can be set when the server starts, then those that are part of its design. Not here: the ranges of a
//! scene's fields, which are physics and stand in the table of fields.

use std::ops::RangeInclusive;
use std::sync::LazyLock;
use std::time::Duration;

use clap::builder::Resettable;
use clap::{Args, Command, FromArgMatches};

use crate::compute::Limit;
use crate::flags::{seconds, within};
use crate::memory;

/// The limits that can be set: those of load, which depend on the machine and on who uses it. What is said here is what
/// `--help` says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Args)]
#[command(next_help_heading = "Limits")]
pub struct Limits {
    /// Open connections, besides those of WebSockets. When all are taken, the one that has waited longest for its client
    /// gives way, of whoever has most. Each takes some 20 KiB, and up to 64 KiB more while a request arrives
    #[arg(long, env = "EQUIPOISE_CONNECTIONS", value_name = "NUMBER", default_value = "16384")]
    #[arg(value_parser = within::<usize>(16..=1_000_000, "connections"))]
    pub connections: usize,

    /// Time a client has to send the head of a request, and an idle connection to send its next one
    #[arg(long, env = "EQUIPOISE_HEAD_TIME", value_name = "SECONDS", default_value = "30")]
    #[arg(value_parser = seconds(1..=3600))]
    pub head_time: Duration,

    /// Size of a request's body. A scene of a polygon with hundreds of corners is about 20 KiB
    #[arg(long, env = "EQUIPOISE_BODY_BYTES", value_name = "BYTES", default_value = "262144")]
    #[arg(value_parser = within::<usize>(1024..=64 * 1024 * 1024, "bytes"))]
    pub body_bytes: usize,

    /// Time a client has to send a whole body. Longer is a stuck or hostile client that holds memory
    #[arg(long, env = "EQUIPOISE_BODY_TIME", value_name = "SECONDS", default_value = "10")]
    #[arg(value_parser = seconds(1..=3600))]
    pub body_time: Duration,

    /// Time in which a client that is slow has to take at least 64 KiB of its answer, which is held in memory for it,
    /// before it is cut off
    #[arg(long, env = "EQUIPOISE_STALL_TIME", value_name = "SECONDS", default_value = "30")]
    #[arg(value_parser = seconds(1..=3600))]
    pub stall_time: Duration,

    /// Work of one request, in bounces of the plain rod, some 70 ns each: two seconds of one core
    #[arg(long, env = "EQUIPOISE_WORK", value_name = "BOUNCES", default_value = "30000000")]
    #[arg(value_parser = within::<u64>(1000..=1_000_000_000_000, "bounces"))]
    pub work: u64,

    /// Work of one region, in bounces of lanes, a sixth of a plain one each: some 20 s of two cores for a million cells of
    /// 2000 contacts. It is computed in turns with others' requests, and stopped as soon as its client is gone
    #[arg(long, env = "EQUIPOISE_REGION_WORK", value_name = "BOUNCES", default_value = "2200000000")]
    #[arg(value_parser = within::<u64>(1000..=1_000_000_000_000, "bounces"))]
    pub region_work: u64,

    /// Work of one ensemble, in bounces of the plain rod; one with noise counts as three of them: some 14 s of two cores. In
    /// turns and stopped like that of a region
    #[arg(long, env = "EQUIPOISE_ENSEMBLE_WORK", value_name = "BOUNCES", default_value = "400000000")]
    #[arg(value_parser = within::<u64>(1000..=1_000_000_000_000, "bounces"))]
    pub ensemble_work: u64,

    /// Numbers in one answer (columns times rows). JSON takes some 20 bytes for each, held in memory until they are sent
    #[arg(long, env = "EQUIPOISE_ANSWER", value_name = "NUMBERS", default_value = "4000000")]
    #[arg(value_parser = within::<u64>(1000..=1_000_000_000, "numbers"))]
    pub answer: u64,

    /// Memory for answers that are computed and not yet sent. One client has at most as much as is left, so half of it; beyond
    /// that it is told to read first. If not set, a quarter of the memory that the process may have, and at most 1 GiB
    #[arg(long, env = "EQUIPOISE_HELD_BYTES", value_name = "BYTES", default_value = HELD_BYTES.as_str())]
    #[arg(value_parser = within::<usize>(HELD_BYTES_LEAST as usize..=1 << 44, "bytes"))]
    pub held_bytes: usize,

    /// Requests that may wait for each of the permits. One client takes at most as many places as are left, so half of
    /// them; more would wait longer than the time to wait anyway
    #[arg(long, env = "EQUIPOISE_QUEUE", value_name = "NUMBER", default_value = "16")]
    #[arg(value_parser = within::<usize>(1..=10_000, "requests for each permit"))]
    pub queue: usize,

    /// Time a request waits for a permit before it is told to come back
    #[arg(long, env = "EQUIPOISE_QUEUE_TIME", value_name = "SECONDS", default_value = "5")]
    #[arg(value_parser = seconds(1..=3600))]
    pub queue_time: Duration,

    /// Live runs at a time, over WebSockets and as events together; one client has at most as many as are left, so half of
    /// them. Each computes its own bounces, `speed` times real time, and takes some 40 KiB
    #[arg(long, env = "EQUIPOISE_LIVE_SESSIONS", value_name = "NUMBER", default_value = "2048")]
    #[arg(value_parser = within::<usize>(1..=1_000_000, "live runs"))]
    pub live_sessions: usize,

    /// Time that a live run is told on one WebSocket before it is closed, so that none is held for ever. Clients come back
    /// to the run's URL and miss nothing, perhaps to another server
    #[arg(long, env = "EQUIPOISE_LIVE_TIME", value_name = "SECONDS", default_value = "86400")]
    #[arg(value_parser = seconds(1..=31_536_000))]
    pub live_time: Duration,

    /// The same for events, whose server cannot tell a dead client from a silent one
    #[arg(long, env = "EQUIPOISE_EVENTS_TIME", value_name = "SECONDS", default_value = "3600")]
    #[arg(value_parser = seconds(1..=31_536_000))]
    pub events_time: Duration,

    /// Time that a live run which ended, or is paused, stays open without a message from its client
    #[arg(long, env = "EQUIPOISE_LIVE_IDLE_TIME", value_name = "SECONDS", default_value = "1800")]
    #[arg(value_parser = seconds(1..=31_536_000))]
    pub live_idle_time: Duration,

    /// Time a shutdown waits for answers under way before it cuts them off. Longer than any but a large region takes
    #[arg(long, env = "EQUIPOISE_SHUTDOWN_TIME", value_name = "SECONDS", default_value = "8")]
    #[arg(value_parser = seconds(0..=3600))]
    pub shutdown_time: Duration,
}

impl Limits {
    /// [`Limits::work`], for its error.
    pub fn of_work(&self) -> Limit {
        Limit { name: "work of this request", most: self.work, unit: "bounces" }
    }

    /// [`Limits::region_work`], for its error.
    pub fn of_region_work(&self) -> Limit {
        Limit { name: "work of this region", most: self.region_work, unit: "bounces" }
    }

    /// [`Limits::ensemble_work`], for its error.
    pub fn of_ensemble_work(&self) -> Limit {
        Limit { name: "work of this ensemble", most: self.ensemble_work, unit: "bounces" }
    }

    /// [`Limits::answer`], for its error.
    pub fn of_answer(&self) -> Limit {
        Limit { name: "size of the answer", most: self.answer, unit: "numbers" }
    }
}

/// Default of [`Limits::held_bytes`] on this machine, as text.
static HELD_BYTES: LazyLock<String> = LazyLock::new(|| held_bytes(memory::allowed()).to_string());

/// Memory for answers out of what the process may have. As much again goes to what is computed, and the rest to connections.
fn held_bytes(allowed: Option<u64>) -> u64 {
    allowed.map_or(HELD_BYTES_MOST, |allowed| allowed / HELD_BYTES_SHARE).clamp(HELD_BYTES_LEAST, HELD_BYTES_MOST)
}

/// As when nothing is set, whatever the environment says.
impl Default for Limits {
    fn default() -> Self {
        let command = Self::augment_args(Command::new("equipoise")).mut_args(|arg| arg.env(Resettable::Reset));
        Self::from_arg_matches(&command.get_matches_from([""])).expect("every limit has a default within its range")
    }
}

// --- What a request may be ---

/// Bytes of path and query together. Common proxies pass 8 KiB at most, so a longer URL would not arrive anyway.
pub const URL_BYTES: usize = 8 * 1024;

/// Bytes of a whole request head (request line and headers), one connection's read buffer while waiting for it.
pub const HEAD_BYTES: usize = 64 * 1024;

/// Headers of one request.
pub const HEADERS: usize = 100;

/// Parameters of one query. All fields of a scene together are under a hundred.
pub const QUERY_PARAMETERS: usize = 512;

/// Levels of objects and arrays in a request. The deepest valid one has five; reading recurses once per level.
pub const DEPTH: usize = 16;

/// Longest name in a JSON body, bytes. The pointer of every error repeats all names down to it, so that 64 errors below one name
/// of 250 KiB would be an answer of 16 MiB.
pub const NAME_BYTES: usize = 256;

/// Errors reported in one problem. A client mends a few at a time; more would only be bytes.
pub const ERRORS: usize = 64;

// --- What a request may cost ---

/// Work of any answer, however little there is to compute, in bounces: what follows from the scene, and writing it down.
pub const ANSWER_PRICE: u64 = 700;

/// Contacts of one run. With its JSON that is 40 MB; a longer watch of a run is `stability`, which keeps no states.
pub const IMPACTS: u64 = 100_000;

/// Contacts that one derivative may pass. Beyond that a product of derivatives says nothing: it has overflowed, or its
/// digits are gone.
pub const PERIOD: u64 = 1000;

/// Contacts after which a periodic orbit may come back. Newton's iteration over more has no digits left.
pub const ORBIT_PERIOD: u64 = 64;

/// Points of one branch of periodic orbits. A picture shows no more.
pub const BRANCH_POINTS: u64 = 2000;

/// Work beyond that of a bounce, in bounces, of finding the end of a flight of many turns: its pieces are ten at most
/// (`contact_time::MAX_PIECES` with some for rounding), 25 ns each, and the root in the last.
pub const SPINNING_PRICE: u64 = 8;

/// Work of designing a law, in bounces: the picture follows its eigenvalues over a hundred and more gains, some 1.5 ms.
pub const CONTROLLER_PRICE: u64 = 20_000;

/// Samples of one flight. A canvas is no wider.
pub const SAMPLES_PER_FLIGHT: u64 = 256;

/// Values of one side of a region, which is larger than one answer may be and then asked for in tiles. At most so many stand in one
/// row, which is in memory as a whole, with its values of x as text: some 10 MB.
pub const REGION_SIDE: u64 = 100_000;

/// Work of one block of a region, the piece that a thread takes at a time, in bounces of lanes: some 10 ms, so that a
/// request beside it does not wait longer.
pub const REGION_BLOCK_WORK: u64 = 1_000_000;

/// Price of a cell of a region beside its bounces, in bounces of lanes: its scene, its first flight, and writing it down.
pub const REGION_CELL_PRICE: u64 = 60;

/// The same of a cell that no lane can run.
pub const REGION_ALONE_CELL_PRICE: u64 = 350;

/// Price of a cell that shows a number of the linear analysis.
pub const REGION_LINEAR_CELL_PRICE: u64 = 200;

/// Price of a region beside its cells and its linear boundary, in bounces of lanes: its picture, some 5 ms.
pub const REGION_ANSWER_PRICE: u64 = 400_000;

/// What a bounce of a region costs that no lane can make, in bounces of lanes: a rod steered by feedback takes 9, a polygon and a
/// point 17, one with noise 25.
pub const REGION_ALONE_PRICE: u64 = 20;

/// Cells of one block: at least so many that lanes are full, at most so many that rows come as they are done.
pub const REGION_BLOCK_CELLS: RangeInclusive<u64> = 64..=2048;

/// Nodes along a side of the grid on which the linear boundary of a region is found.
pub const REGION_BOUNDARY_NODES: usize = 49;

/// Runs of one answer about an ensemble. The interval about a share of them is then within 0.7 % of it.
pub const ENSEMBLE_RUNS: u64 = 20_000;

/// Runs of an ensemble that is asked for in tiles: counts of so many still add up exactly in a double, by far.
pub const ENSEMBLE_RUNS_IN_TILES: u64 = 1_000_000_000;

/// Work of one block of an ensemble, the runs that a thread takes at a time: some 10 ms, as for regions. One run may be more.
pub const ENSEMBLE_BLOCK_WORK: u64 = 50_000;

/// Price of an ensemble beside its runs, in bounces: its summary and its picture, some 6 ms.
pub const ENSEMBLE_ANSWER_PRICE: u64 = 80_000;

/// Price of a run of an ensemble beside its bounces, in bounces: its model and its first flight.
pub const ENSEMBLE_RUN_PRICE: u64 = 10;

/// Price of each contact of the survival curve, in bounces: its interval, and writing it down.
pub const ENSEMBLE_CONTACT_PRICE: u64 = 20;

/// Price of an angle that is kept, in bounces: sorting it, and writing it down.
pub const ENSEMBLE_ANGLE_PRICE: u64 = 2;

/// Contacts at which an ensemble keeps the angle of each run, to sort them for quantiles: with `ENSEMBLE_RUNS` 4 million
/// numbers, as many as an answer. A picture shows no more.
pub const ENSEMBLE_ANGLE_CONTACTS: u64 = 200;

/// Contacts over which methods are charted. Errors of chaotic runs say nothing long before, and fine steps take too long.
pub const PRECISION_IMPACTS: u64 = 1000;

/// Steps of one run of a charted method, some 30 ms: settings that would take more are left out.
pub const PRECISION_STEPS: u64 = 1_000_000;

/// Time over which one method with one setting is measured, three times as long where one run takes all of it: some 1.5 to 2 s
/// for all fifty.
pub const PRECISION_TIME: Duration = Duration::from_millis(30);

/// Work of that, in bounces, with the longer time that long runs get.
pub const PRECISION_PRICE: u64 = 550_000;

/// Least time of one look of the stopwatch: a thousand times the grain of the clock.
pub const PRECISION_SAMPLE: Duration = Duration::from_micros(50);

/// Looks of which a median is taken.
pub const PRECISION_REPEATS: usize = 301;

/// Pixels of one picture. The largest drawing has 0.9 million; a pixel takes four bytes, three times over.
pub const PICTURE_PIXELS: u64 = 4_000_000;

/// Work of drawing a picture, in bounces: some 0.3 ms.
pub const SVG_PRICE: u64 = 5000;

/// Work of drawing the pixels of one picture, in bounces: some 30 ms.
pub const PNG_PRICE: u64 = 400_000;

/// Times that a line of a batch waits again before it is told that there is too much to do: with the time that each
/// waits in the queue, about a minute.
pub const BATCH_WAITS: u32 = 10;

/// Time until it tries again: what `RETRY_AFTER_S` asks of clients.
pub const BATCH_WAIT_TIME: Duration = Duration::from_secs(RETRY_AFTER_S as u64);

/// Work up to this price, in bounces, is done on the async thread at once: some 0.25 ms, not much more than the way to
/// another thread and back is worth. A run of a hundred contacts is within it.
pub const INLINE_BOUNCES: u64 = 4096;

/// Time of such work on the async thread, after which it is begun anew on another: several times what its price says, for the
/// few scenes whose bounces are dearer. One client has at most half of these threads at a time.
pub const INLINE_TIME: Duration = Duration::from_millis(1);

/// Time that work computes before others have their turn: with a few waiting, a request waits some hundredths of a second.
pub const TURN_TIME: Duration = Duration::from_millis(10);

/// How far threads that compute stand back behind those that answer, in steps of the system's 19: a third of the weight.
pub const COMPUTE_NICENESS: i32 = 5;

/// What `Retry-After` says on a 503, seconds: about the time of one request at its dearest.
pub const RETRY_AFTER_S: u32 = 2;

/// One part in so many of the memory that the process may have is for answers that are not yet sent, if nothing is set.
const HELD_BYTES_SHARE: u64 = 4;

/// Bytes for such answers, at least: a smaller one would be told to read what it has not been sent.
const HELD_BYTES_LEAST: u64 = 1024 * 1024;

/// The same at most, if nothing is set: a dozen answers of the largest size.
const HELD_BYTES_MOST: u64 = 1024 * 1024 * 1024;

/// Bytes of answer that are compressed or copied between two looks at whether the client is still there: under 10 ms.
pub const GZIP_STEP_BYTES: usize = 128 * 1024;

/// Bytes of answer that are written between two looks at whether the client is still there: under 2 ms, whatever they say.
pub const WRITE_STEP_BYTES: usize = 64 * 1024;

// --- Connections ---

/// Bytes of its answer that a slow client has to take in the time to stall: at the default time some 2 KB/s, which any
/// network does.
pub const STALL_BYTES: usize = 64 * 1024;

/// Time after which a client that waits with its sending half closed is sent a byte for the second time, to see whether it is still
/// there; each next time after three times as long as it has waited. The last of the nine bytes of a status line goes out after 22 s.
pub const PRESENCE_TIME: Duration = Duration::from_millis(10);

/// Zeros before the size of a chunk that may be sent for that. Clients read up to sixteen digits, of which a size has eight at most.
pub const PRESENCE_ZEROS: usize = 8;

/// When connections give way, one in so many does at once: finding out which takes longer than closing them.
pub const CONNECTIONS_AT_ONCE: usize = 64;

/// Open files kept free for anything but connections: sockets to listen on, the log, the page's files.
pub const OTHER_FILES: usize = 64;

/// Bytes of a request id that a client or a proxy may choose. A UUID has 36.
pub const REQUEST_ID_BYTES: usize = 64;

/// Characters of a token, at least: 16 random ones cannot be guessed over a network.
pub const TOKEN_CHARACTERS: RangeInclusive<usize> = 16..=512;

/// Time for which a browser may remember that another origin may ask.
pub const PREFLIGHT_TIME: Duration = Duration::from_secs(3600);

/// Time that live runs have, after the answers under way at a shutdown, to say goodbye.
pub const GOODBYE_TIME: Duration = Duration::from_secs(1);

// --- Live runs ---

/// Bytes of one message from a live client. The longest valid one sets a few fields.
pub const LIVE_MESSAGE_BYTES: usize = 8 * 1024;

/// Messages a second that a live client may send, averaged over a few seconds. A dragged slider sends up to 60.
pub const LIVE_MESSAGES_PER_S: u32 = 120;

/// Bytes read at a time from a live client, whose messages are short. The library's own 128 KiB are cleared at every read: at a
/// thousand clients two thirds of all the work.
pub const LIVE_READ_BYTES: usize = 4 * 1024;

/// Bytes that wait to be written before the socket is tried.
pub const LIVE_WRITE_BYTES: usize = 16 * 1024;

/// Bytes that may wait to be written beyond that: the longest message, several times over. A client that takes fewer is
/// slow, and what else there is to say waits where it can be left out.
pub const LIVE_WRITE_MOST_BYTES: usize = 1024 * 1024;

/// Impacts waiting for a slow live client before the oldest are skipped over with a `gap`: four batches.
pub const LIVE_QUEUE: usize = 1024;

/// Time that a live client may be behind before it is closed with 1013. Under the default time to stall,
/// which would cut it off mute.
pub const LIVE_BEHIND_TIME: Duration = Duration::from_secs(20);

/// Bytes of one message that break the connection, since reading it to its end would only cost memory. In between a
/// message is refused and the run goes on.
pub const LIVE_FRAME_BYTES: usize = 4 * LIVE_MESSAGE_BYTES;

/// Impacts in one message: 20 bytes for each of 14 numbers, so some 70 KiB.
pub const LIVE_BATCH: usize = 256;

/// Impacts a second on the wall above which they come in batches. No display shows more.
pub const LIVE_SINGLE_PER_S: f64 = 60.0;

/// Time from one such batch to the next.
pub const LIVE_BATCH_TIME: Duration = Duration::from_millis(50);

/// Work that a live run does between two batches, in bounces; `LIVE_BATCH` impacts are the other limit, 5,120 a second. A
/// run that asks for more falls behind its clock, rather than taking a core from others.
pub const LIVE_BATCH_BOUNCES: u64 = 4096;

/// Impacts of one live run, after which it has `completed`: a month of four a second. Without it a run that bounces in
/// place would never end.
pub const LIVE_IMPACTS: u64 = 10_000_000;

/// Interventions in one live run. They all stand in its URL, which has to stay under `URL_BYTES`.
pub const LIVE_INTERVENTIONS: usize = 100;

/// Entries of the clock in a live run's URL. Older ones matter to nobody who asks later, and are left out.
pub const LIVE_CLOCK_ENTRIES: usize = 16;

/// Time between pings to a live client; a client that answers none for `LIVE_SILENCE_TIME` is gone.
pub const LIVE_PING_TIME: Duration = Duration::from_secs(20);

/// Silence of a live client, its pongs included, after which its run ends.
pub const LIVE_SILENCE_TIME: Duration = Duration::from_secs(60);

/// Time after which a client of events that was cut off is told to come back.
pub const LIVE_RETRY_TIME: Duration = Duration::from_secs(1);

/// Work of writing one impact and reading it, in bounces: no client wants more than some 100,000 of them at once.
pub const LIVE_IMPACT_PRICE: u64 = 100;

/// Work of catching up with an old `epoch` or `from`: a run of `LIVE_IMPACTS` to its end, so that whoever was cut off comes back
/// to any, and its last impacts told anew. Some 0.7 s of one core, and 2 s with noise.
pub const LIVE_CATCH_UP: Limit =
    Limit { name: "work of catching up with this run", most: LIVE_IMPACTS + 1_000_000, unit: "bounces" };

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_held_in_a_share_of_the_memory_there_is() {
        for (allowed, held) in
            [(None, 1 << 30), (Some(64 << 30), 1 << 30), (Some(512 << 20), 128 << 20), (Some(0), 1 << 20)]
        {
            assert_eq!(held_bytes(allowed), held, "{allowed:?}");
        }
        assert!(Limits::default().held_bytes as u64 <= HELD_BYTES_MOST);
    }
}
