//! All limits of the server, with their units, meanings and reasons: first those with a flag, then the fixed ones.
//!
//! Ranges of a scene's fields are physics and stand in the table of fields.

use std::ops::RangeInclusive;
use std::sync::LazyLock;
use std::time::Duration;

use clap::builder::Resettable;
use clap::{Args, Command, FromArgMatches};

use crate::flags::{seconds, within};
use crate::memory;

/// A limit, with the name and the unit that its error gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limit {
    /// Name of the limited quantity, such as `work of this request`.
    pub name: &'static str,
    /// Largest allowed amount.
    pub most: u64,
    /// Unit of the amount, such as `bounces`.
    pub unit: &'static str,
}

/// Limits of load, set by flags. These comments are the text of `--help`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Args)]
#[command(next_help_heading = "Limits")]
pub struct Limits {
    /// Open connections, besides those of WebSockets. When all are taken, the longest idle connection of the client with the
    /// most connections is closed. Each takes about 20 KiB, and up to 64 KiB more while a request arrives
    #[arg(long, env = "EQUIPOISE_CONNECTIONS", value_name = "NUMBER", default_value = "16384")]
    #[arg(value_parser = within::<usize>(16..=1_000_000, "connections"))]
    pub connections: usize,

    /// Time for a client to send the head of a request, also of the next request on an idle connection
    #[arg(long, env = "EQUIPOISE_HEAD_TIME", value_name = "SECONDS", default_value = "30")]
    #[arg(value_parser = seconds(1..=3600))]
    pub head_time: Duration,

    /// Size of a request's body. A scene of a polygon with all its vertices has a few KiB
    #[arg(long, env = "EQUIPOISE_BODY_BYTES", value_name = "BYTES", default_value = "262144")]
    #[arg(value_parser = within::<usize>(1024..=64 * 1024 * 1024, "bytes"))]
    pub body_bytes: usize,

    /// Time for a client to send a whole body. A client that takes longer is stuck or hostile, and holds memory
    #[arg(long, env = "EQUIPOISE_BODY_TIME", value_name = "SECONDS", default_value = "10")]
    #[arg(value_parser = seconds(1..=3600))]
    pub body_time: Duration,

    /// Time in which a slow client must read at least 64 KiB of its answer; otherwise the connection is closed. The answer
    /// is held in memory meanwhile
    #[arg(long, env = "EQUIPOISE_STALL_TIME", value_name = "SECONDS", default_value = "30")]
    #[arg(value_parser = seconds(1..=3600))]
    pub stall_time: Duration,

    /// Work of one request, in bounces of the plain rod, about 70 ns each. The default is two seconds of one core
    #[arg(long, env = "EQUIPOISE_WORK", value_name = "BOUNCES", default_value = "30000000")]
    #[arg(value_parser = within::<u64>(1000..=1_000_000_000_000, "bounces"))]
    pub work: u64,

    /// Work of one region, in bounces in lanes, a sixth of a plain one each: about 20 s of two cores for a million cells of
    /// 2000 contacts. It shares the cores with other requests, and stops as soon as its client has gone
    #[arg(long, env = "EQUIPOISE_REGION_WORK", value_name = "BOUNCES", default_value = "2200000000")]
    #[arg(value_parser = within::<u64>(1000..=1_000_000_000_000, "bounces"))]
    pub region_work: u64,

    /// Work of one ensemble, in bounces of the plain rod; a bounce with noise counts as three. The default is about 14 s of
    /// two cores. It shares the cores and stops like a region
    #[arg(long, env = "EQUIPOISE_ENSEMBLE_WORK", value_name = "BOUNCES", default_value = "400000000")]
    #[arg(value_parser = within::<u64>(1000..=1_000_000_000_000, "bounces"))]
    pub ensemble_work: u64,

    /// Numbers in one answer (columns times rows). JSON takes about 20 bytes for each, held in memory until they are sent
    #[arg(long, env = "EQUIPOISE_ANSWER", value_name = "NUMBERS", default_value = "4000000")]
    #[arg(value_parser = within::<u64>(1000..=1_000_000_000, "numbers"))]
    pub answer: u64,

    /// Memory for answers that are computed and not yet sent. One client gets at most as much as is left, so half of it; its
    /// next request is refused until it has read. The default is a quarter of the memory of the process, at most 1 GiB
    #[arg(long, env = "EQUIPOISE_HELD_BYTES", value_name = "BYTES", default_value = HELD_BYTES.as_str())]
    #[arg(value_parser = within::<usize>(HELD_BYTES_LEAST as usize..=1 << 44, "bytes"))]
    pub held_bytes: usize,

