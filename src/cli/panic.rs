//! `selflink panic`, which no help lists: breaks on purpose, so that the report of a panic can be
//! tried.

use clap::{ArgMatches, Command};

use super::job::Order;
use super::options;

/// The command's arguments.
pub fn command() -> Command {
    options::solving(Command::new("panic").hide(true).about("Break on purpose, to try the report of a panic"))
}

/// Panics once the settings are known.
pub fn run(matches: &ArgMatches) -> anyhow::Result<()> {
    let _order = Order::from_matches(matches)?;
    panic!("broken on purpose")
}
