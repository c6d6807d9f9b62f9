//! Comparison with a reference: what the reference finds of each run, and what the view shows of
//! it.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::app::Wake;
use crate::app::view::paint::fresh_serial;
use crate::measure::accuracy::SolutionError;
use crate::measure::reference::Cache;
use crate::measure::reference_worker::{Measurement, ReferenceWorker, Report};
use crate::render::{BLUE_WHITE_RED, VIRIDIS, along_ramp};
use crate::scene::Scene;
use crate::solve::{Epsilon, Snapshot, SolverParams, name_of};

/// Points of a reference that a person may choose.
pub const POINTS: std::ops::RangeInclusive<usize> = 250..=16_000;
/// Runs whose curves are kept.
const MOST_RUNS: usize = 12;
/// Relative error at the end of the colour scales.
pub const FULL_SCALE: f32 = 0.5;

/// Meaning of the colours of surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Shading {
    /// The light.
    #[default]
    Lit,
    /// The size of the relative error.
    Error,
    /// The signed relative error: too dark, too bright.
    Difference,
}

impl Shading {
    /// The colour of a signed relative error; gamma-encoded.
    pub fn colour(self, difference: f32) -> [u8; 3] {
        match self {
            Self::Difference => along_ramp(&BLUE_WHITE_RED, 0.5 + 0.5 * difference / FULL_SCALE),
            Self::Lit | Self::Error => along_ramp(&VIRIDIS, difference.abs() / FULL_SCALE),
        }
    }

    /// A snapshot whose vertices have the colours of these relative errors.
    pub fn painted(self, of: &Snapshot, differences: &[f32]) -> Arc<Snapshot> {
        let colour = |&difference: &f32| self.colour(difference).map(|channel| f32::from(channel) / 255.0);
        let vertex_radiosity = differences.iter().map(colour).collect();
        Arc::new(Snapshot { vertex_radiosity, serial: fresh_serial(), ..of.clone() })
    }
}

/// The error of a solve at one time.
#[derive(Clone, Copy)]
pub struct RunPoint {
    /// Since the solve's start, s.
    pub seconds: f64,
    /// Relative RMS error.
    pub error: f64,
    /// Standard error of the error.
    pub noise: f64,
}

/// The error over time of one solve.
pub struct Run {
    /// Settings of the run, short.
    pub name: String,
    params: SolverParams,
    generation: u64,
    /// From the first picture to the last.
    pub points: Vec<RunPoint>,
}

/// A snapshot whose vertices carry colours, and what it was made of.
struct Painted {
    serial: u64,
    shading: Shading,
    snapshot: Arc<Snapshot>,
}

/// The window's side of the reference's thread.
pub struct Comparison {
    reference_worker: Option<ReferenceWorker>,
    report: Report,
    /// Points of the next reference.
    pub points: usize,
    pub shading: Shading,
    runs: Vec<Run>,
    /// The measurement that the runs hold already.
    noted: u64,
    asked: Option<Arc<Snapshot>>,
    painted: Option<Painted>,
}

impl Default for Comparison {
    fn default() -> Self {
        Self {
            reference_worker: None,
            report: Report::default(),
            points: 2000,
            shading: Shading::Lit,
            runs: Vec::new(),
            noted: 0,
            asked: None,
            painted: None,
        }
    }
}

impl Comparison {
    /// Starts a reference of a scene.
    ///
    /// # Errors
    /// The system gives no further thread.
    pub fn begin(&mut self, scene: &Arc<Scene>, wake: &Wake) -> std::io::Result<()> {
        if self.reference_worker.is_none() {
            let wake = wake.clone();
            self.reference_worker = Some(ReferenceWorker::spawn(Box::new(move || wake()))?);
        }
        self.forget_measurements();
        self.report.is_active = true;
        self.report.points = self.points;
        if let Some(reference_worker) = &self.reference_worker {
            reference_worker.begin(scene.clone(), self.points, Cache::of_user());
        }
        Ok(())
    }

    /// Stops; the curves stay.
    pub fn stop(&mut self) {
        if let Some(reference_worker) = &self.reference_worker {
            reference_worker.forget();
        }
        self.forget_measurements();
        self.report = Report::default();
        self.shading = Shading::Lit;
    }

