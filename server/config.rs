//! What can be set when the server starts: the command line and its environment variables.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Parser;

/// Says whether a bouncing object can be balanced: a page and an HTTP API.
#[derive(Debug, Clone, Parser)]
#[command(name = "equipoise", version = crate::BUILD)]
pub struct Config {
    /// Where to listen; port 0 takes any that is free
    #[arg(long, env = "EQUIPOISE_LISTEN", value_name = "ADDRESS:PORT", default_value = Self::LISTEN)]
    pub listen: String,

    /// Requests computed at a time [default: as many as there are cores]
    #[arg(long, env = "EQUIPOISE_PERMITS", value_name = "NUMBER")]
    pub permits: Option<NonZeroUsize>,

    /// Serve the page's files from this folder instead of the embedded ones, while working on them
    #[arg(long, env = "EQUIPOISE_WEB", value_name = "FOLDER")]
    pub web: Option<PathBuf>,
}

impl Config {
    const LISTEN: &str = "127.0.0.1:8080";

    /// Requests computed at a time. How many never changes what an answer says, only when.
    pub fn permits(&self) -> usize {
        self.permits.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get)
    }
}

/// As from an empty command line in an empty environment.
impl Default for Config {
    fn default() -> Self {
        Self { listen: Self::LISTEN.to_owned(), permits: None, web: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Config::command().debug_assert();
        let config = Config::try_parse_from(["equipoise", "--listen", "[::1]:0", "--permits", "3"]).unwrap();
        assert_eq!((config.listen.as_str(), config.permits()), ("[::1]:0", 3));
        assert!(Config::try_parse_from(["equipoise", "--permits", "0"]).is_err());
        assert!(Config::default().permits() >= 1);
    }
}
