//! The cost of a large map. `cargo bench --bench cost` measures cells per second of one core over HTTP, by scene, quantity and number
//! of impacts, and the bytes of a cell. It prints the part of `docs/measurements.md` that `benches/run cost` writes; with `-- --short` the
//! figures are rough, to see that all parts run.
//!
//! Core-seconds are the CPU time of the server as the system counts it, so other work on the machine disturbs them little. Only the
//! part about several servers measures wall time and needs a quiet machine.

#[path = "../load/program.rs"]
mod program;
mod tiles;

use std::fmt::Write;
use std::io;
use std::time::Instant;

use program::{Program, load_average};
use tiles::{Map, ask};

/// Cells of the map whose cost is worked out.
const CELLS: f64 = 1e9;

/// Cells of a tile of the script in `docs/clients`, for 1000 impacts.
const TILE_CELLS: f64 = 100_000.0;

const TILT_GAIN: &str = "&x.field=table.tilt_gain&x.from=0.95&x.to=1.6&y.field=release.theta&y.from=0&y.to=0.5";

/// The maps that are measured: name, scene, axes, impacts, quantity.
const MAPS: [Map; 19] = [
    Map::new("rod", "preset=case-1", TILT_GAIN, 1000, "survival"),
    Map::new("rod, 100 impacts", "preset=case-1", TILT_GAIN, 100, "survival"),
    Map::new("rod, 10,000 impacts", "preset=case-1", TILT_GAIN, 10_000, "survival"),
    Map::new("rod, all of whose runs survive", "preset=case-1", SMALL, 1000, "survival"),
    Map::new("rod with losses, on an incline", "preset=case-4", TILT_GAIN, 1000, "survival"),
    Map::new(
        "friction by Poisson",
        "preset=case-1&scene.contact.friction=0.2&scene.table.slide=matched",
        TILT_GAIN,
        1000,
        "survival",
    ),
    Map::new(
        "friction by Poisson, all of whose runs survive",
        "preset=case-1&scene.contact.friction=0.2&scene.table.slide=matched",
        SMALL,
        1000,
        "survival",
    ),
    Map::new(
        "friction by Stronge, all of whose runs survive",
        "preset=case-1&scene.contact.friction=0.2&scene.contact.law=stronge&scene.table.slide=matched",
        SMALL,
        1000,
        "survival",
    ),
    Map::new("polygon, a triangle", "preset=triangle-polygon", TILT_GAIN, 1000, "survival"),
    Map::new("state feedback", FEEDBACK, FEEDBACK_AXES, 1000, "survival"),
    Map::new("noise", "preset=case-1-noise", TILT_GAIN, 1000, "survival"),
    Map::new("point mass", "preset=point-mass", POINT_AXES, 1000, "survival"),
    Map::new("rod, largest angle", "preset=case-1", TILT_GAIN, 1000, "max_theta"),
    Map::new("rod, residue", "preset=case-1", TILT_GAIN, 1000, "residue"),
    Map::new("rod, spectral radius", "preset=case-1", TILT_GAIN, 1000, "spectral_radius"),
    Map::new("rod with losses, residue", "preset=case-4", TILT_GAIN, 1000, "residue"),
    Map::new("state feedback, all of whose runs survive", FEEDBACK, SMALL_FEEDBACK, 1000, "survival"),
    Map::new("small noise, all of whose runs survive", SMALL_NOISE, SMALL, 1000, "survival"),
    Map::new(
        "polygon, a triangle, all of whose runs survive",
        "preset=triangle-polygon",
        SMALL_TRIANGLE,
        1000,
        "survival",
    ),
];

const SMALL: &str = "&x.field=table.tilt_gain&x.from=1.05&x.to=1.4&y.field=release.theta&y.from=0&y.to=0.05";
const FEEDBACK: &str = "scene.body.contact_distance=0.13333&scene.body.radius_of_gyration=0.09428&scene.release.height=0.2\
                        &scene.table.feedback.x=0.018&scene.table.feedback.x_dot=0.023&scene.table.feedback.theta_dot=-0.031";
