//! Measured runs: a room with its reference, a solve, its counts, times and error.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::effort::Effort;
use crate::base::cancel::CancelToken;
use crate::base::format::percent_with;
use crate::geometry::Occluders;
use crate::geometry::orient;
use crate::measure::accuracy::{ErrorMeter, SolutionError};
use crate::measure::chart::within;
use crate::measure::reference::{Reference, ReferenceRun, Wish, compute, random_points};
use crate::scene::{Scene, builtin::BuiltinScene};
use crate::solve::{Snapshot, Solver, SolverParams, Stats};
use crate::transport::VisibilitySource;

/// Seed of the reference's points and paths, the same as the solver's default.
const SEED: u64 = 1;

/// A scene that is ready to be solved. Its occluders are built already: no time of a run holds
/// them.
pub struct Room {
    /// Name of the room on the command line.
    pub name: &'static str,
    /// The scene.
    pub scene: Arc<Scene>,
    /// Occluders of the room.
    pub occluders: Arc<Occluders>,
    meter: Option<ErrorMeter>,
}

impl Room {
    /// A room for its speed alone.
    pub fn new(builtin: BuiltinScene) -> Self {
        Self::of_scene(builtin.name(), builtin.build())
    }

    /// The room of any scene.
    pub fn of_scene(name: &'static str, scene: Scene) -> Self {
        let sides = scene.sides;
        let (scene, occluders) = orient::apply(scene, sides);
        Self { name, scene: Arc::new(scene), occluders: Arc::new(occluders), meter: None }
    }

    /// Number of polygons of the scene.
    pub fn polygons(&self) -> usize {
        self.scene.polygons.len()
    }

    fn solver(&self, setting: &str, params: SolverParams) -> Result<Solver, LeftOut> {
        let solver = Solver::new(self.scene.clone(), self.occluders.clone(), params, 1);
        solver.map_err(|error| self.left_out(setting, error.to_string(), None))
    }

    fn left_out(&self, setting: &str, why: String, longer_than: Option<f64>) -> LeftOut {
        LeftOut { setting: setting.to_owned(), polygons: self.polygons(), why, longer_than }
    }

    /// Name and size for a person: seminar, 2,008 polygons.
    pub fn title(&self) -> String {
        format!("{}, {}", self.name, crate::base::format::things(self.polygons(), "polygon", "polygons"))
    }
}

/// One setting, measured.
#[derive(Clone, Debug)]
pub struct Run {
    /// Name of the run in the tables.
    pub setting: String,
    /// The scene's name.
    pub scene: &'static str,
    /// Number of polygons of the scene.
    pub polygons: usize,
    /// Every parameter.
    pub params: SolverParams,
    /// Worker threads.
    pub threads: usize,
    /// Time of each repetition, s: building clusters, refining and gathering.
    pub seconds: Vec<f64>,
    /// Counts of the solve, which are the same in every repetition.
    pub stats: Stats,
    /// Links whose visibility comes from rays of their own.
    pub links_with_rays: usize,
    /// Links among them that had no more rays than the lower bound.
    pub links_at_bound: usize,
    /// The error, where there is a reference.
    pub error: Option<SolutionError>,
}

impl Run {
    /// The median time, s.
    pub fn time(&self) -> f64 {
        median(&self.seconds)
    }

    /// Displayed RMS error, a share.
    pub fn rms(&self) -> f64 {
        self.error.map_or(f64::NAN, |error| error.displayed.rms)
    }

    /// The displayed RMS error with its standard error: 12.4 ± 0.8 %.
    pub fn rms_text(&self) -> String {
        self.error.map_or("–".into(), |error| percent_with(error.displayed.rms, error.displayed.rms_noise))
    }

    /// The median of the displayed local error with its standard error: 12.4 ± 0.8 %.
    pub fn local_median_text(&self) -> String {
        let text =
            |error: SolutionError| percent_with(error.displayed.local_median, error.displayed.local_median_noise);
        self.error.map_or("–".into(), text)
    }

    /// Median of the displayed local error, a share.
    pub fn local_median(&self) -> f64 {
        self.error.map_or(f64::NAN, |error| error.displayed.local_median)
    }

    /// Bytes of links, elements and radiosities when the solve ends.
    pub fn bytes(&self) -> usize {
        self.stats.bytes.links + self.stats.bytes.elements
    }
}

/// A run that was not made, or not to its end.
#[derive(Clone, Debug)]
pub struct LeftOut {
    /// The setting.
    pub setting: String,
    /// Polygons of the room.
    pub polygons: usize,
    /// Why, in a few words.
    pub why: String,
    /// The time that did not suffice, s, where it was time that lacked.
    pub longer_than: Option<f64>,
}

