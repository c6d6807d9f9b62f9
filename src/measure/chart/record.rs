//! Records of a chart's runs, with every parameter of each.

use serde::Serialize;

use crate::measure::accuracy::{LocalError, SolutionError};
use crate::solve::{Bytes, Seconds, SolverParams};

/// One scene's runs.
#[derive(Clone, Debug, Serialize)]
pub struct Chart {
    /// The scene's name.
    pub scene: String,
    /// Polygons of the scene, doubled ones counted twice.
    pub polygons: usize,
    /// Worker threads of every run.
    pub threads: usize,
    /// The reference that errors are measured by.
    pub reference: ReferenceRecord,
    /// The runs, setting by setting, from coarse to fine.
    pub runs: Vec<RunRecord>,
    /// Runs that were not made.
    pub skipped: Vec<SkippedRun>,
    /// The path tracer on a fixed set of points.
    pub path_tracer: Vec<PathTracerRecord>,
}

/// The reference of a chart.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ReferenceRecord {
    /// Random points.
    pub points: usize,
    /// Paths from all of them.
    pub paths: u64,
    /// Relative RMS noise.
    pub noise: f64,
}

/// One run of the solver.
#[derive(Clone, Debug, Serialize)]
pub struct RunRecord {
    /// Name of the setting.
    pub setting: String,
    /// Every parameter.
    pub params: SolverParams,
    /// ε as a share of Φ.
    pub epsilon_relative: f64,
    /// ε, W.
    pub epsilon_watts: f64,
    /// Whether it finished within its time.
    pub converged: bool,
    /// Seconds by phase, loading left out.
    pub seconds: Seconds,
    /// Clusters.
    pub clusters: usize,
    /// Leaf patches.
    pub patches: usize,
    /// Vertices of the display mesh.
    pub vertices: usize,
    /// Links.
    pub links: usize,
    /// Pairs judged.
    pub pairs_judged: u64,
    /// Visibility rays.
    pub rays: u64,
    /// Rounds.
    pub iterations: u32,
    /// Leaves whose form factors were scaled back.
    pub clamped_leaves: usize,
    /// Error that was asked for, if one was.
    pub error_asked: Option<f64>,
    /// The solver's own cautious estimate of its error, if it made one.
    pub error_estimate: Option<f64>,
    /// Memory of the large tables.
    pub bytes: Bytes,
    /// Error of the run.
    pub error: SolutionError,
    /// Whether no other run is both faster and more accurate.
    pub pareto: bool,
}

/// A run that was not made.
#[derive(Clone, Debug, Serialize)]
pub struct SkippedRun {
    /// Name of the setting.
    pub setting: String,
    /// ε as a share of Φ.
    pub epsilon_relative: f64,
    /// Why, in a sentence.
    pub why: String,
}

/// The path tracer after some time.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PathTracerRecord {
    /// Points computed: the same in every chart of the scene, whatever the meshes of the runs.
    pub points: usize,
    /// Paths from all of them.
    pub paths: u64,
    /// Time from the first path on, s.
    pub seconds: f64,
    /// Relative RMS of its standard errors, which is the RMS error of an unbiased estimate.
    pub error: f64,
    /// Standard error of `error`, from the spread over the points.
    pub error_noise: f64,
    /// Median of its local relative error, which it would have with normal errors of its standard
    /// errors.
    pub local_median: f64,
    /// Standard error of `local_median`.
    pub local_median_noise: f64,
    /// The local error of E that normal errors of its standard errors have.
    pub local: LocalError,
}