    /// Memory for answers while they are computed. The most that an answer takes is reserved before it is begun. One client gets
    /// more as long as it has less than is left; its next request waits in the queue. The default is a third of the memory of
    /// the process
    #[arg(long, env = "EQUIPOISE_COMPUTE_BYTES", value_name = "BYTES", default_value = COMPUTE_BYTES.as_str())]
    #[arg(value_parser = within::<usize>(COMPUTE_BYTES_LEAST as usize..=COMPUTE_BYTES_MOST as usize, "bytes"))]
    pub compute_bytes: usize,

    /// Memory for answers that are asked for again: those whose request determines every byte. 0 keeps none. The default is a
    /// thirty-second of the memory of the process, at most 64 MiB, some 2000 runs of a hundred impacts
    #[arg(long, env = "EQUIPOISE_ANSWER_CACHE", value_name = "BYTES", default_value = ANSWER_CACHE.as_str())]
    #[arg(value_parser = within::<usize>(0..=1 << 44, "bytes"))]
    pub answer_cache: usize,

    /// Requests that may wait for each permit. One client gets at most as many places as are left, so half of them. More
    /// requests than this would reach the queue time anyway
    #[arg(long, env = "EQUIPOISE_QUEUE", value_name = "NUMBER", default_value = "16")]
    #[arg(value_parser = within::<usize>(1..=10_000, "requests for each permit"))]
    pub queue: usize,

    /// Time a request waits for a permit before it is refused with 503 and Retry-After
    #[arg(long, env = "EQUIPOISE_QUEUE_TIME", value_name = "SECONDS", default_value = "5")]
    #[arg(value_parser = seconds(1..=3600))]
    pub queue_time: Duration,

    /// Live runs at a time, WebSockets and event streams together. One client gets at most as many as are left, so half of
    /// them. Each computes its own bounces, at `speed` times real time, and takes about 40 KiB
    #[arg(long, env = "EQUIPOISE_LIVE_SESSIONS", value_name = "NUMBER", default_value = "2048")]
    #[arg(value_parser = within::<usize>(1..=1_000_000, "live runs"))]
    pub live_sessions: usize,

    /// Lifetime of a WebSocket, so that none is open for ever. A client reconnects to the run's URL, perhaps on another
    /// server, and misses nothing
    #[arg(long, env = "EQUIPOISE_LIVE_TIME", value_name = "SECONDS", default_value = "86400")]
    #[arg(value_parser = seconds(1..=31_536_000))]
    pub live_time: Duration,

    /// Lifetime of an event stream. The server cannot tell whether its client is still there
    #[arg(long, env = "EQUIPOISE_EVENTS_TIME", value_name = "SECONDS", default_value = "3600")]
    #[arg(value_parser = seconds(1..=31_536_000))]
    pub events_time: Duration,

    /// Time that a paused or ended live run stays open without a message from its client
    #[arg(long, env = "EQUIPOISE_LIVE_IDLE_TIME", value_name = "SECONDS", default_value = "1800")]
    #[arg(value_parser = seconds(1..=31_536_000))]
    pub live_idle_time: Duration,

    /// Time that a shutdown waits for unfinished answers before it breaks them off. Only a large region takes longer
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

    /// [`Limits::compute_bytes`], for its error.
    pub fn of_compute_bytes(&self) -> Limit {
        Limit { name: "memory of this request", most: self.compute_bytes as u64, unit: "bytes" }
    }
}

/// Default of [`Limits::held_bytes`] on this machine, as text.
static HELD_BYTES: LazyLock<String> =
    LazyLock::new(|| share(memory::allowed(), HELD_BYTES_SHARE, HELD_BYTES_LEAST..=HELD_BYTES_MOST).to_string());

/// Default of [`Limits::compute_bytes`] on this machine, as text.
static COMPUTE_BYTES: LazyLock<String> = LazyLock::new(|| {
    share(memory::allowed(), COMPUTE_BYTES_SHARE, COMPUTE_BYTES_LEAST..=COMPUTE_BYTES_MOST).to_string()
});

/// Default of [`Limits::answer_cache`] on this machine, as text.
static ANSWER_CACHE: LazyLock<String> =
    LazyLock::new(|| share(memory::allowed(), ANSWER_CACHE_SHARE, 0..=ANSWER_CACHE_MOST).to_string());