/// Makes the runs.
pub struct Lab<'a> {
    /// Parameters of the run.
    pub effort: Effort,
    truth: Wish,
    references: FxHashMap<BuiltinScene, Arc<Reference>>,
    tell: &'a mut (dyn FnMut(&str) + Send),
}

impl<'a> Lab<'a> {
    /// A lab that tells what it does, line by line.
    pub fn new(effort: Effort, truth: Wish, tell: &'a mut (dyn FnMut(&str) + Send)) -> Self {
        Self { effort, truth, references: FxHashMap::default(), tell }
    }

    /// Says what is done.
    pub fn tell(&mut self, line: &str) {
        (self.tell)(line);
    }

    /// A room whose runs have an error.
    pub fn room(&mut self, builtin: BuiltinScene) -> Room {
        let mut room = Room::new(builtin);
        let reference = match self.references.get(&builtin) {
            Some(reference) => reference.clone(),
            None => {
                self.tell(&format!("reference of {}", room.title()));
                let points = random_points(&room.scene, self.truth.points, SEED).into();
                let mut run = ReferenceRun::new(&room.scene, points, SEED);
                let cache = self.truth.cache.as_ref();
                let outcome = compute(&mut run, cache, self.truth.target, &CancelToken::new(), |_, _| {});
                if let Some(error) = &outcome.cache_error {
                    self.tell(&format!("the reference cannot be kept for the next time ({error})"));
                }
                self.references.entry(builtin).insert_entry(Arc::new(outcome.reference)).get().clone()
            }
        };
        room.meter = Some(ErrorMeter::new(reference));
        room
    }

    /// A setting, repeated where it is short.
    ///
    /// # Errors
    /// The solve does not fit into memory or takes longer than it may.
    pub fn run(&mut self, room: &mut Room, setting: &str, params: SolverParams) -> Result<Run, LeftOut> {
        let runs = self.by_turns(room, &[(setting.to_owned(), params)], self.effort.repeats);
        runs.into_iter().next().expect("one setting, one run")
    }

    /// Settings by turns, so that what else the machine does meets all of them alike; those that
    /// are not short have one turn.
    pub fn by_turns(
        &mut self,
        room: &mut Room,
        settings: &[(String, SolverParams)],
        turns: usize,
    ) -> Vec<Result<Run, LeftOut>> {
        let mut runs: Vec<_> = settings
            .iter()
            .map(|(setting, params)| self.solve(room, setting, *params).map(|solved| solved.0))
            .collect();
        for _ in 1..turns {
            for run in runs.iter_mut().flatten().filter(|run| run.seconds[0] < Effort::SHORT) {
                let setting = run.setting.clone();
                if let Ok((again, _)) = self.solve(room, &setting, run.params) {
                    run.seconds.extend(again.seconds);
                }
            }
        }
        runs
    }

    /// Seconds until there is a picture, from the root's self-link alone.
    ///
    /// # Errors
    /// As [`Lab::run`].
    pub fn first_picture(&mut self, room: &Room, setting: &str, params: SolverParams) -> Result<f64, LeftOut> {
        let mut solver = room.solver(setting, params)?;
        Ok(solver.snapshot().stats.seconds.first_snapshot)
    }

    /// One solve and what is there to be seen of it.
    ///
    /// # Errors
    /// As [`Lab::run`].
    pub fn solve(&mut self, room: &mut Room, setting: &str, params: SolverParams) -> Result<(Run, Snapshot), LeftOut> {
        self.tell(&format!("{}: {setting}", room.title()));
        let mut solver = room.solver(setting, params)?;
        if !within(self.effort.cap, &CancelToken::new(), |cancel| solver.run(cancel)) {
            let cap = self.effort.cap.as_secs_f64();
            return Err(room.left_out(setting, format!("not finished within {cap} s"), Some(cap)));
        }
        let stats = solver.stats();
        let rays = |link: &crate::transport::Link| match link.visibility_source() {
            VisibilitySource::Rays(rays) | VisibilitySource::Clear(rays) => Some(u32::from(rays)),
            VisibilitySource::None | VisibilitySource::Inherited => None,
        };
        let counts = solver
            .links()
            .all()
            .iter()
            .filter_map(rays)
            .fold((0, 0), |(all, at_bound), rays| (all + 1, at_bound + usize::from(rays <= params.rays_min)));
        let snapshot = solver.snapshot();
        let run = Run {
            setting: setting.to_owned(),
            scene: room.name,
            polygons: room.polygons(),
            params,
            threads: rayon::current_num_threads(),
            seconds: vec![stats.seconds.total],
            links_with_rays: counts.0,
            links_at_bound: counts.1,
            error: room.meter.as_mut().map(|meter| meter.measure(&snapshot)),
            stats,
        };
        Ok((run, snapshot))
    }
}

/// The median; NaN of nothing.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}
