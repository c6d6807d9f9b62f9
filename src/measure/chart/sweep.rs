//! Runs of the solver, setting by setting and threshold by threshold.

use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::scope;
use std::time::Duration;

use super::pareto::front;
use super::path_tracer;
use super::record::{Chart, ReferenceRecord, RunRecord, SkippedRun};
use crate::base::cancel::CancelToken;
use crate::geometry::Occluders;
use crate::measure::accuracy::ErrorMeter;
use crate::measure::reference::Reference;
use crate::scene::Scene;
use crate::solve::{ClusteringMode, Epsilon, Reconstruct, Solver, SolverError, SolverParams, USUAL_ERROR};
use crate::transport::{ClusterModel, Push};

/// The path tracer computes as many points as the display mesh of a solve with this ε has vertices.
const EPSILON_OF_POINTS: f64 = 1e-3;

/// A way to solve; its ε comes from the sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Name of the setting in the chart.
    pub name: String,
    /// Every parameter.
    pub params: SolverParams,
}

/// Settings and thresholds to run.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The settings. An option that the solver learns joins here, with a name.
    pub settings: Vec<Setting>,
    /// Thresholds as shares of Φ, from coarse to fine.
    pub epsilons: Vec<f64>,
    /// How long one run may take; what is finer than one that did not finish is left out.
    pub limit: Duration,
}

/// Every clustering with either push, on top of `base`, the paper's isotropic clusters, and the
/// final gather that is asked for an error. Without clusters there is nothing to push.
pub fn usual_settings(base: SolverParams) -> Vec<Setting> {
    let base = SolverParams { error: None, reconstruct: Reconstruct::Vertex, ..base };
    let modes = [
        ("adaptive", ClusteringMode::Adaptive),
        ("groups", ClusteringMode::Groups),
        ("octree", ClusteringMode::Octree),
        ("none", ClusteringMode::None),
    ];
    let mut settings = Vec::new();
    for (mode, clustering) in modes {
        for (name, push) in [("immediate", Push::Immediate), ("deferred", Push::Deferred)] {
            let params = SolverParams { clustering, push, ..base };
            match (clustering, push) {
                (ClusteringMode::None, Push::Deferred) => {}
                (ClusteringMode::None, Push::Immediate) => settings.push(Setting { name: mode.to_owned(), params }),
                _ => settings.push(Setting { name: format!("{mode}, {name}"), params }),
            }
        }
    }
    let isotropic = SolverParams { cluster_model: ClusterModel::Isotropic, ..base };
    let params = SolverParams { clustering: ClusteringMode::Adaptive, push: Push::Immediate, ..isotropic };
    settings.push(Setting { name: "isotropic, adaptive".to_owned(), params });
    let adaptive = SolverParams { clustering: ClusteringMode::Adaptive, push: Push::Immediate, ..base };
    let params = SolverParams { error: Some(USUAL_ERROR), ..adaptive };
    settings.push(Setting { name: "gather, adaptive".to_owned(), params });
    settings
}

/// Thresholds from 10⁻² to 10⁻⁵, two to a power of ten.
pub fn usual_epsilons() -> Vec<f64> {
    vec![1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5]
}

/// Errors that a final gather is asked for, from 20 % to 2 %.
const ERRORS: [f64; 5] = [0.2, 0.1, 0.05, 0.03, 0.02];

impl Setting {
    /// The runs of this setting, from coarse to fine.
    fn runs(&self, epsilons: &[f64]) -> Vec<SolverParams> {
        match self.params.error {
            Some(_) => ERRORS.iter().map(|error| SolverParams { error: Some(*error), ..self.params }).collect(),
            None => {
                let with = |epsilon: &f64| SolverParams { epsilon: Epsilon::Relative(*epsilon), ..self.params };
                epsilons.iter().map(with).collect()
            }
        }
    }
}

