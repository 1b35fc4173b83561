//! The log of the program on stderr: text or JSON lines, filtered by `RUST_LOG`, and the access log as JSON in both cases.
//!
//! Events of a request carry its id in the span [`request_span`]. Log write errors are ignored, so that they never fail a request.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::fmt::{self, Debug, Write};
use std::io;
use std::net::IpAddr;
use std::panic::PanicHookInfo;
use std::time::{SystemTime, UNIX_EPOCH};

use clap::ValueEnum;
use serde::Serialize;
use tracing::field::{Field, Visit};
use tracing::level_filters::LevelFilter;
use tracing::{Event, Span, Subscriber, error_span};
use tracing_subscriber::filter::Targets;
use tracing_subscriber::fmt::format::{Format, JsonFields, Writer};
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields, layer};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt;

/// Form of the log. The access log is JSON in each of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    /// Lines for people.
    Text,
    /// One JSON object on each line.
    Json,
}

/// Target of the events that make up the access log.
const ACCESS: &str = "equipoise::access";

/// Installs the log of this process, and a panic hook that writes to it. Call it once.
///
/// # Errors
/// `RUST_LOG` cannot be read.
pub fn init(format: LogFormat) -> Result<(), String> {
    let levels = match std::env::var("RUST_LOG") {
        Ok(text) if !text.trim().is_empty() => text.parse().map_err(|error| format!("RUST_LOG={text}: {error}"))?,
        Ok(_) | Err(_) => Targets::new().with_default(LevelFilter::INFO),
    };
    // `--access-log` alone decides over the access log: without it there are no such events.
    let log = tracing_subscriber::registry().with(levels.with_target(ACCESS, LevelFilter::INFO));
    let layer = layer().with_writer(io::stderr).with_ansi(false).log_internal_errors(false);
    match format {
        LogFormat::Text => log.with(layer.event_format(Lines(Format::default()))).init(),
        LogFormat::Json => {
            let lines = Lines(Format::default().json().flatten_event(true));
            log.with(layer.fmt_fields(JsonFields::new()).event_format(lines)).init();
        }
    }
    std::panic::set_hook(Box::new(log_panic));
    Ok(())
}

/// Logs a panic, with its backtrace if `RUST_BACKTRACE` asks for one.
fn log_panic(panic: &PanicHookInfo<'_>) {
    let message = panic.payload_as_str().unwrap_or("a value that is not text");
    let location = panic.location().map(tracing::field::display);
    let backtrace = Backtrace::capture();
    let backtrace = (backtrace.status() == BacktraceStatus::Captured).then_some(backtrace);
    tracing::error!(location, backtrace = backtrace.map(tracing::field::display), "panic: {message}");
}

/// The span of a request. It is recorded at every level of `RUST_LOG` but `off`, so that each event has the id. An info span would
/// cost the same at the default level, and errors would lose the id at `RUST_LOG=error`.
pub fn request_span(id: &str) -> Span {
    error_span!("request", id)
}

/// One request in the access log.
#[derive(Debug)]
pub struct AccessLogEntry<'a> {
    /// Id of the request.
    pub id: &'a str,
    /// Address of the client.
    pub peer: IpAddr,
    /// Method of the request.
    pub method: &'a str,
    /// Path and query, without a secret.
    pub target: &'a str,
    /// Status of the answer.
    pub status: u16,
    /// Time from the head of the request to the head of the answer, ms.
    pub ms: f64,
}

impl AccessLogEntry<'_> {
    /// Writes the entry to the access log.
    pub fn write(&self) {
        let Self { id, peer, method, target, status, ms } = self;
        tracing::info!(target: ACCESS, id, %peer, method, target, status, ms);
    }
}

/// Writes entries of the access log as their own JSON lines, and leaves all other events to a format of the library.
struct Lines<F>(F);

