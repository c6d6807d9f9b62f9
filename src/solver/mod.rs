//! The solver: one link, from the root cluster to itself, refined until every link carries little enough.
//!
//! [`Solver::step`] does one bounded piece of work at a time, so that whoever drives it can look at pictures, change
//! parameters or stop in between. The algorithm:
//!
//! 1. Start with emitted light and the root's self-link as the one candidate.
//! 2. Judge the candidates of a wave (`Oracle`), apply the verdicts (`Refinement`); repeat until none is left.
//! 3. Gather to convergence (`Gatherer`).
//! 4. Judge the stored links again, for B has grown; those that fail are candidates of the next round, until none fails.
//! 5. Where an error is asked for, gather light anew over it ([`crate::gather`]) until the certificate keeps the target error.
//!
//! Settings, lamps and materials may change meanwhile (`live`): what that costs is told by `change`, and a coarser threshold merges
//! links and patches back (`coarsen`).
//!
//! This module imports `scene`, `visibility` and `hierarchy`.

pub mod anatomy;
mod audit;
mod balance;
mod bounds;
mod candidate;
mod change;
mod coarsen;
mod display;
mod form_factor;
mod gather;
mod history;
mod link;
mod link_error;
mod live;
mod memory;
mod mesh_error;
mod oracle;
mod outside;
pub mod params;
mod picture;
mod progress;
mod push;
mod rays;
mod reconstruct;
mod refine;
mod rounds;
mod sight;
pub mod snapshot;
mod state;
pub mod stats;
mod verdict;

use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;

pub use anatomy::{Anatomy, LinkView};
pub use audit::{Audit, audit};
pub use balance::{PowerBalance, power_balance};
pub use change::Invalidates;
pub use display::barycentric;
pub use form_factor::{Exchange, exchange, point_to_polygon};
pub use history::{MomentInfo, MomentKind};
pub use link::{Evidence, Link, LinkTable};
pub use link_error::LinkError;
pub use memory::MemoryStop;
pub use mesh_error::MeshError;
pub use outside::lets_daylight_in;
pub use params::{
    ClusterModel, ClusteringMode, Epsilon, OracleKind, PARAMETERS, Parameter, ParameterId, ParamsError, Push,
    Reconstruct, SolverParams, USUAL_ERROR, ValueKind,
};
pub use refine::RejectedPair;
pub use snapshot::{ClusterBox, Leaf, Mesh, Snapshot};
pub use stats::{Bytes, ErrorFound, Phase, Seconds, Stats};
pub use verdict::Rejection;

use crate::cancel::CancelToken;
use crate::gather::Gather;
use crate::geometry::Occluders;
use crate::geometry::Reachability;
use crate::hierarchy::{ElementId, Hierarchy, PatchSums, Shape};
use crate::scene::{Scene, Surface};
use candidate::Candidate;
use change::Doubts;
use display::Display;
use gather::{Light, pull};
use history::History;
use memory::check_pairs_fit;
use picture::Picture;
use refine::Refinement;

/// Why a solve cannot start.
#[derive(Debug, thiserror::Error)]
pub enum SolverError {
    /// A parameter cannot be used.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// Plain HR would need more memory than there is.
    #[error(
        "clustering none would judge {pairs} pairs and needs up to {needed_mib} MiB for their links, more than half of the memory budget of {budget_mib} MiB: choose adaptive, groups or octree, or give more with --memory"
    )]
    TooManyPairs {
        /// Pairs of initial patches.
        pairs: u64,
        /// Memory their links may take, MiB.
        needed_mib: u64,
        /// The memory budget, MiB.
        budget_mib: u64,
    },
}

/// What one call of [`Solver::step`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Judged and applied a part of a wave.
    Refined {
        /// Whether the wave ended with it.
        wave_ended: bool,
    },
    /// Gathered to convergence and judged the stored links again.
    Gathered,
    /// Looked for light at vertices.
    Reconstructed {
        /// Whether a pass over all of them ended with it.
        pass_ended: bool,
    },
    /// Nothing is left to do.
    Finished,
    /// The token was cancelled; the same step can be taken again, with the same result.
    Interrupted,
}