impl Sweep {
    /// Makes every run, one after the other on the present threads, and the path tracer's;
    /// `progress` hears of each before it starts. Cancelled, it returns what is there.
    pub fn run(
        &self,
        scene: &Arc<Scene>,
        occluders: &Arc<Occluders>,
        reference: Arc<Reference>,
        cancel: &CancelToken,
        mut progress: impl FnMut(&str, f64),
    ) -> Chart {
        let seed = self.settings.first().map_or(1, |setting| setting.params.seed);
        let mut chart = Chart {
            scene: scene.name.clone(),
            polygons: scene.polygons.len(),
            threads: rayon::current_num_threads(),
            reference: ReferenceRecord {
                points: reference.points.len(),
                paths: reference.paths,
                noise: reference.noise(),
            },
            runs: Vec::new(),
            skipped: Vec::new(),
            path_tracer: Vec::new(),
        };
        let mut meter = ErrorMeter::new(reference);
        for setting in &self.settings {
            let mut unfinished: Option<String> = None;
            for params in setting.runs(&self.epsilons) {
                if cancel.is_cancelled() {
                    return chart;
                }
                let (Epsilon::Relative(epsilon) | Epsilon::Watts(epsilon)) = params.threshold();
                let skip = |why: String| SkippedRun { setting: setting.name.clone(), epsilon_relative: epsilon, why };
                if let Some(why) = &unfinished {
                    chart.skipped.push(skip(why.clone()));
                    continue;
                }
                progress(&setting.name, epsilon);
                match self.solve(setting, params, scene, occluders, &mut meter, cancel) {
                    Ok(run) => {
                        if !run.converged {
                            let limit = self.limit.as_secs_f64();
                            unfinished = Some(format!("a coarser threshold took longer than {limit} s"));
                        }
                        chart.runs.push(run);
                    }
                    Err(error) => chart.skipped.push(skip(error.to_string())),
                }
            }
        }
        progress("path tracer", 0.0);
        let vertices = chart
            .runs
            .iter()
            .find(|run| run.error_asked.is_none() && run.epsilon_relative <= 1.001 * EPSILON_OF_POINTS);
        let points = vertices.or(chart.runs.last()).map_or(1000, |run| run.vertices);
        chart.path_tracer = path_tracer::curve(scene, points, seed, self.limit, cancel);
        chart.mark_front();
        chart
    }

    fn solve(
        &self,
        setting: &Setting,
        params: SolverParams,
        scene: &Arc<Scene>,
        occluders: &Arc<Occluders>,
        meter: &mut ErrorMeter,
        cancel: &CancelToken,
    ) -> Result<RunRecord, SolverError> {
        let mut solver = Solver::new(scene.clone(), occluders.clone(), params, 1)?;
        within(self.limit, cancel, |cancel| solver.run(cancel));
        let stats = solver.stats();
        let snapshot = solver.snapshot();
        Ok(RunRecord {
            setting: setting.name.clone(),
            params,
            epsilon_relative: stats.epsilon_relative,
            epsilon_watts: stats.epsilon_watts,
            converged: stats.converged,
            seconds: stats.seconds,
            clusters: stats.clusters,
            patches: stats.patches,
            vertices: snapshot.mesh.positions.len(),
            links: stats.links,
            pairs_judged: stats.pairs_judged,
            rays: stats.rays,
            iterations: stats.iterations,
            clamped_leaves: stats.clamped_leaves,
            error_asked: stats.error_asked,
            error_estimate: stats.error_estimate,
            bytes: stats.bytes,
            error: meter.measure(&snapshot),
            pareto: false,
        })
    }
}

impl Chart {
    /// Marks the finished runs that no other one beats in both time and local error.
    fn mark_front(&mut self) {
        let finished: Vec<usize> = (0..self.runs.len()).filter(|index| self.runs[*index].converged).collect();
        let of = |index: &usize| (self.runs[*index].seconds.total, self.runs[*index].error.local.p90);
        let marks = front(&finished.iter().map(of).collect::<Vec<_>>());
        for (index, mark) in finished.into_iter().zip(marks) {
            self.runs[index].pareto = mark;
        }
    }
}

/// Does work that is cancelled when the time is over or when `outer` is.
pub(crate) fn within(limit: Duration, outer: &CancelToken, work: impl FnOnce(&CancelToken) -> bool) -> bool {
    /// How often the outer token is looked at.
    const LOOK: Duration = Duration::from_millis(20);
    let inner = CancelToken::new();
    let (done, is_done) = channel::<()>();
    scope(|scope| {
        let (watched, begun) = (inner.clone(), std::time::Instant::now());
        scope.spawn(move || {
            // Woken when the work is done and `done` is dropped.
            while is_done.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                if begun.elapsed() >= limit || outer.is_cancelled() {
                    watched.cancel();
                }
            }
        });
        let finished = work(&inner);
        drop(done);
        finished
    })
}
