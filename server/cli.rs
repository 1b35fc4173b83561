//! The command line: serves, or answers one request without a server, as in `equipoise stability --preset case-1 table.tilt_gain=1.2`.
//!
//! Such a request goes to the router in this process, so that its answer has the bytes of the server's.

use std::ffi::OsString;
use std::fs::File;
use std::io::{IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::pin::pin;
use std::process::ExitCode;
use std::time::Duration;
use std::{fs, io};

use axum::body::Body;
use axum::http::{Request, Uri, header};
use clap::builder::PossibleValuesParser;
use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, CommandFactory, FromArgMatches, value_parser};
use clap_complete::{Shell, generate};
use clap_mangen::Man;
use futures_util::StreamExt;
use http_body_util::BodyExt;
use prometheus_client::metrics::counter::Counter;
use serde::de::IgnoredAny;
use serde_json::Value;
use tokio::time::timeout;
use tower::ServiceExt;

use crate::api::App;
use crate::api::computed::COMPUTED;
use crate::api::ops::contract::WRITTEN;
use crate::api::resource::Endpoint;
use crate::config::{Config, of_variable};
use crate::http::Format;
use crate::limits::Limits;
use crate::router::router;

/// The subcommand that serves, which is the default.
const SERVE: &str = "serve";

/// Subcommands that write completions for a shell, and a page of the manual.
const COMPLETIONS: &str = "completions";
const MANUAL: &str = "man";

/// A task of the program.
#[derive(Debug)]
pub enum Task {
    /// Serve.
    Serve(Box<Config>),
    /// Answer one request.
    Answer(Box<Config>, Box<Question>),
    /// Print this text.
    Print(Vec<u8>),
}

/// Reads the command line and the environment.
///
/// # Errors
/// A wrong setting or argument, or a request for help.
pub fn read(arguments: impl IntoIterator<Item = OsString>) -> Result<Task, clap::Error> {
    let arguments: Vec<_> = arguments.into_iter().collect();
    // The contract is read for help alone: an answer does not wait for it.
    let of_help = ["--help", "-h", "help", COMPLETIONS, MANUAL];
    let is_help = arguments.iter().any(|argument| of_help.iter().any(|help| argument == help));
    let mut command = command(is_help);
    let matches = command.try_get_matches_from_mut(&arguments).map_err(|error| of_variable(error, &arguments))?;
    match matches.subcommand() {
        None => Ok(Task::Serve(Box::new(Config::from_arg_matches(&matches)?))),
        Some((SERVE, matches)) => Ok(Task::Serve(Box::new(Config::from_arg_matches(matches)?))),
        Some((COMPLETIONS, matches)) => {
            let shell = *matches.get_one::<Shell>("shell").expect("a required argument");
            let mut text = Vec::new();
            generate(shell, &mut command, "equipoise", &mut text);
            Ok(Task::Print(text))
        }
        Some((MANUAL, matches)) => {
            let name = matches.get_one::<String>("command").cloned();
            // Names the pages of the subcommands after the program.
            command.build();
            let page = name.and_then(|name| command.find_subcommand(name)).unwrap_or(&command).clone();
            let mut text = Vec::new();
            Man::new(page).render(&mut text)?;
            Ok(Task::Print(text))
        }
        Some((name, matches)) => {
            let config = Config { limits: Limits::from_arg_matches(matches)?, ..Config::default() };
            let endpoint = COMPUTED.into_iter().find(|endpoint| endpoint.name == name).expect("one of the subcommands");
            let command = command.find_subcommand_mut(name).expect("the same");
            let question = Question::of(endpoint, matches);
            let question = question.map_err(|why| command.error(ErrorKind::ValueValidation, why))?;
            Ok(Task::Answer(Box::new(config), Box::new(question)))
        }
    }
}

/// The whole command line, with descriptions and fields of the subcommands if they are to be shown.
fn command(is_help: bool) -> Command {
    let contract = is_help.then(Contract::read);
    let answers = COMPUTED.into_iter().map(|endpoint| {
        let command = subcommand(endpoint);
        match &contract {
            Some(contract) => contract.explain(command, endpoint.name),
            None => command,
        }
    });
    let serve = Config::command().name(SERVE).about("Serve the page and the HTTP API; the default");
    let shell = Arg::new("shell").required(true).value_name("SHELL").value_parser(value_parser!(Shell));
    let completions = Command::new(COMPLETIONS).about("Write completions for a shell").arg(shell);
    let names = COMPUTED.map(|endpoint| endpoint.name).into_iter().chain([SERVE]);
    let page = Arg::new("command").value_name("COMMAND").value_parser(PossibleValuesParser::new(names));
    let manual = Command::new(MANUAL).about("Write a page of the manual: of the program, or of a command").arg(page);
    let others = [serve, completions, manual];
    Config::command().args_conflicts_with_subcommands(true).subcommands(answers).subcommands(others)
}

