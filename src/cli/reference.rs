//! `selflink reference`: path-traced irradiance at random points, with standard errors, as a CSV
//! file.

use std::io::Write as _;
use std::time::Duration;

use anyhow::bail;
use clap::{ArgMatches, Command};
use selflink::base::cancel::CancelToken;
use selflink::base::format::{count, seconds, things};
use selflink::measure::reference::{
    Cache, Outcome, Reference, ReferenceRun, SurfacePoint, Target, Wish, compute, random_points,
};
use selflink::scene::Scene;
use selflink::solve::ParameterId;

use super::job::{Job, Order};
use super::options::{self, flag_arg, path, path_arg, value_arg};
use super::output::{OutputFile, say};
use super::progress;

/// Columns of the table; E and its standard error in W/m².
const COLUMNS: &str = "x,y,z,nx,ny,nz,weight,polygon,rho_r,rho_g,rho_b,E_r,E_g,E_b,error_r,error_g,error_b";
/// Points when nothing is said.
const POINTS: u32 = 1000;
/// More points than anybody waits for.
const MOST_POINTS: u32 = 10_000_000;

/// The command's arguments.
pub fn command() -> Command {
    let command = Command::new("reference")
        .about(
            "Path-trace irradiance E at random points on surfaces, with standard errors, until the noise is low enough",
        )
        .arg(options::scene_arg().required(true))
        .arg(path_arg("out", "FILE.csv").help(format!("Write the points: {COLUMNS}")))
        .arg(options::seconds_arg("Stop after so many seconds with the reference so far"));
    let of_scene = |id| matches!(id, ParameterId::Sides | ParameterId::Threads | ParameterId::Seed);
    wish_args(command).args(options::scene_args()).args(options::solver_args_where(of_scene))
}

/// The arguments of [`Wish`].
pub fn wish_args(command: Command) -> Command {
    command
        .arg(value_arg("points", "N").value_parser(options::whole::<u32>).allow_hyphen_values(true).help(format!(
            "Random points of the reference, half of them by area and half by A·B², lamps left out [default: {POINTS}]"
        )))
        .arg(
            value_arg("noise", "SHARE")
                .value_parser(options::number)
                .allow_hyphen_values(true)
                .help("Noise that suffices: RMS over the area, relative to the radiosity's [default: 0.01]"),
        )
        .arg(
            path_arg("cache", "DIR").help(
                "Folder that keeps references for the next time [default: selflink in $XDG_CACHE_HOME or ~/.cache]",
            ),
        )
        .arg(flag_arg("no-cache").conflicts_with("cache").help("Neither read nor keep references"))
}

/// The wish that the arguments state, checked.
pub fn wish(matches: &ArgMatches, limit: Option<Duration>) -> anyhow::Result<Wish> {
    let points = matches.get_one::<u32>("points").copied().unwrap_or(POINTS);
    if !(2..=MOST_POINTS).contains(&points) {
        bail!("--points must lie between 2 and {} (it is {points})", count(MOST_POINTS));
    }
    let noise = matches.get_one::<f64>("noise").copied().unwrap_or(0.01);
    if !(noise > 0.0 && noise < 1.0) {
        bail!("--noise must lie between 0 and 1, such as 0.01 for 1 % (it is {noise})");
    }
    let cache = match (path(matches, "cache"), matches.get_flag("no-cache")) {
        (Some(folder), _) => Some(Cache::new(&folder)),
        (None, true) => None,
        (None, false) => Cache::of_user(),
    };
    Ok(Wish { points: points as usize, target: Target { noise, limit }, cache })
}

/// Makes the reference of a job's scene; shows progress on a terminal.
pub fn make(job: &Job, wish: &Wish) -> anyhow::Result<Outcome> {
    let seed = job.settings.solver.seed;
    let points = random_points(&job.scene, wish.points, seed);
    if points.is_empty() {
        bail!("every surface of {} emits: there are no points for a reference", job.scene.name);
    }
    let begun = std::time::Instant::now();
    let outcome = job.pool.install(|| {
        let mut run = ReferenceRun::new(&job.scene, points.into(), seed);
        let bar = progress::spinner();
        compute(&mut run, wish.cache.as_ref(), wish.target, &CancelToken::new(), |run, noise| {
            bar.set_message(format!("pass {}, noise {:.2} %", run.passes(), 100.0 * noise));
        })
    });
    if let Some(error) = &outcome.cache_error {
        eprintln!(
            "warning: the reference cannot be kept for the next time ({error}); --cache DIR names another folder."
        );
    }
    Ok(Outcome { seconds: begun.elapsed().as_secs_f64(), ..outcome })
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> anyhow::Result<()> {
    let order = Order::from_matches(matches)?;
    let wish = wish(matches, order.limit)?;
    let file = path(matches, "out").map(|path| OutputFile::new(&path, &order.inputs())).transpose()?;
    let job = order.load()?;
    let outcome = make(&job, &wish)?;
    let reference = &outcome.reference;
    if let Some(file) = &file {
        file.write(|writer| {
            writeln!(writer, "{COLUMNS}")?;
            (0..reference.points.len()).try_for_each(|index| writeln!(writer, "{}", row(&job.scene, reference, index)))
        })?;
    }
    if !outcome.reached {
        eprintln!("warning: the time was over before the noise was down to {} %.", 100.0 * wish.target.noise);
    }
    say(&summary(&job.scene.name, &outcome))
}

/// One line for people.
pub fn summary(scene: &str, outcome: &Outcome) -> String {
    let reference = &outcome.reference;
    let cached = match outcome.cached_passes {
        0 => String::new(),
        passes if passes == outcome.passes => ", all from the cache".to_owned(),
        passes => format!(", {} % from the cache", 100 * passes / outcome.passes),
    };
    format!(
        "{scene}: {}, {} paths{cached}, noise {:.2} %, {}\n",
        things(reference.points.len(), "point", "points"),
        count(reference.paths),
        100.0 * outcome.noise,
        seconds(outcome.seconds),
    )
}

fn row(scene: &Scene, reference: &Reference, index: usize) -> String {
    let SurfacePoint { position, normal, polygon, reflectance, weight } = reference.points[index];
    let three = |[a, b, c]: [f64; 3]| format!("{a},{b},{c}");
    let single = |[a, b, c]: [f32; 3]| format!("{a},{b},{c}");
    let (irradiance, error) = (reference.irradiance[index].to_array(), reference.standard_error[index].to_array());
    let position = three(scene.to_file(position).to_array());
    let [normal, reflectance] = [normal, reflectance].map(|vector| single(vector.to_array()));
    format!("{position},{normal},{weight},{polygon},{reflectance},{},{}", three(irradiance), three(error))
}
