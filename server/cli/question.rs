//! A request on the command line: the subcommand of a resource, and its arguments as a request to the router.

use std::fs;
use std::io::{self, IsTerminal, Read};
use std::path::{Path, PathBuf};

use axum::body::Body;
use axum::http::{Request, Uri, header};
use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, value_parser};

use crate::api::resource::Endpoint;
use crate::http::Format;
use crate::limits::Limits;

/// A request, and the place of its answer.
#[derive(Debug)]
pub struct Question {
    pub(super) request: Request<Body>,
    /// The file of the answer; standard output if there is none.
    pub(super) output: Option<PathBuf>,
    /// True if lines report the progress; the last one has the answer.
    pub(super) tells_progress: bool,
}

impl Question {
    /// The request that the arguments stand for.
    pub(super) fn of(endpoint: Endpoint, matches: &ArgMatches) -> Result<Self, String> {
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
pub(super) fn command(endpoint: Endpoint) -> Command {
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
