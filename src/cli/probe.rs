//! `selflink probe`: irradiance and radiosity at points of a CSV file; a work plane is measured
//! next door.

use std::fs;
use std::io::Write as _;
use std::path::Path;

use anyhow::{anyhow, bail};
use clap::{ArgMatches, Command};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use selflink::base::format::things;
use selflink::gather::NOISE;
use selflink::read::probe::{Probe, Sample};
use selflink::solve::USUAL_ERROR;

use super::job::{Job, Order};
use super::options::{self, path, path_arg, value_arg};
use super::output::{OutputFile, say};
use super::work_plane;

/// Columns read.
const COLUMNS: &str = "x,y,z,nx,ny,nz";
/// Columns added, W/m².
const ADDED: &str = "E_r,E_g,E_b,B_r,B_g,B_b,se_r,se_g,se_b";

/// The command's arguments.
pub fn command() -> Command {
    options::solving(
        Command::new("probe")
            .about("Solve a scene; write irradiance E and radiosity B (W/m²) at given points, or E of a work plane"),
    )
    .arg(
        path_arg("points", "FILE.csv")
            .required_unless_present("work-plane")
            .conflicts_with("work-plane")
            .help(format!("Points on surfaces, a row each: {COLUMNS}; a header line may come first, and further columns (as `selflink reference` writes them) are passed over")),
    )
    .arg(
        path_arg("out", "FILE.csv")
            .required(true)
            .help(format!(
                "The points with {ADDED}: irradiance, radiosity and the standard error of E. They stay empty where a point lies on no surface, the error where light is interpolated (--epsilon without --reconstruct final-gather)"
            )),
    )
    .arg(
        value_arg("se", "SHARE")
            .value_parser(parse_error)
            .help("Standard error of each E, as a share of the light there (0.02 or 2%) [default: a third of the target error]"),
    )
    .args(work_plane::args().map(|arg| arg.help_heading("Work plane")))
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> anyhow::Result<()> {
    let order = Order::from_matches(matches)?;
    if matches.contains_id("work-plane") {
        return work_plane::run(matches, order);
    }
    let points_path = path(matches, "points").unwrap_or_default();
    let rows = read_rows(&points_path)?;
    let inputs = [order.inputs(), vec![&*points_path]].concat();
    let file = OutputFile::new(&path(matches, "out").unwrap_or_default(), &inputs)?;

    let job = order.load()?;
    let solution = job.solve()?;
    let snapshot = &solution.snapshot;
    let probe = Probe::new(&snapshot.mesh, &snapshot.vertex_irradiance, &snapshot.vertex_radiosity);
    let error = standard_error(matches, &job);
    let read = |row: &Row| {
        let point = job.scene.from_file(row.point);
        let Some(field) = &snapshot.field else { return Some((probe.at(point, row.normal)?, None)) };
        let (position, polygon) = probe.place(point, row.normal)?;
        let read = field.read(polygon, position, error);
        let surface = field.surface(polygon);
        let radiosity = surface.emission + surface.reflectance * read.mean;
        Some((Sample { irradiance: read.mean, radiosity }, Some(read.standard_error)))
    };
    let samples: Vec<Option<(Sample, Option<Vec3>)>> = job.pool.install(|| rows.par_iter().map(read).collect());
    file.write(|writer| {
        writeln!(writer, "{COLUMNS},{ADDED}")?;
        for (row, sample) in rows.iter().zip(&samples) {
            write!(writer, "{}", row.text)?;
            match sample {
                Some((Sample { irradiance: e, radiosity: b }, _)) => {
                    write!(writer, ",{},{},{},{},{},{}", e.x, e.y, e.z, b.x, b.y, b.z)?;
                }
                None => write!(writer, ",,,,,,")?,
            }
            match sample {
                Some((_, Some(error))) => writeln!(writer, ",{},{},{}", error.x, error.y, error.z)?,
                _ => writeln!(writer, ",,,")?,
            }
        }
        Ok(())
    })?;
    let missed = samples.iter().filter(|sample| sample.is_none()).count();
    if missed > 0 {
        let rows = things(missed, "row lies", "rows lie");
        eprintln!("warning: {rows} on no surface that faces the given normal; E and B are empty there.");
    }
    say(&format!("{}: {}\n", file.path().display(), things(rows.len(), "point", "points")))
}

/// The standard error of a reading, as a share of the light there.
pub fn standard_error(matches: &ArgMatches, job: &Job) -> f32 {
    let asked = matches.get_one::<f64>("se").copied();
    asked.unwrap_or_else(|| NOISE * job.settings.solver.error.unwrap_or(USUAL_ERROR)) as f32
}

/// A standard error: a share, or a percentage.
fn parse_error(text: &str) -> Result<f64, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    match number.trim().parse::<f64>() {
        Ok(share) if (1e-4..=1.0).contains(&(unit * share)) => Ok(unit * share),
        _ => Err("a standard error must be a share from 0.0001 to 1, or a percentage such as 2%".into()),
    }
}

