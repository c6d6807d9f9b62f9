//! `selflink solve`: a solution without a window; statistics, the lit mesh as PLY or GLB, and links
//! as CSV.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use clap::{ArgMatches, Command};
use selflink::export::{LitMesh, MeshFormat, links};

use super::job::Order;
use super::options::{self, path, path_arg};
use super::output::{OutputFile, json, say};
use super::report::Report;

/// The command's arguments.
pub fn command() -> Command {
    options::solving(
        Command::new("solve").about("Solve a scene; print a summary, write statistics, the lit mesh and links"),
    )
    .arg(
        path_arg("stats", "FILE.json")
            .help("Write the statistics as JSON; - writes them to stdout, in place of the summary"),
    )
    .arg(
        path_arg("out", "FILE.ply|glb").help(
            "Write the lit mesh: vertices with radiosities in W/m² and tone-mapped colours, as binary PLY or as GLB",
        ),
    )
    .arg(path_arg("links", "FILE.csv").help("Write every link: both ends, F, V, rays and power in W"))
}

/// Runs it.
pub fn run(matches: &ArgMatches, started: Instant) -> anyhow::Result<()> {
    let order = Order::from_matches(matches)?;
    let output = |path: PathBuf| OutputFile::new(&path, &order.inputs());
    let stats_path = path(matches, "stats");
    let stats_to_stdout = stats_path.as_deref() == Some(Path::new("-"));
    let stats_file = stats_path.filter(|_| !stats_to_stdout).map(output).transpose()?;
    let mesh_path = path(matches, "out");
    let mesh_format = mesh_path.as_deref().map(MeshFormat::of).transpose()?;
    let mesh_file = mesh_path.map(output).transpose()?;
    let links_file = path(matches, "links").map(output).transpose()?;

    let job = order.load()?;
    let mut solution = job.solve()?;
    if let (Some(file), Some(format)) = (&mesh_file, mesh_format) {
        let lit = LitMesh::of(&solution.snapshot, &job.scene);
        file.write(|writer| format.write(writer, &lit))?;
    }
    if let Some(file) = &links_file {
        solution.solver.show_solution_view(true);
        let solution_view = job.pool.install(|| solution.solver.snapshot()).solution_view;
        let solution_view = solution_view.context("the solution does not show its links")?;
        file.write(|writer| job.pool.install(|| links::write(writer, &solution_view)))?;
    }
    let report = Report::new(&job, &solution, started);
    if let Some(file) = &stats_file {
        file.write_text(&json(&report)?)?;
    }
    say(&if stats_to_stdout { json(&report)? } else { report.summary() })
}
