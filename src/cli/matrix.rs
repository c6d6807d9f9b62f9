//! `selflink matrix`: the links of a solution as blocks, receivers by sources.

use anyhow::{anyhow, bail};
use clap::{Arg, ArgMatches, Command, value_parser};
use selflink::base::cancel::CancelToken;
use selflink::hierarchy::Room;
use selflink::read::matrix::{Colouring, Drawing, draw};
use selflink::read::names::Names;
use selflink::solve::{Snapshot, Solver, Step};

use super::job::{Job, Order};
use super::options::{self, path, path_arg, value_arg};
use super::output::{OutputFile, say};

/// Names of what elements get room for.
const ROOMS: [(&str, Room); 3] = [("area", Room::Area), ("polygons", Room::Polygons), ("leaves", Room::Leaves)];
/// Pixels along the sides of the square that can be asked for.
const SIZES: std::ops::RangeInclusive<i64> = 200..=8000;

/// The command's arguments.
pub fn command() -> Command {
    let about =
        "Solve a scene and draw its link matrix to a PNG file: rows receive, columns send, each link is a block";
    options::solving(Command::new("matrix").about(about))
        .arg(path_arg("out", "FILE.png").required(true).help("The picture"))
        .arg(
            value_arg("colour", "COLOUR")
                .default_value("power")
                .value_parser(Colouring::ALL.map(Colouring::name))
                .help("Quantity that colours stand for: power for each area of both ends, visibility V, level of refinement, or rays"),
        )
        .arg(
            Arg::new("row-height")
                .long("row-height")
                .alias("room")
                .value_name("MEASURE")
                .default_value("area")
                .value_parser(ROOMS.map(|(name, _)| name))
                .help("Measure by which rows and columns are as large as they are: area, polygons or leaves of their elements"),
        )
        .arg(
            value_arg("size", "PIXELS")
                .default_value("1000")
                .value_parser(value_parser!(u32).range(SIZES))
                .help("Pixels along the sides of the square"),
        )
        .arg(
            value_arg("waves", "N")
                .value_parser(value_parser!(u32))
                .allow_hyphen_values(true)
                .help("Stop after so many waves of refinement; 0 shows the root's self-link [default: solve to the end]"),
        )
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> anyhow::Result<()> {
    let order = Order::from_matches(matches)?;
    let path = path(matches, "out").unwrap_or_default();
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        bail!("{}: pictures are written as PNG; choose a name that ends in .png", path.display());
    }
    let file = OutputFile::new(&path, &order.inputs())?;
    let text = |name: &str| matches.get_one::<String>(name).map(String::as_str);
    let colouring = Colouring::ALL.into_iter().find(|colouring| text("colour") == Some(colouring.name()));
    let room = ROOMS.into_iter().find(|(name, _)| text("row-height") == Some(name));
    let pixels = matches.get_one::<u32>("size").copied().unwrap_or(1000);

    let job = order.load()?;
    let snapshot = match matches.get_one::<u32>("waves") {
        Some(&waves) => after_waves(&job, waves)?,
        None => {
            let mut solution = job.solve()?;
            solution.solver.show_solution_view(true);
            solution.solver.snapshot()
        }
    };
    let solution_view = snapshot.solution_view.ok_or_else(|| anyhow!("the solution tells nothing of its links"))?;
    let names = Names::new(snapshot.generation, solution_view.hierarchy(), &job.scene);
    let (colouring, room) = (colouring.unwrap_or_default(), room.map(|(_, room)| room).unwrap_or_default());
    let drawing = Drawing { solution_view: &solution_view, names: &names, scene: &job.scene, room, colouring, pixels };
    let picture = draw(drawing)?;
    file.write_png(&picture)?;
    let [width, height] = [picture.width(), picture.height()];
    say(&format!("{}: {width} × {height} pixels\n", file.path().display()))
}

/// The state after so many waves, or when nothing is left to do.
fn after_waves(job: &Job, waves: u32) -> anyhow::Result<Snapshot> {
    job.pool.install(|| {
        let mut solver = Solver::new(job.scene.clone(), job.occluders.clone(), job.settings.solver, 1)?;
        solver.show_solution_view(true);
        let never = CancelToken::new();
        let mut left = waves;
        while left > 0 {
            match solver.step(&never) {
                Step::Refined { wave_ended: true } => left -= 1,
                Step::Finished | Step::Interrupted => break,
                Step::Refined { .. } | Step::Gathered | Step::Reconstructed { .. } => {}
            }
        }
        Ok(solver.snapshot())
    })
}