const FEEDBACK_AXES: &str =
    "&x.field=table.feedback.theta&x.from=-1.6&x.to=-0.95&y.field=release.theta&y.from=0&y.to=0.5";
const SMALL_FEEDBACK: &str =
    "&x.field=table.feedback.theta&x.from=-1.2&x.to=-1.1&y.field=release.theta&y.from=0&y.to=0.02";
const SMALL_TRIANGLE: &str = "&x.field=table.tilt_gain&x.from=1.02&x.to=1.1&y.field=release.theta&y.from=0&y.to=0.02";
const SMALL_NOISE: &str = "preset=case-1-noise&scene.noise.timing_sd=0.0001";
const POINT_AXES: &str = "&x.field=table.tilt_gain&x.from=0.1&x.to=0.9&y.field=release.height&y.from=0.1&y.to=0.4";

fn main() -> io::Result<()> {
    let short = std::env::args().any(|argument| argument == "--short");
    let mut text = introduction();
    let server = Program::start()?;
    let overhead = Overhead::measure(&server)?;
    write_rates(&server, short, &overhead, &mut text)?;
    let bytes = write_bytes(&server, &mut text)?;
    write_overhead(&overhead, &bytes, server.memory_mib(), &mut text);
    drop(server);
    write_servers(&mut text)?;
    print!("{text}");
    Ok(())
}

fn introduction() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let cpu = cpu.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let cpu = cpu.map_or("a CPU", |(_, name)| name);
    format!(
        "Written by `benches/run cost` on {cpu}, {cores} cores, build {}, load of the machine before it began {}.\n\
         Core-hours are the CPU time of the server as the system counts it, including the time to send the answer.\n\n",
        equipoise::BUILD,
        load_average(),
    )
}

/// Time that a tile takes besides that of its cells, s.
struct Overhead {
    cpu_s: f64,
    wall_s: f64,
}

impl Overhead {
    fn measure(server: &Program) -> io::Result<Self> {
        const REQUESTS: usize = 2000;
        let one_cell = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=1&x.to=1.1&x.count=1\
                        &y.field=release.theta&y.from=0&y.to=0.1&y.count=1&bounces=1&format=ndjson";
        let (begin, before) = (Instant::now(), server.cpu_s());
        for _ in 0..REQUESTS {
            ask(server.address, one_cell, false)?;
        }
        let each = |seconds: f64| seconds / REQUESTS as f64;
        Ok(Self { cpu_s: each(server.cpu_s() - before), wall_s: each(begin.elapsed().as_secs_f64()) })
    }
}

/// Measures cells per second of one core, over whole tiles from all over each map.
fn write_rates(server: &Program, short: bool, overhead: &Overhead, text: &mut String) -> io::Result<()> {
    text.push_str(
        "Typical maps over tilt gain and release. Many of their runs fall early, which makes cells cheap. In the rows \"all of whose runs \
         survive\"\ncells cost as much as they can for that scene. Cells per second are those of one core: the median of 3 rounds; ± is half \
         of their spread.\nThe last column is for a map of 31,623 values a side, in tiles by \
         [in_tiles.py](clients/README.md#too-large-for-one-request).\n\n\
         | | impacts | quantity | cells per second | rounds | completed | core-hours for 10⁹ cells |\n|---|---|---|---|---|---|---|\n",
    );
    for map in &MAPS {
        let found = map.measure(server, short)?;
        let core_s = CELLS / found.rate + CELLS / TILE_CELLS * overhead.cpu_s;
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | ± {:.0} % | {} | {} |",
            map.name,
            map.impacts,
            map.quantity,
            grouped(found.rate),
            100.0 * found.spread,
            found.completed.map_or("–".to_owned(), |share| format!("{:.0} %", 100.0 * share)),
            three_digits(core_s / 3600.0),
        );
    }
    text.push('\n');
    Ok(())
}

