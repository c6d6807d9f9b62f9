//! Counts, times and the power balance of a solution, as statistics files and panels show them.

use serde::Serialize;

use super::memory::MemoryStop;
use crate::gather::Quantiles;

/// Phase of a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Building clusters.
    #[default]
    Hierarchy,
    /// Judging candidate links.
    Refine,
    /// Gathering to convergence.
    Gather,
    /// Gathering light anew over the links' solution (final gather).
    Reconstruct,
    /// Nothing is left to do.
    Done,
}

/// Counts and times of one solve; keys as in the statistics file.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Stats {
    /// Present phase of the solve.
    pub phase: Phase,
    /// Threshold ε, W.
    pub epsilon_watts: f64,
    /// Threshold ε as a share of Φ (0 where nothing emits).
    pub epsilon_relative: f64,
    /// Power Φ now, emitted and from outside, by the largest colour, W.
    pub power_watts: f64,
    /// The Φ by which ε became watts, W; ε stays as it is when a lamp is dimmed.
    pub anchor_watts: f64,
    /// Polygons that became patches.
    pub initial_patches: usize,
    /// Clusters.
    pub clusters: usize,
    /// Leaf patches of the subdivision.
    pub patches: usize,
    /// Elements of every kind.
    pub elements: usize,
    /// Links kept.
    pub links: usize,
    /// Pairs that the oracle was asked about.
    pub pairs_judged: u64,
    /// Visibility rays cast.
    pub rays: u64,
    /// Rounds of refinement, each ended by a gather.
    pub iterations: u32,
    /// Waves of the present round.
    pub wave: u32,
    /// Candidates that wait in the present wave.
    pub candidates_left: usize,
    /// Whether nothing was left to refine, for want of memory neither, and the last gather
    /// converged.
    pub converged: bool,
    /// Times that the depth guard kept a patch from being subdivided.
    pub depth_guard_struck: u64,
    /// Leaves whose form factors summed to more than 1 and were scaled back.
    pub clamped_leaves: usize,
    /// Leaves that were brighter than anything in the scene can be, max B_e/(1−ρ_max), and were
    /// brought back to that.
    pub bounded_leaves: usize,
    /// Target error: the local error |ΔE|/(E + E₀) within which nine tenths of the area are to be
    /// read.
    pub error_asked: Option<f64>,
    /// Upper bound on it that the certificate found, once there is one.
    pub error_estimate: Option<f64>,
    /// Further facts about the error, once they are known.
    pub error: Option<ErrorFound>,
    /// Time spent so far.
    pub seconds: Seconds,
    /// Memory of the large tables.
    pub bytes: Bytes,
    /// The part that could not be refined as far as was asked for within the memory budget.
    pub memory_stop: Option<MemoryStop>,
    /// Emitted power Φ, W (all colours summed).
    pub emitted_watts: f64,
    /// Power that comes in from outside and meets bright sides, all colours together, W.
    pub entering_watts: f64,
    /// Power absorbed by bright sides, W (all colours summed).
    pub absorbed_watts: f64,
    /// Share of the whole solve that is done, as far as can be known, 0..1.
    pub progress: f32,
    /// Local error within which nine tenths of the area are, by the points that the certificate has
    /// compared so far.
    #[serde(skip)]
    pub error_so_far: Option<f64>,
}

impl Stats {
    /// Links that are there, those that wait to be tested among them.
    pub fn all_links(&self) -> usize {
        self.links + self.candidates_left
    }
}

/// Errors that the certificate of a gather found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorFound {
    /// Nine tenths of the area are read within this local error,
    pub bound: f64,
    /// with this probability.
    pub confidence: f64,
    /// Points that were compared.
    pub points: usize,
    /// Local error of what is read.
    pub read: Quantiles,
    /// RMS error of B as it is read, as a share of the RMS radiosity.
    pub radiosity_rms: f64,
    /// Local error of the bare mesh, which is exported and shown while the camera moves.
    pub mesh: Quantiles,
}

/// Seconds of work by phase; pauses between steps do not count.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Seconds {
    /// Reading the file, turning faces and building the occluders.
    pub load: f64,
    /// Building clusters.
    pub hierarchy: f64,
    /// Judging and refining.
    pub refine: f64,
    /// Gathering.
    pub gather: f64,
    /// The final gather.
    pub reconstruct: f64,
    /// Of `total`, until the first snapshot was there.
    pub first_snapshot: f64,
    /// Spent on this solve so far: clusters, refining, gathering, and snapshots until it was done.
    pub total: f64,
}

/// Bytes of the large tables.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Bytes {
    /// Links alone.
    pub links: usize,
    /// Elements with their radiosities, and vertices.
    pub elements: usize,
    /// The gather: its own leaves, and the samples of its looks.
    pub gather_samples: usize,
    /// All that is counted against the budget: scene, solution, and what is made of them meanwhile.
    pub counted: usize,
    /// The memory budget.
    pub budget: usize,
}
