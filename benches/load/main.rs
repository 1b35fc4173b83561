//! The server under load. `cargo bench --bench load` measures everything and prints the part of `docs/measurements.md` that `benches/run
//! load` writes. With `-- --only rates`, `overload`, `live`, `slow`, `spinning` or `soak` it measures one part. `-- --short` takes about a
//! tenth of the time, to see that all parts run.
//!
//! The server is a separate process on the same machine as its clients, so every figure contains the clients' time. Ratios hold on a noisy
//! machine; absolute figures need a quiet one.

mod client;
mod live;
mod overload;
mod program;
mod rates;
mod slow;
mod soak;
mod spinning;

use std::io;
use std::time::Duration;

use clap::{Parser, ValueEnum};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

#[derive(Parser)]
struct Arguments {
    /// Measure only this part
    #[arg(long)]
    only: Option<Part>,

    /// Take about a tenth of the time
    #[arg(long)]
    short: bool,

    /// Minutes of mixed load
    #[arg(long, default_value_t = 30.0)]
    minutes: f64,

    /// Serve the answers of this server from memory, for comparison
    #[arg(long, hide = true)]
    bare: Option<std::net::SocketAddr>,

    /// Argument that cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Part {
    Rates,
    Overload,
    Live,
    Slow,
    Spinning,
    Soak,
}

#[tokio::main]
async fn main() -> io::Result<()> {
    let arguments = Arguments::parse();
    if let Some(address) = arguments.bare {
        return rates::serve_bare(address).await;
    }
    // Ten thousand connections need as many open files.
    let maximum = getrlimit(Resource::Nofile).maximum;
    let _ = setrlimit(Resource::Nofile, Rlimit { current: maximum, maximum });
    let short = arguments.short;
    let soak = Duration::from_secs_f64(60.0 * arguments.minutes / if short { 60.0 } else { 1.0 });
    print_introduction();
    for part in [Part::Rates, Part::Overload, Part::Live, Part::Slow, Part::Spinning, Part::Soak] {
        if arguments.only.is_some_and(|only| only != part) {
            continue;
        }
        let section = match part {
            Part::Rates => rates::measure(short).await?,
            Part::Overload => overload::measure(short).await?,
            Part::Live => live::measure(short).await?,
            Part::Slow => slow::measure(short).await?,
            Part::Spinning => spinning::measure(short).await?,
            Part::Soak => soak::measure(soak).await?,
        };
        print!("{section}");
    }
    Ok(())
}

fn print_introduction() {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let cpu = cpu
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(": "))
        .map_or("a CPU", |(_, name)| name);
    println!(
        "Written by `benches/run load` on {cpu}, {cores} cores, build {}. Clients and server share the cores, so\n\
         every figure contains the clients' own time. Load average before the start: {}.\n",
        equipoise::BUILD,
        program::load_average(),
    );
}