/// One part in so many of the memory of the process, within a range.
fn share(allowed: Option<u64>, parts: u64, range: RangeInclusive<u64>) -> u64 {
    allowed.map_or(*range.end(), |allowed| allowed / parts).clamp(*range.start(), *range.end())
}

/// The defaults of the flags. The environment is not read.
impl Default for Limits {
    fn default() -> Self {
        let command = Self::augment_args(Command::new("equipoise")).mut_args(|arg| arg.env(Resettable::Reset));
        Self::from_arg_matches(&command.get_matches_from([""])).expect("every limit has a default within its range")
    }
}

// --- Requests ---

/// Bytes of path and query together. Common proxies pass at most 8 KiB.
pub const URL_BYTES: usize = 8 * 1024;

/// Bytes of a request line besides its URL, by which a URL that is too long is told from headers that are: the longest method of HTTP has 16.
pub const METHOD_AND_VERSION_BYTES: usize = 64;

/// Bytes of a request head (request line and headers): the read buffer of one connection.
pub const HEAD_BYTES: usize = 64 * 1024;

/// Headers of one request.
pub const HEADERS: usize = 100;

/// Parameters of one query. All fields of a scene together are under a hundred.
pub const QUERY_PARAMETERS: usize = 512;

/// Levels of objects and arrays in a request. The deepest valid one has five; reading recurses once per level.
pub const DEPTH: usize = 16;

/// Longest name in a JSON body, bytes. Each error's pointer repeats all names above it: 64 errors below one name of 250 KiB would
/// make an answer of 16 MiB.
pub const NAME_BYTES: usize = 256;

/// Errors reported in one problem. A client mends a few at a time.
pub const ERRORS: usize = 64;

// --- Work ---

/// Least price of an answer, in bounces: deriving values from the scene, and writing.
pub const ANSWER_PRICE: u64 = 700;

/// Contacts of one run: 40 MB of JSON. For longer runs there is `stability`, which keeps no states.
pub const BOUNCES: u64 = 100_000;

/// Contacts in the product of one derivative. Longer products have overflowed or lost all digits.
pub const PERIOD: u64 = 1000;

/// Longest period of a periodic orbit, in contacts. Newton's iteration over more has no digits left.
pub const ORBIT_PERIOD: u64 = 64;

/// Points of one branch of periodic orbits. A picture shows no more.
pub const BRANCH_POINTS: u64 = 2000;

/// Highest extra price of a flight of many turns, in bounces: the contact search takes at most ten pieces
/// (`contact_time::MAX_PIECES` and some for rounding) of 25 ns each, and finds the root in the last.
pub const SPINNING_PRICE: u64 = 8;

/// Price of designing a control law, in bounces: the picture follows the eigenvalues over more than a hundred gains, about 1.5 ms.
pub const CONTROLLER_PRICE: u64 = 20_000;

/// Measured impacts of one fit. A lab measures some hundred of a run.
pub const FIT_IMPACTS: usize = 1000;

/// Iterations of a fit by which it is priced: all stages of a slow one together, with their linear algebra and the looks beside the minimum.
pub const FIT_ITERATIONS: u64 = 400;

/// Further iterations of a slow fit of few impacts: it has the same stages, and its minima are flat.
pub const FIT_FURTHER_ITERATIONS: u64 = 300;

/// Impacts of such a fit. Those of a longer one take these further iterations for so many of its impacts.
pub const FIT_FEW_IMPACTS: u64 = 300;

/// Impacts that are added to those of a fit, for the work that does not grow with them.
pub const FIT_OVERHEAD: u64 = 16;

/// Longest time in contact after a catch, s: ten times the time in which the default weights bring a body to rest.
pub const HOLD_TIME: f64 = 60.0;

/// Rows of one hold: 140 kB of JSON. A canvas is no wider.
pub const HOLD_SAMPLES: u64 = 602;

/// Price of each row of a hold, in bounces: computing and writing.
pub const HOLD_SAMPLE_PRICE: u64 = 40;

/// Price of the work of a lasting contact, in bounces: a step of its integrator, or the search for a turn, 1.5 to 3 µs.
pub const CONTACT_WORK_PRICE: u64 = 25;

/// Samples of one flight. A canvas is no wider.
pub const SAMPLES_PER_FLIGHT: u64 = 256;

/// Contacts of a comparison of methods. Errors of chaotic runs saturate long before, and small steps take too long.
pub const PRECISION_BOUNCES: u64 = 1000;