/// A request, and the place of its answer.
#[derive(Debug)]
pub struct Question {
    request: Request<Body>,
    /// The file of the answer; standard output if there is none.
    output: Option<PathBuf>,
    /// True if lines report the progress; the last one has the answer.
    tells_progress: bool,
}

impl Question {
    /// The request that the arguments stand for.
    fn of(endpoint: Endpoint, matches: &ArgMatches) -> Result<Self, String> {
        let text = |name: &str| matches.get_one::<String>(name).map(String::as_str);
        let output = matches.get_one::<PathBuf>("output").cloned();
        let format = match (text("format"), &output) {
            (Some(format), _) => Some(format),
            (None, Some(file)) => Some(format_of(file, endpoint.formats())?),
            (None, None) => None,
        };
        let fields = matches.get_many::<(String, String)>("fields").into_iter().flatten();
        let fields: Vec<_> = fields.map(|(name, value)| (name.as_str(), value.as_str())).collect();
        let is_json = format.is_none_or(|format| format == Format::Json.name());
        let tells_progress = is_json
            && io::stderr().is_terminal()
            && endpoint.formats().contains(&Format::Progress)
            && fields.iter().all(|(name, _)| *name != "format");
        let format = if tells_progress { Some(Format::Progress.name()) } else { format };
        let named = [("preset", text("preset")), ("format", format)];
        let mut query = form_urlencoded::Serializer::new(String::new());
        query.extend_pairs(named.into_iter().filter_map(|(name, value)| Some((name, value?))).chain(fields));
        let uri =
            format!("/v1/{}?{}", endpoint.name, query.finish()).parse::<Uri>().map_err(|error| error.to_string())?;
        let request = match matches.get_one::<PathBuf>("data") {
            None => Request::get(uri).body(Body::empty()),
            Some(file) => {
                let data = data(file).map_err(|error| format!("{}: {error}", file.display()))?;
                Request::post(uri).header(header::CONTENT_TYPE, media_type(&data)).body(Body::from(data))
            }
        };
        Ok(Self { request: request.map_err(|error| error.to_string())?, output, tells_progress })
    }
}

/// The subcommand of a resource.
fn subcommand(endpoint: Endpoint) -> Command {
    let formats = endpoint.formats().iter().map(|format| format.name());
    let command = Command::new(endpoint.name)
        .arg(Arg::new("preset").long("preset").value_name("NAME").help("Preset to start from, the same as preset=NAME"))
        .arg(
            Arg::new("format")
                .long("format")
                .value_name("FORMAT")
                .value_parser(PossibleValuesParser::new(formats))
                .help("Format of the answer"),
        )
        .arg(
            Arg::new("output")
                .short('o')
                .long("output")
                .value_name("FILE")
                .value_parser(value_parser!(PathBuf))
                .help("Write the answer to this file; its extension is the format"),
        )
        .arg(
            Arg::new("data")
                .long("data")
                .value_name("FILE")
                .value_parser(value_parser!(PathBuf))
                .required(endpoint.post_only)
                .help("Send this file as the body of the request: JSON, or a table as CSV or Arrow. `-` is standard input"),
        )
        .arg(
            Arg::new("fields")
                .value_name("NAME=VALUE")
                .action(ArgAction::Append)
                .num_args(0..)
                .value_parser(field)
                .help("Fields of the request, as in a query"),
        );
    // The limits of the server hold here too. `serve --help` explains them.
    Limits::augment_args(command).mut_args(|arg| if arg.get_env().is_some() { arg.hide(true) } else { arg })
}

/// A field of a request.
fn field(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').filter(|(name, _)| !name.is_empty()).ok_or("it must be NAME=VALUE")?;
    Ok((name.to_owned(), value.to_owned()))
}

/// The format that a file's extension names.
fn format_of(file: &Path, formats: &[Format]) -> Result<&'static str, String> {
    let extension = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    // The IPC stream format has an extension of its own.
    let extension = if extension == "arrows" { "arrow" } else { extension.as_str() };
    let names = || formats.iter().map(|format| format.name());
    names().find(|name| *name == extension).ok_or_else(|| {
        let known = names().collect::<Vec<_>>().join(", .");
        format!("{} has none of the extensions .{known}; give --format", file.display())
    })
}

fn data(file: &Path) -> io::Result<Vec<u8>> {
    if file != Path::new("-") {
        return fs::read(file);
    }
    let mut data = Vec::new();
    io::stdin().read_to_end(&mut data)?;
    Ok(data)
}

