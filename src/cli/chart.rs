//! `selflink chart`: error with its standard error over time, links and rays for many settings, as
//! tables and pictures.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use anyhow::bail;
use clap::{ArgMatches, Command};
use selflink::base::cancel::CancelToken;
use selflink::export::file_name;
use selflink::measure::chart::{
    Against, Chart, Drawing, Shown, Sweep, csv, draw_png, draw_svg, error_table, target_table, usual_epsilons,
    usual_settings,
};
use selflink::measure::reference::Wish;
use selflink::solve::ParameterId;

use super::job::{Job, Order};
use super::options::{self, path, path_arg, value_arg};
use super::output::{OutputFile, json, say};
use super::progress;
use super::reference;

/// Time of one run when nothing is said, s.
const SECONDS: f64 = 20.0;

/// The command's arguments.
pub fn command() -> Command {
    let command = Command::new("chart")
        .about(
            "Chart the solver's error over time, links and rays, for every clustering, push and cluster model, beside a path tracer's",
        )
        .arg(options::scene_arg().num_args(1..).required(true))
        .arg(
            path_arg("out", "DIR")
                .required(true)
                .help("Folder for SCENE.csv, SCENE.json and SCENE-….svg and .png; it is made where it is missing"),
        )
        .arg(
            value_arg("epsilons", "LIST")
                .help("Thresholds as shares of Φ, such as 1e-2,1e-3 [default: seven from 1e-2 to 1e-5]"),
        )
        .arg(value_arg("settings", "LIST").help(
            "Settings to run: names, or the first words of names, between commas, such as adaptive,none [default: all]",
        ))
        .arg(options::seconds_arg(
            "Time of one run; thresholds finer than one that took longer are left out [default: 20]",
        ));
    let swept = [
        ParameterId::Error,
        ParameterId::Epsilon,
        ParameterId::EpsilonWatts,
        ParameterId::Reconstruct,
        ParameterId::Clustering,
        ParameterId::ClusterModel,
        ParameterId::Push,
    ];
    let command = reference::wish_args(command).args(options::scene_args());
    #[cfg(feature = "gui")]
    let command = super::picture_chart::with_args(command);
    command.args(options::solver_args_where(move |id| !swept.contains(&id))).arg(options::former_arg())
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> anyhow::Result<()> {
    #[cfg(feature = "gui")]
    if matches.get_flag("picture") {
        return super::picture_chart::run(matches);
    }
    let orders = Order::of_scenes(matches)?;
    let limit = limit(matches)?;
    let epsilons = epsilons(matches)?;
    let wish = reference::wish(matches, None)?;
    let wanted: Option<Vec<&str>> =
        matches.get_one::<String>("settings").map(|list| list.split(',').map(str::trim).collect());
    if let Some(words) = &wanted {
        let known = usual_settings(selflink::solve::SolverParams::default());
        if let Some(word) = words.iter().find(|word| !known.iter().any(|setting| is_called(&setting.name, word))) {
            let names = known.iter().map(|setting| setting.name.as_str()).collect::<Vec<_>>().join("; ");
            bail!("--settings does not know `{word}`; the settings are: {names}");
        }
    }
    let folder = path(matches, "out").unwrap_or_default();
    super::output::make_folder(&folder)?;
    for order in orders {
        let job = order.load()?;
        let settings = usual_settings(job.settings.solver).into_iter().filter(|setting| {
            wanted.as_ref().is_none_or(|words| words.iter().any(|word| is_called(&setting.name, word)))
        });
        let sweep = Sweep { settings: settings.collect(), epsilons: epsilons.clone(), limit };
        let chart = chart(&job, &wish, &sweep)?;
        write(&chart, &folder)?;
        let named = format!("{}\n\n{}\n{}\n", chart.scene, error_table(&chart), target_table(&chart));
        say(&named)?;
        for skipped in &chart.skipped {
            eprintln!("note: {}, ε = {:.0e} Φ left out: {}.", skipped.setting, skipped.epsilon_relative, skipped.why);
        }
    }
    Ok(())
}

/// The time of one run.
pub fn limit(matches: &ArgMatches) -> anyhow::Result<Duration> {
    Ok(options::seconds_of_a_run(matches)?.unwrap_or(Duration::from_secs_f64(SECONDS)))
}

/// Whether a setting has this name, or one that begins with this word.
fn is_called(name: &str, word: &str) -> bool {
    name == word || name.split(',').next() == Some(word)
}

fn epsilons(matches: &ArgMatches) -> anyhow::Result<Vec<f64>> {
    let must_be = "numbers greater than 0 between commas, such as 1e-2,1e-3";
    let given = options::number_list(matches, "epsilons", must_be, |number| number > 0.0 && number.is_finite())?;
    let mut epsilons = given.unwrap_or_else(usual_epsilons);
    epsilons.sort_by(|a, b| b.total_cmp(a));
    Ok(epsilons)
}

fn chart(job: &Job, wish: &Wish, sweep: &Sweep) -> anyhow::Result<Chart> {
    let outcome = reference::make(job, wish)?;
    eprint!("reference  {}", reference::summary(&job.scene.name, &outcome));
    let reference = Arc::new(outcome.reference);
    let bar = progress::spinner();
    let report = |setting: &str, epsilon: f64| {
        bar.set_message(format!("{setting}, ε = {epsilon:.0e} Φ"));
        bar.tick();
    };
    let cancel = CancelToken::new();
    Ok(job.pool.install(|| sweep.run(&job.scene, &job.occluders, reference, &cancel, report)))
}

fn write(chart: &Chart, folder: &Path) -> anyhow::Result<()> {
    let files = ChartFiles { folder, scene: &chart.scene };
    files.text(".csv", &csv(chart))?;
    files.text(".json", &json(chart)?)?;
    let pictures = [
        (Shown::Local, Against::Seconds, "seconds"),
        (Shown::Local, Against::Links, "links"),
        (Shown::Local, Against::Rays, "rays"),
        (Shown::Rms, Against::Seconds, "rms"),
    ];
    for (shown, against, name) in pictures {
        let drawing = Drawing { chart, against, shown };
        files.text(&format!("-{name}.svg"), &draw_svg(&drawing)?)?;
        files.picture(&format!("-{name}.png"), &draw_png(&drawing)?)?;
    }
    Ok(())
}

/// The files of a scene's chart.
pub struct ChartFiles<'a> {
    /// Where they lie.
    pub folder: &'a Path,
    /// The scene's name.
    pub scene: &'a str,
}

impl ChartFiles<'_> {
    fn file(&self, ending: &str) -> anyhow::Result<OutputFile> {
        OutputFile::new(&self.folder.join(format!("{}{ending}", file_name(self.scene))), &[])
    }

    /// Writes the one with this ending.
    pub fn text(&self, ending: &str, text: &str) -> anyhow::Result<()> {
        self.file(ending)?.write_text(text)
    }

    /// Writes a picture of the chart as PNG.
    pub fn picture(&self, ending: &str, picture: &image::RgbImage) -> anyhow::Result<()> {
        self.file(ending)?.write_png(picture)
    }
}