impl<S, N, F> FormatEvent<S, N> for Lines<F>
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
    F: FormatEvent<S, N>,
{
    fn format_event(&self, context: &FmtContext<'_, S, N>, mut writer: Writer<'_>, event: &Event<'_>) -> fmt::Result {
        if event.metadata().target() != ACCESS {
            return self.0.format_event(context, writer, event);
        }
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let mut line = JsonLine(String::from("{"));
        line.member("time", &now.as_secs_f64());
        event.record(&mut line);
        writeln!(writer, "{}}}", line.0)
    }
}

/// A JSON object on one line. Nothing that a client sends can look like another line.
struct JsonLine(String);

impl JsonLine {
    fn member(&mut self, name: &str, value: &impl Serialize) {
        let separator = if self.0.len() > 1 { "," } else { "" };
        let value = serde_json::to_string(value).unwrap_or_else(|_| "null".to_owned());
        // Writing to a string does not fail.
        let _ = write!(self.0, "{separator}\"{name}\":{value}");
    }
}

impl Visit for JsonLine {
    fn record_f64(&mut self, field: &Field, value: f64) {
        self.member(field.name(), &value);
    }

    fn record_u64(&mut self, field: &Field, value: u64) {
        self.member(field.name(), &value);
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        self.member(field.name(), &value);
    }

    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        self.member(field.name(), &format!("{value:?}"));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use serde_json::Value;
    use tracing::subscriber::with_default;

    use super::*;

    /// Lines logged by `work`.
    fn logged(format: LogFormat, work: impl FnOnce()) -> Vec<String> {
        #[derive(Clone, Default)]
        struct Buffer(Arc<Mutex<Vec<u8>>>);
        impl io::Write for Buffer {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                self.0.lock().unwrap().write(bytes)
            }

            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let buffer = Buffer::default();
        let layer = layer().with_writer({
            let buffer = buffer.clone();
            move || buffer.clone()
        });
        let log = tracing_subscriber::registry();
        match format {
            LogFormat::Text => with_default(
                log.with(layer.with_ansi(false).event_format(Lines(Format::default().without_time()))),
                work,
            ),
            LogFormat::Json => with_default(
                log.with(
                    layer
                        .fmt_fields(JsonFields::new())
                        .event_format(Lines(Format::default().json().flatten_event(true))),
                ),
                work,
            ),
        }
        let text = String::from_utf8(buffer.0.lock().unwrap().clone()).unwrap();
        text.lines().map(str::to_owned).collect()
    }

    #[test]
    fn events_carry_the_id_of_their_request() {
        let work = || request_span("lab-1").in_scope(|| tracing::warn!(most = 3, "too many"));
        let text = logged(LogFormat::Text, work);
        assert_eq!(text, [" WARN request{id=\"lab-1\"}: equipoise::logging::tests: too many most=3"]);
        let json = logged(LogFormat::Json, work);
        let line: Value = serde_json::from_str(&json[0]).unwrap();
        assert_eq!((&line["message"], &line["level"]), (&"too many".into(), &"WARN".into()));
        assert_eq!((&line["most"], &line["span"]["id"]), (&3.into(), &"lab-1".into()));
    }

    #[test]
    fn an_access_log_entry_is_one_line_of_json_in_each_format() {
        let entry = AccessLogEntry {
            id: "lab-1",
            peer: [192, 0, 2, 7].into(),
            method: "GET",
            target: "/v1/scenes?a=\"\n",
            status: 422,
            ms: 0.25,
        };
        for format in [LogFormat::Text, LogFormat::Json] {
            let lines = logged(format, || request_span("lab-1").in_scope(|| entry.write()));
            let (time, rest) = lines[0].split_once(",\"id\":").unwrap();
            assert!(time.strip_prefix("{\"time\":").unwrap().parse::<f64>().unwrap() > 1e9);
            assert_eq!(
                rest,
                "\"lab-1\",\"peer\":\"192.0.2.7\",\"method\":\"GET\",\"target\":\"/v1/scenes?a=\\\"\\n\",\"status\":422,\"ms\":0.25}"
            );
            assert_eq!(lines.len(), 1);
        }
    }
}