/// The media type of a body by its first bytes.
fn media_type(data: &[u8]) -> &'static str {
    match data.trim_ascii_start() {
        [b'{', ..] => "application/json",
        [0xff, 0xff, 0xff, 0xff, ..] => Format::Arrow.media_type(),
        _ => "text/csv",
    }
}

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
    let app = App::new(config);
    let bounces = app.metrics.bounces.clone();
    let shows_bounces = io::stderr().is_terminal() && !tells_progress;
    let Ok(response) = with_bounces(router(app).oneshot(request), &bounces, shows_bounces).await;
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
    while let Some(piece) = with_bounces(pieces.next(), &bounces, shows_bounces).await {
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

/// Time between two looks at the bounces computed so far.
const LOOK: Duration = Duration::from_millis(500);

/// Waits for a part of an answer. If `shows` is true, the terminal meanwhile shows the bounces computed so far.
async fn with_bounces<T>(part: impl Future<Output = T>, bounces: &Counter, shows: bool) -> T {
    if !shows {
        return part.await;
    }
    let mut part = pin!(part);
    let mut is_shown = false;
    loop {
        if let Ok(part) = timeout(LOOK, &mut part).await {
            if is_shown {
                eprint!("\r{:32}\r", "");
            }
            return part;
        }
        eprint!("\r{} bounces", bounces.get());
        is_shown = true;
    }
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

/// The last words of the help on a subcommand.
const NOTE: &str =
    "Names of a scene's fields may begin with `scene.`. The limits of `serve` hold, by its variables and flags.";

/// The contract as a document.
struct Contract(Value);

impl Contract {
    fn read() -> Self {
        Self(serde_json::from_slice(WRITTEN).unwrap_or_default())
    }

    /// Adds what the contract says of a resource to its subcommand.
    fn explain(&self, command: Command, name: &str) -> Command {
        let item = &self.0["paths"][format!("/v1/{name}")];
        let operation = item.get("get").unwrap_or(&item["post"]);
        let text = |name: &str| unwrapped(operation[name].as_str().unwrap_or_default());
        let fields = match item.get("get") {
            Some(get) => {
                let parameters = get["parameters"].as_array().into_iter().flatten();
                parameters.map(|parameter| self.resolve(parameter)).filter_map(parameter_line).collect()
            }
            None => {
                let body = &item["post"]["requestBody"]["content"]["application/json"]["schema"];
                let own = self.resolve(body)["properties"].as_object().into_iter().flatten();
                let own = own.filter(|(name, _)| *name != "preset" && *name != "scene").map(property_line);
                let parameters = self.0["components"]["parameters"].as_object().into_iter().flatten();
                let is_of_scene = |name: &Value| name.as_str().is_some_and(|name| name.starts_with("scene."));
                let scene =
                    parameters.map(|(_, parameter)| parameter).filter(|parameter| is_of_scene(&parameter["name"]));
                own.chain(scene.filter_map(parameter_line)).collect::<String>()
            }
        };
        let about = format!("{}\n\n{}", text("summary"), text("description"));
        command.about(text("summary")).long_about(about).after_long_help(format!("Fields:\n{fields}\n{NOTE}"))
    }

    /// The part that a reference names, or the part itself.
    fn resolve<'a>(&'a self, part: &'a Value) -> &'a Value {
        let pointer = part["$ref"].as_str().and_then(|reference| reference.strip_prefix('#'));
        pointer.and_then(|pointer| self.0.pointer(pointer)).unwrap_or(part)
    }
}

/// Prose with each paragraph and item on one line, which the terminal wraps.
fn unwrapped(prose: &str) -> String {
    let paragraphs = prose.trim().replace("\n\n", "\0").replace("\n- ", "\u{1}").replace('\n', " ");
    paragraphs.replace('\0', "\n\n").replace('\u{1}', "\n- ")
}

/// A parameter of a query: name, kind, range, default and word.
fn parameter_line(parameter: &Value) -> Option<String> {
    let name = parameter["name"].as_str()?;
    // Flags of their own.
    if name == "preset" || name == "format" {
        return None;
    }
    let name = name.strip_prefix("scene.").unwrap_or(name);
    Some(line(name, &parameter["schema"], parameter["description"].as_str()))
}

fn property_line((name, schema): (&String, &Value)) -> String {
    line(name, schema, schema["description"].as_str())
}

fn line(name: &str, schema: &Value, about: Option<&str>) -> String {
    let mut facts: Vec<String> = Vec::new();
    if let Some(words) = schema["enum"].as_array() {
        let words: Vec<_> = words.iter().filter_map(Value::as_str).collect();
        facts.push(words.join(", "));
    }
    let unit = schema["x-unit"].as_str().filter(|unit| *unit != "1").map(|unit| format!(" {unit}")).unwrap_or_default();
    if let (Some(least), Some(most)) = (schema["minimum"].as_f64(), schema["maximum"].as_f64()) {
        facts.push(format!("{least} to {most}{unit}"));
    }
    if let Some(default) = schema.get("default").or(schema.get("x-default")) {
        let number = default.as_f64().map_or_else(|| default.to_string(), |number| number.to_string());
        let default = default.as_str().map_or(number, str::to_owned);
        facts.push(format!("default {default}"));
    }
    let facts = if facts.is_empty() { String::new() } else { format!(" [{}]", facts.join("; ")) };
    format!("  {name}{facts}\n          {}\n", about.unwrap_or_default().replace('\n', " ").trim())
}
