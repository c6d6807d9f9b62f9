//! `selflink solve`: a solution without a window; statistics, and the lit mesh as PLY.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::bail;
use clap::{ArgMatches, Command};
use selflink::export;

use super::job::Order;
use super::options::{self, path, path_arg};
use super::output::{OutputFile, json, say};
use super::report::Report;

/// The command's arguments.
pub fn command() -> Command {
    options::solving(Command::new("solve").about("Solve a scene; print a summary, write statistics and the lit mesh"))
        .arg(
            path_arg("stats", "FILE.json")
                .help("Write the statistics as JSON; - writes them to stdout, in place of the summary"),
        )
        .arg(path_arg("out", "FILE.ply").help("Write the lit mesh: vertices with radiosities in W/m² (binary PLY)"))
}

/// Runs it.
pub fn run(matches: &ArgMatches, started: Instant) -> anyhow::Result<()> {
    let order = Order::from_matches(matches)?;
    let output = |path: PathBuf| OutputFile::new(&path, &order.inputs());
    let stats_path = path(matches, "stats");
    let stats_to_stdout = stats_path.as_deref() == Some(Path::new("-"));
    let stats_file = stats_path.filter(|_| !stats_to_stdout).map(output).transpose()?;
    let mesh_path = path(matches, "out");
    let is_ply = |path: &&PathBuf| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ply"));
    if let Some(path) = mesh_path.as_ref().filter(|path| !is_ply(path)) {
        bail!("{}: meshes are written as PLY; choose a name that ends in .ply", path.display());
    }
    let mesh_file = mesh_path.map(output).transpose()?;

    let job = order.load()?;
    let solution = job.solve()?;
    if let Some(file) = &mesh_file {
        let snapshot = &solution.snapshot;
        file.write(|writer| export::write_ply(writer, &snapshot.mesh, &snapshot.vertex_radiosity))?;
    }
    let report = Report::new(&job, &solution, started);
    if let Some(file) = &stats_file {
        let text = json(&report)?;
        file.write(|writer| std::io::Write::write_all(writer, text.as_bytes()))?;
    }
    say(&if stats_to_stdout { json(&report)? } else { report.summary() })
}
