//! `selflink [SCENE]`: the window; without a display the main job is done all the same, into a
//! picture and statistics.

use std::time::Instant;

use clap::parser::ValueSource;
use clap::{ArgMatches, Command};
use selflink::base::panic_report;
use selflink::export::settings::Settings;
use selflink::scene::{Source, builtin::BuiltinScene};

use super::job::Order;
use super::log;
use super::options::{self, flag_arg};
use super::output::say;
use super::report::Report;
#[cfg(feature = "gui")]
use {
    super::job::{Job, Solution},
    super::output::OutputFile,
    super::render::{self, View},
    selflink::export::file_name,
    selflink::render::Offscreen,
};

/// The program's own arguments.
pub fn command() -> Command {
    let default = BuiltinScene::default().name();
    Command::new("selflink")
        .version(env!("CARGO_PKG_VERSION"))
        .about("Lights a 3D scene by hierarchical radiosity with isotropic clusters and shows it in a window.\n\nWithout a command the window opens, without any argument as it was left; without a display the scene is solved all the same, into a picture and statistics.")
        .args_conflicts_with_subcommands(true)
        .arg(options::scene_arg().help(format!("{} [default: {default}]", options::scene_help())))
        .arg(options::settings_arg())
        .arg(flag_arg("fresh").help(
            "Start afresh, without the scene, settings and view of the last time",
        ))
        .args(options::scene_args())
        .args(options::solver_args())
        .arg(log::arg())
}

/// Runs it.
pub fn run(matches: &ArgMatches, started: Instant) -> anyhow::Result<()> {
    let scene = matches.get_one::<String>("scene").map(String::as_str);
    let mut settings = options::settings(scene, matches)?;
    let source = match scene {
        // As it was given, so that errors name it so.
        Some(scene) => options::source(scene)?,
        None => settings.source().unwrap_or(Source::Builtin(BuiltinScene::default())),
    };
    settings.scene = Some(Settings::name_of(&source));
    panic_report::note_settings(settings.to_json()?);
    let sentence = match open(&settings, !asks_for_something(matches)) {
        Ok(()) => return Ok(()),
        Err(sentence) => sentence,
    };
    eprintln!("selflink: {sentence}.");
    eprintln!("selflink: solving the scene without a window.");
    let settings_path = options::settings_path(matches);
    without_window(Order { source, settings, settings_path, limit: None }, started)
}

/// Whether the arguments say what to open or how, rather than what to log.
fn asks_for_something(matches: &ArgMatches) -> bool {
    let is_given = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
    matches.ids().any(|id| id.as_str() != log::LOG && is_given(id.as_str()))
}

#[cfg(feature = "gui")]
fn open(settings: &Settings, resumes: bool) -> Result<(), String> {
    selflink::app::run(settings.clone(), resumes).map_err(|error| error.to_string())
}

#[cfg(not(feature = "gui"))]
fn open(_settings: &Settings, _resumes: bool) -> Result<(), String> {
    Err("no window can be opened, this program was built without one".to_owned())
}

/// Solves the scene, prints the statistics and writes a picture if an adapter draws one.
fn without_window(order: Order, started: Instant) -> anyhow::Result<()> {
    let job = order.load()?;
    #[cfg(feature = "gui")]
    let file = OutputFile::new(format!("selflink-{}.png", file_name(&job.scene.name)).as_ref(), &[])?;
    let solution = job.solve()?;
    say(&Report::new(&job, &solution, started).summary())?;
    #[cfg(feature = "gui")]
    draw(&job, solution, &file)?;
    Ok(())
}

#[cfg(feature = "gui")]
fn draw(job: &Job, mut solution: Solution, file: &OutputFile) -> anyhow::Result<()> {
    let mut offscreen = match Offscreen::new() {
        Ok(offscreen) => offscreen,
        Err(error) => {
            eprintln!("selflink: no picture was drawn, {error}.");
            return Ok(());
        }
    };
    let picture = render::draw(&mut offscreen, &job.scene, &mut solution, &View::default(), None)?;
    file.write_png(&picture)?;
    say(&format!("picture    {}, drawn by {}\n", file.path().display(), offscreen.adapter()))
}
