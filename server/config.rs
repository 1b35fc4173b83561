//! Settings of the server: command-line flags and their environment variables.

use std::error::Error;
use std::ffi::OsString;
use std::fmt::{self, Display, Formatter};
use std::net::SocketAddr;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::Resettable;
use clap::error::ContextKind;
use clap::{CommandFactory, FromArgMatches, Parser};

use crate::compute::Network;
use crate::flags::yes_or_no;
use crate::http::{HostName, Origin, Token};
use crate::limits::Limits;
use crate::logging::LogFormat;

/// Says whether a bouncing object can be balanced: a page and an HTTP API.
#[derive(Debug, Clone, Parser)]
#[command(name = "equipoise", version = crate::BUILD, next_line_help = true)]
pub struct Config {
    /// Address to listen on; port 0 takes a free one
    #[arg(long, env = "EQUIPOISE_LISTEN", value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080")]
    pub listen: String,

    /// Number of requests computed at a time [default: number of cores]
    #[arg(long, env = "EQUIPOISE_PERMITS", value_name = "NUMBER")]
    pub permits: Option<NonZeroUsize>,

    /// Serve the page's files from this folder instead of the embedded ones, for work on the page
    #[arg(long, env = "EQUIPOISE_WEB", value_name = "FOLDER", value_parser = folder)]
    pub web: Option<PathBuf>,

    /// Form of the log on stderr. `RUST_LOG` sets its level, as in RUST_LOG=warn
    #[arg(long, env = "EQUIPOISE_LOG_FORMAT", value_name = "FORMAT", value_enum, default_value = "text")]
    pub log_format: LogFormat,

    /// Write a line of JSON to stderr for each request: time, id, peer, method, target, status, milliseconds
    #[arg(long, env = "EQUIPOISE_ACCESS_LOG")]
    #[arg(num_args = 0..=1, require_equals = true, default_missing_value = "true", default_value = "false")]
    #[arg(hide_default_value = true, hide_possible_values = true, value_name = "YES", value_parser = yes_or_no)]
    pub access_log: bool,

    /// Require this secret for everything but /health. Programs send it as `Authorization: Bearer …`; a browser opens /?token=…
    /// once. Other users of the machine can read a command line, so prefer the variable
    #[arg(long, env = "EQUIPOISE_TOKEN", value_name = "TOKEN", hide_env_values = true)]
    pub token: Option<Token>,

    /// Let pages of this origin use the API, live runs included; http://localhost:* is every port of a host, as for notebooks. May be
    /// given several times
    #[arg(long, env = "EQUIPOISE_ALLOW_ORIGIN", value_name = "ORIGIN", value_delimiter = ',')]
    pub allow_origin: Vec<Origin>,

    /// Answer to this host name too. Without a token and on localhost, the server answers only to localhost, to addresses and to
    /// these names, so that no page of another site can use its own name for it (DNS rebinding). Otherwise it answers to every name
    /// unless one is given here. May be given several times
    #[arg(long, env = "EQUIPOISE_ALLOW_HOST", value_name = "NAME", value_delimiter = ',')]
    pub allow_host: Vec<HostName>,

    /// Let pages of any site show pictures of this server, and its panels in frames. Otherwise pages of other sites get nothing
    /// that costs work, except those of --allow-origin
    #[arg(long, env = "EQUIPOISE_ALLOW_EMBEDDING")]
    #[arg(num_args = 0..=1, require_equals = true, default_missing_value = "true", default_value = "false")]
    #[arg(hide_default_value = true, hide_possible_values = true, value_name = "YES", value_parser = yes_or_no)]
    pub allow_embedding: bool,

    /// Path under which a proxy shows this server, as in /rig. Requests may come with it or without
    #[arg(long, env = "EQUIPOISE_BASE_PATH", value_name = "PATH", default_value = "", hide_default_value = true)]
    pub base_path: BasePath,

    /// Trust `X-Forwarded-For` from this proxy address or network, as far as its last entry. Otherwise all clients of the proxy
    /// share one client's quota. May be given several times
    #[arg(long, env = "EQUIPOISE_TRUST_PROXY", value_name = "ADDRESS[/BITS]", value_delimiter = ',')]
    pub trust_proxy: Vec<Network>,

    /// Limits of load.
    #[command(flatten)]
    pub limits: Limits,
}

