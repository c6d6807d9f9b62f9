//! `selflink tables`: the paper's tables, statements and figures run again, as text, Markdown, CSV
//! and pictures.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::anyhow;
use clap::{ArgMatches, Command};
use rayon::ThreadPool;
use selflink::base::format::seconds;
use selflink::measure::tables::{Claim, Effort, Lab, Part, Report, Verdict, claims_markdown};
use selflink::solve::ParameterId;

use super::job::pool;
use super::options::{self, flag_arg, path, path_arg, value_arg};
use super::output::{OutputFile, make_folder, say};
use super::reference;

/// The folder when nothing is said.
const OUT: &str = "docs/paper";

/// The command's arguments.
pub fn command() -> Command {
    let command = Command::new("tables")
        .about("Run the paper's tables and statements again, its rows above ours, with a verdict on each of its claims")
        .arg(path_arg("out", "DIR").help(format!("Folder for the tables; it is made where it is missing [default: {OUT}]")))
        .arg(value_arg("only", "LIST").help(format!(
            "Parts to run, between commas: {} [default: all]. DIR/README.md, which needs them all, is then left as it is",
            names()
        )))
        .arg(
            flag_arg("quick")
                .help("Small rooms and coarse thresholds: for trying out the command, not for answering the paper"),
        )
        .arg(options::seconds_arg("Time of one run; runs that take longer are left out and reported [default: 30]"));
    let of_machine = |id| matches!(id, ParameterId::Threads);
    reference::wish_args(command).args(options::solver_args_where(of_machine))
}

fn names() -> String {
    Part::ALL.map(Part::name).join(", ")
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> anyhow::Result<()> {
    let parts = parts(matches)?;
    let mut effort = if matches.get_flag("quick") { Effort::quick() } else { Effort::full() };
    effort.cap = options::seconds_of_a_run(matches)?.unwrap_or(effort.cap);
    let wish = reference::wish(matches, None)?;
    let pool = pool(options::solver_params(matches)?.threads)?;
    let folder = path(matches, "out").unwrap_or_else(|| PathBuf::from(OUT));
    make_folder(&folder)?;
    // Before the long work, so that a folder that cannot be written to is reported soon.
    OutputFile::new(&folder.join("README.md"), &[])?;

    let begun = Instant::now();
    let mut tell = |line: &str| eprintln!("{:>7}  {line}", seconds(begun.elapsed().as_secs_f64()));
    let mut reports = Vec::new();
    let mut lab = Lab::new(effort.clone(), wish, &mut tell);
    for &part in &parts {
        let Some(report) = report(&mut lab, part, &folder, &pool)? else { continue };
        save(&folder, &format!("{}.md", part.name()), &report.markdown())?;
        if !report.records.is_empty() {
            save(&folder, &format!("{}.csv", part.name()), &report.csv())?;
        }
        say(&format!("{}\n", report.text()))?;
        reports.push(report);
    }
    let took = begun.elapsed().as_secs_f64();
    say(&verdicts(&reports))?;
    if parts.len() == Part::ALL.len() {
        save(&folder, "README.md", &readme(&reports, &effort, pool.current_num_threads(), took))?;
    }
    eprintln!("{}: written in {}", folder.display(), seconds(took));
    Ok(())
}

fn parts(matches: &ArgMatches) -> anyhow::Result<Vec<Part>> {
    let Some(list) = matches.get_one::<String>("only") else { return Ok(Part::ALL.to_vec()) };
    let known = |name: &str| {
        Part::from_name(name).ok_or_else(|| anyhow!("--only does not know `{name}`; the parts are {}", names()))
    };
    let wanted = list.split(',').map(|name| known(name.trim())).collect::<anyhow::Result<Vec<_>>>()?;
    Ok(Part::ALL.into_iter().filter(|part| wanted.contains(part)).collect())
}

/// One part; nothing where it is the figures and there is nothing to draw them with.
fn report(lab: &mut Lab<'_>, part: Part, folder: &Path, pool: &ThreadPool) -> anyhow::Result<Option<Report>> {
    if part != Part::Figures {
        return Ok(pool.install(|| part.run(lab)));
    }
    figures(lab, folder, pool)
}

#[cfg(feature = "gui")]
fn figures(lab: &mut Lab<'_>, folder: &Path, pool: &ThreadPool) -> anyhow::Result<Option<Report>> {
    use selflink::measure::tables::figures;
    use selflink::render::{Offscreen, RenderError};
    let drawn = match Offscreen::new() {
        Ok(mut offscreen) => {
            let solved = pool.install(|| figures::solve(lab));
            figures::draw(solved, &mut offscreen, lab.effort.picture)?
        }
        Err(error @ (RenderError::NoAdapter | RenderError::NoDevice { .. })) => {
            eprintln!("warning: the figures are left out: {error}.");
            return Ok(None);
        }
        Err(error) => return Err(error.into()),
    };
    let (report, pictures) = drawn;
    for picture in pictures {
        OutputFile::new(&folder.join(&picture.name), &[])?.write_png(&picture.pixels)?;
    }
    Ok(Some(report))
}

#[cfg(not(feature = "gui"))]
fn figures(_: &mut Lab<'_>, _: &Path, _: &ThreadPool) -> anyhow::Result<Option<Report>> {
    eprintln!("warning: the figures are left out: this program was built without the feature gui.");
    Ok(None)
}

fn save(folder: &Path, name: &str, text: &str) -> anyhow::Result<()> {
    OutputFile::new(&folder.join(name), &[])?.write_text(text)
}

/// The claims for a terminal.
fn verdicts(reports: &[Report]) -> String {
    let line = |claim: &Claim| {
        format!("{:<11}  {}: {}\n             {}\n", claim.verdict.to_string(), claim.place, claim.says, claim.found)
    };
    reports.iter().flat_map(|report| &report.claims).map(line).collect()
}

/// The page that has every claim and leads to the tables.
fn readme(reports: &[Report], effort: &Effort, threads: usize, took: f64) -> String {
    let claims = || reports.iter().flat_map(|report| &report.claims);
    let number = |verdict: Verdict| claims().filter(|claim| claim.verdict == verdict).count();
    let mut text = String::from("# The paper, run again\n\n");
    if effort.quick {
        text += "Made with `--quick`: small rooms stand in, so nothing here answers the paper.\n\n";
    }
    // A String takes any text.
    let _ = write!(
        text,
        "*Isotropic Clustering for Hierarchical Radiosity – Implementation and Experiences* by Stamminger, Nitsch, Slusallek and Seidel, claim by claim. Everything here is written by\n\n\
         ```sh\nselflink tables --out docs/paper\n```\n\n\
         in {} on {threads} threads; `--only PART` runs a part of it. A verdict follows from the numbers by the rule beside it: {} confirmed, {} better, {} not so here. Our seminar room and office have the \
         paper's numbers of polygons, but they are drawn by us: shapes, materials and light are other ones, and the machine is 30 years younger, so ratios compare and seconds do not.\n\n",
        seconds(took),
        number(Verdict::Confirmed),
        number(Verdict::Better),
        number(Verdict::NotSoHere)
    );
    text += "## Tables and pictures\n\n";
    for report in reports {
        let _ = writeln!(text, "- [{}]({}.md)", report.title, report.part.name());
    }
    if !effort.quick {
        text += "- [What was tried, and what became of it](tried.md), written by hand\n";
    }
    text + "\n## Claims\n\n" + &claims_markdown(reports)
}
