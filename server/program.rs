//! The `equipoise` program: listens and serves until it is stopped, or answers one request.

use std::io::{self, Write};
use std::process::ExitCode;
use std::time::Duration;

use serde_json::json;
use tokio::net::TcpListener;
use tokio::signal::unix::{SignalKind, signal};
use tokio::time::{sleep, timeout};

use crate::api::App;
use crate::cli::{self, Task};
use crate::config::Config;
use crate::limits::Limits;
use crate::logging::LogFormat;
use crate::{BUILD, limits, logging, router, transport};

/// Does what the command line asks for.
pub fn main() -> ExitCode {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        // Memory that another thread has freed goes back with the thread that took it.
        .thread_keep_alive(limits::WORKER_IDLE_TIME)
        .build();
    let task = cli::read(std::env::args_os()).unwrap_or_else(|error| error.exit());
    let config = match (task, &runtime) {
        (Task::Serve(config), _) => *config,
        (Task::Answer(config, question), Ok(runtime)) => return runtime.block_on(cli::answer(&config, *question)),
        (Task::Print(text), _) => {
            // As with the first line: nobody has to read it.
            let _ = io::stdout().write_all(&text);
            return ExitCode::SUCCESS;
        }
        (Task::Answer(..), Err(error)) => {
            eprintln!("equipoise: {error}");
            return ExitCode::FAILURE;
        }
    };
    if let Err(error) = logging::init(config.log_format) {
        eprintln!("equipoise: {error}");
        return ExitCode::from(WRONG_SETTING);
    }
    match runtime.map_err(|error| error.to_string()).and_then(|runtime| runtime.block_on(serve(config))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            tracing::error!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Exit status for settings that are wrong, as of the parser of the command line. Whatever fails later ends with 1.
const WRONG_SETTING: u8 = 2;

async fn serve(mut config: Config) -> Result<(), String> {
    if transport::fit_open_files(&mut config.limits) {
        let Limits { connections, live_sessions, .. } = config.limits;
        tracing::warn!(
            connections,
            live_sessions,
            "the system's limit of open files lowers the number of connections and of live runs; raise it with ulimit -n"
        );
    }
    let listener = TcpListener::bind(&config.listen).await.map_err(|error| cannot_listen(&config.listen, &error))?;
    let address = listener.local_addr().map_err(|error| error.to_string())?;
    let stop = stop_signal().map_err(|error| format!("cannot listen for signals: {error}"))?;
    // The host name has become an address.
    config.listen = address.to_string();
    let openness = config.openness(address);
    let url = format!("http://{address}{}/", config.base_path);
    let first = match config.log_format {
        LogFormat::Text => format!("equipoise {BUILD} serves {url}\n{openness}"),
        LogFormat::Json => json!({"message": "serves", "build": BUILD, "url": url, "access": openness}).to_string(),
    };
    // A write error is ignored: nobody has to read it.
    let _ = writeln!(io::stdout(), "{first}");

    let app = App::new(&config);
    let stop = async {
        stop.await;
        app.close();
    };
    transport::serve(listener, router::router(app.clone()), &config.limits, stop).await;
    // Live runs are tasks apart from their connections. They see the server closing, and close their clients.
    let gone = async {
        while app.metrics.live_sessions.get() > 0 {
            sleep(Duration::from_millis(10)).await;
        }
    };
    let _ = timeout(limits::GOODBYE_TIME, gone).await;
    Ok(())
}

fn cannot_listen(listen: &str, error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::AddrInUse => {
            format!("{listen} is taken by another program; choose another with --listen ADDRESS:PORT")
        }
        _ => format!("cannot listen on {listen}: {error}"),
    }
}

/// Waits for SIGINT (Ctrl-C) or SIGTERM (service managers).
fn stop_signal() -> io::Result<impl Future<Output = ()>> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    Ok(async move {
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
        }
    })
}