impl Config {
    /// Number of requests computed at a time. It never changes an answer.
    pub fn permits(&self) -> usize {
        self.permits.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get)
    }

    /// Host names that are answered besides those of the machine itself; None if every name is.
    ///
    /// With a token no list is needed: a page that uses its own name for this server has neither the token nor a cookie.
    pub fn hosts(&self) -> Option<&[HostName]> {
        let is_open_to_pages = self.token.is_none() && self.listens_to_itself();
        (is_open_to_pages || !self.allow_host.is_empty()).then_some(&self.allow_host)
    }

    /// Tells whether only programs on this machine can connect.
    fn listens_to_itself(&self) -> bool {
        let Ok(address) = self.listen.parse::<SocketAddr>() else {
            let name = self.listen.rsplit_once(':').map_or(self.listen.as_str(), |(name, _)| name);
            return name.eq_ignore_ascii_case("localhost");
        };
        address.ip().to_canonical().is_loopback()
    }

    /// Says who has access, in a sentence for whoever starts the server.
    pub fn openness(&self, address: SocketAddr) -> String {
        let whom = match address.ip() {
            ip if ip.is_loopback() => "programs on this machine, and whatever a proxy on it lets through".to_owned(),
            ip if ip.is_unspecified() => "everyone who reaches this machine on any of its networks".to_owned(),
            ip => format!("everyone who reaches {ip}"),
        };
        let with = match self.token {
            Some(_) => "with the token, and /health without",
            None => "no token is asked for",
        };
        let origins: String =
            self.allow_origin.iter().map(|origin| format!("; pages of {origin} may ask too")).collect();
        let hosts: String = self.allow_host.iter().map(|host| format!("; it answers to the name {host} too")).collect();
        let embedding = if self.allow_embedding { "; pages of any site may show its pictures and panels" } else { "" };
        format!("open to {whom}: {with}{origins}{hosts}{embedding}")
    }
}

/// The error of a setting, with the name of its variable if that gave the value.
pub(crate) fn of_variable(error: clap::Error, arguments: &[OsString]) -> clap::Error {
    let text = |kind| error.get(kind).map(ToString::to_string);
    let (Some(argument), Some(value)) = (text(ContextKind::InvalidArg), text(ContextKind::InvalidValue)) else {
        return error;
    };
    let flag = argument.split([' ', '=', '[']).next().unwrap_or_default();
    let is_given = |given: &OsString| {
        let given = given.to_string_lossy();
        given.strip_prefix(flag).is_some_and(|rest| rest.is_empty() || rest.starts_with('='))
    };
    let mut command = Config::command();
    let variable = command
        .get_arguments()
        .find(|known| known.get_long().is_some_and(|long| flag.strip_prefix("--") == Some(long)))
        .and_then(|known| known.get_env())
        .map(|variable| variable.to_string_lossy().into_owned());
    let Some(variable) = variable.filter(|_| !arguments.iter().any(is_given)) else { return error };
    let shown = if variable == "EQUIPOISE_TOKEN" { "the value".to_owned() } else { format!("{value:?}") };
    let known = text(ContextKind::ValidValue).map(|known| format!("it must be one of {known}"));
    let why = error.source().map(ToString::to_string).or(known).unwrap_or_else(|| "the value is not valid".to_owned());
    command.error(error.kind(), format!("{shown} of the variable {variable}: {why}"))
}

/// Parses a folder that exists.
fn folder(text: &str) -> Result<PathBuf, String> {
    let folder = PathBuf::from(text);
    if folder.is_dir() { Ok(folder) } else { Err("there is no folder of this name".to_owned()) }
}

/// The defaults. The environment is not read.
impl Default for Config {
    fn default() -> Self {
        let command = Self::command().mut_args(|arg| arg.env(Resettable::Reset));
        Self::from_arg_matches(&command.get_matches_from([""])).expect("everything has a default")
    }
}

/// A path in front of all others: empty, or `/` and segments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BasePath(String);

impl BasePath {
    /// The path as text; it may be empty.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl FromStr for BasePath {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let path = text.trim_end_matches('/');
        let is_plain = |segment: &str| {
            !matches!(segment, "" | "." | "..")
                && segment.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte))
        };
        let is_fine = match path.strip_prefix('/') {
            None => path.is_empty(),
            Some(segments) => path.len() <= 256 && segments.split('/').all(is_plain),
        };
        if !is_fine {
            return Err("it must begin with / and have segments of letters, digits and -._~, as in /rig".to_owned());
        }
        Ok(Self(path.to_owned()))
    }
}

impl Display for BasePath {
    fn fmt(&self, formatter: &mut Formatter) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn parsed(arguments: &[&str]) -> Result<Config, String> {
        Config::try_parse_from([&["equipoise"], arguments].concat()).map_err(|error| error.to_string())
    }

