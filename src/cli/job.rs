//! A job: a scene that is ready to be solved, and its solution.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::Builder;
use std::time::{Duration, Instant};

use anyhow::{anyhow, bail};
use clap::ArgMatches;
use rayon::ThreadPool;
use selflink::base::cancel::CancelToken;
use selflink::base::{panic_report, threads};
use selflink::export::settings::Settings;
use selflink::geometry::Occluders;
use selflink::prepare;
use selflink::scene::{Scene, Source};
use selflink::solve::{Snapshot, Solver, Stats, Step};

use super::options;
use super::progress::Progress;

/// A scene to be solved, and how; read from the arguments and checked, but nothing loaded yet.
pub struct Order {
    /// Where the scene comes from.
    pub source: Source,
    /// Scene, added light, view and parameters.
    pub settings: Settings,
    /// The file that settings were read from.
    pub settings_path: Option<PathBuf>,
    /// How long the solve may take.
    pub limit: Option<Duration>,
}

impl Order {
    /// The order that the arguments of [`options::solving`] give.
    pub fn from_matches(matches: &ArgMatches) -> anyhow::Result<Self> {
        Self::new(matches.get_one::<String>("scene").map(String::as_str), matches)
    }

    /// The orders of a command that takes several scenes.
    pub fn of_scenes(matches: &ArgMatches) -> anyhow::Result<Vec<Self>> {
        let scenes = matches.get_many::<String>("scene").unwrap_or_default();
        scenes.map(|scene| Self::new(Some(scene), matches)).collect()
    }

    fn new(scene: Option<&str>, matches: &ArgMatches) -> anyhow::Result<Self> {
        let limit = options::seconds(matches)?;
        let settings = options::settings(scene, matches)?;
        panic_report::note_settings(settings.to_json()?);
        let source = match scene {
            // As it was given, so that errors name it so.
            Some(scene) => options::source(scene)?,
            None => {
                settings.source().ok_or_else(|| anyhow!("the settings name no scene: give one before --settings"))?
            }
        };
        Ok(Self { source, settings, settings_path: options::settings_path(matches), limit })
    }

    /// The files read, which no output may overwrite.
    pub fn inputs(&self) -> Vec<&Path> {
        let scene = match &self.source {
            Source::File(path) => Some(path),
            Source::Builtin(_) => None,
        };
        scene.into_iter().chain(&self.settings_path).map(PathBuf::as_path).collect()
    }

    /// Loads the scene and says on stderr what loading skipped.
    pub fn load(self) -> anyhow::Result<Job> {
        let pool = pool(self.settings.solver.threads)?;
        let begun = Instant::now();
        let (scene, occluders) = pool.install(|| prepare(&self))?;
        let load_seconds = begun.elapsed().as_secs_f64();
        for sentence in scene.skipped.sentences() {
            eprintln!("note: {sentence}");
        }
        if !scene.has_light() {
            eprintln!("warning: {}", Scene::no_light_sentence());
        }
        let (scene, occluders) = (Arc::new(scene), Arc::new(occluders));
        Ok(Job { scene, occluders, settings: self.settings, limit: self.limit, load_seconds, pool })
    }
}

fn prepare(order: &Order) -> anyhow::Result<(Scene, Occluders)> {
    let Settings { reading, light, solver, .. } = &order.settings;
    let ready = prepare::prepare(&order.source, reading, light, solver.sides)?;
    Ok((ready.scene, ready.occluders))
}

/// Threads for the solver; 0 takes every core.
pub fn pool(count: u32) -> anyhow::Result<ThreadPool> {
    threads::pool("solver", count as usize)
        .map_err(|error| anyhow!("the solver's threads cannot be started ({error}); try fewer --threads"))
}

/// A scene that is ready to be solved.
pub struct Job {
    /// The scene, faces turned or doubled as its sides ask.
    pub scene: Arc<Scene>,
    /// Occluders of the scene.
    pub occluders: Arc<Occluders>,
    /// Settings of the solve.
    pub settings: Settings,
    /// How long it may take.
    pub limit: Option<Duration>,
    load_seconds: f64,
    /// The threads that work on it.
    pub pool: ThreadPool,
}

/// A solution, finished or not.
pub struct Solution {
    /// The solver, for further questions.
    pub solver: Solver,
    /// Counts and times when the solve ended.
    pub stats: Stats,
    /// Snapshot of the solution.
    pub snapshot: Snapshot,
    /// When the first snapshot was there.
    pub first_snapshot_at: Instant,
    /// Threads that worked on it.
    pub threads: usize,
}

impl Job {
    /// Refines and gathers until nothing is left to do or the time is over; shows progress on a
    /// terminal.
    pub fn solve(&self) -> anyhow::Result<Solution> {
        self.pool.install(|| self.solve_here())
    }

    fn solve_here(&self) -> anyhow::Result<Solution> {
        let cancel = CancelToken::new();
        if let Some(limit) = self.limit {
            start_timer(limit, cancel.clone())?;
        }
        let mut solver = Solver::new(self.scene.clone(), self.occluders.clone(), self.settings.solver, 1)?;
        solver.set_load_seconds(self.load_seconds);
        // What a window would show at once; its time is reported.
        drop(solver.snapshot());
        let first_snapshot_at = Instant::now();
        let mut progress = Progress::start();
        loop {
            match solver.step(&cancel) {
                Step::Finished | Step::Interrupted => break,
                Step::Refined { .. } | Step::Gathered | Step::Reconstructed { .. } => progress.show(&solver),
            }
        }
        drop(progress);
        let stats = solver.stats();
        let snapshot = solver.snapshot();
        if snapshot.vertex_radiosity.iter().flatten().any(|value| !value.is_finite()) {
            bail!("the solution holds values that are not finite: please report this scene");
        }
        Ok(Solution { solver, stats, snapshot, first_snapshot_at, threads: self.pool.current_num_threads() })
    }
}

/// Cancels when the time is over; ends with the process.
pub fn start_timer(limit: Duration, cancel: CancelToken) -> anyhow::Result<()> {
    if limit.is_zero() {
        cancel.cancel();
        return Ok(());
    }
    let wait = move || {
        std::thread::sleep(limit);
        cancel.cancel();
    };
    let started = Builder::new().name("timer".into()).spawn(wait);
    started.map(drop).map_err(|error| anyhow!("no thread is left to watch the time ({error})"))
}
