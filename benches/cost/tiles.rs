//! Requests tiles of a map one after the other, as the script in `docs/clients` does, and measures the cost of their cells.

use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use crate::program::Program;

/// Values of x: the cells of a row.
const COLUMNS: usize = 512;

/// Rows of all tiles together.
const ROWS: usize = 4096;

/// Tiles of a map, and how many of them are requested, spread over the map.
const TILES: usize = 512;
const SOME: usize = 8;

/// Cells of a tile.
pub(crate) const CELLS: usize = COLUMNS * ROWS / TILES;

/// Least core-time of a round: a hundred ticks of the system's CPU accounting. The same tiles are repeated until then.
const ROUND_S: f64 = 1.0;

/// Indices of the tiles that are requested.
pub(crate) fn all_over() -> impl Iterator<Item = usize> + Clone {
    (0..SOME).map(|number| (2 * number + 1) * TILES / (2 * SOME))
}

/// A map that is measured.
pub(crate) struct Map {
    pub(crate) name: &'static str,
    scene: &'static str,
    axes: &'static str,
    pub(crate) impacts: u64,
    pub(crate) quantity: &'static str,
}

/// Measured cost of the cells of a map.
pub(crate) struct Found {
    /// Cells per second of one core; median of the rounds.
    pub(crate) rate: f64,
    /// Half of the spread of the rounds, relative to the median.
    pub(crate) spread: f64,
    /// Share of cells whose run completed; `None` for quantities without runs.
    pub(crate) completed: Option<f64>,
}

impl Map {
    pub(crate) const fn new(
        name: &'static str,
        scene: &'static str,
        axes: &'static str,
        impacts: u64,
        quantity: &'static str,
    ) -> Self {
        Self { name, scene, axes, impacts, quantity }
    }

    /// Request target of a tile.
    pub(crate) fn tile(&self, index: usize, form: &str) -> String {
        let Self { scene, axes, impacts, quantity, .. } = self;
        format!(
            "/v1/regions?{scene}{axes}&x.count={COLUMNS}&y.count={ROWS}&bounces={impacts}&quantity={quantity}\
             &tile.index={index}&tile.of={TILES}&format={form}"
        )
    }

    /// Requests tiles from all over the map until each round is long enough; `short` rounds have each tile once.
    pub(crate) fn measure(&self, server: &Program, short: bool) -> io::Result<Found> {
        let (mut rates, mut completed, mut runs) = (Vec::new(), 0, 0);
        for _ in 0..3 {
            let (before, mut cells) = (server.cpu_s(), 0);
            let cpu_s = loop {
                for index in all_over() {
                    let body = ask(server.address, &self.tile(index, "ndjson"), false)?;
                    cells += CELLS;
                    completed += count(&body, "completed")?;
                    runs += CELLS - count(&body, "none")?;
                }
                let cpu_s = server.cpu_s() - before;
                if short || cpu_s >= ROUND_S {
                    break cpu_s;
                }
            };
            rates.push(cells as f64 / cpu_s);
        }
        rates.sort_by(f64::total_cmp);
        let spread = 0.5 * (rates[2] - rates[0]) / rates[1];
        Ok(Found { rate: rates[1], spread, completed: (runs > 0).then(|| completed as f64 / runs as f64) })
    }

    /// Wall-clock cells per second of some servers, with two clients each.
    pub(crate) fn measure_by_clock(&self, servers: &[Program]) -> io::Result<f64> {
        const TIME: Duration = Duration::from_millis(1500);
        let begin = Instant::now();
        let clients = 2 * servers.len();
        let cells = std::thread::scope(|scope| {
            let asking: Vec<_> = (0..clients)
                .map(|client| {
                    let address = servers[client % servers.len()].address;
                    scope.spawn(move || {
                        let mut cells = 0;
                        for index in all_over().cycle().skip(client) {
                            if begin.elapsed() >= TIME {
                                break;
                            }
                            ask(address, &self.tile(index, "ndjson"), false)?;
                            cells += CELLS;
                        }
                        Ok(cells)
                    })
                })
                .collect();
            asking.into_iter().map(|client| client.join().expect("no client panics")).sum::<io::Result<usize>>()
        })?;
        Ok(cells as f64 / begin.elapsed().as_secs_f64())
    }
}

/// Number of cells with an ending, from the last line of an answer.
fn count(body: &[u8], name: &str) -> io::Result<usize> {
    let text = String::from_utf8_lossy(body);
    let end = text.lines().last().filter(|line| line.starts_with("{\"end\":"));
    let digits = end.and_then(|line| line.split_once(&format!("\"{name}\":"))).map(|(_, rest)| rest);
    let digits = digits.and_then(|rest| rest.split(|c: char| !c.is_ascii_digit()).next());
    digits.and_then(|digits| digits.parse().ok()).ok_or_else(|| io::Error::other(format!("no {name} in {end:?}")))
}

/// Sends one request on a new connection and reads the answer to its end.
pub(crate) fn ask(address: SocketAddr, target: &str, gzip: bool) -> io::Result<Vec<u8>> {
    let mut socket = TcpStream::connect(address)?;
    let accept = if gzip { "accept-encoding: gzip\r\n" } else { "" };
    socket.write_all(format!("GET {target} HTTP/1.0\r\nhost: localhost\r\n{accept}\r\n").as_bytes())?;
    let mut received = Vec::new();
    socket.read_to_end(&mut received)?;
    let end = received.windows(4).position(|window| window == b"\r\n\r\n").map_or(received.len(), |place| place + 4);
    let head = String::from_utf8_lossy(&received[..end]);
    if head.get(9..12) != Some("200") {
        return Err(io::Error::other(String::from_utf8_lossy(&received).into_owned()));
    }
    Ok(received.split_off(end))
}