/// Refines the root's self-link and gathers, step by step.
pub struct Solver {
    scene: Arc<Scene>,
    occluders: Arc<Occluders>,
    surfaces: Vec<Surface>,
    params: SolverParams,
    epsilon_watts: f64,
    /// The Φ by which ε became watts, W.
    anchor_watts: f64,
    /// Power from outside, W per colour.
    entering: Vec3,
    /// Whether links may be finer than ε asks for, because it was raised.
    merges_back: bool,
    /// What the next look at the stored links must look for.
    doubts: Doubts,
    hierarchy: Hierarchy,
    light: Light,
    /// Emitted power of the initial patches, by the largest colour, W.
    emission: PatchSums,
    /// Largest colour of each element's B at the last fixed point of the algorithm; what verdicts look at.
    brightness: Vec<f32>,
    /// Standard deviation of that over each element's leaves, W/m².
    spread: Vec<f32>,
    links: LinkTable,
    refinement: Refinement,
    phase: Phase,
    /// Place in [`SCHEDULE`].
    stage: usize,
    /// Whether the next gather is the last one, to [`FINAL_TOLERANCE`].
    gathers_finely: bool,
    /// Whether the light is that of the last gather, and nothing has changed since but what is asked of links.
    is_converged: bool,
    /// Whether nothing is split any more, because memory would not hold it.
    is_full: bool,
    /// Whether clusters light some of their children as a whole because memory was full: pairs of siblings would count twice beside that.
    has_cut_rows: bool,
    /// What was not refined as far as was asked for, for want of memory.
    memory_stop: Option<MemoryStop>,
    iterations: u32,
    clamped_leaves: usize,
    bounded_leaves: usize,
    /// Time spent working; whoever drives the solver may let it rest in between.
    seconds: Seconds,
    generation: u64,
    serial: u64,
    picture: Picture,
    display: Option<Display>,
    gather: Option<Gather>,
    /// What its certificate found, once it ended.
    error_found: Option<ErrorFound>,
    /// Whether snapshots carry the anatomy, and the hierarchy of the last one that did.
    wants_anatomy: bool,
    frozen: Option<Arc<Hierarchy>>,
    history: Option<History>,
}

impl Solver {
    /// Builds the hierarchy and the root's self-link.
    ///
    /// # Errors
    /// Parameters out of range, or a `none` solve that cannot fit into memory.
    pub fn new(
        scene: Arc<Scene>,
        occluders: Arc<Occluders>,
        params: SolverParams,
        generation: u64,
    ) -> Result<Self, SolverError> {
        Self::with_reachability(scene, occluders, params, generation, |scene, occluders| {
            Arc::new(Reachability::new(scene, occluders))
        })
    }

    /// The same where somebody may know already what is hidden.
    fn with_reachability(
        scene: Arc<Scene>,
        occluders: Arc<Occluders>,
        params: SolverParams,
        generation: u64,
        reachability: impl FnOnce(&Scene, &Occluders) -> Arc<Reachability>,
    ) -> Result<Self, SolverError> {
        params.validate()?;
        if params.clustering == ClusteringMode::None {
            check_pairs_fit(scene.polygons.len() as u64, params.memory.bytes())?;
        }
        let entering = outside::entering_power(&scene, &occluders, outside::RAYS, params.seed);
        let (hierarchy, seconds) =
            timed(|| Self::new_hierarchy(&scene, reachability(&scene, &occluders), &params, entering));
        let seconds = Seconds { hierarchy: seconds, total: seconds, ..Seconds::default() };
        let mut solver = Self {
            surfaces: surfaces_of(&scene),
            epsilon_watts: watts(&params, largest_power(&scene, entering)),
            anchor_watts: largest_power(&scene, entering),
            entering,
            merges_back: false,
            doubts: Doubts::default(),
            scene,
            occluders,
            params,
            hierarchy,
            light: Light::default(),
            emission: PatchSums::default(),
            brightness: Vec::new(),
            spread: Vec::new(),
            links: LinkTable::default(),
            refinement: Refinement::default(),
            phase: Phase::Refine,
            stage: 0,
            gathers_finely: false,
            is_converged: false,
            is_full: false,
            has_cut_rows: false,
            memory_stop: None,
            iterations: 0,
            clamped_leaves: 0,
            bounded_leaves: 0,
            seconds,
            generation,
            serial: 0,
            picture: Picture::default(),
            display: None,
            gather: None,
            error_found: None,
            wants_anatomy: false,
            frozen: None,
            history: None,
        };
        solver.light = solver.emitted_light();
        solver.emission = solver.emission_sums();
        solver.fix_brightness();
        solver.refinement.start(Candidate::first(&solver.hierarchy));
        Ok(solver)
    }