/// Steps of one run in a comparison, about 30 ms. Settings that would take more are left out.
pub const PRECISION_STEPS: u64 = 1_000_000;

/// Time of measuring one method at one setting, and three times as long if a single run takes all of it: 1.5 to 2 s for all fifty.
pub const PRECISION_TIME: Duration = Duration::from_millis(30);

/// Price of measuring one method at one setting, in bounces, with the longer time of long runs.
pub const PRECISION_PRICE: u64 = 550_000;

/// Least time of one sample of the stopwatch: a thousand times the resolution of the clock.
pub const PRECISION_SAMPLE: Duration = Duration::from_micros(50);

/// Most samples for one median.
pub const PRECISION_REPEATS: usize = 301;

/// Price of a preview besides its run, in bounces: the picture, about 6 ms.
pub const PREVIEW_ANSWER_PRICE: u64 = 80_000;

/// Most contacts of a preview. More dots do not show in a small picture.
pub const PREVIEW_BOUNCES: u64 = 10_000;

/// Pixels of one picture. The largest drawing has 0.9 million; a pixel takes four bytes, three times over.
pub const PICTURE_PIXELS: u64 = 4_000_000;

/// Price of drawing an SVG, in bounces: about 0.3 ms.
pub const SVG_PRICE: u64 = 5000;

/// Price of drawing the pixels of a picture, in bounces: about 30 ms.
pub const PNG_PRICE: u64 = 400_000;

/// Retries of a line of a batch before it gets a 503: about a minute with the time in the queue.
pub const BATCH_WAITS: u32 = 10;

/// Time between these retries, the same that `Retry-After` asks of clients.
pub const BATCH_WAIT_TIME: Duration = Duration::from_secs(RETRY_AFTER_S as u64);

/// Work up to this price, in bounces, is computed on the async thread: about 0.25 ms, not much more than the way to a worker thread
/// and back. A run of a hundred contacts is within it.
pub const INLINE_BOUNCES: u64 = 4096;

/// Longest time of such work on the async thread; then it starts again on a worker thread. It is several times the price, for the few
/// scenes with slower bounces. One client has at most half of the async threads at a time, unless it is the only one.
pub const INLINE_TIME: Duration = Duration::from_millis(1);

/// A client that has been the only one for this time has all async threads for such work, until another one sends any request, which
/// waits for the pieces of work under way.
pub const ALONE_TIME: Duration = Duration::from_secs(1);

/// Length of a time slice, after which work passes its permit on. With a few waiting, a request waits some hundredths of a second.
pub const TURN_TIME: Duration = Duration::from_millis(10);

/// Time after which an idle worker thread ends, and with it the memory that it keeps. Starting one takes some hundredths of a millisecond.
pub const WORKER_IDLE_TIME: Duration = Duration::from_millis(500);

/// Niceness of worker threads, of at most 19: a third of the weight of threads that answer.
pub const COMPUTE_NICENESS: i32 = 5;

/// `Retry-After` of a 503, seconds: about the time of the most expensive request.
pub const RETRY_AFTER_S: u32 = 2;

/// Default share of the memory of the process for unsent answers: one part in so many.
const HELD_BYTES_SHARE: u64 = 4;

/// Least memory for unsent answers, bytes. With less, a client would be refused before anything was sent to it.
const HELD_BYTES_LEAST: u64 = 1024 * 1024;

/// Largest default for unsent answers, bytes: a dozen answers of the largest size.
const HELD_BYTES_MOST: u64 = 1024 * 1024 * 1024;

/// Default share of the memory of the process for computing: one part in so many. Unsent answers, kept ones, connections and the
/// allocator's own units take the rest.
const COMPUTE_BYTES_SHARE: u64 = 3;

/// Least memory for computing, bytes: a few answers of usual size.
const COMPUTE_BYTES_LEAST: u64 = 32 * 1024 * 1024;

/// Largest memory for computing, bytes; the default on a system that does not tell its memory.
const COMPUTE_BYTES_MOST: u64 = 1 << 44;

/// Time after which work looks again for memory that was given back: short beside the work that takes much of it.
pub const MEMORY_WAIT_TIME: Duration = Duration::from_millis(20);

/// Most memory of work besides its numbers, bytes: a run, a scene of many vertices, a drawing as SVG with its pixels.
pub const WORK_BYTES: usize = 4 * 1024 * 1024;

/// Most memory of a number of an answer, bytes: 16 in its column, and 20 to 30 as text. A run of 100,000 impacts takes 33 as JSON, 42 as PNG.
pub const NUMBER_BYTES: u64 = 64;

