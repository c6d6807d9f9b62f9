//! `selflink accuracy`: every closed form beside what the reference and the solver find, as a
//! table.

use clap::{ArgMatches, Command};
use selflink::measure::accuracy::cases::{self, Case, Reading};
use selflink::measure::accuracy::{Measured, by_reference, by_solver};
use selflink::measure::records::{self, Table};
use selflink::measure::stability::measure::MODES;
use selflink::solve::{SolverParams, name_of};

use super::options::{path, path_arg};
use super::output::{OutputFile, make_folder, say};

/// Thresholds of the table, as shares of Φ.
const EPSILONS: [f64; 2] = [1e-3, 1e-4];
/// Passes of the reference at a point: 2¹⁴ paths.
const PASSES: u32 = 256;
const SEED: u64 = 1;

/// The command's arguments.
pub fn command() -> Command {
    Command::new("accuracy")
        .about("Compare the reference and the solver, in every clustering, with closed forms: rectangles, furnaces, CIE 171")
        .arg(path_arg("out", "DIR").help("Write closed-forms.md and closed-forms.csv there; it is made where it is missing"))
}

/// Values of the reference and the solver for one reading.
struct Row {
    case: &'static str,
    source: &'static str,
    reading: Reading,
    reference: Measured,
    /// By ε, then by mode.
    solver: Vec<f64>,
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> anyhow::Result<()> {
    let folder = path(matches, "out");
    if let Some(folder) = &folder {
        make_folder(folder)?;
    }
    let file = |name: &str| folder.as_ref().map(|folder| OutputFile::new(&folder.join(name), &[])).transpose();
    let (markdown_file, csv_file) = (file("closed-forms.md")?, file("closed-forms.csv")?);
    let mut rows = Vec::new();
    for case in cases::all() {
        rows.extend(measure(case)?);
    }
    let table = markdown(&rows);
    if let Some(file) = markdown_file {
        file.write_text(&format!("{INTRODUCTION}{table}"))?;
    }
    if let Some(file) = csv_file {
        file.write_text(&csv(&rows))?;
    }
    say(&table)
}

fn measure(case: Case) -> anyhow::Result<Vec<Row>> {
    let reference = by_reference(&case, PASSES, SEED);
    let mut solver = vec![Vec::new(); case.readings.len()];
    for epsilon in EPSILONS {
        for clustering in MODES {
            let params = SolverParams { clustering, ..SolverParams::with_epsilon(epsilon) };
            for (values, value) in solver.iter_mut().zip(by_solver(&case, params)?) {
                values.push(value);
            }
        }
    }
    let found = case.readings.into_iter().zip(reference).zip(solver);
    let row = |((reading, reference), solver)| Row { case: case.name, source: case.source, reading, reference, solver };
    Ok(found.map(row).collect())
}

const INTRODUCTION: &str = "# Closed forms\n\n\
    Written by `selflink accuracy --out docs/accuracy`. Truth, what the path-traced reference finds (with one standard error), and what the solver finds in each\n\
    clustering mode at two thresholds. A reading is a form factor or an irradiance per exitance of 1 where it has no unit; points are read as displayed\n\
    (interpolated), `F`, walls and other areas are means. CIE 171:2006 5.2 stands in for its point lamp with a Lambertian square of 1 cm. The standard's own\n\
    table for 5.7 is wrong; its truth here is the part of the wall that a point sees.\n\n";

/// The columns of the solver, by ε, then by mode.
fn columns() -> impl Iterator<Item = (String, f64)> {
    EPSILONS.into_iter().flat_map(|epsilon| MODES.map(|mode| (name_of(&mode), epsilon)))
}

fn markdown(rows: &[Row]) -> String {
    let mut last = "";
    let mut cells = |row: &Row| {
        let truth = row.reading.truth;
        // As many decimals as show a hundredth of a per cent.
        let decimals = if truth > 0.0 { (3 - truth.log10().floor() as i32).clamp(1, 6) as usize } else { 3 };
        let case = if row.case == last { "" } else { row.case };
        last = row.case;
        let unit = if row.reading.unit.is_empty() { String::new() } else { format!(" {}", row.reading.unit) };
        let (value, error) = (row.reference.value, row.reference.standard_error);
        let mut cells = vec![
            case.to_owned(),
            row.reading.label.clone(),
            format!("{truth:.decimals$}{unit}"),
            format!("{value:.decimals$} ± {error:.decimals$}"),
        ];
        cells.extend(row.solver.iter().map(|value| format!("{value:.decimals$}{}", deviation(*value, truth))));
        cells
    };
    let rows = rows.iter().map(&mut cells).collect();
    let head = ["case", "reading", "truth", "reference"].map(String::from).into_iter();
    let head = head.chain(columns().map(|(mode, epsilon)| format!("{mode}, {epsilon:e}"))).collect();
    Table { caption: String::new(), head, rows }.markdown_with(2)
}

/// How far a value is off, where that can be said in per cent.
fn deviation(value: f64, truth: f64) -> String {
    if truth > 0.0 { format!(" ({:+.1} %)", 100.0 * (value / truth - 1.0)) } else { String::new() }
}

fn csv(rows: &[Row]) -> String {
    let names: Vec<String> = columns().map(|(mode, epsilon)| format!("{mode}_{epsilon:e}")).collect();
    let record = |row: &Row| {
        let Reading { label, unit, truth, .. } = &row.reading;
        let Measured { value, standard_error } = row.reference;
        let mut record = vec![
            ("case", row.case.to_owned()),
            ("reading", label.clone()),
            ("unit", unit.to_string()),
            ("source", row.source.to_owned()),
            ("truth", truth.to_string()),
            ("reference", value.to_string()),
            ("standard_error", standard_error.to_string()),
        ];
        record.extend(names.iter().map(String::as_str).zip(row.solver.iter().map(f64::to_string)));
        record
    };
    records::csv(&rows.iter().map(record).collect::<Vec<_>>())
}
