//! One client with the most expensive scenes, spinning bodies over a planned table that is nearly vertical, beside another client.

use std::fmt::Write;
use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use tokio::io::AsyncWriteExt;
use tokio::net::{TcpSocket, TcpStream};
use tokio::time::{sleep, timeout};

use crate::client::{Connection, Times};
use crate::program::Program;

const CONNECTIONS: usize = 100;
const TIME: Duration = Duration::from_secs(10);
const TRIES: u32 = 5;
const LONGEST: Duration = Duration::from_secs(60);

const SCENE: &str = "scene.gravity=0.1&scene.incline=0.01&scene.body.contact_distance=1&scene.body.radius_of_gyration=1\
                     &scene.contact.restitution=1&scene.table.tilt_gain=-46.3055&scene.topple_angle=3.141592653589793\
                     &scene.release.height=100&scene.release.theta_dot=164.18&scene.release.x_dot=59.06&scene.release.y_dot=100\
                     &scene.noise.model=plan&scene.noise.timing_sd=0.01&scene.noise.angle_sd=0.01";

pub(crate) async fn measure(short: bool) -> io::Result<String> {
    let (time, tries) = if short { (TIME / 5, 1) } else { (TIME, TRIES) };
    // Equal requests are computed each.
    let server = Program::start_with(&["--answer-cache", "0"])?;
    let mut text = format!(
        "### Spinning bodies\n\nA body that spins fast in little gravity, over a table that is planned nearly vertical (`--only spinning`, `--answer-cache 0`). \
         {CONNECTIONS} connections of one\naddress request runs of it, each as soon as the last is answered. Another client requests \
         `/health/live` every 5 ms for {} s.\n\n| | p50 | p99 | most | answers per second to the {CONNECTIONS} |\n|---|---|---|---|---|\n",
        time.as_secs()
    );
    let run = format!("/v1/trajectories?{SCENE}&scene.noise.seed=1&scene.noise.run=22&bounces=1");
    for (name, target) in [("alone", None), ("beside them", Some(run))] {
        let others: Vec<_> = (0..CONNECTIONS)
            .filter_map(|_| target.clone())
            .map(|target| tokio::spawn(ask_for_ever(server.address, target)))
            .collect();
        sleep(Duration::from_secs(1)).await;
        let before = requests(server.address).await?;
        let begin = Instant::now();
        let (mut times, mut most) = (Times::default(), 0.0_f64);
        let mut asking = Connection::open(server.address).await?;
        while begin.elapsed() < time {
            let asked = Instant::now();
            asking.get("/health/live").await?;
            times.add(asked);
            most = most.max(asked.elapsed().as_secs_f64() * 1e3);
            sleep(Duration::from_millis(5)).await;
        }
        let answers = (requests(server.address).await? - before) / begin.elapsed().as_secs_f64();
        others.iter().for_each(tokio::task::JoinHandle::abort);
        let [p50, p99] = [0.5, 0.99].map(|share| times.quantile(share));
        let _ = writeln!(text, "| {name} | {p50:.2} ms | {p99:.2} ms | {most:.1} ms | {answers:.0} |");
    }
    text += &leaving(server.address, tries).await?;
    Ok(text)
}

/// Measures how long a core goes on computing for a client that has hung up.
async fn leaving(address: SocketAddr, tries: u32) -> io::Result<String> {
    let mut text = format!(
        "\nTime from when a client hangs up to when its work has stopped; the longest of {tries} tries, each hung up at another time.\n\n\
         | | free after |\n|---|---|\n"
    );
    let axes =
        "x.field=release.theta_dot&x.from=100&x.to=200&x.count=400&y.field=release.x_dot&y.from=1&y.to=100&y.count=400";
    let grid = "x.field=table.tilt_gain&x.from=0.95&x.to=1.6&x.count=1000&y.field=release.theta&y.from=0&y.to=0.5&y.count=1000";
    let targets = [
        ("20,000 such runs", format!("/v1/ensembles?{SCENE}&runs=20000&bounces=1")),
        ("20,000 such runs of up to 1000 contacts", format!("/v1/ensembles?{SCENE}&runs=20000&bounces=1000")),
        ("a map of 160,000 such runs", format!("/v1/regions?{SCENE}&{axes}&bounces=10")),
        ("a map of case 1", format!("/v1/regions?preset=case-1&{grid}&bounces=2000")),
        ("100,000 contacts as JSON", "/v1/trajectories?preset=case-1&bounces=100000".to_owned()),
        ("100,000 contacts as CSV", "/v1/trajectories?preset=case-1&bounces=100000&format=csv".to_owned()),
        ("100,000 contacts as a picture", "/v1/trajectories?preset=case-1&bounces=100000&format=png".to_owned()),
        ("100,000 contacts with 31 digits", "/v1/trajectories?preset=case-1&bounces=100000&method=extended".to_owned()),
        ("a basin", "/v1/stability?preset=case-1&bounces=20000&basin=true".to_owned()),
        ("a ladder", "/v1/ladder?preset=case-1-noise&scene.release.theta=0.1&bounces=100000".to_owned()),
        ("methods beside each other", "/v1/precision?preset=case-1&bounces=1000".to_owned()),
    ];
    for (name, target) in targets {
        let mut longest = Duration::ZERO;
        let mut metrics = Connection::open(address).await?;
        let mut held = 0;
        for share in 1..=tries {
            let mut socket = TcpStream::connect(address).await?;
            socket.write_all(format!("GET {target} HTTP/1.1\r\nhost: localhost\r\n\r\n").as_bytes()).await?;
            sleep(Duration::from_millis(120) * share).await;
            held += u32::from(running(&mut metrics).await? > 0.0);
            drop(socket);
            let left = Instant::now();
            while running(&mut metrics).await? > 0.0 && left.elapsed() < LONGEST {
                sleep(Duration::from_millis(1)).await;
            }
            longest = longest.max(left.elapsed());
        }
        let note = if held < tries { format!(" ({held} were still computed)") } else { String::new() };
        let _ = writeln!(text, "| {name} | {:.0} ms{note} |", longest.as_secs_f64() * 1e3);
    }
    Ok(text + "\n")
}

async fn running(metrics: &mut Connection) -> io::Result<f64> {
    counted(metrics, "equipoise_jobs_running ").await
}

async fn requests(address: SocketAddr) -> io::Result<f64> {
    let metrics = &mut Connection::open(address).await?;
    counted(metrics, "equipoise_requests_total").await
}

/// Sum over all lines of `/metrics` with a prefix.
async fn counted(metrics: &mut Connection, name: &str) -> io::Result<f64> {
    let body = metrics.get("/metrics").await?.body;
    let text = String::from_utf8_lossy(&body);
    let lines = text.lines().filter(|line| line.starts_with(name));
    Ok(lines.filter_map(|line| line.rsplit(' ').next()?.parse::<f64>().ok()).sum())
}

/// Sends requests from one address for ever; refusals do not matter.
async fn ask_for_ever(address: SocketAddr, target: String) -> io::Result<()> {
    loop {
        let socket = TcpSocket::new_v4()?;
        socket.bind(([127, 0, 0, 2], 0).into())?;
        let mut connection = Connection::over(socket.connect(address).await?)?;
        while timeout(LONGEST, connection.get(&target)).await?.is_ok() {}
    }
}