/// The same with 31 digits, which take 24 and up to 50: 75 as JSON, 86 as NDJSON.
pub const LONG_NUMBER_BYTES: u64 = 96;

/// Default share of the memory of the process for kept answers: one part in so many.
const ANSWER_CACHE_SHARE: u64 = 32;

/// Largest default for kept answers, bytes. What is asked for again, such as the panels of a dashboard, takes far less.
const ANSWER_CACHE_MOST: u64 = 64 * 1024 * 1024;

/// Largest kept answer, bytes. A larger one takes longer to send than its request to read, and would push many others out.
pub const KEPT_ANSWER_BYTES: usize = 1024 * 1024;

/// Bytes of a kept answer besides its name and its body.
pub const KEPT_ANSWER_OVERHEAD: usize = 256;

/// Size of a typical kept answer, bytes, from which the tables for them are sized.
pub const ANSWER_CACHE_TYPICAL_BYTES: usize = 16 * 1024;

/// Share of the memory for kept answers that goes to the requests for them: one part in so many.
pub const REPEATS_SHARE: usize = 8;

/// Bytes of a request for a kept answer besides its name and that of the answer.
pub const REPEAT_OVERHEAD: usize = 512;

/// Size of a typical request for a kept answer, bytes, from which the table for them is sized.
pub const REPEAT_TYPICAL_BYTES: usize = 2 * 1024;

/// Parts of the memory for kept answers, each with a lock. An answer has room in one of them.
pub const ANSWER_CACHE_SHARDS: usize = 4;

/// Bytes that are compressed or copied between two checks for cancellation: under 10 ms.
pub const GZIP_STEP_BYTES: usize = 128 * 1024;

/// Rows of one batch of an Arrow stream: 2 MB with 20 columns, which a reader holds at a time.
pub const ARROW_BATCH_ROWS: usize = 16_384;

/// Bytes that are written between two checks for cancellation: under 2 ms.
pub const WRITE_STEP_BYTES: usize = 64 * 1024;

// --- Connections ---

/// Bytes that a slow client must read in `stall_time`: about 2 KB/s by default, which any network reaches.
pub const STALL_BYTES: usize = 64 * 1024;

/// Time from the first to the second probe byte to a client that has closed its sending half, to see whether it is still there. Each
/// next byte goes out after three times the waiting time so far, the ninth and last byte of a status line after 22 s.
pub const PRESENCE_TIME: Duration = Duration::from_millis(10);

/// Probe bytes before a chunk: zeros of its size. Clients read up to sixteen digits, and a size has at most eight.
pub const PRESENCE_ZEROS: usize = 8;

/// Share of idle connections that are closed at once when all are taken: one in so many. Choosing them takes longer than closing them.
pub const CONNECTIONS_AT_ONCE: usize = 64;

/// Open files kept free for other than connections: listening sockets, the log, the page's files.
pub const OTHER_FILES: usize = 64;

/// Bytes of a request id that a client or a proxy may choose. A UUID has 36.
pub const REQUEST_ID_BYTES: usize = 64;

/// Characters of a token. 16 random ones cannot be guessed over a network.
pub const TOKEN_CHARACTERS: RangeInclusive<usize> = 16..=512;

/// Time for which a browser may remember the answer to a CORS preflight.
pub const PREFLIGHT_TIME: Duration = Duration::from_secs(3600);

/// Time for live runs to close at a shutdown, after unfinished answers.
pub const GOODBYE_TIME: Duration = Duration::from_secs(1);

// --- Surveys ---

/// Values along one side of a region. A row is in memory as a whole, with its x values as text: about 10 MB. A region larger than one
/// answer is requested in tiles.
pub const REGION_SIDE: u64 = 100_000;

/// Work of one block of a region, which a thread computes at a time, in bounces in lanes: about 10 ms, so that other requests do not
/// wait longer.
pub const REGION_BLOCK_WORK: u64 = 1_000_000;

/// Price of a cell of a region besides its bounces, in bounces in lanes: the scene, the first flight, and writing.
pub const REGION_CELL_PRICE: u64 = 60;

/// Price of a bounce of a table with a program of heights, in bounces in lanes: every strike has its own height.
pub const REGION_PROGRAM_PRICE: u64 = 2;

/// Price of a cell that cannot run in lanes, besides its bounces, in bounces in lanes.
pub const REGION_ALONE_CELL_PRICE: u64 = 350;

