//! `selflink selftest`: every known way to fail, tried on this machine, a line for each.

use std::process::ExitCode;

use anyhow::bail;
use clap::{ArgMatches, Command};
use selflink::measure::stability::{Check, Finding, Relation, Row, Verdict, rows};
use serde::Serialize;

use super::options::{path, path_arg, value_arg};
use super::output::{OutputFile, json, say};

/// Exit code where a row fails beyond its known limit.
const FAILED: u8 = 1;

/// The command's arguments.
pub fn command() -> Command {
    Command::new("selftest")
        // Its name until 0.1.
        .alias("doctor")
        .about("Try the places where methods of this kind fail, each against a known truth, and print a line for each")
        .arg(
            value_arg("only", "NAMES")
                .value_delimiter(',')
                .help("Run these rows only, by name or number, separated by commas"),
        )
        .arg(path_arg("json", "FILE").help("Write every check of every row there"))
}

/// Content of the file that `--json` names.
#[derive(Serialize)]
struct Report<'a> {
    version: &'static str,
    passed: usize,
    known_limits: usize,
    failed: usize,
    seconds: f64,
    rows: &'a [Finding],
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> anyhow::Result<ExitCode> {
    let wanted: Vec<&String> = matches.get_many("only").into_iter().flatten().collect();
    let all = rows();
    let names = |row: &Row, name: &str| row.name == name || row.number.to_string() == name;
    if let Some(unknown) = wanted.iter().find(|name| !all.iter().any(|row| names(row, name))) {
        let known: Vec<&str> = all.iter().map(|row| row.name).collect();
        bail!("--only {unknown}: there is no such row; choose from {}", known.join(", "));
    }
    let file = path(matches, "json").map(|path| OutputFile::new(&path, &[])).transpose()?;
    let mut findings = Vec::new();
    for row in all.iter().filter(|row| wanted.is_empty() || wanted.iter().any(|name| names(row, name))) {
        let finding = row.run()?;
        say(&line(&finding))?;
        findings.push(finding);
    }
    let count = |verdict: Verdict| findings.iter().filter(|finding| finding.verdict == verdict).count();
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        passed: count(Verdict::Pass),
        known_limits: count(Verdict::KnownLimit),
        failed: count(Verdict::Fail),
        seconds: findings.iter().map(|finding| finding.seconds).sum(),
        rows: &findings,
    };
    say(&summary(&report))?;
    if let Some(file) = file {
        file.write_text(&json(&report)?)?;
    }
    Ok(if report.failed > 0 { ExitCode::from(FAILED) } else { ExitCode::SUCCESS })
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "pass",
        Verdict::KnownLimit => "known limit",
        Verdict::Fail => "FAIL",
    }
}

/// A row: its verdict and name, what was asked, and the check that is farthest off.
fn line(finding: &Finding) -> String {
    let mut text =
        format!("{:2} {:<19} {:<11}  {}", finding.number, finding.name, word(finding.verdict), finding.asked);
    if let Some(worst) = finding.worst() {
        text += &format!("\n{:36}{}", "", described(worst, finding.checks.len()));
    }
    if let (Verdict::KnownLimit, Some(limit)) = (finding.verdict, finding.limit) {
        text += &format!("\n{:36}why: {limit}", "");
    }
    text + "\n"
}

/// The truth and what was found.
fn described(check: &Check, checks: usize) -> String {
    let relation = match check.relation {
        Relation::Near => "truth",
        Relation::AtMost => "at most",
    };
    let share = 100.0 * (check.ours / check.truth - 1.0);
    let share = if check.truth != 0.0 && share.is_finite() { format!(" ({share:+.2} %)") } else { String::new() };
    format!("worst of {checks}: {relation} {}, ours {}{share}: {}", number(check.truth), number(check.ours), check.what)
}

/// Four digits that matter.
fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e4).contains(&size) => {
            let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
            format!("{value:.decimals$}")
        }
        _ => format!("{value:.3e}"),
    }
}

fn summary(report: &Report) -> String {
    let Report { passed, known_limits, failed, seconds, .. } = report;
    let rows = passed + known_limits + failed;
    let advice = if *failed > 0 {
        "\nA row that fails here and nowhere else tells of this machine's arithmetic: please report it with --json."
    } else {
        ""
    };
    format!(
        "{rows} rows in {seconds:.0} s: {passed} pass, {known_limits} known limits (docs/limits.md), {failed} fail.{advice}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        let texts = [0.0, 0.199_824, 16.666_67, 12_345.6, 2.0e-6, -0.5].map(number);
        assert_eq!(texts, ["0", "0.1998", "16.67", "1.235e4", "2.000e-6", "-0.5000"]);
    }
}