/// Measures the bytes of a cell. Returns those of NDJSON and CSV, in that order.
fn write_bytes(server: &Program, text: &mut String) -> io::Result<[f64; 2]> {
    text.push_str(
        "Bytes of a cell:\n\n| | NDJSON | the same, gzip | CSV | the same, gzip | JSON |\n|---|---|---|---|---|---|\n",
    );
    let mut kept = [0.0; 2];
    for map in [&MAPS[0], &MAPS[12], &MAPS[13]] {
        let _ = write!(text, "| {} |", map.quantity);
        for (place, (form, gzip)) in
            [("ndjson", false), ("ndjson", true), ("csv", false), ("csv", true), ("json", false)]
                .into_iter()
                .enumerate()
        {
            let (mut bytes, mut cells) = (0, 0);
            for index in tiles::all_over() {
                bytes += ask(server.address, &map.tile(index, form), gzip)?.len();
                cells += tiles::CELLS;
            }
            let each = bytes as f64 / cells as f64;
            let _ = write!(text, " {each:.1} |");
            if map.quantity == MAPS[0].quantity && !gzip && place < 4 {
                kept[place / 2] = each;
            }
        }
        text.push('\n');
    }
    text.push('\n');
    Ok(kept)
}

fn write_overhead(overhead: &Overhead, bytes: &[f64; 2], memory_mib: f64, text: &mut String) {
    let _ = writeln!(
        text,
        "A request for one cell of one impact, on a new connection, takes {:.2} ms of a core and {:.2} ms of wall time. The script's tiles \
         have up to\n{} cells of 1000 impacts, and stay beside the result: a map of 10⁹ cells takes {:.0} GB of disk for survival as NDJSON, \
         and {:.0} GB more\nfor CSV. At the end of this benchmark the server held {memory_mib:.0} MiB of memory.\n",
        1e3 * overhead.cpu_s,
        1e3 * overhead.wall_s,
        grouped(TILE_CELLS),
        2.0 * CELLS * bytes[0] / 1e9,
        CELLS * bytes[1] / 1e9,
    );
}

/// Measures the wall-clock rate of one map: one server with one permit, one with two, and two with one each.
fn write_servers(text: &mut String) -> io::Result<()> {
    text.push_str(
        "Several servers: wall-clock rate of the first map, with two clients per server that request tiles; median of 3 rounds in turns. With n\n\
         permits a server computes n requests at a time.\n\n\
         | servers | permits of each | cells per second | ratio to the first row |\n|---|---|---|---|\n",
    );
    let set_ups = [(1, "1"), (1, "2"), (2, "1")];
    let mut found = [const { Vec::new() }; 3];
    for _ in 0..3 {
        for ((servers, permits), rates) in set_ups.iter().zip(&mut found) {
            let mut running = Vec::new();
            for _ in 0..*servers {
                running.push(Program::start_with(&["--permits", permits])?);
            }
            rates.push(MAPS[0].measure_by_clock(&running)?);
        }
    }
    let medians = found.map(|mut rates| {
        rates.sort_by(f64::total_cmp);
        rates[rates.len() / 2]
    });
    for ((servers, permits), rate) in set_ups.iter().zip(medians) {
        let _ = writeln!(text, "| {servers} | {permits} | {} | {:.2} |", grouped(rate), rate / medians[0]);
    }
    Ok(())
}

/// A whole number with thousands separated by commas.
fn grouped(number: f64) -> String {
    let digits = format!("{number:.0}");
    let first = digits.len() % 3;
    let groups = (0..digits.len()).filter(|place| place % 3 == first).map(|place| &digits[place..place + 3]);
    let groups: Vec<&str> = (first > 0).then(|| &digits[..first]).into_iter().chain(groups).collect();
    groups.join(",")
}

fn three_digits(number: f64) -> String {
    let places = (2 - number.log10().floor() as i32).clamp(0, 4);
    format!("{number:.*}", places as usize)
}
