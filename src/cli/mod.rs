//! The command line: the window, or `solve`, `render`, `matrix`, `probe`, `reference`, `chart`,
//! `tables`, `accuracy`, `selftest`, `scene`, `export` and `man` without one.
//!
//! Whatever cannot be done gives one sentence on stderr and exit code 2. Results go to stdout,
//! remarks about the scene and progress to stderr.

mod accuracy;
mod chart;
#[cfg(feature = "gui")]
mod clusters;
mod export;
#[cfg(feature = "gui")]
mod gathered;
mod job;
mod log;
mod man;
mod matrix;
mod options;
mod output;
mod panic;
#[cfg(feature = "gui")]
mod picture_chart;
mod probe;
mod progress;
#[cfg(feature = "gui")]
mod reading;
mod reference;
#[cfg(feature = "gui")]
mod render;
mod report;
mod scene;
mod selftest;
mod solve;
mod tables;
mod window;
mod work_plane;

use std::process::ExitCode;
use std::time::Instant;

use clap::error::ErrorKind;
use clap::{ArgMatches, Command};
use selflink::base::format::without_os_codes;
use selflink::base::panic_report;

/// Exit code of everything that cannot be done.
const CANNOT: u8 = 2;

/// Runs what the arguments ask for; `started` is when the process was.
pub fn main(started: Instant) -> ExitCode {
    panic_report::install(std::env::temp_dir());
    let matches = match command().try_get_matches() {
        Ok(matches) => matches,
        Err(error) if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) => {
            return match output::say(&error.render().to_string()) {
                Ok(()) => ExitCode::SUCCESS,
                Err(_) => ExitCode::from(CANNOT),
            };
        }
        Err(error) => return refuse(&sentence_of(&error)),
    };
    let done = log::start(&matches).and_then(|()| dispatch(&matches, started));
    match done {
        Ok(code) => code,
        Err(error) => refuse(&error.to_string()),
    }
}

fn dispatch(matches: &ArgMatches, started: Instant) -> anyhow::Result<ExitCode> {
    let done = match matches.subcommand() {
        Some(("selftest", matches)) => return selftest::run(matches),
        Some(("solve", matches)) => solve::run(matches, started),
        #[cfg(feature = "gui")]
        Some(("render", matches)) => render::run(matches),
        Some(("matrix", matches)) => matrix::run(matches),
        Some(("probe", matches)) => probe::run(matches),
        Some(("chart", matches)) => chart::run(matches),
        Some(("tables", matches)) => tables::run(matches),
        Some(("accuracy", matches)) => accuracy::run(matches),
        Some(("reference", matches)) => reference::run(matches),
        Some(("export", matches)) => export::run(matches),
        Some(("scene", matches)) => scene::run(matches),
        Some(("man", matches)) => man::run(matches, command()),
        Some(("panic", matches)) => panic::run(matches),
        _ => window::run(matches, started),
    };
    done.map(|()| ExitCode::SUCCESS)
}

fn command() -> Command {
    let command = window::command().subcommand(solve::command());
    #[cfg(feature = "gui")]
    let command = command.subcommand(render::command());
    let command = command.subcommand(matrix::command());
    let command = command.subcommand(probe::command()).subcommand(reference::command()).subcommand(chart::command());
    command
        .subcommand(tables::command())
        .subcommand(accuracy::command())
        .subcommand(selftest::command())
        .subcommand(scene::command())
        .subcommand(export::command())
        .subcommand(man::command())
        .subcommand(panic::command())
}

/// Says why, in one line.
fn refuse(sentence: &str) -> ExitCode {
    let words: Vec<&str> = sentence.split_whitespace().collect();
    eprintln!("selflink: {}", without_os_codes(&words.join(" ")));
    ExitCode::from(CANNOT)
}

/// Clap's message of several paragraphs as one sentence, without its usage lines.
fn sentence_of(error: &clap::Error) -> String {
    let text = error.render().to_string();
    let is_said = |paragraph: &&str| !paragraph.starts_with("Usage:") && !paragraph.starts_with("For more information");
    let said: Vec<&str> = text.split("\n\n").map(str::trim).filter(is_said).collect();
    let said = said.join("; ");
    format!("{} (see selflink{} --help)", said.strip_prefix("error: ").unwrap_or(&said), named_command())
}

/// The command that the arguments name, with a space before it; nothing where they name none.
fn named_command() -> String {
    let first = std::env::args_os().nth(1).unwrap_or_default();
    let command = command();
    let named = command
        .get_subcommands()
        .find(|command| command.get_name() == first || command.get_all_aliases().any(|name| first == *name));
    named.map_or(String::new(), |command| format!(" {}", command.get_name()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clap's own checks of names, defaults and conflicts.
    #[test]
    fn the_command_line_is_sound() {
        command().debug_assert();
    }
}
