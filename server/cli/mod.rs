//! The command line: serves, or answers one request without a server, as in `equipoise stability --preset case-1 table.tilt_gain=1.2`.
//!
//! Such a request goes to the router in this process, so that its answer has the bytes of the server's.

mod answer;
mod help;
mod question;

use std::ffi::OsString;

use clap::builder::PossibleValuesParser;
use clap::error::ErrorKind;
use clap::{Arg, Command, CommandFactory, FromArgMatches, value_parser};
use clap_complete::{Shell, generate};
use clap_mangen::Man;

use crate::api::COMPUTED;
pub use crate::cli::answer::answer;
pub use crate::cli::question::Question;
use crate::config::{Config, of_variable};
use crate::limits::Limits;

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
    let contract = is_help.then(help::Contract::read);
    let answers = COMPUTED.into_iter().map(|endpoint| {
        let command = question::command(endpoint);
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