/// Price of a cell with a quantity of the linear analysis, in bounces in lanes.
pub const REGION_LINEAR_CELL_PRICE: u64 = 200;

/// Price of a bounce of the plain rod, in bounces in lanes: catches are priced in the former.
pub const REGION_PLAIN_PRICE: u64 = 6;

/// Price of a region besides its cells and its linear boundary, in bounces in lanes: the picture, about 5 ms.
pub const REGION_ANSWER_PRICE: u64 = 400_000;

/// Price of a bounce in lanes on a table that errs, in other bounces in lanes.
pub const REGION_NOISE_PRICE: u64 = 4;

/// Price of a bounce outside lanes, in bounces in lanes: on a table with limits or a program of heights it takes 12, on one that errs in
/// its plan 35.
pub const REGION_ALONE_PRICE: u64 = 20;

/// Most memory of a cell of a region, with its value and its outcome, bytes: 36 as JSON, 48 as PNG.
pub const REGION_CELL_BYTES: u64 = 64;

/// Cells of one block: enough to fill the lanes, and few enough that rows are sent as they are done.
pub const REGION_BLOCK_CELLS: RangeInclusive<u64> = 64..=2048;

/// Nodes along a side of the grid on which the linear boundary of a region is found.
pub const REGION_BOUNDARY_NODES: usize = 49;

/// Runs of an ensemble in one answer. The interval of a share is then within 0.7 %.
pub const ENSEMBLE_RUNS: u64 = 20_000;

/// Runs of an ensemble in tiles. Counts of so many still add up exactly in double precision.
pub const ENSEMBLE_RUNS_IN_TILES: u64 = 1_000_000_000;

/// Work of one block of an ensemble, in bounces: about 10 ms, as for regions. A single run may take more.
pub const ENSEMBLE_BLOCK_WORK: u64 = 50_000;

/// Fewest runs of a block in lanes, a hundredth of all between these: enough to fill the lanes, and few enough that progress is told.
pub const ENSEMBLE_BLOCK_RUNS: RangeInclusive<u64> = 16..=64;

/// Bounces in lanes on a table that errs for the price of one of the plain rod.
pub const ENSEMBLE_LANE_BOUNCES: u64 = 2;

/// Price of an ensemble besides its runs, in bounces: the summary and the picture, about 6 ms.
pub const ENSEMBLE_ANSWER_PRICE: u64 = 80_000;

/// Price of a run of an ensemble besides its bounces, in bounces: the model and the first flight.
pub const ENSEMBLE_RUN_PRICE: u64 = 10;

/// Price of each contact of the survival curve, in bounces: the interval, and writing.
pub const ENSEMBLE_CONTACT_PRICE: u64 = 20;

/// Price of each stored angle, in bounces: sorting and writing.
pub const ENSEMBLE_ANGLE_PRICE: u64 = 2;

/// Contacts at which an ensemble stores the angle of each run, for quantiles: with `ENSEMBLE_RUNS` 4 million numbers, as many as an
/// answer may have.
pub const ENSEMBLE_ANGLE_CONTACTS: u64 = 200;

/// Most memory of a stored angle of an ensemble that is not in the answer, bytes: 24, sorted.
pub const ENSEMBLE_ANGLE_BYTES: u64 = 32;

/// The same of an angle that is, with its text, bytes: 81.
pub const ENSEMBLE_LISTED_ANGLE_BYTES: u64 = 96;

// --- Live runs ---

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_held_in_a_share_of_the_memory_there_is() {
        for (allowed, held) in
            [(None, 1 << 30), (Some(64 << 30), 1 << 30), (Some(512 << 20), 128 << 20), (Some(0), 1 << 20)]
        {
            assert_eq!(share(allowed, HELD_BYTES_SHARE, HELD_BYTES_LEAST..=HELD_BYTES_MOST), held, "{allowed:?}");
        }
        for (allowed, computing) in [(None, 1 << 44), (Some(600 << 20), 200 << 20), (Some(0), 32 << 20)] {
            let range = COMPUTE_BYTES_LEAST..=COMPUTE_BYTES_MOST;
            assert_eq!(share(allowed, COMPUTE_BYTES_SHARE, range), computing, "{allowed:?}");
        }
        let Limits { held_bytes, answer_cache, .. } = Limits::default();
        assert!(held_bytes as u64 <= HELD_BYTES_MOST && answer_cache as u64 <= ANSWER_CACHE_MOST);
    }
}