/// A point to be probed.
#[derive(Debug, PartialEq)]
struct Row {
    /// The six columns as they were read.
    text: String,
    /// In the coordinates of the scene's file.
    point: DVec3,
    normal: Vec3,
}

fn read_rows(path: &Path) -> anyhow::Result<Vec<Row>> {
    let text = fs::read_to_string(path)
        .map_err(|error| anyhow!("{}: cannot be read ({error}); --points takes a CSV file", path.display()))?;
    let rows = parse_rows(&text).map_err(|problem| anyhow!("{}, {problem}", path.display()))?;
    if rows.is_empty() {
        bail!("{}: there are no points; each row must be {COLUMNS}", path.display());
    }
    Ok(rows)
}

fn parse_rows(text: &str) -> anyhow::Result<Vec<Row>> {
    let mut rows = Vec::new();
    let lines = text.trim_start_matches('\u{feff}').lines().map(str::trim).enumerate();
    let mut filled = lines.filter(|(_, line)| !line.is_empty()).peekable();
    // Words in every column of the first line are a header.
    filled.next_if(|(_, line)| line.split(',').all(|word| word.trim().parse::<f32>().is_err()));
    for (index, line) in filled {
        let number = index + 1;
        // Further columns, as a reference has them, are passed over.
        let end = line.match_indices(',').nth(5).map_or(line.len(), |(end, _)| end);
        let Some([x, y, z, nx, ny, nz]) = options::coordinates::<6>(&line[..end], ',') else {
            bail!("line {number}: a row must begin with six finite numbers, {COLUMNS}");
        };
        let normal = DVec3::new(nx, ny, nz).as_vec3();
        let Some(normal) = normal.try_normalize() else {
            bail!("line {number}: the normal nx,ny,nz has no length");
        };
        rows.push(Row { text: line[..end].to_owned(), point: DVec3::new(x, y, z), normal });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_with_and_without_a_header() {
        let rows = parse_rows("\u{feff}x, y, z, nx, ny, nz\r\n\r\n1,2,3,0,0,2\r\n").expect("good rows");
        assert_eq!(rows, [Row { text: "1,2,3,0,0,2".into(), point: DVec3::new(1.0, 2.0, 3.0), normal: Vec3::Z }]);
        assert_eq!(parse_rows("1,2,3,0,1,0").expect("a good row").len(), 1);
        // A reference's file: what stands behind the normal is passed over.
        let of_reference = parse_rows("x,y,z,nx,ny,nz,weight\n1,2,3,0,0,1,0.5,7,0.5").expect("a reference's rows");
        assert_eq!(
            of_reference,
            [Row { text: "1,2,3,0,0,1".into(), point: DVec3::new(1.0, 2.0, 3.0), normal: Vec3::Z }]
        );
    }

    #[test]
    fn bad_rows_name_their_line() {
        let cases = [
            ("1,2,3,0,0,1\n1,2,3", "line 2"),
            ("1,2,3,0,0,x", "line 1"),
            ("x,y,z,nx,ny,nz\n\n1,2,NaN,0,0,1", "line 3"),
            ("1,2,3,0,0,0", "no length"),
            ("x,y\nx,y", "line 2"),
        ];
        for (text, part) in cases {
            let said = parse_rows(text).expect_err("a bad row").to_string();
            assert!(said.contains(part), "{text}: {said}");
        }
    }
}