    /// Another scene is in view, or the same one changed: a reference of the former is none of this
    /// one.
    pub fn follow_scene(&mut self, scene: &Arc<Scene>, is_new: bool) {
        self.runs.clear();
        if is_new {
            self.stop();
        } else if self.report.is_active {
            self.forget_measurements();
            if let Some(reference_worker) = &self.reference_worker {
                reference_worker.begin(scene.clone(), self.points, Cache::of_user());
            }
        }
    }

    fn forget_measurements(&mut self) {
        self.report = Report::default();
        (self.asked, self.painted) = (None, None);
    }

    /// Takes up what the reference found, and shows it the snapshot in view.
    pub fn note(&mut self, snapshot: Option<&Arc<Snapshot>>, params: &SolverParams) {
        let Some(reference_worker) = &self.reference_worker else { return };
        if !self.report.is_active {
            return;
        }
        if let Some(snapshot) = snapshot
            && self.asked.as_ref().is_none_or(|asked| !Arc::ptr_eq(asked, snapshot))
        {
            reference_worker.measure(snapshot.clone());
            self.asked = Some(snapshot.clone());
        }
        let report = reference_worker.report();
        // Before the thread has taken up its task the report is of none.
        if report.is_active {
            self.report = report;
        }
        if let Some(measured) = self.report.measured.clone()
            && measured.serial != self.noted
        {
            self.noted = measured.serial;
            self.add_to_run(&measured, params);
        }
    }

    fn add_to_run(&mut self, measured: &Measurement, params: &SolverParams) {
        let stats = &measured.snapshot.stats;
        let shown = &measured.error.displayed;
        let point = RunPoint { seconds: stats.seconds.total, error: shown.rms, noise: shown.rms_noise };
        let generation = measured.snapshot.generation;
        let goes_on = |run: &&mut Run| run.generation == generation && run.params == *params;
        match self.runs.last_mut().filter(goes_on) {
            Some(run) => {
                // A better reference measures the last picture again.
                if run.points.last().is_some_and(|last| last.seconds >= point.seconds) {
                    run.points.pop();
                }
                run.points.push(point);
            }
            None => {
                let run = Run { name: in_words(params), params: *params, generation, points: vec![point] };
                self.runs.push(run);
                let surplus = self.runs.len().saturating_sub(MOST_RUNS);
                self.runs.drain(..surplus);
            }
        }
    }

    /// Report of the reference's thread.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// The newest error.
    pub fn error(&self) -> Option<&SolutionError> {
        self.report.measured.as_ref().map(|measured| &measured.error)
    }

    /// Runs measured so far, the present one last.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Forgets all runs but the present one.
    pub fn forget_runs(&mut self) {
        let earlier = self.runs.len().saturating_sub(1);
        self.runs.drain(..earlier);
    }

    /// The measured snapshot with its errors as colours, where these are to be shown.
    pub fn painted(&mut self) -> Option<Arc<Snapshot>> {
        let measured = self.report.measured.as_ref().filter(|_| self.shading != Shading::Lit)?;
        let is_painted = |painted: &Painted| (painted.serial, painted.shading) == (measured.serial, self.shading);
        if !self.painted.as_ref().is_some_and(is_painted) {
            let snapshot = self.shading.painted(&measured.snapshot, &measured.differences);
            self.painted = Some(Painted { serial: measured.serial, shading: self.shading, snapshot });
        }
        self.painted.as_ref().map(|painted| painted.snapshot.clone())
    }
}

/// Settings in a few words.
fn in_words(params: &SolverParams) -> String {
    let asked = match (params.error, params.epsilon) {
        (Some(error), _) => format!("{} % asked", crate::base::format::number(100.0 * error)),
        (None, Epsilon::Relative(share)) => format!("ε {share:.0e} Φ"),
        (None, Epsilon::Watts(watts)) => format!("ε {watts:.1e} W"),
    };
    format!("{asked}, {}, {}", name_of(&params.clustering), name_of(&params.push))
}