    /// Does one bounded piece of work, and keeps the moment where one ends with it and history is kept.
    pub fn step(&mut self, cancel: &CancelToken) -> Step {
        let step = self.work(cancel);
        match step {
            Step::Refined { wave_ended: true } => self.remember(MomentKind::Wave),
            Step::Gathered => self.remember(MomentKind::Round),
            Step::Reconstructed { pass_ended: true } => self.remember(MomentKind::Pass),
            _ => {}
        }
        step
    }

    /// Steps until nothing is left to do; false if cancelled.
    pub fn run(&mut self, cancel: &CancelToken) -> bool {
        loop {
            match self.step(cancel) {
                Step::Finished => return true,
                Step::Interrupted => return false,
                Step::Refined { .. } | Step::Gathered | Step::Reconstructed { .. } => {}
            }
        }
    }

    /// Emitted light alone, pulled up the tree.
    fn emitted_light(&self) -> Light {
        let emission = |element: &crate::hierarchy::Element| match element.shape {
            Shape::Patch(patch) => self.surfaces[patch.polygon as usize].emission,
            Shape::Cluster(_) => Vec3::ZERO,
            Shape::Sky(number) => self.hierarchy.sky_part(number).radiosity,
        };
        let mut radiosity: Vec<Vec3> = self.hierarchy.elements().iter().map(emission).collect();
        pull(&self.hierarchy, &mut radiosity);
        let irradiance = vec![Vec3::ZERO; radiosity.len()];
        Light { emitted: radiosity.clone(), radiosity, irradiance, row_scale: Vec::new() }
    }

    fn emission_sums(&self) -> PatchSums {
        let power = |&id: &ElementId| {
            f64::from(self.hierarchy.element(id).sampled_area * self.light.emitted[id.index()].max_element())
        };
        PatchSums::new(self.hierarchy.initial_patches().iter().map(power))
    }

    /// Lets new elements start with their parents' light, in all that verdicts look at.
    fn grow_light(&mut self) {
        self.light.grow(&self.hierarchy);
        let known = self.brightness.len();
        self.brightness.extend(self.light.radiosity[known..].iter().map(|radiosity| radiosity.max_element()));
        self.spread.resize(self.brightness.len(), 0.0);
    }

    /// Makes the present radiosities those that verdicts look at.
    fn fix_brightness(&mut self) {
        self.brightness.clear();
        self.brightness.extend(self.light.radiosity.iter().map(|radiosity| radiosity.max_element()));
        link_error::spread_of(&self.hierarchy, &self.brightness, &mut self.spread);
    }
}

/// Does some work; also tells how many seconds it took.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begun = Instant::now();
    let result = work();
    (result, begun.elapsed().as_secs_f64())
}

/// ε in W.
fn watts(params: &SolverParams, power: f64) -> f64 {
    match params.threshold() {
        Epsilon::Watts(watts) => watts,
        Epsilon::Relative(share) => share * power,
    }
}

/// Power Φ, emitted and from outside, by the largest colour, W.
fn largest_power(scene: &Scene, entering: Vec3) -> f64 {
    f64::from((scene.emitted_power() + entering).max_element())
}

fn surfaces_of(scene: &Scene) -> Vec<Surface> {
    scene.polygons.iter().map(|polygon| scene.surface(polygon)).collect()
}
