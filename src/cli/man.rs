//! `selflink man`: manual pages and shell completions, made from the same table as `--help`.

use std::io;
use std::path::Path;

use anyhow::anyhow;
use clap::{ArgMatches, Command};
use clap_complete::Shell;
use selflink::base::format::things;

use super::options::{path, path_arg};
use super::output::say;

/// Shells that completions are written for.
const SHELLS: [Shell; 3] = [Shell::Bash, Shell::Zsh, Shell::Fish];

/// The command's arguments.
pub fn command() -> Command {
    Command::new("man").about("Write manual pages and shell completions, for those who package the program").arg(
        path_arg("folder", "DIR")
            .long(None)
            .index(1)
            .required(true)
            .help("Folder to write to; it is made where it is missing"),
    )
}

/// Writes those of the whole program.
pub fn run(matches: &ArgMatches, program: Command) -> anyhow::Result<()> {
    let folder = path(matches, "folder").unwrap_or_default();
    let written = write(&folder, program).map_err(|error| {
        anyhow!("{}: cannot be written ({error}); choose a folder that you may write to", folder.display())
    })?;
    say(&format!("{}: {}\n", folder.display(), things(written, "file", "files")))
}

/// Pages go to `man`, completions to `completions`.
fn write(folder: &Path, mut program: Command) -> io::Result<usize> {
    let [pages, completions] = ["man", "completions"].map(|name| folder.join(name));
    std::fs::create_dir_all(&pages)?;
    std::fs::create_dir_all(&completions)?;
    // Before completions build the command, which adds pages for `help` and for each of its words.
    let of_pages = program.clone().disable_help_subcommand(true);
    for shell in SHELLS {
        clap_complete::generate_to(shell, &mut program, "selflink", &completions)?;
    }
    let commands = 1 + of_pages.get_subcommands().filter(|command| !command.is_hide_set()).count();
    clap_mangen::generate_to(of_pages, &pages)?;
    Ok(commands + SHELLS.len())
}