    #[test]
    fn the_command_line_is_consistent() {
        Config::command().debug_assert();
        let config = parsed(&["--listen", "[::1]:0", "--permits", "3"]).unwrap();
        assert_eq!((config.listen.as_str(), config.permits()), ("[::1]:0", 3));
        assert!(parsed(&["--permits", "0"]).is_err());
        assert!(Config::default().permits() >= 1);
    }

    #[test]
    fn limits_are_set_within_their_ranges() {
        let config = parsed(&["--connections", "100", "--head-time", "7", "--region-work", "5000"]).unwrap();
        let Limits { connections, head_time, region_work, .. } = config.limits;
        assert_eq!((connections, head_time, region_work), (100, Duration::from_secs(7), 5000));
        assert_eq!(Limits { connections, head_time, region_work, ..Limits::default() }, config.limits);
        for (flag, value, unit) in [
            ("--connections", "7", "16 to 1000000 connections"),
            ("--head-time", "0", "1 to 3600 seconds"),
            ("--head-time", "1.5", "whole number"),
            ("--body-bytes", "much", "bytes"),
            ("--work", "0", "bounces"),
        ] {
            let error = parsed(&[flag, value]).unwrap_err();
            assert!(error.contains(flag) && error.contains(unit), "{error}");
        }
    }

    /// `--help` shows flag, variable, unit and default of every limit.
    #[test]
    fn help_shows_every_limit() {
        let help = Config::command().render_long_help().to_string();
        let (_, limits) = help.split_once("Limits:").unwrap();
        let shown = limits.matches("\n      --").count();
        assert_eq!(shown, format!("{:?}", Limits::default()).matches(": ").count(), "{help}");
        for part in ["[env: EQUIPOISE_", "[default: "] {
            assert_eq!(limits.matches(part).count(), shown, "{limits}");
        }
        assert!(!help.contains("EQUIPOISE_TOKEN="), "{help}");
    }

    #[test]
    fn what_is_open_to_whom_is_said() {
        let say = |listen: &str, arguments: &[&str]| parsed(arguments).unwrap().openness(listen.parse().unwrap());
        assert!(say("127.0.0.1:80", &[]).starts_with("open to programs on this machine"));
        assert!(say("0.0.0.0:80", &[]).ends_with("any of its networks: no token is asked for"));
        let guarded = ["--token", "0123456789abcdef", "--allow-origin", "https://lab.example"];
        let said = say("192.0.2.1:80", &guarded);
        assert!(said.contains("with the token") && said.contains("https://lab.example"), "{said}");
        assert!(!said.contains("0123456789abcdef"));
    }

    #[test]
    fn names_are_looked_at_where_a_page_of_another_site_could_ask() {
        let hosts = |arguments: &[&str]| {
            let config = parsed(arguments).unwrap();
            config.hosts().map(|hosts| hosts.iter().map(ToString::to_string).collect::<Vec<_>>())
        };
        for listen in ["127.0.0.1:8080", "127.9.9.9:1", "[::1]:0", "[::ffff:127.0.0.1]:0", "localhost:8080"] {
            assert_eq!(hosts(&["--listen", listen]), Some(vec![]), "{listen}");
            assert_eq!(hosts(&["--listen", listen, "--token", "0123456789abcdef"]), None, "{listen}");
        }
        let named = ["--allow-host", "rig.lab,Rig", "--allow-host", "a.example"];
        for listen in ["0.0.0.0:80", "[::]:80", "192.0.2.1:80", "lab.example:80"] {
            assert_eq!(hosts(&["--listen", listen]), None, "{listen}");
            let all = [&["--listen", listen], named.as_slice()].concat();
            assert_eq!(hosts(&all), Some(["rig.lab", "rig", "a.example"].map(str::to_owned).into()), "{listen}");
        }
        assert!(parsed(&["--allow-host", "http://rig.lab:80"]).unwrap_err().contains("without scheme and port"));
        let said =
            parsed(&[&named[..], &["--allow-embedding"]].concat()).unwrap().openness("127.0.0.1:80".parse().unwrap());
        assert!(said.contains("the name rig.lab too") && said.ends_with("pictures and panels"), "{said}");
    }

    #[test]
    fn a_base_path_is_a_path() {
        for (text, path) in [("", ""), ("/", ""), ("/rig", "/rig"), ("/lab/rig-2/", "/lab/rig-2")] {
            assert_eq!(text.parse::<BasePath>().unwrap().as_str(), path);
        }
        for text in ["rig", "//rig", "/a//b", "/a/../b", "/a?b", "/ä", "http://x/"] {
            assert!(text.parse::<BasePath>().is_err(), "{text}");
        }
    }
}
