//! One request to the router of this process, and its answer on standard output or in a file.

use std::fs::File;
use std::io::{self, Write};
use std::process::ExitCode;

use futures_util::StreamExt;
use http_body_util::BodyExt;
use serde::de::IgnoredAny;
use serde_json::Value;
use tower::ServiceExt;

use crate::api::App;
use crate::cli::question::Question;
use crate::config::Config;
use crate::router::router;

/// Answers a request. The exit status is 1 if the server would refuse it, or if the answer cannot be written.
pub async fn answer(config: &Config, question: Question) -> ExitCode {
    match answered(config, question).await {
        Ok(()) => ExitCode::SUCCESS,
        // A reader such as `head` has what it wants.
        Err(Failure::Io(error)) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::FAILURE,
        Err(Failure::Io(error)) => {
            eprintln!("equipoise: {error}");
            ExitCode::FAILURE
        }
        Err(Failure::Refused(problem)) => {
            eprint!("{}", in_lines(&problem));
            ExitCode::FAILURE
        }
    }
}

/// A reason for which there is no answer.
enum Failure {
    Refused(Value),
    Io(io::Error),
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

async fn answered(config: &Config, question: Question) -> Result<(), Failure> {
    let Question { request, output, tells_progress } = question;
    let Ok(response) = router(App::new(config)).oneshot(request).await;
    let is_answer = response.status().is_success();
    let body = response.into_body();
    if !is_answer {
        let bytes = body.collect().await.map_err(io::Error::other)?.to_bytes();
        return Err(Failure::Refused(serde_json::from_slice(&bytes).unwrap_or_default()));
    }
    let mut out: Box<dyn Write> = Box::new(io::stdout().lock());
    // Lines of progress may end in a problem, which leaves a file as it is.
    let mut file = output;
    let mut write = |bytes: &[u8]| {
        if let Some(file) = file.take_if(|_| !bytes.is_empty()) {
            let name = |error| io::Error::other(format!("{}: {error}", file.display()));
            out = Box::new(File::create(&file).map_err(name)?);
        }
        out.write_all(bytes)
    };
    let mut pieces = body.into_data_stream();
    let mut line = Vec::new();
    while let Some(piece) = pieces.next().await {
        let piece = piece.map_err(io::Error::other)?;
        if !tells_progress {
            write(&piece)?;
            continue;
        }
        for part in piece.split_inclusive(|byte| *byte == b'\n') {
            line.extend_from_slice(part);
            if line.ends_with(b"\n") {
                write(of_line(&line)?)?;
                line.clear();
            }
        }
    }
    Ok(out.flush()?)
}

/// The start of the line that has the answer.
const END: &[u8] = b"{\"end\":";

/// The answer in the last line of a report of progress; nothing in other lines, which a terminal shows.
fn of_line(line: &[u8]) -> Result<&[u8], Failure> {
    let Some(rest) = line.strip_prefix(END) else {
        let line: Value = serde_json::from_slice(line).unwrap_or_default();
        if let Some(problem) = line.get("problem") {
            return Err(Failure::Refused(problem.clone()));
        }
        let number = |name: &str| line["progress"][name].as_f64();
        if let (Some(done), Some(of)) = (number("done"), number("of")) {
            eprint!("\r{:3.0} %", 100.0 * done / of.max(1.0));
        }
        return Ok(b"");
    };
    eprint!("\r     \r");
    let mut values = serde_json::Deserializer::from_slice(rest).into_iter::<IgnoredAny>();
    values.next();
    Ok(&rest[..values.byte_offset()])
}

/// A problem in lines: one for each fault, with the name of the field as in a query.
fn in_lines(problem: &Value) -> String {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let line = |error: &Value| {
        let pointer = text(&error["pointer"]);
        let name = pointer.trim_start_matches('/').replace('/', ".");
        let name = name.strip_prefix("scene.").unwrap_or(&name);
        let separator = if name.is_empty() { "" } else { ": " };
        format!("equipoise: {name}{separator}{}\n", text(&error["detail"]))
    };
    match problem["errors"].as_array() {
        Some(errors) if !errors.is_empty() => errors.iter().map(line).collect(),
        _ => line(problem),
    }
}
